// SPDX-License-Identifier: Apache-2.0
// The texture maps of MRASEL (Chapman 1986, section 3.6 and Appendix I) and the programs that make and show them.
//
// A map is 512 x 512 texels of a byte each for red, green and blue, the first at the upper left, row by row, without a
// header. MTEXTURE reads one and writes ten files, NAME.512, NAME.256, ..., NAME.1, each half as wide and high as the one
// before; MRASEL reads these. The essay says that they are filtered, not how: here a texel is the mean of all that it
// covers of the largest map, taken from exact sums and rounded to the nearest byte, a half up. SHOWMAP puts the nine smallest
// into one picture, the largest at its upper left; that the others stand to the right of it in one row, on black, is
// ours.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/image/source.h"

namespace anamorph::figure {

/// The side of the largest map, in texels, and the number of maps.
inline constexpr int kMraselSide = 512, kMraselMaps = 10;

/// The bytes of a map of so many texels either way.
constexpr std::size_t bytes_of_map(int side) {
    return std::size_t{3} * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
}

/// The file of a map: NAME.64 is the one of 64 texels either way.
std::string mrasel_map_file(const std::string& name, int side);

/// Ten maps, each a level of a source.
class MraselMaps final : public Source {
  public:
    /// Makes the smaller maps of the largest, as MTEXTURE does. `name`: of the file, for messages. Throws Error unless it has the
    /// bytes that a map of 512 texels has.
    static MraselMaps made_of(std::string_view base, std::string_view name);
    /// Reads all ten. `read`: gives the bytes of a file by its name. Throws Error unless each file has the bytes that its map
    /// has, and whatever `read` throws.
    static MraselMaps read_from(const std::string& name,
                                const std::function<std::string(const std::string& file)>& read);

    PixelType type() const noexcept override { return PixelType::uint8; }
    int channels() const noexcept override { return 3; }
    int levels() const noexcept override { return kMraselMaps; }
    Size size(int level) const noexcept override { return {side(level), side(level)}; }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;

    /// The side of a map, of level 0 to 9.
    static constexpr int side(int level) { return kMraselSide >> level; }
    /// The bytes of a map, as its file has them.
    const std::string& bytes(int level) const { return m_maps[static_cast<std::size_t>(level)]; }

  private:
    std::array<std::string, kMraselMaps> m_maps;
};

/// A picture of triples of bytes, row by row from the upper left.
struct TriplePicture {
    int width = 0, height = 0;
    std::string bytes;

    /// The picture as a PPM file (P6): a header, and the triples as they are.
    std::string ppm() const;
};

/// The nine smallest maps in one picture of 512 x 256, as SHOWMAP has them.
TriplePicture shown_maps(const MraselMaps& maps);

}  // namespace anamorph::figure
