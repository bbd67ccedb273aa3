// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/deformed_surface.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <new>
#include <numbers>
#include <stdexcept>

#include "anamorph/deform/deform_kernels.h"
#include "anamorph/parameter/parameter.h"

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
              int block, bool shares, LineVector<double>& tables) {
    const double inverse = 1 / extent;
    const auto [first, last] = reached(values, center, inverse, reach);
    if (first == last) return {};
    const Axis axis{round_down(first, block), round_up(last, block), tables.size()};
    tables.resize(tables.size() + static_cast<std::size_t>(axis.end - axis.begin), gaussian ? 0.0 : 2.0);
    const int count = std::min(axis.end, static_cast<int>(values.size())) - axis.begin;
    const double* from = values.data() + axis.begin;
    simd::axis_factors({center, inverse, reach, gaussian, shares}, from, count, tables.data() + axis.at,
                       nullptr);
    return axis;
}

/// Terms made ready to be drawn on a grid.
struct GridTerms {
    std::vector<simd::GridTerm> terms;
    LineVector<double> tables;
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
            add_axis(u, d.center.x, d.extent.x, gaussian, reach, simd::kGridBlock, true, ready.tables);
        const Axis row =
            add_axis(v, d.center.y, d.extent.y, gaussian, reach, simd::kGridRows, false, ready.tables);
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

/// Is a surface so large that its points are better not fetched into the caches before they are written, and
/// would not be found there afterwards?
template <class T>
bool goes_past_caches(int columns, int rows) {
    constexpr double kLarge = 8e6;
    return 3 * sizeof(T) * static_cast<double>(columns) * rows >= kLarge;
}

/// Draws terms on bands of rows; without sums nothing is kept.
template <class T>
void draw_terms(const GridTerms& ready, bool all, int columns, int rows, double resolution, bool in_double,
                std::int64_t* sums, const double* offsets, const T* base, T* out,
                const ParallelFor& parallel_for) {
    constexpr int kBandRows = 16;
    const bool stream = goes_past_caches<T>(columns, rows);
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
        simd::deform_band({terms.data(), terms.size(), begin, band_end, columns, sums, resolution, offsets,
                           base, out, all, stream, in_double});
    });
}

void check_axis(const char* name, std::span<const double> values) {
    constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max() - 1024;
    if (values.empty() || values.size() > kMost)
        throw Error(name, std::to_string(values.size()) + " values",
                    "must be from 1 to " + std::to_string(kMost));
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            throw Error(std::string(name) + "[" + std::to_string(i) + "]", shortest(values[i]),
                        "must be a finite number");
}

void check_grid(std::span<const double> u, std::span<const double> v) {
    check_axis("u", u);
    check_axis("v", v);
    constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 40;
    if (u.size() > kMostPoints / v.size())
        throw Error("u and v", std::to_string(u.size()) + "x" + std::to_string(v.size()) + " points",
                    "must be at most 2^40");
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
    kCutoffRow.check(options.cutoff);
    int exponent = 0;
    if (!(options.resolution >= 0x1p-500 && options.resolution <= 0x1p500) ||
        std::frexp(options.resolution, &exponent) != 0.5)
        throw Error("resolution", shortest(options.resolution), "must be a power of 2 from 2^-500 to 2^500");
}

double DisplacementSum::reach(DeformationKernel kernel) const {
    if (kernel == DeformationKernel::wendland_c2) return 1;
    return std::sqrt(-std::log(m_options.cutoff)) * (1 + 0x1p-48);
}

namespace {

/// What the errors of frames are counted in, times V: whole numbers of it, so that what was added and taken away leaves no trace.
constexpr double kFrameUnit = 0x1p-33;

/// The error of F by a bump's frame, in kFrameUnit.
double frame_error_of(const Deformation& d) {
    const auto [least, most] = std::minmax({d.extent.x, d.extent.y, d.extent_w});
    return simd::kFrameError * (most / least + 1) * (0x1p-53 / kFrameUnit);
}

}  // namespace

void DisplacementSum::add(Totals& totals, const Deformation& d, int sign) const {
    for (int c = 0; c < 3; ++c) {
        const double units = std::ceil(std::fabs(d.vector[c]) / m_options.resolution);
        if (!(units < simd::kMostUnits))
            throw Error("vector", shortest(d.vector[c]),
                        "with resolution=" + shortest(m_options.resolution) +
                            ", the magnitude must be below " +
                            shortest(simd::kMostUnits * m_options.resolution));
        const auto whole = static_cast<std::int64_t>(units) * sign;
        if (static_cast<double>(totals.units[c]) + static_cast<double>(whole) >= kMostTotal)
            throw Error("vector", shortest(d.vector[c]),
                        "with resolution=" + shortest(m_options.resolution) +
                            " the magnitudes of all vectors together must stay below " +
                            shortest(kMostTotal * m_options.resolution));
        totals.units[c] += whole;
        if (d.kernel == DeformationKernel::gaussian) totals.gaussian[c] += whole;
        if (!d.is_plain()) totals.deep[c] += whole;
        if (!d.has_frame()) continue;
        const double framed = std::ceil(units * frame_error_of(d));
        if (static_cast<double>(totals.framed[c]) + sign * framed >= kMostTotal)
            throw Error("vector", shortest(d.vector[c]),
                        "with extents so far apart: must be smaller, or without an orientation");
        totals.framed[c] += static_cast<std::int64_t>(framed) * sign;
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
                                  static_cast<double>(m_totals.units[c]) * simd::kKernelError * 0x1p-53 +
                                  static_cast<double>(m_totals.deep[c]) * simd::kDeepError * 0x1p-53 +
                                  static_cast<double>(m_totals.framed[c]) * kFrameUnit);
    return (most + 0.5 * static_cast<double>(m_totals.count)) * m_options.resolution;
}

bool DisplacementSum::stays_in_double(std::span<const DeformationChange> changes) const {
    // Before the changes sums were at most what they are after them and all that is changed; on the way they are at most all
    // that is changed more. Twice is for what is rounded here and in the kernels. Totals are negative where something was taken
    // away before it was added.
    double most_on_the_way = std::max(0.0, most());
    for (const Term& term : terms_of(changes)) {
        const glm::dvec3& v = term.deformation->vector;
        most_on_the_way +=
            2 * (std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}) + m_options.resolution);
    }
    return 2 * most_on_the_way <= simd::kMostInDouble * m_options.resolution;
}

double DisplacementSum::most() const {
    double most = 0;
    for (int c = 0; c < 3; ++c)
        most =
            std::max(most, static_cast<double>(m_totals.units[c]) * (1 + 2 * simd::kKernelError * 0x1p-53) +
                               static_cast<double>(m_totals.deep[c]) * (2 * simd::kDeepError * 0x1p-53) +
                               2 * static_cast<double>(m_totals.framed[c]) * kFrameUnit);
    return (most + 0.5 * static_cast<double>(m_totals.count)) * m_options.resolution;
}

namespace {

/// Throws Error on bumps that need more of a point than (u, v).
void check_plain(std::span<const DeformationChange> changes, const char* what) {
    for (const DeformationChange& change : changes)
        for (const auto& end : {change.before, change.after})
            if (end && !end->is_plain())
                throw Error(end->has_depth() ? "extent" : "side",
                            end->has_depth() ? shortest(end->extent_w) : "front or back",
                            std::string("there are no depths and normals ") + what +
                                ": must be without a third number, and of both sides");
}

}  // namespace

// --- Grids

DeformedGrid::DeformedGrid(std::vector<double> u, std::vector<double> v, const DeformOptions& options)
    : m_u(std::move(u)), m_v(std::move(v)), m_sum(options) {
    check_grid(m_u, m_v);
}

void DeformedGrid::apply(std::span<const DeformationChange> changes) {
    check_plain(changes, "on a grid of (u, v)");
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
    const bool in_double = m_sum.stays_in_double(m_pending);
    GridPart part;
    std::size_t next = 0;
    while (next < terms.size() || (all && next == 0)) {
        const GridTerms ready = prepare(terms, next, m_u, m_v, m_sum);
        const bool write_all = all && next == terms.size();
        draw_terms(ready, write_all, columns, rows, m_sum.options().resolution, in_double, m_sums.data(),
                   m_offsets, base, out, parallel_for);
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
                                  m_sums.data(), m_sum.options().resolution, m_offsets, nullptr, displacement,
                                  true, goes_past_caches<T>(columns, rows), in_double});
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

namespace {

// Derivatives on a grid are added tile by tile, so that what is kept does not grow with the grid nor with the
// list.
constexpr int kTileColumns = 64, kTileRows = 16;
static_assert(kTileColumns <= SurfaceSlopes::kMost && kTileColumns % simd::kGridBlock == 0);

GridPart common(const GridPart& a, const GridPart& b) {
    return {std::max(a.column_begin, b.column_begin), std::max(a.row_begin, b.row_begin),
            std::min(a.column_end, b.column_end), std::min(a.row_end, b.row_end)};
}

/// The derivatives at a part of a tile.
class TileSlopes {
  public:
    TileSlopes(const GridPart& part, std::span<const double> u, std::span<const double> v)
        : m_part(part),
          m_width(round_up(part.column_end - part.column_begin, simd::kGridBlock)),
          m_u(u.subspan(static_cast<std::size_t>(part.column_begin),
                        static_cast<std::size_t>(part.column_end - part.column_begin))),
          m_v(v.subspan(static_cast<std::size_t>(part.row_begin),
                        static_cast<std::size_t>(part.row_end - part.row_begin))),
          m_by(static_cast<std::size_t>(6 * m_width) * m_v.size()) {}

    void add(const Term& from, const DisplacementSum& sum) {
        const Deformation& d = *from.deformation;
        const bool gaussian = d.kernel == DeformationKernel::gaussian;
        const simd::AxisKernel across{d.center.x, 1 / d.extent.x, sum.reach(d.kernel), gaussian},
            down{d.center.y, 1 / d.extent.y, sum.reach(d.kernel), gaussian};
        const auto [column, column_end] = reached(m_u, across.center, across.inverse_extent, across.reach);
        const auto [row, row_end] = reached(m_v, down.center, down.inverse_extent, down.reach);
        if (column == column_end || row == row_end) return;
        TileTerm& term = m_terms.emplace_back();
        term.columns = {round_down(column, simd::kGridBlock), row, round_up(column_end, simd::kGridBlock),
                        row_end};
        set_units(from, 1, term.vector);
        term.gaussian = gaussian;
        // Beyond the last column F has no slope.
        std::fill(term.column, term.column + m_width, gaussian ? 0.0 : 2.0);
        std::fill(term.column_slope, term.column_slope + m_width, 0.0);
        simd::axis_factors(across, m_u.data(), static_cast<int>(m_u.size()), term.column, term.column_slope);
        simd::axis_factors(down, m_v.data(), static_cast<int>(m_v.size()), term.row, term.row_slope);
        if (m_terms.size() == kTermsAtOnce) carry_out();
    }

    void take(int columns, const TakeSlopes& take) {
        carry_out();
        for (int row = 0; row < static_cast<int>(m_v.size()); ++row) {
            double by[6][SurfaceSlopes::kMost];
            for (int c = 0; c < 6; ++c) std::copy_n(sums(row, c), m_width, by[c]);
            take({static_cast<int>(m_u.size()),
                  std::int64_t{m_part.row_begin + row} * columns + m_part.column_begin, nullptr, by});
        }
    }

  private:
    struct TileTerm {
        GridPart columns;  ///< and rows, of the tile
        double vector[3];
        bool gaussian;
        double column[kTileColumns], column_slope[kTileColumns], row[kTileRows], row_slope[kTileRows];
    };
    static constexpr std::size_t kTermsAtOnce = 64;

    double* sums(int row, int c) { return m_by.data() + std::ptrdiff_t{6 * row + c} * m_width; }

    void carry_out() {
        std::vector<simd::RowTerm> on_block;
        for (int row = 0; row < static_cast<int>(m_v.size()); ++row)
            for (int column = 0; column < m_width; column += simd::kGridBlock) {
                on_block.clear();
                for (const TileTerm& t : m_terms)
                    if (t.columns.column_begin <= column && column < t.columns.column_end &&
                        t.columns.row_begin <= row && row < t.columns.row_end)
                        on_block.push_back({t.column + column,
                                            t.column_slope + column,
                                            t.row[row],
                                            t.row_slope[row],
                                            {t.vector[0], t.vector[1], t.vector[2]},
                                            t.gaussian});
                double* to[6];
                for (int c = 0; c < 6; ++c) to[c] = sums(row, c) + column;
                simd::add_row_slopes(on_block.data(), on_block.size(), simd::kGridBlock, to);
            }
        m_terms.clear();
    }

    GridPart m_part;
    int m_width;
    std::span<const double> m_u, m_v;
    std::vector<double> m_by;
    std::vector<TileTerm> m_terms;
};

}  // namespace

void DeformedGrid::slopes(const std::vector<Deformation>& list, const std::vector<DeformationChange>* changes,
                          const TakeSlopes& take, const ParallelFor& parallel_for) const {
    const int columns = static_cast<int>(m_u.size()), rows = static_cast<int>(m_v.size());
    const std::vector<DeformationChange> all = difference({}, list);
    const std::vector<Term> terms = terms_of(all);
    std::vector<GridPart> parts;
    if (!changes) parts.push_back({0, 0, columns, rows});
    for (const Term& term : terms_of(changes ? std::span(*changes) : std::span<const DeformationChange>())) {
        const Deformation& d = *term.deformation;
        const double reach = m_sum.reach(d.kernel);
        const auto [column, column_end] = reached(m_u, d.center.x, 1 / d.extent.x, reach);
        const auto [row, row_end] = reached(m_v, d.center.y, 1 / d.extent.y, reach);
        parts.push_back({column, row, column_end, row_end});
    }
    const std::int64_t across = (columns + kTileColumns - 1) / kTileColumns,
                       down = (rows + kTileRows - 1) / kTileRows;
    parallel_for(across * down, [&](std::int64_t i) {
        const int column = static_cast<int>(i % across) * kTileColumns,
                  row = static_cast<int>(i / across) * kTileRows;
        const GridPart tile{column, row, std::min(column + kTileColumns, columns),
                            std::min(row + kTileRows, rows)};
        GridPart part;
        for (const GridPart& p : parts) hull(part, common(tile, p));
        if (part.empty()) return;
        TileSlopes slopes_of_part(part, m_u, m_v);
        for (const Term& term : terms) slopes_of_part.add(term, m_sum);
        slopes_of_part.take(columns, take);
    });
}

template <class T>
double deform_grid(const std::vector<Deformation>& list, std::span<const double> u, std::span<const double> v,
                   const DeformOptions& options, const T* base, T* out, const ParallelFor& parallel_for) {
    check_grid(u, v);
    const std::vector<DeformationChange> changes = difference({}, list);
    check_plain(changes, "on a grid of (u, v)");
    DisplacementSum sum(options);
    sum.apply(changes);
    const std::vector<Term> terms = terms_of(changes);
    std::size_t next = 0;
    const GridTerms ready = prepare(terms, next, u, v, sum);
    if (next == terms.size()) {
        draw_terms<T>(ready, true, static_cast<int>(u.size()), static_cast<int>(v.size()), options.resolution,
                      sum.stays_in_double(), nullptr, nullptr, base, out, parallel_for);
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
                         {},
                         d.kernel == DeformationKernel::gaussian};
    set_units(from, 1, term.vector);
    set_units(from, sum.options().resolution, term.units);
    term.has_depth = d.has_depth();
    term.has_side = d.has_side();
    if (term.has_depth) {
        term.center_w = d.center_w;
        term.inverse_extent_w = 1 / d.extent_w;
    }
    const Triple<double> direction = side_direction<double>(d);
    if (term.has_side)
        term.direction[0] = direction.x, term.direction[1] = direction.y, term.direction[2] = direction.z;
    term.has_frame = d.has_frame();
    if (term.has_frame) {
        const auto turn = turn_of<double>(d);
        for (std::size_t j = 0; j < 3; ++j) std::copy(std::begin(turn[j]), std::end(turn[j]), term.turn[j]);
        const glm::dvec3 reach = framed_reach(d);
        term.box[0] = 1 / reach.x;
        term.box[1] = 1 / reach.y;
    }
    return term;
}
std::vector<simd::PointTerm> point_terms(std::span<const DeformationChange> changes,
                                         const DisplacementSum& sum) {
    std::vector<simd::PointTerm> terms;
    for (const Term& from : terms_of(changes)) terms.push_back(point_term(from, sum));
    return terms;
}

/// Does a term move points with coordinates from `least` to `most`? The arithmetic of simd::deform_points,
/// monotonic in the coordinate.
bool reaches(const simd::PointTerm& term, int axis, double least, double most) {
    const double inverse = term.has_frame ? term.box[axis] : term.inverse_extent[axis];
    return (most - term.center[axis]) * inverse >= -term.reach &&
           (least - term.center[axis]) * inverse <= term.reach;
}

/// The derivatives at `count` points, a multiple of simd::kPointBlock, and how many parameters they are by.
template <int kSlopes>
int point_slopes(const std::vector<const simd::PointTerm*>& near, const simd::TermPoints& points,
                 std::size_t count, double (&by)[kSlopes][SurfaceSlopes::kMost]) {
    const int parameters = points.w ? 6 : 2;
    double* sums[kSlopes];
    for (int c = 0; c < 3 * parameters; ++c) std::fill_n(sums[c] = by[c], count, 0.0);
    simd::add_point_slopes(near.data(), near.size(), points, count, sums);
    return parameters;
}

}  // namespace

DeformedPoints::DeformedPoints(std::span<const glm::dvec2> points, const DeformOptions& options)
    : m_sum(options) {
    if (points.size() > std::numeric_limits<std::int32_t>::max())
        throw Error("points", std::to_string(points.size()), "must be fewer than 2^31");
    if (points.empty()) return;
    glm::dvec2 least = points[0], most = points[0];
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int c = 0; c < 2; ++c) {
            if (!std::isfinite(points[i][c]))
                throw Error("points[" + std::to_string(i) + "]", shortest(points[i][c]),
                            "must be a finite number");
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
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    std::vector<std::size_t> count(static_cast<std::size_t>(across) * static_cast<std::size_t>(across));
    for (const glm::dvec2& p : points) ++count[cell_of(p)];
    std::size_t end = 0;
    for (std::size_t c = 0; c < count.size(); ++c) {
        if (c % static_cast<std::size_t>(across) == 0) m_cell_rows.push_back(c);
        m_cells.push_back({end, end, glm::dvec2(kEndless), glm::dvec2(-kEndless)});
        end += (count[c] + simd::kPointBlock - 1) / simd::kPointBlock * simd::kPointBlock;
    }
    m_cell_rows.push_back(count.size());
    m_u.assign(end, std::numeric_limits<double>::quiet_NaN());
    m_v = m_u;
    m_point.assign(end, -1);
    for (LineVector<std::int64_t>& sums : m_sums) sums.resize(end);
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

DeformedPoints::DeformedPoints(std::span<const glm::dvec2> points, const PointDepths& depths,
                               const DeformOptions& options)
    : DeformedPoints(points, options) {
    if (depths.w.size() != points.size() || depths.normal.size() != points.size())
        throw Error(
            "depths",
            std::to_string(depths.w.size()) + " and " + std::to_string(depths.normal.size()) + " normals",
            "must be as many as points, " + std::to_string(points.size()));
    m_w.assign(m_u.size(), std::numeric_limits<double>::infinity());
    for (LineVector<double>& normal : m_normal) normal.assign(m_u.size(), 0);
    for (std::size_t slot = 0; slot < m_point.size(); ++slot) {
        if (m_point[slot] < 0) continue;
        const auto i = static_cast<std::size_t>(m_point[slot]);
        // At an infinite depth no bump that has one moves a point.
        if (std::isfinite(depths.w[i])) m_w[slot] = depths.w[i];
        for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(depths.normal[i][c]))
                throw Error("normal[" + std::to_string(i) + "]", shortest(depths.normal[i][c]),
                            "must be a finite number");
            m_normal[c][slot] = depths.normal[i][c];
        }
    }
}

simd::TermPoints DeformedPoints::term_points(std::size_t slot) const {
    simd::TermPoints points{&m_u[slot], &m_v[slot]};
    if (!m_w.empty()) {
        points.w = &m_w[slot];
        for (int c = 0; c < 3; ++c) points.normal[c] = &m_normal[c][slot];
    }
    return points;
}

void DeformedPoints::check_depth(std::span<const DeformationChange> changes) const {
    if (m_w.empty()) check_plain(changes, "at points that are given without them");
}

void DeformedPoints::apply(std::span<const DeformationChange> changes) {
    if (!m_u.empty()) check_depth(changes);
    m_sum.apply(changes);
    m_pending.insert(m_pending.end(), changes.begin(), changes.end());
}

void DeformedPoints::each_cell(
    const std::vector<simd::PointTerm>& visiting, bool all, const std::vector<simd::PointTerm>& terms,
    const ParallelFor& parallel_for,
    const std::function<void(const Cell&, const std::vector<const simd::PointTerm*>&)>& body) const {
    using Pointers = std::vector<const simd::PointTerm*>;
    const auto row_of = [](const std::vector<simd::PointTerm>& from, double least, double most) {
        Pointers on_row;
        for (const simd::PointTerm& term : from)
            if (reaches(term, 1, least, most)) on_row.push_back(&term);
        return on_row;
    };
    const auto visit_row = [&](std::int64_t row) {
        const std::size_t begin = m_cell_rows[static_cast<std::size_t>(row)],
                          end = m_cell_rows[static_cast<std::size_t>(row) + 1];
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (std::size_t c = begin; c < end; ++c) {
            least = std::min(least, m_cells[c].least.y);
            most = std::max(most, m_cells[c].most.y);
        }
        const Pointers visiting_row = row_of(visiting, least, most);
        if (visiting_row.empty() && !all) return;
        const Pointers on_row = row_of(terms, least, most);
        Pointers near;
        for (std::size_t c = begin; c < end; ++c) {
            const Cell& cell = m_cells[c];
            if (cell.begin == cell.end) continue;
            const auto reaches_cell = [&](const simd::PointTerm* term) {
                return reaches(*term, 0, cell.least.x, cell.most.x) &&
                       reaches(*term, 1, cell.least.y, cell.most.y);
            };
            if (!all && std::none_of(visiting_row.begin(), visiting_row.end(), reaches_cell)) continue;
            near.clear();
            std::copy_if(on_row.begin(), on_row.end(), std::back_inserter(near), reaches_cell);
            body(cell, near);
        }
    };
    if (!m_cells.empty()) parallel_for(static_cast<std::int64_t>(m_cell_rows.size()) - 1, visit_row);
}

void DeformedPoints::slopes(const std::vector<Deformation>& list,
                            const std::vector<DeformationChange>* changes, const TakeSlopes& take,
                            const ParallelFor& parallel_for) const {
    const std::vector<DeformationChange> all = difference({}, list);
    if (!m_u.empty()) check_depth(all);
    const std::vector<simd::PointTerm> terms = point_terms(all, m_sum);
    std::vector<simd::PointTerm> visiting;
    if (changes) visiting = point_terms(*changes, m_sum);
    constexpr std::size_t kMost = SurfaceSlopes::kMost;
    each_cell(visiting, !changes, terms, parallel_for,
              [&](const Cell& cell, const std::vector<const simd::PointTerm*>& near) {
                  double by[simd::kDeepSlopes][kMost];
                  for (std::size_t at = cell.begin; at < cell.end; at += kMost) {
                      const std::size_t slots = std::min(kMost, cell.end - at);
                      const int parameters = point_slopes(near, term_points(at), slots, by);
                      const auto end = std::find(&m_point[at], &m_point[at] + slots, -1);
                      if (end != &m_point[at])
                          take({static_cast<int>(end - &m_point[at]), 0, &m_point[at], by, parameters});
                  }
              });
}

template <class T>
std::int64_t DeformedPoints::write_slots(std::size_t begin, std::size_t end, const T* base, T* out,
                                         T* displacement) const {
    const double resolution = m_sum.options().resolution;
    std::int64_t points = 0;
    for (std::size_t slot = begin; slot < end && m_point[slot] >= 0; ++slot, ++points)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t k = 3 * static_cast<std::size_t>(m_point[slot]) + c;
            const double start = base ? static_cast<double>(base[k]) : 0;
            const double more = m_offsets ? m_offsets[k] : 0;
            const double moved = static_cast<double>(m_sums[c][slot]) * resolution + more;
            out[k] = static_cast<T>(moved + start);
            if (displacement) displacement[k] = static_cast<T>(moved);
        }
    return points;
}

template <class T>
std::int64_t DeformedPoints::draw(bool all, const T* base, T* out, const ParallelFor& parallel_for,
                                  T* displacement) {
    const std::vector<simd::PointTerm> terms = point_terms(m_pending, m_sum);
    const bool in_double = m_sum.stays_in_double(m_pending);
    std::atomic<std::int64_t> written = 0;
    const auto draw_cell = [&](const Cell& cell, const std::vector<const simd::PointTerm*>& near) {
        std::int64_t* const sums[3] = {&m_sums[0][cell.begin], &m_sums[1][cell.begin],
                                       &m_sums[2][cell.begin]};
        simd::deform_points(near.data(), near.size(), term_points(cell.begin), cell.end - cell.begin, sums,
                            in_double);
        written += write_slots(cell.begin, cell.end, base, out, displacement);
    };
    if (all || !terms.empty()) each_cell(terms, all, terms, parallel_for, draw_cell);
    m_pending.clear();
    return written;
}

template <class T>
void DeformedPoints::write_with_slopes(const std::vector<Deformation>& list, const T* base, T* out,
                                       const TakeSlopes& take, const ParallelFor& parallel_for,
                                       T* displacement) {
    const std::vector<DeformationChange> changes = difference({}, list);
    if (!m_u.empty()) check_depth(changes);
    DisplacementSum sum(m_sum.options());
    sum.apply(changes);
    m_sum = sum;
    m_pending.clear();
    const std::vector<simd::PointTerm> terms = point_terms(changes, m_sum);
    const bool in_double = m_sum.stays_in_double();
    constexpr std::size_t kMost = SurfaceSlopes::kMost;
    each_cell({}, true, terms, parallel_for,
              [&](const Cell& cell, const std::vector<const simd::PointTerm*>& near) {
                  double by[simd::kDeepSlopes][kMost];
                  const int parameters = m_w.empty() ? 2 : 6;
                  for (std::size_t at = cell.begin; at < cell.end; at += kMost) {
                      const std::size_t slots = std::min(kMost, cell.end - at);
                      std::int64_t* sums[3];
                      double* slopes[simd::kDeepSlopes];
                      for (int c = 0; c < 3; ++c) std::fill_n(sums[c] = &m_sums[c][at], slots, 0);
                      for (int c = 0; c < 3 * parameters; ++c) std::fill_n(slopes[c] = by[c], slots, 0.0);
                      simd::deform_points_with_slopes(near.data(), near.size(), term_points(at), slots, sums,
                                                      slopes, in_double);
                      const std::int64_t points = write_slots(at, at + slots, base, out, displacement);
                      if (points > 0) take({static_cast<int>(points), 0, &m_point[at], by, parameters});
                  }
              });
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
template void DeformedPoints::write_with_slopes(const std::vector<Deformation>&, const float*, float*,
                                                const TakeSlopes&, const ParallelFor&, float*);
template void DeformedPoints::write_with_slopes(const std::vector<Deformation>&, const double*, double*,
                                                const TakeSlopes&, const ParallelFor&, double*);

// --- Normals

void turn_normals(const SurfaceSlopes& slopes, glm::dvec3 gradient_u, glm::dvec3 gradient_v,
                  double (&normals)[3][SurfaceSlopes::kMost], glm::dvec3 gradient_w) {
    const std::size_t count = static_cast<std::size_t>(round_up(slopes.count, simd::kPointBlock));
    const bool by_depth = slopes.parameters > 2;
    const double* by[9] = {};
    for (int c = 0; c < (by_depth ? 9 : 6); ++c) by[c] = slopes.by[c];
    double* to[3];
    for (int c = 0; c < 3; ++c) to[c] = normals[c];
    const double gradients[3][3] = {{gradient_u.x, gradient_u.y, gradient_u.z},
                                    {gradient_v.x, gradient_v.y, gradient_v.z},
                                    {gradient_w.x, gradient_w.y, gradient_w.z}};
    simd::turn_normals(by, by_depth, gradients, count, to);
}

void CornerSums::add(int k, const Edge& next, const Edge& previous, bool goes_inwards) {
    if (m_count == kMost) carry_out();
    const int at = m_count++;
    m_point[at] = k;
    for (int c = 0; c < 3 * m_slopes.parameters; ++c) m_by[c][at] = m_slopes.by[c][k];
    for (int c = 0; c < 3; ++c) {
        m_next[c][at] = next.points[c];
        m_previous[c][at] = previous.points[c];
    }
    const auto keep = [&](const Edge& edge, double(&by)[6][kMost]) {
        for (int c = 0; c < 2; ++c) by[c][at] = edge.parameters[c];
        if (m_slopes.parameters == 2) return;
        by[2][at] = edge.depth;
        for (int c = 0; c < 3; ++c) by[3 + c][at] = edge.normal[c];
    };
    keep(next, m_next_by);
    keep(previous, m_previous_by);
    m_turns[at] = goes_inwards ? 2 * std::numbers::pi : 0;
}

void CornerSums::carry_out() {
    // 2^16 unit vectors times angles up to 2 pi.
    constexpr double kUnit = 0x1p-44;
    simd::CornerEdges edges{};
    edges.parameters = m_slopes.parameters;
    for (int c = 0; c < 3 * edges.parameters; ++c) edges.by[c] = m_by[c];
    for (int c = 0; c < 3; ++c) {
        edges.next[c] = m_next[c];
        edges.previous[c] = m_previous[c];
    }
    for (int c = 0; c < edges.parameters; ++c) {
        edges.next_by[c] = m_next_by[c];
        edges.previous_by[c] = m_previous_by[c];
    }
    edges.turns = m_turns;
    // What fills the last vector is a corner without a direction.
    const int count = round_up(m_count, simd::kPointBlock);
    for (double(&values)[kMost] : m_next) std::fill(values + m_count, values + count, 0.0);
    double normals[3][kMost];
    double* const out[3] = {normals[0], normals[1], normals[2]};
    simd::corner_normals(edges, kUnit, static_cast<std::size_t>(count), out);
    for (int i = 0; i < m_count; ++i)
        for (int c = 0; c < 3; ++c) m_sums[m_point[i]][c] += static_cast<std::int64_t>(normals[c][i]);
    m_count = 0;
}

glm::dvec3 CornerSums::normal(int k) {
    if (m_count > 0) carry_out();
    const glm::dvec3 sum(m_sums[k][0], m_sums[k][1], m_sums[k][2]);
    const double length = glm::length(sum);
    return length > 0 ? sum / length : glm::dvec3(0.0);
}

namespace {

/// A few neighbouring points and the terms that reach them.
struct Chunk {
    std::size_t begin, end;  ///< of the points, at most kMost
    std::vector<std::size_t> near;

    static constexpr std::size_t kMost = 64;
};

void each_chunk(std::span<const glm::dvec2> points, const std::vector<simd::PointTerm>& terms,
                const ParallelFor& parallel_for, const std::function<void(const Chunk&)>& body) {
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int c = 0; c < 2; ++c)
            if (!std::isfinite(points[i][c]))
                throw Error("points[" + std::to_string(i) + "]", shortest(points[i][c]),
                            "must be a finite number");
    const auto chunks = static_cast<std::int64_t>((points.size() + Chunk::kMost - 1) / Chunk::kMost);
    parallel_for(chunks, [&](std::int64_t i) {
        const std::size_t begin = static_cast<std::size_t>(i) * Chunk::kMost;
        Chunk chunk{begin, std::min(begin + Chunk::kMost, points.size()), {}};
        glm::dvec2 least = points[begin], most = least;
        for (std::size_t k = begin; k < chunk.end; ++k)
            for (int c = 0; c < 2; ++c) {
                least[c] = std::min(least[c], points[k][c]);
                most[c] = std::max(most[c], points[k][c]);
            }
        for (std::size_t k = 0; k < terms.size(); ++k)
            if (reaches(terms[k], 0, least.x, most.x) && reaches(terms[k], 1, least.y, most.y))
                chunk.near.push_back(k);
        body(chunk);
    });
}

}  // namespace

void displacement_jets(const std::vector<Deformation>& list, std::span<const glm::dvec2> points,
                       const DeformOptions& options, DisplacementJet* out, const ParallelFor& parallel_for) {
    DisplacementSum sum(options);
    const std::vector<DeformationChange> changes = difference({}, list);
    check_plain(changes, "at points that are given without them");
    sum.apply(changes);
    const std::vector<Term> all = terms_of(changes);
    const std::vector<simd::PointTerm> terms = point_terms(changes, sum);
    each_chunk(points, terms, parallel_for, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const glm::dvec2 p = points[i];
            out[i] = {};
            for (const std::size_t k : chunk.near)
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
                        "must be one, or as many as points, " + std::to_string(points.size()));
    DisplacementSum sum(options);
    const std::vector<DeformationChange> changes = difference({}, list);
    check_plain(changes, "at points that are given without them");
    sum.apply(changes);
    const std::vector<simd::PointTerm> terms = point_terms(changes, sum);
    each_chunk(points, terms, parallel_for, [&](const Chunk& chunk) {
        std::vector<const simd::PointTerm*> near;
        for (const std::size_t k : chunk.near) near.push_back(&terms[k]);
        // Points that fill the last vector have no parameters.
        double u[Chunk::kMost], v[Chunk::kMost], by[6][SurfaceSlopes::kMost];
        std::fill_n(u, Chunk::kMost, std::numeric_limits<double>::quiet_NaN());
        std::fill_n(v, Chunk::kMost, std::numeric_limits<double>::quiet_NaN());
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            u[i - chunk.begin] = points[i].x;
            v[i - chunk.begin] = points[i].y;
        }
        point_slopes(near, {u, v}, Chunk::kMost, by);
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            DisplacementJet jet;
            for (int c = 0; c < 3; ++c) {
                jet.by_u[c] = by[c][i - chunk.begin];
                jet.by_v[c] = by[3 + c][i - chunk.begin];
            }
            out[i] = normal_of(jet, base_u[base_u.size() == 1 ? 0 : i], base_v[base_v.size() == 1 ? 0 : i]);
        }
    });
}

}  // namespace anamorph
