// SPDX-License-Identifier: Apache-2.0
// Panoramas in a projection that is written as text: to=formula.
#pragma once

#include <memory>
#include <string>

#include "anamorph/operation/operation.h"

namespace anamorph {

/// A row of projections, and of "formula".
Parameter projection_or_formula(const char* name, const std::string& doc);
/// The rows of a formula: its expressions and definitions.
ParameterTable ray_rows();

/// Is the picture's projection the formula's? Throws Error if it is not, and a formula is given.
bool has_formula(const ParameterValues& values);
/// The pictures of a projection that is a formula. Throws Error of what the formula has not, such as a field
/// of view.
std::unique_ptr<const Pictures> pictures_of_formula(const ParameterValues& values, const SourceFacts& facts);

}  // namespace anamorph
