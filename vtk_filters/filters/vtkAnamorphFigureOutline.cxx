// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphFigureOutline.h"

#include <cmath>
#include <glm/common.hpp>
#include <numbers>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/outline/connected.h"
#include "anamorph/figure/outline/outline.h"
#include "anamorph/figure/outline/outline_arcs.h"
#include "anamorph/parameter/parameter.h"
#include "execution.h"
#include "figure_data.h"
#include "figure_lines.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkObjectFactoryNewMacro(vtkAnamorphFigureOutline);

namespace {

using anamorph::Error;
using anamorph::figure::Arc;
using anamorph::figure::Outline;

/// Longer arcs are closed.
constexpr double kWholeTurn = 2 * std::numbers::pi - 1e-9;

/// An arc of a curve, which may go over its end.
std::vector<glm::dvec3> part_of(const anamorph::figure::CrossingCurve& curve, const Arc& arc) {
    const auto& points = curve.points;
    const auto at = [&](double t) {
        const double below = std::floor(t);
        const auto k = static_cast<std::size_t>(below);
        return glm::mix(points[k % points.size()], points[(k + 1) % points.size()], t - below);
    };
    std::vector<glm::dvec3> part{at(arc.begin)};
    for (double t = std::floor(arc.begin) + 1; t < arc.end; ++t) part.push_back(at(t));
    part.push_back(at(arc.end));
    if (arc.length() >= static_cast<double>(points.size())) part.back() = part.front();
    return part;
}

/// Takes away what of outlines is inside of connections.
void cut_out(const std::vector<anamorph::figure::Connection>& connections, std::vector<Outline>& outlines) {
    constexpr double turn = 2 * std::numbers::pi;
    std::vector<std::vector<Arc>> inside(outlines.size());
    for (const anamorph::figure::Connection& c : connections) {
        auto &first = inside[static_cast<std::size_t>(c.first)],
             &second = inside[static_cast<std::size_t>(c.second)];
        first.insert(first.end(), c.first_inside.begin(), c.first_inside.end());
        second.insert(second.end(), c.second_inside.begin(), c.second_inside.end());
    }
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        if (inside[i].empty()) continue;
        const auto without_inside = [&](const std::vector<Arc>& others) {
            std::vector<Arc> taken = inside[i];
            taken.insert(taken.end(), others.begin(), others.end());
            return anamorph::figure::complement_of(anamorph::figure::union_of(taken, turn), turn);
        };
        const std::vector<Arc> visible = without_inside(outlines[i].hidden);
        outlines[i].hidden = without_inside(outlines[i].visible);
        outlines[i].visible = visible;
    }
}

}  // namespace

vtkAnamorphFigureOutline::vtkAnamorphFigureOutline() = default;
vtkAnamorphFigureOutline::~vtkAnamorphFigureOutline() = default;

void vtkAnamorphFigureOutline::Draw(vtkPolyData* input, vtkDataObject* output,
                                    anamorph_vtk::Execution& execution) {
    anamorph::figure::kOutlineTolRow.check(this->Tolerance, "Tolerance");
    const anamorph_vtk::Bodies bodies(input);
    const anamorph::figure::View view = this->ViewOf(input);
    anamorph::figure::OutlineOptions options;
    options.hide = false;
    options.names = bodies.names;
    // Limbs tell at once that there are too many chords, crossings late.
    if (this->Crossings)
        for (const Outline& outline : anamorph::figure::outlines(bodies.shapes, view, options).bodies)
            for (const Arc& arc : outline.visible)
                anamorph::figure::chord_angles(outline, arc, view, this->Tolerance);
    options.hide = this->Hidden != TRANSPARENT;
    options.crossings = this->Crossings;
    options.keep_hidden = this->Hidden == KEPT;
    options.tol = this->Tolerance;
    execution.progress(0.05);
    anamorph::figure::Outlines all =
        anamorph::figure::outlines(bodies.shapes, view, options, execution.stage(0.1, 0.6));
    std::vector<anamorph::figure::Connection> connections;
    if (this->Connected) {
        connections =
            anamorph::figure::connections(bodies.joints, bodies.shapes, all, view, execution.stage(0.6, 0.7));
        cut_out(connections, all.bodies);
    }

    anamorph_vtk::LineWriter writer(input, this->OutputPointsPrecision, {"Visible", "OtherBodyId"});
    const auto id = [&](int body) { return body < 0 ? -1 : bodies.ids[static_cast<std::size_t>(body)]; };
    // Adds the parts of something that has visible and hidden ones.
    const auto add = [&](const auto& line, int body, int other, const auto& part) {
        const auto other_id = static_cast<double>(id(other));
        for (const Arc& arc : line.visible) writer.add(part(arc), id(body), {1, other_id});
        if (this->Hidden != KEPT) return;
        for (const Arc& arc : line.hidden) writer.add(part(arc), id(body), {0, other_id});
    };
    for (std::size_t i = 0; i < all.bodies.size(); ++i) {
        const Outline& outline = all.bodies[i];
        add(outline, static_cast<int>(i), -1, [&](const Arc& arc) {
            std::vector<glm::dvec3> points;
            for (const double angle : anamorph::figure::chord_angles(outline, arc, view, this->Tolerance))
                points.push_back(outline.limb(angle));
            if (arc.length() > kWholeTurn) points.back() = points.front();
            return points;
        });
        if (i % 64 == 63)
            execution.progress(0.7 + 0.2 * static_cast<double>(i) / static_cast<double>(all.bodies.size()));
    }
    for (const anamorph::figure::CrossingCurve& curve : all.crossings)
        add(curve, curve.first, curve.second, [&](const Arc& arc) { return part_of(curve, arc); });
    for (const anamorph::figure::Connection& c : connections)
        for (const anamorph::figure::ConnectingStroke& stroke : c.strokes)
            add(stroke.line, c.first, c.second, [&](const Arc& arc) {
                return std::vector<glm::dvec3>{glm::mix(stroke.line.from, stroke.line.to, arc.begin),
                                               glm::mix(stroke.line.from, stroke.line.to, arc.end)};
            });
    writer.write(vtkPolyData::SafeDownCast(output));
}

void vtkAnamorphFigureOutline::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    static const char* const hidden[] = {"removed", "kept", "transparent"};
    os << indent << "Hidden: " << hidden[this->Hidden] << "\n"
       << indent << "Crossings: " << this->Crossings << "\n"
       << indent << "Connected: " << this->Connected << "\n"
       << indent << "Tolerance: " << this->Tolerance << "\n"
       << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
}
