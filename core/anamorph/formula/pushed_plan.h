// SPDX-License-Identifier: Apache-2.0
// The blocks of a formula that is text and leads from the source to the target.
#pragma once

#include "anamorph/formula/pushed_map.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

extern template class FormulaPlan<PushedMap>;

class PushedPlan final : public FormulaPlan<PushedMap> {
  public:
    using FormulaPlan::FormulaPlan;

    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    /// Points are searched for, and may jump from sheet to sheet.
    bool is_smooth_in_pixels() const noexcept override { return false; }
};

}  // namespace anamorph
