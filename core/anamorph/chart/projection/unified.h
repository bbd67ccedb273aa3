// SPDX-License-Identifier: Apache-2.0
// The unified model of omnidirectional cameras (Geyer and Daniilidis 2000; Mei and Rives 2007) with xi = d: the sphere of
// directions seen from d behind its centre, X = (d + 1) x / (z + d) for a ray of length 1. d = 0 is rectilinear, 1 stereographic.
// Its radius is to the angle from the axis what the Pannini projection's X is to the azimuth.

struct Unified : AnyProjection {
    static constexpr std::string_view alias = "mei";
    static constexpr FieldOfView fov{180, 360, true};
    static constexpr int numbers = 1;
    static constexpr double least_d = 0;

    static double most_fov(const FieldOfView& most, const Setting& s) { return Pannini::most_fov(most, s); }
    static DoubleDouble width(DoubleDouble degrees, const Setting& s) { return Pannini::width(degrees, s); }
    static double width_units(DoubleDouble degrees, const Setting& s) {
        return Pannini::width_units(degrees, s);
    }
    static double largest_tangent(double half_width, double half_height) {
        return Pannini::largest_tangent(half_width, half_height);
    }

    /// For d > 1 a picture ends where the sphere's far side begins: r^2 (d^2 - 1) = (d + 1)^2.
    template <class T>
    static T inside(const Point<T>& p, const Setting& s) {
        const double k = (s.distance.d - 1) / (s.distance.d + 1);
        return 1 * kSlack - (square(p.x) + square(p.y)) * k;
    }
    template <class T>
    static T sees(const Ray<T>& r, const Setting& s) {
        return Pannini::sees_before(r, sqrt(T(square(r.x) + square(r.y) + square(r.z))), s);
    }
    /// The local ray times k + 1, with k = r^2 / (d + 1)^2: (k + 1) cos t = q - k d and (k + 1) (cos t + d) = q + d for
    /// q = sqrt(1 + k - k d^2), from r (d + cos t) = (d + 1) sin t.
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        const auto per_sum = s.distance.per_sum.as<T>();
        const T k = square(T(p.x * per_sum)) + square(T(p.y * per_sum));
        const T q = sqrt(without_hair(T(1.0 + k * s.distance.less_square.as<T>())));
        const T across = (q + s.distance.d) * per_sum;
        return {p.x * across, p.y * across, q - k * s.distance.d};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const T n = sqrt(T(square(r.x) + square(r.y) + square(r.z)));
        const T k = T(1) / ((n * s.distance.d + r.z) * s.distance.per_sum.as<T>());
        return {r.x * k, r.y * k};
    }
};
