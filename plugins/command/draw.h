// SPDX-License-Identifier: Apache-2.0
// Pictures of recipes as files: one, or the frames of a film.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/parameter/parameter.h"
#include "picture_reader.h"

namespace anamorph::command {

/// What is to be drawn.
struct Drawing {
    std::string recipe;  ///< "{frame}" in it is the number of the frame
    std::string output;  ///< file; of frames with "{frame}", "%04d" or "####" for their numbers
    std::optional<std::string> frames;       ///< "3", "1-48", "1-48x4", "all"
    std::optional<std::string> compression;  ///< that of PictureFile
    int jobs = 0;  ///< so many threads draw, each a frame where there are several; 0: one a processor
    /// What is drawn of a recipe, of which keys are overridden.
    std::function<std::unique_ptr<PictureReader>(const std::string& recipe,
                                                 const std::vector<Assignment>& given)>
        open = open_picture;
    bool in_float = false;  ///< that of PictureFile
};
inline constexpr int kMostJobs = 256;

/// Has so many threads draw, 0 for one a processor, and says how many that is. Throws Error.
int use_threads(int jobs);

/// Draws a picture, or frames, each of which is there when it is whole; a bar on the standard error says how far it is. A frame is that of
/// the recipe with its number for "{frame}", or else by its key `frame`, or else, counted from 0, one of its pictures. Without numbers all
/// of its pictures are drawn if the file's name has "{frame}". Throws Error; the frames that are drawn by then stay.
void draw(const Drawing& drawing);

}  // namespace anamorph::command
