// SPDX-License-Identifier: Apache-2.0
// A pull map made cheap: the picture cut into blocks, each with a way to find the source points of its pixels
// and a proven bound of their error.
//
// Blocks are anchored to the whole target image: what part of the picture is asked for, in what order and by
// how many threads changes none of them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "anamorph/chart/chart.h"
#include "anamorph/error.h"
#include "anamorph/parallel_for.h"

namespace anamorph {

class MapLink;

/// The data that a map keeps of a region for its computed or bicubic blocks.
struct RegionData {
    virtual ~RegionData() = default;
};

/// A rectangle of target pixels, at most kMaxSide either way (outside blocks: any size), with one way to find
/// their source points.
///
/// For a polynomial block, with s and t in [-1, 1] running over the pixel centres of the block (s right, t
/// down), the source point is base + (x or y)[0] + [1] s + [2] t + [3] s^2 + [4] s t + [5] t^2, in source
/// pixels.
struct Block {
    /// bicubic: the map gives the polynomial (BlockMap::bicubic); x and y hold a quadratic near it.
    /// computed: the map gives the points, row by row, as offsets from the base (BlockMap::computed_row), or in double.
    /// exact: the formula gives the points one by one. outside: no pixel has a source point.
    enum class Kind : std::uint8_t { polynomial, bicubic, computed, exact, outside };
    static constexpr int kMaxSide = 64;

    Box box;
    Kind kind = Kind::exact;
    /// Are exact blocks evaluated in DoubleDouble, bicubic and computed ones in double (BlockMap::exact_rows)?
    bool precise = false;
    int piece = 0;         ///< the piece of the target, which also says the layer (BlockMap)
    int source_piece = 0;  ///< the piece of the source; not set for exact blocks and those outside
    std::int32_t base_x = 0, base_y = 0;
    float x[6] = {}, y[6] = {};
    double bound = 0;  ///< largest distance from the exact source point, proven; source pixels
    /// The data of the region of a computed or bicubic block, if the map keeps any, and the block's record there.
    const RegionData* data = nullptr;
    int record = 0;
};

/// The largest bound, in source pixels, up to which computed blocks in double count as exact.
inline constexpr double kExactError = 1e-9;

/// Does each pixel of a block get its source point in double by the formula, or within kExactError of that?
inline bool is_exact(const Block& block) {
    return block.kind == Block::Kind::exact ||
           (block.kind == Block::Kind::computed && block.precise && block.bound <= kExactError);
}

/// Are a block's source points in double, by BlockMap::exact_rows?
inline bool in_double(const Block& block) {
    return block.kind == Block::Kind::exact || block.precise;
}

/// The source points of a block less its base, evaluated in float by Block-wide loops: the sums of c[j][i]
/// s^i t^j (x) and c[j][4 + i] s^i t^j (y), by Horner's rule for t, then for s.
struct BlockPolynomial {
    int degree = 2;  ///< the highest degree in s and in t: 2 or 3
    float c[4][8] = {};
};

/// The quadratic of a block (Block::x and Block::y) as a BlockPolynomial.
BlockPolynomial quadratic_of(const Block& block);

/// The accuracy of a picture: the largest proven bound in use, in source pixels, and the fraction of pixels evaluated
/// exactly (is_exact).
struct Reached {
    double max_error = 0;
    double exact_fraction = 0;
};

/// The blocks of a region of the picture, and the data that they point to.
struct Blocks : std::vector<Block> {
    std::shared_ptr<const RegionData> data;
};

/// Shared ownership of the blocks of a region, which live as long as this, even when the map no longer keeps them.
/// It is a range, so that `for (const Block& b : map.blocks(region))` keeps them for the whole loop.
class SharedBlocks {
  public:
    /// Shares `blocks`, which is not null.
    explicit SharedBlocks(std::shared_ptr<const Blocks> blocks) : m_blocks(std::move(blocks)) {}

    auto begin() const { return m_blocks->begin(); }
    auto end() const { return m_blocks->end(); }
    std::size_t size() const { return m_blocks->size(); }
    /// Block i, from 0 to size() - 1.
    const Block& operator[](std::size_t i) const { return (*m_blocks)[i]; }

  private:
    std::shared_ptr<const Blocks> m_blocks;
};

/// A buffer for the source points of all pixels of a block, row by row, as offsets from its base.
struct PointRows {
    float *x, *y;
    std::ptrdiff_t stride;  ///< floats from row to row; behind each there is room for 16 more
};

/// A buffer for the source points of rows of pixels in double.
struct DoubleRows {
    double *x, *y;
    std::int32_t* piece;    ///< the piece of the source; -1 where there is no source point
    std::ptrdiff_t stride;  ///< entries from row to row; behind each there is room for 16 more
};

/// The corner of the region, of that side, in which a piece begins: regions stand on multiples of their side where the piece
/// begins before its picture does, else at the piece's own corner.
constexpr int region_corner(int first, int side) {
    return first < 0 ? -((side - 1 - first) / side) * side : first;
}

/// The layout of a map, and how much is kept of it.
struct BlockLayout {
    int layers = 1;
    int region_side = 256;  ///< pixels
    /// The largest number of regions whose plans are kept; when it is reached, all of them are discarded.
    std::size_t kept_regions = 8192;
};

/// A pull map cut into blocks. The target consists of pieces, each cut into square regions from its corner
/// on; the blocks of a region cover it without overlap.
///
/// A map may have several layers, each with a source of its own: every pixel then has a source point in each.
/// Pieces are numbered layer by layer, so that piece n of layer k is number n + k * (the pieces of the target).
/// Blocks come layers() together: the same box and kind, one for each layer, in their order.
class BlockMap {
  public:
    static constexpr int kRegion = BlockLayout{}.region_side;

    /// `pieces`: boxes of a target of width x height pixels. A single one may reach beyond it (overscan): the regions inside are
    /// then the same.
    BlockMap(int width, int height, const std::vector<Box>& pieces, const BlockLayout& layout = {});
    virtual ~BlockMap() = default;

    int width() const { return m_width; }
    int height() const { return m_height; }
    int layers() const { return m_layout.layers; }
    /// The layer that a block belongs to.
    int layer_of(const Block& block) const { return block.piece / static_cast<int>(m_grids.size()); }

    /// Does every pixel of a box belong to a piece?
    bool covers(const Box& box) const;

    /// The piece of the first layer that a target point lies in, its edges included, of two the later one; -1 where there is none.
    int piece_at(double x, double y) const;

    std::int64_t regions() const { return m_regions; }
    /// The pixels of a region.
    Box region_box(std::int64_t region) const { return place_of(region).box; }
    /// The regions that meet a box of the picture.
    std::vector<std::int64_t> regions_in(const Box& box) const;

    /// The blocks of a region: planned when first asked for and kept for a while. Thread safe; several
    /// threads that ask for the same region plan it once.
    SharedBlocks blocks(std::int64_t region) const;

    /// The accuracy reached over the whole picture and all layers; plans every region.
    Reached reached(const ParallelFor& parallel_for) const;

    /// Finds the source point of a target point by the formula in double. False where there is none.
    virtual bool exact(double x, double y, int piece, Point<double>& source_point,
                       int& source_piece) const noexcept = 0;
    /// Does exact() find a source point?
    virtual bool seen(double x, double y, int piece) const noexcept;
    /// Finds the source point as precisely as the map can, as the reference for measuring errors; in double by default.
    virtual bool truth(double x, double y, int piece, Point<DoubleDouble>& source_point,
                       int& source_piece) const noexcept;
    /// Finds the source point of a target point of an exact block, in the block's precision. False where there is none.
    bool exact(const Block& block, double x, double y, Point<double>& source_point,
               int& source_piece) const noexcept;
    /// The source points of rows [begin, end) (0 is the block's first) of a block for which in_double() holds.
    virtual void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept;
    /// The derivative of the map at a target point: source pixels per target pixel.
    virtual Jacobian jacobian(double x, double y, int piece) const noexcept = 0;
    /// Do exact() and jacobian() answer at any point of a pixel, each in little time, and change from point to point as one
    /// formula does?
    virtual bool is_smooth_in_pixels() const noexcept { return false; }
    /// The polynomial of a bicubic block; it gives offsets from the block's base.
    virtual BlockPolynomial bicubic(const Block& block) const noexcept;
    /// Writes the source points of pixels [begin, end) of row `row` (0 is the block's first) of a computed block, less the
    /// block's base. The buffers have room for 16 more floats.
    virtual void computed_row(const Block& block, int row, int begin, int end, float* x,
                              float* y) const noexcept;
    /// Writes the source points of all pixels of computed blocks: those that the layers have in one place, each to
    /// rows of its own.
    virtual void computed(std::span<const Block> layers, const PointRows* to) const noexcept;

    /// The map as a link of a chain of maps (chain/), planned with any other as one; null where it cannot be.
    virtual std::shared_ptr<const MapLink> link() const { return nullptr; }
    /// The reason why link() is null, as it follows "it": "has pairs of points".
    virtual std::string why_unlinked() const { return "has a scheme that does not join"; }

  protected:
    /// Cuts `box`, a region of `piece`, into blocks.
    virtual void plan(const Box& box, int piece, Blocks& blocks) const = 0;

  private:
    struct Place {
        Box box;
        int piece;
    };
    /// Regions of one piece, numbered row by row, from a corner (region_corner()) on.
    struct Grid {
        Box box;
        std::int64_t first;
        int columns;
        int x0, y0;
    };
    struct Cache;

    Place place_of(std::int64_t region) const;

    int m_width, m_height;
    BlockLayout m_layout;
    std::vector<Grid> m_grids;
    std::int64_t m_regions = 0, m_pixels = 0;
    std::shared_ptr<Cache> m_cache;
};

}  // namespace anamorph
