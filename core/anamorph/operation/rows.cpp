// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/rows.h"

#include <cmath>

#include "anamorph/render/source.h"

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

Parameter text(const char* name, const std::string& doc) {
    return row(name, ParameterType::text, doc);
}
Parameter image(const char* name, const std::string& doc) {
    return row(name, ParameterType::image, doc);
}
Parameter file(const char* name, const std::string& doc) {
    return row(name, ParameterType::file, doc);
}

Parameter size(const std::string& doc) {
    Parameter parameter = extent("size", "", 1, kMaxSide, doc);
    parameter.alias = "res";
    return parameter;
}

Parameter tile() {
    return extent("tile", "256", 0, kMaxTile, "tile size that a host is told; 0 for scanlines");
}

Parameter mip() {
    Parameter parameter = row("mip", ParameterType::toggle, "1: the picture has MIP levels");
    parameter.default_value = std::string("0");
    return parameter;
}

Parameter filter() {
    return choice("filter", "antialias", filters(), "antialias is bilinear where the map magnifies");
}

Parameter tol() {
    return number("tol", "source pixels", "0.01", 0, kInfinity,
                  "most that a source point may be off; 0: every pixel exactly");
}

Parameter colorspace(const std::string& doc) {
    return text("colorspace", doc);
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

const std::vector<std::string>& filters() {
    static const std::vector<std::string> names = {"nearest", "bilinear", "bicubic", "antialias"};
    return names;
}

}  // namespace anamorph::rows
