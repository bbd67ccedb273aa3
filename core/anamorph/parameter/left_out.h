// SPDX-License-Identifier: Apache-2.0
// What a small build lacks, since no control of the page reaches it (docs/web.md lists it).
#pragma once

#include <string>

namespace anamorph {

/// Was this build made with ANAMORPH_SMALL, as the page is (plugins/web)?
#ifdef ANAMORPH_SMALL
constexpr bool kIsSmall = true;
#else
constexpr bool kIsSmall = false;
#endif

/// Throws the Error that says that `what` is not in this build.
[[noreturn]] void refuse_left_out(const std::string& what);

}  // namespace anamorph
