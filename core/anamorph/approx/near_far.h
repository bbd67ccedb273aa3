// SPDX-License-Identifier: Apache-2.0
// The maps of a morph made cheap, with their bound: near/far.
//
// A pixel's displacement is a quotient, sum of w_i D_i over sum of w_i (feature_lines.h), of sums over all
// lines. On a cell of the picture the sums over the lines that are far from it become polynomials, K x K
// Chebyshev interpolants; the few lines that are near are summed at every pixel. near_far.cpp proves the
// bound; cells are cut into four until it keeps the tolerance, and the smallest fall back on double.
//
// Cells are anchored to the whole target image: what part of the picture is asked for, in what order and by
// how many threads changes none of them.
#pragma once

#include <functional>
#include <memory>

#include "anamorph/approx/block.h"
#include "anamorph/map/feature_lines.h"

namespace anamorph {

/// Source points of all pixels of a block, row by row, as offsets from the block's base in source pixels;
/// null for an exact block.
struct CellPoints {
    const float *x = nullptr, *y = nullptr;
    std::ptrdiff_t row_stride = 0;  ///< floats; behind every row 16 more may be read
};

/// The source points of several maps over one target, block by block.
class CellField {
  public:
    /// The target is cut into regions of this many pixels square from its corner on.
    static constexpr int kRegion = 128;

    using Visit = std::function<void(int shape, const Block& block, const CellPoints& points)>;

    virtual ~CellField() = default;
    /// Calls `visit` for the blocks of a region that meet `part` of it, shape by shape; blocks are exact or
    /// computed, and those of a shape cover the region without overlap.
    virtual void each_block(const Box& region, const Box& part, const Visit& visit) const = 0;
    /// The largest bound and the number of exact pixels of a region.
    struct Tally {
        double bound = 0;
        std::int64_t exact_pixels = 0;
    };
    virtual Tally tally(const Box& region) const = 0;
};

struct NearFarOptions {
    double tol = 0.01;  ///< source pixels; 0: every pixel exactly in double
    /// The shapes whose maps are wanted, one or two of them.
    std::vector<int> shapes = {0, 1};
};

class NearFar final : public CellField {
  public:
    /// The map outlives this. Throws Error when tol is negative or not a number.
    NearFar(const FeatureMap& map, const NearFarOptions& options);
    ~NearFar() override;

    void each_block(const Box& region, const Box& part, const Visit& visit) const override;
    Tally tally(const Box& region) const override;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace anamorph
