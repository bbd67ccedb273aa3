// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/panorama_glsl.h"

#include "anamorph/chart/chart_glsl.h"

namespace anamorph {

namespace {

constexpr const char* kArguments =
    "(vec3 r, vec3 a, vec3 b, out vec2 texel, out vec2 alongA, out vec2 alongB)";

std::string vec2(const GlslNumber& x, const GlslNumber& y) {
    return "vec2(" + x.written() + ", " + y.written() + ")";
}

/// A ray of the shader with its two derivatives.
Ray<GlslJet> ray_of(GlslText& text) {
    const auto part = [&](const std::string& i) {
        return GlslJet::variable(text.input("r." + i), text.input("a." + i), text.input("b." + i));
    };
    return {part("x"), part("y"), part("z")};
}

/// True where the found point is on the picture. Rounding moves it by less than 2^-20 of the picture over its border.
GlslNumber on_picture(const Chart& chart, const GlslNumber& x, const GlslNumber& y) {
    const auto within = [](const GlslNumber& at, double size) {
        const double slack = size * 0x1p-20;
        return min(at + slack, (size + slack) - at);
    };
    const GlslNumber down = within(y, chart.height());
    return chart.closed() ? down : min(within(x, chart.width()), down);
}

/// The formulas of one piece.
std::string piece_function(const Chart& chart, int piece, const std::string& name) {
    GlslText text;
    const Branch& branch = chart.branch(piece);
    const Ray<GlslJet> local = transform(glm::transpose(branch.axes), ray_of(text));
    const Point<GlslJet> p = chart.local_point(local, branch);
    const GlslNumber on = on_picture(chart, p.x.c[0], p.y.c[0]);
    const GlslNumber seen =
        chart.pieces_see_all() ? GlslNumber(1)
                               : chart.sees(Ray<GlslNumber>{local.x.c[0], local.y.c[0], local.z.c[0]}, piece);
    return "bool " + name + kArguments + " {\n" + text.lines() + "  texel = " + vec2(p.x.c[0], p.y.c[0]) +
           ";\n  alongA = " + vec2(p.x.c[1], p.y.c[1]) + ";\n  alongB = " + vec2(p.x.c[2], p.y.c[2]) +
           ";\n  return " + seen.written() + " > 0.0 && " + on.written() + " >= 0.0;\n}\n";
}

/// The text that chooses a piece as Chart::piece_of() does.
std::string choice_of_piece(const Chart& chart) {
    std::string text = "  int piece = 0;\n  float most = -3.0, along;\n";
    for (std::size_t i = 0; i < chart.pieces().size(); ++i) {
        const glm::dvec3& f = chart.pieces()[i].toward;
        text += "  along = dot(r, vec3(" + GlslNumber(f.x).written() + ", " + GlslNumber(f.y).written() +
                ", " + GlslNumber(f.z).written() +
                "));\n  if (along > most) { most = along; piece = " + std::to_string(i) + "; }\n";
    }
    return text;
}

}  // namespace

std::string_view panorama_glsl_prelude() {
    return GlslText::prelude();
}

std::string panorama_glsl(const Chart& panorama, const std::string& name) {
    std::string text, calls;
    const std::size_t count = panorama.pieces().size();
    for (std::size_t i = 0; i < count; ++i) {
        const std::string function = name + "Piece" + std::to_string(i);
        text += piece_function(panorama, static_cast<int>(i), function);
        const std::string when = i + 1 < count ? "if (piece == " + std::to_string(i) + ") " : "";
        calls += "  " + when + "return " + function + "(r, a, b, texel, alongA, alongB);\n";
    }
    text += "bool " + name + kArguments +
            " {\n  texel = alongA = alongB = vec2(0.0);\n"
            "  float size = max(max(abs(r.x), abs(r.y)), abs(r.z));\n"
            "  if (!(size > 0.0)) return false;\n  r /= size;\n  a /= size;\n  b /= size;\n";
    if (count > 1) text += choice_of_piece(panorama);
    return text + calls + "}\n";
}

}  // namespace anamorph
