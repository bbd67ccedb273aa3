// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <type_traits>

#include "frame_range.h"
#include "writers.h"

namespace anamorph::command {
using namespace figure;
namespace {

/// Appends four decimals at most, with a point whatever the locale; of numbers that have none, all digits.
void add(std::string& text, double value) {
    constexpr long long kUnits = 10000;
    char digits[32];
    if (!(std::fabs(value) < 1e14)) {
        text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
        return;
    }
    const long long units = std::llround(value * kUnits), size = std::llabs(units);
    char* end = std::to_chars(digits, digits + sizeof digits, size / kUnits).ptr;
    if (long long rest = size % kUnits; rest > 0) {
        *end++ = '.';
        for (long long place = kUnits / 10; rest > 0; rest %= place, place /= 10)
            *end++ = static_cast<char>('0' + rest / place);
    }
    if (units < 0) text += '-';
    text.append(digits, end);
}

/// Appends texts and numbers.
template <class... Parts>
void add(std::string& text, const Parts&... parts) {
    const auto one = [&](const auto& part) {
        if constexpr (std::is_same_v<std::decay_t<decltype(part)>, double>)
            add(text, part);
        else
            text += part;
    };
    (one(parts), ...);
}

void add_path(std::string& text, const std::vector<glm::dvec2>& points) {
    const bool closed = points.size() > 3 && points.front() == points.back();
    text += " d=\"M";
    for (std::size_t k = 0; k + (closed ? 1 : 0) < points.size(); ++k) {
        if (k > 0) text += k == 1 ? 'L' : ' ';
        add(text, points[k].x);
        text += ' ';
        add(text, points[k].y);
    }
    text += closed ? "Z\"" : "\"";
}

void add_color(std::string& text, const char* attribute, const glm::dvec3& rgb) {
    add(text, attribute, "rgb(", std::to_string(std::lround(rgb.r)), ",", std::to_string(std::lround(rgb.g)),
        ",", std::to_string(std::lround(rgb.b)), ")\"");
}

const char* class_of(StrokeKind kind) {
    switch (kind) {
        case StrokeKind::hidden:
            return "hidden";
        case StrokeKind::stick:
            return "stick";
        case StrokeKind::dot:
            return "dot";
        default:
            return "visible";
    }
}

void add_stroke(std::string& text, const Stroke& stroke, const Drawing& drawing) {
    if (stroke.kind == StrokeKind::dot) {
        add(text, "<circle class=\"dot\" data-body=\"", stroke.body, "\" cx=\"", stroke.points[0].x,
            "\" cy=\"", stroke.points[0].y, "\" r=\"", drawing.line_width);
        add_color(text, "\" fill=\"", stroke.color);
        text += " stroke=\"none\"/>\n";
        return;
    }
    if (stroke.kind == StrokeKind::fill) {
        add(text, "<path class=\"fill\" data-body=\"", stroke.body, "\"");
        add_path(text, stroke.points);
        add_color(text, " fill=\"", stroke.color);
        text += " stroke=\"none\"/>\n";
        return;
    }
    for (const std::vector<glm::dvec2>& part : stroke.halo) {
        text += "<path class=\"halo\"";
        add_path(text, part);
        add(text, " stroke=\"white\" stroke-width=\"", drawing.line_width + 2 * drawing.halo,
            "\" stroke-linecap=\"butt\"/>\n");
    }
    add(text, "<path class=\"", class_of(stroke.kind), "\" data-body=\"", stroke.body, "\"");
    add_path(text, stroke.points);
    add_color(text, " stroke=\"", stroke.color);
    const double dash = 3 * drawing.line_width;
    if (stroke.kind == StrokeKind::hidden) add(text, " stroke-dasharray=\"", dash, " ", dash, "\"");
    text += "/>\n";
}

std::string svg_of(const Drawing& drawing) {
    std::string text, width, height;
    add(width, drawing.size.x);
    add(height, drawing.size.y);
    add(text,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"",
        width, "\" height=\"", height, "\" viewBox=\"0 0 ", width, " ", height, "\"");
    // Rounded up.
    if (drawing.simple) add(text, " data-error=\"", drawing.max_error + 1e-4, "\"");
    add(text, ">\n<title>frame ", std::to_string(drawing.frame),
        "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<g fill=\"none\" "
        "stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke-width=\"",
        drawing.line_width, "\">\n");
    for (const Stroke& stroke : drawing.strokes) add_stroke(text, stroke, drawing);
    text += "</g>\n</svg>\n";
    return text;
}

class SvgWriter : public DrawingWriter {
  public:
    SvgWriter(std::string name, bool several) : m_name(std::move(name)), m_several(several) {}
    void add(const Drawing& drawing) override {
        OutputFile file(m_several ? numbered_name(m_name, drawing.frame) : m_name);
        file.write(svg_of(drawing));
        file.close();
    }

  private:
    std::string m_name;
    bool m_several;
};

}  // namespace

std::unique_ptr<DrawingWriter> svg_writer(const std::string& name, bool several) {
    return std::make_unique<SvgWriter>(name, several);
}

}  // namespace anamorph::command
