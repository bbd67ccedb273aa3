// SPDX-License-Identifier: Apache-2.0
// The facts of a projection besides its formulas.
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <vector>

#include "anamorph/number/hypot.h"
#include "anamorph/number/rounded.h"

namespace anamorph {

/// An angle from which others are counted. The angle is taken to be exact; cos and sin have an error of at most `error`.
struct Heading {
    double angle = 0, cos = 1, sin = 0, error = 0;

    /// The error of cos and sin of an angle from atan2. atan2 is off by its error in libm, of pi at most, and so is the
    /// direction that it stands for; hypot by as much again at most and a quotient by half a ULP, of 1 at most.
    static constexpr double kError = 6 * interval_detail::kLibmError;

    Heading() = default;
    /// Constructs the heading of the point (x, y); that of angle 0 for the origin and for points that are not finite.
    Heading(double y, double x) {
        const double r = hypot(x, y);
        if (!(r > 0 && r < HUGE_VAL)) return;
        angle = std::atan2(y, x);
        cos = x / r;
        sin = y / r;
        error = kError;
    }
};

/// The numbers d and e of projections that have some, such as the distance d of the Pannini projection, and constants that
/// formulas compute from them.
struct Distance {
    double d, e;
    Constant per_sum;                    ///< 1 / (d + 1)
    Constant less_square;                ///< 1 - d^2
    Constant rest, difference, product;  ///< 1 - e, 1 - 2 e, e (1 - e)

    Distance(double distance = 1, double second = kSecond)  // NOLINT: the number is the distance
        : d(distance),
          e(second),
          per_sum(1 / (1 + DoubleDouble(d))),
          less_square((1 - DoubleDouble(d)) * (1 + DoubleDouble(d))),
          rest(1 - DoubleDouble(e)),
          difference(1 - 2 * DoubleDouble(e)),
          product(e * (1 - DoubleDouble(e))) {}

    /// The second number unless it is said.
    static constexpr double kSecond = 0.5;
};

/// The arguments of a projection's formulas besides the point: the direction from which angles are counted (`around` is
/// the azimuth, or the angle about the axis of a fisheye; `along` the elevation, or the angle from that axis), and the
/// choices of a chart. A neighbourhood of that direction meets no seam, and intervals stay narrow there; nothing else
/// depends on it.
struct Setting {
    Heading around, along;
    double half_width = 0;              ///< half the width of the plane that the picture, or a face, covers
    double centre_x = 0, centre_y = 0;  ///< the centre of the piece in the plane
    double reach = 1;                   ///< the largest tangent that is seen, where not all can be
    Distance distance;                  ///< the numbers d and e of projections that have some
};

/// The angles that a projection's formulas count.
enum class Counted {
    none,
    azimuth,  ///< azimuth and elevation: a local ray is turned about the vertical axis
    axis      ///< angles about and from the axis of sight: a local ray is turned about that axis
};

/// The default and the largest horizontal field of view of a projection, in degrees, edge to edge.
struct FieldOfView {
    double standard, most;
    bool open = false;   ///< `most` itself is not allowed
    bool fixed = false;  ///< only `standard` is allowed
};

/// The distortion that a picture of a projection may have (chart/lens.h): that of a flat picture, of one whose radius is the
/// angle from the axis, of a stereographic one, of another one with an axis, or none.
enum class Lensed { no, flat, equidistant, stereographic, axial };

/// A face of a layout of several: its axes (right, down, forward) as columns, and its place in the layout. A ray
/// belongs to the face whose `toward` it is nearest to.
struct Face {
    glm::dmat3 axes;
    int column, row;
    glm::dvec3 toward = axes[2];
};

/// The axes of the faces of a cube: six upright as seen from inside, the upper and lower one hinged to the front.
namespace faces {
inline const glm::dmat3 kRight(0, 0, -1, 0, 1, 0, 1, 0, 0);
inline const glm::dmat3 kLeft(0, 0, 1, 0, 1, 0, -1, 0, 0);
inline const glm::dmat3 kUp(1, 0, 0, 0, 0, 1, 0, -1, 0);
inline const glm::dmat3 kDown(1, 0, 0, 0, 0, -1, 0, 1, 0);
inline const glm::dmat3 kFront(1, 0, 0, 0, 1, 0, 0, 0, 1);
inline const glm::dmat3 kBack(-1, 0, 0, 0, 1, 0, 0, 0, -1);
}  // namespace faces

}  // namespace anamorph
