// SPDX-License-Identifier: Apache-2.0
// Equisolid: the radius is 2 sin(t / 2). Areas keep their proportions: it is Lambert's azimuthal equal-area
// projection.

struct Equisolid : AxisFamily {
    static constexpr std::string_view alias = "lambert";
    static double diameter(const Setting&) { return 4; }

    static DoubleDouble width(DoubleDouble degrees, const Setting&) { return 4 * sine_of(degrees / 4); }

    template <class T>
    static T inside(const Point<T>& p, const Setting&) {
        return 4 * kSlack - (square(p.x) + square(p.y));
    }
    /// The local ray, by sin t = r sqrt(1 - r^2 / 4) and cos t = 1 - r^2 / 2.
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting&) {
        const T r2 = square(p.x) + square(p.y);
        const T k = sqrt(without_hair(T(1.0 - r2 * 0.25)));
        return {p.x * k, p.y * k, 1.0 - r2 * 0.5};
    }
    /// The point of a local ray; for one of length 1, X = x / cos(t / 2) = x sqrt(2 / (1 + z)). The direction straight behind
    /// is all of the rim, of which one point is taken.
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting&) {
        const T rho_squared = square(r.x) + square(r.y);
        const T n = sqrt(T(rho_squared + square(r.z)));
        const T k = sqrt(T(T(2) / (n * add_to_length(n, r.z, rho_squared))));
        const auto behind = both(is_zero(rho_squared), is_negative(r.z));
        return {select(behind, T(2), T(r.x * k)), select(behind, T(0), T(r.y * k))};
    }
};
