// SPDX-License-Identifier: Apache-2.0
// Leads from a point of a surface that is seen near a place on the screen to the point that is seen there.
#pragma once

#include "anamorph/surface/camera.h"
#include "anamorph/surface/surface.h"

namespace anamorph::surface {

/// Finds points by Newton's method. Keeps references to its arguments; thread safe.
class PointPolish {
  public:
    PointPolish(const DrapedSurface& surface, const Camera& camera) : m_surface(surface), m_camera(camera) {}

    /// A point that was found.
    struct Polished {
        double u, v;
        double nearness;  ///< as FacetCorner::nearness
        double bound;     ///< bound of the distance on the screen from where it is seen to (x, y), in pixels
    };
    /// The derivatives of the place on the screen by u and v, over a box.
    struct Slopes {
        Interval u, v;  ///< the box
        Interval x_u, x_v, y_u, y_v;
    };

    /// Finds the point that is seen at (x, y), pixels from the middle of the screen, from one that is seen
    /// near by. The bound is infinite where none is found, or where it is not certain that the surface
    /// between both does not fold: there, with g' the derivatives of the place on the screen over the box
    /// that both span and Y = g'^-1 at the point, |1 - Y g'| < 1 (Krawczyk 1969), so that no other point of
    /// the box is seen at (x, y).
    /// `around`: slopes that many points may share; they are found for the box alone where that is not within, or they do not do.
    Polished polish(double x, double y, double u, double v, const Slopes* around = nullptr) const noexcept;

    /// Encloses g' over a box of the picture.
    Slopes slopes(const Interval& u, const Interval& v) const noexcept;

  private:
    struct Step;
    Step step(double x, double y, double u, double v) const noexcept;
    static bool contracts(const Step& step, const Slopes& slopes) noexcept;
    bool is_single(const Step& step, double u0, double v0, double u1, double v1,
                   const Slopes* around) const noexcept;

    const DrapedSurface& m_surface;
    const Camera& m_camera;
};

}  // namespace anamorph::surface
