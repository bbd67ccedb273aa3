// SPDX-License-Identifier: Apache-2.0
// Highway's library, which Debian has not for WebAssembly: there is one set of instructions, with which everything is compiled.
#include <hwy/targets.h>

namespace hwy {

int64_t SupportedTargets() {
    return HWY_STATIC_TARGET;
}
void SetSupportedTargetsForTest(int64_t) {}
ChosenTarget& GetChosenTarget() {
    static ChosenTarget target;
    return target;
}

}  // namespace hwy
