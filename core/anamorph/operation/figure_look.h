// SPDX-License-Identifier: Apache-2.0
// What of figures' looks every host offers, by the same rows: colors by formulas, heights, and what stands for bodies in drawings of
// lines.
#pragma once

#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {

/// The rows solid, solid_scale, solid_samples, red, green, blue, let, bump and bump_scale.
ParameterTable figure_relief_rows();
/// The rows outlines and outline_tol.
ParameterTable figure_outline_rows();
/// All of them.
const ParameterTable& figure_look_table();

/// Sets what the values of a table with these rows say of a look whose style and antialias are known: colors by formulas and heights,
/// which there are where `heights` says so. Throws Error, of what would mean nothing too.
void read_figure_relief(const ParameterValues& values, bool heights, figure::FigureLook& look);
/// The same of what stands for bodies.
void read_figure_outlines(const ParameterValues& values, figure::FigureLook& look);

}  // namespace anamorph
