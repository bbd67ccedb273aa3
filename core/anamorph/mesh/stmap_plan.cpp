// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/stmap_plan.h"

#include <algorithm>
#include <cmath>

#include "anamorph/mesh/sample_rows.h"
#include "anamorph/mesh/st_windows.h"
#include "anamorph/number/hypot.h"
#include "anamorph/plan/block_writer.h"
#include "anamorph/plan/map_link.h"

namespace anamorph {
bool StMapPlan::serves(const ControlMesh& mesh, const Size& target) {
    return mesh.samples && mesh.direction == Direction::pull && mesh.levels.empty() &&
           mesh.columns + 1 == target.width && mesh.rows + 1 == target.height && mesh.width == target.width &&
           mesh.height == target.height;
}

StMapPlan::StMapPlan(const ControlMesh& mesh, const Size& target, const Size& source, double amount,
                     WarpScheme scheme, double tol, const std::string& name)
    : WarpPlan(target.width, target.height, {Box{0, 0, target.width, target.height}}),
      m_lattice(std::make_shared<const StLattice>(mesh.samples, target, source, amount)),
      m_scheme(scheme),
      m_given_tol(tol),
      m_tol(scheme == WarpScheme::exact && tol > 0 ? 0 : tol) {
    check_tol(tol);
    // What is refused is refused by the mesh, which names the vertex.
    const double most = mesh.samples->most * std::max(source.width, source.height);
    const double moved = (most + std::max(source.width, source.height)) * std::fabs(amount);
    if (!(most <= ControlMesh::kMaxPosition && moved <= 1e3 * ControlMesh::kMaxPosition))
        Mesh(mesh, target, source, amount, name);
}

bool StMapPlan::exact(double x, double y, int, Point<double>& source_point,
                      int& source_piece) const noexcept {
    source_point = m_lattice->at(x, y);
    source_piece = 0;
    return std::fabs(source_point.x) < kFarthest && std::fabs(source_point.y) < kFarthest;
}

void StMapPlan::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    for (int row = begin; row < end; ++row)
        for (int i = 0; i < block.box.width(); ++i) {
            const Point<double> at = m_lattice->point(block.box.x0 + i, block.box.y0 + row);
            const std::ptrdiff_t k = (row - begin) * to.stride + i;
            to.x[k] = at.x;
            to.y[k] = at.y;
            to.piece[k] = std::fabs(at.x) < kFarthest && std::fabs(at.y) < kFarthest ? 0 : -1;
        }
}

void StMapPlan::plan(const Box& box, int, Blocks& blocks) const {
    BlockWriter writer(m_tol, blocks);
    const double in_double = m_lattice->rounding(), amount = m_lattice->amount();
    const bool v_up = m_lattice->samples().v_up;
    const Size& source = m_lattice->source();
    const Point<double>& scale = m_lattice->scale();
    BlockWriter::for_blocks(box, [&](const Box& b) {
        simd::SampleRange range;
        for (int y = b.y0; m_tol > 0 && y < b.y1; ++y)
            simd::extend_range(m_lattice->sample(b.x0, y), b.width(), range);
        // The middle of a range of places and half of it, the identity's part of them included.
        const auto span = [&](int k, double size, double from, double to) {
            const double middle = 0.5 * (double{range.high[k]} + double{range.low[k]});
            const double there = (k == 1 && v_up ? 1 - middle : middle) * size,
                         half_there = 0.5 * (double{range.high[k]} - double{range.low[k]}) * size;
            return Point<double>{there * amount + 0.5 * (from + to) * (1 - amount),
                                 half_there * std::fabs(amount) + 0.5 * (to - from) * std::fabs(1 - amount)};
        };
        const Point<double> x = span(0, source.width, b.x0 * scale.x, b.x1 * scale.x),
                            y = span(1, source.height, b.y0 * scale.y, b.y1 * scale.y);
        // The offset from the base, which is rounded down, is rounded to float, and twice more where it is read.
        const double offsets = hypot(x.y + 1, y.y + 1) * (3.03 * 0x1p-24);
        const bool has_holes = !(range.most() < HUGE_VAL);
        if (!(m_tol > 0 && !has_holes && writer.computed(b, {x.x, y.x}, offsets + in_double)))
            writer.exact(b, in_double);
    });
}

void StMapPlan::computed_row(const Block& block, int row, int begin, int end, float* x,
                             float* y) const noexcept {
    const int column = block.box.x0 + begin, line = block.box.y0 + row;
    const Size& source = m_lattice->source();
    const Point<double>& scale = m_lattice->scale();
    const double amount = m_lattice->amount(), rest = 1 - amount;
    const bool v_up = m_lattice->samples().v_up;
    const simd::SampleAxis across{source.width * amount, (column + 0.5) * scale.x * rest - block.base_x,
                                  scale.x * rest},
        down{source.height * amount * (v_up ? -1 : 1),
             (line + 0.5) * scale.y * rest - block.base_y + (v_up ? source.height * amount : 0), 0};
    simd::sample_places(m_lattice->sample(column, line), end - begin, across, down, x, y);
}

Jacobian StMapPlan::jacobian(double x, double y, int) const noexcept {
    const Jacobian j = m_lattice->jacobian(m_lattice->across(x), m_lattice->down(y));
    if (m_lattice->samples().holes == 0 || std::isfinite(j.x_i + j.y_i + j.x_j + j.y_j)) return j;
    const auto pixel = [](double at, int size) {
        return static_cast<int>(std::clamp(std::floor(at), 0.0, size - 1.0));
    };
    return jacobian_by_neighbors(pixel(x, width()), pixel(y, height()));
}

/// Of a pixel near a hole: the steps to and from the pixels beside it, of those that are none.
Jacobian StMapPlan::jacobian_by_neighbors(int column, int row) const {
    const auto at = [&](int x, int y) {
        const bool inside = x >= 0 && y >= 0 && x < width() && y < height();
        return inside ? m_lattice->point(x, y) : Point<double>{NAN, NAN};
    };
    const Point<double> here = at(column, row);
    const auto step = [&](const Point<double>& before, const Point<double>& after) {
        if (std::isnan(after.x)) return here - before;
        return std::isnan(before.x) ? after - here : (after - before) * 0.5;
    };
    Point<double> across = step(at(column - 1, row), at(column + 1, row)),
                  down = step(at(column, row - 1), at(column, row + 1));
    // Between two holes: as long as the other, and square to it.
    if (std::isnan(across.x)) across = {down.y, -down.x};
    if (std::isnan(down.x)) down = {-across.y, across.x};
    return {across.x, across.y, down.x, down.y};
}

std::shared_ptr<const MapLink> StMapPlan::link() const {
    return joins(m_scheme) ? window_link(std::make_shared<const StWindows>(m_lattice), m_scheme, m_given_tol)
                           : nullptr;
}

std::string StMapPlan::why_unlinked() const {
    return joins(m_scheme) ? "has an ST-map that is rough or small" : BlockMap::why_unlinked();
}

/// +1, or -1 where most cells between samples are flipped.
double StMapPlan::orientation() const {
    std::call_once(m_turned, [this] {
        std::int64_t flipped = 0;
        for (int row = 0; row + 1 < height(); ++row)
            for (int column = 0; column + 1 < width(); ++column) {
                // Twice the area of a quadrilateral is the product of its diagonals.
                const auto at = [&](int x, int y) { return m_lattice->point(x, y); };
                const Point<double> p = at(column + 1, row + 1) - at(column, row),
                                    q = at(column, row + 1) - at(column + 1, row);
                const double turn = p.x * q.y - p.y * q.x;
                flipped += (turn < 0) - (turn > 0);
            }
        m_orientation = flipped > 0 ? -1 : 1;
    });
    return m_orientation;
}

float StMapPlan::folds(double x, double y) const noexcept {
    const Jacobian j = jacobian(x, y, 0);
    return (j.x_i * j.y_j - j.x_j * j.y_i) * orientation() < 0 ? 1.0f : 0.0f;
}

std::int64_t StMapPlan::folded_pixels(const Box& box) const {
    std::vector<LatticeWeights> across;
    for (int x = box.x0; x < box.x1; ++x) across.push_back(m_lattice->across(x + 0.5));
    std::int64_t folded = 0;
    for (int y = box.y0; y < box.y1; ++y) {
        const LatticeWeights down = m_lattice->down(y + 0.5);
        for (const LatticeWeights& at : across) {
            const Jacobian j = m_lattice->jacobian(at, down);
            folded += (j.x_i * j.y_j - j.x_j * j.y_i) * orientation() < 0;
        }
    }
    return folded;
}

}  // namespace anamorph
