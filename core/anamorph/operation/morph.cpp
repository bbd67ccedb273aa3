// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/morph.h"

#include <algorithm>

#include "anamorph/machine/machine_text.h"
#include "anamorph/morph/features_file.h"
#include "anamorph/operation/read_once.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/shaded_morph.h"
#include "anamorph/operation/solved.h"

namespace anamorph {
namespace {

using rows::chosen;

constexpr int kMaxFrames = 9999;

/// Weights of the pictures.
Parameter weights(const char* name, const char* doc) {
    Parameter row = rows::numbers(name, -MorphOptions::kMostT, doc);
    row.maximum = MorphOptions::kMostT;
    return row;
}

ParameterTable make_morph_table() {
    using namespace rows;
    ParameterTable table = {
        image("a", "the first picture; by default the recipe's name without .morph"),
        image("b", "the second picture"),
    };
    for (std::size_t i = 2; i < morph_pictures().size(); ++i)
        table.push_back(image(morph_pictures()[i].c_str(), "one more picture, with shape_weights"));
    const ParameterTable others = {
        file("features", "lines that correspond to each other in the pictures: .json, .csv or .svg"),
        number("t", "", "0.5", -MorphOptions::kMostT, MorphOptions::kMostT,
               "of the shape: 0 is that of a, 1 that of b"),
        number("t_color", "", "", -MorphOptions::kMostT, MorphOptions::kMostT,
               "of the color: 0 is that of a, 1 that of b; by default t"),
        weights("shape_weights", "of the shape, in place of t: one for each picture, with sum 1"),
        weights("color_weights", "of the color, in place of t_color; by default shape_weights"),
        whole("frames", "", "1", 1, kMaxFrames,
              "more than 1: as many subimages, t running evenly from 0 in the first to 1 in the last"),
        number(
            "weight_a", "", "1", 0, LineWeights::kMostA,
            "a of a line's weight (length^p / (a + distance))^b: the smaller, the closer lines are followed"),
        number("weight_b", "", "2", 0, LineWeights::kMostB, "b of it: how fast a line's influence falls off"),
        number("weight_p", "", "0.5", 0, LineWeights::kMostP, "p of it: how much more long lines count"),
        number(
            "pin_border", "", "", 0, kInfinity,
            "holds the picture's border with lines of this weight; 0: not; by default as the features say"),
        size("width and height of the picture, or its width alone; by default those of a"),
        overscan(),
        subimage(),
        tile(),
        mip(),
        hash(),
        reached("of scheme hardware and of films"),
        filter(),
        clamp(),
        data_channels(),
        data_filter(),
        wrap("is clamp"),
        tol(),
        scheme({{"auto", MorphScheme::automatic}, {"exact", MorphScheme::exact}, {"hardware", Word::kNone}}),
        text("machine",
             "of scheme hardware: kim-2003, the meshes, the pixel shader and the frame buffer of Kim 2003, "
             "and what "
             "differs from it, kim-2003:cells=24,levels=0 or {\"cells\": 24, \"levels\": 0}; by default "
             "kim-2003"),
        colorspace("color space to filter and blend in; by default that of the pictures"),
        output({{"lines", Word::kNone, "color with the features of all pictures drawn over it"}}),
        alpha("with wrap=black"),
        flip_v(),
        choice("picture", "", morph_pictures(),
               "one picture alone, warped, in place of the blend: its color, stmap, error, bound; by default "
               "stmap is that of a, error and bound are the largest"),
    };
    table.insert(table.end(), others.begin(), others.end());
    return table;
}

/// The unit of scheme hardware. What is said of a machine is checked with the other schemes too.
std::optional<machine::MorphUnit> unit_of(const ParameterValues& values) {
    const machine::MorphUnit unit = values.given("machine")
                                        ? machine::morph_unit_from_text(values.text("machine"))
                                        : machine::MorphUnit{};
    rows::check_scheme_of(values, "machine", {"hardware"});
    if (values.text("scheme") != "hardware") return {};
    rows::check_overscan(values);
    if (values.text("output") == "lines")
        throw Error("output", "lines", "must be another with scheme=hardware");
    return unit;
}

/// What is drawn, and of which picture.
void read_output(const ParameterValues& values, std::size_t pictures, MorphOptions& options) {
    options.output = rows::chosen_output(values);
    options.lines = values.text("output") == "lines";
    if (!values.given("picture")) return;
    const std::string& key = values.text("picture");
    const std::vector<std::string>& keys = morph_pictures();
    const auto index = static_cast<std::size_t>(std::find(keys.begin(), keys.end(), key) - keys.begin());
    if (index >= pictures)
        throw Error("picture", key, "must be one of the pictures that are given, a to " + keys[pictures - 1]);
    options.picture = static_cast<int>(index);
}

}  // namespace

const std::vector<std::string>& morph_pictures() {
    static const std::vector<std::string> keys = {"a", "b", "c", "d", "e", "f", "g", "h"};
    return keys;
}

MorphOptions MorphRequest::frame_options(int frame) const {
    MorphOptions out = options;
    if (frames > 1) out.t = double(frame) / (frames - 1);
    return out;
}

MorphRequest read_morph_request(const ParameterValues& values, const std::vector<Size>& pictures) {
    MorphRequest request;
    request.pictures = pictures;
    const Size size = rows::size_of(values, {pictures[0].width, pictures[0].height});
    request.width = size.width;
    request.height = size.height;

    MorphOptions& options = request.options;
    options.overscan = rows::overscan_of(values, size);
    request.machine = unit_of(values);
    if (!request.machine) options.scheme = chosen<MorphScheme>(values, "scheme");
    options.tol = values.number("tol");
    options.filter = rows::filter_of(values);
    options.wrap = chosen<Wrap>(values, "wrap");
    read_output(values, pictures.size(), options);
    options.t = values.number("t");
    if (values.given("t_color")) options.t_color = values.number("t_color");
    if (values.given("shape_weights")) options.shape_weights = values.numbers("shape_weights");
    if (values.given("color_weights")) options.color_weights = values.numbers("color_weights");
    options.weight_a = values.number("weight_a");
    options.weight_b = values.number("weight_b");
    options.weight_p = values.number("weight_p");
    if (values.given("pin_border")) request.pin_border = values.number("pin_border");

    for (const char* name : {"shape_weights", "color_weights"})
        if (values.given(name))
            check_mixture(name, values.text(name), values.numbers(name), static_cast<int>(pictures.size()));

    request.frames = values.whole("frames");
    // What says the same as another key, where both are given.
    const auto refuse = [&](const char* name, const char* other) {
        if (values.given(name) && values.given(other))
            throw Error(name, values.text(name), std::string("must not be given together with ") + other);
    };
    refuse("t", "shape_weights");
    refuse("t_color", "color_weights");
    refuse("t_color", "shape_weights");
    if (request.frames > 1) {
        refuse("t", "frames");
        refuse("shape_weights", "frames");
        refuse("color_weights", "frames");
    }
    if (pictures.size() > 2 && !values.given("shape_weights"))
        throw Error::not_given("shape_weights", ": must be one number for each of the " +
                                                    std::to_string(pictures.size()) +
                                                    " pictures, with sum 1");
    return request;
}

namespace {

/// What a blend needs: as many channels of the same meaning, colour in one space.
void check_alike(const std::vector<SourceImage>& sources, const ParameterValues& values) {
    for (std::size_t i = 1; i < sources.size(); ++i) {
        const SourceImage &a = sources[0], &other = sources[i];
        const std::string& key = morph_pictures()[i];
        if (other.channels != a.channels)
            throw Error("picture " + key + " has " + std::to_string(other.channels) + " channels and a has " +
                        std::to_string(a.channels) + ": must have as many");
        if (other.facts.pixel_aspect != a.facts.pixel_aspect)
            throw Error("picture " + key + " has PixelAspectRatio=" +
                        shortest(static_cast<float>(other.facts.pixel_aspect)) + " and a has " +
                        shortest(static_cast<float>(a.facts.pixel_aspect)) + ": must have the same");
        check_color_space(other, "picture " + key, a, "a", values);
    }
}

/// The shapes in the order of the pictures whose files they are linked to, where each is to another one and they do not stand so.
std::optional<std::vector<int>> order_by_links(const Features& features, const OperationInput& input) {
    const auto count = static_cast<std::size_t>(features.shapes());
    std::vector<int> order;
    for (std::size_t i = 0; i < count; ++i) {
        const auto file = input.files.find(morph_pictures()[i]);
        if (file == input.files.end()) return {};
        // Of a recipe, the picture that it names.
        const auto is_of = [&](int shape) {
            const std::string& link = features.picture(shape);
            return !link.empty() && file->second.name.find(link) != std::string::npos;
        };
        int found = -1;
        for (int k = 0; k < features.shapes(); ++k) {
            if (!is_of(k)) continue;
            if (found >= 0) return {};
            found = k;
        }
        if (found < 0 || std::find(order.begin(), order.end(), found) != order.end()) return {};
        order.push_back(found);
    }
    return std::is_sorted(order.begin(), order.end()) ? std::nullopt : std::optional(order);
}

std::shared_ptr<const Features> read_features(const MorphRequest& request, const OperationInput& input) {
    const auto found = input.files.find("features");
    if (found == input.files.end())
        throw Error::not_given("features", ": must be the name of a .json, .csv or .svg file");
    const SideFile& file = found->second;
    std::shared_ptr<const Features> features = read_once<Features>(
        file, "features", [&] { return parse_features_file(input.reader.text(file.name), file.name); });
    const std::size_t pictures = input.sources.size();
    if (static_cast<std::size_t>(features->shapes()) != pictures)
        throw Error("features", printable(file.name),
                    "the file has " + std::to_string(features->shapes()) + " shapes: must have " +
                        std::to_string(pictures) + ", as many as pictures are given");
    const std::optional<std::vector<int>> order = order_by_links(*features, input);
    if (!order && !request.pin_border) return features;
    auto changed = std::make_shared<Features>(order ? features->in_order(*order) : *features);
    if (request.pin_border) changed->pin_border(*request.pin_border);
    return changed;
}

/// "a is layer cat, b is layer dog"; nothing where shapes have no names.
std::string named_shapes(const Features& features) {
    std::string text;
    for (int k = 0; k < features.shapes(); ++k) {
        if (features.title(k).empty()) return "";
        text += (k > 0 ? ", " : "") + morph_pictures()[static_cast<std::size_t>(k)] + " is layer " +
                features.title(k);
    }
    return text;
}

class Morphs final : public Pictures {
  public:
    Morphs(const MorphRequest& request, std::shared_ptr<const Features> features)
        : m_request(request), m_features(std::move(features)) {}

    int frames() const override { return m_request.frames; }

    std::optional<PictureRequest> picture(int frame, int level) const override {
        const std::optional<Size> size = level_size({m_request.width, m_request.height}, level);
        const Size& overscan = m_request.options.overscan;
        if (!size || (level > 0 && !(overscan == Size{}))) return {};
        MorphRequest request = m_request;
        request.width = size->width;
        request.height = size->height;
        const MorphOptions options = request.frame_options(frame);
        PictureRequest picture;
        picture.size = *size;
        picture.add_overscan(overscan);
        picture.keeps_format = level == 0 && picture.shows(m_request.pictures[0]);
        picture.pixels = pixels_of(options.output);
        picture.adds_alpha = options.adds_alpha;
        if (!request.machine) picture.says = {{"anamorph:tol", options.tol}};
        // A film's frames are blends but for a few.
        if (picture.pixels == PixelKind::color && m_request.frames == 1 && !request.machine)
            picture.moves = moved_picture(options, static_cast<int>(request.pictures.size()));
        if (picture.pixels == PixelKind::color) picture.moved_channels = moved_channels(options.data);
        for (Attribute& attribute : said_of_pixels(request.pixel_aspect))
            picture.says.push_back(std::move(attribute));
        if (options.shape_weights.empty()) picture.says.push_back({"anamorph:t", options.t});
        if (const std::string shapes = named_shapes(*m_features); !shapes.empty())
            picture.says.push_back({"anamorph:shapes", shapes});
        picture.solve = [request, options, features = m_features]() -> std::unique_ptr<const SolvedPicture> {
            if (request.machine) return shaded_morph(features, request, options);
            return solved(
                morphed_picture(features, request.pictures, {request.width, request.height}, options));
        };
        return picture;
    }

  private:
    MorphRequest m_request;
    std::shared_ptr<const Features> m_features;
};

const char* const kExampleFeatures = R"({"sizes": [[150, 100], [150, 100]], "features": [
    {"line": [[60, 30, 120, 40], [80, 20, 130, 50]]},
    {"line": [[40, 100, 90, 90], [30, 80, 70, 100]]}]})";

std::unique_ptr<const Pictures> read_morphs(const OperationInput& input) {
    std::vector<Size> sizes;
    for (const SourceImage& image : input.sources) sizes.push_back(image.size());
    check_alike(input.sources, input.values);
    MorphRequest request = read_morph_request(input.values, sizes);
    if (Size{request.width, request.height} == sizes[0])
        request.pixel_aspect = input.sources[0].facts.pixel_aspect;
    request.options.data = rows::data_of(input.values, input.sources[0].facts, request.options.filter);
    if (request.machine && request.options.output == Output::color) check_shaded_sources(input.sources);
    request.options.adds_alpha =
        rows::adds_alpha(input.values, input.sources[0].alpha >= 0, request.options.wrap == Wrap::black);
    return std::make_unique<Morphs>(request, read_features(request, input));
}

}  // namespace

const Operation& morph_operation() {
    static const ParameterTable table = make_morph_table();
    static const Operation operation{
        "morph", "Pictures that turn into each other along corresponding lines", &table,     morph_pictures(),
        2,       {"features=lines.json", {{"lines.json", kExampleFeatures}}},    read_morphs};
    return operation;
}

}  // namespace anamorph
