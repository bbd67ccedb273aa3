// SPDX-License-Identifier: Apache-2.0
// The filtered pixels of a block: its source points, the level and taps that serve them, the window of texels
// they read, and the loops over its rows.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "anamorph/image/apart_reader.h"
#include "anamorph/image/canvas.h"
#include "anamorph/image/footprint.h"
#include "anamorph/image/own_taps.h"
#include "anamorph/image/point_sampler.h"
#include "anamorph/image/split_points.h"
#include "anamorph/image/window.h"
#include "anamorph/plan/block.h"
#include "anamorph/plan/partial_pixels.h"

namespace anamorph {

/// Source points of all pixels of a block, row by row.
template <class Real>
struct PixelPoints {
    const Real *x = nullptr, *y = nullptr;
    std::ptrdiff_t row_stride = 0;  ///< entries; behind every row at least 16 more may be read
};
/// The points of a block as offsets from its base, in source pixels.
using BlockPoints = PixelPoints<float>;

/// Buffers for the points of the blocks that the layers of a map have in one place.
class BlockPlanes {
  public:
    explicit BlockPlanes(std::size_t layers);

    const PointRows* rows() const { return m_rows.data(); }
    BlockPoints points(std::size_t layer) const {
        const PointRows& r = m_rows[layer];
        return {r.x, r.y, r.stride};
    }

  private:
    std::unique_ptr<float[]> m_values;
    std::vector<PointRows> m_rows;
};

/// The largest distance, in a coarse level's texels and along each axis, of the point sampled there from the one that
/// a block's bound holds for: in units of 2^-24, 1/2 for the place of the polynomial's origin past a whole
/// texel of the level, 3 for the additions it goes through (two of Horner's rule, one of the sampler), and 1
/// of kSamplerRounding; points from a table or in double lose less. The next power of two.
inline constexpr double kLevelRounding = 0x1p-21;

/// The source points of a block's pixels in double.
class PointsInDouble {
  public:
    /// Reads rows [begin, end), counted from its first, of a block for which in_double() holds.
    void read(const BlockMap& map, const Block& block, int begin, int end);
    /// Reads all of a computed block from its points in float.
    void take(const Block& block, const BlockPoints& from);

    /// The points that were read, from their first row on.
    PixelPoints<double> points() const { return {m_x.data(), m_y.data(), m_stride}; }
    /// The pieces of the source for the k-th of those rows; -1 where there is no source point.
    const std::int32_t* piece(int k) const { return m_piece.data() + k * m_stride; }
    Point<double> at(int i, int k) const {
        const std::ptrdiff_t n = k * m_stride + i;
        return {m_x.data()[n], m_y.data()[n]};
    }

  private:
    void make_room(int width, int rows);

    std::ptrdiff_t m_stride = 0;
    std::vector<double> m_x, m_y;
    std::vector<std::int32_t> m_piece;
};

/// Writes the offsets from the base of a polynomial, bicubic or computed block for row j of `part` of it; x and y have
/// room for simd::kRowRoom floats. Nothing is written for other kinds, nor for points in double.
void block_row(const BlockMap& map, const Block& block, const Box& part, int j, float* x, float* y);

/// Reads one source through one map; one per thread. The bits of a pixel depend on its block and the source,
/// not on the part of the block that is asked for.
///
/// Where it reads. On the source itself the point sampled is within the block's bound of the exact one; that
/// of an exact pixel, or of another in double, is within 2^-23 texels of the point in double (its rest past
/// a whole texel is rounded, and kSamplerRounding). On a coarser level of a pyramid kLevelRounding of that level's texels are added:
/// what is left of a point past a whole texel is a float there too.
///
/// What it averages. An antialiased pixel takes a footprint whose axes are the map's own, its steps from
/// pixel to pixel, to within a quarter of their lengths or half a source pixel: by blocks where one serves
/// all of their pixels, else by parts of them, down to single pixels; where maps are not smooth in pixels these take footprints
/// of their own, exactly, as long as they are small (image/own_taps.h). Where a pixel's own footprints differ by more than
/// that it is drawn in parts (BlockMap::is_smooth_in_pixels).
class BlockReader {
  public:
    /// The arguments outlive the reader.
    BlockReader(const BlockMap& map, const Source& source, const Border& border, Filter filter);

    /// Receives `count` pixels from (x, y) on, channel by channel; `one` is the value that stands for 1.
    using Row = std::function<void(int x, int y, int count, const float* values, float one)>;

    /// Gives the pixels of `part` of a block to `row`, row by row; those without a source point are 0. False when the source
    /// could not be read.
    bool rows(const Block& block, const Box& part, const Row& row);
    /// Gives the pixels of `part` of a computed block to `row`, row by row, from its points, which are known
    /// already.
    bool rows(const Block& block, const BlockPoints& points, const Box& part, const Row& row);

    /// Draws `part` of a block. Unless one point is read, pixels that are partial (plan/partial_pixels.h) have as much of their
    /// parts' mean as these fill.
    bool draw(const Block& block, const Box& part, const Canvas& canvas);

  private:
    /// The level and taps that all pixels of a cell share.
    struct Filtering {
        int level = 0;
        double scale_x = 1, scale_y = 1;  ///< level texels per source pixel
        simd::Kernel kernel = simd::Kernel::bilinear;
        int tap_count = 1;
        std::array<simd::Tap, simd::kMaxTaps> taps{};
        double reach_x = 0, reach_y = 0;  ///< reach of the taps, level texels
        bool own = false;                 ///< has each pixel taps of its own (m_own)?
    };
    using Range = simd::Ends;
    /// Points as whole texels and rests.
    struct SplitBlock {
        std::int32_t *whole_x, *whole_y;
        float *x, *y;
        std::ptrdiff_t stride;

        simd::Polynomials points(const Block& block) const {
            return {nullptr, 0, block.box.width(), block.box.height(), x, y, stride, whole_x, whole_y};
        }
    };
    struct LevelPolynomial;
    struct LevelPoints;
    struct Span;
    enum class Got { window, too_large, failed };

    bool draw_whole(const Block& block, const Box& part, const Row& row, const Canvas& canvas);
    bool draw_partial(const Block& block, const Box& part, const Row& row);
    Got draw_polynomial(const Block& block, const Box& part, const Canvas& canvas);
    template <class Real>
    bool filtering_of(const Block& block, const PixelPoints<Real>& points, Filtering& f) const;
    Got draw_points(const Block& block, const BlockPoints& points, const Box& part, const Canvas& canvas);
    Got draw_in_double(const Block& block, const Box& part, const Canvas& canvas);
    Got draw_scattered(const Filtering& f, const Block& block, const Range& y, const Box& part,
                       const Canvas& canvas);
    bool draw_pixels(const Block& block, const std::vector<Point<int>>& pixels, const Canvas& canvas);
    SplitBlock split(const Block& block, const Box& part, double scale_x, double scale_y,
                     const Point<std::int32_t>& base);
    static void draw_window(const Filtering& f, const Block& block, const simd::Polynomials& polynomials,
                            const Point<std::int32_t>& base, const Window& window, const Box& part,
                            const Canvas& canvas);

    bool polynomial_rows(const Block& block, const Box& part, const Row& row);
    bool rows_in_double(const Block& block, const Box& part, const Row& row);
    bool rows_one_by_one(const Block& block, const BlockPoints& points, const Box& part, const Row& row);
    bool rows_apart(const Block& block, const BlockPoints& points, const Box& part, const Row& row);
    void take_apart(const Block& block, const BlockPoints& points, int i, int j, int k,
                    ApartReader::Row& to) const;
    template <class At>
    bool lie_apart(const At& at, const Block& block) const;
    int parts_at(int i, int j, int target_piece, Jacobian& middle);
    const Jacobian& derivative_at(int x, int y, int target_piece);
    bool sample_point(int i, int j, int target_piece, const Point<double>& p, int piece, float* pixel);
    bool sample_parts(int i, int j, int target_piece, int n, float* pixel);
    void sample(const simd::Texels& texels, const simd::Offsets& offsets, PixelType type, int x, int y,
                const Row& row);
    void finish(int x, int y, int count, float one, const Row& row);

    template <class At, class Body>
    bool for_each_footprint(const Block& block, const At& at, const Box& part, const Row& row,
                            const Body& body);
    template <class Body>
    bool pixels_of_cell(const Block& block, const Box& cell, const Box& part, const Row& row,
                        const Body& body);
    bool own_rows(const Block& block, const BlockPoints& points, const Box& part, const Row& row);
    void find_own(const Block& block, const BlockPoints& points);
    simd::OwnKind kind_of_cell(const Box& cell) const;
    Filtering own_filtering(simd::OwnKind kind) const;
    static bool ranges_of(const Block& block, const BlockPoints& points, const Box& cell, Range& x, Range& y);
    bool points_cell(const Filtering& f, const Block& block, const BlockPoints& points, const Box& cell,
                     const Box& part, const Row& row);
    bool ranges_in_double(const Box& cell, Range& x, Range& y) const;
    void read_in_double(const Block& block);
    bool lie_together(const Box& cell) const;
    bool exact_cell(const Filtering& f, const Block& block, const Box& cell, const Box& part, const Row& row);
    template <class RowPoints, class RowTaps>
    Got split_rows(const Filtering& f, int piece, const RowPoints& points, const RowTaps& taps,
                   const LevelPoints& x, const LevelPoints& y, const Box& cell, const Box& own,
                   const Row& row);

    bool shares_filter(const BlockPolynomial& polynomial, const Block& block) const;
    BlockPoints points_of(const Block& block);
    Filtering filtering(const Jacobian& jacobian) const;
    Got polynomial_window(const Filtering& f, const Block& block, const LevelPolynomial& polynomial,
                          Window& window);
    Got window_of(const Filtering& f, int piece, std::int32_t base_x, const Range& range_x,
                  std::int32_t base_y, const Range& range_y, const Box& block, Window& window);
    static simd::Texels texels_of(const Filtering& f, const Window& window, std::int32_t base_x,
                                  std::int32_t base_y, double pixels);

    const BlockMap& m_map;
    const Source& m_source;
    const Border& m_border;
    Filter m_filter;
    WindowReader m_reader;
    PointSampler m_points;
    ApartReader m_apart;
    ApartReader::Row m_apart_rows[2];
    FootprintChooser m_chooser;
    std::vector<float> m_values;
    struct Corner {
        int x = 0, y = 0, piece = -1;
        Jacobian derivative;
    };
    std::array<Corner, 64> m_corners;  ///< derivatives at pixels' corners, the last ones asked for
    std::vector<float> m_part;         ///< a part of a pixel
    std::vector<double> m_parts;
    std::optional<BlockPlanes> m_planes;
    PointsInDouble m_exact;              ///< points of the block that is being read
    std::vector<std::int32_t> m_texels;  ///< the texels that points fall into; m_rests has the rests
    std::vector<float> m_rests;
    std::vector<Point<int>> m_over_edge;
    std::vector<float> m_own_taps;
    std::vector<std::int32_t> m_own_counts;
    simd::OwnTapRows m_own{};        ///< taps of the block's pixels, counted from its corner
    simd::OwnReach m_own_reach;      ///< of all of them
    const PartialPixels* m_partial;  ///< of the map, or null
    std::vector<PartialPixel> m_partial_pixels;
};

}  // namespace anamorph
