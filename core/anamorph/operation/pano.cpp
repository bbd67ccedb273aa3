// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/pano.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "anamorph/machine/machine_text.h"
#include "anamorph/operation/flat_picture.h"
#include "anamorph/operation/pano_formula.h"
#include "anamorph/operation/panorama_attributes.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"

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

ParameterTable make_pano_table() {
    using namespace rows;
    ParameterTable table = {
        image("src",
              "the source image; by default the recipe's name without .pano; in a name it stands last when "
              "it has arguments of its own"),
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
        number("srcd", "", "1", 0, Chart::kMostDistance,
               "Pannini's distance d of the source, for from=pannini"),
        number("d", "", "1", 0, Chart::kMostDistance,
               "Pannini's distance d of the picture, for to=pannini: 0 is rectilinear, 1 the usual one; fov "
               "stays below the angle at which d + cos or 1 + d cos of its half is 0"),
        number("yaw", "degrees", "0", -kInfinity, kInfinity, "where the camera looks: to the right"),
        number("pitch", "degrees", "0", -kInfinity, kInfinity, "where the camera looks: up"),
        number("roll", "degrees", "0", -kInfinity, kInfinity,
               "the camera's turn about its axis, clockwise; roll is applied first, then pitch, then yaw"),
        number("srcyaw", "degrees", "0", -kInfinity, kInfinity,
               "how the source's camera was held: turned to the right"),
        number("srcpitch", "degrees", "0", -kInfinity, kInfinity,
               "how the source's camera was held: tilted up"),
        number("srcroll", "degrees", "0", -kInfinity, kInfinity,
               "how the source's camera was held: turned about its axis, clockwise; in the same order"),
        text("srclens",
             "distortion of the source, as for lens; by default what the image says of itself, else none"),
        text("lens",
             "distortion of the picture: none, or MODEL:name=value,name=value with ptlens (a, b, c), brown "
             "(k1 to k6, p1, p2), 3de4 (k1, k2) or kb4 (k1 to k4), and d, e, the shift of its centre in "
             "pixels; by default none; fields of view are those without distortion"),
        size("width and height of the picture, or its width alone; by default as fine as the source at the "
             "centre"),
        subimage(),
        concatenate(),
        tile(),
        mip(),
        filter(),
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
        flip_v(),
    };
    const ParameterTable of_formula = ray_rows();
    table.insert(table.end(), of_formula.begin(), of_formula.end());
    return table;
}

Size natural_size(Projection projection, double fov, double width) {
    const double limit = kMaxSide;
    const int w = static_cast<int>(std::clamp(std::round(width), 1.0, limit));
    const int h = static_cast<int>(std::clamp(std::round(w * natural_aspect(projection, fov)), 1.0, limit));
    return {w, h};
}

/// The picture's size where none was given: as many pixels per radian at its centre as the source has. `magnified`: by
/// its lens there.
Size default_size(Projection projection, double fov, double d, double magnified, const Chart& source) {
    const int probe = 1200;  // holds whole faces of every cube layout
    const Size shape = natural_size(projection, fov, probe);
    const Chart chart(projection, shape.width, shape.height, fov, PixelSpacing::edges, "", d);
    const double width =
        probe * source.pixels_per_radian() / (chart.pixels_per_radian() * std::max(magnified, 1e-3));
    const double most = kMaxDefaultSize / std::max(1.0, natural_aspect(projection, fov));
    const int faces = std::max(1, faces_of(projection).columns);
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

struct TakenFieldOfView {
    double degrees;
    std::string reason;  ///< where it goes without saying, nothing
};

/// The field of view of the source: what was asked for or what it says of itself, else by its camera's focal
/// length, else the projection's.
TakenFieldOfView source_field_of_view(const ParameterValues& values, const SourceFacts& facts,
                                      Projection projection, PixelSpacing spacing) {
    if (values.given("srcfov")) return {values.number("srcfov"), ""};
    if (facts.fov && facts.projection == projection) return {*facts.fov, ""};
    const auto with_reason = [](double degrees, const std::string& reason) {
        return TakenFieldOfView{degrees, ", " + rounded_degrees(degrees) + " degrees " + reason};
    };
    const double standard = Chart::default_fov(projection);
    if (projection != Projection::rectilinear) return {standard, ""};
    if (!facts.focal_length) return with_reason(standard, "assumed");
    return with_reason(
        flat_field_of_view(facts.width - (spacing == PixelSpacing::centers ? 1 : 0), *facts.focal_length),
        "as " + facts.focal_length_said_by + " says");
}

LensModel lens_of(const ParameterValues& values, const std::string& name) {
    return values.given(name) ? LensModel::parse(values.text(name), name) : LensModel{};
}

/// The machine of scheme hardware. What is said of a machine is checked with the other schemes too.
std::optional<machine::BumpUnit> machine_of(const ParameterValues& values) {
    const machine::BumpUnit unit =
        values.given("machine") ? machine::bump_unit_from_text(values.text("machine")) : machine::BumpUnit{};
    if (values.text("scheme") != "hardware") return {};
    return unit;
}

}  // namespace

Chart read_target_chart(const ParameterValues& values, const Chart& source) {
    const Projection to = projection_from_name(values.text("to"), "to");
    const double fov = field_of_view(values, "fov", to), d = values.number("d");
    const LensModel lens = lens_of(values, "lens");
    const auto chart = [&](int width, int height, const LensModel& through) {
        return Chart(to, width, height, fov, PixelSpacing::edges, "", d, through);
    };
    // Reports a field of view that the lens cannot have before a size is made of it.
    const int probe = 12;
    static_cast<void>(
        chart(probe, has_faces(to) ? static_cast<int>(probe * natural_aspect(to, fov)) : probe, {}));

    Size size;
    if (!values.given("size")) {
        size = default_size(to, fov, d, lens.magnification(), source);
    } else {
        size = values.extent("size");
        if (size.height < 0) size = natural_size(to, fov, size.width);
    }
    return chart(size.width, size.height, lens);
}

Orientation read_orientation(const ParameterValues& values) {
    return {values.number("yaw"), values.number("pitch"), values.number("roll")};
}

ReprojectOptions read_reproject_options(const ParameterValues& values, const SourceFacts& source) {
    ReprojectOptions options;
    options.tol = values.number("tol");
    options.filter = chosen<Filter>(values, "filter");
    options.wrap = chosen<Wrap>(values, "wrap");
    options.output = rows::chosen_output(values);
    options.overscan = source.overscan.has_value();
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
    return {Chart(from, facts.width, facts.height, fov, spacing, "src", values.number("srcd"), srclens),
            reason + fov_reason};
}

Orientation read_held(const ParameterValues& values) {
    return {values.number("srcyaw"), values.number("srcpitch"), values.number("srcroll")};
}

ReprojectRequest read_reproject_request(const ParameterValues& values, const SourceFacts& facts) {
    const TakenSource source = read_source(values, facts);
    ReprojectOptions options = read_reproject_options(values, facts);
    const std::optional<machine::BumpUnit> machine = machine_of(values);
    if (!machine) options.scheme = chosen<Scheme>(values, "scheme");
    return {
        source, read_target_chart(values, source.chart), read_orientation(values), read_held(values), options,
        machine};
}

std::optional<Chart> half_size(const Chart& chart) {
    const FaceGrid faces = faces_of(chart.projection());
    const int columns = std::max(1, faces.columns), rows = std::max(1, faces.rows);
    const int w = chart.width() / columns, h = chart.height() / rows;
    if (w == 1 && h == 1) return {};
    return chart.resized(std::max(1, w / 2) * columns, std::max(1, h / 2) * rows);
}

namespace {

/// A panorama drawn by a bump unit.
Picture bumped_picture(const ReprojectRequest& request) {
    const auto plan = std::make_shared<machine::BumpedPanorama>(request.map(), *request.machine);
    Picture picture = picture_through(plan, Border(request.source.chart, request.options.wrap),
                                      request.options.filter, request.options.output);
    picture.says = [plan](const ParallelFor& parallel_for) -> Attributes {
        return {{"anamorph:saturated_pixels", double(plan->saturated_pixels(parallel_for))},
                {"anamorph:saturated_texels", plan->saturated_texels()}};
    };
    picture.reached_by_drawing = true;
    return picture;
}

class Panos final : public Pictures {
  public:
    explicit Panos(const ReprojectRequest& request) : m_request(request) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        ReprojectRequest request = m_request;
        for (; level > 0; --level) {
            const std::optional<Chart> half = half_size(request.target);
            if (!half) return {};
            request.target = *half;
        }
        PictureRequest picture;
        picture.size = {request.target.width(), request.target.height()};
        picture.pixels = pixels_of(request.options.output);
        picture.says = panorama_attributes(request.target, picture.pixels == PixelKind::color);
        if (picture.pixels == PixelKind::color && request.options.filter == Filter::nearest)
            picture.moves = 0;
        if (!request.machine) picture.says.push_back({"anamorph:tol", request.options.tol});
        picture.says.push_back(request.source.says());
        picture.solve = [request] {
            return solved(request.machine ? bumped_picture(request)
                                          : reprojected_picture(request.map(), request.options));
        };
        return picture;
    }

    SourceFaces faces() const override { return faces_of(m_request.source.chart); }

  private:
    ReprojectRequest m_request;
};

}  // namespace

const Operation& pano_operation() {
    static const ParameterTable table = make_pano_table();
    static const Operation operation{
        "pano",
        "A panorama seen through another lens",
        &table,
        {"src"},
        1,
        {"from=equirectangular&to=equirectangular&yaw=40&pitch=20", {}},
        [](const OperationInput& input) -> std::unique_ptr<const Pictures> {
            const SourceFacts& facts = input.sources[0].facts;
            if (has_formula(input.values)) return pictures_of_formula(input.values, facts);
            return std::make_unique<Panos>(read_reproject_request(input.values, facts));
        }};
    return operation;
}

}  // namespace anamorph
