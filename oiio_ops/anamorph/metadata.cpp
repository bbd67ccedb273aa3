// SPDX-License-Identifier: Apache-2.0
#include "anamorph/metadata.h"

#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

#include "anamorph/image_source.h"
#include "anamorph/operation/panorama_attributes.h"
#include "anamorph/panorama/photo_sphere.h"

namespace anamorph {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;
namespace Strutil = OIIO::Strutil;

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
                                                   kPanoramaProjection};
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

/// "fisheye fov=180" or "rectilinear fov=90 lens=brown:k1=-0.1", as panorama_attributes writes it.
void read_projection(const std::string& text, SourceFacts& facts) {
    const std::size_t blank = text.find(' ');
    constexpr std::string_view kFov = " fov=";
    if (blank == std::string::npos || text.compare(blank, kFov.size(), kFov) != 0) return;
    std::string rest = text.substr(blank + kFov.size());
    const std::string fov = rest.substr(0, rest.find(' '));
    rest.erase(0, fov.size());
    // The words that may follow, in this order.
    const auto next = [&](std::string_view word) -> std::string {
        if (rest.compare(0, word.size(), word) != 0) return "";
        const std::string value = rest.substr(word.size(), rest.find(' ', 1) - word.size());
        rest.erase(0, word.size() + value.size());
        return value;
    };
    const std::string vfov = next(" vfov="), distance = next(" d="), second = next(" e="),
                      padding = next(" padding=");
    constexpr std::string_view kLens = " lens=";
    try {
        const Projection projection = projection_from_name(text.substr(0, blank));
        if (rest.compare(0, kLens.size(), kLens) == 0)
            facts.lens = LensModel::parse(rest.substr(kLens.size()));
        facts.projection = projection;
    } catch (const Error&) {
        return;
    }
    facts.said_by = kPanoramaProjection;
    for (const auto& [written, to] : {std::pair{fov, &facts.fov},
                                      {vfov, &facts.vfov},
                                      {distance, &facts.distance},
                                      {second, &facts.second}})
        if (Strutil::string_is_float(written)) *to = Strutil::stod(written);
    facts.padding = Padding::parse(padding);
}

/// A number of metadata. EXR and TIFF bring whole ones as integers, which are no floats to OpenImageIO.
double number_of(const ImageSpec& spec, const std::string& name) {
    const double value = spec.get_float_attribute(name);
    return value != 0 ? value : static_cast<double>(spec.get_int_attribute(name));
}

/// What is read of Google's Photo Sphere metadata besides GPano:ProjectionType, which is no number.
constexpr std::array kPhotoSphereNumbers = {"FullPanoWidthPixels",
                                            "FullPanoHeightPixels",
                                            "CroppedAreaLeftPixels",
                                            "CroppedAreaTopPixels",
                                            "CroppedAreaImageWidthPixels",
                                            "CroppedAreaImageHeightPixels",
                                            "PoseHeadingDegrees",
                                            "PosePitchDegrees",
                                            "PoseRollDegrees"};

/// The part of a panorama and its camera's pose, by Google's Photo Sphere metadata.
void read_photo_sphere(const ImageSpec& spec, SourceFacts& facts) {
    const auto number = [&](const char* name) { return number_of(spec, std::string("GPano:") + name); };
    const PanoramaCrop crop{number("FullPanoWidthPixels"),         number("FullPanoHeightPixels"),
                            number("CroppedAreaLeftPixels"),       number("CroppedAreaTopPixels"),
                            number("CroppedAreaImageWidthPixels"), number("CroppedAreaImageHeightPixels")};
    constexpr double kMost = 1 << 24;
    const bool is_possible = crop.w > 0 && crop.h > 0 && crop.w <= crop.width && crop.width <= kMost &&
                             crop.y >= 0 && crop.y + crop.h <= crop.height && crop.height <= kMost &&
                             std::fabs(crop.x) <= crop.width;
    // A whole one of square pixels is what it looks like; another one has 180 degrees from top to bottom.
    const bool is_whole = crop.w == crop.width && crop.h == crop.height && crop.x == 0 &&
                          facts.width * crop.h == facts.height * crop.w && crop.width == 2 * crop.height;
    const bool is_said = crop.w != 0 || crop.h != 0 || crop.x != 0 || crop.y != 0;
    facts.has_impossible_crop = is_said && !is_possible;
    if (is_possible && !is_whole) facts.crop = crop;
    const auto angle = [&](const char* name, std::optional<double>& to) {
        if (const double degrees = number(name); degrees != 0 && std::fabs(degrees) <= 360) to = degrees;
    };
    angle("PoseHeadingDegrees", facts.yaw);
    angle("PosePitchDegrees", facts.pitch);
    angle("PoseRollDegrees", facts.roll);
}

/// The focal length by Exif, in the order in which Hugin asks for it: that of a camera with a film of 36 x 24 mm whose
/// picture has the same diagonal, else by the pixels there are on the focal plane.
void read_focal_length(const ImageSpec& spec, SourceFacts& facts) {
    const auto number = [&](const char* name) { return number_of(spec, name); };
    // In pixels across; those of the height may be longer or shorter.
    const double aspect = facts.pixel_aspect;
    // What is no lens's, below .03 degrees or above 178 across, is taken for a slip.
    const double longer = std::max(facts.width, facts.height);
    const auto take = [&](double pixels, const std::string& by) {
        if (!(pixels >= longer / 200 && pixels <= longer * 2000)) return false;
        facts.focal_length = pixels;
        facts.focal_length_said_by = by;
        return true;
    };
    const double on_film = number("Exif:FocalLengthIn35mmFilm");
    if (take(on_film * std::hypot(facts.width, facts.height / aspect) / std::hypot(36, 24),
             "Exif:FocalLengthIn35mmFilm=" + shortest(on_film)))
        return;
    // Millimetres in an inch (which it is by default), a centimetre, a millimetre and a micrometre.
    const int unit = spec.get_int_attribute("Exif:FocalPlaneResolutionUnit", 2);
    const double millimetres = unit == 2 ? 25.4 : unit == 3 ? 10 : unit == 4 ? 1 : unit == 5 ? 0.001 : 0;
    if (millimetres == 0) return;
    // As many pixels as the camera stored, whatever the picture was resized to since, or turned.
    const double stored = std::max(number("Exif:PixelXDimension"), number("Exif:PixelYDimension"));
    const double resized = stored > 0 ? std::max(facts.width, facts.height) / stored : 1;
    const double length = number("Exif:FocalLength");
    take(length * number("Exif:FocalPlaneXResolution") / millimetres * resized,
         "Exif:FocalLength=" + shortest(static_cast<float>(length)));
}

/// The beginnings of the names of Cryptomatte's channels: its metadata name each layer, cryptomatte/1234567/name.
std::vector<std::string> cryptomatte_layers(const ImageSpec& spec) {
    std::vector<std::string> layers;
    for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
        const std::string name = attribute.name().string();
        if (Strutil::istarts_with(name, "cryptomatte/") && Strutil::iends_with(name, "/name"))
            layers.push_back(attribute.get_string());
    }
    return layers;
}

/// Is a channel one of ids or of depth, by its name?
bool is_named_as_data(const std::string& channel) {
    const std::string name = channel.substr(channel.find_last_of('.') + 1);
    for (const char* known : {"Z", "ZBack", "depth", "id"})
        if (Strutil::iequals(name, known)) return true;
    return name.ends_with("Id") || name.ends_with("ID") || Strutil::iends_with(name, "_id");
}

/// Is a channel one of a layer of Cryptomatte? CryptoObject00.R, CryptoObject01.G and so on hold ids and their shares.
bool is_matte(const std::string& channel, const std::vector<std::string>& layers) {
    return std::any_of(layers.begin(), layers.end(), [&](const std::string& layer) {
        const std::string rest = channel.substr(std::min(layer.size(), channel.size()));
        const bool goes_on =
            !rest.empty() && (rest[0] == '.' || std::isdigit(static_cast<unsigned char>(rest[0])));
        return channel.starts_with(layer) && goes_on;
    });
}

/// The channels that hold no colour.
std::vector<int> data_channels_of(const ImageSpec& spec) {
    const std::vector<std::string> layers = cryptomatte_layers(spec);
    std::vector<int> channels;
    for (int c = 0; c < spec.nchannels && c < static_cast<int>(spec.channelnames.size()); ++c) {
        const std::string& name = spec.channelnames[static_cast<std::size_t>(c)];
        if (is_matte(name, layers) || (c != spec.alpha_channel && is_named_as_data(name)))
            channels.push_back(c);
    }
    return channels;
}

}  // namespace

int alpha_channel_of(const ImageSpec& spec) {
    const int alpha = spec.alpha_channel;
    if (alpha < 0 || alpha >= static_cast<int>(spec.channelnames.size())) return alpha;
    return is_matte(spec.channelnames[static_cast<std::size_t>(alpha)], cryptomatte_layers(spec)) ? -1
                                                                                                  : alpha;
}

void add_photo_sphere(ImageSpec& spec, const std::string& file) {
    constexpr const char* kProjection = "ProjectionType";
    const auto attribute = [](const char* name) { return std::string("GPano:") + name; };
    const auto is_said = [&](const char* name) { return spec.find_attribute(attribute(name)) != nullptr; };
    if (is_said(kProjection) || std::any_of(kPhotoSphereNumbers.begin(), kPhotoSphereNumbers.end(), is_said))
        return;
    std::ifstream stored(file, std::ios::binary);
    const PhotoSphere values = photo_sphere_of(xmp_of_jpeg(stored));
    if (const auto found = values.find(kProjection); found != values.end())
        spec.attribute(attribute(kProjection), found->second);
    for (const char* name : kPhotoSphereNumbers)
        if (const auto found = values.find(name);
            found != values.end() && Strutil::string_is_float(found->second))
            spec.attribute(attribute(name), Strutil::stof(found->second));
}

SourceFacts facts_of(const ImageSpec& spec) {
    const Frame frame = frame_of(spec);
    SourceFacts facts;
    facts.width = frame.width;
    facts.height = frame.height;
    facts.pixel_aspect = pixel_aspect_of(spec);
    facts.has_alpha = alpha_channel_of(spec) >= 0;
    facts.channel_names = spec.channelnames;
    facts.data_channels = data_channels_of(spec);
    if (const SourceLevel level = frame.level(); !(level.extent == SourceLevel(level.size).extent))
        facts.overscan = level.extent;
    read_focal_length(spec, facts);
    const auto says = [&](const char* attribute, Projection projection) {
        facts.projection = projection;
        facts.said_by = attribute;
    };
    const std::string gpano = Strutil::lower(spec.get_string_attribute("GPano:ProjectionType"));
    const std::string texture = spec.get_string_attribute("textureformat");
    // Ours first: it says the field of view too.
    read_projection(spec.get_string_attribute(kPanoramaProjection), facts);
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
    read_photo_sphere(spec, facts);
    return facts;
}

SourceImage source_image(const ImageSpec& spec) {
    return {facts_of(spec), spec.nchannels, spec.get_string_attribute("oiio:ColorSpace"),
            alpha_channel_of(spec)};
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

namespace {

/// Throws Error when a picture is larger than OpenImageIO allows.
void check_size(const ImageSpec& picture, const std::string& sized_by) {
    const int limit = OIIO::get_int_attribute("limits:imagesize_MB", 32768);
    const double megabytes = double(picture.width) * picture.height * picture.nchannels *
                             double(picture.format.size()) / (1024.0 * 1024.0);
    if (limit > 0 && megabytes > limit)
        throw Error(sized_by, std::to_string(picture.width) + "x" + std::to_string(picture.height),
                    "must make at most " + std::to_string(limit) + " MB (limits:imagesize_MB)");
}

/// Channels by their names, as float.
void set_channels(ImageSpec& spec, const std::vector<std::string>& names) {
    spec.channelnames = names;
    spec.nchannels = static_cast<int>(names.size());
    const auto index = [&](const char* name) {
        const auto found = std::find(names.begin(), names.end(), name);
        return found == names.end() ? -1 : static_cast<int>(found - names.begin());
    };
    spec.alpha_channel = index("A");
    spec.z_channel = index("Z");
    spec.format = OIIO::TypeFloat;
}

}  // namespace

bool moves_stored(const PictureRequest& picture, const std::vector<ImageSpec>& sources,
                  const std::string& space) {
    if (!picture.moves || picture.adds_alpha || *picture.moves >= sources.size() || !space.empty())
        return false;
    const ImageSpec &shown = sources[*picture.moves], &first = sources[0];
    return loses_values(shown) && shown.nchannels == first.nchannels && shown.format == first.format &&
           shown.channelformats == first.channelformats;
}

bool moves_channels_stored(const PictureRequest& picture, const std::vector<ImageSpec>& sources) {
    if (sources.empty()) return false;
    const ImageSpec& first = sources[0];
    const auto is_alike = [&](const ImageSpec& other) {
        return other.nchannels == first.nchannels && other.format == first.format &&
               other.channelformats == first.channelformats;
    };
    return std::all_of(sources.begin(), sources.end(), is_alike) &&
           std::any_of(picture.moved_channels.begin(), picture.moved_channels.end(),
                       [&](int c) { return loses_values(first.channelformat(c)); });
}

namespace {

/// Where the display window of a picture begins: where that of the source does whose format it has, but for numbers near the end of
/// int, which hosts add sizes to.
int window_origin(int of_source, bool keeps_format) {
    constexpr int kMost = 1 << 30;
    return keeps_format && of_source >= -kMost && of_source <= kMost ? of_source : 0;
}

}  // namespace

ImageSpec picture_spec(const ImageSpec* source, const PictureRequest& picture, bool stored,
                       bool keeps_types) {
    ImageSpec spec = source ? *source : ImageSpec();
    const Box display = picture.shown();
    const bool keeps_format = source && picture.keeps_format;
    spec.full_x = window_origin(spec.full_x, keeps_format);
    spec.full_y = window_origin(spec.full_y, keeps_format);
    spec.x = spec.full_x - display.x0;
    spec.y = spec.full_y - display.y0;
    spec.width = picture.size.width;
    spec.height = picture.size.height;
    spec.full_width = display.width();
    spec.full_height = display.height();
    spec.z = spec.full_z = 0;
    spec.depth = spec.full_depth = 1;
    spec.tile_width = spec.tile_height = 0;
    spec.tile_depth = 1;
    const bool color = picture.pixels == PixelKind::color;
    if (!stored) {
        if (color && keeps_types && !spec.channelformats.empty())
            spec.format = OIIO::TypeFloat;
        else
            spec.channelformats.clear();
        spec.format = oiio_type(pixel_type(spec.format));
    }
    if (!color)
        set_channels(spec, picture.pixels == PixelKind::point    ? std::vector<std::string>{"R", "G"}
                           : picture.pixels == PixelKind::vector ? std::vector<std::string>{"R", "G", "B"}
                                                                 : std::vector<std::string>{"Y"});
    else if (!source)
        set_channels(spec, picture.channels);
    else if (picture.adds_alpha) {
        spec.alpha_channel = spec.nchannels++;
        spec.channelnames.emplace_back("A");
        if (!spec.channelformats.empty()) spec.channelformats.push_back(spec.channelformats.front());
    }
    check_size(spec, picture.sized_by);
    OIIO::ParamValueList kept;
    for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
        const std::string name = attribute.name().string();
        if (!holds_no_longer(name) && (color || !is_for_color(name))) kept.push_back(attribute);
    }
    spec.extra_attribs = kept;
    add_attributes(spec, picture.says);
    return spec;
}

void add_attributes(ImageSpec& spec, const Attributes& attributes) {
    for (const auto& [name, value] : attributes) {
        if (const double* number = std::get_if<double>(&value))
            spec.attribute(name, static_cast<float>(*number));
        else if (const int* integer = std::get_if<int>(&value))
            spec.attribute(name, *integer);
        else
            spec.attribute(name, std::get<std::string>(value));
    }
}

Attributes own_attributes(const Attributes& attributes) {
    Attributes own;
    for (const Attribute& attribute : attributes)
        if (attribute.name.starts_with("anamorph:")) own.push_back(attribute);
    return own;
}

}  // namespace anamorph
