// SPDX-License-Identifier: Apache-2.0
// Several intervals at a time: a vector of lower and one of upper ends. Each lane is what Interval gives for it, by the
// same operations in the same order, each rounded once: what number/interval.h derives holds lane by lane, bit for bit.
//
// Functions for which there is no vector, and what underflows, are read with Interval, lane by lane. Angles are vectors',
// within 5 units of 2^-53 (number/lanes.h), less than kLibmError, of which kLibmMargin is twice as much.
//
// No include guard and no namespace, as in number/lanes.h, behind which this is included.

template <class Tag>
struct LaneInterval {
    using D = Tag;
    using L = Lanes<Tag>;
    using M = LaneMask<Tag>;
    static constexpr int kCount = L::kCount;

    L lo, hi;

    LaneInterval() = default;
    HWY_INLINE LaneInterval(double k) : lo(k), hi(k) {}  // NOLINT: a number is an interval
    HWY_INLINE LaneInterval(const L& low, const L& high) : lo(low), hi(high) {}

    friend HWY_INLINE LaneInterval operator-(const LaneInterval& a) { return {-a.hi, -a.lo}; }
    friend HWY_INLINE LaneInterval operator+(const LaneInterval& a, const LaneInterval& b) {
        return widen(a.lo + b.lo, a.hi + b.hi, interval_detail::kUlp);
    }
    friend HWY_INLINE LaneInterval operator-(const LaneInterval& a, const LaneInterval& b) {
        return widen(a.lo - b.hi, a.hi - b.lo, interval_detail::kUlp);
    }
    friend HWY_INLINE LaneInterval operator*(const LaneInterval& a, const LaneInterval& b) {
        const L p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
        const LaneInterval product =
            widen(min(min(p, q), min(r, s)), max(max(p, q), max(r, s)), interval_detail::kUlp);
        const M known{hn::Eq((p + q + r + s).v, (p + q + r + s).v)};
        const M zero = either(both(is_zero(a.lo), is_zero(a.hi)), both(is_zero(b.lo), is_zero(b.hi)));
        if (somewhere(both(both(known, lost(product)), opposite(zero))))
            return by_lane(a, b, [](const Interval& x, const Interval& y) { return x * y; });
        // 0 times infinity is NaN, and no zero.
        return select(known, select(zero, LaneInterval(0), product), all());
    }
    friend HWY_INLINE LaneInterval operator*(const LaneInterval& a, double k) {
        const L p = a.lo * k, q = a.hi * k;
        const LaneInterval product =
            k < 0 ? widen(q, p, interval_detail::kUlp) : widen(p, q, interval_detail::kUlp);
        const M known{hn::Eq((p + q).v, (p + q).v)};
        const M zero = both(is_zero(a.lo), is_zero(a.hi));
        if (k == 0 || somewhere(either(opposite(known), both(lost(product), opposite(zero)))))
            return by_lane(a, [k](const Interval& x) { return x * k; });
        return select(zero, LaneInterval(0), product);
    }
    friend HWY_INLINE LaneInterval operator/(const LaneInterval& a, const LaneInterval& b) {
        const LaneInterval plain = widen(L(1) / b.hi, L(1) / b.lo, interval_detail::kUlp);
        const L least = select(lost(plain), L(interval_detail::kSmallest), L(0));
        const LaneInterval inverse{plain.lo - least, plain.hi + least};
        return select(either(L(0) < b.lo, b.hi < L(0)), a * inverse, all());
    }
    friend HWY_INLINE LaneInterval square(const LaneInterval& a) {
        const L p = a.lo * a.lo, q = a.hi * a.hi;
        const M known{hn::Eq((p + q).v, (p + q).v)};
        const M holds_zero{hn::And(hn::Le(a.lo.v, hn::Zero(Tag())), hn::Ge(a.hi.v, hn::Zero(Tag())))};
        LaneInterval r = widen(select(holds_zero, L(0), min(p, q)), max(p, q), interval_detail::kUlp);
        const M little = lost(r), zero = both(is_zero(a.lo), is_zero(a.hi));
        const L least = select(little, L(interval_detail::kSmallest), L(0));
        r = {max(r.lo - least, L(0)), r.hi + select(zero, L(0), least)};
        return select(known, r, all());
    }
    friend HWY_INLINE LaneInterval sqrt(const LaneInterval& a) {
        const LaneInterval r = widen(sqrt(a.lo), sqrt(a.hi), interval_detail::kUlp);
        return {select(r.lo < L(0), L(0), r.lo), r.hi};
    }
    friend HWY_INLINE LaneInterval atan2(const LaneInterval& y, const LaneInterval& x) {
        using namespace interval_detail;
        const L p = atan2(y.lo, x.lo), q = atan2(y.lo, x.hi), r = atan2(y.hi, x.lo), s = atan2(y.hi, x.hi);
        const LaneInterval angle = widen(min(min(p, q), min(r, s)), max(max(p, q), max(r, s)), kLibmMargin);
        // Beside the negative x axis; no infinity among the ends, nor angles next to nothing.
        const M beside = either(L(0) < x.lo, either(L(0) < y.lo, y.hi < L(0)));
        const L size = abs(x.lo) + abs(x.hi) + abs(y.lo) + abs(y.hi);
        const M plain = both(both(beside, size < L(HUGE_VAL)), opposite(lost(angle)));
        if (everywhere(plain)) return angle;
        return select(plain, angle, by_lane(y, x, [](const Interval& a, const Interval& b) {
                          return anamorph::atan2(a, b);
                      }));
    }

    friend HWY_INLINE LaneInterval select(const M& where, const LaneInterval& a, const LaneInterval& b) {
        return {select(where, a.lo, b.lo), select(where, a.hi, b.hi)};
    }

    static HWY_INLINE LaneInterval all() { return {L(-HUGE_VAL), L(HUGE_VAL)}; }
    static HWY_INLINE LaneInterval widen(const L& lo, const L& hi, double relative) {
        return {lo - abs(lo) * relative, hi + abs(hi) * relative};
    }
    /// Has an end lost digits to underflow?
    static HWY_INLINE M lost(const LaneInterval& a) {
        const L least(4 * interval_detail::kSmallest);
        return either(abs(a.lo) < least, abs(a.hi) < least);
    }
    static HWY_INLINE M either(const M& a, const M& b) { return {hn::Or(a.m, b.m)}; }
    static HWY_INLINE M opposite(const M& a) { return {hn::Not(a.m)}; }
    static HWY_INLINE bool somewhere(const M& a) { return !hn::AllFalse(Tag(), a.m); }
    static HWY_INLINE bool everywhere(const M& a) { return hn::AllTrue(Tag(), a.m); }

    /// The ends in memory.
    struct Ends {
        HWY_ALIGN double lo[kCount], hi[kCount];
        Interval operator[](int i) const { return {lo[i], hi[i]}; }
        void set(int i, const Interval& a) {
            lo[i] = a.lo;
            hi[i] = a.hi;
        }
    };
    HWY_INLINE Ends ends() const {
        Ends e;
        lo.store(e.lo);
        hi.store(e.hi);
        return e;
    }
    static HWY_INLINE LaneInterval of(const Ends& e) { return {L::load(e.lo), L::load(e.hi)}; }

    template <class Function>
    static HWY_NOINLINE LaneInterval by_lane(const LaneInterval& a, const LaneInterval& b,
                                             const Function& function) {
        const Ends x = a.ends(), y = b.ends();
        Ends r;
        for (int i = 0; i < kCount; ++i) r.set(i, function(x[i], y[i]));
        return of(r);
    }
    template <class Function>
    static HWY_NOINLINE LaneInterval by_lane(const LaneInterval& a, const Function& function) {
        return by_lane(a, a, [&](const Interval& x, const Interval&) { return function(x); });
    }
};

template <class Tag>
HWY_INLINE void sin_cos(const LaneInterval<Tag>& a, LaneInterval<Tag>& s, LaneInterval<Tag>& c) {
    s = LaneInterval<Tag>::by_lane(a, [](const Interval& x) { return anamorph::sin(x); });
    c = LaneInterval<Tag>::by_lane(a, [](const Interval& x) { return anamorph::cos(x); });
}
template <class Tag>
HWY_INLINE LaneInterval<Tag> exp(const LaneInterval<Tag>& a) {
    return LaneInterval<Tag>::by_lane(a, [](const Interval& x) { return anamorph::exp(x); });
}
template <class Tag>
HWY_INLINE LaneInterval<Tag> log(const LaneInterval<Tag>& a) {
    return LaneInterval<Tag>::by_lane(a, [](const Interval& x) { return anamorph::log(x); });
}
template <class Tag>
HWY_INLINE LaneInterval<Tag> asinh(const LaneInterval<Tag>& a) {
    return LaneInterval<Tag>::by_lane(a, [](const Interval& x) { return anamorph::asinh(x); });
}
template <class Tag>
HWY_INLINE LaneInterval<Tag> scaled_sinh(const LaneInterval<Tag>& a, LaneInterval<Tag>& s) {
    s = LaneInterval<Tag>::by_lane(a, [](const Interval& x) { return anamorph::tanh(x); });
    return LaneInterval<Tag>::by_lane(a, [](const Interval& x) {
        Interval sine;
        return anamorph::scaled_sinh(x, sine);
    });
}
