// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_plan.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "anamorph/mesh/cell_map.h"
#include "anamorph/mesh/cells.h"
#include "anamorph/mesh/folds.h"
#include "anamorph/mesh/hermite.h"
#include "anamorph/mesh/mesh_lattice.h"
#include "anamorph/mesh/mesh_residual.h"
#include "anamorph/mesh/mesh_windows.h"
#include "anamorph/mesh/window_map.h"
#include "anamorph/number/hypot.h"
#include "anamorph/plan/block_writer.h"
#include "anamorph/plan/map_link.h"

namespace anamorph {
namespace {

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

/// Have cells so few pixels in a box that blocks are better off without them?
bool has_small_cells(const Mesh& mesh, const Box& box) {
    const auto cells_between = [](const std::vector<double>& lines, double from, double to) {
        return 1.0 + Mesh::line_below(lines, to) - Mesh::line_below(lines, from);
    };
    double cells = 0;
    if (mesh.has_levels())
        mesh.each_cell(box.x0 + 0.5, box.y0 + 0.5, box.x1 - 0.5, box.y1 - 0.5,
                       [&](const MeshCell&) { ++cells; });
    else
        cells = cells_between(mesh.x_lines(), box.x0 + 0.5, box.x1 - 0.5) *
                cells_between(mesh.y_lines(), box.y0 + 0.5, box.y1 - 0.5);
    return double(box.width()) * box.height() < BlockWriter::kFloorPixels * cells;
}

/// Plans one region; blocks are appended to `blocks`.
class CellSubdivider {
  public:
    CellSubdivider(const Mesh& mesh, bool lattice, WarpScheme scheme, double tol,
                   const ResidualTables* tables, Blocks& blocks)
        : m_mesh(mesh),
          m_lattice(lattice),
          m_scheme(scheme),
          m_tol(tol),
          m_tables(tables),
          m_writer(tol, blocks) {}

    /// Point by point, in whichever cells.
    void exact(const Box& box) {
        BlockWriter::for_blocks(box, [&](const Box& b) { m_writer.exact(b, exact_bound(b)); });
    }

    /// Point by point too, of a mesh that is a lattice, but in offsets that are floats.
    void lattice(const Box& box) {
        BlockWriter::for_blocks(box, [&](const Box& b) { place_lattice(b); });
    }

    void region(const Box& box) {
        if (has_small_cells(m_mesh, box)) return exact(box);
        each_cell_of(m_mesh, box,
                     [&](const MeshCell& cell, const Box& part) { settle(CellForm(m_mesh, cell), part); });
    }

  private:
    double exact_bound(const Box& box) const {
        const Bounds all = with_neighbors({box.x0 + 0.5, box.y0 + 0.5, box.x1 - 0.5, box.y1 - 0.5});
        if (m_lattice || (!m_mesh.has_levels() && has_small_cells(m_mesh, box))) {
            const double rough = exact_rounding(m_mesh, all);
            if (m_lattice || m_tol == 0 || rough <= m_tol) return rough;
        }
        return exact_rounding_by_cells(m_mesh, all);
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
            m_writer.polynomial(box, x.c, y.c, hypot(x.dropped, y.dropped) + form.rounding))
            return;
        if (m_writer.bicubic(box, f.x, f.y, x.c, y.c, form.rounding)) return;
        m_writer.halve(box, box.width() >= box.height(), [&](const Box& b) { place(form, b); });
    }

    /// The displacement is a sum whose weights sum to 1 and their magnitudes to at most 1.6^2 (mesh_lattice.h):
    /// no farther from the middle of those of the vertices than 1.28 times their range. The offset from the
    /// base is rounded to float, and twice more where it is read.
    void place_lattice(const Box& b) {
        const Bounds all{b.x0 + 0.5, b.y0 + 0.5, b.x1 - 0.5, b.y1 - 0.5};
        const Mesh::Rough rough = m_mesh.rough(all.x0, all.y0, all.x1, all.y1);
        const Point<double>& scale = m_mesh.scale();
        const Point<double> middle{0.5 * (b.x0 + b.x1) * scale.x + 0.5 * (rough.low.x + rough.high.x),
                                   0.5 * (b.y0 + b.y1) * scale.y + 0.5 * (rough.low.y + rough.high.y)};
        const double x = 0.5 * b.width() * scale.x + 1.29 * (rough.high.x - rough.low.x) + 1,
                     y = 0.5 * b.height() * scale.y + 1.29 * (rough.high.y - rough.low.y) + 1;
        const double rounding = with_rounding(m_mesh, rough, all, kExactTerms);
        if (!m_writer.computed(b, middle, hypot(x, y) * (3.03 * 0x1p-24) + rounding))
            m_writer.exact(b, rounding);
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
    bool m_lattice;
    WarpScheme m_scheme;
    double m_tol;
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
    m_lattice = is_lattice(m_mesh) && has_small_cells(m_mesh, {0, 0, width(), height()});
}

void MeshPlan::plan(const Box& box, int, Blocks& blocks) const {
    CellSubdivider subdivider(m_mesh, m_lattice, m_scheme, m_tol, m_tables.get(), blocks);
    if (m_tol == 0)
        subdivider.exact(box);
    else if (m_lattice && m_scheme != WarpScheme::exact)
        subdivider.lattice(box);
    else
        subdivider.region(box);
}

bool MeshPlan::exact(double x, double y, int, Point<double>& source_point, int& source_piece) const noexcept {
    source_point = m_lattice ? lattice_point(m_mesh, {m_mesh.x_lines(), x}, {m_mesh.y_lines(), y}, x, y)
                             : m_mesh.at(x, y);
    source_piece = 0;
    return std::fabs(source_point.x) < kFarthest && std::fabs(source_point.y) < kFarthest;
}

Jacobian MeshPlan::jacobian(double x, double y, int) const noexcept {
    if (m_lattice) return lattice_jacobian(m_mesh, {m_mesh.x_lines(), x}, {m_mesh.y_lines(), y});
    using J = Jet1<double>;
    const Point<J> p =
        m_mesh.at(m_mesh.patch(m_mesh.cell_at(x, y)), J::variable(x, 1, 0), J::variable(y, 0, 1));
    return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
}

PlanOptions link_options(WarpScheme scheme, double tol) {
    PlanOptions options;
    options.scheme = scheme == WarpScheme::exact ? Scheme::exact : Scheme::automatic;
    options.tol = tol;
    options.cull = false;
    return options;
}

std::shared_ptr<const MapLink> window_link(std::shared_ptr<const WindowSource> source, WarpScheme scheme,
                                           double tol) {
    // Of a picture that has so few pixels each is computed by itself, where windows do not serve: of it as a whole that takes no time.
    constexpr int kFewPixels = 64 * 64;
    const Size size = source->target_size();
    const bool is_small = std::int64_t{size.width} * size.height <= kFewPixels;
    const WindowMap map(std::move(source), tol);
    if (scheme != WarpScheme::exact && !is_small && !map.is_smooth()) return nullptr;
    return std::make_shared<const LinkOf<WindowMap>>(map, link_options(scheme, tol));
}

std::shared_ptr<const MapLink> MeshPlan::link() const {
    if (!joins(m_scheme)) return nullptr;
    const auto mesh = std::make_shared<const Mesh>(m_mesh);
    // Cells that are one to a block are formulas, unless larger parts of the map are smooth.
    constexpr int kLarge = 64;
    const bool has_large_cells = !m_lattice && CellMap::serves(m_mesh);
    if (has_large_cells &&
        !(m_tol > 0 && WindowMap(std::make_shared<const MeshWindows>(mesh), m_tol).is_smooth(kLarge)))
        return std::make_shared<const LinkOf<CellMap>>(CellMap(mesh), link_options(m_scheme, m_tol));
    return window_link(std::make_shared<const MeshWindows>(mesh), m_scheme, m_tol);
}

std::string MeshPlan::why_unlinked() const {
    return joins(m_scheme) ? "has a mesh of small cells that differ" : BlockMap::why_unlinked();
}

float MeshPlan::folds(double x, double y) const noexcept {
    return folds(jacobian(x, y, 0)) ? 1.0f : 0.0f;
}

bool MeshPlan::folds(const Jacobian& j) const noexcept {
    return (j.x_i * j.y_j - j.x_j * j.y_i) * m_mesh.orientation() < 0;
}

BlockPolynomial MeshPlan::bicubic(const Block& block) const noexcept {
    const CellForm form(m_mesh, m_mesh.leaf_at(block.box.x0 + 0.5, block.box.y0 + 0.5));
    return float_form(form.on(block.box), block);
}

void MeshPlan::computed(std::span<const Block> layers, const PointRows* to) const noexcept {
    if (!m_lattice) return WarpPlan::computed(layers, to);
    const Block& block = layers.front();
    lattice_rows(block, block.box, *to);
}

/// The points of a part of a block of a lattice.
void MeshPlan::lattice_rows(const Block& block, const Box& part, const PointRows& to) const noexcept {
    std::array<LatticeWeights, Block::kMaxSide> across;
    bool on_lines = true;
    for (int i = 0; i < part.width(); ++i) {
        LatticeWeights& weights = across[static_cast<std::size_t>(i)];
        weights = {m_mesh.x_lines(), part.x0 + i + 0.5};
        on_lines &= weights.on_line();
    }
    for (int j = 0; j < part.height(); ++j) {
        const double at_y = part.y0 + j + 0.5;
        const LatticeWeights down(m_mesh.y_lines(), at_y);
        float *x = to.x + j * to.stride, *y = to.y + j * to.stride;
        // What lattice_point says where every pixel of the row is a vertex.
        if (const Point<double>* d = m_mesh.displacements(down.line()); on_lines && down.on_line()) {
            for (int i = 0; i < part.width(); ++i) {
                const Point<double>& at = d[across[static_cast<std::size_t>(i)].line()];
                x[i] = static_cast<float>((part.x0 + i + 0.5) * m_mesh.scale().x + at.x - block.base_x);
                y[i] = static_cast<float>(at_y * m_mesh.scale().y + at.y - block.base_y);
            }
            continue;
        }
        for (int i = 0; i < part.width(); ++i) {
            const Point<double> p =
                lattice_point(m_mesh, across[static_cast<std::size_t>(i)], down, part.x0 + i + 0.5, at_y);
            x[i] = static_cast<float>(p.x - block.base_x);
            y[i] = static_cast<float>(p.y - block.base_y);
        }
    }
}

/// A row of a block of the residual scheme, or of a lattice.
void MeshPlan::computed_row(const Block& block, int row, int begin, int end, float* x,
                            float* y) const noexcept {
    const Box& b = block.box;
    if (m_lattice)
        return lattice_rows(block, {b.x0 + begin, b.y0 + row, b.x0 + end, b.y0 + row + 1}, {x, y, 0});
    const CellForm form(m_mesh, m_mesh.leaf_at(b.x0 + 0.5, b.y0 + 0.5));
    const double step = 1 / (form.cell.x1 - form.cell.x0);
    const double first = (b.x0 + 0.5 - form.cell.x0) * step;
    const double at_t = (b.y0 + row + 0.5 - form.cell.y0) / (form.cell.y1 - form.cell.y0);
    const double px = (b.x0 + 0.5) * m_mesh.scale().x - block.base_x,
                 py = (b.y0 + row + 0.5) * m_mesh.scale().y - block.base_y;
    m_tables->row(ResidualPatch(form.patch), {px, py, m_mesh.scale().x}, first, step, at_t, begin, end, x, y);
}

std::int64_t MeshPlan::folded_pixels_of_lattice(const Box& box) const {
    std::vector<LatticeWeights> across;
    for (int x = box.x0; x < box.x1; ++x) across.emplace_back(m_mesh.x_lines(), x + 0.5);
    std::int64_t folded = 0;
    for (int y = box.y0; y < box.y1; ++y) {
        const LatticeWeights down(m_mesh.y_lines(), y + 0.5);
        for (const LatticeWeights& at : across) folded += folds(lattice_jacobian(m_mesh, at, down));
    }
    return folded;
}

std::int64_t MeshPlan::folded_pixels(const Box& box) const {
    if (m_lattice) return folded_pixels_of_lattice(box);
    if (has_small_cells(m_mesh, box)) return WarpPlan::folded_pixels(box);
    const int orientation = m_mesh.orientation() < 0 ? -1 : 1;
    std::int64_t folded = 0;
    each_cell_of(m_mesh, box, [&](const MeshCell& cell, const Box& part) {
        const CellForm form(m_mesh, cell);
        // A derivative sums up to 16 terms, each up to three times a coefficient.
        const auto sign = [&](const Box& b) {
            return sign_of_determinant(form.on(b), 48 * form.rounding) * orientation;
        };
        folded += count_folded(part, sign, [&](const Box& b) { return WarpPlan::folded_pixels(b); });
    });
    return folded;
}

}  // namespace anamorph
