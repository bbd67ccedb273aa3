// SPDX-License-Identifier: Apache-2.0
#include <anamorph/version.h>

namespace anamorph {

const char* version() noexcept {
    return ANAMORPH_VERSION;
}

}  // namespace anamorph
