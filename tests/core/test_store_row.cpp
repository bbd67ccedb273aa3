// SPDX-License-Identifier: Apache-2.0
// Rows are stored without a byte read or written past their end: both stand against a page that must not be
// touched.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "anamorph/image/pixel.h"
#include "anamorph/simd/block_sampler.h"
#include "guarded_memory.h"

namespace anamorph {
namespace {

TEST(StoreRow, StaysWithinItsRow) {
    const test::GuardedMemory from, to;
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
