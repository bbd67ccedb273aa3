// SPDX-License-Identifier: Apache-2.0
// Taylor coefficients of a lens over rings about its centre. By how much a point is stretched, or shrunk the other way, is
// a function of its distance from the centre alone (but for a tangential part, chart/lens.h): what encloses the function's
// derivatives over narrow rings is made once, and a box lies in those that it meets. Over the box itself intervals would
// be many times wider, most of all those of a root.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "anamorph/chart/lens.h"

namespace anamorph {

/// The rings of one lens, each made when it is first asked for. Distances in the lens's own units. Thread safe.
class LensTable {
  public:
    using Coefficients = LensCoefficients;

    /// Makes the table of a lens that has none yet; `corner`: the distance of the picture's farthest observed point.
    LensTable(const LensTerms& lens, double corner);

    /// Encloses the Taylor coefficients of stretch_of() (chart/lens_formula.h) about every member of `squared`, in powers of
    /// the increment of the squared distance; shrink() does so for shrink_of().
    Coefficients stretch(const Interval& squared) const { return over(m_stretch, squared); }
    Coefficients shrink(const Interval& squared) const { return over(m_shrink, squared); }

    /// The Taylor coefficients of shrink() in powers of the increment of a value, and the error of computing them in double: up
    /// to degree 4 by shrink_series() from the root that it finds. Unbounded where that is not known.
    ComputedSeries computed_shrink(const Interval& value) const;

    /// An approximation of the root of radial_at(t) = value, in [0, end].
    double near_root(double value) const;

  private:
    struct Ring {
        std::once_flag made, computed_made;
        Coefficients coefficients;
        ComputedSeries computed;
        double middle = 0, root[4] = {};  ///< the root in powers of the increment of a value in the middle
    };
    struct Rings {
        bool shrink = false;
        std::vector<double> ends;  ///< squares of distances, one more than rings
        std::unique_ptr<Ring[]> rings;

        std::size_t index_of(double squared) const;
    };
    void cut(Rings& rings, double corner, double reach) const;
    const Ring& ring(const Rings& rings, std::size_t i) const;
    const ComputedSeries& computed_in(std::size_t i) const;
    void make(Ring& ring, const Interval& squared, bool shrink) const;
    Coefficients enclosed(const Interval& squared, bool shrink, int halvings) const;
    Coefficients shrink_at(const Interval& value) const;
    Coefficients direct(const Interval& squared, bool shrink) const;
    Coefficients over(const Rings& rings, const Interval& squared) const;

    LensTerms m_lens;
    Rings m_stretch, m_shrink;
};

}  // namespace anamorph
