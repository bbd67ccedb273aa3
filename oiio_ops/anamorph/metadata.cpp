// SPDX-License-Identifier: Apache-2.0
#include "anamorph/metadata.h"

#include <OpenImageIO/strutil.h>

#include <array>

#include "anamorph/image_source.h"

namespace anamorph {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;
namespace Strutil = OIIO::Strutil;

/// Of the pixels' layout, of the camera or of the file, not of what the picture shows.
bool holds_no_longer(const std::string& name) {
    constexpr std::array prefixes = {"GPano:",   "tiff:",         "png:",     "thumbnail_",
                                     "openexr:", "oiio:subimage", "anamorph:"};
    for (const char* prefix : prefixes)
        if (Strutil::istarts_with(name, prefix)) return true;
    constexpr std::array names = {"Orientation",
                                  "textureformat",
                                  "wrapmodes",
                                  "fovcot",
                                  "worldtocamera",
                                  "worldtoscreen",
                                  "worldtoNDC",
                                  "envmap",
                                  "oiio:updirection",
                                  "oiio:sampleborder",
                                  "oiio:SHA-1",
                                  "oiio:ConstantColor",
                                  "oiio:AverageColor",
                                  "oiio:Movie",
                                  "oiio:subimagename",
                                  "Exif:PixelXDimension",
                                  "Exif:PixelYDimension",
                                  "Exif:ImageWidth",
                                  "Exif:ImageLength",
                                  "Exif:ThumbnailOffset",
                                  "screenWindowCenter",
                                  "screenWindowWidth",
                                  "PixelAspectRatio",
                                  "chunkCount",
                                  "multiView",
                                  "view",
                                  "deepImageState"};
    for (const char* other : names)
        if (Strutil::iequals(name, other)) return true;
    return false;
}

}  // namespace

SourceFacts facts_of(const ImageSpec& spec) {
    const Frame frame = frame_of(spec);
    SourceFacts facts{frame.width, frame.height, {}};
    const std::string gpano = Strutil::lower(spec.get_string_attribute("GPano:ProjectionType"));
    const std::string texture = spec.get_string_attribute("textureformat");
    if (gpano == "equirectangular" || texture == "LatLong Environment")
        facts.projection = Projection::equirectangular;
    else if (gpano == "cylindrical")
        facts.projection = Projection::cylindrical;
    else if (gpano == "fisheye")
        facts.projection = Projection::fisheye;
    else if (texture == "CubeFace Environment" && frame.height == 6 * std::int64_t{frame.width})
        facts.projection = Projection::cubemap;
    return facts;
}

std::vector<Assignment> assignments_of(const OIIO::ParamValueList& options, const std::string& prefix) {
    std::vector<Assignment> out;
    for (const OIIO::ParamValue& option : options) {
        const std::string name = option.name().string();
        if (!Strutil::istarts_with(name, prefix)) continue;
        std::string value;
        const TypeDesc type = option.type();
        if (type == OIIO::TypeFloat)
            value = shortest(option.get<float>());
        else if (type == TypeDesc(TypeDesc::DOUBLE))
            value = shortest(option.get<double>());
        else if (type.basetype == TypeDesc::INT && type.numelements() * type.aggregate == 2)
            value = std::to_string(option.get<int>(0)) + "x" + std::to_string(option.get<int>(1));
        else
            value = option.get_string();
        out.push_back({name.substr(prefix.size()), value});
    }
    return out;
}

void check_size(const PictureRequest& picture, const ImageSpec& source) {
    const int limit = OIIO::get_int_attribute("limits:imagesize_MB", 32768);
    const double megabytes = double(picture.width) * picture.height * source.nchannels *
                             double(source.format.size()) / (1024.0 * 1024.0);
    if (limit > 0 && megabytes > limit)
        throw Error("size", std::to_string(picture.width) + "x" + std::to_string(picture.height),
                    "must make at most " + std::to_string(limit) + " MB (limits:imagesize_MB)");
}

ImageSpec picture_spec(const ImageSpec& source, const PictureRequest& picture) {
    ImageSpec spec = source;
    spec.x = spec.y = spec.z = 0;
    spec.full_x = spec.full_y = spec.full_z = 0;
    spec.width = spec.full_width = picture.width;
    spec.height = spec.full_height = picture.height;
    spec.depth = spec.full_depth = 1;
    spec.tile_width = spec.tile_height = 0;
    spec.tile_depth = 1;
    spec.channelformats.clear();
    spec.format = oiio_type(pixel_type(source.format));
    if (picture.pixels != PixelKind::color) {
        const bool point = picture.pixels == PixelKind::point;
        spec.nchannels = point ? 2 : 1;
        spec.channelnames = point ? std::vector<std::string>{"R", "G"} : std::vector<std::string>{"Y"};
        spec.alpha_channel = spec.z_channel = -1;
        spec.format = OIIO::TypeFloat;
        spec.erase_attribute("oiio:ColorSpace");
        spec.erase_attribute("oiio:BitsPerSample");
        spec.erase_attribute("oiio:UnassociatedAlpha");
        spec.erase_attribute("ICCProfile");
    }
    OIIO::ParamValueList kept;
    for (const OIIO::ParamValue& attribute : spec.extra_attribs)
        if (!holds_no_longer(attribute.name().string())) kept.push_back(attribute);
    spec.extra_attribs = kept;
    add_facts(spec, picture.facts);
    return spec;
}

void add_facts(ImageSpec& spec, const Facts& facts) {
    for (const auto& [name, value] : facts) spec.attribute(name, static_cast<float>(value));
}

}  // namespace anamorph
