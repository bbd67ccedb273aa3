// SPDX-License-Identifier: Apache-2.0
// The pull map of a reprojection: from a point of the target image through its ray, the camera's rotation and
// the source's lens to a point of the source image. Pixels, x right, y down, pixel centres at + 0.5.
#pragma once

#include <glm/mat3x3.hpp>

#include "anamorph/map/chart.h"

namespace anamorph {

/// Where the target's camera looks, in degrees: yaw to the right, pitch up, roll clockwise; the camera is
/// rolled first, then pitched, then turned.
struct Orientation {
    double yaw = 0, pitch = 0, roll = 0;
};

/// Rotation of rays: source ray = matrix * target ray (frame x right, y down, z forward).
glm::dmat3 rotation(const Orientation& orientation);

class Panorama {
  public:
    /// Throws Error when an angle is not finite.
    Panorama(const Chart& source, const Chart& target, const Orientation& orientation = {});

    const Chart& source() const { return m_source; }
    const Chart& target() const { return m_target; }

    /// The map about one point: a branch of either chart, and the rotation between their local rays.
    struct Local {
        Branch target, source;
        glm::dmat3 rotation;
    };
    /// For a neighbourhood of a target point.
    Local local_around(double x, double y, int piece) const;

    /// The source's local ray of a target point.
    template <class T>
    Ray<T> local_ray(const T& x, const T& y, const Local& local) const {
        return transform(local.rotation, m_target.local_ray(x, y, local.target));
    }

    /// The source point of a target point.
    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        return m_source.local_point(local_ray(x, y, local), local.source);
    }

    /// The source point of one target point, read with double or long double: the truth. False where the
    /// target point has no ray, or the source's lens does not see it.
    template <class T>
    bool exact(const T& x, const T& y, int piece, Point<T>& source_point, int& source_piece) const {
        if (!(m_target.inside(x, y, piece) >= 0)) return false;
        const Ray<T> r = transform(m_rotation, m_target.ray(x, y, piece));
        if (m_source.projection() == Projection::rectilinear && !(r.z > 0)) return false;
        source_piece = m_source.piece_of(r);
        source_point = m_source.point(r, source_piece);
        return std::isfinite(source_point.x) && std::isfinite(source_point.y);
    }

  private:
    Chart m_source, m_target;
    glm::dmat3 m_rotation;
};

}  // namespace anamorph
