// SPDX-License-Identifier: Apache-2.0
#include "anamorph/map/text_map.h"

#include <algorithm>
#include <cmath>

#include "anamorph/simd/program_rows.h"

namespace anamorph {

void TextMap::exact_row(double x, double y, int count, double* to_x, double* to_y,
                        std::int32_t* piece) const {
    using simd::kProgramRow, simd::ProgramRow;
    const double per_x = m_is_scaled ? m_per_x.as<double>() : 1,
                 per_y = m_is_scaled ? m_per_y.as<double>() : 1;
    ProgramRow at, found, domain;
    for (int begin = 0; begin < count; begin += kProgramRow) {
        const int part = std::min(count - begin, kProgramRow);
        for (int i = 0; i < kProgramRow; ++i) {
            // What stands behind the last point is read, and left.
            at.x[i] = (x + begin + std::min(i, part - 1)) * per_x;
            at.y[i] = y * per_y;
        }
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

}  // namespace anamorph
