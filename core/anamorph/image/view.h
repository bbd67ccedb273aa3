// SPDX-License-Identifier: Apache-2.0
// Strided pixels in memory, whoever owns them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "anamorph/chart/chart.h"

namespace anamorph {

/// The type of a channel. uint8 and uint16 stand for 0 to 1 (normalised), half is IEEE binary16.
enum class PixelType : std::uint8_t { uint8, uint16, half, float32 };

/// The size of one channel in bytes.
constexpr int size_of(PixelType type) {
    return type == PixelType::uint8 ? 1 : type == PixelType::float32 ? 4 : 2;
}

/// A view of pixels in memory. `data` points at channel 0 of pixel (0, 0) of the view; the strides are in bytes and may
/// be negative. The channels of a pixel stand next to each other.
template <class Byte>
struct BasicView {
    Byte* data = nullptr;
    PixelType type = PixelType::float32;
    int width = 0, height = 0, channels = 0;
    std::ptrdiff_t pixel_stride = 0, row_stride = 0;

    /// The address of channel 0 of pixel (x, y).
    Byte* at(std::ptrdiff_t x, std::ptrdiff_t y) const { return data + y * row_stride + x * pixel_stride; }
    /// Do pixels of a row follow each other without a gap?
    bool packed() const { return pixel_stride == std::ptrdiff_t{channels} * size_of(type); }
};

/// A view of pixels to write.
using ImageView = BasicView<std::byte>;
/// A view of pixels to read.
using ConstImageView = BasicView<const std::byte>;

/// Channels [first, first + count) of a view.
inline ImageView channels_of(ImageView view, int first, int count) {
    view.data += first * size_of(view.type);
    view.channels = count;
    return view;
}

/// A packed view of `data`.
template <class Byte>
BasicView<Byte> packed_view(Byte* data, PixelType type, int width, int height, int channels) {
    const std::ptrdiff_t pixel = std::ptrdiff_t{channels} * size_of(type);
    return {data, type, width, height, channels, pixel, pixel * width};
}

}  // namespace anamorph
