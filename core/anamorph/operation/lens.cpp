// SPDX-License-Identifier: Apache-2.0
// A lens's distortion taken off a picture, or put on one.
#include "anamorph/lens/lens_plan.h"
#include "anamorph/operation/flat_picture.h"
#include "anamorph/operation/panorama_attributes.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"

namespace anamorph {
namespace {

using rows::chosen;
using rows::flat_field_of_view;
using rows::rounded_degrees;

const char* const kAll = "all";

ParameterTable make_lens_table() {
    using namespace rows;
    Parameter extent = size(
        "width and height of the picture, or its width alone, about the same middle and as fine as the "
        "source; all: the source's, with a data window that holds all that is left of the source; by default "
        "the "
        "source's");
    extent.choices = {kAll};
    return {
        image("src", "the source image; by default the recipe's name without .lens"),
        enumeration(
            "mode", "undistort", {{"undistort", LensMode::undistort}, {"distort", LensMode::distort}},
            "undistort: the source was taken through the lens, and the picture is free of it; distort: "
            "the other way round, with the picture of the size that the lens is of"),
        text("lens",
             "MODEL:name=value,name=value with ptlens (a, b, c, g, t), brown (k1 to k6, p1, p2, s1 to s4), "
             "3de4 "
             "(k1, k2), "
             "kb4 (k1 to k4), division (k1, k2), poly (k0 to k4) or ocam (a0, a2, a3, a4, affine_c to "
             "affine_e), and d, e, the "
             "shift of its "
             "centre in pixels, which stays where it is; or lensfun:lens=NAME,camera=NAME,focal=35; by "
             "default what the "
             "image says of itself"),
        above(number("fov", "degrees", "", 0, 360,
                     "horizontal field of view of the picture that was taken through the lens, without the "
                     "distortion; brown (below 180) and kb4, whose unit is the focal length, need it, "
                     "pictures of others only say it; by default what the image says of itself, for brown "
                     "also by Exif's focal length")),
        extent,
        overscan(),
        subimage(),
        concatenate(),
        tile(),
        mip(),
        hash(),
        filter(),
        clamp(),
        data_channels(),
        data_filter(),
        wrap("is black"),
        tol(),
        scheme({{"auto", Scheme::automatic},
                {"exact", Scheme::exact},
                {"blocks", Scheme::blocks},
                {"residual", Scheme::residual}}),
        colorspace("color space to filter in; by default the source's own"),
        output(),
        alpha(),
        flip_v(),
    };
}

/// The picture as the lens gives it, and what was taken for its field of view, if that was not said outright.
struct Observed {
    Chart chart;
    std::optional<double> fov = {};  ///< its field of view, where that is known
    Attributes says = {};
};

LensModel model_of(const ParameterValues& values, const SourceFacts& facts) {
    const LensModel model = values.given("lens") ? LensModel::parse(values.text("lens"))
                            : facts.lens         ? *facts.lens
                                                 : LensModel{};
    if (model.kind != LensModel::Kind::none) return model;
    if (values.given("lens"))
        throw Error("lens", printable(values.text("lens")), "must be a lens, as in ptlens:b=-0.02");
    throw Error::not_given("lens", " and the source does not say it: must be given, as in ptlens:b=-0.02");
}

/// The vertical field of view that pixels of that shape make; none where they are square.
VerticalField vertical_field(Projection projection, const Size& size, double fov, double pixel_aspect) {
    if (pixel_aspect == 1) return {};
    const double width = plane_width(projection, fov),
                 height = width / size.width * size.height / pixel_aspect;
    const double degrees = vfov_of_plane_height(projection, height);
    if (!(plane_height(projection, degrees) >= height * (1 - 1e-9)))
        throw Error("fov", shortest(fov),
                    "is too much: with PixelAspectRatio=" + shortest(static_cast<float>(pixel_aspect)) +
                        " the picture is higher than " + std::string(name_of(projection)) + " shows");
    return {degrees};
}

Observed observed_picture(const ParameterValues& values, const SourceFacts& facts, const Size& size) {
    const LensModel model = model_of(values, facts);
    const bool fisheye = model.kind == LensModel::Kind::kb4;
    const bool by_focal_length = fisheye || model.kind == LensModel::Kind::brown;
    const Projection projection = fisheye ? Projection::fisheye : Projection::rectilinear;
    const auto chart = [&](double fov) {
        return Chart(projection, size.width, size.height, fov, PixelSpacing::edges, "", 1, model,
                     vertical_field(projection, size, fov, facts.pixel_aspect));
    };
    const auto with = [&](double fov, Attributes says = {}) {
        return Observed{chart(fov), fov, std::move(says)};
    };
    // Its focal length is a0.
    if (model.kind == LensModel::Kind::ocam) {
        if (model.values[0] == 0) throw Error("lens", model.text(), "must have an a0 other than 0");
        const double fov =
            fov_of_plane_width(Projection::stereographic, size.width / std::fabs(model.values[0]));
        return {Chart(Projection::stereographic, size.width, size.height, fov, PixelSpacing::edges, "", 1,
                      model, vertical_field(Projection::stereographic, size, fov, facts.pixel_aspect)),
                fov};
    }
    std::optional<double> known;
    if (values.given("fov"))
        known = values.number("fov");
    else if (facts.fov && facts.projection == projection)
        known = facts.fov;
    // Of the other models nothing depends on it, but what is said of the picture.
    if (!by_focal_length) {
        if (known) static_cast<void>(chart(*known));
        return {chart(Chart::default_fov(projection)), known};
    }
    if (known) return with(*known);
    if (!fisheye && facts.focal_length) {
        const double fov = flat_field_of_view(size.width, *facts.focal_length);
        Attributes says;
        says.push_back(
            {"anamorph:fov", rounded_degrees(fov) + " degrees as " + facts.focal_length_said_by + " says"});
        return with(fov, std::move(says));
    }
    throw Error::not_given("fov", " and the source does not say it: must be given for lens=" + model.text());
}

/// The least size about the middle of a source's picture in which all of its pixels are.
Size size_around(const SourceFacts& facts) {
    const Size size{facts.width, facts.height};
    const Box all = facts.overscan.value_or(Box{0, 0, size.width, size.height});
    return {std::max(size.width - 2 * all.x0, 2 * all.x1 - size.width),
            std::max(size.height - 2 * all.y0, 2 * all.y1 - size.height)};
}

/// A picture of `size` in the middle of a larger one; the sizes differ by whole pixels on both sides.
Box in_middle_of(const Size& larger, const Size& size) {
    const int x = (larger.width - size.width) / 2, y = (larger.height - size.height) / 2;
    return {x, y, x + size.width, y + size.height};
}

/// What the picture says of itself: of which field of view it was taken, and, where that is known, what it shows.
std::shared_ptr<const Attributes> said_of(Observed& observed, LensMode mode, const Size& target,
                                          double pixel_aspect) {
    auto says = std::make_shared<Attributes>(std::move(observed.says));
    const Chart& chart = observed.chart;
    if (!observed.fov) return says;
    const LensModel& model = chart.lens()->model();
    const double width = plane_width(chart.projection(), *observed.fov) / chart.width() * target.width,
                 fov = fov_of_plane_width(chart.projection(), width);
    // A picture that shows more than its projection can has no field of view, nor one whose lens's centre stays beside its middle.
    const bool is_centred = model.values[model.values.size() - 2] == 0 && model.values.back() == 0;
    if (!(plane_width(chart.projection(), fov) >= width * (1 - 1e-9)) || !is_centred) return says;
    // Lenses whose unit is a length of the picture are others in a picture of another size.
    const bool is_by_size = model.kind != LensModel::Kind::brown && model.kind != LensModel::Kind::kb4 &&
                            model.kind != LensModel::Kind::ocam;
    if (mode == LensMode::distort && is_by_size && !(target == Size{chart.width(), chart.height()}))
        return says;
    const Chart shown(chart.projection(), target.width, target.height,
                      target.width == chart.width() ? *observed.fov : fov, PixelSpacing::edges, "", 1,
                      mode == LensMode::distort ? model : LensModel{},
                      vertical_field(chart.projection(), target, fov, pixel_aspect));
    for (Attribute& attribute : panorama_attributes(shown, false)) says->push_back(std::move(attribute));
    return says;
}

std::unique_ptr<const Pictures> pictures_of_lens(const ParameterValues& values, const SourceFacts& facts) {
    const Size source{facts.width, facts.height};
    const auto mode = chosen<LensMode>(values, "mode");
    const bool all = values.text("size") == kAll;
    const Size asked = all ? source : rows::size_of(values, source);
    Observed observed = observed_picture(values, facts, mode == LensMode::distort ? asked : source);
    const Size target = all ? LensMap::covering(observed.chart, mode, size_around(facts)) : asked;
    if (target.width > kMaxSide || target.height > kMaxSide)
        throw Error("size", kAll,
                    "makes " + std::to_string(target.width) + "x" + std::to_string(target.height) +
                        " pixels: must be at most " + std::to_string(kMaxSide) + " either way");
    if (all && values.given("overscan"))
        throw Error("overscan", printable(values.text("overscan")),
                    "must not be given together with size=all, which is as much as there is");
    FlatRequest request = flat_request(values, facts, target);
    request.says = said_of(observed, mode, target, facts.pixel_aspect);
    add_to(request, said_of_pixels(facts.pixel_aspect));
    if (!(target == asked)) request.display = in_middle_of(target, asked);
    return flat_pictures(request, [request, chart = observed.chart, mode](const Size& pixels) {
        return FlatMap{std::make_shared<LensPlan>(
            LensMap(chart, mode, request.target, pixels, request.source_size()), request.plan)};
    });
}

}  // namespace

const Operation& lens_operation() {
    static const ParameterTable table = make_lens_table();
    static const Operation operation{
        "lens",
        "The distortion of a lens taken off a flat picture, or put on one",
        &table,
        {"src"},
        1,
        {"fov=120&lens=kb4:k1=0.05,k2=0.01", {}},
        [](const OperationInput& input) { return pictures_of_lens(input.values, input.sources[0].facts); }};
    return operation;
}

}  // namespace anamorph
