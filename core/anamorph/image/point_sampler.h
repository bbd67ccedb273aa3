// SPDX-License-Identifier: Apache-2.0
// The filters at one point: their weights, and the reference sampler that reads a source with them. It serves
// the pixels that stand alone (at poles and seams) and is the truth in tests; whole blocks have their own
// loops.
#pragma once

#include <array>
#include <vector>

#include "anamorph/image/filter.h"
#include "anamorph/image/footprint.h"
#include "anamorph/image/summed_areas.h"
#include "anamorph/image/window.h"

namespace anamorph {

/// Weights of the two texels around a point, `t` in [0, 1) from the first one's centre to the second one's.
template <class T>
std::array<T, 2> bilinear_weights(T t) {
    return {1 - t, t};
}

/// Weights of the four texels around a point, `t` in [0, 1) from the second one's centre to the third one's. Keys 1981, eq. 4,
/// with `a` of cubic_slope.
template <class T>
std::array<T, 4> cubic_weights(T t, T a) {
    const T u = 1 - t;
    return {a * t * u * u, 1 + t * t * ((a + 2) * t - (a + 3)), 1 + u * u * ((a + 2) * u - (a + 3)),
            a * t * t * u};
}

/// Samples a source at single points. Keeps a small window; one per thread. Keeps references to its
/// arguments.
class PointSampler {
  public:
    /// `border` is that of the source.
    PointSampler(const Source& source, const Border& border);

    /// Samples the source at (x, y), in pixels of `level` (texel centres at + 0.5), on `piece`, which may be
    /// left over every edge: writes channels() floats to `pixel`, colour multiplied by alpha where the source
    /// has unassociated alpha (unassociate_alpha undoes it). A texel of weight zero is not looked at; a point
    /// that is not a number gives zeros. Filter::antialias reads as bilinear. False when the source could not
    /// be read.
    bool sample(Filter filter, int level, int piece, double x, double y, float* pixel) noexcept;

    /// Samples the mean of the footprint's taps around (x, y), in pixels of level 0; `jacobian` as given to
    /// the footprint.
    bool sample(const Footprint& footprint, const Jacobian& jacobian, int piece, double x, double y,
                float* pixel) noexcept;

    /// Samples the source at (x, y), in pixels of level 0, by any filter, for a pixel that takes steps of
    /// `jacobian` there; `chooser` is the source's. Filter::summed_area is for sources of one piece.
    bool sample(Filter filter, const FootprintChooser& chooser, const Jacobian& jacobian, int piece, double x,
                double y, float* pixel) noexcept;

  private:
    void sample(Filter filter, const Window& window, double x, double y, float* pixel) noexcept;
    bool mean(const Jacobian& rectangle, double x, double y, float* pixel) noexcept;

    const Source& m_source;
    const Border& m_border;
    SummedLevels m_sums;
    WindowReader m_reader;
    std::vector<float> m_tap;
    std::vector<double> m_sum, m_values, m_mended;
    std::vector<float> m_texels;
};

}  // namespace anamorph
