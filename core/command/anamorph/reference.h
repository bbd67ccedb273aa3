// SPDX-License-Identifier: Apache-2.0
// Operations and their keys as pages of text for a terminal.
#pragma once

#include <string>

#include "anamorph/operation/operation.h"

namespace anamorph::command {

/// All operations, a line each.
std::string operations_page();

/// What an operation draws, an example, and every key: what it may be, its default and what it means.
std::string operation_page(const Operation& operation);

}  // namespace anamorph::command
