// SPDX-License-Identifier: Apache-2.0
// Other programs, run for what they say.
#pragma once

#include <string>
#include <vector>

namespace anamorph::command {

/// What became of a program.
struct ProgramRun {
    /// Its exit status; 128 and the number of the signal that ended it; -1 if it was stopped after its time.
    int status = 0;
    /// What it wrote on its standard output and error, as far as the first 64 KiB go.
    std::string text;

    bool ok() const { return status == 0; }
    /// The last line of `text` that is not empty, fit for a message.
    std::string last_line() const;
    /// The rest of the last line of `text` that begins with `mark`; empty where there is none.
    std::string after(const std::string& mark) const;
};

/// The file that a shell would run as `name`; empty where PATH has none.
std::string find_program(const std::string& name);

/// Runs `words`, the first of which is a file, without input, for `seconds` at most. Throws Error if there
/// is no process to be had.
ProgramRun run_program(const std::vector<std::string>& words, int seconds);

}  // namespace anamorph::command
