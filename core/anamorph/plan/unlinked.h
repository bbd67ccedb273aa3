// SPDX-License-Identifier: Apache-2.0
// Maps that say why they cannot be links of a chain.
#pragma once

#include <string>

namespace anamorph {

class Unlinked {
  public:
    virtual ~Unlinked() = default;
    /// The reason why BlockMap::link() is null, as it follows "it": "has pairs of points".
    virtual std::string why_unlinked() const = 0;
};

}  // namespace anamorph
