// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/fit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace anamorph::figure {
namespace {

constexpr double kMargin = 0.05;

/// Where planes through the eye, x = t z, touch an ellipsoid with centre c and c + M x, |x| <= 1: the roots of
/// (c.x - t c.z)^2 = |(row_x - t row_z) M|^2.
void add_slopes(const glm::dvec3& center, const glm::dmat3& matrix, double distance, int axis,
                SeenExtent& extent) {
    const glm::dmat3 rows = glm::transpose(matrix);
    const double a = center.z * center.z - glm::dot(rows[2], rows[2]),
                 b = center[axis] * center.z - glm::dot(rows[axis], rows[2]),
                 c = center[axis] * center[axis] - glm::dot(rows[axis], rows[axis]);
    const double root = std::sqrt(std::max(b * b - a * c, 0.0));
    extent.least[axis] = std::min(extent.least[axis], distance * (b - root) / a);
    extent.most[axis] = std::max(extent.most[axis], distance * (b + root) / a);
}

}  // namespace

void add_seen_extent(const FigureFrame& frame, const View& view, SeenExtent& extent) {
    for (const Body& body : frame.bodies) {
        const glm::dvec3 center = view.to_view(body.shape.center);
        glm::dmat3 matrix = view.rotation * body.shape.rotation;
        for (int k = 0; k < 3; ++k) matrix[k] *= body.shape.axes[k];
        const glm::dmat3 rows = glm::transpose(matrix);
        if (!view.perspective()) {
            for (int axis = 0; axis < 2; ++axis) {
                const double reach = glm::length(rows[axis]);
                extent.least[axis] = std::min(extent.least[axis], center[axis] - reach);
                extent.most[axis] = std::max(extent.most[axis], center[axis] + reach);
            }
        } else if (center.z - glm::length(rows[2]) > view.near) {
            for (int axis = 0; axis < 2; ++axis) add_slopes(center, matrix, view.eye_distance, axis, extent);
        }
    }
}

void fit_view(View& view, const SeenExtent& extent, const glm::dvec2& size) {
    if (extent.empty()) return;
    const glm::dvec2 wanted = (1 - 2 * kMargin) * size, seen = extent.most - extent.least;
    const double scale = std::min(wanted.x / seen.x, wanted.y / seen.y);
    if (std::isfinite(scale) && scale > 0) view.scale = scale;
    view.middle = 0.5 * size - view.scale * 0.5 * (extent.least + extent.most);
}

}  // namespace anamorph::figure
