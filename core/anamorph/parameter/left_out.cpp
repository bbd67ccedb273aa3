// SPDX-License-Identifier: Apache-2.0
#include "anamorph/parameter/left_out.h"

#include "anamorph/error.h"

namespace anamorph {

void refuse_left_out(const std::string& what) {
    throw Error(what + " is not in this build, which was made to be small");
}

}  // namespace anamorph
