// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <pugixml.hpp>

#include "anamorph/morph/features_file.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

using text_file::excerpt;
using text_file::fail;
using text_file::in_entry;
using text_file::take_number;
using Vertex = Point<double>;

// --- the lists of numbers in attributes

void skip_blanks(std::string_view& text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == ',' || text.front() == '\t' ||
                             text.front() == '\n' || text.front() == '\r'))
        text.remove_prefix(1);
}

/// The next number of a list; `.5.5` and `1-2` are two, as SVG has it.
double next_number(std::string_view& text) {
    skip_blanks(text);
    const std::string_view at = text;
    double value;
    if (!take_number(text, value))
        throw Error("there must be a number at \"" + excerpt(at.substr(0, 20)) + "\"");
    return value;
}

double number_of(const pugi::xml_node& node, const char* attribute) {
    std::string_view text = node.attribute(attribute).value();
    if (text.empty()) return 0;
    const double value = next_number(text);
    if (!text.empty() && text != "px")
        throw Error(std::string(attribute) + "=\"" + excerpt(node.attribute(attribute).value()) +
                    "\": must be a number of user units");
    return value;
}

// --- transforms

/// x' = a x + c y + e, y' = b x + d y + f.
struct Transform {
    double a = 1, b = 0, c = 0, d = 1, e = 0, f = 0;

    Vertex operator()(const Vertex& p) const { return {a * p.x + c * p.y + e, b * p.x + d * p.y + f}; }
    friend Transform operator*(const Transform& m, const Transform& n) {
        return {m.a * n.a + m.c * n.b, m.b * n.a + m.d * n.b,       m.a * n.c + m.c * n.d,
                m.b * n.c + m.d * n.d, m.a * n.e + m.c * n.f + m.e, m.b * n.e + m.d * n.f + m.f};
    }
    Transform inverse() const {
        const double det = a * d - b * c;
        if (!(std::fabs(det) > 0)) throw Error("transform: must be one that can be undone");
        return {d / det, -b / det, -c / det, a / det, (c * f - d * e) / det, (b * e - a * f) / det};
    }
};

Transform rotation(double degrees) {
    const double angle = degrees * 3.14159265358979323846 / 180;
    return {std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle), 0, 0};
}

/// One item of a transform list from its name and numbers.
Transform item(std::string_view name, const std::vector<double>& v) {
    const std::size_t n = v.size();
    if (name == "matrix" && n == 6) return {v[0], v[1], v[2], v[3], v[4], v[5]};
    if (name == "translate" && (n == 1 || n == 2)) return {1, 0, 0, 1, v[0], n == 2 ? v[1] : 0};
    if (name == "scale" && (n == 1 || n == 2)) return {v[0], 0, 0, n == 2 ? v[1] : v[0], 0, 0};
    if (name == "rotate" && n == 1) return rotation(v[0]);
    if (name == "rotate" && n == 3)
        return Transform{1, 0, 0, 1, v[1], v[2]} * rotation(v[0]) * Transform{1, 0, 0, 1, -v[1], -v[2]};
    if (name == "skewX" && n == 1) return {1, 0, std::tan(v[0] * 3.14159265358979323846 / 180), 1, 0, 0};
    if (name == "skewY" && n == 1) return {1, std::tan(v[0] * 3.14159265358979323846 / 180), 0, 1, 0, 0};
    throw Error("transform: " + excerpt(name) + " with " + std::to_string(n) + " numbers is not known");
}

Transform parse_transform(std::string_view text) {
    Transform all;
    for (skip_blanks(text); !text.empty(); skip_blanks(text)) {
        const std::size_t open = text.find('('), close = text.find(')');
        if (open == std::string_view::npos || close == std::string_view::npos || close < open)
            throw Error("transform: no list of transforms: \"" + excerpt(text) + "\"");
        std::string_view name = text.substr(0, open), list = text.substr(open + 1, close - open - 1);
        while (!name.empty() && name.back() == ' ') name.remove_suffix(1);
        std::vector<double> numbers;
        for (skip_blanks(list); !list.empty() && numbers.size() < 7; skip_blanks(list))
            numbers.push_back(next_number(list));
        all = all * item(name, numbers);
        text.remove_prefix(close + 1);
    }
    return all;
}

// --- shapes

/// A segment of a chain behind its first vertex: a straight line to `to`, or a cubic.
struct Segment {
    bool straight;
    Vertex control[2];
    Vertex to;
};
struct Chain {
    Vertex start;
    std::vector<Segment> segments;

    void line_to(const Vertex& to) { segments.push_back({true, {}, to}); }
    Vertex end() const { return segments.empty() ? start : segments.back().to; }
    void close() {
        const Vertex at = end();
        if (at.x != start.x || at.y != start.y) line_to(start);
    }
};

/// The chains of a path's `d` attribute.
class PathReader {
  public:
    explicit PathReader(std::string_view text) : m_text(text) {}

    std::vector<Chain> read() {
        char command = 0;
        for (skip_blanks(m_text); !m_text.empty(); skip_blanks(m_text)) {
            const char c = m_text.front();
            if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) {
                command = c;
                m_text.remove_prefix(1);
            } else if (command == 'Z' || command == 'z' || command == 0)
                throw Error("d: there must be a command at \"" + excerpt(m_text.substr(0, 20)) + "\"");
            step(command);
            // Pairs that follow a move are lines.
            if (command == 'M') command = 'L';
            if (command == 'm') command = 'l';
        }
        std::erase_if(m_chains, [](const Chain& chain) { return chain.segments.empty(); });
        return std::move(m_chains);
    }

  private:
    void step(char command) {
        m_relative = command >= 'a';
        const char upper = m_relative ? static_cast<char>(command - 'a' + 'A') : command;
        if (upper == 'M') {
            m_chains.push_back({point(), {}});
            m_at = m_last_control = m_chains.back().start;
            m_last = upper;
            return;
        }
        if (m_chains.empty()) throw Error("d: a path begins with M");
        if (upper == 'Z') {
            m_chains.back().close();
            const Vertex start = m_chains.back().start;
            m_chains.push_back({start, {}});
            m_at = m_last_control = start;
            m_last = upper;
            return;
        }
        segment(upper);
        m_last = upper;
    }

    void segment(char upper) {
        const auto mirrored = [&](char x, char y) {
            return m_last == x || m_last == y
                       ? Vertex{2 * m_at.x - m_last_control.x, 2 * m_at.y - m_last_control.y}
                       : m_at;
        };
        switch (upper) {
            case 'L':
                return line(point());
            case 'H':
                return line({next_number(m_text) + (m_relative ? m_at.x : 0), m_at.y});
            case 'V':
                return line({m_at.x, next_number(m_text) + (m_relative ? m_at.y : 0)});
            case 'C': {
                const Vertex a = point(), b = point();
                return cubic(a, b, point());
            }
            case 'S': {
                const Vertex a = mirrored('C', 'S'), b = point();
                return cubic(a, b, point());
            }
            case 'Q': {
                const Vertex a = point();
                return quadratic(a, point());
            }
            case 'T': {
                const Vertex a = mirrored('Q', 'T');
                return quadratic(a, point());
            }
            case 'A':
                throw Error("d: arcs are not read; convert them to curves");
            default:
                throw Error("d: the command " + excerpt(std::string(1, upper)) + " is not known");
        }
    }

    Vertex point() {
        const double x = next_number(m_text), y = next_number(m_text);
        return m_relative ? Vertex{m_at.x + x, m_at.y + y} : Vertex{x, y};
    }
    void line(const Vertex& to) {
        m_chains.back().line_to(to);
        m_at = m_last_control = to;
    }
    void cubic(const Vertex& a, const Vertex& b, const Vertex& to) {
        m_chains.back().segments.push_back({false, {a, b}, to});
        m_at = to;
        m_last_control = b;
    }
    void quadratic(const Vertex& a, const Vertex& to) {
        const auto third = [&](const Vertex& end) {
            return Vertex{end.x + (a.x - end.x) * 2 / 3, end.y + (a.y - end.y) * 2 / 3};
        };
        m_chains.back().segments.push_back({false, {third(m_at), third(to)}, to});
        m_at = to;
        m_last_control = a;
    }

    std::string_view m_text;
    std::vector<Chain> m_chains;
    Vertex m_at{0, 0}, m_last_control{0, 0};
    bool m_relative = false;
    char m_last = 0;
};

std::vector<Chain> read_points(std::string_view text, bool closed) {
    std::vector<Vertex> points;
    for (skip_blanks(text); !text.empty(); skip_blanks(text)) {
        const double x = next_number(text);
        points.push_back({x, next_number(text)});
    }
    if (points.size() < 2) throw Error("points: must be two or more");
    Chain chain{points[0], {}};
    for (std::size_t i = 1; i < points.size(); ++i) chain.line_to(points[i]);
    if (closed) chain.close();
    return {chain};
}

/// An ellipse as four cubics, from its right end on downwards: off by 0.0003 of its radius.
Chain ellipse_of(const pugi::xml_node& node, bool is_circle) {
    const Vertex c{number_of(node, "cx"), number_of(node, "cy")};
    const double rx = number_of(node, is_circle ? "r" : "rx"), ry = is_circle ? rx : number_of(node, "ry");
    if (!(rx > 0 && ry > 0)) throw Error("must have radii above 0");
    // 4 / 3 tan(pi / 8): the middle of each cubic lies on the ellipse.
    const double k = 4.0 / 3 * (std::sqrt(2.0) - 1);
    const Vertex along[] = {{rx, 0}, {0, ry}, {-rx, 0}, {0, -ry}};
    const auto at = [&](double x, double y) { return Vertex{c.x + x, c.y + y}; };
    Chain chain{at(rx, 0), {}};
    for (int quarter = 0; quarter < 4; ++quarter) {
        const Vertex &a = along[quarter], &b = along[(quarter + 1) % 4];
        chain.segments.push_back(
            {false, {at(a.x + k * b.x, a.y + k * b.y), at(b.x + k * a.x, b.y + k * a.y)}, at(b.x, b.y)});
    }
    return chain;
}

/// The chains of an element, in its own units; none for elements that are not lines.
std::vector<Chain> chains_of(const pugi::xml_node& node) {
    const std::string_view tag = node.name();
    if (tag == "line") {
        Chain chain{{number_of(node, "x1"), number_of(node, "y1")}, {}};
        chain.line_to({number_of(node, "x2"), number_of(node, "y2")});
        return {chain};
    }
    if (tag == "polyline" || tag == "polygon")
        return read_points(node.attribute("points").value(), tag == "polygon");
    if (tag == "path") return PathReader(node.attribute("d").value()).read();
    if (tag == "circle" || tag == "ellipse") return {ellipse_of(node, tag == "circle")};
    return {};
}

// --- the document

struct Drawing {
    std::string id, label;
    double weight;
    std::vector<Chain> chains;

    const std::string& name() const { return label.empty() ? id : label; }
};
struct Layer {
    std::string label;
    std::vector<Drawing> drawings;
    /// The transform from user units to pixels of the picture, and that picture's size, where the layer
    /// holds one.
    std::optional<Transform> to_picture;
    Features::Frame frame;
    std::string picture = {};  ///< the name of that picture's file
};

class DocumentReader {
  public:
    explicit DocumentReader(std::string_view file) : m_file(file) {}

    std::vector<Layer> read(const pugi::xml_node& root) {
        visit(root, {}, kNoLayer, 0);
        std::erase_if(m_layers, [](const Layer& layer) { return layer.drawings.empty(); });
        for (Layer& layer : m_layers)
            if (layer.to_picture) move(layer);
        return std::move(m_layers);
    }

  private:
    static constexpr std::size_t kNoLayer = static_cast<std::size_t>(-1);
    static constexpr int kDeepest = 200;

    void visit(const pugi::xml_node& parent, const Transform& outer, std::size_t layer, int depth) {
        if (depth > kDeepest) fail(m_file, "", "groups are nested too deeply");
        for (const pugi::xml_node& node : parent.children()) {
            const std::string_view tag = node.name();
            if (tag == "defs" || tag == "clipPath" || tag == "mask" || tag == "symbol") continue;
            const std::string entry = excerpt(node.name()) + " " + excerpt(node.attribute("id").value());
            Transform inner;
            in_entry(m_file, entry,
                     [&] { inner = outer * parse_transform(node.attribute("transform").value()); });
            if (tag == "g") {
                std::size_t own = layer;
                if (std::string_view(node.attribute("inkscape:groupmode").value()) == "layer") {
                    own = m_layers.size();
                    m_layers.push_back({node.attribute("inkscape:label").value(), {}, {}, {}});
                }
                visit(node, inner, own, depth + 1);
            } else if (layer != kNoLayer)
                in_entry(m_file, entry, [&] { take(node, inner, m_layers[layer]); });
        }
    }

    void take(const pugi::xml_node& node, const Transform& transform, Layer& layer) {
        if (std::string_view(node.name()) == "image") return take_picture(node, transform, layer);
        Drawing drawing{node.attribute("id").value(), node.attribute("inkscape:label").value(), 1,
                        chains_of(node)};
        if (drawing.chains.empty()) return;
        if (drawing.name().empty()) throw Error("must have an id");
        if (node.attribute("data-weight")) drawing.weight = number_of(node, "data-weight");
        for (Chain& chain : drawing.chains) apply(transform, chain);
        layer.drawings.push_back(std::move(drawing));
    }

    static void apply(const Transform& transform, Chain& chain) {
        chain.start = transform(chain.start);
        for (Segment& s : chain.segments) {
            s.to = transform(s.to);
            for (Vertex& control : s.control) control = transform(control);
        }
    }

    static void take_picture(const pugi::xml_node& node, const Transform& transform, Layer& layer) {
        const Transform corner{1, 0, 0, 1, number_of(node, "x"), number_of(node, "y")};
        layer.frame = {number_of(node, "width"), number_of(node, "height")};
        if (!(layer.frame.width > 0 && layer.frame.height > 0))
            throw Error("an image needs a width and a height in user units");
        layer.to_picture = (transform * corner).inverse();
        const pugi::xml_attribute link =
            node.attribute("xlink:href") ? node.attribute("xlink:href") : node.attribute("href");
        const std::string_view name = link.value();
        // What is stored in the file itself has no name.
        if (!name.starts_with("data:")) layer.picture = name.substr(name.find_last_of("/\\") + 1);
    }

    static void move(Layer& layer) {
        for (Drawing& drawing : layer.drawings)
            for (Chain& chain : drawing.chains) apply(*layer.to_picture, chain);
    }

    std::string_view m_file;
    std::vector<Layer> m_layers;
};

// --- what belongs together

/// An id without a tail that names its layer: "brow_a" in layer A.
std::string without_layer(const std::string& id, const std::string& layer) {
    if (layer.empty() || id.size() <= layer.size() + 1) return id;
    const std::size_t at = id.size() - layer.size() - 1;
    if (id[at] != '-' && id[at] != '_') return id;
    const auto lower = [](unsigned char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : int{c}; };
    for (std::size_t i = 0; i < layer.size(); ++i)
        if (lower(static_cast<unsigned char>(id[at + 1 + i])) != lower(static_cast<unsigned char>(layer[i])))
            return id;
    return id.substr(0, at);
}

using Names = std::map<std::string, std::size_t>;

/// The drawing of the first layer that `drawing` of `layer` belongs to.
std::optional<std::size_t> partner(const Drawing& drawing, const Layer& layer, const Names& labels,
                                   const Names& ids) {
    if (const auto found = labels.find(drawing.label); !drawing.label.empty() && found != labels.end())
        return found->second;
    std::string id = without_layer(drawing.id, layer.label);
    for (;;) {
        if (const auto found = ids.find(id); found != ids.end()) return found->second;
        const std::size_t tail = id.find_last_of("-_");
        if (tail == std::string::npos || tail == 0) return std::nullopt;
        id.resize(tail);
    }
}

std::string in_layer(const Drawing& drawing, const Layer& layer) {
    return excerpt(drawing.name()) + " in layer " + excerpt(layer.label);
}

/// Lists for every drawing of the first layer the one of each layer that belongs to it.
std::vector<std::vector<const Drawing*>> partners(const std::vector<Layer>& layers, std::string_view file) {
    const Layer& first = layers[0];
    Names labels, ids;
    for (std::size_t i = 0; i < first.drawings.size(); ++i) {
        const Drawing& drawing = first.drawings[i];
        if (!drawing.label.empty() && !labels.emplace(drawing.label, i).second)
            fail(file, in_layer(drawing, first), "its label is there twice: must be there once in a layer");
        // Labels are enough.
        if (drawing.id.empty()) continue;
        if (!ids.emplace(without_layer(drawing.id, first.label), i).second)
            fail(file, in_layer(drawing, first), "its id is not the only one");
        ids.emplace(drawing.id, i);
    }
    std::vector<std::vector<const Drawing*>> found(first.drawings.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        found[i].resize(layers.size());
        found[i][0] = &first.drawings[i];
    }
    for (std::size_t k = 1; k < layers.size(); ++k) {
        for (const Drawing& drawing : layers[k].drawings) {
            const auto i = partner(drawing, layers[k], labels, ids);
            if (!i)
                fail(file, in_layer(drawing, layers[k]),
                     "layer " + excerpt(first.label) + " has nothing with this id");
            if (found[*i][k])
                fail(file, in_layer(drawing, layers[k]),
                     !drawing.label.empty() && drawing.label == found[*i][k]->label
                         ? "its label is there twice: must be there once in a layer"
                         : "two drawings belong to " + excerpt(first.drawings[*i].name()));
            found[*i][k] = &drawing;
        }
        for (const auto& shapes : found)
            if (!shapes[k])
                fail(file, in_layer(*shapes[0], first),
                     "layer " + excerpt(layers[k].label) + " has nothing with this id");
    }
    return found;
}

void add_segment(Features& features, const std::vector<Vertex>& from,
                 const std::vector<const Segment*>& segments, double weight, const std::string& name) {
    bool straight = true;
    for (const Segment* s : segments) straight = straight && s->straight;
    if (straight) {
        std::vector<Line> line;
        for (std::size_t k = 0; k < segments.size(); ++k) line.push_back({from[k], segments[k]->to});
        return features.add_line(line, weight, name);
    }
    std::vector<std::vector<Vertex>> curve;
    for (std::size_t k = 0; k < segments.size(); ++k) {
        const Segment& s = *segments[k];
        const auto between = [&](double t) {
            return Vertex{from[k].x + t * (s.to.x - from[k].x), from[k].y + t * (s.to.y - from[k].y)};
        };
        curve.push_back({from[k], s.straight ? between(1.0 / 3) : s.control[0],
                         s.straight ? between(2.0 / 3) : s.control[1], s.to});
    }
    features.add_curve(curve, weight, name);
}

void add_drawing(Features& features, const std::vector<const Drawing*>& shapes) {
    const Drawing& first = *shapes[0];
    for (const Drawing* d : shapes)
        if (d->chains.size() != first.chains.size())
            throw Error("the layers have " + std::to_string(first.chains.size()) + " and " +
                        std::to_string(d->chains.size()) + " parts of it");
    for (std::size_t c = 0; c < first.chains.size(); ++c) {
        const std::size_t count = first.chains[c].segments.size();
        std::vector<Vertex> from;
        for (const Drawing* d : shapes) {
            if (d->chains[c].segments.size() != count)
                throw Error("the layers have " + std::to_string(count) + " and " +
                            std::to_string(d->chains[c].segments.size()) + " segments of it");
            from.push_back(d->chains[c].start);
        }
        std::vector<const Segment*> segments(shapes.size());
        for (std::size_t s = 0; s < count; ++s) {
            for (std::size_t k = 0; k < shapes.size(); ++k) segments[k] = &shapes[k]->chains[c].segments[s];
            add_segment(features, from, segments, first.weight, excerpt(first.name()));
            for (std::size_t k = 0; k < shapes.size(); ++k) from[k] = segments[k]->to;
        }
    }
}

}  // namespace

Features parse_features_svg(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    pugi::xml_document document;
    const pugi::xml_parse_result parsed =
        document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_auto);
    if (!parsed)
        fail(name, "byte " + std::to_string(parsed.offset), std::string("no XML: ") + parsed.description());
    const pugi::xml_node root = document.child("svg");
    if (!root) fail(name, "", "must be an svg element");
    const std::vector<Layer> layers = DocumentReader(name).read(root);
    if (layers.size() < 2 || layers.size() > 64)
        fail(name, "", "must have from 2 to 64 layers with lines, not " + std::to_string(layers.size()));
    Features features(static_cast<int>(layers.size()));
    for (const std::vector<const Drawing*>& shapes : partners(layers, name)) {
        const std::string entry = excerpt(shapes[0]->name());
        in_entry(name, entry, [&] { add_drawing(features, shapes); });
        check_feature_count(features, name, entry);
    }
    for (std::size_t k = 0; k < layers.size(); ++k) {
        features.set_title(static_cast<int>(k), layers[k].label, layers[k].picture);
        if (layers[k].to_picture) features.set_frame(static_cast<int>(k), layers[k].frame);
    }
    return features;
}

}  // namespace anamorph
