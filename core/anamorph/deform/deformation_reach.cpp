// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/deformation_reach.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

namespace anamorph {
namespace {

// e^-64 is 1.6038e-28.
constexpr double kFar = 1.61e-28;
constexpr std::uint32_t kMostOfLeaf = 2;

/// R^2 of (F).
double squared_reach(const Deformation& d) {
    return 64 - 2 * std::log(std::min({d.extent.x, d.extent.y, 1.0}));
}

}  // namespace

DeformationReach::DeformationReach(const std::vector<Deformation>& list) : m_order(list.size()) {
    for (const Deformation& d : list) {
        m_boxes.push_back(reached_by(d));
        if (d.kernel == DeformationKernel::gaussian && d.is_plain())
            m_far += glm::abs(d.vector) * ((2 * squared_reach(d) + 1) * kFar);
    }
    std::iota(m_order.begin(), m_order.end(), 0u);
    if (!list.empty()) build(0, static_cast<std::uint32_t>(list.size()));
}

DeformationReach::Reached DeformationReach::reached_by(const Deformation& d) {
    constexpr double kMost = std::numeric_limits<double>::max();
    if (d.kernel == DeformationKernel::gaussian && !d.is_plain()) return {-kMost, -kMost, kMost, kMost};
    // A little more, for what is rounded here.
    const double reach =
        1.001 * (d.kernel == DeformationKernel::gaussian ? std::sqrt(squared_reach(d)) : 1.0);
    const glm::dvec2 half = d.has_frame() ? glm::dvec2(framed_reach(d)) : d.extent;
    const double across = reach * half.x + 1e-12 * std::fabs(d.center.x),
                 down = reach * half.y + 1e-12 * std::fabs(d.center.y);
    return {d.center.x - across, d.center.y - down, d.center.x + across, d.center.y + down};
}

/// Halves what is not few yet, across the longer side of the middles' box.
std::uint32_t DeformationReach::build(std::uint32_t begin, std::uint32_t end) {
    Reached box{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, middles = box;
    const auto middle_u = [&](std::uint32_t i) { return m_boxes[i].u0 / 2 + m_boxes[i].u1 / 2; };
    const auto middle_v = [&](std::uint32_t i) { return m_boxes[i].v0 / 2 + m_boxes[i].v1 / 2; };
    for (std::uint32_t k = begin; k < end; ++k) {
        const Reached& b = m_boxes[m_order[k]];
        box = {std::min(box.u0, b.u0), std::min(box.v0, b.v0), std::max(box.u1, b.u1),
               std::max(box.v1, b.v1)};
        const double u = middle_u(m_order[k]), v = middle_v(m_order[k]);
        middles = {std::min(middles.u0, u), std::min(middles.v0, v), std::max(middles.u1, u),
                   std::max(middles.v1, v)};
    }
    const auto index = static_cast<std::uint32_t>(m_nodes.size());
    m_nodes.push_back({box, begin, end});
    if (end - begin <= kMostOfLeaf) return index;
    const bool across = middles.u1 - middles.u0 >= middles.v1 - middles.v0;
    const std::uint32_t half = begin + (end - begin) / 2;
    std::stable_sort(m_order.begin() + begin, m_order.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
        return across ? middle_u(a) < middle_u(b) : middle_v(a) < middle_v(b);
    });
    build(begin, half);
    const std::uint32_t second = build(half, end);
    m_nodes[index].second = second;
    return index;
}

}  // namespace anamorph
