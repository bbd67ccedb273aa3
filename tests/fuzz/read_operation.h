// SPDX-License-Identifier: Apache-2.0
// An operation's pictures, by assignments from outside.
#pragma once

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "anamorph/operation/operation.h"
#include "expect_error.h"

namespace anamorph::fuzz {

/// A reader to whom every side file, whatever it is called, is the example's.
class ExampleFile final : public SideFileReader {
  public:
    explicit ExampleFile(const Operation& operation) : m_operation(operation) {}
    std::string text(const std::string& name) const override {
        if (m_operation.example.files.empty()) throw Error("there is no file " + printable(name));
        return m_operation.example.files[0].second;
    }
    std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
        throw Error("there is no image " + printable(name));
    }

  private:
    const Operation& m_operation;
};

/// Reads the first and the last picture, solving none.
inline void read_operation(const Operation& operation, const std::vector<Assignment>& assignments) {
    ParameterValues values(*operation.parameters);
    values.assign(parse_recipe_name("?" + operation.example.arguments).assignments);
    values.assign(assignments);
    SideFiles files;
    std::size_t count = operation.least_sources;
    for (const Parameter& p : *operation.parameters)
        if ((p.type == ParameterType::image || p.type == ParameterType::file) && values.given(p.name))
            files[p.name] = {values.text(p.name), ""};
    for (std::size_t i = count; i < operation.sources.size() && values.given(operation.sources[i]); ++i)
        ++count;
    SourceImage source;
    source.facts.width = 1024;
    source.facts.height = 512;
    source.channels = 3;
    const std::vector<SourceImage> sources(count, source);
    const ExampleFile reader(operation);
    const auto pictures = operation.read({values, sources, files, reader});
    require(pictures->frames() >= 1, "there is a frame");
    for (const int frame : {0, pictures->frames() - 1}) {
        const PictureRequest request = *pictures->picture(frame, 0);
        require(request.size.width > 0 && request.size.height > 0, "a picture has pixels");
        for (const Attribute& attribute : request.says)
            if (const double* value = std::get_if<double>(&attribute.value))
                require(std::isfinite(*value), "an attribute is a number");
    }
}

}  // namespace anamorph::fuzz
