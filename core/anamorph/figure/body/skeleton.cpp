// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/body/skeleton.h"

#include <cmath>

namespace anamorph::figure {
namespace {

Stick axis_stick(const Ellipsoid& body, int position) {
    int longest = 0;
    for (int k = 1; k < 3; ++k)
        if (std::fabs(body.axes[k]) > std::fabs(body.axes[longest])) longest = k;
    const glm::dvec3 half = body.rotation[longest] * std::fabs(body.axes[longest]);
    return {body.center - half, body.center + half, position};
}

}  // namespace

std::vector<Stick> axis_sticks(std::span<const Ellipsoid> bodies) {
    std::vector<Stick> sticks;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        sticks.push_back(axis_stick(bodies[i], static_cast<int>(i)));
    return sticks;
}

std::vector<Stick> axis_sticks(const FigureFrame& frame) {
    std::vector<Stick> sticks;
    for (std::size_t i = 0; i < frame.bodies.size(); ++i)
        sticks.push_back(axis_stick(frame.bodies[i].shape, static_cast<int>(i)));
    return sticks;
}

std::vector<Stick> joint_sticks(const FigureFrame& frame) {
    std::vector<Stick> sticks;
    for (int i = 0; i < static_cast<int>(frame.bodies.size()); ++i) {
        std::vector<glm::dvec3> at;
        for (const Joint& joint : frame.joints)
            if (joint.first == i || joint.second == i) at.push_back(joint.position);
        const glm::dvec3& center = frame.bodies[static_cast<std::size_t>(i)].shape.center;
        if (at.size() == 2)
            sticks.push_back({at[0], at[1], i});
        else
            for (const glm::dvec3& joint : at) sticks.push_back({center, joint, i});
    }
    return sticks;
}

}  // namespace anamorph::figure
