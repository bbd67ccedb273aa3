// SPDX-License-Identifier: Apache-2.0
// The steps that operations that draw a Picture share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "anamorph/image/picture.h"
#include "anamorph/operation/operation.h"

namespace anamorph {

/// The kind of pixels of a picture that shows this output.
PixelKind pixels_of(Output output);

/// The channels of a picture that are only moved, while others may be mixed.
std::vector<int> moved_channels(const DataChannels& data);

/// What a picture says of its pixels, by the width of one over its height: nothing where they are square.
Attributes said_of_pixels(double aspect);

/// A picture as an operation hands it to a host: it says anamorph:max_error, anamorph:exact_fraction, what it says itself, and
/// `known`, which is known before anything is drawn.
std::unique_ptr<const SolvedPicture> solved(Picture picture, Attributes known = {});

/// Copies channels from one picture to another of the same size and type, at the pixels that `is_there` says.
template <class IsThere>
void copy_channels(const std::vector<int>& channels, const ImageView& from, const ImageView& to,
                   const IsThere& is_there) {
    const std::ptrdiff_t size = size_of(to.type);
    for (int y = 0; y < to.height; ++y)
        for (int x = 0; x < to.width; ++x)
            for (const int c : channels)
                if (is_there(x, y)) std::copy_n(from.at(x, y) + c * size, size, to.at(x, y) + c * size);
}

}  // namespace anamorph
