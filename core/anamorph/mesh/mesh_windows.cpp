// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_windows.h"

#include <algorithm>
#include <cmath>

#include "anamorph/mesh/cells.h"
#include "anamorph/mesh/hermite.h"
#include "anamorph/number/hypot.h"
#include "anamorph/plan/block_writer.h"

namespace anamorph {
namespace {

/// A cell's map in powers of its parameters from 0 to 1.
Bicubic powers_of(const Mesh& mesh, const MeshCell& cell, const Patch& patch) {
    Bicubic f = power_form(patch);
    add_identity(f, mesh, {cell.x0, cell.x1 - cell.x0}, {cell.y0, cell.y1 - cell.y0});
    return f;
}

/// How far a cell's map is from a cubic, on the part of the cell in a window that reaches [-1, 1] in the cubic's parameters.
Point<double> distance_in_part(const Mesh& mesh, const MeshCell& cell, const Patch& patch,
                               const WindowCubic& cubic) {
    // The common part in either's parameters.
    const auto common = [&](double from, double to, double middle, Part& in_cell, Part& in_window) {
        const double low = std::max(from, middle - 1 / cubic.unit),
                     high = std::min(to, middle + 1 / cubic.unit);
        const double at = 0.5 * (low + high), reach = 0.5 * std::max(0.0, high - low);
        in_cell = {(at - from) / (to - from), reach / (to - from)};
        in_window = {(at - middle) * cubic.unit, reach * cubic.unit};
    };
    Part s, t, u, v;
    common(cell.x0, cell.x1, cubic.middle.x, s, u);
    common(cell.y0, cell.y1, cubic.middle.y, t, v);
    Bicubic p{};
    for (int k = 0; k < 10; ++k) {
        p.x[WindowCubic::kAcross[k]][WindowCubic::kDown[k]] = cubic.cx[k];
        p.y[WindowCubic::kAcross[k]][WindowCubic::kDown[k]] = cubic.cy[k];
    }
    Bicubic off = restricted(powers_of(mesh, cell, patch), s, t);
    const Bicubic near = restricted(p, u, v);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            off.x[i][j] -= near.x[i][j];
            off.y[i][j] -= near.y[i][j];
        }
    return {chebyshev_size(off.x), chebyshev_size(off.y)};
}

/// How far a cell's map is from a cubic anywhere on the cell, by what they are at its corners.
Point<double> distance_by_corners(const Mesh& mesh, const MeshCell& cell, const Patch& patch,
                                  const WindowCubic& cubic) {
    const double w = cell.x1 - cell.x0, h = cell.y1 - cell.y0;
    const double ds = w * cubic.unit, dt = h * cubic.unit;
    Point<double> value{0, 0}, by_s{0, 0}, by_t{0, 0}, twist{0, 0};
    const auto raise = [](Point<double>& most, double x, double y) {
        most = {std::max(most.x, std::fabs(x)), std::max(most.y, std::fabs(y))};
    };
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            const double x = i ? cell.x1 : cell.x0, y = j ? cell.y1 : cell.y0;
            const double s = (x - cubic.middle.x) * cubic.unit, t = (y - cubic.middle.y) * cubic.unit;
            struct Corner {
                double value, by_s, by_t, twist;
            };
            const auto at = [s, t](const double* c) -> Corner {
                const double c1 = c[1] + t * (c[4] + t * c[8]), c2 = c[3] + t * c[7], c3 = c[6];
                return {c[0] + t * (c[2] + t * (c[5] + t * c[9])) + s * (c1 + s * (c2 + s * c3)),
                        c1 + s * (2 * c2 + 3 * s * c3),
                        c[2] + t * (2 * c[5] + 3 * t * c[9]) + s * (c[4] + 2 * t * c[8] + s * c[7]),
                        c[4] + 2 * t * c[8] + 2 * s * c[7]};
            };
            const Corner px = at(cubic.cx), py = at(cubic.cy);
            const Point<double>&g = patch.g[i][j], &gs = patch.g[2 + i][j], &gt = patch.g[i][2 + j],
                  &gst = patch.g[2 + i][2 + j];
            raise(value, px.value - x * mesh.scale().x - g.x, py.value - y * mesh.scale().y - g.y);
            raise(by_s, px.by_s * ds - w * mesh.scale().x - gs.x, py.by_s * ds - gs.y);
            raise(by_t, px.by_t * dt - gt.x, py.by_t * dt - h * mesh.scale().y - gt.y);
            raise(twist, px.twist * ds * dt - gst.x, py.twist * ds * dt - gst.y);
        }
    return value + (by_s + by_t) * 0.25 + twist * 0.0625;
}

}  // namespace

bool MeshWindows::exact(double x, double y, Point<double>& p) const {
    p = m_mesh->at(x, y);
    return std::fabs(p.x) < kFarthest && std::fabs(p.y) < kFarthest;
}

Jacobian MeshWindows::jacobian(double x, double y) const {
    using J = Jet1<double>;
    const Point<J> p =
        m_mesh->at(m_mesh->patch(m_mesh->cell_at(x, y)), J::variable(x, 1, 0), J::variable(y, 0, 1));
    return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
}

WindowCubic MeshWindows::cubic_over(const Box& window, double most) const {
    WindowCubic cubic = cubic_about(window);
    const Bounds all{double(window.x0), double(window.y0), double(window.x1), double(window.y1)};
    int cells = 0;
    m_mesh->each_cell(all.x0, all.y0, all.x1, all.y1, [&](const MeshCell&) { ++cells; });
    if (cells * double{kLeastPixels} > double(window.width()) * window.height()) return cubic;
    if (!fit_of(window).fits(*this, window, cubic)) return cubic;
    // What double rounds of the cubic here and where it is read, shifted and scaled to a part: less than 256 units of its size.
    const double rounded = 1.4143 * 0x1p-45 * cubic.size();
    double error = 0;
    m_mesh->each_cell(all.x0, all.y0, all.x1, all.y1, [&](const MeshCell& cell) {
        if (!(error <= most)) return;
        const Patch patch = m_mesh->patch(cell);
        const bool is_in = cell.x0 >= all.x0 && cell.y0 >= all.y0 && cell.x1 <= all.x1 && cell.y1 <= all.y1;
        const Point<double> off = is_in ? distance_by_corners(*m_mesh, cell, patch, cubic)
                                        : distance_in_part(*m_mesh, cell, patch, cubic);
        const double here = hypot(off.x, off.y) + rounded + double_rounding(*m_mesh, cell, patch);
        // Written so that what is no number is too much.
        if (!(here <= error)) error = here;
    });
    error *= rounded_detail::kUp;
    if (!(error <= most)) return cubic;
    cubic.error = error;
    cubic.x = {all.x0, all.x1};
    cubic.y = {all.y0, all.y1};
    return cubic;
}

template <class Body>
void MeshWindows::each_part(const Interval& x, const Interval& y, const Body& body) const {
    const Bounds all = with_neighbors({x.lo, y.lo, x.hi, y.hi});
    m_mesh->each_cell(all.x0, all.y0, all.x1, all.y1, [&](const MeshCell& cell) {
        const Patch patch = m_mesh->patch(cell);
        // The outermost cells go on beyond the picture.
        const auto part = [](double from, double to, const std::vector<double>& lines, double low,
                             double high) {
            const double a = from <= lines.front() ? low : std::max(from, low),
                         b = to >= lines.back() ? high : std::min(to, high);
            return Part{(0.5 * (a + b) - from) / (to - from), 0.5 * (b - a) / (to - from)};
        };
        const Part s = part(cell.x0, cell.x1, m_mesh->x_lines(), all.x0, all.x1),
                   t = part(cell.y0, cell.y1, m_mesh->y_lines(), all.y0, all.y1);
        body(cell, patch, s, t, restricted(powers_of(*m_mesh, cell, patch), s, t));
    });
}

/// Where points are off by `off`, the map moves them by that times its slope at most, which is its coefficients' on what of the box
/// lies in each cell: a power of a parameter in [-1, 1] changes by no more than its degree.
double MeshWindows::exact_error(const Interval& x, const Interval& y, double off) const {
    if (off == 0) return exact_rounding_by_cells(*m_mesh, with_neighbors({x.lo, y.lo, x.hi, y.hi}));
    double rounding = 0, slope = 0;
    each_part(x, y,
              [&](const MeshCell& cell, const Patch& patch, const Part& s, const Part& t, const Bicubic& f) {
                  const double here = exact_rounding(*m_mesh, cell, patch);
                  if (!(here <= rounding)) rounding = here;
                  double by_s[2] = {}, by_t[2] = {};
                  for (int i = 0; i < 4; ++i)
                      for (int j = 0; j < 4; ++j) {
                          by_s[0] += i * std::fabs(f.x[i][j]), by_s[1] += i * std::fabs(f.y[i][j]);
                          by_t[0] += j * std::fabs(f.x[i][j]), by_t[1] += j * std::fabs(f.y[i][j]);
                      }
                  const double steep = hypot(hypot(by_s[0], by_s[1]) / (s.half * (cell.x1 - cell.x0)),
                                             hypot(by_t[0], by_t[1]) / (t.half * (cell.y1 - cell.y0)));
                  if (!(steep <= slope)) slope = steep;
              });
    return (rounding + slope * off) * rounded_detail::kUp;
}

std::optional<Point<Interval>> MeshWindows::points_of(const Interval& x, const Interval& y) const {
    Point<Interval> all{{HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}};
    each_part(x, y,
              [&](const MeshCell& cell, const Patch& patch, const Part&, const Part&, const Bicubic& f) {
                  const double rounding = double_rounding(*m_mesh, cell, patch);
                  const auto add = [&](Interval& to, const double(&c)[4][4]) {
                      const double reach = sum_of_magnitudes(c) - std::fabs(c[0][0]) + rounding;
                      to = {std::min(to.lo, c[0][0] - reach), std::max(to.hi, c[0][0] + reach)};
                  };
                  add(all.x, f.x);
                  add(all.y, f.y);
              });
    const bool is_near = magnitude(all.x) < kFarthest && magnitude(all.y) < kFarthest;
    return is_near ? std::optional(all) : std::nullopt;
}

}  // namespace anamorph
