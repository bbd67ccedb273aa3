// SPDX-License-Identifier: Apache-2.0
// The locally linear approximation of Oka et al. 1987: the picture in square blocks, each drawn as a parallelogram.
#pragma once

#include <memory>
#include <vector>

#include "anamorph/parallel_for.h"
#include "anamorph/room_pool.h"
#include "anamorph/surface/facet_raster.h"
#include "anamorph/surface/facets.h"
#include "anamorph/surface/parallelogram_rows.h"

namespace anamorph::surface {

/// How a picture is cut into blocks.
struct OkaBlocks {
    double side = 8;       ///< d, pixels of the picture; either way at most all of them
    double overlap = 0.5;  ///< width of the common area of two neighbours, pixels of the picture
    /// Depth within a block: false, that of its centre, so that nearer blocks are drawn over farther ones (section 3); true,
    /// linear (section 5).
    bool linear_depth = false;
};

/// A block of the picture and its linear map: x, y (pixels from the middle of the screen) and depth of its centre, and what
/// they gain by u and by v.
struct OkaBlock {
    double u, v;            ///< its centre
    double u0, u1, v0, v1;  ///< its rectangle and its share of the common area, within the picture
    glm::dvec3 centre, by_u, by_v;
    glm::dvec3 left, right, above,
        below;  ///< the centres of its neighbours, by which by_u and by_v are found
};

/// Blocks across and down a picture. Throws Error where there are more than four million.
Size oka_block_count(const Size& picture, const OkaBlocks& blocks);
/// Block (i, j), or (i, j) of the blocks that are halved `level` times. False where its centre or that of a neighbour is not in
/// front of the camera.
bool oka_block(const DrapedSurface& surface, const Camera& camera, const Size& picture,
               const OkaBlocks& blocks, int i, int j, OkaBlock& block, int level = 0);
/// May block (i, j) be seen where no linear map of it shows it: is one of its five points behind the camera, or less than half as
/// far ahead as another one, while intervals cannot tell that all of it is out of view?
bool oka_block_is_cut(const DrapedSurface& surface, const Camera& camera, const Size& picture,
                      const OkaBlocks& blocks, int i, int j, int level = 0);

/// The buffers of the blocks that a camera sees, reused for other views.
struct OkaRoom {
    /// Columns and rows of squares of the screen, from the first to the last.
    struct Squares {
        std::uint16_t x0, y0, x1, y1;
    };

    std::vector<simd::Parallelogram> blocks;
    std::vector<Squares> squares;  ///< squares of the blocks and the pixels around them
    std::vector<std::uint32_t> keys, order, sorted, lists;
    std::vector<std::size_t> first;
    std::vector<double> columns, rows;
    std::vector<glm::dvec3> seen;
    std::vector<std::int32_t> behind;  ///< columns of a row's blocks of which a part may be behind the camera
};

/// The blocks that are on the screen as parallelograms: each block's linear map (2.8), whose matrix comes from central
/// differences (2.4 to 2.7) over the block's side, on the block and half of the common area around it. They are drawn from
/// the farthest to the nearest, those as far as each other in their order in the picture, or each with its depths.
/// Neighbours need not meet. Blocks of which a part is behind the camera (oka_block_is_cut) have no linear map, or one that is not
/// on the screen: they are halved, as often as kMostHalvings, until their parts have one. left_out() counts parts that do not. Blocks
/// whose parallelogram is a line but for rounding are left out.
class OkaRaster {
  public:
    /// `square`: side of the squares that draw() finds blocks by. `pool`: room that other views may leave and use. Throws
    /// Error where there are more than four million blocks.
    OkaRaster(std::shared_ptr<const DrapedSurface> surface, const Camera& camera, const Size& picture,
              const OkaBlocks& blocks, int square, std::shared_ptr<RoomPool<OkaRoom>> pool);
    ~OkaRaster();
    OkaRaster(const OkaRaster&) = delete;
    OkaRaster& operator=(const OkaRaster&) = delete;

    /// Finds what is seen in a box, as FacetRaster::draw does. A pixel's facet is the first of its block's (make_facets());
    /// nearness is that of linear depth, and empty without.
    void draw(const Box& box, SeenPixels& seen, int times = 1) const;

    std::size_t count() const { return m_room->blocks.size(); }
    /// The number of parts of blocks that may be in view and are not drawn, as a part of them is behind the camera.
    std::size_t left_out() const { return m_left_out; }
    static constexpr int kMostHalvings = 10;
    /// The most parts that are looked at.
    static constexpr std::size_t kMostParts = std::size_t{1} << 20;
    /// The nearness of a block's centre.
    double nearness(std::size_t block) const { return -m_room->blocks[block].z; }
    /// The most pixels on the screen per unit of u; most_by_v() is the same per unit of v.
    double most_by_u() const { return m_most_by_u; }
    double most_by_v() const { return m_most_by_v; }
    /// Room for facets of all blocks, none of them made.
    Facets empty_facets() const;
    /// Makes the corners, the two facets and the leaf of a block, at their places in the order of blocks; leaves have no bound. Corners
    /// are not rounded to a grid.
    void make_facets(std::size_t block, Facets& to) const;
    /// The largest distance, in pixels, of a drawn point of a block from where it is seen. By Taylor's formula (2.9) about the
    /// block's centre, axis by axis, of g, the map to the screen, and the linear map a that is drawn, whatever it is made of,
    ///     |g - a0 + (g_u - a1) s + (g_v - a2) t + g_uu s^2 / 2 + g_uv s t + g_vv t^2 / 2|
    /// with g, g_u and g_v at the centre and, for (s, t) in each sixteenth of each quarter of the block, a mean of the second
    /// derivatives over the quarters of that quarter that the way there from the centre passes, part by part of the way.
    /// Infinite where that is not known, and where a part of the block is missing.
    double bound_of(std::size_t block) const;
    /// The largest bound of all blocks. It is computed only for blocks of which a quick bound does not say that another
    /// block's is larger.
    double most_bound(const ParallelFor& parallel_for) const;

  private:
    double quick_bound_of(std::size_t block) const;
    double lost_by(const OkaBlock& block, const simd::ParallelogramGrid& grid) const;
    void find_blocks();
    void find_row(int row, const glm::dvec3* above, const glm::dvec3* here, const glm::dvec3* below);
    bool add(const glm::dvec3& centre, const glm::dvec3& by_u, const glm::dvec3& by_v, int column, int row,
             int level);
    void add_parts_of_row(int row, int first, int end);
    void add_parts(int column, int row, int level);
    void sort_by_depth();
    OkaRoom::Squares squares_of(const Box& pixels) const;
    void list_squares();
    OkaBlock block_of(const simd::Parallelogram& p) const;

    std::shared_ptr<const DrapedSurface> m_surface;
    Camera m_camera;
    Size m_picture, m_count;
    OkaBlocks m_blocks;
    simd::ParallelogramGrid m_grid;
    int m_square, m_columns;
    double m_most_by_u = 0, m_most_by_v = 0;
    std::size_t m_left_out = 0, m_parts = 0;
    std::shared_ptr<RoomPool<OkaRoom>> m_pool;
    std::unique_ptr<OkaRoom> m_room;
};

}  // namespace anamorph::surface
