// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/window_map.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "anamorph/plan/block_writer.h"

namespace anamorph {
namespace {

// From one window to the next. Windows have two pixels more on either side, so that no box of that size lies in none.
constexpr std::array kSteps{128, 64, 32, 16, 8};
constexpr int side_of(int step) {
    return 2 * step + 4;
}
// Cubics are fitted to so many pixels each way, or one more.
constexpr int kFitted = 8;
// What cubics may be off where all pixels are exact, and cubics but tell where the map leads.
constexpr double kNearby = 1.0 / 512;
// What cubics may be off where it is asked whether a map is smooth, whatever the tolerance: what they may be of the default one.
constexpr double kSmooth = 0.01 * WindowCubic::kShare;

WindowFit make_fit(int side) {
    std::vector<Point<int>> pixels;
    std::vector<Point<double>> places;
    const int step = side / kFitted;
    const auto place = [&](int i) { return (2 * i - (side - 1)) / static_cast<double>(side); };
    for (int j = step / 2; j < side; j += step)
        for (int i = step / 2; i < side; i += step) {
            pixels.push_back({i, j});
            places.push_back({place(i), place(j)});
        }
    return {std::move(pixels), CubicFit(std::move(places))};
}

}  // namespace

const WindowFit& fit_of(const Box& window) {
    static const std::array<WindowFit, kSteps.size()> all = [] {
        return std::array{make_fit(side_of(kSteps[0])), make_fit(side_of(kSteps[1])),
                          make_fit(side_of(kSteps[2])), make_fit(side_of(kSteps[3])),
                          make_fit(side_of(kSteps[4]))};
    }();
    std::size_t i = 0;
    while (i + 1 < kSteps.size() && side_of(kSteps[i]) > window.width()) ++i;
    return all[i];
}

WindowCubic cubic_about(const Box& window) {
    WindowCubic cubic;
    cubic.middle = {0.5 * (window.x0 + window.x1), 0.5 * (window.y0 + window.y1)};
    cubic.unit = 2.0 / window.width();
    return cubic;
}

Cover cover_by(const WindowCubic& cubic, const Interval& x, const Interval& y) {
    if (!cubic.holds(x, y)) return Cover::mixed;
    const Point<Interval> p = cubic(x, y);
    return magnitude(p.x) < kFarthest && magnitude(p.y) < kFarthest ? Cover::inside : Cover::mixed;
}

bool WindowFit::fits(const WindowSource& source, const Box& window, WindowCubic& cubic) const {
    bool all = true;
    fit.fit(
        [&](std::size_t n) {
            Point<double> p{};
            all = all && source.exact(window.x0 + pixels[n].x + 0.5, window.y0 + pixels[n].y + 0.5, p);
            return p;
        },
        cubic);
    return all;
}

/// The cubics of all windows, each made when it is first asked for.
class WindowMap::Windows {
  public:
    Windows(const WindowSource& source, double most) : m_source(source), m_most(most) {
        const Size size = source.target_size();
        for (const int step : kSteps) {
            const int side = side_of(step);
            if (size.width < side || size.height < side) continue;
            const auto count = [&](int length) { return (length - side + step - 1) / step + 1; };
            m_grids.emplace_back(step, count(size.width), count(size.height));
        }
    }
    Windows(const Windows&) = delete;
    Windows& operator=(const Windows&) = delete;
    ~Windows() {
        for (Grid& grid : m_grids)
            for (std::atomic<const WindowCubic*>& cubic : grid.cubics) delete cubic.load();
    }

    /// The largest window that serves of those whose middle is nearest to a point; null where none does.
    const WindowCubic* serving(double x, double y, int least_step) const {
        for (const Grid& grid : m_grids) {
            if (grid.step < least_step) break;
            const auto nearest = [&](double at, int count) {
                return static_cast<int>(std::clamp(std::floor(at / grid.step - 0.5), 0.0, count - 1.0));
            };
            const WindowCubic& cubic = window(grid, nearest(x, grid.columns), nearest(y, grid.rows));
            if (cubic.serves()) return &cubic;
        }
        return nullptr;
    }

  private:
    struct Grid {
        int step, columns, rows;
        mutable std::vector<std::atomic<const WindowCubic*>> cubics;

        Grid(int s, int c, int r)
            : step(s),
              columns(c),
              rows(r),
              cubics(static_cast<std::size_t>(c) * static_cast<std::size_t>(r)) {}
    };

    /// Threads that make one at once make the same; the first that is done keeps it.
    const WindowCubic& window(const Grid& grid, int column, int row) const {
        auto& kept = grid.cubics[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) +
                                 static_cast<std::size_t>(column)];
        const WindowCubic* known = kept.load(std::memory_order_acquire);
        if (known) return *known;
        // That of number i has its middle `step` (i + 1) pixels from the edge, as blocks have.
        const Size size = m_source.target_size();
        const int side = side_of(grid.step);
        const auto first = [&](int number, int length) {
            return std::clamp(grid.step * (number + 1) - side / 2, 0, length - side);
        };
        const int x = first(column, size.width), y = first(row, size.height);
        auto made =
            std::make_unique<const WindowCubic>(m_source.cubic_over({x, y, x + side, y + side}, m_most));
        if (kept.compare_exchange_strong(known, made.get(), std::memory_order_acq_rel))
            return *made.release();
        return *known;
    }

    const WindowSource& m_source;
    double m_most;
    std::vector<Grid> m_grids;
};

WindowMap::WindowMap(std::shared_ptr<const WindowSource> source, double tol)
    : m_source(std::move(source)),
      m_windows(std::make_shared<const Windows>(*m_source, tol > 0 ? WindowCubic::kShare * tol : kNearby)) {}

bool WindowMap::is_smooth(int least_step) const {
    constexpr int kTried = 8;
    const Windows windows(*m_source, kSmooth);
    const Size size = target_size();
    int missing = 0;
    for (int j = 0; j < kTried; ++j)
        for (int i = 0; i < kTried; ++i) {
            const double x = (i + 0.5) * size.width / kTried, y = (j + 0.5) * size.height / kTried;
            missing += !windows.serving(x, y, least_step);
            if (2 * missing > kTried * kTried) return false;
        }
    return true;
}

WindowMap::Local WindowMap::local_around(double x, double y, int) const {
    if (const WindowCubic* cubic = m_windows->serving(x, y, 0)) return *cubic;
    WindowCubic linear;
    linear.middle = {x, y};
    const Jacobian j = m_source->jacobian(x, y);
    if (Point<double> at; m_source->exact(x, y, at)) linear.cx[0] = at.x, linear.cy[0] = at.y;
    linear.cx[1] = j.x_i, linear.cx[2] = j.x_j;
    linear.cy[1] = j.y_i, linear.cy[2] = j.y_j;
    return linear;
}

Cover WindowMap::cover(const Interval& x, const Interval& y, int, const Local& local, bool) const {
    return m_source->misses(x, y) ? Cover::outside : cover_by(local, x, y);
}

}  // namespace anamorph
