// SPDX-License-Identifier: Apache-2.0
// The numbers that users set of deformations (deformation.h, deformed_surface.h).
#pragma once

#include "anamorph/parameter/number_row.h"

namespace anamorph {

/// A half axis of a deformation, in the units of u or v. The half axis and its inverse stay in the range of double.
inline constexpr NumberRow kExtentRow{"extent", 1, 1e-300, 1e300};
/// The share of V below which Gaussians are cut off.
inline constexpr NumberRow kCutoffRow{"cutoff", 1e-7, 0, 0.5};

inline constexpr NumberRow kDeformRows[] = {kExtentRow, kCutoffRow};

}  // namespace anamorph
