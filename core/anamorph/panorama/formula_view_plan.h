// SPDX-License-Identifier: Apache-2.0
// The blocks of a panorama's picture whose rays are text.
#pragma once

#include "anamorph/panorama/formula_view.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

extern template class FormulaPlan<FormulaView>;

class FormulaViewPlan final : public FormulaPlan<FormulaView> {
  public:
    using FormulaPlan::FormulaPlan;

    /// Reads exact pixels by vectors.
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;
};

}  // namespace anamorph
