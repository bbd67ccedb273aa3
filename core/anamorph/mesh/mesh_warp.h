// SPDX-License-Identifier: Apache-2.0
// Mesh warps: a picture drawn through a control mesh, or through pairs of points, to a proven tolerance; any
// part of it at a time (Kim 2003, chapter 5).
#pragma once

#include <memory>

#include "anamorph/image/picture.h"
#include "anamorph/mesh/mesh_data.h"
#include "anamorph/parallel_for.h"
#include "anamorph/plan/scheme.h"

namespace anamorph {

/// How a warp is drawn.
struct MeshWarpOptions {
    WarpScheme scheme = WarpScheme::automatic;
    double tol = 0.01;  ///< source pixels; 0: every pixel in double, whose rounding is the bound
    Filter filter = Filter::antialias;
    Wrap wrap = Wrap::automatic;  ///< automatic is black
    Output output = Output::color;
    /// In place of `output`: 0 where the map is one to one, else for a map that pulls 1 where it shows the
    /// source turned over (its Jacobian's determinant has the other sign than that of most of the mesh), and
    /// for a mesh that pushes the number of further source points that land on the pixel.
    bool folds = false;
    double amount = 1;  ///< blends vertices from the identity (0) to the warp (1) and beyond; finite
};

/// One warp, ready to draw any box of the picture in any order from any number of threads: the bits of a
/// pixel depend on nothing but the map, the options, the sizes and the source.
///
/// The identity maps the source image onto the whole target image. Where several source points land on a
/// pixel (a mesh that pushes, folded), those come first where the mesh is not turned over, of these the one
/// in the cell with the largest number, row by row; where none lands, the picture is black. Where a pixel
/// lies so near a fold's edge that double does not tell two source points apart, the fold counts as one, and
/// the bound spans them. Between the outermost lines of a mesh and the edges of the image it lies in, and
/// beyond given points, the map goes on (mesh_data.h, scattered.h).
class MeshWarp {
  public:
    /// Throws Error: a vertex that is not a number, a tolerance below 0, an amount that is not finite, sizes
    /// that do not fit.
    MeshWarp(const WarpMap& map, int source_width, int source_height, int width, int height,
             const MeshWarpOptions& options);
    ~MeshWarp();
    MeshWarp(MeshWarp&&) noexcept;
    MeshWarp& operator=(MeshWarp&&) noexcept;

    int width() const;
    int height() const;
    const MeshWarpOptions& options() const;
    /// The source point of every pixel, in blocks.
    const BlockMap& blocks() const;
    const Picture& picture() const;

    /// Channels of the picture: the source's for colour, 2 for stmap, else 1.
    int channels(const Source& source) const;

    /// The largest proven bound in use (source pixels) and the fraction of pixels computed exactly, over the
    /// whole picture.
    Reached reached(const ParallelFor& parallel_for = serial_for) const;
    /// The fraction of the picture's pixels where the map is folded (`folds` shows what is not 0).
    double folded_fraction(const ParallelFor& parallel_for = serial_for) const;

    /// Draws the pixels of `box` (of the target image) to `view`, whose pixel (0, 0) is (box.x0, box.y0).
    /// `source` has the size given above at level 0; it is not read for the other outputs and may then be
    /// null. False when the source could not be read: the picture is then incomplete.
    bool draw(const Source* source, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for = serial_for) const;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace anamorph
