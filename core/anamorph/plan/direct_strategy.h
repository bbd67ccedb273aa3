// SPDX-License-Identifier: Apache-2.0
// Decides where a map may be read pixel by pixel near the middles of blocks (direct_blocks.h), in float or in
// double.
#pragma once

#include <cmath>

#include "anamorph/plan/box_bounds.h"
#include "anamorph/plan/cost_model.h"
#include "anamorph/plan/direct_blocks.h"

namespace anamorph::plan_detail {

// Where a pixel has more texels than this, what it reads lies apart from what its neighbours read.
inline constexpr double kTexelsApart = 12;

/// Tries direct blocks; what they are made of is found later, for those that are placed.
template <FormulaMap Map>
class DirectStrategy {
  public:
    /// `goal`: the largest error that is allowed. `in_double`: is float not tried?
    DirectStrategy(const Map& map, const BoxBounds<Map>& bounds, const ReadOrders& orders, double goal,
                   bool in_double, CostModel& costs)
        : m_map(map),
          m_bounds(bounds),
          m_orders(orders),
          m_goal(goal),
          m_in_double(in_double),
          m_costs(costs) {}

    bool is_possible() const {
        if constexpr (DirectMap<Map>)
            return m_read_as_written && m_map.may_be_direct();
        else
            return false;
    }

    /// The way that serves most of a box, judged by the block in its middle.
    struct Trial {
        Fallback fallback;
        double error = 0;  ///< the block's, where the fallback is unknown; 0 where it was not tried
    };
    Trial try_middle(const Box& box) {
        if constexpr (DirectMap<Map>)
            if (is_possible()) return m_in_double ? try_in_double(box) : try_in_float(box);
        return {};
    }

  private:
    Trial try_in_double(const Box& box) {
        const Middle middle = read_middle<double>(box);
        if (!m_read_as_written) return {};
        return middle.error <= m_goal ? in_double(middle.box) : Trial{{}, middle.error};
    }
    Trial try_in_float(const Box& box) {
        const PlanCosts& costs = m_costs.costs();
        Middle middle = read_middle<float>(box);
        if (!m_read_as_written) return {};
        if (middle.error <= m_goal) return {{Fallback::direct_in_float, costs.direct_pixel}};
        // Where float holds it in smaller blocks only, a polynomial saves more.
        if (serves_in_float(middle.box, middle.error, m_goal) && holds_in_small_parts(middle.box))
            return {{Fallback::direct_in_float, costs.precise_pixel}};
        if (middle.error < HUGE_VAL) middle.error = error_in<double>(middle.box);
        return middle.error <= m_goal ? in_double(middle.box) : Trial{{}, middle.error};
    }
    Trial in_double(const Box& middle) const {
        const PlanCosts& costs = m_costs.costs();
        const bool apart = m_bounds.texels_of_pixel(middle) > kTexelsApart;
        return {{Fallback::direct_in_double, apart ? costs.apart_pixel : costs.precise_pixel, costs.block}};
    }

    struct Middle {
        Box box;
        double error;
    };
    /// Reads the block in the middle of a box. Where blocks are too large for any bound, smaller ones may
    /// have one.
    template <class Real>
    Middle read_middle(const Box& box) {
        Middle middle{is_block(box) ? box : middle_of(box), 0};
        middle.error = error_in<Real>(middle.box);
        while (m_read_as_written && !(middle.error < HUGE_VAL) && is_cut(middle.box)) {
            middle.box = part_of(middle.box);
            middle.error = error_in<Real>(middle.box);
        }
        return middle;
    }
    bool holds_in_small_parts(Box box) {
        while (is_cut(box)) box = part_of(box);
        return error_in<float>(box) <= m_goal;
    }
    static bool is_cut(const Box& box) { return pixels_of(box) >= 2 * kLeastInFloat; }
    static Box part_of(const Box& box) { return sub_box(box, box.width() > box.height(), false); }

    template <class Real>
    double error_in(const Box& box) {
        m_costs.pay_for_direct_trial();
        const auto place = m_bounds.place_about(box);
        const NearReading found = read_near<Real>(m_map, box, place.local, m_orders, m_bases);
        m_read_as_written = m_read_as_written && is_read_as_written<Real>(found, m_orders);
        return found.error;
    }

    const Map& m_map;
    const BoxBounds<Map>& m_bounds;
    ReadOrders m_orders;
    double m_goal;
    bool m_in_double;
    CostModel& m_costs;
    bool m_read_as_written = true;  ///< would direct blocks read the bases that are written for them?
    Bases m_bases;
};

}  // namespace anamorph::plan_detail
