// SPDX-License-Identifier: Apache-2.0
// Ellipsoids in outline, hidden lines removed.
//
// The limb of an ellipsoid, where view rays touch it, is an ellipse in space. A point of it is hidden where
// the view ray meets the surface of another body between the eye and the point: behind a body, or inside one.
// Arcs are angles on the limb, in radians. Accuracy: limb points lie within 1e-9 of their body's size on the
// limb; the ends of arcs are exact to rounding.
//
// Negative half-axes mean their absolute values. Bodies without volume are outlined too: a disc (one axis
// zero) hides what is behind it, a line or a point (two or three) hides nothing. A body around the eye has no
// limb and hides what is outside it. Bodies that coincide do not hide each other.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/body/ellipse.h"
#include "anamorph/figure/body/ellipsoid.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/outline/outline_view.h"
#include "anamorph/parallel_for.h"

namespace anamorph::figure {

/// Angles from `begin` to `end`, radians: 0 <= begin < 2 pi, begin < end <= begin + 2 pi.
struct Arc {
    double begin = 0, end = 0;

    double length() const { return end - begin; }
    bool operator==(const Arc&) const = default;
};

/// The place of a limb as seen by the observer.
enum class OutlineKind : std::uint8_t {
    whole,       ///< the limb lies before the observer
    cut,         ///< in perspective: part of the limb is nearer than View::near, or behind the eye
    behind,      ///< in perspective: all of the limb is nearer than View::near, or behind the eye
    around_eye,  ///< in perspective: the eye is inside the body
};

/// The limb of a body, and which arcs of it are seen.
struct Outline {
    OutlineKind kind = OutlineKind::whole;
    Ellipse<glm::dvec3> limb;    ///< in the scene; arcs are angles on it
    Ellipse<glm::dvec3> viewed;  ///< the limb as View::to_view sees it, angle for angle
    /// The limb on the screen, in pixels; set for kind `whole` only. In perspective its angles are those of screen_angle().
    Ellipse<glm::dvec2> screen;
    std::vector<Arc> visible, hidden;  ///< sorted, disjoint; together all of the limb but what `near` cuts

    /// The point on the screen, in pixels, of the limb's point at `angle`.
    glm::dvec2 on_screen(double angle, const View& view) const { return view.to_screen(viewed(angle)); }
    /// The angle on `screen` of the limb's point at `angle`, in radians.
    double screen_angle(double angle, const View& view) const;
    /// The angle on the limb of the point at `screen_angle` of `screen`.
    double limb_angle(double screen_angle, const View& view) const;
};

/// The curve in which the surfaces of two bodies meet, as a polyline: one closed loop of it.
struct CrossingCurve {
    int first = 0, second = 0;       ///< positions of the bodies
    std::vector<glm::dvec3> points;  ///< in the scene, on both surfaces; the last is joined to the first
    /// The visible and the hidden parts of the polyline: 2.25 is the point a quarter of the way from points[2] to
    /// points[3]. They are like arcs, with the number of points for 2 pi. Their ends are found on the curve itself, and on
    /// the polyline lie beside those. Parts shorter than a sixteenth of tol may be missed.
    std::vector<Arc> visible, hidden;
};

/// A rectangle of the screen, in pixels.
struct ScreenWindow {
    glm::dvec2 low{-HUGE_VAL}, high{HUGE_VAL};
};

/// The curves that are outlined, and how exactly.
struct OutlineOptions {
    bool hide = true;                      ///< false: bodies are transparent, as VISIB draws them
    bool crossings = false;                ///< also the curves in which bodies pass through each other
    bool keep_hidden = true;               ///< false: curves of which nothing is seen are left out
    double tol = kOutlineTolRow.standard;  ///< maximum chord error of those curves, in pixels
    /// What of the screen is looked at: a limb whose image lies wholly outside has neither visible nor hidden arcs. Its body hides
    /// what is behind it nevertheless.
    ScreenWindow window;
    /// The names of the bodies for messages; where it is empty, messages give their positions.
    std::vector<std::string> names;
};

/// The outlines of a scene.
struct Outlines {
    std::vector<Outline> bodies;  ///< one for each body, in their order
    std::vector<CrossingCurve> crossings;
};

/// Outlines bodies in a view. Throws Error when a body has a value that is not finite or larger than 1e25, or axes of rotation that are
/// not orthonormal to 1e-6 (naming the body), and when the view or an option is out of its range.
Outlines outlines(std::span<const Ellipsoid> bodies, const View& view, const OutlineOptions& options = {},
                  const ParallelFor& parallel_for = serial_for);
/// Outlines the bodies of a frame; messages call them by their names.
Outlines outlines(const FigureFrame& frame, const View& view, OutlineOptions options = {},
                  const ParallelFor& parallel_for = serial_for);

/// Finds angles from arc.begin to arc.end between which chords stay within `tol` pixels of the limb's image on the
/// screen. Throws Error when tol is out of the range of kOutlineTolRow, or asks for more than a million chords.
std::vector<double> chord_angles(const Outline& outline, const Arc& arc, const View& view, double tol);
/// The points on the screen, in pixels, at the angles that chord_angles() finds.
std::vector<glm::dvec2> chords(const Outline& outline, const Arc& arc, const View& view, double tol);

/// A straight line in the scene, and how much of it is seen: parts as arcs with 0 at `from` and 1 at `to`.
/// What View::near cuts is in neither list.
struct SeenLine {
    glm::dvec3 from{0.0}, to{0.0};
    std::vector<Arc> visible, hidden;
};

/// Finds the parts of lines that bodies hide. `ignored[i]`, where given, lists bodies that do not hide line i.
/// Throws Error as outlines() does, and when an end of a line is not finite or larger than 1e25.
void hide_lines(std::span<SeenLine> lines, std::span<const Ellipsoid> bodies, const View& view,
                const std::vector<std::vector<int>>& ignored = {},
                const ParallelFor& parallel_for = serial_for);

}  // namespace anamorph::figure
