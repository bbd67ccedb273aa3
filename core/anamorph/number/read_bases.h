// SPDX-License-Identifier: Apache-2.0
// Bases as vectors read them (number/near.h), where NearBound has written them down.
//
// No include guard and no namespace: this is compiled for each instruction set, after number/lanes.h and number/near.h, where
// L<Real> is the vector of Real that rests are.

/// A decision at a base, that was written down.
template <class Order>
struct ReadDecision {
    bool holds;
    typename Order::Number number;

    friend HWY_INLINE ReadDecision both(const ReadDecision& a, const ReadDecision& b) {
        return {a.holds && b.holds, t_order<Order>.next(BaseOperation::both, a.number, b.number)};
    }
};

/// A base: a constant, or one that was written down. Operations read their result in place of computing it.
template <class Real, class Order>
struct ReadBase {
    using Number = typename Order::Number;
    using Decision = ReadDecision<Order>;

    Real value = 0;
    Number number = 0;  ///< as in WrittenBase

    ReadBase() = default;
    HWY_INLINE ReadBase(double k) : value(static_cast<Real>(k)) {}  // NOLINT: a number is a constant
    static HWY_INLINE ReadBase next(BaseOperation operation, Number a, Number b = 0) {
        return known(next_value(), t_order<Order>.next(operation, a, b));
    }
    static HWY_INLINE Decision next_decision(BaseOperation operation, Number a) {
        return {next_value() != 0, t_order<Order>.next(operation, a)};
    }
    static HWY_INLINE Real next_value() {
        const Real* const next = static_cast<const Real*>(t_next);
        t_next = next + 1;
        return *next;
    }
    static HWY_INLINE ReadBase known(Real value, Number number) {
        ReadBase base;
        base.value = value;
        base.number = number;
        return base;
    }
    static HWY_INLINE ReadBase input(Real value) {
        return known(value, t_order<Order>.next(BaseOperation::input));
    }

    HWY_INLINE L<Real> lanes() const { return L<Real>(hn::Set(D<Real>(), value)); }

    friend HWY_INLINE ReadBase operator-(const ReadBase& a) {
        return next(BaseOperation::negation, a.number);
    }
    friend HWY_INLINE ReadBase operator+(const ReadBase& a, const ReadBase& b) {
        return next(BaseOperation::sum, a.number, b.number);
    }
    friend HWY_INLINE ReadBase operator-(const ReadBase& a, const ReadBase& b) {
        return next(BaseOperation::difference, a.number, b.number);
    }
    friend HWY_INLINE ReadBase operator*(const ReadBase& a, const ReadBase& b) {
        return next(BaseOperation::product, a.number, b.number);
    }
    friend HWY_INLINE ReadBase operator/(const ReadBase& a, const ReadBase& b) {
        return next(BaseOperation::quotient, a.number, b.number);
    }
    friend HWY_INLINE ReadBase sqrt(const ReadBase& a) { return next(BaseOperation::root, a.number); }
    friend HWY_INLINE ReadBase asinh(const ReadBase& a) { return next(BaseOperation::area_sine, a.number); }
    friend HWY_INLINE ReadBase atan2(const ReadBase& y, const ReadBase& x) {
        return next(BaseOperation::angle, y.number, x.number);
    }
    friend HWY_INLINE void sin_cos(const ReadBase& a, ReadBase& s, ReadBase& c) {
        const Number of = a.number;
        s = next(BaseOperation::sine_and_cosine, of);
        c = next(BaseOperation::sine_and_cosine, of);
    }
    friend HWY_INLINE ReadBase scaled_sinh(const ReadBase& a, ReadBase& s) {
        const Number of = a.number;
        s = next(BaseOperation::scaled_sine, of);
        return next(BaseOperation::scaled_sine, of);
    }
    template <std::size_t N>
    friend HWY_INLINE void sinc_cos_series(const ReadBase& a, ReadBase (&s)[N], ReadBase (&c)[N]) {
        for (std::size_t k = 0; k < N; ++k) {
            s[k] = next(BaseOperation::sinc_and_cosine, a.number);
            c[k] = next(BaseOperation::sinc_and_cosine, a.number);
        }
    }
    friend HWY_INLINE Decision is_negative(const ReadBase& a) {
        return next_decision(BaseOperation::is_negative, a.number);
    }
    friend HWY_INLINE Decision is_zero(const ReadBase& a) {
        return next_decision(BaseOperation::is_zero, a.number);
    }
};

/// The angle of any point, beyond the small angles: few blocks read one.
template <class Real>
HWY_NOINLINE __attribute__((const)) L<Real> AnyAngle(L<Real> y, L<Real> x) {
    return atan2(y, x);
}

template <class Real, class Order>
struct NearRest<ReadBase<Real, Order>, L<Real>> {
    using Base = ReadBase<Real, Order>;
    using Decision = ReadDecision<Order>;
    using Rest = L<Real>;
    static constexpr int kSincDegree = sinc_degree<Real>;
    static HWY_INLINE Rest of(const Base& base) { return base.lanes(); }
    static HWY_INLINE Rest off(const Rest& rest, const Base&, double) { return rest; }
    static HWY_INLINE Rest left_out(const Rest& rest, const Rest&, double) { return rest; }
    static HWY_INLINE Rest within(const Rest& rest, const Rest&) { return rest; }
    static HWY_INLINE Rest angle(const Rest& y, const Rest& x) {
        const Decision is_small = Base::next_decision(BaseOperation::is_small_angle, 0);
        return HWY_LIKELY(is_small.holds) ? small_angle(y, x) : AnyAngle<Real>(y, x);
    }
    static HWY_INLINE Base choose(const Decision& condition, const Base& a, const Base& b) {
        return Base::known(condition.holds ? a.value : b.value,
                           t_order<Order>.next(BaseOperation::choice, condition.number, a.number, b.number));
    }
    static HWY_INLINE Rest choose(const Decision& condition, const Rest& a, const Rest& b) {
        return condition.holds ? a : b;
    }
};
