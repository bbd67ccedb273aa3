// SPDX-License-Identifier: Apache-2.0
// Programs of the user's in warps: what they find, what they draw, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "anamorph/image/source.h"
#include "anamorph/machine/shaded_warp.h"
#include "anamorph/operation/operation.h"

namespace anamorph::test_warp_program {
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
            EXPECT_EQ(drawn_by(warp_program(ShaderLayout::ours), shown).values, drawn_by("", shown).values)
                << output;
        }
        const Drawn own = drawn_by(warp_program(ShaderLayout::ours), values), ours = drawn_by("", values);
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

// The program of Kim 2003, Appendix A, instruction by instruction as it is printed.
const std::string kAppendix = R"(ps.2.0

dcl t0.rg
dcl t1.rg

dcl_2d s0
dcl_2d s1
dcl_2d s2
dcl_2d s3
dcl_2d s4

texld r1, t1, s1 ;
texld r2, t1, s2 ;
texld r3, t1, s3 ;
texld r4, t1, s4 ;

//
dp4 r5.x, r1, c0
dp4 r6.x, r2, c1
dp4 r7.x, r4, c5
dp4 r5.y, r1, c2
dp4 r6.y, r2, c3
dp4 r7.y, r4, c6

add r5.xy, r5, r6
add r5.xy, r5, r7

//
mad r5.xy, r3.r, c4, r5

//
add r0.xy, r5, t0
texld r0, r0, s0
mov r0.a, c4.a

mov oC0, r0
)";

/// kMesh in a picture of kWidth x kHeight, after section 5.3: displacements in pixels, derivatives by eq. 5.8 with the border
/// extrapolated, and the elements of eq. 5.5 and 5.7.
struct PrintedMesh {
    /// Of vertex (i, j), which may lie one beyond the border: x (k = 0) or y.
    static double displacement(int i, int j, int k) {
        if (i < 0) return 2 * displacement(0, j, k) - displacement(1, j, k);
        if (i > 2) return 2 * displacement(2, j, k) - displacement(1, j, k);
        if (j < 0) return 2 * displacement(i, 0, k) - displacement(i, 1, k);
        if (j > 2) return 2 * displacement(i, 2, k) - displacement(i, 1, k);
        if (i != 1 || j != 1) return 0;
        return k == 0 ? 0.61 * kWidth - 20 : 0.42 * kHeight - 12;
    }
    /// The matrix G of eq. 5.3 of a cell: rows by s, columns by t.
    static std::array<std::array<double, 4>, 4> geometry(int column, int row, int k) {
        const auto x = [&](int i, int j) { return displacement(i, j, k); };
        std::array<std::array<double, 4>, 4> g{};
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b) {
                const int i = column + a, j = row + b;
                const auto s = static_cast<std::size_t>(a), t = static_cast<std::size_t>(b);
                g[s][t] = x(i, j);
                g[s + 2][t] = (x(i + 1, j) - x(i - 1, j)) / 2;
                g[s][t + 2] = (x(i, j + 1) - x(i, j - 1)) / 2;
                g[s + 2][t + 2] = (x(i + 1, j + 1) - x(i - 1, j + 1) - x(i + 1, j - 1) + x(i - 1, j - 1)) / 4;
            }
        return g;
    }
    /// G_N1 or G_N2, and the plane that they are counted from: its value at (0, 0), along s and along t.
    struct Parts {
        std::array<std::array<double, 4>, 4> n;
        double origin, right, down;
    };
    static Parts parts(int column, int row, int k, bool second) {
        const auto g = geometry(column, row, k);
        Parts p{g, g[0][0], g[1][0] - g[0][0], g[0][1] - g[0][0]};
        if (second) {
            p.right = g[1][1] - g[0][1];
            p.down = g[1][1] - g[1][0];
            p.origin = g[1][0] + g[0][1] - g[1][1];
        }
        for (std::size_t a = 0; a < 2; ++a)
            for (std::size_t b = 0; b < 2; ++b) {
                p.n[a][b] -= p.origin + p.right * double(a) + p.down * double(b);
                p.n[a + 2][b] -= p.right;
                p.n[a][b + 2] -= p.down;
            }
        return p;
    }
};

/// The functions of s or t of eq. 5.3, S M.
std::array<double, 4> cubics(double s) {
    return {(2 * s - 3) * s * s + 1, (3 - 2 * s) * s * s, s * (1 - s) * (1 - s), s * s * (s - 1)};
}

/// What the program makes of a pixel in floats: 16 factors for each coordinate, tables of 256 texels that are read with weights of 8 bits.
Point<double> printed_by_floats(int x, int y) {
    const double in_x = (x + 0.5) / (kWidth / 2), in_y = (y + 0.5) / (kHeight / 2);
    const int column = static_cast<int>(in_x), row = static_cast<int>(in_y);
    const double s = in_x - column, t = in_y - row;
    const bool second = s + t > 1;
    // A product of the a-th cubic of s and the b-th of t, as texture hardware reads it.
    const auto product = [&](std::size_t a, std::size_t b) {
        const auto place = [](double at, int& first, float& weight) {
            const double in = std::clamp(double{static_cast<float>(at)} * 256 - 0.5, 0.0, 255.0);
            first = static_cast<int>(in);
            weight = static_cast<float>(std::nearbyint((in - first) * 256) / 256);
        };
        int i = 0, j = 0;
        float u = 0, v = 0;
        place(s, i, u);
        place(t, j, v);
        const auto texel = [&](int m, int n) {
            return static_cast<float>(cubics((std::min(m, 255) + 0.5) / 256)[a] *
                                      cubics((std::min(n, 255) + 0.5) / 256)[b]);
        };
        const auto across = [&](int n) { return texel(i, n) + (texel(i + 1, n) - texel(i, n)) * u; };
        return across(j) + (across(j + 1) - across(j)) * v;
    };
    Point<double> at{};
    for (const int k : {0, 1}) {
        const PrintedMesh::Parts p = PrintedMesh::parts(column, row, k, second);
        const double size = k == 0 ? kWidth : kHeight;
        const auto factor = [&](std::size_t a, std::size_t b) {
            return static_cast<float>(double{static_cast<float>(p.n[a][b])} / size);
        };
        const auto dp4 = [&](const std::size_t(&e)[4][2]) {
            float sum = product(e[0][0], e[0][1]) * factor(e[0][0], e[0][1]);
            for (std::size_t i = 1; i < 4; ++i) sum += product(e[i][0], e[i][1]) * factor(e[i][0], e[i][1]);
            return sum;
        };
        static constexpr std::size_t kFirst[4][2] = {{0, 2}, {0, 3}, {1, 2}, {1, 3}},
                                     kSecond[4][2] = {{2, 0}, {2, 1}, {2, 2}, {2, 3}},
                                     kThird[4][2] = {{3, 0}, {3, 1}, {3, 2}, {3, 3}};
        const float planar = dp4(kFirst) + dp4(kSecond) + dp4(kThird);
        const std::size_t corner = second ? 0 : 1;
        const float perturbed = product(corner, corner) * factor(corner, corner) + planar;
        const auto linear =
            static_cast<float>(((k == 0 ? x : y) + 0.5 + p.origin + p.right * s + p.down * t) / size);
        (k == 0 ? at.x : at.y) = double{perturbed + linear};
    }
    return at;
}

const std::vector<Assignment> kPrinted = {{"mesh", "grid.json"},
                                          {"machine", "kim-2003:arithmetic=float32,address_bits=16"},
                                          {"filter", "bilinear"}};

TEST(PrintedProgram, HasSeventeenInstructionsAndOursEighteen) {
    for (const auto& [text, count] :
         {std::pair(kAppendix, 17), std::pair(std::string(warp_program(ShaderLayout::printed)), 17),
          std::pair(std::string(warp_program(ShaderLayout::ours)), 18)}) {
        const ShaderProgram program = assemble_shader(text, "program", kWarpSlots);
        EXPECT_EQ(program.instructions.size(), static_cast<std::size_t>(count));
        EXPECT_EQ(program.arithmetic + program.texture, count);
    }
}

/// As printed, and as the preset has it by itself; source points to the bit.
TEST(PrintedProgram, RunsOnAMeshAsPrinted) {
    std::vector<Assignment> shown = kPrinted;
    shown.push_back({"output", "stmap"});
    const Drawn printed = drawn_by(kAppendix, shown);
    EXPECT_EQ(printed.values, drawn_by("", shown).values);
    double most = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const Point<double> at = printed_by_floats(x, y);
            const auto address = [](double u, int size) {
                return std::nearbyint(u * size * 65536) / 65536 / size;
            };
            ASSERT_EQ(printed.at(x, y, 0, 2), static_cast<float>(address(at.x, kWidth))) << x << " " << y;
            ASSERT_EQ(printed.at(x, y, 1, 2), static_cast<float>(address(at.y, kHeight))) << x << " " << y;
            most = std::max(most, std::fabs(at.x * kWidth - x - 0.5));
        }
    EXPECT_GT(most, 3);
    // Texels at their centres are clamped half a texel before the edges of cells: 1/512 of derivatives of a few pixels.
    EXPECT_LT(printed.says.at("anamorph:max_error"), 0.02);
    // In our layout of registers it is something else.
    std::vector<Assignment> ours = shown;
    ours[1].value = "ps20:arithmetic=float32,address_bits=16";
    EXPECT_GT(drawn_by(kAppendix, ours).says.at("anamorph:max_error"), 1);
}

TEST(PrintedProgram, RegistersAreThoseOfThePaper) {
    const auto constant = [&](int number, int x, int y) {
        const Drawn drawn = drawn_by("ps_2_0\nmov oC0, c" + std::to_string(number) + "\n", kPrinted, 4);
        std::array<float, 4> four{};
        for (int c = 0; c < 4; ++c) four[static_cast<std::size_t>(c)] = drawn.at(x, y, c, 4);
        return four;
    };
    // Of the first cell: in its first triangle, and in its second.
    for (const bool second : {false, true}) {
        const int x = second ? 18 : 3, y = second ? 10 : 2;
        for (const int k : {0, 1}) {
            const PrintedMesh::Parts p = PrintedMesh::parts(0, 0, k, second);
            const double size = k == 0 ? kWidth : kHeight;
            const auto row = [&](std::initializer_list<std::pair<int, int>> elements) {
                std::array<float, 4> four{};
                auto* to = four.begin();
                for (const auto& [a, b] : elements)
                    *to++ = static_cast<float>(
                        double{static_cast<float>(
                            p.n[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)])} /
                        size);
                return four;
            };
            // But for what differences of double are off.
            const auto near = [](const std::array<float, 4>& four) {
                return testing::Pointwise(testing::FloatNear(1e-15F), four);
            };
            EXPECT_THAT(constant(k == 0 ? 0 : 2, x, y), near(row({{0, 2}, {0, 3}, {1, 2}, {1, 3}})));
            EXPECT_THAT(constant(k == 0 ? 1 : 3, x, y), near(row({{2, 0}, {2, 1}, {2, 2}, {2, 3}})));
            EXPECT_THAT(constant(k == 0 ? 5 : 6, x, y), near(row({{3, 0}, {3, 1}, {3, 2}, {3, 3}})));
            const int corner = second ? 0 : 1;
            EXPECT_EQ(constant(4, x, y)[static_cast<std::size_t>(k)], row({{corner, corner}})[0]);
        }
        EXPECT_EQ(constant(4, x, y)[2], 0);
        EXPECT_EQ(constant(4, x, y)[3], 1);
        EXPECT_EQ(constant(7, x, y), (std::array<float, 4>{}));
    }
    const Drawn t1 = drawn_by("ps_2_0\ndcl t1\nmov oC0, t1\n", kPrinted, 4);
    EXPECT_FLOAT_EQ(t1.at(3, 2, 0, 4), 3.5F / 20);
    EXPECT_FLOAT_EQ(t1.at(3, 2, 1, 4), 2.5F / 12);
}

TEST(PrintedProgram, WritesTheAlphaThatItIsGiven) {
    std::vector<Assignment> faded = kPrinted;
    faded[1].value = "kim-2003:arithmetic=float32,address_bits=16,alpha=0.25";
    const Drawn opaque = drawn_by("", kPrinted, 4), quarter = drawn_by("", faded, 4);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            ASSERT_EQ(opaque.at(x, y, 3, 4), 1);
            ASSERT_EQ(quarter.at(x, y, 3, 4), 0.25);
            ASSERT_EQ(quarter.at(x, y, 0, 4), opaque.at(x, y, 0, 4));
        }
}

TEST(PrintedProgram, WhatIsWrongIsSaid) {
    EXPECT_EQ(refusal_of("", kPrinted, 5), "src has 5 channels: must have at most 4 with machine=kim-2003");
    const auto machine = [&](const char* text) {
        std::vector<Assignment> values = kPrinted;
        values[1].value = text;
        return refusal_of("", values);
    };
    EXPECT_EQ(machine("kim-2003:alpha=2"), "machine: alpha=2: must be a number from 0 to 1");
    EXPECT_THAT(machine("ps20:alpha=1"), HasSubstr("\"alpha\": no such key"));
    EXPECT_THAT(machine("kim-2003:layout=1"), HasSubstr("\"layout\": no such key"));
    EXPECT_EQ(machine("kim-2004"),
              "machine=kim-2004: must be ps20, ps20:key=value,key=value or an object of JSON, {...}, or "
              "kim-2003 likewise");
}

}  // namespace
}  // namespace anamorph::test_warp_program
