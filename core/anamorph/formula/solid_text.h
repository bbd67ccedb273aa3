// SPDX-License-Identifier: Apache-2.0
// Colors that are a function of a point in space, written as text: solid textures (Peachey 1985, Perlin 1985).
//
// Names, beside those that definitions make before; functions are those of formula_text.h:
//
//   x y z                   the point, in the body's own axes from its centre, in units of the scene
//   own_red own_green own_blue    the color that the body has, from 0 to 1
//   scale                   a length that callers give
//   frame                   a number that callers give
#pragma once

#include <array>
#include <string>

namespace anamorph {

/// A color at every point of space, each channel from 0 to 1.
struct SolidText {
    std::string red = "own_red", green = "own_green", blue = "own_blue";
    std::string let = {};  ///< as in FormulaText
};

/// The values that names of a SolidText stand for.
struct SolidSetting {
    std::array<double, 3> axes{1, 1, 1};  ///< half-axes of the ellipsoid that is colored
    std::array<double, 3> own{0, 0, 0};
    double scale = 1, frame = 0;
    bool behind = false;  ///< which half of the ellipsoid: that with z of at least 0
};

}  // namespace anamorph
