// SPDX-License-Identifier: Apache-2.0
// A box of pixels of the picture being drawn.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/image/block_sampler.h"
#include "anamorph/image/view.h"

namespace anamorph {

/// The value of a type of pixels that stands for 1.
inline float one_of(PixelType type) {
    return type == PixelType::uint8 ? 255.0f : type == PixelType::uint16 ? 65535.0f : 1.0f;
}

/// Throws Error where a box that is drawn has more pixels either way than the view that it is drawn to.
inline void check_room(const ImageView& view, const Box& box) {
    if (box.width() <= view.width && box.height() <= view.height) return;
    throw Error("view", std::to_string(view.width) + "x" + std::to_string(view.height),
                "must be at least as large as the box that is drawn, " + std::to_string(box.width()) + "x" +
                    std::to_string(box.height()));
}

class Canvas {
  public:
    /// Pixel (0, 0) of `view` is (box.x0, box.y0) of the picture. Throws what check_room() throws.
    Canvas(const ImageView& view, const Box& box) : m_view(view), m_box(box) { check_room(view, box); }

    const Box& box() const { return m_box; }
    int channels() const { return m_view.channels; }
    PixelType type() const { return m_view.type; }
    bool packed() const { return m_view.packed(); }
    std::ptrdiff_t row_stride() const { return m_view.row_stride; }
    std::byte* at(int x, int y) const { return m_view.at(x - m_box.x0, y - m_box.y0); }
    /// The factor that leads from values of which `one` stands for 1 to those of the view.
    float scale_from(float one) const { return one_of(m_view.type) / one; }

    /// Writes at most simd::kMaxRow pixels of a row from x on; `one` is the value that stands for 1.
    void store(int x, int y, int count, const float* values, float one = 1) const {
        std::byte* to = at(x, y);
        const int channels = m_view.channels;
        const float scale = scale_from(one);
        if (m_view.packed()) return simd::store_row(values, count * channels, scale, m_view.type, to);
        for (int i = 0; i < count; ++i)
            simd::store_row(values + std::ptrdiff_t{i} * channels, channels, scale, m_view.type,
                            to + i * m_view.pixel_stride);
    }

    /// Writes `value` to every channel of a box.
    void fill(const Box& box, float value) const {
        const std::vector<float> row(static_cast<std::size_t>(simd::kMaxRow * channels() + 16), value);
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; x += simd::kMaxRow)
                store(x, y, std::min(simd::kMaxRow, box.x1 - x), row.data());
    }

  private:
    ImageView m_view;
    Box m_box;
};

}  // namespace anamorph
