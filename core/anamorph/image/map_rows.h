// SPDX-License-Identifier: Apache-2.0
// What a picture of the map itself shows: source points, their errors and bounds.
#pragma once

#include <functional>

#include "anamorph/image/block_reader.h"
#include "anamorph/image/picture.h"

namespace anamorph {

/// Receives `count` pixels from (x, y) on, channel by channel.
using MapRow = std::function<void(int x, int y, int count, const float* values)>;

/// Gives the pixels of `part` of a block to `row`, row by row: what `output`, which is not color, names.
/// `source` is the chart of the block's layer; `points` are those of a computed block.
void map_rows(const BlockMap& map, const Chart& source, Output output, const Block& block,
              const BlockPoints& points, const Box& part, const MapRow& row);

}  // namespace anamorph
