// SPDX-License-Identifier: Apache-2.0
// What is said of a projection besides its formulas.
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <vector>

#include "anamorph/number/rounded.h"

namespace anamorph {

/// An angle from which others are counted. The angle is the truth; cos and sin are off by `error` at most.
struct Heading {
    double angle = 0, cos = 1, sin = 0, error = 0;

    /// atan2 is off by its error in libm, of pi at most, and so is the direction that it stands for; hypot by
    /// as much again at most and a quotient by half a ULP, of 1 at most.
    static constexpr double kError = 6 * interval_detail::kLibmError;

    Heading() = default;
    /// The angle of (x, y); 0 for the origin and for what is not finite.
    Heading(double y, double x) {
        const double r = std::hypot(x, y);
        if (!(r > 0 && r < HUGE_VAL)) return;
        angle = std::atan2(y, x);
        cos = x / r;
        sin = y / r;
        error = kError;
    }
};

/// Pannini's distance d, and constants that formulas make of it.
struct Distance {
    double d;
    Constant per_sum;      ///< 1 / (d + 1)
    Constant less_square;  ///< 1 - d^2

    Distance(double distance = 1)  // NOLINT: the number is the distance
        : d(distance), per_sum(1 / (1.0L + d)), less_square((1.0L - d) * (1.0L + d)) {}
};

/// What the formulas of a projection are read with besides the point: the direction from which angles are
/// counted (`around` is the azimuth, or the angle about the axis of a fisheye; `along` the elevation, or the
/// angle from that axis), and what a chart has chosen. A neighbourhood of that direction meets no seam, and
/// intervals stay narrow there; nothing else depends on it.
struct Setting {
    Heading around, along;
    double half_width = 0;              ///< of the plane that the picture, or one of its faces, covers
    double centre_x = 0, centre_y = 0;  ///< of the piece in the plane
    double reach = 1;                   ///< the largest tangent that is seen, where not all can be
    Distance distance;                  ///< of Pannini
};

/// Which angles a projection's formulas count.
enum class Counted {
    none,
    azimuth,  ///< and elevation: a local ray is turned about the vertical axis
    axis      ///< about and from the axis of sight: a local ray is turned about that axis
};

/// Horizontal field of view in degrees, edge to edge.
struct FieldOfView {
    double standard, most;
    bool open = false;   ///< `most` itself is not allowed
    bool fixed = false;  ///< there is only the standard one
};

/// What distortion a picture of a projection may have (chart/lens.h): one of a flat picture, of one whose radius is the
/// angle from the axis, of another with an axis, or none.
enum class Lensed { no, flat, equidistant, axial };

/// A face of a layout of several: its axes (right, down, forward) as columns, and where it stands. A ray
/// belongs to the face whose `toward` it is nearest to.
struct Face {
    glm::dmat3 axes;
    int column, row;
    glm::dvec3 toward = axes[2];
};

/// Faces by their axes: six upright as seen from inside, the upper and lower one hinged to the front.
namespace faces {
inline const glm::dmat3 kRight(0, 0, -1, 0, 1, 0, 1, 0, 0);
inline const glm::dmat3 kLeft(0, 0, 1, 0, 1, 0, -1, 0, 0);
inline const glm::dmat3 kUp(1, 0, 0, 0, 0, 1, 0, -1, 0);
inline const glm::dmat3 kDown(1, 0, 0, 0, 0, -1, 0, 1, 0);
inline const glm::dmat3 kFront(1, 0, 0, 0, 1, 0, 0, 0, 1);
inline const glm::dmat3 kBack(-1, 0, 0, 0, 1, 0, 0, 0, -1);
}  // namespace faces

}  // namespace anamorph
