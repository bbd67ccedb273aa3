// SPDX-License-Identifier: Apache-2.0
// The blocks of a panorama's picture whose projection is text, the other way.
#pragma once

#include "anamorph/panorama/inverse_view.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

extern template class FormulaPlan<InverseView>;

class InverseViewPlan final : public FormulaPlan<InverseView> {
  public:
    using FormulaPlan::FormulaPlan;

    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    /// Points are searched for, and may jump from sheet to sheet.
    bool is_smooth_in_pixels() const noexcept override { return false; }
};

}  // namespace anamorph
