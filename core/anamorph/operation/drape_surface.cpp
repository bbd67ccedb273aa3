// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/drape_surface.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/operation/read_once.h"
#include "anamorph/operation/rows.h"
#include "anamorph/parameter/text_file.h"
#include "anamorph/surface/drape_rows.h"

namespace anamorph {
namespace {

// Weights are from minus this to this.
constexpr double kMostWeight = 1e6;

surface::SurfaceShape shape_of(const ParameterValues& values, double aspect) {
    surface::SurfaceShape shape;
    shape.aspect = aspect;
    shape.angle = values.number("angle");
    if (values.given("radius")) shape.radius = values.number("radius");
    shape.tube = values.number("tube");
    shape.amplitude = values.number("amplitude");
    shape.wavelength = values.number("wavelength");
    shape.phase = values.number("phase");
    shape.direction = values.number("direction");
    shape.turn = values.number("turn");
    return shape;
}

/// The names in `blend`.
std::vector<std::string> blended(const ParameterValues& values) {
    std::vector<std::string> names;
    if (!values.given("blend")) return names;
    std::stringstream list(values.text("blend"));
    for (std::string name; std::getline(list, name, ',');) names.push_back(name);
    return names;
}

/// Does `blend` mean a file by a name? No surface has a dot.
bool is_file(const std::string& name) {
    return name.find('.') != std::string::npos;
}
bool is_list(const std::string& name) {
    return text_file::ends_with(name, ".json") || text_file::ends_with(name, ".csv");
}
/// The key of a file of `blend` among side files.
std::string key_of(const std::string& name) {
    return "blend/" + name;
}

std::vector<double> weights_of(const ParameterValues& values, std::size_t count) {
    std::vector<double> weights;
    if (values.given("weights")) weights = values.numbers("weights");
    if (weights.size() != count)
        throw Error("weights", std::to_string(weights.size()) + " numbers",
                    "must be as many as surfaces in blend, " + std::to_string(count));
    for (const double weight : weights)
        if (!(std::fabs(weight) <= kMostWeight))
            throw Error("weights", shortest(weight), "must be numbers from -1e6 to 1e6");
    return weights;
}

/// The first channels of an image, 1 to 3 of them.
std::vector<float> texels_of(const SideFile& file, const char* key, const SideFileReader& reader,
                             int channels, Size& size) {
    const std::unique_ptr<SideImage> image = reader.image(key, file.name);
    size = {image->display().width(), image->display().height()};
    if (image->channels() < channels)
        throw Error(
            key, printable(file.name),
            "has " + std::to_string(image->channels()) + " channels: must have " + std::to_string(channels));
    if (std::int64_t{size.width} * size.height > surface::SampledField::kMostTexels)
        throw Error(key, printable(file.name),
                    "has " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                        " pixels: must have at most " + std::to_string(surface::SampledField::kMostTexels));
    return read_display(*image, channels, std::string(key) + " \"" + printable(file.name) + "\"");
}

std::shared_ptr<const surface::SampledField> read_positions(const SideFile& file, const char* key,
                                                            const SideFileReader& reader) {
    return read_once<surface::SampledField>(file, "positions", [&] {
        Size size;
        const std::vector<float> texels = texels_of(file, key, reader, 3, size);
        return surface::SampledField(texels, size, 3);
    });
}

/// Heights are brightness, smoothed.
std::shared_ptr<const surface::SampledField> read_heights(const SideFile& file, double sigma,
                                                          const SideFileReader& reader) {
    return read_once<surface::SampledField>(file, "height " + shortest(sigma), [&] {
        const int channels = std::clamp(reader.image("height", file.name)->channels(), 1, 3);
        Size size;
        const std::vector<float> texels = texels_of(file, "height", reader, channels, size);
        std::vector<float> heights(texels.size() / static_cast<std::size_t>(channels));
        for (std::size_t i = 0; i < texels.size(); ++i)
            heights[i / static_cast<std::size_t>(channels)] += texels[i] / static_cast<float>(channels);
        return surface::SampledField(surface::smoothed(heights, size, sigma), size, 1);
    });
}

/// What a formula is made of is for a surface that has one.
void check_formula_keys(const ParameterValues& values, bool has_formula) {
    if (has_formula) return;
    for (const char* name : {"px", "py", "pz", "let"})
        if (values.given(name))
            throw Error(name, printable(values.text(name)),
                        "is of surface=formula: surface must be formula, or blend name it");
    values.refuse_definitions();
}

/// What is missing of a surface, in words.
std::string missing_of(const char* key, const surface::SampledField& field) {
    if (field.missing_texels() == 0) return "";
    return std::to_string(field.missing_texels()) + " texels of " + key + ", the first at " +
           std::to_string(field.first_missing().x) + "," + std::to_string(field.first_missing().y);
}

}  // namespace

LinkedFiles files_of_blend(const ParameterValues& values) {
    LinkedFiles files;
    for (const std::string& name : blended(values))
        if (is_file(name)) files.push_back({key_of(name), name, !is_list(name)});
    return files;
}

ParameterTable drape_surface_rows() {
    using namespace rows;
    return {
        choice(
            "surface", "plane", surface::all_surface_names(),
            "undeformed the picture is 1 high, about the origin, in the plane z = 0, with x to the right "
            "and y up. cylinder: about the y axis; sphere: about the origin, with all latitudes; torus: "
            "about the y axis; page_turn: a sheet curls round a cylinder that rolls over it; waves, "
            "ripples: plane and circular; positions: of the picture that the key positions names; formula: "
            "of px, py and pz"),
        text("blend",
             "names of surfaces, separated by commas, that the surface is blended with, by weights; among "
             "them lists of deformations "
             "(.json, .csv), which stand for the surface moved by them, and pictures of positions"),
        numbers("weights", -kInfinity,
                "one for each surface of blend; what they lack to 1 is the weight of surface itself, and any "
                "may be negative or above 1"),
        image("positions",
              "of surface=positions: a picture whose first three channels are x, y and z, over the whole of "
              "the draped picture, interpolated by smooth cubics"),
        text("px",
             "of surface=formula: x in space, a formula of u and v, from 0 to 1 with v up, of aspect, the "
             "picture's width over its height, and of frame; (u-0.5)*aspect by default"),
        text("py", "the same for y; v-0.5 by default"),
        text("pz", "the same for z; 0 by default"),
        definitions("let",
                    "definitions before these, as in k=0.3;c=cos(k); any other key k=0.3 is one too, and "
                    "stands before these"),
        image("height",
              "a picture by whose brightness, the mean of up to three channels, the surface is raised along "
              "its normal, interpolated by smooth cubics"),
        number("height_scale", "", "0.1", -1000, 1000, "how high brightness 1 is"),
        number("height_smooth", "texels", "1", 0, 100,
               "heights are smoothed by a Gaussian of that standard deviation; 0: not"),
        number("angle", "degrees", surface::kDrapeAngleRow,
               "of cylinder, sphere and torus, the part of a turn that is covered"),
        number("radius", "", surface::kDrapeRadiusRow,
               "of the surface; by default 0.5 (sphere, torus), 0.1 (page_turn), and for a cylinder such "
               "that the picture keeps its width"),
        number("tube", "", surface::kDrapeTubeRow, "radius of a torus's tube"),
        number("amplitude", "", surface::kDrapeAmplitudeRow, "of waves and ripples"),
        number("wavelength", "", surface::kDrapeWavelengthRow, "of waves and ripples"),
        number("phase", "turns", surface::kDrapePhaseRow, "of waves and ripples"),
        number(
            "direction", "degrees", surface::kDrapeDirectionRow,
            "counterclockwise from the x axis: where waves go, and where the part of a page that turns lies"),
        number("turn", "", surface::kDrapeTurnRow, "how far a page is turned"),
        file("deform",
             "a list of deformations, JSON or CSV, that move the surface; their u and v run from 0 to 1, v "
             "up"),
    };
}

DrapeSurfaces::DrapeSurfaces(const OperationInput& input, double aspect) : m_aspect(aspect) {
    const auto file = [&](const char* key) {
        const auto found = input.files.find(key);
        return found == input.files.end() ? nullptr : &found->second;
    };
    const auto keep = [&](const char* key, std::shared_ptr<const surface::SampledField> field) {
        if (const std::string what = missing_of(key, *field); !what.empty())
            m_missing += (m_missing.empty() ? "" : "; ") + what;
        return field;
    };
    if (const SideFile* positions = file("positions"))
        m_files.positions = keep("positions", read_positions(*positions, "positions", input.reader));
    for (const std::string& name : blended(input.values)) {
        const SideFile* designed = is_file(name) ? file(key_of(name).c_str()) : nullptr;
        if (!designed) continue;
        if (is_list(name))
            m_designed[name].deformations =
                parse_deformations_file(input.reader.text(designed->name), designed->name);
        else
            m_designed[name].positions = keep("blend", read_positions(*designed, "blend", input.reader));
    }
    if (const SideFile* heights = file("height"))
        m_files.heights =
            keep("height", read_heights(*heights, input.values.number("height_smooth"), input.reader));
    if (const SideFile* list = file("deform"))
        m_files.deformations = parse_deformations_file(input.reader.text(list->name), list->name);
}

SpaceFormula DrapeSurfaces::formula_of(const ParameterValues& values) const {
    SurfaceText text;
    if (values.given("px")) text.px = values.text("px");
    if (values.given("py")) text.py = values.text("py");
    if (values.given("pz")) text.pz = values.text("pz");
    if (values.given("let")) text.let = values.text("let");
    text.definitions = values.definitions();
    return parse_surface(text, {m_aspect, values.given("frame") ? values.number("frame") : 0});
}

/// Adds the surfaces of `blend` to a sum that has the surface itself, by weights of sum 1 (Oka 1987, eq. 4.3). A list that moves the
/// surface S to S + D (4.1) adds w (S + D): what is taken from the weight of S comes back, and vectors are w V.
void DrapeSurfaces::blend(const ParameterValues& values, surface::SurfaceSum& sum) const {
    const std::vector<std::string>&names = surface::all_surface_names(), blend = blended(values);
    const std::vector<double> weights = weights_of(values, blend.size());
    for (std::size_t i = 0; i < blend.size(); ++i) {
        const auto designed = m_designed.find(blend[i]);
        if (designed != m_designed.end() && !designed->second.positions) {
            for (Deformation moved : designed->second.deformations) {
                moved.vector *= weights[i];
                // The side stays, though the vector turns round.
                if (weights[i] < 0 && moved.has_side())
                    moved.side =
                        moved.side == DeformationSide::front ? DeformationSide::back : DeformationSide::front;
                sum.deformations.push_back(moved);
            }
            continue;
        }
        const auto found =
            std::find(names.begin(), names.end(), designed == m_designed.end() ? blend[i] : "positions");
        if (found == names.end())
            throw Error("blend", printable(blend[i]),
                        "must be names of surfaces, separated by commas, or of files: lists of deformations "
                        "(.json, .csv) or "
                        "pictures of positions");
        sum.parts[0].weight -= weights[i];
        sum.parts.push_back({static_cast<std::size_t>(found - names.begin()), weights[i],
                             designed == m_designed.end() ? nullptr : designed->second.positions});
    }
}

surface::SurfaceSum DrapeSurfaces::sum_of(const ParameterValues& values) const {
    surface::SurfaceSum sum = m_files;
    sum.parts = {{values.choice("surface"), 1}};
    blend(values, sum);
    sum.shape = shape_of(values, m_aspect);
    sum.height_scale = values.number("height_scale");
    const auto has = [&](const char* name) {
        return std::any_of(sum.parts.begin(), sum.parts.end(), [&](const surface::SurfaceSum::Part& part) {
            return surface::all_surface_names()[part.which] == name && !part.positions;
        });
    };
    check_formula_keys(values, has("formula"));
    if (has("formula")) sum.formula = formula_of(values);
    const bool sampled = has("positions");
    if (sampled && !sum.positions) throw Error::not_given("positions", ": must be a picture of x, y and z");
    if (!sampled && sum.positions)
        throw Error("positions is given: surface must be positions, or blend name it");
    for (const surface::SurfaceSum::Part& part : sum.parts)
        if (sum.heights && !surface::has_smooth_normals(part.which))
            throw Error("height is given: surface must not be " + surface::all_surface_names()[part.which] +
                        ", whose normals may turn abruptly");
    return sum;
}

std::shared_ptr<surface::SharedTree> DrapeSurfaces::tree_of(const surface::SurfaceSum& sum) const {
    constexpr std::size_t kKept = 4;
    const std::lock_guard lock(m_kept->mutex);
    auto& trees = m_kept->trees;
    const auto known =
        std::find_if(trees.begin(), trees.end(), [&](const auto& kept) { return kept.first == sum; });
    if (known != trees.end()) {
        std::rotate(trees.begin(), known, known + 1);
        return trees.front().second;
    }
    trees.insert(trees.begin(), {sum, std::make_shared<surface::SharedTree>(surface::make_surface(sum))});
    if (trees.size() > kKept) trees.pop_back();
    return trees.front().second;
}

}  // namespace anamorph
