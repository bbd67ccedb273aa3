// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/reproject.h"

#include <memory>

#include "anamorph/panorama/panorama_plan.h"

namespace anamorph {

PlanOptions plan_options(const ReprojectOptions& options) {
    PlanOptions plan;
    plan.scheme = options.scheme;
    plan.tol = options.tol;
    plan.cull = ends_at_edges(options.wrap, options.output) && !options.overscan;
    plan.across_seam = options.wrap == Wrap::automatic;
    return plan;
}

Picture reprojected_picture(const Panorama& map, const ReprojectOptions& options) {
    return picture_through(std::make_shared<PanoramaPlan>(map, plan_options(options)),
                           Border(map.source(), options.wrap), options.filter, options.output);
}

}  // namespace anamorph
