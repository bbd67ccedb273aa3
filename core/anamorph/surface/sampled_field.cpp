// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/sampled_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace anamorph::surface {
namespace {

// The boxes of the pyramid's finest level are so many cells wide and high; each next level's, twice as many.
constexpr int kFinestBox = 4;
// A query reads at most so many boxes each way.
constexpr int kMostBoxes = 3;
// What is left of a cell next to missing ones is cut down to this.
constexpr double kLeastRest = 1.0 / 8;

// Bezier coefficients of a part of a cell are 12 interpolations away from texels no larger than M: each loses at most 6
// units of 2^-53 of numbers up to (4/3)^2 M, together less than 128 units of M. Those of a derivative, differences of the
// cell's before they are cut down to the part, are larger by 2 for each difference, and so is what they lose.
constexpr double kFieldRounding = 128 * 0x1p-53;
// What the place within a cell loses of a coordinate counted in cells.
constexpr double kPlaceRounding = 4 * 0x1p-53;

double between(double a, double b, double t) {
    return a + t * (b - a);
}

/// The cubic through four texels, between the middle two: its Bezier coefficients. Secants are its slopes there.
void to_bezier(double* p, std::size_t step) {
    const double p0 = p[0], p1 = p[step], p2 = p[2 * step], p3 = p[3 * step];
    p[0] = p1;
    p[step] = p1 + (p2 - p0) / 6;
    p[2 * step] = p2 - (p3 - p1) / 6;
    p[3 * step] = p2;
}

/// The coefficients of a polynomial of the first to the third degree over [a, b] of [0, 1], from those over that: its blossom
/// at as many b, and for the rest a.
void to_part(double* q, std::size_t step, std::size_t degree, double a, double b) {
    const double from[4] = {q[0], q[step], degree > 1 ? q[2 * step] : 0, degree > 2 ? q[3 * step] : 0};
    for (std::size_t k = 0; k <= degree; ++k) {
        double to[4] = {from[0], from[1], from[2], from[3]};
        for (std::size_t n = degree; n > 0; --n)
            for (std::size_t i = 0; i < n; ++i) to[i] = between(to[i], to[i + 1], n > degree - k ? b : a);
        q[k * step] = to[0];
    }
}

/// The coefficients of differences, along rows or along columns, of those of a polynomial.
struct Net {
    std::array<double, 16> values{};  ///< row by row of 4
    std::size_t columns = 4, rows = 4;

    double at(std::size_t i, std::size_t j) const { return values[4 * j + i]; }
    Net across() const {
        Net d{{}, columns - 1, rows};
        for (std::size_t j = 0; j < d.rows; ++j)
            for (std::size_t i = 0; i < d.columns; ++i) d.values[4 * j + i] = at(i + 1, j) - at(i, j);
        return d;
    }
    Net down() const {
        Net d{{}, columns, rows - 1};
        for (std::size_t j = 0; j < d.rows; ++j)
            for (std::size_t i = 0; i < d.columns; ++i) d.values[4 * j + i] = at(i, j + 1) - at(i, j);
        return d;
    }
    /// Over a part of the cell.
    Net part(double x0, double y0, double x1, double y1) const {
        Net n = *this;
        for (std::size_t j = 0; j < rows; ++j) to_part(n.values.data() + 4 * j, 1, columns - 1, x0, x1);
        for (std::size_t i = 0; i < columns; ++i) to_part(n.values.data() + i, 4, rows - 1, y0, y1);
        return n;
    }
    /// The hull of all coefficients, widened and scaled.
    Interval hull(double margin, double scale) const {
        double least = HUGE_VAL, most = -HUGE_VAL;
        for (std::size_t j = 0; j < rows; ++j)
            for (std::size_t i = 0; i < columns; ++i) {
                least = std::min(least, at(i, j));
                most = std::max(most, at(i, j));
            }
        return Interval(least - margin, most + margin) * scale;
    }
};

void extend(Interval& range, const Interval& more) {
    range = {std::min(range.lo, more.lo), std::max(range.hi, more.hi)};
}

constexpr Interval kNothing{HUGE_VAL, -HUGE_VAL};
constexpr std::array<Interval, 6> kNoHull{kNothing, kNothing, kNothing, kNothing, kNothing, kNothing};

bool is_number(float value) {
    return std::fabs(value) <= SampledField::kMostMagnitude;
}

}  // namespace

SampledField::SampledField(const std::vector<float>& texels, const Size& size, int channels)
    : m_size(size), m_channels(channels) {
    pad(texels);
    find_missing();
    build();
}

int SampledField::cell_at(double place, int size) {
    return static_cast<int>(std::clamp(std::floor(place), 0.0, double(size)));
}

/// Puts two more texels on each side, which go on straight: first of rows, then of columns.
void SampledField::pad(const std::vector<float>& texels) {
    const int w = m_size.width, h = m_size.height;
    m_texels.resize(offset(0, h + 4));
    const auto row_of = static_cast<std::size_t>(w) * static_cast<std::size_t>(m_channels);
    for (int y = 0; y < h; ++y)
        std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(row_of) * y, row_of, texel(2, y + 2));
    // From `last` on, whose neighbour within is `before`.
    const auto go_on = [&](const float* last, const float* before, int steps, float* to) {
        for (int c = 0; c < m_channels; ++c)
            to[c] = static_cast<float>(last[c] + steps * (double{last[c]} - before[c]));
    };
    for (int y = 2; y < h + 2; ++y)
        for (int k = 1; k <= 2; ++k) {
            go_on(texel(2, y), texel(std::min(3, w + 1), y), k, texel(2 - k, y));
            go_on(texel(w + 1, y), texel(std::max(2, w), y), k, texel(w + 1 + k, y));
        }
    for (int x = 0; x < w + 4; ++x)
        for (int k = 1; k <= 2; ++k) {
            go_on(texel(x, 2), texel(x, std::min(3, h + 1)), k, texel(x, 2 - k));
            go_on(texel(x, h + 1), texel(x, std::max(2, h)), k, texel(x, h + 1 + k));
        }
}

/// Finds the texels that are no numbers and the cells that depend on them.
void SampledField::find_missing() {
    double largest = 0;
    for (int y = 0; y < m_size.height + 4; ++y)
        for (int x = 0; x < m_size.width + 4; ++x) {
            float* const numbers = texel(x, y);
            if (std::all_of(numbers, numbers + m_channels, is_number)) {
                for (int c = 0; c < m_channels; ++c)
                    largest = std::max(largest, std::fabs(double{numbers[c]}));
                continue;
            }
            std::fill_n(numbers, m_channels, std::numeric_limits<float>::quiet_NaN());
            const bool own = x >= 2 && x < m_size.width + 2 && y >= 2 && y < m_size.height + 2;
            if (own && m_missing_texels++ == 0) m_first_missing = {x - 2, y - 2};
            const auto columns = static_cast<std::size_t>(m_size.width) + 1;
            m_missing.resize(columns * static_cast<std::size_t>(m_size.height + 1), Certainty::no);
            for (int row = std::max(0, y - 3); row <= std::min(m_size.height, y); ++row)
                for (int column = std::max(0, x - 3); column <= std::min(m_size.width, x); ++column)
                    m_missing[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)] =
                        Certainty::yes;
        }
    // Over a whole cell the field changes by less than 16 times the largest texel.
    m_rounding = largest * (kFieldRounding + 16 * kPlaceRounding * (m_size.width + m_size.height));
}

Certainty SampledField::missing_cell(int column, int row) const {
    return m_missing.empty()
               ? Certainty::no
               : m_missing[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_size.width + 1) +
                           static_cast<std::size_t>(column)];
}

/// The pyramid, up to a level of few boxes.
void SampledField::build() {
    Range finer{0, 0, m_size.width, m_size.height};
    for (int side = kFinestBox; std::max(finer.columns(), finer.rows()) > kMostBoxes; side = 2) {
        Level level{{0, 0, finer.x1 / side, finer.y1 / side}, {}, {}};
        for (int y = 0; y < level.boxes.rows(); ++y)
            for (int x = 0; x < level.boxes.columns(); ++x)
                build_box(m_levels.empty() ? nullptr : &m_levels.back(),
                          {x * side, y * side, std::min(finer.x1, x * side + side - 1),
                           std::min(finer.y1, y * side + side - 1)},
                          level);
        finer = level.boxes;
        m_levels.push_back(std::move(level));
    }
}

/// Adds a box made of those of a finer level, or of cells.
void SampledField::build_box(const Level* finer, const Range& parts, Level& to) const {
    std::vector<Hull> hulls(static_cast<std::size_t>(m_channels), kNoHull);
    bool all = true, none = true;
    for (int y = parts.y0; y <= parts.y1; ++y)
        for (int x = parts.x0; x <= parts.x1; ++x) {
            const Certainty missing = finer ? finer->missing[finer->index(x, y)] : missing_cell(x, y);
            all = all && missing == Certainty::yes;
            none = none && missing == Certainty::no;
            if (finer)
                add_box(*finer, x, y, hulls.data());
            else
                add_cell(x, y, {0, 0, 1, 1}, hulls.data());
        }
    to.hulls.insert(to.hulls.end(), hulls.begin(), hulls.end());
    to.missing.push_back(none ? Certainty::no : all ? Certainty::yes : Certainty::open);
}

void SampledField::add_box(const Level& level, int x, int y, Hull* hulls) const {
    const Hull* const box = level.hulls.data() + level.index(x, y) * static_cast<std::size_t>(m_channels);
    for (int c = 0; c < m_channels; ++c)
        for (std::size_t k = 0; k < 6; ++k) extend(hulls[c][k], box[c][k]);
}

/// Adds the coefficients over a part of a cell, and those of derivatives.
void SampledField::add_cell(int column, int row, const Part& part, Hull* hulls) const {
    if (missing_cell(column, row) != Certainty::no) return;
    const double across = m_size.width, down = m_size.height;
    const double beyond = std::max({1.0, 1 - 2 * part.x0, 2 * part.x1 - 1, 1 - 2 * part.y0, 2 * part.y1 - 1});
    for (int c = 0; c < m_channels; ++c) {
        Net cell;
        double largest = 0;
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t i = 0; i < 4; ++i) {
                const double number = texel(column + static_cast<int>(i), row + static_cast<int>(j))[c];
                cell.values[4 * j + i] = number;
                largest = std::max(largest, std::fabs(number));
            }
        for (std::size_t k = 0; k < 4; ++k) to_bezier(cell.values.data() + 4 * k, 1);
        for (std::size_t k = 0; k < 4; ++k) to_bezier(cell.values.data() + k, 4);
        // Extrapolated, each of six linear steps multiplies by that.
        const double margin = largest * kFieldRounding * std::pow(beyond, 6);
        const auto add = [&](Interval& to, const Net& net, double lost, double scale) {
            extend(to, net.part(part.x0, part.y0, part.x1, part.y1).hull(lost, scale));
        };
        Hull& h = hulls[c];
        const Net by_x = cell.across(), by_y = cell.down();
        add(h[0], cell, margin, 1);
        add(h[1], by_x, 2 * margin, 3 * across);
        add(h[2], by_y, 2 * margin, 3 * down);
        // Half of the second derivative, twice the difference of differences times 3.
        add(h[3], by_x.across(), 4 * margin, 3 * across * across);
        add(h[4], by_x.down(), 4 * margin, 9 * across * down);
        add(h[5], by_y.down(), 4 * margin, 3 * down * down);
    }
}

SampledField::Range SampledField::cells_of(const Interval& u, const Interval& v) const {
    const auto cell = [](double t, int size, double slack) {
        const double place = t * size + 0.5;
        return cell_at(place + slack * (std::fabs(place) + 1), size);
    };
    return {cell(u.lo, m_size.width, -kPlaceRounding), cell(v.lo, m_size.height, -kPlaceRounding),
            cell(u.hi, m_size.width, kPlaceRounding), cell(v.hi, m_size.height, kPlaceRounding)};
}

/// The part of a cell that a box meets, a little more than that.
SampledField::Part SampledField::part_of(int column, int row, const Interval& u, const Interval& v) const {
    const auto from = [](double t, int size, int cell) {
        const double at = t * size + 0.5;
        const double part = at - cell - kPlaceRounding * (std::fabs(at) + 1);
        return cell == 0 ? std::min(part, 1.0) : std::clamp(part, 0.0, 1.0);
    };
    const auto to = [](double t, int size, int cell) {
        const double at = t * size + 0.5;
        const double part = at - cell + kPlaceRounding * (std::fabs(at) + 1);
        return cell == size ? std::max(part, 0.0) : std::clamp(part, 0.0, 1.0);
    };
    return {from(u.lo, m_size.width, column), from(v.lo, m_size.height, row), to(u.hi, m_size.width, column),
            to(v.hi, m_size.height, row)};
}

const SampledField::Level* SampledField::level_of(Range& range) const {
    const Level* found = nullptr;
    for (const Level& level : m_levels) {
        if (std::max(range.columns(), range.rows()) <= kMostBoxes) break;
        const int side = found ? 2 : kFinestBox;
        range = {range.x0 / side, range.y0 / side, range.x1 / side, range.y1 / side};
        found = &level;
    }
    return found;
}

void SampledField::read(const Interval& u, const Interval& v, Interval* to) const {
    std::array<double, 3> numbers{};
    read(u.lo / 2 + u.hi / 2, v.lo / 2 + v.hi / 2, numbers.data());
    for (std::size_t c = 0; c < static_cast<std::size_t>(m_channels); ++c)
        to[c] = Interval(numbers[c]) + Interval(-m_rounding, m_rounding);
}

void SampledField::read(const Jet<Interval, 2>& u, const Jet<Interval, 2>& v, Jet<Interval, 2>* to) const {
    std::array<Hull, 3> hulls{kNoHull, kNoHull, kNoHull};
    const Range cells = cells_of(u.c[0], v.c[0]);
    Range range = cells;
    const Level* const level = level_of(range);
    const auto add_part = [&](int x, int y) { add_cell(x, y, part_of(x, y, u.c[0], v.c[0]), hulls.data()); };
    for (int y = range.y0; y <= range.y1; ++y)
        for (int x = range.x0; x <= range.x1; ++x)
            if (level)
                add_box(*level, x, y, hulls.data());
            else
                add_part(x, y);
    if (level) {
        // Boxes are of whole cells: beyond the picture those on its edges go on.
        for (int y = cells.y0; y <= cells.y1; ++y) {
            if (u.c[0].lo < 0) add_part(cells.x0, y);
            if (u.c[0].hi > 1) add_part(cells.x1, y);
        }
        for (int x = cells.x0; x <= cells.x1; ++x) {
            if (v.c[0].lo < 0) add_part(x, cells.y0);
            if (v.c[0].hi > 1) add_part(x, cells.y1);
        }
    }
    for (std::size_t c = 0; c < static_cast<std::size_t>(m_channels); ++c)
        for (std::size_t k = 0; k < 6; ++k)
            to[c].c[k] = hulls[c][k].lo <= hulls[c][k].hi ? hulls[c][k] : Interval::all();
}

Certainty SampledField::missing(const Interval& u, const Interval& v) const {
    if (m_missing.empty()) return Certainty::no;
    Range range = cells_of(u, v);
    const Level* const level = level_of(range);
    bool all = true, none = true;
    for (int y = range.y0; y <= range.y1; ++y)
        for (int x = range.x0; x <= range.x1; ++x) {
            const Certainty is = level ? level->missing[level->index(x, y)] : missing_cell(x, y);
            all = all && is == Certainty::yes;
            none = none && is == Certainty::no;
        }
    const bool small =
        !level && (u.hi - u.lo) * m_size.width <= kLeastRest && (v.hi - v.lo) * m_size.height <= kLeastRest;
    return none ? Certainty::no : all || small ? Certainty::yes : Certainty::open;
}

std::vector<float> smoothed(const std::vector<float>& texels, const Size& size, double sigma) {
    if (!(sigma > 0)) return texels;
    const int reach = static_cast<int>(std::ceil(4 * sigma));
    std::vector<double> kernel;
    for (int k = -reach; k <= reach; ++k) kernel.push_back(std::exp(-k * k / (2 * sigma * sigma)));
    // Sums of weights and of weighted numbers; along rows, then along columns.
    std::vector<double> weight(texels.size()), sum(texels.size());
    for (std::size_t i = 0; i < texels.size(); ++i) {
        weight[i] = is_number(texels[i]) ? 1 : 0;
        sum[i] = weight[i] > 0 ? double{texels[i]} : 0;
    }
    const auto along = [&](std::vector<double>& of, int count, std::size_t step, std::size_t first) {
        std::vector<double> line(static_cast<std::size_t>(count));
        for (std::size_t i = 0; i < line.size(); ++i) line[i] = of[first + i * step];
        for (int i = 0; i < count; ++i) {
            double total = 0;
            for (int k = std::max(-reach, -i); k <= std::min(reach, count - 1 - i); ++k)
                total += kernel.data()[k + reach] * line.data()[i + k];
            of[first + static_cast<std::size_t>(i) * step] = total;
        }
    };
    const auto width = static_cast<std::size_t>(size.width), height = static_cast<std::size_t>(size.height);
    for (std::vector<double>* of : {&weight, &sum}) {
        for (std::size_t y = 0; y < height; ++y) along(*of, size.width, 1, y * width);
        for (std::size_t x = 0; x < width; ++x) along(*of, size.height, width, x);
    }
    std::vector<float> result(texels);
    for (std::size_t i = 0; i < texels.size(); ++i)
        if (is_number(texels[i])) result[i] = static_cast<float>(sum[i] / weight[i]);
    return result;
}

}  // namespace anamorph::surface
