// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphFigureOutline.h"

#include <numbers>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/outline.h"
#include "anamorph/parameter.h"
#include "execution.h"
#include "figure_data.h"
#include "figure_lines.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkObjectFactoryNewMacro(vtkAnamorphFigureOutline);

namespace {

using anamorph::Arc;
using anamorph::Error;
using anamorph::Outline;

/// Longer arcs are closed.
constexpr double kWholeTurn = 2 * std::numbers::pi - 1e-9;

/// An arc as points in space.
struct Polyline {
    vtkIdType body;
    bool visible;
    std::vector<glm::dvec3> points;
};

}  // namespace

vtkAnamorphFigureOutline::vtkAnamorphFigureOutline() = default;
vtkAnamorphFigureOutline::~vtkAnamorphFigureOutline() = default;

int vtkAnamorphFigureOutline::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                          vtkInformationVector* outputs) {
    vtkPolyData *input = vtkPolyData::GetData(inputs[0]), *output = vtkPolyData::GetData(outputs);
    return this->Guarded(output, [&] {
        anamorph_vtk::Execution execution(this);
        if (!(this->Tolerance > 0))
            throw Error("Tolerance", anamorph::shortest(this->Tolerance), "allowed is a positive number");
        const anamorph_vtk::Bodies bodies(input);
        const anamorph::View view = this->ViewOf(input);
        anamorph::OutlineOptions options;
        options.hide = this->Hidden != TRANSPARENT;
        options.names = bodies.names;
        execution.progress(0.05);
        const std::vector<Outline> outlines =
            anamorph::outlines(bodies.shapes, view, options, execution.stage(0.1, 0.7)).bodies;

        std::vector<std::vector<Polyline>> polylines(outlines.size());
        execution.stage(0.7, 0.9)(static_cast<std::int64_t>(outlines.size()), [&](std::int64_t k) {
            const auto i = static_cast<std::size_t>(k);
            const auto add = [&](const Arc& arc, bool visible) {
                Polyline line{bodies.ids[i], visible, {}};
                for (const double angle : anamorph::chord_angles(outlines[i], arc, view, this->Tolerance))
                    line.points.push_back(outlines[i].limb(angle));
                if (arc.length() > kWholeTurn) line.points.back() = line.points.front();
                polylines[i].push_back(std::move(line));
            };
            for (const Arc& arc : outlines[i].visible) add(arc, true);
            if (this->Hidden == KEPT)
                for (const Arc& arc : outlines[i].hidden) add(arc, false);
        });

        anamorph_vtk::LineWriter writer(input, this->OutputPointsPrecision, "Visible");
        for (const std::vector<Polyline>& of_body : polylines)
            for (const Polyline& line : of_body) writer.add(line.points, line.body, line.visible);
        writer.write(output);
    });
}

void vtkAnamorphFigureOutline::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    static const char* const hidden[] = {"removed", "kept", "transparent"};
    os << indent << "Hidden: " << hidden[this->Hidden] << "\n"
       << indent << "Tolerance: " << this->Tolerance << "\n"
       << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
}
