// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/connected.h"

#include <algorithm>
#include <cmath>

#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/outline/outline_arcs.h"

namespace anamorph::figure {
namespace {

constexpr int kSteps = 256;

using ScreenEllipse = Ellipse<glm::dvec2>;

glm::dvec2 normal_at(double angle) {
    return {std::cos(angle), std::sin(angle)};
}

/// Its point farthest along n is at this angle.
double contact(const ScreenEllipse& e, const glm::dvec2& n) {
    return std::atan2(glm::dot(e.sine, n), glm::dot(e.cosine, n));
}

/// How far it reaches along n, from `origin`.
double support(const ScreenEllipse& e, const glm::dvec2& n, const glm::dvec2& origin) {
    const double c = glm::dot(e.cosine, n), s = glm::dot(e.sine, n);
    return glm::dot(e.center - origin, n) + std::sqrt(c * c + s * s);
}

/// Two outlines; a common tangent has a normal along which both reach equally far.
struct Tangents {
    const ScreenEllipse &a, &b;

    double lead_of_a(double angle) const {
        const glm::dvec2 n = normal_at(angle);
        return support(a, n, a.center) - support(b, n, a.center);
    }

    /// The angles of the normals, ascending.
    std::vector<double> normals() const {
        std::vector<double> found;
        double low = 0, at_low = lead_of_a(0);
        for (int k = 1; k <= kSteps; ++k) {
            const double high = kTurn * k / kSteps, at_high = lead_of_a(high == kTurn ? 0 : high);
            if ((at_low < 0) != (at_high < 0)) found.push_back(root(low, high, at_low < 0));
            low = high;
            at_low = at_high;
        }
        return found;
    }

    double root(double low, double high, bool rising) const {
        while (high - low > 1e-15) {
            const double middle = 0.5 * (low + high);
            if (middle <= low || middle >= high) break;
            ((lead_of_a(middle) < 0) == rising ? low : high) = middle;
        }
        return 0.5 * (low + high);
    }
};

/// The arc of a limb with normals from `from` to `to`.
Arc limb_arc(const Outline& outline, double from, double to, const View& view) {
    const ScreenEllipse& e = outline.screen;
    double begin = outline.limb_angle(contact(e, normal_at(from)), view);
    double end = outline.limb_angle(contact(e, normal_at(to)), view);
    if (e.cosine.x * e.sine.y - e.cosine.y * e.sine.x < 0) std::swap(begin, end);
    begin = in_turn(begin);
    end = in_turn(end);
    return {begin, end > begin ? end : end + kTurn};
}

Connection connect(const Joint& joint, const Outline& a, const Outline& b, const View& view) {
    Connection connection;
    connection.first = joint.first;
    connection.second = joint.second;
    const Tangents tangents{a.screen, b.screen};
    const std::vector<double> normals = tangents.normals();
    if (normals.empty()) {
        (tangents.lead_of_a(0) < 0 ? connection.first_inside : connection.second_inside) = {{0, kTurn}};
        return connection;
    }
    for (std::size_t k = 0; k < normals.size(); ++k) {
        const glm::dvec2 n = normal_at(normals[k]);
        ConnectingStroke stroke;
        stroke.first_angle = in_turn(a.limb_angle(contact(a.screen, n), view));
        stroke.second_angle = in_turn(b.limb_angle(contact(b.screen, n), view));
        stroke.line.from = a.limb(stroke.first_angle);
        stroke.line.to = b.limb(stroke.second_angle);
        connection.strokes.push_back(stroke);
        // Between two tangents the outline that reaches less far is inside.
        const double next = k + 1 < normals.size() ? normals[k + 1] : normals[0] + kTurn;
        if (tangents.lead_of_a(0.5 * (normals[k] + next)) < 0)
            connection.first_inside.push_back(limb_arc(a, normals[k], next, view));
        else
            connection.second_inside.push_back(limb_arc(b, normals[k], next, view));
    }
    connection.first_inside = union_of(std::move(connection.first_inside), kTurn);
    connection.second_inside = union_of(std::move(connection.second_inside), kTurn);
    return connection;
}

}  // namespace

std::vector<Connection> connections(std::span<const Joint> joints, std::span<const Ellipsoid> bodies,
                                    const Outlines& outlines, const View& view,
                                    const ParallelFor& parallel_for) {
    const auto outline_of = [&](const Joint& joint, int body) -> const Outline& {
        if (body < 0 || static_cast<std::size_t>(body) >= std::min(bodies.size(), outlines.bodies.size()))
            throw Error("joint " + joint.name, std::to_string(body),
                        "must be the position of one of the " + std::to_string(bodies.size()) + " bodies");
        return outlines.bodies[static_cast<std::size_t>(body)];
    };
    std::vector<Connection> all;
    std::vector<SeenLine> lines;
    std::vector<std::vector<int>> ignored;
    for (const Joint& joint : joints) {
        const Outline &a = outline_of(joint, joint.first), &b = outline_of(joint, joint.second);
        if (a.kind != OutlineKind::whole || b.kind != OutlineKind::whole) continue;
        all.push_back(connect(joint, a, b, view));
        for (const ConnectingStroke& stroke : all.back().strokes) {
            lines.push_back(stroke.line);
            ignored.push_back({joint.first, joint.second});
        }
    }
    hide_lines(lines, bodies, view, ignored, parallel_for);
    auto line = lines.begin();
    for (Connection& connection : all)
        for (ConnectingStroke& stroke : connection.strokes) stroke.line = *line++;
    return all;
}

std::vector<Connection> connections(const FigureFrame& frame, const Outlines& outlines, const View& view,
                                    const ParallelFor& parallel_for) {
    std::vector<Ellipsoid> shapes;
    for (const Body& body : frame.bodies) shapes.push_back(body.shape);
    return connections(frame.joints, shapes, outlines, view, parallel_for);
}

}  // namespace anamorph::figure
