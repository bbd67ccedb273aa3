// SPDX-License-Identifier: Apache-2.0
// The ways in which a source is read between its pixels.
#pragma once

namespace anamorph {

/// The filters by which a source is read.
///
/// nearest, bilinear, bicubic (Catmull-Rom) and sharp_bicubic (the cubic that keeps more of what is fine) read the source as it is; the
/// clamped ones are without what overshoots: each channel is at least the least and at most the greatest of the 4 x 4 texels that
/// are read. antialias is bilinear where the map magnifies and averages over the pixel's footprint, on the pyramid level that fits it,
/// where it minifies.
/// The last two average over the least rectangle of the source, its sides along the source's own, that covers that
/// parallelogram (Oka 1987, fig. 2.6), too much of a blur where it lies aslant: pyramid on a level of the pyramid
/// (Williams 1983), summed_area over all texels, by Source::summed_areas (Crow 1984), which a
/// Pyramid has.
enum class Filter {
    nearest,
    bilinear,
    bicubic,
    bicubic_clamped,
    sharp_bicubic,
    sharp_bicubic_clamped,
    antialias,
    pyramid,
    summed_area
};

/// Does a filter average where the map minifies?
constexpr bool averages(Filter filter) {
    return filter >= Filter::antialias;
}

/// Does a filter read 4 x 4 texels by cubics?
constexpr bool is_cubic(Filter filter) {
    return filter >= Filter::bicubic && filter <= Filter::sharp_bicubic_clamped;
}
/// Is a filter the sharp cubic, clamped or not?
constexpr bool is_sharp(Filter filter) {
    return filter == Filter::sharp_bicubic || filter == Filter::sharp_bicubic_clamped;
}
/// Is what a filter overshoots cut off?
constexpr bool is_clamped(Filter filter) {
    return filter == Filter::bicubic_clamped || filter == Filter::sharp_bicubic_clamped;
}

/// The slope at a distance of one texel of the interpolating cubic that bicubic is: a of Keys 1981, eq. 4, of Mitchell and Netravali's
/// cubics (1988) that with B = 0 and C = -a. At a fifth of the sampling rate its response is 0.973.
inline constexpr float kBicubicSlope = -0.5f;
/// That of sharp_bicubic, -2/3, whose response there is 0.9976, and at most 1.0076 up to there. It is off by 8e-8 so that a + 2 and a + 3
/// are floats, too, and weights are 0 and 1 in the middle of a texel.
inline constexpr float kSharpBicubicSlope = -0xaaaaacp-24f;
/// One of the two.
constexpr float cubic_slope(bool sharp) {
    return sharp ? kSharpBicubicSlope : kBicubicSlope;
}

}  // namespace anamorph
