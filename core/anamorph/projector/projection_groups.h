// SPDX-License-Identifier: Apache-2.0
// A panorama's projection as graphics hardware evaluates it (Kim 2003, 4.2 to 4.4): about a direction of projection, as a
// linear part that a matrix and a division make, and a table of residuals that is read bilinearly. Geometry is grouped by
// the direction within whose field of view it lies.
//
// Across a direction d, with e to the right and f downwards, a ray has the coordinates x' = r . e / r . d, y' = r . f / r . d
// on the projection plane. A residual is what eq. 4.2 is beyond the linear part. Linear parts cancel in what interpolation
// in a cell of h_x by h_y is off: |F_xx| h_x^2 / 8 + |F_yy| h_y^2 / 8 at most, as it goes along one axis and then along the
// other; second derivatives by jets of intervals over each cell.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/projector/projector.h"

namespace anamorph {

/// The field of view about a direction of projection, and its table.
struct GroupOptions {
    double x_max = 1, y_max = 1;  ///< |x'| and |y'| go up to these: 1 is 45 degrees
    int columns = 256;            ///< of the table: its nodes go from border to border
    int rows = 256;               ///< of the table
};

/// A direction of projection with its linear part and residuals.
struct ProjectionGroup {
    glm::dmat3 axes{1};  ///< e, f and d in the frame of rays (chart/chart.h), as columns
    /// Times a ray: texel x and y of the linear part, both times r . d, and r . d. Rows go to these, as with GLM's product.
    glm::dmat3 linear{1};
    std::vector<std::array<float, 2>> residuals;  ///< texels, in rows from y' = -y_max, x' = -x_max
    double bound =
        0;  ///< texels: how far the sum of both is from the panorama's formula, proven; infinite where unknown
    double linear_error = 0;  ///< texels: the largest residual of the table
};

/// Directions of projection for a projector.
class ProjectionGroups {
  public:
    /// `directions` in the frame of rays; any length, but not along y, which goes downwards in every projection plane.
    /// Texels go on across the seam of a closed panorama: readers repeat it. Throws Error.
    ProjectionGroups(const Projector& projector, const std::vector<glm::dvec3>& directions,
                     const GroupOptions& options = {});

    /// Directions all around, level and so many. Any geometry whose azimuths differ by no more than
    /// 2 atan(x_max) - 2 pi / count is then within one of them.
    static std::vector<glm::dvec3> level_directions(int count);

    /// The groups, in the order of the directions.
    const std::vector<ProjectionGroup>& groups() const { return m_groups; }
    /// The options that it was made with.
    const GroupOptions& options() const { return m_options; }

    /// The group that a triangle of the scene lies in, the one with it nearest to its middle; -1 where it has to be cut.
    int group_of(const std::array<glm::dvec3, 3>& triangle) const;
    /// The texel that a group finds for a point of the scene: the linear part and the table's residual. False where the
    /// point is not in its field of view.
    bool texel(int group, const glm::dvec3& point, Point<double>& at) const;

  private:
    bool on_plane(const ProjectionGroup& group, const glm::dvec3& point, glm::dvec2& at) const;
    ProjectionGroup make_group(const glm::dvec3& direction) const;
    void set_linear(ProjectionGroup& group, const Branch& branch) const;
    void set_residuals(ProjectionGroup& group, const Branch& branch) const;

    Projector m_projector;
    GroupOptions m_options;
    std::vector<ProjectionGroup> m_groups;
};

}  // namespace anamorph
