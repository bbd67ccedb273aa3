// SPDX-License-Identifier: Apache-2.0
// Projects of Hugin of any bytes: what is read is within its limits, and leads to pictures or to an error.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "anamorph/operation/pano.h"
#include "anamorph/panorama/hugin_project.h"
#include "expect_error.h"

using namespace anamorph;

namespace {

/// A reader to whom every file is the project.
class ProjectFile final : public SideFileReader {
  public:
    explicit ProjectFile(std::string_view text) : m_text(text) {}
    std::string text(const std::string&) const override { return m_text; }
    std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
        throw Error("there is no image " + printable(name));
    }

  private:
    std::string m_text;
};

void check(const HuginProject& project) {
    fuzz::require(!project.images.empty() && project.images.size() <= kMostHuginImages,
                  "a project has images");
    for (const HuginImage& image : project.images) {
        fuzz::require(image.size.width > 0 && image.size.height > 0, "an image has pixels");
        fuzz::require(image.fov > 0 && std::isfinite(image.yaw + image.pitch + image.roll),
                      "an image has numbers");
        fuzz::require(!image.crop || !image.crop->empty(), "a crop has pixels");
        for (const auto& mask : image.masks) fuzz::require(mask.size() >= 3, "a mask has corners");
    }
}

/// Reads the pictures of all images, or of the first; they are not solved.
void read_pictures(const HuginProject& project, const SideFileReader& reader, const char* arguments) {
    const Operation& operation = pano_operation();
    ParameterValues values(*operation.parameters);
    values.assign(parse_recipe_name(arguments).assignments);
    const SideFiles files{{"src", {"fuzz.pto", ""}}};
    std::vector<SourceImage> sources;
    for (const LinkedFile& file : operation.linked(values, files, reader)) {
        const auto number = static_cast<std::size_t>(std::stoul(file.key.substr(file.key.find('/') + 1)));
        SourceImage source;
        source.facts.width = project.images.at(number).size.width;
        source.facts.height = project.images.at(number).size.height;
        source.channels = 3;
        sources.push_back(source);
    }
    const auto pictures = operation.read({values, sources, files, reader});
    const PictureRequest request = *pictures->picture(0, 0);
    fuzz::require(request.size.width > 0 && request.size.height > 0, "a picture has pixels");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    fuzz::expect_no_failure_but_error([&] {
        const HuginProject project = parse_hugin_project(text, "fuzz.pto");
        check(project);
        const ProjectFile reader(text);
        for (const char* arguments : {"?layers=blend", "?image=0&to=rectilinear&fov=70"})
            fuzz::expect_no_failure_but_error([&] { read_pictures(project, reader, arguments); });
    });
    return 0;
}
