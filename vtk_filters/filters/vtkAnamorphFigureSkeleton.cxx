// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphFigureSkeleton.h"

#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/body/skeleton.h"
#include "anamorph/figure/outline/level_of_detail.h"
#include "anamorph/figure/outline/spheres.h"
#include "anamorph/parameter/parameter.h"
#include "execution.h"
#include "figure_data.h"
#include "figure_lines.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkObjectFactoryNewMacro(vtkAnamorphFigureSkeleton);

namespace {

using anamorph::Error;
using anamorph::figure::Detail;
using anamorph::figure::Stick;
using anamorph_vtk::Bodies;

std::vector<Stick> sticks_from_joint_to_joint(const Bodies& bodies) {
    anamorph::figure::FigureFrame frame;
    for (const anamorph::figure::Ellipsoid& shape : bodies.shapes) {
        frame.bodies.emplace_back();
        frame.bodies.back().shape = shape;
    }
    frame.joints = bodies.joints;
    return anamorph::figure::joint_sticks(frame);
}

}  // namespace

vtkAnamorphFigureSkeleton::vtkAnamorphFigureSkeleton() = default;
vtkAnamorphFigureSkeleton::~vtkAnamorphFigureSkeleton() = default;

void vtkAnamorphFigureSkeleton::Draw(vtkPolyData* input, vtkDataObject* output,
                                     anamorph_vtk::Execution& execution) {
    anamorph::figure::kLevelOfDetailRow.check(this->LevelOfDetail, "LevelOfDetail");
    anamorph::figure::kSphereTolRow.check(this->Tolerance, "Tolerance");
    const Bodies bodies(input);
    const std::vector<Detail> details =
        anamorph::figure::levels_of_detail(bodies.shapes, this->ViewOf(input), {this->LevelOfDetail});
    execution.progress(0.3);

    static_assert(NONE == static_cast<int>(Detail::none) && DOT == static_cast<int>(Detail::dot) &&
                  LINE == static_cast<int>(Detail::line) && ELLIPSE == static_cast<int>(Detail::ellipse) &&
                  BODY == static_cast<int>(Detail::body));
    anamorph_vtk::LineWriter writer(input, this->OutputPointsPrecision, {"Detail", "Radius"});
    const auto add = [&](const std::vector<glm::dvec3>& points, std::size_t body, double radius) {
        writer.add(points, bodies.ids[body], {static_cast<double>(details[body]), radius});
    };
    for (std::size_t i = 0; i < details.size(); ++i)
        if (details[i] == Detail::dot) add({bodies.shapes[i].center}, i, 0);
    const auto is_more_than_a_dot = [&](std::size_t i) { return details[i] > Detail::dot; };
    if (this->Mode == SPHERES) {
        anamorph::figure::SphereOptions options;
        options.tol = this->Tolerance;
        for (std::size_t i = 0; i < details.size(); ++i) {
            execution.progress(0.3 + 0.6 * static_cast<double>(i) / static_cast<double>(details.size()));
            if (!is_more_than_a_dot(i)) continue;
            const anamorph::figure::SphereFill fill =
                anamorph::figure::fill_with_spheres(bodies.shapes[i], options);
            if (!(fill.deviation <= this->Tolerance))
                throw Error("Tolerance", anamorph::shortest(this->Tolerance),
                            "needs more than " + std::to_string(options.most_spheres) + " spheres for " +
                                bodies.names[i]);
            for (const anamorph::figure::Sphere& sphere : fill.spheres)
                add({sphere.center}, i, sphere.radius);
        }
    } else {
        const std::vector<Stick> sticks = this->Mode == AXES ? anamorph::figure::axis_sticks(bodies.shapes)
                                                             : sticks_from_joint_to_joint(bodies);
        for (const Stick& stick : sticks) {
            const auto body = static_cast<std::size_t>(stick.body);
            if (is_more_than_a_dot(body)) add({stick.from, stick.to}, body, 0);
        }
    }
    writer.write(vtkPolyData::SafeDownCast(output));
}

void vtkAnamorphFigureSkeleton::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    static const char* const modes[] = {"axes", "joints", "spheres"};
    os << indent << "Mode: " << modes[this->Mode] << "\n"
       << indent << "LevelOfDetail: " << this->LevelOfDetail << "\n"
       << indent << "Tolerance: " << this->Tolerance << "\n"
       << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
}
