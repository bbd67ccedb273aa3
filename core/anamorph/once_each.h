// SPDX-License-Identifier: Apache-2.0
// Things of a list that are made when they are first asked for.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>

namespace anamorph {

/// Which things of a list have been made: a few neighbours together, since who asks for one asks for the next soon. Thread safe.
class OnceEach {
  public:
    /// A list of `count` things.
    explicit OnceEach(std::size_t count)
        : m_count(count), m_made(std::make_unique<Some[]>(count / kTogether + 1)) {}

    /// Makes thing `i` and its neighbours, where they have not been made, by make(first, end). Who asks meanwhile waits.
    template <class Make>
    void ask(std::size_t i, const Make& make) {
        Some& some = m_made[i / kTogether];
        if (some.is_made.load(std::memory_order_acquire)) return;
        std::call_once(some.once, [&] {
            const std::size_t first = i / kTogether * kTogether;
            make(first, std::min(first + kTogether, m_count));
            some.is_made.store(true, std::memory_order_release);
        });
    }

  private:
    static constexpr std::size_t kTogether = 32;

    struct Some {
        std::once_flag once;
        std::atomic<bool> is_made = false;  ///< asked for each pixel, which once_flag is too slow for
    };

    std::size_t m_count;
    std::unique_ptr<Some[]> m_made;
};

}  // namespace anamorph
