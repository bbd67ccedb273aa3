// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/texel_types.h"

#include "anamorph/error.h"

namespace anamorph {

void refuse_texels(PixelType type) {
    const char* const names[] = {"uint8", "uint16", "half", "float"};
    throw Error("an image has pixels of type " + std::string(names[static_cast<int>(type)]) +
                ", which this build does not filter: it was made for uint8 only");
}

}  // namespace anamorph
