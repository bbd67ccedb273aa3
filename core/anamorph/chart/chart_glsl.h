// SPDX-License-Identifier: Apache-2.0
// The formulas of charts and lenses written as GLSL: compiled once, in chart_numbers.cpp.
#pragma once

#include "anamorph/chart/chart_numbers.h"
#include "anamorph/number/glsl_number.h"

namespace anamorph {

/// radial_root() by a fixed number of Newton's steps, which stay in a bracket.
template <>
GlslNumber lens_formula::radial_root(const LensTerms& lens, const GlslNumber& value);

using GlslJet = Jet1<GlslNumber>;

extern template Point<GlslJet> Chart::local_point(const Ray<GlslJet>&, const Branch&) const;
extern template GlslNumber Chart::sees(const Ray<GlslNumber>&, int) const;

}  // namespace anamorph
