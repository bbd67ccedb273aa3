// SPDX-License-Identifier: Apache-2.0
// Means over rectangles of an image from a table of sums (Crow 1984), exact for texels that are constant.
#pragma once

#include <memory>
#include <vector>

#include "anamorph/render/source.h"

namespace anamorph {

/// What stands left and right of the image: itself again, which then goes on over its upper and lower edge half a
/// turn farther, as a sphere does over its poles; or its reflection, as above and below.
enum class SummedEdges { turn, reflected };

/// Thread safe.
class SummedArea {
  public:
    /// Larger images are read at a coarser level.
    static constexpr std::int64_t kMostTexels = std::int64_t{1} << 22;

    /// Null where the source cannot be read, or no level of it is small enough.
    static std::unique_ptr<const SummedArea> of(const Source& source, SummedEdges edges);

    /// The mean over |dx| <= half_width, |dy| <= half_height about (x, y), in pixels of level 0; at least a texel
    /// and at most the image is averaged each way. Colour is multiplied by alpha.
    void mean(double x, double y, double half_width, double half_height, float* pixel) const;

  private:
    SummedArea(const Size& size, int channels, SummedEdges edges);
    bool add(const Source& source, int level);
    double sum(double x, double y, std::size_t channel) const;
    double sum(double x0, double x1, double y0, double y1, std::size_t channel) const;
    double sum_left_of(double x, double y0, double y1, std::size_t channel) const;

    Size m_size;
    std::size_t m_channels;
    SummedEdges m_edges;
    double m_scale_x = 1, m_scale_y = 1;
    std::vector<double>
        m_sums;  ///< of all texels above and left of a corner; packed, (width + 1) x (height + 1)
};

}  // namespace anamorph
