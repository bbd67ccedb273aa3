// SPDX-License-Identifier: Apache-2.0
#include "anamorph/picture_tiles.h"

#include <algorithm>
#include <vector>

namespace anamorph {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

namespace {

HashedNumbers numbers_of(const TypeDesc& type) {
    return {static_cast<int>(type.basesize()), type.is_floating_point()};
}

}  // namespace

Box TileGrid::box(std::int64_t i, std::int64_t number) const {
    const int x = static_cast<int>(i % columns()) * kSide, y = static_cast<int>(i / columns()) * kSide;
    return {x, y, static_cast<int>(std::min<std::int64_t>(width, x + number * kSide)),
            std::min(height, y + kSide)};
}

std::int64_t TileGrid::together(std::int64_t i, std::int64_t end) const {
    constexpr std::int64_t kMost = 16;
    return std::min({kMost, end - i, columns() - i % columns()});
}

std::string picture_text(const ImageSpec& spec) {
    std::string text = "picture";
    for (const int number : {spec.x, spec.y, spec.width, spec.height, spec.full_x, spec.full_y,
                             spec.full_width, spec.full_height})
        text.append(1, ' ').append(std::to_string(number));
    text += "\n";
    for (int c = 0; c < spec.nchannels; ++c)
        text.append("channel ")
            .append(spec.channel_name(c))
            .append(1, ' ')
            .append(spec.channelformat(c).c_str())
            .append(1, '\n');
    return text;
}

PictureHash hash_of_tile(const ImageSpec& spec, const std::byte* pixels, std::size_t row_bytes, int width,
                         int height) {
    PictureHasher hasher;
    const std::size_t pixel = spec.pixel_bytes(true);
    for (int y = 0; y < height; ++y, pixels += row_bytes) {
        if (spec.channelformats.empty()) {
            hasher.add_numbers({pixels, pixel * static_cast<std::size_t>(width)}, numbers_of(spec.format));
            continue;
        }
        const std::byte* at = pixels;
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < spec.nchannels; ++c) {
                const HashedNumbers kind = numbers_of(spec.channelformat(c));
                hasher.add_numbers({at, static_cast<std::size_t>(kind.bytes)}, kind);
                at += kind.bytes;
            }
    }
    return hasher.hash();
}

FileHasher::FileHasher() {
    m_hasher.add("anamorph hash 1\n");
}
void FileHasher::begin(const ImageSpec& spec) {
    m_hasher.add(picture_text(spec));
}

void FileHasher::add_picture(const ImageSpec& spec,
                             const std::function<void(const Box& box, std::byte* pixels)>& read) {
    begin(spec);
    const TileGrid tiles(spec);
    const std::size_t pixel = spec.pixel_bytes(true);
    std::vector<std::byte> pixels;
    for (std::int64_t i = 0, n = 0; i < tiles.count(); i += n) {
        n = tiles.together(i, tiles.count());
        const Box box = tiles.box(i, n);
        const std::size_t row = pixel * static_cast<std::size_t>(box.width());
        pixels.resize(row * static_cast<std::size_t>(box.height()));
        read(box, pixels.data());
        for (std::int64_t k = 0; k < n; ++k) {
            const Box tile = tiles.box(i + k);
            add(hash_of_tile(spec, pixels.data() + pixel * static_cast<std::size_t>(tile.x0 - box.x0), row,
                             tile.width(), tile.height()));
        }
    }
}

}  // namespace anamorph
