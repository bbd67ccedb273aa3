// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/reproject.h"

#include <memory>

#include "anamorph/panorama/panorama_plan.h"

namespace anamorph {

PlanOptions plan_options(const ReprojectOptions& options) {
    PlanOptions plan;
    plan.scheme = options.scheme;
    plan.tol = options.tol;
    plan.cull = ends_at_edges(options.wrap, options.output) && !options.source_overscan;
    plan.across_seam = options.wrap == Wrap::automatic;
    plan.overscan = options.overscan;
    return plan;
}

Picture reprojected_picture(const Panorama& map, const ReprojectOptions& options) {
    Picture picture = picture_through(std::make_shared<PanoramaPlan>(map, plan_options(options)),
                                      Border(map.source(), options.wrap), options.filter, options.output);
    picture.overscan = options.overscan;
    picture.adds_alpha = options.adds_alpha;
    picture.data = options.data;
    return picture;
}

}  // namespace anamorph
