// SPDX-License-Identifier: Apache-2.0
// The size of an image.
#pragma once

namespace anamorph {

/// Width and height in pixels.
struct Size {
    int width = 0, height = 0;
    friend bool operator==(const Size&, const Size&) = default;
};

}  // namespace anamorph
