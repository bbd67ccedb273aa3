// SPDX-License-Identifier: Apache-2.0
// A picture drawn along a formula that is written as text.
#include "anamorph/approx/text_plan.h"
#include "anamorph/operation/operation.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"

namespace anamorph {
namespace {

using rows::chosen;

ParameterTable make_table() {
    using namespace rows;
    return {
        image("src", "the source image; by default the recipe's name without .map"),
        text("u",
             "where a pixel is taken from, across: a formula of x, y, s, t, px, py, r, a and others; x by "
             "default"),
        text("v", "the same, down; y by default"),
        text("let", "definitions before both, as in k=0.3;c=cos(k)"),
        choice("units", "pixels", {"pixels", "fractions"},
               "of u and v: pixels of the source, or parts of its width and height"),
        number("frame", "", "0", -1e9, 1e9, "the number that frame is in the formulas"),
        size("width and height of the picture, or its width alone, in the source's shape; by default the "
             "source's"),
        tile(),
        mip(),
        filter(),
        wrap("is black"),
        tol(),
        scheme({{"auto"}, {"exact"}, {"blocks"}, {"residual"}}),
        colorspace("color space to filter in; by default the source's own"),
        output(),
    };
}

struct MapRequest {
    Size source, target;
    PlaneFormula formula;
    PlanOptions plan;
    Filter filter;
    Wrap wrap;
    Output output;
};

MapRequest read_request(const ParameterValues& values, const SourceFacts& facts) {
    const Size source{facts.width, facts.height}, target = rows::size_of(values, source);
    FormulaText text;
    if (values.given("u")) text.u = values.text("u");
    if (values.given("v")) text.v = values.text("v");
    if (values.given("let")) text.let = values.text("let");
    const FormulaSetting setting{target, source, values.number("frame"), values.text("units") == "fractions"};
    const auto wrap = chosen<Wrap>(values, "wrap");
    const Output output = rows::chosen_output(values);
    PlanOptions plan;
    plan.scheme = chosen<Scheme>(values, "scheme");
    plan.tol = values.number("tol");
    plan.cull = ends_at_edges(wrap, output);
    return {source, target, parse_formula(text, setting), plan, chosen<Filter>(values, "filter"),
            wrap,   output};
}

/// The map and its picture.
class MapPicture {
  public:
    MapPicture(const MapRequest& r, const Size& pixels) {
        const TextMap map(r.formula, r.target, pixels, r.source);
        const Chart flat(Projection::rectilinear, r.source.width, r.source.height);
        m_picture.maps = {{std::make_shared<TextPlan>(map, r.plan), {{Border(flat, r.wrap)}}}};
        m_picture.filter = r.filter;
        m_picture.output = r.output;
    }
    const Picture& picture() const { return m_picture; }

  private:
    Picture m_picture;
};

class MapPictures final : public Pictures {
  public:
    explicit MapPictures(MapRequest request) : m_request(std::move(request)) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        const std::optional<Size> size = level_size(m_request.target, level);
        if (!size) return {};
        PictureRequest picture;
        picture.size = *size;
        picture.pixels = pixels_of(m_request.output);
        picture.says = {{"anamorph:tol", m_request.plan.tol}};
        if (picture.pixels == PixelKind::color && m_request.filter == Filter::nearest) picture.moves = 0;
        picture.solve = [request = m_request, size = *size] {
            return std::make_unique<Solved<MapPicture>>(MapPicture(request, size));
        };
        return picture;
    }

  private:
    MapRequest m_request;
};

}  // namespace

const Operation& map_operation() {
    static const ParameterTable table = make_table();
    static const Operation operation{
        "map",
        "A picture drawn along a formula that you write",
        &table,
        {"src"},
        1,
        {"let=w=(0.6+frame)*exp(-4*r^2)&u=width/2+height/2*r*cos(a+w)&v=height/2-height/2*r*sin(a+w)", {}},
        [](const OperationInput& input) -> std::unique_ptr<const Pictures> {
            return std::make_unique<MapPictures>(read_request(input.values, input.sources[0].facts));
        }};
    return operation;
}

}  // namespace anamorph
