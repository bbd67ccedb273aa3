// SPDX-License-Identifier: Apache-2.0
#include "anamorph/formula/pushed_plan.h"

#include "anamorph/plan/formula_plan_impl.h"

namespace anamorph {

template class FormulaPlan<PushedMap>;

Jacobian PushedPlan::jacobian(double x, double y, int) const noexcept {
    const Preimages all = map().preimages(x, y);
    if (all.count == 0) return {};
    const Matrix2 inverse = map().formula().derivative(all.best.at).inverse();
    return {inverse.a11, inverse.a21, inverse.a12, inverse.a22};
}

}  // namespace anamorph
