// SPDX-License-Identifier: Apache-2.0
// The types of texels that a build has loops for.
#pragma once

#include "anamorph/image/view.h"

namespace anamorph {

/// Does this build filter texels of a type? All do, but those that define ANAMORPH_SMALL.
constexpr bool has_loops(PixelType type) {
#ifdef ANAMORPH_SMALL
    return type == PixelType::uint8;
#else
    return type <= PixelType::float32;
#endif
}

/// Throws the Error that says that this build does not filter texels of a type.
[[noreturn]] void refuse_texels(PixelType type);

}  // namespace anamorph
