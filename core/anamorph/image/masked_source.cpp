// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/masked_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include "anamorph/image/pixel.h"

namespace anamorph {
namespace {

/// The texels of a row within [x0, x1) whose middles lie right of a point: from the one that is returned on.
int first_right_of(double x, int x0, int x1) noexcept {
    return static_cast<int>(std::clamp(std::ceil(x - 0.5), double(x0), double(x1)));
}

/// Marks the first of the texels of a row that lie right of each edge that crosses it, in the second bit: what has an odd number of
/// edges on its left is inside.
void mark_edges(const std::vector<Point<double>>& polygon, int y, int x0, int x1,
                unsigned char* edges) noexcept {
    const double middle = y + 0.5;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point<double>&a = polygon[i], &b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
        if ((a.y <= middle) == (b.y <= middle)) continue;
        const double x = a.x + (b.x - a.x) * ((middle - a.y) / (b.y - a.y));
        if (const int at = first_right_of(x, x0, x1); at < x1) edges[at - x0] ^= 2;
    }
}

}  // namespace

void SourceMask::write_row(int y, int x0, int x1, unsigned char* counts) const noexcept {
    const auto keep_only = [&](int from, int to) {
        for (int x = x0; x < x1; ++x)
            if (x < from || x >= to) counts[x - x0] = 0;
    };
    std::fill_n(counts, x1 - x0, static_cast<unsigned char>(1));
    if (rectangle) keep_only(y < rectangle->y0 || y >= rectangle->y1 ? x1 : rectangle->x0, rectangle->x1);
    if (circle) {
        const double down = y + 0.5 - circle->middle.y;
        for (int x = x0; x < x1; ++x) {
            const double across = x + 0.5 - circle->middle.x;
            if (!(across * across + down * down <= circle->radius * circle->radius)) counts[x - x0] = 0;
        }
    }
    for (const std::vector<Point<double>>& polygon : holes) {
        mark_edges(polygon, y, x0, x1, counts);
        bool is_inside = false;
        for (int x = x0; x < x1; ++x) {
            unsigned char& texel = counts[x - x0];
            is_inside = is_inside != ((texel & 2) != 0);
            texel = (texel & 1) != 0 && !is_inside ? 1 : 0;
        }
    }
    for (int x = x0; shows && x < x1; ++x)
        if (counts[x - x0] != 0 && !shows(x + 0.5, y + 0.5)) counts[x - x0] = 0;
}

void MaskedSource::write(const float* from, bool counts, float* to) const noexcept {
    const int channels = m_base.channels();
    std::fill_n(to, this->channels(), 0.0f);
    if (!counts) return;
    std::copy_n(from, channels, to);
    if (m_alpha < 0) to[channels] = 1;
}

bool MaskedSource::read(int level, const Box& box, std::byte* texels,
                        std::ptrdiff_t row_stride) const noexcept {
    const auto width = static_cast<std::size_t>(box.width());
    const int channels = m_base.channels();
    const std::size_t values = width * static_cast<std::size_t>(channels),
                      row = values * static_cast<std::size_t>(size_of(m_base.type()));
    const auto rows = static_cast<std::size_t>(box.height());
    const std::unique_ptr<std::byte[]> base(new (std::nothrow) std::byte[row * rows]);
    const std::unique_ptr<float[]> loaded(new (std::nothrow) float[values]);
    const std::unique_ptr<unsigned char[]> counts(new (std::nothrow) unsigned char[width]);
    if (!base || !loaded || !counts) return false;
    if (!m_base.read(level, box, base.get(), static_cast<std::ptrdiff_t>(row))) return false;
    for (int y = box.y0; y < box.y1; ++y) {
        load_channels(base.get() + static_cast<std::size_t>(y - box.y0) * row, m_base.type(),
                      static_cast<std::int64_t>(values), loaded.get());
        m_mask.write_row(y, box.x0, box.x1, counts.get());
        auto* const to = reinterpret_cast<float*>(texels + (y - box.y0) * row_stride);
        for (std::size_t x = 0; x < width; ++x)
            write(loaded.get() + x * static_cast<std::size_t>(channels), counts[x] != 0,
                  to + x * static_cast<std::size_t>(this->channels()));
    }
    return true;
}

}  // namespace anamorph
