// SPDX-License-Identifier: Apache-2.0
// Charts: the flat pictures of the sphere of directions. A chart maps a point of its image to a ray and a ray
// to a point of its image; each formula is written once, as a template over the scalar.
//
// Frames. Image: pixels, x right, y down, the centre of pixel (i, j) at (i + 0.5, j + 0.5). Ray: x right, y down,
// z forward, any length. Chart plane: (X, Y) = (image - centre) / pixels per unit, in the unit of the lens
// (radians for angles).
//
// Lenses, with azimuth a and elevation e (downwards) of the ray, or polar angle t from the axis:
//   rectilinear      X = x / z, Y = y / z
//   equirectangular  X = a, Y = e
//   cylindrical      X = a, Y = tan e                    (Kim 2003, eq. 4.1, 4.2)
//   mercator         X = a, Y = asinh(tan e)
//   fisheye          radius t (equidistant)
//   equisolid        radius 2 sin(t / 2)
//   stereographic    radius 2 tan(t / 2)
//   cubemap          six rectilinear faces of 90 degrees in a vertical strip, in OpenEXR's order and orientation
//   cubemap3x2       right left up / down front back, each face upright as seen from inside
//   cubecross        up / left front right back / down on a 4 x 3 grid
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/number/jet.h"

namespace anamorph {

enum class Projection {
    equirectangular,
    cylindrical,
    rectilinear,
    fisheye,
    equisolid,
    stereographic,
    mercator,
    cubemap,
    cubemap3x2,
    cubecross
};

/// How a field of view spreads over W pixels: edge to edge, or from the first pixel's centre to the last one's.
enum class PixelSpacing { edges, centers };

/// "equirectangular" and so on; "latlong" is an alias. Throws Error naming `parameter`.
Projection projection_from_name(std::string_view name, const std::string& parameter = "projection");
std::string_view name_of(Projection projection);
/// All names, separated by ", ", for messages and documentation.
std::string projection_names();
bool is_cube(Projection projection);

/// A rectangle of pixels, half open: x0 <= x < x1, y0 <= y < y1.
struct Box {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool empty() const { return x1 <= x0 || y1 <= y0; }
    friend bool operator==(const Box&, const Box&) = default;
};
inline Box intersection(const Box& a, const Box& b)
{
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

template <class T>
struct Ray {
    T x, y, z;
};

template <class T>
struct Point {
    T x, y;
};

/// One smooth piece of a chart: where it stands in the image, and which way it faces (cube faces only).
/// A ray of the face is forward + X right + Y down.
struct Piece {
    Box box;
    std::array<double, 3> right{1, 0, 0}, down{0, 1, 0}, forward{0, 0, 1};
};

/// Which branch of a chart's inverse to take: the piece, and the azimuth from which angles are counted, so that
/// a neighbourhood of that azimuth meets no seam.
struct Branch {
    int piece = 0;
    double azimuth = 0, cos_azimuth = 1, sin_azimuth = 0;
};

class Chart {
public:
    /// `fov`: the horizontal field of view of the whole image in degrees; 0 takes the projection's default
    /// (default_fov). `prefix` is put before "fov" and "size" in errors. Throws Error.
    Chart(Projection projection, int width, int height, double fov = 0,
          PixelSpacing spacing = PixelSpacing::edges, const std::string& prefix = "");

    /// 360 for equirectangular, cylindrical and mercator, 180 for fisheye, equisolid and stereographic, else 90.
    static double default_fov(Projection projection);

    Projection projection() const { return m_projection; }
    int width() const { return m_width; }
    int height() const { return m_height; }
    double fov() const { return m_fov; }
    PixelSpacing spacing() const { return m_spacing; }
    const std::vector<Piece>& pieces() const { return m_pieces; }

    /// Does azimuth close on itself in this image (a full turn)? Its period in pixels is then period().
    bool closed() const { return m_closed; }
    /// Pixels of a full turn: the width, or one less where fields of view run between pixel centres.
    int period() const { return m_spacing == PixelSpacing::edges ? m_width : m_width - 1; }
    /// Is the image an angle's: equirectangular, cylindrical, mercator?
    bool has_azimuth() const
    {
        return m_projection == Projection::equirectangular || m_projection == Projection::cylindrical ||
               m_projection == Projection::mercator;
    }
    /// Do the first and last rows touch the poles (equirectangular over the full 180 degrees)?
    bool reaches_poles() const { return m_poles; }
    /// Pixels per unit of the chart plane at pieces()[0].
    double scale_x() const { return m_sx; }
    double scale_y() const { return m_sy; }

    /// The ray through an image point, in the frame of `piece`. Meaningful where inside() >= 0.
    template <class T>
    Ray<T> ray(const T& x, const T& y, int piece = 0) const;

    /// >= 0 where the image point has a ray; the sign holds for all members of an interval, or is open.
    template <class T>
    T inside(const T& x, const T& y, int piece = 0) const;

    /// The image point of a ray on a branch.
    template <class T>
    Point<T> point(const Ray<T>& ray, const Branch& branch) const;

    /// >= 0 where the ray is seen by the lens and lies on the branch's piece.
    template <class T>
    T sees(const Ray<T>& ray, const Branch& branch) const;

    /// The branch whose azimuth is that of `ray` (for a neighbourhood of it).
    Branch branch_around(const Ray<double>& ray) const;
    /// The branch for one ray alone: azimuths counted from straight ahead, in [-180, 180].
    template <class T>
    Branch branch_of(const Ray<T>& ray) const;

private:
    template <class T>
    Point<T> to_plane(const T& x, const T& y, const Piece& piece) const;

    Projection m_projection;
    int m_width, m_height;
    double m_fov;
    PixelSpacing m_spacing;
    double m_sx = 0, m_sy = 0;
    bool m_closed = false, m_poles = false;
    std::vector<Piece> m_pieces;
};

// ---------------------------------------------------------------------------------------------------------

template <class T>
Point<T> Chart::to_plane(const T& x, const T& y, const Piece& piece) const
{
    const double cx = 0.5 * (piece.box.x0 + piece.box.x1), cy = 0.5 * (piece.box.y0 + piece.box.y1);
    return {(x - cx) * (1 / m_sx), (y - cy) * (1 / m_sy)};
}

template <class T>
T Chart::inside(const T& x, const T& y, int piece) const
{
    const Point<T> p = to_plane(x, y, m_pieces[static_cast<std::size_t>(piece)]);
    constexpr double kPi = std::numbers::pi;
    // A hair over the limit still counts, so that the last pixel of a full image is never lost to rounding.
    constexpr double kSlack = 1 + 1e-12;
    switch (m_projection) {
        case Projection::equirectangular: return kPi * kPi / 4 * kSlack - square(p.y);
        case Projection::fisheye: return kPi * kPi * kSlack - (square(p.x) + square(p.y));
        case Projection::equisolid: return 4 * kSlack - (square(p.x) + square(p.y));
        default: return T(1);
    }
}

template <class T>
Ray<T> Chart::ray(const T& x, const T& y, int piece) const
{
    using std::sinh;
    using std::sqrt;
    const Piece& face = m_pieces[static_cast<std::size_t>(piece)];
    const Point<T> p = to_plane(x, y, face);
    T sa, ca, se, ce;
    switch (m_projection) {
        case Projection::rectilinear: return {p.x, p.y, T(1)};
        case Projection::equirectangular:
            sin_cos(p.x, sa, ca);
            sin_cos(p.y, se, ce);
            return {sa * ce, se, ca * ce};
        case Projection::cylindrical:
            sin_cos(p.x, sa, ca);
            return {sa, p.y, ca};
        case Projection::mercator:
            // tan e = sinh Y
            sin_cos(p.x, sa, ca);
            return {sa, sinh(p.y), ca};
        case Projection::fisheye: {
            // sin t along the radius, cos t along the axis
            const T r = sqrt(square(p.x) + square(p.y));
            if (is_zero(constant_part(r))) return {p.x, p.y, T(1)};
            sin_cos(r, sa, ca);
            const T k = sa / r;
            return {p.x * k, p.y * k, ca};
        }
        case Projection::equisolid: {
            // sin t = r sqrt(1 - r^2 / 4), cos t = 1 - r^2 / 2
            const T r2 = square(p.x) + square(p.y);
            const T k = sqrt(1.0 - r2 * 0.25);
            return {p.x * k, p.y * k, 1.0 - r2 * 0.5};
        }
        case Projection::stereographic: {
            // (sin t, cos t) (1 + r^2 / 4) = (r, 1 - r^2 / 4)
            const T r2 = square(p.x) + square(p.y);
            return {p.x, p.y, 1.0 - r2 * 0.25};
        }
        default: {
            const auto axis = [&](std::size_t i) {
                return face.forward[i] + p.x * face.right[i] + p.y * face.down[i];
            };
            return {axis(0), axis(1), axis(2)};
        }
    }
}

template <class T>
T Chart::sees(const Ray<T>& ray, const Branch& branch) const
{
    if (m_projection == Projection::rectilinear) return ray.z;
    if (!is_cube(m_projection)) return T(1);
    // On a face the forward component is the largest.
    const Piece& face = m_pieces[static_cast<std::size_t>(branch.piece)];
    const auto along = [&](const std::array<double, 3>& v) {
        return ray.x * v[0] + ray.y * v[1] + ray.z * v[2];
    };
    const T f = along(face.forward), a = along(face.right), b = along(face.down);
    T least = f - a;
    for (const T& other : {f + a, f - b, f + b})
        if (lower_end(constant_part(other)) < lower_end(constant_part(least))) least = other;
    return least;
}

template <class T>
Point<T> Chart::point(const Ray<T>& ray, const Branch& branch) const
{
    using std::asinh;
    using std::atan2;
    using std::sqrt;
    const Piece& face = m_pieces[static_cast<std::size_t>(branch.piece)];
    const double cx = 0.5 * (face.box.x0 + face.box.x1), cy = 0.5 * (face.box.y0 + face.box.y1);
    const auto image = [&](const T& px, const T& py) {
        return Point<T>{px * m_sx + cx, py * m_sy + cy};
    };
    switch (m_projection) {
        case Projection::rectilinear: return image(ray.x / ray.z, ray.y / ray.z);
        case Projection::equirectangular:
        case Projection::cylindrical:
        case Projection::mercator: {
            // Turn the branch's azimuth to straight ahead, where atan2 has no cut.
            const T sx = ray.x * branch.cos_azimuth - ray.z * branch.sin_azimuth;
            const T sz = ray.x * branch.sin_azimuth + ray.z * branch.cos_azimuth;
            const T azimuth = atan2(sx, sz) + branch.azimuth;
            const T rho = sqrt(square(ray.x) + square(ray.z));
            if (m_projection == Projection::equirectangular) return image(azimuth, atan2(ray.y, rho));
            const T slope = ray.y / rho;
            return image(azimuth, m_projection == Projection::cylindrical ? slope : T(asinh(slope)));
        }
        case Projection::fisheye: {
            const T rho = sqrt(square(ray.x) + square(ray.y));
            if (is_zero(constant_part(rho))) return image(ray.x, ray.y);
            const T k = atan2(rho, ray.z) / rho;
            return image(ray.x * k, ray.y * k);
        }
        case Projection::equisolid: {
            // For a unit ray X = x / cos(t / 2) = x sqrt(2 / (1 + z)).
            const T n = sqrt(square(ray.x) + square(ray.y) + square(ray.z));
            const T k = sqrt(T(2) / (n * (n + ray.z)));
            return image(ray.x * k, ray.y * k);
        }
        case Projection::stereographic: {
            const T n = sqrt(square(ray.x) + square(ray.y) + square(ray.z));
            const T k = T(2) / (n + ray.z);
            return image(ray.x * k, ray.y * k);
        }
        default: {
            const auto along = [&](const std::array<double, 3>& v) {
                return ray.x * v[0] + ray.y * v[1] + ray.z * v[2];
            };
            const T f = along(face.forward);
            return image(along(face.right) / f, along(face.down) / f);
        }
    }
}

template <class T>
Branch Chart::branch_of(const Ray<T>& ray) const
{
    Branch b;
    if (!is_cube(m_projection)) return b;
    T best = T(-1);
    for (std::size_t i = 0; i < m_pieces.size(); ++i) {
        const auto& f = m_pieces[i].forward;
        const T along = ray.x * f[0] + ray.y * f[1] + ray.z * f[2];
        if (i == 0 || along > best) {
            best = along;
            b.piece = static_cast<int>(i);
        }
    }
    return b;
}

}  // namespace anamorph
