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

/// The field of view about a direction of projection, and the size of its table of residuals.
struct GroupOptions {
    double x_max = 1, y_max = 1;  ///< |x'| and |y'| go up to these: 1 is 45 degrees
    int columns = 256;            ///< nodes of the table across, from border to border
    int rows = 256;               ///< nodes of the table down
};

/// A direction of projection with its linear part and residuals.
struct ProjectionGroup {
    glm::dmat3 axes{1};  ///< e, f and d in the frame of rays (chart/chart.h), as columns
    /// The matrix of the linear part: its product with a ray r is (x r . d, y r . d, r . d), with the texel (x, y).
    glm::dmat3 linear{1};
    std::vector<std::array<float, 2>> residuals;  ///< texels, in rows from y' = -y_max, x' = -x_max
    /// A proven bound, in texels, of the distance of the sum of both from the panorama's formula; infinite where unknown.
    double bound = 0;
    double linear_error = 0;  ///< the largest residual of the table, in texels
};

/// The directions of projection of a projector, with their tables.
class ProjectionGroups {
  public:
    /// `directions`: in the frame of rays, of any length, but not along y, which goes downwards in every projection plane.
    /// Texels go on across the seam of a closed panorama, so that readers have to repeat it. Throws Error on options or
    /// directions out of range.
    ProjectionGroups(const Projector& projector, const std::vector<glm::dvec3>& directions,
                     const GroupOptions& options = {});

    /// Returns `count` level directions all around. Any geometry whose azimuths differ by no more than
    /// 2 atan(x_max) - 2 pi / count is then in the field of view of one of them.
    static std::vector<glm::dvec3> level_directions(int count);

    /// The groups, in the order of the directions.
    const std::vector<ProjectionGroup>& groups() const { return m_groups; }
    /// The options that it was made with.
    const GroupOptions& options() const { return m_options; }

    /// The group in whose field of view a triangle of the scene lies, of several the one with the triangle nearest to its
    /// middle; -1 where it lies in none and has to be cut.
    int group_of(const std::array<glm::dvec3, 3>& triangle) const;
    /// Finds the texel of a point of the scene by a group: the linear part plus the table's residual. False where the point is
    /// not in the group's field of view.
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
