// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/apart_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "anamorph/image/split_points.h"

namespace anamorph {
namespace {

simd::Texels texels_of(const Window& window, simd::Kernel kernel) {
    static constexpr simd::Tap kMiddle{};
    return {window.texels, window.row_stride, window.type, window.channels, kernel, &kMiddle, 1};
}

}  // namespace

ApartReader::ApartReader(const Source& source, const Border& border)
    : m_source(source), m_reader(source, border) {}

bool ApartReader::locate(Row& row, simd::Kernel kernel) {
    simd::split_points(row.x, row.count, 1, 0, row.texel_x, row.rest_x);
    simd::split_points(row.y, row.count, 1, 0, row.texel_y, row.rest_y);
    const int support = support_of(kernel);
    if (!in_place(row, support)) return one_by_one(row, support);
    std::fill_n(row.from, row.count, nullptr);
    simd::fetch_row(texels_of(row.window, kernel), row.offsets());
    return true;
}

PixelType ApartReader::sample(Row& row, simd::Kernel kernel, float* values) const {
    const int support = support_of(kernel);
    for (int i = 0; i < row.count; ++i) {
        if (!row.from[i]) continue;
        // Bilinear reads one row besides a point's own.
        const bool is_bilinear = kernel == simd::Kernel::bilinear, above = row.rest_y[i] < 0.5f;
        row.copy(i, row.from[i], row.from_stride, support, is_bilinear && !above ? 0 : -support,
                 is_bilinear && above ? 0 : support);
    }
    simd::sample_row(texels_of(row.window, kernel), row.offsets(), values);
    const int channels = row.window.channels;
    for (int i = 0; i < row.count; ++i)
        if (row.piece[i] < 0) std::fill_n(values + i * channels, channels, 0.0f);
    return row.window.type;
}

/// Where one box that stands in memory holds all texels: they are counted from its corner.
bool ApartReader::in_place(Row& row, int support) {
    const std::int32_t piece = row.piece[0], *const x = row.texel_x, *const y = row.texel_y;
    const auto on_piece = [&](std::int32_t p) { return p == piece; };
    if (piece < 0 || !std::all_of(row.piece, row.piece + row.count, on_piece)) return false;
    const auto [left, right] = std::minmax_element(x, x + row.count);
    const auto [top, bottom] = std::minmax_element(y, y + row.count);
    const Box box{*left - support, *top - support, *right + support + 1, *bottom + support + 1};
    if (!m_reader.get_in_place(0, piece, box, row.window)) return false;
    // Offsets count elements in 32 bits.
    const double bytes = std::fabs(static_cast<double>(row.window.row_stride)) * (box.height() + 1.0);
    if (bytes > std::numeric_limits<std::int32_t>::max()) return false;
    for (int i = 0; i < row.count; ++i) {
        row.texel_x[i] -= box.x0;
        row.texel_y[i] -= box.y0;
    }
    return true;
}

/// Elsewhere the texels of each are copied, side by side: those that stand in memory once they are near.
bool ApartReader::one_by_one(Row& row, int support) {
    const int side = 2 * support + 1, channels = m_source.channels();
    // As WindowReader has them.
    const PixelType type = m_source.unassociated_alpha() < 0 ? m_source.type() : PixelType::float32;
    const std::ptrdiff_t bytes = std::ptrdiff_t{side} * channels * size_of(type);
    const std::ptrdiff_t row_stride = simd::kMaxRow * bytes;
    row.texels.resize(static_cast<std::size_t>(side * row_stride + Window::kSlack));
    row.window = {row.texels.data(), type, channels, row_stride, {}};
    for (int i = 0; i < row.count; ++i) {
        const int x = row.texel_x[i] - support, y = row.texel_y[i] - support;
        const Box box{x, y, x + side, y + side};
        row.texel_x[i] = i * side + support;
        row.texel_y[i] = support;
        row.from[i] = nullptr;
        if (row.piece[i] < 0) continue;
        Window around;
        const bool stands = m_reader.get_in_place(0, row.piece[i], box, around);
        if (!stands && !m_reader.get_copy(0, row.piece[i], box, around)) return false;
        const std::byte* texel =
            around.texels + support * (around.row_stride + std::ptrdiff_t{channels} * size_of(type));
        if (stands) {
            row.from[i] = texel;
            row.from_stride = around.row_stride;
        } else
            row.copy(i, texel, around.row_stride, support, -support, support);
    }
    simd::fetch_row(row.from, row.rest_y, row.count, row.from_stride);
    return true;
}

void ApartReader::Row::copy(int i, const std::byte* texel, std::ptrdiff_t row_stride, int support, int first,
                            int last) {
    const std::ptrdiff_t pixel = std::ptrdiff_t{window.channels} * size_of(window.type);
    const std::ptrdiff_t bytes = (2 * support + 1) * pixel;
    for (int j = first; j <= last; ++j)
        std::memcpy(texels.data() + (support + j) * window.row_stride + i * bytes,
                    texel + j * row_stride - support * pixel, static_cast<std::size_t>(bytes));
}

}  // namespace anamorph
