// SPDX-License-Identifier: Apache-2.0
// What anamorph leaves to other programs beside it.
#pragma once

#include <string_view>

namespace anamorph::command {

/// The subcommands of anamorph-pictures, which need OpenImageIO.
inline constexpr std::string_view kOfPictures[] = {"hash", "draw", "stmap", "join", "explain"};
/// Programs anamorph-NAME, which take all words behind NAME.
inline constexpr std::string_view kPrograms[] = {"figure", "machine"};
/// That of the Python module.
inline constexpr std::string_view kBench = "bench";

}  // namespace anamorph::command
