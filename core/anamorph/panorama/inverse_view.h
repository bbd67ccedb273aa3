// SPDX-License-Identifier: Apache-2.0
// The pull map of a panorama's picture whose projection is known the other way alone: formulas that are text say where in it a
// direction goes. Pixels, x right, y down, pixel centres at + 0.5.
#pragma once

#include "anamorph/formula/pushed_map.h"
#include "anamorph/panorama/panorama.h"

namespace anamorph {

/// The map by a PushedMap from the globe to the picture, inverted, and by a Panorama from the globe on.
class InverseView {
  public:
    /// The costs of PushedMap, whose source points cost most here too.
    static constexpr PlanCosts kCosts = PushedMap::kCosts;
    /// The pixels of the globe, an equirectangular picture, in which directions are counted.
    static constexpr Size kGlobe{2048, 1024};

    /// `points`: as parse_directions() makes them. `picture`: the size that they speak of. `target`: the
    /// pixels that the picture has, `overscan`: those beyond its edges. Throws Error as Panorama and PushedMap do.
    InverseView(const Chart& source, PlaneFormula points, const Size& picture, const Size& target,
                const Orientation& orientation = {}, const Orientation& held = {}, const Size& overscan = {});

    const Chart& source() const { return m_view.source(); }

    // The members that make this a FormulaMap (plan/formula_map.h).
    struct Local {
        PushedMap::Local globe;
        Panorama::Local view;
    };
    Size target_size() const { return m_globe.target_size(); }
    Size source_size() const { return m_view.source_size(); }
    std::vector<Box> target_pieces() const { return m_globe.target_pieces(); }
    int source_piece(const Local& local) const { return m_view.source_piece(local.view); }
    int period() const { return m_view.period(); }
    static bool reads_computed_points() { return PushedMap::reads_computed_points(); }
    SourceEdges source_edges() const { return m_view.source_edges(); }
    Local local_around(double x, double y, int piece) const;
    Cover cover(const Interval& x, const Interval& y, int piece, const Local& local, bool across_seam) const;

    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        const Point<T> at = m_globe(x, y, local.globe);
        return m_view(at.x, at.y, local.view);
    }
    template <RealNumber Real>
    bool exact(const Real& x, const Real& y, int piece, Point<Real>& source_point, int& source_piece) const {
        Point<Real> at;
        return m_globe.exact(x, y, piece, at, source_piece) &&
               m_view.exact(m_view.source_ray(at.x, at.y, 0), source_point, source_piece);
    }
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int piece) const;

    /// The number of pixels of a box that show no direction.
    std::int64_t undefined_pixels(const Box& box) const { return m_globe.undefined_pixels(box); }

  private:
    /// Bounds the error of source points from points of the globe in a box, which are computed off by `error`
    /// at most.
    template <class Real>
    double error_from(const Point<Interval>& at, double error) const;

    PushedMap m_globe;
    Panorama m_view;  ///< from the globe to the source
};

}  // namespace anamorph
