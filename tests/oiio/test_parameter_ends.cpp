// SPDX-License-Identifier: Apache-2.0
// What a row of a parameter table says is what the code accepts: every row of every operation at both of its
// ends, drawn by the recipe, and one step beyond, refused by its name.
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "anamorph/operation/morph.h"
#include "anamorph/panorama/concentric.h"
#include "host.h"

namespace anamorph::test_parameter_ends {
namespace {

using namespace testing_oiio;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using Values = std::vector<std::string>;

struct Ends {
    Values accepted, refused;
};

/// Where a range is open towards infinity its end is the largest number there is.
Ends ends_of_number(const Parameter& p) {
    Ends ends;
    if (std::isfinite(p.minimum)) {
        const double least = p.above_minimum ? std::nextafter(p.minimum, DBL_MAX) : p.minimum;
        ends.accepted.push_back(shortest(least));
        ends.refused.push_back(shortest(std::nextafter(least, -DBL_MAX)));
    } else {
        ends.accepted.push_back(shortest(-DBL_MAX));
        ends.refused.push_back("-1e309");
    }
    if (std::isfinite(p.maximum)) {
        ends.accepted.push_back(shortest(p.maximum));
        ends.refused.push_back(shortest(std::nextafter(p.maximum, DBL_MAX)));
    } else {
        ends.accepted.push_back(shortest(DBL_MAX));
        ends.refused.push_back("1e309");
    }
    return ends;
}

Ends ends_of(const Parameter& p) {
    const auto text = [](double value) { return std::to_string(std::llround(value)); };
    switch (p.type) {
        case ParameterType::number:
            return ends_of_number(p);
        case ParameterType::whole:
            return {{text(p.minimum), text(p.maximum)}, {text(p.minimum - 1), text(p.maximum + 1)}};
        case ParameterType::extent: {
            const auto least = std::llround(p.minimum), most = std::llround(p.maximum);
            const auto size = [](long long width, long long height) {
                return OIIO::Strutil::fmt::format("{}x{}", width, height);
            };
            return {Values{text(p.minimum), size(least, least), size(most, 1), size(1, most)},
                    Values{text(p.minimum - 1), size(most, least - 1), size(most + 1, 1), size(1, most + 1)}};
        }
        case ParameterType::toggle:
            return {Values{"0", "1"}, Values{"-1", "2", "true"}};
        case ParameterType::choice:
            return {p.choices, Values{"", "nonesuch", p.choices.front().substr(1)}};
        default:
            return {};
    }
}

class ParameterEnds : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("city.exr", 24, 12);
        write_panorama("town.exr", 24, 12);
        write_panorama("tall.exr", 4, 2 * ConcentricStack::kMostCircles);
        for (const Projection p : kProjections)
            if (has_faces(p))
                write_panorama(std::string(name_of(p)) + ".exr", 4 * faces_of(p).columns,
                               4 * faces_of(p).rows);
        write_text("still.json", R"({"columns": 1, "rows": 1, "units": "fractions",
                                     "vertices": [[0, 0], [1, 0], [0, 1], [1, 1]]})");
        ASSERT_EQ(run("oiiotool 'city.exr.warp?mesh=still.json&output=stmap' -o st.exr").status, 0);
    }

    /// A project of Hugin of so many images.
    static std::string write_project(int images) {
        std::string text = "p f2 w8 h4 v360\n";
        for (int i = 0; i < images; ++i)
            text += "i w24 h12 f4 v360 y" + std::to_string(i % 360) + " p0 r0 n\"city.exr\"\n";
        write_text("images.pto", text);
        return "images.pto";
    }

    /// A recipe in which any value of `key` has a meaning.
    static std::string name_for(const Operation& operation, const std::string& key,
                                const std::string& value) {
        std::vector<std::string> sources = {"city.exr", "town.exr"};
        std::vector<Assignment> arguments = {{"size", "4x3"}};
        const auto add = [&](const char* name, const std::string& text) {
            arguments.push_back({name, text});
        };
        const FaceGrid faces = faces_named(value);
        if (key == "step") add("mesh", "st.exr");
        if (key == "amount") add("mesh", "still.json");
        if (key == "from" && faces.columns > 0) sources[0] = value + ".exr";
        if (key == "to" && faces.columns > 0)
            add("size", std::to_string(2 * faces.columns) + "x" + std::to_string(2 * faces.rows));
        if (key == "vfov" || key == "srcvfov") {
            const std::string of = key == "vfov" ? "" : "src";
            add(of.empty() ? "to" : "from", "fisheye");
            arguments.push_back({of + "fov", "360"});
        }
        for (const std::string of : {"", "src"}) {
            if (key != of + "focal" && key != of + "sensor") continue;
            add(of.empty() ? "to" : "from", "rectilinear");
            if (key == of + "sensor") arguments.push_back({of + "focal", "24"});
        }
        if (key == "e" || key == "srce") {
            add(key == "e" ? "to" : "from", "eucm");
            arguments.push_back({key == "e" ? "fov" : "srcfov", "90"});
        }
        if (key == "d" || key == "srcd") {
            // The least value of all is one projection's, the largest one others'.
            add(key == "d" ? "to" : "from", value.starts_with('-') ? "double_sphere" : "pannini");
            arguments.push_back({key == "d" ? "fov" : "srcfov", "90"});
        }
        if (key == "face") {
            const bool is_opengl = value.starts_with('p') || value.starts_with('n');
            add("to", is_opengl ? "cubemap3x2" : "cubemap");
            arguments.push_back({"size", "4x4"});
        }
        if (operation.name == "pano" && value == "hardware") add("to", "rectilinear");
        if (key == "seam" || key.starts_with("front_") || key.starts_with("back_")) {
            sources[0] = "dual_fisheye.exr";
            add("from", "dual_fisheye");
        }
        if (key == "eye") add("stereo", "side-by-side");
        if (key == "samples") add("shutter", "1");
        if (key == "alpha" && operation.name == "morph") add("wrap", "black");
        if (key == "surface" && value == "positions") add("positions", "city.exr");
        if (key == "frame" && operation.name == "pano") add("to", "formula");
        if (key == "frame" && operation.name == "figure") {
            write_text("long.nudes",
                       "figure f 1 e\nellipsoid e 200 300 100\nrepeat 0 1000000 spinby f e e 1 z\nstop\n");
            add("script", "long.nudes");
        }
        if (key == "output" && value == "mips") {
            write_text("dressed.nudes",
                       "figure f 1 e\nellipsoid e 200 300 100\nrepeat 0 1 texture e city.exr 0 0\nstop\n");
            add("script", "dressed.nudes");
        }
        if (operation.name == "figure" && (key == "outlines" || key == "outline_tol"))
            add("style", "outline");
        if (key == "outline_tol") add("outlines", "levels");
        if (key == "solid_scale" || key == "solid_samples") add("solid", "wood");
        if (key == "solid" && value == "formula") add("red", "x");
        if (key == "seed") add("perturbation", "0.1");
        if (key == "bump_scale") add("bump", "city.exr");
        if (operation.name == "drape" && (key == "block" || key == "overlap")) add("scheme", "oka");
        if (operation.name == "mosaic") {
            if (key == "circles" || key == "circle") {
                sources[0] = "tall.exr";
                add("from", "cylindrical");
            }
            if (key == "circle") add("circles", std::to_string(ConcentricStack::kMostCircles));
            if (key == "x" || key == "z") add(key == "x" ? "z" : "x", "0");
        }
        if (key == "picture") {
            for (const Assignment& a : pictures_to(value)) arguments.push_back(a);
        }
        if (operation.name == "pano" && (key == "image" || key == "layers" || key == "feather"))
            return write_project(key == "image" ? 1024 : 2) + "?" + key + "=" + value;
        arguments.push_back({key, value});
        return example(operation, sources, arguments);
    }

  private:
    /// Arguments of a morph of pictures up to that one, two at least.
    static std::vector<Assignment> pictures_to(const std::string& key) {
        const std::vector<std::string>& keys = morph_pictures();
        const auto last = std::find(keys.begin(), keys.end(), key);
        const auto count = static_cast<std::size_t>(last == keys.end() ? 2 : last - keys.begin() + 1);
        std::vector<Assignment> arguments = {{"features", "many.json"}, {"shape_weights", "1"}};
        std::string line = "[1, 2, 9, 3]";
        for (std::size_t i = 1; i < std::max<std::size_t>(2, count); ++i) {
            if (i > 1) arguments.push_back({keys[i], "town.exr"});
            line += ", [1, 2, 9, 3]";
            arguments[1].value += ",0";
        }
        write_text("many.json", "{\"features\": [{\"line\": [" + line + "]}]}");
        return arguments;
    }
    /// Those of a projection; none for what is not the name of one.
    static FaceGrid faces_named(const std::string& value) {
        for (const Projection p : kProjections)
            if (name_of(p) == value) return faces_of(p);
        return {};
    }
};

/// Opens the picture and reads its first pixel.
std::string error_of(const std::string& name) {
    const auto input = OIIO::ImageInput::open(name);
    if (!input) return OIIO::geterror();
    const OIIO::ImageSpec spec = input->spec();
    std::vector<float> pixels(
        spec.tile_width > 0
            ? static_cast<std::size_t>(spec.tile_pixels()) * static_cast<std::size_t>(spec.nchannels)
            : static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels));
    const bool read = spec.tile_width > 0 ? input->read_tile(0, 0, 0, OIIO::TypeFloat, pixels.data())
                                          : input->read_scanline(0, 0, OIIO::TypeFloat, pixels.data());
    if (!read) return input->geterror();
    for (const float value : pixels)
        if (!std::isfinite(value)) return "a pixel is not finite";
    return "";
}

TEST_F(ParameterEnds, EveryRowAcceptsWhatItSaysAndNoMore) {
    for (const Operation* operation : operations())
        for (const Parameter& p : *operation->parameters) {
            const Ends ends = ends_of(p);
            for (const std::string& value : ends.accepted) {
                const std::string name = name_for(*operation, p.name, value);
                EXPECT_EQ(error_of(name), "") << name;
            }
            for (const std::string& value : ends.refused) {
                const std::string name = name_for(*operation, p.name, value);
                std::string start = "anamorph: ";
                start.append(p.name).append("=").append(value).append(": ");
                EXPECT_THAT(open_error(name), AllOf(StartsWith(start), HasSubstr(p.rule()))) << name;
            }
        }
}

}  // namespace
}  // namespace anamorph::test_parameter_ends
