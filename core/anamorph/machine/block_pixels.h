// SPDX-License-Identifier: Apache-2.0
// The image memories and the pixel processor of the machine of 1987 (block_machine.h): the picture is filtered before it is
// stored in the input image memory, and of four texels next to an address a pixel is interpolated.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "anamorph/image/border.h"
#include "anamorph/image/filter.h"
#include "anamorph/image/source.h"
#include "anamorph/machine/block_machine_map.h"
#include "anamorph/machine/block_shading.h"
#include "anamorph/parallel_for.h"

namespace anamorph::machine {

/// What the machine shows of a picture at the addresses of a frame.
///
/// With Filter::antialias each block has its own filter (Oka 1987, 2.3): a texel holds the mean over the smallest rectangle of
/// the picture about its centre that covers a pixel's parallelogram, |b11| + |b12| by |b21| + |b22| texels and at least one each way.
/// With Filter::bilinear and Filter::nearest the picture is stored as it is; nearest shows the texel that an address lies in.
class BlockPixels {
  public:
    /// `border`: of the source, one piece.
    BlockPixels(std::shared_ptr<const BlockMachineMap> map, const BlockMachine& machine, const Border& border,
                Filter filter);
    /// Lights what is drawn from now on. `alpha`: the channel of alpha of sources, -1 where there is none.
    void light(BlockShading shading, int alpha) {
        m_shading = std::move(shading);
        m_alpha = alpha;
    }

    /// Draws a box of the screen to `view`, whose pixel (0, 0) is (box.x0, box.y0). Pixels of no block are 0. False where the source
    /// could not be read. Throws Error where there is no source, or the view does not fit, and std::bad_alloc.
    bool draw(const Source* source, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const;

  private:
    class Reader;

    std::shared_ptr<const BlockMachineMap> m_map;
    Border m_border;
    Filter m_filter;
    int m_weight_bits, m_texel_bits, m_alpha = -1;
    std::optional<BlockShading> m_shading;
};

}  // namespace anamorph::machine
