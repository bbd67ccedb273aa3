// SPDX-License-Identifier: Apache-2.0
// Images as a graphics card takes them.
#pragma once

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

#include "anamorph/source_stack.h"

namespace anamorph_viewer {

/// Throws Error: a card does not draw `what`.
[[noreturn]] void refuse_card(const std::string& what);

/// The texels of one level of an image, row by row from the top.
struct CardTexels {
    anamorph::Size size;
    int channels = 0;
    std::vector<float> values;
};

/// The finest level of an image that a card takes: 8192 texels a side, and 2^25 in all. `stacked`: how many pictures stand in it, one
/// above the other, none of which is cut. Throws Error where there is none, or it is in another colour space.
CardTexels card_texels(const anamorph::SourceStack& stack, int stacked = 1);

/// Three channels of them, grey three times, as VTK has images: rows from the bottom. `scalars`: VTK_FLOAT, or VTK_UNSIGNED_CHAR for
/// values from 0 to 1 that were 8 bits.
vtkSmartPointer<vtkImageData> card_image(const CardTexels& texels, int scalars);

}  // namespace anamorph_viewer
