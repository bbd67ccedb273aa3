// SPDX-License-Identifier: Apache-2.0
// What a point of a surface costs a processor: counted in the surface's own formula.
#pragma once

#include "anamorph/machine/counted.h"
#include "anamorph/surface/surface.h"

namespace anamorph::machine {

/// What micro-coded processors do for a point of a surface, and what the host computer tells them of it.
struct SurfaceCost {
    OperationCounts point;
    int numbers = 0;             ///< numbers that describe the surface, those of its bumps among them
    OperationCounts light = {};  ///< what a block takes more for its light

    friend bool operator==(const SurfaceCost&, const SurfaceCost&) = default;
};

/// Counts what a point of a sum of surfaces takes, each summand's formula and each bump's that is enabled. Positions and heights of
/// files are interpolated between four values that the processors hold.
SurfaceCost cost_of(const surface::SurfaceSum& sum);

}  // namespace anamorph::machine
