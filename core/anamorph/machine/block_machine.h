// SPDX-License-Identifier: Apache-2.0
// The machine of Oka et al. 1987, section 3 and Fig. 3.2: a host computer and micro-coded processors make a linear map for
// each block of the picture, an address controller visits the pixels of the block on the screen, segment by segment, and a
// pixel processor interpolates four texels for each.
//
// The machine draws a real drape: blocks are those of surface/oka.h, its addresses fixed-point numbers. What it visits is
// counted: blocks, segments and pixels, and no others; how long that takes is block_schedule.h's.
#pragma once

#include <cstdint>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/machine/number_format.h"
#include "anamorph/parameter/number_row.h"
#include "anamorph/surface/oka.h"

namespace anamorph::machine {

inline constexpr NumberRow kClockRow{"clock_mhz", 10, 0.001, 1e6};
inline constexpr NumberRow kProcessorsRow{"processors", 2, 1, 4096, NumberRow::closed, true};
inline constexpr NumberRow kMultipliersRow{"multipliers", 1, 1, 4096, NumberRow::closed, true};
inline constexpr NumberRow kDivisionRow{"division_cycles", 16, 1, 10000, NumberRow::closed, true};
inline constexpr NumberRow kSurfaceRow{"surface_multiplies", 20, 0, 1000000, NumberRow::closed, true};
inline constexpr NumberRow kHostRow{"host_cycles", 20000, 0, 1e9, NumberRow::closed, true};
inline constexpr NumberRow kSetupRow{"block_cycles", 8, 0, 10000, NumberRow::closed, true};
inline constexpr NumberRow kSegmentCyclesRow{"segment_cycles", 4, 1, 10000, NumberRow::closed, true};
inline constexpr NumberRow kSegmentRow{"segment", 8, 1, 256, NumberRow::closed, true};
inline constexpr NumberRow kPixelUnitsRow{"pixel_units", 1, 1, 4096, NumberRow::closed, true};
inline constexpr NumberRow kAddressBitsRow{"address_bits", 24, 2, 36, NumberRow::closed, true};
inline constexpr NumberRow kFractionBitsRow{"fraction_bits", 12, 0, 30, NumberRow::closed, true};
inline constexpr NumberRow kOkaBlockRow{"block", 8, 0.25, 4096};
inline constexpr NumberRow kOkaOverlapRow{"overlap", 0.5, 0, 16};

/// The parts and numbers of the machine. By default a picture of 512 x 512 in blocks of 8 x 8 takes less than
/// 33 ms a frame.
struct BlockMachine {
    double clock_mhz = kClockRow.standard;
    int processors = static_cast<int>(kProcessorsRow.standard);
    int multipliers = static_cast<int>(kMultipliersRow.standard);  ///< in each processor
    int division_cycles = static_cast<int>(kDivisionRow.standard);
    int surface_multiplies = static_cast<int>(kSurfaceRow.standard);  ///< products for a point of the surface
    int host_cycles = static_cast<int>(kHostRow.standard);            ///< cycles of the host, a frame
    int block_cycles = static_cast<int>(kSetupRow.standard);          ///< cycles of the controller, a block
    int segment_cycles = static_cast<int>(kSegmentCyclesRow.standard);
    int segment = static_cast<int>(kSegmentRow.standard);  ///< side of a segment of the screen, pixels
    int pixel_units =
        static_cast<int>(kPixelUnitsRow.standard);  ///< pixels that the pixel processor makes in a cycle
    int address_bits =
        static_cast<int>(kAddressBitsRow.standard);  ///< bits of an address, in texels, two's complement
    int fraction_bits = static_cast<int>(kFractionBitsRow.standard);  ///< of these, those behind the point
    double block = kOkaBlockRow.standard, overlap = kOkaOverlapRow.standard;  ///< as in OkaBlocks
};

/// The numbers of what a frame visits.
struct BlockCounts {
    std::int64_t blocks = 0;  ///< blocks that the processors make a map for
    std::int64_t segments = 0;
    std::int64_t pixels = 0;     ///< visited pixels, again for every block that is drawn over the ones before
    std::int64_t saturated = 0;  ///< pixels of the screen whose address, the last one, was beyond the range
};

/// A frame as the machine draws it: for each pixel of the screen, row by row, the block that was drawn last,
/// and its address there, in texels.
struct BlockFrame {
    static constexpr std::int32_t kNone = -1;

    BlockCounts counts;
    Size screen;
    std::vector<std::int32_t> block;  ///< kNone where none was drawn
    std::vector<Point<double>> addresses;
    std::vector<bool> beyond;     ///< the address was beyond the range, and saturated
    std::vector<Jacobian> steps;  ///< derivatives of the blocks' maps, before they were rounded

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(screen.width) +
               static_cast<std::size_t>(x);
    }
};

/// Draws blocks from the farthest to the nearest, as their centres are. Throws Error where there are more than four million
/// blocks.
BlockFrame run_block_machine(const BlockMachine& machine, const surface::DrapedSurface& surface,
                             const surface::Camera& camera, const Size& picture);

}  // namespace anamorph::machine
