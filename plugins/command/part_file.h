// SPDX-License-Identifier: Apache-2.0
// Shares of a picture, drawn by themselves, maybe elsewhere, and joined.
//
// A part is a file of tiles as they are stored, one behind the other, and FILE.tiles, a text: the picture's size and channels, which part
// it is, and a line for each tile that is written, with its hash.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "anamorph/image/picture_hash.h"
#include "picture_reader.h"
#include "picture_writer.h"

namespace anamorph::command {

/// Which share: part `index` of `count`, from 1 on.
struct Share {
    int index = 1, count = 1;

    std::int64_t begin(std::int64_t tiles) const { return tiles * (index - 1) / count; }
    std::int64_t end(std::int64_t tiles) const { return tiles * index / count; }
};

inline constexpr int kMostParts = 100000;

/// Reads "I/N". Throws Error.
Share share_of(const std::string& text);

/// Draws a share of a recipe's picture into `file`. What is there of it already, and has the hashes that it should, stays where nothing
/// that the recipe is made of has changed. Returns how many tiles were drawn now. Throws Error.
std::int64_t draw_part(const std::string& recipe, const Share& share, const std::string& file);

/// Puts all parts of a picture together, in any order, as the picture `output`, or, where that has no name, only checks them: all are
/// there, of one picture, and each tile has its hash. Returns the hash of the picture. Throws Error.
PictureHash join_parts(std::vector<std::string> files, const PictureFile& output);

/// Draws one of a recipe's pictures as the file `output`, which is there when it is whole. `drawn` is called with the number of tiles
/// that were drawn since. Throws Error.
void draw_picture_file(PictureReader& picture, int subimage, const PictureFile& output,
                       const std::function<void(std::int64_t tiles)>& drawn);

}  // namespace anamorph::command
