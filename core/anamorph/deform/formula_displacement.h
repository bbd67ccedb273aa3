// SPDX-License-Identifier: Apache-2.0
// Displacements of a surface's points by a formula that is text, to be added to those by lists of bumps.
//
// The formula is one of u and v, the parameters that centres of bumps are given in. Where it has no value, or
// none that double holds, it does not move a point.
//
// Errors. What rounding does to a formula is bounded over boxes around points that follow each other, by
// Rounded<double> and by intervals, which hold computed values as well as exact ones. A box that a jump or a
// pole goes through says too much: it is halved, down to single points. Where rounding decides whether the
// formula has a value, or on which side of a jump it is, the bound holds for either answer.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <utility>
#include <vector>

#include "anamorph/deform/deformation.h"
#include "anamorph/deform/deformed_surface.h"
#include "anamorph/formula/formula_text.h"
#include "anamorph/parallel_for.h"

namespace anamorph {

/// The numbers that a formula adds to the displacements of points.
struct FormulaOffsets {
    std::vector<double> values;  ///< three numbers a point
    double error_bound = 0;      ///< the largest distance of any from the formula
    double most = 0;             ///< the largest magnitude of any
    std::int64_t undefined = 0;  ///< points where the formula has no value
};

/// A formula, and its derivatives.
class FormulaDisplacement {
  public:
    explicit FormulaDisplacement(SpaceFormula formula) : m_formula(std::move(formula)) {}

    /// Evaluates the formula at many points: the same bits for any number of threads, and but for the bound
    /// whatever other points there are. Points that are not finite are not moved, and not counted.
    FormulaOffsets offsets(std::span<const glm::dvec2> points,
                           const ParallelFor& parallel_for = serial_for) const;
    /// Evaluates the formula at one point; 0 where there is no value, and derivatives are 0 where there are
    /// none.
    DisplacementJet jet(glm::dvec2 point) const;
    /// Adds the formula's derivatives to those by a list. points: of the whole surface.
    void add_slopes(std::span<const glm::dvec2> points, const SurfaceSlopes& slopes) const;

    /// Do both compute the same?
    friend bool operator==(const FormulaDisplacement& a, const FormulaDisplacement& b) {
        return a.m_formula == b.m_formula;
    }

  private:
    /// What FormulaOffsets says, of a few points from `first` on.
    struct Part {
        double error_bound = 0, most = 0;
        std::int64_t undefined = 0;
    };
    Part compute(std::span<const glm::dvec2> points, std::size_t first, double* values) const;

    SpaceFormula m_formula;
};

}  // namespace anamorph
