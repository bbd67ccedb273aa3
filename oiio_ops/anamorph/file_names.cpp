// SPDX-License-Identifier: Apache-2.0
#include "anamorph/file_names.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

namespace fs = std::filesystem;

/// "http:", "concat:", "subfile,,start,0,end,9,,:" in front; two characters at least.
bool has_scheme(std::string_view name) {
    const std::size_t colon = name.find(':');
    if (colon == std::string_view::npos || colon < 2 || !std::isalpha(static_cast<unsigned char>(name[0])))
        return false;
    return std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(colon), [](unsigned char c) {
        return std::isalnum(c) || c == '+' || c == '-' || c == '.' || c == ',' || c == '_';
    });
}

bool urls_are_allowed() {
    const char* value = std::getenv("ANAMORPH_ALLOW_URLS");
    return value && std::string_view(value) == "1";
}

}  // namespace

void check_file_name(const std::string& key, const std::string& name) {
    // As a name, and without the arguments of one that OpenImageIO makes pixels of.
    for (const std::string& path : {name, name.substr(0, name.find('?'))}) {
        std::error_code failure;
        const fs::file_status status = fs::status(path, failure);
        if (failure || !fs::exists(status)) continue;
        if (fs::is_regular_file(status)) return;
        throw Error(key, printable(name),
                    "is not a file but a folder, pipe or device: must be the name of a file");
    }
    if (has_scheme(name) && !urls_are_allowed())
        throw Error(key, printable(name),
                    "is an address: must be the name of a file, unless the environment variable "
                    "ANAMORPH_ALLOW_URLS is 1");
}

std::string content_state(const std::string& name) {
    struct stat s {};
    std::string state;
    if (::stat(name.c_str(), &s) != 0) return state;
    for (const auto number : {std::int64_t(s.st_ino), std::int64_t(s.st_size), std::int64_t(s.st_mtim.tv_sec),
                              std::int64_t(s.st_mtim.tv_nsec)})
        state += std::to_string(number) + " ";
    return state;
}

std::string file_state(const std::string& name) {
    struct stat s {};
    if (::stat(name.c_str(), &s) != 0) return {};
    return content_state(name) + std::to_string(s.st_ctim.tv_sec) + " " + std::to_string(s.st_ctim.tv_nsec) +
           " ";
}

bool has_extension(std::string_view name, std::string_view extension) {
    const std::string_view base = name.substr(0, name.find('?'));
    if (base.size() <= extension.size()) return false;
    const std::string_view end = base.substr(base.size() - extension.size());
    return std::equal(end.begin(), end.end(), extension.begin(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

bool ends_as_main_file(const Operation& operation, std::string_view name) {
    return std::any_of(operation.endings.begin(), operation.endings.end(), [&](const std::string& ending) {
        std::string dotted = ".";
        dotted += ending;
        return has_extension(name, dotted);
    });
}

const Operation* operation_of(std::string_view name) {
    for (const Operation* operation : operations())
        if (has_extension(name, "." + operation->name) || ends_as_main_file(*operation, name))
            return operation;
    return nullptr;
}

}  // namespace anamorph
