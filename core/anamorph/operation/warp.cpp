// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/warp.h"

#include "anamorph/machine/machine_text.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/operation/read_once.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/shaded_picture.h"
#include "anamorph/operation/solved.h"
#include "anamorph/parameter/left_out.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

using rows::chosen;

constexpr int kMaxStep = 1 << 16;

ParameterTable make_warp_table() {
    using namespace rows;
    return {
        image("src", "the source image; by default the recipe's name without .warp"),
        image("mesh",
              "the control mesh: a .json file, or an image that is an ST-map (any name with another ending)"),
        whole("step", "pixels", "1", 1, kMaxStep,
              "of an ST-map: every step-th pixel is a vertex of the mesh"),
        file(
            "points",
            "in place of a mesh: pairs of points x, y (in the picture), u, v (in the source), .csv or .json"),
        enumeration(
            "direction", "", {{"pull", Direction::pull}, {"push", Direction::push}},
            "pull: the mesh lies in the picture, its vertices say where in the source; push: the mesh lies "
            "in the source, its vertices say where they go; by default what the file says, else pull"),
        number("amount", "", "1", -kInfinity, kInfinity,
               "how far every vertex is moved: 0 not at all, 1 as given, any other as far in proportion"),
        size("width and height of the picture, or its width alone; by default the source's, of an ST-map "
             "that pulls its own"),
        overscan(),
        subimage(),
        concatenate(),
        tile(),
        mip(),
        hash(),
        reached("of scheme hardware"),
        filter(),
        clamp(),
        data_channels(),
        data_filter(),
        wrap("is black"),
        tol(),
        scheme({{"auto", WarpScheme::automatic},
                {"exact", WarpScheme::exact},
                {"hermite", WarpScheme::hermite, "the mesh's bicubic patches in float"},
                {"residual", WarpScheme::residual},
                {"hardware", Word::kNone}}),
        text("machine",
             "of scheme hardware: ps20, a pixel shader as in Kim 2003, or kim-2003, the one that is printed "
             "there, and "
             "what differs from it, "
             "ps20:table_size=32,arithmetic=fixed16 or {\"table_size\": 32, \"arithmetic\": \"fixed16\"}; by "
             "default ps20"),
        file("program",
             "of scheme hardware: a program of pixel shader 2.0 that is run for each pixel in place of ours; "
             "it needs no mesh"),
        colorspace("color space to filter in; by default the source's own"),
        output({{"folds", Word::kNone, "not 0 where the warp folds"},
                {"mesh", Word::kNone, "color with the mesh and its subdivision drawn over it"}}),
        alpha(),
        flip_v(", and of the one that mesh names,"),
    };
}

/// The unit of scheme hardware. What is said of a machine is checked with the other schemes too.
std::optional<machine::ShaderUnit> shader_of(const ParameterValues& values) {
    machine::ShaderUnit unit;
    if constexpr (!kIsSmall)
        if (values.given("machine")) unit = machine::shader_unit_from_text(values.text("machine"));
    rows::check_scheme_of(values, "machine", {"hardware"});
    if (values.text("scheme") != "hardware") return {};
    return unit;
}

/// Divides a position in an image by its size.
void divide(double& x, double& y, const Size& size) {
    x /= size.width;
    y /= size.height;
}

}  // namespace

Size warp_target(const ParameterValues& values, const Size& natural) {
    const Size size = rows::size_of(values, {natural.width, natural.height});
    return {size.width, size.height};
}

WarpRequest read_warp_request(const ParameterValues& values, const Size& source) {
    WarpRequest request;
    request.source = source;
    request.target = warp_target(values, source);
    MeshWarpOptions& options = request.options;
    request.machine = shader_of(values);
    if (!request.machine) options.scheme = chosen<WarpScheme>(values, "scheme");
    options.tol = values.number("tol");
    options.filter = rows::filter_of(values);
    options.wrap = chosen<Wrap>(values, "wrap");
    options.output = rows::chosen_output(values);
    options.folds = values.text("output") == "folds";
    options.draws_mesh = values.text("output") == "mesh";
    if (options.draws_mesh && request.machine)
        throw Error("output", "mesh", "must be another with scheme=hardware");
    options.amount = values.number("amount");
    request.step = values.whole("step");
    if (values.given("direction")) request.direction = chosen<Direction>(values, "direction");
    return request;
}

WarpMap in_fractions(const WarpMap& map, const Size& source, const Size& target) {
    WarpMap out = map;
    if (auto* points = std::get_if<ControlPoints>(&out.shape); points && points->units == Units::pixels) {
        points->units = Units::fractions;
        for (ControlPoints::Pair& pair : points->pairs) {
            divide(pair.x, pair.y, target);
            divide(pair.u, pair.v, source);
        }
    }
    if (auto* mesh = std::get_if<ControlMesh>(&out.shape); mesh && mesh->units == Units::pixels) {
        mesh->units = Units::fractions;
        const bool pull = mesh->direction == Direction::pull;
        const Size &from = pull ? target : source, &to = pull ? source : target;
        for (double& x : mesh->x_lines) x /= from.width;
        for (double& y : mesh->y_lines) y /= from.height;
        for (Point<double>& vertex : mesh->vertices) divide(vertex.x, vertex.y, to);
        for (ControlMesh::Level& level : mesh->levels)
            for (ControlMesh::Vertex& vertex : level.vertices) divide(vertex.at.x, vertex.at.y, to);
    }
    return out;
}

namespace {

/// u and v of each pixel; where alpha is 0 they are NaN.
std::vector<float> read_uv(SideImage& image) {
    const int alpha = image.alpha() > 1 ? image.alpha() : 0, channels = alpha > 0 ? alpha + 1 : 2;
    std::vector<float> pixels = image.read(channels);
    if (alpha == 0) return pixels;
    const auto step = static_cast<std::size_t>(channels);
    const std::size_t count = pixels.size() / step;
    for (std::size_t i = 0; i < count; ++i) {
        const float* from = &pixels[i * step];
        const bool is_hole = from[alpha] == 0;
        const float u = is_hole ? NAN : from[0], v = is_hole ? NAN : from[1];
        pixels[2 * i] = u;
        pixels[2 * i + 1] = v;
    }
    pixels.resize(2 * count);
    pixels.shrink_to_fit();
    return pixels;
}

/// How an ST-map is read.
struct StMapReading {
    int step;
    bool flip_v;
};

WarpMap read_stmap(const std::string& name, const StMapReading& how, const SideFileReader& reader) {
    const std::string what = "ST-map \"" + printable(name) + "\"";
    if (kIsSmall) refuse_left_out(what);
    const std::unique_ptr<SideImage> image = reader.image("mesh", name);
    const Size size = image->size();
    const std::string shape = std::to_string(size.width) + "x" + std::to_string(size.height);
    if (image->channels() < 2) throw Error(what + " has one channel: must have two, u and v");
    if (std::int64_t{size.width} * size.height > kMostStMapVertices)
        throw Error(what + " has " + shape + " pixels: must have at most " +
                    std::to_string(kMostStMapVertices));
    std::vector<float> uv = read_uv(*image);
    WarpMap map = how.step == 1 ? mesh_from_stmap(std::move(uv), size.width, size.height, name, how.flip_v)
                                : mesh_from_stmap(uv.data(), size.width, size.height, 2,
                                                  std::ptrdiff_t{2} * size.width, how.step, name, how.flip_v);
    if (!(image->display() == Box{0, 0, size.width, size.height}))
        std::get<ControlMesh>(map.shape).display = image->display();
    return map;
}

/// A mesh or pairs of points from text (.json, .csv), or a mesh from every `step`-th pixel of an ST-map: any
/// image, u in its first channel, v in its second.
std::shared_ptr<const WarpMap> read_mesh(const SideFile& file, const StMapReading& how,
                                         const SideFileReader& reader) {
    const bool text = text_file::ends_with(file.name, ".json");
    if (text && how.step != 1)
        throw Error("step", std::to_string(how.step), "must be given with ST-maps only");
    const std::string kind = "mesh " + std::to_string(how.step) + (how.flip_v ? " flipped" : "");
    return read_once<WarpMap>(file, kind, [&] {
        return text ? parse_warp_file(reader.text(file.name), file.name) : read_stmap(file.name, how, reader);
    });
}

std::shared_ptr<const WarpMap> read_points(const SideFile& file, const SideFileReader& reader) {
    if (kIsSmall) refuse_left_out("points=" + printable(file.name));
    return read_once<WarpMap>(file, "points",
                              [&] { return parse_warp_file(reader.text(file.name), file.name); });
}

/// A mesh of one cell, the picture as it stands.
std::shared_ptr<const WarpMap> unmoved() {
    ControlMesh mesh;
    mesh.columns = mesh.rows = 1;
    mesh.units = Units::fractions;
    mesh.vertices = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    return std::make_shared<WarpMap>(WarpMap{"mesh", mesh});
}

/// The mesh or the points that were asked for.
std::shared_ptr<const WarpMap> read_map(const WarpRequest& request, const OperationInput& input) {
    const auto mesh = input.files.find("mesh"), points = input.files.find("points");
    const bool has_mesh = mesh != input.files.end(), has_points = points != input.files.end();
    if (has_mesh && has_points)
        throw Error("points", printable(points->second.name), "must not be given together with mesh");
    const bool has_none = !has_mesh && !has_points;
    if (has_none && !request.program)
        throw Error::not_given("mesh",
                               ": must be a mesh (.json) or an ST-map (an image), or points be given");
    std::shared_ptr<const WarpMap> map =
        has_none   ? unmoved()
        : has_mesh ? read_mesh(mesh->second, {request.step, input.values.toggle("flip_v")}, input.reader)
                   : read_points(points->second, input.reader);
    if (has_points && std::holds_alternative<ControlMesh>(map->shape))
        throw Error("points", printable(points->second.name), "the file holds a mesh: must be given as mesh");
    if (request.direction) {
        auto turned = std::make_shared<WarpMap>(*map);
        auto* shape = std::get_if<ControlMesh>(&turned->shape);
        if (!shape) throw Error("direction is given with points: must be given with a mesh only");
        shape->direction = *request.direction;
        map = turned;
    }
    return map;
}

class Warps final : public Pictures {
  public:
    Warps(const WarpRequest& request, std::shared_ptr<const WarpMap> map)
        : m_request(request), m_map(std::move(map)) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        const std::optional<Size> size = level_size(m_request.target, level);
        if (!size || (level > 0 && (has_holes(*m_map) || m_request.display))) return {};
        WarpRequest request = m_request;
        request.target = *size;
        PictureRequest picture;
        picture.size = *size;
        picture.display = m_request.display;
        picture.keeps_format = level == 0 && picture.shows(m_request.source);
        picture.pixels = request.options.folds ? PixelKind::value : pixels_of(request.options.output);
        picture.adds_alpha = request.options.adds_alpha;
        if (!request.machine) picture.says = {{"anamorph:tol", request.options.tol}};
        for (Attribute& attribute : said_of_pixels(request.pixel_aspect))
            picture.says.push_back(std::move(attribute));
        if (picture.pixels == PixelKind::color && request.options.filter == Filter::nearest &&
            !request.options.draws_mesh && !runs_program(request))
            picture.moves = 0;
        if (picture.pixels == PixelKind::color && !request.program && !request.machine)
            picture.moved_channels = moved_channels(request.options.data);
        // Positions in pixels are pixels of the finest level.
        picture.solve = [request, level, map = m_map,
                         whole = m_request]() -> std::unique_ptr<const SolvedPicture> {
            const WarpMap& given = *map;
            const WarpMap here = level > 0 ? in_fractions(given, whole.source, whole.target) : given;
            if (request.machine) {
                if (has_holes(given))
                    throw Error(
                        "scheme", "hardware",
                        "must be another for " + given.name + ", which has pixels that come from nowhere");
                return shaded_picture(here, request);
            }
            return solved(warped_picture(here, whole.source, request.target, request.options));
        };
        return picture;
    }

  private:
    static bool has_holes(const WarpMap& map) {
        const auto* mesh = std::get_if<ControlMesh>(&map.shape);
        return mesh && mesh->samples && mesh->samples->holes > 0;
    }

    WarpRequest m_request;
    std::shared_ptr<const WarpMap> m_map;
};

/// Moves positions in the picture by its overscan, in whose pixels they are then; positions in the source do not move.
WarpMap with_overscan(const WarpMap& map, const Size& source, const Size& shown, const Size& overscan) {
    WarpMap out = map;
    // From parts of a size, if need be, to pixels of it, and those beyond its edge.
    const auto place = [](Point<double>& p, Units units, const Size& size, const Size& more) {
        const bool parts = units == Units::fractions;
        p = {p.x * (parts ? size.width : 1) + more.width, p.y * (parts ? size.height : 1) + more.height};
    };
    if (auto* points = std::get_if<ControlPoints>(&out.shape)) {
        for (ControlPoints::Pair& pair : points->pairs) {
            Point<double> at{pair.x, pair.y}, to{pair.u, pair.v};
            place(at, points->units, shown, overscan);
            place(to, points->units, source, {});
            pair.x = at.x, pair.y = at.y, pair.u = to.x, pair.v = to.y;
        }
        points->units = Units::pixels;
        points->overscan = overscan;
        return out;
    }
    auto& mesh = std::get<ControlMesh>(out.shape);
    const bool pull = mesh.direction == Direction::pull;
    const Size &from = pull ? shown : source, &to = pull ? source : shown;
    const Size before = pull ? overscan : Size{}, beyond = pull ? Size{} : overscan;
    const auto place_lines = [&](std::vector<double>& lines, int cells, int side, int more) {
        const bool even = lines.empty();
        for (int i = 0; even && i <= cells; ++i) lines.push_back(double(i) * side / cells);
        const double unit = !even && mesh.units == Units::fractions ? side : 1;
        for (double& line : lines) line = line * unit + more;
    };
    place_lines(mesh.x_lines, mesh.columns, from.width, before.width);
    place_lines(mesh.y_lines, mesh.rows, from.height, before.height);
    for (Point<double>& vertex : mesh.vertices) place(vertex, mesh.units, to, beyond);
    for (ControlMesh::Level& level : mesh.levels)
        for (ControlMesh::Vertex& vertex : level.vertices) place(vertex.at, mesh.units, to, beyond);
    mesh.units = Units::pixels;
    return out;
}

std::string text_of(const Size& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

/// An ST-map is as large as its picture, and so are its windows.
void take_windows(const ControlMesh& mesh, const ParameterValues& values, WarpRequest& request) {
    const Size data{mesh.width, mesh.height};
    if (!mesh.display) {
        if (mesh.direction == Direction::pull) request.target = warp_target(values, data);
        return;
    }
    const Size shown{mesh.display->width(), mesh.display->height()};
    const std::string why =
        " of an ST-map of " + text_of(data) + " pixels with a display window of " + text_of(shown);
    if (mesh.direction == Direction::push) throw Error("direction", "push", "must be pull" + why);
    if (request.options.amount != 1)
        throw Error("amount", shortest(request.options.amount), "must be 1" + why);
    if (const Size asked = warp_target(values, shown); !(asked == shown))
        throw Error("size", text_of(asked), "must be " + text_of(shown) + why);
    request.target = data;
    request.display = mesh.display;
}

/// The picture with its overscan, and the map in its pixels.
std::shared_ptr<const WarpMap> take_overscan(const std::shared_ptr<const WarpMap>& map,
                                             const ParameterValues& values, WarpRequest& request) {
    rows::check_overscan(values);
    const Size overscan = rows::overscan_of(values, request.target);
    if (overscan == Size{}) return map;
    const auto refuse = [&](const char* why) {
        throw Error("overscan", printable(values.text("overscan")), std::string("must not be given ") + why);
    };
    const auto* mesh = std::get_if<ControlMesh>(&map->shape);
    if (mesh && mesh->width > 0) refuse("of an ST-map, whose windows are its picture's");
    // Its least is the identity, which is one of pictures without overscan.
    if (request.options.amount != 1) refuse("together with amount");
    PictureRequest all;
    all.size = request.target;
    all.add_overscan(overscan);
    const auto moved =
        std::make_shared<const WarpMap>(with_overscan(*map, request.source, request.target, overscan));
    request.target = all.size;
    request.display = all.display;
    return moved;
}

const char* const kExampleMesh = R"({"columns": 2, "rows": 2, "units": "fractions", "vertices": [
    [0, 0], [0.5, 0], [1, 0],  [0, 0.5], [0.61, 0.42], [1, 0.5],  [0, 1], [0.5, 1], [1, 1]]})";

std::unique_ptr<const Pictures> read_warps(const OperationInput& input) {
    WarpRequest request = read_warp_request(input.values, input.sources[0].size());
    request.program = read_shader(input);
    check_program_channels(request, input.sources[0].channels);
    MeshWarpOptions& options = request.options;
    options.data = rows::data_of(input.values, input.sources[0].facts, options.filter);
    options.adds_alpha = rows::adds_alpha(input.values, input.sources[0].alpha >= 0,
                                          options.wrap == Wrap::automatic || options.wrap == Wrap::black);
    const std::shared_ptr<const WarpMap> map = read_map(request, input);
    const auto* mesh = std::get_if<ControlMesh>(&map->shape);
    if (mesh && mesh->width > 0) take_windows(*mesh, input.values, request);
    const Box shown = request.display.value_or(Box{0, 0, request.target.width, request.target.height});
    if (Size{shown.width(), shown.height()} == request.source)
        request.pixel_aspect = input.sources[0].facts.pixel_aspect;
    return std::make_unique<Warps>(request, take_overscan(map, input.values, request));
}

}  // namespace

const Operation& warp_operation() {
    static const ParameterTable table = make_warp_table();
    static const Operation operation{
        "warp",    "A picture drawn through a control mesh, an ST-map or pairs of points",
        &table,    {"src"},
        1,         {"mesh=grid.json", {{"grid.json", kExampleMesh}}},
        read_warps};
    return operation;
}

}  // namespace anamorph
