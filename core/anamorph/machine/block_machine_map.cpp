// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/block_machine_map.h"

#include <algorithm>
#include <cmath>

namespace anamorph::machine {

namespace {

/// The pixels of a region.
struct DrawnRegion final : RegionData {
    explicit DrawnRegion(std::shared_ptr<const BlockFrame> of) : frame(std::move(of)) {}

    std::shared_ptr<const BlockFrame> frame;
};

// Pixels of regions, 28 bytes each.
constexpr std::size_t kKeptRegions = 64;

const BlockFrame& frame_of(const Block& block) {
    return *static_cast<const DrawnRegion*>(block.data)->frame;
}

}  // namespace

struct BlockMachineMap::Spot {
    std::shared_ptr<const BlockFrame> frame;
    int x, y;

    std::size_t index() const { return frame->index(x, y); }
};

BlockMachineMap::BlockMachineMap(const BlockMachine& machine,
                                 std::shared_ptr<const surface::DrapedSurface> surface,
                                 const surface::Camera& camera, const Size& picture)
    : BlockMap(camera.screen().width, camera.screen().height,
               {{0, 0, camera.screen().width, camera.screen().height}}, {1, kRegion, kKeptRegions}),
      m_surface(std::move(surface)),
      m_camera(camera),
      m_picture(picture),
      m_blocks(machine, m_surface, camera, picture) {}

const BlockFrame& BlockMachineMap::frame(const ParallelFor& parallel_for) const {
    std::call_once(m_once, [&] {
        m_frame = m_blocks.draw_all(parallel_for);
        m_has_frame = true;
    });
    return m_frame;
}

std::shared_ptr<const BlockFrame> BlockMachineMap::frame_of(const Box& box) const {
    if (m_has_frame) return {std::shared_ptr<const BlockFrame>(), &m_frame};
    return std::make_shared<const BlockFrame>(m_blocks.draw(box));
}

double BlockMachineMap::landing_error(const BlockFrame& frame, int x, int y) const {
    const std::size_t at = frame.index(x, y);
    if (frame.block[at] == BlockFrame::kNone) return 0;
    const Point<double>& address = frame.addresses[at];
    const glm::dvec3 p =
        m_camera.in_frame(m_surface->position(address.x / m_picture.width, address.y / m_picture.height));
    const Point<double> seen = m_camera.seen(p);
    const double across = seen.x - (x + 0.5 - 0.5 * width()), down = seen.y - (y + 0.5 - 0.5 * height());
    const double off = std::sqrt(across * across + down * down);
    return p.z >= m_camera.near() && std::isfinite(off) ? off : HUGE_VAL;
}

double BlockMachineMap::landing_error(int x, int y) const {
    const Spot spot = spot_at(x, y);
    return landing_error(*spot.frame, spot.x, spot.y);
}

void BlockMachineMap::plan(const Box& box, int, Blocks& blocks) const {
    const auto region = std::make_shared<DrawnRegion>(frame_of(box));
    blocks.data = region;
    constexpr int kSide = Block::kMaxSide;
    for (int y = box.y0; y < box.y1; y += kSide)
        for (int x = box.x0; x < box.x1; x += kSide) {
            Block block;
            block.box = {x, y, std::min(x + kSide, box.x1), std::min(y + kSide, box.y1)};
            block.kind = Block::Kind::computed;
            block.precise = true;
            block.data = region.get();
            for (int j = block.box.y0; j < block.box.y1; ++j)
                for (int i = block.box.x0; i < block.box.x1; ++i)
                    block.bound = std::max(block.bound, landing_error(*region->frame, i, j));
            blocks.push_back(block);
        }
}

/// The pixel that a point of the screen lies in, or the one next to it.
BlockMachineMap::Spot BlockMachineMap::spot_at(double x, double y) const {
    const int i = std::clamp(static_cast<int>(std::floor(x)), 0, width() - 1),
              j = std::clamp(static_cast<int>(std::floor(y)), 0, height() - 1);
    if (m_has_frame) return {{std::shared_ptr<const BlockFrame>(), &m_frame}, i, j};
    const SharedBlocks drawn = blocks(regions_in({i, j, i + 1, j + 1}).front());
    return {static_cast<const DrawnRegion*>(drawn[0].data)->frame, i, j};
}

bool BlockMachineMap::exact(double x, double y, int, Point<double>& source_point,
                            int& source_piece) const noexcept {
    const Spot spot = spot_at(x, y);
    source_piece = 0;
    if (spot.frame->block[spot.index()] == BlockFrame::kNone) return false;
    source_point = spot.frame->addresses[spot.index()];
    return true;
}

Jacobian BlockMachineMap::jacobian(double x, double y, int) const noexcept {
    const Spot spot = spot_at(x, y);
    const std::int32_t block = spot.frame->block[spot.index()];
    return block == BlockFrame::kNone ? Jacobian{} : m_blocks.steps()[static_cast<std::size_t>(block)];
}

void BlockMachineMap::exact_rows(const Block& block, int begin, int end,
                                 const DoubleRows& to) const noexcept {
    const BlockFrame& frame = machine::frame_of(block);
    for (int row = begin; row < end; ++row)
        for (int i = 0; i < block.box.width(); ++i) {
            const std::size_t at = frame.index(block.box.x0 + i, block.box.y0 + row);
            const std::ptrdiff_t k = (row - begin) * to.stride + i;
            to.x[k] = frame.addresses[at].x;
            to.y[k] = frame.addresses[at].y;
            to.piece[k] = frame.block[at] == BlockFrame::kNone ? -1 : 0;
        }
}

}  // namespace anamorph::machine
