// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/deformed_surface.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>

#include "anamorph/parameter.h"
#include "anamorph/simd/deform.h"

namespace anamorph {
namespace {

constexpr double kMostTotal = 0x1p62;

/// A deformation that is added (sign 1) or taken away (-1).
struct Term {
    const Deformation* deformation;
    int sign;
};

std::vector<Term> terms_of(std::span<const DeformationChange> changes) {
    std::vector<Term> terms;
    for (const DeformationChange& change : changes) {
        if (change.before) terms.push_back({&*change.before, -1});
        if (change.after) terms.push_back({&*change.after, 1});
    }
    return terms;
}

void set_units(const Term& term, double resolution, double (&units)[3]) {
    for (int c = 0; c < 3; ++c) units[c] = term.sign * term.deformation->vector[c] / resolution;
}

/// Indices [begin, end) of values within `reach` extents of a centre. The same arithmetic as that of the
/// factors decides, so what is left out is zero.
std::pair<int, int> reached(std::span<const double> values, double center, double inverse_extent,
                            double reach) {
    int begin = static_cast<int>(values.size()), end = 0;
    for (int i = 0; i < static_cast<int>(values.size()); ++i)
        if (std::fabs((values[static_cast<std::size_t>(i)] - center) * inverse_extent) <= reach) {
            begin = std::min(begin, i);
            end = i + 1;
        }
    return {begin, std::max(begin, end)};
}

int round_down(int value, int step) {
    return value / step * step;
}
int round_up(int value, int step) {
    return (value + step - 1) / step * step;
}

/// One direction of a term over a grid: a table of `values` from `begin` to `end`, whole blocks.
struct Axis {
    int begin = 0, end = 0;
    std::size_t at = 0;  ///< of `begin` in the tables
};

Axis add_axis(std::span<const double> values, double center, double extent, bool gaussian, double reach,
              int block, std::vector<double>& tables) {
    const double inverse = 1 / extent;
    const auto [first, last] = reached(values, center, inverse, reach);
    if (first == last) return {};
    const Axis axis{round_down(first, block), round_up(last, block), tables.size()};
    tables.resize(tables.size() + static_cast<std::size_t>(axis.end - axis.begin), gaussian ? 0.0 : 2.0);
    const int count = std::min(axis.end, static_cast<int>(values.size())) - axis.begin;
    const double* from = values.data() + axis.begin;
    if (gaussian)
        simd::gaussian_factors(from, count, center, inverse, reach, tables.data() + axis.at);
    else
        simd::squared_distances(from, count, center, inverse, tables.data() + axis.at);
    return axis;
}

/// Terms made ready to be drawn on a grid.
struct GridTerms {
    std::vector<simd::GridTerm> terms;
    std::vector<double> tables;
    GridPart part;  ///< that they reach
};

constexpr std::size_t kMostTable = std::size_t{1} << 22;

/// Takes terms from `next` on while the tables do not grow beyond kMostTable.
GridTerms prepare(std::span<const Term> all, std::size_t& next, std::span<const double> u,
                  std::span<const double> v, const DisplacementSum& sum) {
    GridTerms ready;
    std::vector<Axis> columns, rows;
    for (; next < all.size() && ready.tables.size() < kMostTable; ++next) {
        const Deformation& d = *all[next].deformation;
        const bool gaussian = d.kernel == DeformationKernel::gaussian;
        const double reach = sum.reach(d.kernel);
        const Axis column =
            add_axis(u, d.center.x, d.extent.x, gaussian, reach, simd::kGridBlock, ready.tables);
        const Axis row = add_axis(v, d.center.y, d.extent.y, gaussian, reach, simd::kGridRows, ready.tables);
        if (column.begin == column.end || row.begin == row.end) continue;
        simd::GridTerm term{nullptr, nullptr, column.begin, column.end, row.begin, row.end, {}, gaussian};
        set_units(all[next], sum.options().resolution, term.units);
        ready.terms.push_back(term);
        columns.push_back(column);
        rows.push_back(row);
    }
    GridPart part{std::numeric_limits<int>::max(), std::numeric_limits<int>::max(), 0, 0};
    for (std::size_t k = 0; k < ready.terms.size(); ++k) {
        ready.terms[k].column = ready.tables.data() + columns[k].at;
        ready.terms[k].row = ready.tables.data() + rows[k].at;
        part.column_begin = std::min(part.column_begin, columns[k].begin);
        part.row_begin = std::min(part.row_begin, rows[k].begin);
        part.column_end = std::max(part.column_end, std::min(columns[k].end, static_cast<int>(u.size())));
        part.row_end = std::max(part.row_end, std::min(rows[k].end, static_cast<int>(v.size())));
    }
    if (!ready.terms.empty()) ready.part = part;
    return ready;
}

/// Draws terms on bands of rows; without sums nothing is kept.
template <class T>
void draw_terms(const GridTerms& ready, bool all, int columns, int rows, double resolution,
                std::int64_t* sums, const T* base, T* out, const ParallelFor& parallel_for) {
    constexpr int kBandRows = 16;
    static_assert(kBandRows % simd::kGridRows == 0);
    const int first = all ? 0 : round_down(ready.part.row_begin, kBandRows);
    const int end = all ? rows : ready.part.row_end;
    if (first >= end) return;
    parallel_for((end - first + kBandRows - 1) / kBandRows, [&](std::int64_t i) {
        const int begin = first + static_cast<int>(i) * kBandRows;
        const int band_end = std::min(begin + kBandRows, end);
        std::vector<simd::GridTerm> terms;
        for (const simd::GridTerm& t : ready.terms)
            if (t.row_begin < band_end && begin < t.row_end) terms.push_back(t);
        simd::deform_band(
            {terms.data(), terms.size(), begin, band_end, columns, sums, resolution, base, out, all});
    });
}

void check_axis(const char* name, std::span<const double> values) {
    constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max() - 1024;
    if (values.empty() || values.size() > kMost)
        throw Error(name, std::to_string(values.size()) + " values",
                    "allowed are 1 to " + std::to_string(kMost));
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            throw Error(std::string(name) + "[" + std::to_string(i) + "]", shortest(values[i]),
                        "allowed are finite numbers");
}

void check_grid(std::span<const double> u, std::span<const double> v) {
    check_axis("u", u);
    check_axis("v", v);
    constexpr std::size_t kMostPoints = std::size_t{1} << 40;
    if (u.size() > kMostPoints / v.size())
        throw Error("u and v", std::to_string(u.size()) + "x" + std::to_string(v.size()) + " points",
                    "allowed are up to 2^40");
}

void hull(GridPart& part, const GridPart& other) {
    if (other.empty()) return;
    if (part.empty()) {
        part = other;
        return;
    }
    part = {std::min(part.column_begin, other.column_begin), std::min(part.row_begin, other.row_begin),
            std::max(part.column_end, other.column_end), std::max(part.row_end, other.row_end)};
}

}  // namespace

DisplacementSum::DisplacementSum(const DeformOptions& options) : m_options(options) {
    if (!(options.cutoff >= 0 && options.cutoff <= 0.5))
        throw Error("cutoff", shortest(options.cutoff), "allowed are numbers from 0 to 0.5");
    int exponent = 0;
    if (!(options.resolution >= 0x1p-500 && options.resolution <= 0x1p500) ||
        std::frexp(options.resolution, &exponent) != 0.5)
        throw Error("resolution", shortest(options.resolution),
                    "allowed are powers of 2 from 2^-500 to 2^500");
}

double DisplacementSum::reach(DeformationKernel kernel) const {
    if (kernel == DeformationKernel::wendland_c2) return 1;
    return std::sqrt(-std::log(m_options.cutoff)) * (1 + 0x1p-48);
}

void DisplacementSum::add(Totals& totals, const Deformation& d, int sign) const {
    for (int c = 0; c < 3; ++c) {
        const double units = std::ceil(std::fabs(d.vector[c]) / m_options.resolution);
        if (!(units < simd::kMostUnits))
            throw Error("vector", shortest(d.vector[c]),
                        "with resolution=" + shortest(m_options.resolution) +
                            " allowed are magnitudes below " +
                            shortest(simd::kMostUnits * m_options.resolution));
        const auto whole = static_cast<std::int64_t>(units) * sign;
        if (static_cast<double>(totals.units[c]) + static_cast<double>(whole) >= kMostTotal)
            throw Error("vector", shortest(d.vector[c]),
                        "with resolution=" + shortest(m_options.resolution) +
                            " the magnitudes of all vectors together must stay below " +
                            shortest(kMostTotal * m_options.resolution));
        totals.units[c] += whole;
        if (d.kernel == DeformationKernel::gaussian) totals.gaussian[c] += whole;
    }
    totals.count += sign;
}

void DisplacementSum::apply(std::span<const DeformationChange> changes) {
    Totals totals = m_totals;
    for (const DeformationChange& change : changes) {
        for (const auto& end : {change.before, change.after})
            if (end) check_deformation(*end);
        if (change.before) add(totals, *change.before, -1);
        if (change.after) add(totals, *change.after, 1);
    }
    m_totals = totals;
}

double DisplacementSum::error_bound() const {
    double most = 0;
    for (int c = 0; c < 3; ++c)
        most = std::max(most, static_cast<double>(m_totals.gaussian[c]) * m_options.cutoff +
                                  static_cast<double>(m_totals.units[c]) * simd::kKernelError * 0x1p-53);
    return (most + 0.5 * static_cast<double>(m_totals.count)) * m_options.resolution;
}

// --- Grids

DeformedGrid::DeformedGrid(std::vector<double> u, std::vector<double> v, const DeformOptions& options)
    : m_u(std::move(u)), m_v(std::move(v)), m_sum(options) {
    check_grid(m_u, m_v);
}

void DeformedGrid::apply(std::span<const DeformationChange> changes) {
    m_sum.apply(changes);
    m_pending.insert(m_pending.end(), changes.begin(), changes.end());
}

template <class T>
GridPart DeformedGrid::draw(bool all, const T* base, T* out, const ParallelFor& parallel_for,
                            T* displacement) {
    const int columns = static_cast<int>(m_u.size()), rows = static_cast<int>(m_v.size());
    if (m_sums.empty() && (all || !m_pending.empty())) try {
            m_sums.resize(
                static_cast<std::size_t>(simd::grid_sums(round_up(rows, simd::kGridRows), columns)));
        } catch (const std::exception&) {
            throw Error("u and v", std::to_string(columns) + "x" + std::to_string(rows) + " points",
                        "there is no memory for so many");
        }
    const std::vector<Term> terms = terms_of(m_pending);
    GridPart part;
    std::size_t next = 0;
    while (next < terms.size() || (all && next == 0)) {
        const GridTerms ready = prepare(terms, next, m_u, m_v, m_sum);
        const bool write_all = all && next == terms.size();
        draw_terms(ready, write_all, columns, rows, m_sum.options().resolution, m_sums.data(), base, out,
                   parallel_for);
        hull(part, ready.part);
        if (terms.empty()) break;
    }
    m_pending.clear();
    if (displacement && (all || !part.empty())) {
        // The sums stand: rows that were touched are written once more, without a base.
        const int first = all ? 0 : round_down(part.row_begin, simd::kGridRows);
        const int count = (all ? rows : part.row_end) - first;
        constexpr int kRowsAtOnce = 16;
        parallel_for((count + kRowsAtOnce - 1) / kRowsAtOnce, [&](std::int64_t i) {
            const int begin = first + static_cast<int>(i) * kRowsAtOnce;
            simd::deform_band(
                simd::GridBand<T>{nullptr, 0, begin, std::min(begin + kRowsAtOnce, first + count), columns,
                                  m_sums.data(), m_sum.options().resolution, nullptr, displacement, true});
        });
    }
    return part;
}

template <class T>
GridPart DeformedGrid::update(const T* base, T* out, const ParallelFor& parallel_for, T* displacement) {
    return draw(false, base, out, parallel_for, displacement);
}

template <class T>
void DeformedGrid::write(const T* base, T* out, const ParallelFor& parallel_for, T* displacement) {
    draw(true, base, out, parallel_for, displacement);
}

template <class T>
double deform_grid(const std::vector<Deformation>& list, std::span<const double> u, std::span<const double> v,
                   const DeformOptions& options, const T* base, T* out, const ParallelFor& parallel_for) {
    check_grid(u, v);
    const std::vector<DeformationChange> changes = difference({}, list);
    DisplacementSum sum(options);
    sum.apply(changes);
    const std::vector<Term> terms = terms_of(changes);
    std::size_t next = 0;
    const GridTerms ready = prepare(terms, next, u, v, sum);
    if (next == terms.size()) {
        draw_terms<T>(ready, true, static_cast<int>(u.size()), static_cast<int>(v.size()), options.resolution,
                      nullptr, base, out, parallel_for);
    } else {
        DeformedGrid grid({u.begin(), u.end()}, {v.begin(), v.end()}, options);
        grid.apply(changes);
        grid.write(base, out, parallel_for);
    }
    return sum.error_bound();
}

template GridPart DeformedGrid::update(const float*, float*, const ParallelFor&, float*);
template GridPart DeformedGrid::update(const double*, double*, const ParallelFor&, double*);
template void DeformedGrid::write(const float*, float*, const ParallelFor&, float*);
template void DeformedGrid::write(const double*, double*, const ParallelFor&, double*);
template double deform_grid(const std::vector<Deformation>&, std::span<const double>, std::span<const double>,
                            const DeformOptions&, const float*, float*, const ParallelFor&);
template double deform_grid(const std::vector<Deformation>&, std::span<const double>, std::span<const double>,
                            const DeformOptions&, const double*, double*, const ParallelFor&);

// --- Points

namespace {

constexpr double kPointsInCell = 256;

/// Which of `count` equal parts of [least, most] holds a value.
int part_of(double value, double least, double most, int count) {
    if (!(most > least)) return 0;
    // Halves, so that the width of a range stays in the range of double.
    const double at = (value / 2 - least / 2) / (most / 2 - least / 2) * count;
    return std::clamp(static_cast<int>(at), 0, count - 1);
}

simd::PointTerm point_term(const Term& from, const DisplacementSum& sum) {
    const Deformation& d = *from.deformation;
    simd::PointTerm term{{d.center.x, d.center.y},
                         {1 / d.extent.x, 1 / d.extent.y},
                         sum.reach(d.kernel),
                         {},
                         d.kernel == DeformationKernel::gaussian};
    set_units(from, sum.options().resolution, term.units);
    return term;
}

/// Does a term move points with coordinates from `least` to `most`? The arithmetic of simd::deform_points,
/// monotonic in the coordinate.
bool reaches(const simd::PointTerm& term, int axis, double least, double most) {
    return (most - term.center[axis]) * term.inverse_extent[axis] >= -term.reach &&
           (least - term.center[axis]) * term.inverse_extent[axis] <= term.reach;
}

}  // namespace

DeformedPoints::DeformedPoints(std::span<const glm::dvec2> points, const DeformOptions& options)
    : m_sum(options) {
    if (points.size() > std::numeric_limits<std::int32_t>::max())
        throw Error("points", std::to_string(points.size()), "allowed are fewer than 2^31");
    if (points.empty()) return;
    glm::dvec2 least = points[0], most = points[0];
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int c = 0; c < 2; ++c) {
            if (!std::isfinite(points[i][c]))
                throw Error("points[" + std::to_string(i) + "]", shortest(points[i][c]),
                            "allowed are finite numbers");
            least[c] = std::min(least[c], points[i][c]);
            most[c] = std::max(most[c], points[i][c]);
        }
    const int across =
        std::clamp(static_cast<int>(std::sqrt(static_cast<double>(points.size()) / kPointsInCell)), 1, 2048);
    // Counting sort: the points of each cell in their order.
    const auto cell_of = [&](glm::dvec2 p) {
        return static_cast<std::size_t>(part_of(p.y, least.y, most.y, across) * across +
                                        part_of(p.x, least.x, most.x, across));
    };
    constexpr double kFar = std::numeric_limits<double>::infinity();
    std::vector<std::size_t> count(static_cast<std::size_t>(across) * static_cast<std::size_t>(across));
    for (const glm::dvec2& p : points) ++count[cell_of(p)];
    std::size_t end = 0;
    for (std::size_t c = 0; c < count.size(); ++c) {
        if (c % static_cast<std::size_t>(across) == 0) m_cell_rows.push_back(c);
        m_cells.push_back({end, end, glm::dvec2(kFar), glm::dvec2(-kFar)});
        end += (count[c] + simd::kPointBlock - 1) / simd::kPointBlock * simd::kPointBlock;
    }
    m_cell_rows.push_back(count.size());
    m_u.assign(end, std::numeric_limits<double>::quiet_NaN());
    m_v = m_u;
    m_point.assign(end, -1);
    for (std::vector<std::int64_t>& sums : m_sums) sums.resize(end);
    for (std::size_t i = 0; i < points.size(); ++i) {
        Cell& cell = m_cells[cell_of(points[i])];
        cell.least = glm::dvec2(std::min(cell.least.x, points[i].x), std::min(cell.least.y, points[i].y));
        cell.most = glm::dvec2(std::max(cell.most.x, points[i].x), std::max(cell.most.y, points[i].y));
        m_u[cell.end] = points[i].x;
        m_v[cell.end] = points[i].y;
        m_point[cell.end++] = static_cast<std::int32_t>(i);
    }
    for (Cell& cell : m_cells)
        cell.end += (simd::kPointBlock - (cell.end - cell.begin) % simd::kPointBlock) % simd::kPointBlock;
}

void DeformedPoints::apply(std::span<const DeformationChange> changes) {
    m_sum.apply(changes);
    m_pending.insert(m_pending.end(), changes.begin(), changes.end());
}

template <class T>
std::int64_t DeformedPoints::draw(bool all, const T* base, T* out, const ParallelFor& parallel_for,
                                  T* displacement) {
    std::vector<simd::PointTerm> terms;
    for (const Term& from : terms_of(m_pending)) terms.push_back(point_term(from, m_sum));
    std::atomic<std::int64_t> written = 0;
    const double resolution = m_sum.options().resolution;
    const auto draw_cell = [&](const Cell& cell, const std::vector<const simd::PointTerm*>& on_row,
                               std::vector<const simd::PointTerm*>& on_cell) {
        on_cell.clear();
        for (const simd::PointTerm* term : on_row)
            if (reaches(*term, 0, cell.least.x, cell.most.x) && reaches(*term, 1, cell.least.y, cell.most.y))
                on_cell.push_back(term);
        if (on_cell.empty() && !all) return;
        std::int64_t* const sums[3] = {&m_sums[0][cell.begin], &m_sums[1][cell.begin],
                                       &m_sums[2][cell.begin]};
        simd::deform_points(on_cell.data(), on_cell.size(), &m_u[cell.begin], &m_v[cell.begin],
                            cell.end - cell.begin, sums);
        std::int64_t points = 0;
        for (std::size_t slot = cell.begin; slot < cell.end && m_point[slot] >= 0; ++slot, ++points)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t k = 3 * static_cast<std::size_t>(m_point[slot]) + c;
                const double start = base ? static_cast<double>(base[k]) : 0;
                const double moved = static_cast<double>(m_sums[c][slot]) * resolution;
                out[k] = static_cast<T>(moved + start);
                if (displacement) displacement[k] = static_cast<T>(moved);
            }
        written += points;
    };
    const auto draw_row = [&](std::int64_t row) {
        const std::size_t begin = m_cell_rows[static_cast<std::size_t>(row)],
                          end = m_cell_rows[static_cast<std::size_t>(row) + 1];
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (std::size_t c = begin; c < end; ++c) {
            least = std::min(least, m_cells[c].least.y);
            most = std::max(most, m_cells[c].most.y);
        }
        std::vector<const simd::PointTerm*> on_row, on_cell;
        for (const simd::PointTerm& term : terms)
            if (reaches(term, 1, least, most)) on_row.push_back(&term);
        for (std::size_t c = begin; c < end; ++c)
            if (m_cells[c].begin != m_cells[c].end) draw_cell(m_cells[c], on_row, on_cell);
    };
    if (!m_cells.empty() && (all || !terms.empty()))
        parallel_for(static_cast<std::int64_t>(m_cell_rows.size()) - 1, draw_row);
    m_pending.clear();
    return written;
}

template <class T>
std::int64_t DeformedPoints::update(const T* base, T* out, const ParallelFor& parallel_for, T* displacement) {
    return draw(false, base, out, parallel_for, displacement);
}

template <class T>
void DeformedPoints::write(const T* base, T* out, const ParallelFor& parallel_for, T* displacement) {
    draw(true, base, out, parallel_for, displacement);
}

template std::int64_t DeformedPoints::update(const float*, float*, const ParallelFor&, float*);
template std::int64_t DeformedPoints::update(const double*, double*, const ParallelFor&, double*);
template void DeformedPoints::write(const float*, float*, const ParallelFor&, float*);
template void DeformedPoints::write(const double*, double*, const ParallelFor&, double*);

// --- Normals

void displacement_jets(const std::vector<Deformation>& list, std::span<const glm::dvec2> points,
                       const DeformOptions& options, DisplacementJet* out, const ParallelFor& parallel_for) {
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int c = 0; c < 2; ++c)
            if (!std::isfinite(points[i][c]))
                throw Error("points[" + std::to_string(i) + "]", shortest(points[i][c]),
                            "allowed are finite numbers");
    DisplacementSum sum(options);
    const std::vector<DeformationChange> changes = difference({}, list);
    sum.apply(changes);
    const std::vector<Term> all = terms_of(changes);
    std::vector<simd::PointTerm> terms;
    for (const Term& term : all) terms.push_back(point_term(term, sum));
    constexpr std::size_t kChunk = 64;
    parallel_for(static_cast<std::int64_t>((points.size() + kChunk - 1) / kChunk), [&](std::int64_t chunk) {
        const std::size_t begin = static_cast<std::size_t>(chunk) * kChunk,
                          end = std::min(begin + kChunk, points.size());
        glm::dvec2 least = points[begin], most = least;
        for (std::size_t i = begin; i < end; ++i)
            for (int c = 0; c < 2; ++c) {
                least[c] = std::min(least[c], points[i][c]);
                most[c] = std::max(most[c], points[i][c]);
            }
        std::vector<std::size_t> near;
        for (std::size_t k = 0; k < terms.size(); ++k)
            if (reaches(terms[k], 0, least.x, most.x) && reaches(terms[k], 1, least.y, most.y))
                near.push_back(k);
        for (std::size_t i = begin; i < end; ++i) {
            const glm::dvec2 p = points[i];
            out[i] = {};
            for (const std::size_t k : near)
                if (reaches(terms[k], 0, p.x, p.x) && reaches(terms[k], 1, p.y, p.y))
                    add_displacement(*all[k].deformation, p, out[i]);
        }
    });
}

void deformed_normals(const std::vector<Deformation>& list, std::span<const glm::dvec2> points,
                      std::span<const glm::dvec3> base_u, std::span<const glm::dvec3> base_v,
                      const DeformOptions& options, glm::dvec3* out, const ParallelFor& parallel_for) {
    for (const auto& [name, size] : {std::pair("base_u", base_u.size()), std::pair("base_v", base_v.size())})
        if (size != 1 && size != points.size())
            throw Error(name, std::to_string(size) + " vectors",
                        "needed are one, or as many as points, " + std::to_string(points.size()));
    std::vector<DisplacementJet> jets(points.size());
    displacement_jets(list, points, options, jets.data(), parallel_for);
    for (std::size_t i = 0; i < points.size(); ++i)
        out[i] = normal_of(jets[i], base_u[base_u.size() == 1 ? 0 : i], base_v[base_v.size() == 1 ? 0 : i]);
}

}  // namespace anamorph
