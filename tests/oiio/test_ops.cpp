// SPDX-License-Identifier: Apache-2.0
// anamorph::reproject with the contract of ImageBufAlgo, and its agreement with the recipe.
#include "anamorph/oiio_ops.h"

#include <OpenImageIO/color.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/thread.h>
#include <malloc.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "anamorph/parallel.h"
#include "host.h"

namespace anamorph::test_ops {
namespace {

using namespace testing_oiio;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ParamValueList;
using OIIO::ROI;
using OIIO::TypeDesc;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Ops : public InFolder {};

TEST_F(Ops, ReturnsWhatItFills) {
    const ImageBuf source = panorama(256, 128);
    const ParamValueList o = options({{"yaw", "30"}, {"size", "100x80"}});
    ImageBuf filled;
    ASSERT_TRUE(reproject(filled, source, o)) << filled.geterror();
    EXPECT_EQ(filled.spec().width, 100);
    EXPECT_EQ(filled.spec().height, 80);
    EXPECT_EQ(filled.spec().format, TypeDesc::FLOAT);
    const ImageBuf returned = reproject(source, o);
    ASSERT_FALSE(returned.has_error()) << returned.geterror();
    EXPECT_EQ(bytes(returned), bytes(filled));
    // Options as numbers.
    ParamValueList numbers;
    numbers.attribute("yaw", 30.0f);
    const int size[] = {100, 80};
    numbers.attribute("size", TypeDesc(TypeDesc::INT, 2), size);
    EXPECT_EQ(bytes(reproject(source, numbers)), bytes(filled));
}

TEST_F(Ops, AgreesWithTheRecipe) {
    for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::UINT16, TypeDesc::HALF, TypeDesc::FLOAT})
        for (const int channels : {1, 3, 4}) {
            SCOPED_TRACE(std::string(type.c_str()) + " " + std::to_string(channels));
            const bool integer = type == TypeDesc::UINT8 || type == TypeDesc::UINT16;
            const std::string name = integer ? "s.tif" : "s.exr";
            write_panorama(name, 256, 128, type, channels);
            ImageBuf source(name);
            ASSERT_TRUE(source.read(0, 0, true));
            ASSERT_EQ(source.spec().format, type);
            const ImageBuf made =
                reproject(source, options({{"pitch", "85"}, {"roll", "10"}, {"size", "90x70"}}));
            EXPECT_EQ(bytes(made), read_pixels(name + ".pano?pitch=85&roll=10&size=90x70").bytes);
        }
}

TEST_F(Ops, EveryOperationByItsNameIsItsRecipe) {
    const std::vector<std::string> names = {"city.exr", "town.exr"};
    write_panorama("city.exr", 64, 32);
    write_image(OIIO::ImageBufAlgo::flop(panorama(64, 32)), "town.exr");
    for (const Operation* operation : operations()) {
        SCOPED_TRACE(operation->name);
        const Pixels recipe = read_pixels(example(*operation, names));
        std::vector<ImageBuf> images;
        for (std::size_t i = 0; i < operation->least_sources; ++i) images.emplace_back(names[i]);
        std::vector<const ImageBuf*> sources;
        for (const ImageBuf& image : images) sources.push_back(&image);
        ParamValueList o;
        for (const Assignment& a : parse_recipe_name("?" + operation->example.arguments).assignments)
            o.attribute(a.key, a.value);
        const ImageBuf made = apply(operation->name, sources, o);
        EXPECT_EQ(bytes(made), recipe.bytes);
        for (const char* name : {"anamorph:tol", "anamorph:max_error"})
            EXPECT_EQ(made.spec().get_float_attribute(name, -1), recipe.spec.get_float_attribute(name, -2));
        // A part of it, in place of what was there.
        ImageBuf dst(made.spec());
        const ROI part(5, 20, 3, 17, 0, 1, 0, 3);
        ASSERT_TRUE(apply(dst, operation->name, sources, o, part)) << dst.geterror();
        EXPECT_EQ(bytes(OIIO::ImageBufAlgo::cut(dst, part)), bytes(OIIO::ImageBufAlgo::cut(made, part)));
        // As many sources as it draws.
        sources.resize(operation->sources.size() + 1, &dst);
        EXPECT_FALSE(apply(dst, operation->name, sources, o));
        EXPECT_THAT(dst.geterror(), AllOf(HasSubstr(operation->name + ": "),
                                          HasSubstr("source images: must be "), Not(HasSubstr("\n"))));
    }
    const ImageBuf none = apply("none", {});
    EXPECT_EQ(none.geterror(), "apply: operation \"none\": must be one of " + operation_names());
}

TEST_F(Ops, ReadsAnImageBehindACache) {
    write_panorama("s.exr", 256, 128);
    ImageBuf local("s.exr"), cached("s.exr", 0, 0, OIIO::ImageCache::create(true));
    ASSERT_TRUE(local.read(0, 0, true));
    ASSERT_TRUE(cached.read(0, 0, false));
    ASSERT_EQ(cached.storage(), ImageBuf::IMAGECACHE);
    const ParamValueList o = options({{"yaw", "175"}, {"size", "90x70"}});
    EXPECT_EQ(bytes(reproject(cached, o)), bytes(reproject(local, o)));
    // One that was only named so far.
    EXPECT_EQ(bytes(reproject(ImageBuf("s.exr"), o)), bytes(reproject(local, o)));
    const ImageBuf missing = reproject(ImageBuf("none.exr"), o);
    EXPECT_TRUE(missing.has_error());
    EXPECT_THAT(missing.geterror(), HasSubstr("none.exr"));
}

TEST_F(Ops, ReadsTheLevelsOfAnImageBehindACache) {
    ASSERT_TRUE(OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, panorama(512, 256),
                                                 "s.tx", ImageSpec()));
    const auto cache = OIIO::ImageCache::create(true);
    // Pixels of a level that is a source by itself: magnified, none but its own serve.
    const ParamValueList near = options({{"yaw", "175"}, {"fov", "40"}, {"size", "90x70"}});
    for (const int level : {0, 1, 2}) {
        ImageBuf local("s.tx", 0, level), cached("s.tx", 0, level, cache);
        ASSERT_TRUE(local.read(0, level, true));
        ASSERT_TRUE(cached.read(0, level, false));
        ASSERT_EQ(cached.storage(), ImageBuf::IMAGECACHE);
        EXPECT_EQ(local.spec().width, 512 >> level);
        EXPECT_EQ(bytes(reproject(cached, near)), bytes(reproject(local, near))) << level;
    }
    // Made much smaller, the file's own coarse levels serve: far fewer tiles than the 32 of level 0 are read.
    cache->invalidate_all(true);
    ImageBuf cached("s.tx", 0, 0, cache);
    ASSERT_TRUE(cached.read(0, 0, false));
    const auto tiles_read = [&] {
        long long n = -1;
        EXPECT_TRUE(cache->get_image_info(OIIO::ustring("s.tx"), 0, 0, OIIO::ustring("stat:tilesread"),
                                          TypeDesc::INT64, &n));
        return n;
    };
    const long long before = tiles_read();
    const ImageBuf small = reproject(cached, options({{"to", "equirectangular"}, {"size", "32x16"}}));
    ASSERT_FALSE(small.has_error()) << small.geterror();
    EXPECT_LE(tiles_read() - before, 8);
}

TEST_F(Ops, AnInitialisedImageKeepsItsSpec) {
    const ImageBuf source = panorama(256, 128);
    const ImageBuf whole = reproject(source, options({{"size", "100x80"}}));
    ImageSpec spec(100, 80, 3, TypeDesc::UINT16);
    spec.attribute("mine", 5);
    ImageBuf dst(spec);
    const ROI roi(20, 70, 10, 60, 0, 1, 1, 2);
    const float grey[] = {0.25f, 0.25f, 0.25f};
    OIIO::ImageBufAlgo::fill(dst, grey);
    // Without a size, dst's.
    ASSERT_TRUE(reproject(dst, source, {}, roi)) << dst.geterror();
    EXPECT_EQ(dst.spec().format, TypeDesc::UINT16);
    EXPECT_EQ(dst.spec().get_int_attribute("mine"), 5);
    EXPECT_LE(dst.spec().get_float_attribute("anamorph:max_error", 9), 0.01f);
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 100; ++x)
            for (int c = 0; c < 3; ++c) {
                const bool inside = roi.contains(x, y, 0, c);
                ASSERT_NEAR(dst.getchannel(x, y, 0, c), inside ? whole.getchannel(x, y, 0, c) : 0.25f, 1e-4)
                    << x << " " << y << " " << c;
            }
    // A roi of a new image is its data window.
    ImageBuf part;
    ASSERT_TRUE(reproject(part, source, options({{"size", "100x80"}}), ROI(20, 70, 10, 60)));
    EXPECT_EQ(part.spec().x, 20);
    EXPECT_EQ(part.spec().width, 50);
    EXPECT_EQ(part.spec().full_width, 100);
    for (int y = 10; y < 60; ++y)
        for (int x = 20; x < 70; ++x) ASSERT_EQ(part.getchannel(x, y, 0, 2), whole.getchannel(x, y, 0, 2));
    // More channels than the picture has: the others stay.
    ImageBuf four(ImageSpec(100, 80, 4, TypeDesc::FLOAT));
    const float white[] = {1, 1, 1, 0.75f};
    OIIO::ImageBufAlgo::fill(four, white);
    ASSERT_TRUE(reproject(four, source));
    EXPECT_EQ(four.getchannel(50, 40, 0, 1), whole.getchannel(50, 40, 0, 1));
    EXPECT_EQ(four.getchannel(50, 40, 0, 3), 0.75f);
    // In place.
    ImageBuf itself = panorama(256, 128);
    ASSERT_TRUE(reproject(itself, itself, options({{"to", "equirectangular"}, {"yaw", "90"}})));
    EXPECT_NEAR(itself.getchannel(10, 64, 0, 0), source.getchannel(74, 64, 0, 0), 1e-4);
}

TEST_F(Ops, ThreadsDoNotChangeAnyBit) {
    const ImageBuf source = panorama(512, 256);
    const ParamValueList o = options({{"to", "cubemap"}, {"yaw", "33"}, {"size", "200"}});
    const std::vector<std::byte> one = bytes(reproject(source, o, {}, 1));
    for (const int threads : {0, 2, 3, 7})
        EXPECT_EQ(bytes(reproject(source, o, {}, threads)), one) << threads;
}

/// Memory that comes and goes is not zero as long as this lives.
class DirtyMemory {
  public:
    DirtyMemory() { ::mallopt(M_PERTURB, 0x5a); }
    ~DirtyMemory() { ::mallopt(M_PERTURB, 0); }
};

TEST_F(Ops, ANewImageHasAValueEverywhere) {
    const DirtyMemory dirty;
    const ImageBuf source = panorama(256, 128);
    // A cross has faces missing, a fisheye has corners without a source, and a roi may reach beyond the picture.
    const ROI beyond(-20, 60, 30, 140), channel(10, 60, 30, 70, 0, 1, 1, 2);
    for (const char* to : {"rectilinear", "fisheye", "cubecross"})
        for (const ROI& roi : {ROI(), beyond, channel}) {
            SCOPED_TRACE(std::string(to) + " " + (roi.defined() ? std::to_string(roi.chend) : "all"));
            const ParamValueList o = options({{"to", to}, {"size", "120"}});
            const ImageBuf made = reproject(source, o, roi);
            ASSERT_FALSE(made.has_error()) << made.geterror();
            ImageBuf filled(made.spec());
            OIIO::ImageBufAlgo::zero(filled);
            ASSERT_TRUE(reproject(filled, source, o, roi)) << filled.geterror();
            EXPECT_EQ(bytes(made), bytes(filled));
        }
}

TEST_F(Ops, ANewImageThatCannotBeFilledIsBlack) {
    const DirtyMemory dirty;
    write_panorama("s.exr", 256, 128);
    ImageBuf cached("s.exr", 0, 0, OIIO::ImageCache::create(true));
    ASSERT_TRUE(cached.read(0, 0, false));
    run("truncate -s 2000 s.exr");
    ImageBuf dst;
    EXPECT_FALSE(reproject(dst, cached, options({{"size", "90x70"}})));
    EXPECT_THAT(dst.geterror(), HasSubstr("s.exr"));
    for (const std::byte b : bytes(dst)) ASSERT_EQ(b, std::byte{0});
}

TEST_F(Ops, OtherPixelTypesGoThroughFloat) {
    for (const TypeDesc type : {TypeDesc::INT16, TypeDesc::UINT32, TypeDesc::DOUBLE}) {
        const ImageBuf source = panorama(256, 128, type);
        ImageBuf dst(ImageSpec(64, 64, 3, type));
        ASSERT_TRUE(reproject(dst, source)) << dst.geterror();
        const ImageBuf expected = reproject(panorama(256, 128), options({{"size", "64x64"}}));
        const auto result = OIIO::ImageBufAlgo::compare(dst, expected, 2e-4f, 2e-4f);
        EXPECT_EQ(result.nfail, 0u) << type.c_str() << " " << result.maxerror;
    }
}

TEST_F(Ops, ErrorsAreOneLineOfTheDestination) {
    const ImageBuf source = panorama(256, 128);
    const auto refuses = [&](const ParamValueList& o, const char* part, const ImageBuf& from) {
        ImageBuf dst;
        EXPECT_FALSE(reproject(dst, from, o));
        const std::string error = dst.geterror();
        EXPECT_THAT(error, AllOf(HasSubstr("reproject: "), HasSubstr(part), Not(HasSubstr("\n"))));
        EXPECT_TRUE(reproject(from, o).has_error());
    };
    refuses(options({{"fov", "200"}}), "fov=200", source);
    refuses(options({{"jaw", "2"}}), "jaw=2: there is no such parameter", source);
    refuses(options({{"src", "x.exr"}}), "src=x.exr: must be given in recipes only", source);
    refuses(options({{"tile", "64"}}), "tile=64", source);
    refuses(options({{"size", "1048576"}}), "limits:imagesize_MB", source);
    refuses(options({}), "not initialised", ImageBuf());
    refuses(options({}), "from is not given", ImageBuf(ImageSpec(100, 70, 3, TypeDesc::FLOAT)));
    refuses(options({}), "volume", ImageBuf([] {
                ImageSpec spec(8, 4, 1, TypeDesc::FLOAT);
                spec.depth = spec.full_depth = 3;
                return spec;
            }()));
    ImageBuf deep([] {
        ImageSpec spec(8, 4, 1, TypeDesc::FLOAT);
        spec.deep = true;
        return spec;
    }());
    refuses(options({}), "deep", deep);
}

TEST_F(Ops, MetadataThatHoldsIsKept) {
    ImageBuf source = panorama(256, 128);
    source.specmod().attribute("Artist", "somebody");
    source.specmod().attribute("GPano:ProjectionType", "equirectangular");
    source.specmod().attribute("textureformat", "LatLong Environment");
    source.specmod().attribute("oiio:ColorSpace", "sRGB");
    source.specmod().attribute("Orientation", 6);
    const ImageSpec spec = reproject(source, options({{"size", "64"}, {"tol", "0.02"}})).spec();
    EXPECT_EQ(spec.get_string_attribute("Artist"), "somebody");
    EXPECT_EQ(spec.get_string_attribute("oiio:ColorSpace"), "sRGB");
    EXPECT_FALSE(spec.find_attribute("GPano:ProjectionType"));
    EXPECT_FALSE(spec.find_attribute("textureformat"));
    EXPECT_EQ(spec.get_int_attribute("Orientation"), 1);
    EXPECT_FLOAT_EQ(spec.get_float_attribute("anamorph:tol"), 0.02f);
    EXPECT_LE(spec.get_float_attribute("anamorph:max_error", 9), 0.02f);
    EXPECT_GE(spec.get_float_attribute("anamorph:exact_fraction", -1), 0.0f);
    // What an image says of itself.
    ImageBuf square = panorama(128, 128);
    square.specmod().attribute("GPano:ProjectionType", "fisheye");
    EXPECT_FALSE(reproject(square, options({{"size", "8"}})).has_error());
    square.specmod().attribute("GPano:ProjectionType", "unknown");
    EXPECT_TRUE(reproject(square, options({{"size", "8"}})).has_error());
    // Maps have their own channels and no colour.
    const ImageSpec map = reproject(source, options({{"size", "64"}, {"output", "stmap"}})).spec();
    EXPECT_EQ(map.channelnames, (std::vector<std::string>{"R", "G"}));
    EXPECT_FALSE(map.find_attribute("oiio:ColorSpace"));
    EXPECT_EQ(reproject(source, options({{"size", "64"}, {"output", "bound"}})).nchannels(), 1);
}

TEST_F(Ops, ACroppedPanoramaStandsWhereGPanoSays) {
    const ImageBuf whole = panorama(256, 128);
    ImageBuf part = OIIO::ImageBufAlgo::cut(whole, ROI(60, 190, 30, 90));
    for (const auto& [key, value] : {std::pair{"FullPanoWidthPixels", 256},
                                     {"FullPanoHeightPixels", 128},
                                     {"CroppedAreaImageWidthPixels", 130},
                                     {"CroppedAreaImageHeightPixels", 60},
                                     {"CroppedAreaLeftPixels", 60},
                                     {"CroppedAreaTopPixels", 30}})
        part.specmod().attribute(std::string("GPano:") + key, value);
    const ParamValueList o = options({{"size", "64"}, {"fov", "30"}, {"yaw", "10"}, {"tol", "1e-6"}});
    const auto difference =
        OIIO::ImageBufAlgo::compare(reproject(part, o), reproject(whole, o), 2e-5f, 2e-5f);
    EXPECT_FALSE(difference.error) << difference.maxerror;
}

TEST_F(Ops, UnassociatedAlphaIsMultipliedForFiltering) {
    // Red where there is cover, green where there is none: no green may come through.
    ImageSpec spec(256, 128, 4, TypeDesc::FLOAT);
    spec.alpha_channel = 3;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    ImageBuf source(spec);
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) {
            const bool cover = (x / 3 + y / 3) % 2 == 0;
            const float pixel[] = {cover ? 1.0f : 0.0f, cover ? 0.0f : 1.0f, 0, cover ? 1.0f : 0.0f};
            source.setpixel(x, y, pixel);
        }
    for (const char* size : {"300x300", "20x20"}) {
        const ImageBuf view = reproject(source, options({{"size", size}, {"yaw", "20"}}));
        for (ImageBuf::ConstIterator<float> p(view); !p.done(); ++p) {
            ASSERT_NEAR(p[1] * p[3], 0, 1e-5);
            if (p[3] > 1e-3f) {
                ASSERT_NEAR(p[0], 1, 1e-3);
            }
        }
    }
}

TEST_F(Ops, FiltersInTheColorSpaceAskedFor) {
    ImageBuf source = panorama(256, 128);
    source.specmod().attribute("oiio:ColorSpace", "sRGB");
    const ParamValueList plain = options({{"size", "20x20"}}),
                         linear = options({{"size", "20x20"}, {"colorspace", "scene_linear"}});
    const ImageBuf made = reproject(source, linear);
    ASSERT_FALSE(made.has_error()) << made.geterror();
    EXPECT_EQ(made.spec().get_string_attribute("oiio:ColorSpace"), "sRGB");
    // The long way round: convert the whole image, draw, convert back.
    const ImageBuf converted = OIIO::ImageBufAlgo::colorconvert(source, "sRGB", "linear");
    const ImageBuf expected = OIIO::ImageBufAlgo::colorconvert(reproject(converted, plain), "linear", "sRGB");
    const auto same = OIIO::ImageBufAlgo::compare(made, expected, 1e-4f, 1e-4f);
    EXPECT_EQ(same.nfail, 0u) << same.maxerror;
    const auto different = OIIO::ImageBufAlgo::compare(made, reproject(source, plain), 1e-3f, 1e-3f);
    EXPECT_GT(different.nfail, 40u) << "filtering in another space makes a difference where the map minifies";
    // The recipe agrees.
    source.specmod().attribute("oiio:ColorSpace", "sRGB");
    write_image(source, "s.tif");
    write_image(reproject(ImageBuf("s.tif"), linear), "view.tif");
    // (Also after a map of the same source, which has no colour to convert.)
    read_pixels("s.tif.pano?size=20x20&colorspace=scene_linear&output=stmap");
    EXPECT_EQ(read_pixels("view.tif").bytes,
              read_pixels("s.tif.pano?size=20x20&colorspace=scene_linear").bytes);
    // What is refused is not among what is allowed.
    const std::string error = reproject(source, options({{"colorspace", "Rec709"}})).geterror();
    EXPECT_THAT(error, HasSubstr("colorspace=Rec709: no way to it from \"sRGB\""));
    EXPECT_THAT(error.substr(error.find("one of")), Not(HasSubstr("Rec709")));
    // An image that does not say its own.
    ImageBuf untagged = panorama(256, 128);
    untagged.specmod().erase_attribute("oiio:ColorSpace");
    EXPECT_THAT(reproject(untagged, linear).geterror(),
                HasSubstr("colorspace=scene_linear: the source does not say"));
}

TEST(PoolWorker, CountsWhileItLivesAndInEveryThreadThatHelps) {
    const auto is_worker = [] { return OIIO::default_thread_pool()->is_worker(std::this_thread::get_id()); };
    EXPECT_FALSE(is_worker());
    {
        const PoolWorker worker;
        { const PoolWorker again; }
        EXPECT_TRUE(is_worker());
    }
    EXPECT_FALSE(is_worker());
    OIIO::thread_pool own(3);
    const ParallelFor loop = parallel_for_on(own, 4);
    const auto me = std::this_thread::get_id();
    std::atomic<int> helped{0}, not_counted{0};
    // On a busy machine they help late.
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (helped == 0 && std::chrono::steady_clock::now() < end)
        loop(16, [&](std::int64_t) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            if (std::this_thread::get_id() == me) return;
            ++helped;
            if (!is_worker()) ++not_counted;
        });
    EXPECT_GT(helped, 0);
    EXPECT_EQ(not_counted, 0);
}

TEST(ParallelFor, RunsEachIndexOnceAndNests) {
    OIIO::thread_pool pool(3);
    const ParallelFor loop = parallel_for_on(pool, 4);
    for (const int count : {0, 1, 2, 100, 5000}) {
        std::vector<std::atomic<int>> seen(static_cast<std::size_t>(count));
        loop(count, [&](std::int64_t i) { ++seen[static_cast<std::size_t>(i)]; });
        for (const auto& n : seen) ASSERT_EQ(n, 1);
    }
    std::atomic<int> sum{0};
    loop(20, [&](std::int64_t) { loop(20, [&](std::int64_t) { loop(5, [&](std::int64_t) { ++sum; }); }); });
    EXPECT_EQ(sum, 2000);
    EXPECT_THROW(loop(100,
                      [](std::int64_t i) {
                          if (i == 50) throw Error("stop");
                      }),
                 Error);
}

}  // namespace
}  // namespace anamorph::test_ops
