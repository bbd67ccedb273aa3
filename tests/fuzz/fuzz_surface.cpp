// SPDX-License-Identifier: Apache-2.0
// Surfaces of any text: points in double lie within their rounding of long double, and both within the range of their box.
// Displacements of any text lie within their bound.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/deform/formula_displacement.h"
#include "anamorph/surface/surface.h"
#include "expect_error.h"

using namespace anamorph;
using namespace anamorph::surface;

namespace {

void check_displacement(const DisplacementText& text) {
    const SpaceFormula formula = parse_displacement(text, 3);
    const FormulaDisplacement displacement(formula);
    for (const glm::dvec2 p : {glm::dvec2(0, .5), glm::dvec2(.3, .5), glm::dvec2(-.7, 2)}) {
        const FormulaOffsets offsets = displacement.offsets(std::span(&p, 1));
        // What has no value is either nowhere, or overflows on its way.
        if (offsets.undefined > 0 || !std::isfinite(offsets.error_bound)) continue;
        const long double u = p.x, v = p.y;
        const bool has_value = formula.is_everywhere || read_program<1>(formula.domain, u, v)[0] > 0;
        const long double exact = has_value ? read_program<3>(formula.point, u, v)[2] : 0;
        // The truth is rounded too.
        const long double unit = 0x1p-60L * (std::fabs(exact) + 1);
        fuzz::require(std::fabs(exact - offsets.values[2]) <= offsets.error_bound * (1 + 1e-3) + unit,
                      "a displacement lies within its bound");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size > 400) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const std::size_t end = bytes.find('\n');
    fuzz::expect_no_failure_but_error([&] {
        SurfaceText text;
        text.pz = bytes.substr(0, end);
        if (end != bytes.npos) text.let = bytes.substr(end + 1);
        SurfaceSum sum;
        sum.parts = {{surface_names().size() + 1, 1}};
        sum.formula = parse_surface(text, {1.5, 3});
        const auto surface = make_surface(sum);
        for (const double side : {1.0, 0.25, 0x1p-20})
            for (const double at : {0.0, 0.3, 0.5}) {
                const Interval u(at, std::min(at + side, 1.0)), v(0.5, std::min(0.5 + side, 1.0));
                if (surface->missing(u, v) != Certainty::no) continue;
                const Interval place = surface->range(u, v)[2].c[0];
                const double lost = surface->rounding(u, v), s = u.lo / 3 + u.hi / 3 * 2;
                const double z = surface->position(s, v.lo).z;
                const auto exact = static_cast<long double>(surface->truth(s, v.lo)[2]);
                if (!std::isfinite(magnitude(place)) || !std::isfinite(lost)) continue;
                // What overflows on its way has no point.
                if (!std::isfinite(z)) continue;
                fuzz::require(z >= place.lo && z <= place.hi, "a point lies within the range of its box");
                // The truth is rounded too.
                const long double unit = 0x1p-60L * (std::fabs(exact) + 1);
                fuzz::require(exact >= place.lo - unit && exact <= place.hi + unit,
                              "an exact point lies within the range of its box");
                fuzz::require(std::fabs(exact - z) <= lost * (1 + 1e-3) + 0x1p-64L,
                              "a point lies within its rounding");
            }
        check_displacement({"", "", text.pz, text.let});
    });
    return 0;
}
