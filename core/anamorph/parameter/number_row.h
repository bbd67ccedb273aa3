// SPDX-License-Identifier: Apache-2.0
// Numbers that users of a host set. A row says what a number is called, its default and its range. The core's
// options take their defaults from rows, and its checks their ranges; VTK's filters check by the same rows, the
// options of anamorph-figure are made of them, and a test compares ParaView's XML with them.
#pragma once

#include <limits>
#include <string>

#include "anamorph/error.h"

namespace anamorph {

struct NumberRow {
    static constexpr double kNoEnd = std::numeric_limits<double>::infinity();
    enum Ends { closed, above_least, between };  ///< refused are: above_least, `least`; between, both

    const char* name;  ///< lower_snake
    double standard;   ///< the default; NaN where there is none
    double least = -kNoEnd, most = kNoEnd;
    Ends ends = closed;
    bool integer = false;

    /// Is a number finite and in the range?
    bool holds(double value) const;
    /// The range in words: "a number from 0 to 0.5", "an integer of at least 1".
    std::string range() const;
    /// Checks a value. Throws Error naming `parameter` (by default the row) unless the value is in the range.
    void check(double value, const char* parameter = nullptr) const;
};

}  // namespace anamorph
