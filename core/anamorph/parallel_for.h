// SPDX-License-Identifier: Apache-2.0
// The loop by which a host lends threads.
#pragma once

#include <cstdint>
#include <functional>

namespace anamorph {

/// Calls `body(i)` once for every i in [0, count), in any order, on any threads, and waits for all.
/// The core starts no thread of its own: a host passes its own pool here. Where `body` throws, the call throws that again once
/// nothing runs any more. It is never empty.
using ParallelFor = std::function<void(std::int64_t count, const std::function<void(std::int64_t)>& body)>;

/// A ParallelFor without threads: calls `body` for each i in turn, on the calling thread.
inline void serial_for(std::int64_t count, const std::function<void(std::int64_t)>& body) {
    for (std::int64_t i = 0; i < count; ++i) body(i);
}

}  // namespace anamorph
