// SPDX-License-Identifier: Apache-2.0
// An operation by its name, as hosts call it: keys as in a recipe, sources as they are known, pictures that are solved and drawn.
#include <anamorph/operation.h>

#include <iostream>
#include <span>
#include <vector>

using namespace anamorph;

// This host has no files beside its sources.
struct NoFiles final : SideFileReader {
    std::string text(const std::string& name) const override { throw Error("there is no file " + name); }
    std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
        throw Error("there is no file " + name);
    }
};

int main() try {
    const Operation& pano = *find_operation("pano");
    ParameterValues values(*pano.parameters);
    values.assign({{"to", "stereographic"}, {"fov", "200"}, {"size", "300x300"}});
    values.set("pitch", -90);

    const std::vector<SourceImage> sources = {
        {.facts = {.width = 1024, .height = 512}, .channels = 1, .color_space = {}}};
    const auto pictures = pano.read({values, sources, {}, NoFiles()});
    const PictureRequest request = *pictures->picture(/*frame=*/0, /*level=*/0);
    const auto solved = request.solve();

    const std::vector<float> panorama(1024 * 512, 0.25f);
    std::vector<float> pixels(300 * 300);
    const MemorySource source(
        packed_view(std::as_bytes(std::span(panorama)).data(), PixelType::float32, 1024, 512, 1));
    if (!solved->draw(
            {&source}, {0, 0, 300, 300},
            packed_view(std::as_writable_bytes(std::span(pixels)).data(), PixelType::float32, 300, 300, 1),
            serial_for))
        return 1;
    std::cout << "middle " << pixels[150 * 300 + 150] << "\n";
    for (const Attribute& attribute : solved->reached(serial_for))
        if (const double* value = std::get_if<double>(&attribute.value))
            std::cout << attribute.name << " " << *value << "\n";
    values.assign({{"fov", "400"}});  // is refused
} catch (const Error& error) {
    std::cout << error.what() << "\n";
}
