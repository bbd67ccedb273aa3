// SPDX-License-Identifier: Apache-2.0
// An elliptical viewport, by which NUDES clips outlines to the viewing surface (Chapman 1986, section 1.4).
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace anamorph::figure {

/// An ellipse on a page, with axes along the page's sides. Lines beyond it are not drawn.
struct Viewport {
    glm::dvec2 middle{0.0},
        half_axes{1.0};  ///< pixels from the upper left of the page, y down; half-axes positive

    /// Is a point of the page within it?
    bool holds(const glm::dvec2& point) const;
};

/// The viewport that the four numbers x, y, a, b say, its middle and half-axes in shares of a picture's width and height.
/// Throws Error naming the parameter `name` and `text`, its value, where they are not four or one is out of its range.
Viewport viewport_of(std::string_view name, const std::string& text, std::span<const double> numbers);

/// A viewport in shares as pixels of a page, on which the picture's upper left corner is at `corner`.
Viewport in_pixels(const Viewport& shares, const glm::dvec2& size, const glm::dvec2& corner);

/// Cuts the segment from a to b to the viewport; false where nothing is left. What is left lies in it to rounding, and an
/// end that lies in it keeps its bits.
bool clip(glm::dvec2& a, glm::dvec2& b, const Viewport& viewport);

/// What of a closed convex polygon (the last point is the first) lies in the viewport, as such a polygon; empty where
/// nothing does. The viewport's chords are within `tol` pixels of it.
std::vector<glm::dvec2> clip_polygon(const std::vector<glm::dvec2>& polygon, const Viewport& viewport,
                                     double tol);

}  // namespace anamorph::figure
