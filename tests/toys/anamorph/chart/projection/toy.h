// SPDX-License-Identifier: Apache-2.0
// A toy: X = azimuth, Y = 2 tan(elevation / 2).

struct Toy : CylinderFamily {
    template <class T>
    static T inside(const Point<T>& p, const Setting&) {
        return 4 * kSlack - square(p.y);
    }
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        T sa, ca;
        sin_cos(T(p.x - s.around.angle), sa, ca);
        const T across = 4.0 - square(p.y);
        return {sa * across, p.y * 4.0, ca * across};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const Ray<T> l = with_squares(r);
        const T across = across_length(l), length = sqrt(T(square(across) + square(l.y)));
        return {atan2(r.x, r.z) + s.around.angle, l.y * 2.0 / (length + across)};
    }
};
