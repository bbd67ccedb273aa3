// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "anamorph/error.h"
#include "anamorph/morph/features_file.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

using Given = Features::Given;
using Kind = Features::Given::Kind;

std::string text_of(const Point<double>& p, const char* between) {
    return shortest(p.x) + between + shortest(p.y);
}

const char* key_of(Kind kind) {
    return kind == Kind::line ? "line" : kind == Kind::polyline ? "polyline" : "curve";
}

/// The numbers of a list of points: of a line as one list, else each in brackets.
std::string json_points(const Given& feature, const std::vector<Point<double>>& points) {
    std::string text;
    for (const Point<double>& p : points) {
        text += text.empty() ? "" : ", ";
        text += feature.kind == Kind::line ? text_of(p, ", ") : "[" + text_of(p, ", ") + "]";
    }
    return "[" + text + "]";
}

std::string json_feature(const Given& feature) {
    std::string shapes;
    for (const auto& points : feature.points)
        shapes += (shapes.empty() ? "" : ", ") + json_points(feature, points);
    std::string text = std::string("{\"") + key_of(feature.kind) + "\": [" + shapes + "]";
    if (!feature.name.empty())
        text += ", \"name\": " +
                nlohmann::json(feature.name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (feature.weight != 1) text += ", \"weight\": " + shortest(feature.weight);
    return text + "}";
}

bool has_frame(const Features& features, int shape) {
    return features.frame(shape).width > 0;
}

}  // namespace

std::string features_json(const Features& features) {
    std::string text = "{\n";
    std::string sizes;
    int framed = 0;
    for (int k = 0; k < features.shapes(); ++k) {
        const Features::Frame frame = features.frame(k);
        framed += has_frame(features, k);
        sizes += (k > 0 ? ", [" : "[") + shortest(frame.width) + ", " + shortest(frame.height) + "]";
    }
    if (framed != 0 && framed != features.shapes())
        throw Error("sizes: must be those of all pictures or of none");
    if (framed > 0) text += "  \"sizes\": [" + sizes + "],\n";
    if (features.border_weight() > 0)
        text += "  \"pin_border\": " + shortest(features.border_weight()) + ",\n";
    text += "  \"features\": [";
    bool first = true;
    for (const Given& feature : features.given()) {
        text += (first ? "\n    " : ",\n    ") + json_feature(feature);
        first = false;
    }
    return text + "]\n}\n";
}

std::string features_csv(const Features& features) {
    const auto refuse = [](const std::string& what) {
        throw Error("CSV has no " + what + ": must be saved as .json or .svg");
    };
    if (features.shapes() != 2) refuse("more than two shapes");
    if (features.border_weight() > 0) refuse("pin_border");
    if (has_frame(features, 0) || has_frame(features, 1)) refuse("sizes of pictures");
    std::string text = "ax0,ay0,ax1,ay1,bx0,by0,bx1,by1,weight\n";
    for (const Given& feature : features.given()) {
        if (feature.kind == Kind::curve) refuse("curves");
        if (!feature.name.empty()) refuse("names of lines");
        const auto &a = feature.points[0], &b = feature.points[1];
        for (std::size_t i = 0; i + 1 < a.size(); ++i)
            text += text_of(a[i], ",") + "," + text_of(a[i + 1], ",") + "," + text_of(b[i], ",") + "," +
                    text_of(b[i + 1], ",") + "," + shortest(feature.weight) + "\n";
    }
    return text;
}

namespace {

/// A path of a part: straight from point to point, or cubics.
std::string path_of(const Given& feature, std::size_t shape) {
    const std::vector<Point<double>>& points = feature.points[shape];
    std::string text = "M " + text_of(points[0], " ");
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (feature.kind == Kind::curve) text += i % 3 == 1 ? " C" : ",";
        if (feature.kind != Kind::curve) text += " L";
        text += " " + text_of(points[i], " ");
    }
    return text;
}

/// The drawings of a file: features of one name and weight that follow each other are parts of one. Each has a name that no other has.
struct Written {
    std::string name;
    double weight;
    std::vector<const Given*> parts;
};
std::vector<Written> drawings_of(const Features& features) {
    std::vector<Written> all;
    std::set<std::string> names;
    for (const Given& feature : features.given()) {
        if (!all.empty() && !feature.name.empty() && all.back().parts[0]->name == feature.name &&
            all.back().weight == feature.weight) {
            all.back().parts.push_back(&feature);
            continue;
        }
        const std::string base = feature.name.empty() ? "line" : feature.name;
        std::string name = feature.name.empty() ? "line 1" : base;
        for (int i = 2; !names.insert(name).second; ++i) name = base + " " + std::to_string(i);
        all.push_back({name, feature.weight, {&feature}});
    }
    return all;
}

void set(pugi::xml_node node, const char* key, const std::string& value) {
    node.append_attribute(key).set_value(value.c_str());
}

}  // namespace

std::string features_svg(const Features& features) {
    if (features.border_weight() > 0) throw Error("SVG has no pin_border: must be saved as .json");
    pugi::xml_document document;
    pugi::xml_node svg = document.append_child("svg");
    set(svg, "xmlns", "http://www.w3.org/2000/svg");
    set(svg, "xmlns:xlink", "http://www.w3.org/1999/xlink");
    set(svg, "xmlns:inkscape", "http://www.inkscape.org/namespaces/inkscape");
    const std::vector<Written> drawings = drawings_of(features);
    for (int k = 0; k < features.shapes(); ++k) {
        const std::string layer =
            features.title(k).empty() ? std::string(1, static_cast<char>('a' + k)) : features.title(k);
        pugi::xml_node group = svg.append_child("g");
        set(group, "inkscape:groupmode", "layer");
        set(group, "inkscape:label", layer);
        if (has_frame(features, k)) {
            pugi::xml_node image = group.append_child("image");
            set(image, "width", shortest(features.frame(k).width));
            set(image, "height", shortest(features.frame(k).height));
            set(image, "xlink:href", features.picture(k).empty() ? "data:" : features.picture(k));
        }
        for (std::size_t i = 0; i < drawings.size(); ++i) {
            std::string d;
            for (const Given* part : drawings[i].parts)
                d += (d.empty() ? "" : " ") + path_of(*part, static_cast<std::size_t>(k));
            pugi::xml_node path = group.append_child("path");
            set(path, "id", "feature" + std::to_string(i + 1) + "-" + std::to_string(k + 1));
            set(path, "inkscape:label", drawings[i].name);
            set(path, "d", d);
            set(path, "style", "fill:none;stroke:#ff5500;stroke-width:2");
            if (drawings[i].weight != 1) set(path, "data-weight", shortest(drawings[i].weight));
        }
    }
    std::ostringstream text;
    document.save(text, "  ");
    return text.str();
}

std::string features_text(const Features& features, std::string_view name) {
    if (text_file::ends_with(name, ".csv")) return features_csv(features);
    if (text_file::ends_with(name, ".svg")) return features_svg(features);
    return features_json(features);
}

}  // namespace anamorph
