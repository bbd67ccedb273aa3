// SPDX-License-Identifier: Apache-2.0
// When a picture of a picture is drawn by one resampling (chain/joined.h), for whatever opens both.
#pragma once

#include <string>

#include "anamorph/chain/joined.h"
#include "anamorph/operation/operation.h"

namespace anamorph {

/// The picture of an operation as one side of a chain. Keeps references.
struct ChainSide {
    const SolvedPicture& picture;
    const Box& shown;          ///< the display window, in pixels of the picture
    const std::string& space;  ///< the color space that its sources are filtered in
    bool stored;               ///< are its pixels those that a source stores, of any types?
};

/// The reason for which what is asked of an operation keeps its picture from being joined with its source's; empty where there is none.
/// `count`: how many pictures it makes.
std::string why_drawn_apart(const std::string& operation, const ParameterValues& values, int count);

/// Joins a picture, of such pixels, with that which its source shows, or says why not.
Joined joined_sides(const ChainSide& outer, PixelKind pixels, const ChainSide& inner);

}  // namespace anamorph
