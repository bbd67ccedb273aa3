// SPDX-License-Identifier: Apache-2.0
// Films of panoramas: key frames of a camera, and the blur of its motion.
#include <cmath>

#include "host.h"

namespace anamorph::test_films {
namespace {

using namespace testing_oiio;
using testing::HasSubstr;

class Films : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("globe.exr", 256, 128);
        write_text(
            "pan.json",
            R"({"interpolation": "linear", "keys": {"yaw": [[0, 10], [4, 50]], "fov": [[0, 80], [4, 60]]}})");
    }
};

const std::string kView = "globe.exr.pano?size=48x32&tol=0.001";

std::vector<float> frame_of(const std::string& name, int frame) {
    const auto input = open(name);
    EXPECT_TRUE(input && input->seek_subimage(frame, 0));
    std::vector<float> pixels(input->spec().image_pixels() *
                              static_cast<std::size_t>(input->spec().nchannels));
    EXPECT_TRUE(input->read_image(frame, 0, 0, input->spec().nchannels, OIIO::TypeFloat, pixels.data()));
    return pixels;
}
int frames_of(const std::string& name) {
    const auto input = open(name);
    int frames = 0;
    while (input->seek_subimage(frames, 0)) ++frames;
    return frames;
}

TEST_F(Films, ACameraFollowsItsKeys) {
    const std::string film = kView + "&keys=pan.json";
    EXPECT_EQ(frames_of(film), 5);
    for (int i = 0; i < 5; ++i) {
        const std::string still =
            kView + "&yaw=" + std::to_string(10 + 10 * i) + "&fov=" + std::to_string(80 - 5 * i);
        EXPECT_EQ(frame_of(film, i), read_floats(still)) << i;
    }
    EXPECT_EQ(read_floats(film + "&frame=1.5"), read_floats(kView + "&yaw=25&fov=72.5"));
    EXPECT_EQ(frames_of(film + "&frames=9"), 9);
    EXPECT_EQ(frame_of(film + "&frames=9", 8), read_floats(kView + "&yaw=50&fov=60"));
    // Formulas of rays have frames too, and names of theirs may be keyed.
    write_text("bend.json", R"({"interpolation": "linear", "keys": {"k": [[0, 1], [2, 1.5]]}})");
    const std::string bent = kView + "&to=formula&ray_z=k&k=1";
    EXPECT_EQ(frame_of(bent + "&keys=bend.json", 1), read_floats(kView + "&to=formula&ray_z=1.25"));
}

// The mean of stills, each at its moment.
TEST_F(Films, AnOpenShutterSeesTheMeanOfItsMoments) {
    for (const std::string filter : {"antialias", "nearest"})
        for (const std::string alpha : {"", "&alpha=1"}) {
            const std::string keys = "&filter=" + filter + alpha,
                              blurred = kView + keys + "&keys=pan.json&frame=2&shutter=0.5&samples=4";
            SCOPED_TRACE(blurred);
            const std::vector<float> seen = read_floats(blurred);
            std::vector<double> mean(seen.size());
            for (const double moment : {1.8125, 1.9375, 2.0625, 2.1875}) {
                const std::vector<float> still =
                    read_floats(kView + keys + "&yaw=" + shortest(10 + 10 * moment) +
                                "&fov=" + shortest(80 - 5 * moment));
                ASSERT_EQ(still.size(), seen.size());
                for (std::size_t i = 0; i < still.size(); ++i) mean[i] += 0.25 * double{still[i]};
            }
            for (std::size_t i = 0; i < seen.size(); ++i) ASSERT_NEAR(seen[i], mean[i], 1e-5) << i;
            EXPECT_LE(open(blurred)->spec().get_float_attribute("anamorph:max_error"), 0.001f);
        }
    expect_one_picture(kView + "&keys=pan.json&frame=2&shutter=1", 3, 1);
    // A camera that stands still blurs nothing.
    const std::vector<float> sharp = read_floats(kView), still = read_floats(kView + "&shutter=1&samples=8");
    EXPECT_LT(largest_difference(still, sharp), 1e-5);
    // With two eyes, in larger windows, and of the error, which is the largest of all moments.
    EXPECT_EQ(
        open(kView + "&from=latlong&srcfov=180&stereo=side-by-side&keys=pan.json&shutter=0.5")->spec().width,
        96);
    EXPECT_EQ(open(kView + "&keys=pan.json&shutter=0.5&overscan=4")->spec().x, -4);
    for (const float bound : read_floats(kView + "&keys=pan.json&shutter=0.5&output=bound"))
        ASSERT_LE(bound, 0.001f);
}

TEST_F(Films, AreRefusedWhereTheyCannotBe) {
    EXPECT_THAT(open_error(kView + "&samples=4"), HasSubstr("must be given together with shutter"));
    EXPECT_THAT(open_error(kView + "&shutter=0.5&output=stmap"), HasSubstr("several source points"));
    EXPECT_THAT(open_error(kView + "&shutter=-1"), HasSubstr("shutter"));
    EXPECT_THAT(open_error(kView + "&keys=pan.json&frames=3&frame=1"),
                HasSubstr("must not be given together with frames"));
    EXPECT_THAT(open_error("globe.exr.pano?keys=pan.json&shutter=1"),
                HasSubstr("must be given together with size"));
    write_text("bad.json", R"({"keys": {"fov": [[0, 80], [4, 200]]}})");
    EXPECT_THAT(open_error(kView + "&keys=bad.json"), HasSubstr("frame 4: fov"));
    write_text("no.json", R"({"keys": {"size": [[0, 80]]}})");
    EXPECT_THAT(open_error(kView + "&keys=no.json"), HasSubstr("size"));
    for (const std::string name : {"shutter", "frame", "samples"}) {
        write_text("time.json", "{\"keys\": {\"" + name + "\": [[0, 2]]}}");
        EXPECT_THAT(open_error(kView + "&keys=time.json&frame=2"), HasSubstr(name));
    }
}

}  // namespace
}  // namespace anamorph::test_films
