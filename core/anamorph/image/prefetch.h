// SPDX-License-Identifier: Apache-2.0
// Fetching memory that is read soon.
#pragma once

namespace anamorph::simd {

/// Fetches a cache line into the second level only. The first has few places for addresses that differ by a multiple of
/// 4096: rows of a picture whose length in bytes is one push each other out of it before they are read.
///
/// GCC takes a function that does nothing else for one without effect, and leaves out its calls unless it is inlined first.
[[gnu::always_inline]] inline void prefetch_to_second_level(const void* at) {
    constexpr int kRead = 0, kSecondLevel = 2;
    __builtin_prefetch(at, kRead, kSecondLevel);
}

}  // namespace anamorph::simd
