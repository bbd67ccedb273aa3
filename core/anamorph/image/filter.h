// SPDX-License-Identifier: Apache-2.0
// The ways in which a source is read between its pixels.
#pragma once

namespace anamorph {

/// The filters by which a source is read.
///
/// nearest, bilinear and bicubic (Catmull-Rom) read the source as it is; bicubic_clamped is bicubic without what overshoots:
/// each channel is at least the least and at most the greatest of the 4 x 4 texels that are read. antialias is bilinear where the map
/// magnifies and averages over the pixel's footprint, on the pyramid level that fits it, where it minifies.
/// The last two average over the least rectangle of the source, its sides along the source's own, that covers that
/// parallelogram (Oka 1987, fig. 2.6), too much of a blur where it lies aslant: pyramid on a level of the pyramid
/// (Williams 1983), summed_area over all texels, by Source::summed_areas (Crow 1984), which a
/// Pyramid has.
enum class Filter { nearest, bilinear, bicubic, bicubic_clamped, antialias, pyramid, summed_area };

/// Does a filter average where the map minifies?
constexpr bool averages(Filter filter) {
    return filter >= Filter::antialias;
}

}  // namespace anamorph
