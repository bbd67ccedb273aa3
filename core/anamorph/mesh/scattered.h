// SPDX-License-Identifier: Apache-2.0
// The map through pairs of points at any places: their Delaunay triangulation in the target, in which sides of given polygons are edges
// by flips of those that cross them (Sloan 1993), and on each
// triangle Clough and Tocher's element, three cubics that join to a C1 map (Clough and Tocher 1965; in Bezier
// form as in Farin 1986, "Triangular Bernstein-Bezier patches", section 7).
//
// Gradients at the points are those of the planes that fit the neighbours in the triangulation best, weighted
// by 1 / distance^2. Outside the points the map goes over to the affine map that fits all pairs best (to
// their mean displacement, where they do not determine one): that one holds at four further points, at the
// corners of a box three times as wide and high as target and points together. What is interpolated is the
// displacement from the identity, which maps the whole target onto the whole source. Pixels, x right, y down.
#pragma once

#include <array>

#include "anamorph/geometry/bounds_tree.h"
#include "anamorph/geometry/size.h"
#include "anamorph/mesh/mesh.h"

namespace anamorph {

/// One cubic on a triangle whose corners are an edge of the triangulation and the middle of its triangle.
struct CubicTriangle {
    Point<double> corner[3];
    /// The base of the barycentric coordinates for corners 0 and 1, which are c + a (x - base.x) + b
    /// (y - base.y). It is a whole pixel of the image, so that differences lose nothing.
    Point<double> base;
    double a[2], b[2], c[2];
    /// Bezier points of the displacement: 300, 030, 003, 210, 120, 201, 021, 102, 012, 111.
    Point<double> bezier[10];
    /// The largest distances of c, of a and b, and of any coordinate of the Bezier points from what the given
    /// points define.
    double c_error, slope_error, bezier_error[10];

    template <class T>
    Point<T> operator()(const T& x, const T& y) const {
        const T dx = x - base.x, dy = y - base.y;
        const T u = dx * a[0] + dy * b[0] + c[0], v = dx * a[1] + dy * b[1] + c[1], w = 1.0 - u - v;
        const T uu = square(u), vv = square(v), ww = square(w);
        const std::array<T, 10> weight{uu * u,       vv * v,         ww * w,       uu * v * 3.0,
                                       vv * u * 3.0, uu * w * 3.0,   vv * w * 3.0, ww * u * 3.0,
                                       ww * v * 3.0, u * v * w * 6.0};
        Point<T> sum{T(0.0), T(0.0)};
        for (std::size_t i = 0; i < 10; ++i) {
            sum.x = sum.x + weight[i] * bezier[i].x;
            sum.y = sum.y + weight[i] * bezier[i].y;
        }
        return sum;
    }

    /// The largest error of both barycentric coordinates together in a rectangle, as computed in double.
    double place_error(const Bounds& box) const;
    /// The largest magnitudes of the three barycentric coordinates in a rectangle.
    struct Reach {
        double u, v, w;
    };
    Reach reach(const Bounds& box) const;
    /// For barycentric coordinates of at most given magnitudes, the sum of the magnitudes of all terms of a
    /// coordinate of the displacement, of the errors of its Bezier points, and of its derivatives by the
    /// first two coordinates.
    struct Terms {
        double value, error, slope;
    };
    Terms terms(const Reach& reach) const;

    /// The least barycentric coordinate: not negative inside.
    double inside(double x, double y) const;
    Bounds bounds() const;
    /// Does the triangle share a point with a rectangle, or nearly?
    bool meets(const Bounds& box) const;
};

class Scattered {
  public:
    /// Triangulates points. `from` is the target, `to` the source. Throws Error that names `name` and the
    /// point: one that is not a number, two at the same place, none at all; and the polygon: one whose corners are no
    /// points, or with a side that another side crosses or a point lies on.
    Scattered(const ControlPoints& points, const Size& from, const Size& to, double amount,
              const std::string& name = "points");

    const Size& from() const { return m_from; }
    const Size& to() const { return m_to; }
    const Point<double>& scale() const { return m_scale; }
    const std::vector<CubicTriangle>& triangles() const { return m_triangles; }
    const BoundsTree& tree() const { return m_tree; }

    /// The cubic that a point of the target is evaluated in.
    const CubicTriangle& triangle_at(double x, double y) const;

    /// The map on one cubic.
    template <class T>
    Point<T> at(const CubicTriangle& triangle, const T& x, const T& y) const {
        const Point<T> d = triangle(x, y);
        return {x * m_scale.x + d.x, y * m_scale.y + d.y};
    }
    Point<double> at(double x, double y) const { return at(triangle_at(x, y), x, y); }

    /// The orientation of the map: +1, or -1 where the affine map that fits all pairs best flips the image.
    double orientation() const { return m_orientation; }

  private:
    Size m_from, m_to;
    Point<double> m_scale;
    std::vector<CubicTriangle> m_triangles;
    BoundsTree m_tree;
    double m_orientation = 1;
};

}  // namespace anamorph
