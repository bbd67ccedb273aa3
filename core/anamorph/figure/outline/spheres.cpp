// SPDX-License-Identifier: Apache-2.0
// With X = x a / sqrt(a^2 - c^2) and Y = y b / sqrt(b^2 - c^2) for a centre (x, y) on the medial surface:
//
//     r^2 = c^2 (1 - X^2/a^2 - Y^2/b^2),   |X, Y| in the ellipse with half-axes sqrt(a^2 - c^2), sqrt(b^2 -
//     c^2)
//
// and where q is the surface point that the sphere about one centre touches, its distance from another centre
// satisfies |q - center'|^2 = r'^2 + d^2, with d the distance of the two in (X, Y): q lies
// sqrt(r'^2 + d^2) - r' outside that sphere, which is at most tol where d^2 <= tol^2 + 2 tol r'.
#include "anamorph/figure/outline/spheres.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "anamorph/figure/outline/outline_body.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::figure {
namespace {

class Fill {
  public:
    Fill(const Ellipsoid& body, double tol, std::size_t most) : m_body(body), m_tol(tol), m_most(most) {
        std::sort(m_order.begin(), m_order.end(),
                  [&](int i, int j) { return std::fabs(body.axes[i]) > std::fabs(body.axes[j]); });
        m_a = std::fabs(body.axes[m_order[0]]);
        m_b = std::fabs(body.axes[m_order[1]]);
        m_c = std::fabs(body.axes[m_order[2]]);
        m_wide = std::sqrt((m_a - m_c) * (m_a + m_c));
        m_high = std::sqrt((m_b - m_c) * (m_b + m_c));
    }

    /// False when there would be too many.
    bool place(std::vector<Sphere>& spheres) {
        spheres.clear();
        const double least_reach = reach(m_a > 0 ? m_c * m_c / m_a : 0);
        const bool one_row = m_high <= 0.5 * least_reach;
        const double rows = one_row ? 1 : std::ceil(2 * m_high / least_reach);
        if (!(rows <= static_cast<double>(m_most))) return false;
        const double half = m_high / rows;
        for (double k = 0; k < rows; ++k) {
            const double y = (2 * k + 1 - rows) * half;
            if (!place_row(y, half, spheres)) return false;
        }
        return one_row || place_rim(least_reach, spheres);
    }

  private:
    double reach(double radius) const { return std::sqrt(m_tol * (m_tol + 2 * radius)); }
    double square_of(double part, double whole) const {
        return whole > 0 ? (part / whole) * (part / whole) : 0;
    }
    double radius(double x, double y) const {
        return m_c * std::sqrt(std::max(0.0, 1 - square_of(x, m_a) - square_of(y, m_b)));
    }

    bool add(double x, double y, std::vector<Sphere>& spheres) const {
        if (spheres.size() >= m_most) return false;
        const double along = m_a > 0 ? x * m_wide / m_a : 0, across = m_b > 0 ? y * m_high / m_b : 0;
        spheres.push_back(
            {m_body.center + m_body.rotation[m_order[0]] * along + m_body.rotation[m_order[1]] * across,
             radius(x, y)});
        return true;
    }

    /// Spheres at height y, from the middle out, that serve all centres up to `half` above and below.
    bool place_row(double y, double half, std::vector<Sphere>& spheres) const {
        const double end = m_wide * std::sqrt(std::max(0.0, 1 - square_of(y, m_high)));
        const auto serves = [&](double x) {
            const double r = reach(radius(x, y));
            return std::sqrt(std::max(0.0, (r - half) * (r + half)));
        };
        if (!add(0, y, spheres)) return false;
        for (double served = serves(0); served < end;) {
            // The farthest centre that serves from there on: x - serves(x) grows with x.
            double low = served, high = end;
            if (high - serves(high) > served)
                for (int k = 0; k < 60; ++k) {
                    const double middle = 0.5 * (low + high);
                    (middle - serves(middle) > served ? high : low) = middle;
                }
            else
                low = high;
            if (!add(low, y, spheres) || !add(-low, y, spheres)) return false;
            served = low < end ? low + serves(low) : end;
        }
        return true;
    }

    /// What rows leave out at their ends is at most half a row's height from the rim.
    bool place_rim(double spacing, std::vector<Sphere>& spheres) const {
        const double count = std::ceil(2 * std::numbers::pi * m_wide / spacing);
        if (!(count <= static_cast<double>(m_most))) return false;
        for (double k = 0; k < count; ++k) {
            const double t = 2 * std::numbers::pi * k / count;
            if (!add(m_wide * std::cos(t), m_high * std::sin(t), spheres)) return false;
        }
        return true;
    }

    const Ellipsoid& m_body;
    double m_tol;
    std::size_t m_most;
    std::array<int, 3> m_order{0, 1, 2};
    double m_a = 0, m_b = 0, m_c = 0;
    double m_wide = 0, m_high = 0;  ///< half-axes of the centres' ellipse in (X, Y)
};

}  // namespace

SphereFill fill_with_spheres(const Ellipsoid& body, const SphereOptions& options) {
    check(body, 0, {});
    kSphereTolRow.check(options.tol, "tol");
    if (options.most_spheres < 1)
        throw Error("most_spheres", std::to_string(options.most_spheres), "must be an integer of at least 1");
    SphereFill fill;
    // Doubles place no surface better, and the smallest of them does not grow.
    const double largest =
        std::max({std::fabs(body.axes[0]), std::fabs(body.axes[1]), std::fabs(body.axes[2])});
    fill.deviation = std::max({options.tol, 0x1p-53 * largest, std::numeric_limits<double>::min()});
    while (!Fill(body, fill.deviation, static_cast<std::size_t>(options.most_spheres)).place(fill.spheres))
        fill.deviation *= 1.25;
    return fill;
}

}  // namespace anamorph::figure
