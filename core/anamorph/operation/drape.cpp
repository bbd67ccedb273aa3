// SPDX-License-Identifier: Apache-2.0
// A picture laid on a surface in space and seen by a camera.
#include "anamorph/operation/drape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "anamorph/operation/block_drape.h"
#include "anamorph/operation/drape_surface.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/sequence.h"
#include "anamorph/operation/solved.h"
#include "anamorph/surface/drape.h"
#include "anamorph/surface/drape_rows.h"

namespace anamorph {
namespace {

using rows::chosen;

constexpr double kFarthest = 1e6;

Parameter vector(const char* name, std::string value, const std::string& doc) {
    Parameter row = rows::numbers(name, -rows::kInfinity, doc);
    row.default_value = std::move(value);
    return row;
}

/// Which pictures there are.
ParameterTable sequence_rows() {
    using namespace rows;
    ParameterTable table = sequence(", and of keys that define names of formulas");
    table.insert(table.begin() + 1, whole("frame", "", "", 0, Sequence::kMostFrames, "one frame alone"));
    return table;
}

/// Where the surface is, and who sees it.
ParameterTable view_rows() {
    using namespace rows;
    return {
        vector("rotate", "0,0,0", "degrees about the x, the y and the z axis, in this order"),
        number("scale", "", "1", 0.001, 1000, "of the surface, after it is rotated"),
        vector("move", "0,0,0", "of the surface, after that"),
        vector("camera", "",
               "position of the camera; by default in front of the origin, where the flat picture fills the "
               "width"),
        vector("target", "0,0,0", "the point that the middle of the picture shows"),
        vector("up", "0,1,0", "the direction that is up in the picture"),
        choice("view", "perspective", {"perspective", "parallel"}, "how the camera sees"),
        number("fov", "degrees", "40", 0.01, 179, "horizontal field of view of a perspective view"),
        number("extent", "", "", 1e-6, kFarthest,
               "width of a parallel view; by default that of the flat picture"),
        size("width and height of the picture, or its width alone; by default the source's"),
        overscan(),
        subimage(),
        tile(),
        mip(),
        hash(),
        reached("of schemes other than auto and of films"),
    };
}

/// How it is drawn.
ParameterTable accuracy_rows() {
    using namespace rows;
    return {
        filter({{"pyramid", Filter::pyramid,
                 "the mean over the least rectangle along the source's sides that covers what a pixel shows, "
                 "from a pyramid (Oka 1987, Williams 1983)"},
                {"summed_area", Filter::summed_area,
                 "the same of all texels, from a table of sums (Crow 1984)"}}),
        clamp(),
        data_channels(),
        data_filter(),
        wrap("goes on as at the edge"),
        number("tol", "pixels", surface::kDrapeTolRow,
               "how far, on the screen, a point of the picture may be drawn from where it belongs"),
        scheme({{"auto", surface::DrapeScheme::automatic},
                {"exact", surface::DrapeScheme::exact},
                {"oka", surface::DrapeScheme::oka,
                 "blocks of the picture as parallelograms, the nearer over the farther, with the tolerance "
                 "that comes out (Oka 1987)"},
                {"oka-z", surface::DrapeScheme::oka_z, "the same with a depth for each pixel"},
                {"hardware", Word::kNone}}),
        text("machine",
             "of scheme hardware: oka-1987, the machine of Oka 1987, and what differs from it, "
             "oka-1987:block=4,fraction_bits=8 or {\"block\": 4, \"fraction_bits\": 8}; by default oka-1987"),
        number("block", "pixels", "8", 0.25, 4096,
               "of oka and oka-z: side of a block, in pixels of the source"),
        number("overlap", "pixels", "0.5", 0, 64,
               "of oka and oka-z: width of what neighbours have in common"),
        toggle("holes", "0",
               "of oka and oka-z: 1: anamorph:holes is counted, for which scheme auto is drawn, too"),
    };
}

/// How it looks, and what is written.
ParameterTable look_rows() {
    using namespace rows;
    return {
        enumeration("shading", "none",
                    {{"none", surface::DrapeShading::none},
                     {"gouraud", surface::DrapeShading::gouraud},
                     {"phong", surface::DrapeShading::phong}},
                    "none; by the light at corners of patches; by the normals there"),
        vector("light", "0,0,1", "directions towards the lights, three numbers each"),
        number("ambient", "", "0.2", 0, 1000, "share of the colour that is seen without light"),
        number("diffuse", "", "0.8", 0, 1000, "share of the colour that light adds"),
        number("specular", "", "0", 0, 1000, "highlights that light adds"),
        number("shininess", "", "20", 0, 100000, "of highlights, the exponent"),
        vector("background", "",
               "values of the channels behind the surface and where its picture's alpha lets through; by "
               "default nothing, 0 in every channel; where it is given for the colors alone, alpha is 1"),
        image("back",
              "the picture on the far side of the surface, of any size, stretched over it as src is, with as "
              "many "
              "channels as that, of which the same is alpha; seen from there it is the right way round; by "
              "default src, as it shows through"),
        image("backdrop",
              "a picture behind the surface and over the background, as large as the screen; with as many "
              "colors, with alpha or without"),
        colorspace("color space to filter in; by default the source's own"),
        output(
            {{"depth", surface::DrapeOutput::depth,
              "the distance ahead of the camera, infinite where nothing is seen"},
             {"normal", surface::DrapeOutput::normal, "the unit normal on the viewer's side"},
             {"patch", surface::DrapeOutput::patch,
              "the number of the patch of the surface that is drawn, -1 where none is"},
             {"coverage", Output::coverage,
              "the share of the pixel in which the surface is seen, by which its colours are faded at edges "
              "into the background, and 0 or 1 with the filters nearest, bilinear and bicubic, which fade "
              "nothing"},
             {"seen", surface::DrapeOutput::seen,
              "1 where the surface is seen in the pixel's middle, else 0"}}),
        toggle("alpha", "0",
               "1: where the picture has no alpha, what is drawn has one: the coverage, by which colors are "
               "faded; without background and backdrop"),
        flip_v(),
    };
}

ParameterTable make_drape_table() {
    ParameterTable table = {
        rows::image("src", "the picture that is draped; by default the recipe's name without .drape")};
    for (const ParameterTable& part :
         {drape_surface_rows(), sequence_rows(), view_rows(), accuracy_rows(), look_rows()})
        table.insert(table.end(), part.begin(), part.end());
    return table;
}

glm::dvec3 vector_of(const ParameterValues& values, const char* name) {
    return rows::three_numbers(values, name, -kFarthest, kFarthest);
}

surface::CameraPose pose_of(const ParameterValues& values, double aspect) {
    surface::CameraPose pose;
    pose.perspective = values.text("view") == "perspective";
    pose.fov = values.number("fov");
    pose.extent = values.given("extent") ? values.number("extent") : aspect;
    pose.position = values.given("camera")
                        ? vector_of(values, "camera")
                        : glm::dvec3(0, 0, aspect / (2 * std::tan(pose.fov * (surface::kPi / 360))));
    pose.target = vector_of(values, "target");
    pose.up = vector_of(values, "up");
    return pose;
}

/// Rotations about x, y and z, one after the other, and a scale.
glm::dmat3 matrix_of(const ParameterValues& values) {
    const glm::dvec3 angles = vector_of(values, "rotate") * (surface::kPi / 180);
    const double scale = values.number("scale");
    glm::dmat3 matrix(scale);
    for (int axis = 0; axis < 3; ++axis) {
        const int i = (axis + 1) % 3, k = (axis + 2) % 3;
        const double c = std::cos(angles[axis]), s = std::sin(angles[axis]);
        glm::dmat3 turn(1.0);
        turn[i][i] = turn[k][k] = c;
        turn[i][k] = s;
        turn[k][i] = -s;
        matrix = turn * matrix;
    }
    return matrix;
}

surface::DrapeOptions options_of(const ParameterValues& values) {
    surface::DrapeOptions options;
    if (values.text("scheme") != "hardware") options.scheme = chosen<surface::DrapeScheme>(values, "scheme");
    options.block = values.number("block");
    options.overlap = values.number("overlap");
    options.tol = values.number("tol");
    options.filter = rows::filter_of(values);
    options.wrap = chosen<Wrap>(values, "wrap");
    if (options.wrap == Wrap::automatic) options.wrap = Wrap::clamp;
    options.output = rows::chosen_output(values);
    if (options.output == Output::coverage) {
        options.output = Output::color;
        options.own = surface::DrapeOutput::coverage;
    }
    if (!rows::has_shared_output(values)) options.own = chosen<surface::DrapeOutput>(values, "output");
    options.lighting = {chosen<surface::DrapeShading>(values, "shading"),
                        drape_lights(values.numbers("light")),
                        values.number("ambient"),
                        values.number("diffuse"),
                        values.number("specular"),
                        values.number("shininess")};
    if (values.given("background"))
        for (const double value : values.numbers("background"))
            options.background.push_back(static_cast<float>(value));
    return options;
}

/// The colors of the backdrop go with those of the picture.
void check_backdrop(const std::vector<SourceImage>& sources, const ParameterValues& values) {
    if (sources.size() < 2) return;
    const auto colors = [](const SourceImage& image) { return image.channels - (image.alpha >= 0 ? 1 : 0); };
    const int has = colors(sources[1]), wanted = colors(sources[0]);
    if (has != wanted)
        throw Error("backdrop has " + std::to_string(has) + " channels besides alpha and src " +
                    std::to_string(wanted) + ": must have as many");
    check_color_space(sources[1], "backdrop", sources[0], "src", values);
}

const char* const kBack = "picture/back";

/// The picture on the far side, which is drawn.
LinkedFiles linked_back(const ParameterValues&, const SideFiles& files, const SideFileReader&) {
    const auto back = files.find("back");
    if (back == files.end()) return {};
    return {{kBack, back->second.name, true}};
}

/// The size of the picture on the far side, which goes with the one on this side; none where there is none.
Size read_back(const OperationInput& input) {
    const auto back = input.files.find("back");
    if (back == input.files.end()) return {};
    const SourceImage& front = input.sources[0];
    const std::unique_ptr<SideImage> image = input.reader.image("back", back->second.name);
    const Box shown = image->display();
    const auto text = [](int channels, int alpha) {
        return std::to_string(channels) + " channels, " +
               (alpha >= 0 ? "number " + std::to_string(alpha) + " alpha" : "none of them alpha");
    };
    if (image->channels() != front.channels || image->alpha() != front.alpha)
        throw Error("back", printable(back->second.name),
                    "has " + text(image->channels(), image->alpha()) + ": must be as src, " +
                        text(front.channels, front.alpha));
    return {shown.width(), shown.height()};
}

/// What is asked for, at any frame.
class DrapeRequest {
  public:
    explicit DrapeRequest(const OperationInput& input)
        : m_sequence(input),
          m_source(input.sources[0].size()),
          m_has_backdrop(input.sources.size() > 1),
          m_has_back(input.values.given("back")),
          m_facts(input.sources[0].facts),
          m_alpha(input.sources[0].alpha),
          m_backdrop_alpha(input.sources.size() > 1 ? input.sources[1].alpha : -1),
          m_surfaces(std::make_shared<DrapeSurfaces>(input, aspect())) {
        check_backdrop(input.sources, input.values);
        m_back = read_back(input);
        // What does not depend on the size of the picture is checked now.
        for (int i = 0; i < frames(); ++i) check(number_of(i));
    }

    int frames() const { return m_sequence.frames(); }
    /// The number of the i-th of these.
    int number_of(int i) const { return static_cast<int>(m_sequence.time_of(i)); }
    bool has_backdrop() const { return m_has_backdrop; }
    bool has_back() const { return m_has_back; }
    bool is_film() const { return m_sequence.is_film(); }

    /// A frame's values.
    ParameterValues values_at(int frame) const { return m_sequence.values_at(frame); }
    Size target(const ParameterValues& values) const { return rows::size_of(values, square_size()); }
    surface::DrapeOptions options(const ParameterValues& values) const {
        surface::DrapeOptions options = options_of(values);
        data(values, options.filter);
        options.alpha = m_alpha;
        options.backdrop_alpha = m_backdrop_alpha;
        options.back = m_back;
        options.overscan = rows::overscan_of(values, target(values));
        return options;
    }
    /// Channels that hold no colour. Where all do, `filter` becomes theirs.
    DataChannels data(const ParameterValues& values, Filter& filter) const {
        return rows::data_of(values, m_facts, filter);
    }
    DataChannels data(const ParameterValues& values) const {
        Filter filter = Filter::nearest;
        return data(values, filter);
    }
    bool has_behind(const ParameterValues& values) const {
        return m_has_backdrop || values.given("background");
    }
    const std::string& missing() const { return m_surfaces->missing(); }

    /// `shown`: the screen without overscan.
    surface::Camera camera(const ParameterValues& values, const Size& shown) const {
        const Size overscan = rows::overscan_of(values, target(values));
        const Size screen{shown.width + 2 * overscan.width, shown.height + 2 * overscan.height};
        return {pose_of(values, aspect()), matrix_of(values), vector_of(values, "move"), screen, overscan};
    }
    /// The machine of scheme hardware.
    std::optional<machine::BlockMachine> machine(const ParameterValues& values) const {
        std::optional<machine::BlockMachine> machine = drape_machine(values, options(values));
        rows::check_scheme_of(values, "machine", {"hardware"});
        for (const char* name : {"block", "overlap"}) rows::check_scheme_of(values, name, {"oka", "oka-z"});
        if (machine && values.given("holes"))
            throw Error("holes", values.text("holes"), "must not be given with scheme=hardware");
        return machine;
    }
    const Size& source() const { return m_source; }
    surface::SurfaceSum sum(const ParameterValues& values) const { return m_surfaces->sum_of(values); }
    std::shared_ptr<const surface::DrapedSurface> surface(const ParameterValues& values) const {
        const auto tree = m_surfaces->tree_of(sum(values));
        return {tree, &tree->tree.surface()};
    }
    surface::Drape drape(const ParameterValues& values, const Size& shown,
                         const surface::DrapeOptions& options) const {
        return {m_surfaces->tree_of(m_surfaces->sum_of(values)), camera(values, shown), m_source, options};
    }
    /// Is the coverage to be added as alpha?
    bool adds_alpha(const ParameterValues& values) const {
        if (!rows::adds_alpha(values, m_alpha >= 0, true)) return false;
        for (const char* name : {"background", "backdrop"})
            if (values.given(name))
                throw Error("alpha", "1", std::string("must not be given together with ") + name);
        return true;
    }

  private:
    double aspect() const { return m_facts.pixel_aspect * m_source.width / m_source.height; }
    /// The source's size in square pixels as large as its longer ones.
    Size square_size() const {
        const double aspect = m_facts.pixel_aspect;
        const auto side = [](double pixels) {
            return static_cast<int>(std::clamp(std::round(pixels), 1.0, double{kMaxSide}));
        };
        return {aspect > 1 ? side(m_source.width * aspect) : m_source.width,
                aspect < 1 ? side(m_source.height / aspect) : m_source.height};
    }

    void check(int frame) const {
        try {
            const ParameterValues values = values_at(frame);
            m_surfaces->sum_of(values);
            camera(values, target(values));
            machine(values);
            rows::check_overscan(values);
            adds_alpha(values);
            data(values);
        } catch (const Error& error) {
            if (!m_sequence.has_keys()) throw;
            throw Error("frame " + std::to_string(frame) + ": " + error.what());
        }
    }

    Sequence m_sequence;
    Size m_source;
    bool m_has_backdrop, m_has_back;
    Size m_back;
    SourceFacts m_facts;
    int m_alpha, m_backdrop_alpha;
    std::shared_ptr<const DrapeSurfaces> m_surfaces;
};

PixelKind pixels_of(const surface::DrapeOptions& options) {
    if (options.own == surface::DrapeOutput::shared) return pixels_of(options.output);
    return options.own == surface::DrapeOutput::normal ? PixelKind::vector : PixelKind::value;
}

/// The drapes that a picture is made of.
struct DrapeParts {
    surface::Drape color;
    std::optional<surface::Drape> coverage = {};  ///< drawn to the last channel
    /// Channels that hold no colour are those of the side that is seen in a pixel's middle, neither lit nor mixed; where none is,
    /// those of what is behind, if there is anything.
    std::vector<int> data = {};
    bool counts_holes = false;
    bool reached_by_drawing = false;
    bool shows_depth = false;
    std::optional<surface::Drape> bare = {}, behind = {}, seen = {};
};

DrapeParts parts_of(const DrapeRequest& request, const ParameterValues& values, const Size& size,
                    bool adds_alpha) {
    const surface::DrapeOptions options = request.options(values);
    const auto drape = [&](const surface::DrapeOptions& of) { return request.drape(values, size, of); };
    const auto value_of = [&](surface::DrapeOutput output) {
        surface::DrapeOptions of_value = options;
        of_value.own = output;
        return drape(of_value);
    };
    DrapeParts parts{drape(options)};
    const bool shares_edges =
        options.scheme == surface::DrapeScheme::automatic || options.scheme == surface::DrapeScheme::exact;
    parts.counts_holes = shares_edges || values.toggle("holes");
    parts.shows_depth = options.own == surface::DrapeOutput::depth;
    parts.reached_by_drawing = options.scheme != surface::DrapeScheme::automatic && !values.toggle("holes");
    if (adds_alpha) parts.coverage.emplace(value_of(surface::DrapeOutput::coverage));
    const DataChannels data = request.data(values);
    if (pixels_of(options) != PixelKind::color || data.channels.empty()) return parts;
    parts.data = data.channels;
    surface::DrapeOptions of_data = options;
    of_data.filter = data.filter;
    of_data.lighting.shading = surface::DrapeShading::none;
    if (request.has_behind(values)) {
        parts.behind.emplace(drape(of_data));
        parts.seen.emplace(value_of(surface::DrapeOutput::seen));
    }
    of_data.background.clear();
    parts.bare.emplace(drape(of_data));
    return parts;
}

/// A drape of the first source.
class SolvedDrape final : public SolvedPicture {
  public:
    /// `request` says which sources there are.
    SolvedDrape(const DrapeRequest& request, DrapeParts parts)
        : SolvedDrape(std::move(parts), request.has_backdrop(), request.has_back()) {}
    SolvedDrape(DrapeParts parts, bool has_backdrop, bool has_back)
        : m_parts(std::move(parts)), m_has_backdrop(has_backdrop), m_has_back(has_back) {}

    bool reached_by_drawing() const override { return m_parts.reached_by_drawing; }
    Attributes known() const override {
        const surface::Drape& drape = m_parts.color;
        Attributes all = {{"anamorph:patches", static_cast<int>(drape.patches())}};
        if (const auto parts = drape.left_out()) all.push_back({"anamorph:blocks_left_out", *parts});
        const std::optional<double> off = m_parts.shows_depth ? drape.max_depth_error() : std::nullopt;
        if (off) all.push_back({"anamorph:max_depth_error", *off});
        return all;
    }
    Attributes reached(const ParallelFor& parallel_for) const override {
        const surface::Drape& drape = m_parts.color;
        const Reached reached = drape.reached(parallel_for);
        Attributes all = known();
        all.push_back({"anamorph:max_error", reached.max_error});
        all.push_back({"anamorph:exact_fraction", reached.exact_fraction});
        const std::optional<int> holes = m_parts.counts_holes ? drape.holes(parallel_for) : std::nullopt;
        if (holes) all.push_back({"anamorph:holes", *holes});
        return all;
    }
    std::unique_ptr<const SolvedPicture> of_moved() const override {
        if (!m_parts.bare || m_parts.behind) return nullptr;
        return std::make_unique<SolvedDrape>(DrapeParts{*m_parts.bare}, m_has_backdrop, m_has_back);
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        const Source* const source = sources.empty() ? nullptr : sources[0];
        const auto given = [&](bool is_given, std::size_t i) {
            return is_given && i < sources.size() ? sources[i] : nullptr;
        };
        const Source *const backdrop = given(m_has_backdrop, 1), *const back = given(m_has_back,
                                                                                     m_has_backdrop ? 2 : 1);
        const int colors = view.channels - (m_parts.coverage ? 1 : 0);
        const ImageView of_colors = channels_of(view, 0, colors);
        bool ok = m_parts.color.draw(source, box, of_colors, parallel_for, backdrop, back);
        if (m_parts.bare) ok = draw_data(source, backdrop, back, box, of_colors, parallel_for) && ok;
        if (m_parts.coverage)
            ok = m_parts.coverage->draw(nullptr, box, channels_of(view, colors, 1), parallel_for) && ok;
        return ok;
    }

  private:
    bool draw_data(const Source* source, const Source* backdrop, const Source* back, const Box& box,
                   const ImageView& to, const ParallelFor& parallel_for) const {
        const auto pixels = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height());
        std::vector<std::byte> drawn(pixels * static_cast<std::size_t>(to.channels * size_of(to.type)));
        const ImageView from = packed_view(drawn.data(), to.type, box.width(), box.height(), to.channels);
        bool ok = true;
        std::vector<float> seen(pixels, 1.0f);
        if (m_parts.behind) {
            ok = m_parts.behind->draw(source, box, from, parallel_for, backdrop, back);
            copy_channels(m_parts.data, from, to, [](int, int) { return true; });
            m_parts.seen->draw(nullptr, box,
                               packed_view(reinterpret_cast<std::byte*>(seen.data()), PixelType::float32,
                                           box.width(), box.height(), 1),
                               parallel_for);
        }
        ok = m_parts.bare->draw(source, box, from, parallel_for, nullptr, back) && ok;
        copy_channels(m_parts.data, from, to, [&](int x, int y) {
            return seen[static_cast<std::size_t>(y) * static_cast<std::size_t>(box.width()) +
                        static_cast<std::size_t>(x)] != 0;
        });
        return ok;
    }

    DrapeParts m_parts;
    bool m_has_backdrop, m_has_back;
};

class Drapes final : public Pictures {
  public:
    explicit Drapes(std::shared_ptr<const DrapeRequest> request) : m_request(std::move(request)) {}

    int frames() const override { return m_request->frames(); }

    std::optional<PictureRequest> picture(int frame, int level) const override {
        const int number = m_request->number_of(frame);
        const ParameterValues values = m_request->values_at(number);
        const std::optional<Size> size = level_size(m_request->target(values), level);
        const surface::DrapeOptions options = m_request->options(values);
        if (!size || (level > 0 && !(options.overscan == Size{}))) return {};
        PictureRequest picture;
        picture.size = *size;
        picture.add_overscan(options.overscan);
        picture.pixels = pixels_of(options);
        // What the paper's blocks and its machine come to is no tolerance that they hold.
        if (values.text("scheme") == "auto" || values.text("scheme") == "exact")
            picture.says = {{"anamorph:tol", options.tol}};
        const bool plain = options.lighting.shading == surface::DrapeShading::none &&
                           options.background.empty() && !m_request->has_backdrop() && !m_request->has_back();
        if (picture.pixels == PixelKind::color && options.filter == Filter::nearest && plain)
            picture.moves = 0;
        if (picture.pixels == PixelKind::color && !m_request->has_behind(values) && !m_request->has_back())
            picture.moved_channels = moved_channels(m_request->data(values));
        if (m_request->is_film()) picture.says.push_back({"anamorph:frame", number});
        if (!m_request->missing().empty()) picture.says.push_back({"anamorph:missing", m_request->missing()});
        picture.adds_alpha = picture.pixels == PixelKind::color && m_request->adds_alpha(values);
        picture.solve = [request = m_request, values, adds_alpha = picture.adds_alpha,
                         size = *size]() -> std::unique_ptr<const SolvedPicture> {
            if (const auto machine = request->machine(values))
                return solved_by_blocks({*machine, request->sum(values), request->surface(values),
                                         request->camera(values, size), request->source(),
                                         request->options(values), size, request->data(values)});
            return std::make_unique<SolvedDrape>(*request, parts_of(*request, values, size, adds_alpha));
        };
        return picture;
    }

  private:
    std::shared_ptr<const DrapeRequest> m_request;
};

}  // namespace

std::vector<glm::dvec3> drape_lights(const std::vector<double>& numbers) {
    const auto check = [&](bool holds, const char* must) {
        std::string text;
        for (const double number : numbers) text += (text.empty() ? "" : ",") + shortest(number);
        if (!holds) throw Error("light", text, must);
    };
    check(numbers.size() % 3 == 0, "must be three numbers for each light");
    std::vector<glm::dvec3> lights;
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
        const glm::dvec3 light(numbers[i], numbers[i + 1], numbers[i + 2]);
        const double largest = std::max({std::fabs(light.x), std::fabs(light.y), std::fabs(light.z)});
        check(largest != 0, "must be directions, other than 0,0,0");
        lights.push_back(glm::normalize(light / largest));
    }
    return lights;
}

const Operation& drape_operation() {
    static const ParameterTable table = make_drape_table();
    static const Operation operation{
        .name = "drape",
        .title = "A picture laid on a surface in space",
        .parameters = &table,
        .sources = {"src", "backdrop"},
        .least_sources = 1,
        .example = {"surface=cylinder&angle=120&camera=0.4,0.3,2.5", {}},
        .make = [](const OperationInput& input) -> std::unique_ptr<const Pictures> {
            return std::make_unique<Drapes>(std::make_shared<DrapeRequest>(input));
        },
        .named = files_of_blend,
        .linked = linked_back};
    return operation;
}

}  // namespace anamorph
