// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/language/figure_state.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "anamorph/figure/body/rotation.h"
#include "anamorph/number/hypot.h"

namespace anamorph::figure {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

/// Ellipsoids and joints reached, the joint `barred` not crossed. `seen` marks ellipsoids.
void spread(const Topology& topology, int from, int barred, std::vector<char>& seen, FigurePart& part) {
    std::size_t next = part.bodies.size();
    part.bodies.push_back(from);
    seen[at(from)] = 1;
    for (; next < part.bodies.size(); ++next)
        for (const int joint : topology.joints_of[at(part.bodies[next])]) {
            if (joint == barred) continue;
            const int other = topology.other_end(joint, part.bodies[next]);
            // A joint is met from both ends; it is kept where it is first met, or where it closes a ring.
            if (!seen[at(other)]) {
                seen[at(other)] = 1;
                part.bodies.push_back(other);
            }
            if (topology.joints[at(joint)].first == part.bodies[next]) part.joints.push_back(joint);
        }
}

}  // namespace

void Topology::connect(std::size_t ellipsoids) {
    joints_of.assign(ellipsoids, {});
    for (const int j : joint_order) {
        joints_of[at(joints[at(j)].first)].push_back(j);
        if (joints[at(j)].second != joints[at(j)].first) joints_of[at(joints[at(j)].second)].push_back(j);
    }
    m_pieces.assign(ellipsoids, {});
    visited += ellipsoids + joint_order.size();
    for (const int j : joint_order) join(joints[at(j)].first, joints[at(j)].second);
    // Of several figures that hang together the first.
    for (std::size_t f = figure_first.size(); f-- > 2;)
        if (figure_first[f] >= 0) m_pieces[at(root_of(figure_first[f]))].figure = static_cast<int>(f);
}

int Topology::root_of(int ellipsoid) const {
    while (m_pieces[at(ellipsoid)].parent >= 0) ellipsoid = m_pieces[at(ellipsoid)].parent;
    return ellipsoid;
}

int Topology::figure_of(int ellipsoid) const {
    return m_pieces[at(root_of(ellipsoid))].figure;
}

void Topology::join(int first, int second) {
    int large = root_of(first), small = root_of(second);
    if (large == small) return;
    if (m_pieces[at(large)].size < m_pieces[at(small)].size) std::swap(large, small);
    Piece &kept = m_pieces[at(large)], &added = m_pieces[at(small)];
    kept.size += added.size;
    if (kept.figure < 0 || (added.figure >= 0 && added.figure < kept.figure)) kept.figure = added.figure;
    added.parent = large;
}

void Topology::attach(int joint, int first, int second) {
    joints[at(joint)] = {first, second, true};
    joint_order.push_back(joint);
    joints_of[at(first)].push_back(joint);
    if (second != first) joints_of[at(second)].push_back(joint);
    join(first, second);
    visited += 2;
}

int Topology::other_end(int joint, int ellipsoid) const {
    const Ends& ends = joints[at(joint)];
    return ends.first == ellipsoid ? ends.second : ends.first;
}

bool Topology::is_end(int joint, int ellipsoid) const {
    const Ends& ends = joints[at(joint)];
    return ends.joined && (ends.first == ellipsoid || ends.second == ellipsoid);
}

std::size_t FigureState::bytes() const {
    return sizeof(FigureState) + bodies.size() * sizeof(Body) + joints.size() * sizeof(glm::dvec3) +
           variables.size() * sizeof(Value) + overlaps.size() * sizeof(Overlap);
}

Topology& own_topology(FigureState& state) {
    if (state.topology.use_count() > 1) {
        auto copy = std::make_shared<Topology>(*state.topology);
        copy->visited += state.bodies.size() + copy->joint_order.size();
        state.topology = std::move(copy);
    }
    return *state.topology;
}

FigurePart part_from(const FigureState& state, int ellipsoid, int joint) {
    FigurePart part;
    std::vector<char> seen(state.bodies.size(), 0);
    spread(*state.topology, ellipsoid, joint, seen, part);
    return part;
}

FigurePart part_of_figure(const FigureState& state, int figure) {
    if (figure >= 2) return part_from(state, state.topology->figure_first[at(figure)], -1);
    FigurePart part;
    for (std::size_t i = 1; i < state.bodies.size(); ++i) part.bodies.push_back(static_cast<int>(i));
    part.joints = state.topology->joint_order;
    return part;
}

void translate(FigureState& state, const FigurePart& part, const glm::dvec3& by) {
    for (const int i : part.bodies)
        if (i != 0) state.bodies[at(i)].center += by;
    for (const int j : part.joints) state.joints[at(j)] += by;
}

void turn(FigureState& state, const FigurePart& part, const glm::dquat& by, glm::dvec3 about) {
    const glm::dmat3 matrix = glm::mat3_cast(by);
    for (const int i : part.bodies) {
        if (i == 0) continue;
        auto& body = state.bodies[at(i)];
        body.center = about + matrix * (body.center - about);
        body.turn = glm::normalize(by * body.turn);
    }
    for (const int j : part.joints) state.joints[at(j)] = about + matrix * (state.joints[at(j)] - about);
}

double half_height(const FigureState::Body& body) {
    const glm::dmat3 r = glm::mat3_cast(body.turn);
    return hypot(body.axes.x * r[0].y, body.axes.y * r[1].y, body.axes.z * r[2].y);
}

double lowest(const FigureState& state, const std::vector<int>& bodies) {
    double low = std::numeric_limits<double>::infinity();
    for (const int i : bodies)
        low = std::min(low, state.bodies[at(i)].center.y - half_height(state.bodies[at(i)]));
    return low;
}

Ellipsoid shape_of(const FigureState::Body& body) {
    return {body.center, glm::abs(body.axes), glm::mat3_cast(body.turn)};
}

FigureState figures_at_rest(const Program& program) {
    FigureState state;
    state.bodies.resize(program.ellipsoids.size());
    for (std::size_t i = 1; i < state.bodies.size(); ++i)
        state.bodies[i].axes = glm::abs(program.ellipsoids[i].axes);
    state.joints.assign(program.joints.size(), glm::dvec3(0.0));
    state.variables.resize(program.variables.size());

    auto topology = std::make_shared<Topology>();
    for (std::size_t j = 0; j < program.joints.size(); ++j) {
        const JointDeclaration& joint = program.joints[j];
        topology->joints.push_back({joint.first, joint.second, !joint.attached});
        if (!joint.attached) topology->joint_order.push_back(static_cast<int>(j));
    }
    for (const FigureDeclaration& figure : program.figures)
        topology->figure_first.push_back(figure.ellipsoids.empty() ? -1 : figure.ellipsoids.front());
    topology->connect(state.bodies.size());

    // Ellipsoids are placed as they are reached, each from one that is placed.
    std::vector<char> seen(state.bodies.size(), 0);
    for (std::size_t root = 1; root < state.bodies.size(); ++root) {
        if (seen[root]) continue;
        std::vector<int> reached{static_cast<int>(root)};
        seen[root] = 1;
        for (std::size_t next = 0; next < reached.size(); ++next)
            for (const int j : topology->joints_of[at(reached[next])]) {
                const int from = reached[next], other = topology->other_end(j, from);
                if (seen[at(other)]) continue;
                seen[at(other)] = 1;
                const JointDeclaration& joint = program.joints[at(j)];
                const glm::dvec3 across = joint.first_offset - joint.second_offset;
                state.bodies[at(other)].center =
                    state.bodies[at(from)].center + (joint.first == from ? across : -across);
                reached.push_back(other);
            }
    }
    for (const int j : topology->joint_order)
        state.joints[at(j)] =
            state.bodies[at(program.joints[at(j)].first)].center + program.joints[at(j)].first_offset;
    state.topology = std::move(topology);
    return state;
}

FigureFrame frame_of(const FigureState& state, const Program& program, int number) {
    const Topology& topology = *state.topology;
    FigureFrame frame;
    frame.number = number;
    // Figures that an attached joint has made one appear under the first name; others have no place in the
    // list.
    std::vector<int> listed(program.figures.size(), -1);
    frame.bodies.resize(state.bodies.size() - 1);
    const auto list = [&](std::size_t f, const std::string& name) {
        listed[f] = static_cast<int>(frame.figures.size());
        frame.figures.push_back(name);
    };
    for (std::size_t f = 2; f < program.figures.size(); ++f)
        if (topology.figure_first[f] >= 0 &&
            topology.figure_of(topology.figure_first[f]) == static_cast<int>(f))
            list(f, program.figures[f].name);
    std::vector<int> declared(state.bodies.size(), 0);
    for (std::size_t f = program.figures.size(); f-- > 2;)
        for (const int e : program.figures[f].ellipsoids) declared[at(e)] = static_cast<int>(f);
    for (std::size_t i = 1; i < state.bodies.size(); ++i) {
        const auto& from = state.bodies[i];
        Body& body = frame.bodies[i - 1];
        body.shape = shape_of(from);
        body.name = program.ellipsoids[i].name;
        // Where a figure is in pieces, only the first is found by its joints: the others by their
        // declaration.
        const int figure = topology.figure_of(static_cast<int>(i));
        const auto f = at(figure >= 0 ? figure : declared[i]);
        if (listed[f] < 0) list(f, f == 0 ? "" : program.figures[f].name);
        body.figure = listed[f];
        body.color = from.color;
        if (from.image >= 0) body.texture = program.images[at(from.image)];
        body.texture_offset = from.offset;
    }
    for (const int j : topology.joint_order)
        frame.joints.push_back({program.joints[at(j)].name, topology.joints[at(j)].first - 1,
                                topology.joints[at(j)].second - 1, state.joints[at(j)]});
    frame.place = state.place;
    frame.observe = state.observe;
    frame.observer = glm::mat3_cast(turn_xyz(state.observe));
    return frame;
}

}  // namespace anamorph::figure
