// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/number_format.h"

#include <algorithm>
#include <utility>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::machine {
namespace {

constexpr std::pair<const char*, NumberFormat> kNames[] = {
    {"float16", kFloat16}, {"float24", kFloat24}, {"float32", kFloat32}, {"fixed16", kFixed16},
    {"fixed32", kFixed32}, {"V8U8", kSigned8},    {"V16U16", kSigned16}, {"G16R16", kUnsigned16}};

}  // namespace

NumberFormat number_format_from_name(std::string_view name, const std::string& parameter,
                                     std::initializer_list<NumberFormat> allowed) {
    std::string names;
    for (const auto& [known, format] : kNames) {
        if (allowed.size() > 0 && std::find(allowed.begin(), allowed.end(), format) == allowed.end())
            continue;
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

namespace format_detail {

double beyond_fixed(const NumberFormat& format, double units, bool& beyond) {
    const double half = power_of_2(format.bits - 1);
    beyond = true;
    if (!format.wraps && !std::isnan(units)) return units < 0 ? -half : half - 1;
    if (!std::isfinite(units)) return 0;
    const double kept = std::fmod(std::nearbyint(units), 2 * half);
    return kept + (kept >= half ? -2 * half : kept < -half ? 2 * half : 0.0);
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

}  // namespace format_detail

}  // namespace anamorph::machine
