// SPDX-License-Identifier: Apache-2.0
// Connected outlines: strokes that lead the outline of a body over to that of its neighbour at a joint, as
// Willmert's straight connections do: here along the common tangents, so that both together show their hull.
#pragma once

#include <span>
#include <vector>

#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/outline/outline.h"
#include "anamorph/parallel_for.h"

namespace anamorph::figure {

/// A stroke along a common tangent of two limbs, from its point of contact with the first body's limb to its point of
/// contact with the second's.
struct ConnectingStroke {
    double first_angle = 0, second_angle = 0;  ///< angles of the points of contact on the limbs, in radians
    SeenLine line;                             ///< the stroke in space; its two bodies do not hide it
};

/// The connection of two outlines: without the arcs inside and with the strokes, they are the outline of both bodies'
/// hull on the screen.
struct Connection {
    int first = 0, second = 0;              ///< positions of the bodies
    std::vector<ConnectingStroke> strokes;  ///< two as a rule; none where one outline is around the other
    std::vector<Arc> first_inside, second_inside;  ///< the arcs of the limbs inside the hull
};

/// Finds a connection for each joint whose bodies' outlines are both of kind `whole`. `outlines` are those of
/// `bodies` in `view`. Throws Error as outlines() does, and for a joint of bodies that are not there.
std::vector<Connection> connections(std::span<const Joint> joints, std::span<const Ellipsoid> bodies,
                                    const Outlines& outlines, const View& view,
                                    const ParallelFor& parallel_for = serial_for);
/// Finds the connections of a frame, for its own joints and bodies.
std::vector<Connection> connections(const FigureFrame& frame, const Outlines& outlines, const View& view,
                                    const ParallelFor& parallel_for = serial_for);

}  // namespace anamorph::figure
