// SPDX-License-Identifier: Apache-2.0
// Hammer: Lambert's equal-area projection of the ray with half the azimuth, stretched to twice the width:
// X = 2 k cos e sin(a / 2), Y = k sin e, k = sqrt(2 / (1 + cos e cos(a / 2))).

struct Hammer : CylinderFamily {
    static constexpr bool closes = false;

    static DoubleDouble width(DoubleDouble degrees, const Setting&) { return 8 * sine_of(degrees / 8); }
    static double aspect(double fov) {
        return 2 * std::sqrt(2.0) / (8 * std::sin(fov * std::numbers::pi / 1440));
    }

    /// A point has a ray within half a turn each way.
    template <class T>
    static T inside(const Point<T>& p, const Setting&) {
        return 2 * kSlack - (square(p.x) * 0.25 + square(p.y));
    }
    /// The local ray: the ray (x, y, z) with half the azimuth has length 1; its azimuth is doubled and turned by `around`.
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        const T r2 = square(p.x) * 0.25 + square(p.y);
        const T k = sqrt(without_hair(T(1.0 - r2 * 0.25)));
        const T x = p.x * k * 0.5, z = 1.0 - r2 * 0.5;
        const T across = x * z * 2.0, ahead = square(z) - square(x);
        const auto cos = measured<T>(s.around.cos, s.around.error),
                   sin = measured<T>(s.around.sin, s.around.error);
        return {across * cos - ahead * sin, p.y * k * length(x, z), ahead * cos + across * sin};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const T rho = across_length(r), n = length(rho, r.y), cos_e = rho / n;
        T sh, ch;
        sin_cos(T((atan2(r.x, r.z) + s.around.angle) * 0.5), sh, ch);
        const T k = sqrt(T(T(2) / (cos_e * ch + 1.0)));
        return {k * cos_e * sh * 2.0, k * r.y / n};
    }
};
