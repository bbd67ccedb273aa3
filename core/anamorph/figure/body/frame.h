// SPDX-License-Identifier: Apache-2.0
// One moment of a performance: ellipsoids in space, what they look like, and the joints between them.
//
// Space as in NUDES: x to the right, y up, z away from the observer (left-handed), ground at y = 0, a window
// of 1000 by 1000 units. Angles in degrees.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "anamorph/figure/body/ellipsoid.h"

namespace anamorph::figure {

/// An ellipsoid of a figure.
struct Body {
    Ellipsoid shape;
    std::string name;
    int figure = 0;                  ///< position in FigureFrame::figures
    glm::dvec3 color{255, 128, 64};  ///< red, green, blue, 0 to 255
    std::string texture;             ///< the name of its picture; empty where it has none
    glm::dvec2 texture_offset{0};    ///< in texels
};

/// A point that two bodies have in common.
struct Joint {
    std::string name;
    int first = 0, second = 0;  ///< the bodies that it connects, positions in FigureFrame::bodies
    glm::dvec3 position{0.0};   ///< in space
};

/// A stripe of the background, over all of the picture's width.
struct BackgroundBand {
    double end = 1;         ///< where it ends, 0 at the top of the picture to 1 at the bottom
    glm::dvec3 color{0.0};  ///< red, green, blue, 0 to 255
};

/// All that is there at one moment, and where it is seen from.
struct FigureFrame {
    int number = 0;
    std::vector<Body> bodies;
    std::vector<Joint> joints;
    std::vector<std::string> figures;
    std::vector<BackgroundBand> bands;  ///< the background, from the top; empty where it is transparent
    glm::dvec3 place{500.0};            ///< the centre of attention: it is seen in the middle of the window
    glm::dmat3 observer{1.0};  ///< turns space about `place` before it is seen: Rx Ry Rz of `observe`
    glm::dvec3 observe{0.0};   ///< the angles of `observer`
};

}  // namespace anamorph::figure
