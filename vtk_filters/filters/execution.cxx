// SPDX-License-Identifier: Apache-2.0
#include "execution.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>

#include "host.h"
#include "vtkAlgorithm.h"

namespace anamorph_vtk {

void Execution::progress(double amount) {
    if (amount > m_progress) {
        m_progress = amount;
        m_algorithm->UpdateProgress(amount);
    }
    if (anamorph::is_aborted(m_algorithm)) throw Aborted();
}

anamorph::ParallelFor Execution::stage(double begin, double end) {
    return [this, begin, end](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        // In slices: observers are called from the filter's own thread alone.
        constexpr std::int64_t kSlices = 10, kLeastSlice = 32;
        const std::int64_t slice = std::max((count + kSlices - 1) / kSlices, kLeastSlice);
        std::atomic<bool> failed = false;
        std::exception_ptr failure;
        std::mutex guard;
        for (std::int64_t first = 0; first < count; first += slice) {
            const std::int64_t last = std::min(first + slice, count);
            anamorph::smp_for(last - first, [&](std::int64_t i) {
                if (failed) return;
                try {
                    body(first + i);
                } catch (...) {
                    const std::lock_guard<std::mutex> lock(guard);
                    if (!failure) failure = std::current_exception();
                    failed = true;
                }
            });
            if (failure) std::rethrow_exception(failure);
            progress(begin + (end - begin) * static_cast<double>(last) / static_cast<double>(count));
        }
    };
}

}  // namespace anamorph_vtk
