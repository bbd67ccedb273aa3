// SPDX-License-Identifier: Apache-2.0
// Panorama reprojection: a picture drawn through a pull map to a proven tolerance, any part of it at a time.
#pragma once

#include "anamorph/image/picture.h"
#include "anamorph/panorama/panorama.h"
#include "anamorph/plan/scheme.h"

namespace anamorph {

struct PlanOptions;

/// How a reprojection is drawn.
struct ReprojectOptions {
    Scheme scheme = Scheme::automatic;
    double tol = 0.01;  ///< source pixels; 0: every pixel exactly in double
    Filter filter = Filter::antialias;
    DataChannels data = {};
    Wrap wrap = Wrap::automatic;
    Output output = Output::color;
    /// Has the source texels beyond the edges of its picture (Source::extent) that are to be drawn?
    bool source_overscan = false;
    /// Pixels beyond the edges of the picture, across and down, on either side; only of one in one piece.
    Size overscan = {};
    /// Has colour a channel more, of how much of a pixel the source covers (Picture::adds_alpha)?
    bool adds_alpha = false;
};

/// How the map of a reprojection is approximated.
PlanOptions plan_options(const ReprojectOptions& options);

/// The panorama that a map reads, as it shows it. Its one source has the size of the map's source chart at level 0. The bits of a
/// pixel depend on nothing but the map, the options and the source. Throws Error.
Picture reprojected_picture(const Panorama& map, const ReprojectOptions& options);

}  // namespace anamorph
