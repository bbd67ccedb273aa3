// SPDX-License-Identifier: Apache-2.0
#include "anamorph/lens/lens_map.h"

#include <algorithm>
#include <cmath>

#include "anamorph/error.h"

namespace anamorph {
namespace {

/// No less than the largest magnitude of a function of [-1, 1], nor more by more than `slack`: `of` encloses it over
/// an interval.
template <class Of>
double largest_magnitude(const Of& of, double slack) {
    constexpr int kDeepest = 40;
    double reached = 0, bound = 0;
    const auto search = [&](const auto& self, const Interval& s, int depth) -> void {
        const double most = magnitude(of(s));
        if (most <= reached + slack || depth == kDeepest || !(most < HUGE_VAL)) {
            bound = std::max(bound, most);
            return;
        }
        const double middle = 0.5 * (s.lo + s.hi);
        const Interval there = of(Interval(middle));
        reached = std::max({reached, there.lo, -there.hi});
        self(self, {s.lo, middle}, depth + 1);
        self(self, {middle, s.hi}, depth + 1);
    };
    search(search, {-1, 1}, 0);
    return bound;
}

/// The side with as many pixels more or fewer at both ends as hold what lies up to `half` pixels from the
/// middle.
int widened(int side, double half) {
    // A hair that rounding adds is no pixel.
    const double more = std::ceil(half - 0.5 * side - 1e-6);
    return static_cast<int>(std::clamp(side + 2 * more, 1.0, 1e9));
}

}  // namespace

LensMap::LensMap(const Chart& observed, LensMode mode, const Size& covered, const Size& target,
                 const Size& source)
    : PlaneMap(target, source),
      m_observed(observed),
      m_mode(mode),
      m_scale_x(observed.pixels_per_unit()),
      m_scale_y(observed.pixels_per_unit_down()) {
    if (!observed.lens()) throw Error("lens", "none", "must be a lens");
    const auto stretched = [](const Constant& per, int shown, int pixels) {
        return shown == pixels ? per : Constant(per.precise() * shown / pixels);
    };
    m_per_x = stretched(observed.units_per_pixel(), covered.width, target.width);
    m_per_y = stretched(observed.units_per_pixel_down(), covered.height, target.height);
}

Size LensMap::covering(const Chart& observed, LensMode mode, const Size& size) {
    // A lens takes what it maps one to one, so a picture's outline goes to that of what it becomes, or where the lens
    // ends within the picture, its end does: in the direction of a side that lies beyond it, to the end itself.
    constexpr double kSlack = 1e-3;  // pixels
    const Lens& lens = *observed.lens();
    const LensTerms& terms = lens.terms();
    const bool undistort = mode == LensMode::undistort;
    const double half_width = 0.5 * size.width * observed.units_per_pixel().value(),
                 half_height = 0.5 * size.height * observed.units_per_pixel_down().value();
    const double end = undistort ? terms.ideal_end * terms.unit.value() : lens.reach();
    const double end_across = (end + std::fabs(terms.shift_x.value())) * observed.scale_x(),
                 end_down = (end + std::fabs(terms.shift_y.value())) * observed.scale_y();
    const Point<Interval> shift{terms.shift_x.as<Interval>(), terms.shift_y.as<Interval>()};
    double across = 0, down = 0;
    for (const double side : {-1.0, 1.0})
        for (const bool upright : {false, true}) {
            const auto place = [&](const Interval& s) {
                const Point<Interval> p = upright
                                              ? Point<Interval>{Interval(side * half_width), s * half_height}
                                              : Point<Interval>{s * half_width, Interval(side * half_height)};
                return undistort ? p : Point<Interval>{p.x - shift.x, p.y - shift.y};
            };
            const auto beyond = [&](const Point<Interval>& p) {
                return (undistort ? lens.inside(p) : lens.sees(p)).hi < 0;
            };
            const auto on_side = [&](const Interval& s) {
                const Point<Interval> p = place(s);
                if (beyond(p)) return Point<Interval>{Interval(0), Interval(0)};
                if (!undistort) return lens.observed(p);
                const Point<Interval> q = lens.ideal(p);
                return Point<Interval>{q.x + shift.x, q.y + shift.y};
            };
            const auto x = [&](const Interval& s) { return on_side(s).x * observed.scale_x(); };
            const auto y = [&](const Interval& s) { return on_side(s).y * observed.scale_y(); };
            across = std::max(across, largest_magnitude(x, kSlack));
            down = std::max(down, largest_magnitude(y, kSlack));
            if (beyond(place({-1, 1}))) {
                double& reach = upright ? across : down;
                reach = std::max(reach, upright ? end_across : end_down);
            }
        }
    return {widened(size.width, std::min(across, end_across)),
            widened(size.height, std::min(down, end_down))};
}

}  // namespace anamorph
