// SPDX-License-Identifier: Apache-2.0
// The machine of Oka et al. 1987, section 3 and Fig. 3.2: a host computer and micro-coded processors make a linear map for
// each block of the picture, an address controller visits the pixels of the block on the screen, segment by segment, and a
// pixel processor interpolates four texels for each (block_pixels.h).
//
// The machine draws a real drape: blocks are those of surface/oka.h. The processors' numbers are rounded as they are computed,
// addresses are fixed-point numbers, and a pixel belongs to a block where its address lies in the block's rectangle: what is lost
// by rounding is seen as cracks, which the common area of neighbours closes. What the machine visits is counted: blocks, segments
// and pixels, and no others; how long that takes is block_schedule.h's. The paper gives no widths of numbers and no cycles: all of
// them are ours.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/machine/number_format.h"
#include "anamorph/parallel_for.h"
#include "anamorph/parameter/number_row.h"
#include "anamorph/surface/oka.h"

namespace anamorph::machine {

inline constexpr NumberRow kClockRow{"clock_mhz", 10, 0.001, 1e6};
inline constexpr NumberRow kProcessorsRow{"processors", 2, 1, 4096, NumberRow::closed, true};
inline constexpr NumberRow kMultipliersRow{"multipliers", 1, 1, 4096, NumberRow::closed, true};
inline constexpr NumberRow kDivisionRow{"division_cycles", 16, 1, 10000, NumberRow::closed, true};
inline constexpr NumberRow kSurfaceRow{"surface_multiplies", NAN, 0, 1000000, NumberRow::closed, true};
inline constexpr NumberRow kFunctionRow{"function_multiplies", 4, 0, 10000, NumberRow::closed, true};
inline constexpr NumberRow kBucketsRow{"buckets", 256, 1, 1 << 20, NumberRow::closed, true};
inline constexpr NumberRow kSortRow{"sort_cycles", 2, 0, 10000, NumberRow::closed, true};
inline constexpr NumberRow kHostRow{"host_cycles", 20000, 0, 1e9, NumberRow::closed, true};
inline constexpr NumberRow kSetupRow{"block_cycles", 8, 0, 10000, NumberRow::closed, true};
inline constexpr NumberRow kSegmentCyclesRow{"segment_cycles", 4, 1, 10000, NumberRow::closed, true};
inline constexpr NumberRow kSegmentRow{"segment", 8, 1, 256, NumberRow::closed, true};
inline constexpr NumberRow kPixelUnitsRow{"pixel_units", 1, 1, 4096, NumberRow::closed, true};
inline constexpr NumberRow kAddressBitsRow{"address_bits", 24, 2, 36, NumberRow::closed, true};
inline constexpr NumberRow kFractionBitsRow{"fraction_bits", 12, 0, 30, NumberRow::closed, true};
inline constexpr NumberRow kDepthBitsRow{"depth_bits", 16, 1, 32, NumberRow::closed, true};
inline constexpr NumberRow kTapWeightRow{"weight_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kTexelBitsRow{"texel_bits", 0, 0, 16, NumberRow::closed, true};
inline constexpr NumberRow kLightBitsRow{"light_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kFrameClockRow{"frame_clock_ms", 33, 0, 1e6};
inline constexpr NumberRow kOkaBlockRow{"block", 8, 0.25, 4096};
inline constexpr NumberRow kOkaOverlapRow{"overlap", 0.5, 0, 16};

/// How the address controller finds the addresses of a block, from that of the pixel next to the block's centre (2.12, Fig. 2.5).
enum class Addressing : std::uint8_t {
    segments,  ///< from segment to segment by repetition, within one directly: as many pixels at once as there are units
    repeated,  ///< from pixel to pixel by repetition: one after the other, and what a step is rounded by adds up
    direct     ///< every pixel by products of its own
};

/// What hides blocks that lie behind others.
enum class Hiding : std::uint8_t {
    sort,  ///< a list from the farthest to the nearest by buckets, in which centres are told apart no further (section 3)
    z_buffer  ///< linear depth for each pixel (section 5)
};

/// The parts and numbers of the machine. By default a picture of 512 x 512 in blocks of 8 x 8 takes less than
/// 33 ms a frame.
struct BlockMachine {
    double clock_mhz = kClockRow.standard;
    int processors = static_cast<int>(kProcessorsRow.standard);
    int multipliers = static_cast<int>(kMultipliersRow.standard);  ///< in each processor
    int division_cycles = static_cast<int>(kDivisionRow.standard);
    std::optional<int>
        surface_multiplies;  ///< products for a point of the surface; else as its formula has them
    int function_multiplies =
        static_cast<int>(kFunctionRow.standard);            ///< products that a root or a sine takes
    int buckets = static_cast<int>(kBucketsRow.standard);   ///< of the sort by depth
    int sort_cycles = static_cast<int>(kSortRow.standard);  ///< cycles of the sort for a block
    NumberFormat coordinates = kFloat32;   ///< numbers of points and what they gain by steps (2.4 to 2.7)
    NumberFormat coefficients = kFloat32;  ///< numbers of the inverse (2.11)
    int host_cycles = static_cast<int>(kHostRow.standard);    ///< cycles of the host, a frame
    int block_cycles = static_cast<int>(kSetupRow.standard);  ///< cycles of the controller, a block
    int segment_cycles = static_cast<int>(kSegmentCyclesRow.standard);
    int segment = static_cast<int>(kSegmentRow.standard);  ///< side of a segment of the screen, pixels
    int pixel_units =
        static_cast<int>(kPixelUnitsRow.standard);  ///< pixels that the pixel processor makes in a cycle
    int address_bits =
        static_cast<int>(kAddressBitsRow.standard);  ///< bits of an address, in texels, two's complement
    int fraction_bits = static_cast<int>(kFractionBitsRow.standard);  ///< of these, those behind the point
    Addressing addresses = Addressing::segments;
    Hiding hidden = Hiding::sort;
    int depth_bits = static_cast<int>(kDepthBitsRow.standard);  ///< of the z-buffer
    int weight_bits =
        static_cast<int>(kTapWeightRow.standard);  ///< weights of texels are multiples of 2^-weight_bits
    int texel_bits = static_cast<int>(
        kTexelBitsRow.standard);  ///< of a channel in the memories; 0: as the source has them
    int light_bits = static_cast<int>(
        kLightBitsRow.standard);  ///< what light makes of a pixel is of multiples of 2^-light_bits
    double frame_clock_ms = kFrameClockRow.standard;  ///< time from one shown frame to the next; 0: none
    double block = kOkaBlockRow.standard, overlap = kOkaOverlapRow.standard;  ///< as in OkaBlocks
};

/// The numbers of what a frame visits.
struct BlockCounts {
    std::int64_t blocks = 0;  ///< blocks that the processors make a map for
    std::int64_t segments = 0;
    std::int64_t pixels = 0;     ///< visited pixels, again for every block that is drawn over the ones before
    std::int64_t saturated = 0;  ///< pixels of the screen whose address, the last one, was beyond the range
    std::int64_t addressed = 0;  ///< pixels of the segments, in a block or not
    std::int64_t pixel_cycles =
        0;                    ///< cycles of the pixel processor, whose units share the pixels of a segment
    std::int64_t cracks = 0;  ///< pixels that lie in a block but by rounding in none
    std::int64_t misordered = 0;  ///< pixels that show a block where one was drawn whose centre is nearer
    std::int64_t left_out =
        0;  ///< blocks that may be in view where no linear map shows them (oka_block_is_cut)
};

/// A part of a frame as the machine draws it: for each pixel of a box of the screen, row by row, the block that was drawn last,
/// and its address there, in texels.
struct BlockFrame {
    static constexpr std::int32_t kNone = -1;

    BlockCounts counts;
    Box box;
    std::vector<std::int32_t> block;  ///< kNone where none was drawn
    std::vector<Point<double>> addresses;
    std::vector<std::uint8_t> beyond;  ///< 1 where the address was beyond the range, and saturated

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - box.y0) * static_cast<std::size_t>(box.width()) +
               static_cast<std::size_t>(x - box.x0);
    }
};

/// The blocks of a picture as the processors have made them, ready to be drawn one over the other as the machine hides them. A
/// pixel's address is a sum of products, whatever else is drawn, so that each part of the screen can be drawn by itself.
class MachineBlocks {
  public:
    /// Makes the blocks. Throws Error where there are more than four million of them, or the screen does not fit the memory.
    MachineBlocks(const BlockMachine& machine, std::shared_ptr<const surface::DrapedSurface> surface,
                  const surface::Camera& camera, const Size& picture);
    ~MachineBlocks();
    MachineBlocks(const MachineBlocks&) = delete;
    MachineBlocks& operator=(const MachineBlocks&) = delete;

    /// Draws a box of the screen, and counts nothing.
    BlockFrame draw(const Box& box) const;
    /// Draws the screen, and counts.
    BlockFrame draw_all(const ParallelFor& parallel_for) const;

    /// The number of blocks that the processors make a map for.
    std::int64_t made() const;
    /// The derivatives of the maps of the blocks that have one, in the processors' numbers.
    const std::vector<Jacobian>& steps() const;
    /// Their centres, in texels.
    const std::vector<Point<double>>& centres() const;

  private:
    struct Parts;

    std::unique_ptr<const Parts> m_parts;
};

}  // namespace anamorph::machine
