// SPDX-License-Identifier: Apache-2.0
// Bodies as if they were cut out of a block (Peachey 1985, Perlin 1985): colors that are a function of the point in space, in the body's
// own axes.
//
// Colors are means over SolidLook::samples points either way of what a pixel shows: what is finer than that is not averaged away.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/image/seen_surface.h"
#include "anamorph/figure/image/solid_look.h"
#include "anamorph/formula/solid_program.h"

namespace anamorph::figure {

/// A solid texture that comes with Anamorph: its name, what it is, and its formula.
struct SolidPreset {
    std::string name, documentation;
    SolidText text;
};

/// The textures that come with Anamorph: wood, marble and checker.
const std::vector<SolidPreset>& solid_presets();

/// A body's solid texture. Thread safe.
class SolidTexture {
  public:
    /// `frame`: the frame's number. Throws Error as parse_solid() does.
    SolidTexture(const SolidLook& look, const Body& body, int frame);

    /// The mean color over a square of `side` pixels about (x, y), of a surface that is the body's. Where the formula is not defined,
    /// it is the body's own color.
    glm::dvec3 color(const SeenSurface& surface, double x, double y, bool far_side, double side) const;
    /// The color at a point of the unit sphere in the body's own axes.
    glm::dvec3 color_at(const glm::dvec3& unit) const;

  private:
    std::array<SpaceFormula, 2> m_halves;  ///< in front, with z below 0, and behind
    glm::dvec3 m_own;
    int m_samples;
};

}  // namespace anamorph::figure
