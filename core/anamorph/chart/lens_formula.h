// SPDX-License-Identifier: Apache-2.0
// A lens's distortion in its own units, about its own centre: F(u) = (S + 2 m.u) u + |u|^2 m + |u|^2 a + |u|^4 b, with S a
// polynomial in r = |u| or r^2, or a quotient of two; of one model only, m = (p2, p1), the tangential part (Brown 1966), and
// a = (s1, s3), b = (s2, s4), a thin prism. What the models are is said in chart/lens.h.
//
// No include guard and no namespace: vectors need the templates compiled for each instruction set, so whoever reads
// them includes this file inside a namespace of his own (chart/lens.h, panorama/panorama_rows_lanes.cpp), where somewhere(condition)
// is known for his numbers: does it hold for any lane?

/// A Taylor polynomial in one variable, of degree N.
template <class T, int N>
struct Series {
    static constexpr int kDegree = N;

    T c[N + 1];

    Series() {
        for (T& k : c) k = T(0);
    }
    Series(const T& constant) : Series() { c[0] = constant; }  // NOLINT: a number is a series
    static Series variable(const T& value) {
        Series s(value);
        s.c[1] = T(1);
        return s;
    }
};

template <class T, int N>
Series<T, N> operator+(const Series<T, N>& a, const Series<T, N>& b) {
    Series<T, N> s;
    for (int k = 0; k <= N; ++k) s.c[k] = a.c[k] + b.c[k];
    return s;
}
template <class T, int N>
Series<T, N> operator-(const Series<T, N>& a, const Series<T, N>& b) {
    Series<T, N> s;
    for (int k = 0; k <= N; ++k) s.c[k] = a.c[k] - b.c[k];
    return s;
}
template <class T, int N>
Series<T, N> operator*(const Series<T, N>& a, const Series<T, N>& b) {
    Series<T, N> s;
    for (int k = 0; k <= N; ++k) {
        s.c[k] = a.c[0] * b.c[k];
        for (int j = 1; j <= k; ++j) s.c[k] = s.c[k] + a.c[j] * b.c[k - j];
    }
    return s;
}
/// The quotient q with q b = a: b_0 q_k = a_k - sum_(j<k) q_j b_(k-j).
template <class T, int N>
Series<T, N> operator/(const Series<T, N>& a, const Series<T, N>& b) {
    Series<T, N> q;
    for (int k = 0; k <= N; ++k) {
        T rest = a.c[k];
        for (int j = 0; j < k; ++j) rest = rest - q.c[j] * b.c[k - j];
        q.c[k] = rest / b.c[0];
    }
    return q;
}

/// What formulas of numbers are to series: a root, r_0 r_k = (a_k - sum_(0<j<k) r_j r_(k-j)) / 2, and a choice by the constant part.
template <class T>
T root_of(const T& a) {
    return sqrt(a);
}
template <class T, int N>
Series<T, N> root_of(const Series<T, N>& a) {
    Series<T, N> r(sqrt(a.c[0]));
    for (int k = 1; k <= N; ++k) {
        T rest = a.c[k];
        for (int j = 1; j < k; ++j) rest = rest - r.c[j] * r.c[k - j];
        r.c[k] = rest / (r.c[0] * 2.0);
    }
    return r;
}
template <class T>
T choose_if_negative(const T& a, const T& then, const T& otherwise) {
    return select(is_negative(a), then, otherwise);
}
template <class T, int N>
Series<T, N> choose_if_negative(const Series<T, N>& a, const Series<T, N>& then,
                                const Series<T, N>& otherwise) {
    const auto negative = is_negative(a.c[0]);
    Series<T, N> s;
    for (int k = 0; k <= N; ++k) s.c[k] = select(negative, then.c[k], otherwise.c[k]);
    return s;
}

/// The sum g + sqrt(g^2 + t^2) by the square of t, without cancellation where g is negative. The quotient is chosen there only:
/// in the middle, where it is none, g is positive.
template <class T>
T add_length(const T& g, const T& squared) {
    const T n = root_of(T(g * g + squared));
    return choose_if_negative(g, T(squared / (n - g)), T(n + g));
}

/// A constant as a factor of a number, or of a series of numbers.
template <class T>
auto read_constant(const Constant& k, const T&) {
    return k.template as<T>();
}
template <class T, int N>
T read_constant(const Constant& k, const Series<T, N>&) {
    return T(k.template as<T>());
}

/// The sum c[0] + c[1] t + ..., by Horner's rule.
template <class T>
T sum_of_powers(const Constant* c, int count, const T& t) {
    T sum = T(read_constant(c[count - 1], t));
    for (int i = count - 2; i >= 0; --i) sum = sum * t + T(read_constant(c[i], t));
    return sum;
}

/// The factor S (of a direction, chart/lens.h) at t, with t = r where the polynomials are in r, else r^2.
template <class T>
T stretch_at(const LensTerms& lens, const T& t) {
    const T over = sum_of_powers(lens.over, lens.over_count, t);
    if (lens.of_direction) {
        const T ahead = sum_of_powers(lens.under, lens.under_count, t);
        return over / add_length(ahead, lens.in_radius ? T(t * t) : t);
    }
    if (lens.under_count == 1) return over;
    return over / sum_of_powers(lens.under, lens.under_count, t);
}

/// The distorted t: the radius |F|, or its square where t is a square; for a lens without a tangential part.
template <class T>
T radial_at(const LensTerms& lens, const T& t) {
    const T stretch = stretch_at(lens, t);
    return lens.in_radius ? T(t * stretch) : T(t * (stretch * stretch));
}

/// The t of a point: its radius r, or r^2, as stretch_at() takes it.
template <class T>
T radial_of(const LensTerms& lens, const Point<T>& u) {
    const T squared = square(u.x) + square(u.y);
    if (!lens.in_radius) return squared;
    const auto centre = is_zero(squared);
    return select(centre, T(0), sqrt(T(select(centre, T(1), squared))));
}

/// The factor S at a point.
template <class T>
T stretch_of(const LensTerms& lens, const Point<T>& u) {
    return stretch_at(lens, radial_of(lens, u));
}

/// What a thin prism adds to a point; `squared` is the square of its distance from the centre.
template <class T>
Point<T> through_prism(const LensTerms& lens, const Point<T>& p, const T& squared) {
    if (!lens.prism) return p;
    const T fourth = square(squared);
    return {p.x + squared * lens.ax + fourth * lens.bx, p.y + squared * lens.ay + fourth * lens.by};
}

/// The part of F that is not radial.
template <class T>
Point<T> tangential_at(const LensTerms& lens, const Point<T>& u) {
    const T squared = square(u.x) + square(u.y), along = (u.x * lens.mx + u.y * lens.my) * 2.0;
    return through_prism(lens, Point<T>{u.x * along + squared * lens.mx, u.y * along + squared * lens.my},
                         squared);
}

/// The distorted point F(u). For lenses with a tangential part S is a function of r^2.
template <class T>
Point<T> distorted(const LensTerms& lens, const Point<T>& u) {
    if (!lens.tangential) {
        const T stretch = stretch_of(lens, u);
        return {u.x * stretch, u.y * stretch};
    }
    const T squared = square(u.x) + square(u.y), along = (u.x * lens.mx + u.y * lens.my) * 2.0;
    const T stretch = stretch_at(lens, squared) + along;
    return through_prism(lens, Point<T>{u.x * stretch + squared * lens.mx, u.y * stretch + squared * lens.my},
                         squared);
}

/// The unit roundoff of T, relative to the number; 0 where it is not known.
template <class T>
constexpr double unit_of() {
    if constexpr (requires { typename T::Scalar; })
        return unit_of<typename T::Scalar>();
    else if constexpr (std::is_floating_point_v<T> || std::is_same_v<T, DoubleDouble>)
        return unit_roundoff<T>();
    else
        return 0;
}

/// The first approximation of radial_root().
template <class T>
T near_root(const LensTerms& lens, const T& value) {
    return T(value * lens.slope);
}
/// Finds the root t of radial_at(t) = value, which rises up to the lens's end, by Newton's iteration in a bracket. It ends
/// where the residual is within kResidual roundings, which is all that is relied upon. Each lane stands still from then on,
/// so it does not depend on its neighbours.
template <class T>
T radial_root(const LensTerms& lens, const T& value) {
    // So many steps are Newton's where they stay in the bracket. Beyond, every other one halves it, more often than
    // numbers have digits, down to kSmall.
    constexpr int kFree = 10, kMost = 10 + 2 * (64 + 24 + 12);
    const T goal = min(value, T(lens.value_end));
    const double unit = LensTerms::kResidual * unit_of<T>() * lens.condition;
    const T residual = (goal + LensTerms::kSmall * lens.value_end) * unit;
    T low(0), high(lens.end), t = min(near_root(lens, goal), high);
    for (int i = 0; i < kMost; ++i) {
        const Series<T, 1> at = radial_at(lens, Series<T, 1>::variable(t));
        const T off = at.c[0] - goal;
        const auto open = is_negative(T(residual - max(off, T(-off))));
        if (!somewhere(open)) break;
        const auto below = is_negative(off);
        low = select(below, t, low);
        high = select(below, high, t);
        const T middle = (low + high) * 0.5, step = t - off / at.c[1];
        const bool halve = i >= kFree && i % 2 == 0;
        const T next = halve ? middle : select(is_negative(T((step - low) * (high - step))), middle, step);
        t = select(open, next, t);
    }
    return t;
}

/// The inverse of a power series without its constant: the x with g_1 x + g_2 x^2 + ... = y, by powers of y (Lagrange).
template <class T, int N>
Series<T, N> reversed(const Series<T, N>& g) {
    static_assert(N >= 1 && N <= 5);
    Series<T, N> x;
    const T r = T(1) / g.c[1];
    T b[6] = {T(0), T(1), T(0), T(0), T(0), T(0)}, power = r;
    for (int k = 2; k <= N; ++k) b[k] = g.c[k] * r;
    const T b22 = b[2] * b[2];
    const T a[6] = {T(0),
                    T(1),
                    -b[2],
                    b22 * 2.0 - b[3],
                    b[2] * b[3] * 5.0 - b22 * b[2] * 5.0 - b[4],
                    b22 * b22 * 14.0 - b22 * b[3] * 21.0 + b[2] * b[4] * 6.0 + b[3] * b[3] * 3.0 - b[5]};
    for (int k = 1; k <= N; ++k, power = power * r) x.c[k] = a[k] * power;
    return x;
}

/// The Taylor series of shrink() about a value whose root is `t`.
template <int N, class T>
Series<T, N> shrink_series(const LensTerms& lens, const T& t) {
    using S = Series<T, N>;
    S root = reversed(radial_at(lens, S::variable(t)));
    root.c[0] = t;
    return S(T(1)) / stretch_at(lens, root);
}

/// The factor by which F(u) = v is undone for a lens without a tangential part: u = v shrink(t of v).
template <class T>
T shrink(const LensTerms& lens, const T& value) {
    return T(1) / stretch_at(lens, radial_root(lens, value));
}

/// shrink() at a point v.
template <class T>
T shrink_of(const LensTerms& lens, const Point<T>& v) {
    return shrink(lens, radial_of(lens, v));
}

/// The point u with S u = v, which undoes the radial part of the distortion.
template <class T>
Point<T> radially_undistorted(const LensTerms& lens, const Point<T>& v) {
    const T k = shrink_of(lens, v);
    return {v.x * k, v.y * k};
}

/// A step towards u with F(u) = v: what is left of v without u's tangential part. The distance to u becomes half as large
/// at most, as far as the lens goes (set_ends() in lens.cpp).
template <class T>
Point<T> nearer(const LensTerms& lens, const Point<T>& v, const Point<T>& u) {
    const Point<T> more = tangential_at(lens, u);
    return radially_undistorted(lens, Point<T>{v.x - more.x, v.y - more.y});
}

/// The derivative of F: a symmetric matrix, S + 2 m.u along the diagonal, 2 S' u u^T with S' by |u|^2, and
/// 2 (u m^T + m u^T); and of a prism 2 (a + 2 b |u|^2) u^T.
template <class T>
struct Slope {
    T stretch, xx, xy, yx, yy, determinant;

    Slope(const LensTerms& lens, const Point<T>& u) {
        const T squared = square(u.x) + square(u.y);
        const auto series = stretch_at(lens, Series<T, 1>::variable(squared));
        stretch = series.c[0];
        const T along = stretch + (u.x * lens.mx + u.y * lens.my) * 2.0;
        xx = along + (series.c[1] * square(u.x) + u.x * lens.mx * 2.0) * 2.0;
        yy = along + (series.c[1] * square(u.y) + u.y * lens.my * 2.0) * 2.0;
        xy = (series.c[1] * (u.x * u.y) + u.x * lens.my + u.y * lens.mx) * 2.0;
        yx = xy;
        if (!lens.prism) {
            determinant = xx * yy - square(xy);
            return;
        }
        const T along_x = (squared * (2.0 * lens.bx) + lens.ax) * 2.0,
                along_y = (squared * (2.0 * lens.by) + lens.ay) * 2.0;
        xx = xx + along_x * u.x;
        xy = xy + along_x * u.y;
        yx = yx + along_y * u.x;
        yy = yy + along_y * u.y;
        determinant = xx * yy - xy * yx;
    }
    /// The vector that the derivative maps to (x, y).
    Point<T> solved(const T& x, const T& y) const {
        return {(yy * x - xy * y) / determinant, (xx * y - yx * x) / determinant};
    }
};

/// A step of Newton's method towards u with F(u) = v, unless it leads out of the lens.
template <class T>
Point<T> newton_step(const LensTerms& lens, const Point<T>& v, const Point<T>& u) {
    const Slope<T> slope(lens, u);
    const Point<T> more = tangential_at(lens, u);
    const Point<T> step =
        slope.solved(v.x - u.x * slope.stretch - more.x, v.y - u.y * slope.stretch - more.y);
    const Point<T> next{u.x + step.x, u.y + step.y};
    const auto within = is_negative(T(square(next.x) + square(next.y) - lens.ideal_end * lens.ideal_end));
    return {select(within, next.x, u.x), select(within, next.y, u.y)};
}

/// Solves F(u) = v for a lens with a tangential part: by Newton's method, which is fast, and then by steps of nearer(),
/// which are certain to converge, until one is negligible or kSteps are done.
template <class T>
Point<T> settled(const LensTerms& lens, const Point<T>& v) {
    Point<T> u = radially_undistorted(lens, v);
    for (int i = 0; i < LensTerms::kFastSteps; ++i) u = newton_step(lens, v, u);
    for (int i = 0; i < LensTerms::kSteps; ++i) {
        const Point<T> next = nearer(lens, v, u);
        const T x = next.x - u.x, y = next.y - u.y;
        const T left = LensTerms::kStill * unit_of<T>() * lens.ideal_end - max(max(x, T(-x)), max(y, T(-y)));
        const auto open = is_negative(left);
        u = {select(open, next.x, u.x), select(open, next.y, u.y)};
        if (!somewhere(open)) break;
    }
    return u;
}

/// Solves F(u) = v.
template <class T>
Point<T> undistorted(const LensTerms& lens, const Point<T>& v) {
    return lens.tangential ? settled(lens, v) : radially_undistorted(lens, v);
}

/// Is T a number of derivatives or bounds, for which it pays to skip operations without effect? Pixels are computed faster
/// without branches.
template <class T>
constexpr bool leaves_out() {
    return requires {
        T::kDegree;
    };
}

/// Converts a point between the units of the plane and of the lens: `scale` is per_unit or unit.
template <class T>
Point<T> scaled(const LensTerms& lens, const Point<T>& p, const Constant& scale) {
    if (leaves_out<T>() && !lens.has_unit) return p;
    const auto k = scale.as<T>();
    return {p.x * k, p.y * k};
}
/// A point times the matrix `shear` or `unshear` of a lens.
template <class T>
Point<T> sheared(const LensTerms& lens, const Point<T>& p, const Constant (&by)[4]) {
    if (!lens.sheared) return p;
    return {p.x * by[0].as<T>() + p.y * by[1].as<T>(), p.x * by[2].as<T>() + p.y * by[3].as<T>()};
}
/// A point of the observed plane in the lens's units, relative to the lens's centre, as it is before it is sheared.
template <class T>
Point<T> centred(const LensTerms& lens, const Point<T>& observed) {
    if (leaves_out<T>() && !lens.shifted)
        return sheared(lens, scaled(lens, observed, lens.per_unit), lens.unshear);
    return sheared(
        lens,
        scaled(lens, Point<T>{observed.x - lens.shift_x.as<T>(), observed.y - lens.shift_y.as<T>()},
               lens.per_unit),
        lens.unshear);
}

/// The point of the ideal plane for a point of the observed plane; observed_point() is its inverse.
template <class T>
Point<T> ideal_point(const LensTerms& lens, const Point<T>& observed) {
    const Point<T> p = centred(lens, observed);
    return scaled(lens, lens.to_observed ? undistorted(lens, p) : distorted(lens, p), lens.unit);
}
template <class T>
Point<T> observed_point(const LensTerms& lens, const Point<T>& ideal) {
    const Point<T> p = scaled(lens, ideal, lens.per_unit);
    const Point<T> made = lens.to_observed ? distorted(lens, p) : undistorted(lens, p);
    const Point<T> q = scaled(lens, sheared(lens, made, lens.shear), lens.unit);
    if (leaves_out<T>() && !lens.shifted) return q;
    return {q.x + lens.shift_x.as<T>(), q.y + lens.shift_y.as<T>()};
}

/// A number that is >= 0 where a point of the observed plane has one of the ideal plane; has_observed() is the same for a
/// point of the ideal plane.
template <class T>
T has_ideal(const LensTerms& lens, const Point<T>& observed) {
    const Point<T> p = centred(lens, observed);
    return lens.observed_end * lens.observed_end - (square(p.x) + square(p.y));
}
template <class T>
T has_observed(const LensTerms& lens, const Point<T>& ideal) {
    const Point<T> p = scaled(lens, ideal, lens.per_unit);
    return lens.ideal_end * lens.ideal_end - (square(p.x) + square(p.y));
}
