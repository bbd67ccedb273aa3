// SPDX-License-Identifier: Apache-2.0
// Jets and their recurrences (number/jet.h), over any number.
//
// No include guard and no namespace: vectors need them compiled for each instruction set (number/jets_lanes.cpp). Whoever includes
// this says with ANAMORPH_UNROLLED how a function is written into its callers, and with ToldDegree<T> what jets of T are
// told of their degree as polynomials: nothing where it is to be seen, or `degree`; and with kJetSteps<T, N> whether recurrences
// are unrolled whole: a constant N, or not: the number N.

template <class T, int N>
struct Jet : ToldDegree<T> {
    static constexpr int kDegree = N;
    static constexpr int kSize = (N + 1) * (N + 2) / 2;
    static constexpr bool kIsTold = !std::is_empty_v<ToldDegree<T>>;

    /// The coefficients, degree by degree; that of s^(k-j) t^j stands at k (k + 1) / 2 + j.
    T c[kSize];

    /// Constructs zero; where degrees are told, the coefficients are not set.
    Jet() {
        if constexpr (!kIsTold)
            for (T& k : c) k = T(0);
    }
    Jet(const T& constant) : Jet() { c[0] = constant; }  // NOLINT: a number is a jet
    template <class U>
    requires(std::is_arithmetic_v<U> && !std::is_same_v<U, T>) Jet(U constant)  // NOLINT: a number is a jet
        : Jet() {
        c[0] = T(constant);
    }

    /// The jet value + ds * s + dt * t.
    static Jet variable(const T& value, const T& ds, const T& dt) {
        Jet r(value);
        r.c[1] = ds;
        r.c[2] = dt;
        return r;
    }

    static constexpr int part(int degree) { return degree * (degree + 1) / 2; }
    const T& at(int i, int j) const { return c[part(i + j) + j]; }
    const T& value() const { return c[0]; }
};

namespace jet_detail {

// Counts are constants where recurrences are unrolled, else plain numbers.
template <int I>
using CountOf = std::integral_constant<int, I>;

template <int More, int I>
constexpr CountOf<I + More> plus(CountOf<I>) {
    return {};
}
template <int More>
constexpr int plus(int count) {
    return count + More;
}
template <int I, int J>
constexpr CountOf<I + J> sum(CountOf<I>, CountOf<J>) {
    return {};
}
constexpr int sum(int i, int j) {
    return i + j;
}
template <int I, int J>
constexpr CountOf<I - J> difference(CountOf<I>, CountOf<J>) {
    return {};
}
constexpr int difference(int i, int j) {
    return i - j;
}
template <int I>
constexpr CountOf<I / 2> half(CountOf<I>) {
    return {};
}
constexpr int half(int count) {
    return count / 2;
}

/// Calls body(0), ..., body(count - 1), each with its index as a constant where the count is a constant.
template <int Count, class Body>
ANAMORPH_UNROLLED inline void unroll(CountOf<Count>, const Body& body) {
    [&]<int... I>(std::integer_sequence<int, I...>) ANAMORPH_UNROLLED {
        (body(CountOf<I>{}), ...);
    }
    (std::make_integer_sequence<int, std::max(Count, 0)>{});
}
template <class Body>
ANAMORPH_UNROLLED inline void unroll(int count, const Body& body) {
    for (int i = 0; i < count; ++i) body(i);
}
/// Calls body(i) for 0 <= i <= a with 0 <= m - i <= b.
template <int A, int B, int M, class Body>
ANAMORPH_UNROLLED inline void each_split(CountOf<A>, CountOf<B>, CountOf<M>, const Body& body) {
    constexpr int kFirst = std::max(0, M - B), kLast = std::min(A, M);
    unroll(CountOf<kLast - kFirst + 1>{}, [&](auto i) ANAMORPH_UNROLLED { body(plus<kFirst>(i)); });
}
template <class Body>
ANAMORPH_UNROLLED inline void each_split(int a, int b, int m, const Body& body) {
    for (int i = std::max(0, m - b); i <= std::min(a, m); ++i) body(i);
}

/// A number that stands for all numbers between two ends, such as an interval.
template <class T>
concept Enclosure = requires(const T& a) {
    a.lo;
    a.hi;
};

/// A sum of products.
template <class T>
struct ProductSum {
    using Term = T;  ///< what a factor contributes to its products
    T sum;

    ANAMORPH_UNROLLED ProductSum() : sum(0) {}
    ANAMORPH_UNROLLED void add(const Term& a, const Term& b) { sum = sum + a * b; }
    ANAMORPH_UNROLLED void add(const ProductSum& part, int weight) {
        sum = sum + (weight == 1 ? part.sum : part.sum * T(weight));
    }
    const T& value() const { return sum; }
};
/// Sums of products of intervals (R: of double, or of a vector), in about as many steps as of numbers. With middles p, q and largest
/// magnitudes P, Q of two factors, their product is within PQ - |p||q| of pq; so is a sum of them, with weights w, of the sum of w p q.
/// Read here are s = 2 p and t = 2 q, sums of ends, which do not underflow.
///
/// Rounding, in units u = 2^-53 of G = sum |w| P Q, for N <= 6, when a coefficient has at most 16 products: s t w
/// is off by 4 u of itself, and adding up by 16 u more, so that sum w s t and sum |w| |s| |t|, of 4 G at most, are
/// off by 20 u of 4 G, and G by 18 u; the difference of sizes and the two ends by 4 u. 20 + 20 + 18 + 4 < 64 units;
/// 128 are taken. What underflows is off by 2^-1022 at most, 16 products with weights up to 12 in three sums by
/// less than 2^-1012: no more than the rest of the units where G is at least 2^-950. Where it is less, the sum is
/// only known to be next to nothing.
template <Enclosure T>
struct ProductSum<T> {
    using R = decltype(T::lo);
    struct Term {
        R twice, size;  ///< s, and P

        Term() = default;
        ANAMORPH_UNROLLED explicit Term(const T& a) : twice(a.lo + a.hi), size(max(a.hi, R(-a.lo))) {}
    };
    R middle, middle_size;  ///< sum w s t and sum |w s t|
    R size;                 ///< G

    ANAMORPH_UNROLLED ProductSum() : middle(0), middle_size(0), size(0) {}
    ANAMORPH_UNROLLED void add(const Term& a, const Term& b) {
        using std::abs;
        const R product = a.twice * b.twice;
        middle = middle + product;
        middle_size = middle_size + abs(product);
        size = size + a.size * b.size;
    }
    ANAMORPH_UNROLLED void add(const ProductSum& part, int weight) {
        middle = middle + part.middle * weight;
        middle_size = middle_size + part.middle_size * std::abs(weight);
        size = size + part.size * std::abs(weight);
    }
    /// The sum as an interval; unbounded where a factor is, or nearly so.
    ANAMORPH_UNROLLED T value() const {
        const auto bounded = middle_size + size < R(0x1p1000);
        const R radius =
            select(size < R(0x1p-950), R(0x1p-940), R((size - middle_size * 0.25) + size * 0x1p-46));
        const R centre = middle * 0.25;
        return {select(bounded, R(centre - radius), R(-HUGE_VAL)),
                select(bounded, R(centre + radius), R(HUGE_VAL))};
    }
};

/// The degree of a jet as a polynomial: parts above are zero. Operations on constants, lines and their squares, which are
/// mostly zeros, are faster where it is known.
template <class T, int N>
int degree_of(const Jet<T, N>& jet) {
    int degree = N;
    if constexpr (requires { jet.degree; })
        degree = jet.degree < N ? jet.degree : N;
    else if constexpr (requires(bool known, const T& a) { known = is_zero(a); })
        for (int last = Jet<T, N>::kSize - 1; last > 0 && is_zero(jet.c[last]); --last)
            if (last == Jet<T, N>::part(degree)) --degree;
    return degree;
}

template <class T, int N>
void tell_degree(Jet<T, N>& jet, int degree) {
    if constexpr (requires { jet.degree; }) jet.degree = degree < N ? degree : N;
}

/// The number of coefficients that are operated on: all of them, but of intervals those up to the jet's degree.
template <class T, int N>
int terms(const Jet<T, N>& jet) {
    return Enclosure<T> ? Jet<T, N>::part(degree_of(jet) + 1) : Jet<T, N>::kSize;
}

/// A jet as a factor of products.
template <class T, int N>
struct Factor {
    const Jet<T, N>& jet;
    int degree;

    explicit Factor(const Jet<T, N>& known) : jet(known), degree(degree_of(known)) {}
    /// The factor of a jet of which only the constant part is known yet; grow() is called for each other coefficient once it is
    /// computed.
    static Factor growing(const Jet<T, N>& jet) { return Factor(jet, N); }
    ANAMORPH_UNROLLED void grow(int) {}

    ANAMORPH_UNROLLED const T& operator[](int at) const { return jet.c[at]; }

  private:
    Factor(const Jet<T, N>& unknown, int any) : jet(unknown), degree(any) {}
};
/// A factor of intervals, with the terms of all its products.
template <Enclosure T, int N>
struct Factor<T, N> {
    using Term = typename ProductSum<T>::Term;
    const Jet<T, N>& jet;
    int degree;

    explicit Factor(const Jet<T, N>& known) : jet(known), degree(degree_of(known)) {
        for (int at = 0; at < Jet<T, N>::part(degree + 1); ++at) grow(at);
    }
    static Factor growing(const Jet<T, N>& jet) { return Factor(jet, N); }
    ANAMORPH_UNROLLED void grow(int at) { m_terms[at] = Term(jet.c[at]); }

    ANAMORPH_UNROLLED const Term& operator[](int at) const { return m_terms[at]; }

  private:
    Factor(const Jet<T, N>& unknown, int any) : jet(unknown), degree(any) { grow(0); }

    Term m_terms[Jet<T, N>::kSize];
};

/// Computes coefficient m of the part of degree k of sum_(first <= a <= last) weight(a) f_a g_(k-a).
template <class K, class First, class Last, class T, int N, class M, class Weight>
ANAMORPH_UNROLLED inline T convolve(K k, First first, Last last, const Factor<T, N>& f, const Factor<T, N>& g,
                                    M m, const Weight& weight) {
    using J = Jet<T, N>;
    static_assert(!Enclosure<T> || N <= 6);
    if (first > last || k > f.degree + g.degree) return T(0);
    ProductSum<T> sums;
    unroll(plus<1>(difference(last, first)), [&](auto offset) ANAMORPH_UNROLLED {
        const auto a = sum(first, offset);
        const auto b = difference(k, a);
        if (a > f.degree || b > g.degree) return;
        ProductSum<T> part;
        each_split(a, b, m,
                   [&](int i) ANAMORPH_UNROLLED { part.add(f[J::part(a) + i], g[J::part(b) + m - i]); });
        sums.add(part, weight(a));
    });
    return sums.value();
}

/// Calls body(k, m) for the coefficients m of the parts of degree k = 1 ... N, part by part.
template <class T, int N, class Body>
ANAMORPH_UNROLLED inline void each_coefficient(const Body& body) {
    unroll(kJetSteps<T, N>, [&](auto below) ANAMORPH_UNROLLED {
        const auto k = plus<1>(below);
        unroll(plus<1>(k), [&](auto m) ANAMORPH_UNROLLED { body(k, m); });
    });
}

/// Solves q E g = w for the parts of g above the constant: k q_0 g_k = w_k - sum_(0<j<k) j g_j q_(k-j).
template <class T, int N>
inline void integrate_quotient(Jet<T, N>& g, const Jet<T, N>& w, const Jet<T, N>& q) {
    const T inverse = T(1) / q.c[0];
    T part_of[N + 1];
    for (int k = 1; k <= N; ++k) part_of[k] = inverse / T(k);
    auto left = Factor<T, N>::growing(g);
    const Factor<T, N> right(q);
    each_coefficient<T, N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const T known = convolve(k, kJetSteps<T, 1>, plus<-1>(k), left, right, m, [](int j) { return j; });
        const int at = Jet<T, N>::part(k) + m;
        g.c[at] = (w.c[at] - known) * part_of[k];
        left.grow(at);
    });
}

/// The jet x E y - y E x, whose part of degree k is sum_a (k - 2 a) x_a y_(k-a).
template <class T, int N>
inline Jet<T, N> wronskian(const Jet<T, N>& x, const Jet<T, N>& y) {
    Jet<T, N> r;
    const Factor<T, N> left(x), right(y);
    each_coefficient<T, N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        r.c[Jet<T, N>::part(k) + m] =
            convolve(k, kJetSteps<T, 0>, k, left, right, m, [&](int a) { return k - 2 * a; });
    });
    tell_degree(r, left.degree + right.degree);
    return r;
}

/// A disc of complex numbers: those within `radius` of a middle, whose magnitude is at most `size`, but for two units of it.
template <class R>
struct Disc {
    R re, im, radius, size;

    Disc() = default;
    ANAMORPH_UNROLLED Disc(const R& real, const R& imaginary, const R& around)
        : re(real), im(imaginary), radius(around), size(longest(real, imaginary)) {}
    /// The disc around a rectangle, with margins of 8 units of 2^-53: a middle is rounded by one, half a side by one and
    /// longest() by two.
    template <Enclosure T>
    static ANAMORPH_UNROLLED Disc around(const T& real, const T& imaginary) {
        const R half = longest(R((real.hi - real.lo) * 0.5), R((imaginary.hi - imaginary.lo) * 0.5));
        Disc d(R((real.lo + real.hi) * 0.5), R((imaginary.lo + imaginary.hi) * 0.5), half);
        d.radius = half + d.reach() * 0x1p-50;
        return d;
    }
    /// The disc of the inverses: about c / (|c|^2 - r^2), c conjugate, with radius r / (|c|^2 - r^2). The divisor is off by 5
    /// units of |c|^2 at most, a part of 2^-10 of it where it is known, and both results by as many of its own and three
    /// roundings more.
    ANAMORPH_UNROLLED Disc inverse() const {
        const R squared = re * re + im * im, divisor = squared - radius * radius;
        const auto known = R(max(squared * 0x1p-40, R(0x1p-900))) < divisor;
        const R scale = R(1) / select(known, divisor, R(1));
        Disc d(R(re * scale), R(-(im * scale)), R(radius * scale));
        d.radius = select(known, R(d.radius + d.reach() * (squared * scale) * 0x1p-46), R(HUGE_VAL));
        return d;
    }
    /// An upper bound of the magnitudes of all members.
    ANAMORPH_UNROLLED R reach() const { return size + radius; }

  private:
    /// An upper bound of the hypotenuse of a and b, which is convex in the quotient of its sides and as long as the bound at
    /// both ends, 0 and 1.
    static ANAMORPH_UNROLLED R longest(const R& a, const R& b) {
        using std::abs;
        const R p = abs(a), q = abs(b);
        return max(p, q) + min(p, q) * 0.41421356237309515;
    }
};

/// A sum of products of discs. With middles p, q and radii r, s a product is within (P + r)(Q + s) - P Q of p q, where P
/// and Q are no less than the magnitudes of p and q.
///
/// Rounding, in units of 2^-53 of G = sum (P + r)(Q + s), for at most 16 products: a real or imaginary part of a product
/// is off by 2 units and by 15 more as they are added, both parts together by 25; sum P Q by 17, G by 18, and both by
/// 5 more where P and Q are too small by two units; the difference and the two ends by 4. 25 + 17 + 18 + 5 + 4 < 128. What
/// underflows is less than 2^-940.
template <class R>
struct DiscSum {
    R re, im, middles, sum;

    ANAMORPH_UNROLLED DiscSum() : re(0), im(0), middles(0), sum(0) {}
    ANAMORPH_UNROLLED void add(const Disc<R>& a, const Disc<R>& b) {
        re = re + (a.re * b.re - a.im * b.im);
        im = im + (a.re * b.im + a.im * b.re);
        middles = middles + a.size * b.size;
        sum = sum + a.reach() * b.reach();
    }
    ANAMORPH_UNROLLED R radius() const { return (sum - middles) + sum * 0x1p-46 + R(0x1p-940); }
    ANAMORPH_UNROLLED Disc<R> value() const { return {re, im, radius()}; }
};

/// The disc k z less a sum, for k = 0 without z: rounded three times, with a margin of 8 units.
template <class R>
ANAMORPH_UNROLLED inline Disc<R> less_sum(int k, const Disc<R>& z, const DiscSum<R>& sum) {
    if (k == 0) return {R(-sum.re), R(-sum.im), sum.radius()};
    Disc<R> d(R(z.re * k - sum.re), R(z.im * k - sum.im), R(z.radius * k + sum.radius()));
    d.radius = d.radius + (z.reach() * k + sum.sum) * 0x1p-50;
    return d;
}

/// Finds the parts above the constant one of the angle of z = x + i y, the imaginary part of its logarithm: with e = E log z,
/// z_0 e_k = k z_k - sum_(0<j<k) e_j z_(k-j). Discs turn as they are multiplied and grow by their radii alone, so that
/// over wide boxes they are many times narrower than quotients of wronskian(x, y).
template <Enclosure T, int N>
inline void integrate_logarithm(Jet<T, N>& g, const Jet<T, N>& y, const Jet<T, N>& x) {
    static_assert(N <= 6);
    using J = Jet<T, N>;
    using R = decltype(T::lo);
    const int degree = std::max(degree_of(x), degree_of(y));
    Disc<R> z[J::kSize], e[J::kSize];
    for (int i = 0; i < J::part(degree + 1); ++i) z[i] = Disc<R>::around(x.c[i], y.c[i]);
    const Disc<R> inverse = z[0].inverse();
    for (int k = 1; k <= N; ++k)
        for (int m = 0; m <= k; ++m) {
            const int at = J::part(k) + m;
            DiscSum<R> known, part;
            for (int j = std::max(1, k - degree); j < k; ++j)
                for (int i = std::max(0, m - (k - j)); i <= std::min(j, m); ++i)
                    known.add(e[J::part(j) + i], z[J::part(k - j) + m - i]);
            part.add(inverse, less_sum(k <= degree ? k : 0, z[k <= degree ? at : 0], known));
            e[at] = part.value();
            const auto bounded = e[at].reach() < R(0x1p1000);
            g.c[at] = T(select(bounded, R(part.im - e[at].radius), R(-HUGE_VAL)),
                        select(bounded, R(part.im + e[at].radius), R(HUGE_VAL))) /
                      T(k);
        }
}

/// The jet E f, whose part of degree k is that of f times k.
template <class T, int N>
inline Jet<T, N> euler(const Jet<T, N>& f) {
    Jet<T, N> r;
    each_coefficient<T, N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const int at = Jet<T, N>::part(k) + m;
        r.c[at] = f.c[at] * T(k);
    });
    tell_degree(r, degree_of(f));
    return r;
}

/// Solves E u = v E a and E v = Sign * u E a for sine and cosine (Sign -1), or the hyperbolic ones (Sign 1).
template <int Sign, class T, int N>
inline void oscillate(Jet<T, N>& u, Jet<T, N>& v, const Jet<T, N>& a) {
    const Factor<T, N> angle(a);
    auto sine = Factor<T, N>::growing(u), cosine = Factor<T, N>::growing(v);
    each_coefficient<T, N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const int at = Jet<T, N>::part(k) + m;
        u.c[at] = convolve(k, kJetSteps<T, 1>, k, angle, cosine, m, [](int j) { return j; }) / T(k);
        v.c[at] = convolve(k, kJetSteps<T, 1>, k, angle, sine, m, [](int j) { return Sign * j; }) / T(k);
        sine.grow(at);
        cosine.grow(at);
    });
}

}  // namespace jet_detail

template <class T, int N>
inline Jet<T, N> operator-(const Jet<T, N>& a) {
    Jet<T, N> r;
    jet_detail::tell_degree(r, jet_detail::degree_of(a));
    for (int i = 0; i < Jet<T, N>::kSize; ++i) r.c[i] = -a.c[i];
    return r;
}
template <class T, int N>
inline Jet<T, N> operator+(const Jet<T, N>& a, const Jet<T, N>& b) {
    Jet<T, N> r;
    const int size = std::max(jet_detail::terms(a), jet_detail::terms(b));
    jet_detail::tell_degree(r, std::max(jet_detail::degree_of(a), jet_detail::degree_of(b)));
    for (int i = 0; i < size; ++i) r.c[i] = a.c[i] + b.c[i];
    return r;
}
template <class T, int N>
inline Jet<T, N> operator-(const Jet<T, N>& a, const Jet<T, N>& b) {
    Jet<T, N> r;
    const int size = std::max(jet_detail::terms(a), jet_detail::terms(b));
    jet_detail::tell_degree(r, std::max(jet_detail::degree_of(a), jet_detail::degree_of(b)));
    for (int i = 0; i < size; ++i) r.c[i] = a.c[i] - b.c[i];
    return r;
}
template <class T, int N>
inline Jet<T, N> operator*(const Jet<T, N>& a, const Jet<T, N>& b) {
    Jet<T, N> r(a.c[0] * b.c[0]);
    const jet_detail::Factor<T, N> left(a), right(b);
    jet_detail::each_coefficient<T, N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        r.c[Jet<T, N>::part(k) + m] =
            jet_detail::convolve(k, kJetSteps<T, 0>, k, left, right, m, [](int) { return 1; });
    });
    jet_detail::tell_degree(r, left.degree + right.degree);
    return r;
}
template <class T, int N>
inline Jet<T, N> operator*(const Jet<T, N>& a, double b) {
    if (b == 1) return a;
    Jet<T, N> r;
    const int size = jet_detail::terms(a);
    for (int i = 0; i < size; ++i) r.c[i] = a.c[i] * b;
    return r;
}
template <class T, int N>
requires(!std::is_arithmetic_v<T>) inline Jet<T, N> operator*(const Jet<T, N>& a, const T& b) {
    Jet<T, N> r;
    for (int i = 0; i < Jet<T, N>::kSize; ++i) r.c[i] = a.c[i] * b;
    return r;
}
template <class T, int N>
inline Jet<T, N> operator*(double a, const Jet<T, N>& b) {
    return b * a;
}
template <class T, int N>
inline Jet<T, N> operator+(const Jet<T, N>& a, double b) {
    Jet<T, N> r = a;
    r.c[0] = r.c[0] + T(b);
    return r;
}
template <class T, int N>
inline Jet<T, N> operator+(double a, const Jet<T, N>& b) {
    return b + a;
}
template <class T, int N>
inline Jet<T, N> operator-(const Jet<T, N>& a, double b) {
    return a + (-b);
}
template <class T, int N>
inline Jet<T, N> operator-(double a, const Jet<T, N>& b) {
    return -b + a;
}

/// The quotient q with q g = f: g_0 q_k = f_k - sum_(j<k) q_j g_(k-j).
template <class T, int N>
inline Jet<T, N> operator/(const Jet<T, N>& f, const Jet<T, N>& g) {
    const T inverse = T(1) / g.c[0];
    Jet<T, N> q(f.c[0] * inverse);
    auto left = jet_detail::Factor<T, N>::growing(q);
    const jet_detail::Factor<T, N> right(g);
    jet_detail::each_coefficient<T, N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const T known = jet_detail::convolve(k, kJetSteps<T, 0>, jet_detail::plus<-1>(k), left, right, m,
                                             [](int) { return 1; });
        const int at = Jet<T, N>::part(k) + m;
        q.c[at] = (f.c[at] - known) * inverse;
        left.grow(at);
    });
    return q;
}

/// The sum of c_k f^k for k = 0 ... N, with f less its constant part, by Horner's rule. A sum that is still to be
/// multiplied by f n times is needed up to degree N - n only.
template <class T, int N>
inline Jet<T, N> compose(const T* c, const Jet<T, N>& f) {
    Jet<T, N> r(c[N]);
    auto left = jet_detail::Factor<T, N>::growing(r);
    const jet_detail::Factor<T, N> right(f);
    for (int degree = 1; degree <= N; ++degree) {
        // A part needs those below only, so the highest comes first.
        for (int k = degree; k > 0; --k)
            for (int m = 0; m <= k; ++m) {
                const int at = Jet<T, N>::part(k) + m;
                r.c[at] = jet_detail::convolve(k, 0, k - 1, left, right, m, [](int) { return 1; });
                left.grow(at);
            }
        r.c[0] = c[N - degree];
        left.grow(0);
    }
    return r;
}

/// The square of a, with a constant part that is never negative.
template <class T, int N>
inline Jet<T, N> square(const Jet<T, N>& a) {
    Jet<T, N> r(square(a.c[0]));
    const jet_detail::Factor<T, N> both(a);
    jet_detail::each_coefficient<T, N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        // Each pair of different parts counts twice.
        r.c[Jet<T, N>::part(k) + m] =
            jet_detail::convolve(k, kJetSteps<T, 0>, jet_detail::half(k), both, both, m,
                                 [&](int j) { return 2 * j == k ? 1 : 2; });
    });
    jet_detail::tell_degree(r, 2 * both.degree);
    return r;
}

/// The root r with r r = f: 2 r_0 r_k = f_k - sum_(0<j<k) r_j r_(k-j).
template <class T, int N>
inline Jet<T, N> sqrt(const Jet<T, N>& f) {
    using std::sqrt;
    Jet<T, N> r(sqrt(f.c[0]));
    const T inverse = T(0.5) / r.c[0];
    auto root = jet_detail::Factor<T, N>::growing(r);
    jet_detail::each_coefficient<T, N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const T known = jet_detail::convolve(k, kJetSteps<T, 1>, jet_detail::plus<-1>(k), root, root, m,
                                             [](int) { return 1; });
        const int at = Jet<T, N>::part(k) + m;
        r.c[at] = (f.c[at] - known) * inverse;
        root.grow(at);
    });
    return r;
}

template <class T, int N>
inline void sin_cos(const Jet<T, N>& a, Jet<T, N>& s, Jet<T, N>& c) {
    T sine, cosine;
    sin_cos(a.c[0], sine, cosine);
    s = Jet<T, N>(sine);
    c = Jet<T, N>(cosine);
    jet_detail::oscillate<-1>(s, c, a);
}

/// The exponential g = exp(a): E g = g E a, so that k g_k = sum_(0<j<=k) j a_j g_(k-j).
template <class T, int N>
inline Jet<T, N> exp(const Jet<T, N>& a) {
    using std::exp;
    Jet<T, N> g(exp(a.c[0]));
    const jet_detail::Factor<T, N> exponent(a);
    auto power = jet_detail::Factor<T, N>::growing(g);
    jet_detail::each_coefficient<T, N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const int at = Jet<T, N>::part(k) + m;
        g.c[at] =
            jet_detail::convolve(k, kJetSteps<T, 1>, k, exponent, power, m, [](int j) { return j; }) / T(k);
        power.grow(at);
    });
    return g;
}

/// The logarithm g = log(a), by a E g = E a.
template <class T, int N>
inline Jet<T, N> log(const Jet<T, N>& a) {
    using std::log;
    Jet<T, N> g(log(a.c[0]));
    jet_detail::integrate_quotient(g, jet_detail::euler(a), a);
    return g;
}

/// Writes sinh(a) into s and returns 1, both over cosh of a's constant part.
template <class T, int N>
inline T scaled_sinh(const Jet<T, N>& a, Jet<T, N>& s) {
    T sine;
    const T one = scaled_sinh(a.c[0], sine);
    Jet<T, N> c(T(1));
    s = Jet<T, N>(sine);
    jet_detail::oscillate<1>(s, c, a);
    return one;
}

/// The inverse hyperbolic sine g = asinh(a), by E g sqrt(1 + a^2) = E a.
template <class T, int N>
inline Jet<T, N> asinh(const Jet<T, N>& a) {
    using std::asinh;
    Jet<T, N> g(asinh(a.c[0]));
    jet_detail::integrate_quotient(g, jet_detail::euler(a), sqrt(square(a) + 1.0));
    return g;
}

/// The angle of x + i y, which is the imaginary part of its logarithm.
template <class T, int N>
inline Jet<T, N> atan2(const Jet<T, N>& y, const Jet<T, N>& x) {
    using std::atan2;
    Jet<T, N> g(atan2(y.c[0], x.c[0]));
    if constexpr (jet_detail::Enclosure<T>)
        jet_detail::integrate_logarithm(g, y, x);
    else
        jet_detail::integrate_quotient(g, jet_detail::wronskian(x, y), square(x) + square(y));
    return g;
}
