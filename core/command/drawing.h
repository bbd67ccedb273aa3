// SPDX-License-Identifier: Apache-2.0
// A frame as strokes on a page, which all formats draw.
#pragma once

#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/figure_rows.h"
#include "anamorph/figure/frame.h"
#include "anamorph/number_row.h"
#include "anamorph/parallel_for.h"

namespace anamorph::command {

enum class Hidden { remove, dash, draw };
enum class Sticks { none, axes, joints };

/// The numbers that users set of drawings, beside those of figure_rows.h. Files have four decimals, whose
/// rounding is less than a hundredth of the least tolerance.
inline constexpr NumberRow kTolRow{"tol", kOutlineTolRow.standard, 0.01};
inline constexpr NumberRow kSizeRow{"size", 500, 1, 16384};
inline constexpr NumberRow kPerspectiveRow{"perspective", NAN, 1e-3, 1e9};
inline constexpr NumberRow kLineWidthRow{"line-width", 1, 0.01, 1000};
inline constexpr NumberRow kHaloRow{"halo", 0, 0, 1000};

struct DrawingOptions {
    double size = kSizeRow.standard;  ///< the window of 1000 units, in pixels
    /// The distance from the eye to the middle of the window, in units; orthographic without.
    std::optional<double> perspective;
    Hidden hidden = Hidden::remove;           ///< what becomes of hidden arcs; draw: bodies are transparent
    Sticks sticks = Sticks::none;             ///< instead of outlines
    bool crossings = false;                   ///< also the curves in which bodies pass through each other
    double lod = kLevelOfDetailRow.standard;  ///< bodies no wider are dots and lines; pixels
    double tol = kTolRow.standard;            ///< maximum chord error; pixels
    double line_width = kLineWidthRow.standard;  ///< pixels
    double halo = kHaloRow.standard;             ///< the gap on either side of a nearer line, in pixels
    bool colors = false;                         ///< of the bodies; black otherwise
};

enum class StrokeKind { visible, hidden, stick, dot };

struct Stroke {
    StrokeKind kind = StrokeKind::visible;
    std::vector<glm::dvec2> points;  ///< on the page, pixels from its upper left, y down; a dot's is one
    std::string body;                ///< its name
    glm::dvec3 color{0};             ///< 0 to 255
    double depth = 0;
};

struct Drawing {
    int frame = 0;
    double size = 0, line_width = 1, halo = 0;
    std::vector<Stroke> strokes;  ///< hidden ones first, then from far to near
};

/// Throws Error as outlines and levels_of_detail do.
Drawing draw(const FigureFrame& frame, const DrawingOptions& options, const ParallelFor& parallel_for);

}  // namespace anamorph::command
