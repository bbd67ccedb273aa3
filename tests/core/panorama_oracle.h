// SPDX-License-Identifier: Apache-2.0
// Where a panorama's pixel comes from, written out in long double: shares nothing with what it judges but the
// places and axes of a cube's faces, which are whole numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anamorph/map/panorama.h"

namespace anamorph::oracle {

using Real = long double;
inline constexpr Real kPi = std::numbers::pi_v<long double>;

struct Vector {
    Real x, y, z;
};

struct View {
    Projection projection;
    int width, height;
    double fov;
    bool centers = false;
};

/// Radians per plane unit and all that: half the plane's width for half the field of view.
inline Real half_plane(const View& v) {
    const Real half = Real(v.fov) / 2;
    const auto tangent = [](Real degrees) {
        return degrees > 45 ? 1 / std::tan((90 - degrees) / 180 * kPi) : std::tan(degrees / 180 * kPi);
    };
    switch (v.projection) {
        case Projection::rectilinear:
            return tangent(half);
        case Projection::equisolid:
            return 2 * std::sin(half / 360 * kPi);
        case Projection::stereographic:
            return 2 * tangent(half / 2);
        case Projection::cubemap:
        case Projection::cubemap3x2:
        case Projection::cubecross:
            return 1;
        default:
            return half / 180 * kPi;
    }
}

inline int face_width(const View& v) {
    switch (v.projection) {
        case Projection::cubemap:
            return v.width;
        case Projection::cubemap3x2:
            return v.width / 3;
        case Projection::cubecross:
            return v.width / 4;
        default:
            return v.width;
    }
}

/// Pixels per unit of the plane, whose pixels would be square if fields of view ran from edge to edge.
struct Scale {
    Real x, y;
};
inline Scale scale(const View& v) {
    const int columns = face_width(v), rows = has_faces(v.projection) ? columns : v.height;
    const Real wide = 2 * half_plane(v), high = wide * rows / columns;
    return v.centers ? Scale{(columns - 1) / wide, (rows - 1) / high} : Scale{columns / wide, rows / high};
}

inline Vector along(const glm::dmat3& axes, const Vector& local) {
    const auto row = [&](int i) {
        return axes[0][i] * local.x + axes[1][i] * local.y + axes[2][i] * local.z;
    };
    return {row(0), row(1), row(2)};
}
inline Vector across(const glm::dmat3& axes, const Vector& ray) {
    const auto column = [&](int i) { return axes[i][0] * ray.x + axes[i][1] * ray.y + axes[i][2] * ray.z; };
    return {column(0), column(1), column(2)};
}

/// The ray through a pixel's centre; false outside of the lens, by more than a hair.
inline bool ray_of(const View& v, const Piece& piece, Real x, Real y, Vector& ray) {
    const Scale s = scale(v);
    const Real px = (x - Real(piece.box.x0 + piece.box.x1) / 2) / s.x,
               py = (y - Real(piece.box.y0 + piece.box.y1) / 2) / s.y, r = std::hypot(px, py);
    const Real azimuth = std::atan2(py, px);
    const auto from_axis = [&](Real t) {
        ray = {std::sin(t) * std::cos(azimuth), std::sin(t) * std::sin(azimuth), std::cos(t)};
        if (r == 0) ray = {0, 0, 1};
    };
    switch (v.projection) {
        case Projection::equirectangular:
            ray = {std::sin(px) * std::cos(py), std::sin(py), std::cos(px) * std::cos(py)};
            return std::fabs(py) <= kPi / 2;
        case Projection::cylindrical: {
            const Real e = std::atan(py);
            ray = {std::sin(px) * std::cos(e), std::sin(e), std::cos(px) * std::cos(e)};
            return true;
        }
        case Projection::mercator:
            ray = {std::sin(px) / std::cosh(py), std::tanh(py), std::cos(px) / std::cosh(py)};
            return true;
        case Projection::fisheye:
            from_axis(r);
            return r <= kPi;
        case Projection::equisolid:
            from_axis(2 * std::asin(std::min(r / 2, Real(1))));
            return r <= 2;
        case Projection::stereographic:
            from_axis(2 * std::atan(r / 2));
            return true;
        default: {
            const Real n = std::sqrt(1 + px * px + py * py);
            ray = along(piece.axes, {px / n, py / n, 1 / n});
            return true;
        }
    }
}

/// A turn about an axis in the plane of the coordinates a and b, by degrees: exact for right angles.
inline void turn(Real& a, Real& b, double degrees) {
    Real rest = std::fmod(Real(degrees), Real(360));
    int quarters = 0;
    while (rest > 45) rest -= 90, ++quarters;
    while (rest < -45) rest += 90, --quarters;
    const Real c = std::cos(rest / 180 * kPi), s = std::sin(rest / 180 * kPi);
    const Real p = a * c - b * s, q = a * s + b * c;
    switch (((quarters % 4) + 4) % 4) {
        case 0:
            a = p, b = q;
            break;
        case 1:
            a = -q, b = p;
            break;
        case 2:
            a = -p, b = -q;
            break;
        default:
            a = q, b = -p;
    }
}

inline Vector rotated(Vector v, const Orientation& look) {
    turn(v.x, v.y, look.roll);
    turn(v.y, v.z, look.pitch);
    turn(v.z, v.x, look.yaw);
    return v;
}

/// The point of a ray on a given face. Not finite where there is none.
inline Point<long double> point_of(const View& v, const Piece& piece, const Vector& ray) {
    const Scale s = scale(v);
    const Real cx = Real(piece.box.x0 + piece.box.x1) / 2, cy = Real(piece.box.y0 + piece.box.y1) / 2;
    const Real rho = std::hypot(ray.x, ray.y), level = std::hypot(ray.x, ray.z), t = std::atan2(rho, ray.z);
    const auto at = [&](Real px, Real py) { return Point<long double>{px * s.x + cx, py * s.y + cy}; };
    const auto radial = [&](Real radius) {
        return rho > 0 ? at(radius * (ray.x / rho), radius * (ray.y / rho)) : at(radius, 0);
    };
    switch (v.projection) {
        case Projection::equirectangular:
            return at(std::atan2(ray.x, ray.z), std::atan2(ray.y, level));
        case Projection::cylindrical:
            return at(std::atan2(ray.x, ray.z), ray.y / level);
        case Projection::mercator:
            return at(std::atan2(ray.x, ray.z), std::asinh(ray.y / level));
        case Projection::fisheye:
            return radial(t);
        case Projection::equisolid:
            return radial(2 * std::sin(t / 2));
        case Projection::stereographic:
            // 2 tan(t / 2), near t = pi too
            return radial(ray.z < 0 ? 2 * (std::hypot(rho, ray.z) - ray.z) / rho
                                    : 2 * rho / (std::hypot(rho, ray.z) + ray.z));
        default: {
            const Vector local = across(piece.axes, ray);
            if (!(local.z > 0)) return {HUGE_VALL, HUGE_VALL};
            return at(local.x / local.z, local.y / local.z);
        }
    }
}

}  // namespace anamorph::oracle
