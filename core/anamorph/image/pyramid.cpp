// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/pyramid.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <exception>
#include <mutex>

#include "anamorph/image/pages.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/summed_areas.h"
#include "anamorph/image/texel_types.h"

namespace anamorph {

/// Texel `i` of `coarse` covers [i r, (i + 1) r) of `fine`, r = fine / coarse; here in units of 1 / coarse.
TexelSpan span_of_texel(int i, int fine, int coarse) noexcept {
    const std::int64_t from = std::int64_t{i} * fine, to = from + fine;
    const Box met = texels_over({i, 0, i + 1, 1}, {coarse, 1}, {fine, 1});
    TexelSpan span{met.x0, 0, {}};
    for (std::int64_t k = met.x0; k < met.x1; ++k) {
        const std::int64_t overlap = std::min((k + 1) * coarse, to) - std::max(k * coarse, from);
        span.weight[static_cast<std::size_t>(span.count++)] =
            static_cast<float>(static_cast<double>(overlap) / fine);
    }
    return span;
}

namespace {

std::vector<TexelSpan> spans_of(int first, int end, int fine, int coarse) {
    std::vector<TexelSpan> spans;
    for (int i = first; i < end; ++i) spans.push_back(span_of_texel(i, fine, coarse));
    return spans;
}

// Channels as plain numbers: integers need not be normalised to be averaged.
float number(std::uint8_t value) {
    return value;
}
float number(std::uint16_t value) {
    return value;
}
float number(float value) {
    return value;
}
struct Half {
    std::uint16_t bits;
};
float number(Half value) {
    return float_from_half(value.bits);
}

/// To the nearest integer, ties to even, for 0 <= value < 2^22.
float nearest(float value) {
    return (value + 0x1.8p23f) - 0x1.8p23f;
}
void assign(float value, std::uint8_t& to) {
    to = static_cast<std::uint8_t>(nearest(value));
}
void assign(float value, std::uint16_t& to) {
    to = static_cast<std::uint16_t>(nearest(value));
}
void assign(float value, float& to) {
    to = value;
}
void assign(float value, Half& to) {
    to.bits = half_from_float(value);
}

/// sum += weight * row, pixel by pixel; colour multiplied by alpha where `alpha` >= 0.
template <class T>
void add_row(const std::byte* __restrict row, float weight, int values, int channels, int alpha,
             float* __restrict sum) {
    const auto at = [&](int i) { return number(pixel_detail::get<T>(row + i * std::ptrdiff_t{sizeof(T)})); };
    if (alpha < 0) {
        for (int i = 0; i < values; ++i) sum[i] += weight * at(i);
        return;
    }
    for (int i = 0; i < values; i += channels) {
        const float a = at(i + alpha);
        for (int c = 0; c < channels && a != 0; ++c) sum[i + c] += weight * (c == alpha ? a : a * at(i + c));
    }
}

/// Averages a row, which begins at texel `first` of the finer level.
void average_row(const float* __restrict row, const std::vector<TexelSpan>& spans, int first, int channels,
                 float* __restrict average) {
    for (const TexelSpan& span : spans) {
        const float* from = row + std::ptrdiff_t{span.first - first} * channels;
        const float w0 = span.weight[0], w1 = span.weight[1];
        for (int c = 0; c < channels; ++c) average[c] = w0 * from[c] + w1 * from[channels + c];
        for (int k = 2; k < span.count; ++k)
            for (int c = 0; c < channels; ++c)
                average[c] += span.weight[static_cast<std::size_t>(k)] * from[k * channels + c];
        average += channels;
    }
}

template <class T>
void store_row(const float* __restrict values, int count, std::byte* __restrict row) {
    for (int i = 0; i < count; ++i) {
        T stored;
        assign(values[i], stored);
        pixel_detail::put(stored, row + i * std::ptrdiff_t{sizeof(T)});
    }
}

/// Averages `fine`, whose texel (0, 0) is `corner` of the finer level, to the coarser rows of `coarse`.
template <class T>
void reduce(const ConstImageView& fine, int corner_x, int corner_y, const std::vector<TexelSpan>& across,
            const std::vector<TexelSpan>& down, int alpha, std::byte* coarse, std::ptrdiff_t row_stride) {
    const int channels = fine.channels, values = fine.width * channels;
    const int count = static_cast<int>(across.size()) * channels;
    std::vector<float> sum(static_cast<std::size_t>(values)), average(static_cast<std::size_t>(count));
    for (const TexelSpan& span : down) {
        std::fill(sum.begin(), sum.end(), 0.0f);
        for (int k = 0; k < span.count; ++k)
            add_row<T>(fine.at(0, span.first - corner_y + k), span.weight[static_cast<std::size_t>(k)],
                       values, channels, alpha, sum.data());
        average_row(sum.data(), across, corner_x, channels, average.data());
        for (int i = 0; alpha >= 0 && i < count; i += channels)
            unassociate_alpha(&average[static_cast<std::size_t>(i)], channels, alpha);
        store_row<T>(average.data(), count, coarse);
        coarse += row_stride;
    }
}

}  // namespace

struct Pyramid::Level {
    /// `halvings`: of the base, 1 or more.
    Level(const SourceLevel& level, int halvings, PixelType type, int channels)
        : size(level.size),
          extent(level.extent),
          tile_height(std::max(kTile >> halvings, kLeastTileHeight)),
          tiles_x((extent.width() + kTile - 1) / kTile),
          tiles_y((extent.height() + tile_height - 1) / tile_height),
          pages(static_cast<std::size_t>(extent.width()) * static_cast<std::size_t>(extent.height()) *
                static_cast<std::size_t>(channels * size_of(type))),
          view(packed_view<const std::byte>(pages.data(), type, extent.width(), extent.height(), channels)),
          ready(std::make_unique<std::atomic<bool>[]>(static_cast<std::size_t>(tiles_x) *
                                                      static_cast<std::size_t>(tiles_y))) {}

    bool is_whole() const { return extent == SourceLevel(size).extent; }
    /// A box of the level as one of `view`.
    Box in_view(const Box& box) const {
        return {box.x0 - extent.x0, box.y0 - extent.y0, box.x1 - extent.x0, box.y1 - extent.y0};
    }

    Size size;
    Box extent;
    int tile_height, tiles_x, tiles_y;
    Pages pages;
    ConstImageView view;  ///< of the extent
    std::unique_ptr<std::atomic<bool>[]> ready;
    // One for every 16th tile. A thread holds at most one of a level, and goes from coarse to fine.
    mutable std::array<std::mutex, 16> making;
};

Pyramid::Pyramid(const Source& base, int columns, int rows) : m_base(base) {
    // Colour that is yet to be multiplied by alpha is filtered as floats.
    const PixelType filtered = base.unassociated_alpha() < 0 ? base.type() : PixelType::float32;
    if (!has_loops(filtered)) refuse_texels(filtered);
    if (base.levels() != 1) return;
    const bool pieces = columns > 1 || rows > 1;
    SourceLevel finer = base.level(0);
    for (;;) {
        const Size size = finer.size, next{size.width / 2, size.height / 2};
        if (next.width / columns < kLeast || next.height / rows < kLeast) return;
        if (pieces && (size.width % (2 * columns) != 0 || size.height % (2 * rows) != 0)) return;
        finer = {next, texels_over(finer.extent, size, next)};
        const int halvings = static_cast<int>(m_made.size()) + 1;
        m_made.push_back(std::make_unique<Level>(finer, halvings, base.type(), base.channels()));
    }
}

Pyramid::~Pyramid() = default;

Size Pyramid::size(int level) const noexcept {
    return made(level) ? at(level).size : m_base.size(level);
}

Box Pyramid::extent(int level) const noexcept {
    return made(level) ? at(level).extent : m_base.extent(level);
}

const ConstImageView* Pyramid::view(int level) const noexcept {
    if (!made(level)) return m_base.view(level);
    return at(level).is_whole() ? &at(level).view : nullptr;
}

bool Pyramid::read(int level, const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const noexcept {
    if (!made(level)) return m_base.read(level, box, texels, row_stride);
    if (!prepare(level, box)) return false;
    const ConstImageView& from = at(level).view;
    const Box rows = at(level).in_view(box);
    for (int y = rows.y0; y < rows.y1; ++y, texels += row_stride)
        std::memcpy(texels, from.at(rows.x0, y), static_cast<std::size_t>(from.pixel_stride * rows.width()));
    return true;
}

bool Pyramid::prepare(int level, const Box& box) const noexcept try {
    if (!made(level)) return m_base.prepare(level, box);
    if (box.empty()) return true;
    const Level& to = at(level);
    const Box part = to.in_view(box);
    for (int ty = part.y0 / to.tile_height; ty <= (part.y1 - 1) / to.tile_height; ++ty)
        for (int tx = part.x0 / kTile; tx <= (part.x1 - 1) / kTile; ++tx) {
            const std::size_t tile = static_cast<std::size_t>(ty) * static_cast<std::size_t>(to.tiles_x) +
                                     static_cast<std::size_t>(tx);
            std::atomic<bool>& ready = to.ready[tile];
            if (ready.load(std::memory_order_acquire)) continue;
            const std::lock_guard lock(to.making[tile % to.making.size()]);
            if (ready.load(std::memory_order_relaxed)) continue;
            const int x = to.extent.x0 + tx * kTile, y = to.extent.y0 + ty * to.tile_height;
            const Box tile_box{x, y, x + kTile, y + to.tile_height};
            if (!make_tile(level, intersection(to.extent, tile_box))) return false;
            ready.store(true, std::memory_order_release);
        }
    return true;
} catch (const std::exception&) {
    return false;
}

const SummedAreas* Pyramid::summed_areas(int level) const noexcept try {
    const std::lock_guard lock(m_summing);
    m_sums.resize(static_cast<std::size_t>(levels()));
    auto& sums = m_sums[static_cast<std::size_t>(level)];
    if (!sums) sums = std::make_unique<const SummedAreas>(*this, level);
    return sums.get();
} catch (const std::exception&) {
    return nullptr;
}

bool Pyramid::make_tile(int level, const Box& tile) const {
    const Level& to = at(level);
    // What the image has nothing of is 0 as it stands, however large its picture is. Level by level, since texels of odd sizes reach
    // farther so than by one step to the base.
    Box under = tile;
    for (int finer = level - 1; finer >= 0; --finer) under = texels_over(under, size(finer + 1), size(finer));
    if (intersection(under, data_window()).empty()) return true;
    const Size finer = size(level - 1);
    const std::vector<TexelSpan> across = spans_of(tile.x0, tile.x1, finer.width, to.size.width);
    const std::vector<TexelSpan> down = spans_of(tile.y0, tile.y1, finer.height, to.size.height);
    const Box box{across.front().first, down.front().first, across.back().first + across.back().count,
                  down.back().first + down.back().count};

    // The finer texels where they stand, or copied.
    ConstImageView fine;
    std::vector<std::byte> copy;
    const ConstImageView* whole = view(level - 1);
    if (whole && whole->packed()) {
        if (!prepare(level - 1, box)) return false;
        fine = *whole;
        fine.data = whole->at(box.x0, box.y0);
        fine.width = box.width();
        fine.height = box.height();
    } else {
        // Texels on the outer edges of the extent may cover some that the finer level lacks: 0.
        const Box there = intersection(box, extent(level - 1));
        const std::ptrdiff_t pixel = std::ptrdiff_t{channels()} * size_of(type()),
                             stride = box.width() * pixel;
        copy.resize(static_cast<std::size_t>(stride * box.height()));
        if (!read(level - 1, there, copy.data() + (there.y0 - box.y0) * stride + (there.x0 - box.x0) * pixel,
                  stride))
            return false;
        fine = packed_view<const std::byte>(copy.data(), type(), box.width(), box.height(), channels());
    }

    const Box in_view = to.in_view(tile);
    const std::ptrdiff_t offset = to.view.at(in_view.x0, in_view.y0) - to.view.data;
    const auto run = [&]<class T>(T) {
        reduce<T>(fine, box.x0, box.y0, across, down, unassociated_alpha(), to.pages.data() + offset,
                  to.view.row_stride);
    };
    switch (type()) {
        case PixelType::uint8:
            run(std::uint8_t{});
            break;
        case PixelType::uint16:
            run(std::uint16_t{});
            break;
        case PixelType::half:
            run(Half{});
            break;
        case PixelType::float32:
            run(float{});
            break;
    }
    return true;
}

}  // namespace anamorph
