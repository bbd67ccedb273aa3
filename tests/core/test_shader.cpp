// SPDX-License-Identifier: Apache-2.0
// The pixel-shader unit: its assembler, its instructions, and mesh warps that are drawn by our own program.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "anamorph/error.h"
#include "anamorph/machine/machine_text.h"
#include "anamorph/machine/shader_run.h"
#include "anamorph/mesh/mesh_residual.h"
#include "anamorph/number/half.h"
#include "mesh_cases.h"

namespace anamorph::test_shader {
using namespace machine;
namespace {

std::string message_of_shader(const std::string& body) {
    try {
        assemble_shader("ps_2_0\n" + body, "warp.ps");
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(ShaderProgram, ErrorsNameTheLine) {
    const auto expect = [](const std::string& body, const std::string& message) {
        EXPECT_EQ(message_of_shader(body), "warp.ps: " + message) << body;
    };
    EXPECT_EQ(message_of_shader("mov oC0, c0"), "");
    const std::string last = "\nmov oC0, r0";
    expect("frob r0, c0" + last,
           "line 2: \"frob\": no such instruction; there are texld, texldp, texldb, texkill, nop, mov, add, "
           "sub, mul, mad, lrp, abs, frc, dp2add, dp3, dp4, crs, nrm, rcp, rsq, exp, log, pow, sincos, min, "
           "max, "
           "cmp, m3x2, m3x3, m3x4, m4x3, m4x4");
    expect("mov r12, c0" + last, "line 2: \"r12\": must be r0 to r11");
    expect("mov r0, c32" + last, "line 2: \"c32\": must be c0 to c31");
    expect("mov r0, x0" + last,
           "line 2: \"x0\": no such register; there are r, c, t, v, s and oC with a number, and oDepth");
    expect("mov r0.yx, c0" + last, "line 2: \"r0.yx\": components of a mask must be in the order x, y, z, w");
    expect("mov r0, c0.xyyz" + last,
           "line 2: \"c0.xyyz\": a swizzle must be one component, or xyzw, yzxw, zxyw or wzyx");
    expect("mov r0, c0.q" + last, "line 2: \"c0.q\": must have x, y, z, w or r, g, b, a behind the point");
    expect("\n; a comment\nadd r0, r1, c0" + last, "line 4: \"r1.x\": is read before it is written");
    expect("mov r1.x, c0\nadd r0.xy, r1, c0" + last, "line 3: \"r1.y\": is read before it is written");
    expect("mov r0, t0" + last, "line 2: \"t0.x\": must be declared by dcl");
    expect("dcl t0.xy\nmov r0, t0" + last, "line 3: \"t0.z\": must be declared by dcl");
    expect("dcl t0\ntexld r0, t0, s0" + last, "line 3: \"s0\": must be declared by dcl_2d");
    expect("mov r0, c0\ndcl t0" + last, "line 3: \"dcl\": must stand before the first instruction");
    expect("dcl t0\ndcl t0" + last, "line 3: \"t0\": is declared twice");
    expect("def c0, 1, 2, 3" + last, "line 2: \"def\": must have 5 operands, and has 4");
    expect("def c0, 1, 2, 3, nan" + last, "line 2: \"nan\": must be a finite number");
    expect("def c0, 1, 2, 3, 4\ndef c0, 1, 2, 3, 4" + last, "line 3: \"c0\": is defined twice");
    expect("mad r0, c0, c1, c2" + last, "line 2: an instruction can read two different constants at most");
    expect("rcp r0.x, c0" + last, "line 2: \"c0\": must be one component, as in r0.x");
    expect("mov_x2 r0, c0" + last, "line 2: \"mov_x2\": must have _sat and _pp at most behind it, each once");
    expect("mov_sat_sat r0, c0" + last,
           "line 2: \"mov_sat_sat\": must have _sat and _pp at most behind it, each once");
    expect("add oC0, c0, c1", "line 2: \"oC0\": must be written by mov, all of it");
    expect("mov c0, c1" + last,
           "line 2: \"c0\": must be a register that can be written, r0 to r11, oC0 to oC3 or oDepth");
    const char* const unwritten = "is the last one, and all of oC0 has not been written: must be by then";
    expect("mov r0, c0", std::string("line 2: ") + unwritten);
    expect("mov r0, c0\n\n; the end\n", std::string("line 4: ") + unwritten);
    expect("mov r0, c0\n\n", std::string("line 3: ") + unwritten);
    const auto whole = [](const char* text) -> std::string {
        try {
            assemble_shader(text, "none");
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_EQ(whole(""), "none: line 1: is empty: the first line must be ps_2_0");
    EXPECT_EQ(whole("\n\n"), "none: line 2: is empty: the first line must be ps_2_0");
    EXPECT_THROW(assemble_shader("vs_2_0\n", "none"), Error);
    EXPECT_EQ(whole("\xef\xbb\xbfps_2_0\r\nmov oC0, c0\r\n"), "");
}

TEST(ShaderProgram, HasTheLimitsOfTheProfile) {
    const auto repeated = [](const std::string& line, int count) {
        std::string text;
        for (int i = 0; i < count; ++i) text += line + "\n";
        return text;
    };
    const std::string declared = "dcl t0\ndcl_2d s0\n";
    EXPECT_EQ(message_of_shader(repeated("mov r0, c0", 63) + "mov oC0, r0"), "");
    EXPECT_EQ(message_of_shader(repeated("mov r0, c0", 64) + "mov oC0, r0"),
              "warp.ps: line 66: is one instruction too many: a program can have 64 slots of arithmetic "
              "instructions");
    std::string reads;
    for (int i = 0; i < 32; ++i) reads += "texld r" + std::to_string(i % 8) + ", t0, s0\n";
    EXPECT_EQ(message_of_shader(declared + reads + "mov oC0, r0"), "");
    EXPECT_EQ(message_of_shader(declared + reads + "texkill t0\nmov oC0, r0"),
              "warp.ps: line 36: is one instruction too many: a program can have 32 texture instructions");
    const std::string first = declared + "texld r0, t0, s0\n";
    EXPECT_EQ(message_of_shader(first + repeated("texld r0, r0, s0", 3) + "mov oC0, r0"), "");
    const std::string fourth =
        ": is a dependent read of order 4: must be of order 3 at most (one more than those whose registers "
        "it "
        "reads or writes again)";
    EXPECT_EQ(message_of_shader(first + repeated("texld r0, r0, s0", 4) + "mov oC0, r0"),
              "warp.ps: line 8" + fourth);
    // Coordinates that were computed, and a register that is written again.
    EXPECT_EQ(message_of_shader(declared + "mov r0, t0\n" + repeated("texld r0, r0, s0", 4) + "mov oC0, r0"),
              "warp.ps: line 8" + fourth);
    EXPECT_EQ(message_of_shader(first + repeated("texld r0, t0, s0", 4) + "mov oC0, r0"),
              "warp.ps: line 8" + fourth);
}

/// Slots as the table "ps_2_0 Instructions" of Microsoft's reference has them.
TEST(ShaderProgram, CountsTheSlotsOfTheProfile) {
    const std::string ahead =
        "ps_2_0\ndcl t0\ndcl_2d s0\ndef c30, -1.5500992e-6, -2.1701389e-5, 0.0026041667, 0.00026041668\n"
        "def c31, -0.020833334, -0.125, 1, 0.5\nmov r1, t0\n";
    struct Case {
        const char* line;
        int arithmetic, texture;
    };
    for (const Case& which : std::initializer_list<Case>{{"abs r0, r1", 1, 0},
                                                         {"add r0, r1, c0", 1, 0},
                                                         {"cmp r0, r1, c0, c1", 1, 0},
                                                         {"crs r0.xyz, r1, c0", 2, 0},
                                                         {"dp2add r0, r1, c0, c1.x", 2, 0},
                                                         {"dp3 r0, r1, c0", 1, 0},
                                                         {"dp4 r0, r1, c0", 1, 0},
                                                         {"exp r0, r1.x", 1, 0},
                                                         {"frc r0, r1", 1, 0},
                                                         {"log r0, r1.x", 1, 0},
                                                         {"lrp r0, r1, c0, c1", 2, 0},
                                                         {"m3x2 r0.xy, r1, c0", 2, 0},
                                                         {"m3x3 r0.xyz, r1, c0", 3, 0},
                                                         {"m3x4 r0, r1, c0", 4, 0},
                                                         {"m4x3 r0.xyz, r1, c0", 3, 0},
                                                         {"m4x4 r0, r1, c0", 4, 0},
                                                         {"mad r0, r1, c0, c1", 1, 0},
                                                         {"max r0, r1, c0", 1, 0},
                                                         {"min r0, r1, c0", 1, 0},
                                                         {"mov r0, r1", 1, 0},
                                                         {"mul r0, r1, c0", 1, 0},
                                                         {"nop", 1, 0},
                                                         {"nrm r0, r1", 3, 0},
                                                         {"pow r0, r1.x, c0.y", 3, 0},
                                                         {"rcp r0, r1.x", 1, 0},
                                                         {"rsq r0, r1.x", 1, 0},
                                                         {"sincos r0.xy, r1.x, c30, c31", 8, 0},
                                                         {"sub r0, r1, c0", 1, 0},
                                                         {"texkill r1", 0, 1},
                                                         {"texld r0, r1, s0", 0, 1},
                                                         {"texldb r0, r1, s0", 0, 1},
                                                         {"texldp r0, r1, s0", 0, 1},
                                                         {"mov oDepth, r1.x", 1, 0}}) {
        const ShaderProgram program = assemble_shader(ahead + which.line + "\nmov oC0, r1\n", "slots");
        EXPECT_EQ(program.arithmetic - 2, which.arithmetic) << which.line;
        EXPECT_EQ(program.texture, which.texture) << which.line;
        EXPECT_EQ(shader_listing(assemble_shader(shader_listing(program), "again")), shader_listing(program));
    }
}

/// What the reference's pages of single instructions and registers refuse.
TEST(ShaderProgram, RefusesWhatTheProfileDoes) {
    const auto refused = [](const std::string& body, const std::string& why) {
        const std::string message = message_of_shader(
            "dcl t0\ndcl v0\ndcl v1\ndcl_2d s0\nmov r1, t0\nmov r2, r1\n" + body + "\nmov oC0, r1\n");
        EXPECT_NE(message.find(why), std::string::npos) << body << ": " << message;
    };
    refused("add r0, v0, v1", "an instruction can read one of v0 and v1 at most");
    refused("mad r0, v0, r1, -v1.x", "an instruction can read one of v0 and v1 at most");
    EXPECT_EQ(message_of_shader("dcl v0\nadd r0, v0, v0\nmov oC0, r0"), "");
    const char* const plain = "must be without swizzle and minus";
    refused("mov oC0, -r1", plain);
    refused("mov oC0, r1.wzyx", plain);
    refused("mov_pp oC0, r1", "must be written by mov, all of it");
    refused("mov oC0, r1", "\"oC0\": is written twice: must be written once");
    refused("mov oC2, r1", "oC2 has been written and oC1 has not");
    refused("mov oDepth, r1", "must be one component without a minus");
    refused("mov oDepth, -r1.x", "must be one component without a minus");
    refused("mov oDepth, r1.x\nmov oDepth, r1.x", "\"oDepth\": is written twice");
    refused("add oDepth, r1.x, r1.x", "must be written by mov");
    refused("mov r0, oDepth", "cannot be read");
    const char* const other = "must be another register than the one that is written";
    refused("nrm r1, r1", other);
    refused("pow r1, r2.x, r1.x", other);
    refused("pow r0, r1, r2.x", "must be one component");
    refused("exp r0, r1", "must be one component");
    refused("log r0, r1", "must be one component");
    refused("dp2add r0, r1, r2, c0", "must be one component");
    refused("crs r1.xyz, r1, r2", other);
    refused("crs r0, r1, r2", "what crs writes must be of x, y and z alone");
    refused("crs r0.xyz, r1.yzxw, r2", "must be without swizzle");
    refused("frc_sat r0, r1", "cannot have _sat");
    refused("texld_sat r0, t0, s0", "cannot have _sat");
    refused("sincos r0, r1.x, c0, c1", "what sincos writes must be .x, .y or .xy");
    refused("sincos r0.xy, r1, c0, c1", "must be one component");
    refused("sincos r0.xy, r1.x, c0, c0", "must be one of two different constants");
    refused("sincos r0.xy, r1.x, c0, r2", "must be one of two different constants");
    refused("sincos r2.xy, r1.x, c0, c1\nmov r3.z, r2", "\"r2.z\": is read before it is written");
    refused("sincos r2.x, r1.x, c0, c1\nmov r3.y, r2", "\"r2.y\": is read before it is written");
    EXPECT_NE(
        message_of_shader("dcl t0\ndef c0, 1, 2, 3, 4\nsincos r0.xy, t0.x, c0, c1\nmov oC0, t0")
            .find("must be -1.5500992e-06, -2.1701389e-05, 0.0026041667, 0.00026041668 (D3DSINCOSCONST1)"),
        std::string::npos);
    refused("m3x2 r0.xyz, r1, c0", "what m3x2 writes must be the components .xy");
    refused("m4x4 r0.x, r1, c0", "what m4x4 writes must be all of a register");
    refused("m3x3 r0.xyz, r1, c30", "must be the first of 3 registers");
    refused("m3x3 r1.xyz, r1, c0", other);
    refused("m3x2 r2.xy, r1, r1", other);
    refused("m3x2 r0.xy, r1, -c0", plain);
    refused("texldp r0, v0, s0", "texldp must have a register r or t and a texture");
    refused("texldp r0.xy, t0, s0", "must be all of a register");
    refused("texkill c0", "texkill must have a register r or t");
    refused("texkill r1.x", "texkill must have a register r or t, without components");
    refused("mov r3.xy, r1\ntexldp r0, r3, s0", "\"r3.w\": is read before it is written");
    refused("mov r3.xy, r1\ntexkill r3", "\"r3.z\": is read before it is written");
    refused("nop r0", "must have 0 operands, and has 1");
}

TEST(ShaderProgram, ListingsAssembleToTheSame) {
    const std::string text =
        "ps.2.0 // as it was first called\ndcl_pp t1.rg\ndcl v0\ndcl_2d s3\ndef c4, 1, -2.5, 1e-3, 0\n"
        "texld r1, t1, s3\nmad_sat_pp r0.xw, -r1.wzyx, c4.r, v0 ; comment\nmov r0.yz, c4\nmov oC0, r0\n";
    const ShaderProgram program = assemble_shader(text, "text");
    EXPECT_EQ(shader_listing(program),
              "ps_2_0\ndcl t1.xy\ndcl v0\ndcl_2d s3\ndef c4, 1, -2.5, 0.001, 0\ntexld r1, t1, s3\n"
              "mad_sat_pp r0.xw, -r1.wzyx, c4.x, v0\nmov r0.yz, c4\nmov oC0, r0\n");
    EXPECT_EQ(shader_listing(assemble_shader(shader_listing(program), "again")), shader_listing(program));
    EXPECT_EQ(program.arithmetic, 3);
    EXPECT_EQ(program.texture, 1);
}

using Float32 = FormatNumber<kFloat32>;

/// What one instruction makes of c0, c1 and r2, all four components.
std::array<float, 4> computed(const std::string& instruction, const std::array<std::array<float, 4>, 3>& v) {
    const ShaderProgram program =
        assemble_shader("ps_2_0\ndcl v0\nmov r2, v0\nmov r0, c0\n" + instruction + "\nmov oC0, r0\n", "one");
    ShaderInputs<Float32> inputs(program);
    for (std::size_t i = 0; i < 4; ++i) {
        inputs.constants[0][i] = Float32(v[0][i]);
        inputs.constants[1][i] = Float32(v[1][i]);
        inputs.colors[0][i] = Float32(v[2][i]);
    }
    const auto result = ShaderMachine<Float32>(program, inputs).run([](int, Float32, Float32) {
        return ShaderVector<Float32>{};
    });
    std::array<float, 4> out{};
    for (std::size_t i = 0; i < 4; ++i) out[i] = static_cast<float>(result[i].value);
    return out;
}

/// In arithmetic of float, component by component.
TEST(ShaderMachine, BothZerosHaveTheSameRoot) {
    const std::array<std::array<float, 4>, 3> v{{{0, 0, 0, 0}, {-0.0f, 0, 0, 0}, {0, 0, 0, 0}}};
    EXPECT_EQ(computed("rsq_sat r0, -c0.x", v)[0], 1);
    EXPECT_EQ(computed("rsq_sat r0, c1.x", v)[0], 1);
    EXPECT_EQ(computed("rsq_sat r0, c1.xxxx", v)[0], 1);
}

TEST(ShaderMachine, InstructionsComputeAsTheProcessorDoes) {
    constexpr unsigned kSeed = 11;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<float> uniform(-2, 2);
    for (int n = 0; n < 50; ++n) {
        std::array<std::array<float, 4>, 3> v{};
        for (auto& vector : v)
            for (float& x : vector) x = uniform(random);
        const std::array<float, 4>& a = v[0];
        const std::array<float, 4>& b = v[1];
        const std::array<float, 4>& c = v[2];
        const auto expect = [&](const std::string& instruction,
                                const std::function<float(std::size_t)>& wanted) {
            const std::array<float, 4> got = computed(instruction, v);
            for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(got[i], wanted(i)) << instruction << " " << i;
        };
        expect("mov r0, -c1", [&](std::size_t i) { return -b[i]; });
        expect("add r0, c0, c1", [&](std::size_t i) { return a[i] + b[i]; });
        expect("mul r0, c0, r2", [&](std::size_t i) { return a[i] * c[i]; });
        expect("mad r0, c0, c1, r2", [&](std::size_t i) {
            const volatile float product = a[i] * b[i];
            return product + c[i];
        });
        const auto dot = [&](std::size_t count) {
            volatile float sum = a[0] * b[0];
            for (std::size_t k = 1; k < count; ++k) {
                const volatile float product = a[k] * b[k];
                sum = sum + product;
            }
            return float(sum);
        };
        expect("dp3 r0, c0, c1", [&](std::size_t) { return dot(3); });
        expect("dp4 r0, c0, c1", [&](std::size_t) { return dot(4); });
        expect("rcp r0, c1.y", [&](std::size_t) { return 1 / b[1]; });
        expect("rsq r0, c1.w", [&](std::size_t) { return 1 / std::sqrt(std::fabs(b[3])); });
        expect("min r0, c0, c1", [&](std::size_t i) { return std::min(a[i], b[i]); });
        expect("max r0, c0, c1", [&](std::size_t i) { return std::max(a[i], b[i]); });
        expect("cmp r0, r2, c0, c1", [&](std::size_t i) { return c[i] >= 0 ? a[i] : b[i]; });
        expect("sub r0, c0, c1", [&](std::size_t i) { return a[i] - b[i]; });
        expect("abs r0, c1", [&](std::size_t i) { return std::fabs(b[i]); });
        expect("frc r0, c1", [&](std::size_t i) { return b[i] - std::floor(b[i]); });
        expect("lrp r0, c0, c1, r2", [&](std::size_t i) {
            const volatile float product = a[i] * (b[i] - c[i]);
            return product + c[i];
        });
        expect("dp2add r0, c0, c1, r2.w", [&](std::size_t) {
            const volatile float x = a[0] * b[0], y = a[1] * b[1], sum = x + y;
            return sum + c[3];
        });
        expect("crs r0.xyz, c0, c1", [&](std::size_t i) {
            const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
            const volatile float first = a[j] * b[k], second = a[k] * b[j];
            return i < 3 ? first - second : a[3];
        });
        expect("nrm r0, c1", [&](std::size_t i) {
            const volatile float x = b[0] * b[0], y = b[1] * b[1], z = b[2] * b[2], xy = x + y;
            return b[i] * (1 / std::sqrt(xy + z));
        });
        expect("exp r0, c1.x", [&](std::size_t) { return float(std::exp2(double(b[0]))); });
        expect("log r0, c1.x", [&](std::size_t) { return float(std::log2(std::fabs(double(b[0])))); });
        expect("pow r0, c0.y, c1.z", [&](std::size_t) {
            const volatile float logarithm = float(std::log2(std::fabs(double(a[1]))));
            const volatile float product = b[2] * logarithm;
            return float(std::exp2(double(product)));
        });
        // Rows c0 and c1.
        expect("m3x2 r0.xy, -r2.yzxw, c0", [&](std::size_t i) {
            if (i > 1) return a[i];
            const auto& row = i == 0 ? a : b;
            volatile float sum = -c[1] * row[0];
            for (std::size_t k = 1; k < 3; ++k) {
                const volatile float product = -c[(k + 1) % 3] * row[k];
                sum = sum + product;
            }
            return float(sum);
        });
        expect("mov_sat r0, c1", [&](std::size_t i) { return std::clamp(b[i], 0.0f, 1.0f); });
        expect("mov_pp r0, c1", [&](std::size_t i) { return float_from_half(half_from_float(b[i])); });
        expect("add r0.yw, c0, c1.yzxw", [&](std::size_t i) {
            return i == 1 ? a[1] + b[2] : i == 3 ? a[3] + b[3] : a[i];
        });
        expect("mov r0, c1.zxyw", [&](std::size_t i) { return b[std::array{2, 0, 1, 3}[i]]; });
        expect("mov r0, c1.wzyx", [&](std::size_t i) { return b[3 - i]; });
        expect("mov r0, c1.b", [&](std::size_t) { return b[2]; });
    }
    const std::array<float, 4> huge{1e38f, -1e38f, 0, NAN};
    EXPECT_EQ(computed("mul r0, c0, c0", {huge, huge, huge})[0], HUGE_VALF);
    EXPECT_EQ(computed("mov_sat r0, c0", {huge, huge, huge}), (std::array<float, 4>{1, 0, 0, 0}));
    EXPECT_EQ(computed("rcp r0, c0.z", {huge, huge, huge})[0], HUGE_VALF);
    // What the reference says of 0: FLT_MAX in place of infinities.
    const std::array<float, 4> zero{};
    constexpr float kMost = std::numeric_limits<float>::max();
    EXPECT_EQ(computed("log r0, c0.x", {zero, zero, zero})[0], -kMost);
    EXPECT_EQ(computed("nrm r0, c0", {{{0, -0.0f, 0, 1}, zero, zero}}),
              (std::array<float, 4>{0, -0.0f, 0, kMost}));
    EXPECT_EQ(computed("pow r0, c0.x, c0.x", {zero, zero, zero})[0], 1);
}

/// The reference of Direct3D states 0.002 as the largest error of sin and cos from -pi to pi.
TEST(ShaderMachine, SincosIsWithinWhatTheReferenceStates) {
    const ShaderProgram program = assemble_shader(
        "ps_2_0\ndcl t0\ndef c4, -1.5500992e-6, -2.1701389e-5, 0.0026041667, 0.00026041668\n"
        "def c5, -0.020833334, -0.125, 1, 0.5\nmov r0, t0\nsincos r0.xy, -t0.y, c4, c5\nmov r0.z, t0\n"
        "mov oC0, r0\n",
        "sincos");
    ShaderInputs<Float32> inputs(program);
    double most = 0;
    for (int i = -1000; i <= 1000; ++i) {
        const double angle = i * 3.14159265358979 / 1000;
        inputs.coordinates[0] = {Float32(7.0), Float32(-angle), Float32(8.0), Float32(9.0)};
        const auto got = ShaderMachine<Float32>(program, inputs).run([](int, Float32, Float32) {
            return ShaderVector<Float32>{};
        });
        most = std::max(
            {most, std::fabs(got[0].value - std::cos(angle)), std::fabs(got[1].value - std::sin(angle))});
        EXPECT_EQ(got[3].value, 9);
    }
    EXPECT_LT(most, 0.002);
    EXPECT_GT(most, 0.0015);  // the series are seen
}

TEST(ShaderMachine, TexturesAreReadProjectedAndPixelsKilled) {
    const auto run = [](const std::string& line, const std::array<double, 4>& at, bool& killed) {
        const ShaderProgram program =
            assemble_shader("ps_2_0\ndcl t0\ndcl_2d s2\nmov r0, t0\n" + line + "\nmov oC0, r0\n", "one");
        ShaderInputs<Float32> inputs(program);
        for (std::size_t i = 0; i < 4; ++i) inputs.coordinates[0][i] = Float32(at[i]);
        ShaderMachine<Float32> machine(program, inputs);
        const auto result = machine.run([](int number, Float32 u, Float32 v) {
            return ShaderVector<Float32>{u, v, Float32(number), Float32(1.0)};
        });
        killed = machine.killed();
        return std::array<double, 4>{result[0].value, result[1].value, result[2].value, result[3].value};
    };
    bool killed = true;
    EXPECT_EQ(run("texldp r0, t0, s2", {1, 3, 5, 4}, killed), (std::array<double, 4>{0.25, 0.75, 2, 1}));
    EXPECT_FALSE(killed);
    EXPECT_EQ(run("texldb r0, t0, s2", {0.5, 0.25, 0, 3}, killed), (std::array<double, 4>{0.5, 0.25, 2, 1}));
    EXPECT_EQ(run("texkill t0", {0, -0.0, 2, -1}, killed), (std::array<double, 4>{0, 0, 2, -1}));
    EXPECT_FALSE(killed);
    for (std::size_t i = 0; i < 3; ++i) {
        std::array<double, 4> at{1, 1, 1, 1};
        at[i] = -1e-30;
        EXPECT_EQ(run("texkill r0", at, killed), (std::array<double, 4>{}));
        EXPECT_TRUE(killed);
    }
}

/// Our own program against the mesh's formula: products from tables of n texels are off by (|f_ss| + |f_tt|) / (8 n^2)
/// of a cell at most (ResidualTables::bound has it for 256 cells), and the rest is rounding: of 30 or so operations on
/// numbers of the size of texture coordinates, and of the address.
TEST(ShadedWarp, AgreesWithTheMeshToTheFormatsError) {
    constexpr unsigned kSeed = 5;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    const Size size{160, 120};
    for (const int levels : {0, 2}) {
        test::Random random(kSeed);
        const Mesh mesh(test::random_mesh(random, size, size, 4, 3, 0.3, false, levels), size, size, 1);
        struct Case {
            NumberFormat format;
            double unit;
        };
        for (const Case& which :
             {Case{kFloat32, 0x1p-24}, Case{kFloat24, 0x1p-17}, Case{kFixed32, 0x1p-17}}) {
            for (const int table : {33, 257}) {
                ShaderUnit shader;
                shader.arithmetic = which.format;
                shader.table_size = table;
                shader.weight_bits = 23;
                shader.address_bits = 16;
                const ShadedWarp warp(mesh, shader);
                double most = 0;
                for (const Block& block : warp.blocks(0)) {
                    std::vector<double> x(80), y(80);
                    std::vector<std::int32_t> piece(80);
                    for (int row = 0; row < block.box.height(); ++row) {
                        warp.exact_rows(block, row, row + 1, {x.data(), y.data(), piece.data(), 80});
                        for (std::size_t i = 0; i < std::size_t(block.box.width()); ++i) {
                            const double px = block.box.x0 + double(i) + 0.5, py = block.box.y0 + row + 0.5;
                            const Point<double> exact = mesh.at(px, py);
                            const double off = std::hypot(x[i] - exact.x, y[i] - exact.y);
                            const ResidualPatch residual(mesh.patch(mesh.cell_at(px, py)));
                            const double tables =
                                ResidualTables::shared()->bound(residual) * std::pow(256.0 / (table - 1), 2);
                            ASSERT_LE(off, tables + 60 * which.unit * size.width)
                                << name_of(which.format) << " " << table;
                            ASSERT_LE(off, block.bound);
                            most = std::max(most, off);
                        }
                    }
                }
                // The tables of 33 texels and the coarse formats are seen.
                EXPECT_GT(most, table == 33 ? 0.002 : 0.5 * which.unit * size.width);
            }
        }
    }
}

TEST(ShadedWarp, RefusesWhatItCannotRepresent) {
    const Size size{64, 48};
    ShaderUnit unit;
    unit.texture_side = 32;
    try {
        const ShadedWarp warp(Mesh(test::identity_mesh(size, 2, 2), size, size, 1), unit);
        FAIL();
    } catch (const Error& e) {
        EXPECT_STREQ(e.what(),
                     "machine: a source of 64x48 does not fit its textures: must be at most 32 either way");
    }
}

TEST(ShadedWarp, KilledPixelsHaveNoPoint) {
    const Size size{64, 48};
    const ShadedWarp warp(
        Mesh(test::identity_mesh(size, 2, 2), size, size, 1), ShaderUnit(),
        assemble_shader("ps_2_0\ndcl t0\ndcl_2d s0\ndef c20, -0.5, 0, 0, 0\nadd r1, t0, c20\n"
                        "texkill r1\ntexldp r0, t0, s0\nmov oC0, r0\n",
                        "half", kWarpSlots));
    const auto white = [](const Point<double>&) { return std::array<double, 4>{1, 1, 1, 1}; };
    for (const Block& block : warp.blocks(0)) {
        std::vector<double> x(64), y(64);
        std::vector<std::int32_t> piece(64);
        for (int row = 0; row < block.box.height(); ++row) {
            warp.exact_rows(block, row, row + 1, {x.data(), y.data(), piece.data(), 64});
            for (int i = 0; i < block.box.width(); ++i) {
                const int px = block.box.x0 + i;
                EXPECT_EQ(piece[std::size_t(i)], px < 32 ? -1 : 0);
                EXPECT_EQ(warp.color(px, block.box.y0 + row, white)[0], px < 32 ? 0 : 1);
            }
        }
    }
}

TEST(ShadedWarp, SaturatesAndCounts) {
    const Size size{64, 48};
    ControlMesh mesh = test::identity_mesh(size, 2, 2);
    mesh.vertices[4] = {64 * 40.0, 24};
    ShaderUnit unit;
    unit.arithmetic = kFixed16;
    EXPECT_GT(ShadedWarp(Mesh(mesh, size, size, 1), unit).saturated_pixels(serial_for), 100);
    EXPECT_EQ(ShadedWarp(Mesh(mesh, size, size, 0), unit).saturated_pixels(serial_for), 0);
}

}  // namespace
}  // namespace anamorph::test_shader
