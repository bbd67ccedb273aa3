// SPDX-License-Identifier: Apache-2.0
// The distortion of a lens taken off a picture, or put on one. Both pictures have the scale and the middle of the
// observed one, so that only their sizes differ, and the lens's centre stands at the same place in both: there nothing is moved.
// Pixels, x right, y down, pixel centres at + 0.5.
#pragma once

#include "anamorph/chart/chart_numbers.h"
#include "anamorph/plan/costs.h"
#include "anamorph/plan/formula_map.h"

namespace anamorph {

/// undistort: from the picture as it was taken (observed) to the one that a lens without distortion would have
/// given (ideal). distort: the other way round.
enum class LensMode { undistort, distort };

class LensMap : public PlaneMap<LensMap> {
  public:
    static constexpr PlanCosts kCosts{
        .bound = 200, .further_bound = 30, .polynomial = 18, .rounding = 20, .double_pixel = 0.5};

    /// `observed`: the chart that has the lens, of rectangular pixels edge to edge. `covered`: how much the target
    /// shows, in pixels of the observed picture. `target`: the pixels it has; `source`: those of the source. Throws
    /// Error when the chart has no lens.
    LensMap(const Chart& observed, LensMode mode, const Size& covered, const Size& target,
            const Size& source);

    /// The source point of a target point.
    template <class T>
    Point<T> source_point(const T& x, const T& y) const {
        const Point<T> p = m_mode == LensMode::undistort ? lens().observed(about_axis(in_plane(x, y)))
                                                         : about_middle(lens().ideal(in_plane(x, y)));
        return {p.x * m_scale_x.as<T>() + 0.5 * source_size().width,
                p.y * m_scale_y.as<T>() + 0.5 * source_size().height};
    }
    /// A number that is positive before the lens ends.
    template <class T>
    T inside(const T& x, const T& y) const {
        return m_mode == LensMode::undistort ? lens().sees(about_axis(in_plane(x, y)))
                                             : lens().inside(in_plane(x, y));
    }

    /// The least size that shows all of a source of `size` pixels that has a counterpart, with the same middle and
    /// with pixels that lie on those of the source. It may be larger than any picture.
    static Size covering(const Chart& observed, LensMode mode, const Size& size);

  private:
    const Lens& lens() const { return *m_observed.lens(); }

    template <class T>
    Point<T> in_plane(const T& x, const T& y) const {
        return {(x - 0.5 * target_size().width) * m_per_x.as<T>(),
                (y - 0.5 * target_size().height) * m_per_y.as<T>()};
    }

    /// Moves a point of the ideal picture so that it is about the axis of sight, which meets it in the lens's
    /// centre, as the lens reads it.
    template <class T>
    Point<T> about_axis(const Point<T>& p) const {
        const LensTerms& terms = lens().terms();
        if (!terms.shifted) return p;
        return {p.x - terms.shift_x.as<T>(), p.y - terms.shift_y.as<T>()};
    }
    /// Moves a point of the ideal picture back from the axis of sight to the picture's middle.
    template <class T>
    Point<T> about_middle(const Point<T>& p) const {
        const LensTerms& terms = lens().terms();
        if (!terms.shifted) return p;
        return {p.x + terms.shift_x.as<T>(), p.y + terms.shift_y.as<T>()};
    }

    Chart m_observed;
    LensMode m_mode;
    /// Units of the plane per target pixel, and source pixels per unit.
    Constant m_per_x, m_per_y, m_scale_x, m_scale_y;
};

}  // namespace anamorph
