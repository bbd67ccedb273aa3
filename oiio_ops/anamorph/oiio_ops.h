// SPDX-License-Identifier: Apache-2.0
// Image warping for OpenImageIO's ImageBufs, with the contract of ImageBufAlgo. Each function has a twin that
// returns a new image; on an error the result has_error().
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <vector>

namespace anamorph {

/// Applies an operation by its name: "pano", "warp", "morph" and whatever else there are recipes for.
///
/// `sources`: the images that the operation reads, in the order of their keys (src; a, b, c ...); empty for an
/// operation without sources. `options`: the keys of a recipe as strings or numbers; names of files are relative
/// to the working folder. The keys of sources, `tile`, `mip` and `frames` are for recipe files and not taken here.
///
/// An uninitialised `dst` gets the size of the picture (or of `roi`, if one is given), the channels and pixel type of
/// the source, and its metadata that still holds. An initialised `dst` keeps its spec, and its region `roi` is filled:
/// without `size` its display window is the picture; channels that the picture does not have do not change. The
/// attributes anamorph:tol, anamorph:max_error (source pixels) and anamorph:exact_fraction tell the accuracy reached.
/// `nthreads`: 0 for OpenImageIO's default. Returns false on any error, and `dst` then has a message of one line.
bool apply(OIIO::ImageBuf& dst, OIIO::string_view operation,
           const std::vector<const OIIO::ImageBuf*>& sources, const OIIO::ParamValueList& options = {},
           OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf apply(OIIO::string_view operation, const std::vector<const OIIO::ImageBuf*>& sources,
                     const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);

/// Draws a panorama as seen through another lens: the operation pano (from, to, fov, yaw, pitch, roll, size, filter,
/// tol, ...).
bool reproject(OIIO::ImageBuf& dst, const OIIO::ImageBuf& src, const OIIO::ParamValueList& options = {},
               OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf reproject(const OIIO::ImageBuf& src, const OIIO::ParamValueList& options = {},
                         OIIO::ROI roi = {}, int nthreads = 0);

/// Warps a picture by a control mesh: the operation warp (mesh, points, amount, ...). The attribute
/// anamorph:folded_fraction tells in which fraction of the picture the warp folds.
bool mesh_warp(OIIO::ImageBuf& dst, const OIIO::ImageBuf& src, const OIIO::ParamValueList& options = {},
               OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf mesh_warp(const OIIO::ImageBuf& src, const OIIO::ParamValueList& options = {},
                         OIIO::ROI roi = {}, int nthreads = 0);

/// Draws a picture laid on a surface in space as seen by a camera: the operation drape (surface, camera, deform, ...).
/// anamorph:max_error is in pixels of the result; anamorph:patches tells how many patches were drawn and
/// anamorph:holes how many pixels within the surface show nothing.
bool drape(OIIO::ImageBuf& dst, const OIIO::ImageBuf& texture, const OIIO::ParamValueList& options = {},
           OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf drape(const OIIO::ImageBuf& texture, const OIIO::ParamValueList& options = {},
                     OIIO::ROI roi = {}, int nthreads = 0);

/// Draws a step of a morph from one picture to another, along features that correspond to each other: the operation
/// morph (features, t, ...). The picture is like `a` in type, metadata and, without `size`, in size.
bool morph(OIIO::ImageBuf& dst, const OIIO::ImageBuf& a, const OIIO::ImageBuf& b,
           const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf morph(const OIIO::ImageBuf& a, const OIIO::ImageBuf& b,
                     const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);

/// Draws a morph of two to eight pictures, in the order of the features' shapes; the option `shape_weights` gives the
/// weight of each.
bool morph(OIIO::ImageBuf& dst, const std::vector<const OIIO::ImageBuf*>& pictures,
           const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf morph(const std::vector<const OIIO::ImageBuf*>& pictures,
                     const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);

}  // namespace anamorph
