// SPDX-License-Identifier: Apache-2.0
// What an image says of itself, and what a picture made of it may still say.
#pragma once

#include <OpenImageIO/imageio.h>

#include "anamorph/operation.h"
#include "anamorph/render/reproject_parameters.h"

namespace anamorph {

/// What an operation may know of an upright image.
SourceImage source_image(const OIIO::ImageSpec& spec);

/// The panorama's size, and its projection as GPano, OpenEXR's envmap, a texture's format or a picture of
/// ours names it.
SourceFacts facts_of(const OIIO::ImageSpec& spec);

/// The other way: what a picture says of itself, so that facts_of and other programs know. Only a picture of
/// colour is an environment to others.
OIIO::ParamValueList projection_attributes(const Chart& picture, bool color);

/// The options of a call as assignments: names with `prefix` (taken off), all names without one. Numbers are
/// written in the fewest digits that read back, so that 0.01f means 0.01.
std::vector<Assignment> assignments_of(const OIIO::ParamValueList& options, const std::string& prefix = "");

/// Throws Error when a picture is larger than OpenImageIO's attribute limits:imagesize_MB.
void check_size(const PictureRequest& picture, const OIIO::ImageSpec& source);

/// The picture's header: its size and channels, the metadata of the upright source that still holds, and the
/// picture's own facts: anamorph:tol, anamorph:max_error and so on. No tiles.
OIIO::ImageSpec picture_spec(const OIIO::ImageSpec& source, const PictureRequest& picture);

/// Sets the attributes of ours, anamorph:*, that a picture has beforehand.
void add_own_facts(OIIO::ImageSpec& spec, const PictureRequest& picture);

/// Sets them as attributes of type float.
void add_facts(OIIO::ImageSpec& spec, const Facts& facts);

}  // namespace anamorph
