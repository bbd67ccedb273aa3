// SPDX-License-Identifier: Apache-2.0
// Cylindrical: X = azimuth, Y = tan(elevation) (Kim 2003, eq. 4.1 and 4.2).

struct Cylindrical : CylinderFamily {
    /// Of less than a full turn: a lens about the middle of the plane, as PanoTools has it.
    static constexpr Lensed lensed = Lensed::axial;

    /// The default height covers 90 degrees of elevation: 2 tan 45 over the azimuth.
    static double aspect(double fov) { return 2 / (fov * std::numbers::pi / 180); }

    static double largest_tangent(double, double half_height) { return half_height; }
    template <class T>
    static T sees(const Ray<T>& r, const Setting& s) {
        const T far = across_length(r) * s.reach;
        return min(T(far - r.y), T(far + r.y));
    }
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        T sa, ca;
        sin_cos(T(p.x - s.around.angle), sa, ca);
        return {sa, p.y, ca};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const Ray<T> l = with_squares(r);
        return {atan2(r.x, r.z) + s.around.angle, l.y / across_length(l)};
    }
};
