// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/formula_view_plan.h"

#include "anamorph/chart/chart_jets.h"
#include "anamorph/plan/formula_plan_impl.h"

namespace anamorph {

template class FormulaPlan<FormulaView>;

void FormulaViewPlan::exact_rows(const Block& block, int begin, int end,
                                 const DoubleRows& to) const noexcept {
    if (block.precise || block.kind != Block::Kind::exact)
        return FormulaPlan::exact_rows(block, begin, end, to);
    for (int row = begin; row < end; ++row) {
        const std::ptrdiff_t at = (row - begin) * to.stride;
        map().exact_row(block.box.x0 + 0.5, block.box.y0 + row + 0.5, block.box.width(), to.x + at, to.y + at,
                        to.piece + at);
    }
}

}  // namespace anamorph
