// SPDX-License-Identifier: Apache-2.0
// Where in a picture points of its source are seen: the inverse of a map, point by point.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/geometry/size.h"
#include "anamorph/plan/block.h"

namespace anamorph::command {

/// Finds points of a picture by Newton's iteration, from those of a grid over it whose source points are nearest. What is found depends on
/// nothing but the point. Thread safe; keeps a reference to the map.
class InversePoints {
  public:
    /// `data`: the part of the map's target that may be looked in; `source`: the size of what the map reads.
    InversePoints(const BlockMap& map, const Box& data, const Size& source);

    /// The point that shows a point of the source, met to 1e-9 of the source's larger side; none where it is not found.
    std::optional<Point<double>> of(const Point<double>& wanted) const;

  private:
    struct Start {
        Point<double> at, source;
    };
    std::optional<Point<double>> source_of(const Point<double>& at) const;
    std::optional<Point<double>> newton(const Start& start, const Point<double>& wanted) const;
    std::size_t cell_of(const Point<double>& p) const;

    const BlockMap& m_map;
    Box m_data;
    double m_met;
    std::vector<Start> m_starts;
    Point<double> m_low{0, 0}, m_size{1, 1};
    std::vector<std::vector<std::uint32_t>>
        m_near;  ///< by cells of the source, the starts nearest to their middles
};

}  // namespace anamorph::command
