// SPDX-License-Identifier: Apache-2.0
// How a source is read between its pixels.
#pragma once

namespace anamorph {

/// nearest, bilinear and bicubic (Catmull-Rom) read the source as it is; antialias is bilinear where the map
/// magnifies and averages over the pixel's footprint, on the pyramid level that fits it, where it minifies.
enum class Filter { nearest, bilinear, bicubic, antialias };

}  // namespace anamorph
