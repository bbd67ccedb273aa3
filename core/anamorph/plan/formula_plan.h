// SPDX-License-Identifier: Apache-2.0
// The blocks of a map that is one formula: polynomials for the source point with a proven bound of their
// error, split where the bound exceeds the tolerance, exact where no block holds it. Exact pixels have a bound
// too: that of their rounding, in double, or where that is not enough in DoubleDouble.
//
// A map's plans are compiled once: the header of its plan declares `extern template class FormulaPlan<Map>`,
// and one source file includes plan/formula_plan_impl.h and instantiates it. See panorama/panorama_plan.h.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "anamorph/plan/block.h"
#include "anamorph/plan/costs.h"
#include "anamorph/plan/formula_map.h"
#include "anamorph/plan/scheme.h"

namespace anamorph {

/// How a map is approximated.
struct PlanOptions {
    Scheme scheme = Scheme::automatic;
    double tol = 0.01;  ///< source pixels
    /// May source points be left out that lie outside the source image by more than a filter's support?
    bool cull = true;
    /// May blocks run over the seam of a source that closes on itself, with x beyond its edges?
    bool across_seam = true;
    /// How many pixels beyond its edges the target has, across and down, on either side; only of one that is one piece.
    Size overscan = {};
    /// The costs that things are taken to have: by default costs_of() the map.
    std::optional<PlanCosts> costs = {};
};

/// A computed block as it is read near its middle: the place, the source point there, and its bases.
template <class Local, class Real>
struct NearBlock {
    const Local& place;
    Point<double> middle;
    std::span<const Real> bases;
};

/// The orders in which computed() and exact_rows() read a block's bases, in float and in double, as NearReading has that in
/// which they were written. A block whose bases come in another order is exact.
struct ReadOrders {
    std::uint64_t in_float = 0, in_double = 0;
};

/// The blocks of a FormulaMap.
template <class Map>
class FormulaPlan : public BlockMap {
  public:
    /// Throws Error when tol is negative or not a number.
    FormulaPlan(const Map& map, const PlanOptions& options, const ReadOrders& orders = {});

    const Map& map() const { return m_map; }
    const PlanOptions& options() const { return m_options; }

    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    bool truth(double x, double y, int piece, Point<DoubleDouble>& source_point,
               int& source_piece) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    bool is_smooth_in_pixels() const noexcept override { return true; }
    BlockPolynomial bicubic(const Block& block) const noexcept override;
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;
    /// Null where another scheme than automatic or exact is asked for.
    std::shared_ptr<const MapLink> link() const override;

  protected:
    void plan(const Box& box, int piece, Blocks& blocks) const override;

    /// A computed block as it is read, in float or in double.
    static NearBlock<typename Map::Local, float> near_in_float(const Block& block);
    static NearBlock<typename Map::Local, double> near_in_double(const Block& block);

  private:
    Map m_map;
    PlanOptions m_options;
    ReadOrders m_orders;
};

}  // namespace anamorph
