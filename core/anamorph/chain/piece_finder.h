// SPDX-License-Identifier: Apache-2.0
// The pieces of a picture, found by what they hold.
#pragma once

#include <cstddef>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/number/interval.h"

namespace anamorph {

class PieceFinder {
  public:
    /// Takes pieces that do not overlap, at least one.
    explicit PieceFinder(std::vector<Box> pieces);

    const std::vector<Box>& all() const { return m_pieces; }
    /// The rectangle around all of them.
    const Box& frame() const { return m_frame; }
    /// Do they leave some of that free?
    bool have_gaps() const { return m_have_gaps; }

    /// The first piece that holds all of a box, its edges included; -1 where there is none.
    int holding(const Interval& x, const Interval& y) const;

  private:
    std::size_t bucket_of(double x, double y) const;

    std::vector<Box> m_pieces;
    Box m_frame;
    bool m_have_gaps;
    int m_side = 1, m_columns = 1, m_rows = 1;  ///< of buckets, squares of the frame
    std::vector<std::vector<int>> m_buckets;    ///< the pieces that meet each, their edges included, in order
};

}  // namespace anamorph
