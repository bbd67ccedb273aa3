// SPDX-License-Identifier: Apache-2.0
// Image warping for OpenImageIO's ImageBufs, with the contract of ImageBufAlgo. Each function has a twin that
// returns a new image; on an error the result has_error().
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <vector>

namespace anamorph {

/// An operation by its name: "pano", "warp", "morph" and whatever else there are recipes for.
///
/// `sources`: as many images as the operation draws, in the order of their keys (src; a, b, c ...); none for
/// one that draws without. `options`: the keys of a recipe as strings or numbers; names of files are relative
/// to the working folder. The sources' keys, `tile`, `mip` and `frames` are a file's and not taken here.
///
/// An uninitialised `dst` gets the picture's size (of `roi`, if one is given), the source's channels and
/// pixel type and its metadata that still holds. An initialised one keeps its spec, and `roi` of it is
/// filled: without `size` its display window is the picture; channels that the picture does not have are left
/// alone. anamorph:tol, anamorph:max_error (source pixels) and anamorph:exact_fraction tell what was reached.
/// `nthreads`: 0 for OpenImageIO's default. On any error: false, and `dst` has a message of one line.
bool apply(OIIO::ImageBuf& dst, OIIO::string_view operation,
           const std::vector<const OIIO::ImageBuf*>& sources, const OIIO::ParamValueList& options = {},
           OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf apply(OIIO::string_view operation, const std::vector<const OIIO::ImageBuf*>& sources,
                     const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);

/// A panorama seen through another lens: the operation pano (from, to, fov, yaw, pitch, roll, size, filter,
/// tol, ...).
bool reproject(OIIO::ImageBuf& dst, const OIIO::ImageBuf& src, const OIIO::ParamValueList& options = {},
               OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf reproject(const OIIO::ImageBuf& src, const OIIO::ParamValueList& options = {},
                         OIIO::ROI roi = {}, int nthreads = 0);

/// A picture drawn through a control mesh: the operation warp (mesh, points, amount, ...).
/// anamorph:folded_fraction tells of how much of the picture the warp folds.
bool mesh_warp(OIIO::ImageBuf& dst, const OIIO::ImageBuf& src, const OIIO::ParamValueList& options = {},
               OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf mesh_warp(const OIIO::ImageBuf& src, const OIIO::ParamValueList& options = {},
                         OIIO::ROI roi = {}, int nthreads = 0);

/// A picture laid on a surface in space and seen by a camera: the operation drape (surface, camera, deform, ...).
/// anamorph:max_error is in pixels of the result; anamorph:patches tells how many patches were drawn and
/// anamorph:holes how many pixels within the surface show nothing.
bool drape(OIIO::ImageBuf& dst, const OIIO::ImageBuf& texture, const OIIO::ParamValueList& options = {},
           OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf drape(const OIIO::ImageBuf& texture, const OIIO::ParamValueList& options = {},
                     OIIO::ROI roi = {}, int nthreads = 0);

/// A step of the way from one picture to another along features that correspond to each other: the operation
/// morph (features, t, ...). The picture is like `a` in type, metadata and, without `size`, in size.
bool morph(OIIO::ImageBuf& dst, const OIIO::ImageBuf& a, const OIIO::ImageBuf& b,
           const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf morph(const OIIO::ImageBuf& a, const OIIO::ImageBuf& b,
                     const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);

/// A morph of two to eight pictures, in the order of the features' shapes; `shape_weights` says how much of
/// each.
bool morph(OIIO::ImageBuf& dst, const std::vector<const OIIO::ImageBuf*>& pictures,
           const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);
OIIO::ImageBuf morph(const std::vector<const OIIO::ImageBuf*>& pictures,
                     const OIIO::ParamValueList& options = {}, OIIO::ROI roi = {}, int nthreads = 0);

}  // namespace anamorph
