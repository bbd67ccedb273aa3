// SPDX-License-Identifier: Apache-2.0
// Concentric mosaics seen from a point inside their circles.
#include "anamorph/operation/mosaic.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "anamorph/image/part_source.h"
#include "anamorph/number/hypot.h"
#include "anamorph/operation/operation.h"
#include "anamorph/operation/pano.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"
#include "anamorph/panorama/concentric_view.h"

namespace anamorph {
namespace {

using rows::chosen;

const char* const kDistortion = "distortion";

/// The projections whose rows are a full turn.
std::vector<std::string> turning_projections() {
    std::vector<std::string> names;
    for (const Projection p : kProjections)
        if (rows_turn(p)) names.emplace_back(name_of(p));
    return names;
}

ParameterTable make_mosaic_table() {
    using namespace rows;
    const auto as_pano = [](const char* name) {
        const ParameterTable& pano = *pano_operation().parameters;
        return *std::find_if(pano.begin(), pano.end(), [&](const Parameter& p) { return p.name == name; });
    };
    return {
        image("src",
              "the panoramas, one above the other in a single image, all as high, from the circle of radius "
              "-1 at the top to that of 1; by default the recipe's name without .mosaic"),
        whole("circles", "", "1", 1, ConcentricStack::kMostCircles,
              "how many panoramas there are; their circles' radii run evenly from -1 to 1, a single one has "
              "0. A column in the direction u of the circle of radius r was seen along u from the point r to "
              "the right of the centre"),
        choice("from", "cylindrical", turning_projections(), "projection of each panorama, a full turn"),
        number("x", "outer radii", "0", -1, 1, "the viewpoint, to the right of the centre"),
        number("z", "outer radii", "0", -1, 1,
               "the viewpoint, in front of the centre; inside the outer circle together with x"),
        above(number("depth", "outer radii", "", 1, kInfinity,
                     "distance from the centre that all things are taken to have; by default infinite")),
        above(number("nearest", "outer radii", "", 1, kInfinity,
                     "distance from the centre of the nearest thing, for anamorph:vertical_distortion; by "
                     "default depth")),
        whole("circle", "", "", 1, ConcentricStack::kMostCircles,
              "one panorama alone, in place of the mixture of the two nearest; stmap is of one alone, in 0 "
              "to 1 on it, by default of the middle one"),
        choice("to", "rectilinear", projection_name_list(), "projection of the picture"),
        as_pano("fov"),
        as_pano("vfov"),
        as_pano("focal"),
        as_pano("sensor"),
        as_pano("d"),
        as_pano("e"),
        as_pano("yaw"),
        as_pano("pitch"),
        as_pano("roll"),
        as_pano("lens"),
        as_pano("size"),
        overscan(),
        subimage(),
        tile(),
        mip(),
        hash(),
        concatenate(),
        filter(),
        clamp(),
        data_channels(),
        data_filter(),
        as_pano("wrap"),
        tol(),
        scheme({{"auto", Scheme::automatic},
                {"exact", Scheme::exact},
                {"blocks", Scheme::blocks},
                {"residual", Scheme::residual}}),
        colorspace("color space to filter in; by default the source's own"),
        output({{kDistortion, Word::kNone, "how far heights may be from 1 times the true ones"}}),
        alpha(),
        flip_v(),
    };
}

struct MosaicRequest {
    Chart panorama, target;
    Orientation orientation;
    ReprojectOptions options;
    ConcentricStack stack;
    std::optional<int> circle;
    std::optional<double> nearest;
    bool distortion = false;

    Panorama view() const { return Panorama(panorama, target, orientation); }
};

}  // namespace

ConcentricStack read_concentric_stack(const ParameterValues& values) {
    ConcentricStack stack;
    stack.circles = values.whole("circles");
    if (values.given("depth")) stack.depth = values.number("depth");
    stack.viewpoint = {values.number("x"), values.number("z")};
    if (!(hypot(stack.viewpoint.x, stack.viewpoint.y) <= 1 + 1e-12))
        throw Error("z", shortest(stack.viewpoint.y),
                    "must be inside the outer circle together with x=" + shortest(stack.viewpoint.x));
    return stack;
}

Chart read_slit_panorama(const ParameterValues& values, const SourceFacts& facts, int circles) {
    if (facts.pixel_aspect != 1)
        throw Error("source has PixelAspectRatio=" + shortest(static_cast<float>(facts.pixel_aspect)) +
                    ": must be 1 in mosaics; resize it to square pixels, or correct the attribute");
    if (facts.height % circles != 0)
        throw Error("circles", std::to_string(circles),
                    "must divide the source's height, " + std::to_string(facts.height));
    return Chart(projection_from_name(values.text("from"), "from"), facts.width, facts.height / circles, 360,
                 PixelSpacing::edges, "src");
}

namespace {

MosaicRequest read_request(const ParameterValues& values, const SourceFacts& facts) {
    const ConcentricStack stack = read_concentric_stack(values);
    const Chart panorama = read_slit_panorama(values, facts, stack.circles);
    MosaicRequest request{panorama,
                          read_target_chart(values, panorama),
                          read_orientation(values),
                          read_reproject_options(values, facts),
                          stack,
                          {},
                          {}};
    request.options.scheme = chosen<Scheme>(values, "scheme");
    request.options.overscan = read_overscan(values, request.target);
    request.distortion = values.text("output") == kDistortion;
    if (values.given("circle")) request.circle = values.whole("circle") - 1;
    if (request.circle && *request.circle >= stack.circles)
        throw Error("circle", values.text("circle"),
                    "must be one of the circles, 1 to " + std::to_string(stack.circles));
    if (values.given("nearest") || values.given("depth"))
        request.nearest = values.number(values.given("nearest") ? "nearest" : "depth");
    if (request.distortion && !request.nearest) throw Error("output", kDistortion, "needs nearest or depth");
    return request;
}

Picture picture_of(const MosaicRequest& request) {
    Picture picture = mosaic_picture(request.view(), request.stack, request.options, request.circle);
    if (request.distortion) picture.value = distortion_of(request.view(), request.stack, *request.nearest);
    if (request.nearest)
        picture.says = [stack = request.stack, nearest = *request.nearest](const ParallelFor&) -> Attributes {
            return {{"anamorph:vertical_distortion", stack.vertical_distortion(nearest)}};
        };
    return picture;
}

/// The panoramas are strips of one source.
class SolvedMosaic final : public SolvedPicture {
  public:
    explicit SolvedMosaic(const MosaicRequest& request)
        : SolvedMosaic(solved(picture_of(request)), request.stack.circles, request.panorama.height()) {}
    SolvedMosaic(std::unique_ptr<const SolvedPicture> picture, int circles, int height)
        : m_picture(std::move(picture)), m_circles(circles), m_height(height) {}

    Attributes reached(const ParallelFor& parallel_for) const override {
        return m_picture->reached(parallel_for);
    }
    /// One panorama alone is all of the source.
    const Picture* of_maps() const override { return m_circles == 1 ? m_picture->of_maps() : nullptr; }
    std::unique_ptr<const SolvedPicture> of_moved() const override {
        std::unique_ptr<const SolvedPicture> moved = m_picture->of_moved();
        return moved ? std::make_unique<SolvedMosaic>(std::move(moved), m_circles, m_height) : nullptr;
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        std::deque<PartSource> strips;
        std::vector<const Source*> panoramas;
        const Source* stack = sources.empty() ? nullptr : sources[0];
        for (int i = 0; stack && i < m_circles; ++i)
            panoramas.push_back(
                &strips.emplace_back(*stack, Box{0, i * m_height, stack->size(0).width, (i + 1) * m_height}));
        return m_picture->draw(panoramas, box, view, parallel_for);
    }

  private:
    std::unique_ptr<const SolvedPicture> m_picture;
    int m_circles, m_height;
};

class Mosaics final : public Pictures {
  public:
    explicit Mosaics(const MosaicRequest& request) : m_request(request) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        MosaicRequest request = m_request;
        const PixelKind pixels = request.distortion ? PixelKind::value : pixels_of(request.options.output);
        std::optional<PanoramaLevel> made = panorama_level(request.target, request.options, pixels, level);
        if (!made) return {};
        request.target = made->target;
        PictureRequest& picture = made->request;
        const bool single = request.circle || request.stack.circles == 1;
        if (picture.pixels == PixelKind::color && request.options.filter == Filter::nearest && single)
            picture.moves = 0;
        if (picture.pixels == PixelKind::color) picture.moved_channels = moved_channels(request.options.data);
        picture.says.push_back({"anamorph:tol", request.options.tol});
        picture.solve = [request] { return std::make_unique<SolvedMosaic>(request); };
        return std::move(picture);
    }
    SourceFaces faces() const override { return {1, m_request.stack.circles}; }

  private:
    MosaicRequest m_request;
};

}  // namespace

const Operation& mosaic_operation() {
    static const ParameterTable table = make_mosaic_table();
    static const Operation operation{
        "mosaic",
        "Concentric mosaics, slit panoramas on circles, seen from a point inside",
        &table,
        {"src"},
        1,
        {"from=equirectangular&to=equirectangular&x=0.4&z=0.3&depth=4&pitch=20", {}},
        [](const OperationInput& input) -> std::unique_ptr<const Pictures> {
            return std::make_unique<Mosaics>(read_request(input.values, input.sources[0].facts));
        }};
    return operation;
}

}  // namespace anamorph
