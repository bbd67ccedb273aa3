// SPDX-License-Identifier: Apache-2.0
// Mercator: X = azimuth, Y = asinh(tan(elevation)).

struct Mercator : CylinderFamily {
    static double largest_tangent(double, double half_height) {
        return std::sinh(std::min(half_height, 600.0));
    }

    template <class T>
    static T sees(const Ray<T>& r, const Setting& s) {
        return Cylindrical::sees(r, s);
    }
    /// The local ray, by tan e = sinh Y; it is divided by cosh Y, so that it never overflows.
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        T sa, ca, se;
        sin_cos(T(p.x - s.around.angle), sa, ca);
        const auto one = scaled_sinh(p.y, se);
        return {sa * one, se, ca * one};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const Point<T> p = Cylindrical::point(r, s);
        return {p.x, asinh(p.y)};
    }
};
