// SPDX-License-Identifier: Apache-2.0
// Concentric mosaics (Shum and He 1999; Kim 2003, 7.2): panoramas whose columns were each seen through a slit, from points
// of a circle and along its tangents. The rays of a viewpoint inside the outer circle, in the plane of the circles, lie on
// such tangents, so that its view is made of columns of many circles.
//
// Plane of the circles: x right, z forward, as the panoramas' rays have them; lengths in radii of the outer circle. A line of
// sight with the horizontal direction u, of length 1, has the offset r = u_z p_x - u_x p_z from the centre, and its
// viewpoint p lies t = p . u beyond the point where it touches the circle of radius |r|; offsets to the left are negative,
// and so are the radii of circles whose slits look that way. The circle of radius q shows in its column of direction u what
// lies on the line with offset q.
//
// Heights need the distance of what is seen, which a mosaic does not know. It is taken to be `depth` from the centre for all
// there is (the constant depth correction). A scene that lies there is shown as it is, whatever the number of circles; of
// any other the columns are those of the right lines of sight, in between circles to within the next ones, and heights are
// off as vertical_distortion() says.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "anamorph/panorama/panorama.h"

namespace anamorph {

/// A stack of slit panoramas, and a viewpoint.
struct ConcentricStack {
    static constexpr int kMostCircles = 1024;
    /// Depths from here on are taken to be infinite.
    static constexpr double kFar = 1e15;

    /// Panoramas, at least 1; their radii run evenly from -1 to 1. A single one is of radius 0.
    int circles = 1;
    /// Distance from the centre of all that is seen; above 1, or infinite.
    double depth = HUGE_VAL;
    /// The viewpoint, x right and z forward; at most 1 from the centre.
    glm::dvec2 viewpoint{0.0};

    /// Throws Error where there are too many circles or none, the depth is not above 1, or the viewpoint is not inside the outer circle.
    void check() const;

    double radius(int circle) const { return circles == 1 ? 0 : (2.0 * circle) / (circles - 1) - 1; }
    /// Horizontal offset of a line of sight through the viewpoint; 0 for a vertical one.
    double offset(const Ray<double>& ray) const;
    /// The weight of a circle for lines of sight with this offset: 1 at its own radius, 0 from the radii of its neighbours
    /// on. The weights of all circles add up to 1.
    double weight(int circle, double offset) const;
    /// The largest relative error of drawn heights in the direction of a ray, for things that are `nearest` (above 1) or
    /// farther from the centre.
    double vertical_distortion(const Ray<double>& ray, double nearest) const;
    /// The largest relative error of drawn heights in all directions, to within a thousandth of it.
    double vertical_distortion(double nearest) const;
};

/// Throws Error where the rows of a panorama are no full turn.
void check_slit_panorama(const Chart& panorama);

/// The pull map from a view of a stack to one of its panoramas.
class ConcentricMap {
  public:
    /// `view`: from the picture to a panorama whose rows are a full turn, as if both had been taken from the centre. Unless it
    /// is to be `whole`, the map may say of boxes where all of weight() is 0 that there is nothing. Throws Error: the source is
    /// no full turn; the viewpoint is not inside the outer circle; the depth is not above 1; no such circle.
    ConcentricMap(const Panorama& view, const ConcentricStack& stack, int circle, bool whole);

    const Panorama& view() const { return m_view; }
    const ConcentricStack& stack() const { return m_stack; }

    /// The map about one point: the view's, and the viewpoint in the frame of the source's local rays.
    struct Local {
        Panorama::Local view;
        glm::dvec2 viewpoint;
    };
    Local local_around(double x, double y, int piece) const;

    // The members that make this a FormulaMap (plan/formula_map.h).
    Size target_size() const { return m_view.target_size(); }
    Size source_size() const { return m_view.source_size(); }
    std::vector<Box> target_pieces() const { return m_view.target_pieces(); }
    int source_piece(const Local& local) const { return m_view.source_piece(local.view); }
    int period() const { return m_view.period(); }
    int target_period() const { return m_view.target_period(); }
    SourceEdges source_edges() const { return m_view.source_edges(); }
    Cover cover(const Interval& x, const Interval& y, int piece, const Local& local, bool across_seam) const;

    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        return m_view.source().local_point(local_slit_ray<T>(x, y, local), local.view.source);
    }
    template <class T>
    bool exact(const T& x, const T& y, int piece, Point<T>& source_point, int& source_piece) const {
        if (!(m_view.target().inside(x, y, piece) >= 0)) return false;
        return m_view.exact(slit_or_pole(m_view.source_ray(x, y, piece)), source_point, source_piece);
    }
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int piece) const;

    /// A circle's slit as formulas read it: its radius over the depth, the root of 1 less its square, and 1 over that.
    template <class T>
    struct Slit {
        T radius, root, per_root;
    };
    /// The ray of a slit towards the point that a ray of the viewpoint (px, pz) meets at the depth.
    /// With that point at x = r n + l u, |x| = depth, n to the right of u: the slit's direction is u turned to the right by
    /// asin(r / depth) - asin(radius / depth), and heights are as (l - t) to the slit's own l.
    template <class T, class P>
    static Ray<T> slit_ray(const Ray<T>& ray, const P& px, const P& pz, double per_depth,
                           const Slit<T>& slit) {
        const Sight<T> s = sight(ray, px, pz);
        const T a = s.offset * per_depth, root = sqrt(T(1.0 - square(a)));
        const T cos = root * slit.root + a * slit.radius, sin = a * slit.root - root * slit.radius;
        return {s.along.x * cos + s.along.z * sin, s.along.y * (root - s.ahead * per_depth) * slit.per_root,
                s.along.z * cos - s.along.x * sin};
    }
    /// The offset of a line of sight through the viewpoint (px, pz).
    template <class T, class P>
    static T offset_of(const Ray<T>& ray, const P& px, const P& pz) {
        return sight(ray, px, pz).offset;
    }

  private:
    /// The frame of local rays is turned about the vertical axis: its entries may be off by Heading::kError, the two
    /// products and their sum by as many units.
    static constexpr double kLocalError = 2 * Heading::kError + 8 * 0x1p-53;

    /// A line of sight in the plane: its direction, of length 1, with the ray's height, its offset, and how far the viewpoint
    /// lies along it.
    template <class T>
    struct Sight {
        Ray<T> along;
        T offset, ahead;
    };
    template <class T, class P>
    static Sight<T> sight(const Ray<T>& ray, const P& px, const P& pz) {
        const Ray<T> r = with_enlarged(ray);
        const T length = sqrt(T(square(r.x) + square(r.z)));
        const Ray<T> u{r.x / length, r.y / length, r.z / length};
        return {u, u.z * px - u.x * pz, u.x * px + u.z * pz};
    }
    /// The largest error of the offset of a ray computed in double (ConcentricStack::offset()), together with the rounding of
    /// weight(), over a box of target points.
    double offset_error(const Interval& x, const Interval& y, int piece) const;

    template <class T>
    static Ray<T> with_enlarged(const Ray<T>& r) {
        const auto k = enlarger(r.x, r.z);
        return {r.x * k, r.y * k, r.z * k};
    }

    /// A ray such that no ray of a slit for this one is flatter, by half: what does not see it sees none of
    /// them, up to where there is no azimuth.
    template <class T>
    Ray<T> flattest(const Ray<T>& ray) const {
        return {ray.x, ray.y * m_least_height, ray.z};
    }
    /// The ray of this circle's slit.
    template <class T, class P>
    Ray<T> slit_ray(const Ray<T>& ray, const P& px, const P& pz) const {
        return slit_ray(ray, px, pz, m_per_depth,
                        Slit<T>{m_slit.as<T>(), m_slit_root.as<T>(), m_per_root.as<T>()});
    }
    /// The ray of the circle's slit for the stack's viewpoint; straight up and down, where there is no
    /// horizontal direction, the ray itself.
    template <class T>
    Ray<T> slit_or_pole(const Ray<T>& ray) const {
        if (ray.x == T(0) && ray.z == T(0)) return ray;
        return slit_ray(ray, T(m_stack.viewpoint.x), T(m_stack.viewpoint.y));
    }
    template <class T>
    Ray<T> local_slit_ray(const T& x, const T& y, const Local& local) const {
        return slit_ray(m_view.local_ray(x, y, local.view), measured<T>(local.viewpoint.x, kLocalError),
                        measured<T>(local.viewpoint.y, kLocalError));
    }

    Panorama m_view;
    ConcentricStack m_stack;
    int m_circle;
    bool m_whole;
    /// Half of 1 - |viewpoint| / depth: the way from the viewpoint to what is seen is no shorter, over that from the slit.
    double m_least_height;
    double m_per_depth;  ///< 1 / depth, in double
    /// radius / depth, the root of 1 less its square, and 1 over that.
    Constant m_slit, m_slit_root, m_per_root;
};

}  // namespace anamorph
