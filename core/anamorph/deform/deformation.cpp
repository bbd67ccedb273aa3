// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/deformation.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <tuple>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

void check_finite(const char* name, double value) {
    if (!std::isfinite(value)) throw Error(name, shortest(value), "must be a finite number");
}

double largest_of(const glm::dvec4& q) {
    return std::max({std::fabs(q.x), std::fabs(q.y), std::fabs(q.z), std::fabs(q.w)});
}

void check_frame(const Deformation& d) {
    constexpr double kLeast = 1e-100, kMost = 1e100;
    for (int c = 0; c < 4; ++c) check_finite("orientation", d.orientation[c]);
    const double largest = largest_of(d.orientation);
    if (!(largest >= kLeast && largest <= kMost))
        throw Error("orientation", shortest(largest),
                    "the largest number must have a magnitude from 1e-100 to 1e100");
    if (!d.has_frame()) return;
    if (!d.has_depth())
        throw Error(
            "orientation",
            shortest(d.orientation.y) + "," + shortest(d.orientation.z) + "," + shortest(d.orientation.w),
            "must be without a turn (1, 0, 0, 0), or the extent must have a third number");
    const auto [least, most] = std::minmax({d.extent.x, d.extent.y, d.extent_w});
    if (!(most / least <= kMostExtentRatio))
        throw Error("extent", shortest(most),
                    "with an orientation, must be at most 2^20 times the least, " + shortest(least));
}

std::optional<Deformation> effect(const Deformation& d) {
    if (!d.enabled || d.vector == glm::dvec3(0.0)) return std::nullopt;
    return d;
}

auto key(const Deformation& d) {
    return std::tuple(d.center.x, d.center.y, d.extent.x, d.extent.y, d.vector.x, d.vector.y, d.vector.z,
                      d.kernel, d.center_w, d.extent_w, d.side, d.orientation.x, d.orientation.y,
                      d.orientation.z, d.orientation.w);
}

/// What moves the surface, sorted.
std::vector<Deformation> effects(const std::vector<Deformation>& list) {
    std::vector<Deformation> sorted;
    for (const Deformation& d : list)
        if (effect(d)) sorted.push_back(d);
    std::sort(sorted.begin(), sorted.end(),
              [](const Deformation& a, const Deformation& b) { return key(a) < key(b); });
    return sorted;
}

}  // namespace

void check_deformation(const Deformation& d) {
    for (const double v : {d.vector.x, d.vector.y, d.vector.z}) check_finite("vector", v);
    for (const double c : {d.center.x, d.center.y}) check_finite("center", c);
    check_finite("center", d.center_w);
    kExtentRow.check(d.extent.x);
    kExtentRow.check(d.extent.y);
    if (d.has_depth()) kExtentRow.check(d.extent_w);
    check_frame(d);
}

glm::dvec4 unit_scaled(glm::dvec4 q) {
    const int exponent = std::ilogb(largest_of(q));
    return {std::ldexp(q.x, -exponent), std::ldexp(q.y, -exponent), std::ldexp(q.z, -exponent),
            std::ldexp(q.w, -exponent)};
}

glm::dvec3 framed_reach(const Deformation& d) {
    const auto turn = turn_of<double>(d);
    const double extent[3] = {d.extent.x, d.extent.y, d.extent_w};
    glm::dvec3 reach(0.0);
    for (int j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k)
            reach[j] += std::fabs(turn[static_cast<std::size_t>(j)][k]) * extent[k];
    // With |p - c|_1 at most about r (S_u + S_v + S_w), x errs by 13 units of 2^-53 of that over its extent
    // (deform_kernels.h), so that a point whose x is found within may be off along u by 23 of them; what is rounded here is less.
    return reach + glm::dvec3(0x1p-44 * (reach.x + reach.y + reach.z));
}

glm::dvec4 frame_at(glm::dvec3 normal) {
    const double largest = std::max({std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)});
    if (!(largest > 0) || !std::isfinite(largest))
        throw Error("normal", shortest(normal.x) + "," + shortest(normal.y) + "," + shortest(normal.z),
                    "must have a direction");
    const glm::dvec3 n = glm::normalize(normal / largest);
    // Half the way from w to n: (1 + n_w, w x n). Straight down, any axis of the plane will do.
    const double aside = n.x * n.x + n.y * n.y;
    if (n.z < 0 && !(aside > 0)) return {0, 1, 0, 0};
    const glm::dvec4 q(n.z < 0 ? aside / (1 - n.z) : 1 + n.z, -n.y, n.x, 0);
    return q / glm::length(q);
}

bool needs_depth(const std::vector<Deformation>& list) {
    return std::any_of(list.begin(), list.end(),
                       [](const Deformation& d) { return effect(d) && !d.is_plain(); });
}

bool needs_normals(const std::vector<Deformation>& list) {
    return std::any_of(list.begin(), list.end(),
                       [](const Deformation& d) { return effect(d) && d.has_side(); });
}

void add_displacement(const Deformation& d, glm::dvec2 p, DisplacementJet& sum) {
    using J = Jet1<double>;
    const J f = influence(d, J::variable(p.x, 1, 0), J::variable(p.y, 0, 1));
    sum.value += d.vector * f.c[0];
    sum.by_u += d.vector * f.c[1];
    sum.by_v += d.vector * f.c[2];
}

DisplacementJet displacement_at(const std::vector<Deformation>& list, glm::dvec2 p) {
    DisplacementJet sum;
    for (const Deformation& d : list)
        if (d.enabled) add_displacement(d, p, sum);
    return sum;
}

glm::dvec3 displacement_at(const std::vector<Deformation>& list, glm::dvec2 p, double w, glm::dvec3 n) {
    glm::dvec3 sum(0.0);
    for (const Deformation& d : list)
        if (d.enabled)
            sum +=
                d.vector * influence(d, p.x, p.y, w, dot_product(side_direction<double>(d), {n.x, n.y, n.z}));
    return sum;
}

glm::dvec3 normal_of(const DisplacementJet& d, glm::dvec3 base_u, glm::dvec3 base_v) {
    const glm::dvec3 normal = glm::cross(base_u + d.by_u, base_v + d.by_v);
    const double length = glm::length(normal);
    return length > 0 ? normal / length : glm::dvec3(0.0);
}

DeformationList::DeformationList(std::vector<Deformation> entries) : m_entries(std::move(entries)) {
    for (const Deformation& d : m_entries) check_deformation(d);
}

void DeformationList::check_position(std::size_t position, std::size_t end) const {
    if (position >= end)
        throw Error("position", std::to_string(position),
                    end ? "must be an integer from 0 to " + std::to_string(end - 1) : "the list is empty");
}

DeformationChange DeformationList::add(const Deformation& deformation) {
    return insert(m_entries.size(), deformation);
}

DeformationChange DeformationList::insert(std::size_t position, const Deformation& deformation) {
    check_position(position, m_entries.size() + 1);
    check_deformation(deformation);
    m_entries.insert(m_entries.begin() + static_cast<std::ptrdiff_t>(position), deformation);
    return {std::nullopt, effect(deformation)};
}

DeformationChange DeformationList::change(std::size_t position, const Deformation& deformation) {
    check_position(position, m_entries.size());
    check_deformation(deformation);
    const DeformationChange done{effect(m_entries[position]), effect(deformation)};
    m_entries[position] = deformation;
    return done.before == done.after ? DeformationChange() : done;
}

DeformationChange DeformationList::remove(std::size_t position) {
    check_position(position, m_entries.size());
    const DeformationChange done{effect(m_entries[position]), std::nullopt};
    m_entries.erase(m_entries.begin() + static_cast<std::ptrdiff_t>(position));
    return done;
}

DeformationChange DeformationList::enable(std::size_t position, bool enabled) {
    check_position(position, m_entries.size());
    Deformation d = m_entries[position];
    d.enabled = enabled;
    return change(position, d);
}

void DeformationList::move(std::size_t from, std::size_t to) {
    check_position(from, m_entries.size());
    check_position(to, m_entries.size());
    const auto at = [&](std::size_t i) { return m_entries.begin() + static_cast<std::ptrdiff_t>(i); };
    if (from < to)
        std::rotate(at(from), at(from + 1), at(to + 1));
    else
        std::rotate(at(to), at(from), at(from + 1));
}

std::vector<DeformationChange> difference(const std::vector<Deformation>& from,
                                          const std::vector<Deformation>& to) {
    const std::vector<Deformation> a = effects(from), b = effects(to);
    std::vector<DeformationChange> changes;
    std::size_t i = 0, j = 0;
    while (i < a.size() || j < b.size()) {
        const bool only_a = j == b.size() || (i < a.size() && key(a[i]) < key(b[j]));
        const bool only_b = !only_a && (i == a.size() || key(b[j]) < key(a[i]));
        if (only_a)
            changes.push_back({a[i++], std::nullopt});
        else if (only_b)
            changes.push_back({std::nullopt, b[j++]});
        else
            ++i, ++j;
    }
    return changes;
}

}  // namespace anamorph
