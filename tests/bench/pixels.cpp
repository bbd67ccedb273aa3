// SPDX-License-Identifier: Apache-2.0
#include "pixels.h"

#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <new>
#include <utility>

namespace anamorph::bench {
namespace {

/// What loops are taken down by, if they are.
Shares* s_shares = nullptr;

double processor_ns(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
}
double sleeps() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_nvcsw);
}

}  // namespace

Shares::Shares(const std::function<void()>& draw) {
    const double from = sleeps(), start = processor_ns(CLOCK_PROCESS_CPUTIME_ID);
    s_shares = this;
    draw();
    s_shares = nullptr;
    m_all = processor_ns(CLOCK_PROCESS_CPUTIME_ID) - start;
    m_sleeps = sleeps() - from;
}

double Shares::speed_on(int threads) const {
    double alone = m_all, together = 0;
    for (const std::vector<double>& parts : m_loops) {
        std::vector<double> until(static_cast<std::size_t>(threads));
        for (const double part : parts) {
            *std::min_element(until.begin(), until.end()) += part;
            alone -= part;
        }
        together += *std::max_element(until.begin(), until.end());
    }
    return m_all / (std::max(alone, 0.0) + together);
}

double Shares::waits(int threads) const {
    // All but one are woken, and one waits for the last.
    return std::max(0.0, m_sleeps - static_cast<double>(m_loops.size()) * threads);
}

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
    return [this](std::int64_t count, const std::function<void(std::int64_t)>& body) { run(count, body); };
}

void Pool::run(std::int64_t count, const std::function<void(std::int64_t)>& body) {
    if (m_threads.empty() && !s_shares) return serial_for(count, body);
    if (s_shares) m_times.assign(static_cast<std::size_t>(count), 0.0);
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
    if (s_shares) s_shares->add_loop(std::exchange(m_times, {}));
}

void Pool::drain() {
    for (std::int64_t i = m_next++; i < m_count; i = m_next++) do_part(i);
}

void Pool::do_part(std::int64_t i) {
    if (!s_shares) return (*m_body)(i);
    const double start = processor_ns(CLOCK_THREAD_CPUTIME_ID);
    (*m_body)(i);
    m_times[static_cast<std::size_t>(i)] = processor_ns(CLOCK_THREAD_CPUTIME_ID) - start;
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
