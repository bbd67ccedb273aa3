// SPDX-License-Identifier: Apache-2.0
// A picture of a picture, drawn from the source by one resampling, where both are maps of one picture each.
#pragma once

#include <optional>
#include <string>

#include "anamorph/geometry/box.h"
#include "anamorph/image/picture.h"

namespace anamorph {

/// A picture that was joined of two, or the reason why it was not.
struct Joined {
    std::optional<Picture> picture = {};
    std::string reason = {};
};

/// Joins `outer`, whose source is what `inner` draws, with that. `shown`: the display window of what inner draws, in its pixels,
/// from which the coordinates of outer's source count.
///
/// The source of the result is inner's. Its points are those of both maps, one after the other, and its tolerance, in pixels
/// of that source, the smaller one of theirs; its bounds are of both maps at once. Where the picture in the middle has no pixels
/// or no source point, nor has the result. It is not joined where it would be another picture than outer's but for what was lost
/// by drawing twice.
Joined joined_picture(const Picture& outer, const Picture& inner, const Box& shown);

}  // namespace anamorph
