// SPDX-License-Identifier: Apache-2.0
#include "anamorph/metadata.h"

#include <OpenImageIO/strutil.h>

#include <string_view>
#include <utility>
#include <vector>

#include "anamorph/image_source.h"

namespace anamorph {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;
namespace Strutil = OIIO::Strutil;

// No name of ours with a colon: where the plugin is loaded, OpenImageIO takes "anamorph:" for what belongs to
// that format alone, and does not write it to files of others.
const char* const kProjection = "panoramaProjection";

bool starts_with_any(const std::string& name, const std::vector<const char*>& beginnings) {
    for (const char* beginning : beginnings)
        if (Strutil::istarts_with(name, beginning)) return true;
    return false;
}

bool is_any(const std::string& name, const std::vector<const char*>& names) {
    for (const char* other : names)
        if (Strutil::iequals(name, other)) return true;
    return false;
}

/// Of the pixels' layout, of the camera or of the file, not of what the picture shows.
bool holds_no_longer(const std::string& name) {
    static const std::vector<const char*> beginnings = {
        "GPano:",   "tiff:",    "png:",       "thumbnail_",   "openexr:", "oiio:subimage",
        "raw:Crop", "raw:flip", "Exif:Focal", "Exif:Subject", "anamorph:"};
    static const std::vector<const char*> names = {"textureformat",
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
                                                   "originalDataWindow",
                                                   "chunkCount",
                                                   "multiView",
                                                   "view",
                                                   "deepImageState",
                                                   "maxSamplesPerPixel",
                                                   kProjection};
    // Exif:SubjectDistance is one of the camera's, and remains.
    if (Strutil::istarts_with(name, "Exif:SubjectDistance")) return false;
    return starts_with_any(name, beginnings) || is_any(name, names);
}

/// How colour is coded or compressed: would spoil values that are no colour.
bool is_for_color(const std::string& name) {
    static const std::vector<const char*> beginnings = {
        "jpeg:", "webp:", "heif:", "jpegxl:", "gif:", "dpx:", "ICCProfile"};
    static const std::vector<const char*> names = {"compression",
                                                   "CompressionQuality",
                                                   "compressionlevel",
                                                   "dwaCompressionLevel",
                                                   "quality",
                                                   "oiio:ColorSpace",
                                                   "oiio:Gamma",
                                                   "oiio:BitsPerSample",
                                                   "oiio:dither",
                                                   "Exif:ColorSpace",
                                                   "oiio:UnassociatedAlpha",
                                                   "Exif:Gamma",
                                                   "chromaticities",
                                                   "whiteLuminance",
                                                   "adoptedNeutral",
                                                   "renderingTransform",
                                                   "lookModTransform",
                                                   "colorInteropID",
                                                   "acesImageContainerFlag"};
    return starts_with_any(name, beginnings) || is_any(name, names);
}

/// "fisheye fov=180", as projection_attributes writes it.
void read_projection(const std::string& text, SourceFacts& facts) {
    const std::size_t blank = text.find(' ');
    constexpr std::string_view kFov = " fov=";
    if (blank == std::string::npos || text.compare(blank, kFov.size(), kFov) != 0) return;
    const std::string fov = text.substr(blank + kFov.size());
    try {
        facts.projection = projection_from_name(text.substr(0, blank));
    } catch (const Error&) {
        return;
    }
    facts.said_by = kProjection;
    if (Strutil::string_is_float(fov)) facts.fov = OIIO::Strutil::from_string<float>(fov);
}

}  // namespace

SourceFacts facts_of(const ImageSpec& spec) {
    const Frame frame = frame_of(spec);
    SourceFacts facts{frame.width, frame.height, {}, {}, {}};
    const auto says = [&](const char* attribute, Projection projection) {
        facts.projection = projection;
        facts.said_by = attribute;
    };
    const std::string gpano = Strutil::lower(spec.get_string_attribute("GPano:ProjectionType"));
    const std::string texture = spec.get_string_attribute("textureformat");
    // Ours first: it says the field of view too.
    read_projection(spec.get_string_attribute(kProjection), facts);
    if (facts.projection) return facts;
    if (gpano == "equirectangular")
        says("GPano:ProjectionType", Projection::equirectangular);
    else if (texture == "LatLong Environment")
        says("textureformat", Projection::equirectangular);
    else if (gpano == "cylindrical")
        says("GPano:ProjectionType", Projection::cylindrical);
    else if (gpano == "fisheye")
        says("GPano:ProjectionType", Projection::fisheye);
    else if (texture == "CubeFace Environment" && frame.height == 6 * std::int64_t{frame.width})
        says("textureformat", Projection::cubemap);
    return facts;
}

SourceImage source_image(const ImageSpec& spec) {
    return {facts_of(spec), spec.nchannels, spec.get_string_attribute("oiio:ColorSpace")};
}

OIIO::ParamValueList projection_attributes(const Chart& picture, bool color) {
    OIIO::ParamValueList says;
    says.attribute(kProjection,
                   std::string(name_of(picture.projection())) + " fov=" + shortest(picture.fov()));
    if (!color) return says;
    const int w = picture.width(), h = picture.height(), whole = w / 2;
    const auto environment = [&](const char* format) {
        says.attribute("textureformat", format);
        says.attribute("oiio:updirection", "y");
    };
    if (picture.projection() == Projection::cubemap) environment("CubeFace Environment");
    // A whole turn, and as much of the poles as whole rows can say.
    const bool turn = picture.projection() == Projection::equirectangular && picture.fov() == 360;
    if (turn && w % 2 == 0 && h <= whole && (whole - h) % 2 == 0) {
        says.attribute("GPano:ProjectionType", "equirectangular");
        for (const auto& [name, value] : {std::pair{"FullPanoWidthPixels", w},
                                          {"FullPanoHeightPixels", whole},
                                          {"CroppedAreaImageWidthPixels", w},
                                          {"CroppedAreaImageHeightPixels", h},
                                          {"CroppedAreaLeftPixels", 0},
                                          {"CroppedAreaTopPixels", (whole - h) / 2}})
            says.attribute(std::string("GPano:") + name, value);
        if (h == whole) environment("LatLong Environment");
    }
    return says;
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
    }
    const bool color = picture.pixels == PixelKind::color;
    OIIO::ParamValueList kept;
    for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
        const std::string name = attribute.name().string();
        if (!holds_no_longer(name) && (color || !is_for_color(name))) kept.push_back(attribute);
    }
    spec.extra_attribs = kept;
    for (const OIIO::ParamValue& attribute : picture.says) spec.extra_attribs.add_or_replace(attribute);
    add_own_facts(spec, picture);
    return spec;
}

void add_own_facts(ImageSpec& spec, const PictureRequest& picture) {
    for (const OIIO::ParamValue& attribute : picture.says)
        if (Strutil::istarts_with(attribute.name().string(), "anamorph:"))
            spec.extra_attribs.add_or_replace(attribute);
    add_facts(spec, picture.facts);
}

void add_facts(ImageSpec& spec, const Facts& facts) {
    for (const auto& [name, value] : facts) spec.attribute(name, static_cast<float>(value));
}

}  // namespace anamorph
