// SPDX-License-Identifier: Apache-2.0
// The triangles of a scene cut so that texture coordinates, interpolated linearly across each, paint it with a panorama
// (Kim 2003, chapter 4) within a tolerance that is proven (edge_rule.h), and cut along seams, faces and the panorama's
// borders. Every triangle is cut by itself, and neighbours fit: what is painted has no cracks. Where the panorama's border goes
// through, what is beside it may have corners more on a side than its neighbour, in line but for rounding.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "anamorph/projector/edge_rule.h"
#include "anamorph/projector/occluders.h"
#include "anamorph/projector/projector_rows.h"

namespace anamorph {

/// How a scene is painted with a panorama.
struct ProjectionOptions {
    double tol = kProjectionTolRow.standard;
    /// Edges as short as this, in units of the scene, are not split any further. About 2^-20 of the scene serves points in
    /// float.
    double smallest = 0;
    /// Are points of the scene kept in float? New points are then rounded to float.
    bool single = false;
    /// The triangles that stand between the projector and the scene, those of the scene included if it is to hide itself; null:
    /// nothing is hidden. They have to live as long as the painter. Triangles are cut along the borders of its shadows; what is left on the wrong side is narrower
    /// than an eighth of the tolerance, or of a texel if that is less, and what has no simpler shape is hidden as soon as
    /// it is as small as the tolerance, or a texel: nothing is hidden farther than that from a shadow.
    const Occluders* occluders = nullptr;
    /// The largest number of triangles; more are refused.
    std::int64_t most_triangles = std::int64_t{1} << 23;
};

/// How a piece of a triangle is painted.
enum class Painting {
    painted,      ///< it shows the panorama, with texels that are meant
    outside,      ///< it lies beside the panorama
    hidden,       ///< something stands between it and the projector
    no_direction  ///< it is next to the centre, or at the end of an axis where texels have no limit
};

/// A corner of a piece.
struct PaintedCorner {
    glm::dvec3 weights{0.0};  ///< weights of the triangle's corners; exactly 0 for those opposite of its edge
    glm::dvec3 point{0.0};    ///< in the scene
    Point<double> texel{};    ///< in pixels of the panorama, where painted
};

/// A piece of a triangle, with the orientation of the triangle.
struct PaintedTriangle {
    std::array<PaintedCorner, 3> corners;
    Painting painting = Painting::no_direction;
};

/// The numbers of pieces by their painting, of one triangle or of all.
struct PaintedCounts {
    std::int64_t painted = 0, outside = 0, hidden = 0, no_direction = 0;
    /// The largest bound of the error in use, in texels: proven, but for the rounding of double. For triangles about a pole
    /// it is the bound of their directions.
    double max_error = 0;

    /// Adds the counts, and keeps the larger error.
    PaintedCounts& operator+=(const PaintedCounts& other);
};

/// Paints the triangles of a scene with a panorama.
class ScenePainter {
  public:
    /// A painter of scenes for a projector. Throws Error where an option is out of its range.
    ScenePainter(const Projector& projector, const ProjectionOptions& options);

    /// Appends the pieces of a triangle to `to`. May be called from several threads at once. Throws Error where there are too
    /// many triangles, of all calls together.
    PaintedCounts paint(const std::array<glm::dvec3, 3>& triangle, std::vector<PaintedTriangle>& to) const;

    const Projector& projector() const { return m_projector; }

  private:
    Projector m_projector;
    ProjectionOptions m_options;
    EdgeRule m_rule;
    mutable std::atomic<std::int64_t> m_count{0};
};

}  // namespace anamorph
