// SPDX-License-Identifier: Apache-2.0
// Formulas of any text, parsed and planned: every pixel that is drawn lies within its bound of long double.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "anamorph/formula/text_plan.h"
#include "expect_error.h"

using namespace anamorph;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size > 400) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const std::size_t end = bytes.find('\n');
    fuzz::expect_no_failure_but_error([&] {
        FormulaText text;
        text.u = bytes.substr(0, end);
        if (end != bytes.npos) text.let = bytes.substr(end + 1);
        const Size picture{16, 8}, source{32, 16};
        PlanOptions options;
        options.tol = 1.0 / 16;
        const TextPlan plan(TextMap(parse_formula(text, {picture, source}), picture, picture, source),
                            options);
        for (const Block& block : plan.blocks(0)) {
            if (block.kind != Block::Kind::exact) continue;
            Point<double> point{};
            Point<DoubleDouble> truth{};
            int piece = 0;
            const double x = block.box.x0 + 0.5, y = block.box.y0 + 0.5;
            if (!static_cast<const BlockMap&>(plan).exact(block, x, y, point, piece)) continue;
            if (!std::isfinite(block.bound) || !plan.truth(x, y, 0, truth, piece)) continue;
            const auto error = static_cast<double>(hypot(point.x - truth.x, point.y - truth.y));
            // The truth is rounded too.
            fuzz::require(error <= block.bound * (1 + 1e-3), "a point lies within its bound");
        }
    });
    return 0;
}
