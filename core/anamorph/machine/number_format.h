// SPDX-License-Identifier: Apache-2.0
// Number formats of graphics hardware: small floats, two's-complement fixed point, normalised texels; and a number that
// is rounded to its format after every operation, with which formulas are read (number.h).
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include "anamorph/number/number.h"
#include "anamorph/number/portable.h"

namespace anamorph::machine {

/// The format in which a value is stored. Rounding is to nearest, ties to even.
struct NumberFormat {
    enum class Kind : std::uint8_t {
        floating,   ///< 1 bit of sign, `bits` of exponent, `fraction` bits behind a leading 1
        fixed,      ///< two's complement of `bits` bits, `fraction` of them behind the point
        normalised  ///< k / (2^bits - 1), k from 0 to 2^bits - 1
    };
    Kind kind;
    int bits, fraction = 0;
    bool wraps = false;       ///< fixed: what lies beyond the range loses its upper bits; else it saturates
    bool subnormals = false;  ///< floating: numbers below 2^(2 - 2^(bits - 1)) are kept; else they are 0

    bool operator==(const NumberFormat&) const = default;
};

inline constexpr NumberFormat kFloat16{NumberFormat::Kind::floating, 5, 10, false, true};
/// The format of pixel shaders of 2003: 1, 7 and 16 bits.
inline constexpr NumberFormat kFloat24{NumberFormat::Kind::floating, 7, 16};
inline constexpr NumberFormat kFloat32{NumberFormat::Kind::floating, 8, 23, false, true};
/// The format of pixel shaders before floats: -8 to 8 in steps of 2^-12.
inline constexpr NumberFormat kFixed16{NumberFormat::Kind::fixed, 16, 12};
inline constexpr NumberFormat kFixed32{NumberFormat::Kind::fixed, 32, 16};
/// The formats of a component of D3DFMT_V8U8, V16U16 and G16R16: -1 to 1 - 2^-7, -1 to 1 - 2^-15, and 0 to 1.
inline constexpr NumberFormat kSigned8{NumberFormat::Kind::fixed, 8, 7};
inline constexpr NumberFormat kSigned16{NumberFormat::Kind::fixed, 16, 15};
inline constexpr NumberFormat kUnsigned16{NumberFormat::Kind::normalised, 16};
/// The format of a channel of D3DFMT_X8R8G8B8, 0 to 1.
inline constexpr NumberFormat kUnsigned8{NumberFormat::Kind::normalised, 8};

/// float16, float24, float32, fixed16, fixed32, V8U8, V16U16 or G16R16; of these only those `allowed`, where any are given.
/// Throws Error naming `parameter` and what is allowed.
NumberFormat number_format_from_name(std::string_view name, const std::string& parameter,
                                     std::initializer_list<NumberFormat> allowed = {});
/// The name of a format, one of those that number_format_from_name() reads.
std::string name_of(const NumberFormat& format);

/// The largest number of the format.
double largest(const NumberFormat& format);

namespace format_detail {

/// The units that a fixed format gives what lies beyond its range.
double beyond_fixed(const NumberFormat& format, double units, bool& beyond);
double nearest_normalised(const NumberFormat& format, double value, bool& beyond);

/// The power 2^exponent, from 2^-1022 to 2^1023.
constexpr double power_of_2(int exponent) {
    return bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

/// The nearest integer, ties to even, of a size of at most 2^51: the sum has no bits behind the point.
inline double nearest_integer(double value) {
    constexpr double kShift = 0x1.8p52;
    return value + kShift - kShift;
}

// Rounds to a floating format. It is inlined so that a format known to the compiler costs nothing
// (nearest_of).
[[gnu::always_inline]] inline double nearest_float(const NumberFormat& format, double value, bool& beyond) {
    constexpr int kDoubleFraction = 52;
    const int bias = (1 << (format.bits - 1)) - 1, least = 1 - bias;
    const double size = std::fabs(value), smallest = power_of_2(least);
    if (std::isnan(value)) {
        beyond = true;
        return value;
    }
    double rounded = 0;
    if (size < smallest) {
        // Multiples of the least binade's last place.
        const double place = power_of_2(least - format.fraction), shift = 0x1.8p52 * place;
        rounded = size + shift - shift;
        if (rounded < smallest && !format.subnormals) rounded = 0;
    } else {
        // What is cut off carries into the bits above it where it is more than half of their last one, or half and
        // that one is odd.
        const int cut = kDoubleFraction - format.fraction;
        auto bits = bit_cast<std::uint64_t>(size);
        bits += (std::uint64_t{1} << (cut - 1)) - 1 + (bits >> cut & 1);
        rounded = bit_cast<double>(bits >> cut << cut);
    }
    if (rounded >= power_of_2(bias + 1)) {
        beyond = true;
        rounded = std::numeric_limits<double>::infinity();
    }
    return std::copysign(rounded, value);
}

[[gnu::always_inline]] inline double nearest_fixed(const NumberFormat& format, double value, bool& beyond) {
    const double half = power_of_2(format.bits - 1), unit = power_of_2(-format.fraction),
                 exact = value * power_of_2(format.fraction);
    // Two's complement has one zero, which 0 added to the other makes.
    if (exact >= -half - 1 && exact <= half) {
        const double units = nearest_integer(exact) + 0.0;
        if (units >= -half && units < half) return units * unit;
    }
    return beyond_fixed(format, exact, beyond) * unit;
}

}  // namespace format_detail

/// The nearest number of the format. Sets `beyond` where the value rounds to none of its range, or is NaN: fixed and
/// normalised formats then give the nearest end (wrapped: what is left of it; NaN: 0), floating ones infinity or NaN.
[[gnu::always_inline]] inline double nearest(const NumberFormat& format, double value, bool& beyond) {
    switch (format.kind) {
        case NumberFormat::Kind::floating:
            return format_detail::nearest_float(format, value, beyond);
        case NumberFormat::Kind::fixed:
            return format_detail::nearest_fixed(format, value, beyond);
        default:
            return format_detail::nearest_normalised(format, value, beyond);
    }
}
inline double nearest(const NumberFormat& format, double value) {
    bool beyond = false;
    return nearest(format, value, beyond);
}

/// The nearest number of a format that the compiler knows, as nearest() finds it.
template <NumberFormat kFormat>
double nearest_of(double value, bool& beyond) {
    return nearest(kFormat, value, beyond);
}

/// A number that is rounded to its format after every operation. Sums, products, quotients and roots of formats of up to
/// 24 significant bits are correctly rounded: double holds more than twice as many, and two. So are kFixed32's: exact ones of
/// its range are farther from a tie than double's rounding, 2^-32 and 2^-39.
template <NumberFormat kFormat>
struct FormatNumber {
    /// Was it, or a number that it is made of, beyond the range?
    bool beyond = false;
    double value = 0;

    FormatNumber() = default;
    /// The largest number of the format.
    static FormatNumber greatest() { return {largest(kFormat)}; }
    FormatNumber(double exact)
        : value(nearest_of<kFormat>(exact, beyond)) {}  // NOLINT: a number is one, rounded

    /// Makes a number of an exact result of `operands`.
    template <class... Operands>
    static FormatNumber made_of(double exact, const Operands&... operands) {
        FormatNumber made(exact);
        made.beyond = (made.beyond || ... || operands.beyond);
        return made;
    }

    friend FormatNumber operator-(FormatNumber a) { return made_of(-a.value, a); }
    friend FormatNumber operator+(FormatNumber a, FormatNumber b) { return made_of(a.value + b.value, a, b); }
    friend FormatNumber operator-(FormatNumber a, FormatNumber b) { return made_of(a.value - b.value, a, b); }
    friend FormatNumber operator*(FormatNumber a, FormatNumber b) { return made_of(a.value * b.value, a, b); }
    friend FormatNumber operator/(FormatNumber a, FormatNumber b) { return made_of(a.value / b.value, a, b); }
    friend FormatNumber square(FormatNumber a) { return a * a; }
    friend FormatNumber sqrt(FormatNumber a) { return made_of(std::sqrt(a.value), a); }
    friend FormatNumber root(FormatNumber a) { return sqrt(a); }
    friend void sin_cos(FormatNumber a, FormatNumber& s, FormatNumber& c) {
        s = made_of(std::sin(a.value), a);
        c = made_of(std::cos(a.value), a);
    }
    friend FormatNumber atan2(FormatNumber b, FormatNumber a) {
        return made_of(std::atan2(b.value, a.value), a, b);
    }
    friend FormatNumber exp(FormatNumber a) { return made_of(std::exp(a.value), a); }
    friend FormatNumber log(FormatNumber a) { return made_of(std::log(a.value), a); }
    friend FormatNumber exp2(FormatNumber a) { return made_of(std::exp2(a.value), a); }
    friend FormatNumber log2(FormatNumber a) { return made_of(std::log2(a.value), a); }
    friend FormatNumber asinh(FormatNumber a) { return made_of(std::asinh(a.value), a); }
    friend FormatNumber min(FormatNumber a, FormatNumber b) { return b.value < a.value ? b : a; }
    friend FormatNumber max(FormatNumber a, FormatNumber b) { return a.value < b.value ? b : a; }
    friend bool is_zero(FormatNumber a) { return a.value == 0; }
    friend bool is_negative(FormatNumber a) { return a.value < 0; }
    /// A hair is 128 units of rounding.
    friend FormatNumber without_hair(FormatNumber a) {
        const bool hair = a.value < 0 && a.value > -std::ldexp(1.0, 6 - kFormat.fraction);
        return hair ? made_of(0, a) : a;
    }
    friend FormatNumber scaled_sinh(FormatNumber a, FormatNumber& s) {
        s = made_of(std::tanh(a.value), a);
        return made_of(1 / std::cosh(a.value), a);
    }
    friend double enlarger(FormatNumber, FormatNumber) { return 1; }
};

/// Numbers of a processor: each result is rounded to its format.
struct Rounding {
    NumberFormat format;

    double operator()(double value) const {
        bool beyond = false;
        return nearest(format, value, beyond);
    }
};

/// Calls body(FormatNumber<format>()) for a format in which hardware computes: float16, float24, fixed16,
/// fixed32, and float32 in place of all others.
template <class Body>
decltype(auto) with_format(const NumberFormat& format, const Body& body) {
    if (format == kFloat16) return body(FormatNumber<kFloat16>());
    if (format == kFloat24) return body(FormatNumber<kFloat24>());
    if (format == kFixed16) return body(FormatNumber<kFixed16>());
    if (format == kFixed32) return body(FormatNumber<kFixed32>());
    return body(FormatNumber<kFloat32>());
}

}  // namespace anamorph::machine
