// SPDX-License-Identifier: Apache-2.0
// What a picture that is a panorama says of itself, so that readers of ours and of others know.
#pragma once

#include "anamorph/operation/operation.h"

namespace anamorph {

/// The attribute of any projection, "fisheye fov=180": the projection, its horizontal field of view in
/// degrees and its lens. Without a colon: OpenImageIO takes what stands before one for the name of a format.
inline constexpr const char* kPanoramaProjection = "panoramaProjection";

/// The attribute kPanoramaProjection; and where there is one, what others read: GPano's, OpenEXR's and
/// OpenImageIO's names of an environment. Only a picture of colour is an environment to others.
Attributes panorama_attributes(const Chart& picture, bool color);

}  // namespace anamorph
