// SPDX-License-Identifier: Apache-2.0
#include "anamorph/formula/text_plan.h"

#include "anamorph/formula/text_rows.h"
#include "anamorph/plan/formula_plan_impl.h"
#include "anamorph/plan/vector_rows.h"

namespace anamorph {

template class FormulaPlan<TextMap>;

TextPlan::TextPlan(const TextMap& map, const PlanOptions& options)
    : FormulaPlan(map, options, {TextMap::kReadInSteps, TextMap::kReadInSteps}) {}

void TextPlan::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    if (block.kind == Block::Kind::computed) {
        const NearBlock<TextMap::Local, double> near = near_in_double(block);
        const simd::TextBlock<double> at{map().program(),   map().scale(),      near.bases,
                                         block.box.width(), block.box.height(), near.middle};
        for (int row = begin; row < end; ++row) {
            const std::ptrdiff_t k = (row - begin) * to.stride;
            simd::text_row(at, row, to.x + k, to.y + k);
            std::fill_n(to.piece + k, block.box.width(), block.source_piece);
        }
        return;
    }
    if (block.precise || block.kind != Block::Kind::exact)
        return FormulaPlan::exact_rows(block, begin, end, to);
    exact_rows_by_vectors(map(), block, begin, end, to);
}

/// Reads a part of a block, counted from its corner.
void TextPlan::direct_rows(const Block& block, const Box& part, const PointRows& to) const {
    const NearBlock<TextMap::Local, float> near = near_in_float(block);
    const Point<float> middle{static_cast<float>(near.middle.x - block.base_x),
                              static_cast<float>(near.middle.y - block.base_y)};
    simd::text_rows(
        {map().program(), map().scale(), near.bases, block.box.width(), block.box.height(), middle}, part,
        to);
}
void TextPlan::computed_row(const Block& block, int row, int begin, int end, float* x,
                            float* y) const noexcept {
    direct_rows(block, {begin, row, end, row + 1}, {x, y, 0});
}
void TextPlan::computed(std::span<const Block> layers, const PointRows* to) const noexcept {
    direct_rows(layers[0], {0, 0, layers[0].box.width(), layers[0].box.height()}, to[0]);
}

}  // namespace anamorph
