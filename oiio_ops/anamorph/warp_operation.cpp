// SPDX-License-Identifier: Apache-2.0
// A picture drawn through a control mesh.
#include "anamorph/operation.h"
#include "anamorph/render/warp_parameters.h"
#include "anamorph/side_files.h"

namespace anamorph {
namespace {

class WarpDrawing final : public Drawing {
  public:
    WarpDrawing(const WarpMap& map, const WarpRequest& r)
        : m_warp(map, r.source.width, r.source.height, r.target.width, r.target.height, r.options) {}

    Facts reached(const ParallelFor& parallel_for) const override {
        const Reached reached = m_warp.reached(parallel_for);
        return {{"anamorph:max_error", reached.max_error},
                {"anamorph:exact_fraction", reached.exact_fraction},
                {"anamorph:folded_fraction", m_warp.folded_fraction(parallel_for)}};
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        return m_warp.draw(sources[0], box, view, parallel_for);
    }

  private:
    MeshWarp m_warp;
};

/// The mesh or the points that were asked for.
std::shared_ptr<const WarpMap> read_map(const WarpRequest& request, const SideFiles& files) {
    const auto mesh = files.find("mesh"), points = files.find("points");
    const bool has_mesh = mesh != files.end(), has_points = points != files.end();
    if (has_mesh && has_points)
        throw Error("points", printable(points->second.name), "must not be given together with mesh");
    if (!has_mesh && !has_points)
        throw Error("mesh is not given: needed are a mesh (.json), an ST-map (an image), or points");
    const SideFile& file = has_mesh ? mesh->second : points->second;
    std::shared_ptr<const WarpMap> map = has_mesh ? read_warp_map(file, request.step) : read_points(file);
    if (has_points && std::holds_alternative<ControlMesh>(map->shape))
        throw Error("points", printable(file.name), "the file holds a mesh: must be given as mesh");
    if (request.direction) {
        auto turned = std::make_shared<WarpMap>(*map);
        auto* shape = std::get_if<ControlMesh>(&turned->shape);
        if (!shape) throw Error("direction is given with points: must be given with a mesh only");
        shape->direction = *request.direction;
        map = turned;
    }
    return map;
}

class WarpOperation final : public Operation {
  public:
    WarpOperation(const WarpRequest& request, std::shared_ptr<const WarpMap> map)
        : m_request(request), m_map(std::move(map)) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        WarpRequest request = m_request;
        if (level > 0 && std::max(request.target.width, request.target.height) >> level < 1) return {};
        request.target.width = std::max(1, request.target.width >> level);
        request.target.height = std::max(1, request.target.height >> level);
        const WarpOutput output = request.options.output;
        PictureRequest picture;
        picture.width = request.target.width;
        picture.height = request.target.height;
        picture.pixels = output == WarpOutput::color   ? PixelKind::color
                         : output == WarpOutput::stmap ? PixelKind::point
                                                       : PixelKind::value;
        picture.facts = {{"anamorph:tol", request.options.tol}};
        // Positions in pixels are pixels of the finest level.
        picture.solve = [request, level, map = m_map, whole = m_request] {
            return std::make_unique<WarpDrawing>(
                level > 0 ? in_fractions(*map, whole.source, whole.target) : *map, request);
        };
        return picture;
    }

  private:
    WarpRequest m_request;
    std::shared_ptr<const WarpMap> m_map;
};

}  // namespace

const OperationKind& warp_kind() {
    static const OperationKind kind{
        "warp",
        &warp_parameters(),
        {"src"},
        1,
        [](const ParameterValues& values, const std::vector<SourceImage>& images, const SideFiles& files) {
            WarpRequest request = read_warp_request(values, images[0].size());
            const std::shared_ptr<const WarpMap> map = read_map(request, files);
            // An ST-map is as large as its picture.
            const auto* mesh = std::get_if<ControlMesh>(&map->shape);
            if (mesh && mesh->width > 0 && mesh->direction == Direction::pull)
                request.target = warp_target(values, {mesh->width, mesh->height});
            return std::unique_ptr<const Operation>(std::make_unique<WarpOperation>(request, map));
        }};
    return kind;
}

}  // namespace anamorph
