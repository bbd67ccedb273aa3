// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/image/mrasel_maps.h"

#include <cstring>

#include "anamorph/error.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

void check_bytes(std::string_view bytes, std::string_view name, int side) {
    if (bytes.size() == bytes_of_map(side)) return;
    const std::string n = std::to_string(side);
    text_file::fail(name, "",
                    "has " + std::to_string(bytes.size()) + " bytes: must have " +
                        std::to_string(bytes_of_map(side)) + ", a map of " + n + " by " + n +
                        " texels of red, green and blue");
}

/// Sums of the texels that each texel of a map covers of the largest.
using Sums = std::vector<std::uint32_t>;

Sums sums_of(std::string_view base) {
    Sums sums;
    sums.reserve(base.size());
    for (const char c : base) sums.push_back(static_cast<unsigned char>(c));
    return sums;
}

/// The sums of a map half as wide and high. The largest, 255 * 512^2, fits.
Sums halved(const Sums& fine, std::size_t side) {
    Sums coarse;
    coarse.reserve(fine.size() / 4);
    for (std::size_t y = 0; y < side; y += 2)
        for (std::size_t x = 0; x < side; x += 2)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t above = 3 * (y * side + x) + c, below = above + 3 * side;
                coarse.push_back(fine[above] + fine[above + 3] + fine[below] + fine[below + 3]);
            }
    return coarse;
}

}  // namespace

std::string mrasel_map_file(const std::string& name, int side) {
    return name + "." + std::to_string(side);
}

MraselMaps MraselMaps::made_of(std::string_view base, std::string_view name) {
    check_bytes(base, name, kMraselSide);
    MraselMaps maps;
    maps.m_maps[0] = base;
    Sums sums = sums_of(base);
    for (int level = 1; level < kMraselMaps; ++level) {
        sums = halved(sums, static_cast<std::size_t>(side(level - 1)));
        // The mean of 4^level texels, a half up.
        const int bits = 2 * level;
        std::string& map = maps.m_maps[static_cast<std::size_t>(level)];
        for (const std::uint32_t sum : sums)
            map += static_cast<char>(static_cast<unsigned char>((sum + (1u << (bits - 1))) >> bits));
    }
    return maps;
}

MraselMaps MraselMaps::read_from(const std::string& name,
                                 const std::function<std::string(const std::string& file)>& read) {
    MraselMaps maps;
    for (int level = 0; level < kMraselMaps; ++level) {
        const std::string file = mrasel_map_file(name, side(level));
        std::string bytes = read(file);
        check_bytes(bytes, file, side(level));
        maps.m_maps[static_cast<std::size_t>(level)] = std::move(bytes);
    }
    return maps;
}

bool MraselMaps::read(int level, const Box& box, std::byte* texels,
                      std::ptrdiff_t row_stride) const noexcept {
    const char* from = bytes(level).data();
    for (int y = box.y0; y < box.y1; ++y)
        std::memcpy(texels + (y - box.y0) * row_stride,
                    from + std::ptrdiff_t{3} * (std::ptrdiff_t{y} * side(level) + box.x0),
                    static_cast<std::size_t>(box.width()) * 3);
    return true;
}

std::string TriplePicture::ppm() const {
    return "P6\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" + bytes;
}

TriplePicture shown_maps(const MraselMaps& maps) {
    const int width = MraselMaps::side(0), height = MraselMaps::side(1);
    TriplePicture picture{width, height, {}};
    picture.bytes.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3, '\0');
    // Widths of 256 + 128 + ... + 1 are one less than the picture's.
    std::size_t x = 0;
    for (int level = 1; level < kMraselMaps; ++level) {
        const auto side = static_cast<std::size_t>(MraselMaps::side(level));
        for (std::size_t y = 0; y < side; ++y)
            picture.bytes.replace(3 * (y * static_cast<std::size_t>(width) + x), 3 * side, maps.bytes(level),
                                  3 * y * side, 3 * side);
        x += side;
    }
    return picture;
}

}  // namespace anamorph::figure
