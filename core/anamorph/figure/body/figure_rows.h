// SPDX-License-Identifier: Apache-2.0
// The numbers that users set of figures and of the views that they are drawn in.
#pragma once

#include "anamorph/parameter/number_row.h"

namespace anamorph::figure {

/// The maximum distance of a tessellated surface from its ellipsoid, in units of the scene or in pixels.
inline constexpr NumberRow kSurfaceTolRow{"surface_tol", 0.25, 0, NumberRow::kNoEnd, NumberRow::above_least};
/// The maximum chord error of outlines, in pixels.
inline constexpr NumberRow kOutlineTolRow{"outline_tol", 0.1, 0, NumberRow::kNoEnd, NumberRow::above_least};
/// The maximum distance of a body's surface from the spheres in it, in units of the scene.
inline constexpr NumberRow kSphereTolRow{"sphere_tol", 1, 0, NumberRow::kNoEnd, NumberRow::above_least};
/// The width up to which a body is drawn as a dot, in pixels; 0: all bodies are drawn whole.
inline constexpr NumberRow kLevelOfDetailRow{"level_of_detail", 0, 0};

/// The probability with which ellipsoids of displacement hold their atoms, as of ORTEP.
inline constexpr NumberRow kProbabilityRow{"probability", 0.5, 0, 1, NumberRow::between};

/// The width and height of a view, in pixels.
inline constexpr NumberRow kViewSizeRow{"view_size", 500, 1, NumberRow::kNoEnd, NumberRow::closed, true};
/// Half the height of an orthographic view, in units of the scene.
inline constexpr NumberRow kParallelScaleRow{"camera_parallel_scale", 500, 0, 1e50, NumberRow::between};
/// The angle from bottom to top of a view in perspective, in degrees.
inline constexpr NumberRow kViewAngleRow{"camera_view_angle", 30, 0, 180, NumberRow::between};

inline constexpr NumberRow kFigureRows[] = {kSurfaceTolRow,    kOutlineTolRow,  kSphereTolRow,
                                            kLevelOfDetailRow, kProbabilityRow, kViewSizeRow,
                                            kParallelScaleRow, kViewAngleRow};

}  // namespace anamorph::figure
