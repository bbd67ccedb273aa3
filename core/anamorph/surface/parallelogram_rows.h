// SPDX-License-Identifier: Apache-2.0
// Parallelograms with linear maps, drawn to planes of points one over the other (Oka 1987, eq. 2.12).
#pragma once

#include <cstddef>
#include <cstdint>

#include "anamorph/geometry/box.h"
#include "anamorph/surface/facet_rows.h"

namespace anamorph::surface::simd {

/// A block of a picture on the screen.
struct Parallelogram {
    double x, y, z;             ///< the centre, pixels from the middle of the screen, and the depth there
    double u_x, u_y, v_x, v_y;  ///< what u and v gain from pixel to pixel
    double z_u, z_v;            ///< what the depth gains by u and by v
    std::int32_t column, row;   ///< column and row of the block
    std::int32_t level;         ///< of a part of a block, how often it was halved; else 0
    Box pixels;                 ///< pixels of the screen that it may cover
};

/// The grid of all blocks: they have their centres at ((column + 1/2) side_u, (row + 1/2) side_v), reach as
/// far as half_u and half_v from there, but not beyond 0 to 1.
struct ParallelogramGrid {
    double side_u, side_v, half_u, half_v;

    /// The grid of blocks that are halved `level` times, which reach over their edges as far as the whole ones.
    ParallelogramGrid at(int level) const {
        const double part = 1 / static_cast<double>(std::int64_t{1} << level);
        return {side_u * part, side_v * part, half_u - (1 - part) * side_u / 2,
                half_v - (1 - part) * side_v / 2};
    }
};

/// The pixels of a box of a screen of width x height, whose side is 1 / `times` of those of the screen.
struct ParallelogramView {
    Box box;
    int width, height, times;
};

/// Draws the `count` of `all` that `list` names: point and id (twice the number in `all`) at the pixels whose centres lie
/// within, each over those before it or, if `by_depth`, where its depth there, linear, is less: the nearness is less the
/// depth, and is only then read and written. The planes begin at the box's first pixel. The same bits for every box and on
/// all instruction sets.
void draw_parallelograms(const Parallelogram* all, const std::uint32_t* list, std::size_t count,
                         const ParallelogramGrid& grid, const ParallelogramView& view, bool by_depth,
                         const FacetPlanes& to);

}  // namespace anamorph::surface::simd
