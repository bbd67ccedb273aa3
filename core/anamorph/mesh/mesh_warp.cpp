// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_warp.h"

#include <atomic>

#include "anamorph/image/strips.h"
#include "anamorph/mesh/inverse.h"
#include "anamorph/mesh/mesh_scattered.h"
#include "anamorph/mesh/stmap_plan.h"

namespace anamorph {
namespace {

std::unique_ptr<const WarpPlan> make_plan(const WarpMap& map, const Size& source, const Size& target,
                                          const MeshWarpOptions& options) {
    if (const ControlPoints* points = std::get_if<ControlPoints>(&map.shape))
        return std::make_unique<ScatteredPlan>(Scattered(*points, target, source, options.amount, map.name),
                                               options.scheme, options.tol);
    const ControlMesh& mesh = std::get<ControlMesh>(map.shape);
    if (mesh.direction == Direction::push)
        return std::make_unique<InversePlan>(Mesh(mesh, source, target, options.amount, map.name),
                                             options.scheme, options.tol, map.name);
    if (StMapPlan::serves(mesh, target))
        return std::make_unique<StMapPlan>(mesh, target, source, options.amount, options.scheme, options.tol,
                                           map.name);
    return std::make_unique<MeshPlan>(Mesh(mesh, target, source, options.amount, map.name), options.scheme,
                                      options.tol);
}

void check_size(const char* name, int width, int height) {
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
        throw Error(name, std::to_string(width) + "x" + std::to_string(height),
                    "must be 1 to " + std::to_string(kMaxSide) + " pixels either way");
}

}  // namespace

struct MeshWarp::State {
    State(const WarpMap& map, const Size& source, const Size& target, const MeshWarpOptions& warp)
        : options(warp), plan(make_plan(map, source, target, warp)) {
        const Chart flat(Projection::rectilinear, source.width, source.height);
        picture.maps = {{plan, {{Border(flat, warp.wrap)}}}};
        picture.filter = warp.filter;
        picture.output = warp.output;
        if (warp.folds) picture.value = [p = plan.get()](double x, double y) { return p->folds(x, y); };
    }

    MeshWarpOptions options;
    std::shared_ptr<const WarpPlan> plan;
    Picture picture;
};

MeshWarp::MeshWarp(const WarpMap& map, int source_width, int source_height, int width, int height,
                   const MeshWarpOptions& options) {
    check_size("source size", source_width, source_height);
    check_size("size", width, height);
    m_state = std::make_unique<State>(map, Size{source_width, source_height}, Size{width, height}, options);
}
MeshWarp::~MeshWarp() = default;
MeshWarp::MeshWarp(MeshWarp&&) noexcept = default;
MeshWarp& MeshWarp::operator=(MeshWarp&&) noexcept = default;

int MeshWarp::width() const {
    return m_state->plan->width();
}
int MeshWarp::height() const {
    return m_state->plan->height();
}
const MeshWarpOptions& MeshWarp::options() const {
    return m_state->options;
}
const BlockMap& MeshWarp::blocks() const {
    return *m_state->plan;
}
const Picture& MeshWarp::picture() const {
    return m_state->picture;
}
int MeshWarp::channels(const Source& source) const {
    return m_state->picture.channels(&source);
}
Reached MeshWarp::reached(const ParallelFor& parallel_for) const {
    return m_state->picture.reached(parallel_for);
}

double MeshWarp::folded_fraction(const ParallelFor& parallel_for) const {
    const Box whole{0, 0, width(), height()};
    std::atomic<std::int64_t> folded{0};
    for_each_square(whole, parallel_for,
                    [&](const Box& square) { folded += m_state->plan->folded_pixels(square); });
    return static_cast<double>(folded) / (double(whole.width()) * whole.height());
}

bool MeshWarp::draw(const Source* source, const Box& box, const ImageView& view,
                    const ParallelFor& parallel_for) const {
    return m_state->picture.draw({source}, box, view, parallel_for);
}

}  // namespace anamorph
