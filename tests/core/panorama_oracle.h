// SPDX-License-Identifier: Apache-2.0
// The place that a panorama's pixel comes from, written out in long double: shares nothing with what it
// judges but the places and axes of a cube's faces, which are whole numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "anamorph/panorama/panorama.h"

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
    LensModel lens = {};
    mutable std::shared_ptr<const class LensOracle> solved = {};
    double vfov = 0;                     ///< 0: square pixels
    std::optional<double> horizon = {};  ///< pixels from the upper edge
};

/// A picture through a lens, in a projection that may have it.
inline View view_through(const std::string& lens, const Size& size, double fov) {
    return {lens.starts_with("kb4")    ? Projection::fisheye
            : lens.starts_with("ocam") ? Projection::stereographic
                                       : Projection::rectilinear,
            size.width,
            size.height,
            fov,
            false,
            LensModel::parse(lens)};
}

/// The chart that is judged.
inline Chart chart_of(const View& v) {
    return Chart(v.projection, v.width, v.height, v.fov,
                 v.centers ? PixelSpacing::centers : PixelSpacing::edges, "", 1, v.lens, {v.vfov, v.horizon});
}

/// Half the plane's width, in its unit: the image of half the field of view.
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

/// Half the plane's height, in its unit, of a vertical field of view: what half of it is above straight ahead.
inline Real half_plane_up(const View& v) {
    const Real half = Real(v.vfov) / 2, radians = half / 180 * kPi;
    const auto tangent = [](Real degrees) {
        return degrees > 45 ? 1 / std::tan((90 - degrees) / 180 * kPi) : std::tan(degrees / 180 * kPi);
    };
    switch (v.projection) {
        case Projection::rectilinear:
        case Projection::cylindrical:
            return tangent(half);
        case Projection::mercator:
            return std::log(std::tan(kPi / 4 + radians / 2));
        case Projection::equisolid:
            return 2 * std::sin(radians / 2);
        case Projection::stereographic:
            return 2 * tangent(half / 2);
        default:
            return radians;
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

/// The pixels per unit of the plane, which would be square if fields of view ran from edge to edge.
struct Scale {
    Real x, y;
};
inline Scale scale(const View& v) {
    const int columns = face_width(v), rows = has_faces(v.projection) ? columns : v.height;
    const Real wide = 2 * half_plane(v), high = v.vfov != 0 ? 2 * half_plane_up(v) : wide * rows / columns;
    return v.centers ? Scale{(columns - 1) / wide, (rows - 1) / high} : Scale{columns / wide, rows / high};
}

/// The row of the plane's middle.
inline Real middle_row(const View& v, const Piece& piece) {
    return v.horizon ? Real(*v.horizon) : Real(piece.box.y0 + piece.box.y1) / 2;
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

/// A lens in its own unit, from polar coordinates: radii, and how they become each other.
class LensOracle {
  public:
    explicit LensOracle(const View& v) : m_kind(v.lens.kind), m_values(v.lens.values) {
        using enum LensModel::Kind;
        const std::size_t n = m_values.size();
        m_unit = m_kind == ptlens || m_kind == poly ? std::min(v.width, v.height) / Real(2)
                 : m_kind == ocam                   ? 1
                 : is_of_observed() ? std::sqrt(Real(v.width) * v.width + Real(v.height) * v.height) / 2
                                    : scale(v).x;
        m_scale = scale(v).x;
        m_cx = Real(v.width) / 2 + m_values[n - 2];
        m_cy = Real(v.height) / 2 + m_values[n - 1];
        if (m_kind == ptlens) {
            m_across = Real(m_values[3]) / v.height;
            m_down = Real(m_values[4]) / v.width;
        }
        // In steps up to where the radius falls; the top lies within one of them.
        const Real far = 4 * std::sqrt(Real(v.width) * v.width + Real(v.height) * v.height) / m_unit;
        const Real step = far / 4096;
        const auto rises = [&](Real r) { return formula(r + step) > formula(r); };
        for (m_end = 0; rises(m_end) && m_end < far && formula(m_end) < 4 * far;) m_end += step;
        if (rises(m_end)) return;
        Real low = std::max(m_end - step, Real(0)), high = m_end + step;
        for (int i = 0; i < 200; ++i) {
            const Real third = (high - low) / 3;
            if (formula(low + third) < formula(high - third))
                low += third;
            else
                high -= third;
        }
        m_end = (low + high) / 2;
    }
    /// Is the formula one of observed points?
    bool is_of_observed() const {
        return m_kind == LensModel::Kind::three_de4 || m_kind == LensModel::Kind::division ||
               m_kind == LensModel::Kind::ocam;
    }
    /// The model's own function.
    Real formula(Real r) const {
        using enum LensModel::Kind;
        const auto k = [&](std::size_t i) { return Real(m_values[i]); };
        const Real r2 = r * r, r4 = r2 * r2;
        switch (m_kind) {
            case ptlens:
                return k(0) * r4 + k(1) * r2 * r + k(2) * r2 + (1 - k(0) - k(1) - k(2)) * r;
            case brown:
                return r * (1 + k(0) * r2 + k(1) * r4 + k(2) * r2 * r4) /
                       (1 + k(3) * r2 + k(4) * r4 + k(5) * r2 * r4);
            case three_de4:
                return r + k(0) * r2 * r + k(1) * r4 * r;
            case division:
                return r / (1 + k(0) * r2 + k(1) * r4);
            case poly:
                return r * (1 + k(0)) + k(1) * r2 + k(2) * r2 * r + k(3) * r4 + k(4) * r4 * r;
            case ocam: {
                // The angle from the axis, and its radius in a stereographic picture.
                const Real ahead = k(0) + k(1) * r2 + k(2) * r2 * r + k(3) * r4;
                return 2 * m_scale * std::tan(std::atan2(r, k(0) < 0 ? -ahead : ahead) / 2);
            }
            default:
                return r + k(0) * r2 * r + k(1) * r4 * r + k(2) * r4 * r2 * r + k(3) * r4 * r4 * r;
        }
    }
    /// The root of formula(r) = value, by halving; not a number beyond the fold.
    Real root(Real value) const {
        Real low = 0, high = m_end;
        if (value > formula(m_end)) return NAN;
        for (int i = 0; i < 90; ++i) {
            const Real middle = (low + high) / 2;
            (formula(middle) < value ? low : high) = middle;
        }
        return (low + high) / 2;
    }
    Real end() const { return m_end; }
    /// Where the centre is observed, from the picture's middle.
    Point<Real> centre(const View& v) const {
        const Point<Real> p = observed(v, {Real(v.width) / 2, Real(v.height) / 2});
        return {p.x - Real(v.width) / 2, p.y - Real(v.height) / 2};
    }
    Real unit() const { return m_unit; }

    /// The pixel at which one of the ideal picture is observed; ideal() is the way back. The ideal one's
    /// centre is the picture's middle.
    Point<Real> observed(const View& v, const Point<Real>& ideal) const {
        const Point<Real> p = observed_before_shear(v, ideal), middle{Real(v.width) / 2, Real(v.height) / 2};
        return {p.x + m_across * (p.y - middle.y), p.y + m_down * (p.x - middle.x)};
    }
    Point<Real> observed_before_shear(const View& v, const Point<Real>& ideal) const {
        const Real x = (ideal.x - Real(v.width) / 2) / m_unit, y = (ideal.y - Real(v.height) / 2) / m_unit;
        const Real r = std::hypot(x, y), angle = std::atan2(y, x);
        if (!is_of_observed() && r > m_end) return {NAN, NAN};
        if (r == 0) return {m_cx, m_cy};
        const Real radius = is_of_observed() ? root(r) : formula(r);
        Point<Real> p{radius * std::cos(angle), radius * std::sin(angle)};
        if (m_kind == LensModel::Kind::brown) {
            const Real p1 = m_values[6], p2 = m_values[7];
            p.x += 2 * p1 * x * y + p2 * (r * r + 2 * x * x);
            p.y += p1 * (r * r + 2 * y * y) + 2 * p2 * x * y;
            // OpenCV's thin prism.
            const Real r2 = r * r, r4 = r2 * r2;
            p.x += m_values[8] * r2 + m_values[9] * r4;
            p.y += m_values[10] * r2 + m_values[11] * r4;
        }
        if (m_kind == LensModel::Kind::ocam)
            p = {p.x + m_values[6] * p.y, m_values[5] * p.x + m_values[4] * p.y};
        return {p.x * m_unit + m_cx, p.y * m_unit + m_cy};
    }
    Point<Real> ideal(const View& v, const Point<Real>& observed) const {
        // PanoTools shears about the middle, after the centre was shifted from it: Cramer's rule undoes it.
        const Real u = observed.x - Real(v.width) / 2, w = observed.y - Real(v.height) / 2;
        const Real area = 1 - m_across * m_down;
        Real x = ((u - m_across * w) / area + Real(v.width) / 2 - m_cx) / m_unit;
        Real y = ((w - m_down * u) / area + Real(v.height) / 2 - m_cy) / m_unit;
        if (m_kind == LensModel::Kind::ocam) {
            // OCamCalib's equations, solved by elimination.
            y = (y - m_values[5] * x) / (m_values[4] - Real(m_values[5]) * m_values[6]);
            x -= m_values[6] * y;
        }
        const Real r = std::hypot(x, y), angle = std::atan2(y, x);
        if (is_of_observed() && r > m_end) return {NAN, NAN};
        const Real radius = is_of_observed() ? formula(r) : root(r);
        const Point<Real> p{radius * std::cos(angle) * m_unit + Real(v.width) / 2,
                            radius * std::sin(angle) * m_unit + Real(v.height) / 2};
        const bool tangential =
            m_kind == LensModel::Kind::brown && std::isfinite(radius) &&
            std::any_of(m_values.begin() + 6, m_values.begin() + 12, [](double value) { return value != 0; });
        return tangential ? newton(v, observed, p) : p;
    }

    /// Solves observed(p) = wanted by Newton's method from `p`, with slopes from differences.
    Point<Real> newton(const View& v, const Point<Real>& wanted, Point<Real> p) const {
        for (int i = 0; i < 40; ++i) {
            const Real h = 1e-6L * m_unit;
            const Point<Real> f = observed(v, p), a = observed(v, {p.x + h, p.y}),
                              b = observed(v, {p.x, p.y + h});
            const Real xx = (a.x - f.x) / h, xy = (b.x - f.x) / h, yx = (a.y - f.y) / h, yy = (b.y - f.y) / h;
            const Real x = wanted.x - f.x, y = wanted.y - f.y, determinant = xx * yy - xy * yx;
            p = {p.x + (yy * x - xy * y) / determinant, p.y + (xx * y - yx * x) / determinant};
        }
        return p;
    }

  private:
    LensModel::Kind m_kind;
    std::vector<double> m_values;
    Real m_unit = 1, m_scale = 1, m_cx = 0, m_cy = 0, m_end = 0;
    Real m_across = 0, m_down = 0;  ///< PanoTools' shear: pixels across for one down, and down for one across
};

inline const LensOracle& lens_of(const View& v) {
    if (!v.solved) v.solved = std::make_shared<const LensOracle>(v);
    return *v.solved;
}

/// The ray through a pixel's centre; false outside of the lens, by more than a hair.
inline bool ray_of(const View& v, const Piece& piece, Real x, Real y, Vector& ray) {
    if (v.lens.kind != LensModel::Kind::none) {
        const Point<Real> ideal = lens_of(v).ideal(v, {x, y});
        if (!std::isfinite(ideal.x)) return false;
        x = ideal.x, y = ideal.y;
    }
    const Scale s = scale(v);
    const Real px = (x - Real(piece.box.x0 + piece.box.x1) / 2) / s.x, py = (y - middle_row(v, piece)) / s.y,
               r = std::hypot(px, py);
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

/// Where a camera elsewhere sees the point that a direction meets of the plane that is 1 away.
inline Vector toward_plane(const Vector& v, const PlaneTransfer& transfer) {
    Vector n{0, 0, 1};
    turn(n.y, n.z, transfer.pitch);
    turn(n.z, n.x, transfer.yaw);
    const Real along = n.x * v.x + n.y * v.y + n.z * v.z;
    if (along == 0) return v;  // in the limit
    const Vector met{v.x / along, v.y / along, v.z / along};
    const Real way = along < 0 ? -1 : 1;  // behind, the map goes on
    return {way * (met.x - transfer.camera[0]), way * (met.y - transfer.camera[1]),
            way * (met.z - transfer.camera[2])};
}

/// Turns back, by the inverses in the other order.
inline Vector turned_back(Vector v, const Orientation& held) {
    if (held.transfer) v = toward_plane(v, *held.transfer);
    turn(v.z, v.x, -held.yaw);
    turn(v.y, v.z, -held.pitch);
    turn(v.x, v.y, -held.roll);
    turn(v.z, v.x, -held.ahead);
    return v;
}

/// The point of a ray on a given face. Not finite where there is none.
inline Point<long double> point_of(const View& view, const Piece& piece, const Vector& ray) {
    if (view.lens.kind != LensModel::Kind::none) {
        View ideal = view;
        ideal.lens = {};
        return lens_of(view).observed(view, point_of(ideal, piece, ray));
    }
    const View& v = view;
    const Scale s = scale(v);
    const Real cx = Real(piece.box.x0 + piece.box.x1) / 2, cy = middle_row(v, piece);
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
