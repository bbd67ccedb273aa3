// SPDX-License-Identifier: Apache-2.0
// The hot loops: from the polynomials of a block to its filtered pixels. Compiled for every instruction set
// Highway knows and chosen once per call; tests run each against the scalar path.
//
// Errors. Coordinates are evaluated in float as block.h states (fused where the machine fuses), within the
// rounding term of the block's bound (term_rounding in plan/block_writer.h). A point given as Offsets is
// moved by half a texel, which rounds the sum once, by at most 2^-24 |x|, and by kSamplerRounding (plan/block_writer.h) besides.
// Where taps make up a pixel their places are the filter's, rounded to float. A filtered value differs from
// the scalar path's by float rounding: at most 16 half-ULP of the largest texel read. Bilinear pixels of three or four
// channels that draw_block draws from uint8 to uint8 are filtered in whole numbers: before they are rounded to a level,
// they differ by at most 1/32 level, of 255 (packed_blocks.h), and of 1/15 where two or four taps lie within half a texel of the
// point. That is an error of the value, not of the point.
#pragma once

#include <cstddef>
#include <cstdint>

#include "anamorph/image/view.h"

namespace anamorph::simd {

/// The polynomials of a block for the source points of its pixels: [j][i] of s^i t^j for x, [j][4 + i] for y,
/// s and t in [-1, 1] over the pixel centres; of a degree up to 3 in s and in t; and the block's size. Or the points
/// themselves, row by row, with room for 16 more behind each: offsets, to which whole texels may be added.
struct Polynomials {
    const float (*c)[8];
    int degree;
    int width, height;
    const float *x = nullptr, *y = nullptr;
    std::ptrdiff_t row_stride = 0;
    const std::int32_t *whole_x = nullptr, *whole_y = nullptr;
};

/// Finds the source points of pixels [begin, end) of row `row`: offsets from the block's base in texels.
/// There is room for kRowRoom floats in each array.
void block_points(const Polynomials& block, int row, int begin, int end, float* out_x, float* out_y);

enum class Kernel : std::uint8_t {
    nearest,
    bilinear,
    bicubic,
    bicubic_clamped,
    sharp_bicubic,
    sharp_bicubic_clamped
};

/// Does a kernel read 4 x 4 texels?
constexpr bool is_cubic(Kernel kernel) {
    return kernel >= Kernel::bicubic;
}
constexpr bool is_sharp(Kernel kernel) {
    return kernel >= Kernel::sharp_bicubic;
}
/// Is what a kernel overshoots cut off?
constexpr bool is_clamped(Kernel kernel) {
    return kernel == Kernel::bicubic_clamped || kernel == Kernel::sharp_bicubic_clamped;
}

/// One of the taps that make up a filtered pixel, all of equal weight: its offset in texels.
struct Tap {
    float x = 0, y = 0;
};

/// The texels that a block reads: `texels` points at the texel that offset (0, 0) falls into; all texels that
/// the pixels' taps and the kernel need are there, and 64 bytes behind each row's last one may be read.
/// Bilinear pixels need the texel a tap falls into and its neighbours on every side, bicubic ones also the
/// next.
struct Texels {
    const std::byte* texels = nullptr;
    std::ptrdiff_t row_stride = 0;
    PixelType type = PixelType::float32;
    int channels = 0;
    Kernel kernel = Kernel::bilinear;
    /// The taps of a pixel, at most kMaxTaps (one for nearest and bicubic).
    const Tap* taps = nullptr;
    int tap_count = 1;
    /// Do neighbouring pixels read texels far apart?
    bool apart = false;
};
inline constexpr int kMaxTaps = 64;

/// The most pixels that a row has.
inline constexpr int kMaxRow = 64;

/// Taps that each pixel has for itself, in place of those of Texels. Arrays with room for 16 more, or null. Pixels of which `taps` says
/// less than 2 have four, at the sums and differences of (x_i, y_i) and (x_j, y_j) either way, in texels, all of them within half a texel.
/// Of others its bits from kTapsAcrossShift and kTapsDownShift on are how many there are each way: tap (a, b) stands 2 a - (count - 1)
/// times (x_i, y_i) from the point, and so along (x_j, y_j) for b.
struct OwnTaps {
    const float *x_i = nullptr, *y_i = nullptr, *x_j = nullptr, *y_j = nullptr;
    const std::int32_t* taps = nullptr;
};
/// Where `taps` has the counts.
inline constexpr int kTapsAcrossShift = 8, kTapsDownShift = 16;

/// Offsets of `count` <= kMaxRow pixels in texels (centres at + 0.5): (x[i], y[i]), or (whole_x[i] + x[i],
/// whole_y[i] + y[i]) where those are given.
struct Offsets {
    const float *x, *y;
    int count;
    const std::int32_t *whole_x = nullptr, *whole_y = nullptr;
    OwnTaps own = {};  ///< of bilinear pixels
};
/// The number of pixels that arrays of Offsets have room for.
inline constexpr int kRowRoom = kMaxRow + 16;

/// Samples a row of pixels into `out`: `channels` floats a pixel, in units of the source's type (0..255 for
/// uint8). `out` has room for kMaxRow * channels + 16 floats.
void sample_row(const Texels& texels, const Offsets& offsets, float* out);

/// Prefetches what sample_row is to read of a row by one tap.
void fetch_row(const Texels& texels, const Offsets& offsets);
/// Prefetches what `count` pixels read by one tap, each with texels of its own: texels[i] is the one that it
/// falls into, y[i] far down, or null.
void fetch_row(const std::byte* const* texels, const float* y, int count, std::ptrdiff_t row_stride);

/// Samples pixels [begin, end) x [row_begin, row_end) of a block and stores them: block_points, sample_row
/// and store_row in one, but for uint8 (see Errors). `to` points at pixel (begin, row_begin) of a picture with
/// packed pixels.
void draw_block(const Texels& texels, const Polynomials& block, int begin, int end, int row_begin,
                int row_end, float scale, PixelType type, std::byte* to, std::ptrdiff_t row_stride);

/// Converts `count` values to `type` and writes them, `scale` times (source units to the picture's); whole
/// cache lines bypass the cache. uint8 and uint16 are rounded and clamped, NaN gives 0.
void store_row(const float* values, int count, float scale, PixelType type, std::byte* to);

/// Makes what store_row wrote visible to other threads; to be called once after the last row.
void finish_stores();

/// The instruction sets compiled in that this machine has, best first, and a way to force one (for tests); an
/// empty name chooses the best again. False when there is no such set.
const char* const* instruction_sets();
bool use_instruction_set(const char* name);

}  // namespace anamorph::simd
