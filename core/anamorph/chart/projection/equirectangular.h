// SPDX-License-Identifier: Apache-2.0
// Equirectangular: X = azimuth, Y = elevation (down), both in radians.

struct Equirectangular : CylinderFamily {
    static constexpr std::string_view alias = "latlong";
    static constexpr bool has_pole_rows = true;
    /// Of less than a full turn: a lens about the middle of the plane, as PanoTools has it.
    static constexpr Lensed lensed = Lensed::axial;

    static double aspect(double fov) { return std::min(fov, 180.0) / fov; }

    template <class T>
    static T inside(const Point<T>& p, const Setting&) {
        constexpr double kQuarter = std::numbers::pi / 2;
        return kQuarter * kQuarter * kSlack - square(p.y);
    }
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        T sa, ca, se, ce;
        sin_cos(T(p.x - s.around.angle), sa, ca);
        sin_cos(p.y, se, ce);
        return {sa * ce, se, ca * ce};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const Ray<T> l = with_squares(r);
        return {atan2(r.x, r.z) + s.around.angle, tilt(l.y, across_length(l), s.along)};
    }
};
