// SPDX-License-Identifier: Apache-2.0
// What a recipe's picture is made of, and what drawing it needs.
#pragma once

#include <optional>
#include <ostream>
#include <string>

namespace anamorph::command {

/// Prints what a recipe says of its picture, by which blocks it is drawn, and which texels of its sources would be read; no pixels
/// are read for that. `crop`: "WxH+X+Y", the part of the picture that is meant, as oiiotool has it, else all. `subimage`: the one of
/// several. `timed`: draws it as well, and tells how long each stage takes. Throws Error.
void explain(const std::string& recipe, const std::optional<std::string>& crop, int subimage, bool timed,
             std::ostream& to);

}  // namespace anamorph::command
