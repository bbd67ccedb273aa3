// SPDX-License-Identifier: Apache-2.0
// Scripts of figures as films, in stock hosts.
#include <algorithm>
#include <filesystem>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_figure {
namespace {

using namespace testing_oiio;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Figure : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        OIIO::ImageCache::create(true)->invalidate_all(true);
        write_text("parts.n",
                   "figure f 2 a b\nellipsoid a 200 300 100\nellipsoid b 80 90 100\n"
                   "joint j a 0 280 0 b 0 -80 0\n");
        write_text("walk.n",
                   "include parts.n\nrepeat 0 1 moveto f a 500 400 500\n"
                   "linear 0 5 spinby f a a 50 z\nstop\n");
    }
};

TEST_F(Figure, AScriptIsAFilm) {
    for (const char* command :
         {"oiiotool walk.n -o first.png", "oiiotool walk.n --sisplit -o:all=1 f.%04d.png",
          "oiiotool 'walk.n?frame=3&size=512x512&style=shaded' -o third.png",
          "oiiotool 'WALK.n.figure?script=walk.n&frame=3&size=512x512' -o same.png"}) {
        const Ran ran = run(command);
        ASSERT_EQ(ran.status, 0) << command << "\n" << ran.text;
    }
    const Pixels first = read_pixels("first.png");
    EXPECT_EQ(first.spec.width, 1000);
    EXPECT_EQ(first.spec.nchannels, 4);
    EXPECT_EQ(read_pixels("f.0001.png"), first);
    EXPECT_TRUE(std::filesystem::exists("f.0005.png"));
    EXPECT_FALSE(std::filesystem::exists("f.0006.png"));
    EXPECT_EQ(read_pixels("third.png"), read_pixels("same.png"));
    EXPECT_EQ(read_pixels("third.png").spec.width, 512);
    const auto film = open("walk.n?size=64");
    EXPECT_EQ(film->supports("multiimage"), 1);
    int frames = 0;
    for (; film->seek_subimage(frames, 0); ++frames)
        EXPECT_EQ(film->spec().get_int_attribute("anamorph:frame"), frames + 1);
    EXPECT_EQ(frames, 5);
    // A recipe file of the same.
    write_text("third.figure", "script=walk.n\nframe=3\nsize=512x512\n");
    EXPECT_EQ(read_pixels("third.figure"), read_pixels("walk.n?frame=3&size=512x512"));
    std::filesystem::copy("walk.n", "walk.nudes");
    EXPECT_EQ(read_pixels("walk.nudes?frame=3&size=512x512"), read_pixels("walk.n?frame=3&size=512x512"));
}

TEST_F(Figure, AFunctionDrawsTheSame) {
    const OIIO::ImageBuf call =
        apply("figure", {}, options({{"script", "walk.n"}, {"frame", "2"}, {"size", "90x70"}}));
    EXPECT_EQ(bytes(call), read_pixels("walk.n?frame=2&size=90x70").bytes);
    const OIIO::ImageBuf none = apply("figure", {}, options({{"frame", "2"}}));
    EXPECT_THAT(none.geterror(), HasSubstr("script is not given"));
}

TEST_F(Figure, StylesHaveNamedChannels) {
    EXPECT_EQ(read_pixels("walk.n?frame=1&size=32&style=depth").spec.channelnames[0], "Z");
    EXPECT_EQ(read_pixels("walk.n?frame=1&size=32&style=depth").spec.z_channel, 0);
    const std::vector<float> id = read_floats("walk.n?frame=1&size=64&style=id");
    EXPECT_EQ(*std::max_element(id.begin(), id.end()), 2);
    EXPECT_EQ(read_pixels("walk.n?frame=1&size=32&style=uv").spec.nchannels, 2);
    EXPECT_EQ(read_pixels("walk.n?frame=1&size=32").spec.alpha_channel, 3);
}

TEST_F(Figure, AFigureIsASource) {
    write_text("still.json", R"({"columns": 1, "rows": 1, "units": "fractions",
                                 "vertices": [[0, 0], [1, 0], [0, 1], [1, 1]]})");
    const std::vector<float> warped =
        read_floats("picture.warp?mesh=still.json&tol=0&src=walk.n?frame=3&size=64");
    EXPECT_LT(largest_difference(warped, read_floats("walk.n?frame=3&size=64")), 1e-5);
}

TEST_F(Figure, WhatAScriptIncludesIsSeenWhenItChanges) {
    const std::vector<float> before = read_floats("walk.n?frame=1&size=64");
    write_text("parts.n",
               "figure f 2 a b\nellipsoid a 100 300 100\nellipsoid b 80 90 1000\n"
               "joint j a 0 280 0 b 0 -80 0\n");
    EXPECT_NE(read_floats("walk.n?frame=1&size=64"), before);
    // By way of another recipe, too.
    const std::vector<float> other = read_floats("x.figure?script=walk.n&frame=1&size=64");
    write_text("parts.n",
               "figure f 2 a b\nellipsoid a 50 300 100\nellipsoid b 80 90 10\n"
               "joint j a 0 280 0 b 0 -80 0\n");
    EXPECT_NE(read_floats("x.figure?script=walk.n&frame=1&size=64"), other);
}

TEST_F(Figure, TexturesLieBesideTheScript) {
    std::filesystem::create_directory("sub");
    write_text("sub/doll.n",
               "figure f 2 a b\nellipsoid a 200 300 100\nellipsoid b 80 90 100\njoint j a 0 280 0 b 0 -80 0\n"
               "repeat 0 1 moveto f a 500 400 500\nrepeat 0 1 texture a face 0 0\n"
               "repeat 0 1 texture b none.png 0 0\nstop\n");
    const std::string name = "sub/doll.n?frame=1&size=64&style=textured";
    const std::string plain = "sub/doll.n?frame=1&size=64";
    const auto missing = [&] {
        return read_pixels(name).spec.get_string_attribute("anamorph:missing_textures");
    };
    // Missing ones are named, and bodies have their own colours.
    EXPECT_EQ(missing(), "face, none.png");
    EXPECT_EQ(read_floats(name), read_floats(plain));
    write_text("sub/face.png", "no picture");
    EXPECT_EQ(missing(), "face, none.png");
    OIIO::ImageBuf face(OIIO::ImageSpec(64, 32, 3, OIIO::TypeFloat));
    const float green[] = {0, 1, 0}, blue[] = {0, 0, 1};
    OIIO::ImageBufAlgo::fill(face, green);
    write_image(face, "sub/face.png");
    EXPECT_EQ(missing(), "none.png");
    const auto pixel = [&] {
        const std::vector<float> all = read_floats(name);
        const float* at = &all[(38 * 64 + 32) * 4];
        return std::vector<float>(at, at + 4);
    };
    EXPECT_EQ(pixel()[0], 0);
    EXPECT_GT(pixel()[1], 0.3f);
    EXPECT_EQ(pixel()[2], 0);
    // One that changes, and by way of the function.
    OIIO::ImageBufAlgo::fill(face, blue);
    write_image(face, "sub/face.png");
    EXPECT_EQ(pixel()[1], 0);
    EXPECT_GT(pixel()[2], 0.3f);
    OIIO::ImageCache::create(true)->invalidate_all(true);
    const OIIO::ImageBuf call =
        apply("figure", {},
              options({{"script", "sub/doll.n"}, {"frame", "1"}, {"size", "64"}, {"style", "textured"}}));
    EXPECT_EQ(bytes(call), read_pixels(name).bytes);
    // Mappings and filters are heard of.
    write_panorama("sub/face.png", 64, 32, OIIO::TypeDesc::UINT8, 3, 0);
    const std::vector<float> latlong = read_floats(name);
    EXPECT_NE(read_floats(name + "&mapping=octahedral"), latlong);
    EXPECT_NE(read_floats(name + "&filter=nearest"), latlong);
    // One key for what is shared with other pictures and what is not.
    EXPECT_EQ(read_floats(name + "&filter=antialias"), latlong);
    std::vector<std::vector<float>> different = {latlong};
    for (const std::string filter : {"trilinear", "summed_area", "mrasel"}) {
        SCOPED_TRACE(filter);
        different.push_back(read_floats(name + "&filter=" + filter));
        for (std::size_t i = 0; i + 1 < different.size(); ++i) EXPECT_NE(different[i], different.back()) << i;
    }
    EXPECT_THAT(open_error(name + "&filter=pyramid"), HasSubstr("filter=pyramid: must be one of nearest, "));
    const Ran ran = run("oiiotool '" + name + "' -o out.png");
    EXPECT_EQ(ran.status, 0) << ran.text;
}

TEST_F(Figure, WhatIsWrongIsNamed) {
    const auto expect = [](const std::string& name, const std::string& part) {
        EXPECT_THAT(open_error(name), AllOf(HasSubstr(part), Not(HasSubstr("\n")))) << name;
    };
    expect("walk.n?frame=9", "frame=9: must be an integer from 0 to 5");
    expect("walk.n?script=parts.n", "script=parts.n: must not be given");
    expect("none.n", "none.n");
    expect("x.figure?script=none.n", "none.n");
    expect("none.figure", "\"none\" does not exist");
    write_text("bad.n", "figure f 1 e\nellipsoid e 1 2\nstop\n");
    expect("bad.n", "bad.n:2:1");
    write_text("zero.n", "figure f 1 e\nellipsoid e 1 2 3\nrepeat 0 2 grofig f e 0 1 1\nstop\n");
    expect("zero.n?frame=1", "zero.n:3");
    std::filesystem::create_directory("folder.n");
    expect("folder.n", "is not a file");
    write_text("empty.n", "");
    expect("empty.n", "empty.n");
}

}  // namespace
}  // namespace anamorph::test_figure
