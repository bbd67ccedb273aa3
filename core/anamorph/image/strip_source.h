// SPDX-License-Identifier: Apache-2.0
// Rows of an image as an image of its own: one of several that stand above each other.
#pragma once

#include <vector>

#include "anamorph/image/source.h"

namespace anamorph {

/// Rows [first, first + rows) of level 0 of a source, and of as many of its levels as the strip begins and ends with a row
/// of. The base is kept by reference.
class StripSource final : public Source {
  public:
    StripSource(const Source& base, int first, int rows);

    PixelType type() const noexcept override { return m_base.type(); }
    int channels() const noexcept override { return m_base.channels(); }
    int unassociated_alpha() const noexcept override { return m_base.unassociated_alpha(); }
    int levels() const noexcept override { return static_cast<int>(m_levels.size()); }
    Size size(int level) const noexcept override { return at(level).size; }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override {
        return m_base.read(level, moved(level, box), texels, row_stride);
    }
    const ConstImageView* view(int level) const noexcept override {
        return at(level).view.data ? &at(level).view : nullptr;
    }
    bool prepare(int level, const Box& box) const noexcept override {
        return m_base.prepare(level, moved(level, box));
    }

  private:
    struct Level {
        int first;  ///< first row in the base
        Size size;
        ConstImageView view;  ///< without data where the base has none
    };
    const Level& at(int level) const noexcept { return m_levels[static_cast<std::size_t>(level)]; }
    Box moved(int level, const Box& box) const noexcept {
        const int first = at(level).first;
        return {box.x0, box.y0 + first, box.x1, box.y1 + first};
    }

    const Source& m_base;
    std::vector<Level> m_levels;
};

}  // namespace anamorph
