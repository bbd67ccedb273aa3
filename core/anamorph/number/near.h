// SPDX-License-Identifier: Apache-2.0
// A number near a known one: a base, the same for all pixels of a block and computed once in double, and a small rest
// of each pixel's own, computed in float or double. A formula's results differ from the base's by the rest alone, so what
// float loses is relative to the size of the block, not of the picture; and what functions of rests cost is little, since
// they are small.
//
// Every operation is an identity for the rests: with A = a + da and B = b + db
//
//   A B - a b = da B + a db        A / B - q = (da - q db) / B,  q = a / b       sqrt A - r = da / (r + sqrt A)
//   sin A - s = c sin da - s (1 - cos da)     cos A - c = -s sin da - c (1 - cos da)
//   angle of (X, Y) - that of (x, y) = atan((x dy - y dx) / (x X + y Y))
//
// Base and Rest are numbers. They are read in two pairs:
//
//   double                    RestBound        the bases, written down in turn, and a bound of |computed - exact| over all
//                                              pixels of a block (number/near_bound.h)
//   read from there           lanes            a block's pixels (panorama/direct_rows_lanes.cpp)
//
// NearRest<Base, Rest> says what belongs to a pair: of(base), the base as a rest; off(rest, base, units), the rest
// where the base was rounded by so many units of 2^-53 of another; left_out(rest, d, factor), the rest where up to
// `factor` times |d| was left out; within(rest, other), the rest, of which the other is another way to compute it;
// angle(y, x), that of (x, y); choose(condition of bases, a, b); and the degree of the series of sinc_cos. Rests offer
// sine_versine(a, s, v), sin a and 1 - cos a for |a| <= pi / 4, and length(a, b); bases sinc_cos_series(a, s, c)
// (number/sinc_series.h).
//
// Bases are read in the order in which they were written, which is that in which the operands of a formula are evaluated.
// C++ leaves that to the compiler, for the two pairs apart. So both number their operations as they do them, and a base
// carries the number of the one whose result it is (0 is a constant). Both join what is done, and the numbers of its operands,
// into a sum (number/reading_order.h), at the end those of the results: where the sums differ a bound is infinite.
//
// Where they are the same, every operation that the results depend on has one number in both, and so reads its own bases:
// - Both are one formula's operations. Those of this file do their parts in a fixed order, each in statements of their own, and
//   calls never interleave: an operation's parts have consecutive numbers, all known by that of its result; so have its bases.
// - One sum means one sequence of entries (a different one has the same sum by chance, once in 2^64). The last ones give the
//   results one number in both. The entry of that number names, in both, the operands of one and the same operation: they have
//   one number in both as well, and so on down to the inputs, which are numbered in a fixed order.
// An operation that no result depends on may read any base: nothing is made of it. Drawing reads bases without numbers, and is
// compared with a reading that numbers them (panorama/direct_rows.h). tests/core/test_direct.cpp reads formulas whose operands come in
// another order, and every formula that there is.
//
// No include guard and no namespace, as in chart/lens_formula.h: lanes are compiled for each instruction set.
// ANAMORPH_INLINE says how.

template <class Base, class Rest>
struct NearRest;

/// A condition at the base, and the same condition for the pixels.
template <class AtBase, class AtRest>
struct NearCondition {
    AtBase base;
    AtRest rest;
};
template <class A, class B, class C, class D>
ANAMORPH_INLINE auto both(const NearCondition<A, B>& a, const NearCondition<C, D>& b) {
    return NearCondition<decltype(both(a.base, b.base)), decltype(both(a.rest, b.rest))>{
        both(a.base, b.base), both(a.rest, b.rest)};
}

template <class Base, class Rest>
struct Near {
    using Pair = NearRest<Base, Rest>;

    Base base;
    Rest rest;

    Near() = default;
    ANAMORPH_INLINE Near(double k) : base(k), rest(0.0) {}  // NOLINT: a number is one without a rest
    ANAMORPH_INLINE Near(const Base& b, const Rest& r) : base(b), rest(r) {}

    /// A constant with an error of at most `error`, for pairs that keep track of it. (Asked by the address: Clang would ask for a call
    /// before a Near is complete, which is what it returns.)
    static Near near(double value, double error) requires requires { &Pair::near; }
    { return Pair::near(value, error); }

    /// The number itself, base plus rest, as a rest.
    ANAMORPH_INLINE Rest whole() const { return Pair::of(base) + rest; }

    friend ANAMORPH_INLINE Near operator-(const Near& a) { return {-a.base, -a.rest}; }
    friend ANAMORPH_INLINE Near operator+(const Near& a, const Near& b) {
        const Base result = a.base + b.base;
        return {result, Pair::off(a.rest + b.rest, result, 1)};
    }
    friend ANAMORPH_INLINE Near operator-(const Near& a, const Near& b) {
        const Base result = a.base - b.base;
        return {result, Pair::off(a.rest - b.rest, result, 1)};
    }
    friend ANAMORPH_INLINE Near operator*(const Near& a, const Near& b) {
        const Base result = a.base * b.base;
        return {result, Pair::off(a.rest * b.whole() + Pair::of(a.base) * b.rest, result, 1)};
    }
    friend ANAMORPH_INLINE Near operator/(const Near& a, const Near& b) {
        const Base q = a.base / b.base;
        // q b = a to within a rounding, of a's size or a little more.
        return {q, Pair::off(a.rest - Pair::of(q) * b.rest, a.base, 2) / b.whole()};
    }

    friend ANAMORPH_INLINE Near operator+(const Near& a, double k) {
        const Base result = a.base + Base(k);
        return {result, Pair::off(a.rest, result, 1)};
    }
    friend ANAMORPH_INLINE Near operator+(double k, const Near& a) {
        const Base result = Base(k) + a.base;
        return {result, Pair::off(a.rest, result, 1)};
    }
    friend ANAMORPH_INLINE Near operator-(const Near& a, double k) {
        const Base result = a.base - Base(k);
        return {result, Pair::off(a.rest, result, 1)};
    }
    friend ANAMORPH_INLINE Near operator-(double k, const Near& a) {
        const Base result = Base(k) - a.base;
        return {result, Pair::off(-a.rest, result, 1)};
    }
    friend ANAMORPH_INLINE Near operator*(const Near& a, double k) {
        const Base result = a.base * Base(k);
        return {result, Pair::off(a.rest * Pair::of(Base(k)), result, 1)};
    }
    friend ANAMORPH_INLINE Near operator*(double k, const Near& a) {
        const Base result = Base(k) * a.base;
        return {result, Pair::off(a.rest * Pair::of(Base(k)), result, 1)};
    }

    friend ANAMORPH_INLINE Near square(const Near& a) {
        const Base result = a.base * a.base;
        return {result, Pair::off(a.rest * (a.whole() + Pair::of(a.base)), result, 1)};
    }
    friend ANAMORPH_INLINE Near sqrt(const Near& a) {
        const Base root = sqrt(a.base);
        const Rest of_a = Pair::off(a.rest, a.base, 3);
        return {root, of_a / (Pair::of(root) + sqrt(a.whole()))};
    }
    /// The root L' of A^2 + B^2: with L that of the bases, L'^2 - L^2 = da (A + a) + db (B + b), over L' + L.
    friend ANAMORPH_INLINE Near length(const Near& a, const Near& b) {
        const Base square_a = a.base * a.base, square_b = b.base * b.base;
        const Base squared = square_a + square_b, root = sqrt(squared);
        const Rest whole_a = a.whole(), whole_b = b.whole(), of_root = Pair::of(root);
        const Rest whole = length(whole_a, whole_b);
        const Rest grown = a.rest * (whole_a + Pair::of(a.base)) + b.rest * (whole_b + Pair::of(b.base));
        return {root, Pair::within(Pair::off(grown, squared, 4) / (of_root + whole), whole - of_root)};
    }
    friend ANAMORPH_INLINE void sin_cos(const Near& a, Near& sine, Near& cosine) {
        Base s, c;
        sin_cos(a.base, s, c);
        Rest rs, rv;
        sine_versine(a.rest, rs, rv);
        const Rest of_s = Pair::of(s), of_c = Pair::of(c);
        // Both are off by 8 units of libm, each of them of what its factor, at most 1, makes of it.
        sine = {s, Pair::off(of_c * rs - of_s * rv, Base(1.0), 16)};
        cosine = {c, Pair::off(-(of_s * rs + of_c * rv), Base(1.0), 16)};
    }
    friend ANAMORPH_INLINE Near atan2(const Near& y, const Near& x) {
        const Base angle = atan2(y.base, x.base);
        const Rest y0 = Pair::of(y.base), x0 = Pair::of(x.base);
        const Rest across = x0 * y.rest - y0 * x.rest, along = x0 * x.whole() + y0 * y.whole();
        return {angle, Pair::off(Pair::angle(across, along), angle, 8)};
    }
    /// The angle itself: its rest counts from its base already, and needs no other heading.
    friend ANAMORPH_INLINE Near tilt(const Near& across, const Near& ahead, const Heading&) {
        return atan2(across, ahead);
    }
    /// Finds sin t / t and cos t for t^2 = A, by their power series about a. With r^2 = a the coefficients of the first are
    /// (-1/2)^k j_k(r) / (r^k k!), j_k the spherical Bessel functions: at most 1 / (2 k + 1)!, which they are at 0. Those of
    /// the second are -1 / (2 k) times the ones before: at most 1 / (2 k)!. That much of the next power is left out.
    friend ANAMORPH_INLINE void sinc_cos(const Near& a, Near& sinc, Near& cosine) {
        constexpr int n = Pair::kSincDegree;
        Base s[n + 1], c[n + 1];
        sinc_cos_series(a.base, s, c);
        const Rest& d = a.rest;
        Rest sum_s = Pair::left_out(Rest(0.0), d, inverse_factorial(2 * n + 3)),
             sum_c = Pair::left_out(Rest(0.0), d, inverse_factorial(2 * n + 2));
        for (int k = n; k > 0; --k) {
            const Rest of_s = Pair::off(Pair::of(s[k]), Base(inverse_factorial(2 * k + 1)), kSincUnits);
            const Rest of_c = Pair::off(Pair::of(c[k]), Base(inverse_factorial(2 * k)), kSincUnits);
            sum_s = (sum_s + of_s) * d;
            sum_c = (sum_c + of_c) * d;
        }
        // s[0] and c[0] are off by 8 units of libm and what the rounding of r, at most pi, makes of them.
        sinc = {s[0], Pair::off(sum_s, Base(1.0), 16)};
        cosine = {c[0], Pair::off(sum_c, Base(1.0), 16)};
    }
    /// Finds tanh A and 1 / cosh A.
    /// With t = tanh a and T = tanh da: tanh A - t = T (1 - t^2) / (1 + t T), and with the two 1 / cosh, c and C,
    /// 1 / cosh A - c = c (C - 1 - t T) / (1 + t T), C - 1 = -T^2 / (1 + C).
    friend ANAMORPH_INLINE Near scaled_sinh(const Near& a, Near& s) {
        Base t;
        const Base c = scaled_sinh(a.base, t);
        Rest rt;
        const Rest rc = scaled_sinh(a.rest, rt);
        const Rest of_c = Pair::of(c), turned = Pair::of(t) * rt, over = turned + Rest(1.0);
        s = {t, Pair::off(rt * (of_c * of_c) / over, Base(1.0), 32)};
        return {c, Pair::off(-(of_c * (rt * rt / (rc + Rest(1.0)) + turned) / over), c, 32)};
    }
    /// The inverse hyperbolic sine: asinh A - asinh a = asinh(A r - a R), r and R the roots of 1 + a^2 and 1 + A^2;
    /// A r - a R = da r - a (R - r).
    friend ANAMORPH_INLINE Near asinh(const Near& a) {
        const Base squared = a.base * a.base, root = sqrt(squared + Base(1.0)), result = asinh(a.base);
        const Rest of_a = Pair::of(a.base), of_root = Pair::of(root);
        const Rest whole = a.whole(), other = sqrt(whole * whole + Rest(1.0));
        const Rest grown = a.rest * (whole + of_a) / (other + of_root);
        return {result, Pair::off(asinh(a.rest * of_root - of_a * grown), result, 32)};
    }

    /// The sum c[0] + c[1] n + ..., by Horner's rule.
    template <std::size_t Count>
    static ANAMORPH_INLINE Near series(const Base (&c)[Count], const Rest& n) {
        Rest sum = Pair::of(c[Count - 1]);
        for (std::size_t k = Count - 2; k > 0; --k) sum = sum * n + Pair::of(c[k]);
        return {c[0], sum * n};
    }

    friend ANAMORPH_INLINE auto is_negative(const Near& a) {
        return NearCondition<decltype(is_negative(a.base)), decltype(is_negative(a.rest))>{
            is_negative(a.base), is_negative(a.whole())};
    }
    friend ANAMORPH_INLINE auto is_zero(const Near& a) {
        return NearCondition<decltype(is_zero(a.base)), decltype(is_zero(a.rest))>{is_zero(a.base),
                                                                                   is_zero(a.whole())};
    }
    /// Selects a or b. The base is the one that is chosen at the base; the rest of a pixel where the other is chosen counts
    /// from that base.
    template <class AtBase, class AtRest>
    friend ANAMORPH_INLINE Near select(const NearCondition<AtBase, AtRest>& where, const Near& a,
                                       const Near& b) {
        const Base apart = b.base - a.base, chosen = Pair::choose(where.base, a.base, b.base);
        const Rest from_a = Pair::off(b.rest + Pair::of(apart), apart, 1);
        const Rest from_b = Pair::off(a.rest - Pair::of(apart), apart, 1);
        return {chosen, Pair::choose(where.base, select(where.rest, a.rest, from_a),
                                     select(where.rest, from_b, b.rest))};
    }
    friend ANAMORPH_INLINE Near min(const Near& a, const Near& b) { return select(is_negative(b - a), b, a); }
    friend ANAMORPH_INLINE Near max(const Near& a, const Near& b) { return select(is_negative(a - b), b, a); }
    /// Returns the number unchanged: next to the end of a root no bound is found, whether or not small negative numbers count
    /// as 0.
    friend ANAMORPH_INLINE Near without_hair(const Near& a) { return a; }
    /// Returns 1: where squares underflow no bound is found.
    friend ANAMORPH_INLINE double enlarger(const Near&, const Near&) { return 1; }
};
