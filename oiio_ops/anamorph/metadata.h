// SPDX-License-Identifier: Apache-2.0
// The metadata of an image, and those that a picture made of it may still have.
#pragma once

#include <OpenImageIO/imageio.h>

#include <string>
#include <vector>

#include "anamorph/operation/operation.h"

namespace anamorph {

/// The facts that an operation may know of an upright image.
SourceImage source_image(const OIIO::ImageSpec& spec);

/// The facts of a panorama: its size, its projection as GPano, OpenEXR's envmap, a texture's format or a
/// picture of ours names it, and the focal length as Exif has it.
SourceFacts facts_of(const OIIO::ImageSpec& spec);

/// Adds to the header of an image what the XMP of its file says of a panorama (GPano:...), which OpenImageIO 2.4 does not hand on
/// of JPEG. Does nothing where the file is of another kind, or the header says such things already.
void add_photo_sphere(OIIO::ImageSpec& spec, const std::string& file);

/// The options of a call as assignments: names with `prefix` (taken off), all names without one. Numbers are
/// written in the fewest digits that read back, so that 0.01f means 0.01.
std::vector<Assignment> assignments_of(const OIIO::ParamValueList& options, const std::string& prefix = "");

/// The picture's header: its size and channels, the metadata of the upright source that still holds, and what
/// the picture says of itself. No tiles. `source`: the first one, null where there is none. Throws Error where
/// the picture is larger than OpenImageIO's attribute limits:imagesize_MB. `stored`: as moves_stored() says. `keeps_types`:
/// may channels be of several types, as those of the source are?
OIIO::ImageSpec picture_spec(const OIIO::ImageSpec* source, const PictureRequest& picture,
                             bool stored = false, bool keeps_types = false);

/// The channel of alpha; -1 where there is none, also where a name misleads: the last of a layer of Cryptomatte holds no alpha.
int alpha_channel_of(const OIIO::ImageSpec& spec);

/// Are a picture's pixels those of one of its sources as they are stored, since they are only moved and the core has no
/// numbers for them? `space`: the color space to filter in, if any.
bool moves_stored(const PictureRequest& picture, const std::vector<OIIO::ImageSpec>& sources,
                  const std::string& space);

/// Are channels that a picture only moves, while others are computed with, of types that the core has no numbers for, in sources
/// that store all channels alike?
bool moves_channels_stored(const PictureRequest& picture, const std::vector<OIIO::ImageSpec>& sources);

/// Sets attributes; numbers that are no integers as type float.
void add_attributes(OIIO::ImageSpec& spec, const Attributes& attributes);

/// The attributes that are ours, anamorph:*.
Attributes own_attributes(const Attributes& attributes);

}  // namespace anamorph
