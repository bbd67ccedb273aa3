// SPDX-License-Identifier: Apache-2.0
// Rows of the property Deformations, and where their centres are in space.
#pragma once

#include <array>
#include <optional>

class vtkSMProperty;
class vtkSMProxy;

namespace anamorph_paraview {

/// A row: c_u, c_v, a_u, a_v, V_x, V_y, V_z and what else there is.
constexpr unsigned int kCenter = 0, kExtent = 2, kVector = 4, kLeastColumns = 7;

unsigned int columns_of(vtkSMProperty* deformations);

using Point = std::array<double, 3>;

/// The plane of (u, v) in space: p = origin + u axes[0] + v axes[1] + t axes[2], the last a unit normal.
struct Frame {
    Point origin = {0, 0, 0};
    std::array<Point, 3> axes = {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}};

    Point point(double u, double v, double t) const;
    /// (u, v, t) of a point.
    Point parameters(const Point& point) const;
    /// Is a point over (u, v), within rounding?
    bool is_over(double u, double v, const Point& point) const;
    bool operator==(const Frame&) const = default;
};

/// The frame of a deform proxy: from its properties Origin, Axis1 and Axis2, or with AutomaticPlane as
/// vtkAnamorphDeform had it last, or would take it from bounds. Of texture coordinates: x-y. None while
/// bounds are not known, or axes are parallel.
std::optional<Frame> frame_of(vtkSMProxy* deform);

/// The bounds of its input; false if they are not known.
bool input_bounds(vtkSMProxy* deform, double bounds[6]);

}  // namespace anamorph_paraview
