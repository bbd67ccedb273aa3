// SPDX-License-Identifier: Apache-2.0
// Plans a region in near/far: cells that hold the tolerance, by their bound.
//
// near_far_subdivider.cpp divides the region, near_far_interpolation.cpp bounds what far lines' polynomials are
// off by, and near_far_rounding.cpp what floats are.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "anamorph/morph/feature_lines.h"
#include "anamorph/morph/near_far.h"
#include "anamorph/morph/near_far_candidates.h"
#include "anamorph/morph/near_far_chebyshev.h"
#include "anamorph/morph/near_far_region.h"
#include "anamorph/morph/near_far_rounding.h"

namespace anamorph::near_far {

/// Adds sums over other lines, all with reaches from the same reference.
inline void add(simd::LineSums& to, const simd::LineSums& more) {
    to.value += more.value;
    to.error += more.error;
    to.least += more.least;
    to.most += more.most;
    to.reach += more.reach;
    to.slope += more.slope;
    to.near += more.near;
    to.near_reach += more.near_reach;
    to.farthest = std::max(to.farthest, more.farthest);
}

/// Sums over the lines that are already far, whose reaches are relative to `center`.
struct FarSums : simd::LineSums {
    Vector center{};

    void move(const Vector& to) {
        Vector d;
        for (std::size_t c = 0; c < kComponents; ++c) d[c] = to[c] - center[c];
        const double shift = length_of(d);
        error += shift * value;
        reach += shift * most;
        near_reach += shift * near;
        farthest += shift;
        center = to;
    }
};

/// The facts that are known of a cell beside its lines' own bounds.
struct Known {
    CellFrame frame;
    Vector center;    ///< displacement at the centre
    double least;     ///< lower bound of the sum of weights
    double mean;      ///< upper bound of the mean of |D_i - center|
    double spread;    ///< upper bound of |D - center|
    double offset;    ///< length of `center`
    double farthest;  ///< the greatest of the |D_i - center|
    bool finite;
};

/// The parts of the near lines' rounding: sums of how far D is moved by a unit of a weight's relative error, and by its
/// error from the place, per pixel; the least a + dist; and the errors of their displacements.
struct NearRounding {
    double moved = 0, moved_by_place = 0, nearest = HUGE_VAL, displacements = 0;
};

/// The total of the near lines' rounding: how far it moves D, apart from the error of the sum of weights; and the largest
/// relative error of weights.
struct NearError {
    double moved, weight;
};

/// Plans the blocks of one region.
class NearFarSubdivider {
  public:
    NearFarSubdivider(const FeatureMap& map, const NearFarOptions& options, const Chebyshev& chebyshev,
                      const std::vector<float>& slopes)
        : m_map(map),
          m_options(options),
          m_chebyshev(chebyshev),
          m_slopes(slopes),
          m_picture(widened({0, 0, map.target().width, map.target().height}, options.overscan)),
          m_weights{static_cast<float>(map.weights().a), static_cast<float>(map.weights().b)} {}

    void plan(int x0, int y0, Region& region);

  private:
    Candidates& level(std::size_t depth) {
        if (m_levels.size() <= depth) m_levels.resize(depth + 1);
        if (!m_levels[depth]) m_levels[depth] = std::make_unique<Candidates>();
        return *m_levels[depth];
    }
    /// Finds the lines as seen from the region's centre. False where floats cannot hold them.
    bool gather();
    /// Finds a line as seen from a point, with its displacement relative to the reference. False where floats cannot hold it.
    bool see(std::size_t i, double x, double y, FieldLine& to) const;

    // The planning of a cell: near_far_subdivider.cpp.
    /// `sums`: over the lines that are in the polynomial of `level(depth)` already, if it has one.
    void settle(int x0, int y0, int size, std::size_t depth, FarSums sums, bool has_polynomial);
    void divide(int x0, int y0, int size, std::size_t depth, const simd::LineBounds& bounds,
                const Known& known, FarSums sums, double budget, bool has_polynomial);
    /// Keeps the cell if its bound holds the tolerance.
    bool emit(const Box& box, Candidates& lines, const simd::LineBounds& bounds, const Known& known,
              const FarSums& sums, bool has_polynomial);
    /// Exact blocks on a square.
    void exact(int x0, int y0, int size);

    // Far lines: near_far_interpolation.cpp.
    Known look(int x0, int y0, int size, Candidates& lines, simd::LineBounds& bounds, FarSums& sums,
               bool has_polynomial) const;
    /// Can floats hold the cell's sums? `most`, `reach`: m and m r of all lines (simd::LineSums).
    bool floats_hold(const Known& known, double most, double reach) const;
    /// The error of the quotient from interpolation, from rounding at the nodes and from far lines' places in double.
    double quotient_error(const FarSums& sums, const Known& known) const;
    /// The error of an interpolant from summation in float at the nodes.
    double node_sum_rounding() const;
    static simd::LineSums select(Candidates& lines, const simd::LineBounds& bounds, const Known& known,
                                 double budget);
    /// Finds the polynomial of a cell: the one inherited from the cell above plus the interpolant of the far lines' sums.
    void interpolate(const Candidates& lines, const CellFrame& frame, bool has_polynomial, double* to);

    // Rounding: near_far_rounding.cpp.
    /// Fills in m_place and m_in_double for a region. False where lines are farther off than floats allow for.
    bool bound_doubles();
    /// The rounding of the displacement at the centre times the sum of weights, from sums over all lines: m r, m r / d, m,
    /// m times the displacement's change per pixel. Of what a polynomial adds up, interpolation makes
    /// Lebesgue_K^2 as much.
    double center_rounding(double reach, double near_reach, double most, double slope, double offset) const;
    double scale() const;
    /// The rounding of adding up, dividing and placing, and of the lines in double, which no subdivision of cells reduces.
    double base_rounding(const Known& known, int near) const;
    /// The rounding of a polynomial's coefficients and of Horner's rule; `size`: the sums of the coefficients' sizes.
    double far_rounding(const Known& known, const float* size) const;
    /// A weight off by a factor 1 + e moves D by e l |D_i - D|, l the weight's part of all, which is l (1 -
    /// l) times the distance of D_i from the mean of the others.
    NearRounding near_rounding(Candidates& lines, const simd::LineBounds& bounds, const Known& known,
                               const FarSums& far) const;
    NearError near_error(const NearRounding& near, bool fine, double half) const;

    const FeatureMap& m_map;
    const NearFarOptions& m_options;
    const Chebyshev& m_chebyshev;
    const std::vector<float>& m_slopes;
    const Box m_picture;
    Region* m_region = nullptr;
    simd::WeightParameters m_weights;
    double m_x = 0, m_y = 0;  ///< the region's centre
    double m_unit = 1;        ///< the unit of weights
    /// The relative errors of weights: from rounding, and from the rounding of the place, per pixel and a + dist.
    double m_constant = 0, m_by_nearest = 0;
    /// The rounding in double: of the places of near lines, in the target's pixels, and of a point by all that is no line's
    /// distance, in pixels of the shapes.
    double m_place = 0, m_in_double = 0;
    Vector m_reference{};  ///< displacements are relative to this
    std::vector<FieldLine> m_lines;
    std::vector<std::int32_t> m_far;
    std::vector<std::unique_ptr<Candidates>> m_levels;
};

}  // namespace anamorph::near_far
