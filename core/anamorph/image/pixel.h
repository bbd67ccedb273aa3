// SPDX-License-Identifier: Apache-2.0
// One channel of a pixel in and out of float: uint8 and uint16 stand for 0..1, half and float for themselves.
#pragma once

#include <cstring>

#include "anamorph/image/view.h"
#include "anamorph/number/half.h"

namespace anamorph {

namespace pixel_detail {

template <class T>
T get(const std::byte* channel) noexcept {
    T value;
    std::memcpy(&value, channel, sizeof value);
    return value;
}
template <class T>
void put(T value, std::byte* channel) noexcept {
    std::memcpy(channel, &value, sizeof value);
}

inline float value(std::uint8_t stored) noexcept {
    return static_cast<float>(stored) / 255.0f;
}
inline float value(std::uint16_t stored) noexcept {
    return static_cast<float>(stored) / 65535.0f;
}

/// The nearest whole number to value * limit in 0..limit, halves upwards; NaN gives 0.
template <class T>
T normalised(float value, float limit) noexcept {
    if (!(value > 0)) return 0;
    return static_cast<T>(value < 1 ? value * limit + 0.5f : limit);
}

}  // namespace pixel_detail

inline float load_channel(const std::byte* channel, PixelType type) noexcept {
    switch (type) {
        case PixelType::uint8:
            return pixel_detail::value(pixel_detail::get<std::uint8_t>(channel));
        case PixelType::uint16:
            return pixel_detail::value(pixel_detail::get<std::uint16_t>(channel));
        case PixelType::half:
            return float_from_half(pixel_detail::get<std::uint16_t>(channel));
        default:
            return pixel_detail::get<float>(channel);
    }
}

/// Stores a channel: clamped to 0..1 and rounded to nearest for uint8 and uint16 (NaN becomes 0), rounded to
/// nearest even for half.
inline void store_channel(float value, std::byte* channel, PixelType type) noexcept {
    switch (type) {
        case PixelType::uint8:
            pixel_detail::put(pixel_detail::normalised<std::uint8_t>(value, 255), channel);
            break;
        case PixelType::uint16:
            pixel_detail::put(pixel_detail::normalised<std::uint16_t>(value, 65535), channel);
            break;
        case PixelType::half:
            pixel_detail::put(half_from_float(value), channel);
            break;
        default:
            pixel_detail::put(value, channel);
            break;
    }
}

/// Loads `count` channels that stand next to each other as floats.
inline void load_channels(const std::byte* channels, PixelType type, std::int64_t count,
                          float* values) noexcept {
    // A loop for each type, so that it can be vectorised.
    const auto load = [&]<class T>(T, auto value) {
        for (std::int64_t i = 0; i < count; ++i)
            values[i] = value(pixel_detail::get<T>(channels + i * std::int64_t{sizeof(T)}));
    };
    const auto normal = [](auto stored) { return pixel_detail::value(stored); };
    switch (type) {
        case PixelType::uint8:
            return load(std::uint8_t{}, normal);
        case PixelType::uint16:
            return load(std::uint16_t{}, normal);
        case PixelType::half:
            return load(std::uint16_t{}, [](std::uint16_t half) { return float_from_half(half); });
        default:
            return load(float{}, [](float value) { return value; });
    }
}

/// Multiplies colour by alpha: the pixel as it is filtered. Where alpha is 0 there is no colour, whatever it
/// held.
inline void associate_alpha(float* pixel, int channels, int alpha) noexcept {
    const float weight = pixel[alpha];
    for (int c = 0; c < channels; ++c)
        if (c != alpha) pixel[c] = weight == 0 ? 0 : pixel[c] * weight;
}

/// Divides colour by alpha again; where alpha is 0 colour stays as it is.
inline void unassociate_alpha(float* pixel, int channels, int alpha) noexcept {
    const float weight = pixel[alpha];
    if (weight == 0) return;
    for (int c = 0; c < channels; ++c)
        if (c != alpha) pixel[c] /= weight;
}

}  // namespace anamorph
