// SPDX-License-Identifier: Apache-2.0
// The maps of a morph made cheap, with their bound: near/far.
//
// A pixel's displacement is a quotient, sum of w_i D_i over sum of w_i (feature_lines.h), of sums over all
// lines. On a cell of the picture the sums over the lines that are far from it become polynomials, K x K
// Chebyshev interpolants; the few lines that are near are summed at every pixel. cells are cut into
// four until their bound (near_far.cpp says where it is proven) keeps the tolerance, and the smallest fall
// back on double.
//
// Two shapes share one plan, since they share the weights: their blocks are the layers of one map.
#pragma once

#include <memory>
#include <vector>

#include "anamorph/morph/feature_blocks.h"

namespace anamorph {

struct NearFarOptions {
    double tol = 0.01;  ///< source pixels; 0: every pixel exactly in double
    /// The shapes whose maps are wanted, one or two of them, which become the layers.
    std::vector<int> shapes = {0, 1};
    /// How many pixels beyond its edges the picture has, across and down, on either side.
    Size overscan = {};
};

class NearFar final : public FeatureBlocks {
  public:
    /// Keeps a reference to the map. Throws Error when tol is negative or not a number.
    NearFar(const FeatureMap& map, const NearFarOptions& options);
    ~NearFar() override;

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
