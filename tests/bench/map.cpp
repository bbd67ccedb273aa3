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
#include "anamorph/parameter/parameter.h"
#include "bench.h"
#include "drawn_map.h"

namespace anamorph::bench {
namespace {

constexpr double kTols[] = {0.01, 0.001};
// Of a text over the compiled map, once planned and with planning; and of its exact pixels.
constexpr double kMostDrawn = 1.25, kMostOfAll = 1.6, kMostExact = 2.5;
constexpr Orientation kTurned{30, 20, 10};

/// A formula in pixels of a source, where its picture is square.
DrawnMap text_map(const std::string& name, const Chart& source, int side, const FormulaText& text) {
    const Size picture{side, side}, pixels{source.width(), source.height()};
    const TextMap map(parse_formula(text, {picture, pixels}), picture, picture, pixels);
    return {name + " text", source,
            [map](const PlanOptions& options) { return std::make_shared<TextPlan>(map, options); }};
}

/// A view of a sphere whose ray is (dx, dy, dz), y down, of any length.
std::vector<DrawnMap> view(const std::string& name, const Settings& settings, const Chart& target,
                           const std::string& ray) {
    const Chart sphere(Projection::equirectangular, 4 * settings.size, 2 * settings.size, 360);
    const Panorama map(sphere, target, kTurned);
    const glm::dmat3 turn = rotation(kTurned);
    FormulaText text;
    text.let = ray;
    const char* const components[] = {"x", "y", "z"};
    for (int row = 0; row < 3; ++row) {
        text.let += std::string(";e") + components[row] + "=0";
        for (int column = 0; column < 3; ++column)
            text.let += "+(" + shortest(turn[column][row]) + ")*d" + components[column];
    }
    text.u = "src_width*(.5+atan2(ex,ez)/(2*pi))";
    text.v = "src_height*(.5+atan2(ey,hypot(ex,ez))/pi)";
    return {{name + " compiled", sphere,
             [map](const PlanOptions& options) { return std::make_shared<PanoramaPlan>(map, options); }},
            text_map(name, sphere, settings.size, text)};
}

std::vector<DrawnMap> lens(const Settings& settings) {
    const int side = settings.size;
    const Chart observed(Projection::rectilinear, side, side, 90, PixelSpacing::edges, "", 1,
                         LensModel::parse("brown:k1=-0.2,k2=0.05,k3=-0.004"));
    const Chart flat(Projection::rectilinear, side, side);
    const Size size{side, side};
    const LensMap map(observed, LensMode::undistort, size, size, size);
    FormulaText text;
    // The half picture spans 45 degrees: px and py are tangents.
    text.let = "q=px^2+py^2;k=1+q*(-.2+q*(.05-.004*q))";
    text.u = "width/2*(1+px*k)";
    text.v = "height/2*(1-py*k)";
    return {{"lens compiled", flat,
             [map](const PlanOptions& options) { return std::make_shared<LensPlan>(map, options); }},
            text_map("lens", flat, side, text)};
}

std::vector<DrawnMap> swirl(const Settings& settings) {
    FormulaText text;
    text.let = "b=a-2*exp(-4*r^2)";
    text.u = "width/2*(1+r*cos(b))";
    text.v = "height/2*(1-r*sin(b))";
    const Chart flat(Projection::rectilinear, settings.size, settings.size);
    return {text_map("swirl", flat, settings.size, text)};
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
            for (const std::string scheme : {"automatic", "plan", "drawn", "exact"}) {
                if (!settings.wants_scheme(scheme)) continue;
                PlanOptions options = options_of(tol);
                if (scheme == "exact") options.scheme = Scheme::exact;
                Row row = row_of(settings, map, options);
                row.op = "map";
                row.scheme = scheme;
                std::function<void()> draw = [&drawing, &map, options] { drawing.draw(map, options); };
                if (scheme == "plan") draw = [&drawing, &map, options] { drawing.plan(map, options); };
                if (scheme == "drawn")
                    draw = [&drawing, &map, blocks = map.plan(options)] { drawing.draw(map, blocks); };
                timed.push_back({row, draw});
            }
    time_all(settings, report, timed);
    for (const auto& [row, draw] : timed) {
        const std::string name = row.case_name.substr(0, row.case_name.find(' '));
        const Row* compiled = report.find(name + " compiled", row.scheme, row.tol_px);
        if (!compiled || row.scheme == "plan" || compiled->case_name == row.case_name) continue;
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
    if (settings.wants_case("straight"))
        measure(
            settings, report,
            view("straight", settings, Chart(Projection::rectilinear, side, side, 90), "dx=px;dy=-py;dz=1"));
    if (settings.wants_case("fisheye"))
        measure(settings, report,
                view("fisheye", settings, Chart(Projection::fisheye, side, side, 180),
                     "h=pi/2*r;dx=sin(h)*cos(a);dy=-sin(h)*sin(a);dz=cos(h)"));
    if (settings.wants_case("lens")) measure(settings, report, lens(settings));
    if (settings.wants_case("swirl")) measure(settings, report, swirl(settings));
}

const RegisterOp registered({"map", run, nullptr});

}  // namespace
}  // namespace anamorph::bench
