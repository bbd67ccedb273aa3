// SPDX-License-Identifier: Apache-2.0
// A draped picture as a pull map: once it is known which facet each pixel of the screen shows, the rest is reading a
// source at points, as any map of blocks does.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "anamorph/once_each.h"
#include "anamorph/plan/block.h"
#include "anamorph/room_pool.h"
#include "anamorph/surface/facet_raster.h"
#include "anamorph/surface/oka.h"

namespace anamorph::surface {

/// A pool of the buffers for the visible pixels of regions, which are reused.
using SeenPool = RoomPool<SeenPixels>;
/// A pool of the buffers for facets.
using FacetPool = RoomPool<FacetRoom>;

/// The visible facets of a region of the screen.
class SeenRegion final : public RegionData {
  public:
    explicit SeenRegion(std::shared_ptr<SeenPool> pool) : m_pool(std::move(pool)), m_pixels(m_pool->take()) {}
    ~SeenRegion() override { m_pool->give_back(std::move(m_pixels)); }
    SeenRegion(const SeenRegion&) = delete;
    SeenRegion& operator=(const SeenRegion&) = delete;

    /// The pixels of the region, and one more on each side where the screen has one.
    SeenPixels& pixels() { return *m_pixels; }
    const SeenPixels& pixels() const { return *m_pixels; }

  private:
    std::shared_ptr<SeenPool> m_pool;
    std::unique_ptr<SeenPixels> m_pixels;
};

/// The pull map from the screen to a picture of `picture` pixels that lies on the surface. Pixels of the screen that show
/// nothing have no source point. A block's bound is a distance on the screen, in pixels.
class DrapeMap final : public BlockMap {
  public:
    /// Makes the map of some facets. Their bounds leave kFloatShare of `tol` to points in float; blocks for which that is too
    /// little have their points in double. With `surface`, which is that of the facets, each pixel has the point of the surface
    /// itself (PointPolish), where that can be found.
    DrapeMap(Facets facets, const Camera& camera, const Size& picture, double tol,
             std::shared_ptr<const DrapedSurface> surface = nullptr);
    /// Makes the map of the facets in `room`, which `facet_pool` gets back. `pool`: buffers that maps share.
    DrapeMap(std::unique_ptr<FacetRoom> room, const Camera& camera, const Size& picture, double tol,
             std::shared_ptr<const DrapedSurface> surface, std::shared_ptr<SeenPool> pool,
             std::shared_ptr<FacetPool> facet_pool);
    /// Makes the map of the paper's blocks (Oka 1987), whose regions have the side kSquare.
    DrapeMap(std::shared_ptr<const OkaRaster> blocks, const Camera& camera, const Size& picture, double tol,
             std::shared_ptr<SeenPool> pool);

    ~DrapeMap() override;
    DrapeMap(const DrapeMap&) = delete;
    DrapeMap& operator=(const DrapeMap&) = delete;

    /// A facet; those of the paper's blocks are made when they are first asked for, and with a facet its corners.
    const Facet& facet(std::size_t index) const;
    const Facet& facet(double seen) const { return facet(static_cast<std::size_t>(seen)); }
    const FacetCorner& corner(std::uint32_t index) const { return m_room->facets.corners[index]; }
    std::size_t corners() const { return m_room->facets.corners.size(); }
    /// As in Facets.
    int grid_bits() const { return m_room->facets.grid_bits; }
    bool inverse_depth() const { return m_room->facets.inverse_depth; }
    /// The number of patches that are drawn: the paper's blocks, or leaves of facets.
    std::size_t patches() const { return m_blocks ? m_blocks->count() : m_room->facets.leaves.size(); }
    /// Of the paper's blocks, parts that may be in view and are not drawn (OkaRaster::left_out).
    std::optional<int> left_out() const {
        return m_blocks ? std::optional(static_cast<int>(m_blocks->left_out())) : std::nullopt;
    }
    /// The facet that a point lies in: one of the two facets of one of the paper's blocks, else `facet` itself.
    const Facet& part_of(const Facet& facet, double u, double v) const;
    const Camera& camera() const { return m_camera; }
    const Size& picture() const { return m_picture; }
    /// The paper's blocks; null where there are none.
    const std::shared_ptr<const OkaRaster>& oka_blocks() const { return m_blocks; }
    /// An upper bound of the bounds of all blocks, in pixels of the screen.
    double max_error(const ParallelFor& parallel_for = serial_for) const;

    /// The largest FacetLeaf::depth_bound; infinite of the paper's blocks.
    double max_depth_error() const { return m_most_depth_bound; }

    /// Has each pixel a point of its own?
    bool exact_points() const { return m_surface != nullptr; }
    /// Finds the bounds of all patches, which bound_at() reads.
    void find_bounds(const ParallelFor& parallel_for) const { bounds(parallel_for); }
    /// The bound of the patch that is seen at a place of SeenPixels.
    double bound_at(const SeenPixels& pixels, std::size_t at) const;
    double nearness_at(const SeenPixels& pixels, std::size_t at) const;

    /// The region of a pixel of the screen.
    std::shared_ptr<const SeenRegion> region_at(int x, int y) const;
    /// Finds what is seen in a box as FacetRaster::draw does. Where each pixel has a point of its own, that decides between
    /// layers of the surface that lie too near each other for facets to tell which is nearer.
    void see(const Box& box, SeenPixels& pixels, int times = 1) const;
    /// The derivative at a point of a facet's plane: pixels of the picture per pixel of the screen.
    Jacobian jacobian_of(const Facet& facet, double x, double y) const;

    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    void computed_row(const Block& block, int row, int begin, int end, float* x,
                      float* y) const noexcept override;

    /// The side of the squares of the screen that are rasterized at once, which fit the caches.
    static constexpr int kSquare = 128;

  protected:
    void plan(const Box& box, int piece, Blocks& blocks) const override;

  private:
    const std::vector<double>& bounds(const ParallelFor& parallel_for = serial_for) const;
    std::size_t leaf_of(double facet) const;
    void order_sheets(const Box& box, SeenPixels& pixels, int times) const;
    void polish(SeenPixels& pixels) const;
    void cut(const SeenRegion& region, const Box& box, Blocks& blocks) const;
    double bound_of(const SeenRegion& region, const Box& box) const;
    /// The ranges of u and v, each from the least to the greatest.
    struct Range {
        double u[2], v[2];
    };
    static Range range_of(const SeenRegion& region, const Box& box);
    bool torn(const SeenRegion& region, const Box& box, const Range& range) const;
    bool fits_float(const SeenRegion& region, const Box& box, const Range& range, Block& block) const;
    template <class Body>
    void for_leaves(const SeenRegion& region, const Box& box, const Body& body) const;

    std::shared_ptr<const OkaRaster> m_blocks;  ///< the paper's blocks, or null
    mutable std::optional<OnceEach> m_made;     ///< facets of the paper's blocks
    std::unique_ptr<FacetRoom> m_room;
    Camera m_camera;
    Size m_picture;
    double m_for_float;
    /// The largest bound of a leaf, and the largest FacetLeaf::by_u and by_v.
    double m_most_bound = 0, m_most_by_u = 0, m_most_by_v = 0;
    double m_most_depth_bound = 0;
    mutable std::once_flag m_bounded;
    mutable std::vector<double> m_bounds;  ///< bounds of the patches, once they are asked for
    std::shared_ptr<const DrapedSurface> m_surface;
    std::optional<FacetRaster> m_raster;  ///< the raster of facets, where there are no blocks
    std::shared_ptr<SeenPool> m_pool;
    std::shared_ptr<FacetPool> m_facet_pool;
};

}  // namespace anamorph::surface
