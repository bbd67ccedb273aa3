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

#include "anamorph/approx/lens_plan.h"
#include "anamorph/approx/panorama_plan.h"
#include "anamorph/render/picture.h"
#include "bench.h"
#include "pixels.h"

namespace anamorph::bench {
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

PlanOptions options_of(double tol) {
    PlanOptions options;
    options.tol = tol;
    return options;
}

/// One map that is drawn, made anew for every drawing: its blocks, and the chart of its source.
struct Case {
    std::string name;
    Chart source;
    std::function<std::shared_ptr<const BlockMap>(double tol)> plan;
};

/// The charts of a lens's pictures: rectilinear views, or fisheyes.
struct Charts {
    Projection projection;
    double fov;
    int size;

    Chart of(int side, const std::string& lens) const {
        return Chart(projection, side, side, fov, PixelSpacing::edges, "", 1, LensModel::parse(lens));
    }
};

Case panorama(const std::string& name, const Chart& source, const Chart& target) {
    const Panorama map(source, target, kTurned);
    return {name, source, [map](double tol) { return std::make_shared<PanoramaPlan>(map, options_of(tol)); }};
}

Case lens_picture(const std::string& name, const Chart& observed, LensMode mode) {
    const Size size{observed.width(), observed.height()};
    const LensMap map(observed, mode, size, size, size);
    return {name, Chart(Projection::rectilinear, size.width, size.height),
            [map](double tol) { return std::make_shared<LensPlan>(map, options_of(tol)); }};
}

/// A target of this chart sees a whole sphere; a source of this chart is seen as a flat view.
std::vector<Case> cases_of(const Charts& charts, const NamedLens& lens) {
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

/// Draws cases of one lens, or only plans them.
class Drawing {
  public:
    Drawing(const Settings& settings)
        : m_settings(settings),
          m_pool(settings.threads),
          m_texels(bytes_of(4 * settings.size, 2 * settings.size)),
          m_picture(bytes_of(settings.size, settings.size)) {
        float* values = m_texels.as<float>();
        const std::size_t count = bytes_of(4 * settings.size, 2 * settings.size) / sizeof(float);
        for (std::size_t i = 0; i < count; ++i)
            values[i] = static_cast<float>(i * 2654435761u % 65536) / 65536;
    }

    void draw(const Case& c, double tol) {
        Picture picture;
        picture.maps = {{c.plan(tol), {{Border(c.source, Wrap::automatic)}}}};
        picture.filter = Filter::bilinear;
        const MemorySource source(packed_view<const std::byte>(m_texels.bytes(), PixelType::float32,
                                                               c.source.width(), c.source.height(), 3));
        const int side = m_settings.size;
        picture.draw({&source}, {0, 0, side, side},
                     packed_view(m_picture.bytes(), PixelType::float32, side, side, 3),
                     m_pool.parallel_for());
    }
    void plan(const Case& c, double tol) { static_cast<void>(c.plan(tol)->reached(m_pool.parallel_for())); }

  private:
    static std::size_t bytes_of(int width, int height) {
        return sizeof(float) * 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }

    const Settings& m_settings;
    Pool m_pool;
    Buffer m_texels, m_picture;
};

/// The panorama that a case is to be compared with: of .lens, the one from the sphere.
std::string plain_of(const std::string& name) {
    return name == "source" ? "plain source" : "plain target";
}

void measure(const Settings& settings, Report& report, const NamedLens& lens, const std::vector<Case>& cases,
             Drawing& drawing) {
    std::vector<Timed> timed;
    std::vector<Row> rows;
    for (const double tol : kTols)
        for (const Case& c : cases)
            for (const char* scheme : {"automatic", "plan"}) {
                if (!settings.wants_scheme(scheme)) continue;
                const bool draws = scheme[0] == 'a';
                timed.push_back(
                    {[&drawing, &c, tol, draws] { draws ? drawing.draw(c, tol) : drawing.plan(c, tol); },
                     settings.threads});
                const Reached reached = c.plan(tol)->reached(serial_for);
                Row row;
                row.op = "lens";
                row.case_name = std::string(lens.name) + " " + c.name;
                row.scheme = scheme;
                row.tol_px = tol;
                row.size = settings.size;
                row.threads = settings.threads;
                row.ratio_to_exact = kNone;
                row.bound_px = reached.max_error;
                row.exact_fraction = reached.exact_fraction;
                rows.push_back(row);
            }
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    const double pixels = double(settings.size) * settings.size;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        rows[k].ns_per_px = times[k].median / pixels;
        rows[k].best_ns_per_px = times[k].best / pixels;
        report.add(rows[k]);
    }
    for (const Row& row : rows) {
        const std::string name = row.case_name.substr(row.case_name.find(' ') + 1);
        const Row* plain = report.find(std::string(lens.name) + " " + plain_of(name), row.scheme, row.tol_px);
        if (!plain || name.starts_with("plain")) continue;
        char what[96];
        std::snprintf(what, sizeof what, "%s, tol %g, %s: times the plain panorama", row.case_name.c_str(),
                      row.tol_px, row.scheme == "plan" ? "its plan alone" : "all");
        report.targets.push_back({what, kMostOfPlain, row.ns_per_px / plain->ns_per_px,
                                  row.best_ns_per_px / plain->best_ns_per_px, true});
    }
}

void run(const Settings& settings, Report& report) {
    Drawing drawing(settings);
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
}  // namespace anamorph::bench
