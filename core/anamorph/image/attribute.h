// SPDX-License-Identifier: Apache-2.0
// What pictures say of themselves.
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace anamorph {

/// A fact that a picture says of itself: "anamorph:max_error" and so on.
struct Attribute {
    std::string name;
    std::variant<int, double, std::string> value;
};
/// Attributes, in the order in which they were made.
using Attributes = std::vector<Attribute>;

}  // namespace anamorph
