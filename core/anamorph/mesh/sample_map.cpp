// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/sample_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anamorph/plan/block_writer.h"

namespace anamorph {
namespace {

// The part of the tolerance that a cubic may be off the samples' map.
constexpr double kShare = 0.5;
// Cubics are fitted to so many samples each way, or one more.
constexpr int kFitted = 8;

/// The values of the ten monomials of a cubic, in the order of Jet.
std::array<double, 10> monomials(double s, double t) {
    return {1, s, t, s * s, s * t, t * t, s * s * s, s * s * t, s * t * t, t * t * t};
}

/// The least-squares fit of cubics to values at fixed places.
class CubicFit {
  public:
    explicit CubicFit(int window) {
        const int step = window / kFitted;
        for (int j = step / 2; j < window; j += step)
            for (int i = step / 2; i < window; i += step) {
                m_places.push_back({i, j});
                m_monomials.push_back(monomials(place(i, window), place(j, window)));
            }
        std::array<std::array<double, 20>, 10> rows{};
        for (std::size_t a = 0; a < 10; ++a) {
            rows[a][10 + a] = 1;
            for (std::size_t b = 0; b < 10; ++b)
                for (const auto& m : m_monomials) rows[a][b] += m[a] * m[b];
        }
        // Gauss and Jordan; the matrix is positive definite.
        for (std::size_t k = 0; k < 10; ++k) {
            const double pivot = rows[k][k];
            for (double& v : rows[k]) v /= pivot;
            for (std::size_t a = 0; a < 10; ++a) {
                const double factor = rows[a][k];
                for (std::size_t b = 0; a != k && b < 20; ++b) rows[a][b] -= factor * rows[k][b];
            }
        }
        for (std::size_t a = 0; a < 10; ++a)
            for (std::size_t b = 0; b < 10; ++b) m_inverse[a][b] = rows[a][10 + b];
    }

    /// Where sample i of a window lies, from -1 to 1 over all of it.
    static double place(int i, int window) { return (2 * i - (window - 1)) / static_cast<double>(window); }

    /// The coefficients for value(i, j) at the samples of a window.
    template <class Value>
    void fit(const Value& value, double* x, double* y) const {
        std::array<double, 10> sum_x{}, sum_y{};
        for (std::size_t n = 0; n < m_places.size(); ++n) {
            const Point<double> v = value(m_places[n].x, m_places[n].y);
            for (std::size_t a = 0; a < 10; ++a) {
                sum_x[a] += v.x * m_monomials[n][a];
                sum_y[a] += v.y * m_monomials[n][a];
            }
        }
        for (std::size_t a = 0; a < 10; ++a) {
            x[a] = y[a] = 0;
            for (std::size_t b = 0; b < 10; ++b) {
                x[a] += m_inverse[a][b] * sum_x[b];
                y[a] += m_inverse[a][b] * sum_y[b];
            }
        }
    }

  private:
    std::vector<Point<int>> m_places;
    std::vector<std::array<double, 10>> m_monomials;
    std::array<std::array<double, 10>, 10> m_inverse{};
};

}  // namespace

SampleMap::SampleMap(std::shared_ptr<const StLattice> lattice, double tol)
    : m_lattice(std::move(lattice)), m_tol(tol) {
    const Size& size = m_lattice->target();
    for (const Layout& layout : kLayouts) {
        if (size.width < layout.window || size.height < layout.window) continue;
        m_windows = windows_of(layout);
        m_is_smooth = most_serve();
        if (m_is_smooth) return;
    }
}

std::shared_ptr<SampleMap::Windows> SampleMap::windows_of(const Layout& layout) const {
    const auto count = [&](int side) { return (side - layout.window + layout.step - 1) / layout.step + 1; };
    const int columns = count(m_lattice->target().width), rows = count(m_lattice->target().height);
    const auto all = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    return std::make_shared<Windows>(Windows{layout, columns, rows, std::vector<Window>(all)});
}

bool SampleMap::most_serve() const {
    constexpr int kTried = 8;
    int serving = 0;
    for (int j = 0; j < kTried; ++j)
        for (int i = 0; i < kTried; ++i)
            serving += window((2 * i + 1) * m_windows->columns / (2 * kTried),
                              (2 * j + 1) * m_windows->rows / (2 * kTried))
                           .serves();
    return 2 * serving >= kTried * kTried;
}

SampleMap::Local SampleMap::fitted(int first_column, int first_row) const {
    static const CubicFit fits[] = {CubicFit(kLayouts[0].window), CubicFit(kLayouts[1].window)};
    const int window = m_windows->layout.window;
    const CubicFit& fit = window == kLayouts[0].window ? fits[0] : fits[1];
    const auto sample = [&](int i, int j) { return m_lattice->point(first_column + i, first_row + j); };
    Local local{Interval(1, 0),
                Interval(1, 0),
                {first_column + 0.5 * window, first_row + 0.5 * window},
                2.0 / window};
    fit.fit(sample, local.cx, local.cy);
    // The farthest that samples are off, row by row; along a row a cubic is one of s.
    constexpr int kMost = kLayouts[0].window;
    double at_x[kMost], at_y[kMost], off_x = 0, off_y = 0;
    for (int j = 0; j < window; ++j) {
        const double t = CubicFit::place(j, window);
        m_lattice->points(first_column, first_row + j, window, at_x, at_y);
        const auto subtract = [&](const double* c, double* at) {
            const double c0 = c[0] + t * (c[2] + t * (c[5] + t * c[9])), c1 = c[1] + t * (c[4] + t * c[8]),
                         c2 = c[3] + t * c[7], c3 = c[6];
            for (int i = 0; i < window; ++i) {
                const double s = CubicFit::place(i, window);
                at[i] = std::fabs(c0 + s * (c1 + s * (c2 + s * c3)) - at[i]);
            }
        };
        subtract(local.cx, at_x);
        subtract(local.cy, at_y);
        // The largest, four by four; a hole makes the sum no number.
        const auto most = [&](const double* at) {
            double largest[4] = {}, sum = 0;
            for (int i = 0; i + 4 <= window; i += 4)
                for (int k = 0; k < 4; ++k) {
                    largest[k] = at[i + k] > largest[k] ? at[i + k] : largest[k];
                    sum += at[i + k];
                }
            return std::isnan(sum) ? HUGE_VAL : std::max({largest[0], largest[1], largest[2], largest[3]});
        };
        off_x = std::max(off_x, most(at_x));
        off_y = std::max(off_y, most(at_y));
    }
    // A cubic's coefficients are those of units of half a window. What double rounds of the cubic, here and where it is read:
    // less than 64 units of its size, and that of the samples.
    const double cubed = local.unit * local.unit * local.unit;
    const auto error_of = [&](double residual, const double* c) {
        double size = 0;
        for (int k = 0; k < 10; ++k) size += std::fabs(c[k]);
        return 1.5625 * (residual + m_lattice->rounding()) +
               0.0963 * cubed * (std::fabs(c[6]) + std::fabs(c[9])) + 0x1p-47 * size;
    };
    const double error =
        std::hypot(error_of(off_x, local.cx), error_of(off_y, local.cy)) * rounded_detail::kUp;
    if (!(error <= kShare * m_tol)) return local;
    local.error = error;
    // Cells in which all four lines are samples of the window.
    local.x = {first_column + 1.5, first_column + window - 1.5};
    local.y = {first_row + 1.5, first_row + window - 1.5};
    return local;
}

const SampleMap::Local& SampleMap::window(int column, int row) const {
    // That of number i has its middle `step` (i + 1) samples from the edge, as blocks have.
    const Layout& layout = m_windows->layout;
    const auto first = [&](int number, int side) {
        return std::clamp(layout.step * (number + 1) - layout.window / 2, 0, side - layout.window);
    };
    const Size& size = m_lattice->target();
    Window& window = m_windows->all[static_cast<std::size_t>(row * m_windows->columns + column)];
    std::call_once(window.once,
                   [&] { window.local = fitted(first(column, size.width), first(row, size.height)); });
    return window.local;
}

SampleMap::Local SampleMap::local_around(double x, double y, int) const {
    if (m_windows) {
        const auto nearest = [step = m_windows->layout.step](double at, int count) {
            return static_cast<int>(std::clamp(std::floor(at / step - 0.5), 0.0, count - 1.0));
        };
        const Local& near = window(nearest(x, m_windows->columns), nearest(y, m_windows->rows));
        if (near.serves()) return near;
    }
    Local local{Interval(1, 0), Interval(1, 0), {x, y}};
    const LatticeWeights across = m_lattice->across(x), down = m_lattice->down(y);
    const Point<double> at = m_lattice->at(x, y);
    const Jacobian j = m_lattice->jacobian(across, down);
    local.cx[0] = at.x, local.cx[1] = j.x_i, local.cx[2] = j.x_j;
    local.cy[0] = at.y, local.cy[1] = j.y_i, local.cy[2] = j.y_j;
    return local;
}

Cover SampleMap::cover(const Interval& x, const Interval& y, int, const Local& local, bool) const {
    const auto holds = [](const Interval& all, const Interval& part) {
        return part.lo >= all.lo && part.hi <= all.hi;
    };
    if (!holds(local.x, x) || !holds(local.y, y)) return Cover::mixed;
    const Point<Interval> p = (*this)(x, y, local);
    return is_near({magnitude(p.x), magnitude(p.y)}) ? Cover::inside : Cover::mixed;
}

Point<Interval> SampleMap::operator()(const Interval& x, const Interval& y, const Local& local) const {
    const Point<Interval> p = cubic(x, y, local);
    const Interval error(-local.error, local.error);
    return {p.x + error, p.y + error};
}

Point<Rounded<double>> SampleMap::operator()(const Rounded<double>& x, const Rounded<double>& y,
                                             const Local& local) const {
    Point<Rounded<double>> p = cubic(x, y, local);
    p.x.error += local.error;
    p.y.error += local.error;
    return p;
}

bool SampleMap::is_near(const Point<double>& p) {
    return std::fabs(p.x) < kFarthest && std::fabs(p.y) < kFarthest;
}

std::optional<Point<Interval>> SampleMap::displacements(const Interval& x, const Interval& y) const {
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
std::optional<Point<Interval>> SampleMap::points_of(const Interval& x, const Interval& y) const {
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
double SampleMap::exact_error(const Interval& x, const Interval& y, double off) const {
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
