// SPDX-License-Identifier: Apache-2.0
// What stands beyond the edge of an image: the other side of the seam, the far side of the pole, the next
// face of the cube, or nothing.
#pragma once

#include <cstdint>
#include <string_view>

#include "anamorph/chart/chart.h"
#include "anamorph/geometry/size.h"
#include "anamorph/image/source.h"

namespace anamorph {

/// The ways in which an image goes on beyond its edge, where it has no texels there itself.
///
/// automatic follows the chart (across +-180 degrees, over the poles, across cube edges) and is black
/// elsewhere; where a full turn fills rows of different lengths (sinusoidal, Hammer), a row goes on at the
/// nearest texel of the other side. The others are OpenImageIO's modes and treat the image, or each face of a
/// cube, as a plain rectangle.
enum class Wrap { automatic, black, clamp, periodic, mirror };

/// A texel of a level, or no texel (black).
struct Texel {
    int x = 0, y = 0;
    bool none = false;
};

/// A run of `count` texels of a row, from `first` to the right; where `first` is none, all of them are.
struct TexelRun {
    Texel first;
    int count = 1;
};

/// Finds the texels that stand beyond the edges of a source.
class Border {
  public:
    /// Constructs the border of a source that `chart` describes at level 0.
    Border(const Chart& chart, Wrap wrap);

    const Chart& chart() const noexcept { return m_chart; }
    /// The mode that says what stands beyond the edge.
    Wrap wrap() const noexcept { return m_wrap; }

    /// A rectangle of texels of a level that lie within `piece` and stand for themselves: all of those, except in
    /// pictures with a round edge. Texels beyond the edges of a picture are among them unless it is divided into faces or
    /// closes around the sphere, where the picture goes on by itself; on coarser levels and beside a border that is not
    /// black only whole ones.
    Box interior(int piece, const SourceLevel& level) const noexcept;

    /// Finds the texel that stands at (x, y), which may lie any distance outside the piece's interior.
    Texel resolve(std::int64_t x, std::int64_t y, int piece, const SourceLevel& level) const noexcept {
        return resolve_run(x, y, piece, level, 1).first;
    }

    /// Finds the texels that stand at (x, y), (x + 1, y), ... as far as they follow each other in a row, 1 to `limit`
    /// of them.
    TexelRun resolve_run(std::int64_t x, std::int64_t y, int piece, const SourceLevel& level,
                         int limit) const noexcept;

    /// Is all that stands in a box of texels certainly black, as it lies beyond the edges?
    bool is_black(const Box& box, const SourceLevel& level) const noexcept;

    /// The number of texels after which the rows of a level's interior repeat; 0 where they do not close on themselves.
    int turn(const Size& level) const noexcept;

  private:
    bool has_edges() const noexcept;
    bool goes_black() const noexcept { return m_wrap == Wrap::black || m_wrap == Wrap::automatic; }
    Box face(int piece, const Size& level) const noexcept;

    Chart m_chart;
    Wrap m_wrap;
};

}  // namespace anamorph
