// SPDX-License-Identifier: Apache-2.0
// The drawing of the machine of 1987 as a pull map.
#pragma once

#include <memory>

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

    const BlockFrame& frame() const { return m_frame; }
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
    std::size_t pixel_at(double x, double y) const;

    std::shared_ptr<const surface::DrapedSurface> m_surface;
    surface::Camera m_camera;
    Size m_picture;
    BlockFrame m_frame;
};

}  // namespace anamorph::machine
