// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/picture_tiles.h"

#include <algorithm>

namespace anamorph {
namespace {

HashedPicture::Channel channel_of(const std::string& name, PixelType type) {
    constexpr const char* kTypes[] = {"uint8", "uint16", "half", "float"};
    const bool floating = type == PixelType::half || type == PixelType::float32;
    return {name, kTypes[static_cast<int>(type)], {static_cast<int>(size_of(type)), floating}};
}

}  // namespace

HashedPicture::HashedPicture(int width, int height, PixelType type, const std::vector<std::string>& names)
    : data{0, 0, width, height}, display(data) {
    for (const std::string& name : names) channels.push_back(channel_of(name, type));
}

std::size_t HashedPicture::pixel_bytes() const {
    std::size_t bytes = 0;
    for (const Channel& channel : channels) bytes += static_cast<std::size_t>(channel.numbers.bytes);
    return bytes;
}

std::string HashedPicture::text() const {
    std::string text = "picture";
    for (const Box& window : {data, display})
        for (const int number : {window.x0, window.y0, window.width(), window.height()})
            text.append(1, ' ').append(std::to_string(number));
    text += "\n";
    for (const Channel& channel : channels)
        text.append("channel ").append(channel.name).append(1, ' ').append(channel.type).append(1, '\n');
    return text;
}

PictureHash HashedPicture::hash_of_tile(const std::byte* pixels, std::size_t row_bytes, int width,
                                        int height) const {
    PictureHasher hasher;
    const std::size_t row = pixel_bytes() * static_cast<std::size_t>(width);
    const auto same_numbers = [&](const Channel& c) {
        return c.numbers.bytes == channels[0].numbers.bytes &&
               c.numbers.floating == channels[0].numbers.floating;
    };
    const bool one_type = std::all_of(channels.begin(), channels.end(), same_numbers);
    for (int y = 0; y < height; ++y, pixels += row_bytes) {
        if (one_type) {
            if (!channels.empty()) hasher.add_numbers({pixels, row}, channels[0].numbers);
            continue;
        }
        const std::byte* at = pixels;
        for (int x = 0; x < width; ++x)
            for (const Channel& channel : channels) {
                const auto bytes = static_cast<std::size_t>(channel.numbers.bytes);
                hasher.add_numbers({at, bytes}, channel.numbers);
                at += bytes;
            }
    }
    return hasher.hash();
}

Box TileGrid::box(std::int64_t i, std::int64_t number) const {
    const int x = static_cast<int>(i % columns()) * kSide, y = static_cast<int>(i / columns()) * kSide;
    return {x, y, static_cast<int>(std::min<std::int64_t>(width, x + number * kSide)),
            std::min(height, y + kSide)};
}

std::int64_t TileGrid::together(std::int64_t i, std::int64_t end) const {
    constexpr std::int64_t kMost = 16;
    return std::min({kMost, end - i, columns() - i % columns()});
}

FileHasher::FileHasher() {
    m_hasher.add("anamorph hash 1\n");
}

void FileHasher::add_picture(const HashedPicture& picture,
                             const std::function<void(const Box& box, std::byte* pixels)>& read) {
    begin(picture);
    const TileGrid tiles({picture.data.width(), picture.data.height()});
    const std::size_t pixel = picture.pixel_bytes();
    std::vector<std::byte> pixels;
    for (std::int64_t i = 0, n = 0; i < tiles.count(); i += n) {
        n = tiles.together(i, tiles.count());
        const Box box = tiles.box(i, n);
        const std::size_t row = pixel * static_cast<std::size_t>(box.width());
        pixels.resize(row * static_cast<std::size_t>(box.height()));
        read(box, pixels.data());
        for (std::int64_t k = 0; k < n; ++k) {
            const Box tile = tiles.box(i + k);
            add(picture.hash_of_tile(pixels.data() + pixel * static_cast<std::size_t>(tile.x0 - box.x0), row,
                                     tile.width(), tile.height()));
        }
    }
}

}  // namespace anamorph
