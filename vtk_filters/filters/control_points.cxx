// SPDX-License-Identifier: Apache-2.0
#include "control_points.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "image_texture.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"

namespace anamorph_vtk {
namespace {

using anamorph::Error;

/// Different numbers in ascending order.
std::vector<double> lines_of(const std::vector<double>& numbers) {
    std::vector<double> lines = numbers;
    std::sort(lines.begin(), lines.end());
    lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
    return lines;
}

std::size_t place_in(const std::vector<double>& lines, double at) {
    return static_cast<std::size_t>(std::lower_bound(lines.begin(), lines.end(), at) - lines.begin());
}

}  // namespace

anamorph::ControlMesh control_mesh(vtkPointSet* points, vtkImageData* image, const int* extent) {
    vtkDataArray* coordinates = points->GetPointData()->GetTCoords();
    const auto count = static_cast<std::size_t>(points->GetNumberOfPoints());
    if (!coordinates || coordinates->GetNumberOfComponents() < 2)
        throw Error("the mesh has no texture coordinates: its points must have an array of them, u and v");
    if (coordinates->GetNumberOfTuples() != points->GetNumberOfPoints())
        throw Error("the mesh has " + std::to_string(coordinates->GetNumberOfTuples()) +
                    " texture coordinates: must have one for each of its " + std::to_string(count) +
                    " points");
    std::vector<double> across, down;
    for (std::size_t i = 0; i < count; ++i) {
        const auto id = static_cast<vtkIdType>(i);
        across.push_back(coordinates->GetComponent(id, 0));
        // Rows go down.
        down.push_back(1 - coordinates->GetComponent(id, 1));
        if (!std::isfinite(across[i]) || !std::isfinite(down[i]))
            throw Error("the texture coordinates of point " + std::to_string(i) +
                        " of the mesh must be finite");
    }
    const std::vector<double> columns = lines_of(across), rows = lines_of(down);
    if (columns.size() < 2 || rows.size() < 2 || columns.size() * rows.size() != count)
        throw Error("the mesh has " + std::to_string(count) + " points, " + std::to_string(columns.size()) +
                    " different u and " + std::to_string(rows.size()) +
                    " different v: must be a grid, with a point for every u with every v, at least 2 x 2");
    // Pixels from the upper left, whose centres are at halves.
    const int width = extent[1] - extent[0] + 1, height = extent[3] - extent[2] + 1;
    if (width < 2 || height < 2)
        throw Error("the image has " + std::to_string(width) + " x " + std::to_string(height) +
                    " pixels: must be at least 2 x 2, for a mesh to lie over them");
    anamorph::ControlMesh mesh;
    mesh.columns = static_cast<int>(columns.size()) - 1;
    mesh.rows = static_cast<int>(rows.size()) - 1;
    for (const double u : columns) mesh.x_lines.push_back(0.5 + u * (width - 1));
    for (const double v : rows) mesh.y_lines.push_back(0.5 + v * (height - 1));
    mesh.vertices.assign(count, {NAN, NAN});
    for (std::size_t i = 0; i < count; ++i) {
        double at[3];
        points->GetPoint(static_cast<vtkIdType>(i), at);
        const anamorph::Point<double> place = pixel_place(image, extent, at);
        if (!std::isfinite(place.x) || !std::isfinite(place.y))
            throw Error("point " + std::to_string(i) + " of the mesh must be finite");
        mesh.vertices[place_in(rows, down[i]) * columns.size() + place_in(columns, across[i])] = place;
    }
    for (const anamorph::Point<double>& vertex : mesh.vertices)
        if (std::isnan(vertex.x))
            throw Error("two points of the mesh have the same texture coordinates: must be a grid");
    return mesh;
}

}  // namespace anamorph_vtk
