// SPDX-License-Identifier: Apache-2.0
// Kim's approximation of a morph (2003, 5.6.2): the maps are evaluated at the vertices of a grid only, which
// is cut finer near the lines, with Hermite patches in between. It holds no tolerance, since the maps have
// kinks on the lines: the bound is infinite.
#pragma once

#include <memory>
#include <vector>

#include "anamorph/morph/feature_blocks.h"

namespace anamorph {

class FeatureMesh final : public FeatureBlocks {
  public:
    /// Makes a grid of `cells` each way, those near a line cut `levels` times into four; `shapes` become the
    /// layers. The map outlives this.
    FeatureMesh(const FeatureMap& map, int cells, int levels, const std::vector<int>& shapes);
    ~FeatureMesh() override;

    /// The number of times that the map was evaluated: once for each vertex.
    std::int64_t evaluations() const;

    void computed_row(const Block& block, int row, int begin, int end, float* x,
                      float* y) const noexcept override;
    void computed(std::span<const Block> layers, const PointRows* to) const noexcept override;

  protected:
    void plan(const Box& box, int piece, Blocks& blocks) const override;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace anamorph
