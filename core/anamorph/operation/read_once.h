// SPDX-License-Identifier: Apache-2.0
// Side files that are read once for all who ask.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "anamorph/operation/memo.h"
#include "anamorph/operation/side_files.h"

namespace anamorph {

/// The value that make() reads of a file. That of a file that has an identity is kept for the next who asks
/// for the same; `how` tells readings of one file apart.
template <class Value, class Make>
std::shared_ptr<const Value> read_once(const SideFile& file, const std::string& how, const Make& make) {
    constexpr std::size_t kKept = 4;
    static auto& memo = *new Memo<const Value>(kKept);
    const auto made = [&] { return std::make_shared<const Value>(make()); };
    return file.identity.empty() ? made() : memo.get(how + "\n" + file.identity, made);
}

}  // namespace anamorph
