// SPDX-License-Identifier: Apache-2.0
// What anamorph leaves to anamorph-pictures.
#pragma once

#include <string_view>

namespace anamorph::command {

/// The subcommands that need OpenImageIO.
inline constexpr std::string_view kOfPictures[] = {"hash", "draw", "join", "explain"};

}  // namespace anamorph::command
