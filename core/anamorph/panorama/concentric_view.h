// SPDX-License-Identifier: Apache-2.0
// A view of concentric mosaics: every pixel is a mixture of the two panoramas whose circles its line of sight passes
// between, each drawn through its map to a proven tolerance.
#pragma once

#include <functional>
#include <optional>

#include "anamorph/panorama/concentric.h"
#include "anamorph/panorama/reproject.h"

namespace anamorph {

/// The picture of a view, whose source i is the panorama of circle i. `view`: as ConcentricMap takes it.
/// `circle`: one panorama alone, in place of the mixture; stmap shows the middle one unless this is given.
/// Throws Error.
Picture mosaic_picture(const Panorama& view, const ConcentricStack& stack, const ReprojectOptions& options,
                       std::optional<int> circle = {});

/// The number that ConcentricStack::vertical_distortion() gives at each pixel of a view, of things `nearest`
/// or farther from the centre.
std::function<float(double x, double y)> distortion_of(const Panorama& view, const ConcentricStack& stack,
                                                       double nearest);

}  // namespace anamorph
