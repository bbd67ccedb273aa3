// SPDX-License-Identifier: Apache-2.0
// What lies behind figures: bands, and a picture.
#pragma once

#include <glm/vec4.hpp>
#include <vector>

#include "anamorph/figure/body/frame.h"
#include "anamorph/geometry/size.h"
#include "anamorph/image/border.h"
#include "anamorph/image/footprint.h"
#include "anamorph/image/point_sampler.h"

namespace anamorph::figure {

/// The mean colour, 0 to 1, and the alpha of a row of pixels in a picture of so many rows; the last band goes on
/// to the bottom.
glm::dvec4 band_color(const std::vector<BackgroundBand>& bands, int y, int height);

/// A picture that is drawn as large as another. Each thread needs its own. Keeps a reference to the source.
class FigureBackdrop {
  public:
    FigureBackdrop(const Source& source, const Size& size);

    /// The picture's colour in a pixel, laid over `below`; colours are multiplied by alpha. `below` itself
    /// where the source cannot be read.
    glm::dvec4 color(int x, int y, const glm::dvec4& below);

  private:
    Jacobian m_jacobian;
    Border m_border;
    Footprint m_footprint;
    PointSampler m_sampler;
    std::vector<float> m_pixel;
};

}  // namespace anamorph::figure
