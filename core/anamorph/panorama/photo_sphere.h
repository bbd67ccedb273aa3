// SPDX-License-Identifier: Apache-2.0
// Google's Photo Sphere metadata (GPano:ProjectionType, GPano:CroppedAreaLeftPixels ...), in the XMP of a JPEG file.
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <string_view>

namespace anamorph {

/// Values by their names without a prefix, as they are written.
using PhotoSphere = std::map<std::string, std::string>;

/// The XMP of a JPEG file, of which only the segments before the picture are read; empty where there is none, or where the file is
/// of another kind or ends early.
std::string xmp_of_jpeg(std::istream& file);

/// The values of the namespace http://ns.google.com/photos/1.0/panorama/, whatever its prefix is, written as attributes or
/// as elements; none where the text is no XML.
PhotoSphere photo_sphere_of(std::string_view xmp);

}  // namespace anamorph
