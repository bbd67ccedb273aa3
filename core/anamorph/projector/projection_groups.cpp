// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/projection_groups.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "anamorph/error.h"
#include "anamorph/number/hypot.h"
#include "anamorph/panorama/panorama_residual.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

/// A point of the projection plane as a ray, in the frame of a branch.
template <class T>
Ray<T> ray_at(const ProjectionGroup& group, const Branch& branch, const T& x, const T& y) {
    const glm::dmat3 to = glm::transpose(branch.axes) * group.axes;
    const auto part = [&](int i) { return x * to[0][i] + y * to[1][i] + to[2][i]; };
    return {part(0), part(1), part(2)};
}

double node(int i, int count, double most) {
    return -most + 2 * most * i / (count - 1);
}

/// What interpolation in a cell is off.
double bound_of_cell(const Chart& chart, const ProjectionGroup& group, const Branch& branch,
                     const Interval& x, const Interval& y) {
    using Jet = Jet2<Interval>;
    const Point<Jet> p =
        chart.local_point(ray_at(group, branch, Jet::variable(x, 1, 0), Jet::variable(y, 0, 1)), branch);
    const double h = x.hi - x.lo, v = y.hi - y.lo;
    const auto off = [&](const Jet& jet) {
        return (2 * magnitude(jet.c[3]) * h * h + 2 * magnitude(jet.c[5]) * v * v) / 8;
    };
    return hypot(off(p.x), off(p.y));
}

}  // namespace

ProjectionGroups::ProjectionGroups(const Projector& projector, const std::vector<glm::dvec3>& directions,
                                   const GroupOptions& options)
    : m_projector(projector), m_options(options) {
    for (const auto& [name, value] : {std::pair("x_max", options.x_max), std::pair("y_max", options.y_max)})
        if (!(value > 0 && value <= 1000))
            throw Error(name, shortest(value), "must be a number above 0, to 1000");
    for (const auto& [name, value] : {std::pair("columns", options.columns), std::pair("rows", options.rows)})
        if (value < 2 || value > 4096)
            throw Error(name, std::to_string(value), "must be an integer from 2 to 4096");
    for (const glm::dvec3& direction : directions) m_groups.push_back(make_group(direction));
}

std::vector<glm::dvec3> ProjectionGroups::level_directions(int count) {
    std::vector<glm::dvec3> all;
    for (int i = 0; i < count; ++i) {
        const double a = 2 * std::numbers::pi * i / count;
        all.emplace_back(std::sin(a), 0, std::cos(a));
    }
    return all;
}

ProjectionGroup ProjectionGroups::make_group(const glm::dvec3& direction) const {
    const glm::dvec3 scaled = scaled_ray(direction), right = glm::cross(glm::dvec3(0, 1, 0), scaled);
    if (!(glm::length(right) > 1e-9))
        throw Error("direction",
                    shortest(direction.x) + "," + shortest(direction.y) + "," + shortest(direction.z),
                    "must be finite and not along y");
    ProjectionGroup group;
    const glm::dvec3 d = glm::normalize(scaled), e = glm::normalize(right);
    group.axes = glm::dmat3(e, glm::cross(d, e), d);
    const Branch branch = m_projector.panorama().branch_around(Ray<double>{d.x, d.y, d.z});
    set_linear(group, branch);
    set_residuals(group, branch);
    return group;
}

/// Section 4.3 where the paper has it, for a level direction and a cylinder; else the derivatives in the middle.
void ProjectionGroups::set_linear(ProjectionGroup& group, const Branch& branch) const {
    using Jet = Jet1<double>;
    const Chart& chart = m_projector.panorama();
    const Point<Jet> p =
        chart.local_point(ray_at(group, branch, Jet::variable(0, 1, 0), Jet::variable(0, 0, 1)), branch);
    glm::dvec2 right(p.x.c[1], p.y.c[1]), down(p.x.c[2], p.y.c[2]);
    if (chart.projection() == Projection::cylindrical && group.axes[2].y == 0) {
        // In units of the plane: theta = azimuth / 2 pi, v = slope / height.
        const double height = chart.height() / chart.scale_y();
        const LinearCoefficients k = minimax_coefficients(m_options.x_max, height);
        right = {k.a * 2 * std::numbers::pi * chart.scale_x(), 0};
        down = {0, k.b * height * chart.scale_y()};
    }
    const glm::dvec3 &e = group.axes[0], &f = group.axes[1], &d = group.axes[2];
    const glm::dvec3 x = e * right.x + f * down.x + d * p.x.c[0], y = e * right.y + f * down.y + d * p.y.c[0];
    group.linear = glm::transpose(glm::dmat3(x, y, d));
}

void ProjectionGroups::set_residuals(ProjectionGroup& group, const Branch& branch) const {
    const Chart& chart = m_projector.panorama();
    const int columns = m_options.columns, rows = m_options.rows;
    double largest = 0, interpolated = 0;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const double x = node(i, columns, m_options.x_max), y = node(j, rows, m_options.y_max);
            const Point<double> exact = chart.local_point(ray_at(group, branch, x, y), branch);
            const glm::dvec3 ray = group.axes[0] * x + group.axes[1] * y + group.axes[2];
            const glm::dvec3 linear = group.linear * ray;
            const double u = exact.x - linear.x / linear.z, v = exact.y - linear.y / linear.z;
            group.residuals.push_back({static_cast<float>(u), static_cast<float>(v)});
            const double size = hypot(u, v);
            if (!(size <= largest)) largest = size;
            if (i == 0 || j == 0) continue;
            const double bound =
                bound_of_cell(chart, group, branch, {node(i - 1, columns, m_options.x_max), x},
                              {node(j - 1, rows, m_options.y_max), y});
            if (!(bound <= interpolated)) interpolated = bound;
        }
    group.linear_error = largest;
    // Residuals are rounded to float; what is left is the rounding of double.
    const double sum = interpolated + 1.5 * largest * 0x1p-24 + 1e-9 + 1e-13 * chart.width();
    group.bound = std::isfinite(sum) ? sum : HUGE_VAL;
}

bool ProjectionGroups::on_plane(const ProjectionGroup& group, const glm::dvec3& point, glm::dvec2& at) const {
    const glm::dvec3 r = scaled_ray(m_projector.ray(point)) * group.axes;
    if (!(r.z > 0)) return false;
    at = {r.x / r.z, r.y / r.z};
    return std::fabs(at.x) <= m_options.x_max && std::fabs(at.y) <= m_options.y_max;
}

int ProjectionGroups::group_of(const std::array<glm::dvec3, 3>& triangle) const {
    int best = -1;
    double least = HUGE_VAL;
    for (std::size_t g = 0; g < m_groups.size(); ++g) {
        double most = 0;
        for (const glm::dvec3& corner : triangle) {
            glm::dvec2 at;
            if (on_plane(m_groups[g], corner, at))
                most = std::max({most, std::fabs(at.x) / m_options.x_max, std::fabs(at.y) / m_options.y_max});
            else
                most = HUGE_VAL;
        }
        if (!(most < least)) continue;
        least = most;
        best = static_cast<int>(g);
    }
    return best;
}

bool ProjectionGroups::texel(int group, const glm::dvec3& point, Point<double>& at) const {
    const ProjectionGroup& g = m_groups[static_cast<std::size_t>(group)];
    glm::dvec2 p;
    if (!on_plane(g, point, p)) return false;
    const glm::dvec3 linear = g.linear * scaled_ray(m_projector.ray(point));
    const auto place = [](double x, double most, int count, int& cell) {
        const double in = (x + most) / (2 * most) * (count - 1);
        cell = std::clamp(static_cast<int>(in), 0, count - 2);
        return in - cell;
    };
    int i = 0, j = 0;
    const double s = place(p.x, m_options.x_max, m_options.columns, i),
                 t = place(p.y, m_options.y_max, m_options.rows, j);
    const auto read = [&](int a, int b, std::size_t c) {
        return double{g.residuals[static_cast<std::size_t>((j + b) * m_options.columns + i + a)][c]};
    };
    const auto residual = [&](std::size_t c) {
        return (1 - t) * ((1 - s) * read(0, 0, c) + s * read(1, 0, c)) +
               t * ((1 - s) * read(0, 1, c) + s * read(1, 1, c));
    };
    at = {linear.x / linear.z + residual(0), linear.y / linear.z + residual(1)};
    return true;
}

}  // namespace anamorph
