// SPDX-License-Identifier: Apache-2.0
// The lines of a morph drawn over its picture.
#pragma once

#include "anamorph/image/picture.h"
#include "anamorph/morph/feature_lines.h"

namespace anamorph {

/// Draws the features of every shape, scaled onto the target, one pixel and a half wide, each shape in a
/// colour of its own; channels above the third become 1 there.
void draw_features(const Features& features, const FeatureMap& map, const PixelRows& pixels);

}  // namespace anamorph
