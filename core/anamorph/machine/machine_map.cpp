// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/machine_map.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

namespace anamorph {
namespace {

constexpr int kBlockSide = 64;

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
            blocks.push_back(measured(part, piece, region->saturated));
            blocks.back().data = region.get();
        }
    blocks.data = region;
}

/// A block with its bound; adds its saturated pixels.
Block MachineMap::measured(const Box& box, int piece, std::int64_t& saturated) const {
    Block block;
    block.box = box;
    block.kind = Block::Kind::computed;
    block.precise = true;
    block.piece = piece;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) {
            Point<double> exact{};
            int source_piece = 0;
            if (!m_exact->exact(x + 0.5, y + 0.5, piece, exact, source_piece)) continue;
            const UnitCoordinates used = coordinates(x, y, piece);
            saturated += used.beyond;
            block.bound = std::max(block.bound, distance(source_point(used), exact));
        }
    block.bound += rounding(box, piece);
    return block;
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
