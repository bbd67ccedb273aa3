// SPDX-License-Identifier: Apache-2.0
// A warp that has no formula that goes on with any other, as one for chains of maps: ST-maps, meshes of small cells, pairs of points,
// meshes that push. Alone it is drawn by a plan of its own; another map reads it at any place.
//
// Where a window of it lies near a cubic it is read as that cubic, which is off by `error` at most anywhere in the window
// (window_cubic.h); elsewhere pixels are exact. Windows are squares of several sizes, of each size so many that every box half as large
// lies in one. The largest that serves is taken.
#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/geometry/size.h"
#include "anamorph/mesh/window_cubic.h"
#include "anamorph/plan/block.h"
#include "anamorph/plan/costs.h"
#include "anamorph/plan/formula_map.h"

namespace anamorph {

/// What a warp says of itself: the map from a target to a source in pixels, x right, y down, pixel centres at + 0.5.
class WindowSource {
  public:
    virtual ~WindowSource() = default;

    virtual Size target_size() const = 0;
    virtual Size source_size() const = 0;
    /// Finds the source point of a target point in double. False where there is none.
    virtual bool exact(double x, double y, Point<double>& p) const = 0;
    /// Bounds the error of exact() over a box where its points may be off by `off` themselves, as FormulaMap's exact_error.
    virtual double exact_error(const Interval& x, const Interval& y, double off) const = 0;
    virtual Jacobian jacobian(double x, double y) const = 0;
    /// Finds a cubic that is off the map by `most` at most, in either coordinate, in a window of fit_of(). It serves where there is one.
    virtual WindowCubic cubic_over(const Box& window, double most) const = 0;
    /// Is there certainly no source point in a box?
    virtual bool misses(const Interval&, const Interval&) const { return false; }
    /// MapLink::points_of().
    virtual std::optional<Point<Interval>> points_of(const Interval&, const Interval&) const { return {}; }
};

/// The pixels of a window that cubics are fitted to, counted from its corner, and the fit to them.
struct WindowFit {
    std::vector<Point<int>> pixels;
    CubicFit fit;

    /// Fits a cubic to what `source` has at these pixels' centres. False where one has no source point.
    bool fits(const WindowSource& source, const Box& window, WindowCubic& cubic) const;
};
/// The fit for a window of a side that WindowMap has.
const WindowFit& fit_of(const Box& window);
/// A cubic of a window that says nothing yet.
WindowCubic cubic_about(const Box& window);
/// FormulaMap::cover() of a map that is read as a cubic: mixed where that does not stand for it in all of a box.
Cover cover_by(const WindowCubic& cubic, const Interval& x, const Interval& y);

class WindowMap {
  public:
    static constexpr PlanCosts kCosts{.bound = 20, .further_bound = 4, .polynomial = 4, .rounding = 6};

    /// `tol`: the tolerance that blocks are to hold, source pixels. Of 0 all pixels are exact, and cubics but tell how the map goes.
    WindowMap(std::shared_ptr<const WindowSource> source, double tol);

    /// The least distance of windows that pay.
    static constexpr int kLeastStep = 16;
    /// Do cubics serve, in windows no nearer to each other, in at least half of some places all over the map?
    bool is_smooth(int least_step = kLeastStep) const;

    // The members that make this a FormulaMap (plan/formula_map.h).

    using Local = WindowCubic;
    Size target_size() const { return m_source->target_size(); }
    Size source_size() const { return m_source->source_size(); }
    std::vector<Box> target_pieces() const { return {{0, 0, target_size().width, target_size().height}}; }
    SourceEdges source_edges() const { return {}; }
    int source_piece(const Local&) const { return 0; }
    int period() const { return 0; }
    /// The cubic of the largest window that serves, of those whose middle is nearest; where none does, the map's linear part.
    Local local_around(double x, double y, int piece) const;
    Cover cover(const Interval& x, const Interval& y, int piece, const Local& local, bool across_seam) const;

    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        return local(x, y);
    }
    template <RealNumber Real>
    bool exact(const Real& x, const Real& y, int, Point<Real>& p, int& source_piece) const {
        source_piece = 0;
        Point<double> at;
        if (!m_source->exact(static_cast<double>(x), static_cast<double>(y), at)) return false;
        p = {Real(at.x), Real(at.y)};
        return true;
    }
    /// The points are doubles whatever Real is.
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int, double off = 0) const {
        return m_source->exact_error(x, y, off);
    }
    std::optional<Point<Interval>> points_of(const Interval& x, const Interval& y) const {
        return m_source->points_of(x, y);
    }
    Jacobian jacobian(double x, double y, int) const { return m_source->jacobian(x, y); }

  private:
    class Windows;

    std::shared_ptr<const WindowSource> m_source;
    std::shared_ptr<const Windows> m_windows;
};

}  // namespace anamorph
