// SPDX-License-Identifier: Apache-2.0
// The grid of latitude and longitude over an ellipsoid whose triangles are within a tolerance of it.
//
// With the latitude t about the axis y and the longitude p, the surface is f(t, p) = (ax cos t sin p, ay sin t, -az cos t cos p),
// turned and moved. Let n = max(ax, az) and m = max(n, ay). Then |f_tt| <= m, |f_tp| <= n and |f_pp| <= n.
//
// A triangle's corners v_i lie in a cell of h by k of (t, p). At x = sum l_i v_i, l_i >= 0 with the sum 1, the triangle is off
// by e = sum l_i f(v_i) - f(x), and by Taylor's theorem about x
//     |e| <= 1/2 sum l_i (m dt_i^2 + 2 n |dt_i dp_i| + n dp_i^2),  (dt_i, dp_i) = v_i - x.
// The sums of l_i dt_i^2 and of l_i dp_i^2 are variances of numbers in ranges of h and k, h^2 / 4 and k^2 / 4 at most (Popoviciu), that
// of the product at most the root of both (Cauchy and Schwarz): |e| <= (m h^2 + 2 n h k + n k^2) / 8. So it is where a cell
// ends in a pole, which has every longitude.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>
#include <optional>

namespace anamorph::figure {

/// The most steps either way.
inline constexpr int kMostSurfaceSteps = 1 << 12;

/// Cells from pole to pole and around, and how far any triangle whose corners are those of a cell may be off, in the
/// units of the axes.
struct SurfaceSteps {
    int rows = 0, columns = 0;
    double bound = 0;
};

/// The steps that hold a tolerance over an ellipsoid of half-axes `axes`, at least 4 from pole to pole and 6 around; nothing where
/// there would be more than kMostSurfaceSteps. 2 n h k is at most n h^2 + n k^2; h and k take half of the tolerance
/// each.
inline std::optional<SurfaceSteps> surface_steps(const glm::dvec3& axes, double tolerance) {
    constexpr double pi = std::numbers::pi, kLeastRows = 4, kLeastColumns = 6;
    const double n = std::max(axes.x, axes.z), m = std::max(n, axes.y);
    const double most_h = std::sqrt(4 * tolerance / (m + n)), most_k = std::sqrt(2 * tolerance / n);
    const double rows = std::max(std::ceil(pi / most_h), kLeastRows),
                 columns = std::max(std::ceil(2 * pi / most_k), kLeastColumns);
    if (!(rows <= kMostSurfaceSteps && columns <= kMostSurfaceSteps)) return std::nullopt;
    const double h = pi / rows, k = 2 * pi / columns;
    return SurfaceSteps{static_cast<int>(rows), static_cast<int>(columns),
                        (m * h * h + 2 * n * h * k + n * k * k) / 8};
}

}  // namespace anamorph::figure
