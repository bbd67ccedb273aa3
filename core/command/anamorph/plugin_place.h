// SPDX-License-Identifier: Apache-2.0
// Where the plugin for OpenImageIO lies, and the environment that it is found by.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace anamorph::command {

/// OpenImageIO's variable: its first name, and the one of version 3.
inline constexpr std::array<const char*, 2> kPluginVariables = {"OIIO_LIBRARY_PATH",
                                                                "OPENIMAGEIO_PLUGIN_PATH"};

/// The folder of this program. Throws Error where the system does not say it.
std::filesystem::path own_folder();

/// The folders where a plugin may lie, by where this program is: an installation's, and a build's. An
/// installation has one for each version of OpenImageIO.
std::vector<std::filesystem::path> plugin_places();

/// The plugins that are there: the files.
std::vector<std::filesystem::path> plugins();

/// `value` of a variable that lists folders, with those of `files` in front that it does not name.
std::string with_folders(const std::string& value, const std::vector<std::filesystem::path>& files);

/// Sets both variables of this process so that OpenImageIO finds `files`; what they name already stays.
void set_plugin_variables(const std::vector<std::filesystem::path>& files);

/// Becomes the command `argv`, whose last element is null, with these variables. It returns only if that
/// cannot be: the status that a shell has for it, 127 for a command that is not there and 126 for one that
/// cannot be run, after a line on the standard error. Throws Error where there is no plugin.
int run_with_plugin(char** argv);

}  // namespace anamorph::command
