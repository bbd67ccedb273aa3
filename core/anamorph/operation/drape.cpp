// SPDX-License-Identifier: Apache-2.0
// A picture laid on a surface in space and seen by a camera.
#include "anamorph/operation/drape.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/drape/drape.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"

namespace anamorph {
namespace {

using rows::chosen;

constexpr double kFarthest = 1e6;

Parameter vector(const char* name, std::string value, const std::string& doc) {
    Parameter row = rows::numbers(name, -rows::kInfinity, doc);
    row.default_value = std::move(value);
    return row;
}

ParameterTable make_table() {
    using namespace rows;
    return {
        image("src", "the picture that is draped; by default the recipe's name without .drape"),
        choice("surface", "plane", surface_names(),
               "undeformed the picture is 1 high, about the origin, in the plane z = 0, with x to the right "
               "and y up. "
               "cylinder: about the y axis; sphere: about the origin, with all latitudes; torus: about the y "
               "axis; "
               "page_turn: a sheet curls round a cylinder that rolls over it; waves, ripples: plane and "
               "circular"),
        number("angle", "degrees", "180", 0.01, 360,
               "of cylinder, sphere and torus, the part of a turn that is covered"),
        number("radius", "", "", 0.001, 1000,
               "of the surface; by default 0.5 (sphere, torus), 0.1 (page_turn), and for a cylinder such "
               "that the "
               "picture keeps its width"),
        number("tube", "", "0.2", 0.001, 1000, "radius of a torus's tube"),
        number("amplitude", "", "0.05", -1000, 1000, "of waves and ripples"),
        number("wavelength", "", "0.5", 0.01, 1000, "of waves and ripples"),
        number("phase", "turns", "0", -1000, 1000, "of waves and ripples"),
        number(
            "direction", "degrees", "0", -360, 360,
            "counterclockwise from the x axis: where waves go, and where the part of a page that turns lies"),
        number("turn", "", "0.5", 0, 1, "how far a page is turned"),
        file("deform",
             "a list of deformations, JSON or CSV, that move the surface; their u and v run from 0 to 1, v "
             "up"),
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
        tile(),
        mip(),
        filter(),
        wrap("goes on as at the edge"),
        number("tol", "pixels", "0.125", 0.001, 1000,
               "how far, on the screen, a point of the picture may be drawn from where it belongs"),
        scheme(
            {{"auto"},
             {"oka",
              "blocks of the picture as parallelograms, the nearer over the farther, with the tolerance that "
              "comes out (Oka 1987)"},
             {"oka-z", "the same with a depth for each pixel"}}),
        number("block", "pixels", "8", 0.25, 4096,
               "of oka and oka-z: side of a block, in pixels of the source"),
        number("overlap", "pixels", "0.5", 0, 64,
               "of oka and oka-z: width of what neighbours have in common"),
        choice("shading", "none", {"none", "gouraud", "phong"},
               "none; by the light at corners of patches; by the normals there"),
        vector("light", "0,0,1", "directions towards the lights, three numbers each"),
        number("ambient", "", "0.2", 0, 1000, "share of the colour that is seen without light"),
        number("diffuse", "", "0.8", 0, 1000, "share of the colour that light adds"),
        number("specular", "", "0", 0, 1000, "highlights that light adds"),
        number("shininess", "", "20", 0, 100000, "of highlights, the exponent"),
        vector("background", "", "values of the channels where nothing is seen; by default 0"),
        colorspace("color space to filter in; by default the source's own"),
        output({{"depth", "the distance ahead of the camera, infinite where nothing is seen"},
                {"normal", "the unit normal on the viewer's side"},
                {"patch", "the number of the patch of the surface that is drawn, -1 where none is"},
                {"coverage", "1 where the surface is seen, else 0"}}),
    };
}

glm::dvec3 vector_of(const ParameterValues& values, const char* name) {
    return rows::three_numbers(values, name, -kFarthest, kFarthest);
}

/// Directions of length 1.
std::vector<glm::dvec3> lights_of(const ParameterValues& values) {
    const std::vector<double> v = values.numbers("light");
    if (v.size() % 3 != 0)
        throw Error("light", printable(values.text("light")), "must be three numbers for each light");
    std::vector<glm::dvec3> lights;
    for (std::size_t i = 0; i < v.size(); i += 3) {
        const glm::dvec3 light(v[i], v[i + 1], v[i + 2]);
        const double largest = std::max({std::fabs(light.x), std::fabs(light.y), std::fabs(light.z)});
        if (largest == 0)
            throw Error("light", printable(values.text("light")), "must be directions, other than 0,0,0");
        lights.push_back(glm::normalize(light / largest));
    }
    return lights;
}

SurfaceShape shape_of(const ParameterValues& values, double aspect) {
    SurfaceShape shape;
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

CameraPose pose_of(const ParameterValues& values, double aspect) {
    CameraPose pose;
    pose.perspective = values.text("view") == "perspective";
    pose.fov = values.number("fov");
    pose.extent = values.given("extent") ? values.number("extent") : aspect;
    pose.position = values.given("camera")
                        ? vector_of(values, "camera")
                        : glm::dvec3(0, 0, aspect / (2 * std::tan(pose.fov * (kPi / 360))));
    pose.target = vector_of(values, "target");
    pose.up = vector_of(values, "up");
    return pose;
}

/// Rotations about x, y and z, one after the other, and a scale.
glm::dmat3 matrix_of(const ParameterValues& values) {
    const glm::dvec3 angles = vector_of(values, "rotate") * (kPi / 180);
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

struct DrapeRequest {
    std::shared_ptr<SharedTree> surface;
    CameraPose pose;
    glm::dmat3 matrix;
    glm::dvec3 offset;
    Size source, target;
    DrapeOptions options;
};

DrapeOptions options_of(const ParameterValues& values) {
    DrapeOptions options;
    options.scheme = chosen<DrapeScheme>(values, "scheme");
    options.block = values.number("block");
    options.overlap = values.number("overlap");
    options.tol = values.number("tol");
    options.filter = chosen<Filter>(values, "filter");
    options.wrap = chosen<Wrap>(values, "wrap");
    if (options.wrap == Wrap::automatic) options.wrap = Wrap::clamp;
    options.output = rows::chosen_output(values);
    constexpr std::array kOwn = {DrapeOutput::depth, DrapeOutput::normal, DrapeOutput::patch,
                                 DrapeOutput::coverage};
    const std::size_t shared = static_cast<std::size_t>(Output::bound) + 1,
                      output = rows::chosen_index(values, "output");
    if (output >= shared) options.own = kOwn[output - shared];
    options.lighting = {chosen<DrapeShading>(values, "shading"),
                        lights_of(values),
                        values.number("ambient"),
                        values.number("diffuse"),
                        values.number("specular"),
                        values.number("shininess")};
    if (values.given("background"))
        for (const double value : values.numbers("background"))
            options.background.push_back(static_cast<float>(value));
    return options;
}

DrapeRequest read_request(const OperationInput& input) {
    const ParameterValues& values = input.values;
    const Size source = input.sources[0].size();
    const double aspect = static_cast<double>(source.width) / source.height;
    std::vector<Deformation> deformations;
    if (const auto file = input.files.find("deform"); file != input.files.end())
        deformations = parse_deformations_file(input.reader.text(file->second.name), file->second.name);
    DrapeRequest request;
    request.surface = std::make_shared<SharedTree>(
        make_surface(rows::chosen_index(values, "surface"), shape_of(values, aspect), deformations));
    request.pose = pose_of(values, aspect);
    request.matrix = matrix_of(values);
    request.offset = vector_of(values, "move");
    request.source = source;
    request.target = rows::size_of(values, source);
    request.options = options_of(values);
    // What does not depend on the size of the picture is checked now.
    Camera(request.pose, request.matrix, request.offset, request.target);
    return request;
}

PixelKind pixels_of(const DrapeOptions& options) {
    if (options.own == DrapeOutput::shared) return pixels_of(options.output);
    return options.own == DrapeOutput::normal ? PixelKind::vector : PixelKind::value;
}

/// A drape of the first source.
class SolvedDrape final : public SolvedPicture {
  public:
    explicit SolvedDrape(const DrapeRequest& r, const Size& size)
        : m_drape(r.surface, Camera(r.pose, r.matrix, r.offset, size), r.source, r.options) {}

    Attributes reached(const ParallelFor&) const override {
        return {{"anamorph:max_error", m_drape.max_error()},
                {"anamorph:exact_fraction", 0.0},
                {"anamorph:patches", static_cast<int>(m_drape.patches())}};
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        return m_drape.draw(sources.empty() ? nullptr : sources[0], box, view, parallel_for);
    }

  private:
    Drape m_drape;
};

class Drapes final : public Pictures {
  public:
    explicit Drapes(DrapeRequest request) : m_request(std::move(request)) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        const std::optional<Size> size = level_size(m_request.target, level);
        if (!size) return {};
        PictureRequest picture;
        picture.size = *size;
        picture.pixels = pixels_of(m_request.options);
        picture.says = {{"anamorph:tol", m_request.options.tol}};
        picture.solve = [request = m_request, size = *size] {
            return std::make_unique<SolvedDrape>(request, size);
        };
        return picture;
    }

  private:
    DrapeRequest m_request;
};

}  // namespace

const Operation& drape_operation() {
    static const ParameterTable table = make_table();
    static const Operation operation{"drape",
                                     "A picture laid on a surface in space",
                                     &table,
                                     {"src"},
                                     1,
                                     {"surface=cylinder&angle=120&camera=0.4,0.3,2.5", {}},
                                     [](const OperationInput& input) -> std::unique_ptr<const Pictures> {
                                         return std::make_unique<Drapes>(read_request(input));
                                     }};
    return operation;
}

}  // namespace anamorph
