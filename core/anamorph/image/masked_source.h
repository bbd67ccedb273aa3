// SPDX-License-Identifier: Apache-2.0
// An image of which a part is cut out: what is left has alpha.
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "anamorph/geometry/point.h"
#include "anamorph/image/source.h"

namespace anamorph {

/// The texels of an image that count: those whose middles lie within all that is given here. Pixels, x right, y down.
struct SourceMask {
    struct Circle {
        Point<double> middle;
        double radius;
    };
    std::optional<Box> rectangle = {};
    std::optional<Circle> circle = {};
    /// Polygons that are cut out, each by the even-odd rule.
    std::vector<std::vector<Point<double>>> holes = {};
    /// Whether a point of the image is shown, if not everything is. It does not throw, and is asked in any order.
    std::function<bool(double x, double y)> shows = {};

    /// Writes 1 for each of the texels [x0, x1) of a row that counts, and 0 for the others.
    void write_row(int y, int x0, int x1, unsigned char* counts) const noexcept;
};

/// A source as float, of one level, whose texels beyond a mask are 0, with alpha: where the base has none, a last channel is 1
/// within the mask and 0 beyond. What the base lacks of its picture (Source::data_window) is beyond the mask, and texels
/// beyond its picture (overscan) are not there. Keeps a reference to the base.
class MaskedSource final : public Source {
  public:
    /// `alpha`: the channel of alpha of the base, -1 where there is none.
    MaskedSource(const Source& base, SourceMask mask, int alpha)
        : m_base(base), m_mask(std::move(mask)), m_alpha(alpha) {
        const Box all{0, 0, base.size(0).width, base.size(0).height};
        m_mask.rectangle = intersection(m_mask.rectangle.value_or(all), base.data_window());
    }

    PixelType type() const noexcept override { return PixelType::float32; }
    int channels() const noexcept override { return m_base.channels() + (m_alpha < 0 ? 1 : 0); }
    int unassociated_alpha() const noexcept override { return m_base.unassociated_alpha(); }
    int levels() const noexcept override { return 1; }
    Size size(int level) const noexcept override { return m_base.size(level); }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;

  private:
    /// Writes a texel of the base, cut by the mask.
    void write(const float* from, bool counts, float* to) const noexcept;

    const Source& m_base;
    SourceMask m_mask;
    int m_alpha;
};

}  // namespace anamorph
