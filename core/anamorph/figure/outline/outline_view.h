// SPDX-License-Identifier: Apache-2.0
// The view of a scene: orthographic as in NUDES, or in perspective.
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "anamorph/figure/body/frame.h"

namespace anamorph::figure {

/// How an observer sees a scene.
///
/// The observer looks along +z of q = rotation (p - center), with x to the right and y up: a smaller q.z is
/// nearer. On the screen, in pixels with y up, p lies at middle + scale (q.x, q.y), in perspective at
/// middle + scale (q.x, q.y) eye_distance / (q.z + eye_distance): `center` is seen at `middle`, and what is
/// as far away as it in the same size.
struct View {
    glm::dmat3 rotation{1.0};        ///< orthonormal; it may mirror
    glm::dvec3 center{0.0};          ///< units of the scene
    glm::dvec2 middle{0.0};          ///< pixels
    double scale = 1;                ///< pixels a unit of the scene; positive
    double eye_distance = HUGE_VAL;  ///< from the eye to `center`, units of the scene; infinite: orthographic
    /// The distance of the near plane from the eye, in units of the scene, positive: in perspective nothing nearer than
    /// that is drawn.
    double near = 1;

    bool perspective() const { return eye_distance < HUGE_VAL; }
    /// The point q of a point p of the scene; in perspective relative to the eye, so that q.z is the depth.
    glm::dvec3 to_view(const glm::dvec3& p) const {
        const glm::dvec3 q = rotation * (p - center);
        return perspective() ? q + glm::dvec3(0, 0, eye_distance) : q;
    }
    /// The point on the screen, in pixels, of a point q as to_view() gives it.
    glm::dvec2 to_screen(const glm::dvec3& q) const {
        const double zoom = perspective() ? scale * eye_distance / q.z : scale;
        return middle + glm::dvec2(zoom * q.x, zoom * q.y);
    }
    /// The point on the screen, in pixels, of a point of the scene.
    glm::dvec2 project(const glm::dvec3& p) const { return to_screen(to_view(p)); }
};

/// The view of a frame in the window of NUDES: 1000 by 1000 units with the origin at its lower left, about the frame's
/// place, `scale` pixels a unit.
inline View view_of(const FigureFrame& frame, double scale = 1) {
    View view;
    view.rotation = frame.observer;
    view.center = frame.place;
    view.middle = glm::dvec2(500 * scale);
    view.scale = scale;
    return view;
}

/// The window of NUDES in the middle of a picture of `size` pixels, as large as fits.
inline View view_in(const FigureFrame& frame, const glm::dvec2& size) {
    View view = view_of(frame, (size.x < size.y ? size.x : size.y) / 1000);
    view.middle = 0.5 * size;
    return view;
}

/// Checks a view. Throws Error naming the field of `view` that is out of its range.
void check(const View& view);

}  // namespace anamorph::figure
