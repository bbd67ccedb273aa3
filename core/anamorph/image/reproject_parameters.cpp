// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/reproject_parameters.h"

#include <algorithm>
#include <cmath>

#include "anamorph/image/picture_parameters.h"

namespace anamorph {
namespace {

using rows::chosen;

// In the order of their enumerations.
const std::vector<std::string> kSpacings = {"edges", "centers"};
const std::vector<std::string> kWraps = {"automatic", "black", "clamp", "periodic", "mirror"};
const std::vector<std::string> kSchemes = {"auto", "exact", "blocks", "residual"};
const std::vector<std::string> kOutputs = {"color", "stmap", "error", "bound"};

std::vector<std::string> projections() {
    std::vector<std::string> names = {"latlong"};
    for (int i = 0; i <= static_cast<int>(Projection::cubecross); ++i)
        names.insert(names.end() - 1, std::string(name_of(static_cast<Projection>(i))));
    return names;
}

ParameterTable make_table() {
    using namespace rows;
    return {
        image(
            "src",
            "the source image; by default the recipe's name without .pano; in a name it stands last when it "
            "has arguments of its own"),
        choice("from", "", projections(),
               "projection of the source; by default what the image says of itself, else by its shape: 2:1 "
               "equirectangular, 1:6 cubemap (anamorph:from tells what was assumed)"),
        choice("to", "rectilinear", projections(), "projection of the picture"),
        above(number(
            "srcfov", "degrees", "", 0, 360,
            "horizontal field of view of the source, edge to edge; by default what the image says of itself, "
            "else 360 for equirectangular, cylindrical and mercator, 180 for fisheye, equisolid and "
            "stereographic, 90 for rectilinear and cube faces")),
        above(
            number("fov", "degrees", "", 0, 360,
                   "horizontal field of view of the picture, edge to edge: below 180 for rectilinear, below "
                   "360 for stereographic, 90 for cube faces; defaults by projection as for srcfov")),
        number("yaw", "degrees", "0", -kInfinity, kInfinity, "where the camera looks: to the right"),
        number("pitch", "degrees", "0", -kInfinity, kInfinity, "where the camera looks: up"),
        number("roll", "degrees", "0", -kInfinity, kInfinity,
               "the camera's turn about its axis, clockwise; roll is applied first, then pitch, then yaw"),
        size("width and height of the picture, or its width alone; by default as fine as the source at the "
             "centre"),
        tile(),
        mip(),
        filter(),
        choice("wrap", "automatic", kWraps,
               "what lies beyond the source's edge; automatic goes on across the seam, the poles and cube "
               "edges"),
        tol(),
        choice("pixels", "edges", kSpacings,
               "where the source's field of view ends: at the edges of its outer pixels or at their centers"),
        choice("scheme", "auto", kSchemes, "how source points are found within tol"),
        colorspace("color space to filter in; by default the source's own"),
        choice("output", "color", kOutputs,
               "color, or per pixel: stmap, the source point (u, v) with v down, in 0 to 1 on the source, "
               "beyond that beyond its edges, (-1, -1) where there is none; error, its distance from the "
               "exact one in source pixels; bound, the proven bound of that"),
    };
}

/// Height over width of the picture of a projection.
double natural_aspect(Projection projection, double fov) {
    switch (projection) {
        case Projection::equirectangular:
            return std::min(fov, 180.0) / fov;
        // 90 degrees of elevation: 2 tan 45 over the azimuth.
        case Projection::cylindrical:
            return 2 / (fov * std::numbers::pi / 180);
        case Projection::cubemap:
            return 6;
        case Projection::cubemap3x2:
            return 2.0 / 3;
        case Projection::cubecross:
            return 3.0 / 4;
        default:
            return 1;
    }
}

int columns_of_faces(Projection projection) {
    return projection == Projection::cubemap3x2 ? 3 : projection == Projection::cubecross ? 4 : 1;
}

SizeValue natural_size(Projection projection, double fov, double width) {
    const double limit = kMaxSide;
    const int w = static_cast<int>(std::clamp(std::round(width), 1.0, limit));
    const int h = static_cast<int>(std::clamp(std::round(w * natural_aspect(projection, fov)), 1.0, limit));
    return {w, h};
}

/// The picture's size where none was given: as many pixels per radian at its centre as the source has.
SizeValue default_size(Projection projection, double fov, const Chart& source) {
    const int probe = 1200;  // holds whole faces of every cube layout
    const SizeValue shape = natural_size(projection, fov, probe);
    const Chart chart(projection, shape.width, shape.height, fov);
    const double width = probe * source.scale_x() / chart.scale_x();
    const double most = kMaxDefaultSize / std::max(1.0, natural_aspect(projection, fov));
    const int faces = columns_of_faces(projection);
    const double face = std::max(1.0, std::min(std::round(width / faces), std::floor(most / faces)));
    return natural_size(projection, fov, face * faces);
}

struct Taken {
    Projection projection;
    std::string reason;
};

/// What the source is taken for, and why.
Taken source_projection(const ParameterValues& values, const SourceFacts& source) {
    if (values.given("from")) return {projection_from_name(values.text("from"), "from"), "given"};
    if (source.projection) return {*source.projection, "as " + source.said_by + " says"};
    if (std::int64_t{source.width} == std::int64_t{source.height} * 2)
        return {Projection::equirectangular, "assumed from the 2:1 shape"};
    if (std::int64_t{source.width} * 6 == source.height)
        return {Projection::cubemap, "assumed from the 1:6 shape"};
    throw Error("from is not given and the source (" + std::to_string(source.width) + "x" +
                std::to_string(source.height) + ") does not say its projection: must be one of " +
                projection_names());
}

double field_of_view(const ParameterValues& values, std::string_view name, Projection projection) {
    if (!values.given(name)) return Chart::default_fov(projection);
    return values.number(name);
}

}  // namespace

const ParameterTable& reproject_parameters() {
    static const ParameterTable table = make_table();
    return table;
}

ReprojectRequest read_reproject_request(const ParameterValues& values, const SourceFacts& facts) {
    const auto [from, reason] = source_projection(values, facts);
    const bool says_fov = !values.given("srcfov") && facts.fov && facts.projection == from;
    const Chart source(from, facts.width, facts.height,
                       says_fov ? *facts.fov : field_of_view(values, "srcfov", from),
                       chosen<PixelSpacing>(values, "pixels", kSpacings), "src");

    const Projection to = projection_from_name(values.text("to"), "to");
    const double fov = field_of_view(values, "fov", to);
    // Reports a field of view that the lens cannot have before a size is made of it.
    const int probe = 12;
    static_cast<void>(
        Chart(to, probe, is_cube(to) ? static_cast<int>(probe * natural_aspect(to, fov)) : probe, fov));

    SizeValue size;
    if (!values.given("size")) {
        size = default_size(to, fov, source);
    } else {
        size = values.extent("size");
        if (size.height < 0) size = natural_size(to, fov, size.width);
    }

    ReprojectOptions options;
    options.scheme = chosen<Scheme>(values, "scheme", kSchemes);
    options.tol = values.number("tol");
    options.filter = chosen<Filter>(values, "filter", rows::filters());
    options.wrap = chosen<Wrap>(values, "wrap", kWraps);
    options.output = chosen<Output>(values, "output", kOutputs);
    return {source,
            Chart(to, size.width, size.height, fov),
            {values.number("yaw"), values.number("pitch"), values.number("roll")},
            options,
            reason};
}

std::optional<Chart> half_size(const Chart& chart) {
    const int columns = columns_of_faces(chart.projection());
    const int rows = is_cube(chart.projection()) ? chart.height() / (chart.width() / columns) : 1;
    const int w = chart.width() / columns, h = chart.height() / rows;
    if (w == 1 && h == 1) return {};
    return Chart(chart.projection(), std::max(1, w / 2) * columns, std::max(1, h / 2) * rows, chart.fov(),
                 chart.spacing());
}

}  // namespace anamorph
