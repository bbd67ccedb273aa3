// SPDX-License-Identifier: Apache-2.0
// The pixel-shader unit: its assembler, its instructions, and mesh warps that are drawn by our own program.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "anamorph/approx/mesh_residual.h"
#include "anamorph/error.h"
#include "anamorph/machine/machine_text.h"
#include "anamorph/machine/shader_run.h"
#include "anamorph/number/half.h"
#include "mesh_cases.h"

namespace anamorph {
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
           "line 2: \"frob\": no such instruction; there are texld, mov, add, mul, mad, dp3, dp4, rcp, rsq, "
           "min, "
           "max, cmp");
    expect("mov r12, c0" + last, "line 2: \"r12\": must be r0 to r11");
    expect("mov r0, c32" + last, "line 2: \"c32\": must be c0 to c31");
    expect("mov r0, x0" + last,
           "line 2: \"x0\": no such register; there are r, c, t, v, s and oC with a number");
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
           "line 2: \"c0\": must be a register that can be written, r0 to r11 or oC0 to oC3");
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
              "warp.ps: line 66: is one instruction too many: a program can have 64 arithmetic instructions");
    EXPECT_EQ(message_of_shader(declared + repeated("texld r0, t0, s0", 32) + "mov oC0, r0"), "");
    EXPECT_EQ(message_of_shader(declared + repeated("texld r0, t0, s0", 33) + "mov oC0, r0"),
              "warp.ps: line 36: is one instruction too many: a program can have 32 texture instructions");
    const std::string first = declared + "texld r0, t0, s0\n";
    EXPECT_EQ(message_of_shader(first + repeated("texld r0, r0, s0", 3) + "mov oC0, r0"), "");
    EXPECT_EQ(message_of_shader(first + repeated("texld r0, r0, s0", 4) + "mov oC0, r0"),
              "warp.ps: line 8: a texture can be read by what was read of textures 3 times in a row at most");
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
}  // namespace anamorph
