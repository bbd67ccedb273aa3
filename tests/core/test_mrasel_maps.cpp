// SPDX-License-Identifier: Apache-2.0
// MRASEL's texture maps, as MTEXTURE makes them and SHOWMAP shows them.
#include "anamorph/figure/image/mrasel_maps.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <random>

#include "anamorph/error.h"

namespace anamorph::test_mrasel_maps {
using namespace figure;
namespace {

using testing::HasSubstr;

std::string random_base(unsigned seed) {
    std::mt19937 random(seed);
    std::string base;
    for (std::size_t i = 0; i < 512u * 512 * 3; ++i) base += static_cast<char>(random() >> 24);
    return base;
}

unsigned byte_at(const std::string& bytes, int side, int x, int y, int c) {
    return static_cast<unsigned char>(bytes[static_cast<std::size_t>(3 * (y * side + x) + c)]);
}

TEST(MraselMaps, EachTexelIsTheMeanOfAllThatItCovers) {
    for (const unsigned seed : {1u, 2u}) {
        SCOPED_TRACE(seed);
        const std::string base = random_base(seed);
        const MraselMaps maps = MraselMaps::made_of(base, "base");
        ASSERT_EQ(maps.levels(), 10);
        EXPECT_EQ(maps.bytes(0), base);
        int side = 512;
        for (int level = 0; level < 10; ++level, side /= 2) {
            ASSERT_EQ(maps.size(level), (Size{side, side}));
            ASSERT_EQ(maps.bytes(level).size(), static_cast<std::size_t>(3 * side * side));
            const int of = 512 / side;
            for (int k = 0; k < 64; ++k) {
                const int x = (k * 37) % side, y = (k * 91) % side, c = k % 3;
                long double mean = 0;
                for (int j = 0; j < of; ++j)
                    for (int i = 0; i < of; ++i) mean += byte_at(base, 512, x * of + i, y * of + j, c);
                mean /= static_cast<long double>(of) * of;
                ASSERT_EQ(byte_at(maps.bytes(level), side, x, y, c), std::floor(mean + 0.5L));
            }
        }
    }
    // All bytes at their most: no sum overflows.
    const MraselMaps white = MraselMaps::made_of(std::string(512u * 512 * 3, '\xff'), "base");
    EXPECT_EQ(white.bytes(9), "\xff\xff\xff");
}

TEST(MraselMaps, AreReadAsTheyStand) {
    const MraselMaps made = MraselMaps::made_of(random_base(3), "base");
    std::map<std::string, std::string> files;
    for (int level = 0; level < 10; ++level)
        files[mrasel_map_file("dir/face", MraselMaps::side(level))] = made.bytes(level);
    ASSERT_TRUE(files.contains("dir/face.512") && files.contains("dir/face.1"));
    // Files that a user has painted over are not made anew.
    files["dir/face.2"] = "abcdefghijkl";
    const auto read = [&](const std::string& name) {
        const auto found = files.find(name);
        if (found == files.end()) throw Error("there is no file " + name);
        return found->second;
    };
    const MraselMaps maps = MraselMaps::read_from("dir/face", read);
    EXPECT_EQ(maps.bytes(0), made.bytes(0));
    EXPECT_EQ(maps.bytes(8), "abcdefghijkl");
    std::byte texels[6];
    ASSERT_TRUE(maps.read(8, {1, 0, 2, 2}, texels, 3));
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(texels), 6), "defjkl");
    const auto error = [&] {
        try {
            MraselMaps::read_from("dir/face", read);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    files["dir/face.64"] += "x";
    EXPECT_EQ(
        error(),
        "dir/face.64: has 12289 bytes: must have 12288, a map of 64 by 64 texels of red, green and blue");
    files.erase("dir/face.64");
    EXPECT_EQ(error(), "there is no file dir/face.64");
    for (const std::size_t size : {std::size_t{0}, std::size_t{786431}, std::size_t{786433}})
        EXPECT_THROW(MraselMaps::made_of(std::string(size, 'a'), "base"), Error);
}

TEST(MraselMaps, ShownInOnePicture) {
    const MraselMaps maps = MraselMaps::made_of(random_base(4), "base");
    const TriplePicture picture = shown_maps(maps);
    ASSERT_EQ(picture.width, 512);
    ASSERT_EQ(picture.height, 256);
    EXPECT_EQ(picture.ppm().substr(0, 15), "P6\n512 256\n255\n");
    EXPECT_EQ(picture.ppm().substr(15), picture.bytes);
    ASSERT_EQ(picture.bytes.size(), 512u * 256 * 3);
    const int left[9] = {0, 256, 384, 448, 480, 496, 504, 508, 510};
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 512; ++x)
            for (int c = 0; c < 3; ++c) {
                unsigned expected = 0;
                for (int k = 0; k < 9; ++k) {
                    const int side = 256 >> k;
                    if (x >= left[k] && x < left[k] + side && y < side)
                        expected = byte_at(maps.bytes(k + 1), side, x - left[k], y, c);
                }
                ASSERT_EQ(static_cast<unsigned char>(
                              picture.bytes[static_cast<std::size_t>(3 * (y * 512 + x) + c)]),
                          expected);
            }
}

}  // namespace
}  // namespace anamorph::test_mrasel_maps
