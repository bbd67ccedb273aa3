// SPDX-License-Identifier: Apache-2.0
// What .mosaic makes of its parameters, for hosts that draw mosaics themselves.
#pragma once

#include "anamorph/operation/operation.h"
#include "anamorph/panorama/concentric.h"

namespace anamorph {

/// The circles and the viewpoint that parameters say. Throws Error.
ConcentricStack read_concentric_stack(const ParameterValues& values);
/// The panorama of each circle of a source. Throws Error where the source is none of so many.
Chart read_slit_panorama(const ParameterValues& values, const SourceFacts& facts, int circles);

}  // namespace anamorph
