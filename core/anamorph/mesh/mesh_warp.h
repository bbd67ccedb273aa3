// SPDX-License-Identifier: Apache-2.0
// Mesh warps: a picture drawn through a control mesh, or through pairs of points, to a proven tolerance; any
// part of it at a time (Kim 2003, chapter 5).
#pragma once

#include "anamorph/geometry/size.h"
#include "anamorph/image/picture.h"
#include "anamorph/mesh/mesh_data.h"
#include "anamorph/plan/scheme.h"

namespace anamorph {

/// How a warp is drawn.
struct MeshWarpOptions {
    WarpScheme scheme = WarpScheme::automatic;
    double tol = 0.01;  ///< source pixels; 0: every pixel in double, whose rounding is the bound
    Filter filter = Filter::antialias;
    DataChannels data = {};
    Wrap wrap = Wrap::automatic;  ///< automatic is black
    Output output = Output::color;
    /// Shows, in place of `output`, 0 where the map is one to one, else for a map that pulls 1 where it shows
    /// the source turned over (its Jacobian's determinant has the other sign than that of most of the mesh),
    /// and for a mesh that pushes the number of further source points that land on the pixel.
    bool folds = false;
    /// Draws over colour the edges of the mesh's cells, each level in a colour of its own.
    bool draws_mesh = false;
    /// Has colour a channel more, of how much of a pixel the source covers (Picture::adds_alpha)?
    bool adds_alpha = false;
    double amount = 1;  ///< blends vertices from the identity (0) to the warp (1) and beyond; finite
};

/// The most cells of a mesh that are drawn over its picture.
inline constexpr int kMostDrawnCells = 1 << 16;

/// A picture warped. Its one source has the size `source` at level 0; the bits of a pixel depend on nothing but the map, the options,
/// the sizes and the source. It says anamorph:folded_fraction, the fraction of its pixels where the map is folded (`folds` shows
/// what is not 0).
///
/// The identity maps the source image onto the whole target image. Where several source points land on a
/// pixel (a mesh that pushes, folded), those come first where the mesh is not turned over, of these the one
/// in the cell with the largest number, row by row; where none lands, the picture is black. Where a pixel
/// lies so near a fold's edge that double does not tell two source points apart, the fold counts as one, and
/// the bound spans them. Between the outermost lines of a mesh and the edges of the image it lies in, and
/// beyond given points, the map goes on (mesh_data.h, scattered.h).
///
/// Throws Error: a mesh that is to be drawn and has more than kMostDrawnCells cells, or is none, a vertex that is not a number, a tolerance below 0, an amount that is not finite, sizes that do not fit.
Picture warped_picture(const WarpMap& map, const Size& source, const Size& target,
                       const MeshWarpOptions& options);

}  // namespace anamorph
