// SPDX-License-Identifier: Apache-2.0
// Operations and their keys as pages of text for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "anamorph/operation/operation.h"

namespace anamorph::command {

/// The longest line of pages and files.
inline constexpr std::size_t kColumns = 80;

/// The words of a text in lines of at most so many columns; of longer words each has a line. At least one line.
std::vector<std::string> wrapped(const std::string& text, std::size_t columns);

/// All operations, a line each.
std::string operations_page();

/// What an operation draws, an example, and every key: what it may be, its default and what it means.
std::string operation_page(const Operation& operation);

}  // namespace anamorph::command
