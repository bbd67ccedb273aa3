// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/feature_glsl.h"

#include "anamorph/error.h"
#include "anamorph/morph/near_far_exact.h"
#include "anamorph/number/glsl_number.h"

namespace anamorph {
namespace feature_glsl_detail {

using anamorph::max;

inline GlslNumber root(const GlslNumber& square) {
    return sqrt(square);
}

#include "anamorph/morph/feature_formula.h"

}  // namespace feature_glsl_detail

namespace {

namespace formula = feature_glsl_detail;

/// Below this the least a + dist counts as this, so that its reciprocal is finite.
constexpr double kLeastUnit = 0x1p-60;

/// The vectors of a line as a function's arguments: l0 to l4 (line_uniforms).
std::string arguments_of_line() {
    std::string text;
    for (int k = 0; k < kVectorsOfLine; ++k) text += "vec4 l" + std::to_string(k) + ", ";
    return text;
}
std::string line_given(const std::string& name, std::size_t line) {
    std::string text;
    for (std::size_t k = 0; k < kVectorsOfLine; ++k)
        text += name + "Lines[" + std::to_string(line * kVectorsOfLine + k) + "], ";
    return text;
}

/// A point in the frame of a line.
struct InFrame {
    GlslNumber along, beside, far;

    explicit InFrame(GlslText& text) {
        const auto in = [&](const char* name) { return text.input(name); };
        const GlslNumber dx = in("at.x") - in("l0.x"), dy = in("at.y") - in("l0.y");
        along = formula::along_line(dx, dy, in("l0.z"), in("l0.w"));
        beside = formula::beside_line(dx, dy, in("l0.z"), in("l0.w"));
        far = formula::distance_to_line<GlslNumber>(-along, along - in("l1.x"), beside) + in("weight.x");
    }
};

/// A line's a + dist.
std::string far_function(const std::string& name) {
    GlslText text;
    const InFrame frame(text);
    return "float " + name + "Far(" + arguments_of_line() + "vec2 weight, vec2 at) {\n" + text.lines() +
           "  return " + frame.far.written() + ";\n}\n";
}

/// Adds what a line says, by its weight, to the sums.
std::string add_function(const std::string& name, double exponent) {
    GlslText text;
    const auto in = [&](const std::string& of) { return text.input(of); };
    const InFrame frame(text);
    const GlslNumber factor = in("l1.y"), near_by = in("perNearest");
    const auto power = [&](const GlslNumber& far) {
        const GlslNumber c = far * near_by;
        return exponent > 0 ? feature_detail::inverse_power_of_constant(c, exponent)
                            : pow(c, -in("weight.y"));
    };
    const GlslNumber weight =
        exponent == 0 ? factor : formula::weight_of_line(frame.far, in("nearest"), factor, power);
    const auto moved = [&](const char* origin, const char* along_rate, const char* beside_rate) {
        return formula::displacement_by_line(in(origin), in(along_rate), frame.along, in(beside_rate),
                                             frame.beside);
    };
    const GlslNumber by[] = {moved("l1.z", "l2.x", "l2.z"), moved("l1.w", "l2.y", "l2.w"),
                             moved("l3.x", "l3.z", "l4.x"), moved("l3.y", "l3.w", "l4.y")};
    std::string sums;
    for (const GlslNumber& d : by) sums += (sums.empty() ? "" : ", ") + (weight * d).written();
    return "void " + name + "Add(" + arguments_of_line() +
           "vec2 weight, float nearest, float perNearest, vec2 at, inout float weights, inout vec4 sums) "
           "{\n" +
           text.lines() + "  weights += " + weight.written() + ";\n  sums += vec4(" + sums + ");\n}\n";
}

}  // namespace

std::vector<std::array<float, 4>> line_uniforms(const FeatureMap& map, const std::array<int, 2>& shapes) {
    if (map.size() > kMostFragmentLines)
        throw Error("features of " + std::to_string(map.size()) + " lines: must have at most " +
                    std::to_string(kMostFragmentLines) + " to be drawn by fragments");
    std::vector<std::array<float, 4>> vectors;
    const auto add = [&](double x, double y, double z, double w) {
        vectors.push_back(
            {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), static_cast<float>(w)});
    };
    for (std::size_t i = 0; i < map.size(); ++i) {
        const FeatureMap::TargetLine& line = map.line(i);
        const FeatureMap::Displacement &a = map.displacement(i, shapes[0]),
                                       &b = map.displacement(i, shapes[1]);
        add(line.p.x, line.p.y, line.along.x, line.along.y);
        add(line.length, line.factor, a.origin.x, a.origin.y);
        add(a.along_rate.x, a.along_rate.y, a.beside_rate.x, a.beside_rate.y);
        add(b.origin.x, b.origin.y, b.along_rate.x, b.along_rate.y);
        add(b.beside_rate.x, b.beside_rate.y, 0, 0);
    }
    return vectors;
}

double own_exponent(double b) {
    return b == 0 || b == 0.5 || b == 1 || b == 2 ? b : -1;
}

std::string feature_glsl(const std::string& name, std::size_t lines, double exponent) {
    std::string text = far_function(name) + add_function(name, exponent) + "vec4 " + name +
                       "(vec2 at, vec2 weight, vec4 scale) {\n  float nearest = " + name + "Far(" +
                       line_given(name, 0) + "weight, at);\n";
    for (std::size_t i = 1; i < lines; ++i)
        text += "  nearest = min(nearest, " + name + "Far(" + line_given(name, i) + "weight, at));\n";
    text += "  float perNearest = 1.0 / max(nearest, " + GlslNumber(kLeastUnit).written() +
            "), weights = 0.0;\n  vec4 sums = vec4(0.0);\n";
    for (std::size_t i = 0; i < lines; ++i)
        text +=
            "  " + name + "Add(" + line_given(name, i) + "weight, nearest, perNearest, at, weights, sums);\n";
    GlslText last;
    const auto in = [&](const std::string& of) { return last.input(of); };
    std::string points;
    for (const char* axis : {"x", "y", "z", "w"}) {
        const std::string of = axis;
        const GlslNumber at = in(of == "x" || of == "z" ? "at.x" : "at.y");
        points +=
            (points.empty() ? "" : ", ") +
            formula::source_coordinate(at, in("sums." + of), in("weights"), in("scale." + of)).written();
    }
    return text + last.lines() + "  return vec4(" + points + ");\n}\n";
}

double feature_glsl_bound(const FeatureMap& map, const std::array<int, 2>& shapes, std::size_t most_boxes) {
    return shader_bound(map, {shapes[0], shapes[1]}, {0, 0, map.target().width, map.target().height},
                        most_boxes);
}

}  // namespace anamorph
