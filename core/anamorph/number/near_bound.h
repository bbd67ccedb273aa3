// SPDX-License-Identifier: Apache-2.0
// Numbers near a known one (number/near.h) as they are read before a block is drawn: to bound what float or double does
// to its pixels, and to write down its bases.
#pragma once

#include <vector>

#include "anamorph/number/rounded.h"

namespace anamorph {

#define ANAMORPH_INLINE inline
#include "anamorph/number/near.h"
#undef ANAMORPH_INLINE

// --- bounds ---

namespace rounded_detail {

/// Errors of what lanes.h has for rests, in units of Real of the value.
inline constexpr double kRestUnits = 4;
inline constexpr double kEighth = 0.785398163397448, kTangentOfSixteenth = 0.414213562373095;

template <class Real>
Rounded<Real> unbounded() {
    return {Interval::all(), 0, HUGE_VAL};
}

}  // namespace rounded_detail

/// sin a and 1 - cos a, |a| <= pi / 4; unbounded beyond.
template <class Real>
void sine_versine(const Rounded<Real>& a, Rounded<Real>& s, Rounded<Real>& v) {
    const double most = magnitude(a.range) + a.error;
    if (!(most <= rounded_detail::kEighth)) {
        s = v = rounded_detail::unbounded<Real>();
        return;
    }
    const Interval sine = sin(a.range), half_sine = sin(a.range * 0.5);
    const Interval versine = square(half_sine) * 2.0;
    const double unit = rounded_detail::kRestUnits * Rounded<Real>::kUnit;
    s = rounded_detail::result<Real>(sine, 0, a.error + unit * (magnitude(sine) + a.error), 0);
    // |sin| <= most.
    const double moved = a.error * most;
    v = rounded_detail::result<Real>(versine, 0, moved + unit * (magnitude(versine) + moved), 0);
}
/// atan a, |a| <= tan(pi / 8); unbounded beyond.
template <class Real>
Rounded<Real> small_atan(const Rounded<Real>& a) {
    if (!(magnitude(a.range) + a.error <= rounded_detail::kTangentOfSixteenth))
        return rounded_detail::unbounded<Real>();
    const Interval angle = atan2(a.range, Interval(1.0));
    const double unit = rounded_detail::kRestUnits * Rounded<Real>::kUnit;
    return rounded_detail::result<Real>(angle, 0, a.error + unit * (magnitude(angle) + a.error), 0);
}

template <class Real>
struct NearRest<Interval, Rounded<Real>> {
    using R = Rounded<Real>;
    static constexpr bool kBounds = true;

    static R of(const Interval& base) {
        if (std::is_same_v<Real, double>) return R(base, 0, 0);
        const bool kept = base.lo == base.hi && static_cast<double>(static_cast<Real>(base.lo)) == base.lo;
        return kept ? R(base.lo) : rounded_detail::result<Real>(base, 0, 0, R::kUnit);
    }
    static R off(const R& rest, const Interval& base, double units) {
        const double by = units * 0x1p-53 * magnitude(base) * rounded_detail::kUp;
        return by == 0 ? rest : R(rest.range + Interval(-by, by), 0, (rest.error + by) * rounded_detail::kUp);
    }
    static Near<Interval, R> near(double value, double error) {
        return {Interval(value), R(Interval(-error, error), 0, error)};
    }
    template <class T>
    static T choose(Certainty condition, const T& a, const T& b) {
        return select(condition, a, b);
    }
    template <class T>
    static T choose(bool condition, const T& a, const T& b) {
        return condition ? a : b;
    }
};

/// Bounds what Real, float or double, does to a formula that is read near known points.
template <class Real>
using NearBound = Near<Interval, Rounded<Real>>;

// --- bases ---

/// The bases of one reading of a formula, in order.
using Bases = std::vector<double>;

/// A base in double. The result of every operation is written down where WrittenBase::to points; decisions as 1 or 0.
struct WrittenBase {
    static inline thread_local Bases* to = nullptr;

    double value = 0;

    WrittenBase() = default;
    WrittenBase(double k) : value(k) {}  // NOLINT: a number is a constant
    static WrittenBase written(double value) {
        to->push_back(value);
        return value;
    }
    static bool written_decision(bool holds) {
        to->push_back(holds ? 1.0 : 0.0);
        return holds;
    }

    friend WrittenBase operator-(const WrittenBase& a) { return written(-a.value); }
    friend WrittenBase operator+(const WrittenBase& a, const WrittenBase& b) {
        return written(a.value + b.value);
    }
    friend WrittenBase operator-(const WrittenBase& a, const WrittenBase& b) {
        return written(a.value - b.value);
    }
    friend WrittenBase operator*(const WrittenBase& a, const WrittenBase& b) {
        return written(a.value * b.value);
    }
    friend WrittenBase operator/(const WrittenBase& a, const WrittenBase& b) {
        return written(a.value / b.value);
    }
    friend WrittenBase sqrt(const WrittenBase& a) { return written(std::sqrt(a.value)); }
    friend void sin_cos(const WrittenBase& a, WrittenBase& s, WrittenBase& c) {
        s = written(std::sin(a.value));
        c = written(std::cos(a.value));
    }
    friend WrittenBase atan2(const WrittenBase& y, const WrittenBase& x) {
        return written(std::atan2(y.value, x.value));
    }
    friend WrittenBase asinh(const WrittenBase& a) { return written(std::asinh(a.value)); }
    friend WrittenBase scaled_sinh(const WrittenBase& a, WrittenBase& s) {
        double t = 0;
        const double c = scaled_sinh(a.value, t);
        s = written(t);
        return written(c);
    }
    friend bool is_negative(const WrittenBase& a) { return written_decision(a.value < 0); }
    friend bool is_zero(const WrittenBase& a) { return written_decision(a.value == 0); }
};

/// The rest of a number of which only the base is asked for.
struct NoRest {
    NoRest() = default;
    explicit NoRest(double) {}
    friend NoRest operator-(NoRest) { return {}; }
    friend NoRest operator+(NoRest, NoRest) { return {}; }
    friend NoRest operator-(NoRest, NoRest) { return {}; }
    friend NoRest operator*(NoRest, NoRest) { return {}; }
    friend NoRest operator/(NoRest, NoRest) { return {}; }
    friend NoRest sqrt(NoRest) { return {}; }
    friend NoRest asinh(NoRest) { return {}; }
    friend NoRest small_atan(NoRest) { return {}; }
    friend void sine_versine(NoRest, NoRest&, NoRest&) {}
    friend NoRest scaled_sinh(NoRest, NoRest&) { return {}; }
    friend bool is_negative(NoRest) { return false; }
    friend bool is_zero(NoRest) { return false; }
};
inline NoRest select(bool, NoRest, NoRest) {
    return {};
}

template <>
struct NearRest<WrittenBase, NoRest> {
    static NoRest of(const WrittenBase&) { return {}; }
    static NoRest off(NoRest, const WrittenBase&, double) { return {}; }
    template <class T>
    static T choose(bool condition, const T& a, const T& b) {
        return condition ? a : b;
    }
};

/// Writes down the bases of a formula.
using NearBase = Near<WrittenBase, NoRest>;

}  // namespace anamorph
