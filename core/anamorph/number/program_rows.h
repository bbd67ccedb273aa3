// SPDX-License-Identifier: Apache-2.0
// Formulas that are programs, read for rows of points with vectors of doubles.
#pragma once

#include <algorithm>

#include "anamorph/number/formula_program.h"

namespace anamorph::simd {

/// The number of points that are read together.
inline constexpr int kProgramRow = 64;

/// The coordinates of points, or up to three numbers that a program gives at points.
struct ProgramRow {
    alignas(64) double x[kProgramRow], y[kProgramRow], z[kProgramRow];

    /// Sets the points scale(left + i, top), `count` of them. What stands behind the last one is read, and
    /// left.
    template <class Scale>
    void set_points(double left, double top, int count, const Scale& scale) {
        for (int i = 0; i < kProgramRow; ++i) {
            const auto point = scale(left + std::min(i, count - 1), top);
            x[i] = point.x;
            y[i] = point.y;
        }
    }
};

/// Computes up to three numbers at `count` <= kProgramRow points, whose coordinates have room for
/// kProgramRow. What is computed and in what order is what read_program<double> does, with functions that err
/// less than Rounded<double> allows for: its bound holds. The same bits on all instruction sets, and for a
/// point whatever stands beside it.
void read_program_row(const FormulaProgram& program, const ProgramRow& at, int count, ProgramRow& to);

}  // namespace anamorph::simd
