// SPDX-License-Identifier: Apache-2.0
// Arrays aligned to cache lines.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace anamorph {

/// An allocator of memory that begins with a line of the cache.
template <class T>
struct LineAllocator {
    using value_type = T;

    LineAllocator() = default;
    template <class U>
    LineAllocator(const LineAllocator<U>&) {}  // NOLINT: as allocators are

    T* allocate(std::size_t count) {
        if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
        return static_cast<T*>(::operator new(count * sizeof(T), kLine));
    }
    void deallocate(T* from, std::size_t) { ::operator delete(from, kLine); }

    bool operator==(const LineAllocator&) const = default;

  private:
    static constexpr std::align_val_t kLine{64};
};

/// A std::vector aligned to cache lines: each SIMD vector that is loaded from a multiple of its size then lies in one
/// line.
template <class T>
using LineVector = std::vector<T, LineAllocator<T>>;

}  // namespace anamorph
