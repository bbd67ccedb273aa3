// SPDX-License-Identifier: Apache-2.0
// Kim 2003, section 3.1 and 4.3: a map as a linear part plus a table of residuals that is read bilinearly.
#pragma once

#include <cmath>

#include "anamorph/plan/formula_map.h"

namespace anamorph {

/// The linear part of a pull map on one piece of the target: source point = origin + right * (x - cx) +
/// down * (y - cy) in pixels, with (cx, cy) the centre of the piece.
struct LinearPart {
    double cx, cy;
    Point<double> origin, right, down;

    Point<double> operator()(double x, double y) const { return at(x, y); }
    template <class T>
    Point<T> at(const T& x, const T& y) const {
        return {(x - cx) * right.x + origin.x + (y - cy) * down.x,
                (x - cx) * right.y + origin.y + (y - cy) * down.y};
    }
};

/// The linear part by the map's derivative at the piece's centre; the centre of the source where there is
/// none.
template <class Map>
LinearPart linear_part(const Map& map, int piece) {
    const Box box = map.target_pieces()[static_cast<std::size_t>(piece)];
    const Size source = map.source_size();
    LinearPart part{0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1), {}, {}, {}};
    part.origin = {0.5 * source.width, 0.5 * source.height};
    Point<double> centre{};
    int source_piece = 0;
    if (!map.exact(part.cx, part.cy, piece, centre, source_piece)) return part;
    using J = Jet1<double>;
    const Point<J> p = map(J::variable(part.cx, 1, 0), J::variable(part.cy, 0, 1),
                           map.local_around(part.cx, part.cy, piece));
    for (int i = 0; i < J::kSize; ++i)
        if (!std::isfinite(p.x.c[i]) || !std::isfinite(p.y.c[i])) return part;
    part.origin = {p.x.c[0], p.y.c[0]};
    part.right = {p.x.c[1], p.y.c[1]};
    part.down = {p.x.c[2], p.y.c[2]};
    return part;
}

/// The residual (4.4) at a target point, in source pixels: the difference of the map, read around `local`,
/// from its linear part.
template <class Map>
Point<double> residual_at(const Map& map, const LinearPart& linear, const typename Map::Local& local,
                          double x, double y) {
    return map(x, y, local) - linear(x, y);
}

}  // namespace anamorph
