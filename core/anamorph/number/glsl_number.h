// SPDX-License-Identifier: Apache-2.0
// The number a formula is read with to write it down in GLSL: every operation is a line of a shader, which computes in
// float.
//
// Numbers that are known while the text is written are constants, and are computed in double. Equal operations share a
// line. Jets of these numbers (number/jet.h) write derivatives. Conditions are bools of GLSL; both sides of a choice are
// computed, as in a vector.
//
// Angles, logarithms and inverse hyperbolic sines are functions of the prelude, as GLSL asks for much less of its own: its
// atan may be off by 4096 units of float, several texels of a wide panorama.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "anamorph/number/jet.h"

namespace anamorph {

class GlslText;

/// A bool of the shader, or one that is known already.
struct GlslCondition {
    GlslText* text = nullptr;
    std::string name;  ///< name of a variable, where there is a text
    bool known = false;
};

/// A float of the shader, or a constant.
class GlslNumber {
  public:
    GlslNumber(double constant = 0) : m_constant(constant) {}  // NOLINT: a number is a constant
    GlslNumber(GlslText& text, std::string name) : m_text(&text), m_name(std::move(name)) {}

    GlslText* text() const { return m_text; }
    bool is(double constant) const { return !m_text && m_constant == constant; }
    bool is_constant() const { return !m_text; }
    double constant() const { return m_constant; }
    /// The variable, or the constant as GLSL reads it.
    std::string written() const;

  private:
    GlslText* m_text = nullptr;
    std::string m_name;
    double m_constant = 0;
};

/// The lines that operations have written, in order.
class GlslText {
  public:
    /// The functions that the lines call; they stand once in a shader, before them.
    static std::string_view prelude();

    /// A float variable of the shader that is there before the lines.
    GlslNumber input(const std::string& name) { return {*this, name}; }
    /// The variable that has the value of an expression: one that is there, or that of a new line. `type`:
    /// float or bool.
    std::string variable(const std::string& type, const std::string& expression);
    /// All lines, each a declaration.
    const std::string& lines() const { return m_lines; }

  private:
    std::map<std::string, std::string> m_known;
    std::string m_lines;
};

GlslNumber operator-(const GlslNumber& a);
GlslNumber operator+(const GlslNumber& a, const GlslNumber& b);
GlslNumber operator-(const GlslNumber& a, const GlslNumber& b);
GlslNumber operator*(const GlslNumber& a, const GlslNumber& b);
GlslNumber operator/(const GlslNumber& a, const GlslNumber& b);
GlslNumber square(const GlslNumber& a);
GlslNumber sqrt(const GlslNumber& a);
void sin_cos(const GlslNumber& a, GlslNumber& s, GlslNumber& c);
GlslNumber atan2(const GlslNumber& y, const GlslNumber& x);
GlslNumber exp(const GlslNumber& a);
GlslNumber log(const GlslNumber& a);
/// a^b, of a above 0.
GlslNumber pow(const GlslNumber& a, const GlslNumber& b);
GlslNumber asinh(const GlslNumber& a);
GlslNumber min(const GlslNumber& a, const GlslNumber& b);
GlslNumber max(const GlslNumber& a, const GlslNumber& b);
GlslNumber scaled_sinh(const GlslNumber& a, GlslNumber& s);
/// The number without a hair that is as wide as float's roundings are.
GlslNumber without_hair(const GlslNumber& a);
/// Squares of what is less than 2^-63 of a ray's length are as good as 0.
inline double enlarger(const GlslNumber&, const GlslNumber&) {
    return 1;
}

GlslCondition is_zero(const GlslNumber& a);
GlslCondition is_negative(const GlslNumber& a);
GlslCondition both(const GlslCondition& a, const GlslCondition& b);
GlslNumber select(const GlslCondition& condition, const GlslNumber& a, const GlslNumber& b);
/// May a condition hold for a fragment?
inline bool somewhere(const GlslCondition& condition) {
    return condition.text || condition.known;
}

template <int N>
Jet<GlslNumber, N> select(const GlslCondition& condition, const Jet<GlslNumber, N>& a,
                          const Jet<GlslNumber, N>& b) {
    Jet<GlslNumber, N> r;
    for (int i = 0; i < Jet<GlslNumber, N>::kSize; ++i) r.c[i] = select(condition, a.c[i], b.c[i]);
    return r;
}

}  // namespace anamorph
