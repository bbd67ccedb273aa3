// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/bump_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

#include "anamorph/error.h"
#include "anamorph/panorama/panorama_residual.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::machine {
namespace {

// q of a point of the plane that is 89.9999 degrees from its direction is 2e-6.
constexpr double kLeastDepth = 1e-6;
/// Points of a plane, each way, at which residuals are looked at: an odd number has the middle and both ends.
constexpr int kProbes = 65;

[[noreturn]] void refuse(const std::string& what) {
    throw Error(
        "machine: embm-2003 draws rectilinear views, without a lens, of cylindrical, equirectangular and "
        "mercator panoramas: " +
        what);
}

void check_charts(const Panorama& view) {
    const Chart& target = view.target();
    check_bump_source(view.source());
    if (target.projection() != Projection::rectilinear)
        refuse("the picture's projection is " + std::string(name_of(target.projection())));
    if (target.lens()) refuse("the picture has a lens");
}

[[noreturn]] void refuse_beyond() {
    throw Error(
        "machine: embm-2003: a part of the view is 90 degrees or more from the horizontal direction of "
        "projection, "
        "beyond its projection plane: pitch, roll or fov must be less");
}

glm::dmat3 turn_of(const Panorama& view) {
    glm::dmat3 turn;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            turn[column][row] =
                view.turn()[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)].value();
    return turn;
}

/// Is one of the panorama's poles in the rectangle?
bool shows_pole(const glm::dmat3& turn, const EyeCorners& eye) {
    // The axis in the frame of the eye; its end in front.
    const glm::dvec3 axis(turn[0].y, turn[1].y, turn[2].y);
    if (axis.z == 0) return false;
    const double x = axis.x / axis.z, y = axis.y / axis.z;
    return x >= eye.first.x && x <= eye.last.x && y >= eye.first.y && y <= eye.last.y;
}

/// The part of a convex polygon where normal . (X, Y, 1) >= 0.
std::vector<glm::dvec2> clipped(const std::vector<glm::dvec2>& corners, const glm::dvec3& normal) {
    const auto side = [&](const glm::dvec2& p) { return normal.x * p.x + normal.y * p.y + normal.z; };
    std::vector<glm::dvec2> kept;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec2 &a = corners[i], &b = corners[(i + 1) % corners.size()];
        const double at_a = side(a), at_b = side(b);
        if (at_a >= 0) kept.push_back(a);
        if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0))
            kept.push_back(a + (b - a) * (at_a / (at_a - at_b)));
    }
    return kept;
}

/// The direction at an azimuth from `ahead`, to the right, with its plane's axes.
glm::dmat3 axes_at(const glm::dvec3& ahead, double azimuth) {
    const double c = std::cos(azimuth), s = std::sin(azimuth);
    const glm::dvec3 d(ahead.x * c + ahead.z * s, 0, ahead.z * c - ahead.x * s), down(0, 1, 0);
    return {glm::cross(down, d), down, d};
}

/// Takes the ranges of a plane's part.
void set_range(ProjectionPlane& plane, const PlaneOptions& options) {
    for (const glm::dvec2& corner : plane.corners) {
        const glm::dvec3 at = plane.from_eye * glm::dvec3(corner, 1.0);
        if (!(at.z > kLeastDepth)) refuse_beyond();
        plane.x_max = std::max(plane.x_max, std::fabs(at.x / at.z));
        plane.y_max = std::max(plane.y_max, std::fabs(at.y / at.z));
    }
    const auto take = [](const char* name, double asked, double& reached) {
        if (asked == 0) return;
        // A view of 90 degrees reaches the tangent of 45, which is 1 but for rounding.
        if (!(asked >= reached * (1 - 1e-9)))
            throw Error(std::string("machine: ") + name, shortest(asked),
                        "must be 0 or at least " + shortest(reached) +
                            ", as far as the view reaches on its projection plane");
        reached = asked;
    };
    take("x_max", options.x_max, plane.x_max);
    take("y_max", options.y_max, plane.y_max);
}

/// The slope b for which the larger of |f(y) - b y| and |g(y) - b y| is least over the ordinates up to y_max.
template <class F, class G>
double minimax_slope(const F& f, const G& g, double y_max) {
    const auto largest = [&](double b) {
        double most = 0;
        for (int i = 1; i <= kProbes; ++i) {
            const double y = y_max * i / kProbes;
            most = std::max({most, std::fabs(f(y) - b * y), std::fabs(g(y) - b * y)});
        }
        return most;
    };
    // The largest of convex functions of b is convex: thirds of the interval that cannot hold its least value are taken away.
    double low = 0, high = 2 * f(y_max / kProbes) * kProbes / y_max;
    for (int i = 0; i < 200; ++i) {
        const double third = (high - low) / 3;
        if (largest(low + third) <= largest(high - third))
            high -= third;
        else
            low += third;
    }
    return 0.5 * (low + high);
}

/// Section 4.3: of the cylinder as there, of others by the same rule, that residuals at x' = 0 and at x_max be least together.
void set_linear(ProjectionPlane& plane, const Chart& source) {
    const double width = source.width(), height = source.height();
    plane.right = plane.down = 0;
    plane.centre = {0, 0};
    plane.centre = plane_residual(source, plane, 0, 0);
    const double h = height / source.scale_y();
    const LinearCoefficients k = minimax_coefficients(plane.x_max, h);
    plane.right = k.a * 2 * std::numbers::pi * source.scale_x() / width;
    if (source.projection() == Projection::cylindrical) {
        plane.down = k.b * h * source.scale_y() / height;
        return;
    }
    plane.down =
        minimax_slope([&](double y) { return plane_residual(source, plane, 0, y).y; },
                      [&](double y) { return plane_residual(source, plane, plane.x_max, y).y; }, plane.y_max);
}

void check_residuals(const ProjectionPlane& plane, const Chart& source) {
    double most = 0;
    for (int j = 0; j < kProbes; ++j)
        for (int i = 0; i < kProbes; ++i) {
            const auto at = [](int k, double range) { return range * (2.0 * k / (kProbes - 1) - 1); };
            const glm::dvec2 r = plane_residual(source, plane, at(i, plane.x_max), at(j, plane.y_max));
            most = std::max({most, std::fabs(r.x), std::fabs(r.y)});
        }
    if (!(most <= 1))
        throw Error(
            "machine: embm-2003: the linear part of the view is off by up to " +
            shortest(std::round(10 * most) / 10) +
            " times the source's size, and a bump map holds -1 to 1: pitch, roll or fov must be less");
}

ProjectionPlane plane_at(const Panorama& view, const glm::dmat3& axes, std::vector<glm::dvec2> corners,
                         const PlaneOptions& options) {
    ProjectionPlane plane;
    plane.axes = axes;
    plane.from_eye = glm::transpose(axes) * turn_of(view);
    plane.corners = std::move(corners);
    set_range(plane, options);
    set_linear(plane, view.source());
    check_residuals(plane, view.source());
    return plane;
}

}  // namespace

void check_bump_source(const Chart& source) {
    if (!rows_turn(source.projection()))
        refuse("the source's projection is " + std::string(name_of(source.projection())));
}

glm::dvec2 plane_residual(const Chart& source, const ProjectionPlane& plane, double x, double y) {
    // Azimuths are counted from the direction of projection, which no seam is near to.
    const glm::dvec3& ahead = plane.axes[2];
    const Branch branch = source.branch_around(Ray<double>{ahead.x, ahead.y, ahead.z});
    const glm::dvec3 ray = glm::transpose(branch.axes) * (plane.axes * glm::dvec3(x, y, 1));
    const Point<double> at = source.local_point(Ray<double>{ray.x, ray.y, ray.z}, branch);
    return {at.x / source.width() - plane.centre.x - plane.right * x,
            at.y / source.height() - plane.centre.y - plane.down * y};
}

EyeCorners eye_corners(const Chart& target) {
    const auto eye = [&](double x, double y) {
        const Ray<double> ray = target.ray(x, y);
        return glm::dvec2(ray.x / ray.z, ray.y / ray.z);
    };
    return {eye(0, 0), eye(target.width(), target.height())};
}

std::vector<ProjectionPlane> projection_planes(const Panorama& view, const PlaneOptions& options) {
    check_charts(view);
    const glm::dmat3 turn = turn_of(view);
    const EyeCorners eye = eye_corners(view.target());
    if (shows_pole(turn, eye)) refuse_beyond();
    const std::vector<glm::dvec2> screen = {
        eye.first, {eye.last.x, eye.first.y}, eye.last, {eye.first.x, eye.last.y}};
    const glm::dvec3 ahead = glm::normalize(glm::dvec3(turn[2].x, 0, turn[2].z));
    if (options.count == 1) return {plane_at(view, axes_at(ahead, 0), screen, options)};
    // Where no pole is seen, the least and the largest azimuth are those of corners.
    const glm::dmat3 to_plane = glm::transpose(axes_at(ahead, 0)) * turn;
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (const glm::dvec2& corner : screen) {
        const glm::dvec3 at = to_plane * glm::dvec3(corner, 1.0);
        const double azimuth = std::atan2(at.x, at.z);
        least = std::min(least, azimuth);
        most = std::max(most, azimuth);
    }
    std::vector<ProjectionPlane> planes;
    const double part = (most - least) / options.count;
    for (int i = 0; i < options.count; ++i) {
        const glm::dmat3 axes = axes_at(ahead, least + (i + 0.5) * part);
        std::vector<glm::dvec2> corners = screen;
        // Rays to the right of an azimuth are along the plane's right there, of those that are not behind.
        if (i > 0) corners = clipped(corners, glm::transpose(turn) * axes_at(ahead, least + i * part)[0]);
        if (i + 1 < options.count)
            corners = clipped(corners, -(glm::transpose(turn) * axes_at(ahead, least + (i + 1) * part)[0]));
        planes.push_back(plane_at(view, axes, std::move(corners), options));
    }
    return planes;
}

}  // namespace anamorph::machine
