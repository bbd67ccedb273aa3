// SPDX-License-Identifier: Apache-2.0
// What a shell may complete a command line of the programs with.
#pragma once

#include <string>
#include <vector>

namespace anamorph::command {

/// The words that the last of `words` may become. `words`: a command line of anamorph, anamorph-figure or anamorph-machine from the name
/// of the program on, up to the cursor. Options and subcommands are those of the programs' own help; in the name of a recipe keys and
/// values are those of its operation. None where a file is all that may stand there.
std::vector<std::string> completions(const std::vector<std::string>& words);

}  // namespace anamorph::command
