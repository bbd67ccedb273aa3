// SPDX-License-Identifier: Apache-2.0
// Figures in VTK's data: a point for each ellipsoid, at its centre, with these arrays.
//
//     Axes           3 double   half the lengths along its own axes
//     Orientation    4 double   a quaternion w, x, y, z: turns its own axes into space
//     Color          3 unsigned char
//     Texture        a string   the name of its picture; empty where it has none
//     TextureOffset  2 double   texels
//     Name, Figure   strings    of the ellipsoid, and of the figure that it belongs to
//
// Field data: of each joint JointBodies (the points that it connects, 2 ids), JointPosition (3 double),
// JointName; and how the script is seen: ViewCenter (3 double), ViewRotation (9 double: the rows point to the
// right, up, and away).
//
// VTK's space is right-handed, and NUDES' is not: z is negated. So x goes to the right, y up and z towards
// the observer, and along -z VTK sees what NUDES shows.
#pragma once

#include <optional>
#include <vector>

#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/outline/outline_view.h"
#include "vtkType.h"

class vtkCellData;
class vtkDataArray;
class vtkPolyData;
class vtkUnsignedCharArray;

namespace anamorph_vtk {

/// Writes points and arrays as above. The cells are a vertex for each ellipsoid and, with `joints`, a line
/// for each joint, between the ellipsoids that it connects. `precision` is that of the points, as in
/// vtkAlgorithm.
void write_figures(const anamorph::figure::FigureFrame& frame, bool joints, int precision,
                   vtkPolyData* output);

/// Ellipsoids read back, in VTK's space. Throws Error where an array is missing or not as it should be; no
/// points need no arrays.
class FigureData {
  public:
    explicit FigureData(vtkPolyData* data);

    vtkIdType size() const { return m_size; }
    /// The ellipsoid of a point; nothing where a number is none, or the point is hidden (blanked). Its axes
    /// are not negative, its rotation is orthonormal.
    std::optional<anamorph::figure::Ellipsoid> ellipsoid(vtkIdType i) const;

  private:
    vtkPolyData* m_data;
    vtkIdType m_size = 0;
    vtkDataArray *m_axes = nullptr, *m_orientation = nullptr;
    vtkUnsignedCharArray* m_ghosts = nullptr;  ///< may be null
};

/// Makes room for what stands for the points: their arrays but Axes and Orientation, and but those that are
/// too short, to be copied by CopyData.
void allocate_cell_data(vtkPolyData* input, vtkIdType cells, vtkCellData* data);

/// The joints that the field data has, between points; those of points that are not there are left out.
std::vector<anamorph::figure::Joint> joints_of(vtkPolyData* data);

/// The view of a script, in which the window of 1000 units is `height` pixels high; the origin of the screen
/// is in its middle. Without the field data it is that of a script that does not set it.
anamorph::figure::View script_view(vtkPolyData* data, double height);

}  // namespace anamorph_vtk
