// SPDX-License-Identifier: Apache-2.0
// The surface of a body as a function on the screen: what a view ray through a pixel meets, exactly.
//
// In the coordinates of the unit sphere that an ellipsoid is made of, turned so that the third axis points
// away from the observer, a view ray has the direction (e1, e2, w), all three affine in the pixel. Without
// perspective w = 1. The ray meets the body where
//     D = w^2 - m (e1^2 + e2^2) >= 0,
// m = 1 without perspective and o^2 - 1 with the eye at distance o from the centre (m < 0: inside the body).
// Points are ordered by their nearness, which is -depth without perspective and 1 / depth with it. On the
// near side it is lean + bulge sqrt(D) with an affine `lean`: a concave function of the pixel, so that over a
// square it is least in a corner and at most twice its value in the middle less that. The far side's is
// convex.
//
// (Herbison-Evans 1980 and Chapman 1986, section 2.7.2, have the coefficients of D without perspective.)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "anamorph/figure/body/ellipsoid.h"
#include "anamorph/figure/outline/outline_view.h"
#include "anamorph/geometry/box.h"
#include "anamorph/number/number.h"

namespace anamorph::figure {

/// The affine function c + x dx + y dy of a place in a pixel.
struct AffineOfPixel {
    double c = 0, x = 0, y = 0;

    double operator()(double dx, double dy) const { return c + x * dx + y * dy; }
    template <class T>
    T operator()(const T& dx, const T& dy) const {
        return c + x * dx + y * dy;
    }
    /// The most that the function changes from the middle of a pixel to its corners.
    double over_half_pixel() const { return 0.5 * (std::fabs(x) + std::fabs(y)); }
};

/// The point where a ray meets a body.
struct SurfaceHit {
    double nearness = -HUGE_VAL;  ///< -infinity where it does not
    bool far_side = false;        ///< the body is seen from inside
};

/// A body's surface as the pixels of a picture show it. Pixels are counted from the upper left corner, y
/// down.
class SeenSurface {
  public:
    /// Takes a body. Axes shorter than a billionth of the longest count as that. `height`: of the picture;
    /// the screen of `view` has its origin at the picture's lower left corner.
    SeenSurface() = default;
    SeenSurface(Ellipsoid body, const View& view, double height);

    /// The box of pixels that may show the body.
    const Box& box() const { return m_box; }
    /// The largest nearness of any point of the body.
    double nearest() const { return m_nearest; }
    /// May part of the body be nearer than View::near? Then its near side is not a function on all of the
    /// pixels that show it.
    bool meets_near_plane() const { return m_meets_near; }

    /// Finds what is seen of the body at a point of the picture.
    SurfaceHit hit(double x, double y) const {
        return m_meets_near ? cut_hit(x, y) : SurfaceHit{near_side(x, y), false};
    }
    /// The nearness of the near side, of a body that does not meet the near plane.
    double near_side(double x, double y) const {
        const double dx = x - m_at.x, dy = y - m_at.y, w = m_w(dx, dy), d = discriminant(dx, dy, w);
        return d >= 0 && w > 0 ? m_lean(dx, dy) + m_bulge * std::sqrt(d) : -HUGE_VAL;
    }
    /// Does the ray through the point meet a body that does not meet the near plane?
    bool covers(double x, double y) const {
        const double dx = x - m_at.x, dy = y - m_at.y, w = m_w(dx, dy);
        return discriminant(dx, dy, w) >= 0 && w > 0;
    }
    /// An upper bound of the nearness of what the pixel around (x, y) shows of the body; -infinity where it shows nothing.
    double nearest_in_pixel(double x, double y) const;
    /// A lower bound of the nearness of what the pixel around (x, y) shows of the body; -infinity where the body meets the near
    /// plane.
    double farthest_in_pixel(double x, double y) const {
        return m_meets_near ? -HUGE_VAL : m_lean(x - m_at.x, y - m_at.y) - m_lean.over_half_pixel();
    }

    /// Pixels x0 <= x < x1 of the row whose middle is at y: no others of the row show the body.
    struct Columns {
        int x0, x1;
    };
    Columns columns(double y, int x0, int x1) const;
    /// The x at which the body is most likely seen on the row at y: the middle of what is seen of it, if anything is.
    double middle_of_row(double y) const;

    /// The point that is seen at (x, y), on the unit sphere of the body's own axes. Where rounding lets the ray
    /// miss the body, the limb's next to it.
    glm::dvec3 unit_point(double x, double y, bool far_side) const {
        return glm::normalize(m_unit * turned_point(x, y, far_side));
    }
    /// unit_point() for any number, such as a jet, but kept so far inside the limb that derivatives are finite.
    template <class T>
    std::array<T, 3> unit_point_of(const T& x, const T& y, bool far_side) const {
        const std::array<T, 3> p = turned(x, y, far_side, kLeastRoot);
        std::array<T, 3> u;
        for (int k = 0; k < 3; ++k)
            u[static_cast<std::size_t>(k)] = p[0] * m_unit[0][k] + p[1] * m_unit[1][k] + p[2] * m_unit[2][k];
        return u;
    }
    /// The gradient of the body's quadric at the point that is seen at (x, y), as the observer sees it:
    /// outwards, x right, y up, z away; not of length 1.
    glm::dvec3 gradient(double x, double y, bool far_side) const {
        return m_gradient * turned_point(x, y, far_side);
    }

  private:
    double discriminant(double dx, double dy, double w) const {
        const double e1 = m_e1(dx, dy), e2 = m_e2(dx, dy);
        return w * w - m_square * (e1 * e1 + e2 * e2);
    }
    SurfaceHit cut_hit(double x, double y) const;
    glm::dvec3 turned_point(double x, double y, bool far_side) const {
        const std::array<double, 3> p = turned(x, y, far_side, 0);
        return {p[0], p[1], p[2]};
    }
    /// The point of the unit sphere that is seen at (x, y), in the coordinates that m_unit rotates. D counts as `least` where
    /// it is less.
    template <class T>
    std::array<T, 3> turned(const T& x, const T& y, bool far_side, double least) const;
    static double value_of(double number) { return number; }
    template <class T>
    static double value_of(const T& number) {
        return number.value();
    }
    static constexpr double kLeastRoot = 1e-12;
    double far_side(double dx, double dy) const;
    void set_parallel(const glm::dmat3& rows, const glm::dvec3& center, const View& view, double height);
    void set_perspective(const glm::dmat3& rows, const glm::dvec3& center, const View& view, double height);
    void set_box(const glm::dvec2& low, const glm::dvec2& high, const View& view, double height);

    bool m_perspective = false, m_meets_near = false;
    glm::dvec2 m_at{0.0};  ///< the pixel that the affine functions are relative to
    AffineOfPixel m_e1, m_e2, m_w, m_lean;
    double m_square = 1;  ///< m
    double m_bulge = 1;
    double m_eye = 0;                ///< o
    double m_near_limit = HUGE_VAL;  ///< nearness of the near plane
    double m_nearest = HUGE_VAL;
    double m_reach =
        0;  ///< the most that sqrt(m) |(e1, e2)| - w changes from a pixel's middle to its corners
    glm::dmat3 m_unit{1.0}, m_gradient{1.0};
    Box m_box;
};

template <class T>
std::array<T, 3> SeenSurface::turned(const T& x, const T& y, bool far_side, double least) const {
    const T dx = x - m_at.x, dy = y - m_at.y, w = m_w(dx, dy), e1 = m_e1(dx, dy), e2 = m_e2(dx, dy);
    const T e = square(e1) + square(e2), d = square(w) - m_square * e;
    const T root = sqrt(d + (std::max(least, value_of(d)) - value_of(d)));
    if (!m_perspective) return {e1, e2, -root};
    // On the ray t (e1, e2, w) from (0, 0, -o).
    if (!far_side) {
        const T sum = m_eye * w + root, t = T(m_square) / sum;
        return {t * e1, t * e2, -(w + m_eye * root) / sum};
    }
    const T length = e + square(w);
    const T t = value_of(w) < 0 ? T(-m_square) / (root - m_eye * w) : (m_eye * w + root) / length;
    return {t * e1, t * e2, (w * root - m_eye * e) / length};
}

/// The depth of a point, as View::to_view gives it in units of the scene, from its nearness.
inline double depth_of(double nearness, bool perspective) {
    return perspective ? 1 / nearness : -nearness;
}

}  // namespace anamorph::figure
