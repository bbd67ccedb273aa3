// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "anamorph/image/pages.h"

namespace anamorph::test_pages {
namespace {

/// Leaves memory of this size in the heap that does not read as zeros.
void leave_marks(std::size_t size) {
    void* const used = std::malloc(size);
    auto* const bytes = static_cast<volatile unsigned char*>(used);  // or nothing would be written
    for (std::size_t i = 0; i < size; ++i) bytes[i] = 0x55;
    std::free(used);
}

TEST(Pages, ReadAsZerosAndKeepWhatIsWritten) {
    for (const std::size_t size : {1, 100, 4096, 65535, 65536, 65537, 1 << 20}) {
        leave_marks(size);
        const Pages pages(size);
        std::byte *const first = pages.data(), *const end = first + size;
        EXPECT_TRUE(std::all_of(first, end, [](std::byte b) { return b == std::byte{0}; })) << size;
        std::fill(first, end, std::byte{7});
        EXPECT_EQ(std::count(first, end, std::byte{7}), static_cast<std::ptrdiff_t>(size));
    }
}

TEST(Pages, TakeRoomWhenWrittenTo) {
    // More than most machines have, or on 32 bits a quarter of what there can be.
    constexpr std::size_t kMiddle = std::size_t{1} << (sizeof(std::size_t) == 8 ? 37 : 29);
    const Pages pages(2 * kMiddle);
    pages.data()[kMiddle] = std::byte{1};
    EXPECT_EQ(pages.data()[kMiddle + 1], std::byte{0});
}

}  // namespace
}  // namespace anamorph::test_pages
