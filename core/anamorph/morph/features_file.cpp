// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/features_file.h"

#include <cctype>
#include <optional>

#include "anamorph/parameter/json_file.h"

namespace anamorph {
namespace {

using text_file::excerpt;
using text_file::fail;
using text_file::in_entry;
using text_file::Json;

// --- JSON

double number(const Json& json) {
    if (!json.is_number()) throw Error("must be a number, not " + excerpt(json.text()));
    return json.number();
}

Json array(const Json& json, const char* of, std::size_t size = 0) {
    if (!json.is_array() || (size && json.size() != size))
        throw Error("must be a list of " + (size ? std::to_string(size) + " " : std::string()) + of);
    return json;
}

Line read_line(const Json& json) {
    array(json, "numbers: x0, y0, x1, y1", 4);
    return {{number(json[0]), number(json[1])}, {number(json[2]), number(json[3])}};
}

std::vector<Point<double>> read_points(const Json& json) {
    std::vector<Point<double>> points;
    for (const Json& p : array(json, "points").entries()) {
        array(p, "numbers: x, y", 2);
        points.push_back({number(p[0]), number(p[1])});
    }
    return points;
}

/// "line", "polyline" or "curve": which kind of feature an entry is.
std::string kind_of(const Json& entry) {
    if (!entry.is_object()) throw Error("must be an object with line, polyline or curve");
    std::string kind;
    for (const auto& [key, value] : entry.members()) {
        if (key == "name" || key == "weight") continue;
        if (key != "line" && key != "polyline" && key != "curve")
            throw Error(excerpt(key) + ": must be one of line, polyline, curve, name, weight");
        if (!kind.empty()) throw Error(kind + " and " + key + ": must not both be given");
        kind = key;
    }
    if (kind.empty()) throw Error("must have one of line, polyline, curve");
    return kind;
}

void add_feature(const Json& entry, std::optional<Features>& features) {
    const std::string kind = kind_of(entry);
    const Json shapes = array(entry.member(kind), "key shapes");
    if (shapes.size() > 64) throw Error("there must be at most 64 key shapes");
    if (!features) features.emplace(static_cast<int>(shapes.size()));
    const double weight = entry.contains("weight") ? number(entry.member("weight")) : 1;
    std::string name;
    if (entry.contains("name")) {
        if (!entry.member("name").is_string()) throw Error("name: must be a text in quotes");
        name = excerpt(entry.member("name").string());
    }
    if (kind == "line") {
        std::vector<Line> line;
        for (const Json& shape : shapes.entries()) line.push_back(read_line(shape));
        return features->add_line(line, weight, name);
    }
    std::vector<std::vector<Point<double>>> points;
    for (const Json& shape : shapes.entries()) points.push_back(read_points(shape));
    if (kind == "polyline")
        features->add_polyline(points, weight, name);
    else
        features->add_curve(points, weight, name);
}

void read_sizes(const Json& sizes, Features& features) {
    array(sizes, "sizes, one for every key shape", static_cast<std::size_t>(features.shapes()));
    for (int k = 0; k < features.shapes(); ++k) {
        const Json size = array(sizes[static_cast<std::size_t>(k)], "numbers: width, height", 2);
        features.set_frame(k, {number(size[0]), number(size[1])});
    }
}

double border_weight(const Json& value) {
    return value.is_boolean() ? (value.boolean() ? 1 : 0) : number(value);
}

// --- CSV

std::vector<double> read_row(std::string_view row) {
    const std::vector<std::string_view> fields = text_file::fields_of(row);
    if (fields.size() < 8 || fields.size() > 9)
        throw Error("must be 8 numbers, ax0,ay0,ax1,ay1,bx0,by0,bx1,by1, and a weight if wanted, not " +
                    std::to_string(fields.size()));
    std::vector<double> values;
    for (const std::string_view field : fields) values.push_back(text_file::number(field));
    return values;
}

}  // namespace

Features parse_features_json(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    const text_file::JsonFile file(text, name);
    const Json json = file.top();
    if (!json.is_object()) fail(name, "", "must be an object with features");
    for (const auto& [key, value] : json.members())
        if (key != "features" && key != "sizes" && key != "pin_border")
            fail(name, excerpt(key), "must be one of features, sizes, pin_border");
    if (!json.contains("features") || !json.member("features").is_array() || json.member("features").empty())
        fail(name, "features", "must be a list of one or more features");

    std::optional<Features> features;
    std::size_t i = 0;
    for (const Json& entry : json.member("features").entries()) {
        const std::string label = "features[" + std::to_string(i++) + "]";
        in_entry(name, label, [&] { add_feature(entry, features); });
        check_feature_count(*features, name, label);
    }
    if (json.contains("sizes")) in_entry(name, "sizes", [&] { read_sizes(json.member("sizes"), *features); });
    if (json.contains("pin_border"))
        in_entry(name, "", [&] { features->pin_border(border_weight(json.member("pin_border"))); });
    return std::move(*features);
}

Features parse_features_csv(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    Features features(2);
    bool first = true;
    text_file::each_row(text, [&](std::string_view row, const std::string& label) {
        const bool head = first && row.starts_with("ax0");
        first = false;
        if (head) return;
        in_entry(name, label, [&] {
            const std::vector<double> v = read_row(row);
            features.add_line({{{v[0], v[1]}, {v[2], v[3]}}, {{v[4], v[5]}, {v[6], v[7]}}},
                              v.size() > 8 ? v[8] : 1);
        });
        check_feature_count(features, name, label);
    });
    if (features.size() == 0) fail(name, "", "must have one pair of lines or more");
    return features;
}

void check_feature_count(const Features& features, std::string_view file, const std::string& entry) {
    if (features.size() > kMaxFeatures)
        fail(file, entry, "must have at most " + std::to_string(kMaxFeatures) + " lines");
}

Features parse_features_file(std::string_view text, std::string_view name) {
    if (text_file::ends_with(name, ".csv")) return parse_features_csv(text, name);
    if (text_file::ends_with(name, ".svg")) return parse_features_svg(text, name);
    return parse_features_json(text, name);
}

}  // namespace anamorph
