// SPDX-License-Identifier: Apache-2.0
// The picture that the page begins with: a ring of columns at dusk, all around.
#pragma once

#include <cstdint>
#include <vector>

namespace anamorph::web {

/// An equirectangular panorama twice as wide as high, `height` a power of 2 from 16 to 8192: red, green, blue and alpha of each pixel, row
/// by row. It is made of sums, products, quotients and roots alone, so that it has the same bits on every processor. Throws Error.
std::vector<std::uint8_t> sample_panorama(int height);

}  // namespace anamorph::web
