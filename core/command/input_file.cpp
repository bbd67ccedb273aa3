// SPDX-License-Identifier: Apache-2.0
#include "input_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <istream>

#include "anamorph/error.h"

namespace anamorph::command {

std::string read_all(std::istream& in, const std::string& name, std::size_t most) {
    std::string text;
    char block[1 << 16];
    while (text.size() <= most &&
           in.read(block, static_cast<std::streamsize>(std::min(sizeof block, most + 1 - text.size())))
                   .gcount() > 0)
        text.append(block, static_cast<std::size_t>(in.gcount()));
    if (in.bad()) throw Error("cannot read " + name);
    return text;
}

std::optional<std::string> read_file(const std::string& path, bool any, std::size_t most) {
    std::error_code error;
    if (any ? std::filesystem::is_directory(path, error) : !std::filesystem::is_regular_file(path, error))
        return std::nullopt;
    std::ifstream in(path, std::ios::binary);
    if (!in) return std::nullopt;
    return read_all(in, path, most);
}

}  // namespace anamorph::command
