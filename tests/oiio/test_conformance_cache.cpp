// SPDX-License-Identifier: Apache-2.0
// Recipes behind OpenImageIO's cache: threads, nesting, sources that change, and how much is read:
// conformance items 15 to 19, 28, 29, 31.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/strutil.h>
#include <OpenImageIO/texture.h>

#include <atomic>
#include <filesystem>
#include <set>
#include <thread>

#include "anamorph/image_source.h"
#include "anamorph/panorama/panorama.h"
#include "host.h"

namespace anamorph::test_conformance_cache {
namespace {

using namespace testing_oiio;
using OIIO::ImageCache;
using OIIO::ImageSpec;
using OIIO::ustring;
using testing::HasSubstr;

class CacheConformance : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        m_cache = ImageCache::create(true);
        m_cache->invalidate_all(true);
        m_cache->attribute("max_open_files", 100);
        m_cache->attribute("max_memory_MB", 256.0f);
        write_panorama("city.exr", 256, 128);
    }
    void TearDown() override {
        m_cache->invalidate_all(true);
        InFolder::TearDown();
    }

    /// Tiles read from a file so far.
    std::int64_t tiles_read(const std::string& name) {
        long long n = -1;
        EXPECT_TRUE(m_cache->get_image_info(ustring(name), 0, 0, ustring("stat:tilesread"),
                                            OIIO::TypeDesc::INT64, &n))
            << m_cache->geterror();
        return n;
    }

    bool read_through_cache(const std::string& name, const OIIO::ROI& roi, std::vector<float>& pixels) {
        pixels.resize(static_cast<std::size_t>(roi.npixels()) * 3);
        return m_cache->get_pixels(ustring(name), 0, 0, roi.xbegin, roi.xend, roi.ybegin, roi.yend, 0, 1,
                                   OIIO::TypeFloat, pixels.data());
    }

    ImageCacheRef m_cache{};
};

TEST_F(CacheConformance, conformance_15_threads_nesting_little_memory_few_files) {
    std::vector<std::string> names;
    write_panorama("lines.tif", 512, 256, OIIO::TypeDesc::UINT16, 3, 0);
    write_text("inner.pano", "src=city.exr\nto=equirectangular\nyaw=40\nsize=256x128\ntile=32\n");
    write_text("middle.pano",
               "src=inner.pano\nconcatenate=0\nto=equirectangular\npitch=30\nsize=256x128\ntile=16\n");
    for (const char* name :
         {"city.exr.pano?size=96x64&tile=16", "middle.pano?size=96x64&yaw=10",
          "x.pano?concatenate=0&size=96x64&tile=32&src=middle.pano?to=equirectangular&roll=9",
          "lines.tif.pano?size=96x64&pitch=85&tile=16", "lines.tif.pano?size=96x64&tile=0"})
        names.push_back(name);
    std::vector<std::vector<float>> expected;
    for (const std::string& name : names) expected.push_back(read_floats(name));
    for (const float megabytes : {256.0f, 10.0f})
        for (const int files : {100, 1}) {
            SCOPED_TRACE(std::to_string(megabytes) + " MB, " + std::to_string(files) + " files");
            m_cache->invalidate_all(true);
            m_cache->attribute("max_memory_MB", megabytes);
            m_cache->attribute("max_open_files", files);
            read_from_threads(*m_cache, names, expected, 96, 64);
        }
}

TEST_F(CacheConformance, conformance_15_no_tiles_are_kept_beyond_a_read) {
    // Each of ten recipes asks for tiles of the next while it draws one; the cache is to have them all back.
    write_panorama("fine.exr", 512, 256, OIIO::TypeFloat, 3, 256);
    for (int i = 0; i < 10; ++i)
        write_text(OIIO::Strutil::fmt::format("n{}.pano", i),
                   "to=equirectangular\nsize=512x256\ntile=256\nyaw=20\nconcatenate=0\nsrc=" +
                       (i == 9 ? std::string("fine.exr") : OIIO::Strutil::fmt::format("n{}.pano", i + 1)));
    std::vector<float> pixels;
    ASSERT_TRUE(read_through_cache("v.pano?size=32x32&tile=16&src=n0.pano", OIIO::ROI(0, 32, 0, 32), pixels))
        << m_cache->geterror();
    const auto megabytes = [&] {
        long long used = -1;
        EXPECT_TRUE(m_cache->getattribute("stat:cache_memory_used", OIIO::TypeDesc::INT64, &used));
        return double(used) / (1 << 20);
    };
    const double before = megabytes();
    EXPECT_GT(before, 5);
    m_cache->invalidate_all(true);
    EXPECT_LT(megabytes(), 0.5) << "of " << before;
}

TEST_F(CacheConformance, conformance_15_the_host_s_own_pool_reads_at_once) {
    // ImageBufs behind the cache walked by OpenImageIO's pool, while other threads read recipes.
    const std::string name = "city.exr.pano?size=200x150&tile=16",
                      other = "x.pano?concatenate=0&size=96x64&tile=16&from=latlong&src=" + name;
    OIIO::ImageBuf whole(name), cached(name, 0, 0, m_cache);
    ASSERT_TRUE(whole.read(0, 0, true));
    ASSERT_TRUE(cached.read(0, 0, false));
    ASSERT_EQ(cached.storage(), OIIO::ImageBuf::IMAGECACHE);
    const std::vector<std::vector<float>> expected = {read_floats(other)};
    std::thread readers([&] { read_from_threads(*m_cache, {other}, expected, 96, 64); });
    for (int i = 0; i < 30; ++i) {
        const auto result = OIIO::ImageBufAlgo::compare(cached, whole, 0, 0);
        EXPECT_EQ(result.nfail, 0u);
        EXPECT_FALSE(cached.has_error()) << cached.geterror();
    }
    readers.join();
}

TEST_F(CacheConformance, conformance_16_cycles) {
    write_text("self.pano", "src=self.pano\n");
    write_text("a.pano", "src=b.pano\n");
    write_text("b.pano", "src=./c.pano\n");
    write_text("c.pano", "src=a.pano\n");
    EXPECT_THAT(open_error("self.pano"), HasSubstr("recipes read each other: self.pano -> self.pano"));
    EXPECT_THAT(open_error("a.pano"), HasSubstr("a.pano -> b.pano -> c.pano -> a.pano"));
    EXPECT_THAT(open_error("x.pano?src=a.pano"), HasSubstr("recipes read each other"));
    // Each name is new, so that only depth ends it.
    std::string deep = "city.exr";
    for (int i = 0; i < 40; ++i)
        deep = OIIO::Strutil::fmt::format("n{}.pano?to=equirectangular&size=8&src={}", i, deep);
    EXPECT_THAT(open_error(deep), HasSubstr("nest too deep: must be at most 16"));
    // Two threads that enter a cycle from both ends must not wait for each other.
    std::vector<std::thread> threads;
    std::atomic<int> opened{0};
    for (const char* name : {"a.pano", "b.pano", "c.pano", "self.pano"})
        threads.emplace_back([&, name] {
            for (int i = 0; i < 50; ++i) {
                OIIO::ImageSpec spec;
                if (m_cache->get_imagespec(ustring(name), spec)) ++opened;
                m_cache->geterror();
                m_cache->invalidate(ustring(name));
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(opened, 0);
}

TEST_F(CacheConformance, conformance_17_source_missing_changed_deleted) {
    EXPECT_THAT(open_error("none.exr.pano?size=8"), HasSubstr("source \"none.exr\""));
    EXPECT_THAT(open_error("x.pano"), HasSubstr("source \"x\""));
    std::vector<float> pixels(64 * 64 * 3);

    // Another size than at open.
    auto input = OIIO::ImageInput::open("city.exr.pano?size=64");
    ASSERT_TRUE(input);
    write_panorama("city.exr", 128, 64);
    m_cache->invalidate_all(true);
    EXPECT_FALSE(input->read_image(0, 0, 0, 3, OIIO::TypeFloat, pixels.data()));
    EXPECT_THAT(input->geterror(), HasSubstr("has changed since it was opened"));

    // Gone.
    input = OIIO::ImageInput::open("city.exr.pano?size=64");
    ASSERT_TRUE(input);
    std::filesystem::remove("city.exr");
    m_cache->invalidate_all(true);
    EXPECT_FALSE(input->read_image(0, 0, 0, 3, OIIO::TypeFloat, pixels.data()));
    EXPECT_THAT(input->geterror(), HasSubstr("city.exr"));

    // Damaged: the header is whole, the pixels are not.
    write_panorama("cut.exr", 256, 128);
    std::filesystem::resize_file("cut.exr", std::filesystem::file_size("cut.exr") / 2);
    input = OIIO::ImageInput::open("cut.exr.pano?to=equirectangular&size=64x64");
    if (input) {
        EXPECT_FALSE(input->read_image(0, 0, 0, 3, OIIO::TypeFloat, pixels.data()));
        EXPECT_THAT(input->geterror(), HasSubstr("cut.exr"));
    }
    // And back again.
    write_panorama("city.exr", 256, 128);
    EXPECT_EQ(read_floats("city.exr.pano?size=64").size(), pixels.size());
}

TEST_F(CacheConformance, conformance_18_source_rewritten_twice_in_one_process) {
    const OIIO::ImageBuf one = panorama(256, 128);
    std::vector<std::vector<float>> seen;
    for (const float gain : {1.0f, 0.5f, 0.25f}) {
        write_image(OIIO::ImageBufAlgo::mul(one, gain), "city.exr");
        seen.push_back(read_floats("city.exr.pano?size=64"));
        seen.push_back(read_floats("x.pano?size=64&src=y.pano?to=equirectangular&size=256x128&src=city.exr"));
    }
    for (std::size_t i = 0; i < seen[0].size(); ++i) {
        ASSERT_FLOAT_EQ(seen[2][i], seen[0][i] * 0.5f);
        ASSERT_FLOAT_EQ(seen[4][i], seen[0][i] * 0.25f);
        ASSERT_FLOAT_EQ(seen[5][i], seen[1][i] * 0.25f);
    }
    // While others read it.
    std::atomic<bool> done{false};
    std::thread reader([&] {
        std::vector<float> pixels;
        while (!done) {
            read_through_cache("z.pano?size=200&tile=16&from=latlong&src=city.exr", OIIO::ROI(0, 200, 0, 200),
                               pixels);
            m_cache->geterror();
        }
    });
    for (int i = 0; i < 20; ++i) {
        write_image(OIIO::ImageBufAlgo::mul(one, 0.25f), "next.exr");
        std::filesystem::rename("next.exr", "city.exr");
        EXPECT_EQ(read_floats("city.exr.pano?size=64"), seen[4]);
    }
    done = true;
    reader.join();
    // The recipe itself rewritten.
    write_text("v.pano", "src=city.exr\nsize=64\nyaw=0\n");
    EXPECT_EQ(read_floats("v.pano"), seen[4]);
    write_text("v.pano", "src=city.exr\nsize=64\nyaw=50\n");
    EXPECT_NE(read_floats("v.pano"), seen[4]);
}

/// As the README says: whoever opens sees the new pixels, and of an ImageBuf by way of OpenImageIO's cache who has that
/// forget the recipe's name.
TEST_F(CacheConformance, conformance_18_source_rewritten_seen_by_image_buffers) {
    const auto write = [](float value) {
        OIIO::ImageBuf image(OIIO::ImageSpec(64, 32, 3, OIIO::TypeFloat));
        const float color[] = {value, value, value};
        OIIO::ImageBufAlgo::fill(image, color);
        write_image(image, "flat.exr");
    };
    OIIO::ImageCache& cache = *OIIO::ImageCache::create(true);
    write_text("v.pano", "src=flat.exr\nto=equirectangular\nsize=64x32\n");
    float value = 1;
    for (const std::string name : {"flat.exr.pano?to=equirectangular&size=64x32", "v.pano",
                                   "w.pano?size=8&src=v.pano", "m.warp?mesh=grid.json&src=v.pano"}) {
        SCOPED_TRACE(name);
        write_text("grid.json", R"({"columns": 1, "rows": 1, "units": "fractions",
                                    "vertices": [[0, 0], [1, 0], [0, 1], [1, 1]]})");
        const auto seen = [&] { return OIIO::ImageBuf(name).getchannel(3, 3, 0, 0); };
        write(value);
        cache.invalidate(OIIO::ustring(name));
        EXPECT_EQ(seen(), value);
        write(++value);
        EXPECT_EQ(read_floats(name)[0], value);
        OIIO::ImageBuf read(name);
        ASSERT_TRUE(read.read(0, 0, true, OIIO::TypeFloat)) << read.geterror();
        EXPECT_EQ(read.getchannel(3, 3, 0, 0), value);
        cache.invalidate(OIIO::ustring(name));
        EXPECT_EQ(seen(), value);
        write(++value);
        cache.invalidate_all(true);
        EXPECT_EQ(seen(), value);
    }
}

TEST_F(CacheConformance, conformance_19_after_invalidate_all_and_statistics) {
    const std::string name =
        "x.pano?concatenate=0&size=96x64&tile=16&src=city.exr.pano?to=equirectangular&size=256x128";
    const std::vector<float> expected = read_floats(name);
    std::vector<float> pixels;
    const OIIO::ROI all(0, 96, 0, 64);
    ASSERT_TRUE(read_through_cache(name, all, pixels)) << m_cache->geterror();
    EXPECT_EQ(pixels, expected);
    m_cache->invalidate_all(true);
    ASSERT_TRUE(read_through_cache(name, all, pixels)) << m_cache->geterror();
    EXPECT_EQ(pixels, expected);
    for (int i = 0; i < 50; ++i) {
        m_cache->invalidate_all(i % 2 == 0);
        EXPECT_TRUE(read_through_cache(name, all, pixels)) << m_cache->geterror();
        EXPECT_EQ(pixels, expected);
        EXPECT_FALSE(m_cache->getstats(5).empty());
    }
    EXPECT_THAT(m_cache->getstats(5), HasSubstr("ImageCache statistics"));
    m_cache->reset_stats();
}

TEST_F(CacheConformance, conformance_28_a_texture_lookup_reads_the_level_it_needs) {
    const std::string name = "city.exr.pano?to=equirectangular&size=1024x512&mip=1&tile=32";
    const auto textures = OIIO::TextureSystem::create(true);
    OIIO::TextureOpt options;
    float result[3];
    // A footprint of a quarter of the picture: level 8 (4 x 2) or thereabouts.
    ASSERT_TRUE(textures->texture(ustring(name), options, 0.5f, 0.5f, 0.25f, 0, 0, 0.25f, 3, result))
        << textures->geterror();
    const std::vector<float> whole = read_floats(name, 9);
    EXPECT_NEAR(result[0], 0.5, 0.2);
    EXPECT_GT(tiles_read(name), 0);
    EXPECT_LT(tiles_read(name), 12) << "level 0 alone has 512 tiles";
}

TEST_F(CacheConformance, conformance_29_a_crop_reads_only_the_tiles_it_needs) {
    const std::string name = "fine.exr.pano?to=equirectangular&size=16384x8192&tile=256";
    std::vector<float> pixels;
    write_panorama("fine.exr", 256, 128, OIIO::TypeFloat, 3, 16);
    ASSERT_TRUE(read_through_cache(name, OIIO::ROI(9000, 9256, 4000, 4256), pixels)) << m_cache->geterror();
    EXPECT_EQ(tiles_read(name), 4);
    // 512 of 16384 columns: 8 source pixels and their neighbours.
    EXPECT_LE(tiles_read("fine.exr"), 4);
}

TEST_F(CacheConformance, conformance_29_a_narrow_view_reads_its_footprint) {
    const std::string source = "big.null?RES=65536x32768&TILE=64x64&CHANNELS=3&TYPE=uint8";
    const std::string name = "v.pano?from=equirectangular&fov=5&size=1024x1024&yaw=33&pitch=11&src=" + source;
    const Panorama map(Chart(Projection::equirectangular, 65536, 32768),
                       Chart(Projection::rectilinear, 1024, 1024, 5), {33, 11, 0});
    // The source tiles under all pixels' bilinear footprints.
    std::set<std::pair<int, int>> tiles;
    for (int y = 0; y < 1024; ++y)
        for (int x = 0; x < 1024; ++x) {
            Point<double> p{};
            int piece = 0;
            ASSERT_TRUE(map.exact(x + 0.5, y + 0.5, 0, p, piece));
            for (const double dx : {-0.5, 0.5})
                for (const double dy : {-0.5, 0.5})
                    tiles.insert({int(std::floor(p.x + dx)) / 64, int(std::floor(p.y + dy)) / 64});
        }
    std::vector<float> pixels;
    ASSERT_TRUE(read_through_cache(name, OIIO::ROI(0, 1024, 0, 1024), pixels)) << m_cache->geterror();
    std::printf("footprint %zu tiles, read %lld\n", tiles.size(), static_cast<long long>(tiles_read(source)));
    EXPECT_GE(tiles_read(source), static_cast<std::int64_t>(tiles.size()));
    EXPECT_LE(double(tiles_read(source)), 1.5 * double(tiles.size()));
}

TEST_F(CacheConformance, conformance_29_a_wide_view_reads_the_level_it_needs) {
    // A texture with its own levels: 2048 x 1024 to a view of 64 pixels reads far less than level 0.
    write_panorama("large.exr", 2048, 1024);
    ASSERT_EQ(run("maketx large.exr --tile 64 64 -o large.tx").status, 0);
    std::vector<float> pixels, plain;
    const OIIO::ROI all(0, 64, 0, 64);
    ASSERT_TRUE(read_through_cache("large.tx.pano?size=64&fov=100", all, pixels)) << m_cache->geterror();
    // 512 tiles stand on level 0, 171 on the others. The picture is minified 12 times in the middle and 5
    // times in the corners, so it needs parts of level 2 (32 tiles) and level 3 (8 tiles).
    std::printf("read %lld of 683 tiles\n", static_cast<long long>(tiles_read("large.tx")));
    EXPECT_LE(tiles_read("large.tx"), 40);
    ASSERT_TRUE(read_through_cache("large.exr.pano?size=64&fov=100", all, plain)) << m_cache->geterror();
    EXPECT_LT(largest_difference(pixels, plain), 0.05);
}

TEST_F(CacheConformance, conformance_31_a_thousand_opens) {
    const auto open_many = [&](int from, int to) {
        for (int i = from; i < to; ++i) {
            const std::string name = "city.exr.pano?size=32x32&yaw=" + std::to_string(i * 0.1);
            auto input = OIIO::ImageInput::open(name);
            ASSERT_TRUE(input) << OIIO::geterror();
            std::vector<float> pixels(32 * 32 * 3);
            if (i % 2) {
                ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeFloat, pixels.data()));
            }
            if (i % 3) input->close();
        }
    };
    expect_nothing_left_behind(open_many, 20);
}

}  // namespace
}  // namespace anamorph::test_conformance_cache
