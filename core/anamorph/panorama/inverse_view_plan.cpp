// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/inverse_view_plan.h"

#include "anamorph/chart/chart_jets.h"
#include "anamorph/plan/formula_plan_impl.h"

namespace anamorph {

template class FormulaPlan<InverseView>;

Jacobian InverseViewPlan::jacobian(double x, double y, int piece) const noexcept {
    Point<double> point{};
    return map().exact(x, y, piece, point, piece) ? FormulaPlan::jacobian(x, y, 0) : Jacobian{};
}

}  // namespace anamorph
