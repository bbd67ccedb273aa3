// SPDX-License-Identifier: Apache-2.0
// A texture around a body, read with the footprint of each pixel: derivatives of (u, v) over the screen by
// reading the surface's and the mapping's formulas with jets.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/figure/body_mapping.h"
#include "anamorph/figure/seen_surface.h"
#include "anamorph/render/border.h"
#include "anamorph/render/filter.h"
#include "anamorph/render/footprint.h"
#include "anamorph/render/point_sampler.h"

namespace anamorph {

/// One for each thread. Keeps a reference to the source.
class BodyTexture {
  public:
    BodyTexture(const Source& source, BodyMapping mapping, Filter filter);

    /// What the texture, moved by `offset` texels, has where a pixel shows the surface at (x, y), over `below`
    /// where it is transparent. `below` itself where the source cannot be read.
    glm::dvec3 color(const SeenSurface& surface, double x, double y, bool far_side, const glm::dvec2& offset,
                     const glm::dvec3& below);

  private:
    const Source& m_source;
    BodyMapping m_mapping;
    Filter m_filter;
    Border m_border;
    FootprintChooser m_chooser;
    PointSampler m_sampler;
    std::vector<float> m_pixel;
};

}  // namespace anamorph
