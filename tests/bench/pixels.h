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

/// The processor's time that a drawing takes: of each part of each loop that was handed to threads, and in all. From these
/// comes how much faster it would be on so many free cores, whatever else the machine does.
class Shares {
  public:
    /// Calls `draw` once, and takes down what its loops do, of pools of this program.
    explicit Shares(const std::function<void()>& draw);

    double all_ns() const { return m_all; }
    /// Have there been loops?
    bool has_loops() const { return !m_loops.empty(); }
    /// The speed on `threads` free cores over that on one, of which each takes the next part when it is done with one.
    double speed_on(int threads) const;
    /// How often threads slept, beyond what starting and ending loops takes: where they waited for one another.
    double waits(int threads) const;

    void add_loop(std::vector<double> parts) { m_loops.push_back(std::move(parts)); }

  private:
    std::vector<std::vector<double>> m_loops;
    double m_all = 0, m_sleeps = 0;
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
    void do_part(std::int64_t i);

    std::vector<std::thread> m_threads;
    std::mutex m_mutex;
    std::condition_variable m_wake, m_done;
    const std::function<void(std::int64_t)>* m_body = nullptr;
    std::atomic<std::int64_t> m_next{0};
    std::int64_t m_count = 0;
    std::vector<double> m_times;  ///< of the parts, where they are taken down
    std::uint64_t m_loop = 0;
    std::size_t m_busy = 0;
    bool m_stop = false;
};

}  // namespace anamorph::bench
