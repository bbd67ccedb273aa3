// SPDX-License-Identifier: Apache-2.0
// The part of a source that a block of the picture reads, as one rectangle of texels without an edge.
#pragma once

#include <cstddef>
#include <vector>

#include "anamorph/image/border.h"
#include "anamorph/image/source.h"

namespace anamorph {

/// A rectangle of texels in memory. `texels` points at texel (box.x0, box.y0): packed pixels of `type`. At
/// least kSlack bytes behind the last texel of every row may be read (they hold anything).
struct Window {
    static constexpr std::ptrdiff_t kSlack = 64;

    const std::byte* texels = nullptr;
    PixelType type = PixelType::float32;
    int channels = 0;
    std::ptrdiff_t row_stride = 0;
    Box box;
};

/// Gets windows; keeps the memory of the last one. One per thread.
class WindowReader {
  public:
    WindowReader(const Source& source, const Border& border) : m_source(source), m_border(border) {}

    /// Gets the texels of `box` on `piece` of `level`; the box may reach over every edge. Points into the
    /// source when the box lies inside a level in memory, or wholly beyond a seam of it, where the same
    /// texels follow each other (packed, not to be multiplied by alpha), else into memory of its own. With
    /// unassociated alpha the window is float with colour multiplied by alpha. False when the source could
    /// not be read or the box has more than kMaxTexels texels.
    bool get(int level, int piece, const Box& box, Window& window) noexcept;

    /// Gets a window where it points into the source, and is false elsewhere: nothing is copied.
    bool get_in_place(int level, int piece, const Box& box, Window& window) noexcept;
    /// Gets a window with rows one behind the other in memory of its own.
    bool get_copy(int level, int piece, const Box& box, Window& window) noexcept;

    /// Does no rectangle of the level hold these texels in the same order, so that they have to be put together?
    bool crosses_edge(int level, int piece, const Box& box) const noexcept {
        return place_of(level, piece, box).empty();
    }

    static constexpr std::int64_t kMaxTexels = std::int64_t{1} << 24;

  private:
    /// The box of the level that holds a box's texels in the same order: itself, or one across a seam; empty if none.
    Box place_of(int level, int piece, const Box& box) const noexcept;
    /// The level in memory, if a window of these texels may point there.
    const ConstImageView* view_of(int level, const Box& texels) const noexcept;

    const Source& m_source;
    const Border& m_border;
    std::vector<std::byte> m_texels, m_raw;
};

}  // namespace anamorph
