// SPDX-License-Identifier: Apache-2.0
// Recipe files to begin with.
#pragma once

#include <string>
#include <vector>

#include "anamorph/operation/operation.h"

namespace anamorph::command {

/// The text of a recipe that has every key of the operation in a comment, with what it may be. Set are the `sources`, in the order of the
/// operation's keys, of figures the script, and, with `example`, the keys of its example. Throws Error where there are more sources than keys.
std::string recipe_template(const Operation& operation, const std::vector<std::string>& sources,
                            bool example);

/// Writes such a recipe as the file `output`, and beside it the files that its example names; sources get the
/// names that they have when seen from there. Nothing that is there is written over; a file that an earlier recipe left is taken as it is. Throws
/// Error, also where some sources are given, but fewer than the operation needs.
void write_recipe_template(const Operation& operation, std::vector<std::string> sources,
                           const std::string& output);

/// Those of some sources that are no recipes, frames or other words, but files that are not there.
std::vector<std::string> missing_files(const std::vector<std::string>& sources);

}  // namespace anamorph::command
