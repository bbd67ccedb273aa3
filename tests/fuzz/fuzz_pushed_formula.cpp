// SPDX-License-Identifier: Apache-2.0
// Formulas of any text that push, inverted: source points lie within their bounds of long double. Small, since each is searched for.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "anamorph/formula/pushed_map.h"
#include "expect_error.h"

using namespace anamorph;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size > 100) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const std::size_t end = bytes.find('\n');
    fuzz::expect_no_failure_but_error([&] {
        FormulaText text;
        text.u = bytes.substr(0, end);
        if (end != bytes.npos) text.v = bytes.substr(end + 1);
        const Size picture{4, 2}, source{6, 5};
        constexpr std::size_t kMostParts = 40;
        const PushedMap map(parse_formula(text, {picture, source, 0, false, true}), picture, picture, source,
                            kMostParts);
        for (const double x : {0.5, 2.5}) {
            constexpr double kRow = 1.5;
            Point<double> point{};
            Point<DoubleDouble> truth{};
            int piece = 0;
            if (map.preimages(x, kRow).on_fold || !map.exact(x, kRow, 0, point, piece)) continue;
            fuzz::require(map.exact<DoubleDouble>(x, kRow, 0, truth, piece),
                          "DoubleDouble finds a point, too");
            const double bound =
                map.exact_error<double>(x, kRow, 0) + map.exact_error<DoubleDouble>(x, kRow, 0);
            const auto off = static_cast<double>(hypot(point.x - truth.x, point.y - truth.y));
            fuzz::require(!(off > bound), "points lie within their bounds");
        }
    });
    return 0;
}
