// SPDX-License-Identifier: Apache-2.0
#include "anamorph/formula/text_map.h"

#include <algorithm>
#include <cmath>

#include "anamorph/geometry/count_pixels.h"
#include "anamorph/number/program_rows.h"

namespace anamorph {

void TextMap::exact_row(double x, double y, int count, double* to_x, double* to_y,
                        std::int32_t* piece) const {
    using simd::kProgramRow, simd::ProgramRow;
    ProgramRow at, found, domain;
    for (int begin = 0; begin < count; begin += kProgramRow) {
        const int part = std::min(count - begin, kProgramRow);
        at.set_points(x + begin, y, part, m_scale);
        simd::read_program_row(m_formula.point, at, part, found);
        if (!m_formula.is_everywhere) simd::read_program_row(m_formula.domain, at, part, domain);
        for (int i = 0; i < part; ++i) {
            const bool is_inside = m_formula.is_everywhere || domain.x[i] > 0;
            const bool is_seen = is_inside && std::isfinite(found.x[i]) && std::isfinite(found.y[i]);
            to_x[begin + i] = is_seen ? found.x[i] : 0;
            to_y[begin + i] = is_seen ? found.y[i] : 0;
            piece[begin + i] = is_seen ? 0 : -1;
        }
    }
}

Certainty TextMap::is_defined(const Box& box) const {
    const DefinedInterval x(Interval(box.x0 + 0.5, box.x1 - 0.5)), y(Interval(box.y0 + 0.5, box.y1 - 0.5));
    const Interval domain = m_formula.is_everywhere ? Interval(1) : read(m_formula.domain, x, y).x;
    if (domain.hi <= 0) return Certainty::no;
    const auto [u, v] = read(m_formula.point, x, y);
    return domain.lo > 0 && std::isfinite(magnitude(u)) && std::isfinite(magnitude(v)) ? Certainty::yes
                                                                                       : Certainty::open;
}

std::int64_t TextMap::undefined_pixels(const Box& box) const {
    // Of fewer pixels, their own points cost no more than intervals.
    constexpr int kFew = 16;
    const auto is_undefined = [&](const Box& b) {
        const Certainty defined = is_defined(b);
        return defined == Certainty::yes  ? Certainty::no
               : defined == Certainty::no ? Certainty::yes
                                          : defined;
    };
    const auto is_small = [](const Box& b) { return b.width() <= kFew && b.height() <= kFew; };
    return count_pixels(box, is_undefined, is_small, [&](const Box& b) {
        std::int64_t count = 0;
        double x[kFew], y[kFew];
        std::int32_t piece[kFew];
        for (int row = b.y0; row < b.y1; ++row) {
            exact_row(b.x0 + 0.5, row + 0.5, b.width(), x, y, piece);
            count += std::count(piece, piece + b.width(), -1);
        }
        return count;
    });
}

}  // namespace anamorph
