// SPDX-License-Identifier: Apache-2.0
#include "anamorph/approx/panorama_plan.h"

#include "anamorph/approx/formula_planner.h"
#include "anamorph/simd/direct_rows.h"
#include "anamorph/simd/panorama_rows.h"

namespace anamorph {

template class FormulaPlan<Panorama>;

void PanoramaPlan::exact_row(const Block& block, int row, ExactPoint* points) const noexcept {
    if (block.precise) return FormulaPlan::exact_row(block, row, points);
    simd::ExactRow found;
    const int count = block.box.width();
    simd::exact_row(map().target(), map().source(), map().turn(), block.piece, block.box.x0 + 0.5,
                    block.box.y0 + row + 0.5, count, found);
    for (int i = 0; i < count; ++i)
        points[i] = {{found.x[i], found.y[i]}, static_cast<int>(found.piece[i]), found.seen[i] != 0};
}

/// Of a part of a block, counted from its corner.
void PanoramaPlan::direct_rows(const Block& block, const Box& part, const PointRows& to) const {
    const Box& box = block.box;
    const Panorama::Local& local = place_of(block);
    const Panorama::Direct direct = map().direct(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1), local);
    // The block's base may be some turns away.
    const int period = map().period();
    const double off = direct.middle.x - block.base_x,
                 turns = period > 0 ? std::round(off / period) * period : 0;
    const Point<float> middle{static_cast<float>(off - turns),
                              static_cast<float>(direct.middle.y - block.base_y)};
    simd::direct_rows(
        {map().target(), map().source(), local, direct.bases, box.width(), box.height(), middle}, part, to);
}
void PanoramaPlan::computed_row(const Block& block, int row, int begin, int end, float* x,
                                float* y) const noexcept {
    direct_rows(block, {begin, row, end, row + 1}, {x, y, 0});
}
void PanoramaPlan::computed(std::span<const Block> layers, const PointRows* to) const noexcept {
    direct_rows(layers[0], {0, 0, layers[0].box.width(), layers[0].box.height()}, to[0]);
}

}  // namespace anamorph
