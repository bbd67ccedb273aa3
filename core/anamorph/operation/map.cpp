// SPDX-License-Identifier: Apache-2.0
// A picture drawn along a formula that is written as text.
#include "anamorph/formula/pushed_plan.h"
#include "anamorph/formula/text_plan.h"
#include "anamorph/operation/flat_picture.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"
#include "anamorph/parameter/left_out.h"

namespace anamorph {
namespace {

ParameterTable make_map_table() {
    using namespace rows;
    return {
        image("src", "the source image; by default the recipe's name without .map"),
        text("u",
             "where a pixel is taken from (pull) or goes (push), across: a formula of x, y, s, t, px, py, "
             "r, a and others; x by default"),
        text("v", "the same, down; y by default"),
        definitions(
            "let",
            "definitions before both, as in k=0.3;c=cos(k); any other key k=0.3 is one too, and stands "
            "before these"),
        choice("direction", "pull", {"pull", "push"},
               "pull: u and v are the point of the source that a pixel of the picture shows; push: they are "
               "where in the picture a point of the source goes, and the formulas are inverted"),
        choice("units", "pixels", {"pixels", "fractions"},
               "of u and v: pixels of the source (pull) or the picture (push), or parts of its width and "
               "height"),
        number("frame", "", "0", -1e9, 1e9, "the number that frame is in the formulas"),
        size("width and height of the picture, or its width alone, in the source's shape; by default the "
             "source's"),
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
                {"residual", Scheme::residual},
                {"direct", Scheme::direct}}),
        colorspace("color space to filter in; by default the source's own"),
        output(),
        alpha(),
        flip_v(),
    };
}

template <class Plan, class MakeMap>
std::unique_ptr<const Pictures> pictures_of(const FlatRequest& request, const MakeMap& make_map) {
    return flat_pictures(request, [request, make_map](const Size& pixels) {
        return with_undefined_fraction(std::make_shared<const Plan>(make_map(pixels), request.plan));
    });
}

/// Does a formula read a name?
bool reads(std::string_view formula, std::string_view name) {
    const auto is_of_name = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    };
    for (std::size_t at = 0; (at = formula.find(name, at)) != formula.npos; at += name.size()) {
        const std::size_t end = at + name.size();
        const bool is_begun = at > 0 && is_of_name(formula[at - 1]),
                   goes_on = end < formula.size() && is_of_name(formula[end]);
        if (!is_begun && !goes_on) return true;
    }
    return false;
}

/// Refuses a frame that nothing is made of.
void check_frame(const ParameterValues& values, const FormulaText& text) {
    if (!values.given("frame")) return;
    bool is_read = reads(text.u, "frame") || reads(text.v, "frame") || reads(text.let, "frame");
    for (const auto& [name, formula] : text.definitions) is_read = is_read || reads(formula, "frame");
    if (!is_read)
        throw Error(
            "frame", printable(values.text("frame")),
            "must be given only where a formula reads frame; of a film as src, subimage chooses a frame");
}

std::unique_ptr<const Pictures> pictures_of_map(const ParameterValues& values, const SourceFacts& facts) {
    const Size source{facts.width, facts.height}, target = rows::size_of(values, source);
    FormulaText text;
    if (values.given("u")) text.u = values.text("u");
    if (values.given("v")) text.v = values.text("v");
    if (values.given("let")) text.let = values.text("let");
    text.definitions = values.definitions();
    check_frame(values, text);
    const bool pushes = values.text("direction") == "push";
    if (kIsSmall && pushes) refuse_left_out("direction=push");
    if (pushes && values.text("scheme") == "direct")
        throw Error("scheme", "direct", "is of direction=pull: must be auto, exact, blocks or residual");
    const FormulaSetting setting{target, source, values.number("frame"), values.text("units") == "fractions",
                                 pushes};
    FlatRequest request = flat_request(values, facts, target);
    if (target == source) add_to(request, said_of_pixels(facts.pixel_aspect));
    const PlaneFormula formula = parse_formula(text, setting);
    if (pushes)
        return pictures_of<PushedPlan>(request, [request, formula](const Size& pixels) {
            try {
                return PushedMap(formula, request.target, pixels, request.source_size(),
                                 PushedMap::kMostParts, PushedSheets::pixel_name, request.plan.overscan);
            } catch (const Error& error) {
                throw Error("direction", "push", error.what());
            }
        });
    return pictures_of<TextPlan>(request, [request, formula](const Size& pixels) {
        return TextMap(formula, request.target, pixels, request.source_size());
    });
}

}  // namespace

const Operation& map_operation() {
    static const ParameterTable table = make_map_table();
    static const Operation operation{
        "map",
        "A picture drawn along a formula that you write",
        &table,
        {"src"},
        1,
        {"let=w=(0.6+frame)*exp(-4*r^2)&u=width/2+height/2*r*cos(a+w)&v=height/2-height/2*r*sin(a+w)", {}},
        [](const OperationInput& input) { return pictures_of_map(input.values, input.sources[0].facts); }};
    return operation;
}

}  // namespace anamorph
