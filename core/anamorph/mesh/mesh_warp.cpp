// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_warp.h"

#include <atomic>
#include <memory>

#include "anamorph/image/line_overlay.h"
#include "anamorph/image/strips.h"
#include "anamorph/mesh/inverse.h"
#include "anamorph/mesh/mesh_edges.h"
#include "anamorph/mesh/mesh_scattered.h"
#include "anamorph/mesh/stmap_plan.h"
#include "anamorph/parameter/left_out.h"

namespace anamorph {
namespace {

/// Only what is taken pixel for pixel may have holes.
void check_holes(const ControlMesh& mesh, const Size& target, const std::string& name) {
    if (!mesh.samples || mesh.samples->holes == 0 || StMapPlan::serves(mesh, target)) return;
    throw Error(
        name + " has " + std::to_string(mesh.samples->holes) +
        " pixels that come from nowhere: must be drawn pixel for pixel, with direction=pull and in its own " +
        "size, " + std::to_string(mesh.width) + "x" + std::to_string(mesh.height));
}

std::unique_ptr<const WarpPlan> make_plan(const WarpMap& map, const Size& source, const Size& target,
                                          const MeshWarpOptions& options) {
    if (const ControlPoints* points = std::get_if<ControlPoints>(&map.shape)) {
        if constexpr (kIsSmall)
            refuse_left_out(map.name + ", of control points,");
        else
            return std::make_unique<ScatteredPlan>(
                Scattered(*points, target, source, options.amount, map.name), options.scheme, options.tol);
    }
    const ControlMesh& mesh = std::get<ControlMesh>(map.shape);
    check_holes(mesh, target, map.name);
    if (mesh.direction == Direction::push)
        return std::make_unique<InversePlan>(Mesh(mesh, source, target, options.amount, map.name),
                                             options.scheme, options.tol, map.name);
    if (kIsSmall) refuse_left_out(map.name + ", a mesh that pulls,");
    if (StMapPlan::serves(mesh, target))
        return std::make_unique<StMapPlan>(mesh, target, source, options.amount, options.scheme, options.tol,
                                           map.name);
    return std::make_unique<MeshPlan>(Mesh(mesh, target, source, options.amount, map.name), options.scheme,
                                      options.tol);
}

double folded_fraction(const WarpPlan& plan, const ParallelFor& parallel_for) {
    const Box whole{0, 0, plan.width(), plan.height()};
    std::atomic<std::int64_t> folded{0};
    for_each_square(whole, parallel_for, [&](const Box& square) { folded += plan.folded_pixels(square); });
    return static_cast<double>(folded) / (double(whole.width()) * whole.height());
}

/// The function that draws a mesh over its picture: where it lies, or, where it pushes, where its edges go.
std::function<void(const PixelRows&)> mesh_overlay(const WarpMap& map, const Size& source, const Size& target,
                                                   double amount) {
    if (kIsSmall) refuse_left_out("output=mesh");
    const auto refuse = [&](const std::string& why) {
        throw Error("output", "mesh", "must be another of " + map.name + ", which " + why);
    };
    const auto* shape = std::get_if<ControlMesh>(&map.shape);
    if (!shape) refuse("has points and no mesh");
    if (shape->samples) refuse("is an ST-map taken pixel for pixel");
    const bool pulls = shape->direction == Direction::pull;
    const Mesh mesh(*shape, pulls ? target : source, pulls ? source : target, amount, map.name);
    std::int64_t cells = 0;
    mesh.each_cell(0, 0, mesh.from().width, mesh.from().height, [&](const MeshCell&) { ++cells; });
    if (cells > kMostDrawnCells)
        refuse("has " + std::to_string(cells) + " cells: at most " + std::to_string(kMostDrawnCells) +
               " are drawn");
    const auto edges = std::make_shared<const std::vector<MeshEdge>>(mesh_edges(mesh, !pulls));
    return [edges](const PixelRows& pixels) {
        for (const MeshEdge& edge : *edges) draw_line_over(edge.line, overlay_color(edge.level), pixels);
    };
}

}  // namespace

Picture warped_picture(const WarpMap& map, const Size& source, const Size& target,
                       const MeshWarpOptions& options) {
    check_picture_size("source size", source);
    check_picture_size("size", target);
    const std::shared_ptr<const WarpPlan> plan = make_plan(map, source, target, options);
    const Chart flat(Projection::rectilinear, source.width, source.height);
    Picture picture = picture_through(plan, Border(flat, options.wrap), options.filter, options.output);
    picture.adds_alpha = options.adds_alpha;
    picture.data = options.data;
    if (options.draws_mesh) picture.overlay = mesh_overlay(map, source, target, options.amount);
    if (options.folds) picture.value = [plan](double x, double y) { return plan->folds(x, y); };
    picture.says = [plan](const ParallelFor& parallel_for) -> Attributes {
        return {{"anamorph:folded_fraction", folded_fraction(*plan, parallel_for)}};
    };
    return picture;
}

}  // namespace anamorph
