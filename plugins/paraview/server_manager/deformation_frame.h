// SPDX-License-Identifier: Apache-2.0
// The rows of the property Deformations, and the places of their centres in space.
#pragma once

#include <array>
#include <optional>

class vtkSMProperty;
class vtkSMProxy;

namespace anamorph_paraview {

/// The columns of a row: c_u, c_v, a_u, a_v, V_x, V_y, V_z and what else there is.
constexpr unsigned int kCenter = 0, kExtent = 2, kVector = 4, kLeastColumns = 7;

unsigned int columns_of(vtkSMProperty* deformations);

using Point = std::array<double, 3>;

/// The plane of (u, v) in space: p = origin + u axes[0] + v axes[1] + t axes[2], the last a unit normal.
struct Frame {
    Point origin = {0, 0, 0};
    std::array<Point, 3> axes = {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}};

    Point point(double u, double v, double t) const;
    /// The parameters (u, v, t) of a point.
    Point parameters(const Point& point) const;
    /// Is a point over (u, v), within rounding?
    bool is_over(double u, double v, const Point& point) const;
    bool operator==(const Frame&) const = default;
};

/// The frame of a deform proxy: from its properties Origin, Axis1 and Axis2, or with AutomaticPlane as
/// vtkAnamorphDeform had it last, or would take it from bounds. For texture coordinates it touches the deformed surface at the
/// centre of the selected deformation, as the last update left it. None while
/// bounds are not known, or axes are parallel.
std::optional<Frame> frame_of(vtkSMProxy* deform);

/// Finds the bounds of the proxy's input; false if they are not known.
bool input_bounds(vtkSMProxy* deform, double bounds[6]);

}  // namespace anamorph_paraview
