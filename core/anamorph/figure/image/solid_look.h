// SPDX-License-Identifier: Apache-2.0
// How bodies have colors that are a function of the point in space (solid_texture.h).
#pragma once

#include "anamorph/formula/solid_text.h"

namespace anamorph::figure {

/// How bodies are colored by formulas.
struct SolidLook {
    SolidText text;
    double scale = 100;  ///< the name `scale` of the formulas, in units of the scene
    int samples =
        4;  ///< points of a pixel either way, over which colors are averaged; from 1 to kMostSolidSamples
};

/// The most points of a pixel either way.
inline constexpr int kMostSolidSamples = 16;

}  // namespace anamorph::figure
