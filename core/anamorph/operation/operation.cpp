// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/operation.h"

#include <algorithm>

#include "anamorph/parameter/text_file.h"

namespace anamorph {

#define ANAMORPH_OPERATION(name) const Operation& name##_operation();
#include "anamorph/operation/list.h"
#undef ANAMORPH_OPERATION

std::unique_ptr<const Pictures> Operation::read(const OperationInput& input) const {
    const std::size_t given = input.sources.size();
    const bool gathers_all = !gathering_file(input.files).empty();
    if (given < least_sources || (given > sources.size() && !gathers_all))
        throw Error("sources", std::to_string(given),
                    name + " takes " + std::to_string(least_sources) +
                        (least_sources < sources.size() ? " to " + std::to_string(sources.size()) : ""));
    return make(input);
}

LinkedFiles Operation::named_files(const ParameterValues& values) const {
    LinkedFiles files;
    for (const Parameter& p : *parameters)
        if ((p.type == ParameterType::image || p.type == ParameterType::file) && values.given(p.name))
            files.push_back({p.name, values.text(p.name), p.type == ParameterType::image});
    if (named)
        for (const LinkedFile& file : named(values)) files.push_back(file);
    return files;
}

bool Operation::gathers(std::string_view file) const {
    // With arguments it is the name of a recipe.
    if (sources.empty() || main_file != sources[0] || file.find('?') != std::string_view::npos) return false;
    return std::any_of(endings.begin(), endings.end(), [&](const std::string& ending) {
        return file.size() > ending.size() + 1 && text_file::ends_with(file, "." + ending);
    });
}

std::string Operation::gathering_file(const SideFiles& files) const {
    const auto found = sources.empty() ? files.end() : files.find(sources[0]);
    return found != files.end() && gathers(found->second.name) ? found->second.name : "";
}

const std::vector<const Operation*>& operations() {
    static const std::vector<const Operation*> all = {
#define ANAMORPH_OPERATION(name) &name##_operation(),
#include "anamorph/operation/list.h"
#undef ANAMORPH_OPERATION
    };
    return all;
}

const Operation* find_operation(std::string_view name) {
    for (const Operation* operation : operations())
        if (operation->name == name) return operation;
    return nullptr;
}

std::string operation_names() {
    std::string names;
    for (const Operation* operation : operations()) names += (names.empty() ? "" : ", ") + operation->name;
    return names;
}

std::string operation_key(const Operation& operation, const ParameterValues& values,
                          const std::vector<SourceImage>& sources, const SideFiles& files) {
    std::string key = operation.name + "\n" + values.key(operation.sources);
    for (const SourceImage& image : sources) {
        const SourceFacts& facts = image.facts;
        key += std::to_string(facts.width) + "x" + std::to_string(facts.height) + " " +
               std::to_string(image.channels) + " \"" + image.color_space + "\" ";
        if (facts.projection) key += std::string(name_of(*facts.projection)) + " as " + facts.said_by;
        for (const auto& [name, value] : {std::pair{" fov=", facts.fov},
                                          {" vfov=", facts.vfov},
                                          {" d=", facts.distance},
                                          {" e=", facts.second},
                                          {" yaw=", facts.yaw},
                                          {" pitch=", facts.pitch},
                                          {" roll=", facts.roll}})
            if (value) key += name + shortest(*value);
        if (facts.padding) key += " padding=" + facts.padding->text();
        if (const std::optional<PanoramaCrop>& crop = facts.crop)
            for (const double value : {crop->width, crop->height, crop->x, crop->y, crop->w, crop->h})
                key += " crop " + shortest(value);
        if (facts.pixel_aspect != 1) key += " pixel aspect " + shortest(facts.pixel_aspect);
        if (facts.lens) key += " lens=" + facts.lens->text();
        if (facts.focal_length)
            key += " focal length=" + shortest(*facts.focal_length) + " by " + facts.focal_length_said_by;
        if (const std::optional<Box>& all = facts.overscan)
            key += " of " + std::to_string(all->x0) + "," + std::to_string(all->y0) + " to " +
                   std::to_string(all->x1) + "," + std::to_string(all->y1);
        for (const std::string& name : facts.channel_names) key += " \"" + name + "\"";
        for (const int channel : facts.data_channels) key += " data " + std::to_string(channel);
        if (image.alpha >= 0) key += " alpha=" + std::to_string(image.alpha);
        key += "\n";
    }
    for (const auto& [name, file] : files)
        if (std::find(operation.sources.begin(), operation.sources.end(), name) == operation.sources.end() ||
            operation.gathers(file.name))
            key += name + "=" + file.name + "\n" + file.identity + "\n";
    return key;
}

void check_color_space(const SourceImage& image, const std::string& name, const SourceImage& first,
                       const std::string& first_name, const ParameterValues& values) {
    const std::string &space = image.color_space, &wanted = first.color_space;
    if (!values.given("colorspace") && !space.empty() && !wanted.empty() && space != wanted)
        throw Error(name + " is in color space \"" + printable(space) + "\" and " + first_name + " in \"" +
                    printable(wanted) + "\": must be the same, or colorspace be given");
}

void PictureRequest::add_overscan(const Size& overscan) {
    if (overscan == Size{}) return;
    const Box all = widened({0, 0, size.width, size.height}, overscan);
    display =
        Box{overscan.width, overscan.height, overscan.width + size.width, overscan.height + size.height};
    size = {all.width(), all.height()};
    sized_by = "overscan";
}

std::optional<Size> level_size(const Size& size, int level) {
    if (level > 0 && std::max(size.width, size.height) >> level < 1) return {};
    return Size{std::max(1, size.width >> level), std::max(1, size.height >> level)};
}

}  // namespace anamorph
