// SPDX-License-Identifier: Apache-2.0
// Texts read near the middles of blocks (number/near.h).
#include <algorithm>
#include <cmath>

#include "anamorph/formula/text_map.h"
#include "anamorph/number/hypot.h"
#include "anamorph/plan/near_pixels.h"

namespace anamorph {

// What programs ask of numbers beyond what other formulas do, for read_program() to find.

/// A choice that is not the same for all pixels has no bound.
template <class Real>
NearBound<Real> choose(const NearCondition<WrittenBase::Decision, Certainty>& where, const NearBound<Real>& a,
                       const NearBound<Real>& b) {
    NearBound<Real> chosen = select(where, a, b);
    if (where.rest == Certainty::open) chosen.rest = RestBound<Real>::unbounded();
    return chosen;
}
/// Near another, an angle goes on beyond half a turn, where a text's jumps.
template <class Real>
NearBound<Real> angle_of(const NearBound<Real>& y, const NearBound<Real>& x) {
    const auto all = [](const NearBound<Real>& a) {
        const double off = a.rest.radius + a.rest.error;
        return Interval(a.base.value) + Interval(a.rest.middle) + Interval(-off, off);
    };
    NearBound<Real> angle = atan2(y, x);
    if (program_detail::may_jump(all(y), all(x))) angle.rest = RestBound<Real>::unbounded();
    return angle;
}
// No block is read with these: may_be_direct().
template <class Real>
NearBound<Real> exp(const NearBound<Real>& a) {
    return {a.base, RestBound<Real>::unbounded()};
}
template <class Real>
NearBound<Real> log(const NearBound<Real>& a) {
    return exp(a);
}
template <class Real>
NearBound<Real> floor_of(const NearBound<Real>& a) {
    return exp(a);
}

bool TextMap::may_be_direct() const {
    return std::none_of(
        m_formula.point.steps.begin(), m_formula.point.steps.end(), [](const ProgramStep& step) {
            return step.kind == StepKind::exp || step.kind == StepKind::log || step.kind == StepKind::floor;
        });
}

template <class Real>
NearReading TextMap::direct(double x, double y, double half_width, double half_height, const Local&,
                            Bases& bases) const {
    BaseWriter writer{bases, {}};
    WrittenBase::to = &writer;
    const Point<NearBound<Real>> pixels = pixels_near<Real>(x, y, half_width, half_height);
    const Point<NearBound<Real>> p = source_point(pixels.x, pixels.y);
    WrittenBase::to = nullptr;
    return {{p.x.base.value, p.y.base.value},
            hypot(drawn_error(p.x, 0), drawn_error(p.y, 0)) * rounded_detail::kUp,
            kReadInSteps};
}

template NearReading TextMap::direct<float>(double, double, double, double, const Local&, Bases&) const;
template NearReading TextMap::direct<double>(double, double, double, double, const Local&, Bases&) const;

}  // namespace anamorph
