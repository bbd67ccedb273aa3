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

std::optional<Deformation> effect(const Deformation& d) {
    if (!d.enabled || d.vector == glm::dvec3(0.0)) return std::nullopt;
    return d;
}

auto key(const Deformation& d) {
    return std::tuple(d.center.x, d.center.y, d.extent.x, d.extent.y, d.vector.x, d.vector.y, d.vector.z,
                      d.kernel, d.center_w, d.extent_w, d.side);
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
