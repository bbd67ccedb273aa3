// SPDX-License-Identifier: Apache-2.0
// Programs of pixel shader 2.0: the assembler of the profile, as Microsoft's reference of Direct3D 9 describes it
// ("ps_2_0 Instructions", "ps_2_0 Registers").
//
//   ps_2_0
//   dcl t0.xy              a coordinate that is interpolated over the triangle: t0 to t7; colors v0, v1
//   dcl_2d s0              a texture: s0 to s15; there are no cubes and volumes
//   def c0, 1, 2, 3, 4     a constant: c0 to c31
//   texld r0, t0, s0       reads a texture
//   mad_sat r0.xy, -r1, c0.x, r2.wzyx
//
// Texture instructions: texld, texldp (at x / w and y / w), texldb (with a bias of the level in w: textures have one level
// here, so that it reads as texld does), texkill. Arithmetic: mov, add, sub, mul, mad, dp3, dp4, rcp, rsq, exp, log, min, max,
// cmp, frc, abs, nop; lrp, crs, dp2add of two slots, nrm, pow of three, sincos of eight; m3x2, m3x3, m3x4, m4x3, m4x4, which
// are expanded to dp3 and dp4. With _sat (to 0..1; not of frc, sincos and textures) and _pp (16 bits), a mask behind the
// destination, and sources with a minus and one of the swizzles of the profile: a single component, or xyzw, yzxw, zxyw,
// wzyx. x, y, z, w are also r, g, b, a. What stands behind ; or // is a comment. Results go to oC0 to oC3 and oDepth, each
// written once by mov, without mask, modifier, minus and swizzle (of oDepth one component).
//
// The profile's limits: 64 slots of arithmetic and 32 texture instructions; r0 to r11; two different constants, one
// coordinate and one color in an instruction; dependent reads of the third order. A texture is read dependently where the
// coordinates are in r#, or the destination has been written before: then its order is one more than that of the reads that
// these registers hold.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace anamorph::machine {

enum class ShaderOpcode : std::uint8_t {
    texld,
    texldp,
    texldb,
    texkill,
    nop,
    mov,
    add,
    sub,
    mul,
    mad,
    lrp,
    abs,
    frc,
    dp2add,
    dp3,
    dp4,
    crs,
    nrm,
    rcp,
    rsq,
    exp,
    log,
    pow,
    sincos,
    min,
    max,
    cmp
};

/// Does an instruction read a texture, whose number is that of its second source?
constexpr bool samples(ShaderOpcode opcode) {
    return opcode == ShaderOpcode::texld || opcode == ShaderOpcode::texldp || opcode == ShaderOpcode::texldb;
}

/// Kinds of registers: r, c, t, v, s, oC, oDepth.
enum class ShaderBank : std::uint8_t { temporary, constant, coordinate, color, sampler, output, depth };

struct ShaderSource {
    ShaderBank bank = ShaderBank::temporary;
    int number = 0;
    bool negated = false;
    std::array<std::uint8_t, 4> swizzle{0, 1, 2, 3};  ///< the component that each is taken from
};

struct ShaderInstruction {
    ShaderOpcode opcode = ShaderOpcode::mov;
    bool saturated = false, partial = false;  ///< _sat, _pp
    ShaderBank bank = ShaderBank::temporary;  ///< bank of the destination
    int number = 0;
    std::uint8_t mask = 15;  ///< bit i: component i is written; 0 of texkill and nop
    std::array<ShaderSource, 3> sources{};
};

struct ShaderConstant {
    int number;
    std::array<double, 4> value;
};

/// An assembled program. Every component that an instruction reads has been written, declared or is a
/// constant.
struct ShaderProgram {
    static constexpr int kMostArithmetic = 64, kMostTexture = 32, kMostOrder = 3;
    static constexpr int kTemporaries = 12, kConstants = 32, kCoordinates = 8, kColors = 2, kSamplers = 16,
                         kOutputs = 4;

    std::vector<ShaderInstruction> instructions;
    std::vector<ShaderConstant> constants;
    std::uint32_t samplers = 0;  ///< bit i: sampler i is declared
    /// Bit i: component i is declared.
    std::array<std::uint8_t, kCoordinates> coordinates{};
    std::array<std::uint8_t, kColors> colors{};
    int arithmetic = 0, texture = 0;  ///< number of slots of either kind
};

/// The numbers of textures, coordinates and colors that whoever runs a program gives it.
struct ShaderSlots {
    int samplers = ShaderProgram::kSamplers, coordinates = ShaderProgram::kCoordinates,
        colors = ShaderProgram::kColors;
};

/// Assembles a text. Throws Error "name: line 3: what is wrong", also where others than those of `slots` are
/// declared.
ShaderProgram assemble_shader(std::string_view text, const std::string& name, const ShaderSlots& slots = {});

/// A program as text again, which assembles to the same.
std::string shader_listing(const ShaderProgram& program);

}  // namespace anamorph::machine
