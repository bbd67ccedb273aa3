// SPDX-License-Identifier: Apache-2.0
// Scripts from files.
#pragma once

#include <string>
#include <vector>

#include "anamorph/figure/script.h"

namespace anamorph::command {

struct ScriptSource {
    std::string path;                    ///< "-" is the standard input
    std::vector<std::string> libraries;  ///< files that are included ahead of it
    Dialect dialect = Dialect::classic;
};

/// Reads and parses. What a script includes is looked for in its folder. Throws Error for what cannot be
/// read, not for what a script says.
Script read_script(const ScriptSource& source);

/// The program of a script without errors. Throws Error with the first error's text.
Program read_program(const ScriptSource& source);

}  // namespace anamorph::command
