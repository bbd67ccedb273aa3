// SPDX-License-Identifier: Apache-2.0
// Programs of the user's in warps: what they find, what they draw, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "anamorph/image/source.h"
#include "anamorph/machine/shaded_warp.h"
#include "anamorph/operation/operation.h"

namespace anamorph {
using namespace machine;
namespace {

using testing::HasSubstr;

constexpr int kWidth = 40, kHeight = 24;

const std::string kMesh = R"({"columns": 2, "rows": 2, "units": "fractions", "vertices": [
    [0, 0], [0.5, 0], [1, 0],  [0, 0.5], [0.61, 0.42], [1, 0.5],  [0, 1], [0.5, 1], [1, 1]]})";

class Files final : public SideFileReader {
  public:
    explicit Files(std::map<std::string, std::string> texts) : m_texts(std::move(texts)) {}
    std::string text(const std::string& name) const override { return m_texts.at(name); }
    std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
        throw Error("there is no image " + name);
    }

  private:
    std::map<std::string, std::string> m_texts;
};

/// Channel c of texel (x, y): smooth in x, y and not the same in any two channels.
float texel(int x, int y, int c) {
    return static_cast<float>(0.5 + 0.4 * std::sin(0.3 * x + 0.2 * y * (c + 1) + c));
}

struct Drawn {
    std::vector<float> values;
    std::map<std::string, double> says;

    float at(int x, int y, int c, int channels, int width = kWidth) const {
        return values[static_cast<std::size_t>((y * width + x) * channels + c)];
    }
};

/// The picture that .warp makes of a source of `channels` floats, by `program` and with `more` values.
Drawn drawn_by(const std::string& program, const std::vector<Assignment>& more = {}, int channels = 3,
               int width = kWidth, int height = kHeight) {
    const Operation& warp = *find_operation("warp");
    ParameterValues values(*warp.parameters);
    values.assign({{"scheme", "hardware"}});
    values.assign(more);
    std::map<std::string, std::string> texts = {{"own.ps", program}, {"grid.json", kMesh}};
    SideFiles files;
    if (!program.empty()) files["program"] = {"own.ps", ""};
    if (values.given("mesh")) files["mesh"] = {"grid.json", ""};
    SourceImage facts;
    facts.facts.width = kWidth;
    facts.facts.height = kHeight;
    facts.channels = channels;
    const Files reader(texts);
    const auto request = warp.read({values, {facts}, files, reader})->picture(0, 0);
    const auto solved = request->solve();
    std::vector<float> texels;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < channels; ++c) texels.push_back(texel(x, y, c));
    const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                          PixelType::float32, kWidth, kHeight, channels));
    Drawn drawn;
    const int shown = request->pixels == PixelKind::color   ? channels
                      : request->pixels == PixelKind::point ? 2
                                                            : 1;
    drawn.values.resize(static_cast<std::size_t>(width * height * shown));
    EXPECT_TRUE(solved->draw({&source}, {0, 0, width, height},
                             packed_view(reinterpret_cast<std::byte*>(drawn.values.data()),
                                         PixelType::float32, width, height, shown),
                             serial_for));
    for (const Attribute& a : solved->reached(serial_for))
        if (std::holds_alternative<double>(a.value)) drawn.says[a.name] = std::get<double>(a.value);
    return drawn;
}

std::string refusal_of(const std::string& program, const std::vector<Assignment>& more = {},
                       int channels = 3) {
    try {
        drawn_by(program, more, channels);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

const std::vector<Assignment> kExactly = {{"machine", "ps20:arithmetic=float32,address_bits=16"},
                                          {"filter", "bilinear"}};

TEST(WarpProgram, T0IsThePictureAsItStands) {
    const std::string same = "ps_2_0\ndcl t0.xy\ndcl_2d s0\ntexld r0, t0, s0\nmov oC0, r0\n";
    const Drawn drawn = drawn_by(same, kExactly);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(drawn.at(x, y, c, 3), texel(x, y, c), 1e-5) << x << " " << y;
    EXPECT_LT(drawn.says.at("anamorph:max_error"), 1e-4);
}

/// t0, t1 and constants, seen as colors; components that are not given are 0, 0 and 1.
TEST(WarpProgram, FindsCoordinatesAndSizes) {
    const Drawn t0 = drawn_by("ps_2_0\ndcl t0\nmov oC0, t0\n", kExactly, 4);
    const Drawn t1 = drawn_by("ps_2_0\ndcl t1\nmov oC0, t1\n", kExactly, 4);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            ASSERT_NEAR(t0.at(x, y, 0, 4), (x + 0.5) / kWidth, 1e-6);
            ASSERT_NEAR(t0.at(x, y, 1, 4), (y + 0.5) / kHeight, 1e-6);
            ASSERT_EQ(t0.at(x, y, 2, 4), 0);
            ASSERT_EQ(t0.at(x, y, 3, 4), 1);
            // One cell, from the middle of a table's first texel to that of its last one.
            ASSERT_NEAR(t1.at(x, y, 0, 4), ((x + 0.5) / kWidth * 255 + 0.5) / 256, 1e-6);
            ASSERT_NEAR(t1.at(x, y, 1, 4), ((y + 0.5) / kHeight * 255 + 0.5) / 256, 1e-6);
        }
    std::vector<Assignment> larger = kExactly;
    larger.push_back({"size", "80x30"});
    const auto constant = [&](const std::string& name) {
        const Drawn drawn = drawn_by("ps_2_0\nmov oC0, " + name + "\n", larger, 4, 80, 30);
        return std::vector<float>(drawn.values.begin(), drawn.values.begin() + 4);
    };
    EXPECT_EQ(constant("c8"), (std::vector<float>{40, 24, 1 / 40.0F, 1 / 24.0F}));
    EXPECT_EQ(constant("c9"), (std::vector<float>{80, 30, 1 / 80.0F, 1 / 30.0F}));
    EXPECT_EQ(constant("c10"), (std::vector<float>{0, 0, 0, 0}));
    // Without a mesh nothing is perturbed.
    EXPECT_EQ(constant("c0"), (std::vector<float>{0, 0, 0, 0}));
}

TEST(WarpProgram, ItsOwnConstantsGoBeforeThoseThatAreGiven) {
    const Drawn drawn = drawn_by("ps_2_0\ndef c8, 1, 2, 3, 4\nmov oC0, c8\n", kExactly, 4);
    EXPECT_EQ(drawn.at(0, 0, 1, 4), 2);
}

/// Our program, given as the user's: the same source points to the bit, and colors to what registers hold.
TEST(WarpProgram, OurProgramIsOneOfThem) {
    for (const char* machine : {"ps20:arithmetic=float32", "ps20", "ps20:arithmetic=fixed16"}) {
        const std::vector<Assignment> values = {
            {"mesh", "grid.json"}, {"machine", machine}, {"filter", "bilinear"}};
        for (const char* output : {"stmap", "error", "bound"}) {
            std::vector<Assignment> shown = values;
            shown.push_back({"output", output});
            EXPECT_EQ(drawn_by(kHermiteShader, shown).values, drawn_by("", shown).values) << output;
        }
        const Drawn own = drawn_by(kHermiteShader, values), ours = drawn_by("", values);
        EXPECT_EQ(own.says, ours.says);
        // Of numbers up to 1: 2^-17 of float24, 2^-13 of fixed16.
        const double near = std::string(machine) == "ps20:arithmetic=fixed16" ? 0x1.1p-13 : 0x1.1p-17;
        for (std::size_t i = 0; i < own.values.size(); ++i)
            ASSERT_NEAR(own.values[i], ours.values[i], near) << machine << " " << i;
    }
}

/// The picture read three times, at places that depend on c8: differences of neighbours, worked out by hand.
TEST(WarpProgram, ReadsThePictureAsOftenAsItLikes) {
    const std::string edges =
        "ps_2_0\ndef c0, 1, 0, 0, 0.5\ndcl t0.xy\ndcl_2d s0\n"
        "mul r0.xy, c8.z, c0       ; a texel to the right\n"
        "add r1.xy, t0, r0\nadd r2.xy, t0, -r0\ntexld r1, r1, s0\ntexld r2, r2, s0\ntexld r3, t0, s0\n"
        "add r4, r1, -r2\nmad r4, r4, c0.w, r3\nmov oC0, r4\n";
    const Drawn drawn = drawn_by(edges, kExactly);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 1; x + 1 < kWidth; ++x)
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(drawn.at(x, y, c, 3),
                            texel(x, y, c) + 0.5F * (texel(x + 1, y, c) - texel(x - 1, y, c)), 1e-4)
                    << x << " " << y;
    EXPECT_EQ(drawn.says.count("anamorph:max_error"), 0u);
    EXPECT_EQ(refusal_of(edges, {{"output", "stmap"}}),
              "output=stmap: must be color with a program that does not read s0 exactly once");
}

/// A picture of one channel is x; y and z are 0, and w is 1.
TEST(WarpProgram, ChannelsThatThePictureHasNotAreZeroAndOne) {
    const std::string start = "ps_2_0\ndcl t0.xy\ndcl_2d s0\ntexld r0, t0, s0\n";
    EXPECT_NEAR(drawn_by(start + "mov oC0, r0\n", kExactly, 1).at(5, 5, 0, 1), texel(5, 5, 0), 1e-5);
    EXPECT_EQ(drawn_by(start + "mov r1, r0.z\nmov oC0, r1\n", kExactly, 1).at(5, 5, 0, 1), 0);
    EXPECT_EQ(drawn_by(start + "mov r1, r0.w\nmov oC0, r1\n", kExactly, 3).at(5, 5, 0, 3), 1);
    EXPECT_NEAR(drawn_by(start + "mov r1, r0.w\nmov oC0, r1\n", kExactly, 4).at(5, 5, 0, 4), texel(5, 5, 3),
                1e-5);
    EXPECT_EQ(refusal_of(start + "mov oC0, r0\n", {}, 5),
              "src has 5 channels: must have at most 4 with program");
}

TEST(WarpProgram, WhatIsWrongIsSaidWithItsLine) {
    const std::string good = "ps_2_0\ndcl t0.xy\ndcl_2d s0\ntexld r0, t0, s0\nmov oC0, r0\n";
    EXPECT_EQ(refusal_of("ps_2_0\ndcl_2d s5\nmov oC0, c0\n"),
              "own.ps: line 2: \"s5\": is not given to this program: must be s0 to s4");
    EXPECT_EQ(refusal_of("ps_2_0\n\ndcl t2\nmov oC0, t2\n"),
              "own.ps: line 3: \"t2\": is not given to this program: must be t0 to t1");
    EXPECT_EQ(refusal_of("ps_2_0\ndcl v0\nmov oC0, v0\n"),
              "own.ps: line 2: \"v0\": is not given to this program");
    EXPECT_THAT(refusal_of("ps_2_0\nfrob r0\n"), HasSubstr("own.ps: line 2: \"frob\": no such instruction"));
    EXPECT_EQ(refusal_of(good, {{"scheme", "exact"}, {"mesh", "grid.json"}}),
              "program=own.ps: must be given with scheme=hardware only");
    EXPECT_EQ(refusal_of(good, {{"direction", "push"}}),
              "machine: ps20 draws meshes that pull, and no other warps");
    EXPECT_THAT(refusal_of(good, {{"machine", "ps20:texture_side=32"}}),
                HasSubstr("a source of 40x24 does not fit its textures: must be at most 32 either way"));
    EXPECT_THAT(refusal_of("", {{"scheme", "hardware"}}), HasSubstr("mesh is not given"));
}

}  // namespace
}  // namespace anamorph
