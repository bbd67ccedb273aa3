// SPDX-License-Identifier: Apache-2.0
// The numbers that users set of a projector (projector.h, projected_triangles.h).
#pragma once

#include "anamorph/parameter/number_row.h"

namespace anamorph {

/// The largest error of the texel that a point of the scene is painted with, in texels of the panorama.
inline constexpr NumberRow kProjectionTolRow{"projection_tol", 0.125, 0, 1e6, NumberRow::above_least};
/// The width of the panorama, in texels.
inline constexpr NumberRow kPanoramaWidthRow{"panorama_width", 4096, 1, 1 << 24, NumberRow::closed, true};
inline constexpr NumberRow kPanoramaHeightRow{"panorama_height", 2048, 1, 1 << 24, NumberRow::closed, true};
/// The horizontal field of view of the panorama, or of each of its faces, in degrees; 0: the projection's default.
inline constexpr NumberRow kFieldOfViewRow{"field_of_view", 0, 0, 360};
/// The distance d of the Pannini projection.
inline constexpr NumberRow kPanniniDistanceRow{"pannini_distance", 1, 0, 1000};

inline constexpr NumberRow kProjectorRows[] = {kProjectionTolRow, kPanoramaWidthRow, kPanoramaHeightRow,
                                               kFieldOfViewRow, kPanniniDistanceRow};

}  // namespace anamorph
