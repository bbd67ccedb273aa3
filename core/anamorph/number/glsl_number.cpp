// SPDX-License-Identifier: Apache-2.0
#include "anamorph/number/glsl_number.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "anamorph/number/portable.h"

namespace anamorph {
namespace {

static_assert(FormulaNumber<GlslNumber>);

/// A literal of the nearest float; what is beyond its range is its end.
std::string literal(double value) {
    constexpr double kMost = std::numeric_limits<float>::max();
    const auto kept = static_cast<float>(std::clamp(value, -kMost, kMost));
    char text[32];
    const auto end = to_chars(text, text + sizeof text, kept).ptr;
    std::string written(text, end);
    if (written.find_first_of(".e") == std::string::npos) written += ".0";
    return kept < 0 ? "(" + written + ")" : written;
}

GlslText* text_of(const GlslNumber& a, const GlslNumber& b) {
    return a.text() ? a.text() : b.text();
}
GlslNumber line(GlslText* text, const std::string& expression) {
    return {*text, text->variable("float", expression)};
}
GlslNumber infix(const GlslNumber& a, const char* sign, const GlslNumber& b) {
    return line(text_of(a, b), a.written() + sign + b.written());
}
GlslNumber call(const std::string& function, const GlslNumber& a) {
    return line(a.text(), function + "(" + a.written() + ")");
}
GlslNumber call(const std::string& function, const GlslNumber& a, const GlslNumber& b) {
    return line(text_of(a, b), function + "(" + a.written() + ", " + b.written() + ")");
}
GlslCondition test(const GlslNumber& a, const std::string& comparison, bool known) {
    if (a.is_constant()) return {nullptr, "", known};
    return {a.text(), a.text()->variable("bool", a.written() + comparison), false};
}

}  // namespace

std::string GlslNumber::written() const {
    return m_text ? m_name : literal(m_constant);
}

std::string GlslText::variable(const std::string& type, const std::string& expression) {
    const auto [known, is_new] = m_known.emplace(expression, "t" + std::to_string(m_known.size()));
    if (is_new) m_lines += "  " + type + " " + known->second + " = " + expression + ";\n";
    return known->second;
}

// Arc tangents by octant, with Cephes' polynomial within tan(pi / 8), as number/lanes.h has them for float.
std::string_view GlslText::prelude() {
    return R"(
float anamorphAtan(float y, float x) {
  float ax = abs(x), ay = abs(y), p = min(ax, ay), q = max(ax, ay);
  bool beyond = p > q * 0.41421356;
  float over = beyond ? p + q : q, t = over == 0.0 ? 0.0 : (beyond ? p - q : p) / over, z = t * t;
  float a = t + t * z * (-3.33329491539e-1 + z * (1.99777106478e-1 + z * (-1.38776856032e-1 + z * 8.05374449538e-2)));
  a = beyond ? 0.785398163 + a : a;
  a = ay > ax ? 1.57079633 - a : a;
  a = x < 0.0 ? 3.14159265 - a : a;
  return y < 0.0 ? -a : a;
}
float anamorphAsinh(float a) {
  float b = abs(a), value = b < 0.03125 ? b - b * b * b / 6.0 : log(b + sqrt(b * b + 1.0));
  return a < 0.0 ? -value : value;
}
)";
}

GlslNumber operator-(const GlslNumber& a) {
    return a.is_constant() ? GlslNumber(-a.constant()) : line(a.text(), "-" + a.written());
}
GlslNumber operator+(const GlslNumber& a, const GlslNumber& b) {
    if (!text_of(a, b)) return a.constant() + b.constant();
    if (a.is(0)) return b;
    return b.is(0) ? a : infix(a, " + ", b);
}
GlslNumber operator-(const GlslNumber& a, const GlslNumber& b) {
    if (!text_of(a, b)) return a.constant() - b.constant();
    if (a.is(0)) return -b;
    return b.is(0) ? a : infix(a, " - ", b);
}
GlslNumber operator*(const GlslNumber& a, const GlslNumber& b) {
    if (!text_of(a, b)) return a.constant() * b.constant();
    if (a.is(0) || b.is(0)) return 0;
    if (a.is(1)) return b;
    if (b.is(1)) return a;
    if (a.is(-1)) return -b;
    return b.is(-1) ? -a : infix(a, " * ", b);
}
GlslNumber operator/(const GlslNumber& a, const GlslNumber& b) {
    if (!text_of(a, b)) return a.constant() / b.constant();
    if (a.is(0)) return 0;
    return b.is(1) ? a : infix(a, " / ", b);
}
GlslNumber square(const GlslNumber& a) {
    return a * a;
}
GlslNumber sqrt(const GlslNumber& a) {
    return a.is_constant() ? GlslNumber(std::sqrt(a.constant())) : call("sqrt", a);
}
void sin_cos(const GlslNumber& a, GlslNumber& s, GlslNumber& c) {
    s = a.is_constant() ? GlslNumber(std::sin(a.constant())) : call("sin", a);
    c = a.is_constant() ? GlslNumber(std::cos(a.constant())) : call("cos", a);
}
GlslNumber atan2(const GlslNumber& y, const GlslNumber& x) {
    if (!text_of(y, x)) return std::atan2(y.constant(), x.constant());
    return call("anamorphAtan", y, x);
}
GlslNumber exp(const GlslNumber& a) {
    return a.is_constant() ? GlslNumber(std::exp(a.constant())) : call("exp", a);
}
GlslNumber log(const GlslNumber& a) {
    return a.is_constant() ? GlslNumber(std::log(a.constant())) : call("log", a);
}
GlslNumber pow(const GlslNumber& a, const GlslNumber& b) {
    if (!text_of(a, b)) return std::pow(a.constant(), b.constant());
    return call("pow", a, b);
}
GlslNumber asinh(const GlslNumber& a) {
    return a.is_constant() ? GlslNumber(std::asinh(a.constant())) : call("anamorphAsinh", a);
}
GlslNumber min(const GlslNumber& a, const GlslNumber& b) {
    if (!text_of(a, b)) return std::min(a.constant(), b.constant());
    return call("min", a, b);
}
GlslNumber max(const GlslNumber& a, const GlslNumber& b) {
    if (!text_of(a, b)) return std::max(a.constant(), b.constant());
    return call("max", a, b);
}
/// Writes tanh a into s and returns 1 / cosh(a). With m = e^-2|a|: tanh |a| = (1 - m) / (1 + m), and
/// 1 / cosh(a) = 2 e^-|a| / (1 + m).
GlslNumber scaled_sinh(const GlslNumber& a, GlslNumber& s) {
    const GlslCondition below = is_negative(a);
    const GlslNumber size = select(below, -a, a), m = exp(size * -2.0), tangent = (1.0 - m) / (m + 1.0);
    s = select(below, -tangent, tangent);
    return max(exp(-size) * 2.0 / (m + 1.0), GlslNumber(0x1p-100));
}
GlslNumber without_hair(const GlslNumber& a) {
    return select(both(is_negative(a), is_negative(-0x1p-20 - a)), GlslNumber(0), a);
}

GlslCondition is_zero(const GlslNumber& a) {
    return test(a, " == 0.0", a.constant() == 0);
}
GlslCondition is_negative(const GlslNumber& a) {
    return test(a, " < 0.0", a.constant() < 0);
}
GlslCondition both(const GlslCondition& a, const GlslCondition& b) {
    if (!a.text) return a.known ? b : a;
    if (!b.text) return b.known ? a : b;
    return {a.text, a.text->variable("bool", a.name + " && " + b.name), false};
}
GlslNumber select(const GlslCondition& condition, const GlslNumber& a, const GlslNumber& b) {
    if (!condition.text) return condition.known ? a : b;
    return line(condition.text, condition.name + " ? " + a.written() + " : " + b.written());
}

}  // namespace anamorph
