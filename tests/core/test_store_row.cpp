// SPDX-License-Identifier: Apache-2.0
// Rows are stored without a byte read or written past their end: both stand against a page that must not be
// touched.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstring>

#include "anamorph/image/pixel.h"
#include "anamorph/simd/block_sampler.h"

namespace anamorph {
namespace {

/// A page of memory with a forbidden one behind it.
class GuardedPage {
  public:
    GuardedPage() : m_size(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))) {
        void* pages = mmap(nullptr, 2 * m_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (pages == MAP_FAILED) throw std::bad_alloc();
        m_first = static_cast<std::byte*>(pages);
        mprotect(m_first + m_size, m_size, PROT_NONE);
    }
    ~GuardedPage() { munmap(m_first, 2 * m_size); }
    GuardedPage(const GuardedPage&) = delete;
    GuardedPage& operator=(const GuardedPage&) = delete;

    /// The last `size` bytes before the forbidden page.
    std::byte* last(std::size_t size) const { return m_first + m_size - size; }

  private:
    std::size_t m_size;
    std::byte* m_first;
};

TEST(StoreRow, StaysWithinItsRow) {
    const GuardedPage from, to;
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        for (const PixelType type :
             {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32})
            for (int count = 1; count <= 70; ++count) {
                const auto n = static_cast<std::size_t>(count);
                auto* values = reinterpret_cast<float*>(from.last(n * sizeof(float)));
                for (int i = 0; i < count; ++i) values[i] = static_cast<float>(i);
                std::byte* row = to.last(n * static_cast<std::size_t>(size_of(type)));
                simd::store_row(values, count, 1, type, row);
                simd::finish_stores();
                const float one = type == PixelType::uint8    ? 255.0f
                                  : type == PixelType::uint16 ? 65535.0f
                                                              : 1.0f;
                for (int i = 0; i < count; ++i)
                    EXPECT_EQ(std::round(load_channel(row + i * size_of(type), type) * one), i) << count;
            }
    }
    simd::use_instruction_set("");
}

}  // namespace
}  // namespace anamorph
