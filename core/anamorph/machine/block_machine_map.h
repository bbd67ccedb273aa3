// SPDX-License-Identifier: Apache-2.0
// The drawing of the machine of 1987 as a pull map.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "anamorph/machine/block_machine.h"
#include "anamorph/plan/block.h"

namespace anamorph::machine {

/// A map whose source points are the machine's addresses, in pixels of the picture. Pixels of the screen
/// where nothing is seen have none. A block's bound is the largest distance on the screen, in pixels, of what
/// its pixels show from where it belongs: each is measured, in double.
class BlockMachineMap final : public BlockMap {
  public:
    /// Throws Error where there are more than four million blocks.
    BlockMachineMap(const BlockMachine& machine, std::shared_ptr<const surface::DrapedSurface> surface,
                    const surface::Camera& camera, const Size& picture);

    const MachineBlocks& blocks_of_machine() const { return m_blocks; }
    /// The whole frame and what is counted of it, drawn when it is first asked for and kept.
    const BlockFrame& frame(const ParallelFor& parallel_for = serial_for) const;
    /// Some pixels of the screen: a part of the whole frame where that is there, else drawn.
    std::shared_ptr<const BlockFrame> frame_of(const Box& box) const;
    const Size& picture() const { return m_picture; }
    /// The distance on the screen of what a pixel shows from where it belongs, 0 where nothing is seen.
    double landing_error(int x, int y) const;

    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;

  protected:
    void plan(const Box& box, int piece, Blocks& blocks) const override;

  private:
    /// A pixel of a frame.
    struct Spot;

    double landing_error(const BlockFrame& frame, int x, int y) const;
    Spot spot_at(double x, double y) const;

    std::shared_ptr<const surface::DrapedSurface> m_surface;
    surface::Camera m_camera;
    Size m_picture;
    MachineBlocks m_blocks;
    mutable std::once_flag m_once;
    mutable BlockFrame m_frame;
    mutable std::atomic<bool> m_has_frame = false;
};

}  // namespace anamorph::machine
