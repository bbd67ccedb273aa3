// SPDX-License-Identifier: Apache-2.0
#include "mrasel.h"

#include <algorithm>
#include <cmath>

#include "anamorph/error.h"
#include "anamorph/figure/files/mrasel_file.h"
#include "anamorph/figure/image/mrasel_maps.h"
#include "anamorph/parameter/text_file.h"
#include "input_file.h"
#include "output_file.h"
#include "picture_bytes.h"
#include "texture_files.h"

namespace anamorph::command {
using namespace figure;
namespace {

const char* const kStandardInput = "the standard input";

void write(const TriplePicture& picture, const PictureOutput& output) {
    OutputFile file(output.name);
    file.write(output.raw ? picture.bytes : picture.ppm());
    file.close();
}

/// The largest half-axis in pixels of the screen, by which the essay chooses the maps that are needed.
double longest_in_pixels(const Body& body) {
    return std::max({body.shape.axes.x, body.shape.axes.y, body.shape.axes.z}) * kMraselSide / 1000;
}

}  // namespace

void make_maps(std::istream& base, const std::string& name) {
    const MraselMaps maps =
        MraselMaps::made_of(read_all(base, kStandardInput, bytes_of_map(kMraselSide)), kStandardInput);
    for (int level = 0; level < kMraselMaps; ++level) {
        OutputFile file(mrasel_map_file(name, MraselMaps::side(level)));
        file.write(maps.bytes(level));
        file.close();
    }
}

void show_maps(const std::string& name, const PictureOutput& output) {
    write(shown_maps(read_maps(name)), output);
}

void draw_mrasel(std::istream& in, FigureLook look, const PictureOutput& output,
                 const ParallelFor& parallel_for, const std::function<void(const std::string& what)>& say) {
    const MraselInput input = mrasel_input(read_all(in, kStandardInput, text_file::kMostBytes), "stdin");
    const FigureFrame& frame = input.frame;
    for (const Body& body : frame.bodies)
        if (std::find(look.textures.begin(), look.textures.end(), body.texture) == look.textures.end())
            look.textures.push_back(body.texture);
    if (input.debug) {
        say("ellipsoids " + std::to_string(frame.bodies.size()) + ", bands " +
            std::to_string(frame.bands.size()) + ", maps " + std::to_string(look.textures.size()));
        for (const Body& body : frame.bodies)
            say("ellipsoid " + body.name + ": half its longest axis is " +
                std::to_string(std::lround(longest_in_pixels(body))) + " pixels");
    }
    const TextureFiles textures("", look.textures, say);
    const Size size{kMraselSide, kMraselSide};
    look.style = FigureStyle::textured;
    const FigurePicture picture(frame, view_in(frame, glm::dvec2(kMraselSide)), size, look, parallel_for);
    const std::vector<std::uint8_t> bytes =
        picture_bytes(picture, look, size, textures.sources(), parallel_for);
    write({size.width, size.height, std::string(bytes.begin(), bytes.end())}, output);
}

}  // namespace anamorph::command
