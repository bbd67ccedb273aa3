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

/// The same error, naming the property where the core's name is one of `names`: other errors may be of a line or a file.
anamorph::Error of_known_property(const anamorph::Error& error,
                                  const std::map<std::string, std::string>& names);

}  // namespace anamorph_vtk
