// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/panorama_plan.h"

#include "anamorph/chart/chart_jets.h"
#include "anamorph/panorama/direct_rows.h"
#include "anamorph/panorama/panorama_residual.h"
#include "anamorph/panorama/panorama_rows.h"
#include "anamorph/plan/formula_plan_impl.h"

namespace anamorph {

template class FormulaPlan<Panorama>;

namespace {

/// The orders in which all blocks are read: no formula asks where it is read.
ReadOrders read_orders(const Panorama& map) {
    if (!map.may_be_direct()) return {};
    const Size size = map.target_size();
    const Panorama::Local local = map.local_around(0.5 * size.width, 0.5 * size.height, 0);
    return {simd::direct_order<float>(map.target(), map.source(), local),
            simd::direct_order<double>(map.target(), map.source(), local)};
}

}  // namespace

PanoramaPlan::PanoramaPlan(const Panorama& map, const PlanOptions& options)
    : FormulaPlan(map, options, read_orders(map)) {}

void PanoramaPlan::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    if (block.kind == Block::Kind::computed) return direct_rows(block, begin, end, to);
    if (block.precise || block.kind != Block::Kind::exact)
        return FormulaPlan::exact_rows(block, begin, end, to);
    simd::ExactRow found;
    const int count = block.box.width();
    for (int row = begin; row < end; ++row) {
        simd::exact_row(map().target(), map().source(), map().turn(), block.piece, block.box.x0 + 0.5,
                        block.box.y0 + row + 0.5, count, found);
        const std::ptrdiff_t at = (row - begin) * to.stride;
        std::copy_n(found.x, count, to.x + at);
        std::copy_n(found.y, count, to.y + at);
        for (int i = 0; i < count; ++i)
            to.piece[at + i] = found.seen[i] != 0 ? static_cast<std::int32_t>(found.piece[i]) : -1;
    }
}

namespace {

/// x of a point, some turns away where the base of its block is.
double beside(const Block& block, double x, int period) {
    return period > 0 ? x - std::round((x - block.base_x) / period) * period : x;
}

}  // namespace

void PanoramaPlan::direct_rows(const Block& block, int begin, int end, const DoubleRows& to) const {
    const NearBlock<Panorama::Local, double> near = near_in_double(block);
    const Point<double> middle{beside(block, near.middle.x, map().period()), near.middle.y};
    const simd::DirectBlock<double> at{map().target(),    map().source(),     near.place, near.bases,
                                       block.box.width(), block.box.height(), middle};
    for (int row = begin; row < end; ++row) {
        const std::ptrdiff_t k = (row - begin) * to.stride;
        simd::direct_row(at, row, to.x + k, to.y + k);
        std::fill_n(to.piece + k, block.box.width(), block.source_piece);
    }
}

/// Reads a part of a block, counted from its corner.
void PanoramaPlan::direct_rows(const Block& block, const Box& part, const PointRows& to) const {
    const NearBlock<Panorama::Local, float> near = near_in_float(block);
    const Point<float> middle{static_cast<float>(beside(block, near.middle.x, map().period()) - block.base_x),
                              static_cast<float>(near.middle.y - block.base_y)};
    simd::direct_rows({map().target(), map().source(), near.place, near.bases, block.box.width(),
                       block.box.height(), middle},
                      part, to);
}
void PanoramaPlan::computed_row(const Block& block, int row, int begin, int end, float* x,
                                float* y) const noexcept {
    direct_rows(block, {begin, row, end, row + 1}, {x, y, 0});
}
void PanoramaPlan::computed(std::span<const Block> layers, const PointRows* to) const noexcept {
    direct_rows(layers[0], {0, 0, layers[0].box.width(), layers[0].box.height()}, to[0]);
}

}  // namespace anamorph
