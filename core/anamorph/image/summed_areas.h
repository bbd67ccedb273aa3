// SPDX-License-Identifier: Apache-2.0
// Means over rectangles of a source, whatever their size, of all texels of a level (Crow 1984).
//
// A table holds, for each texel, the sum of all texels above and to the left of it; that over a rectangle of whole texels
// is S(x1, y1) - S(x0, y1) - S(x1, y0) + S(x0, y0). Each tile of kTile texels either way has a table of its own, which is made when it
// is first asked for, and not kept where many others were asked for since: a rectangle is the sum of its parts in tiles. Sums are
// integers: in a tile uint8 and uint16 lose nothing, with alpha or without, and take 32 bits but for uint16 with alpha; half and float are rounded to a
// unit, a power of two that is at most 2^-60 of the sum of all magnitudes of the channel in the tile.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/image/border.h"
#include "anamorph/image/source.h"

namespace anamorph {

/// The tables of a level of a source. Thread safe; the same bits for any order of reading.
class SummedAreas {
  public:
    static constexpr int kTile = 128;
    /// Tables that are kept take no more than this, or one for each thread that reads. Bytes.
    static constexpr std::size_t kMostBytes = std::size_t{64} << 20;

    /// Keeps a reference to the source, of which nothing is read yet. Throws std::bad_alloc.
    explicit SummedAreas(const Source& source, int level = 0);
    ~SummedAreas();
    SummedAreas(const SummedAreas&) = delete;
    SummedAreas& operator=(const SummedAreas&) = delete;

    /// The bytes that tables take now.
    std::size_t bytes() const noexcept { return m_bytes.load(std::memory_order_relaxed); }

    /// Writes the mean over the rectangle of width x height texels of the level about (x, y), in which texels are squares
    /// of one color, to `pixel`: as many floats as channels, multiplied by alpha as PointSampler::sample
    /// says. Sides below 1, or that are no number, are 1, so that the smallest rectangle interpolates
    /// bilinearly. Beyond the edges as `wrap`, where automatic is black; beside black, texels beyond the edges of
    /// the source's picture stand for themselves, and other borders do without them. A texel that is no number
    /// makes no number of its channel's means over it, and an infinite one infinite ones, unless less than
    /// kSameTexel (weightless.h) of its side is covered; where (x, y) is no number, means are 0. False where the source cannot
    /// be read, or there is no memory; means are 0 then.
    bool mean(double x, double y, double width, double height, Wrap wrap, float* pixel) const noexcept;

    /// Writes the mean over a rectangle of a picture in latitudes and longitudes, all around: left and right
    /// it repeats itself, and beyond its upper and lower edges, the poles, it goes on half a turn farther.
    /// Sides above those of the picture count as these. Returns as mean() does.
    bool mean_over_poles(double x, double y, double width, double height, float* pixel) const noexcept;

  private:
    struct Tile;
    struct Slot;
    struct Part;
    struct Sums;

    /// The table of tile (column, row), made if need be; null where it cannot be.
    std::shared_ptr<const Tile> tile(int column, int row) const noexcept;
    std::shared_ptr<const Tile> make_tile(int column, int row) const;
    void forget_some() const noexcept;
    void clear(float* pixel) const noexcept;
    bool mean_of(std::span<const Part> parts, double area, float* pixel) const noexcept;
    bool add(const Part& part, double weight_x, double weight_y, const Box& texels,
             std::span<Sums> sums) const noexcept;

    const Source& m_source;
    int m_level;
    Size m_size;
    Box m_extent;                  ///< the texels that the tables have
    std::vector<double> m_scales;  ///< units of the values, channel by channel
    int m_columns, m_rows;         ///< of tiles
    std::unique_ptr<Slot[]> m_slots;
    static constexpr std::size_t kLocks = 64;
    mutable std::array<std::mutex, kLocks> m_locks;  ///< of the slots, by their numbers
    mutable std::mutex m_forgetting;
    mutable std::size_t m_hand = 0;  ///< the slot that is next to be forgotten
    mutable std::atomic<std::size_t> m_bytes{0};
};

/// Means over rectangles of a source by the tables of one of its levels. Each thread needs its own. Keeps a reference to the source.
///
/// The level is the coarsest on which the shorter side of a rectangle is kLeastTexels long, else level 0. Texels of it that the rectangle covers
/// in part count by that part. Where levels are means of finer ones, as Pyramid's are, the mean of the whole texel stands for that of a share
/// s, from which it is off by at most 1 - s of the texel's range: the sum is by s (1 - s) <= 1/4 of it. In a rectangle of m x n texels each
/// whole row and each whole column has two of these, together 1/2. At a corner, of shares s and t of its row and its column, x = s t gives
/// x (1 - x) <= sqrt(x) / 2 <= (s + t) / 4. The shares of all corners are those by which m and n are more than what is whole, so that
/// all together are at most (m + n) / 2, and the mean is off by at most (1/m + 1/n) / 2 <= 1/kLeastTexels of the range of what texels at the
/// edge average, beside the rounding of the level's texels. A texel that is no number, or infinite, is so for all of a level's texel.
class SummedLevels {
  public:
    static constexpr int kLeastTexels = 32;

    explicit SummedLevels(const Source& source);

    /// SummedAreas::mean, all in texels of level 0. False also where the source keeps no tables.
    bool mean(double x, double y, double width, double height, Wrap wrap, float* pixel);
    /// SummedAreas::mean_over_poles, all in texels of level 0. False also where the source keeps no tables.
    bool mean_over_poles(double x, double y, double width, double height, float* pixel);

  private:
    /// A level, so many texels of which are one of level 0.
    struct Level {
        double scale_x, scale_y;
        const SummedAreas* sums;  ///< null before it is asked for
    };
    const Level& level_for(double width, double height);

    const Source& m_source;
    std::vector<Level> m_levels;
};

}  // namespace anamorph
