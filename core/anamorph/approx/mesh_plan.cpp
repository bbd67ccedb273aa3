// SPDX-License-Identifier: Apache-2.0
#include "anamorph/approx/mesh_plan.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>

#include "anamorph/approx/block_writer.h"
#include "anamorph/approx/hermite.h"
#include "anamorph/approx/mesh_residual.h"

namespace anamorph {
namespace {

/// The pixels whose centres lie in [from, to), as far as they lie in [first, last).
void pixels_between(double from, double to, int first, int last, int& begin, int& end) {
    const auto number = [&](double at) {
        return static_cast<int>(std::clamp(std::ceil(at - 0.5), double(first), double(last)));
    };
    begin = number(from);
    end = number(to);
}

/// One cell of the mesh, as it is planned.
struct CellForm {
    Mesh const& mesh;
    MeshCell cell;
    Patch patch;
    Bicubic powers;
    double rounding;  ///< of the map in double

    CellForm(const Mesh& m, const MeshCell& c)
        : mesh(m),
          cell(c),
          patch(m.patch(c)),
          powers(power_form(patch)),
          rounding(double_rounding(m, c, patch)) {}

    /// The parameters of a row or column of pixel centres.
    Part across(const Box& b) const {
        const double w = 1 / (cell.x1 - cell.x0);
        return {(0.5 * (b.x0 + b.x1) - cell.x0) * w, half(b.width()) * w};
    }
    Part down(const Box& b) const {
        const double h = 1 / (cell.y1 - cell.y0);
        return {(0.5 * (b.y0 + b.y1) - cell.y0) * h, half(b.height()) * h};
    }

    /// The map, not only the displacement, on a block, in powers of parameters in [-1, 1].
    Bicubic on(const Box& b) const {
        Bicubic f = restricted(powers, across(b), down(b));
        add_identity(f, mesh, {0.5 * (b.x0 + b.x1), half(b.width())},
                     {0.5 * (b.y0 + b.y1), half(b.height())});
        return f;
    }
};

/// Calls body(cell, part) for the cells that meet a box of pixels, with the pixels whose centres they hold.
template <class Body>
void each_cell_of(const Mesh& mesh, const Box& box, const Body& body) {
    mesh.each_cell(box.x0 + 0.5, box.y0 + 0.5, box.x1 - 0.5, box.y1 - 0.5, [&](const MeshCell& cell) {
        Box part;
        // The outermost cells go on to the edges of the image.
        pixels_between(cell.x0 <= mesh.x_lines().front() ? -1 : cell.x0,
                       cell.x1 >= mesh.x_lines().back() ? HUGE_VAL : cell.x1, box.x0, box.x1, part.x0,
                       part.x1);
        pixels_between(cell.y0 <= mesh.y_lines().front() ? -1 : cell.y0,
                       cell.y1 >= mesh.y_lines().back() ? HUGE_VAL : cell.y1, box.y0, box.y1, part.y0,
                       part.y1);
        if (!part.empty()) body(cell, part);
    });
}

/// Have cells so few pixels in a box that blocks are better off without them?
bool has_small_cells(const Mesh& mesh, const Box& box) {
    double cells = 0;
    mesh.each_cell(box.x0 + 0.5, box.y0 + 0.5, box.x1 - 0.5, box.y1 - 0.5, [&](const MeshCell&) { ++cells; });
    return double(box.width()) * box.height() < BlockWriter::kFloorPixels * cells;
}

/// The sign of the Jacobian's determinant on a block: of a map in powers of parameters in [-1, 1], each of
/// whose derivatives errs by at most `rounding`. 0 where it is not the same everywhere, as far as can be
/// seen.
int sign_of_determinant(const Bicubic& f, double rounding) {
    // A derivative is c[1][0] (along s) or c[0][1] (along t), give or take the magnitudes of its other terms.
    struct Range {
        double middle, radius;
    };
    const auto range = [&](const double(&c)[4][4], bool along_s) {
        Range r{along_s ? c[1][0] : c[0][1], rounding - std::fabs(along_s ? c[1][0] : c[0][1])};
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) r.radius += (along_s ? i : j) * std::fabs(c[i][j]);
        return r;
    };
    const auto times = [](const Range& a, const Range& b) {
        const double radius =
            std::fabs(a.middle) * b.radius + a.radius * std::fabs(b.middle) + a.radius * b.radius;
        return Range{a.middle * b.middle, radius};
    };
    const Range forth = times(range(f.x, true), range(f.y, false)),
                back = times(range(f.x, false), range(f.y, true));
    const double middle = forth.middle - back.middle;
    const double radius =
        (forth.radius + back.radius) + 1e-14 * (std::fabs(forth.middle) + std::fabs(back.middle));
    return middle > radius ? 1 : middle < -radius ? -1 : 0;
}

/// Plans one region; blocks are appended to `blocks`.
class Planner {
  public:
    Planner(const Mesh& mesh, WarpScheme scheme, double tol, const ResidualTables* tables, Blocks& blocks)
        : m_mesh(mesh), m_scheme(scheme), m_tables(tables), m_writer(tol, blocks) {}

    /// Point by point, in whichever cells.
    void exact(const Box& box) {
        BlockWriter::for_blocks(box, [&](const Box& b) { m_writer.exact(b, exact_bound(b)); });
    }

    void region(const Box& box) {
        if (has_small_cells(m_mesh, box)) return exact(box);
        each_cell_of(m_mesh, box,
                     [&](const MeshCell& cell, const Box& part) { settle(CellForm(m_mesh, cell), part); });
    }

  private:
    double exact_bound(const Box& box) const {
        // A hair more: points on an edge may be evaluated in the neighbour.
        constexpr double kHair = 1e-9;
        const Bounds all{box.x0 + 0.5 - kHair, box.y0 + 0.5 - kHair, box.x1 - 0.5 + kHair,
                         box.y1 - 0.5 + kHair};
        if (!m_mesh.has_levels() && has_small_cells(m_mesh, box)) return exact_rounding(m_mesh, all);
        double bound = 0;
        m_mesh.each_cell(all.x0, all.y0, all.x1, all.y1, [&](const MeshCell& cell) {
            bound = std::max(bound, exact_rounding(m_mesh, cell, m_mesh.patch(cell)));
        });
        return bound;
    }

    void settle(const CellForm& form, const Box& box) {
        switch (m_scheme) {
            case WarpScheme::automatic:
            case WarpScheme::hermite:
                return BlockWriter::for_blocks(box, [&](const Box& b) { place(form, b); });
            case WarpScheme::residual:
                return place_residual(form, box);
            case WarpScheme::exact:
                return exact(box);
        }
    }

    /// One block, a quadratic where that will do, or its halves.
    void place(const CellForm& form, const Box& box) {
        if (BlockWriter::below_floor(box)) return exact(box);
        const Bicubic f = form.on(box);
        const EconomizedBicubic x(f.x), y(f.y);
        if (m_scheme == WarpScheme::automatic &&
            m_writer.polynomial(box, x.c, y.c, std::hypot(x.dropped, y.dropped) + form.rounding))
            return;
        if (m_writer.bicubic(box, f.x, f.y, x.c, y.c, form.rounding)) return;
        m_writer.halve(box, box.width() >= box.height(), [&](const Box& b) { place(form, b); });
    }

    void place_residual(const CellForm& form, const Box& box) {
        const ResidualPatch residual(form.patch);
        BlockWriter::for_blocks(box, [&](const Box& b) {
            const double error =
                m_tables->bound(residual) + residual.float_rounding(form.on(b)) + form.rounding;
            const Point<double> middle = form.mesh.at(form.patch, 0.5 * (b.x0 + b.x1), 0.5 * (b.y0 + b.y1));
            if (!m_writer.computed(b, middle, error)) exact(b);
        });
    }

    const Mesh& m_mesh;
    WarpScheme m_scheme;
    const ResidualTables* m_tables;
    BlockWriter m_writer;
};

}  // namespace

std::int64_t WarpPlan::folded_pixels(const Box& box) const {
    std::int64_t count = 0;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) count += folds(x + 0.5, y + 0.5) != 0;
    return count;
}

MeshPlan::MeshPlan(Mesh mesh, WarpScheme scheme, double tol)
    : WarpPlan(mesh.from().width, mesh.from().height, {Box{0, 0, mesh.from().width, mesh.from().height}}),
      m_mesh(std::move(mesh)),
      m_scheme(scheme),
      m_tol(tol) {
    check_tol(tol);
    if (scheme == WarpScheme::residual && tol > 0) m_tables = ResidualTables::shared();
}

void MeshPlan::plan(const Box& box, int, Blocks& blocks) const {
    Planner planner(m_mesh, m_scheme, m_tol, m_tables.get(), blocks);
    if (m_tol == 0)
        planner.exact(box);
    else
        planner.region(box);
}

bool MeshPlan::exact(double x, double y, int, Point<double>& source_point, int& source_piece) const noexcept {
    source_point = m_mesh.at(x, y);
    source_piece = 0;
    return std::fabs(source_point.x) < kFarthest && std::fabs(source_point.y) < kFarthest;
}

Jacobian MeshPlan::jacobian(double x, double y, int) const noexcept {
    using J = Jet1<double>;
    const Point<J> p =
        m_mesh.at(m_mesh.patch(m_mesh.cell_at(x, y)), J::variable(x, 1, 0), J::variable(y, 0, 1));
    return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
}

float MeshPlan::folds(double x, double y) const noexcept {
    const Jacobian j = jacobian(x, y, 0);
    return (j.x_i * j.y_j - j.x_j * j.y_i) * m_mesh.orientation() < 0 ? 1.0f : 0.0f;
}

BlockPolynomial MeshPlan::bicubic(const Block& block) const noexcept {
    const CellForm form(m_mesh, m_mesh.leaf_at(block.box.x0 + 0.5, block.box.y0 + 0.5));
    return float_form(form.on(block.box), block);
}

/// A row of a block of the residual scheme.
void MeshPlan::computed_row(const Block& block, int row, int begin, int end, float* x,
                            float* y) const noexcept {
    const Box& b = block.box;
    const CellForm form(m_mesh, m_mesh.leaf_at(b.x0 + 0.5, b.y0 + 0.5));
    const double step = 1 / (form.cell.x1 - form.cell.x0);
    const double first = (b.x0 + 0.5 - form.cell.x0) * step;
    const double at_t = (b.y0 + row + 0.5 - form.cell.y0) / (form.cell.y1 - form.cell.y0);
    const double px = (b.x0 + 0.5) * m_mesh.scale().x - block.base_x,
                 py = (b.y0 + row + 0.5) * m_mesh.scale().y - block.base_y;
    m_tables->row(ResidualPatch(form.patch), {px, py, m_mesh.scale().x}, first, step, at_t, begin, end, x, y);
}

std::int64_t MeshPlan::folded_pixels(const Box& box) const {
    if (has_small_cells(m_mesh, box)) return WarpPlan::folded_pixels(box);
    std::int64_t folded = 0;
    each_cell_of(m_mesh, box, [&](const MeshCell& cell, const Box& part) {
        const CellForm form(m_mesh, cell);
        const std::function<std::int64_t(const Box&)> count = [&](const Box& b) -> std::int64_t {
            // A derivative sums up to 16 terms, each up to three times a coefficient.
            const double sign = sign_of_determinant(form.on(b), 48 * form.rounding) * m_mesh.orientation();
            if (sign > 0) return 0;
            if (sign < 0) return std::int64_t{b.width()} * b.height();
            if (BlockWriter::below_floor(b)) return WarpPlan::folded_pixels(b);
            Box first = b, second = b;
            if (b.width() > b.height())
                first.x1 = second.x0 = (b.x0 + b.x1) / 2;
            else
                first.y1 = second.y0 = (b.y0 + b.y1) / 2;
            return count(first) + count(second);
        };
        folded += count(part);
    });
    return folded;
}

}  // namespace anamorph
