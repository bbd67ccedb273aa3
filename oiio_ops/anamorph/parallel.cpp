// SPDX-License-Identifier: Apache-2.0
#include "anamorph/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

namespace anamorph {
namespace {

class Loop {
  public:
    Loop(std::int64_t count, const std::function<void(std::int64_t)>& body) : m_count(count), m_body(body) {}

    /// A worker joins, unless the loop is over.
    void help() {
        {
            std::lock_guard lock(m_mutex);
            if (m_over) return;
            ++m_helpers;
        }
        {
            const PoolWorker worker;
            work();
        }
        std::lock_guard lock(m_mutex);
        if (--m_helpers == 0) m_left.notify_all();
    }

    void work() {
        try {
            for (std::int64_t i = m_next++; i < m_count; i = m_next++) m_body(i);
        } catch (...) {
            m_next = m_count;
            std::lock_guard lock(m_mutex);
            if (!m_failure) m_failure = std::current_exception();
        }
    }

    /// Lets nobody else in and waits for those inside.
    void finish() {
        std::unique_lock lock(m_mutex);
        m_over = true;
        m_left.wait(lock, [this] { return m_helpers == 0; });
        // The caller's alone: a task that the pool still holds would let go of it on some thread, at some time.
        if (m_failure) std::rethrow_exception(std::exchange(m_failure, nullptr));
    }

  private:
    const std::int64_t m_count;
    const std::function<void(std::int64_t)>& m_body;  // not touched once the loop is over
    std::atomic<std::int64_t> m_next{0};
    std::mutex m_mutex;
    std::condition_variable m_left;
    int m_helpers = 0;
    bool m_over = false;
    std::exception_ptr m_failure;
};

}  // namespace

PoolWorker::PoolWorker() {
    OIIO::default_thread_pool()->register_worker(std::this_thread::get_id());
}

PoolWorker::~PoolWorker() {
    OIIO::default_thread_pool()->deregister_worker(std::this_thread::get_id());
}

ParallelFor parallel_for_on(OIIO::thread_pool& pool, int threads) {
    return [&pool, threads](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        const std::int64_t helpers = std::min<std::int64_t>({threads - 1, pool.size(), count - 1});
        if (helpers < 1) return serial_for(count, body);
        const auto loop = std::make_shared<Loop>(count, body);
        for (std::int64_t i = 0; i < helpers; ++i) pool.push([loop](int) { loop->help(); });
        loop->work();
        loop->finish();
    };
}

ParallelFor default_parallel_for(int threads) {
    OIIO::thread_pool& pool = *OIIO::default_thread_pool();
    return parallel_for_on(pool, threads > 0 ? threads : pool.size() + 1);
}

}  // namespace anamorph
