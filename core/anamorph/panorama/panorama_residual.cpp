// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/panorama_residual.h"

namespace anamorph {

LinearCoefficients minimax_coefficients(double x_max, double height) {
    constexpr double kTurn = 2 * std::numbers::pi;
    const auto residual = [](double x, double a) { return std::atan(x) / kTurn - a * x; };
    // R_theta(x_c) + R_theta(x_max) falls as a grows; x_c, where R_theta' = 0, solves 1 / (1 + x^2) = 2 pi a.
    double low = std::atan(x_max) / kTurn / x_max, high = 1 / kTurn;
    for (int i = 0; i < 100; ++i) {
        const double a = 0.5 * (low + high);
        const double x_c = std::sqrt(std::max(0.0, 1 / (kTurn * a) - 1));
        (residual(x_c, a) + residual(x_max, a) > 0 ? low : high) = a;
    }
    // R_v(0, y) = -R_v(x_max, y)
    const double b = 0.5 / height * (1 + 1 / std::sqrt(1 + x_max * x_max));
    return {0.5 * (low + high), b};
}

LinearPart linear_part(const Panorama& map, int piece) {
    LinearPart part = linear_part<Panorama>(map, piece);
    const Chart &source = map.source(), &target = map.target();
    if (source.projection() != Projection::cylindrical || target.projection() != Projection::rectilinear)
        return part;
    const Ray<double> axis = map.local_ray(part.cx, part.cy, map.local_around(part.cx, part.cy, piece));
    const bool level = std::fabs(part.right.y) + std::fabs(part.down.x) < 1e-12 * source.width() &&
                       std::fabs(axis.y) < 1e-12 * (std::fabs(axis.x) + std::fabs(axis.z));
    if (!level) return part;
    // In units of the plane: theta = azimuth / 2 pi, v = slope / height.
    const double x_max = 0.5 * target.width() / target.scale_x(), height = source.height() / source.scale_y();
    const LinearCoefficients k = minimax_coefficients(x_max, height);
    part.right.x =
        std::copysign(k.a * 2 * std::numbers::pi * source.scale_x() / target.scale_x(), part.right.x);
    part.down.y = std::copysign(k.b * height * source.scale_y() / target.scale_y(), part.down.y);
    return part;
}

}  // namespace anamorph
