// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/rows.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "anamorph/image/source.h"

namespace anamorph::rows {
namespace {

constexpr double kMaxTile = 4096;

Parameter row(const char* name, ParameterType type, const std::string& doc) {
    Parameter parameter;
    parameter.name = name;
    parameter.type = type;
    parameter.documentation = doc;
    return parameter;
}

Parameter extent(const char* name, std::string value, double least, double most, const std::string& doc) {
    Parameter parameter = row(name, ParameterType::extent, doc);
    parameter.unit = "pixels";
    parameter.default_value = std::move(value);
    parameter.minimum = least;
    parameter.maximum = most;
    return parameter;
}

// What the words of all operations mean. In functions, since tables may be made before main() begins.
const std::vector<Word>& shared_schemes() {
    static const std::vector<Word> words = {
        {"auto", "the fastest that holds tol"},
        {"exact", "every pixel by the formula"},
        {"blocks", "polynomials of degree 2 to 4 on blocks"},
        {"residual", "linear maps and a table of what remains"},
        {"direct", "every pixel by the formula, in float where that holds tol, near the middle of its block"},
        {"hardware",
         "as the number formats and the stages of a machine make it, with the error that comes out"}};
    return words;
}
const std::vector<Word>& shared_outputs() {
    static const std::vector<Word> words = {
        {"color", ""},
        {"stmap",
         "the source point (u, v) with v down, in 0 to 1 on the source, "
         "beyond that beyond its edges, (-1, -1) where there is none or the source is far"},
        {"error", "its distance from the exact one in source pixels"},
        {"bound", "the proven bound of that"}};
    return words;
}

std::vector<std::string> names_of(const std::vector<Word>& words) {
    std::vector<std::string> names;
    for (const Word& word : words) names.push_back(word.name);
    return names;
}

/// "exact, every pixel by the formula; blocks, ...", of those that have a meaning.
std::string meanings_of(const std::vector<Word>& words) {
    std::string text;
    for (const Word& word : words)
        if (!word.meaning.empty()) text += (text.empty() ? "" : "; ") + word.name + ", " + word.meaning;
    return text;
}

}  // namespace

Parameter choice(const char* name, std::string value, std::vector<std::string> choices,
                 const std::string& doc) {
    Parameter parameter = row(name, ParameterType::choice, doc);
    parameter.default_value = std::move(value);
    parameter.choices = std::move(choices);
    return parameter;
}

Parameter number(const char* name, const char* unit, std::string value, double least, double most,
                 const std::string& doc) {
    Parameter parameter = row(name, ParameterType::number, doc);
    parameter.unit = unit;
    parameter.default_value = std::move(value);
    parameter.minimum = least;
    parameter.maximum = most;
    return parameter;
}

Parameter number(const char* name, const char* unit, const NumberRow& shared, const std::string& doc) {
    return number(name, unit, std::isnan(shared.standard) ? "" : shortest(shared.standard), shared.least,
                  shared.most, doc);
}

Parameter above(Parameter number) {
    number.above_minimum = true;
    return number;
}

Parameter whole(const char* name, const char* unit, std::string value, int least, int most,
                const std::string& doc) {
    Parameter parameter = number(name, unit, std::move(value), least, most, doc);
    parameter.type = ParameterType::whole;
    return parameter;
}

Parameter numbers(const char* name, double least, const std::string& doc) {
    Parameter parameter = row(name, ParameterType::numbers, doc);
    parameter.minimum = least;
    parameter.maximum = kInfinity;
    return parameter;
}

Parameter toggle(const char* name, const char* value, const std::string& doc) {
    Parameter parameter = row(name, ParameterType::toggle, doc);
    parameter.default_value = std::string(value);
    return parameter;
}

Parameter text(const char* name, const std::string& doc) {
    return row(name, ParameterType::text, doc);
}
Parameter definitions(const char* name, const std::string& doc) {
    Parameter parameter = text(name, doc);
    parameter.definitions = true;
    return parameter;
}
Parameter image(const char* name, const std::string& doc) {
    return row(name, ParameterType::image, doc);
}
Parameter file(const char* name, const std::string& doc) {
    return row(name, ParameterType::file, doc);
}

Parameter size(const std::string& doc) {
    return extent("size", "", 1, kMaxSide, doc);
}

Parameter tile() {
    return extent("tile", "256", 0, kMaxTile, "tile size that a host is told; 0 for scanlines");
}

Parameter mip() {
    return toggle("mip", "0", "1: the picture has MIP levels");
}

Parameter tol() {
    return number("tol", "source pixels", "0.01", 0, kInfinity,
                  "most that a source point may be off; 0: every pixel exactly");
}

Parameter colorspace(const std::string& doc) {
    return text("colorspace", doc);
}

Parameter filter(const std::vector<Word>& own) {
    Parameter row = choice("filter", "antialias", {"nearest", "bilinear", "bicubic", "antialias"},
                           "antialias is bilinear where the map magnifies");
    for (const Word& word : own) row.choices.push_back(word.name);
    if (!own.empty()) row.documentation += "; " + meanings_of(own);
    return row;
}

Parameter wrap(const std::string& automatic) {
    return choice("wrap", "automatic", {"automatic", "black", "clamp", "periodic", "mirror"},
                  "what lies beyond a source's edge; automatic " + automatic);
}

Parameter scheme(const std::vector<Word>& words) {
    std::vector<Word> known = words;
    for (Word& word : known)
        for (const Word& shared : shared_schemes())
            if (word.name == shared.name) word = shared;
    return choice("scheme", "auto", names_of(known), "how source points are found: " + meanings_of(known));
}

Parameter output(const std::vector<Word>& own) {
    std::vector<Word> words = shared_outputs();
    words.insert(words.end(), own.begin(), own.end());
    return choice("output", "color", names_of(words), "color, or per pixel: " + meanings_of(words));
}

Size size_of(const ParameterValues& values, const Size& natural) {
    if (!values.given("size")) return natural;
    Size size = values.extent("size");
    if (size.height < 0) {
        const double height = std::round(double(size.width) * natural.height / natural.width);
        size.height = static_cast<int>(std::clamp(height, 1.0, double{kMaxSide}));
    }
    return size;
}

glm::dvec3 three_numbers(const ParameterValues& values, std::string_view name, double least, double most) {
    const std::vector<double> v = values.numbers(name);
    const auto allowed = [&](double x) { return x >= least && x <= most; };
    if (v.size() != 3 || !std::all_of(v.begin(), v.end(), allowed))
        throw Error(std::string(name), printable(values.text(name)),
                    "must be three numbers from " + shortest(least) + " to " + shortest(most));
    return {v[0], v[1], v[2]};
}

std::size_t chosen_index(const ParameterValues& values, std::string_view name) {
    const ParameterTable& table = values.table();
    const auto row =
        std::find_if(table.begin(), table.end(), [&](const Parameter& p) { return p.name == name; });
    const auto found = std::find(row->choices.begin(), row->choices.end(), values.text(name));
    return static_cast<std::size_t>(found - row->choices.begin());
}

double flat_field_of_view(int width, double focal_length) {
    return 2 * std::atan(width / (2 * focal_length)) * 180 / std::numbers::pi;
}

std::string rounded_degrees(double degrees) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", degrees);
    return text;
}

Output chosen_output(const ParameterValues& values) {
    const std::size_t index = chosen_index(values, "output");
    return index < shared_outputs().size() ? static_cast<Output>(index) : Output::color;
}

}  // namespace anamorph::rows
