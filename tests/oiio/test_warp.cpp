// SPDX-License-Identifier: Apache-2.0
// Mesh warps: recipes and the function, that they agree, what they read and what they refuse.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_warp {
namespace {

using namespace testing_oiio;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ParamValueList;
using OIIO::TypeDesc;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

/// Three cells by two, its inner vertices moved, for a picture and a source of 192 x 128.
const std::string kMesh = R"({"columns": 3, "rows": 2, "vertices": [
    [0, 0], [64, 0], [128, 0], [192, 0],
    [0, 64], [76.5, 53], [119, 80.25], [192, 64],
    [0, 128], [64, 128], [128, 128], [192, 128]]})";
/// The same moved so far that it folds.
const std::string kFolded = R"({"columns": 3, "rows": 2, "vertices": [
    [0, 0], [64, 0], [128, 0], [192, 0],
    [0, 64], [150, 64], [40, 64], [192, 64],
    [0, 128], [64, 128], [128, 128], [192, 128]]})";
const std::string kPoints =
    "x,y,u,v\n0,0,0,0\n192,0,192,0\n0,128,0,128\n192,128,192,128\n90,60,100,70\n40,90,35,80\n";

class Warp : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("city.exr", 192, 128);
        write_text("grid.json", kMesh);
        write_text("folded.json", kFolded);
        write_text("points.csv", kPoints);
    }
};

ImageBuf read(const std::string& name) {
    ImageBuf image(name);
    EXPECT_TRUE(image.read(0, 0, true)) << image.geterror();
    return image;
}

TEST_F(Warp, TheRecipeIsTheCall) {
    read_pixels("city.exr.warp?mesh=grid.json&output=stmap&size=24x16");  // an ST-map to read back
    const Ran made = run("oiiotool 'city.exr.warp?mesh=grid.json&output=stmap&size=24x16' -o st.exr");
    ASSERT_EQ(made.status, 0) << made.text;
    for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::UINT16, TypeDesc::HALF, TypeDesc::FLOAT})
        for (const auto& [key, value] :
             {std::pair{"mesh", "grid.json"}, {"mesh", "st.exr"}, {"points", "points.csv"}}) {
            SCOPED_TRACE(std::string(type.c_str()) + " " + value);
            const bool integer = type == TypeDesc::UINT8 || type == TypeDesc::UINT16;
            const std::string name = integer ? "s.tif" : "s.exr";
            write_panorama(name, 192, 128, type, 4);
            const ImageBuf source = read(name);
            ASSERT_EQ(source.spec().format, type);
            const ImageBuf call =
                mesh_warp(source, options({{key, value}, {"amount", "0.7"}, {"size", "150x90"}}));
            const Pixels recipe = read_pixels(name + ".warp?size=150x90&amount=0.7&" + key + "=" + value);
            EXPECT_EQ(bytes(call), recipe.bytes);
            EXPECT_NE(recipe.bytes,
                      read_pixels(name + ".warp?size=150x90&amount=0&" + key + "=" + value).bytes);
            EXPECT_EQ(call.spec().get_float_attribute("anamorph:max_error", -1),
                      recipe.spec.get_float_attribute("anamorph:max_error", -2));
        }
}

TEST_F(Warp, AmountZeroIsTheSource) {
    for (const char* shape :
         {"mesh=grid.json", "mesh=folded.json", "points=points.csv", "mesh=grid.json&direction=push"}) {
        const std::string name = std::string("city.exr.warp?amount=0&") + shape;
        EXPECT_TRUE(read_pixels(name + "&tol=0").bytes == read_pixels("city.exr").bytes) << shape;
        EXPECT_LT(largest_difference(read_floats(name), read_floats("city.exr")), 1e-5) << shape;
    }
}

TEST_F(Warp, TilesThreadsAndCropsNeverChangePixels) {
    for (const char* arguments :
         {"mesh=grid.json&size=300x200", "mesh=grid.json&direction=push", "points=points.csv&size=150x200",
          "mesh=folded.json&filter=bicubic&scheme=hermite", "mesh=grid.json&scheme=residual",
          "mesh=grid.json&tol=0", "mesh=folded.json&direction=push&output=folds"})
        expect_one_picture(std::string("city.exr.warp?") + arguments, 70, 50);
}

TEST_F(Warp, WhatWasReachedIsTold) {
    for (const char* tol : {"1", "0.25", "0.0625", "0.015625", "0"}) {
        SCOPED_TRACE(tol);
        const ImageSpec spec = read_pixels(std::string("city.exr.warp?mesh=grid.json&tol=") + tol).spec;
        const float limit = std::stof(tol);
        EXPECT_EQ(spec.get_float_attribute("anamorph:tol", -1), limit);
        // With tol=0, what double rounds.
        const float allowed = std::max(limit, 1e-9f);
        EXPECT_LE(spec.get_float_attribute("anamorph:max_error", 99), allowed);
        EXPECT_EQ(spec.get_float_attribute("anamorph:folded_fraction", -1), 0.0f);
        EXPECT_GE(spec.get_float_attribute("anamorph:exact_fraction", -1), limit == 0 ? 1.0f : 0.0f);
        // And it is so, at every pixel.
        const std::string map = std::string("city.exr.warp?mesh=grid.json&tol=") + tol + "&output=";
        const std::vector<float> error = read_floats(map + "error"), bound = read_floats(map + "bound");
        for (std::size_t i = 0; i < error.size(); ++i) ASSERT_LE(error[i], bound[i] + 1e-6f) << i;
        EXPECT_LE(*std::max_element(bound.begin(), bound.end()), allowed);
    }
    for (const char* direction : {"pull", "push"}) {
        const Pixels folds =
            read_pixels(std::string("city.exr.warp?mesh=folded.json&output=folds&direction=") + direction);
        EXPECT_EQ(folds.spec.nchannels, 1);
        const std::vector<float> values =
            read_floats(std::string("city.exr.warp?mesh=folded.json&output=folds&direction=") + direction);
        const auto folded = std::count_if(values.begin(), values.end(), [](float v) { return v != 0; });
        EXPECT_GT(folded, 100) << direction;
        EXPECT_NEAR(folds.spec.get_float_attribute("anamorph:folded_fraction"),
                    double(folded) / double(values.size()), 1e-4);
    }
}

TEST_F(Warp, AnStMapIsAMesh) {
    // A view's source map, every pixel of it, draws that view again.
    const std::string view = "pano?from=latlong&size=192x128&fov=50&yaw=20&filter=bilinear&tol=0";
    const Ran map = run("oiiotool 'city.exr." + view + "&output=stmap' -o st.exr");
    ASSERT_EQ(map.status, 0) << map.text;
    const std::vector<float> drawn = read_floats("city.exr." + view);
    const std::string warp = "city.exr.warp?filter=bilinear&size=192x128&";
    EXPECT_LT(largest_difference(read_floats(warp + "mesh=st.exr"), drawn), 1e-3);
    EXPECT_LT(largest_difference(read_floats(warp + "mesh=st.exr&step=4"), drawn), 0.05);
    // The map need not be written first.
    EXPECT_EQ(read_floats(warp + "mesh=city.exr." + view + "&output=stmap"),
              read_floats(warp + "mesh=st.exr"));
    EXPECT_EQ(
        read_floats("city.exr.warp?mesh=(city.exr." + view + "&output=stmap)&filter=bilinear&size=192x128"),
        read_floats(warp + "mesh=st.exr"));
    // Nor written at all, from an image in memory.
    const Ran memory = run("oiiotool st.exr -o M.anabuf --pop '" + warp + "mesh=M.anabuf' -o out.exr");
    EXPECT_EQ(memory.status, 0) << memory.text;
    EXPECT_EQ(read_floats("out.exr"), read_floats(warp + "mesh=st.exr"));
}

TEST_F(Warp, AnStMapSaysHowLargeThePictureIs) {
    const Ran map = run("oiiotool 'city.exr.warp?mesh=grid.json&size=80x50&output=stmap' -o st.exr");
    ASSERT_EQ(map.status, 0) << map.text;
    const auto size_of = [](const std::string& name) {
        const ImageSpec spec = read(name).spec();
        return std::pair(spec.width, spec.height);
    };
    EXPECT_EQ(size_of("city.exr.warp?mesh=st.exr"), std::pair(80, 50));
    EXPECT_EQ(size_of("city.exr.warp?mesh=st.exr&size=40"), std::pair(40, 25));
    EXPECT_EQ(size_of("city.exr.warp?mesh=st.exr&size=30x7"), std::pair(30, 7));
    // What pushes lies in the source.
    EXPECT_EQ(size_of("city.exr.warp?mesh=st.exr&direction=push"), std::pair(192, 128));
    EXPECT_EQ(size_of("city.exr.warp?mesh=grid.json"), std::pair(192, 128));
}

// An ST-map with windows draws a picture with the same ones.
TEST_F(Warp, AnStMapHasWindows) {
    ASSERT_EQ(
        run("oiiotool 'city.exr.lens?lens=3de4:k1=-0.15&output=stmap&size=all&mode=distort' -o more.exr "
            "'city.exr.lens?lens=3de4:k1=-0.15&output=stmap' -o all.exr --cut 100x60+40+30 -o none.exr")
            .status,
        0);
    const ImageSpec more = read("more.exr").spec();
    ASSERT_LT(more.x, 0);
    const OIIO::ImageBuf drawn = read("city.exr.warp?mesh=more.exr"),
                         lens = read("city.exr.lens?lens=3de4:k1=-0.15&size=all&mode=distort");
    EXPECT_EQ(drawn.roi(), lens.roi());
    EXPECT_EQ(drawn.roi_full(), lens.roi_full());
    EXPECT_LT(OIIO::ImageBufAlgo::compare(drawn, lens, 1e-3f, 1e-3f).maxerror, 1e-3);
    // A cropped one.
    OIIO::ImageBuf crop = OIIO::ImageBufAlgo::crop(read("all.exr"), OIIO::ROI(40, 140, 30, 90));
    write_image(crop, "part.exr");
    const OIIO::ImageBuf part = read("city.exr.warp?mesh=part.exr"),
                         whole = read("city.exr.warp?mesh=all.exr");
    EXPECT_EQ(part.roi(), OIIO::ROI(40, 140, 30, 90, 0, 1, 0, 3));
    EXPECT_EQ(part.roi_full(), whole.roi_full());
    for (int y = 32; y < 88; ++y)
        for (int x = 42; x < 138; ++x)
            ASSERT_NEAR(part.getchannel(x, y, 0, 1), whole.getchannel(x, y, 0, 1), 5e-3);
    EXPECT_THAT(open_error("city.exr.warp?mesh=part.exr&direction=push"),
                HasSubstr("direction=push: must be pull"));
    EXPECT_THAT(open_error("city.exr.warp?mesh=part.exr&amount=0.5"), HasSubstr("amount=0.5: must be 1"));
    EXPECT_THAT(open_error("city.exr.warp?mesh=part.exr&size=64"),
                HasSubstr("must be 192x128 of an ST-map of 100x60"));
    EXPECT_EQ(read_pixels("city.exr.warp?mesh=part.exr&size=192x128").bytes,
              read_pixels("city.exr.warp?mesh=part.exr").bytes);
    // Coarser windows would not lie on pixels.
    for (const char* recipe : {"city.exr.warp?mesh=more.exr&mip=1",
                               "city.exr.lens?lens=3de4:k1=-0.15&size=all&mode=distort&mip=1"})
        EXPECT_EQ(open(recipe)->spec(0, 1).format, OIIO::TypeUnknown);
}

TEST_F(Warp, VMayGoUp) {
    ASSERT_EQ(run("oiiotool 'city.exr.warp?mesh=grid.json&output=stmap' -o down.exr "
                  "'city.exr.warp?mesh=grid.json&output=stmap&flip_v=1' -o up.exr")
                  .status,
              0);
    const std::vector<float> down = read_floats("down.exr"), up = read_floats("up.exr");
    for (std::size_t i = 0; i < down.size(); i += 2) {
        ASSERT_EQ(up[i], down[i]);
        ASSERT_NEAR(up[i + 1], 1 - down[i + 1], 1e-6);
    }
    EXPECT_LT(largest_difference(read_floats("city.exr.warp?mesh=up.exr&flip_v=1"),
                                 read_floats("city.exr.warp?mesh=down.exr")),
              1e-4);
    EXPECT_LT(largest_difference(read_floats("city.exr.warp?mesh=up.exr&flip_v=1&step=5"),
                                 read_floats("city.exr.warp?mesh=down.exr&step=5")),
              1e-3);
    // Read and written in one.
    EXPECT_LT(largest_difference(read_floats("city.exr.warp?mesh=up.exr&flip_v=1&output=stmap"), up), 1e-6);
}

TEST_F(Warp, PixelsOfAnStMapMayComeFromNowhere) {
    OIIO::ImageBuf map = read("city.exr.warp?mesh=grid.json&output=stmap");
    const OIIO::ImageBuf whole = read("city.exr.warp?mesh=grid.json");
    ImageSpec spec(map.spec().width, map.spec().height, 4, OIIO::TypeFloat);
    spec.alpha_channel = 3;
    OIIO::ImageBuf holes(spec);
    const auto is_hole = [](int x, int y) { return (x > 50 && x < 80 && y > 20 && y < 60) || x == 7 * y; };
    for (int y = 0; y < spec.height; ++y)
        for (int x = 0; x < spec.width; ++x) {
            const bool nan = is_hole(x, y) && x % 2 == 0;
            const float value[] = {nan ? NAN : map.getchannel(x, y, 0, 0), map.getchannel(x, y, 0, 1), 0.5f,
                                   is_hole(x, y) && !nan ? 0.0f : 1.0f};
            holes.setpixel(x, y, value);
        }
    write_image(holes, "holes.exr");
    for (const char* filter : {"bilinear", "antialias"}) {
        const OIIO::ImageBuf drawn = read(std::string("city.exr.warp?mesh=holes.exr&filter=") + filter),
                             full = read(std::string("city.exr.warp?mesh=grid.json&filter=") + filter);
        for (int y = 0; y < spec.height; ++y)
            for (int x = 0; x < spec.width; ++x) {
                const float value = drawn.getchannel(x, y, 0, 1);
                if (is_hole(x, y)) {
                    ASSERT_EQ(value, 0) << x << " " << y;
                } else if (filter[0] == 'b') {
                    ASSERT_NEAR(value, full.getchannel(x, y, 0, 1), 2e-3);
                }
            }
    }
    // Alpha that is not multiplied in says no more than that.
    ASSERT_EQ(
        run("oiiotool city.exr.warp?mesh=grid.json\\&output=stmap -o down.exr down.exr --ch R,G,B=0.5,A=0.5 "
            "--attrib oiio:UnassociatedAlpha 1 -d float -o half.tif")
            .status,
        0);
    EXPECT_LT(largest_difference(read_floats("city.exr.warp?mesh=half.tif"),
                                 read_floats("city.exr.warp?mesh=down.exr")),
              1e-3);
    // Levels would have to know more.
    EXPECT_EQ(open("city.exr.warp?mesh=holes.exr&mip=1")->spec(0, 1).format, OIIO::TypeUnknown);
    EXPECT_THAT(open_error("city.exr.warp?mesh=holes.exr&size=96"), HasSubstr("in its own size, 192x128"));
    EXPECT_THAT(open_error("city.exr.warp?mesh=holes.exr&step=3"), HasSubstr("must be finite numbers"));
    EXPECT_THAT(open_error("city.exr.warp?mesh=holes.exr&scheme=hardware"),
                HasSubstr("scheme=hardware: must be another for holes.exr"));
}

TEST_F(Warp, FilesStandWhereTheRecipeStands) {
    const Pixels expected = read_pixels("city.exr.warp?mesh=grid.json");
    fs::create_directories("shots/meshes");
    fs::copy_file("city.exr", "shots/city.exr");
    fs::copy_file("grid.json", "shots/meshes/g.json");
    write_text("shots/v.warp", "src=city.exr\nmesh=meshes/g.json\n");
    EXPECT_EQ(read_pixels("shots/v.warp"), expected);
    EXPECT_EQ(read_pixels("./shots/v.warp?mesh=grid.json"), expected) << "in a name, from the working folder";
    EXPECT_EQ(read_pixels(fs::current_path().string() + "/shots/v.warp"), expected);
    const Ran tool =
        run("cd shots && oiiotool v.warp -o ../v.exr && cd / && oiiotool " + fs::current_path().string() +
            "/shots/v.warp -o " + fs::current_path().string() + "/w.exr");
    EXPECT_EQ(tool.status, 0) << tool.text;
    EXPECT_EQ(read_pixels("v.exr").bytes, expected.bytes);
    EXPECT_EQ(read_pixels("w.exr").bytes, expected.bytes);
}

TEST_F(Warp, AnEditedMeshIsSeen) {
    write_text("g.json", kMesh);
    write_text("w.warp", "src=city.exr\nmesh=g.json\n");
    const std::string outer = "x.pano?size=64&fov=60&from=rectilinear&src=w.warp";
    const Pixels first = read_pixels("w.warp"), first_outer = read_pixels(outer);
    // As many bytes as before.
    std::string edited = kMesh;
    edited.replace(edited.find("76.5, 53"), 8, "56.5, 73");
    write_text("g.json", edited);
    const Pixels second = read_pixels("w.warp"), second_outer = read_pixels(outer);
    EXPECT_NE(second.bytes, first.bytes);
    EXPECT_NE(second_outer.bytes, first_outer.bytes);
    EXPECT_EQ(second.bytes, bytes(mesh_warp(read("city.exr"), options({{"mesh", "g.json"}}))));
    write_text("g.json", kMesh);
    EXPECT_EQ(read_pixels("w.warp"), first);
    EXPECT_EQ(read_pixels(outer), first_outer);
    // An ST-map too, and what that is made of.
    const auto write_map = [](const char* view) {
        const Ran ran = run(std::string("oiiotool 'city.exr.warp?output=stmap&mesh=") + view + "' -o st.exr");
        EXPECT_EQ(ran.status, 0) << ran.text;
    };
    write_map("grid.json");
    const Pixels one = read_pixels("city.exr.warp?mesh=st.exr");
    write_map("folded.json");
    EXPECT_NE(read_pixels("city.exr.warp?mesh=st.exr").bytes, one.bytes);
    write_map("grid.json");
    EXPECT_EQ(read_pixels("city.exr.warp?mesh=st.exr"), one);
}

/// The mean of each block of `size` x `size` pixels.
std::vector<float> block_means(const ImageBuf& image, int size) {
    const int width = image.spec().width / size, height = image.spec().height / size,
              channels = image.nchannels();
    std::vector<float> means;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < channels; ++c) {
                double sum = 0;
                for (int j = 0; j < size; ++j)
                    for (int i = 0; i < size; ++i)
                        sum += double(image.getchannel(x * size + i, y * size + j, 0, c));
                means.push_back(static_cast<float>(sum / (size * size)));
            }
    return means;
}

TEST_F(Warp, Levels) {
    // Positions in pixels are those of the finest level.
    for (const char* shape : {"mesh=grid.json", "mesh=grid.json&direction=push", "points=points.csv"}) {
        SCOPED_TRACE(shape);
        const std::string name = std::string("city.exr.warp?mip=1&") + shape;
        const ImageBuf whole = read(name);
        for (int level = 1; level < 3; ++level) {
            const Pixels pixels = read_pixels(name, level);
            EXPECT_EQ(pixels.spec.width, 192 >> level);
            EXPECT_EQ(pixels.spec.height, 128 >> level);
            const std::vector<float> expected = block_means(whole, 1 << level);
            const std::vector<float> own = read_floats(name, level);
            ASSERT_EQ(own.size(), expected.size());
            double sum = 0;
            for (std::size_t i = 0; i < own.size(); ++i) sum += std::fabs(own[i] - expected[i]);
            // The picture's detail has amplitude 0.35.
            EXPECT_LT(sum / double(own.size()), 0.02) << level;
        }
    }
}

TEST_F(Warp, RecipesOfAllKindsNest) {
    write_text("l.csv", "50,30,60,90,60,30,70,95\n");
    write_text("m.morph", "a=city.exr\nb=city.exr.warp?mesh=grid.json\nfeatures=l.csv\nt=0.4\n");
    write_text("p.pano", "src=m.morph\nfrom=rectilinear\nsrcfov=90\nsize=160x100\n");
    write_text("w.warp", "src=p.pano\nmesh=st.warp\n");
    write_text("st.warp", "src=city.exr\nmesh=grid.json\noutput=stmap\n");
    const Ran ran =
        run("oiiotool w.warp -o w.exr m.morph -o m.exr m.exr -o p0.exr && oiiotool "
            "'m.exr.pano?from=rectilinear&srcfov=90&size=160x100' -o p.exr && oiiotool "
            "st.warp -o st.exr && oiiotool 'p.exr.warp?mesh=st.exr' -o step_by_step.exr");
    ASSERT_EQ(ran.status, 0) << ran.text;
    EXPECT_EQ(read_pixels("w.exr").bytes, read_pixels("step_by_step.exr").bytes);
    // Through the cache, from the middle of other reads, with little memory.
    const auto cache = OIIO::ImageCache::create(true);
    cache->invalidate_all(true);
    std::vector<float> pixels(192 * 128 * 3);  // the ST-map's size
    ASSERT_TRUE(cache->get_pixels(OIIO::ustring("w.warp"), 0, 0, 0, 192, 0, 128, 0, 1, OIIO::TypeFloat,
                                  pixels.data()))
        << cache->geterror();
    EXPECT_EQ(pixels, read_floats("w.exr"));
    // Cycles over any key.
    write_text("st.warp", "src=city.exr\nmesh=w.warp\noutput=stmap\n");
    EXPECT_THAT(open_error("w.warp"), HasSubstr("recipes read each other: w.warp -> st.warp -> w.warp"));
    write_text("st.warp", "src=w.warp\nmesh=grid.json\n");
    EXPECT_THAT(open_error("p.pano?src=w.warp"), HasSubstr("recipes read each other"));
    write_text("m.morph", "a=city.exr\nb=m.morph\nfeatures=l.csv\n");
    EXPECT_THAT(open_error("m.morph"), HasSubstr("m.morph -> m.morph"));
    // Twice the same, sixteen deep: not two to the sixteenth.
    std::string below = "city.exr";
    for (const char letter : std::string("abcdefghijklmn")) {
        const std::string name = std::string(1, letter) + ".morph";
        write_text(name, "a=" + below + "\nb=" + below + "\nfeatures=l.csv\nsize=8x8\n");
        below = name;
    }
    EXPECT_EQ(read_floats("n.morph").size(), 8u * 8 * 3);
}

/// A negative of the mean of a pixel and the one above it, by the stock program, in every type and number of channels.
TEST_F(Warp, ProgramsOfTheUsersRunInOiiotool) {
    write_text("negative.ps",
               "ps_2_0\ndef c0, 1, 1, 1, 1\ndef c1, 0.5, 0, 0, 0\ndcl t0.xy\ndcl_2d s0\n"
               "mov r1.x, c1.y\nmov r1.y, -c8.w         ; a pixel up\nadd r1.xy, t0, r1\n"
               "texld r2, t0, s0\ntexld r3, r1, s0\nadd r2, r2, r3\nmad r2, -r2, c1.x, c0\nmov oC0, r2\n");
    for (const auto& [name, type, channels] : {std::tuple{"grey.tif", TypeDesc::UINT8, 1},
                                               {"rgb.exr", TypeDesc::FLOAT, 3},
                                               {"rgba.tif", TypeDesc::UINT16, 4}}) {
        SCOPED_TRACE(name);
        write_panorama(name, 96, 64, type, channels);
        // A name of its own: the host's cache keeps what was written in the same second.
        const std::string drawn = std::string(name) + ".negative.exr";
        const Ran made =
            run("oiiotool '" + std::string(name) +
                ".warp?scheme=hardware&wrap=clamp&filter=bilinear&program=negative.ps' -o " + drawn);
        ASSERT_EQ(made.status, 0) << made.text;
        const ImageBuf source = read(name), out = read(drawn);
        ASSERT_EQ(out.nchannels(), channels);
        // A level of the source's type, and two units of float24 of numbers up to the picture's.
        const double near = type == TypeDesc::UINT8 ? 0.004 : 0.001;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 96; ++x)
                for (int c = 0; c < channels; ++c) {
                    const double mean = 0.5 * (source.getchannel(x, y, 0, c) +
                                               source.getchannel(x, std::max(y - 1, 0), 0, c));
                    const double wanted = type == TypeDesc::FLOAT ? 1 - mean : std::clamp(1 - mean, 0.0, 1.0);
                    ASSERT_NEAR(out.getchannel(x, y, 0, c), wanted, near) << x << " " << y;
                }
    }
}

/// Their largest error is that of all pixels, which would take minutes.
TEST_F(Warp, RecipesOfMachinesOpenWithoutComputingTheirPixels) {
    const auto input =
        OIIO::ImageInput::open("city.exr.warp?scheme=hardware&mesh=grid.json&size=16384&tile=64");
    ASSERT_TRUE(input) << OIIO::geterror();
    EXPECT_EQ(input->spec().find_attribute("anamorph:max_error"), nullptr);
    EXPECT_EQ(input->spec().find_attribute("anamorph:tol"), nullptr);
    std::vector<float> tile(static_cast<std::size_t>(64 * 64 * input->spec().nchannels));
    EXPECT_TRUE(input->read_tile(64, 64, 0, OIIO::TypeFloat, tile.data())) << input->geterror();
}

TEST_F(Warp, WhatFailsSaysWhyInALine) {
    write_text("short.json", R"({"columns": 2, "rows": 1, "vertices": [[0, 0], [1, 1]]})");
    write_text("cut.json", kMesh.substr(0, kMesh.size() / 2));
    write_text("nan.json", R"({"columns": 1, "rows": 1, "vertices": [[0, 0], [1, 1], [NaN, 2], [3, 3]]})");
    write_text("text.json", R"({"columns": 1, "rows": 1, "vertices": [[0, 0], ["a", 1], [1, 2], [3, 3]]})");
    write_text("empty.json", "");
    write_text("twice.json", R"({"columns": 1, "rows": 1, "rows": 2})");
    write_text("bad.ps", "ps_2_0\n; a comment\nfrob r0\n");
    write_text("good.ps", "ps_2_0\nmov oC0, c0\n");
    write_text("bad.csv", "x,y,u,v\n1,2,3\n");
    write_text("huge.json", "{");
    fs::resize_file("huge.json", 100 << 20);
    fs::create_directory("folder.json");
    write_panorama("one.exr", 16, 16, OIIO::TypeFloat, 1);
    write_text("self.warp", "src=self.warp\nmesh=grid.json\n");
    const std::pair<std::string, std::string> failing[] = {
        {"city.exr.warp", "mesh is not given"},
        {"city.exr.warp?mesh=none.json", "none.json\" does not exist"},
        {"city.exr.warp?mesh=none.exr", "none.exr"},
        {"city.exr.warp?mesh=twice.json", "twice.json: \"rows\" is given twice"},
        {"city.exr.warp?scheme=hardware&program=none.ps", "none.ps\" does not exist"},
        {"city.exr.warp?scheme=hardware&program=.", "program=.: is not a file but a folder"},
        {"city.exr.warp?scheme=hardware&program=bad.ps", "bad.ps: line 3: \"frob\": no such instruction"},
        {"city.exr.warp?scheme=hardware&program=good.ps&output=error", "output=error: must be color"},
        {"city.exr.warp?scheme=exact&mesh=grid.json&program=good.ps", "must be given with scheme=hardware"},
        {"city.exr.warp?scheme=hardware&mesh=grid.json&machine=kim-2003:alpha=2",
         "alpha=2: must be a number"},
        {"city.exr.warp?points=none.csv", "none.csv\" does not exist"},
        {"city.exr.warp?mesh=grid.json&points=points.csv", "must not be given together with mesh"},
        {"city.exr.warp?mesh=grid.json&step=2", "step=2: must be given with ST-maps only"},
        {"city.exr.warp?mesh=one.exr", "has one channel"},
        {"city.exr.warp?mesh=short.json", "short.json"},
        {"city.exr.warp?mesh=cut.json", "cut.json"},
        {"city.exr.warp?mesh=nan.json", "nan.json"},
        {"city.exr.warp?mesh=text.json", "text.json"},
        {"city.exr.warp?mesh=empty.json", "empty.json"},
        {"city.exr.warp?points=bad.csv", "bad.csv"},
        {"city.exr.warp?points=grid.json", "the file holds a mesh"},
        {"city.exr.warp?points=points.csv&direction=push", "direction"},
        {"city.exr.warp?mesh=huge.json", "104857600 bytes"},
        {"city.exr.warp?mesh=folder.json", "is not a file"},
        {"city.exr.warp?mesh=big.null?RES=20000x20000&CHANNELS=3&TYPE=uint8", "20000x20000 pixels"},
        {"city.exr.warp?mesh=grid.json&amount=inf", "amount=inf"},
        {"city.exr.warp?mesh=grid.json&amount=1e300", "amount"},
        {"city.exr.warp?mesh=grid.json&tol=-1", "tol=-1"},
        {"city.exr.warp?mesh=grid.json&size=1048576x1048576", "limits:imagesize_MB"},
        {"city.exr.warp?mesh=grid.json&size=0", "size=0"},
        {"city.exr.warp?mesh=grid.json&yaw=3", "yaw=3: there is no such parameter"},
        {"city.exr.warp?mesh=grid.json&output=lines", "output=lines"},
        {"city.exr.warp?mesh=grid.json&output=mesh&scheme=hardware", "output=mesh: must be another"},
        {"city.exr.warp?mesh=grid.json&machine=ps20",
         "machine=ps20: must be given with scheme=hardware only"},
        {"missing.exr.warp?mesh=grid.json", "missing.exr"},
        {"self.warp", "read each other"},
    };
    for (const auto& [name, reason] : failing) {
        SCOPED_TRACE(name);
        const std::string error = open_error(name);
        EXPECT_THAT(error, AllOf(HasSubstr(reason), Not(HasSubstr("\n"))));
        EXPECT_LT(error.size(), 500u);
    }
    // Through maketx, which opens what exists.
    write_text("bad.warp", "src=city.exr\nmesh=cut.json\n");
    const Ran made = run("maketx bad.warp -o out.tx");
    EXPECT_EQ(made.status, 1) << made.text;
    EXPECT_THAT(made.text, HasSubstr("cut.json"));
    write_text("good.warp", "src=city.exr\nmesh=grid.json\n");
    EXPECT_EQ(run("maketx good.warp -o out.tx").status, 0);
    // The call says the same.
    const ImageBuf source = panorama(192, 128);
    const auto refuses = [&](const ParamValueList& o, const char* part) {
        ImageBuf dst;
        EXPECT_FALSE(mesh_warp(dst, source, o));
        EXPECT_THAT(dst.geterror(), AllOf(HasSubstr("mesh_warp: "), HasSubstr(part), Not(HasSubstr("\n"))));
    };
    refuses(options({}), "mesh is not given");
    refuses(options({{"mesh", "none.json"}}), "none.json");
    refuses(options({{"mesh", "grid.json"}, {"src", "x.exr"}}), "src=x.exr: must be given in recipes only");
    refuses(options({{"mesh", "grid.json"}, {"mip", "1"}}), "mip=1");
}

}  // namespace
}  // namespace anamorph::test_warp
