// SPDX-License-Identifier: Apache-2.0
// Lenses: how much longer a picture takes that is drawn through one.
//
// Pictures are square, three channels of floats, bilinear, drawn with a fresh plan each time. `undistort` and `distort`
// are those of .lens, a flat picture of the same size; `source` and `target` are panoramas whose source or target has the
// lens. All of one kind of lens are measured in the same rounds with the same panorama without a lens, `plain`, at the
// same tolerance. Scheme `plan` makes all blocks and draws nothing.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/lens/lens_plan.h"
#include "anamorph/panorama/panorama_plan.h"
#include "bench.h"
#include "drawn_map.h"

namespace anamorph::bench::op_lens {
namespace {

constexpr double kTols[] = {0.01, 0.001};
constexpr double kMostOfPlain = 1.15;
constexpr Orientation kTurned{30, 20, 10};

struct NamedLens {
    const char *name, *text;
};
constexpr NamedLens kLenses[] = {{"3de4", "3de4:k1=0.1,k2=0.03"},
                                 {"ptlens", "ptlens:a=0.01,b=-0.03,c=0.02"},
                                 {"brown", "brown:k1=-0.2,k2=0.05,k3=-0.004"},
                                 {"brown_p", "brown:k1=-0.1,k2=0.02,p1=0.002,p2=-0.003"},
                                 {"kb4", "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003"}};

/// The charts of a lens's pictures: rectilinear views, or fisheyes.
struct Charts {
    Projection projection;
    double fov;
    int size;

    Chart of(int side, const std::string& lens) const {
        return Chart(projection, side, side, fov, PixelSpacing::edges, "", 1, LensModel::parse(lens));
    }
};

DrawnMap panorama(const std::string& name, const Chart& source, const Chart& target) {
    const Panorama map(source, target, kTurned);
    return {name, source,
            [map](const PlanOptions& options) { return std::make_shared<PanoramaPlan>(map, options); }};
}

DrawnMap lens_picture(const std::string& name, const Chart& observed, LensMode mode) {
    const Size size{observed.width(), observed.height()};
    const LensMap map(observed, mode, size, size, size);
    return {name, Chart(Projection::rectilinear, size.width, size.height),
            [map](const PlanOptions& options) { return std::make_shared<LensPlan>(map, options); }};
}

/// A target of this chart sees a whole sphere; a source of this chart is seen as a flat view.
std::vector<DrawnMap> cases_of(const Charts& charts, const NamedLens& lens) {
    const int wide = 4 * charts.size;
    const Chart sphere(Projection::equirectangular, wide, wide / 2, 360);
    const Chart flat(Projection::rectilinear, charts.size, charts.size, 60);
    const Chart bare = charts.of(charts.size, "none"), observed = charts.of(charts.size, lens.text);
    return {panorama("plain target", sphere, bare),
            panorama("target", sphere, observed),
            panorama("plain source", bare, flat),
            panorama("source", observed, flat),
            lens_picture("undistort", observed, LensMode::undistort),
            lens_picture("distort", observed, LensMode::distort)};
}

/// The panorama that a case is to be compared with: of .lens, the one from the sphere.
std::string plain_of(const std::string& name) {
    return name == "source" ? "plain source" : "plain target";
}

void measure(const Settings& settings, Report& report, const NamedLens& lens,
             const std::vector<DrawnMap>& cases, MapDrawing& drawing) {
    std::vector<TimedRow> timed;
    for (const double tol : kTols)
        for (const DrawnMap& map : cases)
            for (const char* scheme : {"automatic", "plan", "defaults"}) {
                const bool defaults = std::string(scheme) == "defaults";
                if (!settings.wants_scheme(scheme) || (defaults && tol != kTols[0])) continue;
                const PlanOptions options = options_of(tol);
                Row row = row_of(settings, map, options);
                row.op = "lens";
                row.case_name = std::string(lens.name) + " " + map.name;
                row.scheme = scheme;
                const bool draws = row.scheme == "automatic";
                timed.push_back({row, [&drawing, &map, options, draws, defaults] {
                                     defaults ? drawing.draw_with_defaults(map, options)
                                     : draws  ? drawing.draw(map, options)
                                              : drawing.plan(map, options);
                                 }});
            }
    time_all(settings, report, timed);
    for (const auto& [row, draw] : timed) {
        const std::string name = row.case_name.substr(row.case_name.find(' ') + 1);
        const Row* plain = report.find(std::string(lens.name) + " " + plain_of(name), row.scheme, row.tol_px);
        if (!plain || name.starts_with("plain") || row.scheme == "defaults") continue;
        char what[96];
        std::snprintf(what, sizeof what, "%s, tol %g, %s: times the plain panorama", row.case_name.c_str(),
                      row.tol_px, row.scheme == "plan" ? "its plan alone" : "all");
        report.targets.push_back({what, kMostOfPlain, row.ns_per_px / plain->ns_per_px,
                                  row.best_ns_per_px / plain->best_ns_per_px, true});
    }
}

void run(const Settings& settings, Report& report) {
    MapDrawing drawing(settings);
    for (const NamedLens& lens : kLenses) {
        if (!settings.wants_case(lens.name)) continue;
        const bool fisheye = std::string(lens.name) == "kb4";
        const Charts charts{fisheye ? Projection::fisheye : Projection::rectilinear, fisheye ? 150.0 : 90.0,
                            settings.size};
        measure(settings, report, lens, cases_of(charts, lens), drawing);
    }
}

const RegisterOp registered({"lens", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_lens
