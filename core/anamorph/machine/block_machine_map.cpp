// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/block_machine_map.h"

#include <algorithm>
#include <cmath>

namespace anamorph::machine {

BlockMachineMap::BlockMachineMap(const BlockMachine& machine,
                                 std::shared_ptr<const surface::DrapedSurface> surface,
                                 const surface::Camera& camera, const Size& picture)
    : BlockMap(camera.screen().width, camera.screen().height,
               {{0, 0, camera.screen().width, camera.screen().height}}),
      m_surface(std::move(surface)),
      m_camera(camera),
      m_picture(picture),
      m_frame(run_block_machine(machine, *m_surface, camera, picture)) {}

double BlockMachineMap::landing_error(int x, int y) const {
    const std::size_t at = m_frame.index(x, y);
    if (m_frame.block[at] == BlockFrame::kNone) return 0;
    const Point<double>& address = m_frame.addresses[at];
    const glm::dvec3 p =
        m_camera.in_frame(m_surface->position(address.x / m_picture.width, address.y / m_picture.height));
    const Point<double> seen = m_camera.seen(p);
    const double across = seen.x - (x + 0.5 - 0.5 * width()), down = seen.y - (y + 0.5 - 0.5 * height());
    const double off = std::sqrt(across * across + down * down);
    return p.z >= m_camera.near() && std::isfinite(off) ? off : HUGE_VAL;
}

void BlockMachineMap::plan(const Box& box, int, Blocks& blocks) const {
    constexpr int kSide = Block::kMaxSide;
    for (int y = box.y0; y < box.y1; y += kSide)
        for (int x = box.x0; x < box.x1; x += kSide) {
            Block block;
            block.box = {x, y, std::min(x + kSide, box.x1), std::min(y + kSide, box.y1)};
            block.kind = Block::Kind::computed;
            block.precise = true;
            for (int j = block.box.y0; j < block.box.y1; ++j)
                for (int i = block.box.x0; i < block.box.x1; ++i)
                    block.bound = std::max(block.bound, landing_error(i, j));
            blocks.push_back(block);
        }
}

std::size_t BlockMachineMap::pixel_at(double x, double y) const {
    return m_frame.index(std::clamp(static_cast<int>(std::floor(x)), 0, width() - 1),
                         std::clamp(static_cast<int>(std::floor(y)), 0, height() - 1));
}

bool BlockMachineMap::exact(double x, double y, int, Point<double>& source_point,
                            int& source_piece) const noexcept {
    const std::size_t at = pixel_at(x, y);
    source_piece = 0;
    if (m_frame.block[at] == BlockFrame::kNone) return false;
    source_point = m_frame.addresses[at];
    return true;
}

Jacobian BlockMachineMap::jacobian(double x, double y, int) const noexcept {
    const std::int32_t block = m_frame.block[pixel_at(x, y)];
    return block == BlockFrame::kNone ? Jacobian{} : m_frame.steps[static_cast<std::size_t>(block)];
}

void BlockMachineMap::exact_rows(const Block& block, int begin, int end,
                                 const DoubleRows& to) const noexcept {
    for (int row = begin; row < end; ++row)
        for (int i = 0; i < block.box.width(); ++i) {
            const std::size_t at = m_frame.index(block.box.x0 + i, block.box.y0 + row);
            const std::ptrdiff_t k = (row - begin) * to.stride + i;
            to.x[k] = m_frame.addresses[at].x;
            to.y[k] = m_frame.addresses[at].y;
            to.piece[k] = m_frame.block[at] == BlockFrame::kNone ? -1 : 0;
        }
}

}  // namespace anamorph::machine
