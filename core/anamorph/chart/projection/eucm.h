// SPDX-License-Identifier: Apache-2.0
// The enhanced unified camera model (Khomutenko, Garcia and Martinet 2016) with beta = d and alpha = e:
// X = x / (alpha n + (1 - alpha) z) with n^2 = beta (x^2 + y^2) + z^2. With beta = 1 it is the unified model of
// xi = alpha / (1 - alpha). Any other beta stretches the ray across the axis by its root, and shrinks X by as much.

struct Eucm : AnyProjection {
    static constexpr FieldOfView fov{180, 360, true};
    static constexpr int numbers = 2;
    static constexpr double least_d = 1e-3;

    /// The cosine up to which stretched rays are seen. For alpha up to 1/2 the scale has no end there, alpha + (1 - alpha) cos = 0;
    /// for larger ones X turns round: its slope by the angle is a multiple of (1 - alpha) + alpha cos. It is rounded towards 0:
    /// near -1 an angle changes by many times what its cosine does.
    static double least_cosine(const Setting& s) {
        const double alpha = s.distance.e, rest = 1 - alpha;
        const double over = std::min(alpha, rest), under = std::max(alpha, rest), cosine = over / under;
        return -(std::fma(cosine, under, -over) > 0 ? std::nextafter(cosine, 0.0) : cosine);
    }
    /// The stretched angle's sine and cosine at that end: 1 + cos = |2 alpha - 1| over the larger of alpha and 1 - alpha.
    static void end_of_angles(const Setting& s, DoubleDouble& sine, DoubleDouble& cosine) {
        const DoubleDouble alpha = s.distance.e, under = max(alpha, 1 - alpha);
        const DoubleDouble more = fabs(2 * alpha - 1) / under;
        cosine = more - 1;
        sine = sqrt(more * (2 - more));
    }
    /// The largest field of view, no more than it is: DoubleDouble is off by less than the double pi and the quotient.
    static double most_fov(const FieldOfView& most, const Setting& s) {
        DoubleDouble sine, cosine;
        end_of_angles(s, sine, cosine);
        return below(most, atan2(sine, sqrt(DoubleDouble(s.distance.d)) * cosine));
    }
    static DoubleDouble width(DoubleDouble degrees, const Setting& s) { return span<Eucm>(degrees, s).value; }
    static double width_units(DoubleDouble degrees, const Setting& s) { return span<Eucm>(degrees, s).units; }
    static double largest_tangent(double half_width, double half_height) {
        return std::max(half_width, half_height);
    }

    /// For alpha above 1/2 a picture ends where X turns round: beta r^2 (2 alpha - 1) = 1.
    template <class T>
    static T inside(const Point<T>& p, const Setting& s) {
        return 1 * kSlack - (square(p.x) + square(p.y)) * (s.distance.d * (2 * s.distance.e - 1));
    }
    template <class T>
    static T sees(const Ray<T>& r, const Setting& s) {
        const T n = sqrt(T((square(r.x) + square(r.y)) * s.distance.d + square(r.z)));
        return sees_before(r, n, s, s.reach);
    }
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        const T k = (square(p.x) + square(p.y)) * s.distance.d;
        return seen_at(p, k, s);
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const T n = sqrt(T((square(r.x) + square(r.y)) * s.distance.d + square(r.z)));
        const T k = T(1) / scale_of(r.z, n, s);
        return {r.x * k, r.y * k};
    }

  protected:
    /// Twice an angle in degrees, in double no more than it is in DoubleDouble, and at most what is allowed.
    static double below(const FieldOfView& most, DoubleDouble angle) {
        // The conversion to double and the product are off by half of 2^-52 each, and DoubleDouble by far less.
        constexpr double kBelow = 1 - 4 * 0x1p-52;
        return std::min(most.most, static_cast<double>(2 * angle / kDegree) * kBelow);
    }
    /// What a ray's point is divided by, for a ray of the length n: alpha n + (1 - alpha) z.
    template <class T>
    static T scale_of(const T& z, const T& n, const Setting& s) {
        return n * s.distance.e + z * s.distance.rest.as<T>();
    }
    /// Is a ray of length n seen: before its cosine is least, and where its point is within `reach`?
    template <class T>
    static T sees_before(const Ray<T>& r, const T& n, const Setting& s, double reach) {
        const T far = scale_of(r.z, n, s) * reach;
        return min(T(r.z - n * least_cosine(s)),
                   min(min(T(far - r.x), T(far + r.x)), min(T(far - r.y), T(far + r.y))));
    }
    /// The ray that is seen at a point, 1 + (1 - alpha)^2 k long if it is stretched, for k = beta r^2. With
    /// q = sqrt(1 + (1 - 2 alpha) k) it is X (alpha + (1 - alpha) q) across and q - alpha (1 - alpha) k ahead: what X is divided by
    /// then is alpha + (1 - alpha) q.
    template <class T>
    static Ray<T> seen_at(const Point<T>& p, const T& k, const Setting& s) {
        const T q = sqrt(without_hair(T(1.0 + k * s.distance.difference.as<T>())));
        const T across = q * s.distance.rest.as<T>() + s.distance.e;
        return {p.x * across, p.y * across, q - k * s.distance.product.as<T>()};
    }
};
