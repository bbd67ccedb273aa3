// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/formula_displacement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anamorph/number/formula_program.h"
#include "anamorph/number/interval.h"
#include "anamorph/number/jet.h"
#include "anamorph/number/program_rows.h"
#include "anamorph/number/rounded.h"

namespace anamorph {
namespace {

using simd::kProgramRow, simd::ProgramRow;

/// Points that are read together.
struct FormulaRow {
    ProgramRow at;
    int count = 0;
    std::size_t point[kProgramRow];  ///< which of all they are
    bool has_value[kProgramRow];
};

/// The finite ones of at most kProgramRow points.
FormulaRow row_of(std::span<const glm::dvec2> points, std::size_t first) {
    FormulaRow row;
    const std::size_t end = std::min(points.size(), first + kProgramRow);
    for (std::size_t i = first; i < end; ++i) {
        if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y)) continue;
        row.at.x[row.count] = points[i].x;
        row.at.y[row.count] = points[i].y;
        row.point[row.count++] = i;
    }
    // What stands behind the last point is read, and left.
    std::fill(row.at.x + row.count, row.at.x + kProgramRow, row.count > 0 ? row.at.x[0] : 0);
    std::fill(row.at.y + row.count, row.at.y + kProgramRow, row.count > 0 ? row.at.y[0] : 0);
    return row;
}

/// What rounding does over a box.
struct FormulaError {
    double error = 0;  ///< of the component that errs most
    double most = 0;   ///< the largest magnitude of any
    Certainty has_value = Certainty::yes;
};

/// Is there a value at all points of a box, where the domain has these values, computed ones and exact ones?
Certainty has_value(const Rounded<double>& rounded, const Interval& domain) {
    if (domain.lo > 0 || lower_end(rounded) > 0) return Certainty::yes;
    if (domain.hi <= 0 || rounded.range.hi + rounded.error <= 0) return Certainty::no;
    return Certainty::open;
}

/// How far computed values are from exact ones, both of which lie in the range.
double error_of(const Rounded<double>& rounded, const Interval& range, Certainty has_value) {
    // One of the two may be left out, which is 0.
    const bool is_open = has_value == Certainty::open;
    const Interval held = is_open ? hull(range, Interval(0)) : range;
    const double width = (held.hi - held.lo) * (1 + 1e-15);
    // Of the two, the one that is less; NaN is none.
    const double error = is_open ? width : std::fmin(rounded.error, width);
    return error >= 0 ? error : HUGE_VAL;
}

FormulaError error_over(const SpaceFormula& formula, const Interval& u, const Interval& v) {
    using R = Rounded<double>;
    FormulaError all;
    const R rounded_u(u, 0, 0), rounded_v(v, 0, 0);
    if (!formula.is_everywhere)
        all.has_value = has_value(read_program<1>(formula.domain, rounded_u, rounded_v)[0],
                                  read_program<1, DefinedInterval>(formula.domain, u, v)[0]);
    if (all.has_value == Certainty::no) return all;
    const std::array<R, 3> rounded = read_program<3>(formula.point, rounded_u, rounded_v);
    const std::array<DefinedInterval, 3> ranges = read_program<3, DefinedInterval>(formula.point, u, v);
    for (std::size_t c = 0; c < 3; ++c) {
        all.error = std::max(all.error, error_of(rounded[c], ranges[c], all.has_value));
        all.most = std::max(all.most, magnitude(ranges[c]));
    }
    return all;
}

FormulaError error_over(const SpaceFormula& formula, const FormulaRow& row, int begin, int end) {
    const auto [u0, u1] = std::minmax_element(row.at.x + begin, row.at.x + end);
    const auto [v0, v1] = std::minmax_element(row.at.y + begin, row.at.y + end);
    return error_over(formula, Interval(*u0, *u1), Interval(*v0, *v1));
}

/// What rounding does at the points of a row.
double row_error(const SpaceFormula& formula, const FormulaRow& row, int begin, int end) {
    const FormulaError all = error_over(formula, row, begin, end);
    const int middle = begin + (end - begin) / 2;
    // What has a value that double does not hold is left out, and no error.
    if (end - begin == 1) return all.has_value == Certainty::yes && !row.has_value[middle] ? 0 : all.error;
    constexpr double kSmall = 0x1p-44, kFew = 4;
    const auto is_close = [&] {
        return all.error <= kSmall * all.most ||
               all.error <= kFew * error_over(formula, row, middle, middle + 1).error;
    };
    if (std::isfinite(all.error) && is_close()) return all.error;
    return std::max(row_error(formula, row, begin, middle), row_error(formula, row, middle, end));
}

}  // namespace

FormulaDisplacement::Part FormulaDisplacement::compute(std::span<const glm::dvec2> points, std::size_t first,
                                                       double* values) const {
    FormulaRow row = row_of(points, first);
    ProgramRow moved, domain;
    simd::read_program_row(m_formula.point, row.at, row.count, moved);
    if (!m_formula.is_everywhere) simd::read_program_row(m_formula.domain, row.at, row.count, domain);
    Part part;
    for (int i = 0; i < row.count; ++i) {
        const double value[3] = {moved.x[i], moved.y[i], moved.z[i]};
        const bool is_finite = std::isfinite(value[0]) && std::isfinite(value[1]) && std::isfinite(value[2]);
        row.has_value[i] = is_finite && (m_formula.is_everywhere || domain.x[i] > 0);
        if (!row.has_value[i]) {
            ++part.undefined;
            continue;
        }
        std::copy_n(value, 3, values + 3 * row.point[i]);
        for (const double component : value) part.most = std::max(part.most, std::fabs(component));
    }
    if (row.count > 0) part.error_bound = row_error(m_formula, row, 0, row.count);
    return part;
}

FormulaOffsets FormulaDisplacement::offsets(std::span<const glm::dvec2> points,
                                            const ParallelFor& parallel_for) const {
    FormulaOffsets offsets;
    offsets.values.resize(3 * points.size());
    std::vector<Part> parts((points.size() + kProgramRow - 1) / kProgramRow);
    parallel_for(static_cast<std::int64_t>(parts.size()), [&](std::int64_t i) {
        const auto part = static_cast<std::size_t>(i);
        parts[part] = compute(points, part * kProgramRow, offsets.values.data());
    });
    for (const Part& part : parts) {
        offsets.error_bound = std::max(offsets.error_bound, part.error_bound);
        offsets.most = std::max(offsets.most, part.most);
        offsets.undefined += part.undefined;
    }
    return offsets;
}

DisplacementJet FormulaDisplacement::jet(glm::dvec2 point) const {
    DisplacementJet jet;
    if (!m_formula.is_everywhere && !(read_program<1>(m_formula.domain, point.x, point.y)[0] > 0)) return jet;
    using J = Jet1<double>;
    const std::array<J, 3> read =
        read_program<3>(m_formula.point, J::variable(point.x, 1, 0), J::variable(point.y, 0, 1));
    if (!std::all_of(read.begin(), read.end(), [](const J& j) { return std::isfinite(j.c[0]); })) return jet;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto axis = static_cast<int>(c);
        jet.value[axis] = read[c].c[0];
        if (!std::isfinite(read[c].c[1]) || !std::isfinite(read[c].c[2])) continue;
        jet.by_u[axis] = read[c].c[1];
        jet.by_v[axis] = read[c].c[2];
    }
    return jet;
}

void FormulaDisplacement::add_slopes(std::span<const glm::dvec2> points, const SurfaceSlopes& slopes) const {
    for (int k = 0; k < slopes.count; ++k) {
        const DisplacementJet at = jet(points[static_cast<std::size_t>(slopes.point(k))]);
        for (int c = 0; c < 3; ++c) {
            slopes.by[c][k] += at.by_u[c];
            slopes.by[3 + c][k] += at.by_v[c];
        }
    }
}

}  // namespace anamorph
