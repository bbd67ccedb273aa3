// SPDX-License-Identifier: Apache-2.0
// The numbers that users set of nonlinear texture coordinates (nonlinear_texture.h).
#pragma once

#include "anamorph/parameter/number_row.h"

namespace anamorph::surface {

/// The largest error of texture coordinates, in texels.
inline constexpr NumberRow kTextureTolRow{"texture_tol", 0.125, 0, 1e6, NumberRow::above_least};
/// The width of the texture, in texels.
inline constexpr NumberRow kTextureWidthRow{"texture_width", 1024, 1, 1 << 20, NumberRow::closed, true};
/// The height of the texture, in texels.
inline constexpr NumberRow kTextureHeightRow{"texture_height", 1024, 1, 1 << 20, NumberRow::closed, true};

inline constexpr NumberRow kTextureRows[] = {kTextureTolRow, kTextureWidthRow, kTextureHeightRow};

}  // namespace anamorph::surface
