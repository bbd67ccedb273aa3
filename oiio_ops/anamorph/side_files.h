// SPDX-License-Identifier: Apache-2.0
// The files that shape a picture: meshes, ST-maps, points and features.
#pragma once

#include <memory>

#include "anamorph/map/feature_lines.h"
#include "anamorph/map/mesh_data.h"
#include "anamorph/operation.h"

namespace anamorph {

/// A mesh or pairs of points from text (.json, .csv), or a mesh from every `step`-th pixel of an ST-map,
/// which may be any image that OpenImageIO reads: u in its first channel, v in its second. Throws Error.
std::shared_ptr<const WarpMap> read_warp_map(const SideFile& file, int step);

/// Pairs of points from text. Throws Error.
std::shared_ptr<const WarpMap> read_points(const SideFile& file);

/// Feature lines from text (.json, .csv, .svg). Throws Error.
std::shared_ptr<const Features> read_features(const SideFile& file);

}  // namespace anamorph
