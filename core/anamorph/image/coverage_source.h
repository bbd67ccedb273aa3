// SPDX-License-Identifier: Apache-2.0
// How much of each texel of a source its image has.
#pragma once

#include <vector>

#include "anamorph/image/source.h"

namespace anamorph {

/// One channel of float: on level 0 it is 1 in the source's data window and 0 elsewhere, and coarser levels are averages of
/// that as a Pyramid makes them. A source whose coarser levels stand in its file has all texels of them. Keeps a
/// reference to the source.
class CoverageSource final : public Source {
  public:
    explicit CoverageSource(const Source& of) : m_of(of), m_has(of.data_window()) {}

    PixelType type() const noexcept override { return PixelType::float32; }
    int channels() const noexcept override { return 1; }
    int levels() const noexcept override { return m_of.levels(); }
    Size size(int level) const noexcept override { return m_of.size(level); }
    Box extent(int level) const noexcept override { return m_of.extent(level); }
    Box data_window() const noexcept override { return m_has; }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;

  private:
    /// One axis of the source: its numbers of texels, level by level, and the first and the end of those that the image has.
    struct Axis {
        std::vector<int> texels;
        int first, end;

        /// How much of texel `at` of a level the image has, 0 to 1.
        double share(int level, int at) const noexcept;
    };

    const Source& m_of;
    Box m_has;
};

}  // namespace anamorph
