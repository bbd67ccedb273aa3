// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/st_windows.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anamorph/number/hypot.h"
#include "anamorph/plan/block_writer.h"

namespace anamorph {
namespace {

constexpr int kMost = 260;  // the largest side of a window

}  // namespace

WindowCubic StWindows::cubic_over(const Box& window, double most) const {
    WindowCubic cubic = cubic_about(window);
    const int side = window.width();
    fit_of(window).fit.fit(
        [&](std::size_t n) {
            const Point<int>& at = fit_of(window).pixels[n];
            return m_lattice->point(window.x0 + at.x, window.y0 + at.y);
        },
        cubic);
    // The farthest that samples are off, row by row; along a row a cubic is one of s.
    const auto place = [side](int i) { return (2 * i - (side - 1)) / static_cast<double>(side); };
    double at_x[kMost], at_y[kMost], off_x = 0, off_y = 0;
    for (int j = 0; j < side; ++j) {
        const double t = place(j);
        m_lattice->points(window.x0, window.y0 + j, side, at_x, at_y);
        const auto subtract = [&](const double* c, double* at) {
            const double c0 = c[0] + t * (c[2] + t * (c[5] + t * c[9])), c1 = c[1] + t * (c[4] + t * c[8]),
                         c2 = c[3] + t * c[7], c3 = c[6];
            for (int i = 0; i < side; ++i) {
                const double s = place(i);
                at[i] = std::fabs(c0 + s * (c1 + s * (c2 + s * c3)) - at[i]);
            }
        };
        subtract(cubic.cx, at_x);
        subtract(cubic.cy, at_y);
        // The largest, four by four; a hole makes the sum no number.
        const auto farthest = [&](const double* at) {
            double largest[4] = {}, sum = 0;
            for (int i = 0; i + 4 <= side; i += 4)
                for (int k = 0; k < 4; ++k) {
                    largest[k] = at[i + k] > largest[k] ? at[i + k] : largest[k];
                    sum += at[i + k];
                }
            return std::isnan(sum) ? HUGE_VAL : std::max({largest[0], largest[1], largest[2], largest[3]});
        };
        off_x = std::max(off_x, farthest(at_x));
        off_y = std::max(off_y, farthest(at_y));
        if (!(1.5625 * std::max(off_x, off_y) <= most)) return cubic;
    }
    // A cubic's coefficients are those of units of half a window. What double rounds of the cubic, here and where it is read:
    // less than 64 units of its size, and that of the samples.
    const double cubed = cubic.unit * cubic.unit * cubic.unit;
    const auto error_of = [&](double residual, const double* c) {
        double size = 0;
        for (int k = 0; k < 10; ++k) size += std::fabs(c[k]);
        return 1.5625 * (residual + m_lattice->rounding()) +
               0.0963 * cubed * (std::fabs(c[6]) + std::fabs(c[9])) + 0x1p-47 * size;
    };
    const double error = hypot(error_of(off_x, cubic.cx), error_of(off_y, cubic.cy)) * rounded_detail::kUp;
    if (!(error <= most)) return cubic;
    cubic.error = error;
    // Cells in which all four lines are samples of the window.
    cubic.x = {window.x0 + 1.5, window.x1 - 1.5};
    cubic.y = {window.y0 + 1.5, window.y1 - 1.5};
    return cubic;
}

bool StWindows::exact(double x, double y, Point<double>& p) const {
    p = m_lattice->at(x, y);
    return std::fabs(p.x) < kFarthest && std::fabs(p.y) < kFarthest;
}

Jacobian StWindows::jacobian(double x, double y) const {
    return m_lattice->jacobian(m_lattice->across(x), m_lattice->down(y));
}

std::optional<Point<Interval>> StWindows::displacements(const Interval& x, const Interval& y) const {
    // Two samples either way; at the edges the outermost ones stand in for what is beyond.
    const auto samples = [](const Interval& at, int side) {
        const auto within = [side](double i) { return static_cast<int>(std::clamp(i, 0.0, side - 1.0)); };
        return std::pair(within(std::floor(at.lo - 0.5) - 1), within(std::floor(at.hi - 0.5) + 2));
    };
    const auto [x0, x1] = samples(x, m_lattice->target().width);
    const auto [y0, y1] = samples(y, m_lattice->target().height);
    const Point<double>& scale = m_lattice->scale();
    Point<Interval> all{{HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}};
    const auto add = [](Interval& to, double value) {
        to.lo = std::min(to.lo, value);
        to.hi = std::max(to.hi, value);
    };
    for (int j = y0; j <= y1; ++j)
        for (int i = x0; i <= x1; ++i) {
            const Point<double> at = m_lattice->point(i, j);
            if (std::isnan(at.x + at.y)) return {};
            add(all.x, at.x - (i + 0.5) * scale.x);
            add(all.y, at.y - (j + 0.5) * scale.y);
        }
    return all;
}

/// Weights sum to 1, and their magnitudes along an axis to 1.6 at most (mesh_lattice.h). In an outermost cell the map goes on linearly
/// by the two outermost samples, as both of its slopes are their difference: there they sum to 2 at most. So to 4 at most in all, and a
/// sum is no farther from the middle of a range than twice that, 1.5 times it beyond; rounding is next to nothing.
std::optional<Point<Interval>> StWindows::points_of(const Interval& x, const Interval& y) const {
    const auto moved = displacements(x, y);
    if (!moved) return {};
    const auto widened = [](const Interval& a) {
        const double more = 2.1 * (a.hi - a.lo) + 1e-9 * magnitude(a);
        return a + Interval(-more, more);
    };
    const Point<double>& scale = m_lattice->scale();
    return Point<Interval>{x * Interval(scale.x) + widened(moved->x),
                           y * Interval(scale.y) + widened(moved->y)};
}

/// By the displacements of the samples that count anywhere in a box.
///
/// Rounding, u = 2^-53: the sum 300 u of the displacements' size (mesh_lattice.h, where it is derived), these and the point
/// itself 16 u of the source's; and what the samples' own points are off, times the magnitudes of weights. The outermost lines go
/// on by half of a difference, which in a corner is four times the size of the samples at most.
///
/// Slope. On a cell w wide a function changes by 3/2 of the difference of its values at the ends and by each of its slopes there,
/// over w: slopes are differences over no less than w. Along one axis that is at most 7/2 of the range over w, which is 1; in the
/// outermost cells, of 1/2, the map is linear, and its slope the range at most. The other axis's weights sum to 2 at most. So less than
/// 24 times the range.
double StWindows::exact_error(const Interval& x, const Interval& y, double off) const {
    const Size& size = m_lattice->target();
    if (x.lo == x.hi && y.lo == y.hi && off == 0 && x.lo > 0 && y.lo > 0 && x.lo < size.width &&
        y.lo < size.height && m_lattice->across(x.lo).on_line() && m_lattice->down(y.lo).on_line())
        return m_lattice->rounding();
    const auto moved = displacements(x, y);
    if (!moved) {
        // Within one cell a hole that counts does so everywhere.
        const auto is_in_a_cell = [](const Interval& a) {
            const double cell = std::floor(a.lo - 0.5);
            return a.lo - 0.5 > cell && a.hi - 0.5 < cell + 1;
        };
        return is_in_a_cell(x) && is_in_a_cell(y) ? 0 : HUGE_VAL;
    }
    const Size& source = m_lattice->source();
    const Point<double>& scale = m_lattice->scale();
    const double displaced = 4 * std::max(magnitude(moved->x), magnitude(moved->y));
    const double place = std::max(source.width, source.height) + displaced;
    const double rounding =
        1.4143 * 0x1p-53 * (300 * displaced + 16 * place) + 2.56 * 4 * m_lattice->rounding();
    const double slope =
        std::max(scale.x, scale.y) + 24 * std::max(moved->x.hi - moved->x.lo, moved->y.hi - moved->y.lo);
    return (rounding + 2 * slope * off) * rounded_detail::kUp;
}

}  // namespace anamorph
