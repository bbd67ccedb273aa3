// SPDX-License-Identifier: Apache-2.0
// Maps that the benchmark has as text and, most of them, compiled: square pictures.
#pragma once

#include "anamorph/formula/pushed_map.h"
#include "anamorph/formula/text_map.h"
#include "anamorph/lens/lens_map.h"
#include "anamorph/panorama/panorama.h"

namespace anamorph::bench {

/// A map as text, with the chart of its source.
struct TextOf {
    Chart source;
    FormulaText text;

    TextMap map(int side) const;
};

/// A view of a whole sphere, 4 pictures wide.
struct SphereView {
    Panorama map;
    TextOf text;
};
SphereView straight_view(int side);
SphereView fisheye_view(int side);

/// A map that takes a distortion off a picture of 90 degrees.
struct LensView {
    LensMap map;
    TextOf text;
};
LensView lens_view(int side);

TextOf swirl_view(int side);
/// The swirl of swirl_view() by its inverse: where pixels of the source go.
PushedMap pushed_swirl(int side);

}  // namespace anamorph::bench
