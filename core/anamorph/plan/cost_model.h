// SPDX-License-Identifier: Apache-2.0
// The costs and savings of planning a region so far, and so what it may still cost. Wrong costs make pictures
// slower, and change no bound.
#pragma once

#include "anamorph/plan/boxes.h"
#include "anamorph/plan/costs.h"

namespace anamorph::plan_detail {

/// The way to draw pixels that no polynomial serves, as far as is known of the box that is being settled.
struct Fallback {
    enum Kind { unknown, exact, direct_in_float, direct_in_double } kind = unknown;
    double saving = 1;  ///< what a polynomial's pixel saves over one of these, in exact pixels
    double block = 0;   ///< what a polynomial's block costs beyond its pixels, in exact pixels

    bool is_direct() const { return kind >= direct_in_float; }
};

/// The account of a region, in exact pixels.
class CostModel {
  public:
    /// `only_fastest`: are polynomials wanted for their speed alone?
    CostModel(const PlanCosts& costs, bool only_fastest, const Box& region)
        : m_costs(costs),
          m_only_fastest(only_fastest),
          m_balance(costs.credit * pixels_of(region)),
          m_over_direct(m_balance) {}

    const PlanCosts& costs() const { return m_costs; }
    const Fallback& fallback() const { return m_fallback; }
    /// A bound over a box that is being settled.
    double bound() const {
        return m_fallback.kind == Fallback::direct_in_double ? m_costs.precise_bound : m_costs.bound;
    }
    void set_fallback(const Fallback& fallback) { m_fallback = fallback; }

    bool worth_a_polynomial() const {
        return !m_only_fastest || (m_fallback.is_direct() ? m_over_direct : m_balance) >= 0;
    }
    bool worth_a_bound(const Box& box) const {
        return worth_a_polynomial() &&
               (!m_only_fastest || pixels_of(box) * m_fallback.saving >= m_costs.bound_pixels);
    }

    /// Pays for bounds. What polynomials in all cost is paid for by what they save over the fallback.
    void pay_for_bounds(std::size_t at_once) {
        pay(bound() + m_costs.further_bound * (static_cast<double>(at_once) - 1));
    }
    void pay_for_rounding() { pay(m_costs.rounding); }
    /// Pays for a polynomial. `alone`: with a bound of its own rounding.
    void pay_for_polynomial(bool alone) {
        pay(alone ? m_costs.polynomial + m_costs.rounding : m_costs.polynomial);
    }
    void pay_for_direct_trial() { m_balance -= m_costs.direct_trial; }

    /// Enters a box that became a polynomial's.
    void save_polynomial(const Box& box) {
        const int pixels = pixels_of(box);
        if (m_fallback.is_direct()) m_over_direct += pixels - m_fallback.block / m_fallback.saving;
        m_balance += pixels * (m_fallback.is_direct() ? 1 - m_fallback.saving : 1);
    }
    void pay_for_double(const Box& box) { pay(m_costs.double_pixel * pixels_of(box)); }
    /// Enters a box that is left to direct blocks.
    void save_direct(const Box& box) { m_balance += pixels_of(box) * (1 - m_fallback.saving); }

  private:
    void pay(double exact_pixels) {
        if (m_fallback.is_direct())
            m_over_direct -= exact_pixels / m_fallback.saving;
        else
            m_balance -= exact_pixels;
    }

    PlanCosts m_costs;
    bool m_only_fastest;
    Fallback m_fallback;
    double m_balance;      ///< exact pixels saved less those that bounds and polynomials would have paid for
    double m_over_direct;  ///< m_balance in direct pixels, over those where they serve
};

}  // namespace anamorph::plan_detail
