// SPDX-License-Identifier: Apache-2.0
#include "plugin_place.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include "anamorph/parameter/parameter.h"

namespace anamorph::command {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "anamorph_recipes.imageio.so";

/// The folders of `value` between its colons.
std::vector<std::string> split_folders(const std::string& value) {
    std::vector<std::string> folders;
    for (std::size_t at = 0; at <= value.size();) {
        const std::size_t end = std::min(value.find(':', at), value.size());
        if (end > at) folders.push_back(value.substr(at, end - at));
        at = end + 1;
    }
    return folders;
}

bool is_there(const fs::path& path) {
    std::error_code error;
    return fs::exists(path, error);
}

}  // namespace

fs::path own_folder() {
    std::error_code error;
    const fs::path own = fs::read_symlink("/proc/self/exe", error);
    if (error) throw Error("/proc/self/exe: " + error.message() + " (it says where this program lies)");
    return own.parent_path();
}

std::vector<fs::path> plugin_places() {
    const fs::path own = own_folder();
    const fs::path installed = (own / ANAMORPH_PLUGINS_FROM_PROGRAMS).lexically_normal();
    std::vector<fs::path> places;
    std::error_code error;
    for (fs::directory_iterator at(installed, error), end; !error && at != end; at.increment(error))
        if (at->path().filename().string().starts_with("oiio-")) places.push_back(at->path());
    std::ranges::sort(places);
    if (places.empty()) places.push_back(installed / "oiio-VERSION");
    places.push_back((own / "../../plugins/imageio").lexically_normal());
    return places;
}

std::vector<fs::path> plugins() {
    std::vector<fs::path> files;
    for (const fs::path& place : plugin_places())
        if (is_there(place / kFile)) files.push_back(place / kFile);
    return files;
}

std::string with_folders(const std::string& value, const std::vector<fs::path>& files) {
    const std::vector<std::string> named = split_folders(value);
    std::string result;
    for (const fs::path& file : files) {
        const std::string folder = file.parent_path().string();
        if (std::ranges::find(named, folder) == named.end()) result += folder + ":";
    }
    result += value;
    if (result.ends_with(":") && value.empty()) result.pop_back();
    return result;
}

void set_plugin_variables(const std::vector<fs::path>& files) {
    for (const char* variable : kPluginVariables) {
        const char* value = std::getenv(variable);
        setenv(variable, with_folders(value ? value : "", files).c_str(), 1);
    }
}

int run_with_plugin(char** argv) {
    const std::vector<fs::path> files = plugins();
    if (files.empty()) {
        std::string places;
        for (const fs::path& place : plugin_places())
            places += (places.empty() ? "" : " and ") + printable(place.string());
        throw Error("no plugin for OpenImageIO: " + std::string(kFile) + " is not in " + places +
                    " (Debian: anamorph-openimageio)");
    }
    set_plugin_variables(files);
    execvp(argv[0], argv);
    const int reason = errno;
    std::cerr << "anamorph: " << printable(argv[0]) << ": "
              << (reason == ENOENT ? "there is no such command" : std::strerror(reason)) << "\n";
    return reason == ENOENT ? 127 : 126;
}

}  // namespace anamorph::command
