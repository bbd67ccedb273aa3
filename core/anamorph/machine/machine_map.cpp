// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/machine_map.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/number/hypot.h"

namespace anamorph::machine {
namespace {

constexpr int kBlockSide = 64;
// What was computed of a region is kept: 12 megabytes of them.
constexpr BlockLayout kLayout{1, 128, 32};
// Source pixels: less than any machine's own errors.
constexpr double kSmallRounding = 1e-6;

}  // namespace

/// What the machine makes of the pixels of a region, row by row.
struct MachineMap::Region final : RegionData {
    struct Pixel {
        Point<double> used;
        double off = -1;  ///< of `used` from the exact point; negative where there is none
        bool seen() const { return !(off < 0); }
    };
    Box box;
    std::vector<Pixel> pixels;

    const Pixel& at(int x, int y) const {
        return pixels[static_cast<std::size_t>((y - box.y0) * box.width() + x - box.x0)];
    }
};

MachineMap::MachineMap(std::shared_ptr<const BlockMap> exact, const std::vector<Box>& pieces,
                       const Size& source, double turn, int address_bits)
    : BlockMap(exact->width(), exact->height(), pieces, kLayout),
      m_exact(std::move(exact)),
      m_source(source),
      m_turn(turn),
      m_address_unit(std::ldexp(1.0, address_bits)) {}

Point<double> MachineMap::source_point(const UnitCoordinates& coordinates) const {
    const auto address = [&](double at, int texels) {
        return std::isfinite(at) ? std::nearbyint(at * texels * m_address_unit) / m_address_unit : 0;
    };
    return {address(coordinates.at.x, m_source.width), address(coordinates.at.y, m_source.height)};
}

/// In source pixels; points a turn apart are one.
double MachineMap::distance(const Point<double>& used, const Point<double>& exact) const {
    double across = used.x - exact.x;
    if (m_turn < HUGE_VAL) across -= std::round(across / m_turn) * m_turn;
    return hypot(across, used.y - exact.y);
}

void MachineMap::plan(const Box& box, int piece, Blocks& blocks) const {
    const auto region = std::make_shared<Region>();
    const std::int64_t saturated = compute(box, piece, *region);
    {
        const std::lock_guard lock(m_mutex);
        m_saturated[{piece, box.x0, box.y0}] = saturated;
    }
    for (int y = box.y0; y < box.y1; y += kBlockSide)
        for (int x = box.x0; x < box.x1; x += kBlockSide) {
            const Box part{x, y, std::min(x + kBlockSide, box.x1), std::min(y + kBlockSide, box.y1)};
            Block block;
            block.box = part;
            block.kind = Block::Kind::computed;
            block.precise = true;
            block.piece = piece;
            block.bound = bound_over(part, piece, *region);
            block.data = region.get();
            blocks.push_back(block);
        }
    blocks.data = region;
}

/// Returns how many pixels have coordinates that were beyond the range of a format.
std::int64_t MachineMap::compute(const Box& box, int piece, Region& region) const {
    region.box = box;
    std::int64_t saturated = 0;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) {
            Region::Pixel& pixel = region.pixels.emplace_back();
            Point<double> exact{};
            int source_piece = 0;
            if (!m_exact->exact(x + 0.5, y + 0.5, piece, exact, source_piece)) continue;
            const UnitCoordinates found = coordinates(x, y, piece);
            saturated += found.beyond;
            if (!found.seen) continue;
            pixel.used = source_point(found);
            pixel.off = distance(pixel.used, exact);
        }
    return saturated;
}

/// The largest distance of the pixels of a box, and what it may be off. About poles and seams rounding is known of small
/// boxes only.
double MachineMap::bound_over(const Box& box, int piece, const Region& region) const {
    const double off = rounding(box, piece);
    if (!(off <= kSmallRounding) && box.width() * box.height() > 1) {
        Box first = box, second = box;
        if (box.width() >= box.height())
            first.x1 = second.x0 = box.x0 + box.width() / 2;
        else
            first.y1 = second.y0 = box.y0 + box.height() / 2;
        return std::max(bound_over(first, piece, region), bound_over(second, piece, region));
    }
    double largest = 0;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) largest = std::max(largest, region.at(x, y).off);
    return largest + off;
}

std::int64_t MachineMap::saturated_pixels(const ParallelFor& parallel_for) const {
    // All regions are computed for that, if they have not been before.
    reached(parallel_for);
    const std::lock_guard lock(m_mutex);
    std::int64_t pixels = 0;
    for (const auto& [place, saturated] : m_saturated) pixels += saturated;
    return pixels;
}

bool MachineMap::exact(double x, double y, int piece, Point<double>& source_point,
                       int& source_piece) const noexcept {
    return m_exact->exact(x, y, piece, source_point, source_piece);
}
bool MachineMap::truth(double x, double y, int piece, Point<DoubleDouble>& source_point,
                       int& source_piece) const noexcept {
    return m_exact->truth(x, y, piece, source_point, source_piece);
}
Jacobian MachineMap::jacobian(double x, double y, int piece) const noexcept {
    return m_exact->jacobian(x, y, piece);
}

void MachineMap::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    const Region& region = *static_cast<const Region*>(block.data);
    for (int row = begin; row < end; ++row)
        for (int i = 0; i < block.box.width(); ++i) {
            const Region::Pixel& pixel = region.at(block.box.x0 + i, block.box.y0 + row);
            const std::ptrdiff_t at = (row - begin) * to.stride + i;
            to.x[at] = pixel.used.x;
            to.y[at] = pixel.used.y;
            to.piece[at] = pixel.seen() ? 0 : -1;
        }
}

double most_bound(const BlockMap& map, const Box& box) {
    double most = 0;
    for (const std::int64_t region : map.regions_in(box))
        for (const Block& block : map.blocks(region))
            if (!intersection(block.box, box).empty()) most = std::max(most, block.bound);
    return most;
}

void check_texture_side(const Size& source, int side) {
    if (std::max(source.width, source.height) > side)
        throw Error("machine: a source of " + std::to_string(source.width) + "x" +
                    std::to_string(source.height) + " does not fit its textures: must be at most " +
                    std::to_string(side) + " either way");
}

}  // namespace anamorph::machine
