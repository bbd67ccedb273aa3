// SPDX-License-Identifier: Apache-2.0
// Scripts and motions from files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script.h"

namespace anamorph::command {

struct ScriptSource {
    std::string path;                    ///< "-" is the standard input
    std::vector<std::string> libraries;  ///< files that are included ahead of it
    figure::Dialect dialect = figure::Dialect::classic;
};

/// Reads and parses. What a script includes is looked for in its folder. Throws Error for what cannot be
/// read, not for what a script says.
figure::Script read_script(const ScriptSource& source);

/// A script without errors, performed, or a motion by the ending of its name (motion_file.h). Throws Error
/// with the first error's text.
std::unique_ptr<figure::Motion> open_motion(const ScriptSource& source,
                                            const figure::PerformanceOptions& options);

}  // namespace anamorph::command
