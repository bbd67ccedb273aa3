// SPDX-License-Identifier: Apache-2.0
// An image with left and right changed, as it is seen from behind.
#pragma once

#include <algorithm>
#include <vector>

#include "anamorph/image/source.h"

namespace anamorph {

/// Keeps a reference to the base.
class MirroredSource final : public Source {
  public:
    explicit MirroredSource(const Source& base) : m_base(base) {}

    PixelType type() const noexcept override { return m_base.type(); }
    int channels() const noexcept override { return m_base.channels(); }
    int unassociated_alpha() const noexcept override { return m_base.unassociated_alpha(); }
    int levels() const noexcept override { return m_base.levels(); }
    Size size(int level) const noexcept override { return m_base.size(level); }
    Box extent(int level) const noexcept override { return in_base(level, m_base.extent(level)); }
    Box data_window() const noexcept override { return in_base(0, m_base.data_window()); }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override {
        if (!m_base.read(level, in_base(level, box), texels, row_stride)) return false;
        const std::ptrdiff_t texel = std::ptrdiff_t{channels()} * size_of(type());
        for (int y = 0; y < box.height(); ++y) {
            std::byte *first = texels + y * row_stride, *last = first + (box.width() - 1) * texel;
            for (; first < last; first += texel, last -= texel) std::swap_ranges(first, first + texel, last);
        }
        return true;
    }

  private:
    Box in_base(int level, const Box& box) const noexcept {
        const int width = m_base.size(level).width;
        return {width - box.x1, box.y0, width - box.x0, box.y1};
    }

    const Source& m_base;
};

}  // namespace anamorph
