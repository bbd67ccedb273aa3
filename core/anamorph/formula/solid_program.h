// SPDX-License-Identifier: Apache-2.0
// Colors that are a function of a point in space as programs.
#pragma once

#include "anamorph/formula/formula_text.h"
#include "anamorph/formula/solid_text.h"

namespace anamorph {

/// Parses a color over half of an ellipsoid, as programs of the stereographic coordinates of its points: with the point (a, b, c) of
/// the unit sphere, a / (1 + |c|) and b / (1 + |c|), which are at most 1. Errors name the expressions red, green, blue and let. Throws
/// as parse_formula() does.
SpaceFormula parse_solid(const SolidText& text, const SolidSetting& setting);

}  // namespace anamorph
