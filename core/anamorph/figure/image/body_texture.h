// SPDX-License-Identifier: Apache-2.0
// A texture around a body, read with the footprint of each pixel: derivatives of (u, v) over the screen by
// reading the surface's and the mapping's formulas with jets.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <vector>

#include "anamorph/figure/body/body_mapping.h"
#include "anamorph/figure/image/seen_surface.h"
#include "anamorph/image/border.h"
#include "anamorph/image/filter.h"
#include "anamorph/image/footprint.h"
#include "anamorph/image/point_sampler.h"
#include "anamorph/image/summed_areas.h"

namespace anamorph::figure {

/// The surface of a body that a texture lies on, moved by `offset` texels.
struct TexturedSurface {
    const SeenSurface& surface;
    glm::dvec2 offset{0.0};
    double longest = 0;  ///< half of the body's longest axis, in pixels
};

/// A color, multiplied with its alpha, on another, which does not count where alpha is 1, be it infinite or no number.
template <class Color>
Color laid_over(const Color& color, double alpha, const Color& below) {
    return alpha == 1 ? color : color + (1 - alpha) * below;
}

/// Red, green, blue and alpha of a texel of 1 to 4 channels, the last of 2 and of 4 alpha.
glm::dvec4 color_of_texel(const std::vector<float>& texel);

/// What stands beyond a texture's edges: what the mapping continues with.
Border texture_border(const Source& source, BodyMapping mapping);

/// Reads the texture around a body. Each thread needs its own. Keeps a reference to the source.
class BodyTexture {
  public:
    /// Where the source has no table of sums, TextureAverage::summed_area averages by footprints.
    BodyTexture(const Source& source, BodyMapping mapping, Filter filter,
                TextureAverage average = TextureAverage::footprint);

    /// The texture's colour where a pixel shows the body at (x, y), laid over `below` where it is
    /// transparent. `below` itself where the source cannot be read.
    glm::dvec3 color(const TexturedSurface& body, double x, double y, bool far_side, const glm::dvec3& below);

  private:
    bool read_average(const Jacobian& jacobian, double u, double v);
    bool read_trilinear(const Jacobian& jacobian, double u, double v);
    bool read_as_mrasel(double sine, double longest, double u, double v);
    bool read_level(Filter filter, int level, double u, double v, float* pixel);

    const Source& m_source;
    TextureAverage m_average;
    std::optional<SummedLevels> m_sums;
    BodyMapping m_mapping;
    Filter m_filter;
    Border m_border;
    FootprintChooser m_chooser;
    PointSampler m_sampler;
    std::vector<float> m_pixel, m_coarser;
};

}  // namespace anamorph::figure
