// SPDX-License-Identifier: Apache-2.0
// Which of many ellipsoids a picture may show: what is certainly hidden by others need not be drawn.
//
// Bodies are looked at from the nearest on. Each leaves in the pixels that it certainly covers the depth at which it is met there. One that
// is farther than that in all pixels whose middles it may cover is hidden: it is left out, and what is drawn is the same without it. What
// is uncertain, by the margins below, counts as not covered by what hides, and as covered by what may be hidden.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/parallel_for.h"

namespace anamorph::figure {

/// A picture as OpenGL makes it. All bodies are before the eye: their w is positive, or the result has all of them.
struct OcclusionView {
    glm::dmat4 to_clip{1.0};    ///< from the bodies' space; depth is z / w, and less is nearer
    int width = 0, height = 0;  ///< pixels, at most 32767; x / w and y / w of -1 to 1 are all of them
    /// How far from its middle, in pixels, a body must cover a pixel to hide what is behind it: 1/64, as what draws rounds, or more
    /// where it takes several samples of a pixel.
    double reach = 1.0 / 64;
    /// How much deeper than what hides it a body must be, in z / w: what draws rounds depths, and its buffer has 24 bits or more.
    double step = 1.0 / (1 << 18);
};

/// Many ellipsoids, ready to be looked at from anywhere.
class OccludedBodies {
  public:
    void reserve(std::size_t count) { m_bodies.reserve(count); }
    /// Adds the body of the points center + axes s with |s| <= 1, whose number is that of those before it.
    void add(const glm::dvec3& center, const glm::dmat3& axes);
    /// Adds none, which takes a number.
    void add_none() { m_bodies.emplace_back(); }
    std::size_t size() const { return m_bodies.size(); }

    /// The numbers of the bodies that a picture may show, ascending; the same for any number of threads.
    std::vector<std::uint32_t> seen(const OcclusionView& view,
                                    const ParallelFor& parallel_for = serial_for) const;

    /// A body in a cache line. The axes are rounded to 24 bits, by less than the margins of what is derived of them.
    struct Body {
        double center[3] = {};
        float axes[9] = {};  ///< columns
        bool drawn = false;
    };

  private:
    std::vector<Body> m_bodies;
};

}  // namespace anamorph::figure
