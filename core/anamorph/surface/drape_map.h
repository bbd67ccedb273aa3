// SPDX-License-Identifier: Apache-2.0
// A draped picture as a pull map: once it is known which facet each pixel of the screen shows, the rest is reading a
// source at points, as any map of blocks does.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "anamorph/plan/block.h"
#include "anamorph/room_pool.h"
#include "anamorph/surface/facet_raster.h"
#include "anamorph/surface/oka.h"

namespace anamorph::surface {

/// Room for what is seen in regions, used again for others.
using SeenPool = RoomPool<SeenPixels>;
/// Room for facets.
using FacetPool = RoomPool<FacetRoom>;

/// What is seen in a region.
class SeenRegion final : public RegionData {
  public:
    explicit SeenRegion(std::shared_ptr<SeenPool> pool) : m_pool(std::move(pool)), m_pixels(m_pool->take()) {}
    ~SeenRegion() override { m_pool->give_back(std::move(m_pixels)); }
    SeenRegion(const SeenRegion&) = delete;
    SeenRegion& operator=(const SeenRegion&) = delete;

    /// Of the region, and one pixel more on each side that has one.
    SeenPixels& pixels() { return *m_pixels; }
    const SeenPixels& pixels() const { return *m_pixels; }

  private:
    std::shared_ptr<SeenPool> m_pool;
    std::unique_ptr<SeenPixels> m_pixels;
};

/// Points in pixels of a picture of `picture` pixels that lies on the surface. Pixels of the screen where nothing is
/// seen have none. A block's bound is a distance on the screen, in pixels.
class DrapeMap final : public BlockMap {
  public:
    /// Bounds of facets leave kFloatShare of `tol` to points in float; blocks for which that is too little have theirs in
    /// double. With `surface`, that of the facets, each pixel's point is that of the surface itself (PointPolish), where
    /// that can be told. `pool`: room that other maps may leave and use.
    DrapeMap(Facets facets, const Camera& camera, const Size& picture, double tol,
             std::shared_ptr<const DrapedSurface> surface = nullptr);
    /// Of the room's facets; `facet_pool` gets it back.
    DrapeMap(std::unique_ptr<FacetRoom> room, const Camera& camera, const Size& picture, double tol,
             std::shared_ptr<const DrapedSurface> surface, std::shared_ptr<SeenPool> pool,
             std::shared_ptr<FacetPool> facet_pool);
    /// Of the paper's blocks. Their squares have the side kSquare.
    DrapeMap(std::shared_ptr<const OkaRaster> blocks, const Camera& camera, const Size& picture, double tol,
             std::shared_ptr<SeenPool> pool);

    ~DrapeMap() override;
    DrapeMap(const DrapeMap&) = delete;
    DrapeMap& operator=(const DrapeMap&) = delete;

    /// Of the paper's blocks, made when they are asked for first.
    const Facets& facets() const;
    /// Patches that are drawn: leaves of facets().
    std::size_t patches() const { return m_blocks ? m_blocks->count() : m_room->facets.leaves.size(); }
    /// Of the two facets of one of the paper's blocks, the one that a point lies in; of others, the facet itself.
    const Facet& part_of(const Facet& facet, double u, double v) const;
    const Camera& camera() const { return m_camera; }
    const Size& picture() const { return m_picture; }
    /// No block's bound is larger.
    double max_error(const ParallelFor& parallel_for = serial_for) const;

    /// Has each pixel a point of its own?
    bool exact_points() const { return m_surface != nullptr; }
    /// Of all patches, for bound_at().
    void find_bounds(const ParallelFor& parallel_for) const { bounds(parallel_for); }
    /// The bound of what is seen at a place of SeenPixels.
    double bound_at(const SeenPixels& pixels, std::size_t at) const;
    double nearness_at(const SeenPixels& pixels, std::size_t at) const;

    /// What is seen about a pixel of the screen.
    std::shared_ptr<const SeenRegion> region_at(int x, int y) const;
    /// What is seen in a box as FacetRaster::draw says, and, where each pixel has a point of its own, of sheets that lie too
    /// near each other for facets to tell, the one whose own point is nearer.
    void see(const Box& box, SeenPixels& pixels, int times = 1) const;
    /// Pixels of the picture per pixel of the screen, at a point of a facet's plane.
    Jacobian jacobian_of(const Facet& facet, double x, double y) const;

    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    void computed_row(const Block& block, int row, int begin, int end, float* x,
                      float* y) const noexcept override;

    /// Side of the squares of the screen that are seen at once, which caches hold meanwhile.
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
    /// From the least to the greatest u and v.
    struct Range {
        double u[2], v[2];
    };
    static Range range_of(const SeenRegion& region, const Box& box);
    bool torn(const SeenRegion& region, const Box& box, const Range& range) const;
    bool fits_float(const SeenRegion& region, const Box& box, const Range& range, Block& block) const;
    template <class Body>
    void for_leaves(const SeenRegion& region, const Box& box, const Body& body) const;

    std::shared_ptr<const OkaRaster> m_blocks;  ///< or null
    mutable std::once_flag m_made;
    std::unique_ptr<FacetRoom> m_room;
    Camera m_camera;
    Size m_picture;
    double m_for_float;
    /// Of leaves: their bounds, and FacetLeaf::by_u and by_v.
    double m_most_bound = 0, m_most_by_u = 0, m_most_by_v = 0;
    mutable std::once_flag m_bounded;
    mutable std::vector<double> m_bounds;  ///< of leaves, when they are asked for
    std::shared_ptr<const DrapedSurface> m_surface;
    std::optional<FacetRaster> m_raster;  ///< where there are no blocks
    std::shared_ptr<SeenPool> m_pool;
    std::shared_ptr<FacetPool> m_facet_pool;
};

}  // namespace anamorph::surface
