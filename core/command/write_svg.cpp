// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>

#include "frame_range.h"
#include "writers.h"

namespace anamorph::command {
namespace {

/// Four decimals at most, with a point whatever the locale.
std::string number(double value) {
    char text[64];
    const double rounded = std::round(value * 1e4) / 1e4 + 0.0;
    const auto end = std::to_chars(text, text + sizeof text, rounded).ptr;
    return {text, end};
}

std::string color(const glm::dvec3& rgb) {
    std::string text = "rgb(";
    for (int k = 0; k < 3; ++k) text.append(k ? "," : "").append(std::to_string(std::lround(rgb[k])));
    return text + ")";
}

std::string path_data(const std::vector<glm::dvec2>& points) {
    const bool closed = points.size() > 3 && points.front() == points.back();
    std::string data = "M";
    for (std::size_t k = 0; k + (closed ? 1 : 0) < points.size(); ++k) {
        if (k > 0) data += k == 1 ? "L" : " ";
        data += number(points[k].x) + " " + number(points[k].y);
    }
    return data + (closed ? "Z" : "");
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

std::string svg_of(const Stroke& stroke, const Drawing& drawing) {
    const std::string name = " data-body=\"" + stroke.body + "\"";
    if (stroke.kind == StrokeKind::dot)
        return "<circle class=\"dot\"" + name + " cx=\"" + number(stroke.points[0].x) + "\" cy=\"" +
               number(stroke.points[0].y) + "\" r=\"" + number(drawing.line_width) + "\" fill=\"" +
               color(stroke.color) + "\" stroke=\"none\"/>\n";
    const std::string data = " d=\"" + path_data(stroke.points) + "\"";
    std::string text;
    if (drawing.halo > 0 && stroke.kind != StrokeKind::hidden)
        text += "<path class=\"halo\"" + data + " stroke=\"white\" stroke-width=\"" +
                number(drawing.line_width + 2 * drawing.halo) + "\" stroke-linecap=\"butt\"/>\n";
    text += std::string("<path class=\"") + class_of(stroke.kind) + "\"" + name + data + " stroke=\"" +
            color(stroke.color) + "\"";
    if (stroke.kind == StrokeKind::hidden)
        text += " stroke-dasharray=\"" + number(3 * drawing.line_width) + " " +
                number(3 * drawing.line_width) + "\"";
    return text + "/>\n";
}

std::string svg_of(const Drawing& drawing) {
    const std::string size = number(drawing.size);
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
        size + "\" height=\"" + size + "\" viewBox=\"0 0 " + size + " " + size + "\">\n<title>frame " +
        std::to_string(drawing.frame) +
        "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<g fill=\"none\" "
        "stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke-width=\"" +
        number(drawing.line_width) + "\">\n";
    for (const Stroke& stroke : drawing.strokes) text += svg_of(stroke, drawing);
    return text + "</g>\n</svg>\n";
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
