// SPDX-License-Identifier: Apache-2.0
// Files that several threads open at once.
#include <array>
#include <latch>
#include <thread>

#include "anamorph/image_source.h"
#include "host.h"

namespace anamorph::test_opening {
namespace {

using namespace testing_oiio;

void append(std::vector<std::uint8_t>& bytes, std::uint32_t number) {
    for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

/// A profile of colours with as many tags as a JPEG's segment holds, and no tag in two profiles.
std::vector<std::uint8_t> profile(std::uint32_t number) {
    constexpr std::uint32_t kHeader = 128, kTags = 3000;
    std::vector<std::uint8_t> bytes;
    append(bytes, kHeader + 4 + 12 * kTags);
    bytes.resize(kHeader);
    const auto write = [&](std::size_t at, const char* word) { std::copy_n(word, 4, &bytes[at]); };
    write(12, "mntr"), write(16, "RGB "), write(20, "XYZ "), write(36, "acsp"), write(40, "APPL");
    append(bytes, kTags);
    for (std::uint32_t i = 0; i < kTags; ++i)
        append(bytes, (number * kTags + i) | 0x80000000u), append(bytes, 0), append(bytes, 4);
    return bytes;
}

class Opening : public InFolder {};

// OpenImageIO before 2.4.9 notes the tags of new profiles in a map without a lock.
TEST_F(Opening, PhotographsWithProfilesOfTheirOwnOpenAtOnce) {
    constexpr int kThreads = 8, kFiles = 96;
    const auto name = [](int i) { return std::to_string(i) + ".jpg"; };
    for (int i = 0; i < kFiles; ++i) {
        OIIO::ImageSpec spec(8, 8, 3, OIIO::TypeUInt8);
        const std::vector<std::uint8_t> icc = profile(static_cast<std::uint32_t>(i));
        spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(icc.size())),
                       icc.data());
        const auto file = OIIO::ImageOutput::create(name(i));
        const std::array<std::uint8_t, 192> pixels = {};
        ASSERT_TRUE(file->open(name(i), spec) && file->write_image(OIIO::TypeUInt8, pixels.data()) &&
                    file->close())
            << file->geterror();
    }
    const ImageCacheRef cache = OIIO::ImageCache::create(false);
    std::latch start(kThreads);
    std::vector<std::thread> threads;
    std::array<int, kFiles> sizes = {};
    for (int i = 0; i < kThreads; ++i)
        threads.emplace_back([&, i] {
            start.arrive_and_wait();
            for (int k = i; k < kFiles; k += kThreads) {
                const CacheSource source(cache, name(k), 0, 0);
                sizes[static_cast<std::size_t>(k)] =
                    source.spec().get_int_attribute("ICCProfile:profile_size");
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (const int size : sizes) EXPECT_EQ(size, 128 + 4 + 12 * 3000);
#if OIIO_VERSION < 30000
    OIIO::ImageCache::destroy(cache);
#endif
}

}  // namespace
}  // namespace anamorph::test_opening
