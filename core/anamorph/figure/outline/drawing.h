// SPDX-License-Identifier: Apache-2.0
// A frame as strokes on a page, which all formats draw.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/outline/outline_style.h"
#include "anamorph/figure/outline/outline_view.h"
#include "anamorph/figure/outline/viewport.h"
#include "anamorph/parallel_for.h"
#include "anamorph/parameter/number_row.h"

namespace anamorph::figure {

/// How hidden lines are drawn: not at all, dashed, or like visible ones, as if bodies were transparent.
enum class HiddenLines { remove, dash, draw };
/// The sticks that are drawn instead of outlines: none, the longest axis of each body, or lines from joint to joint.
enum class Sticks { none, axes, joints };

// The numbers that users set of drawings, beside those of figure_rows.h.
/// The maximum chord error, in pixels. Files have four decimals, whose rounding is less than a hundredth of the
/// least tolerance.
inline constexpr NumberRow kDrawingTolRow{"tol", kOutlineTolRow.standard, 0.01};
/// The width of lines, in pixels.
inline constexpr NumberRow kLineWidthRow{"line-width", 1, 0.01, 1000};
/// The width of the gap on either side of a nearer line, in pixels.
inline constexpr NumberRow kHaloRow{"halo", 0, 0, 1000};

/// How far Fetter's levels, and contours, may be from bodies' outlines, in pixels.
inline constexpr NumberRow kSimpleTolRow{"simple-tol", 1, 0.001, 1e6};

/// How a frame is drawn.
struct DrawingOptions {
    HiddenLines hidden = HiddenLines::remove;
    Sticks sticks = Sticks::none;
    OutlineStyle style = OutlineStyle::limbs;  ///< fewer lines than outlines, with an error that is stated
    double simple_tol =
        kSimpleTolRow.standard;  ///< of levels and contours: how far they may be off, chords included; pixels
    bool crossings = false;      ///< also the curves in which bodies pass through each other
    double lod = kLevelOfDetailRow.standard;  ///< bodies no wider are dots and lines; pixels
    double tol = kDrawingTolRow.standard;  ///< maximum chord error, of simple_tol a quarter at most; pixels
    double line_width = kLineWidthRow.standard;  ///< pixels
    double halo = kHaloRow.standard;             ///< the gap on either side of a nearer line, in pixels
    bool colors = false;                         ///< lines have the colors of the bodies; else black
    bool fill = false;                           ///< bodies are filled with their colors, from far to near
    std::optional<Viewport> viewport;  ///< what is drawn of lines and fills; of lines, their middles
};

/// The kind of a stroke: what it stands for.
enum class StrokeKind { visible, hidden, stick, dot, fill };

/// A line on the page, or the closed line around what is filled.
struct Stroke {
    StrokeKind kind = StrokeKind::visible;
    std::vector<glm::dvec2> points;  ///< on the page, pixels from its upper left, y down; a dot has one point
    std::string body;                ///< the name of the body that the stroke belongs to
    glm::dvec3 color{0};             ///< red, green and blue, 0 to 255
    double depth = 0;
    int position = -1;  ///< position of the body in the frame
    /// The parts of the line beside which there is a gap, where gaps are drawn: all of the line, except where the line of a
    /// body joined to this one ends at it.
    std::vector<std::vector<glm::dvec2>> halo;
};

/// A frame on a page.
struct Drawing {
    int frame = 0;
    glm::dvec2 size{0.0};  ///< size of the page, in pixels
    double line_width = 1, halo = 0;
    bool simple = false;  ///< are there lines that stand for bodies' outlines?
    /// How far lines are from bodies' outlines, at most, be they these or what stands for them, chords included; pixels.
    double max_error = 0;
    std::vector<int>
        left_out;  ///< bodies that Willmert's cylinders do not show, as they reach before View::near
    std::vector<Stroke> strokes;  ///< fills, then hidden strokes, then the others; each from far to near
};

/// Draws a frame as `view` sees it, on a page of `size` pixels whose lower left corner is the origin of the view's
/// screen. Throws Error as outlines() and levels_of_detail() do.
Drawing draw(const FigureFrame& frame, const View& view, const glm::dvec2& size,
             const DrawingOptions& options, const ParallelFor& parallel_for = serial_for);

}  // namespace anamorph::figure
