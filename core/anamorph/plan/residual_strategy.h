// SPDX-License-Identifier: Apache-2.0
// Kim 2003, sections 3.1 and 4.3: bilinear cells of a table of residuals, which are added to a linear part.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "anamorph/plan/box_bounds.h"
#include "anamorph/plan/residual.h"

namespace anamorph::plan_detail {

/// Makes the cells of one piece of the target.
template <FormulaMap Map>
class ResidualStrategy {
  public:
    using Local = typename Map::Local;

    ResidualStrategy(const Map& map, const BoxBounds<Map>& bounds, int piece)
        : m_map(map), m_bounds(bounds), m_piece(piece) {}

    /// Bounds of the map's second derivatives over a box: interpolation in its cells is off by them.
    class Curvature {
      public:
        explicit Curvature(const Point<Jet<Interval, 2>>& p) : m_p(p) {}

        /// Bounds |f - its bilinear interpolant| by h^2 / 2 max |f_ss| per direction, h half the cell.
        double error(int width, int height) const {
            return error_of(width, height, [](const Interval& a) { return magnitude(a); });
        }
        /// Can no cell of the least sides within the box have an error() of `tol`? A derivative is nowhere smaller than the least
        /// magnitude of its interval. False where that is not known.
        bool is_hopeless(double tol) const { return error_of(kFloor, kFloor, least_magnitude) > tol; }
        /// Does cutting a box from top to bottom take away more of the error?
        bool is_cut_vertically(const Box& box) const {
            const double wide = magnitude(m_p.x.at(2, 0)) + magnitude(m_p.y.at(2, 0));
            const double high = magnitude(m_p.x.at(0, 2)) + magnitude(m_p.y.at(0, 2));
            return wide * box.width() * box.width() >= high * box.height() * box.height();
        }

      private:
        static double least_magnitude(const Interval& a) {
            return a.lo <= 0 && a.hi >= 0 ? 0 : std::min(std::fabs(a.lo), std::fabs(a.hi));
        }
        template <class Size>
        double error_of(int width, int height, const Size& size) const {
            const auto of = [&](const Jet<Interval, 2>& f) {
                return 0.25 * (size(f.at(2, 0)) * width * width + size(f.at(0, 2)) * height * height);
            };
            return length(of(m_p.x), of(m_p.y));
        }

        Point<Jet<Interval, 2>> m_p;
    };
    Curvature curvature(const Box& box, const Local& local) const {
        return Curvature(m_bounds.template enclose<2>(box, local));
    }

    /// A cell as a block's polynomial, with coefficients as in Block, and its error.
    struct Cell {
        double x[6], y[6], error;
    };
    Cell cell(const Box& box, const Local& local, double interpolation_error) {
        if (!m_linear) m_linear = linear_part(m_map, m_piece);
        double x[4], y[4], stored = 0;
        for (int i = 0; i < 4; ++i) {
            const double px = i & 1 ? box.x1 : box.x0, py = i & 2 ? box.y1 : box.y0;
            const Point<double> l = (*m_linear)(px, py), n = residual_at(m_map, *m_linear, local, px, py);
            const double nx = static_cast<float>(n.x), ny = static_cast<float>(n.y);
            stored = std::max(stored, std::fabs(nx) + std::fabs(ny));
            x[i] = l.x + nx;
            y[i] = l.y + ny;
        }
        Cell cell{};
        bilinear(box, x, cell.x);
        bilinear(box, y, cell.y);
        cell.error = interpolation_error + stored * 0x1p-24 + m_bounds.rounding_over(box, 0, 0, local);
        return cell;
    }

  private:
    /// Leads from values at a cell's corners, beyond the outermost pixel centres, to coefficients in s and t.
    static void bilinear(const Box& box, const double* v, double* c) {
        const double ks = half(box.width()) / (0.5 * box.width()),
                     kt = half(box.height()) / (0.5 * box.height());
        c[0] = 0.25 * (v[0] + v[1] + v[2] + v[3]);
        c[1] = 0.25 * (v[1] + v[3] - v[0] - v[2]) * ks;
        c[2] = 0.25 * (v[2] + v[3] - v[0] - v[1]) * kt;
        c[4] = 0.25 * (v[0] + v[3] - v[1] - v[2]) * ks * kt;
        c[3] = c[5] = 0;
    }

    const Map& m_map;
    const BoxBounds<Map>& m_bounds;
    int m_piece;
    std::optional<LinearPart> m_linear;
};

}  // namespace anamorph::plan_detail
