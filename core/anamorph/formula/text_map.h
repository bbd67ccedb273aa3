// SPDX-License-Identifier: Apache-2.0
// A flat map whose formula is text.
#pragma once

#include <cstdint>

#include "anamorph/formula/formula_text.h"
#include "anamorph/formula/pixel_scale.h"
#include "anamorph/plan/costs.h"
#include "anamorph/plan/formula_map.h"

namespace anamorph {

/// Evaluates a program that computes two numbers as a point.
template <class T>
Point<T> read_point(const FormulaProgram& program, const T& x, const T& y) {
    const auto [to_x, to_y] = read_program<2>(program, x, y);
    return {to_x, to_y};
}

/// A pull map given as formulas in text. Pixels, x right, y down, pixel centres at + 0.5.
class TextMap : public PlaneMap<TextMap> {
  public:
    /// An exact pixel costs more than a compiled one, and jets cost less over it.
    static constexpr PlanCosts kCosts{.bound = 400,
                                      .further_bound = 30,
                                      .polynomial = 20,
                                      .rounding = 45,
                                      .direct_trial = 60,
                                      .direct_pixel = 0.45,
                                      .precise_pixel = 1,
                                      .apart_pixel = 1,
                                      .precise_bound = 400,
                                      .block = 0};

    /// `picture`: the size that the formula speaks of. `target`: the pixels that the picture has.
    TextMap(PlaneFormula formula, const Size& picture, const Size& target, const Size& source)
        : PlaneMap(target, source), m_formula(std::move(formula)), m_scale(target, picture) {}

    template <class T>
    Point<T> source_point(const T& x, const T& y) const {
        return read(m_formula.point, x, y);
    }
    template <class T>
    T inside(const T& x, const T& y) const {
        return m_formula.is_everywhere ? T(1) : read(m_formula.domain, x, y).x;
    }

    // The members that make this a DirectMap (plan/formula_map.h).

    /// Do all operations of the formula have a bound near the middle of a block?
    bool may_be_direct() const;
    /// Evaluates the map near the middle of a block, as Panorama::direct() does.
    template <class Real>
    NearReading direct(double x, double y, double half_width, double half_height, const Local& local,
                       Bases& bases) const;
    /// The order in which bases are written and read: that of the program's steps, in both by read_program().
    static constexpr std::uint64_t kReadInSteps = 1;

    const FormulaProgram& program() const { return m_formula.point; }
    const PixelScale& scale() const { return m_scale; }

    /// Finds the source points of the points (x + i, y) as exact() does, within the same bound. `piece` is 0,
    /// or -1 where there is no source point.
    void exact_row(double x, double y, int count, double* to_x, double* to_y, std::int32_t* piece) const;

    /// The number of pixels of a box whose middles have no source point, wherever the source ends.
    std::int64_t undefined_pixels(const Box& box) const;

  private:
    /// Have the middles of all pixels of a box source points?
    Certainty is_defined(const Box& box) const;

    template <class T>
    Point<T> read(const FormulaProgram& program, const T& x, const T& y) const {
        const Point<T> at = m_scale(x, y);
        return read_point(program, at.x, at.y);
    }

    PlaneFormula m_formula;
    PixelScale m_scale;
};

}  // namespace anamorph
