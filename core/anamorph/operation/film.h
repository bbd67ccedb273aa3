// SPDX-License-Identifier: Apache-2.0
// Films of pictures of maps, whose key frames set any of their numbers, and the blur of what moves while a shutter is open.
#pragma once

#include <functional>
#include <memory>

#include "anamorph/operation/sequence.h"

namespace anamorph {

namespace rows {

/// The rows shutter and samples.
ParameterTable shutter();

}  // namespace rows

/// Makes the picture of one moment of its values.
using MakePictures = std::function<std::unique_ptr<const Pictures>(const ParameterValues& values)>;

/// The pictures of all frames that the rows of a film (sequence.h) and of the shutter say. With an open shutter each is the mean
/// of pictures at evenly spread moments, every one of which holds the tolerance. Throws Error.
std::unique_ptr<const Pictures> film_pictures(const OperationInput& input, MakePictures make);

}  // namespace anamorph
