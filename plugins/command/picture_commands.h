// SPDX-License-Identifier: Apache-2.0
// The subcommands of the program anamorph that read and draw pictures.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace anamorph::command {

/// Adds them; `run` is then what is to be done.
void add_picture_commands(CLI::App& app, std::function<void()>& run);

}  // namespace anamorph::command
