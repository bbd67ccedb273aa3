// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/pano_formula.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "anamorph/number/hypot.h"
#include "anamorph/operation/flat_picture.h"
#include "anamorph/operation/pano.h"
#include "anamorph/operation/rows.h"
#include "anamorph/panorama/formula_view_plan.h"
#include "anamorph/panorama/inverse_view_plan.h"
#include "anamorph/parameter/left_out.h"

namespace anamorph {
namespace {

const char* const kFormula = "formula";
const char* const kRays[] = {"ray_x", "ray_y", "ray_z"};
const char* const kPoints[] = {"point_x", "point_y"};

bool is_any_given(const ParameterValues& values, std::span<const char* const> names) {
    return std::any_of(names.begin(), names.end(), [&](const char* name) { return values.given(name); });
}
void set_if_given(const ParameterValues& values, const char* name, std::string& text) {
    if (values.given(name)) text = values.text(name);
}

RayText rays_of(const ParameterValues& values) {
    RayText text;
    set_if_given(values, "ray_x", text.x);
    set_if_given(values, "ray_y", text.y);
    set_if_given(values, "ray_z", text.z);
    set_if_given(values, "let", text.let);
    text.definitions = values.definitions();
    return text;
}
DirectionText directions_of(const ParameterValues& values) {
    DirectionText text;
    set_if_given(values, "point_x", text.x);
    set_if_given(values, "point_y", text.y);
    set_if_given(values, "let", text.let);
    text.definitions = values.definitions();
    return text;
}

/// The picture's formula, one way or the other, with its pixels for a radian next to its middle.
struct RayFormula {
    SpaceFormula rays;

    FlatMap plan(const Chart& source, const Size& picture, const Size& pixels, const Orientation& look,
                 const Orientation& held, const PlanOptions& options) const {
        return with_undefined_fraction(std::make_shared<const FormulaViewPlan>(
            FormulaView(source, rays, picture, pixels, look, held), options));
    }
    double pixels_per_radian(const Size& picture) const {
        using J = Jet1<double>;
        // Not in the middle itself, where r and a have no derivative.
        const double x = 0.5 * picture.width + 0.5, y = 0.5 * picture.height + 0.5;
        const auto [right, down, forward] =
            read_program<3>(rays.point, J::variable(x, 1, 0), J::variable(y, 0, 1));
        const glm::dvec3 ray(right.c[0], down.c[0], forward.c[0]), moved(right.c[1], down.c[1], forward.c[1]);
        return glm::dot(ray, ray) / glm::length(glm::cross(ray, moved));
    }
};
struct DirectionFormula {
    PlaneFormula points;

    FlatMap plan(const Chart& source, const Size& picture, const Size& pixels, const Orientation& look,
                 const Orientation& held, const PlanOptions& options) const {
        try {
            return with_undefined_fraction(std::make_shared<const InverseViewPlan>(
                InverseView(source, points, picture, pixels, look, held, options.overscan), options));
        } catch (const Error& error) {
            throw Error("point_x and point_y: " + std::string(error.what()));
        }
    }
    double pixels_per_radian(const Size&) const {
        using J = Jet1<double>;
        constexpr Size globe = InverseView::kGlobe;
        const auto [x, y] = read_program<2>(points.point, J::variable(0.5 * globe.width + 0.5, 1, 0),
                                            J::variable(0.5 * globe.height + 0.5, 0, 1));
        return hypot(x.c[1], y.c[1]) * globe.width / (2 * std::numbers::pi);
    }
};

RayFormula formula_of(const RayText& text, const FormulaSetting& setting) {
    return {parse_rays(text, setting)};
}
DirectionFormula formula_of(const DirectionText& text, const FormulaSetting& setting) {
    return {parse_directions(text, setting, InverseView::kGlobe)};
}

/// A square as fine as the source in the middle of both.
template <class Text>
Size natural_size(const Text& text, FormulaSetting setting, const Chart& source) {
    constexpr int kProbe = 1200;
    setting.picture = {kProbe, kProbe};
    const double density = formula_of(text, setting).pixels_per_radian(setting.picture);
    const double side = std::round(kProbe * source.pixels_per_radian() / density);
    if (!(side > 0 && side < HUGE_VAL))
        throw Error::not_given(
            "size",
            ", and in its middle the formula does not tell how fine the picture is: must be "
            "N or NxM");
    const int rounded = static_cast<int>(std::clamp(side, 1.0, double{kMaxDefaultSize}));
    return {rounded, rounded};
}

template <class Text>
std::unique_ptr<const Pictures> pictures_of(const Text& text, const ParameterValues& values,
                                            const SourceFacts& facts) {
    const TakenSource source = read_source(values, facts);
    FormulaSetting setting{{}, {facts.width, facts.height}, values.number("frame")};
    Size size = values.given("size") ? values.extent("size") : natural_size(text, setting, source.chart);
    if (size.height < 0) size.height = size.width;
    setting.picture = size;
    ReprojectOptions options = read_reproject_options(values, facts);
    options.scheme = rows::chosen<Scheme>(values, "scheme");
    rows::check_overscan(values);
    options.overscan = rows::overscan_of(values, size);
    FlatRequest request{source.chart, size,           plan_options(options), options.filter,
                        options.wrap, options.output, saying(source.says())};
    request.adds_alpha = options.adds_alpha;
    request.data = options.data;
    const Orientation look = read_orientation(values), held = read_held(values, facts, source);
    return flat_pictures(
        request, [formula = formula_of(text, setting), request, look, held](const Size& pixels) {
            return formula.plan(request.source, request.target, pixels, look, held, request.plan);
        });
}

void refuse_what_formulas_have_not(const ParameterValues& values) {
    for (const char* name :
         {"fov", "vfov", "focal", "sensor", "d", "e", "lens", "face", "padding", "front_yaw", "front_pitch",
          "front_roll", "back_yaw", "back_pitch", "back_roll", "seam"})
        if (values.given(name))
            throw Error(name, printable(values.text(name)),
                        "is of other projections than to=formula: must not be given");
    for (const char* scheme : {"direct", "hardware"})
        if (values.text("scheme") == scheme)
            throw Error("scheme", scheme,
                        "is of other projections than to=formula: must be auto, exact, blocks or residual");
    if (values.given("machine"))
        throw Error("machine", printable(values.text("machine")),
                    "is of scheme=hardware, which to=formula has not: must not be given");
}

}  // namespace

Parameter projection_or_formula(const char* name, const std::string& doc) {
    std::vector<std::string> names = projection_name_list();
    names.emplace_back(kFormula);
    return rows::choice(name, "rectilinear", std::move(names), doc);
}

ParameterTable ray_rows() {
    using namespace rows;
    return {
        text("ray_x",
             "of to=formula: how far the ray of a pixel goes to the right, a formula of px, py, r, a, x, y, "
             "s, t and others (docs/map.md); px by default. Rays may have any length"),
        text("ray_y", "the same, up; py by default"),
        text("ray_z", "the same, forward; 1 by default"),
        text("point_x",
             "of to=formula, in place of rays: where in the picture a direction goes, to the right of its "
             "middle in halves of its smaller side, a formula of lon and lat, in radians; lon/(pi/2) by "
             "default"),
        text("point_y", "the same, up; lat/(pi/2) by default"),
        definitions("let",
                    "definitions before these, as in k=0.3;c=cos(k); any other key k=0.3 is one too, and "
                    "stands before these"),
    };
}

bool has_formula(const ParameterValues& values) {
    if (values.text("to") == kFormula) return true;
    for (const Parameter& row : ray_rows())
        if (values.given(row.name))
            throw Error(row.name, printable(values.text(row.name)),
                        "is of to=formula: must not be given without it");
    const bool has_time = values.given("keys") || values.given("shutter");
    if (values.given("frame") && !has_time)
        throw Error("frame", printable(values.text("frame")),
                    "is of to=formula, of keys and of shutter: must not be given without one of them");
    values.refuse_definitions();
    return false;
}

std::unique_ptr<const Pictures> pictures_of_formula(const ParameterValues& values, const SourceFacts& facts) {
    if (kIsSmall) refuse_left_out("to=formula");
    refuse_what_formulas_have_not(values);
    if (!is_any_given(values, kPoints)) return pictures_of(rays_of(values), values, facts);
    if (is_any_given(values, kRays))
        throw Error("ray_x, ray_y or ray_z and point_x or point_y are given: must be one or the other");
    return pictures_of(directions_of(values), values, facts);
}

}  // namespace anamorph
