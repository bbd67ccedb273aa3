// SPDX-License-Identifier: Apache-2.0
// A frame as strokes on a page, which all formats draw.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/frame.h"
#include "anamorph/parallel_for.h"

namespace anamorph::command {

enum class Hidden { remove, dash, draw };
enum class Sticks { none, axes, joints };

struct DrawingOptions {
    double size = 500;  ///< the window of 1000 units, in pixels
    /// The distance from the eye to the middle of the window, in units; orthographic without.
    std::optional<double> perspective;
    Hidden hidden = Hidden::remove;   ///< what becomes of hidden arcs; draw: bodies are transparent
    Sticks sticks = Sticks::none;     ///< instead of outlines
    bool crossings = false;           ///< also the curves in which bodies pass through each other
    double lod = 0;                   ///< bodies no wider are dots and lines; pixels
    double tol = 0.1;                 ///< maximum chord error; pixels
    double line_width = 1, halo = 0;  ///< pixels; the halo is the gap on either side of a nearer line
    bool colors = false;              ///< of the bodies; black otherwise
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
