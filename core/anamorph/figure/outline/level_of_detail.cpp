// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/level_of_detail.h"

#include <utility>

#include "anamorph/figure/outline/outline.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::figure {
namespace {

/// The depth of the body's farthest point.
double farthest(const Ellipsoid& body, const View& view) {
    const glm::dvec3 along = glm::transpose(view.rotation * body.rotation)[2];
    return view.to_view(body.center).z + glm::length(body.axes * along);
}

Detail detail_of(const Ellipsoid& body, const Outline& outline, const View& view,
                 const DetailOptions& options) {
    if (view.perspective() && farthest(body, view) < view.near) return Detail::none;
    if (outline.kind != OutlineKind::whole) return Detail::body;
    const PrincipalAxes axes = principal_axes(outline.screen);
    const double longest = 2 * axes.major, widest = 2 * axes.minor;
    if (options.lod == 0) return Detail::body;
    if (longest <= options.lod) return Detail::dot;
    if (widest <= options.lod) return Detail::line;
    return longest <= options.body_factor * options.lod ? Detail::ellipse : Detail::body;
}

}  // namespace

std::vector<Detail> levels_of_detail(std::span<const Ellipsoid> bodies, const View& view,
                                     const DetailOptions& options) {
    for (const auto& [name, value] : {std::pair{"lod", options.lod}, {"body_factor", options.body_factor}})
        kLevelOfDetailRow.check(value, name);
    OutlineOptions limbs;
    limbs.hide = false;
    std::vector<Detail> details;
    const Outlines seen = outlines(bodies, view, limbs);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        details.push_back(detail_of(bodies[i], seen.bodies[i], view, options));
    return details;
}

}  // namespace anamorph::figure
