// SPDX-License-Identifier: Apache-2.0
// Pictures over each other, each with alpha: one covers those below it, or all are averaged where they overlap.
//
// With c a layer's colours at a pixel, multiplied by its alpha a, and g its weight there, the colours are C A / W and alpha A, where
//
//   over  C = sum of t g c, W = sum of t g a, from the uppermost layer down, t the product of (1 - g a) of those above
//   mean  C = sum of g c, W = sum of g a
//
// and A = 1 - product of (1 - a): weights say who is seen where several are, not how much of a pixel is covered. Alpha counts as at least 0 and at
// most 1. Where W is 0 nothing is seen. All is in float, in the order of the layers, so that it has the same bits for any box.
#pragma once

#include <functional>
#include <vector>

#include "anamorph/image/picture.h"

namespace anamorph {

enum class Layering { over, mean };

/// A picture in colour, whose last channel, or the one that its source names, is alpha.
struct PictureLayer {
    Picture picture;
    /// The weight at each pixel of a box of the picture, row by row, above 0 and at most 1, where it is not 1 everywhere.
    std::function<void(const Box& box, float* weights, const ParallelFor& parallel_for)> weights = {};
};

struct LayeredPicture {
    std::vector<PictureLayer> layers;  ///< the lowest first; all as large
    Layering layering = Layering::over;
    int alpha =
        -1;  ///< the channel of alpha of all sources, whether their colours are multiplied by it or not
    bool shows_alpha =
        false;  ///< is alpha drawn alone, in place of the first channels, as many as a view has?

    /// Draws the pixels of `box` to `view`, as Picture::draw() does. Throws Error also where some sources have colours that are
    /// multiplied by alpha and others have not.
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const;
};

}  // namespace anamorph
