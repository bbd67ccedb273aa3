// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace anamorph {

/// Adds to the module what anamorph/figures.py and anamorph/surfaces.py stand on: motions, their frames as arrays, outlines as polylines,
/// and points that bumps and weights move.
void bind_figures(pybind11::module_& m);

}  // namespace anamorph
