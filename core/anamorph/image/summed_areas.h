// SPDX-License-Identifier: Apache-2.0
// Means over rectangles of a source in a time that does not depend on their size (Crow 1984).
//
// A table holds, for each texel, the sum of all texels above and to the left of it; that over a rectangle of whole texels
// is S(x1, y1) - S(x0, y1) - S(x1, y0) + S(x0, y0). Sums are integers, in units of a power of two such that no sum of a
// channel reaches 2^62: differences are exact however many texels lie before them. uint8 and uint16 lose nothing, with
// alpha or without; half and float are rounded to the unit, at most 2^-60 of the sum of all magnitudes of the channel.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/image/border.h"
#include "anamorph/image/source.h"

namespace anamorph {

/// The table of a source's level 0. Thread safe once it is made.
class SummedAreas {
  public:
    /// Reads all of the source, twice. Throws std::bad_alloc, and Error where it cannot be read.
    explicit SummedAreas(const Source& source);

    /// Writes the mean over the rectangle of width x height texels about (x, y), in which texels are squares
    /// of one color, to `pixel`: as many floats as channels, multiplied by alpha as PointSampler::sample
    /// says. Sides below 1, or that are no number, are 1, so that the smallest rectangle interpolates
    /// bilinearly. Beyond the edges as `wrap`, where automatic is black; beside black, texels beyond the edges of
    /// the source's picture stand for themselves, and other borders do without them. A texel that is no number
    /// makes no number of its channel's means over it, and an infinite one infinite ones, unless less than
    /// kSameTexel (weightless.h) of its side is covered; where (x, y) is no number, means are 0.
    void mean(double x, double y, double width, double height, Wrap wrap, float* pixel) const noexcept;

    /// Writes the mean over a rectangle of a picture in latitudes and longitudes, all around: left and right
    /// it repeats itself, and beyond its upper and lower edges, the poles, it goes on half a turn farther.
    /// Sides above those of the picture count as these.
    void mean_over_poles(double x, double y, double width, double height, float* pixel) const noexcept;

  private:
    class Texels;
    struct Part;

    /// The number of a corner of the table's texels, counted from its own.
    std::size_t at(int x, int y) const {
        return (static_cast<std::size_t>(y) * (static_cast<std::size_t>(m_extent.width()) + 1) +
                static_cast<std::size_t>(x)) *
               m_units.size();
    }
    void choose_units(Texels& texels);
    void add_up(Texels& texels);
    void clear(float* pixel) const noexcept;
    void mean_of(std::span<const Part> parts, double area, float* pixel) const noexcept;

    Size m_size;
    Box m_extent;                       ///< the texels that the table has
    std::vector<double> m_units;        ///< units of the sums, channel by channel
    std::vector<double> m_scales;       ///< units of the values, channel by channel
    std::vector<std::uint64_t> m_sums;  ///< modulo 2^64
    /// Counts of texels that are no numbers, +infinite and -infinite; each empty where none is.
    std::array<std::vector<std::uint64_t>, 3> m_special;
};

}  // namespace anamorph
