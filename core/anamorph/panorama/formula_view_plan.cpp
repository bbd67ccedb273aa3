// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/formula_view_plan.h"

#include "anamorph/chart/chart_jets.h"
#include "anamorph/plan/formula_plan_impl.h"
#include "anamorph/plan/vector_rows.h"

namespace anamorph {

template class FormulaPlan<FormulaView>;

void FormulaViewPlan::exact_rows(const Block& block, int begin, int end,
                                 const DoubleRows& to) const noexcept {
    if (block.precise || block.kind != Block::Kind::exact)
        return FormulaPlan::exact_rows(block, begin, end, to);
    exact_rows_by_vectors(map(), block, begin, end, to);
}

}  // namespace anamorph
