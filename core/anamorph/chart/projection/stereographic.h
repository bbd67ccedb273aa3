// SPDX-License-Identifier: Apache-2.0
// Stereographic: the radius is 2 tan(t / 2).

struct Stereographic : AxisFamily {
    static constexpr FieldOfView fov{180, 360, true};
    static constexpr Lensed lensed = Lensed::stereographic;

    static DoubleDouble width(DoubleDouble degrees, const Setting&) { return 4 * tan_of(degrees / 4); }

    /// The local ray, by (sin t, cos t) (1 + r^2 / 4) = (r, 1 - r^2 / 4).
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting&) {
        return {p.x, p.y, 1.0 - (square(p.x) + square(p.y)) * 0.25};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting&) {
        const T rho_squared = square(r.x) + square(r.y);
        const T n = sqrt(T(rho_squared + square(r.z)));
        const T k = T(2) / add_to_length(n, r.z, rho_squared);
        return {r.x * k, r.y * k};
    }
};
