// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/cell_map.h"

#include <algorithm>
#include <cmath>

#include "anamorph/mesh/cells.h"
#include "anamorph/plan/block_writer.h"

namespace anamorph {
namespace {

// The sum of all coefficients of a bicubic that is at most 1.
constexpr double kMarkov = 100;

}  // namespace

CellMap::CellMap(std::shared_ptr<const Mesh> mesh) : m_mesh(std::move(mesh)) {
    const Box whole{0, 0, m_mesh->from().width, m_mesh->from().height};
    each_cell_of(*m_mesh, whole, [&](const MeshCell& cell, const Box& part) {
        m_pieces.push_back(part);
        m_cells.push_back(cell);
    });
    m_kept = std::make_shared<std::vector<Kept>>(m_cells.size());
}

bool CellMap::serves(const Mesh& mesh) {
    const Size size = mesh.from();
    const double pixels = double(size.width) * size.height;
    double cells = 0;
    mesh.each_cell(0, 0, size.width, size.height, [&](const MeshCell&) { ++cells; });
    return cells * kLeastPixels <= pixels || (pixels <= kSmallPicture && cells <= kMostInSmall);
}

CellMap::Form CellMap::form_of(const MeshCell& cell) const {
    const Patch patch = m_mesh->patch(cell);
    return {cell, patch, power_form(patch), double_rounding(*m_mesh, cell, patch)};
}

CellMap::Local CellMap::local_around(double x, double y, int piece) const {
    return with_form(x, y, piece, [&](const Form& form) { return local_of(form, x, y); });
}

CellMap::Local CellMap::local_of(const Form& form, double x, double y) const {
    const MeshCell& cell = form.cell;
    const double w = cell.x1 - cell.x0, h = cell.y1 - cell.y0;
    Bicubic powers = restricted(form.powers, {(x - cell.x0) / w, 1 / w}, {(y - cell.y0) / h, 1 / h});
    add_identity(powers, *m_mesh, {x, 1}, {y, 1});
    return {cell, {x, y}, powers, form.rounding};
}

Cover CellMap::cover(const Interval& x, const Interval& y, int, const Local& local, bool) const {
    // The outermost cells go on beyond the edges of the image.
    const auto holds = [](const std::vector<double>& lines, double from, double to, const Interval& a) {
        return (a.lo >= from || from <= lines.front()) && (a.hi <= to || to >= lines.back());
    };
    const MeshCell& cell = local.cell;
    if (!holds(m_mesh->x_lines(), cell.x0, cell.x1, x) || !holds(m_mesh->y_lines(), cell.y0, cell.y1, y))
        return Cover::mixed;
    const Point<Interval> p = (*this)(x, y, local);
    return is_near({magnitude(p.x), magnitude(p.y)}) ? Cover::inside : Cover::mixed;
}

Point<Interval> CellMap::operator()(const Interval& x, const Interval& y, const Local& local) const {
    const Point<Interval> p = polynomial(x, y, local);
    const Interval error(-local.error, local.error);
    return {p.x + error, p.y + error};
}

Point<Rounded<double>> CellMap::operator()(const Rounded<double>& x, const Rounded<double>& y,
                                           const Local& local) const {
    Point<Rounded<double>> p = polynomial(x, y, local);
    p.x.error += kMarkov * local.error;
    p.y.error += kMarkov * local.error;
    return p;
}

bool CellMap::is_near(const Point<double>& p) {
    return std::fabs(p.x) < kFarthest && std::fabs(p.y) < kFarthest;
}

double CellMap::exact_error(const Interval& x, const Interval& y, double off) const {
    const Bounds near = with_neighbors({x.lo, y.lo, x.hi, y.hi});
    const double rounding = exact_rounding_by_cells(*m_mesh, near);
    if (off == 0) return rounding;
    // The way from where a point belongs to where it is computed leads from cell to cell, in which the map goes on: it moves by no more
    // than the derivatives of all of them together, times that way.
    using J = Jet<Interval, 1>;
    double stretch = 0;
    m_mesh->each_cell(near.x0, near.y0, near.x1, near.y1, [&](const MeshCell& cell) {
        const Local local = local_of(form_of(cell), 0.5 * (x.lo + x.hi), 0.5 * (y.lo + y.hi));
        const Point<J> p = polynomial(J::variable(x, 1, 0), J::variable(y, 0, 1), local);
        for (const J& f : {p.x, p.y}) stretch += magnitude(f.c[1]) + magnitude(f.c[2]);
        // The error of the polynomial, of degree 3 each way, has derivatives of at most 9 times its size on [-1, 1] (Markov).
        const double side = std::min(cell.x1 - cell.x0, cell.y1 - cell.y0);
        stretch += 4 * 9 * local.error / (side / 2);
    });
    return (stretch * off + rounding) * rounded_detail::kUp;
}

}  // namespace anamorph
