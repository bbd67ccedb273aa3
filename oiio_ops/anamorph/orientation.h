// SPDX-License-Identifier: Apache-2.0
// Images that are stored turned or mirrored (the tag Orientation, 1 to 8, as EXIF and TIFF define it), read
// upright.
#pragma once

#include <OpenImageIO/imageio.h>

#include <vector>

#include "anamorph/chart/chart.h"
#include "anamorph/image/source.h"

namespace anamorph {

/// The way between stored and upright pixels: the stored column is the upright column, or row if `swaps`,
/// counted from the other end if `mirrors_x`; likewise for rows.
struct StoredOrder {
    bool swaps = false, mirrors_x = false, mirrors_y = false;

    /// The order of a value of the tag; one without a meaning is 1.
    explicit StoredOrder(int orientation);
    explicit StoredOrder(const OIIO::ImageSpec& spec)
        : StoredOrder(spec.get_int_attribute("Orientation", 1)) {}

    bool is_upright() const { return !swaps && !mirrors_x && !mirrors_y; }
    Size upright_size(const Size& stored) const;
    /// The box where upright pixels are stored; upright_box() is the way back. `stored` is the size of the
    /// stored image.
    Box stored_box(const Box& upright, const Size& stored) const;
    Box upright_box(const Box& box, const Size& stored) const;
    /// Copies packed pixels of `pixel` bytes, `from` holding those of a stored box that become those of
    /// `width` x `height` upright ones.
    void turn(const std::byte* from, std::byte* to, int width, int height, std::ptrdiff_t pixel,
              std::ptrdiff_t to_row_stride) const;

  private:
    void mirror(Box& box, const Size& stored) const;
};

/// The spec of the upright image: windows turned, Orientation 1 where there was one.
OIIO::ImageSpec upright(const OIIO::ImageSpec& spec);

/// A stored image, upright. Reads no more of it than it is asked for. Keeps a reference to the base.
class UprightSource final : public Source {
  public:
    UprightSource(const Source& base, const StoredOrder& order) : m_base(base), m_order(order) {}

    PixelType type() const noexcept override { return m_base.type(); }
    int channels() const noexcept override { return m_base.channels(); }
    int unassociated_alpha() const noexcept override { return m_base.unassociated_alpha(); }
    int levels() const noexcept override { return m_base.levels(); }
    Size size(int level) const noexcept override { return m_order.upright_size(m_base.size(level)); }
    Box extent(int level) const noexcept override {
        return m_order.upright_box(m_base.extent(level), m_base.size(level));
    }
    Box data_window() const noexcept override {
        return m_order.upright_box(m_base.data_window(), m_base.size(0));
    }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;

  private:
    const Source& m_base;
    StoredOrder m_order;
};

}  // namespace anamorph
