// SPDX-License-Identifier: Apache-2.0
// The general Pannini projection (Sharpless, Postle and German 2010) with distance d: a cylinder seen from d behind its
// axis. With S = (d + 1) / (d + cos a): X = S sin a, Y = S tan e. d = 0 is rectilinear.

struct Pannini : AnyProjection {
    static constexpr FieldOfView fov{180, 360, true};
    static constexpr int numbers = 1;
    static constexpr double least_d = 0;

    /// The lower limit of cos a: nearer to the back the picture turns round (d > 1) or its scale has no end. Where it is -1 / d
    /// it is rounded towards 0: near -1 an angle changes by many times what its cosine does.
    static double least_cosine(const Setting& s) {
        const double d = s.distance.d;
        if (d <= 1) return -d;
        const double inverse = 1 / d;
        return -(std::fma(inverse, d, -1.0) > 0 ? std::nextafter(inverse, 0.0) : inverse);
    }
    static double most_fov(const FieldOfView& most, const Setting& s) {
        // No more than it is: acos may be off by kLibmError, 4 x 2^-52, each of three operations and the double pi by half of 2^-52.
        constexpr double kBelow = 1 - 8 * 0x1p-52;
        return std::min(most.most, 2 * std::acos(least_cosine(s)) * 180 / std::numbers::pi * kBelow);
    }
    /// The width, by t = tan(a / 2): sin a / (d + cos a) = 2 t / ((d + 1) + (d - 1) t^2), which cancels for d < 1 only.
    static DoubleDouble width(DoubleDouble degrees, const Setting& s) {
        const DoubleDouble t = tan_of(degrees / 4), d = s.distance.d;
        return 4 * (d + 1) * t / (d + 1 + (d - 1) * t * t);
    }
    /// The error as in AnyProjection::width_units: t is off by 14 units, 4 (d + 1) t by 16. Of the sum below, d + 1 is off by
    /// 1, (d - 1) t^2 by 14 twice and 3 more, 31, and the sum itself by 1: all of it by 32 times its terms' magnitudes. With
    /// the quotient, and 4 for what is computed from the width, that is 21 units and 32 times the magnitudes over the sum,
    /// which are at least 1.
    static double width_units(DoubleDouble degrees, const Setting& s) {
        const DoubleDouble t = tan_of(degrees / 4), d = s.distance.d, falling = (d - 1) * t * t;
        return 56 * static_cast<double>((d + 1 + fabs(falling)) / (d + 1 + falling));
    }
    static double largest_tangent(double half_width, double half_height) {
        return std::max(half_width, half_height);
    }

    /// For d > 1 a picture ends where the cylinder's far side begins: X^2 (d^2 - 1) = (d + 1)^2.
    template <class T>
    static T inside(const Point<T>& p, const Setting& s) {
        const double k = (s.distance.d - 1) / (s.distance.d + 1);
        return 1 * kSlack - square(p.x) * k;
    }
    template <class T>
    static T sees(const Ray<T>& r, const Setting& s) {
        return sees_before(r, across_length(r), s);
    }
    /// A ray that makes an angle with cosine z / length with the axis is seen before that is least, and where its point is within the
    /// setting's reach.
    template <class T>
    static T sees_before(const Ray<T>& r, const T& length, const Setting& s) {
        const T far = (length * s.distance.d + r.z) * s.reach;
        return min(T(r.z - length * least_cosine(s)),
                   min(min(T(far - r.x), T(far + r.x)), min(T(far - r.y), T(far + r.y))));
    }
    /// The local ray, with k = X^2 / (d + 1)^2: (k + 1) cos a = sqrt(1 + k - k d^2) - k d, from X (d + cos a) = (d + 1) sin a.
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        const auto per_sum = s.distance.per_sum.as<T>();
        const T k = square(T(p.x * per_sum));
        const T cosine =
            (sqrt(without_hair(T(1.0 + k * s.distance.less_square.as<T>()))) - k * s.distance.d) / (k + 1.0);
        const T per_s = (cosine + s.distance.d) * per_sum;
        return {p.x * per_s, p.y * per_s, cosine};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const T k = T(1) / ((across_length(r) * s.distance.d + r.z) * s.distance.per_sum.as<T>());
        return {r.x * k, r.y * k};
    }
};
