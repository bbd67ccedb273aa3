// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/reproject.h"

#include "anamorph/panorama/panorama_plan.h"

namespace anamorph {

PlanOptions plan_options(const ReprojectOptions& options) {
    PlanOptions plan;
    plan.scheme = options.scheme;
    plan.tol = options.tol;
    plan.cull = ends_at_edges(options.wrap, options.output);
    plan.across_seam = options.wrap == Wrap::automatic;
    return plan;
}

struct Reprojection::State {
    State(const Panorama& map, const ReprojectOptions& reproject)
        : options(reproject), plan(std::make_shared<PanoramaPlan>(map, plan_options(reproject))) {
        picture.maps = {{plan, {{Border(map.source(), reproject.wrap)}}}};
        picture.filter = reproject.filter;
        picture.output = reproject.output;
    }
    ReprojectOptions options;
    std::shared_ptr<const PanoramaPlan> plan;
    Picture picture;
};

Reprojection::Reprojection(const Panorama& map, const ReprojectOptions& options)
    : m_state(std::make_unique<State>(map, options)) {}
Reprojection::~Reprojection() = default;
Reprojection::Reprojection(Reprojection&&) noexcept = default;
Reprojection& Reprojection::operator=(Reprojection&&) noexcept = default;

const Panorama& Reprojection::map() const {
    return m_state->plan->map();
}
const ReprojectOptions& Reprojection::options() const {
    return m_state->options;
}
const Picture& Reprojection::picture() const {
    return m_state->picture;
}
int Reprojection::channels(const Source& source) const {
    return m_state->picture.channels(&source);
}
Reached Reprojection::reached(const ParallelFor& parallel_for) const {
    return m_state->picture.reached(parallel_for);
}
bool Reprojection::draw(const Source* source, const Box& box, const ImageView& view,
                        const ParallelFor& parallel_for) const {
    return m_state->picture.draw({source}, box, view, parallel_for);
}

}  // namespace anamorph
