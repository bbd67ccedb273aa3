// SPDX-License-Identifier: Apache-2.0
// Which frames are asked for, and what the files of several are called.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "anamorph/figure/body/motion.h"

namespace anamorph::command {

/// "7", "1-48", "1-48x4" (every fourth) or "all": those that the script shows.
struct FrameRange {
    bool all = false;
    int first = 1, last = 1, step = 1;

    bool several() const { return all || last > first; }
    bool has(int number) const {
        return all || (number >= first && number <= last && (number - first) % step == 0);
    }
    /// The number of frames; for `all` it asks the motion.
    int count(figure::Motion& motion) const;
    /// Calls body for the frames in order. Throws Error where one is not performed.
    void for_each(figure::Motion& motion, const std::function<void(const figure::FigureFrame&)>& body) const;
};

std::optional<FrameRange> parse_frame_range(std::string_view text);

/// What stands for the number of a frame in names of files and recipes.
inline constexpr std::string_view kFrameWord = "{frame}";

/// `pattern` with the number in place of "{frame}" (four digits), of "%04d" (any width), or of "#" (each # is a digit); otherwise
/// before the ending, in four digits.
std::string numbered_name(const std::string& pattern, int number);

}  // namespace anamorph::command
