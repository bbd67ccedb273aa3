// SPDX-License-Identifier: Apache-2.0
// What is read from files and from the standard input.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>

namespace anamorph::command {

/// Reads a stream to its end, or to one byte more than `most`: whoever asked says what is wrong with it. Throws Error naming `name`
/// where it cannot be read.
std::string read_all(std::istream& in, const std::string& name, std::size_t most);

/// Reads a file as read_all() does; nothing where there is none. `any`: pipes and devices, too.
std::optional<std::string> read_file(const std::string& path, bool any, std::size_t most);

}  // namespace anamorph::command
