// SPDX-License-Identifier: Apache-2.0
// Formulas that are text, beside the same maps compiled.
//
// `straight` and `fisheye` are views of a whole sphere, `lens` takes a distortion off a flat picture; of `swirl` there is only
// the text. Scheme `automatic` plans and draws, `plan` plans alone, `drawn` draws by blocks that are there, `exact` takes every
// pixel by its formula. All are measured in the same rounds. Square pictures of three channels of floats, bilinear.
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/formula/text_plan.h"
#include "anamorph/lens/lens_plan.h"
#include "anamorph/panorama/panorama_plan.h"
#include "bench.h"
#include "drawn_map.h"
#include "map_formulas.h"

namespace anamorph::bench::op_map {
namespace {

constexpr double kTols[] = {0.01, 0.001};
// Of a text over the compiled map, once planned and with planning; and of its exact pixels.
constexpr double kMostDrawn = 1.25, kMostOfAll = 1.6, kMostExact = 2.5;

DrawnMap text_map(const std::string& name, int side, const TextOf& text) {
    const TextMap map = text.map(side);
    return {name + " text", text.source,
            [map](const PlanOptions& options) { return std::make_shared<TextPlan>(map, options); }};
}
template <class Plan, class Map>
std::vector<DrawnMap> both(const std::string& name, int side, const Map& map, const TextOf& text) {
    return {{name + " compiled", text.source,
             [map](const PlanOptions& options) { return std::make_shared<Plan>(map, options); }},
            text_map(name, side, text)};
}

/// A text that is another map than the compiled one would be compared with it for nothing.
void expect_one_map(const Settings& settings, Report& report, const std::vector<DrawnMap>& maps) {
    if (maps.size() < 2) return;
    const PlanOptions options = options_of(0.01);
    const std::shared_ptr<const BlockMap> compiled = maps[0].plan(options), text = maps[1].plan(options);
    constexpr int kPoints = 31;
    for (int i = 1; i < kPoints * kPoints; ++i) {
        const double x = settings.size * (i % kPoints + 0.4) / kPoints,
                     y = settings.size * (i / kPoints + 0.3) / kPoints;
        Point<double> a{}, b{};
        int piece = 0;
        // The text of the fisheye goes on beyond its edge.
        if (!compiled->exact(x, y, 0, a, piece)) continue;
        if (text->exact(x, y, 0, b, piece) && std::hypot(a.x - b.x, a.y - b.y) < 1e-6) continue;
        report.failures.push_back(maps[1].name + ": is another map at " + std::to_string(x) + ", " +
                                  std::to_string(y));
        return;
    }
}

void measure(const Settings& settings, Report& report, const std::vector<DrawnMap>& maps) {
    expect_one_map(settings, report, maps);
    MapDrawing drawing(settings);
    std::vector<TimedRow> timed;
    for (const double tol : kTols)
        for (const DrawnMap& map : maps)
            for (const std::string scheme : {"automatic", "plan", "drawn", "exact", "defaults"}) {
                const bool defaults = scheme == "defaults";
                if (!settings.wants_scheme(scheme) || (defaults && tol != PlanOptions().tol)) continue;
                PlanOptions options = options_of(tol);
                if (scheme == "exact") options.scheme = Scheme::exact;
                Row row = row_of(settings, map, options);
                row.op = "map";
                row.scheme = scheme;
                std::function<void()> draw = [&drawing, &map, options] { drawing.draw(map, options); };
                if (defaults) draw = [&drawing, &map, options] { drawing.draw_with_defaults(map, options); };
                if (scheme == "plan") draw = [&drawing, &map, options] { drawing.plan(map, options); };
                if (scheme == "drawn")
                    draw = [&drawing, &map, blocks = map.plan(options)] { drawing.draw(map, blocks); };
                timed.push_back({row, draw});
            }
    time_all(settings, report, timed);
    for (const auto& [row, draw] : timed) {
        const std::string name = row.case_name.substr(0, row.case_name.find(' '));
        const Row* compiled = report.find(name + " compiled", row.scheme, row.tol_px);
        if (!compiled || row.scheme == "plan" || row.scheme == "defaults" ||
            compiled->case_name == row.case_name)
            continue;
        char what[96];
        std::snprintf(what, sizeof what, "%s, tol %g, %s: times the compiled map", name.c_str(), row.tol_px,
                      row.scheme.c_str());
        report.targets.push_back({what,
                                  row.scheme == "drawn"   ? kMostDrawn
                                  : row.scheme == "exact" ? kMostExact
                                                          : kMostOfAll,
                                  row.ns_per_px / compiled->ns_per_px,
                                  row.best_ns_per_px / compiled->best_ns_per_px, true});
    }
}

void run(const Settings& settings, Report& report) {
    const int side = settings.size;
    const auto measure_view = [&](const std::string& name, const SphereView& view) {
        if (settings.wants_case(name))
            measure(settings, report, both<PanoramaPlan>(name, side, view.map, view.text));
    };
    measure_view("straight", straight_view(side));
    measure_view("fisheye", fisheye_view(side));
    const LensView lens = lens_view(side);
    if (settings.wants_case("lens"))
        measure(settings, report, both<LensPlan>("lens", side, lens.map, lens.text));
    if (settings.wants_case("swirl")) measure(settings, report, {text_map("swirl", side, swirl_view(side))});
}

const RegisterOp registered({"map", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_map
