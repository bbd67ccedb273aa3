// SPDX-License-Identifier: Apache-2.0
// Sinusoidal: X = azimuth cos(elevation), Y = elevation. Areas keep their proportions.

struct Sinusoidal : CylinderFamily {
    static constexpr bool closes = false;

    static double aspect(double fov) { return std::min(fov, 180.0) / fov; }

    /// A point has a ray up to half the picture's width times cos(elevation), and no further than the poles.
    template <class T>
    static T inside(const Point<T>& p, const Setting& s) {
        constexpr double kQuarter = std::numbers::pi / 2;
        T se, ce;
        sin_cos(p.y, se, ce);
        return min(T(kQuarter * kQuarter * kSlack - square(p.y)),
                   T(square(ce) * kSlack - square(T(p.x * (1 / s.half_width)))));
    }
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        T se, ce, sa, ca;
        sin_cos(p.y, se, ce);
        sin_cos(T(p.x / ce - s.around.angle), sa, ca);
        return {sa * ce, se, ca * ce};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const Ray<T> l = with_squares(r);
        const T rho = across_length(l);
        return {(atan2(r.x, r.z) + s.around.angle) * (rho / length(rho, l.y)), tilt(l.y, rho, s.along)};
    }
};
