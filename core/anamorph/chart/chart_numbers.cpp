// SPDX-License-Identifier: Apache-2.0
// The numbers of pixels; those that stand for many at once have files of their own, chart_bounds.cpp and chart_near.cpp.
#include "anamorph/chart/chart_numbers.h"

#include "anamorph/chart/chart_formulas.h"
#include "anamorph/chart/chart_glsl.h"

namespace anamorph {

template <>
GlslNumber lens_formula::radial_root(const LensTerms& lens, const GlslNumber& value) {
    constexpr int kSteps = 10;
    const GlslNumber goal = min(value, GlslNumber(lens.value_end));
    GlslNumber low = 0, high = lens.end, t = min(near_root(lens, goal), high);
    for (int i = 0; i < kSteps; ++i) {
        const auto at = radial_at(lens, Series<GlslNumber, 1>::variable(t));
        const GlslNumber off = at.c[0] - goal, step = t - off / at.c[1];
        const GlslCondition below = is_negative(off);
        low = select(below, t, low);
        high = select(below, high, t);
        t = min(max(step, low), high);
    }
    return t;
}

ANAMORPH_CHART_NUMBERS()
template Point<GlslJet> Chart::local_point(const Ray<GlslJet>&, const Branch&) const;
template GlslNumber Chart::sees(const Ray<GlslNumber>&, int) const;

}  // namespace anamorph
