// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/stmap_plan.h"

#include <algorithm>
#include <cmath>

#include "anamorph/mesh/sample_rows.h"
#include "anamorph/plan/block_writer.h"

namespace anamorph {
namespace {

/// The lines of the lattice that the centres of `size` pixels make, with the edges of the image.
std::vector<double> lines_of(int size) {
    std::vector<double> lines{0};
    for (int i = 0; i < size; ++i) lines.push_back(i + 0.5);
    lines.push_back(size);
    return lines;
}

}  // namespace

bool StMapPlan::serves(const ControlMesh& mesh, const Size& target) {
    return mesh.samples && mesh.direction == Direction::pull && mesh.levels.empty() &&
           mesh.columns + 1 == target.width && mesh.rows + 1 == target.height && mesh.width == target.width &&
           mesh.height == target.height;
}

StMapPlan::StMapPlan(const ControlMesh& mesh, const Size& target, const Size& source, double amount,
                     WarpScheme scheme, double tol, const std::string& name)
    : WarpPlan(target.width, target.height, {Box{0, 0, target.width, target.height}}),
      m_samples(mesh.samples),
      m_source(source),
      m_scale{static_cast<double>(source.width) / target.width,
              static_cast<double>(source.height) / target.height},
      m_amount(amount),
      m_tol(scheme == WarpScheme::exact && tol > 0 ? 0 : tol),
      m_x(lines_of(target.width)),
      m_y(lines_of(target.height)) {
    check_tol(tol);
    // What is refused is refused by the mesh, which names the vertex.
    const double most = m_samples->most * std::max(source.width, source.height);
    const double moved = (most + std::max(source.width, source.height)) * std::fabs(amount);
    if (!(most <= ControlMesh::kMaxPosition && moved <= 1e3 * ControlMesh::kMaxPosition))
        Mesh(mesh, target, source, amount, name);
}

const float* StMapPlan::sample(int column, int row) const {
    return m_samples->uv.data() + 2 * (std::ptrdiff_t{row} * width() + column);
}

/// Where a pixel comes from; without rounding where `amount` is 1 and v goes down, since u is a float and the
/// source's width has 21 bits.
Point<double> StMapPlan::point(int column, int row) const {
    const Point<double> at =
        m_samples->position(static_cast<std::size_t>(std::int64_t{row} * width() + column));
    const Point<double> there{at.x * m_source.width, at.y * m_source.height};
    if (m_amount == 1) return there;
    const Point<double> here{(column + 0.5) * m_scale.x, (row + 0.5) * m_scale.y};
    return {here.x + (there.x - here.x) * m_amount, here.y + (there.y - here.y) * m_amount};
}

/// The displacement of a vertex of the lattice, of which the outermost go on linearly by half a pixel.
Point<double> StMapPlan::displacement(int column, int row) const {
    const auto beyond = [](const Point<double>& edge, const Point<double>& inner) {
        return edge + (edge - inner) * 0.5;
    };
    if (row == 0) return beyond(displacement(column, 1), displacement(column, 2));
    if (row > height()) return beyond(displacement(column, row - 1), displacement(column, row - 2));
    if (column == 0) return beyond(displacement(1, row), displacement(2, row));
    if (column > width()) return beyond(displacement(column - 1, row), displacement(column - 2, row));
    const Point<double> at = point(column - 1, row - 1);
    return {at.x - (column - 0.5) * m_scale.x, at.y - (row - 0.5) * m_scale.y};
}

bool StMapPlan::exact(double x, double y, int, Point<double>& source_point,
                      int& source_piece) const noexcept {
    const LatticeWeights across(m_x, x), down(m_y, y);
    const bool inside = x > 0 && x < width() && y > 0 && y < height();
    if (inside && across.on_line() && down.on_line()) {
        source_point = point(across.line() - 1, down.line() - 1);
    } else {
        const auto at = [this](int column, int row) { return displacement(column, row); };
        const Point<double> d = lattice_displacement(at, across, down);
        source_point = {x * m_scale.x + d.x, y * m_scale.y + d.y};
    }
    source_piece = 0;
    return std::fabs(source_point.x) < kFarthest && std::fabs(source_point.y) < kFarthest;
}

void StMapPlan::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    for (int row = begin; row < end; ++row)
        for (int i = 0; i < block.box.width(); ++i) {
            const Point<double> at = point(block.box.x0 + i, block.box.y0 + row);
            const std::ptrdiff_t k = (row - begin) * to.stride + i;
            to.x[k] = at.x;
            to.y[k] = at.y;
            to.piece[k] = std::fabs(at.x) < kFarthest && std::fabs(at.y) < kFarthest ? 0 : -1;
        }
}

/// The rounding of a pixel's point in double, computed in either way: products and sums of its place and its
/// sample's, 8 u of them at most.
///
/// In units of u (1 + |amount|) `place`, of a row: four operations for the pixel's place in the source, 4; the base off
/// it, 2; two for the sample, 2. Their sum is an offset within the block, which the slack in plan() covers. Where v goes
/// up, `most` is at least 1, and what has the source's size alone is at most half of `place`: 2 for the pixel's place,
/// 1.5 for the base, .5 for the height and 1 for its sum, 2 for the sample.
double StMapPlan::rounding() const {
    if (m_amount == 1 && !m_samples->v_up) return 0;
    const double place = std::max(m_source.width, m_source.height) * (1 + m_samples->most);
    return 1.4143 * 8 * 0x1p-53 * (1 + std::fabs(m_amount)) * place;
}

void StMapPlan::plan(const Box& box, int, Blocks& blocks) const {
    BlockWriter writer(m_tol, blocks);
    const double in_double = rounding();
    BlockWriter::for_blocks(box, [&](const Box& b) {
        simd::SampleRange range;
        for (int y = b.y0; m_tol > 0 && y < b.y1; ++y) simd::extend_range(sample(b.x0, y), b.width(), range);
        // The middle of a range of places and half of it, the identity's part of them included.
        const auto span = [&](int k, double size, double from, double to) {
            const double middle = 0.5 * (double{range.high[k]} + double{range.low[k]});
            const double there = (k == 1 && m_samples->v_up ? 1 - middle : middle) * size,
                         half_there = 0.5 * (double{range.high[k]} - double{range.low[k]}) * size;
            return Point<double>{
                there * m_amount + 0.5 * (from + to) * (1 - m_amount),
                half_there * std::fabs(m_amount) + 0.5 * (to - from) * std::fabs(1 - m_amount)};
        };
        const Point<double> x = span(0, m_source.width, b.x0 * m_scale.x, b.x1 * m_scale.x),
                            y = span(1, m_source.height, b.y0 * m_scale.y, b.y1 * m_scale.y);
        // The offset from the base, which is rounded down, is rounded to float, and twice more where it is read.
        const double offsets = std::hypot(x.y + 1, y.y + 1) * (3.03 * 0x1p-24);
        const bool has_holes = !(range.most() < HUGE_VAL);
        if (!(m_tol > 0 && !has_holes && writer.computed(b, {x.x, y.x}, offsets + in_double)))
            writer.exact(b, in_double);
    });
}

void StMapPlan::computed_row(const Block& block, int row, int begin, int end, float* x,
                             float* y) const noexcept {
    const int column = block.box.x0 + begin, line = block.box.y0 + row;
    const double rest = 1 - m_amount;
    const simd::SampleAxis across{m_source.width * m_amount, (column + 0.5) * m_scale.x * rest - block.base_x,
                                  m_scale.x * rest},
        down{m_source.height * m_amount * (m_samples->v_up ? -1 : 1),
             (line + 0.5) * m_scale.y * rest - block.base_y +
                 (m_samples->v_up ? m_source.height * m_amount : 0),
             0};
    simd::sample_places(sample(column, line), end - begin, across, down, x, y);
}

Jacobian StMapPlan::jacobian(const LatticeWeights& across, const LatticeWeights& down) const {
    const auto at = [this](int column, int row) { return displacement(column, row); };
    return lattice_jacobian(at, m_scale, across, down);
}

Jacobian StMapPlan::jacobian(double x, double y, int) const noexcept {
    const Jacobian j = jacobian({m_x, x}, {m_y, y});
    if (m_samples->holes == 0 || std::isfinite(j.x_i + j.y_i + j.x_j + j.y_j)) return j;
    const auto pixel = [](double at, int size) {
        return static_cast<int>(std::clamp(std::floor(at), 0.0, size - 1.0));
    };
    return jacobian_by_neighbors(pixel(x, width()), pixel(y, height()));
}

/// Of a pixel near a hole: the steps to and from the pixels beside it, of those that are none.
Jacobian StMapPlan::jacobian_by_neighbors(int column, int row) const {
    const auto at = [&](int x, int y) {
        const bool inside = x >= 0 && y >= 0 && x < width() && y < height();
        return inside ? point(x, y) : Point<double>{NAN, NAN};
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

/// +1, or -1 where most cells between samples are flipped.
double StMapPlan::orientation() const {
    std::call_once(m_turned, [this] {
        std::int64_t flipped = 0;
        for (int row = 0; row + 1 < height(); ++row)
            for (int column = 0; column + 1 < width(); ++column) {
                // Twice the area of a quadrilateral is the product of its diagonals.
                const Point<double> p = point(column + 1, row + 1) - point(column, row),
                                    q = point(column, row + 1) - point(column + 1, row);
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
    for (int x = box.x0; x < box.x1; ++x) across.emplace_back(m_x, x + 0.5);
    std::int64_t folded = 0;
    for (int y = box.y0; y < box.y1; ++y) {
        const LatticeWeights down(m_y, y + 0.5);
        for (const LatticeWeights& at : across) {
            const Jacobian j = jacobian(at, down);
            folded += (j.x_i * j.y_j - j.x_j * j.y_i) * orientation() < 0;
        }
    }
    return folded;
}

}  // namespace anamorph
