// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/pano.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>

#include "anamorph/machine/machine_text.h"
#include "anamorph/operation/face_files.h"
#include "anamorph/operation/film.h"
#include "anamorph/operation/fisheye_pair.h"
#include "anamorph/operation/flat_picture.h"
#include "anamorph/operation/pano_formula.h"
#include "anamorph/operation/pano_project.h"
#include "anamorph/operation/panorama_attributes.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"
#include "anamorph/operation/stereo.h"
#include "anamorph/parameter/left_out.h"

namespace anamorph {
namespace {

using rows::chosen;
using rows::flat_field_of_view;
using rows::rounded_degrees;

/// "360 for equirectangular, cylindrical; 180 for fisheye": what each projection has by default.
std::string default_fovs() {
    std::map<double, std::string, std::greater<>> names;
    for (const Projection p : kProjections) {
        std::string& list = names[fov_of(p).standard];
        list += (list.empty() ? "" : ", ") + std::string(name_of(p));
    }
    std::string text;
    for (const auto& [fov, list] : names)
        text += (text.empty() ? "" : "; ") + std::to_string(std::lround(fov)) + " for " + list;
    return text;
}

/// "below 180 for rectilinear, 90 for cubemap": what not every projection can have.
std::string limited_fovs() {
    std::string text;
    for (const Projection p : kProjections) {
        const FieldOfView fov = fov_of(p);
        if (fov.most == 360 && !fov.open && !fov.fixed) continue;
        text += (text.empty() ? "" : ", ") +
                std::string(fov.fixed  ? ""
                            : fov.open ? "below "
                                       : "up to ") +
                std::to_string(std::lround(fov.most)) + " for " + std::string(name_of(p));
    }
    return text;
}

/// The words of face=: those of OpenEXR, in the order of the projection cubemap, directions, and those of OpenGL for the same.
struct FaceWord {
    const char* name;
    glm::dvec3 toward;
};
constexpr std::array<const char*, 6> kExrFaces = {"+x", "-x", "+y", "-y", "+z", "-z"};
constexpr std::array<FaceWord, 6> kFaceWords = {{{"right", {1, 0, 0}},
                                                 {"left", {-1, 0, 0}},
                                                 {"up", {0, -1, 0}},
                                                 {"down", {0, 1, 0}},
                                                 {"front", {0, 0, 1}},
                                                 {"back", {0, 0, -1}}}};
constexpr std::array<const char*, 6> kOpenGlFaces = {"px", "nx", "py", "ny", "pz", "nz"};
std::vector<std::string> face_names() {
    std::vector<std::string> names(kExrFaces.begin(), kExrFaces.end());
    for (const FaceWord& word : kFaceWords) names.emplace_back(word.name);
    names.insert(names.end(), kOpenGlFaces.begin(), kOpenGlFaces.end());
    return names;
}

/// Frames over time.
ParameterTable film_rows() {
    using namespace rows;
    ParameterTable table =
        sequence(" (of the cameras: yaw, fov, srcpitch), and of keys that define names of formulas");
    table.insert(table.begin() + 1,
                 number("frame", "", "0", -1e9, 1e9,
                        "one frame alone, which may lie between others; the number that frame is in "
                        "formulas"));
    const ParameterTable open = shutter();
    table.insert(table.end(), open.begin(), open.end());
    return table;
}

ParameterTable make_pano_table() {
    using namespace rows;
    ParameterTable table = {
        image("src",
              "the source image; by default the recipe's name without .pano; in a name it stands last when "
              "it has arguments of its own; a project of Hugin, x.pto, is the images that it names. With "
              "{face} in it: six files, "
              "one a face of a cube, with one of these in its place: " +
                  face_words()),
        choice("from", "", projection_name_list(),
               "projection of the source; by default what the image says of itself, else by its shape: 2:1 "
               "equirectangular, 1:6 cubemap (anamorph:from tells what was assumed)"),
        projection_or_formula("to", "projection of the picture; formula: that of ray_x, ray_y and ray_z"),
        above(number(
            "srcfov", "degrees", "", 0, 360,
            "horizontal field of view of the source, edge to edge, or of each of its faces; by "
            "default what the image says of itself, of a rectilinear one also by Exif's focal length, else " +
                default_fovs())),
        above(number("fov", "degrees", "", 0, 360,
                     "horizontal field of view of the picture, edge to edge, or of each of its faces: " +
                         limited_fovs() + "; defaults by projection as for srcfov")),
        number(
            "srcvfov", "degrees", "", 1e-6, 360,
            "vertical field of view of the source, where its pixels are not square and its PixelAspectRatio "
            "does not say so; srcfov is then 360 for "
            "equirectangular, cylindrical and mercator, and for others what square pixels make of it, unless "
            "it is given"),
        number(
            "vfov", "degrees", "", 1e-6, 360,
            "vertical field of view of the picture. Without fov that is 360 for equirectangular, cylindrical "
            "and mercator, and for others what square pixels make of vfov and size; where size has no "
            "height, "
            "fov is the projection's, and the height follows. With both, pixels need not be square"),
        number("srcfocal", "mm", "", 1e-3, 1e6,
               "focal length of the source's camera, in place of srcfov, for a sensor as wide as srcsensor"),
        number("srcsensor", "mm", "36", 1e-3, 1e6, "width of the source's sensor or film, for srcfocal"),
        number("focal", "mm", "", 1e-3, 1e6,
               "focal length of the picture's camera, in place of fov, for a sensor as wide as sensor"),
        number("sensor", "mm", "36", 1e-3, 1e6, "width of the picture's sensor or film, for focal"),
        text(
            "srccrop",
            "the part of a whole panorama that the source is: WxH+X+Y, the pixels of the whole and the upper "
            "left corner of the source in it, as in 8000x4000+1200+900; srcfov and srcvfov are then the "
            "whole's; by default as the image says (GPano:CroppedArea...), also of one that was resized; "
            "none: it is whole"),
        number("srcd", "", "1", Chart::kLeastDistance, Chart::kMostDistance,
               "distance d of the source, for from=pannini; xi for from=unified and double_sphere, beta for "
               "eucm"),
        number(
            "d", "", "1", Chart::kLeastDistance, Chart::kMostDistance,
            "Pannini's distance d of the picture, for to=pannini: 0 is rectilinear, 1 the usual one; of "
            "to=unified, xi: 0 is rectilinear, 1 stereographic; fov stays below the angle at which d + cos "
            "or 1 + d cos of its half is 0; of to=double_sphere, xi, at most 1, and of to=eucm, beta, from "
            "0.001"),
        number("srce", "", shortest(Distance::kSecond), 0, 1,
               "alpha of the source, for from=eucm and double_sphere"),
        number("e", "", shortest(Distance::kSecond), 0, 1,
               "alpha of the picture, for to=eucm and double_sphere"),
        number("yaw", "degrees", "0", -kInfinity, kInfinity, "where the camera looks: to the right"),
        number("pitch", "degrees", "0", -kInfinity, kInfinity, "where the camera looks: up"),
        number("roll", "degrees", "0", -kInfinity, kInfinity,
               "the camera's turn about its axis, clockwise; roll is applied first, then pitch, then yaw"),
        number("srcyaw", "degrees", "", -kInfinity, kInfinity,
               "how the source's camera was held: turned to the right; by default as the image says "
               "(GPano:PoseHeadingDegrees), else 0"),
        number("srcpitch", "degrees", "", -kInfinity, kInfinity,
               "how the source's camera was held: tilted up; by default as the image says "
               "(GPano:PosePitchDegrees), else 0"),
        number("srcroll", "degrees", "", -kInfinity, kInfinity,
               "how the source's camera was held: turned about its axis, clockwise; in the same order; by "
               "default as the image says (GPano:PoseRollDegrees), else 0"),
        choice(
            "face", "", face_names(),
            "of to=cubemap, cubemap3x2 and cubecross: one face alone, as it stands there; size is then its "
            "own. +x to -z are the faces of cubemap from above, as OpenEXR has them; right to back say where "
            "a face lies; px, nx, py, ny, pz and nz are right to back, of the others alone, as OpenGL has "
            "them"),
        text(
            "srcpadding",
            "of a source of faces, or a fisheye: how many pixels within each edge of every face its field of "
            "view ends, less than a quarter of its sides; there the face's own plane goes on; of eac, rows:2 "
            "is so many around each row of faces alone, as ffmpeg's v360 has them; by default what the image "
            "says of itself, else 0"),
        text("padding",
             "of a picture of faces, or a fisheye: as many pixels within each edge of every face show what "
             "goes on beyond its field of view, in the face's own plane; size counts them; of eac, rows:2 is "
             "so many around each row of faces alone; by default 0"),
        text("srclens",
             "distortion of the source, as for lens; by default what the image says of itself, else none"),
        text("lens",
             "distortion of the picture: none, or MODEL:name=value,name=value with ptlens (a, b, c, g, t), "
             "brown "
             "(k1 to k6, p1, p2, s1 to s4), 3de4 (k1, k2), kb4 (k1 to k4), division (k1, k2), "
             "poly (k0 to k4) or ocam (a0, a2, a3, a4, affine_c to affine_e), and d, e, the shift of its "
             "centre in pixels, or "
             "lensfun:lens=NAME,camera=NAME,focal=35; by "
             "default none; fields of view are those without distortion"),
        size("width and height of the picture, or its width alone; by default as fine as the source at the "
             "centre"),
        overscan(),
        subimage(),
        concatenate(),
        tile(),
        mip(),
        hash(),
        reached("of scheme hardware and of films"),
        filter(),
        clamp(),
        data_channels(),
        data_filter(),
        wrap("goes on across the seam, the poles and cube edges"),
        tol(),
        enumeration(
            "pixels", "edges", {{"edges", PixelSpacing::edges}, {"centers", PixelSpacing::centers}},
            "where the source's field of view ends: at the edges of its outer pixels or at their centers"),
        scheme({{"auto", Scheme::automatic},
                {"exact", Scheme::exact},
                {"blocks", Scheme::blocks},
                {"residual", Scheme::residual},
                {"direct", Scheme::direct},
                {"hardware", Word::kNone}}),
        text("machine",
             "of scheme hardware: embm-2003, the bump mapping of Kim 2003, and what differs from it, "
             "embm-2003:size=64,texel=V8U8 or {\"size\": 64, \"texel\": \"V8U8\"}; by default embm-2003"),
        colorspace("color space to filter in; by default the source's own"),
        output(),
        alpha(),
        flip_v(),
    };
    for (const ParameterTable& part : {project(), fisheye_pair(), stereo(), film_rows(), ray_rows()})
        table.insert(table.end(), part.begin(), part.end());
    return table;
}

/// What a picture covers, and its height over its width where its size does not say it.
struct Field {
    double fov;
    VerticalField vertical = {};
    double aspect = 1;
};

Size natural_size(const Field& field, double width) {
    const double limit = kMaxSide;
    const int w = static_cast<int>(std::clamp(std::round(width), 1.0, limit));
    const int h = static_cast<int>(std::clamp(std::round(w * field.aspect), 1.0, limit));
    return {w, h};
}

/// The picture's size where none was given: as many pixels per radian at its centre as the source has. `magnified`: by
/// its lens there.
Size default_size(Projection projection, const Field& field, const Distance& d, double magnified,
                  const Chart& source) {
    const int probe = 1200;  // holds whole faces of every cube layout
    const Size shape = natural_size(field, probe);
    const Chart chart(projection, shape.width, shape.height, field.fov, PixelSpacing::edges, "", d);
    // Where pixels are oblong, as fine as the source's shorter sides.
    const Chart::Scale scale = source.scale();
    const double finer = source.vertical().fov != 0 ? std::max(1.0, scale.y / scale.x) : 1;
    const double width =
        probe * source.pixels_per_radian() * finer / (chart.pixels_per_radian() * std::max(magnified, 1e-3));
    const double most = kMaxDefaultSize / std::max(1.0, field.aspect);
    const int faces = std::max(1, faces_of(projection).columns);
    const double face = std::max(1.0, std::min(std::round(width / faces), std::floor(most / faces)));
    return natural_size(field, face * faces);
}

struct Taken {
    Projection projection;
    std::string reason;
};

/// Can a source of this size be a picture of the projection's faces?
bool can_have_faces(Projection projection, const SourceFacts& source) {
    try {
        Chart(projection, source.width, source.height);
        return true;
    } catch (const Error&) {
        return false;
    }
}

/// What the source is taken for, and why. A face that was cut out keeps what was said of all of them: that says nothing.
Taken source_projection(const ParameterValues& values, const SourceFacts& source) {
    if (values.given("from")) return {projection_from_name(values.text("from"), "from"), "given"};
    if (source.projection && (!has_faces(*source.projection) || can_have_faces(*source.projection, source)))
        return {*source.projection, "as " + source.said_by + " says"};
    const double width = source.crop ? source.crop->width : source.width * source.pixel_aspect,
                 height = source.crop ? source.crop->height : source.height;
    if (width == 2 * height) return {Projection::equirectangular, "assumed from the 2:1 shape"};
    if (std::int64_t{source.width} * 6 == source.height)
        return {Projection::cubemap, "assumed from the 1:6 shape"};
    throw Error::not_given(
        "from", " and the source (" + std::to_string(source.width) + "x" + std::to_string(source.height) +
                    ") does not say its projection, which of a photo is rectilinear: must be one of " +
                    projection_names());
}

/// Is a key given that not all tables have?
bool is_given(const ParameterValues& values, const std::string& name) {
    return values.knows(name) && values.given(name);
}

/// What srcpadding or padding says; none where the table has no such row or it is not given. Throws Error.
std::optional<Padding> padding_of(const ParameterValues& values, const std::string& name) {
    if (!is_given(values, name)) return {};
    const std::string& text = values.text(name);
    const std::optional<Padding> padding = Padding::parse(text);
    const bool is_whole = text.find_first_not_of("0123456789", text.find(':') + 1) == text.npos;
    if (!padding || !is_whole || padding->pixels >= 1e6)
        throw Error(
            name, printable(text),
            "must be an integer from 0 to less than a quarter of the sides of a face, in pixels, or of "
            "eac rows: and that, around its rows of faces");
    return padding;
}

/// The horizontal field of view that is asked for, in degrees or by a focal length; none where it is not. `of`: "src" or nothing.
std::optional<double> asked_fov(const ParameterValues& values, const std::string& of, Projection projection,
                                const Distance& d) {
    const std::string fov = of + "fov", focal = of + "focal", sensor = of + "sensor";
    if (!is_given(values, focal)) {
        if (is_given(values, sensor))
            throw Error(sensor, printable(values.text(sensor)), "must be given together with " + focal);
        return values.given(fov) ? std::optional(values.number(fov)) : std::nullopt;
    }
    const std::string text = printable(values.text(focal));
    if (values.given(fov)) throw Error(focal, text, "must not be given together with " + fov);
    if (fov_of(projection).fixed || has_faces(projection))
        throw Error(
            focal, text,
            "must be of a picture in one piece, which " + std::string(name_of(projection)) + " is not");
    // The plane's unit is the focal length.
    const double width = values.number(sensor) / values.number(focal);
    const double degrees = fov_of_plane_width(projection, width, d);
    if (!(plane_width(projection, degrees, d) >= width * (1 - 1e-9)))
        throw Error(focal, text,
                    "is too short: " + std::string(name_of(projection)) + " does not show all of " + sensor +
                        "=" + printable(values.text(sensor)));
    return degrees;
}

/// The horizontal field of view that pixels, so many times as wide as high, make of a vertical one. Throws Error where there is
/// none.
double fov_by_vfov(Projection projection, double vfov, const Size& size, const Distance& d,
                   const std::string& name, double pixel_aspect = 1) {
    const double height = plane_height(projection, vfov, d),
                 width = height / size.height * (size.width * pixel_aspect);
    // Says what is wrong with it.
    if (height == 0)
        static_cast<void>(Chart(projection, size.width, size.height, 0, PixelSpacing::edges,
                                name.substr(0, name.size() - 4), d, {}, {vfov}));
    const double degrees = fov_of_plane_width(projection, width, d);
    if (!(plane_width(projection, degrees, d) >= width * (1 - 1e-9)))
        throw Error(name, shortest(vfov),
                    "is too much: " + std::string(name_of(projection)) + " does not show as much across " +
                        std::to_string(size.width) + "x" + std::to_string(size.height) +
                        (pixel_aspect == 1
                             ? " square pixels"
                             : " pixels of PixelAspectRatio=" + shortest(static_cast<float>(pixel_aspect))));
    return degrees;
}

/// The vertical field of view that pixels, so many times as wide as high, make of a horizontal one. Throws Error where there is
/// none.
double vfov_by_fov(Projection projection, double fov, double width, double height, const Distance& d,
                   double pixel_aspect) {
    const std::string pixels = "source has PixelAspectRatio=" + shortest(static_cast<float>(pixel_aspect));
    if (fov_of(projection).fixed || has_faces(projection))
        throw Error(pixels + ": must be 1 for " + std::string(name_of(projection)) +
                    ", which has a shape of its own; resize it to square pixels, or correct the attribute");
    // Where the plane is one of angles degrees stay what they are.
    if (projection == Projection::equirectangular) return fov * height / (width * pixel_aspect);
    const double across = plane_width(projection, fov, d), down = across / width * height / pixel_aspect;
    const double degrees = vfov_of_plane_height(projection, down, d);
    if (!(plane_height(projection, degrees, d) >= down * (1 - 1e-9)))
        throw Error(pixels + ": with a field of view of " + rounded_degrees(fov) +
                    " degrees it is higher than " + std::string(name_of(projection)) + " shows");
    return degrees;
}

/// What the picture covers. `size`: that which is asked for, with a height below 0 where that is not given.
Field target_field(const ParameterValues& values, Projection to, const Distance& d, const Size& size) {
    const std::optional<double> fov = asked_fov(values, "", to, d);
    Field field{fov.value_or(Chart::default_fov(to))};
    if (!is_given(values, "vfov")) {
        field.aspect = natural_aspect(to, field.fov);
        return field;
    }
    const double vfov = values.number("vfov");
    if (!fov && !rows_turn(to) && size.height > 0) return {fov_by_vfov(to, vfov, size, d, "vfov")};
    field.vertical.fov = vfov;
    field.aspect = plane_height(to, vfov, d) / plane_width(to, field.fov, d);
    return field;
}

struct TakenFieldOfView {
    double degrees;
    std::string reason;  ///< where it goes without saying, nothing
};

/// Refuses numbers of a projection that has none, or no second one. `prefix`: of the keys d and e; `of`: the projection's key.
void check_numbers(const ParameterValues& values, const std::string& prefix, const std::string& of,
                   Projection projection) {
    for (const int number : {1, 2}) {
        const std::string name = prefix + (number == 1 ? "d" : "e");
        if (!is_given(values, name) || numbers_of(projection) >= number) continue;
        std::string names;
        for (const Projection p : kProjections)
            if (numbers_of(p) >= number) names += (names.empty() ? "" : ", ") + std::string(name_of(p));
        throw Error(
            name, printable(values.text(name)),
            "is of " + names + ": must not be given with " + of + "=" + std::string(name_of(projection)));
    }
}

/// The numbers of the source's projection.
Distance source_distance(const ParameterValues& values, const SourceFacts& facts, Projection from) {
    const auto number = [&](const char* name, const std::optional<double>& said) {
        return !values.given(name) && said && facts.projection == from ? *said : values.number(name);
    };
    return {number("srcd", facts.distance), number("srce", facts.second)};
}

/// The field of view of the source: what was asked for or what it says of itself, else by its camera's focal
/// length, else the projection's.
TakenFieldOfView source_field_of_view(const ParameterValues& values, const SourceFacts& facts,
                                      Projection projection, PixelSpacing spacing) {
    const Distance d = source_distance(values, facts, projection);
    if (const std::optional<double> asked = asked_fov(values, "src", projection, d)) return {*asked, ""};
    const bool says = facts.projection == projection;
    if (facts.fov && says) return {*facts.fov, ""};
    const auto with_reason = [](double degrees, const std::string& reason) {
        return TakenFieldOfView{degrees, ", " + rounded_degrees(degrees) + " degrees " + reason};
    };
    if (is_given(values, "srcvfov") && !rows_turn(projection))
        return with_reason(fov_by_vfov(projection, values.number("srcvfov"), {facts.width, facts.height}, d,
                                       "srcvfov", facts.pixel_aspect),
                           "as srcvfov=" + printable(values.text("srcvfov")) + " says");
    const double standard = Chart::default_fov(projection);
    if (projection != Projection::rectilinear) return {standard, ""};
    if (!facts.focal_length) return with_reason(standard, "assumed");
    return with_reason(
        flat_field_of_view(facts.width - (spacing == PixelSpacing::centers ? 1 : 0), *facts.focal_length),
        "as " + facts.focal_length_said_by + " says");
}

/// The four integers of at least 0 in a text, with these characters between them.
std::optional<std::array<int, 4>> numbers_between(std::string_view text, std::string_view separators) {
    std::array<int, 4> numbers{};
    const char *at = text.data(), *end = at + text.size();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (i > 0 && (at == end || *at++ != separators[i - 1])) return {};
        const auto [next, error] = std::from_chars(at, end, numbers[i]);
        if (error != std::errc() || numbers[i] < 0) return {};
        at = next;
    }
    return at == end ? std::optional(numbers) : std::nullopt;
}

/// The part of a panorama that the source is: as asked for or as it says itself; none where it is whole.
std::optional<PanoramaCrop> source_crop(const ParameterValues& values, const SourceFacts& facts,
                                        Projection from) {
    if (!is_given(values, "srccrop")) {
        const bool is_as_said = facts.projection.value_or(from) == from && rows_turn(from);
        return is_as_said ? facts.crop : std::nullopt;
    }
    const std::string text = values.text("srccrop");
    if (text == "none") return {};
    const std::optional<std::array<int, 4>> numbers = numbers_between(text, "x++");
    const PanoramaCrop crop =
        numbers ? PanoramaCrop{double((*numbers)[0]), double((*numbers)[1]), double((*numbers)[2]),
                               double((*numbers)[3]), double(facts.width),   double(facts.height)}
                : PanoramaCrop{};
    const bool is_inside = numbers && crop.width >= crop.w && crop.width <= kMaxSide &&
                           crop.height <= kMaxSide && crop.x < crop.width && crop.y + crop.h <= crop.height;
    if (!is_inside)
        throw Error("srccrop", printable(text),
                    "must be none, or WxH+X+Y with the source, " + std::to_string(facts.width) + "x" +
                        std::to_string(facts.height) + ", inside of WxH");
    return crop;
}

/// A part of a panorama as srccrop has it.
std::string text_of(const PanoramaCrop& crop) {
    return shortest(crop.width) + "x" + shortest(crop.height) + "+" + shortest(crop.x) + "+" +
           shortest(crop.y);
}

/// Where a part of a panorama lies: the chart of `whole` degrees is cut down to it.
struct CutView {
    double fov, ahead;
    VerticalField vertical;
};
CutView cut_to(const PanoramaCrop& crop, Projection from, const SourceFacts& facts, double whole,
               double srcvfov) {
    if (!rows_turn(from))
        throw Error("srccrop", text_of(crop),
                    "must be of a projection whose columns are meridians, equirectangular, cylindrical or "
                    "mercator, which " +
                        std::string(name_of(from)) + " is not");
    if (whole != 360 && crop.x + crop.w > crop.width)
        throw Error("srccrop", text_of(crop),
                    "must not run across the seam of a panorama of " + shortest(whole) + " degrees");
    CutView cut{whole * crop.w / crop.width, ((crop.x + 0.5 * crop.w) / crop.width - 0.5) * whole, {}};
    // Units of the plane for a pixel of the whole.
    const double across = plane_width(from, whole) / crop.width,
                 down = srcvfov > 0 ? plane_height(from, srcvfov) / crop.height : across;
    const bool is_square = down == across && facts.height * crop.w == facts.width * crop.h;
    if (!is_square) cut.vertical.fov = vfov_of_plane_height(from, crop.h * down);
    cut.vertical.horizon = (0.5 * crop.height - crop.y) * facts.height / crop.h;
    return cut;
}

LensModel lens_of(const ParameterValues& values, const std::string& name) {
    return values.given(name) ? LensModel::parse(values.text(name), name) : LensModel{};
}

/// The machine of scheme hardware. What is said of a machine is checked with the other schemes too.
std::optional<machine::BumpUnit> machine_of(const ParameterValues& values) {
    machine::BumpUnit unit;
    if constexpr (!kIsSmall)
        if (values.given("machine")) unit = machine::bump_unit_from_text(values.text("machine"));
    rows::check_scheme_of(values, "machine", {"hardware"});
    if (values.text("scheme") != "hardware") return {};
    return unit;
}

}  // namespace

Chart read_target_chart(const ParameterValues& values, const Chart& source) {
    const Projection to = projection_from_name(values.text("to"), "to");
    check_numbers(values, "", "to", to);
    const Distance d{values.number("d"), values.number("e")};
    const LensModel lens = lens_of(values, "lens");
    Size size = values.given("size") ? values.extent("size") : Size{0, -1};
    const Field field = target_field(values, to, d, size);
    const Padding padding = padding_of(values, "padding").value_or(Padding());
    const auto chart = [&](int width, int height, const LensModel& through, const Padding& within = {}) {
        return Chart(to, width, height, field.fov, PixelSpacing::edges, "", d, through, field.vertical,
                     within);
    };
    // Reports a field of view that the picture cannot have before a size is made of it.
    const int probe = 12;
    static_cast<void>(
        chart(probe, has_faces(to) ? static_cast<int>(probe * natural_aspect(to, field.fov)) : probe, {}));
    if (!values.given("size")) {
        const FaceGrid grid = faces_of(to);
        size = default_size(to, field, d, lens.magnification(), source);
        const int margins = 2 * static_cast<int>(padding.pixels);
        size = {size.width + margins * (padding.around_rows ? 1 : std::max(1, grid.columns)),
                size.height + margins * std::max(1, grid.rows)};
    } else if (size.height < 0) {
        // Near where a projection ends the height that belongs to a width has no end either.
        if (const double height = size.width * field.aspect; !(height < kMaxSide + 0.5))
            throw Error("size", std::to_string(size.width),
                        "makes a picture " + shortest(std::round(height)) + " pixels high, as " +
                            (values.given("vfov") ? "vfov" : "fov") + " says: must be at most " +
                            std::to_string(kMaxSide) + ", or NxM");
        size = natural_size(field, size.width);
    }
    return chart(size.width, size.height, lens, padding);
}

namespace {

/// Where a face of that name looks. Throws Error where the projection's faces have no such names.
glm::dvec3 direction_of_face(const ParameterValues& values, Projection to) {
    const std::string& face = values.text("face");
    const auto exr = std::find(kExrFaces.begin(), kExrFaces.end(), face);
    const bool has_names =
        to == Projection::cubemap || to == Projection::cubemap3x2 || to == Projection::cubecross;
    if (!has_names)
        throw Error("face", face,
                    "must be of to=cubemap, cubemap3x2 or cubecross, not " + std::string(name_of(to)));
    const auto opengl = std::find(kOpenGlFaces.begin(), kOpenGlFaces.end(), face);
    if (opengl != kOpenGlFaces.end()) {
        if (to == Projection::cubemap)
            throw Error("face", face, "must be +x to -z or right to back of to=cubemap");
        return kFaceWords[static_cast<std::size_t>(opengl - kOpenGlFaces.begin())].toward;
    }
    if (exr == kExrFaces.end())
        return std::find_if(kFaceWords.begin(), kFaceWords.end(),
                            [&](const FaceWord& word) { return word.name == face; })
            ->toward;
    if (to != Projection::cubemap)
        throw Error("face", face, "must be right to back or px to nz, or of to=cubemap");
    const Chart cube(Projection::cubemap, 1, 6);
    return cube.pieces()[static_cast<std::size_t>(exr - kExrFaces.begin())].toward;
}

/// One face of a layout as a picture of its own, and how it is turned.
struct FaceAlone {
    Chart chart;
    glm::dmat3 axes;
};
FaceAlone read_face(const ParameterValues& values, const Chart& source) {
    const Projection to = projection_from_name(values.text("to"), "to");
    const glm::dvec3 toward = direction_of_face(values, to);
    for (const char* name : {"fov", "vfov", "focal", "sensor", "lens", "padding"})
        if (values.given(name))
            throw Error(name, printable(values.text(name)),
                        "must not be given with face: a face has 90 degrees");
    const FaceGrid grid = faces_of(to);
    int side = 0;
    if (values.given("size")) {
        const Size size = values.extent("size");
        if (size.height >= 0 && size.height != size.width)
            throw Error("size", values.text("size"), "must be square with face=" + values.text("face"));
        side = size.width;
    } else {
        side = read_target_chart(values, source).width() / grid.columns;
    }
    const Chart layout(to, grid.columns, grid.rows);
    const auto piece = std::find_if(layout.pieces().begin(), layout.pieces().end(),
                                    [&](const Piece& p) { return p.toward == toward; });
    return {Chart(Projection::rectilinear, side, side, 90), piece->axes};
}

}  // namespace

Size read_overscan(const ParameterValues& values, const Chart& target) {
    rows::check_overscan(values, static_cast<int>(target.pieces().size()));
    return rows::overscan_of(values, {target.width(), target.height()});
}

Orientation read_orientation(const ParameterValues& values) {
    return {values.number("yaw"), values.number("pitch"), values.number("roll")};
}

TargetView read_target_view(const ParameterValues& values, const Chart& source) {
    Orientation look = read_orientation(values);
    if (!values.given("face")) return {read_target_chart(values, source), look};
    const FaceAlone face = read_face(values, source);
    look.face = face.axes;
    return {face.chart, look};
}

ReprojectOptions read_reproject_options(const ParameterValues& values, const SourceFacts& source) {
    ReprojectOptions options;
    options.tol = values.number("tol");
    options.filter = rows::filter_of(values);
    options.wrap = chosen<Wrap>(values, "wrap");
    options.output = rows::chosen_output(values);
    options.source_overscan = source.overscan.has_value();
    options.data = rows::data_of(values, source, options.filter);
    options.adds_alpha = rows::adds_alpha(values, source.has_alpha,
                                          options.wrap == Wrap::automatic || options.wrap == Wrap::black);
    return options;
}

Attribute TakenSource::says() const {
    return {"anamorph:from", std::string(name_of(chart.projection())) + " (" + reason + ")"};
}

TakenSource read_source(const ParameterValues& values, const SourceFacts& facts) {
    const auto [from, reason] = source_projection(values, facts);
    const auto spacing = chosen<PixelSpacing>(values, "pixels");
    const auto [fov, fov_reason] = source_field_of_view(values, facts, from, spacing);
    const bool says_lens = !values.given("srclens") && facts.lens && facts.projection == from;
    const LensModel srclens = says_lens ? *facts.lens : lens_of(values, "srclens");
    check_numbers(values, "src", "from", from);
    const Distance d = source_distance(values, facts, from);
    const bool has_vfov = is_given(values, "srcvfov"),
               is_asked = asked_fov(values, "src", from, d).has_value(),
               is_said = facts.fov && facts.projection == from;
    CutView cut{fov, 0, {}};
    std::string whole;
    if (facts.has_impossible_crop && !is_given(values, "srccrop"))
        whole = ", not the part that GPano:CroppedArea... says, which cannot be";
    if (const std::optional<PanoramaCrop> crop = source_crop(values, facts, from)) {
        if (spacing == PixelSpacing::centers)
            throw Error("pixels", "centers", "must be edges of a part of a panorama");
        if (srclens.kind != LensModel::Kind::none)
            throw Error("srclens", srclens.text(), "must not be given of a part of a panorama");
        // Metadata are of panoramas of 180 degrees from top to bottom, where these are the rows' unit.
        const bool by_metadata = !is_given(values, "srccrop") && from == Projection::equirectangular;
        const double vfov = has_vfov                                         ? values.number("srcvfov")
                            : by_metadata && crop->width != 2 * crop->height ? 180
                            : !by_metadata && facts.pixel_aspect != 1
                                ? vfov_by_fov(from, fov, crop->width, crop->height, d, facts.pixel_aspect)
                                : 0;
        cut = cut_to(*crop, from, facts, fov, vfov);
        whole = ", a part of " + shortest(crop->width) + "x" + shortest(crop->height) + " at " +
                shortest(crop->x) + "," + shortest(crop->y);
    } else if (has_vfov) {
        // What made the horizontal field of view has square pixels.
        if (rows_turn(from) || is_asked || is_said || facts.pixel_aspect != 1)
            cut.vertical.fov = values.number("srcvfov");
    } else if (facts.vfov && is_said && !is_asked) {
        cut.vertical.fov = *facts.vfov;
    } else if (facts.pixel_aspect != 1) {
        // Fields of view run between the outer pixels' centres, or their edges.
        const double edge = spacing == PixelSpacing::centers ? 1 : 0;
        cut.vertical.fov =
            vfov_by_fov(from, fov, facts.width - edge, facts.height - edge, d, facts.pixel_aspect);
    }
    const Padding said = facts.projection == from ? facts.padding.value_or(Padding()) : Padding(),
                  padding = padding_of(values, "srcpadding").value_or(said);
    return {
        Chart(from, facts.width, facts.height, cut.fov, spacing, "src", d, srclens, cut.vertical, padding),
        reason + fov_reason + whole, cut.ahead};
}

Orientation read_held(const ParameterValues& values, const SourceFacts& facts, const TakenSource& source) {
    const auto angle = [&](const char* name, const std::optional<double>& said) {
        return values.given(name) ? values.number(name) : said.value_or(0);
    };
    return {angle("srcyaw", facts.yaw), angle("srcpitch", facts.pitch), angle("srcroll", facts.roll),
            source.ahead};
}

ReprojectRequest read_reproject_request(const ParameterValues& values, const SourceFacts& facts) {
    const TakenSource source = read_source(values, facts);
    ReprojectOptions options = read_reproject_options(values, facts);
    const std::optional<machine::BumpUnit> machine = machine_of(values);
    if (!machine) options.scheme = chosen<Scheme>(values, "scheme");
    const auto [target, look] = read_target_view(values, source.chart);
    options.overscan = read_overscan(values, target);
    return {source, target, look, read_held(values, facts, source), options, machine};
}

std::optional<Chart> half_size(const Chart& chart) {
    const FaceGrid faces = faces_of(chart.projection());
    const int columns = std::max(1, faces.columns), rows = std::max(1, faces.rows);
    const int w = chart.width() / columns, h = chart.height() / rows;
    if (w == 1 && h == 1) return {};
    return chart.resized(std::max(1, w / 2) * columns, std::max(1, h / 2) * rows);
}

std::optional<PanoramaLevel> panorama_level(const Chart& target, const ReprojectOptions& options,
                                            PixelKind pixels, int level) {
    if (level > 0 && !(options.overscan == Size{})) return {};
    PanoramaLevel made{target, {}};
    for (; level > 0; --level) {
        const std::optional<Chart> half = half_size(made.target);
        if (!half) return {};
        made.target = *half;
    }
    made.request.size = {made.target.width(), made.target.height()};
    made.request.add_overscan(options.overscan);
    made.request.pixels = pixels;
    made.request.adds_alpha = options.adds_alpha;
    made.request.says = panorama_attributes(made.target, pixels == PixelKind::color);
    return made;
}

namespace {

/// A panorama drawn by a bump unit.
std::unique_ptr<const SolvedPicture> bumped_picture(const ReprojectRequest& request) {
    if constexpr (kIsSmall) refuse_left_out("scheme=hardware");
    const auto plan = std::make_shared<machine::BumpedPanorama>(request.map(), *request.machine);
    Picture picture = picture_through(plan, Border(request.source.chart, request.options.wrap),
                                      request.options.filter, request.options.output);
    picture.says = [plan](const ParallelFor& parallel_for) -> Attributes {
        return {{"anamorph:saturated_pixels", double(plan->saturated_pixels(parallel_for))}};
    };
    picture.reached_by_drawing = true;
    return solved(std::move(picture), {{"anamorph:saturated_texels", plan->saturated_texels()}});
}

class Panos final : public Pictures {
  public:
    /// `pair`: of a source of two fisheyes that are drawn each by itself.
    explicit Panos(const ReprojectRequest& request, const std::optional<FisheyePair>& pair = {})
        : m_request(request), m_pair(pair) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        ReprojectRequest request = m_request;
        std::optional<PanoramaLevel> made =
            panorama_level(request.target, request.options, pixels_of(request.options.output), level);
        if (!made) return {};
        request.target = made->target;
        PictureRequest& picture = made->request;
        if (picture.pixels == PixelKind::color && request.options.filter == Filter::nearest && !m_pair)
            picture.moves = 0;
        if (picture.pixels == PixelKind::color) picture.moved_channels = moved_channels(request.options.data);
        if (!request.machine) picture.says.push_back({"anamorph:tol", request.options.tol});
        picture.says.push_back(request.source.says());
        picture.solve = [request, pair = m_pair] {
            if (request.machine) return bumped_picture(request);
            return solved(pair ? pair->picture(request)
                               : reprojected_picture(request.map(), request.options));
        };
        return std::move(picture);
    }

    SourceFaces faces() const override { return faces_of(m_request.source.chart); }

  private:
    ReprojectRequest m_request;
    std::optional<FisheyePair> m_pair;
};

/// The pictures of a source that is one panorama.
std::unique_ptr<const Pictures> panos(const OperationInput& input, const SourceFacts& facts) {
    const bool is_formula = has_formula(input.values), is_pair = asks_for_fisheye_pair(input);
    std::unique_ptr<const Pictures> pictures = film_pictures(
        input,
        [is_formula, is_pair, facts](const ParameterValues& values) -> std::unique_ptr<const Pictures> {
            refuse_rows_of_projects(values);
            if (is_formula) return pictures_of_formula(values, facts);
            const ReprojectRequest request = read_reproject_request(values, facts);
            return std::make_unique<Panos>(
                request, is_pair ? std::optional(FisheyePair(values, request.source.chart)) : std::nullopt);
        });
    if (!is_pair) return pictures;
    return pictures_of_both(std::move(pictures), read_source(input.values, facts).chart);
}

}  // namespace

std::unique_ptr<const Pictures> reprojected_pictures(const ReprojectRequest& request) {
    return std::make_unique<Panos>(request);
}

const Operation& pano_operation() {
    static const ParameterTable table = make_pano_table();
    static const Operation operation{
        .name = "pano",
        .title = "A panorama seen through another lens",
        .parameters = &table,
        .sources = {"src"},
        .least_sources = 1,
        .example = {"from=equirectangular&to=equirectangular&yaw=40&pitch=20", {}},
        .make = [](const OperationInput& input) -> std::unique_ptr<const Pictures> {
            if (is_of_project(input.files)) {
                if constexpr (kIsSmall)
                    refuse_left_out("a project of Hugin");
                else
                    return pictures_of_project(input);
            }
            const Eyes eyes(input.values, input.sources[0].facts);
            return eyes.pictures(panos(input, eyes.facts_of_one()));
        },
        .main_file = "src",
        .endings = {"pto"},
        .linked = kIsSmall ? nullptr : images_of_project,
        .reads_faces = true};
    return operation;
}

}  // namespace anamorph
