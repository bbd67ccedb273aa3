// SPDX-License-Identifier: Apache-2.0
// Ellipsoids read for drawing, and lines that stand for them.
#pragma once

#include <string>
#include <vector>

#include "figure_data.h"
#include "vtkCellArray.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"

class vtkPolyData;

namespace anamorph_vtk {

/// The ellipsoids of a data set whose numbers are finite, with the points that they stand at. Throws Error as
/// FigureData does.
struct Bodies {
    explicit Bodies(vtkPolyData* data);

    std::vector<anamorph::figure::Ellipsoid> shapes;
    std::vector<vtkIdType> ids;
    std::vector<std::string> names;               ///< names for messages
    std::vector<anamorph::figure::Joint> joints;  ///< joints between positions in `shapes`
};

/// Collects polylines and vertices. Each has the arrays of the point of the input that it stands for but Axes
/// and Orientation, BodyId, and numbers of its own.
class LineWriter {
  public:
    LineWriter(vtkPolyData* input, int precision, std::vector<const char*> names);

    /// Adds a polyline; a single point is a vertex. A last point equal to the first closes the line.
    void add(const std::vector<glm::dvec3>& points, vtkIdType body, const std::vector<double>& numbers);
    void write(vtkPolyData* output);

  private:
    struct Cells {
        vtkNew<vtkCellArray> cells;
        std::vector<vtkIdType> bodies;
        std::vector<std::vector<double>> numbers;
    };

    vtkPolyData* m_input;
    std::vector<const char*> m_names;
    vtkNew<vtkPoints> m_points;
    Cells m_vertices, m_lines;
};

}  // namespace anamorph_vtk
