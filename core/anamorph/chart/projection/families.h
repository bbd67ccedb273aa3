// SPDX-License-Identifier: Apache-2.0
// The members that projections of one family share. There is no include guard and no namespace, as list.h says.

/// A degree, off by less than 2^-113.
inline constexpr DoubleDouble kDegree{0x1.1df46a2529d39p-6, 0x1.5c1d8becdd291p-62};

/// The sine of an angle in degrees.
inline DoubleDouble sine_of(const DoubleDouble& degrees) {
    DoubleDouble sine, cosine;
    sin_cos(degrees * kDegree, sine, cosine);
    return sine;
}
/// The tangent of an angle of 0 to 90 degrees. Near 90 it is found from 90 degrees less the angle, which is exact.
inline DoubleDouble tan_of(const DoubleDouble& degrees) {
    return degrees > 45 ? 1 / tan((90 - degrees) * kDegree) : tan(degrees * kDegree);
}

/// The defaults of all projections. A projection has to define `ray` and `point`:
///   Ray<T> ray(const Point<T>& plane, const Setting&)     the local ray of a point of the plane
///   Point<T> point(const Ray<T>& local, const Setting&)   the point of the plane of a local ray
struct AnyProjection {
    /// An alias of the projection's name; empty where there is none.
    static constexpr std::string_view alias = "";
    static constexpr Counted counted = Counted::none;
    /// The numbers of faces across and down the picture; each is square. 0: the picture is one piece of any shape.
    static constexpr int columns = 0, rows = 0;
    static std::vector<Face> faces() { return {}; }
    /// The distance of the centres of faces from the middle of the plane, along x and along y, where faces are parts of one
    /// picture; 0 where each has a plane of its own.
    static constexpr double face_centre = 0;
    /// May faces be oblong in pixels, as those of films are?
    static constexpr bool has_oblong_faces = false;
    /// Is the middle of the picture straight behind?
    static constexpr bool looks_back = false;
    /// How many numbers does the picture depend on: 1, the distance d, or 2, with e? And what these may be.
    static constexpr int numbers = 0;
    static constexpr double least_d = -0.999, most_d = 1000;
    /// Is every direction seen by the face that it is nearest to?
    static bool faces_see_all(const Setting&) { return true; }
    static constexpr Lensed lensed = Lensed::no;
    /// Does a full turn fill whole rows, which close on themselves at a column?
    static constexpr bool closes = false;
    /// Are the first and last row of a full picture the poles?
    static constexpr bool has_pole_rows = false;

    /// The width of the plane that a field of view in degrees covers.
    static DoubleDouble width(DoubleDouble degrees, const Setting&) { return degrees * kDegree; }
    /// The largest error of the pixels per unit of the plane, and of their inverse, in units of DoubleDouble (2^-64 of them).
    ///
    /// kDegree is off by 2, of pi and of the quotient; an angle, a whole fraction of `degrees` times that, by 3. A sine of 0 to
    /// 90 degrees changes by x cot x, at most 1, of its angle's relative change, and libm adds 8 (Rounded::kLibm): 11. A tangent
    /// of 0 to 45 degrees changes by 2 x / sin 2x, at most pi / 2, of it: 5 + 8, and 1 for 1 over it: 14. Widths are such an
    /// angle, sine or tangent times a power of two (a constant is exact), so they are off by 14 at most. Rows between pixel
    /// centres take most of what follows, a product and two quotients, and 1 more for the inverse: 18. Which is doubled nearly.
    static double width_units(DoubleDouble, const Setting&) { return 32; }
    /// The width of the whole plane of a projection that shows the direction straight behind all around its rim.
    static double diameter(const Setting&) { return HUGE_VAL; }
    /// The largest tangent of a ray in the corner of a plane of twice this size; 0: there is no limit.
    static double largest_tangent(double, double) { return 0; }
    /// The largest field of view in degrees, where it depends on the setting.
    static double most_fov(const FieldOfView& fov, const Setting&) { return fov.most; }
    /// Units of the plane per radian straight ahead.
    static constexpr double per_radian = 1;
    /// The height over the width of a picture of a field of view in degrees.
    static double aspect(double) { return 1; }

    /// The tolerance of limits, so that the last pixel of a full picture is never lost to rounding.
    static constexpr double kSlack = 1 + 1e-12;
    /// A number that is >= 0 where a point of the plane has a ray.
    template <class T>
    static T inside(const Point<T>&, const Setting&) {
        return T(1);
    }
    /// A number that is > 0 where a local ray is seen, and lies on the face it is local to. A projection that cannot show
    /// all directions ends where their tangents are as large as the setting's reach.
    template <class T>
    static T sees(const Ray<T>&, const Setting&) {
        return T(1);
    }
    /// A number that is 0 only where the formulas have a crease, in the plane; ray_crease() is the same for local rays.
    template <class T>
    static T plane_crease(const Point<T>&) {
        return T(1);
    }
    template <class T>
    static T ray_crease(const Ray<T>&) {
        return T(1);
    }
};

/// The family of projections whose X is the azimuth.
struct CylinderFamily : AnyProjection {
    static constexpr Counted counted = Counted::azimuth;
    static constexpr FieldOfView fov{360, 360};
    static constexpr bool closes = true;
};

/// The family of projections whose radius is a function of the angle t from the axis.
struct AxisFamily : AnyProjection {
    static constexpr FieldOfView fov{180, 360};
    static constexpr Lensed lensed = Lensed::axial;
};

/// The family of flat pictures, where a ray's point is where it meets the plane z = 1.
struct FlatFamily : AnyProjection {
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting&) {
        return {p.x, p.y, T(1)};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting&) {
        return {r.x / r.z, r.y / r.z};
    }
};

/// The family of cube maps: six faces, on each of which the forward component of a ray is the largest.
struct CubeFamily : FlatFamily {
    static constexpr FieldOfView fov{90, 90, false, true};

    static DoubleDouble width(DoubleDouble, const Setting&) { return 2; }

    template <class T>
    static T sees(const Ray<T>& r, const Setting&) {
        return min(min(r.z - r.x, r.z + r.x), min(r.z - r.y, r.z + r.y));
    }
};

/// A number of which DoubleDouble has a value that is off by `error` at most.
inline Rounded<DoubleDouble> known_to(DoubleDouble value, double error) {
    const double at = static_cast<double>(value);
    auto r = Rounded<DoubleDouble>::near(at, error + 0x1p-53 * std::fabs(at));
    r.error = error;
    return r;
}

/// A width of the plane, and width_units() of it (AnyProjection).
struct Span {
    DoubleDouble value;
    double units;
};
/// The width by the point of the ray half of `degrees` to the right, for projections with an axis that know no better. The angle, of
/// up to 90 degrees from ahead or behind, is off by 3 units of it and libm by 8 of what it gives: the sine by 11 of its own, since it
/// changes by at most as much of itself as its angle does, and the cosine by 3 pi / 2 + 8, below 18. What follows is read with
/// its rounding; 4 units are for what is computed from the width, and all of it is doubled nearly.
template <class P>
Span span(DoubleDouble degrees, const Setting& s) {
    using R = Rounded<DoubleDouble>;
    const DoubleDouble half = degrees / 2;
    const bool behind = half > 90;
    const DoubleDouble angle = (behind ? 180 - half : half) * kDegree;
    DoubleDouble sine, cosine;
    sin_cos(angle, sine, cosine);
    if (behind) cosine = -cosine;
    const Ray<R> bound{known_to(sine, 11 * R::kUnit * static_cast<double>(sine)), R(0),
                       known_to(cosine, 18 * R::kUnit)};
    const DoubleDouble value = 2 * P::point(Ray<DoubleDouble>{sine, 0, cosine}, s).x;
    const double units = 2 * P::point(bound, s).x.error / (R::kUnit * static_cast<double>(value));
    return {value, 1.8 * (units + 4)};
}

/// The square root of x^2 + y^2.
template <class T>
T length(const T& x, const T& y) {
    return sqrt(T(square(x) + square(y)));
}

/// Finds sin t / t and cos t from the square of t.
template <class T>
void sinc_cos(const T& t_squared, T& sinc, T& cos) {
    const T t = sqrt(t_squared);
    T sin;
    sin_cos(t, sin, cos);
    sinc = select(is_zero(t), T(1), T(sin / t));
}

/// Is a number off by some roundings, as what is far from an axis is?
template <class Real>
bool is_ordinary(const Rounded<Real>& number) {
    return number.error < 1024 * Rounded<Real>::kUnit;
}

/// Is a bound so much smaller than another, which may be none, that it takes its place?
inline bool is_far_better(double bound, double other) {
    return !(other < 1024 * bound);
}

/// The same of what rounding does to them. Of zero, and what is next to it, by Lipschitz constants in s = t^2, which the quotient does
/// not have: d(sin t / t) / ds = -(sin t - t cos t) / (2 t^3), at most 1/6, as sin t - t cos t is the integral of u sin u, at most that
/// of u^2; d(cos t) / ds = -sin t / (2 t), at most 1/2. The root is off by 1 unit of t, so 2 of s and their square; a sine and its
/// quotient by the same root by libm's error and 1 unit more. They are taken where they are far better: elsewhere the bounds of a
/// quotient do, and pictures are divided as ever.
template <class Real>
void sinc_cos(const Rounded<Real>& t_squared, Rounded<Real>& sinc, Rounded<Real>& cos) {
    using R = Rounded<Real>;
    const R t = sqrt(t_squared);
    R sin;
    sin_cos(t, sin, cos);
    sinc = select(is_zero(t), R(1), R(sin / t));
    const double most = t_squared.range.hi;
    if (is_ordinary(sinc) || t_squared.is_jet() || !(most + t_squared.error <= 1)) return;
    const double off = t_squared.error + 3 * R::kUnit * (most + t_squared.error);
    const double bound = (off / 6 + R::kLibm + 2 * R::kUnit) * rounded_detail::kUp;
    if (!is_far_better(bound, sinc.error)) return;
    const Interval s(0, std::max(most, 0.0));
    sinc = R(Interval(1) - s * Interval(0, 1.0 / 6 + 0x1p-50), 0, bound);
    cos = R(Interval(1) - s * Interval(0, 0.5), 0, (off / 2 + R::kLibm) * rounded_detail::kUp);
}

/// The angle of (across, ahead), counted from `along`.
template <class T>
T tilt(const T& across, const T& ahead, const Heading& along) {
    const auto cos = measured<T>(along.cos, along.error), sin = measured<T>(along.sin, along.error);
    return atan2(T(across * cos - ahead * sin), T(ahead * cos + across * sin)) + along.angle;
}

/// The angle of (across, ahead) over `across`; on the axis, where that is 0, 1 / ahead.
template <class T, class Condition>
T tilt_over_across(const Condition& on_axis, const T& across, const T& ahead, const Heading& along) {
    return select(on_axis, T(T(1) / ahead), T(tilt(across, ahead, along) / across));
}
/// The same of what rounding does to it. Next to the axis ahead, with q = across / ahead, it is A(q) / ahead with A(q) = atan(q) / q,
/// and A'(q) = -(atan q - q / (1 + q^2)) / q^2. The numerator is the integral of 2 u^2 / (1 + u^2)^2, which is at most 2 u^2 and at most
/// 1/2: |A'| is at most 2 q / 3 and at most 1 / (2 q), so never above 0.58, the root of 1/3. What is computed is A of the computed
/// numbers, but for libm and a quotient; A is from 1 - q^2 / 3 to 1.
template <class Real, class Condition>
Rounded<Real> tilt_over_across(const Condition& on_axis, const Rounded<Real>& across,
                               const Rounded<Real>& ahead, const Heading& along) {
    using R = Rounded<Real>;
    const R plain = select(on_axis, R(R(1) / ahead), R(tilt(across, ahead, along) / across));
    const bool is_counted_from_ahead = along.sin == 0 && along.cos > 0 && along.angle == 0;
    if (is_ordinary(plain) || across.is_jet() || ahead.is_jet() || !is_counted_from_ahead) return plain;
    const R q = across / ahead;
    if (!(lower_end(ahead) > 0 && magnitude(q.range) + q.error <= 1)) return plain;
    const double far = magnitude(q.range);
    const R better =
        R(Interval(1 - far * far / 3 * rounded_detail::kUp, 1), 0, 0.58 * q.error + R::kLibm + 2 * R::kUnit) /
        ahead;
    return is_far_better(better.error, plain.error) ? better : plain;
}

/// A ray of the same direction, made longer where the squares of x and z would underflow.
template <class T>
Ray<T> with_squares(const Ray<T>& r) {
    const auto k = enlarger(r.x, r.z);
    return {r.x * k, r.y * k, r.z * k};
}

/// The length of a ray's part perpendicular to the vertical axis.
template <class T>
T across_length(const Ray<T>& r) {
    return length(r.x, r.z);
}

/// The sum n + z for n^2 = rho^2 + z^2, without cancellation where z is negative.
template <class T>
T add_to_length(const T& n, const T& z, const T& rho_squared) {
    const auto behind = is_negative(z);
    // Only one of the two divisors is used, and it is at least n.
    return select(behind, T(rho_squared / (n + select(behind, T(-z), z))), T(n + z));
}
