// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "anamorph/error.h"
#include "anamorph/panorama/hugin_project.h"

namespace anamorph::test_hugin_project {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kPanorama = "p f2 w4000 h2000 v360 E12 R0 S0,4000,200,1800 n\"TIFF_m c:LZW r:CROP\"\n";
const std::string kImage = "i w300 h200 f0 v65.5 y10 p-5 r0.25 n\"a b.jpg\"\n";

HuginProject parsed(const std::string& text) {
    return parse_hugin_project(text, "x.pto");
}
std::string error_of(const std::string& text) {
    try {
        static_cast<void>(parsed(text));
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}
/// What is refused of the first image once it is drawn.
std::string refused_of(const std::string& text) {
    try {
        parsed(text).images.at(0).check("x.pto");
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

TEST(HuginProject, ReadsPanoramaImagesAndLinks) {
    const HuginProject project =
        parsed("\xef\xbb\xbf# hugin project file\r\n#hugin_ptoversion 2\r\n" + kPanorama +
               "m i0 g1\r\n\r\n"
               "i w300 h200 f3 v165.5 Ra0 Rb0 a0.01 b-0.02 c0.003 d4 e-5 g0 t0 Va1 Vx0 Vy0 y10 p-5 r0.25 "
               "TrX0 TrY0 TrZ0 Tpy3 Tpp0 j0 Eev12 Er1 "
               "Eb1 Vm5 n\"a b.jpg\"\r\n"
               "i w300 h200 f=0 v=0 a=0 b=0 c=0 d=0 e=0 g=0 t=0 y-170 p1e1 r+2 S20,280,-10,190 n\"b.jpg\"\r\n"
               "i w200 h300 f2 v=1 y=1 p0 r0 S0,0,0,0 n\"c.jpg\"\r\n"
               "i w300 h200 f2 v100 y0 p0 r0 S20,280,10,190 n\"d.jpg\"\r\n"
               "k i1 t0 p\"10 20 30.5 20 30 40\"\r\n"
               "v y1\r\nv\r\nc n0 N1 x10 y20 X30 Y40 t0\r\n*\r\nanything goes here\r\n");
    ASSERT_TRUE(project.panorama);
    EXPECT_EQ(project.panorama->projection, Projection::equirectangular);
    EXPECT_EQ(project.panorama->size, (Size{4000, 2000}));
    EXPECT_EQ(project.panorama->fov, 360);
    EXPECT_EQ(project.panorama->crop, (Box{0, 200, 4000, 1800}));
    ASSERT_EQ(project.images.size(), 4u);
    const HuginImage &a = project.images[0], &b = project.images[1], &c = project.images[2],
                     &d = project.images[3];
    EXPECT_EQ(a.file, "a b.jpg");
    EXPECT_EQ(a.size, (Size{300, 200}));
    EXPECT_EQ(a.projection, Projection::fisheye);
    EXPECT_EQ(a.fov, 165.5);
    EXPECT_EQ(a.lens, (std::array<double, 7>{0.01, -0.02, 0.003, 0, 0, 4, -5}));
    EXPECT_EQ(a.yaw, 10);
    EXPECT_EQ(a.pitch, -5);
    EXPECT_EQ(a.roll, 0.25);
    EXPECT_FALSE(a.crop);
    EXPECT_EQ(b.projection, Projection::fisheye);
    EXPECT_EQ(b.fov, 165.5);
    EXPECT_EQ(b.lens, a.lens);
    EXPECT_EQ(b.yaw, -170);
    EXPECT_EQ(b.pitch, 10);
    EXPECT_EQ(b.roll, 2);
    EXPECT_EQ(b.crop, (Box{20, -10, 280, 190}));
    EXPECT_FALSE(b.is_round);
    ASSERT_EQ(b.masks.size(), 1u);
    ASSERT_EQ(b.masks[0].size(), 3u);
    EXPECT_EQ(b.masks[0][1].x, 30.5);
    EXPECT_EQ(b.masks[0][2].y, 40);
    EXPECT_EQ(c.fov, 165.5) << "by way of another link";
    EXPECT_EQ(c.yaw, -170);
    EXPECT_FALSE(c.crop) << "four zeros";
    EXPECT_TRUE(d.is_round);
    for (const HuginImage& image : project.images) EXPECT_EQ(image.refused, "");
    EXPECT_EQ(project.not_applied, "");
}

TEST(HuginProject, ANameIsNoLink) {
    EXPECT_EQ(parsed("i w3 h2 f0 v90 n\"a\"\ni w3 h2 f0 v90 n\"=0\"").images[1].file, "=0");
}

TEST(HuginProject, KnowsTheProjectionsOfPanoTools) {
    const auto of_image = [](int f) {
        return parsed("i w3 h2 f" + std::to_string(f) + " v90 n\"a\"").images.at(0).projection;
    };
    using enum Projection;
    for (const auto& [f, projection] : {std::pair{0, rectilinear},
                                        {1, cylindrical},
                                        {2, fisheye},
                                        {3, fisheye},
                                        {4, equirectangular},
                                        {8, orthographic},
                                        {10, stereographic},
                                        {21, equisolid}})
        EXPECT_EQ(of_image(f), projection) << f;
    const auto of_panorama = [](int f) {
        return parsed("p w3 h2 v90 f" + std::to_string(f) + "\n" + kImage).panorama->projection;
    };
    for (const auto& [f, projection] : {std::pair{0, rectilinear},
                                        {1, cylindrical},
                                        {2, equirectangular},
                                        {3, fisheye},
                                        {4, stereographic},
                                        {5, mercator},
                                        {7, sinusoidal},
                                        {9, equisolid},
                                        {14, orthographic},
                                        {15, equisolid},
                                        {19, pannini},
                                        {21, hammer}})
        EXPECT_EQ(of_panorama(f), projection) << f;
    EXPECT_EQ(
        refused_of("i w3 h2 f7 v90 n\"a\""),
        "x.pto: row 1: f7: must be one of the projections that there are here, 0 (rectilinear), 1 "
        "(cylindrical), 2 "
        "(fisheye), 3 (fisheye), 4 (equirectangular), 8 (orthographic), 10 (stereographic), 21 (equisolid)");
    for (const int f : {6, 8, 10, 11, 12, 13, 16, 17, 18, 20})
        EXPECT_THAT(parsed("p w3 h2 v90 f" + std::to_string(f) + "\n" + kImage).panorama->refused,
                    StartsWith("row 1: f" + std::to_string(f) + ": must be one of"));
}

TEST(HuginProject, SaysWhatMovesAndIsNotDrawn) {
    const auto with = [](const std::string& more) { return refused_of("i w3 h2 f0 v90 n\"a\" " + more); };
    EXPECT_EQ(with("g0 t0 TrX0 TrY-0 TrZ0.0 Te00 X0 Tpy20 Tpp-4 j3"), "");
    EXPECT_EQ(with("g5 t-0.1 TrX0.5 TrY1 TrZ-1e-9"), "");
    EXPECT_EQ(with("TiX3"), "x.pto: row 1: TiX3: must be 0 (tilt)");
    EXPECT_EQ(with("C1,2,3,4"), "x.pto: row 1: C1,2,3,4: must be 0 (what it means is not known here)");
    EXPECT_EQ(with("Q7"), "x.pto: row 1: Q7: must be 0 (what it means is not known here)");
    EXPECT_EQ(refused_of("i w3 h2 f0 v90 n\"a\"\nk i0 t1 p\"0 0 2 0 2 2\""),
              "x.pto: row 2: t1: must be 0, a mask that cuts a part of its own image out");
    // Of a linked value that of the other image counts.
    const HuginProject linked = parsed("i w3 h2 f0 v90 TiZ5 n\"a\"\ni w3 h2 f0 v90 TiZ=0 n\"b\"");
    EXPECT_EQ(linked.images[1].refused, "row 2: TiZ=0: must be 0 (tilt)");
}

TEST(HuginProject, CamerasMayStandBesideTheOthers) {
    const HuginProject project = parsed(
        "i w3 h2 f0 v90 g5 t-6 d1 e2 TrX0.5 TrY-2 TrZ3 Tpy20 Tpp-4 n\"a\"\n"
        "i w3 h2 f0 v90 g=0 TrX=0 TrY0 TrZ0 Tpy7 n\"b\"\ni w3 h2 f0 v90 TrX0 TrY-0 TrZ0 Tpy9 n\"c\"");
    EXPECT_THAT(project.images[0].lens, testing::ElementsAre(0, 0, 0, 5, -6, 1, 2));
    ASSERT_TRUE(project.images[0].transfer);
    EXPECT_THAT(project.images[0].transfer->camera, testing::ElementsAre(0.5, -2, -3));
    EXPECT_EQ(project.images[0].transfer->yaw, 20);
    EXPECT_EQ(project.images[0].transfer->pitch, -4);
    EXPECT_EQ(project.images[1].lens[3], 5);
    ASSERT_TRUE(project.images[1].transfer);
    EXPECT_THAT(project.images[1].transfer->camera, testing::ElementsAre(0.5, 0, 0));
    EXPECT_FALSE(project.images[2].transfer);
    EXPECT_THAT(error_of("i w3 h2 f0 v90 TrX1e9x n\"a\""), HasSubstr("TrX1e9x"));
    EXPECT_THAT(error_of("i w3 h2 f0 v90 Tppnan n\"a\""), HasSubstr("Tppnan"));
}

TEST(HuginProject, NamesWhatIsAboutColours) {
    const auto not_applied = [](const std::string& one, const std::string& two = "",
                                const std::string& p = "") {
        return parsed(p + "i w3 h2 f0 v90 n\"a\" " + one + "\ni w3 h2 f0 v90 n\"b\" " + two).not_applied;
    };
    EXPECT_EQ(not_applied("Eev12.5 Er1 Eb1 Ra0 Va1 Vb0 Vx7 Vm5", "Eev12.5 Vx3"), "");
    EXPECT_EQ(not_applied("Eev12.5", "Eev12"), "Eev");
    EXPECT_EQ(not_applied("Eev12", "Eev=0", "p f2 w4 h2 v360 E11\n"), "Eev");
    EXPECT_EQ(not_applied("Vb0.1 Er0.9", "Vf\"flat.tif\" Re1"), "Er, Re, Vb, Vf");
}

TEST(HuginProject, SaysWhatIsWrongInOneLine) {
    EXPECT_EQ(error_of(""), "x.pto: has no image: must have at least one row i");
    EXPECT_EQ(error_of("# nothing\n"), "x.pto: has no image: must have at least one row i");
    EXPECT_EQ(error_of("i w300\n"), "x.pto: row 1: n is missing: must be given");
    EXPECT_EQ(error_of("\ni w0 h2 f0 v90 n\"a\""),
              "x.pto: row 2: w0: must be w and an integer from 1 to 1048576");
    EXPECT_EQ(error_of("i w2147483648 h2 f0 v90 n\"a\""),
              "x.pto: row 1: w2147483648: must be w and an integer from 1 to 1048576");
    EXPECT_EQ(error_of("i w3.5 h2 f0 v90 n\"a\""),
              "x.pto: row 1: w3.5: must be w and an integer from 1 to 1048576");
    for (const char* v : {"nan", "inf", "-1", "0", "361", "1e999", "", "9o"})
        EXPECT_EQ(error_of(std::string("i w3 h2 f0 n\"a\" v") + v),
                  "x.pto: row 1: v" + std::string(v) + ": must be v and a number from 1e-06 to 360");
    EXPECT_EQ(error_of("i w3 h2 f0 v90 n\"a\" ynan"),
              "x.pto: row 1: ynan: must be y and a number from -1000000000 to 1000000000");
    EXPECT_THAT(error_of("i w3 h2 f0 v90 n\"a\" b1e10"),
                StartsWith("x.pto: row 1: b1e10: must be b and a number"));
    EXPECT_EQ(error_of("i w3 h2 f0 v=0 n\"a\""),
              "x.pto: row 1: v=0: must be = and the number of an image before this one");
    EXPECT_EQ(error_of(kImage + "i w3 h2 f0 v=1 n\"a\""),
              "x.pto: row 2: v=1: must be = and the number of an image before this one");
    EXPECT_EQ(error_of(kImage + "i w3 h2 f0 v=-1 n\"a\""),
              "x.pto: row 2: v=-1: must be = and the number of an image before this one");
    EXPECT_EQ(error_of("i w3 h2 f0 v90 n\"a"), "x.pto: row 1: n: must end with a quotation mark");
    EXPECT_EQ(error_of("i w3 h2 f0 v90 n\"\""), "x.pto: row 1: n\"\": must be the name of an image");
    EXPECT_EQ(error_of("i w3 w4 h2 f0 v90 n\"a\""), "x.pto: row 1: w: must be given once");
    EXPECT_EQ(error_of("i w3 h2 f0 v90 n\"a\" 17"),
              "x.pto: row 1: \"17\": must begin with a name, as in v65.5");
    EXPECT_EQ(error_of("i w3 h2 f-1 v90 n\"a\""),
              "x.pto: row 1: f-1: must be f and an integer from 0 to 1000");
    for (const char* crop :
         {"1,2,3", "10,5,0,2", "0,5,2,2", "0,1,0,nan", "0,1.5,0,2", "0,3000000000,0,2", ""})
        EXPECT_THAT(
            error_of(std::string("i w3 h2 f0 v90 n\"a\" S") + crop),
            StartsWith("x.pto: row 1: S" + std::string(crop) + ": must be S and left,right,top,bottom"));
    EXPECT_EQ(error_of("o f0\n"), "x.pto: row 1: o: must be a row i, as Hugin has written them since 2010");
    EXPECT_EQ(
        error_of("<html>\n"),
        "x.pto: row 1: \"<html>\": must be a row of a project, which begins with p, i, k, m, v, c or #");
    EXPECT_EQ(error_of(kPanorama + kPanorama), "x.pto: row 2: p: must be given once");
    EXPECT_EQ(error_of("p f2 w4 h2 v360 S5,9,0,1\n" + kImage),
              "x.pto: row 1: S5,9,0,1: must have pixels of the panorama");
    EXPECT_EQ(error_of("p f2 w4 v360\n" + kImage), "x.pto: row 1: h is missing: must be given");
    EXPECT_EQ(error_of(kImage + "k i1 t0 p\"0 0 2 0 2 2\""),
              "x.pto: row 2: i1: must be the number of an image, 0 to 0");
    EXPECT_THAT(error_of(kImage + "k i0 t0 p\"0 0 2 0 2\""),
                HasSubstr("row 2: p: must be x y of each corner"));
    EXPECT_THAT(error_of(kImage + "k i0 t0 p\"0 0 2 0 2 inf\""),
                HasSubstr("row 2: pinf: must be p and a number"));
    EXPECT_THAT(error_of(kImage + "k i0 p\"0 0 2 0 2 2\""), HasSubstr("row 2: t is missing: must be given"));
}

TEST(HuginProject, HasLimits) {
    std::string images, masks = kImage, corners;
    for (std::size_t i = 0; i <= kMostHuginImages; ++i) images += kImage;
    EXPECT_EQ(error_of(images), "x.pto: row 1025: must be one of at most 1024 images");
    for (std::size_t i = 0; i <= kMostHuginMasks; ++i) masks += "k i0 t0 p\"0 0 2 0 2 2\"\n";
    EXPECT_EQ(error_of(masks), "x.pto: row 4098: must be one of at most 4096 masks");
    for (std::size_t i = 0; i <= kMostHuginCorners; ++i) corners += " 1 2";
    EXPECT_THAT(error_of(kImage + "k i0 t0 p\"" + corners + "\""), HasSubstr("3 to 4096 of them"));
}

// PanoTools' own words: t = (150 - compression) / 50, d = 1.5 / (t + 0.0001) - 1.5 / 3.0001.
TEST(HuginProject, PanniniHasTheDistanceOfItsCompression) {
    const auto panorama = [](const std::string& parameters) {
        return parsed("p f19 w300 h200 v120 " + parameters + "\n" + kImage).panorama.value();
    };
    for (const auto& [text, d] : {std::pair{"", 0.99986668},
                                  {"P\"100 0 0\"", 0.99986668},
                                  {"P\"0 0 0\"", 0.0},
                                  {"P\"50\"", 0.24997917},
                                  {"P\"125 0 0\"", 2.4994168},
                                  {"P\" 140  0 0 \"", 6.9962685}}) {
        const HuginPanorama found = panorama(text);
        EXPECT_EQ(found.projection, Projection::pannini);
        EXPECT_EQ(found.refused, "");
        EXPECT_NEAR(found.d.value(), d, 1e-5 * (1 + d)) << text;
    }
    for (const std::string bad :
         {"P\"100 1 0\"", "P\"100 0 -20\"", "P\"151 0 0\"", "P\"-1 0 0\"", "P\"150 0 0\""})
        EXPECT_THAT(panorama(bad).refused, HasSubstr("must be a compression from 0 to 149.9")) << bad;
    for (const std::string bad : {"Px", "P\"1 2 3 4\"", "P\"nan 0 0\"", "P\"1e99 0 0\"", "P\"100 inf 0\""})
        EXPECT_THAT(error_of("p f19 w300 h200 v120 " + bad + "\n" + kImage), HasSubstr("P")) << bad;
    // Of others it means nothing.
    EXPECT_FALSE(parsed("p f2 w300 h200 v120 P\"50 0 0\"\n" + kImage).panorama->d);
}

}  // namespace
}  // namespace anamorph::test_hugin_project
