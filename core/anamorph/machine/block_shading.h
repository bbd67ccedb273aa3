// SPDX-License-Identifier: Apache-2.0
// Shading by the machine of 1987 (Oka et al. 1987, section 5): "by linearly approximating the intensity or the normal direction
// in each block". How it is built in, its numbers and what it costs are ours: the paper has no more than that sentence.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "anamorph/machine/block_machine.h"
#include "anamorph/machine/counted.h"
#include "anamorph/once_each.h"
#include "anamorph/surface/lighting.h"

namespace anamorph::machine {

/// The light of a frame's blocks. Processors find what light makes of the centre of a block and of its four neighbours (Gouraud), or
/// normals and directions of view there (Phong), and by central differences what a texel gains, as they do with points
/// (2.4 to 2.7), each number rounded to BlockMachine::coordinates. The pixel processor goes on from the block's centre by these, and
/// rounds what light makes of a pixel to multiples of 2^-light_bits, 0 at least. A neighbour's normal that points
/// away from the centre's is turned round.
class BlockShading {
  public:
    /// `blocks`: of the same machine, surface, camera and picture; they outlive this. `lighting`: some shading.
    BlockShading(const BlockMachine& machine, std::shared_ptr<const surface::DrapedSurface> surface,
                 const surface::Camera& camera, const Size& picture, const MachineBlocks& blocks,
                 const surface::DrapeLighting& lighting);

    /// What light makes of a pixel at an address of a block. The block's light is found when it is first asked for, and that of
    /// its neighbours in the list. Thread safe.
    surface::Light at(std::int32_t block, const Point<double>& address) const;

  private:
    /// A number that is linear over a block: at its centre, and what it gains by a texel.
    struct Linear {
        double centre, by_u, by_v;
    };

    /// How many numbers a block has: two of intensities, or six of a normal and a direction.
    std::size_t numbers() const {
        return m_lighting.shading == surface::DrapeShading::gouraud ? 2 : kMostNumbers;
    }
    static constexpr std::size_t kMostNumbers = 6;
    void light_blocks(std::size_t first, std::size_t end) const;
    std::array<double, kMostNumbers> numbers_at(const surface::LitPoint& point) const;
    double value(std::size_t block, std::size_t number, const Point<double>& address) const;

    NumberFormat m_coordinates;
    std::shared_ptr<const surface::DrapedSurface> m_surface;
    surface::Camera m_camera;
    Size m_picture;
    const std::vector<Point<double>>* m_centres;
    surface::DrapeLighting m_lighting;
    double m_side, m_unit;
    mutable std::vector<Linear> m_numbers;
    std::unique_ptr<OnceEach> m_lit;
};

/// What the processors do for the light of a block beside its points: a normal by the product of what they gain in space, 12 products, a
/// root and a division; for each light 3 products, with highlights 6 more, two functions and a division; and 2 products for
/// the differences of each number. Nothing without shading.
OperationCounts cost_of(const surface::DrapeLighting& lighting);

}  // namespace anamorph::machine
