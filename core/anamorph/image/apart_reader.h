// SPDX-License-Identifier: Apache-2.0
// Rows of pixels whose texels lie far apart: each is read from the few texels around its own point, instead of all of them
// from one window.
#pragma once

#include <cstdint>
#include <vector>

#include "anamorph/image/block_sampler.h"
#include "anamorph/image/window.h"

namespace anamorph {

/// The number of texels on each side of the one that a point falls into that may be read.
constexpr int support_of(simd::Kernel kernel) {
    return simd::is_cubic(kernel) ? 2 : kernel == simd::Kernel::bilinear ? 1 : 0;
}

/// Reads level 0 of a source; one per thread. Keeps references to its arguments.
class ApartReader {
  public:
    ApartReader(const Source& source, const Border& border);

    /// A row of up to simd::kMaxRow pixels: source points within 2^30 of 0, and the source's piece of each, negative
    /// where there is none.
    struct Row {
        int count = 0;
        alignas(64) double x[simd::kRowRoom], y[simd::kRowRoom];
        std::int32_t piece[simd::kMaxRow];

      private:
        friend ApartReader;
        simd::Offsets offsets() const { return {rest_x, rest_y, count, texel_x, texel_y}; }

        alignas(64) std::int32_t texel_x[simd::kRowRoom], texel_y[simd::kRowRoom];  ///< texels in the window
        alignas(64) float rest_x[simd::kRowRoom], rest_y[simd::kRowRoom];
        Window window;
        std::vector<std::byte> texels;  ///< the window's own
        /// The places in memory of the texels that points fall into, if they are still to be copied from
        /// there; else null.
        const std::byte* from[simd::kMaxRow];
        std::ptrdiff_t from_stride = 0;

        /// Copies the texels of rows `first` to `last` around one to those of pixel i.
        void copy(int i, const std::byte* texel, std::ptrdiff_t row_stride, int support, int first, int last);
    };

    /// Finds a row's texels, for a filter that reads one tap, and brings them near. False when the source could not be
    /// read.
    bool locate(Row& row, simd::Kernel kernel);
    /// Samples the pixels of a row, once after it was located, channel by channel, into `values`, which has
    /// room for simd::kMaxRow * channels + 16 floats; 0 where there is no point. A pixel's bits depend on its
    /// own point only. Returns the type whose units they have (simd::sample_row).
    PixelType sample(Row& row, simd::Kernel kernel, float* values) const;

  private:
    bool in_place(Row& row, int support);
    bool one_by_one(Row& row, int support);

    const Source& m_source;
    WindowReader m_reader;
};

}  // namespace anamorph
