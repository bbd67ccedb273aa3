// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/coverage_source.h"

#include <cstdint>
#include <exception>

#include "anamorph/image/pyramid.h"

namespace anamorph {

/// A mean over a rectangle of texels is one across of means down, so that each axis stands for itself. A texel that the window's
/// edge does not meet, nor do the texels that it is made of, is 1 or 0; so at most two of a level go on to the next finer one.
double CoverageSource::Axis::share(int level, int at) const noexcept {
    int low = at, high = at + 1;
    for (int l = level; l > 0; --l) {
        const int fine = texels[static_cast<std::size_t>(l - 1)],
                  coarse = texels[static_cast<std::size_t>(l)];
        low = span_of_texel(low, fine, coarse).first;
        const TexelSpan last = span_of_texel(high - 1, fine, coarse);
        high = last.first + last.count;
    }
    if (first <= low && high <= end) return 1;
    if (high <= first || low >= end) return 0;
    const TexelSpan span = span_of_texel(at, texels[static_cast<std::size_t>(level - 1)],
                                         texels[static_cast<std::size_t>(level)]);
    double sum = 0;
    for (int k = 0; k < span.count; ++k)
        sum += double{span.weight[static_cast<std::size_t>(k)]} * share(level - 1, span.first + k);
    return sum;
}

bool CoverageSource::read(int level, const Box& box, std::byte* texels,
                          std::ptrdiff_t row_stride) const noexcept try {
    Axis across{{}, m_has.x0, m_has.x1}, down{{}, m_has.y0, m_has.y1};
    for (int l = 0; l <= level; ++l) {
        across.texels.push_back(size(l).width);
        down.texels.push_back(size(l).height);
    }
    std::vector<double> columns;
    for (int x = box.x0; x < box.x1; ++x) columns.push_back(across.share(level, x));
    for (int y = box.y0; y < box.y1; ++y, texels += row_stride) {
        auto* const row = reinterpret_cast<float*>(texels);
        const double share = down.share(level, y);
        for (std::size_t i = 0; i < columns.size(); ++i) row[i] = static_cast<float>(share * columns[i]);
    }
    return true;
} catch (const std::exception&) {
    return false;
}

}  // namespace anamorph
