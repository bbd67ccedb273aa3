// SPDX-License-Identifier: Apache-2.0
// Outlines as HIDE and VISIB write them for PLOTEL (Chapman 1986, section 2.4), `.2` files: text, whole numbers.
//
//     count number                         of ellipses, and the frame
//     x y  minor major  phi  arcs          for each ellipse: its centre and half-axes in units of the window, y up, the
//                                          direction of the minor axis in tenths of a degree, the number of hidden arcs
//     begin end                            for each of these, in tenths of a degree
//
// An arc's angle p, with a = p + 90 degrees, is at the point (x, y) + minor cos(a) u + major sin(a) v, where u is the direction of the
// minor axis and v that a quarter of a turn against the clock from it.
//
// What is not known of the originals is ours: numbers are rounded to the nearest (theirs lose what is behind the
// point); 0 <= phi <= 1800; 0 <= begin < end <= 3600, so that an arc over 3600 is two; one shorter than half a tenth of a degree may
// be left out; an ellipse that is hidden as a whole has the arc 0 3600; VISIB's ellipses have no arcs; every ellipsoid has its
// ellipse, in its place (HIDE leaves out those that lie wholly at z < 0); after the last frame the text ends. As there, there is no
// perspective.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/outline/drawing.h"
#include "anamorph/parallel_for.h"

namespace anamorph::figure {

/// The outline of an ellipsoid, in units of the window and degrees, its numbers not rounded yet or read from a file.
struct FlatEllipse {
    struct HiddenArc {
        double begin = 0, end = 0;
    };
    glm::dvec2 center{0.0};
    double minor = 0, major = 0, phi = 0;
    std::vector<HiddenArc> hidden;

    /// The point at an arc's angle.
    glm::dvec2 at(double angle) const;
};

/// The outlines of a frame.
struct EllipseFrame {
    int number = 0;
    std::vector<FlatEllipse> ellipses;
};

/// Outlines a frame in the window of 1000 by 1000 units. `hide`: with hidden arcs, as HIDE; else none, as VISIB. Throws Error as
/// outlines() does.
EllipseFrame ellipses_of(const FigureFrame& frame, bool hide, const ParallelFor& parallel_for = serial_for);

/// The record of a frame as text. Throws Error where a number does not fit a 32-bit integer.
std::string ellipse_text(const EllipseFrame& frame);

/// Reads all frames of a text. Throws Error naming the file and the line.
std::vector<EllipseFrame> parse_ellipses(std::string_view text, std::string_view name);

/// Draws what is not hidden, as PLOTEL does, on a page of `size` pixels either way that shows the window; chords are within `tol` pixels of
/// the ellipses. A stroke's body is the ellipse's number, from 1.
Drawing plotted(const EllipseFrame& frame, double size, double tol);

}  // namespace anamorph::figure
