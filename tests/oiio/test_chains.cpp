// SPDX-License-Identifier: Apache-2.0
// Recipes of recipes: drawn by one resampling where that can be, and said to be; else as if the inner one were a file.
#include <OpenImageIO/imagebufalgo.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>

#include "host.h"

namespace anamorph::test_chains {
namespace {

using namespace testing_oiio;
using testing::HasSubstr;
using testing::StartsWith;

constexpr int kWidth = 240, kHeight = 160;

std::string chain_of(const std::string& name) {
    const auto input = open(name);
    return input ? std::string(input->spec().get_string_attribute("anamorph:chain")) : "";
}

/// The amplitude of waves along x of a period in pixels, in the middle rows and columns of a picture's first channel.
double amplitude(const std::string& name, double period) {
    const std::vector<float> values = read_floats(name);
    std::complex<double> sum = 0;
    int count = 0;
    for (int y = kHeight / 4; y < 3 * kHeight / 4; ++y)
        for (int x = 40; x < 200; ++x, ++count)
            sum += std::polar(1.0, -2 * std::numbers::pi * (x + 0.5) / period) *
                   double{values[static_cast<std::size_t>(y * kWidth + x)]};
    return 2 * std::abs(sum) / count;
}

class Chains : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("plate.exr", kWidth, kHeight);
        write_text("grid.json",
                   R"({"columns": 2, "rows": 2, "units": "fractions", "vertices": [[0, 0], [0.5, 0],
            [1, 0], [0, 0.5], [0.55, 0.47], [1, 0.5], [0, 1], [0.5, 1], [1, 1]]})");
    }

    const std::string m_lens = "plate.exr.lens?lens=brown:k1=-0.21,k2=0.05&fov=84",
                      m_pano = "view.pano?from=rectilinear&srcfov=84&fov=76&yaw=6&size=240x160&src=(" +
                               m_lens + ")",
                      m_warp = "view.warp?mesh=grid.json&src=(" + m_pano + ")";
};

TEST_F(Chains, SayWhatWasJoined) {
    EXPECT_EQ(chain_of(m_lens), "");
    EXPECT_EQ(chain_of(m_pano), "pano of lens");
    EXPECT_EQ(chain_of(m_warp), "warp of pano of lens");
    EXPECT_EQ(chain_of("v.map?u=x+0.5&src=(" + m_warp + ")"), "map of warp of pano of lens");
    EXPECT_EQ(chain_of("v.drape?src=(" + m_warp + ")"),
              "drape of a picture that is drawn first: drape does not join");
    // Of a chain below a picture that is drawn first the rest is said too.
    EXPECT_EQ(chain_of("v.map?u=x+1&src=(w.warp?mesh=grid.json&concatenate=0&src=(" + m_lens + "))"),
              "map of warp of a picture that is drawn first: concatenate=0");
    // A picture that is drawn first may itself be a chain.
    EXPECT_EQ(chain_of("v.lens?lens=3de4:k1=0.1&concatenate=0&src=(" + m_pano + ")"),
              "lens of a picture that is drawn first: concatenate=0");
}

TEST_F(Chains, AreThePictureThatTheyWouldBeWithoutLosses) {
    for (const std::string& name : {m_pano, m_warp}) {
        SCOPED_TRACE(name);
        const std::vector<float> joined = read_floats(name), drawn = read_floats(name + "&concatenate=0");
        double sum = 0;
        for (std::size_t i = 0; i < joined.size(); ++i) sum += std::fabs(joined[i] - drawn[i]);
        EXPECT_LT(sum / static_cast<double>(joined.size()), 0.02);
        EXPECT_GT(sum, 0);
    }
}

TEST_F(Chains, SayTheToleranceThatHolds) {
    const auto input = open("v.map?u=x&tol=0.5&src=(" + m_lens + "&tol=0.001)");
    ASSERT_TRUE(input);
    EXPECT_FLOAT_EQ(input->spec().get_float_attribute("anamorph:tol"), 0.001f);
    EXPECT_LE(input->spec().get_float_attribute("anamorph:max_error"), 0.001f);
}

// The numbers are those of a chain of formulas written as one.
TEST_F(Chains, AreOneMap) {
    const std::string inner = "v.map?u=x+3*sin(y/20)&v=y&src=plate.exr",
                      chain = "w.map?u=x&v=y+4*cos(x/25)&src=(" + inner + ")",
                      one = "v.map?u=x+3*sin((y+4*cos(x/25))/20)&v=y+4*cos(x/25)&src=plate.exr";
    EXPECT_EQ(chain_of(chain), "map of map");
    for (const std::string keys : {"", "&filter=bicubic", "&output=stmap", "&tol=0.000001"}) {
        SCOPED_TRACE(keys);
        std::string nested = chain;
        nested.insert(nested.find("&src="), keys);
        nested.insert(nested.rfind("&src="), keys.starts_with("&output") ? "" : keys);
        const std::vector<float> a = read_floats(nested), b = read_floats(one + keys);
        std::size_t differ = 0;
        for (std::size_t i = 0; i < a.size(); ++i) differ += std::fabs(a[i] - b[i]) > 0.01f;
        // Beyond the edges of the picture in the middle nothing is shown, which the one formula does not know.
        EXPECT_LT(differ, a.size() / 20);
    }
}

// Undistorted, turned, turned back and distorted again, a plate is what it was: waves of a fifth of the sampling rate stay.
TEST_F(Chains, LoseNothingOnTheWay) {
    constexpr double kPeriod = 5;
    OIIO::ImageBuf waves(OIIO::ImageSpec(kWidth, kHeight, 1, OIIO::TypeFloat));
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const auto value =
                static_cast<float>(0.5 + 0.4 * std::sin(2 * std::numbers::pi * (x + 0.5) / kPeriod));
            waves.setpixel(x, y, &value);
        }
    write_image(waves, "waves.exr");
    const std::string flat = "from=rectilinear&to=rectilinear&srcfov=84&fov=84&size=240x160&pitch=0.4",
                      back = "from=rectilinear&to=rectilinear&srcfov=84&fov=84&size=240x160&srcpitch=0.4";
    const auto chain = [&](const std::string& keys) {
        return "c.pano?" + back + "&lens=brown:k1=-0.1,k2=0.02" + keys + "&src=(b.pano?" + flat + keys +
               "&src=(waves.exr.lens?lens=brown:k1=-0.1,k2=0.02&fov=84" + keys + "))";
    };
    EXPECT_EQ(chain_of(chain("")), "pano of pano of lens");
    EXPECT_GT(amplitude(chain(""), kPeriod), 0.99 * 0.4);
    EXPECT_LT(amplitude(chain("&concatenate=0"), kPeriod), 0.8 * 0.4);
}

TEST_F(Chains, AreNotJoinedWhereTheyWouldBeOtherPictures) {
    // Cells of 19 pixels, each bent its own way.
    std::string rough = R"({"columns": 50, "rows": 40, "units": "fractions", "vertices": [)";
    for (int i = 0; i < 51 * 41; ++i)
        rough += (i > 0 ? ", [" : "[") + std::to_string((i % 51 + 0.3 * (i * 7 % 5 - 2)) / 50.0) + ", " +
                 std::to_string((i / 51 + 0.3 * (i * 3 % 5 - 2)) / 40.0) + "]";
    write_text("rough.json", rough + "]}");
    const struct {
        std::string outer, inner, reason;
    } cases[] = {
        {"v.pano?from=rectilinear&filter=bicubic", "plate.exr.lens?lens=3de4:k1=0.1", "the filters differ"},
        {"v.pano?from=rectilinear&wrap=clamp", "plate.exr.lens?lens=3de4:k1=0.1",
         "wrap goes on beyond its source's edges"},
        {"v.pano?from=rectilinear", "plate.exr.lens?lens=3de4:k1=0.1&scheme=blocks",
         "its source has a scheme that does not join"},
        {"v.pano?from=rectilinear&scheme=residual", "plate.exr.lens?lens=3de4:k1=0.1",
         "it has a scheme that does not join"},
        {"v.pano?from=rectilinear", "plate.exr.map?u=x&v=y&direction=push",
         "its source is inverted point by point"},
        {"v.pano?from=rectilinear", "p.map?v=y&direction=push&src=(q.map?u=x+1&src=plate.exr)",
         "its source is inverted point by point"},
        {"v.pano?from=equirectangular&yaw=180", "plate.exr.map?v=y+1&size=200x100",
         "its source closes on itself, but not what that is drawn from"},
        {"v.warp?mesh=rough.json", "plate.exr.lens?lens=3de4:k1=0.1",
         "it has a mesh of small cells that differ"},
        {"v.pano?from=cylindrical", "plate.exr.mosaic?circles=2&to=cylindrical&size=200x50",
         "its source is no picture of maps"},
        {"v.pano?from=rectilinear", "plate.exr.drape?", "its source is no picture of maps"},
        {"v.pano?from=cubemap", "plate.exr.pano?from=rectilinear&to=cubemap&size=40", "its source has faces"},
        {"v.pano?from=equirectangular&pixels=centers",
         "plate.exr.pano?from=rectilinear&to=equirectangular&size=200x100",
         "its source closes on itself, but not at its edges"},
        {"v.lens?lens=3de4:k1=0.1&colorspace=linear", "plate.exr.lens?lens=3de4:k1=0.1",
         "colors are kept differently"},
    };
    for (const auto& c : cases) {
        const std::string joins = c.outer.ends_with('?') ? "" : "&";
        const std::string name = c.outer + joins + "src=(" + c.inner + ")";
        SCOPED_TRACE(name);
        EXPECT_THAT(chain_of(name), StartsWith(c.outer.substr(2, c.outer.find('?') - 2) + " of a picture"));
        EXPECT_THAT(chain_of(name), testing::EndsWith(": " + c.reason));
        // As of a file that holds all that the inner one has.
        draw(c.inner, "inner.exr");
        EXPECT_EQ(largest_difference(read_floats(name), read_floats(c.outer + joins + "src=inner.exr")), 0);
    }
}

// Overscan of the picture in the middle is there, about its display window.
TEST_F(Chains, KeepOverscan) {
    const std::string all = "plate.exr.lens?lens=brown:k1=-0.25,k2=0.06&fov=70&size=all",
                      back = "v.lens?mode=distort&lens=brown:k1=-0.25,k2=0.06&fov=70&src=(" + all + ")";
    EXPECT_EQ(chain_of(back), "lens of lens");
    EXPECT_LT(largest_difference(read_floats(back), read_floats("plate.exr")), 1e-3);
    // Without it the corners are cut off.
    const std::vector<float> cut = read_floats(
        "v.lens?mode=distort&lens=brown:k1=-0.25,k2=0.06&fov=70&src=(plate.exr.lens?lens=brown:k1=-0.25,k2=0."
        "06&"
        "fov=70)");
    EXPECT_EQ(cut[0], 0);
    EXPECT_GT(cut[static_cast<std::size_t>(3 * (kHeight / 2 * kWidth + kWidth / 2))], 0);
}

// An ST-map of the whole chain draws it.
TEST_F(Chains, HaveOneStmap) {
    ASSERT_EQ(run("oiiotool '" + m_warp.substr(0, m_warp.find("&src=")) + "&output=stmap&src=(" + m_pano +
                  ")' -o chain.exr")
                  .status,
              0);
    const std::vector<float> by_map = read_floats("plate.exr.warp?mesh=chain.exr"),
                             chain = read_floats(m_warp);
    double sum = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) sum += std::fabs(chain[i] - by_map[i]);
    EXPECT_LT(sum / static_cast<double>(chain.size()), 1e-3);
}

/// The pixels of a channel of a picture of `channels`.
std::vector<float> channel_of(const std::vector<float>& all, std::size_t channels, std::size_t channel) {
    std::vector<float> one;
    for (std::size_t i = channel; i < all.size(); i += channels) one.push_back(all[i]);
    return one;
}

// Where the picture in the middle ends the chain fades as if that had been drawn first, and eight times as large, but for what the filter
// blurs such an edge by: it takes more than the pixel. (By area: tests/core/test_chain.cpp.)
TEST_F(Chains, HaveSoftEdges) {
    write_white("white.exr", 800, 600, 3);
    const auto chain = [](const std::string& outer, int scale, const std::string& keys) {
        return "v.pano?" + outer + keys +
               "&alpha=1&src=(m.pano?src=white.exr&from=rectilinear&srcfov=120&to=rectilinear&fov=" +
               "80&yaw=7&pitch=4&roll=3&size=" + std::to_string(120 * scale) + "x" +
               std::to_string(80 * scale) + ")";
    };
    for (const std::string outer : {"from=rectilinear&srcfov=80&fov=100&roll=10&size=140x100",
                                    "from=rectilinear&srcfov=80&fov=100&yaw=30&size=400x300",
                                    "from=rectilinear&srcfov=80&to=fisheye&fov=150&roll=5&size=100"}) {
        SCOPED_TRACE(outer);
        EXPECT_EQ(chain_of(chain(outer, 1, "")), "pano of pano");
        const std::vector<float> joined = read_floats(chain(outer, 1, "")),
                                 drawn = read_floats(chain(outer, 8, "&concatenate=0"));
        const std::vector<float> alpha = channel_of(joined, 4, 3), truth = channel_of(drawn, 4, 3);
        double largest = 0, sum = 0;
        int faded = 0;
        for (std::size_t i = 0; i < alpha.size(); ++i) {
            const double off = std::fabs(double{alpha[i]} - double{truth[i]});
            largest = std::max(largest, off);
            if (truth[i] > 0 && truth[i] < 1) ++faded, sum += off;
            // White is faded as alpha is.
            ASSERT_NEAR(joined[4 * i], alpha[i], 1e-5);
        }
        EXPECT_GT(faded, 50);
        EXPECT_LT(largest, 0.15);
        EXPECT_LT(sum / faded, 0.04);
        // Of ids a pixel is in or out.
        for (const float a : channel_of(read_floats(chain(outer, 1, "&filter=nearest&concatenate=1")), 4, 3))
            ASSERT_TRUE(a == 0 || a == 1);
    }
}

// Between two fisheyes of 150 degrees there is a band that neither sees: a pixel shows as much of them as it lies within, by samples of it.
TEST_F(Chains, HaveSoftRimsOfTwoFisheyes) {
    write_white("pair.exr", 800, 400, 3);
    constexpr int kSide = 160, kTimes = 16;
    const std::string view =
        "v.pano?from=equirectangular&to=rectilinear&fov=50&yaw=90&pitch=45&size=160x160&alpha=1&src=(m.pano?"
        "src="
        "pair.exr&from=dual_fisheye&srcfov=150&to=equirectangular&size=1024x512)";
    EXPECT_EQ(chain_of(view), "pano of pano");
    const std::vector<float> alpha = channel_of(read_floats(view), 4, 3);
    ASSERT_EQ(alpha.size(), std::size_t{kSide} * kSide);
    const double step = 2 * std::tan(25 * std::numbers::pi / 180) / kSide,
                 least = std::cos(75 * std::numbers::pi / 180);
    double largest = 0, sum = 0;
    int faded = 0;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            int seen = 0;
            for (int k = 0; k < kTimes * kTimes; ++k) {
                // To the right of the view is straight behind, and to the left ahead.
                const double x = (i + (k % kTimes + 0.5) / kTimes - kSide / 2) * step,
                             y = (j + (k / kTimes + 0.5) / kTimes - kSide / 2) * step;
                seen += std::fabs(x) / std::sqrt(x * x + y * y + 1) > least;
            }
            const double truth = seen / double{kTimes * kTimes},
                         off = std::fabs(double{alpha[static_cast<std::size_t>(j * kSide + i)]} - truth);
            largest = std::max(largest, off);
            if (truth > 0 && truth < 1) ++faded, sum += off;
        }
    EXPECT_GT(faded, 200);
    // Samples are 1/16 of a pixel apart, and edges straight within it.
    EXPECT_LT(largest, 0.05);
    EXPECT_LT(sum / faded, 0.02);
}

// A pixel's middle that goes through the axis of a fisheye on the way, and next to it, has a bound as others have, with any tolerance.
TEST_F(Chains, HaveBoundsOnTheAxesOfFisheyes) {
    write_panorama("globe.exr", 256, 128);
    for (const std::string lens : {"fisheye", "equisolid", "stereographic", "orthographic"})
        for (const std::string from : {"equirectangular&src=globe.exr", "fisheye&src=plate.exr"})
            for (const std::string shift : {"", "&yaw=1e-13", "&pitch=-3e-15&roll=20"})
                for (const std::string tol : {"0.01", "0.0000001"}) {
                    // Odd sizes have a pixel in the middle.
                    const std::string keys = "&tol=" + tol + "&scheme=exact";
                    std::string name = "v.pano?from=" + lens + "&to=rectilinear&fov=80&size=101x101" + shift +
                                       keys + "&src=(m.pano?to=" + lens + "&size=201x201" + keys +
                                       "&from=" + from + ")";
                    SCOPED_TRACE(name);
                    EXPECT_EQ(chain_of(name), "pano of pano");
                    EXPECT_LE(open(name)->spec().get_float_attribute("anamorph:max_error"), std::stof(tol));
                }
}

// A map that another program wrote, read by a view: its pixels are points of one smooth map.
TEST_F(Chains, GoThroughStmaps) {
    ASSERT_EQ(run("oiiotool --resize 480x320 plate.exr -o large.exr").status, 0);
    const std::string keys = "lens=brown:k1=-0.21,k2=0.05&fov=84";
    ASSERT_EQ(run("oiiotool 'large.exr.lens?" + keys + "&output=stmap&tol=0.001' -d float -o st.exr").status,
              0);
    ASSERT_EQ(run("oiiotool 'large.exr.lens?" + keys +
                  "&size=all&output=stmap&tol=0.001&flip_v=1' -d float -o up.exr")
                  .status,
              0);
    ASSERT_EQ(run("oiiotool st.exr -d half -o rough.exr").status, 0);
    const std::string view = "v.pano?from=rectilinear&srcfov=84&fov=70&yaw=6&size=400x300&src=";
    const std::string by_lens = view + "(large.exr.lens?" + keys + ")";
    for (const std::string map : {"large.exr.warp?mesh=st.exr", "large.exr.warp?mesh=up.exr&flip_v=1"}) {
        SCOPED_TRACE(map);
        const std::string name = view + "(" + map + ")";
        EXPECT_EQ(chain_of(name), "pano of warp");
        // The lens has the same points, but for what is near its edges.
        const std::vector<float> a = read_floats(name), b = read_floats(by_lens);
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) sum += std::fabs(double{a[i]} - double{b[i]});
        EXPECT_LT(sum / static_cast<double>(a.size()), 1e-4);
        EXPECT_LE(open(name)->spec().get_float_attribute("anamorph:max_error"), 0.01f);
    }
    expect_one_picture(view + "(large.exr.warp?mesh=st.exr)", 190, 150);
    // The map as the outer one, and two of them.
    ASSERT_EQ(
        run("oiiotool 'large.exr.lens?mode=distort&" + keys + "&output=stmap&tol=0.001' -d float -o back.exr")
            .status,
        0);
    const std::string there_and_back = "w.warp?mesh=back.exr&src=(large.exr.warp?mesh=st.exr)";
    EXPECT_EQ(chain_of(there_and_back), "warp of warp");
    const std::vector<float> same = read_floats(there_and_back), plate = read_floats("large.exr");
    for (int y = 100; y < 220; ++y)
        for (int x = 3 * 150; x < 3 * 330; ++x)
            ASSERT_NEAR(same[static_cast<std::size_t>(3 * 480 * y + x)],
                        plate[static_cast<std::size_t>(3 * 480 * y + x)], 5e-3);
    EXPECT_EQ(chain_of("w.warp?mesh=back.exr&src=(large.exr.lens?" + keys + ")"), "warp of lens");
    // Half has steps of more than the tolerance.
    EXPECT_EQ(chain_of(view + "(large.exr.warp?mesh=rough.exr)"),
              "pano of a picture that is drawn first: its source has an ST-map that is rough or small");
}

// What has few pixels is joined whatever it is: each is computed by itself.
TEST_F(Chains, GoThroughSmallWarps) {
    std::string rough = R"({"columns": 12, "rows": 9, "units": "fractions", "vertices": [)";
    for (int i = 0; i < 13 * 10; ++i)
        rough += (i > 0 ? ", [" : "[") + std::to_string((i % 13 + 0.2 * (i * 7 % 5 - 2)) / 12.0) + ", " +
                 std::to_string((i / 13 + 0.2 * (i * 3 % 5 - 2)) / 9.0) + "]";
    write_text("rough.json", rough + "]}");
    for (const char* const size : {"2x2", "3x2", "2x9", "24x16", "35x20", "64x64"}) {
        SCOPED_TRACE(size);
        draw("plate.exr.map?u=x*0.9+0.03*width*sin(y/11)&v=y*0.95+1&size=" + std::string(size) +
                 "&output=stmap",
             "st.exr");
        const std::string view = "v.pano?from=rectilinear&srcfov=84&fov=70&yaw=6&size=90x70";
        for (const std::string& keys :
             {std::string("mesh=st.exr"), "mesh=rough.json&size=" + std::string(size)}) {
            const std::string inner = view + "&src=(plate.exr.warp?" + keys + ")",
                              outer = "w.warp?" + keys + "&src=(plate.exr.lens?lens=3de4:k1=0.03)";
            EXPECT_EQ(chain_of(inner), "pano of warp");
            EXPECT_EQ(chain_of(outer), "warp of lens");
            for (const std::string& name : {inner, outer}) {
                const std::size_t at = name.find("&src=");
                const std::vector<float> error = read_floats(std::string(name).insert(at, "&output=error")),
                                         bound = read_floats(std::string(name).insert(at, "&output=bound"));
                ASSERT_EQ(error.size(), bound.size());
                for (std::size_t i = 0; i < error.size(); ++i) ASSERT_LE(error[i], bound[i]) << name;
                for (const float value : read_floats(name)) ASSERT_TRUE(std::isfinite(value)) << name;
            }
            // The outer one has the source points that both maps have, one after the other.
            expect_one_picture(outer, 1, 1);
        }
        std::filesystem::remove("st.exr");
    }
}

// Warps without a formula of their own are read as cubics, which bounds know of: meshes that push, of small cells, pairs of points.
TEST_F(Chains, GoThroughWarpsOfEveryKind) {
    ASSERT_EQ(run("oiiotool --resize 480x320 plate.exr -o large.exr").status, 0);
    write_text("push.json", R"({"columns": 1, "rows": 1, "units": "fractions", "direction": "push",
        "vertices": [[0, 0], [1, 0.02], [0.01, 1], [1, 1]]})");
    write_text("pairs.csv", "x,y,u,v\n20,20,24,22\n400,40,380,44\n200,280,204,274\n300,100,305,96\n");
    std::string fine = R"({"columns": 60, "rows": 40, "units": "fractions", "vertices": [)";
    for (int i = 0; i < 61 * 41; ++i) {
        const double x = i % 61 / 60.0, y = i / 61 / 40.0;
        fine += (i > 0 ? ", [" : "[") + std::to_string(x + 0.02 * std::sin(4 * y)) + ", " +
                std::to_string(y + 0.01 * std::sin(5 * x)) + "]";
    }
    write_text("fine.json", fine + "]}");
    const std::string view = "v.pano?from=rectilinear&srcfov=84&fov=60&yaw=4&size=300x220";
    for (const std::string keys : {"mesh=push.json", "points=pairs.csv", "mesh=fine.json"}) {
        SCOPED_TRACE(keys);
        const std::string inner = view + "&src=(large.exr.warp?" + keys + ")",
                          outer = "w.warp?" + keys + "&src=(large.exr.lens?lens=3de4:k1=0.03)";
        EXPECT_EQ(chain_of(inner), "pano of warp");
        EXPECT_EQ(chain_of(outer), "warp of lens");
        for (const std::string& name : {inner, outer}) {
            EXPECT_LE(open(name)->spec().get_float_attribute("anamorph:max_error"), 0.01f);
            std::string shown = name;
            const std::size_t at = shown.find("&src=");
            const std::vector<float> error = read_floats(shown.insert(at, "&output=error"));
            const std::vector<float> bound = read_floats(std::string(name).insert(at, "&output=bound"));
            ASSERT_EQ(error.size(), bound.size());
            for (std::size_t i = 0; i < error.size(); ++i) ASSERT_LE(error[i], bound[i]);
            // As drawn twice, but for what that loses.
            const std::vector<float> joined = read_floats(name),
                                     drawn = read_floats(std::string(name).insert(at, "&concatenate=0"));
            double sum = 0;
            for (std::size_t i = 0; i < joined.size(); ++i) sum += std::fabs(double{joined[i]} - drawn[i]);
            EXPECT_LT(sum / static_cast<double>(joined.size()), 0.01);
        }
        expect_one_picture(inner, 130, 90);
    }
}

// A mosaic of one panorama is a map of it, at either end.
TEST_F(Chains, GoThroughMosaicsOfOnePanorama) {
    write_panorama("around.exr", 320, 160);
    const std::string
        keys = "from=equirectangular&x=0.3&z=0.2&depth=4",
        inner = "v.pano?from=rectilinear&srcfov=80&fov=60&yaw=5&size=120x90&src=(around.exr.mosaic?" + keys +
                "&fov=80&size=200x150)",
        around = "v.pano?from=equirectangular&yaw=178&fov=80&size=120x90&src=(around.exr.mosaic?" + keys +
                 "&to=equirectangular&size=300x150)",
        outer = "w.mosaic?" + keys +
                "&fov=80&size=120x90&src=(around.exr.pano?to=equirectangular&size=320x160&yaw=30)";
    EXPECT_EQ(chain_of(inner), "pano of mosaic");
    EXPECT_EQ(chain_of(around), "pano of mosaic");
    EXPECT_EQ(chain_of(outer), "mosaic of pano");
    for (const std::string& name : {inner, around, outer}) {
        SCOPED_TRACE(name);
        const std::size_t at = name.find("&src=");
        const std::vector<float> joined = read_floats(name),
                                 drawn = read_floats(std::string(name).insert(at, "&concatenate=0"));
        double sum = 0;
        for (std::size_t i = 0; i < joined.size(); ++i) sum += std::fabs(double{joined[i]} - drawn[i]);
        EXPECT_LT(sum / static_cast<double>(joined.size()), 0.02);
        const std::vector<float> error = read_floats(std::string(name).insert(at, "&output=error")),
                                 bound = read_floats(std::string(name).insert(at, "&output=bound"));
        for (std::size_t i = 0; i < error.size(); ++i) ASSERT_LE(error[i], bound[i]);
    }
    EXPECT_EQ(
        chain_of("v.pano?from=cylindrical&src=(around.exr.mosaic?circles=2&to=cylindrical&size=200x50)"),
        "pano of a picture that is drawn first: its source is no picture of maps");
}

TEST_F(Chains, KeepIntegersAndParts) {
    OIIO::ImageBuf ids(OIIO::ImageSpec(64, 48, 1, OIIO::TypeUInt32));
    std::vector<std::uint32_t> values;
    for (unsigned i = 0; i < 64 * 48; ++i) values.push_back(4000000001u + i);
    ids.set_pixels(ids.roi(), OIIO::TypeUInt32, values.data());
    write_image(ids, "ids.exr");
    const std::string shift = "w.map?u=x+1&filter=nearest&src=(v.map?v=y+2&filter=nearest&src=ids.exr)";
    EXPECT_EQ(chain_of(shift), "map of map");
    const Pixels moved = read_pixels(shift);
    ASSERT_EQ(moved.spec.format, OIIO::TypeUInt32);
    const auto* pixels = reinterpret_cast<const std::uint32_t*>(moved.bytes.data());
    EXPECT_EQ(pixels[0], 4000000001u + 2 * 64 + 1);
    EXPECT_EQ(pixels[62 + 45 * 64], 4000000001u + 63 + 47 * 64);
    EXPECT_EQ(pixels[63], 0u);

    write_panorama("other.exr", 64, 48, OIIO::TypeFloat, 1);
    ASSERT_EQ(run("oiiotool --native ids.exr other.exr --siappend -o two.exr").status, 0);
    const auto input = open("w.map?u=x+1&src=(v.map?v=y+2&src=two.exr)");
    ASSERT_TRUE(input && input->seek_subimage(1, 0));
    EXPECT_EQ(input->spec(1, 0).get_string_attribute("anamorph:chain"), "map of map");
    std::vector<float> second(64 * 48);
    ASSERT_TRUE(input->read_image(1, 0, 0, 1, OIIO::TypeFloat, second.data()));
    EXPECT_NEAR(second[5 + 7 * 64], panorama_value(6, 9, 0, 64, 48), 1e-5);
}

TEST_F(Chains, AreOnePicture) {
    expect_one_picture(m_warp, 60, 50);
    expect_one_picture(
        "v.pano?yaw=180&pitch=30&size=200x150&src=(plate.exr.pano?from=rectilinear&to=equirectangular&"
        "size=320x160&yaw=20)",
        50, 40);
    // So are its levels.
    const auto input = open("view.warp?mesh=grid.json&mip=1&src=(" + m_lens + ")");
    ASSERT_TRUE(input && input->seek_subimage(0, 2));
    EXPECT_EQ(input->spec(0, 2).get_string_attribute("anamorph:chain"), "warp of lens");
    EXPECT_FALSE(open("view.warp?mesh=grid.json&mip=1&src=(" + m_lens + ")")->seek_subimage(0, 8));
}

}  // namespace
}  // namespace anamorph::test_chains
