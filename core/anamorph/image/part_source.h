// SPDX-License-Identifier: Apache-2.0
// A part of an image as an image of its own: one of several that stand above each other, or side by side.
#pragma once

#include <vector>

#include "anamorph/image/source.h"

namespace anamorph {

/// The pixels `part` of level 0 of a source, and of as many of its levels as the part begins and ends with a pixel of. The
/// base is kept by reference.
class PartSource final : public Source {
  public:
    PartSource(const Source& base, const Box& part);

    PixelType type() const noexcept override { return m_base.type(); }
    int channels() const noexcept override { return m_base.channels(); }
    int unassociated_alpha() const noexcept override { return m_base.unassociated_alpha(); }
    int levels() const noexcept override { return static_cast<int>(m_levels.size()); }
    Size size(int level) const noexcept override { return at(level).size; }
    Box data_window() const noexcept override {
        return intersection(extent(0), moved(m_base.data_window(), -at(0).x0, -at(0).y0));
    }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override {
        return m_base.read(level, in_base(level, box), texels, row_stride);
    }
    const ConstImageView* view(int level) const noexcept override {
        return at(level).view.data ? &at(level).view : nullptr;
    }
    bool prepare(int level, const Box& box) const noexcept override {
        return m_base.prepare(level, in_base(level, box));
    }

  private:
    struct Level {
        int x0, y0;  ///< the first pixel, in the base
        Size size;
        ConstImageView view;  ///< without data where the base has none
    };
    const Level& at(int level) const noexcept { return m_levels[static_cast<std::size_t>(level)]; }
    Box in_base(int level, const Box& box) const noexcept { return moved(box, at(level).x0, at(level).y0); }

    const Source& m_base;
    std::vector<Level> m_levels;
};

}  // namespace anamorph
