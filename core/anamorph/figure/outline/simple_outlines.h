// SPDX-License-Identifier: Apache-2.0
// Figures in fewer lines than their outlines: the levels of Fetter's series of men (a dot, sticks, boxes and contours, each about ten
// times as many points as the one before) and Willmert's elliptic cylinders, as Chapman 1986, sections 1.1 and 1.2, describes them.
//
// Errors. An ellipsoid is what |x| <= 1 becomes by its axes; its support function in a direction is |w|, w being the axes' shares of it.
// Shapes that stand for it are convex or have a convex hull, and the distance between convex sets is the largest difference of
// their support functions. So, in shares of |w|, which a projection turns into pixels:
//   box, half-axes times k       k |w|_1, from k to k sqrt(3): least at k = 2 / (1 + sqrt(3)), (sqrt(3) - 1) / (sqrt(3) + 1) = .268
//   cylinder along one axis      k (|w1| + |(w2, w3)|), from k to k sqrt(2): k = 2 / (1 + sqrt(2)), (sqrt(2) - 1) / (sqrt(2) + 1) = .172
//   n parallel contours          at latitudes h = pi / n apart, h / 2 from the poles: k cos(h / 2) to k: k = 2 / (1 + cos(h / 2)),
//                                tan(h / 4)^2
//   longest axis, a line         what is off it: the other two half-axes
//   centre, a dot                all of |w|
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/outline/outline_view.h"

namespace anamorph::figure {

/// The levels of detail of a figure, from least to most.
enum class FigureLevel : std::uint8_t { dot, sticks, boxes, contours, limbs };

/// The most contours of a body.
inline constexpr int kMostContours = 64;

/// A line of a shape, in space. `turned_away`: it is on the far side of the shape.
struct ShapeLine {
    glm::dvec3 from{0.0}, to{0.0};
    bool turned_away = false;
};

// How far the outline of what stands for a body may be from the body's own, in pixels; infinite where a part of either is no farther
// ahead than View::near. These are bounds, less sharp with perspective.
double dot_error(const Ellipsoid& body, const View& view);
double stick_error(const Ellipsoid& body, const View& view);
double box_error(const Ellipsoid& body, const View& view);
double contour_error(const Ellipsoid& body, const View& view, int contours);
double cylinder_error(const Ellipsoid& body, const View& view);

/// The fewest contours with which contour_error() is at most `most`; 0 where more than kMostContours would be needed.
int contours_for(const Ellipsoid& body, const View& view, double most);

/// A body's longest axis.
ShapeLine axis_line(const Ellipsoid& body);
/// The twelve edges of a body's box.
std::vector<ShapeLine> box_lines(const Ellipsoid& body, const View& view);
/// Chords of a body's contours, ellipses across its longest axis, which lie outside of the body; `tol`: of chords, in pixels.
std::vector<ShapeLine> contour_lines(const Ellipsoid& body, const View& view, int contours, double tol);

/// A dot that stands for all of a figure: in the middle of what its bodies cover on the screen, and how far from it these reach, in
/// pixels; infinite as dot_error() is.
struct FigureDot {
    glm::dvec2 at{0.0};
    double error = 0;
};
FigureDot figure_dot(const FigureFrame& frame, const View& view, std::size_t figure);

/// The level of each figure of a frame: the least one whose bodies are all off by at most `most` pixels.
std::vector<FigureLevel> figure_levels(const FigureFrame& frame, const View& view, double most);

/// A polyline on the screen, and the body that it belongs to.
struct CylinderLine {
    int body = 0;
    std::vector<glm::dvec2> points;
};

/// Willmert's body: of each elliptic cylinder its shadow lines, or its end ellipses where it has none; at ends that no joint has, the
/// outer part of the ellipse; at joints, side by side, clip and crease where two shadow lines cross, and else a circular arc
/// about the joint from the one farther from it to the other, extrapolated; a joint nearer to a body's middle than to its ends
/// connects nothing. Nothing hides anything. `tol`: of chords, in pixels.
/// Bodies that reach before View::near are left out, and named by `left_out`.
std::vector<CylinderLine> cylinder_lines(const FigureFrame& frame, const View& view, double tol,
                                         std::vector<int>& left_out);

}  // namespace anamorph::figure
