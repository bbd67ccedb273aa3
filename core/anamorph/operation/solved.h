// SPDX-License-Identifier: Apache-2.0
// What operations that draw a Picture share.
#pragma once

#include <memory>

#include "anamorph/image/picture.h"
#include "anamorph/operation/operation.h"

namespace anamorph {

/// What the channels of a picture hold that shows this.
PixelKind pixels_of(Output output);

/// A picture as an operation hands it to a host: it says anamorph:max_error, anamorph:exact_fraction, and what it says itself.
std::unique_ptr<const SolvedPicture> solved(Picture picture);

}  // namespace anamorph
