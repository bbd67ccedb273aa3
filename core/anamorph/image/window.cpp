// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/window.h"

#include <cstring>
#include <exception>

#include "anamorph/image/pixel.h"

namespace anamorph {
namespace {

bool holds(const Box& outer, const Box& inner) {
    return outer.x0 <= inner.x0 && outer.y0 <= inner.y0 && inner.x1 <= outer.x1 && inner.y1 <= outer.y1;
}

/// May kSlack bytes be read behind every row of `box` without leaving the image?
bool has_slack(const ConstImageView& image, const Box& box) {
    // Behind the row of the highest address, in it and in the rows that follow it in memory.
    const std::ptrdiff_t rows = image.row_stride >= 0 ? image.height - box.y1 : box.y0;
    const std::ptrdiff_t stride = image.row_stride >= 0 ? image.row_stride : -image.row_stride;
    return rows * stride + (image.width - box.x1) * image.pixel_stride >= Window::kSlack;
}

/// May the loops read the image where it stands: packed pixels, rows whole channels apart?
bool is_readable(const ConstImageView& image) {
    return image.packed() && image.row_stride % size_of(image.type) == 0;
}

/// A rectangle of texels of the source and the place it is copied to, relative to the window's corner.
struct Patch {
    Box texels;
    int x, y;
    bool none;
};

/// Collects the texels outside the interior, row by row, into few rectangles.
class Patches {
  public:
    void add(int x, int y, const TexelRun& run) {
        const Texel& texel = run.first;
        if (m_row != y) {
            join_rows();
            m_above = m_begin;
            m_begin = m_patches.size();
            m_row = y;
        }
        if (m_patches.size() > m_begin) {
            Patch& last = m_patches.back();
            const bool follows = last.x + last.texels.width() == x && last.none == texel.none &&
                                 (texel.none || (last.texels.x1 == texel.x && last.texels.y0 == texel.y));
            if (follows) {
                last.texels.x1 += run.count;
                return;
            }
        }
        m_patches.push_back({{texel.x, texel.y, texel.x + run.count, texel.y + 1}, x, y, texel.none});
    }
    const std::vector<Patch>& finish() {
        join_rows();
        m_begin = m_patches.size();
        return m_patches;
    }

  private:
    /// Lengthens the patches of the row above downwards when the whole row continues them.
    void join_rows() {
        const std::size_t count = m_patches.size() - m_begin;
        if (count == 0 || m_begin - m_above != count) return;
        for (std::size_t i = 0; i < count; ++i) {
            const Patch &a = m_patches[m_above + i], &b = m_patches[m_begin + i];
            const bool continues = a.x == b.x && a.y + a.texels.height() == b.y && a.none == b.none &&
                                   a.texels.width() == b.texels.width() &&
                                   (a.none || (a.texels.x0 == b.texels.x0 && a.texels.y1 == b.texels.y0));
            if (!continues) return;
        }
        for (std::size_t i = 0; i < count; ++i) ++m_patches[m_above + i].texels.y1;
        m_patches.resize(m_begin);
        m_begin = m_above;
    }

    std::vector<Patch> m_patches;
    std::size_t m_above = 0, m_begin = 0;
    int m_row = 0;
};

/// Copies one level's texels of a box that may reach over every edge.
class Gather {
  public:
    Gather(const Source& source, const Border& border, int level, int piece, const Box& box,
           std::byte* texels, std::ptrdiff_t row_stride)
        : m_source(source),
          m_border(border),
          m_level(level),
          m_piece(piece),
          m_box(box),
          m_texels(texels),
          m_row_stride(row_stride),
          m_pixel(std::ptrdiff_t{source.channels()} * size_of(source.type())) {}

    bool run() const {
        const SourceLevel level = m_source.level(m_level);
        const Box own = intersection(m_box, m_border.interior(m_piece, level));
        if (!own.empty() &&
            !m_source.read(m_level, own, at(own.x0 - m_box.x0, own.y0 - m_box.y0), m_row_stride))
            return false;
        if (own == m_box) return true;

        Patches patches;
        for (int y = m_box.y0; y < m_box.y1; ++y) {
            const bool crosses = !own.empty() && own.y0 <= y && y < own.y1;
            for (int x = m_box.x0; x < m_box.x1;) {
                if (crosses && x == own.x0) {
                    x = own.x1;
                    continue;
                }
                const int limit = (crosses && x < own.x0 ? own.x0 : m_box.x1) - x;
                const TexelRun run = m_border.resolve_run(x, y, m_piece, level, limit);
                patches.add(x - m_box.x0, y - m_box.y0, run);
                x += run.count;
            }
        }
        for (const Patch& patch : patches.finish())
            if (!fill(patch)) return false;
        return true;
    }

  private:
    std::byte* at(int x, int y) const { return m_texels + y * m_row_stride + x * m_pixel; }

    bool fill(const Patch& patch) const {
        if (!patch.none) return m_source.read(m_level, patch.texels, at(patch.x, patch.y), m_row_stride);
        for (int y = 0; y < patch.texels.height(); ++y)
            std::memset(at(patch.x, patch.y + y), 0,
                        static_cast<std::size_t>(patch.texels.width() * m_pixel));
        return true;
    }

    const Source& m_source;
    const Border& m_border;
    int m_level, m_piece;
    Box m_box;
    std::byte* m_texels;
    std::ptrdiff_t m_row_stride, m_pixel;
};

void grow(std::vector<std::byte>& bytes, std::int64_t size) {
    if (bytes.size() < static_cast<std::size_t>(size)) bytes.resize(static_cast<std::size_t>(size));
}

}  // namespace

const ConstImageView* WindowReader::view_of(int level, const Box& texels) const noexcept {
    const ConstImageView* image =
        !texels.empty() && m_source.unassociated_alpha() < 0 ? m_source.view(level) : nullptr;
    return image && is_readable(*image) && has_slack(*image, texels) ? image : nullptr;
}

Box WindowReader::place_of(int level, int piece, const Box& box) const noexcept {
    const SourceLevel of = m_source.level(level);
    if (holds(m_border.interior(piece, of), box)) return box;
    const std::int64_t width = std::int64_t{box.x1} - box.x0, height = std::int64_t{box.y1} - box.y0;
    if (width <= 0 || height <= 0 || width > of.size.width || height > of.size.height) return {};
    Box place;
    for (int j = 0; j < box.height(); ++j) {
        const TexelRun run = m_border.resolve_run(box.x0, box.y0 + j, piece, of, box.width());
        const Texel& first = run.first;
        if (j == 0) place = {first.x, first.y, first.x + box.width(), first.y + box.height()};
        const bool follows = first.x == place.x0 && first.y == place.y0 + j;
        if (first.none || run.count < box.width() || !follows) return {};
    }
    return place;
}

bool WindowReader::get_in_place(int level, int piece, const Box& box, Window& window) noexcept {
    const Box place = place_of(level, piece, box);
    const ConstImageView* image = view_of(level, place);
    if (!image || !m_source.prepare(level, place)) return false;
    window = {image->at(place.x0, place.y0), m_source.type(), m_source.channels(), image->row_stride, box};
    return true;
}

bool WindowReader::get(int level, int piece, const Box& box, Window& window) noexcept {
    return get_in_place(level, piece, box, window) || get_copy(level, piece, box, window);
}

bool WindowReader::get_copy(int level, int piece, const Box& box, Window& window) noexcept try {
    const std::int64_t width = std::int64_t{box.x1} - box.x0, height = std::int64_t{box.y1} - box.y0;
    if (width <= 0 || height <= 0 || width > kMaxTexels || height > kMaxTexels || width * height > kMaxTexels)
        return false;
    const int channels = m_source.channels(), alpha = m_source.unassociated_alpha();
    const PixelType type = m_source.type();
    const std::int64_t pixel = std::int64_t{channels} * size_of(type);

    std::vector<std::byte>& raw = alpha < 0 ? m_texels : m_raw;
    grow(raw, height * width * pixel + Window::kSlack);
    if (!Gather(m_source, m_border, level, piece, box, raw.data(), width * pixel).run()) return false;
    window = {raw.data(), type, channels, static_cast<std::ptrdiff_t>(width * pixel), box};
    if (alpha < 0) return true;

    const std::int64_t values = width * height * channels;
    grow(m_texels, values * std::int64_t{sizeof(float)} + Window::kSlack);
    float* pixels = reinterpret_cast<float*>(m_texels.data());
    load_channels(raw.data(), type, values, pixels);
    for (std::int64_t i = 0; i < values; i += channels) associate_alpha(pixels + i, channels, alpha);
    const std::int64_t row = width * channels * std::int64_t{sizeof(float)};
    window = {m_texels.data(), PixelType::float32, channels, static_cast<std::ptrdiff_t>(row), box};
    return true;
} catch (const std::exception&) {
    return false;
}

}  // namespace anamorph
