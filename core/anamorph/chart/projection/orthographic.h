// SPDX-License-Identifier: Apache-2.0
// Orthographic: the radius is sin t, a globe seen from far away, from inside.

struct Orthographic : AxisFamily {
    static constexpr FieldOfView fov{180, 180};

    static DoubleDouble width(DoubleDouble degrees, const Setting&) { return 2 * sine_of(degrees / 2); }

    template <class T>
    static T inside(const Point<T>& p, const Setting&) {
        return 1 * kSlack - (square(p.x) + square(p.y));
    }
    template <class T>
    static T sees(const Ray<T>& r, const Setting&) {
        return r.z;
    }
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting&) {
        return {p.x, p.y, sqrt(without_hair(T(1.0 - (square(p.x) + square(p.y)))))};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting&) {
        const T n = sqrt(T(square(r.x) + square(r.y) + square(r.z)));
        return {r.x / n, r.y / n};
    }
};
