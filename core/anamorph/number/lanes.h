// SPDX-License-Identifier: Apache-2.0
// Several numbers at a time: a vector of double or float (Highway's) as a number that formulas are read with.
//
// Compiled for each instruction set, so there is no include guard and no namespace: a file *_lanes.cpp
// includes this inside its HWY_NAMESPACE, after highway.h, with hn for hwy::HWY_NAMESPACE.
//
// Every result is made of sums, products, quotients and roots that are rounded once, each on its own (no
// fused multiply-add, no estimate): all instruction sets give the same bits. Errors, in units of 2^-53 for
// double and 2^-24 for float, with m for the magnitude of the exact value (tests/core/test_lanes.cpp holds
// them):
//
//   + - * / sqrt square             1 m
//   sin_cos(a)  |a| <= 1e4          4 m in double; 2 + |a| 2^-11 in float (absolute)
//   atan2                           5 m
//   exp  log                        3 m      gradual underflow apart
//   asinh                           8 m
//   sine_versine(a, s, v)           4 m      |a| <= pi / 4; gradual underflow of v apart
//   small_atan(a)                   4 m      |a| <= tan(pi / 8)
//   small_angle(y, x)               6 m      |y| <= tan(3 pi / 8) x, x > 0
//   scaled_sinh(a, s)               8 m      s; 5 m what is returned, gradual underflow apart
//
// NaN and infinities come out as IEEE has them for + - * / sqrt; the functions give NaN for NaN.

// Are functions of several operations called? They are where numbers are single, for processors of before 2008: a copy in each formula would
// take long to compile. (WebAssembly has its doubles so.)
#undef ANAMORPH_LANES_CALLED
#define ANAMORPH_LANES_CALLED (HWY_TARGET == HWY_SCALAR && !HWY_ARCH_WASM)
#undef ANAMORPH_LANES_INLINE
#if ANAMORPH_LANES_CALLED
#define ANAMORPH_LANES_INLINE inline
#else
#define ANAMORPH_LANES_INLINE HWY_INLINE
#endif

/// The lanes for which a condition holds.
template <class Tag>
struct LaneMask {
    hn::Mask<Tag> m;

    // GCC compiles constructors that are not written for no instruction set, and NEON's masks have one that it then cannot call.
    HWY_INLINE LaneMask() {}
    HWY_INLINE LaneMask(hn::Mask<Tag> mask) : m(mask) {}  // NOLINT: as an aggregate would be made

    friend HWY_INLINE LaneMask both(const LaneMask& a, const LaneMask& b) { return {hn::And(a.m, b.m)}; }
};

template <class Tag>
struct Lanes {
    using D = Tag;
    using Scalar = hn::TFromD<D>;
    using V = hn::Vec<D>;
    using M = LaneMask<D>;
    static constexpr int kCount = static_cast<int>(hn::MaxLanes(D()));

    V v;

    Lanes() = default;
    HWY_INLINE Lanes(double k) : v(hn::Set(D(), static_cast<Scalar>(k))) {}  // NOLINT: a number is many
    HWY_INLINE explicit Lanes(V values) : v(values) {}

    static HWY_INLINE Lanes load(const Scalar* from) { return Lanes(hn::LoadU(D(), from)); }
    HWY_INLINE void store(Scalar* to) const { hn::StoreU(v, D(), to); }

    friend HWY_INLINE Lanes operator-(const Lanes& a) { return Lanes(hn::Neg(a.v)); }
    friend HWY_INLINE Lanes operator+(const Lanes& a, const Lanes& b) { return Lanes(hn::Add(a.v, b.v)); }
    friend HWY_INLINE Lanes operator-(const Lanes& a, const Lanes& b) { return Lanes(hn::Sub(a.v, b.v)); }
    friend HWY_INLINE Lanes operator*(const Lanes& a, const Lanes& b) { return Lanes(hn::Mul(a.v, b.v)); }
    friend HWY_INLINE Lanes operator/(const Lanes& a, const Lanes& b) { return Lanes(hn::Div(a.v, b.v)); }

    friend HWY_INLINE Lanes square(const Lanes& a) { return a * a; }
    friend HWY_INLINE Lanes sqrt(const Lanes& a) { return Lanes(hn::Sqrt(a.v)); }
    friend HWY_INLINE Lanes length(const Lanes& a, const Lanes& b) { return sqrt(a * a + b * b); }
    friend HWY_INLINE Lanes abs(const Lanes& a) { return Lanes(hn::Abs(a.v)); }
    // As std::min and std::max: the first where the two do not compare.
    friend HWY_INLINE Lanes min(const Lanes& a, const Lanes& b) { return select(b < a, b, a); }
    friend HWY_INLINE Lanes max(const Lanes& a, const Lanes& b) { return select(a < b, b, a); }

    friend HWY_INLINE M operator<(const Lanes& a, const Lanes& b) { return {hn::Lt(a.v, b.v)}; }
    friend HWY_INLINE M is_zero(const Lanes& a) { return {hn::Eq(a.v, hn::Zero(D()))}; }
    friend HWY_INLINE M is_negative(const Lanes& a) { return {hn::Lt(a.v, hn::Zero(D()))}; }
    friend HWY_INLINE Lanes without_hair(const Lanes& a) {
        return select(both(is_negative(a), Lanes(-0x1p-38) < a), Lanes(0), a);
    }
    friend HWY_INLINE Lanes enlarger(const Lanes& a, const Lanes& b) {
        constexpr bool kDouble = sizeof(Scalar) == 8;
        return select(max(abs(a), abs(b)) < Lanes(kDouble ? 0x1p-400 : 0x1p-50),
                      Lanes(kDouble ? 0x1p500 : 0x1p60), Lanes(1));
    }
    friend HWY_INLINE Lanes select(const M& where, const Lanes& a, const Lanes& b) {
        return Lanes(hn::IfThenElse(where.m, a.v, b.v));
    }
};

/// The polynomial c[0] + c[1] x + ..., by Horner's rule.
template <class D, std::size_t N>
HWY_INLINE Lanes<D> polynomial(const Lanes<D>& x, const double (&c)[N]) {
    Lanes<D> sum(c[N - 1]);
    for (std::size_t i = N - 1; i > 0; --i) sum = sum * x + Lanes<D>(c[i - 1]);
    return sum;
}

/// Integers in lanes.
template <class D>
using WholeLanes = hn::Vec<hn::RebindToSigned<D>>;

/// A number below 2^51 (double) or 2^22 (float) plus this has its nearest integer in its last bits, ties to
/// even. Conversions of doubles to integers are slow before AVX-512.
template <class D>
constexpr double kIntegerShift = sizeof(hn::TFromD<D>) == 8 ? 0x1.8p52 : 0x1.8p23;

template <class D>
HWY_INLINE WholeLanes<D> shift_bits() {
    return hn::BitCast(hn::RebindToSigned<D>(), Lanes<D>(kIntegerShift<D>).v);
}

/// The integer nearest to a; `rounded` is the same as a number.
template <class D>
HWY_INLINE WholeLanes<D> nearest_integer(const Lanes<D>& a, Lanes<D>& rounded) {
    const Lanes<D> shifted = a + Lanes<D>(kIntegerShift<D>);
    rounded = shifted - Lanes<D>(kIntegerShift<D>);
    return hn::Sub(hn::BitCast(hn::RebindToSigned<D>(), shifted.v), shift_bits<D>());
}

/// Integers in lanes as numbers; they have to be as small as those of nearest_integer().
template <class D>
HWY_INLINE Lanes<D> number_of(const WholeLanes<D>& n) {
    return Lanes<D>(hn::BitCast(D(), hn::Add(n, shift_bits<D>()))) - Lanes<D>(kIntegerShift<D>);
}

/// The product a 2^n for n from -2044 to 2046 (double), -252 to 254 (float), in two steps, of which neither
/// leaves the range.
template <class D>
HWY_INLINE Lanes<D> times_power_of_two(const Lanes<D>& a, const WholeLanes<D>& n) {
    const hn::RebindToUnsigned<D> du;
    constexpr bool kDouble = sizeof(hn::TFromD<D>) == 8;
    constexpr int kBits = kDouble ? 52 : 23, kBias = kDouble ? 1023 : 127;
    const auto bits = [](auto exponent)
                          HWY_ATTR { return Lanes<D>(hn::BitCast(D(), hn::ShiftLeft<kBits>(exponent))); };
    const auto both_biased = hn::Add(hn::BitCast(du, n), hn::Set(du, 2 * kBias));
    const auto half_biased = hn::ShiftRight<1>(both_biased);
    return a * bits(half_biased) * bits(hn::Sub(both_biased, half_biased));
}

/// The sine of a and 1 - cos a within a quarter of a turn around 0: minimax polynomials of degree 13 and 14 in
/// double (the coefficients are those of fdlibm's kernels), 7 and 8 in float (Cephes').
template <class D>
ANAMORPH_LANES_INLINE void sine_versine(const Lanes<D>& a, Lanes<D>& s, Lanes<D>& v) {
    const Lanes<D> z = a * a;
    if constexpr (sizeof(hn::TFromD<D>) == 8) {
        constexpr double kSine[] = {-1.66666666666666324348e-01, 8.33333333332248946124e-03,
                                    -1.98412698298579493134e-04, 2.75573137070700676789e-06,
                                    -2.50507602534068634195e-08, 1.58969099521155010221e-10};
        constexpr double kCosine[] = {4.16666666666666019037e-02, -1.38888888888741095749e-03,
                                      2.48015872894767294178e-05, -2.75573143513906633035e-07,
                                      2.08757232129817482790e-09, -1.13596475577881948265e-11};
        s = a + a * z * polynomial(z, kSine);
        v = z * 0.5 - z * z * polynomial(z, kCosine);
    } else {
        constexpr double kSine[] = {-1.6666654611e-1, 8.3321608736e-3, -1.9515295891e-4};
        constexpr double kCosine[] = {4.166664568298827e-2, -1.388731625493765e-3, 2.443315711809948e-5};
        s = a + a * z * polynomial(z, kSine);
        v = z * 0.5 - z * z * polynomial(z, kCosine);
    }
}

/// The lanes in which a whole number has a bit.
template <class D>
HWY_INLINE LaneMask<D> has_bit(hn::Vec<hn::RebindToSigned<D>> n, int bit) {
    const hn::RebindToSigned<D> di;
    const auto b = hn::Set(di, bit);
    return {hn::MaskFromVec(hn::BitCast(D(), hn::VecFromMask(di, hn::Eq(hn::And(n, b), b))))};
}

/// Takes off quarters of a turn, in parts of pi / 2 that have as many bits less as the count of quarters may
/// have; then by quadrant.
template <class D>
ANAMORPH_LANES_INLINE void sin_cos(const Lanes<D>& a, Lanes<D>& sine, Lanes<D>& cosine) {
    const hn::RebindToSigned<D> di;
    Lanes<D> quarters, r;
    const auto n = nearest_integer(a * Lanes<D>(0.63661977236758134308), quarters);
    if constexpr (sizeof(hn::TFromD<D>) == 8)
        r = ((a - quarters * 1.57079632673412561417e+00) - quarters * 6.07710050630396597660e-11) -
            quarters * 2.02226624879595063154e-21;
    else
        r = ((a - quarters * 1.5703125) - quarters * 4.837512969970703125e-4) -
            quarters * 7.549789948768648e-8;
    Lanes<D> s, v;
    sine_versine(r, s, v);
    const Lanes<D> c = Lanes<D>(1) - v;
    const LaneMask<D> odd = has_bit<D>(n, 1);
    const Lanes<D> plain_sine = select(odd, c, s), plain_cosine = select(odd, s, c);
    sine = select(has_bit<D>(n, 2), -plain_sine, plain_sine);
    cosine = select(has_bit<D>(hn::Add(n, hn::Set(di, 1)), 2), -plain_cosine, plain_cosine);
}

/// The angle whose tangent is t, within an eighth of a half turn around 0: fdlibm's polynomial and Cephes'.
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> small_atan(const Lanes<D>& t) {
    const Lanes<D> z = t * t;
    if constexpr (sizeof(hn::TFromD<D>) == 8) {
        constexpr double kArc[] = {
            3.33333333333329318027e-01,  -1.99999999998764832476e-01, 1.42857142725034663711e-01,
            -1.11111104054623557880e-01, 9.09088713343650656196e-02,  -7.69187620504482999495e-02,
            6.66107313738753120669e-02,  -5.83357013379057348645e-02, 4.97687799461593236017e-02,
            -3.65315727442169155270e-02, 1.62858201153657823623e-02};
        return t - t * z * polynomial(z, kArc);
    } else {
        constexpr double kArc[] = {3.33329491539e-1, -1.99777106478e-1, 1.38776856032e-1, -8.05374449538e-2};
        return t - t * z * polynomial(z, kArc);
    }
}

/// Half a turn in two parts: what double (or float) leaves out of the first.
constexpr double kHalfTurn = 3.14159265358979311600;
template <class D>
constexpr double kHalfTurnRest = sizeof(hn::TFromD<D>) == 8 ? 1.22464679914735317636e-16
                                                            : kHalfTurn - static_cast<float>(kHalfTurn);
constexpr double kTangentOfSixteenth = 0.41421356237309503;

/// The angle whose tangent is p / q, neither of them negative, up to 3 / 16 of a turn: beyond tan(pi / 8) it is
/// pi / 4 + atan((p - q) / (p + q)). 0 / 0 is the angle 0.
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> steep_angle(const Lanes<D>& p, const Lanes<D>& q) {
    using L = Lanes<D>;
    const auto beyond = q * kTangentOfSixteenth < p;
    const L over = select(beyond, p + q, q);
    const L t = select(is_zero(over), L(0), select(beyond, p - q, p) / over);
    const L eighth = select(beyond, L(kHalfTurn / 4), L(0)),
            rest = select(beyond, L(kHalfTurnRest<D> / 4), L(0));
    return eighth + (small_atan(t) + rest);
}

/// The angle of (x, y), |y| <= tan(3 pi / 8) x and x > 0. Angles up to pi / 8 are found for themselves, with the same bits.
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> small_angle(const Lanes<D>& y, const Lanes<D>& x) {
    using L = Lanes<D>;
    const L p = abs(y);
    const bool small = hn::AllFalse(D(), (x * kTangentOfSixteenth < p).m);
    const L angle = small ? small_atan(p / x) : steep_angle(p, x);
    return L(hn::CopySign(angle.v, y.v));
}

/// The angle of (x, y), by octant.
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> atan2(const Lanes<D>& y, const Lanes<D>& x) {
    using L = Lanes<D>;
    const L ax = abs(x), ay = abs(y);
    const auto steep = ax < ay;
    L angle = steep_angle(select(steep, ax, ay), select(steep, ay, ax));
    angle = select(steep, L(kHalfTurn / 2) - (angle - L(kHalfTurnRest<D> / 2)), angle);
    angle = select(is_negative(x), L(kHalfTurn) - (angle - L(kHalfTurnRest<D>)), angle);
    return L(hn::CopySign(angle.v, y.v));
}

/// e^a: with a = n log 2 + r, e^r = 1 + r + r c / (2 - c), c = r - r^2 P(r^2) (fdlibm's e_exp), times 2^n in
/// two steps, so that neither leaves the range.
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> exp(const Lanes<D>& a) {
    using L = Lanes<D>;
    constexpr bool kDouble = sizeof(hn::TFromD<D>) == 8;
    constexpr double kMost = kDouble ? 710 : 89, kLeast = kDouble ? -746 : -104;
    const L x = select(a < L(kLeast), L(kLeast), select(L(kMost) < a, L(kMost), a));
    L n;
    const auto whole = nearest_integer(x * L(1.44269504088896338700), n);
    const L high = x - n * (kDouble ? 6.93147180369123816490e-01 : 0.693359375);
    const L low = n * (kDouble ? 1.90821492927058770002e-10 : -2.12194440e-4);
    const L r = high - low, z = r * r;
    constexpr double kP[] = {1.66666666666666019037e-01, -2.77777777770155933842e-03,
                             6.61375632143793436117e-05, -1.65339022054652515390e-06,
                             4.13813679705723846039e-08};
    const L c = r - z * polynomial(z, kP);
    const L value = L(1) - ((low - r * c / (L(2) - c)) - high);
    return times_power_of_two(value, whole);
}

/// log a: with a = 2^n m, m around 1, f = m - 1 and s = f / (2 + f), log m = f - s (f - R(s^2)) and so on
/// (fdlibm's e_log). -inf at 0, NaN below.
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> log(const Lanes<D>& a) {
    using L = Lanes<D>;
    const D d;
    const hn::RebindToSigned<D> di;
    constexpr bool kDouble = sizeof(hn::TFromD<D>) == 8;
    constexpr int kBits = kDouble ? 52 : 23;
    // What is less than normal is made larger first.
    const auto tiny = a < L(kDouble ? 0x1p-1022 : 0x1p-126);
    const L x = select(tiny, a * (kDouble ? 0x1p54 : 0x1p25), a);
    // The exponent for which the mantissa lies in [sqrt(1/2), sqrt 2).
    using Int = hn::TFromD<hn::RebindToSigned<D>>;
    const auto bits = hn::BitCast(di, x.v);
    const auto offset =
        hn::Set(di, kDouble ? static_cast<Int>(0x3fe6a09e667f3bcc) : static_cast<Int>(0x3f3504f3));
    const auto n = hn::ShiftRight<kBits>(hn::Sub(bits, offset));
    const L m(hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<kBits>(n))));
    const L exponent = number_of<D>(n) - select(tiny, L(kDouble ? 54 : 25), L(0));
    constexpr double kR[] = {6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01,
                             2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01,
                             1.479819860511658591e-01};
    const L f = m - L(1), s = f / (f + L(2)), z = s * s, half = f * f * 0.5;
    const L r = z * polynomial(z, kR);
    const double high = kDouble ? 6.93147180369123816490e-01 : 0.693359375;
    const double low = kDouble ? 1.90821492927058770002e-10 : -2.12194440e-4;
    const L value = exponent * high - ((half - (s * (half + r) + exponent * low)) - f);
    const L infinite(HUGE_VAL);
    const L ended = select(is_zero(a), -infinite, select(is_negative(a), L(NAN), value));
    // Infinity, and NaN, which compares with nothing.
    return select(a < infinite, ended, a);
}

/// The logarithm log(1 + a) for a >= 0: what rounding takes from 1 + a = w is made good by a / (w - 1)
/// (Kahan).
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> log_of_one_more(const Lanes<D>& a) {
    using L = Lanes<D>;
    const L w = a + L(1), rest = w - L(1);
    return select(is_zero(rest), a, log(w) * (a / select(is_zero(rest), L(1), rest)));
}
/// The difference e^a - 1 for a <= 0: what rounding takes from e^a = w is made good by a / log w (Kahan).
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> exp_less_one(const Lanes<D>& a) {
    using L = Lanes<D>;
    const L w = exp(a), rest = w - L(1), logarithm = log(w);
    // Where e^a is 1 it is a; where next to nothing, -1.
    const L value = rest * (a / select(is_zero(logarithm), L(1), logarithm));
    return select(is_zero(rest), a, select(a < L(-30), rest, value));
}

/// asinh |a| as log(1 + b + b^2 / (1 + sqrt(1 + b^2))) for b = |a|; beyond 2^30 the 1 is lost, and squares
/// would overflow.
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> asinh(const Lanes<D>& a) {
    using L = Lanes<D>;
    const L b = abs(a);
    const LaneMask<D> large = L(0x1p30) < b;
    const L c = select(large, L(0), b), c2 = c * c;
    const L value =
        select(large, log(b) + L(0.69314718055994530942), log_of_one_more(c + c2 / (L(1) + sqrt(c2 + L(1)))));
    return L(hn::CopySign(value.v, a.v));
}

/// tanh a in s, and 1 / cosh a: with m = e^-2|a| - 1, tanh |a| = -m / (m + 2) and 1 / cosh a = 2 e^-|a| /
/// (m + 2).
template <class D>
ANAMORPH_LANES_INLINE Lanes<D> scaled_sinh(const Lanes<D>& a, Lanes<D>& s) {
    using L = Lanes<D>;
    const L b = abs(a), m = exp_less_one(b * -2.0), over = m + L(2);
    s = L(hn::CopySign((-m / over).v, a.v));
    return max(exp(-b) * 2.0 / over, L(sizeof(hn::TFromD<D>) == 8 ? kLeastScale : 0x1p-100));
}
