// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/st_lattice.h"

#include <algorithm>
#include <cmath>

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

StLattice::StLattice(std::shared_ptr<const StSamples> samples, const Size& target, const Size& source,
                     double amount)
    : m_samples(std::move(samples)),
      m_target(target),
      m_source(source),
      m_scale{static_cast<double>(source.width) / target.width,
              static_cast<double>(source.height) / target.height},
      m_amount(amount),
      m_x(lines_of(target.width)),
      m_y(lines_of(target.height)) {}

const float* StLattice::sample(int column, int row) const {
    return m_samples->uv.data() + 2 * (std::ptrdiff_t{row} * m_target.width + column);
}

Point<double> StLattice::point(int column, int row) const {
    const Point<double> at =
        m_samples->position(static_cast<std::size_t>(std::int64_t{row} * m_target.width + column));
    const Point<double> there{at.x * m_source.width, at.y * m_source.height};
    if (m_amount == 1) return there;
    const Point<double> here{(column + 0.5) * m_scale.x, (row + 0.5) * m_scale.y};
    return {here.x + (there.x - here.x) * m_amount, here.y + (there.y - here.y) * m_amount};
}

void StLattice::points(int column, int row, int count, double* x, double* y) const {
    const float* const from = sample(column, row);
    const double width = m_source.width, height = m_source.height;
    // Exactly v, or 1 - v.
    const double first = m_samples->v_up ? 1 : 0, sign = m_samples->v_up ? -1 : 1;
    for (int i = 0; i < count; ++i) {
        x[i] = double{from[2 * i]} * width;
        y[i] = (first + sign * double{from[2 * i + 1]}) * height;
    }
    if (m_amount == 1) return;
    const double below = (row + 0.5) * m_scale.y;
    for (int i = 0; i < count; ++i) {
        const double across = (column + i + 0.5) * m_scale.x;
        x[i] = across + (x[i] - across) * m_amount;
        y[i] = below + (y[i] - below) * m_amount;
    }
}

/// The displacement of a vertex of the lattice, of which the outermost go on linearly by half a pixel.
Point<double> StLattice::displacement(int column, int row) const {
    const auto beyond = [](const Point<double>& edge, const Point<double>& inner) {
        return edge + (edge - inner) * 0.5;
    };
    if (row == 0) return beyond(displacement(column, 1), displacement(column, 2));
    if (row > m_target.height) return beyond(displacement(column, row - 1), displacement(column, row - 2));
    if (column == 0) return beyond(displacement(1, row), displacement(2, row));
    if (column > m_target.width) return beyond(displacement(column - 1, row), displacement(column - 2, row));
    const Point<double> at = point(column - 1, row - 1);
    return {at.x - (column - 0.5) * m_scale.x, at.y - (row - 0.5) * m_scale.y};
}

/// Products and sums of the pixel's place and its sample's, 8 u of them at most.
///
/// In units of u (1 + |amount|) `place`, of a row: four operations for the pixel's place in the source, 4; the base off
/// it, 2; two for the sample, 2. Their sum is an offset within the block, which the slack in StMapPlan::plan() covers. Where v goes
/// up, `most` is at least 1, and what has the source's size alone is at most half of `place`: 2 for the pixel's place,
/// 1.5 for the base, .5 for the height and 1 for its sum, 2 for the sample.
double StLattice::rounding() const {
    if (m_amount == 1 && !m_samples->v_up) return 0;
    const double place = std::max(m_source.width, m_source.height) * (1 + m_samples->most);
    return 1.4143 * 8 * 0x1p-53 * (1 + std::fabs(m_amount)) * place;
}

Point<double> StLattice::at(double x, double y) const {
    const LatticeWeights along = across(x), below = down(y);
    const bool inside = x > 0 && x < m_target.width && y > 0 && y < m_target.height;
    if (inside && along.on_line() && below.on_line()) return point(along.line() - 1, below.line() - 1);
    const auto vertex = [this](int column, int row) { return displacement(column, row); };
    const Point<double> d = lattice_displacement(vertex, along, below);
    return {x * m_scale.x + d.x, y * m_scale.y + d.y};
}

Jacobian StLattice::jacobian(const LatticeWeights& across, const LatticeWeights& down) const {
    const auto at = [this](int column, int row) { return displacement(column, row); };
    return lattice_jacobian(at, m_scale, across, down);
}

}  // namespace anamorph
