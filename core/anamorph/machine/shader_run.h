// SPDX-License-Identifier: Apache-2.0
// Pixel shaders, run with the numbers of the hardware: the interpreter of what shader_program.h assembles.
#pragma once

#include "anamorph/machine/number_format.h"
#include "anamorph/machine/shader_program.h"

namespace anamorph::machine {

/// Four components of a register, numbers T (FormatNumber).
template <class T>
using ShaderVector = std::array<T, 4>;

/// The inputs of a program beside textures.
template <class T>
struct ShaderInputs {
    /// Sets the program's own constants; all else is 0.
    explicit ShaderInputs(const ShaderProgram& program) {
        for (const ShaderConstant& c : program.constants) {
            const auto n = static_cast<std::size_t>(c.number);
            for (std::size_t i = 0; i < 4; ++i) constants[n][i] = T(c.value[i]);
            m_defined |= 1u << n;
        }
    }
    /// Is constant n the program's own?
    bool defines(std::size_t n) const { return m_defined >> n & 1; }
    /// Sets constant n, unless it is the program's own.
    void give(std::size_t n, const std::array<double, 4>& value) {
        for (std::size_t i = 0; i < 4 && !defines(n); ++i) constants[n][i] = T(value[i]);
    }

    std::array<ShaderVector<T>, ShaderProgram::kConstants> constants{};
    std::array<ShaderVector<T>, ShaderProgram::kCoordinates> coordinates{};
    std::array<ShaderVector<T>, ShaderProgram::kColors> colors{};

  private:
    std::uint32_t m_defined = 0;  ///< bit n: constant n is the program's own
};

template <class T>
class ShaderMachine {
  public:
    using Vector = ShaderVector<T>;

    ShaderMachine(const ShaderProgram& program, const ShaderInputs<T>& inputs)
        : m_program(program), m_inputs(inputs) {}

    /// Runs the program once. sample(number, u, v) -> ShaderVector<T> reads texture s`number`. Returns oC0, of a pixel that
    /// is killed 0.
    template <class Sample>
    Vector run(const Sample& sample) {
        m_killed = false;
        for (const ShaderInstruction& i : m_program.instructions) {
            if (samples(i.opcode)) {
                const Vector at = read(i.sources[0]);
                const bool projected = i.opcode == ShaderOpcode::texldp;
                write(i, sample(i.sources[1].number, projected ? at[0] / at[3] : at[0],
                                projected ? at[1] / at[3] : at[1]));
            } else if (i.opcode == ShaderOpcode::texkill) {
                const Vector at = read(i.sources[0]);
                m_killed = is_negative(at[0]) || is_negative(at[1]) || is_negative(at[2]);
                if (m_killed) return {};
            } else if (i.mask != 0 && i.bank != ShaderBank::depth) {
                write(i, computed(i));
            }
        }
        return m_outputs[0];
    }
    /// Has texkill cancelled the pixel?
    bool killed() const { return m_killed; }

  private:
    Vector read(const ShaderSource& source) const {
        const auto n = static_cast<std::size_t>(source.number);
        const Vector& from = source.bank == ShaderBank::temporary    ? m_temporaries[n]
                             : source.bank == ShaderBank::constant   ? m_inputs.constants[n]
                             : source.bank == ShaderBank::coordinate ? m_inputs.coordinates[n]
                                                                     : m_inputs.colors[n];
        Vector vector;
        for (std::size_t i = 0; i < 4; ++i) {
            const T& value = from[source.swizzle[i]];
            vector[i] = source.negated ? -value : value;
        }
        return vector;
    }

    /// Computes all components of an instruction's result, of which the mask takes some.
    Vector computed(const ShaderInstruction& i) const {
        const Vector a = read(i.sources[0]), b = read(i.sources[1]), c = read(i.sources[2]);
        if (i.opcode == ShaderOpcode::nrm) return normalized(a);
        if (i.opcode == ShaderOpcode::crs) return cross(a, b);
        if (i.opcode == ShaderOpcode::sincos) return cos_sin(a[0], b, c);
        Vector result;
        for (std::size_t k = 0; k < 4; ++k)
            if (i.mask >> k & 1) result[k] = component(i.opcode, a, b, c, k);
        return result;
    }
    static T dot3(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static Vector normalized(const Vector& a) {
        const T squares = dot3(a, a), by = is_zero(squares) ? T::greatest() : T(1.0) / sqrt(squares);
        return {a[0] * by, a[1] * by, a[2] * by, a[3] * by};
    }
    static Vector cross(const Vector& a, const Vector& b) {
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], T(0.0)};
    }
    /// cos a and sin a by series of sin and cos of half the angle (Taylor, up to the 7th and the 6th power),
    /// in the eight slots that the profile allows: z = a^2; three steps of both series; sin; sin^2 and
    /// sin cos; cos a and sin a. Within 0.002.
    static Vector cos_sin(const T& a, const Vector& c1, const Vector& c2) {
        const T z = a * a, sine = (((z * c1[0] + c1[3]) * z + c2[0]) * z + c2[3]) * a,
                cosine = ((z * c1[1] + c1[2]) * z + c2[1]) * z + c2[2], square = sine * sine,
                product = sine * cosine;
        return {c2[2] - (square + square), product + product, T(0.0), T(0.0)};
    }
    // The sum makes one zero of two.
    static T size_of(const T& a) { return max(a, -a) + T(0.0); }
    static T log2_of(const T& a) {
        const T size = size_of(a);
        return is_zero(size) ? -T::greatest() : log2(size);
    }
    static T component(ShaderOpcode opcode, const Vector& a, const Vector& b, const Vector& c,
                       std::size_t k) {
        switch (opcode) {
            case ShaderOpcode::add:
                return a[k] + b[k];
            case ShaderOpcode::sub:
                return a[k] - b[k];
            case ShaderOpcode::mul:
                return a[k] * b[k];
            case ShaderOpcode::lrp:
                return a[k] * (b[k] - c[k]) + c[k];
            case ShaderOpcode::abs:
                return size_of(a[k]);
            case ShaderOpcode::frc:
                return a[k] - T(std::floor(a[k].value));
            case ShaderOpcode::dp2add:
                return a[0] * b[0] + a[1] * b[1] + c[k];
            case ShaderOpcode::exp:
                return exp2(a[k]);
            case ShaderOpcode::log:
                return log2_of(a[k]);
            case ShaderOpcode::pow:
                return exp2(b[k] * log2_of(a[k]));
            case ShaderOpcode::mad:
                return a[k] * b[k] + c[k];
            case ShaderOpcode::dp3:
                return dot3(a, b);
            case ShaderOpcode::dp4:
                return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
            case ShaderOpcode::rcp:
                return T(1.0) / a[k];
            case ShaderOpcode::rsq:
                return T(1.0) / sqrt(size_of(a[k]));
            case ShaderOpcode::min:
                return min(a[k], b[k]);
            case ShaderOpcode::max:
                return max(a[k], b[k]);
            case ShaderOpcode::cmp:
                return a[k].value >= 0 ? b[k] : c[k];
            default:
                return a[k];
        }
    }

    void write(const ShaderInstruction& i, const Vector& result) {
        const auto n = static_cast<std::size_t>(i.number);
        Vector& to = i.bank == ShaderBank::output ? m_outputs[n] : m_temporaries[n];
        for (std::size_t k = 0; k < 4; ++k) {
            if ((i.mask >> k & 1) == 0) continue;
            to[k] = result[k];
            if (i.partial) to[k] = T::made_of(nearest(kFloat16, to[k].value), to[k]);
            // NaN is 0 then.
            if (i.saturated) to[k] = T::made_of(to[k].value > 0 ? std::min(to[k].value, 1.0) : 0.0, to[k]);
        }
    }

    const ShaderProgram& m_program;
    const ShaderInputs<T>& m_inputs;
    bool m_killed = false;
    std::array<Vector, ShaderProgram::kTemporaries> m_temporaries{};
    std::array<Vector, ShaderProgram::kOutputs> m_outputs{};
};

}  // namespace anamorph::machine
