// SPDX-License-Identifier: Apache-2.0
#include "anamorph/map/features_file.h"

#include <cctype>
#include <nlohmann/json.hpp>
#include <optional>

#include "anamorph/map/features_text.h"

namespace anamorph {
namespace {

using features_text::excerpt;
using features_text::fail;
using features_text::in_entry;
using Json = nlohmann::json;

// --- JSON
// ---------------------------------------------------------------------------------------------------

double number(const Json& json) {
    if (!json.is_number()) throw Error("needed is a number, not " + excerpt(json.dump(-1, ' ', true)));
    return json.get<double>();
}

const Json& array(const Json& json, const char* of, std::size_t size = 0) {
    if (!json.is_array() || (size && json.size() != size))
        throw Error("needed is a list of " + (size ? std::to_string(size) + " " : std::string()) + of);
    return json;
}

Line read_line(const Json& json) {
    array(json, "numbers: x0, y0, x1, y1", 4);
    return {{number(json[0]), number(json[1])}, {number(json[2]), number(json[3])}};
}

std::vector<Point<double>> read_points(const Json& json) {
    std::vector<Point<double>> points;
    for (const Json& p : array(json, "points")) {
        array(p, "numbers: x, y", 2);
        points.push_back({number(p[0]), number(p[1])});
    }
    return points;
}

/// "line", "polyline" or "curve": which kind of feature an entry is.
std::string kind_of(const Json& entry) {
    if (!entry.is_object()) throw Error("needed is an object with line, polyline or curve");
    std::string kind;
    for (const auto& [key, value] : entry.items()) {
        if (key == "name" || key == "weight") continue;
        if (key != "line" && key != "polyline" && key != "curve")
            throw Error(excerpt(key) + ": allowed are line, polyline, curve, name, weight");
        if (!kind.empty()) throw Error(kind + " and " + key + ": one of them is allowed");
        kind = key;
    }
    if (kind.empty()) throw Error("needed is line, polyline or curve");
    return kind;
}

void add_feature(const Json& entry, std::optional<Features>& features) {
    const std::string kind = kind_of(entry);
    const Json& shapes = array(entry[kind], "key shapes");
    if (shapes.size() > 64) throw Error("allowed are up to 64 key shapes");
    if (!features) features.emplace(static_cast<int>(shapes.size()));
    const double weight = entry.contains("weight") ? number(entry["weight"]) : 1;
    std::string name;
    if (entry.contains("name")) {
        if (!entry["name"].is_string()) throw Error("name: needed is a text");
        name = excerpt(entry["name"].get_ref<const std::string&>());
    }
    if (kind == "line") {
        std::vector<Line> line;
        for (const Json& shape : shapes) line.push_back(read_line(shape));
        return features->add_line(line, weight, name);
    }
    std::vector<std::vector<Point<double>>> points;
    for (const Json& shape : shapes) points.push_back(read_points(shape));
    if (kind == "polyline")
        features->add_polyline(points, weight, name);
    else
        features->add_curve(points, weight, name);
}

void read_sizes(const Json& sizes, Features& features) {
    array(sizes, "sizes, one for every key shape", static_cast<std::size_t>(features.shapes()));
    for (int k = 0; k < features.shapes(); ++k) {
        const Json& size = array(sizes[static_cast<std::size_t>(k)], "numbers: width, height", 2);
        features.set_frame(k, {number(size[0]), number(size[1])});
    }
}

double border_weight(const Json& value) {
    return value.is_boolean() ? (value.get<bool>() ? 1 : 0) : number(value);
}

// --- CSV
// ----------------------------------------------------------------------------------------------------

std::string_view trimmed(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
}

std::vector<double> read_row(std::string_view row) {
    std::vector<double> values;
    for (;;) {
        const std::size_t comma = row.find(',');
        const std::string_view field = trimmed(row.substr(0, comma));
        std::string_view rest = field;
        double value;
        if (!features_text::take_number(rest, value) || !rest.empty())
            throw Error("needed is a number, not \"" + excerpt(field) + "\"");
        values.push_back(value);
        if (values.size() > 9) throw Error("needed are 8 numbers and perhaps a weight, not more");
        if (comma == std::string_view::npos) return values;
        row.remove_prefix(comma + 1);
    }
}

bool ends_with(std::string_view name, std::string_view ending) {
    if (name.size() < ending.size()) return false;
    const std::string_view tail = name.substr(name.size() - ending.size());
    return std::equal(tail.begin(), tail.end(), ending.begin(),
                      [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

}  // namespace

Features parse_features_json(std::string_view text, std::string_view name) {
    features_text::check_size(text, name);
    Json json;
    try {
        json = Json::parse(text);
    } catch (const Json::exception& error) {
        fail(name, "", "no JSON: " + excerpt(error.what()));
    }
    if (!json.is_object()) fail(name, "", "needed is an object with features");
    for (const auto& [key, value] : json.items())
        if (key != "features" && key != "sizes" && key != "pin_border")
            fail(name, excerpt(key), "allowed are features, sizes, pin_border");
    if (!json.contains("features") || !json["features"].is_array() || json["features"].empty())
        fail(name, "features", "needed is a list of one or more features");

    std::optional<Features> features;
    std::size_t i = 0;
    for (const Json& entry : json["features"]) {
        const std::string label = "features[" + std::to_string(i++) + "]";
        in_entry(name, label, [&] { add_feature(entry, features); });
        features_text::check_count(*features, name, label);
    }
    if (json.contains("sizes")) in_entry(name, "sizes", [&] { read_sizes(json["sizes"], *features); });
    if (json.contains("pin_border"))
        in_entry(name, "", [&] { features->pin_border(border_weight(json["pin_border"])); });
    return std::move(*features);
}

Features parse_features_csv(std::string_view text, std::string_view name) {
    features_text::check_size(text, name);
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    Features features(2);
    bool first = true;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = text.find('\n');
        const std::string_view row = trimmed(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (row.empty() || row.front() == '#') continue;
        const bool head = first && row.starts_with("ax0");
        first = false;
        if (head) continue;
        const std::string label = "row " + std::to_string(number);
        in_entry(name, label, [&] {
            const std::vector<double> v = read_row(row);
            if (v.size() < 8)
                throw Error("needed are 8 numbers, ax0,ay0,ax1,ay1,bx0,by0,bx1,by1, not " +
                            std::to_string(v.size()));
            features.add_line({{{v[0], v[1]}, {v[2], v[3]}}, {{v[4], v[5]}, {v[6], v[7]}}},
                              v.size() > 8 ? v[8] : 1);
        });
        features_text::check_count(features, name, label);
    }
    if (features.size() == 0) fail(name, "", "needed is one pair of lines or more");
    return features;
}

Features parse_features_file(std::string_view text, std::string_view name) {
    if (ends_with(name, ".csv")) return parse_features_csv(text, name);
    if (ends_with(name, ".svg")) return parse_features_svg(text, name);
    return parse_features_json(text, name);
}

}  // namespace anamorph
