// SPDX-License-Identifier: Apache-2.0
// A picture drawn through a map of blocks, any part of it at a time.
#pragma once

#include "anamorph/approx/block.h"
#include "anamorph/error.h"
#include "anamorph/parallel_for.h"
#include "anamorph/render/border.h"
#include "anamorph/render/filter.h"
#include "anamorph/render/source.h"

namespace anamorph {

/// What is drawn: colour; the source point as (u, v), v down, (-1, -1) where there is none; the distance of
/// the source point used from the exact one; its proven bound. Distances in source pixels. u and v are in
/// 0..1 on the source: across the seam of one that closes they start anew. Points beyond the edges of any
/// other have values beyond; what is read there is the border's affair.
enum class Output { color, stmap, error, bound };

/// Channels of a picture: the source's for color, 2 for stmap, 1 for error and bound.
int channels_of(Output output, const Source* source);

/// Draws the pixels of `box` (of the target image) to `picture`, whose pixel (0, 0) is (box.x0, box.y0).
/// `border` knows the source's chart, which has the size of `source` at level 0. The source is not read but
/// for colour and may then be null. False when it could not be read: the picture is then incomplete. Throws
/// Error where sizes or channels do not fit.
bool draw_blocks(const BlockMap& map, const Border& border, Filter filter, Output output,
                 const Source* source, const Box& box, const ImageView& picture,
                 const ParallelFor& parallel_for);

}  // namespace anamorph
