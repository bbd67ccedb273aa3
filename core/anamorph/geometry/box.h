// SPDX-License-Identifier: Apache-2.0
// Rectangles of pixels.
#pragma once

#include <algorithm>

#include "anamorph/geometry/size.h"

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

/// A rectangle with so many more pixels on either side.
inline Box widened(const Box& box, const Size& more) {
    return {box.x0 - more.width, box.y0 - more.height, box.x1 + more.width, box.y1 + more.height};
}
/// A rectangle moved.
inline Box moved(const Box& box, int x, int y) {
    return {box.x0 + x, box.y0 + y, box.x1 + x, box.y1 + y};
}

}  // namespace anamorph
