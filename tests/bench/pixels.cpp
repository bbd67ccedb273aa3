// SPDX-License-Identifier: Apache-2.0
#include "pixels.h"

#include <sys/mman.h>

#include <cstdlib>
#include <cstring>
#include <new>

namespace anamorph::bench {

Buffer::Buffer(std::size_t bytes) {
    constexpr std::size_t kPage = std::size_t{2} << 20, kRoom = 4096;
    const std::size_t size = (bytes + kRoom + kPage - 1) / kPage * kPage;
    void* data = std::aligned_alloc(kPage, size);
    if (!data) throw std::bad_alloc();
    madvise(data, size, MADV_HUGEPAGE);
    std::memset(data, 0, size);
    m_data.reset(static_cast<std::byte*>(data));
}

void Buffer::Free::operator()(std::byte* data) const {
    std::free(data);
}

Pool::Pool(int count) {
    for (int i = 1; i < count; ++i) m_threads.emplace_back([this] { work(); });
}

Pool::~Pool() {
    {
        const std::lock_guard lock(m_mutex);
        m_stop = true;
    }
    m_wake.notify_all();
    for (std::thread& thread : m_threads) thread.join();
}

ParallelFor Pool::parallel_for() {
    if (m_threads.empty()) return serial_for;
    return [this](std::int64_t count, const std::function<void(std::int64_t)>& body) { run(count, body); };
}

void Pool::run(std::int64_t count, const std::function<void(std::int64_t)>& body) {
    {
        const std::lock_guard lock(m_mutex);
        m_body = &body;
        m_count = count;
        m_next = 0;
        m_busy = m_threads.size();
        ++m_loop;
    }
    m_wake.notify_all();
    drain();
    std::unique_lock lock(m_mutex);
    m_done.wait(lock, [this] { return m_busy == 0; });
}

void Pool::drain() {
    for (std::int64_t i = m_next++; i < m_count; i = m_next++) (*m_body)(i);
}

void Pool::work() {
    std::uint64_t seen = 0;
    for (;;) {
        {
            std::unique_lock lock(m_mutex);
            m_wake.wait(lock, [&] { return m_stop || m_loop != seen; });
            if (m_stop) return;
            seen = m_loop;
        }
        drain();
        const std::lock_guard lock(m_mutex);
        if (--m_busy == 0) m_done.notify_one();
    }
}

}  // namespace anamorph::bench
