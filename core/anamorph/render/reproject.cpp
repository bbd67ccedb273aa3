// SPDX-License-Identifier: Apache-2.0
#include "anamorph/render/reproject.h"

namespace anamorph {
namespace {

PlanOptions plan_options(const ReprojectOptions& options) {
    PlanOptions plan;
    plan.scheme = options.scheme;
    plan.tol = options.tol;
    plan.cull = options.wrap == Wrap::automatic || options.wrap == Wrap::black;
    plan.across_seam = options.wrap == Wrap::automatic;
    return plan;
}

}  // namespace

struct Reprojection::State {
    State(const Panorama& map, const ReprojectOptions& reproject)
        : options(reproject), plan(map, plan_options(reproject)), border(map.source(), reproject.wrap) {}
    ReprojectOptions options;
    PanoramaPlan plan;
    Border border;
};

Reprojection::Reprojection(const Panorama& map, const ReprojectOptions& options)
    : m_state(std::make_unique<State>(map, options)) {}
Reprojection::~Reprojection() = default;
Reprojection::Reprojection(Reprojection&&) noexcept = default;
Reprojection& Reprojection::operator=(Reprojection&&) noexcept = default;

const Panorama& Reprojection::map() const {
    return m_state->plan.map();
}
const ReprojectOptions& Reprojection::options() const {
    return m_state->options;
}
int Reprojection::channels(const Source& source) const {
    return channels_of(m_state->options.output, &source);
}
Reached Reprojection::reached(const ParallelFor& parallel_for) const {
    return m_state->plan.reached(parallel_for);
}
bool Reprojection::draw(const Source* source, const Box& box, const ImageView& picture,
                        const ParallelFor& parallel_for) const {
    const ReprojectOptions& options = m_state->options;
    return draw_blocks(m_state->plan, m_state->border, options.filter, options.output, source, box, picture,
                       parallel_for);
}

}  // namespace anamorph
