// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/machine_map.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

namespace anamorph {
namespace {

constexpr int kBlockSide = 64;
// Source pixels: less than any machine's own errors.
constexpr double kSmallRounding = 1e-6;

}  // namespace

/// What is counted of a region.
struct MachineMap::Region final : RegionData {
    std::int64_t saturated = 0;
};

MachineMap::MachineMap(std::shared_ptr<const BlockMap> exact, const std::vector<Box>& pieces,
                       const Size& source, double turn, int address_bits)
    : BlockMap(exact->width(), exact->height(), pieces),
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
    return std::hypot(across, used.y - exact.y);
}

void MachineMap::plan(const Box& box, int piece, Blocks& blocks) const {
    const auto region = std::make_shared<Region>();
    for (int y = box.y0; y < box.y1; y += kBlockSide)
        for (int x = box.x0; x < box.x1; x += kBlockSide) {
            const Box part{x, y, std::min(x + kBlockSide, box.x1), std::min(y + kBlockSide, box.y1)};
            Block block;
            block.box = part;
            block.kind = Block::Kind::computed;
            block.precise = true;
            block.piece = piece;
            block.bound = bound_over(part, piece, region->saturated);
            block.data = region.get();
            blocks.push_back(block);
        }
    blocks.data = region;
}

/// The largest distance of the pixels of a box, and what it may be off; adds its saturated pixels. About poles and seams
/// rounding is known of small boxes only.
double MachineMap::bound_over(const Box& box, int piece, std::int64_t& saturated) const {
    const double off = rounding(box, piece);
    if (!(off <= kSmallRounding) && box.width() * box.height() > 1) {
        Box first = box, second = box;
        if (box.width() >= box.height())
            first.x1 = second.x0 = box.x0 + box.width() / 2;
        else
            first.y1 = second.y0 = box.y0 + box.height() / 2;
        const double bound = bound_over(first, piece, saturated);
        return std::max(bound, bound_over(second, piece, saturated));
    }
    double largest = 0;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) {
            Point<double> exact{};
            int source_piece = 0;
            if (!m_exact->exact(x + 0.5, y + 0.5, piece, exact, source_piece)) continue;
            const UnitCoordinates used = coordinates(x, y, piece);
            saturated += used.beyond;
            largest = std::max(largest, distance(source_point(used), exact));
        }
    return largest + off;
}

std::int64_t MachineMap::saturated_pixels(const ParallelFor& parallel_for) const {
    std::atomic<std::int64_t> pixels{0};
    parallel_for(regions(), [&](std::int64_t region) {
        const SharedBlocks found = blocks(region);
        pixels += static_cast<const Region*>(found[0].data)->saturated;
    });
    return pixels;
}

bool MachineMap::exact(double x, double y, int piece, Point<double>& source_point,
                       int& source_piece) const noexcept {
    return m_exact->exact(x, y, piece, source_point, source_piece);
}
bool MachineMap::truth(double x, double y, int piece, Point<long double>& source_point,
                       int& source_piece) const noexcept {
    return m_exact->truth(x, y, piece, source_point, source_piece);
}
Jacobian MachineMap::jacobian(double x, double y, int piece) const noexcept {
    return m_exact->jacobian(x, y, piece);
}

void MachineMap::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    for (int row = begin; row < end; ++row)
        for (int i = 0; i < block.box.width(); ++i) {
            const int x = block.box.x0 + i, y = block.box.y0 + row;
            const std::ptrdiff_t at = (row - begin) * to.stride + i;
            const Point<double> used = source_point(coordinates(x, y, block.piece));
            to.x[at] = used.x;
            to.y[at] = used.y;
            to.piece[at] = m_exact->seen(x + 0.5, y + 0.5, block.piece) ? 0 : -1;
        }
}

void check_texture_side(const Size& source, int side) {
    if (std::max(source.width, source.height) > side)
        throw Error("machine: a source of " + std::to_string(source.width) + "x" +
                    std::to_string(source.height) + " does not fit its textures: must be at most " +
                    std::to_string(side) + " either way");
}

}  // namespace anamorph
