// SPDX-License-Identifier: Apache-2.0
// Errors that name a filter's property in place of the row of the core's table that its value goes to.
#pragma once

#include <map>
#include <string>

#include "anamorph/error.h"

namespace anamorph_vtk {

/// The same error, naming the property that a row of an operation's table comes from: "height_smooth" is HeightSmooth, or what
/// `others` says.
anamorph::Error of_property(const anamorph::Error& error, const std::map<std::string, std::string>& others);

}  // namespace anamorph_vtk
