// SPDX-License-Identifier: Apache-2.0
// Iterations of lenses (chart/lens_formula.h) for four values at once, each as if it were alone: the same bits on every
// instruction set.
#pragma once

#include "anamorph/chart/lens.h"
#include "anamorph/number/jets.h"

namespace anamorph::simd {

/// shrink_series() of degree 4 about the roots of values.
void shrink_series_of(const LensTerms& lens, const Four<double>& values,
                      Four<double> (&coefficients)[TaylorJets::kDegree + 1]);
/// settled() of points.
void settled_of(const LensTerms& lens, const Point<Four<double>>& v, Point<Four<double>>& u);

}  // namespace anamorph::simd
