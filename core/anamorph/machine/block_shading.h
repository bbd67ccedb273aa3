// SPDX-License-Identifier: Apache-2.0
// Shading by the machine of 1987 (Oka et al. 1987, section 5): "by linearly approximating the intensity or the normal direction
// in each block". How it is built in, its numbers and what it costs are ours: the paper has no more than that sentence.
#pragma once

#include <array>
#include <vector>

#include "anamorph/machine/block_machine.h"
#include "anamorph/machine/counted.h"
#include "anamorph/surface/lighting.h"

namespace anamorph::machine {

/// The light of a frame's blocks. Processors find what light makes of the centre of a block and of its four neighbours (Gouraud), or
/// normals and directions of view there (Phong), and by central differences what a texel gains, as they do with points
/// (2.4 to 2.7), each number rounded to BlockMachine::coordinates. The pixel processor goes on from the block's centre by these, and
/// rounds what light makes of a pixel to multiples of 2^-light_bits, 0 at least. A neighbour's normal that points
/// away from the centre's is turned round.
class BlockShading {
  public:
    /// `frame`: of the same machine, surface, camera and picture. Keeps none of them. `lighting`: some shading.
    BlockShading(const BlockMachine& machine, const surface::DrapedSurface& surface,
                 const surface::Camera& camera, const Size& picture, const BlockFrame& frame,
                 const surface::DrapeLighting& lighting);

    /// What light makes of a pixel at an address of a block.
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
    std::array<double, kMostNumbers> numbers_at(const surface::LitPoint& point) const;
    double value(std::int32_t block, std::size_t number, const Point<double>& address) const;

    surface::DrapeLighting m_lighting;
    double m_unit;
    std::vector<Point<double>> m_centres;
    std::vector<Linear> m_numbers;
};

/// What the processors do for the light of a block beside its points: a normal by the product of what they gain in space, 12 products, a
/// root and a division; for each light 3 products, with highlights 6 more, two functions and a division; and 2 products for
/// the differences of each number. Nothing without shading.
OperationCounts cost_of(const surface::DrapeLighting& lighting);

}  // namespace anamorph::machine
