// SPDX-License-Identifier: Apache-2.0
// A picture on a surface in space, seen by a camera (Oka et al. 1987).
//
// The surface is cut into facets (facets.h) whose points are seen at most `tol` pixels from where they belong: a
// distance on the screen, since near a silhouette a step on the screen is any distance on the picture. Each pixel shows
// the nearest facet at its centre; with a filter that averages, those at silhouettes and borders show what is seen at
// kEdgeSamples^2 samples of them.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "anamorph/image/canvas.h"
#include "anamorph/image/picture.h"
#include "anamorph/image/point_sampler.h"
#include "anamorph/parallel_for.h"
#include "anamorph/surface/backdrop.h"
#include "anamorph/surface/edges.h"
#include "anamorph/surface/lighting.h"

namespace anamorph::surface {

/// How the surface is made of facets.
enum class DrapeScheme {
    automatic,  ///< patches as large as the tolerance allows, without cracks
    exact,  ///< as automatic, and each pixel's point is that of the surface itself but for rounding (polish.h)
    oka,    ///< blocks of the picture as parallelograms, nearer ones over farther ones (oka.h)
    oka_z,  ///< as oka, with a depth for each pixel
};

/// The outputs of a drape beside those that every picture can show (Output): the depth ahead of the camera,
/// infinite where nothing is seen; the surface's unit normal on the viewer's side, in space; the number of
/// the patch; the share of the pixel in which anything is seen, by which colours of the same filter are
/// faded; whether anything is seen in its middle.
enum class DrapeOutput { shared, depth, normal, patch, coverage, seen };

/// How a drape is drawn.
struct DrapeOptions {
    DrapeScheme scheme = DrapeScheme::automatic;
    double tol = 0.125;               ///< pixels on the screen; of oka and oka_z, what comes out
    double block = 8, overlap = 0.5;  ///< as in OkaBlocks
    Filter filter = Filter::antialias;
    Wrap wrap = Wrap::clamp;
    Output output = Output::color;
    DrapeOutput own = DrapeOutput::shared;
    DrapeLighting lighting;
    std::vector<float> background;  ///< channel by channel; 0 for channels that it lacks, and 1 for alpha
    int alpha = -1;                 ///< the channel of the picture's alpha, multiplied in or not, or -1
    int backdrop_alpha = -1;        ///< the channel of alpha of the picture behind, or -1
    Size overscan = {};  ///< pixels on either side that the picture behind does not cover but goes on in
    Size back = {};      ///< the size of the picture on the far side; by default that of the other
};

/// A surface's patches, and room to draw in, which views of it share.
struct SharedTree {
    explicit SharedTree(std::shared_ptr<const DrapedSurface> surface) : tree(std::move(surface)) {}
    std::mutex mutex;
    SurfaceTree tree;
    std::shared_ptr<SeenPool> pool = std::make_shared<SeenPool>();
    std::shared_ptr<FacetPool> facet_pool = std::make_shared<FacetPool>();
    std::shared_ptr<RoomPool<OkaRoom>> oka_pool = std::make_shared<RoomPool<OkaRoom>>();
};

/// A surface draped with a picture, ready to draw any box of the screen from any number of threads.
class Drape {
  public:
    /// Drapes a surface. `picture`: its size in pixels. Throws Error where tol is less than the screen's grid
    /// allows, or takes too many patches.
    Drape(std::shared_ptr<SharedTree> surface, const Camera& camera, const Size& picture,
          const DrapeOptions& options);

    /// The largest bound of what the camera sees, or nearly so, in pixels of the screen, and how much is exact.
    Reached reached(const ParallelFor& parallel_for) const;
    double max_error() const { return m_map->max_error(); }
    /// The largest bound of how far the depth that is drawn at a pixel (DrapeOutput::depth), before it is rounded to float, is from
    /// that of the surface at the source point of the pixel: by e_z of facets.h, in units of space. None of the paper's blocks, nor
    /// where pixels have points of their own, whose depth it is.
    std::optional<double> max_depth_error() const;
    /// The number of patches that the camera sees, or nearly so.
    std::size_t patches() const { return m_map->patches(); }

    /// The number of parts of the paper's blocks that may be in view and are not drawn (OkaRaster::left_out); none of others.
    std::optional<int> left_out() const { return m_map->left_out(); }

    /// The number of pixels within the surface that show nothing. None where facets share their edges; of the
    /// paper's blocks, those where facets within kCoverTol show something, also at all eight pixels around,
    /// which takes as long as drawing does. Nothing where the screen has more than kMostCounted pixels or
    /// such facets would be too many.
    std::optional<int> holes(const ParallelFor& parallel_for) const;
    static constexpr double kCoverTol = 0.125;
    static constexpr int kMostCounted = 1 << 24;

    /// Draws the pixels of `box`; sources are read for colour only. `backdrop`: a picture that fills the screen behind the
    /// surface and over the background. `back`: the picture on the surface's far side, with the channels of the other and the size
    /// DrapeOptions::back; seen from there it is the right way round. False when one could not be read.
    bool draw(const Source* source, const Box& box, const ImageView& view, const ParallelFor& parallel_for,
              const Source* backdrop = nullptr, const Source* back = nullptr) const;

  private:
    /// A pixel on the facet that is seen there.
    struct Spot;
    class LitCorners;

    Spot spot(const SeenPixels& pixels, int x, int y) const;
    void weigh(Spot& spot, double x, double y) const;
    /// The layers that the pixels of a picture in colour are made of.
    struct Layers;
    /// Is the far side of the surface seen at a point of the screen?
    bool shows_back(const Facet& facet, double x, double y) const;
    /// Draws the pixels that show the far side again. `picture`: how, whichever side it is.
    bool draw_back(const Picture& picture, const Source& back, const Box& box, const ImageView& view,
                   const ParallelFor& parallel_for) const;
    bool draw_edges(const Layers& layers, const Box& box, const Canvas& canvas,
                    const ParallelFor& parallel_for) const;
    /// Draws edge pixels; one per thread.
    class EdgePainter;
    glm::dvec3 normal(const Spot& spot) const;
    double landing_error(const Spot& spot, int x, int y) const;
    template <class Body>
    void for_edges(const Box& box, const ParallelFor& parallel_for, const Body& body) const;
    bool draw_values(const Box& box, const ImageView& view, const ParallelFor& parallel_for) const;
    void put_values(const Spot& spot, int x, int y, float* to) const;
    void light_pixel(const Spot& spot, float* pixel, int channels, const AlphaChannel& alpha) const;
    bool finish(const PixelRows& rows, const Layers& layers) const;

    std::shared_ptr<SharedTree> m_surface;
    DrapeOptions m_options;
    std::shared_ptr<const DrapeMap> m_map,
        m_back_map;                     ///< the same surface, with the points of either picture
    std::shared_ptr<LitCorners> m_lit;  ///< where corners are lit
    Picture m_picture;
    std::vector<Picture::Map> m_back_maps;
};

}  // namespace anamorph::surface
