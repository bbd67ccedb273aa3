// SPDX-License-Identifier: Apache-2.0
// Memory and threads of the benchmark: buffers on huge pages, so that page faults and TLB misses weigh on
// nobody, and a pool that lends its threads as a ParallelFor.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/parallel_for.h"

namespace anamorph::bench {

/// Zeroed memory, aligned to 2 MiB, with some room behind the last byte for wide loads.
class Buffer {
  public:
    explicit Buffer(std::size_t bytes);

    std::byte* bytes() const { return m_data.get(); }
    template <class T>
    T* as() const {
        return reinterpret_cast<T*>(m_data.get());
    }

  private:
    struct Free {
        void operator()(std::byte* data) const;
    };
    std::unique_ptr<std::byte, Free> m_data;
};

/// `count` threads that work: the caller and count - 1 more, kept between loops.
class Pool {
  public:
    explicit Pool(int count);
    ~Pool();
    Pool(const Pool&) = delete;
    Pool& operator=(const Pool&) = delete;

    ParallelFor parallel_for();

  private:
    void run(std::int64_t count, const std::function<void(std::int64_t)>& body);
    void work();
    void drain();

    std::vector<std::thread> m_threads;
    std::mutex m_mutex;
    std::condition_variable m_wake, m_done;
    const std::function<void(std::int64_t)>* m_body = nullptr;
    std::atomic<std::int64_t> m_next{0};
    std::int64_t m_count = 0;
    std::uint64_t m_loop = 0;
    std::size_t m_busy = 0;
    bool m_stop = false;
};

}  // namespace anamorph::bench
