// SPDX-License-Identifier: Apache-2.0
// Blocks of a text pixel by pixel, in float or in double: its program read with vectors near the middle of the block (number/near.h).
#pragma once

#include <span>

#include "anamorph/formula/pixel_scale.h"
#include "anamorph/geometry/box.h"
#include "anamorph/number/formula_program.h"
#include "anamorph/plan/block.h"

namespace anamorph::simd {

/// A block whose source points are to be read in Real, float or double.
template <class Real>
struct TextBlock {
    const FormulaProgram& program;
    const PixelScale& scale;
    /// The bases that TextMap::direct() wrote down about the middle of the block, in the order of the
    /// program's steps.
    std::span<const Real> bases;
    int width, height;
    /// The number that is added to the rests: the source point of the middle of the block, or its offset from
    /// the block's base.
    Point<Real> middle;
};

/// Finds the source points of a part of the block, counted from its corner, as offsets from its base; row by
/// row from the start of `to` on. What is computed and in what order is what TextMap::direct() bounds. The
/// same bits on all instruction sets.
void text_rows(const TextBlock<float>& block, const Box& part, const PointRows& to);

/// Finds the source points of row `row` of the block, by the same computations.
void text_row(const TextBlock<double>& block, int row, double* x, double* y);

}  // namespace anamorph::simd
