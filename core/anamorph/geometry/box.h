// SPDX-License-Identifier: Apache-2.0
// Rectangles of pixels.
#pragma once

#include <algorithm>

namespace anamorph {

/// A rectangle of pixels, half open: x0 <= x < x1, y0 <= y < y1.
struct Box {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool empty() const { return x1 <= x0 || y1 <= y0; }
    friend bool operator==(const Box&, const Box&) = default;
};

/// The intersection of two rectangles; empty() where they have no pixel in common.
inline Box intersection(const Box& a, const Box& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

}  // namespace anamorph
