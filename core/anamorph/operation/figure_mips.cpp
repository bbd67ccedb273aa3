// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/figure_mips.h"

#include <algorithm>
#include <utility>

#include "anamorph/image/border.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/window.h"

namespace anamorph {
namespace {

/// A level as numbers: red, green and blue of each texel.
struct Texels {
    Size size;
    std::vector<float> values;

    std::size_t at(int x, int y) const {
        return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                    static_cast<std::size_t>(x));
    }
};

/// Part of a level that a source has. Nothing where it cannot be read.
std::optional<Texels> texels_of(const Source& source, int level, const Box& box) {
    const Size size = source.size(level);
    const Border border(Chart(Projection::rectilinear, size.width, size.height), Wrap::clamp);
    WindowReader reader(source, border);
    Texels texels{{box.width(), box.height()}, {}};
    const int channels = source.channels();
    for (int y = box.y0; y < box.y1; ++y) {
        Window window;
        if (!reader.get(level, 0, {box.x0, y, box.x1, y + 1}, window)) return std::nullopt;
        for (int x = 0; x < box.width(); ++x)
            for (int c = 0; c < 3; ++c) {
                // Gray has one channel for all three.
                const int from = x * channels + (channels < 3 ? 0 : c);
                texels.values.push_back(
                    load_channel(window.texels + std::ptrdiff_t{from} * size_of(window.type), window.type));
            }
    }
    return texels;
}

/// Half as large, the means of two texels each way.
Texels half_of(const Texels& fine) {
    Texels coarse{{std::max(1, fine.size.width / 2), std::max(1, fine.size.height / 2)}, {}};
    for (int y = 0; y < coarse.size.height; ++y)
        for (int x = 0; x < coarse.size.width; ++x)
            for (std::size_t c = 0; c < 3; ++c) {
                const int x1 = std::min(2 * x + 1, fine.size.width - 1),
                          y1 = std::min(2 * y + 1, fine.size.height - 1);
                const auto& v = fine.values;
                coarse.values.push_back(0.25f * (v[fine.at(2 * x, 2 * y) + c] + v[fine.at(x1, 2 * y) + c] +
                                                 v[fine.at(2 * x, y1) + c] + v[fine.at(x1, y1) + c]));
            }
    return coarse;
}

class SolvedMips final : public SolvedPicture {
  public:
    /// `index`: of the source; `maps` stand for it where they are given.
    SolvedMips(std::size_t index, const Size& texture, std::shared_ptr<const Source> maps)
        : m_index(index), m_texture(texture), m_maps(std::move(maps)) {}

    Attributes reached(const ParallelFor&) const override { return {}; }

    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor&) const override {
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x) store(view, box, x, y, 0);
        const Source* source = m_maps ? m_maps.get() : m_index < sources.size() ? sources[m_index] : nullptr;
        if (!source) return true;
        Size size = m_texture;
        std::optional<Texels> last;
        for (int level = 0;; ++level) {
            if (level < source->levels()) {
                size = source->size(level);
                if (!draw_level(*source, level, size, box, view)) return false;
                last.reset();
            } else {
                if (!last) last = texels_of(*source, level - 1, {0, 0, size.width, size.height});
                if (!last) return false;
                last = half_of(*last);
                size = last->size;
                for (int c = 0; c < 3; ++c) place(*last, {0, 0, size.width, size.height}, c, size, box, view);
            }
            // The next level would not fit into the quarter.
            if (size.width == 1 || size.height == 1) return true;
        }
    }

  private:
    static void store(const ImageView& view, const Box& box, int x, int y, float value) {
        store_channel(value, view.at(x - box.x0, y - box.y0), view.type);
    }
    /// Where a channel of a level is.
    static Box quarter(int c, const Size& size) {
        const int x = c == 1 ? 0 : size.width, y = c == 0 ? 0 : size.height;
        return {x, y, x + size.width, y + size.height};
    }
    static bool draw_level(const Source& source, int level, const Size& size, const Box& box,
                           const ImageView& view) {
        for (int c = 0; c < 3; ++c) {
            const Box to = quarter(c, size), part = intersection(to, box);
            if (part.empty()) continue;
            const Box from = {part.x0 - to.x0, part.y0 - to.y0, part.x1 - to.x0, part.y1 - to.y0};
            const std::optional<Texels> texels = texels_of(source, level, from);
            if (!texels) return false;
            place(*texels, from, c, size, box, view);
        }
        return true;
    }
    /// `texels`: those of `from`, a part of the level.
    static void place(const Texels& texels, const Box& from, int c, const Size& size, const Box& box,
                      const ImageView& view) {
        const Box to = quarter(c, size);
        for (int y = from.y0; y < from.y1; ++y)
            for (int x = from.x0; x < from.x1; ++x)
                if (contains(box, to.x0 + x, to.y0 + y))
                    store(view, box, to.x0 + x, to.y0 + y,
                          texels.values[texels.at(x - from.x0, y - from.y0) + static_cast<std::size_t>(c)]);
    }
    static bool contains(const Box& box, int x, int y) {
        return x >= box.x0 && x < box.x1 && y >= box.y0 && y < box.y1;
    }

    std::size_t m_index;
    Size m_texture;
    std::shared_ptr<const Source> m_maps;
};

class MipPictures final : public Pictures {
  public:
    MipPictures(std::vector<MipTexture> textures, Attributes says)
        : m_textures(std::move(textures)), m_says(std::move(says)) {}

    int frames() const override { return static_cast<int>(m_textures.size()); }

    std::optional<PictureRequest> picture(int frame, int level) const override {
        if (level > 0) return {};
        const MipTexture& texture = m_textures[static_cast<std::size_t>(frame)];
        const auto index = static_cast<std::size_t>(
            std::count_if(m_textures.begin(), m_textures.begin() + frame,
                          [](const MipTexture& before) { return before.maps == nullptr; }));
        const Size size = texture.size.value_or(Size{1, 1});
        PictureRequest picture;
        picture.size = {2 * size.width, 2 * size.height};
        picture.channels = {"Y"};
        picture.says = m_says;
        picture.says.push_back({"anamorph:texture", texture.name});
        picture.solve = [index, size, maps = texture.maps] {
            return std::make_unique<SolvedMips>(index, size, maps);
        };
        return picture;
    }

  private:
    std::vector<MipTexture> m_textures;
    Attributes m_says;
};

}  // namespace

std::unique_ptr<const Pictures> mip_pictures(std::vector<MipTexture> textures, const Attributes& says) {
    return std::make_unique<MipPictures>(std::move(textures), says);
}

}  // namespace anamorph
