// SPDX-License-Identifier: Apache-2.0
// Numbers given at the texels of a picture, one or more each, interpolated once continuously differentiable: the cubic of
// control meshes (mesh/mesh.h), Hermite's with the secants of Catmull and Rom.
//
// (u, v) run from 0 to 1 over the picture, and a texel's numbers hold at its middle, ((i + 1/2) / width, (j + 1/2) / height).
// Beyond the outermost middles texels go on straight. A cell is the rectangle between four middles; it depends on 4 x 4
// texels, and where one of these is no finite number the cell is missing.
//
// Bounds. On a cell the field and its derivatives are polynomials, which lie within the hull of their Bezier
// coefficients over any part of the cell (Farin 2002, 3.3); a pyramid keeps the hulls of whole cells for larger boxes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/mesh/mesh.h"
#include "anamorph/number/interval.h"
#include "anamorph/number/jet.h"

namespace anamorph::surface {

/// A field given by the texels of a picture. Thread safe.
class SampledField {
  public:
    static constexpr std::int64_t kMostTexels = std::int64_t{1} << 24;
    static constexpr double kMostMagnitude = 1e12;

    /// Makes a field of `texels`: row by row, `channels` numbers each, 1 to 3. What is beyond kMostMagnitude
    /// counts as no number.
    SampledField(const std::vector<float>& texels, const Size& size, int channels);

    const Size& size() const { return m_size; }
    int channels() const { return m_channels; }
    /// The number of texels that are no finite numbers; first_missing() is the first of them.
    std::size_t missing_texels() const { return m_missing_texels; }
    const Point<int>& first_missing() const { return m_first_missing; }

    /// Reads the numbers at (u, v); NaN in a missing cell.
    template <class T>
    void read(const T& u, const T& v, T* to) const {
        const auto place = [](const T& t, int size) {
            return static_cast<double>(constant_part(t)) * size + 0.5;
        };
        const int column = cell_at(place(u, m_size.width), m_size.width),
                  row = cell_at(place(v, m_size.height), m_size.height);
        const std::array<T, 4> a = weights(T(u * double(m_size.width) - (column - 0.5))),
                               b = weights(T(v * double(m_size.height) - (row - 0.5)));
        for (int c = 0; c < m_channels; ++c) {
            to[c] = T(0.0);
            for (int j = 0; j < 4; ++j) {
                T sum(0.0);
                for (int i = 0; i < 4; ++i)
                    sum = sum + a[static_cast<std::size_t>(i)] * double{texel(column + i, row + j)[c]};
                to[c] = to[c] + b[static_cast<std::size_t>(j)] * sum;
            }
        }
    }
    /// The numbers that read() in double gives at the middle of u and v, give or take their rounding.
    void read(const Interval& u, const Interval& v, Interval* to) const;
    /// Encloses the Taylor coefficients at every point of the box that u and v, the variables themselves, run over, but for
    /// what is missing.
    void read(const Jet<Interval, 2>& u, const Jet<Interval, 2>& v, Jet<Interval, 2>* to) const;

    /// Is the box missing: none of it; all of it, or so little of the rest that it is not worth to be told apart; or some.
    Certainty missing(const Interval& u, const Interval& v) const;

  private:
    /// Enclosures of the Taylor coefficients of a channel, in the order of Jet.
    using Hull = std::array<Interval, 6>;
    /// Columns and rows of cells, or of boxes of them, from the first to the last.
    struct Range {
        int x0, y0, x1, y1;
        int columns() const { return x1 - x0 + 1; }
        int rows() const { return y1 - y0 + 1; }
    };
    /// A part of a cell, 0 to 1 either way; at the picture's edges it may reach beyond.
    struct Part {
        double x0, y0, x1, y1;
    };
    /// The hulls of all cells, in boxes of one size.
    struct Level {
        Range boxes;
        std::vector<Hull> hulls;         ///< box by box, channel by channel
        std::vector<Certainty> missing;  ///< box by box: open where some of its cells are

        std::size_t index(int x, int y) const {
            return static_cast<std::size_t>(y) * static_cast<std::size_t>(boxes.columns()) +
                   static_cast<std::size_t>(x);
        }
    };

    /// The weights w of sum_i w_i texel_i: hermite_basis of two texels and the secants there.
    template <class T>
    static std::array<T, 4> weights(const T& s) {
        const std::array<T, 4> h = hermite_basis(s);
        return {h[2] * -0.5, h[0] - h[3] * 0.5, h[1] + h[2] * 0.5, h[3] * 0.5};
    }
    /// The cell that a place is in. There is one more than texels, the first in front of the first middle.
    static int cell_at(double place, int size);
    /// Cell i depends on columns i to i + 3: there are two more on each side than the picture has.
    const float* texel(int column, int row) const { return m_texels.data() + offset(column, row); }
    float* texel(int column, int row) { return m_texels.data() + offset(column, row); }
    std::size_t offset(int column, int row) const {
        return (static_cast<std::size_t>(row) * static_cast<std::size_t>(m_size.width + 4) +
                static_cast<std::size_t>(column)) *
               static_cast<std::size_t>(m_channels);
    }
    void pad(const std::vector<float>& texels);
    void find_missing();
    void build();
    void build_box(const Level* finer, const Range& parts, Level& to) const;
    Certainty missing_cell(int column, int row) const;
    Range cells_of(const Interval& u, const Interval& v) const;
    Part part_of(int column, int row, const Interval& u, const Interval& v) const;
    void add_cell(int column, int row, const Part& part, Hull* hulls) const;
    void add_box(const Level& level, int x, int y, Hull* hulls) const;
    /// The finest level on which a range has few boxes, with the range in these; null for cells themselves.
    const Level* level_of(Range& range) const;

    Size m_size;
    int m_channels;
    std::vector<float> m_texels;
    std::size_t m_missing_texels = 0;
    Point<int> m_first_missing{0, 0};
    std::vector<Certainty> m_missing;  ///< cell by cell, where any is missing
    double m_rounding = 0;             ///< rounding of read() in double
    std::vector<Level> m_levels;
};

/// Texels of one number, averaged by a Gaussian whose standard deviation is `sigma` texels, over those that are numbers.
/// The others stay as they are.
std::vector<float> smoothed(const std::vector<float>& texels, const Size& size, double sigma);

}  // namespace anamorph::surface
