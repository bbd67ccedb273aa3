// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

namespace anamorph {

/// Turns the sine and the cosine of an angle into those of the angle and so many quarters of a turn more, without rounding.
template <class T>
void turn_by_quarters(long long quarters, T& sine, T& cosine) {
    if (quarters & 1) {
        std::swap(sine, cosine);
        cosine = -cosine;
    }
    if (quarters & 2) {
        sine = -sine;
        cosine = -cosine;
    }
}

}  // namespace anamorph
