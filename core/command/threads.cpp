// SPDX-License-Identifier: Apache-2.0
#include "threads.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace anamorph::command {

ParallelFor threads_for(int threads) {
    if (threads <= 1) return serial_for;
    return [threads](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        std::atomic<std::int64_t> next{0};
        std::mutex mutex;
        std::int64_t failed = count;
        std::exception_ptr failure;
        const auto work = [&] {
            for (std::int64_t i = next++; i < count; i = next++) try {
                    body(i);
                } catch (...) {
                    const std::lock_guard lock(mutex);
                    if (i < failed) {
                        failed = i;
                        failure = std::current_exception();
                    }
                }
        };
        std::vector<std::jthread> others;
        for (std::int64_t k = 1; k < std::min<std::int64_t>(threads, count); ++k) others.emplace_back(work);
        work();
        others.clear();
        if (failure) std::rethrow_exception(failure);
    };
}

}  // namespace anamorph::command
