// SPDX-License-Identifier: Apache-2.0
// The pull map of a panorama's picture whose rays are formulas that are text. Pixels, x right, y down, pixel centres at + 0.5.
#pragma once

#include "anamorph/formula/formula_text.h"
#include "anamorph/formula/pixel_scale.h"
#include "anamorph/panorama/panorama.h"
#include "anamorph/plan/costs.h"

namespace anamorph {

/// A reprojection whose target is given by formulas of its rays; from rays on it is a Panorama. A point has no ray where a
/// formula has no value or all three are 0.
class FormulaView {
  public:
    /// The costs of maps given as text.
    static constexpr PlanCosts kCosts{.bound = 400, .further_bound = 30, .polynomial = 20, .rounding = 45};

    /// `rays`: as parse_rays() makes them. `picture`: the size that they speak of. `target`: the pixels that the picture has.
    /// Throws Error as Panorama does.
    FormulaView(const Chart& source, SpaceFormula rays, const Size& picture, const Size& target,
                const Orientation& orientation = {}, const Orientation& held = {});

    const Chart& source() const { return m_view.source(); }

    // The members that make this a FormulaMap (plan/formula_map.h).
    using Local = Panorama::Local;
    Size target_size() const { return m_view.target_size(); }
    Size source_size() const { return m_view.source_size(); }
    std::vector<Box> target_pieces() const { return m_view.target_pieces(); }
    int source_piece(const Local& local) const { return m_view.source_piece(local); }
    int period() const { return m_view.period(); }
    SourceEdges source_edges() const { return m_view.source_edges(); }
    Local local_around(double x, double y, int piece) const;
    Cover cover(const Interval& x, const Interval& y, int piece, const Local& local, bool across_seam) const;

    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        // The frame of the target's rays is not turned, as that of a flat picture.
        return source().local_point(transform(local.rotation, ray(x, y), m_view.local_error()), local.source);
    }
    template <RealNumber Real>
    bool exact(const Real& x, const Real& y, int, Point<Real>& source_point, int& source_piece) const {
        if (!(domain(x, y) > 0)) return false;
        const Ray<Real> r = ray(x, y);
        return has_length(r) && m_view.exact(turned(r), source_point, source_piece);
    }
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int piece, double off = 0) const;

    /// Finds the source points of the points (x + i, y) as exact() does, within the same bound. `piece` is -1
    /// where there is no source point.
    void exact_row(double x, double y, int count, double* to_x, double* to_y, std::int32_t* piece) const;

    /// The number of pixels of a box that have no ray.
    std::int64_t undefined_pixels(const Box& box) const;

  private:
    /// Have all points of a box rays?
    Certainty has_rays(const Interval& x, const Interval& y) const;

    template <class T>
    Ray<T> ray(const T& x, const T& y) const {
        const Point<T> at = m_scale(x, y);
        const auto [to_x, to_y, to_z] = read_program<3>(m_rays.point, at.x, at.y);
        return {to_x, to_y, to_z};
    }
    /// A number that is positive where there is a ray.
    template <class T>
    T domain(const T& x, const T& y) const {
        if (m_rays.is_everywhere) return T(1);
        const Point<T> at = m_scale(x, y);
        return read_program<1>(m_rays.domain, at.x, at.y)[0];
    }
    template <RealNumber Real>
    static bool has_length(const Ray<Real>& r) {
        return r.x != 0 || r.y != 0 || r.z != 0;
    }
    /// The source's ray of a ray.
    template <class T>
    Ray<T> turned(const Ray<T>& r) const {
        return transform([&](int column, int row) { return m_view.turn()[column][row].template as<T>(); }, r);
    }

    /// The map from rays on, as of a flat picture of the same size.
    Panorama m_view;
    SpaceFormula m_rays;
    PixelScale m_scale;
};

}  // namespace anamorph
