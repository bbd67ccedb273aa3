// SPDX-License-Identifier: Apache-2.0
// The double sphere model (Usenko, Demmel and Cremers 2018) with xi = d and alpha = e: a ray of length 1, as seen from xi behind the
// middle of the sphere of directions, in the unified model of that alpha. With w = z + xi and n its length then,
// X = (1 + xi) x / (alpha n + (1 - alpha) w): 1 + xi, by which lengths are per unit straight ahead.

struct DoubleSphere : Eucm {
    static constexpr FieldOfView fov{180, 360, true};
    static constexpr double least_d = -0.999, most_d = 1;

    /// The angle t whose ray is seen at the angle u from behind, sin(t - u) = xi sin u, at the end of the angles u.
    static double most_fov(const FieldOfView& most, const Setting& s) {
        DoubleDouble sine, cosine;
        end_of_angles(s, sine, cosine);
        return below(most, atan2(sine, cosine) + asin(s.distance.d * sine));
    }
    static DoubleDouble width(DoubleDouble degrees, const Setting& s) {
        return span<DoubleSphere>(degrees, s).value;
    }
    static double width_units(DoubleDouble degrees, const Setting& s) {
        return span<DoubleSphere>(degrees, s).units;
    }

    /// For xi = 1 the direction straight behind is all of the rim, X = (1 + xi) / alpha.
    static double diameter(const Setting& s) {
        return s.distance.d == 1 && s.distance.e > 0 ? 4 / s.distance.e : HUGE_VAL;
    }
    /// For alpha above 1/2 a picture ends where X turns round, r^2 (2 alpha - 1) = (1 + xi)^2; for xi = 1 at its rim, which is nearer.
    template <class T>
    static T inside(const Point<T>& p, const Setting& s) {
        const double alpha = s.distance.e, per_sum = s.distance.per_sum.value();
        const double k = s.distance.d == 1 ? alpha * alpha : 2 * alpha - 1;
        return 1 * kSlack - (square(p.x) + square(p.y)) * (k * per_sum * per_sum);
    }
    template <class T>
    static T sees(const Ray<T>& r, const Setting& s) {
        const Ray<T> w = from_behind(r, s);
        return sees_before(w, length_of(w), s, s.reach * s.distance.per_sum.value());
    }
    /// The point of the sphere where the ray w from behind meets it: (g w - xi n^2 e_z) / n^2 for w of length n, with
    /// g = xi w_z + sqrt(w_z^2 + (1 - xi^2) (w_x^2 + w_y^2)).
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        const auto per_sum = s.distance.per_sum.as<T>();
        const Point<T> at{p.x * per_sum, p.y * per_sum};
        const Ray<T> w = seen_at(at, T(square(at.x) + square(at.y)), s);
        const T across = square(w.x) + square(w.y), ahead = square(w.z);
        const T g = w.z * s.distance.d + sqrt(T(ahead + across * s.distance.less_square.as<T>()));
        return {w.x * g, w.y * g, w.z * g - (across + ahead) * s.distance.d};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const Ray<T> w = from_behind(r, s);
        const T k = T(1) / (scale_of(w.z, length_of(w), s) * s.distance.per_sum.as<T>());
        return {r.x * k, r.y * k};
    }

  private:
    template <class T>
    static T length_of(const Ray<T>& r) {
        return sqrt(T(square(r.x) + square(r.y) + square(r.z)));
    }
    template <class T>
    static Ray<T> from_behind(const Ray<T>& r, const Setting& s) {
        return {r.x, r.y, length_of(r) * s.distance.d + r.z};
    }
};
