// SPDX-License-Identifier: Apache-2.0
// The pull map of a reprojection: from a point of the target image through its ray, the camera's rotation and
// the source's lens to a point of the source image. Pixels, x right, y down, pixel centres at + 0.5.
#pragma once

#include <glm/mat3x3.hpp>

#include "anamorph/map/chart.h"

namespace anamorph {

/// Where the target's camera looks, in degrees: yaw to the right, pitch up, roll clockwise; the camera is rolled
/// first, then pitched, then turned.
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

    /// The source's ray of a target point.
    template <class T>
    Ray<T> ray(const T& x, const T& y, int piece) const
    {
        const Ray<T> r = m_target.ray(x, y, piece);
        const auto row = [&](int i) {
            return r.x * m_rotation[0][i] + r.y * m_rotation[1][i] + r.z * m_rotation[2][i];
        };
        return {row(0), row(1), row(2)};
    }

    /// The source point of a target point on a given branch of the source's chart.
    template <class T>
    Point<T> operator()(const T& x, const T& y, int piece, const Branch& branch) const
    {
        return m_source.point(ray(x, y, piece), branch);
    }

    /// The source point of one target point, read with double or long double: the truth. False where the target
    /// point has no ray, or the source's lens does not see it.
    template <class T>
    bool exact(const T& x, const T& y, int piece, Point<T>& source_point, int& source_piece) const
    {
        if (!(m_target.inside(x, y, piece) >= 0)) return false;
        const Ray<T> r = ray(x, y, piece);
        const Branch branch = m_source.branch_of(r);
        const T seen = m_source.sees(r, branch);
        if (!(seen >= 0) || (seen == 0 && m_source.projection() == Projection::rectilinear)) return false;
        source_piece = branch.piece;
        source_point = m_source.point(r, branch);
        return std::isfinite(source_point.x) && std::isfinite(source_point.y);
    }

private:
    Chart m_source, m_target;
    glm::dmat3 m_rotation;
};

}  // namespace anamorph
