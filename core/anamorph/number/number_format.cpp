// SPDX-License-Identifier: Apache-2.0
#include "anamorph/number/number_format.h"

#include <utility>

#include "anamorph/error.h"
#include "anamorph/parameter.h"

namespace anamorph {
namespace {

constexpr std::pair<const char*, NumberFormat> kNames[] = {
    {"float16", kFloat16}, {"float24", kFloat24}, {"float32", kFloat32}, {"fixed16", kFixed16},
    {"fixed32", kFixed32}, {"V8U8", kSigned8},    {"V16U16", kSigned16}, {"G16R16", kUnsigned16}};

double nearest_float(const NumberFormat& format, double value, bool& beyond) {
    beyond = beyond || std::isnan(value);
    if (value == 0 || std::isnan(value)) return value;
    const int bias = (1 << (format.bits - 1)) - 1, least = 1 - bias;
    // The last place of the number's binade; of numbers below all binades, that of the least one.
    double rounded = value;
    if (!std::isinf(value)) {
        const int place = std::max(std::ilogb(value), least) - format.fraction;
        rounded = std::ldexp(std::nearbyint(std::ldexp(value, -place)), place);
    }
    const double size = std::fabs(rounded);
    if (size < std::ldexp(1.0, least) && !format.subnormals) return std::copysign(0.0, value);
    if (size < std::ldexp(1.0, bias + 1)) return rounded;
    beyond = true;
    return std::copysign(std::numeric_limits<double>::infinity(), value);
}

double nearest_fixed(const NumberFormat& format, double value, bool& beyond) {
    // Two's complement has one zero.
    const double units = std::nearbyint(std::ldexp(value, format.fraction)) + 0.0;
    const double half = std::ldexp(1.0, format.bits - 1);
    if (units >= -half && units < half) return std::ldexp(units, -format.fraction);
    beyond = true;
    double kept = 0;
    if (!format.wraps && !std::isnan(units)) {
        kept = units < 0 ? -half : half - 1;
    } else if (std::isfinite(units)) {
        kept = std::fmod(units, 2 * half);
        kept -= kept >= half ? 2 * half : kept < -half ? -2 * half : 0;
    }
    return std::ldexp(kept, -format.fraction);
}

double nearest_normalised(const NumberFormat& format, double value, bool& beyond) {
    // A product that was rounded to the middle of two integers may have come from either side of it: its rest says from which.
    const double most = std::ldexp(1.0, format.bits) - 1, product = value * most;
    double k = std::nearbyint(product);
    if (std::fabs(product - k) == 0.5) {
        const double rest = std::fma(value, most, -product);
        if (rest != 0) k = product + std::copysign(0.5, rest);
    }
    if (k >= 0 && k <= most) return std::fabs(k) / most;
    beyond = true;
    return k > most ? 1 : 0;
}

}  // namespace

NumberFormat number_format_from_name(std::string_view name, const std::string& parameter) {
    std::string names;
    for (const auto& [known, format] : kNames) {
        if (name == known) return format;
        names += (names.empty() ? "" : ", ") + std::string(known);
    }
    throw Error(parameter, printable(name), "must be one of " + names);
}

std::string name_of(const NumberFormat& format) {
    for (const auto& [name, known] : kNames)
        if (format == known) return name;
    return std::to_string(format.bits) + "." + std::to_string(format.fraction);
}

double largest(const NumberFormat& format) {
    switch (format.kind) {
        case NumberFormat::Kind::floating:
            return std::ldexp(2 - std::ldexp(1.0, -format.fraction), (1 << (format.bits - 1)) - 1);
        case NumberFormat::Kind::fixed:
            return std::ldexp(std::ldexp(1.0, format.bits - 1) - 1, -format.fraction);
        default:
            return 1;
    }
}

double nearest(const NumberFormat& format, double value, bool& beyond) {
    if (format == kFloat32 && std::fabs(value) <= std::numeric_limits<float>::max())
        return static_cast<double>(static_cast<float>(value));  // the same, by the processor
    switch (format.kind) {
        case NumberFormat::Kind::floating:
            return nearest_float(format, value, beyond);
        case NumberFormat::Kind::fixed:
            return nearest_fixed(format, value, beyond);
        default:
            return nearest_normalised(format, value, beyond);
    }
}

}  // namespace anamorph
