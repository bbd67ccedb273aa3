// SPDX-License-Identifier: Apache-2.0
#include "anamorph/render/warp_parameters.h"

#include "anamorph/render/picture_parameters.h"

namespace anamorph {
namespace {

using rows::chosen;

// In the order of their enumerations.
const std::vector<std::string> kDirections = {"pull", "push"};
const std::vector<std::string> kWraps = {"automatic", "black", "clamp", "periodic", "mirror"};
const std::vector<std::string> kSchemes = {"auto", "exact", "hermite", "residual"};
const std::vector<std::string> kOutputs = {"color", "stmap", "error", "bound", "folds"};
constexpr int kMaxStep = 1 << 16;

ParameterTable make_table() {
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
        choice(
            "direction", "", kDirections,
            "pull: the mesh lies in the picture, its vertices say where in the source; push: the mesh lies "
            "in the source, its vertices say where they go; by default what the file says, else pull"),
        number("amount", "", "1", -kInfinity, kInfinity,
               "how far every vertex is moved: 0 not at all, 1 as given, any other as far in proportion"),
        size(
            "width and height of the picture, or its width alone; by default the source's, of an ST-map that "
            "pulls its own"),
        tile(),
        mip(),
        filter(),
        choice("wrap", "automatic", kWraps, "what lies beyond the source's edge; automatic is black"),
        tol(),
        choice("scheme", "auto", kSchemes, "how source points are found within tol"),
        colorspace("color space to filter in; by default the source's own"),
        choice("output", "color", kOutputs,
               "color, or per pixel: stmap, the source point (u, v) in 0 to 1 with v down; error, its "
               "distance from the exact one in source pixels; bound, the proven bound of that; folds, not 0 "
               "where the warp folds"),
    };
}

/// Divides a position in an image by its size.
void divide(double& x, double& y, const Size& size) {
    x /= size.width;
    y /= size.height;
}

}  // namespace

const ParameterTable& warp_parameters() {
    static const ParameterTable table = make_table();
    return table;
}

Size warp_target(const ParameterValues& values, const Size& natural) {
    const Size size = rows::size_of(values, {natural.width, natural.height});
    return {size.width, size.height};
}

WarpRequest read_warp_request(const ParameterValues& values, const Size& source) {
    WarpRequest request;
    request.source = source;
    request.target = warp_target(values, source);
    MeshWarpOptions& options = request.options;
    options.scheme = chosen<WarpScheme>(values, "scheme", kSchemes);
    options.tol = values.number("tol");
    options.filter = chosen<Filter>(values, "filter", rows::filters());
    options.wrap = chosen<Wrap>(values, "wrap", kWraps);
    options.output = chosen<WarpOutput>(values, "output", kOutputs);
    options.amount = values.number("amount");
    request.step = values.whole("step");
    if (values.given("direction")) request.direction = chosen<Direction>(values, "direction", kDirections);
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

}  // namespace anamorph
