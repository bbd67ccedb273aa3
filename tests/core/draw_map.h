// SPDX-License-Identifier: Apache-2.0
// Draws through a map that stands on the stack.
#pragma once

#include "anamorph/image/picture.h"

namespace anamorph::test {

inline bool draw_map(const BlockMap& map, const Border& border, Filter filter, Output output,
                     const Source* source, const Box& box, const ImageView& view,
                     const ParallelFor& parallel_for = serial_for) {
    Picture picture;
    picture.maps = {{{std::shared_ptr<const void>(), &map}, {{border}}}};
    picture.filter = filter;
    picture.output = output;
    return picture.draw(source, box, view, parallel_for);
}

}  // namespace anamorph::test
