// SPDX-License-Identifier: Apache-2.0
// Charts: the flat pictures of the sphere of directions. A chart maps a point of its image to a ray and a ray
// to a point of its image; each formula is written once, as a template over the scalar.
//
// Frames. Image: pixels, x right, y down, the centre of pixel (i, j) at (i + 0.5, j + 0.5). Ray: x right, y
// down, z forward, any length. Chart plane: (X, Y) = (image - centre) / pixels per unit, in the unit of the
// lens (radians for angles).
//
// Lenses, with azimuth a and elevation e (downwards) of the ray, or polar angle t from the axis:
//   rectilinear      X = x / z, Y = y / z
//   equirectangular  X = a, Y = e
//   cylindrical      X = a, Y = tan e                    (Kim 2003, eq. 4.1, 4.2)
//   mercator         X = a, Y = asinh(tan e)
//   fisheye          radius t (equidistant)
//   equisolid        radius 2 sin(t / 2)
//   stereographic    radius 2 tan(t / 2)
//   cubemap          six rectilinear faces of 90 degrees in a vertical strip, in OpenEXR's order and
//   orientation cubemap3x2       right left up / down front back, each face upright as seen from inside
//   cubecross        up / left front right back / down on a 4 x 3 grid
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/number/jet.h"
#include "anamorph/number/rounded.h"

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

/// How a field of view spreads over W pixels: edge to edge, or from the first pixel's centre to the last
/// one's.
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
inline Box intersection(const Box& a, const Box& b) {
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
inline Point<double> operator+(const Point<double>& a, const Point<double>& b) {
    return {a.x + b.x, a.y + b.y};
}
inline Point<double> operator-(const Point<double>& a, const Point<double>& b) {
    return {a.x - b.x, a.y - b.y};
}
inline Point<double> operator*(const Point<double>& a, double k) {
    return {a.x * k, a.y * k};
}

/// Source pixels (level 0) that the source point moves per target pixel: right, (x_i, y_i), and down, (x_j,
/// y_j).
struct Jacobian {
    double x_i = 1, y_i = 0, x_j = 0, y_j = 1;
};

/// matrix * ray, with entry(column, row) of the matrix.
template <class T, class Entry>
requires(std::is_invocable_v<Entry, int, int>) Ray<T> transform(const Entry& entry, const Ray<T>& ray) {
    const auto row = [&](int i) -> T {
        return ray.x * entry(0, i) + ray.y * entry(1, i) + ray.z * entry(2, i);
    };
    return {row(0), row(1), row(2)};
}
/// Of a matrix whose entries are off by `error` at most.
template <class T>
Ray<T> transform(const glm::dmat3& matrix, const Ray<T>& ray, double error = 0) {
    return transform([&](int column, int row) { return measured<T>(matrix[column][row], error); }, ray);
}

/// One smooth piece of a chart: where it stands in the image, and its axes (right, down, forward) as columns
/// in the frame of rays; only a cube has more than one.
struct Piece {
    Box box;
    glm::dmat3 axes{1};
};

/// An angle from which others are counted. The angle is the truth; cos and sin are off by `error` at most.
struct Heading {
    double angle = 0, cos = 1, sin = 0, error = 0;

    /// atan2 is off by its error in libm, of pi at most, and so is the direction that it stands for; hypot by
    /// as much again at most and a quotient by half a ULP, of 1 at most.
    static constexpr double kError = 6 * interval_detail::kLibmError;

    Heading() = default;
    /// The angle of (x, y); 0 for the origin.
    Heading(double y, double x);
};

/// Where on a chart its formulas are read: the piece, and the direction from which angles are counted. A
/// neighbourhood of that direction meets no seam, and intervals stay narrow there; nothing else depends on
/// it. `around` is the azimuth, or the angle about the axis of a fisheye; `along` the elevation, or the angle
/// from that axis. A local ray has the direction straight ahead: ray = axes * local ray.
struct Branch {
    int piece = 0;
    Heading around, along;
    glm::dmat3 axes{1};
};

class Chart {
  public:
    /// `fov`: the horizontal field of view of the whole image in degrees; 0 takes the projection's default
    /// (default_fov). `prefix` is put before "fov" and "size" in errors. Throws Error.
    Chart(Projection projection, int width, int height, double fov = 0,
          PixelSpacing spacing = PixelSpacing::edges, const std::string& prefix = "");

    /// 360 for equirectangular, cylindrical and mercator, 180 for fisheye, equisolid and stereographic,
    /// else 90.
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
    bool has_azimuth() const {
        return m_projection == Projection::equirectangular || m_projection == Projection::cylindrical ||
               m_projection == Projection::mercator;
    }
    /// Do the first and last rows touch the poles (equirectangular over the full 180 degrees)?
    bool reaches_poles() const { return m_poles; }
    /// Pixels per unit of the chart plane at pieces()[0].
    double scale_x() const { return m_sx.value(); }
    double scale_y() const { return m_sy.value(); }
    /// Source points of one ray lie so many pixels apart, or any multiple: a full turn, infinite for lenses
    /// without azimuth.
    double turn() const {
        return m_closed ? period() : has_azimuth() ? 2 * std::numbers::pi * scale_x() : HUGE_VAL;
    }

    /// No two points of rays lie farther apart, a hair aside: the diameter of a lens that shows all
    /// directions.
    double widest() const {
        const double diameter = m_projection == Projection::fisheye     ? 2 * std::numbers::pi
                                : m_projection == Projection::equisolid ? 4
                                                                        : HUGE_VAL;
        return diameter * std::max(scale_x(), scale_y()) * (1 + 1e-9);
    }

    /// The local ray through an image point. Meaningful where inside() >= 0.
    template <class T>
    Ray<T> local_ray(const T& x, const T& y, const Branch& branch) const;

    /// >= 0 where the image point has a ray; the sign holds for all members of an interval, or is open.
    template <class T>
    T inside(const T& x, const T& y, int piece = 0) const;

    /// The image point of a local ray.
    template <class T>
    Point<T> local_point(const Ray<T>& local, const Branch& branch) const;

    /// > 0 where a local ray is seen by the lens and lies on the branch's piece. A lens that cannot see all
    /// directions ends where their tangents are 1024 times those of its image's edges, and of 45
    /// degrees.
    template <class T>
    T sees(const Ray<T>& local) const;
    /// Do all directions have a point, and on one piece?
    bool sees_all() const {
        return !is_cube(m_projection) && m_projection != Projection::rectilinear &&
               m_projection != Projection::cylindrical && m_projection != Projection::mercator;
    }

    /// The branch for single points of a piece: azimuths counted from straight ahead, in [-180, 180].
    const Branch& branch(int piece = 0) const { return m_branches[static_cast<std::size_t>(piece)]; }
    /// The branch for a neighbourhood of an image point, or of a ray.
    Branch branch_around(double x, double y, int piece) const;
    Branch branch_around(const Ray<double>& ray) const;

    /// The piece that sees a ray.
    template <class T>
    int piece_of(const Ray<T>& ray) const;

    /// The ray through an image point, and the image point of a ray.
    template <class T>
    Ray<T> ray(const T& x, const T& y, int piece = 0) const {
        return transform(branch(piece).axes, local_ray(x, y, branch(piece)));
    }
    template <class T>
    Point<T> point(const Ray<T>& ray, int piece) const {
        return local_point(transform(glm::transpose(branch(piece).axes), ray), branch(piece));
    }

  private:
    template <class T>
    Point<T> to_plane(const T& x, const T& y, const Piece& piece) const;

    Projection m_projection;
    int m_width, m_height;
    double m_fov;
    PixelSpacing m_spacing;
    /// Pixels per unit of the plane, and units per pixel.
    Constant m_sx, m_sy, m_per_x, m_per_y;
    double m_reach = 1;  ///< of sees(): the largest tangent seen
    bool m_closed = false, m_poles = false;
    std::vector<Piece> m_pieces;
    std::vector<Branch> m_branches;
};

// ---------------------------------------------------------------------------------------------------------

template <class T>
Point<T> Chart::to_plane(const T& x, const T& y, const Piece& piece) const {
    const double cx = 0.5 * (piece.box.x0 + piece.box.x1), cy = 0.5 * (piece.box.y0 + piece.box.y1);
    return {(x - cx) * m_per_x.as<T>(), (y - cy) * m_per_y.as<T>()};
}

template <class T>
T Chart::inside(const T& x, const T& y, int piece) const {
    const Point<T> p = to_plane(x, y, m_pieces[static_cast<std::size_t>(piece)]);
    constexpr double kPi = std::numbers::pi;
    // A hair over the limit still counts, so that the last pixel of a full image is never lost to rounding.
    constexpr double kSlack = 1 + 1e-12;
    switch (m_projection) {
        case Projection::equirectangular:
            return kPi * kPi / 4 * kSlack - square(p.y);
        case Projection::fisheye:
            return kPi * kPi * kSlack - (square(p.x) + square(p.y));
        case Projection::equisolid:
            return 4 * kSlack - (square(p.x) + square(p.y));
        default:
            return T(1);
    }
}

template <class T>
Ray<T> Chart::local_ray(const T& x, const T& y, const Branch& branch) const {
    using std::sqrt;
    const Point<T> p = to_plane(x, y, m_pieces[static_cast<std::size_t>(branch.piece)]);
    const Heading& around = branch.around;
    T sa, ca, se, ce;
    switch (m_projection) {
        case Projection::equirectangular:
            sin_cos(T(p.x - around.angle), sa, ca);
            sin_cos(p.y, se, ce);
            return {sa * ce, se, ca * ce};
        case Projection::cylindrical:
            sin_cos(T(p.x - around.angle), sa, ca);
            return {sa, p.y, ca};
        case Projection::mercator: {
            // tan e = sinh Y; divided by cosh Y, which never overflows.
            sin_cos(T(p.x - around.angle), sa, ca);
            std::remove_cvref_t<decltype(constant_part(se))> one;
            scaled_sinh(p.y, se, one);
            return {sa * one, se, ca * one};
        }
        case Projection::fisheye: {
            // sin t along the radius, cos t along the axis
            const auto cos = measured<T>(around.cos, around.error),
                       sin = measured<T>(around.sin, around.error);
            const T u = p.x * cos + p.y * sin, v = p.y * cos - p.x * sin;
            const T r = sqrt(square(u) + square(v));
            if (is_zero(constant_part(r))) return {u, v, T(1)};
            sin_cos(r, sa, ca);
            const T k = sa / r;
            return {u * k, v * k, ca};
        }
        case Projection::equisolid: {
            // sin t = r sqrt(1 - r^2 / 4), cos t = 1 - r^2 / 2
            const T r2 = square(p.x) + square(p.y);
            const T k = sqrt(without_hair(T(1.0 - r2 * 0.25)));
            return {p.x * k, p.y * k, 1.0 - r2 * 0.5};
        }
        case Projection::stereographic: {
            // (sin t, cos t) (1 + r^2 / 4) = (r, 1 - r^2 / 4)
            const T r2 = square(p.x) + square(p.y);
            return {p.x, p.y, 1.0 - r2 * 0.25};
        }
        default:
            return {p.x, p.y, T(1)};
    }
}

template <class T>
T Chart::sees(const Ray<T>& local) const {
    using std::sqrt;
    if (sees_all()) return T(1);
    const auto least_of = [](std::initializer_list<T> values) {
        T least = *values.begin();
        for (const T& other : values)
            if (lower_end(other) < lower_end(least)) least = other;
        return least;
    };
    if (has_azimuth()) {
        const T far = sqrt(square(local.x) + square(local.z)) * m_reach;
        return least_of({far - local.y, far + local.y});
    }
    // On a face the forward component is the largest.
    const T far = local.z * m_reach;
    return least_of({far - local.x, far + local.x, far - local.y, far + local.y});
}

/// n + z for n^2 = rho^2 + z^2, without cancelling where z is negative.
template <class T>
T add_to_length(const T& n, const T& z, const T& rho_squared) {
    const int side = sign(z);
    if (side > 0) return n + z;
    const T other = rho_squared / (n - z);
    return side < 0 ? other : either(T(n + z), other);
}

template <class T>
Point<T> Chart::local_point(const Ray<T>& local, const Branch& branch) const {
    using std::asinh;
    using std::atan2;
    using std::sqrt;
    const Box& box = m_pieces[static_cast<std::size_t>(branch.piece)].box;
    const Heading &around = branch.around, &along = branch.along;
    const double cx = 0.5 * (box.x0 + box.x1), cy = 0.5 * (box.y0 + box.y1);
    const auto image = [&](const T& px, const T& py) {
        return Point<T>{px * m_sx.as<T>() + cx, py * m_sy.as<T>() + cy};
    };
    // The angle of (across, ahead), counted from `along`.
    const auto tilt = [&](const T& across, const T& ahead) -> T {
        const auto cos = measured<T>(along.cos, along.error), sin = measured<T>(along.sin, along.error);
        return atan2(T(across * cos - ahead * sin), T(ahead * cos + across * sin)) + along.angle;
    };
    switch (m_projection) {
        case Projection::equirectangular:
        case Projection::cylindrical:
        case Projection::mercator: {
            const T azimuth = atan2(local.x, local.z) + around.angle;
            // Squares of what is next to nothing underflow.
            const bool tiny = upper_magnitude(local.x) < 0x1p-400 && upper_magnitude(local.z) < 0x1p-400;
            const double larger = tiny ? 0x1p500 : 1;
            const T rho = sqrt(square(T(local.x * larger)) + square(T(local.z * larger)));
            if (m_projection == Projection::equirectangular)
                return image(azimuth, tilt(T(local.y * larger), rho));
            const T slope = local.y * larger / rho;
            return image(azimuth, m_projection == Projection::cylindrical ? slope : T(asinh(slope)));
        }
        case Projection::fisheye: {
            const T rho = sqrt(square(local.x) + square(local.y));
            const bool axis = is_zero(constant_part(rho));
            // All of the rim looks straight back.
            if (axis && sign(local.z) < 0)
                return image(Constant(std::numbers::pi_v<long double>).as<T>(), T(0));
            const T k = axis ? T(T(1) / local.z) : T(tilt(rho, local.z) / rho);
            const auto cos = measured<T>(around.cos, around.error),
                       sin = measured<T>(around.sin, around.error);
            return image((local.x * cos - local.y * sin) * k, (local.y * cos + local.x * sin) * k);
        }
        case Projection::equisolid: {
            // For a unit ray X = x / cos(t / 2) = x sqrt(2 / (1 + z)).
            const T rho_squared = square(local.x) + square(local.y);
            if (is_zero(constant_part(rho_squared)) && sign(local.z) < 0) return image(T(2), T(0));
            const T n = sqrt(rho_squared + square(local.z));
            const T k = sqrt(T(2) / (n * add_to_length(n, local.z, rho_squared)));
            return image(local.x * k, local.y * k);
        }
        case Projection::stereographic: {
            const T rho_squared = square(local.x) + square(local.y);
            const T n = sqrt(rho_squared + square(local.z));
            const T k = T(2) / add_to_length(n, local.z, rho_squared);
            return image(local.x * k, local.y * k);
        }
        default:
            return image(local.x / local.z, local.y / local.z);
    }
}

template <class T>
int Chart::piece_of(const Ray<T>& ray) const {
    int best = 0;
    T most = T(0);
    for (std::size_t i = 0; i < m_pieces.size() && m_pieces.size() > 1; ++i) {
        const auto& f = m_pieces[i].axes[2];
        const T along = ray.x * f[0] + ray.y * f[1] + ray.z * f[2];
        if (i == 0 || along > most) {
            most = along;
            best = static_cast<int>(i);
        }
    }
    return best;
}

}  // namespace anamorph
