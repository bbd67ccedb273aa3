// SPDX-License-Identifier: Apache-2.0
// Counts the pixels of a box that a map folds, by bounds: most boxes have one sign of the Jacobian's
// determinant throughout.
#pragma once

#include <cmath>
#include <cstdint>

#include "anamorph/geometry/count_pixels.h"
#include "anamorph/mesh/hermite.h"
#include "anamorph/plan/block_writer.h"

namespace anamorph {

/// The sign of the Jacobian's determinant on a block: of a map in powers of parameters in [-1, 1], each of
/// whose derivatives errs by at most `rounding`. 0 where it is not the same everywhere, as far as can be
/// seen.
inline int sign_of_determinant(const Bicubic& f, double rounding) {
    // A derivative is c[1][0] (along s) or c[0][1] (along t), give or take the magnitudes of its other terms.
    struct Range {
        double middle, radius;
    };
    const auto range = [&](const double(&c)[4][4], bool along_s) {
        Range r{along_s ? c[1][0] : c[0][1], rounding - std::fabs(along_s ? c[1][0] : c[0][1])};
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) r.radius += (along_s ? i : j) * std::fabs(c[i][j]);
        return r;
    };
    const auto times = [](const Range& a, const Range& b) {
        const double radius =
            std::fabs(a.middle) * b.radius + a.radius * std::fabs(b.middle) + a.radius * b.radius;
        return Range{a.middle * b.middle, radius};
    };
    const Range forth = times(range(f.x, true), range(f.y, false)),
                back = times(range(f.x, false), range(f.y, true));
    const double middle = forth.middle - back.middle;
    const double radius =
        (forth.radius + back.radius) + 1e-14 * (std::fabs(forth.middle) + std::fabs(back.middle));
    return middle > radius ? 1 : middle < -radius ? -1 : 0;
}

/// Counts the folded pixels of a box. sign(box) is 1 where none certainly is folded, -1 where certainly all
/// are, else 0; count(box) looks at the pixels of a small box one by one.
template <class Sign, class Count>
std::int64_t count_folded(const Box& box, const Sign& sign, const Count& count) {
    const auto certainty = [&](const Box& b) {
        const int all = sign(b);
        return all > 0 ? Certainty::no : all < 0 ? Certainty::yes : Certainty::open;
    };
    return count_pixels(box, certainty, BlockWriter::below_floor, count);
}

}  // namespace anamorph
