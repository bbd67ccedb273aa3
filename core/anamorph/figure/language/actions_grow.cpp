// SPDX-License-Identifier: Apache-2.0
// Actions that change sizes and joints.
#include <algorithm>
#include <cmath>
#include <limits>

#include "anamorph/figure/language/actions.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {

glm::dvec3 FigureAction::powers(const glm::dvec3& factors, double share) const {
    glm::dvec3 out;
    for (int k = 0; k < 3; ++k) {
        if (factors[k] == 0) fail("a factor is zero");
        out[k] = std::copysign(std::pow(std::abs(factors[k]), share), factors[k]);
    }
    return out;
}

void FigureAction::scale(const FigurePart& part, const glm::dvec3& about, const glm::dvec3& factors) const {
    // Places grow along the axes of the world, ellipsoids along their own.
    for (const int i : part.bodies) {
        body(i).center = about + factors * (body(i).center - about);
        body(i).axes *= glm::abs(factors);
    }
    for (const int j : part.joints) joint_position(j) = about + factors * (joint_position(j) - about);
    check(part);
}

void FigureAction::grofig() const {
    const FigurePart part = figure(0);
    const glm::dvec3 about = body(ellipsoid(1)).center;
    scale(part, about, powers(vector(2), m_shares.frac));
}

void FigureAction::groell() const {
    const int grown = ellipsoid(0);
    body(grown).axes *= glm::abs(powers(vector(1), m_shares.frac));
    check(FigurePart{{grown}, {}});
}

void FigureAction::grojnt() const {
    const int grown = ellipsoid(0), fixed = joint(1);
    if (!m_state.topology->is_end(fixed, grown))
        fail("the ellipsoid " + ellipsoid_name(grown) + " is not at the joint " + joint_name(fixed));
    const glm::dvec3 factors = powers(vector(2), m_shares.frac), pivot = joint_position(fixed);
    const glm::dmat3 own = glm::mat3_cast(body(grown).turn);
    const auto moved = [&](const glm::dvec3& point) {
        return pivot + own * (factors * (glm::transpose(own) * (point - pivot)));
    };
    // The limbs at its other joints follow these.
    for (const int j : m_state.topology->joints_of[static_cast<std::size_t>(grown)]) {
        if (j == fixed) continue;
        const glm::dvec3 by = moved(joint_position(j)) - joint_position(j);
        const int other = m_state.topology->other_end(j, grown);
        FigurePart limb = part_from(m_state, other, j);
        const bool ring = std::find(limb.bodies.begin(), limb.bodies.end(), grown) != limb.bodies.end();
        if (!ring) move(limb, by);
        joint_position(j) += by;
        check(joint_position(j), "the joint " + joint_name(j));
    }
    body(grown).center = moved(body(grown).center);
    body(grown).axes *= glm::abs(factors);
    check(FigurePart{{grown}, {}});
}

void FigureAction::growto() const {
    const FigurePart part = figure(0);
    const glm::dvec3 about = body(ellipsoid(1)).center, sizes = vector(2);
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const int i : part.bodies) {
        low = glm::min(low, body(i).center);
        high = glm::max(high, body(i).center);
    }
    glm::dvec3 factors(1.0);
    for (int k = 0; k < 3; ++k)
        if (high[k] > low[k] && sizes[k] > 0) factors[k] = sizes[k] / (high[k] - low[k]);
    scale(part, about, powers(factors, m_shares.prop));
}

void FigureAction::movjnt() const {
    const int moved = joint(0), held = ellipsoid(1);
    if (!m_state.topology->is_end(moved, held))
        fail("the ellipsoid " + ellipsoid_name(held) + " is not at the joint " + joint_name(moved));
    const glm::dvec3 by = m_shares.frac * (glm::mat3_cast(body(held).turn) * vector(2));
    const int other = m_state.topology->other_end(moved, held);
    const FigurePart part = part_from(m_state, other, moved);
    if (std::find(part.bodies.begin(), part.bodies.end(), held) != part.bodies.end())
        fail("the joint " + joint_name(moved) + " is part of a ring");
    move(part, by);
    joint_position(moved) += by;
    check(joint_position(moved), "the joint " + joint_name(moved));
}

void FigureAction::attach() const {
    const int first = ellipsoid(0), made = index(1, OperandKind::joint), second = ellipsoid(2);
    if (first == 0 || second == 0) fail("a joint does not connect world");
    if (m_state.topology->joints[static_cast<std::size_t>(made)].joined)
        fail("the joint " + joint_name(made) + " is in use");
    if (strict()) {
        const FigurePart part = part_from(m_state, first, -1);
        if (std::find(part.bodies.begin(), part.bodies.end(), second) != part.bodies.end())
            fail("the joint " + joint_name(made) + " closes a ring");
    }
    joint_position(made) = body(strict() ? second : first).center + vector(3);
    check(joint_position(made), "the joint " + joint_name(made));
    own_topology(m_state).attach(made, first, second);
}

void FigureAction::detach() const {
    const int parted = ellipsoid(0), cut = joint(1), made = index(2, OperandKind::figure);
    if (!m_state.topology->is_end(cut, parted))
        fail("the ellipsoid " + ellipsoid_name(parted) + " is not at the joint " + joint_name(cut));
    if (made < 2) fail("world is no figure of its own");
    const auto here = part_from(m_state, parted, cut).bodies;
    const auto there = part_from(m_state, m_state.topology->other_end(cut, parted), cut).bodies;
    auto topology = std::make_shared<Topology>(*m_state.topology);
    topology->joints[static_cast<std::size_t>(cut)].joined = false;
    auto& order = topology->joint_order;
    order.erase(std::find(order.begin(), order.end(), cut));
    // Names that were found by an ellipsoid of the part go with the rest.
    for (int& first : topology->figure_first)
        if (first > 0 && std::find(here.begin(), here.end(), first) != here.end())
            first = *std::min_element(there.begin(), there.end());
    topology->figure_first[static_cast<std::size_t>(made)] = *std::min_element(here.begin(), here.end());
    topology->connect(m_state.bodies.size());
    m_state.topology = std::move(topology);
}

}  // namespace anamorph::figure
