// SPDX-License-Identifier: Apache-2.0
// The steps that operations that draw a Picture share.
#pragma once

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

/// A picture as an operation hands it to a host: it says anamorph:max_error, anamorph:exact_fraction, and what it says itself.
std::unique_ptr<const SolvedPicture> solved(Picture picture);

}  // namespace anamorph
