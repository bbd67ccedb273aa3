// SPDX-License-Identifier: Apache-2.0
// The numbers that users set of a surface that a picture lies on (surface/shape/shape.h), and of how it is drawn.
#pragma once

#include <cmath>

#include "anamorph/parameter/number_row.h"

namespace anamorph::surface {

/// The part of a turn that a cylinder, sphere or torus covers, in degrees.
inline constexpr NumberRow kDrapeAngleRow{"drape_angle", 180, 0.01, 360};
/// The radius of a torus's tube.
inline constexpr NumberRow kDrapeTubeRow{"drape_tube", 0.2, 0.001, 1000};
/// The amplitude of waves and ripples.
inline constexpr NumberRow kDrapeAmplitudeRow{"drape_amplitude", 0.05, -1000, 1000};
inline constexpr NumberRow kDrapeWavelengthRow{"drape_wavelength", 0.5, 0.01, 1000};
inline constexpr NumberRow kDrapePhaseRow{"drape_phase", 0, -1000, 1000};
/// The direction in degrees, counterclockwise from the x axis.
inline constexpr NumberRow kDrapeDirectionRow{"drape_direction", 0, -360, 360};
/// The part to which a page is turned.
inline constexpr NumberRow kDrapeTurnRow{"drape_turn", 0.5, 0, 1};
/// The tolerance in pixels on the screen.
inline constexpr NumberRow kDrapeTolRow{"drape_tol", 0.125, 0.001, 1000};
/// Half the height of what a filter shows without perspective, in units of space.
inline constexpr NumberRow kDrapeParallelScaleRow{"drape_parallel_scale", 0.5, 1e-6, 1e6};

/// The radius; by default that of the surface.
inline constexpr NumberRow kDrapeRadiusRow{"drape_radius", NAN, 0.001, 1000};

}  // namespace anamorph::surface
