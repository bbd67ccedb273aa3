// SPDX-License-Identifier: Apache-2.0
// Panorama reprojection: speed against error.
//
// Sources are 8192 pixels wide (less for small pictures). The views of one source are measured in the same
// rounds. Schemes: automatic, blocks, residual and exact plan a fresh picture each time,
// planning included; automatic_kept draws with a plan made before. Rivals: pano_rivals.h.
//
// Errors are distances of the source points used from Panorama::exact<DoubleDouble>, over all pixels. The
// points come from evaluating the plan's blocks here (pano_points.h), from the rivals' own formulas, and are
// checked twice: against Output::error, and by drawing a picture whose values are its coordinates.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "anamorph/image/pyramid.h"
#include "anamorph/number/half.h"
#include "anamorph/panorama/reproject.h"
#include "bench.h"
#include "pano_points.h"
#include "pano_rivals.h"
#include "pixels.h"

namespace anamorph::bench::op_pano {
namespace {

constexpr double kDefaultTol = 0.01;
constexpr double kTols[] = {1, 1.0 / 16, kDefaultTol, 0.001, 1e-4, 1e-5, 1e-6, 0};
// A residual table has few cells that hold less.
constexpr double kLeastResidualTol = 0.001;
constexpr Orientation kTurned{30, 20, 10};

const std::pair<Scheme, const char*> kSchemes[] = {{Scheme::automatic, "automatic"},
                                                   {Scheme::blocks, "blocks"},
                                                   {Scheme::residual, "residual"},
                                                   {Scheme::direct, "direct"}};

/// A view to be measured.
struct View {
    /// Without truth, errors are not looked at.
    View(std::string case_name, const Chart& source, const Chart& target, const Orientation& orientation,
         const ParallelFor& parallel_for, bool with_truth)
        : name(std::move(case_name)),
          map(source, target, orientation),
          plain(map, orientation),
          truth(with_truth ? true_points(map, parallel_for) : Points()) {}
    int width() const { return map.target().width(); }
    int height() const { return map.target().height(); }
    Box box() const { return {0, 0, width(), height()}; }

    std::string name;
    Panorama map;
    PlainView plain;
    Points truth;
};

/// One way to draw a view.
struct Contender {
    const View* view;
    std::string scheme;
    double tol = kNone;
    int threads = 1;
    std::function<void()> draw;
    std::function<Points()> points = nullptr;  ///< the source points that draw() uses, if it uses any
    double bound = kNone, exact_fraction = kNone;
    ReprojectOptions options{};  ///< of the product's own schemes
    bool one_tap = true;         ///< each pixel comes from one point, not from an average over several
};

int source_width(const Settings& settings) {
    return std::min(8192, 8 * settings.size / 8 * 8);
}

/// Three packed channels of PixelType `type`.
class Picture {
  public:
    Picture(PixelType type, int width, int height)
        : m_type(type),
          m_width(width),
          m_height(height),
          m_memory(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3 *
                   static_cast<std::size_t>(size_of(type))) {}

    /// Calls `value(x, y, channel)` for every sample; 0..1.
    template <class Value>
    void fill(const ParallelFor& parallel_for, const Value& value) const {
        parallel_for(m_height, [&](std::int64_t row) {
            const int y = static_cast<int>(row);
            const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(m_width) * 3;
            for (int x = 0; x < m_width; ++x)
                for (int c = 0; c < 3; ++c) {
                    const std::size_t k = first + static_cast<std::size_t>(3 * x + c);
                    const float v = value(x, y, c);
                    switch (m_type) {
                        case PixelType::uint8:
                            m_memory.as<std::uint8_t>()[k] = static_cast<std::uint8_t>(v * 255 + 0.5f);
                            break;
                        case PixelType::uint16:
                            m_memory.as<std::uint16_t>()[k] = static_cast<std::uint16_t>(v * 65535 + 0.5f);
                            break;
                        case PixelType::half:
                            m_memory.as<std::uint16_t>()[k] = half_from_float(v);
                            break;
                        case PixelType::float32:
                            m_memory.as<float>()[k] = v;
                    }
                }
        });
    }

    ConstImageView source() const {
        return packed_view<const std::byte>(m_memory.bytes(), m_type, m_width, m_height, 3);
    }
    /// The first pixels, as a picture of this size.
    ImageView view(int width, int height) const {
        return packed_view(m_memory.bytes(), m_type, width, height, 3);
    }
    PixelType type() const { return m_type; }
    std::byte* bytes() const { return m_memory.bytes(); }
    template <class T>
    T* as() const {
        return m_memory.as<T>();
    }

  private:
    PixelType m_type;
    int m_width, m_height;
    Buffer m_memory;
};

/// Uniform noise in 0..1: one multiplicative hash a sample.
float noise(int x, int y, int c) {
    std::uint64_t h = (static_cast<std::uint64_t>(y) << 34 | static_cast<std::uint64_t>(x) << 2 |
                       static_cast<std::uint64_t>(c)) +
                      1;
    h *= 0x9E3779B97F4A7C15u;
    h ^= h >> 29;
    h *= 0xBF58476D1CE4E5B9u;
    return static_cast<float>(h >> 40) * 0x1p-24f;
}

/// A smooth picture with some noise on it.
void fill_with_scene(const Picture& picture, int width, int height, const ParallelFor& parallel_for) {
    std::vector<float> wave(static_cast<std::size_t>(width));
    for (int x = 0; x < width; ++x)
        wave[static_cast<std::size_t>(x)] =
            0.3f * std::sin(6.2831853f * 5 * static_cast<float>(x) / static_cast<float>(width));
    picture.fill(parallel_for, [&](int x, int y, int c) {
        const float slope = 0.3f * static_cast<float>(y) / static_cast<float>(height);
        return 0.3f + wave[static_cast<std::size_t>(x)] + slope + 0.1f * noise(x, y, c);
    });
}

void draw_ours(const View& view, const Source& source, const ReprojectOptions& options, const ImageView& to,
               const ParallelFor& parallel_for) {
    if (!reprojected_picture(view.map, options).draw(&source, view.box(), to, parallel_for))
        throw Error("the source could not be read");
}

/// One source, its views, and everybody who draws them.
class Scene {
  public:
    Scene(const Settings& settings, Report& report, const Chart& chart, PixelType type, std::string op)
        : m_settings(settings),
          m_report(report),
          m_op(std::move(op)),
          m_chart(chart),
          m_pool(settings.threads),
          m_pair(2),
          m_all(static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))),
          m_texels(type, chart.width(), chart.height()),
          m_picture(type, settings.size, settings.size),
          m_source(m_texels.source()) {
        fill_with_scene(m_texels, chart.width(), chart.height(), m_all.parallel_for());
    }

    const Picture& texels() const { return m_texels; }
    ParallelFor all() { return m_all.parallel_for(); }
    ParallelFor threads() { return m_pool.parallel_for(); }
    ImageView target(const View& view) const { return m_picture.view(view.width(), view.height()); }
    const Picture& picture() const { return m_picture; }
    const Source& source() const { return m_source; }

    void add_view(const std::string& name, int size, double fov, const Orientation& orientation) {
        add_view(name, Chart(Projection::rectilinear, size, size, fov), orientation);
    }
    /// No larger than `size` squared pixels.
    void add_view(const std::string& name, const Chart& target, const Orientation& orientation) {
        if (m_settings.wants_case(name))
            m_views.push_back(
                std::make_unique<View>(name, m_chart, target, orientation, all(), !m_settings.efficiency));
    }
    const std::vector<std::unique_ptr<View>>& views() const { return m_views; }

    void add(Contender contender) {
        if (m_settings.wants_scheme(contender.scheme) ||
            (contender.scheme == "double" && !m_settings.efficiency))
            m_contenders.push_back(std::move(contender));
    }

    void add_ours(const View& view, const std::string& name, const ReprojectOptions& options, Pool& pool,
                  int thread_count) {
        if (!m_settings.wants_scheme(name)) return;
        Contender c{&view, name, options.tol, thread_count, {}};
        c.draw = [this, &view, options, &pool] {
            draw_ours(view, m_source, options, target(view), pool.parallel_for());
        };
        describe_ours(c, options);
        add(std::move(c));
    }

    void describe_ours(Contender& c, const ReprojectOptions& options) {
        PlanOptions plan;
        plan.scheme = options.scheme;
        plan.tol = options.tol;
        const View& view = *c.view;
        c.points = [this, &view, plan] { return plan_points(PanoramaPlan(view.map, plan), all()); };
        const Reached reached = reprojected_picture(view.map, options).reached(all());
        c.options = options;
        c.one_tap = options.filter == Filter::bilinear;
        c.bound = reached.max_error;
        c.exact_fraction = reached.exact_fraction;
    }

    void add_automatic(const View& view, const std::vector<double>& tols) {
        ReprojectOptions options;
        options.filter = Filter::bilinear;
        for (const double tol : tols) {
            options.tol = tol;
            add_ours(view, "automatic", options, m_pool, m_settings.threads);
        }
    }

    void add_schemes(const View& view, const std::vector<double>& tols) {
        ReprojectOptions options;
        options.filter = Filter::bilinear;
        for (const double tol : tols)
            for (const auto& [scheme, name] : kSchemes) {
                if (scheme == Scheme::residual && tol > 0 && tol < kLeastResidualTol) continue;
                options.scheme = scheme;
                options.tol = tol;
                add_ours(view, name, options, m_pool, m_settings.threads);
            }
        options.scheme = Scheme::exact;
        options.tol = 0;
        add_ours(view, "exact", options, m_pool, m_settings.threads);

        options.scheme = Scheme::automatic;
        options.tol = kDefaultTol;
        if (m_settings.threads == 1 && std::thread::hardware_concurrency() > 1)
            add_ours(view, "automatic", options, m_pair, 2);
        add_kept(view);
        add_defaults(view);
    }

    /// As users get it who set nothing: antialiased, with the levels of the source's pyramid that are read made each time.
    void add_defaults(const View& view) {
        if (!m_settings.wants_scheme("defaults")) return;
        const ReprojectOptions options;
        Contender c{&view, "defaults", options.tol, m_settings.threads, [this, &view, options] {
                        const Pyramid fresh(m_source);
                        draw_ours(view, fresh, options, target(view), threads());
                    }};
        describe_ours(c, options);
        add(std::move(c));
    }

    /// With a plan made before.
    void add_kept(const View& view) {
        if (!m_settings.wants_scheme("automatic_kept")) return;
        ReprojectOptions options;
        options.filter = Filter::bilinear;
        options.tol = kDefaultTol;
        Contender kept{&view, "automatic_kept", options.tol, m_settings.threads, {}};
        kept.draw = [this, &view, picture = reprojected_picture(view.map, options)] {
            picture.draw(&m_source, view.box(), target(view), threads());
        };
        describe_ours(kept, options);
        add(std::move(kept));
    }

    template <class Texel>
    void add_rivals(const View& view) {
        const Texel* from = m_texels.as<Texel>();
        Texel* to = m_picture.as<Texel>();
        const int threads_count = m_settings.threads;
        const auto points_by = [&view](auto formula) {
            return [&view, formula] {
                Points points;
                for (int j = 0; j < view.height(); ++j)
                    for (int i = 0; i < view.width(); ++i) points.push_back(formula(view.plain, i, j));
                return points;
            };
        };
        add({&view, "double", kNone, threads_count,
             [=, this, &view] { draw_double(view.plain, from, to, threads()); }, points_by(double_point),
             kNone, 1});
        if constexpr (std::is_same_v<Texel, float>) {
            if (!m_padded && m_settings.wants_scheme("simd_exact")) m_padded.emplace(view.plain, from, all());
            add({&view, "simd_exact", kNone, threads_count,
                 [=, this, &view] { draw_simd_exact(view.plain, *m_padded, to, threads()); },
                 [&view] {
                     Points points;
                     for (const Point<float>& p : simd_exact_points(view.plain)) points.push_back({p.x, p.y});
                     return points;
                 },
                 kNone, 1});
        }
        if (have_opencv()) {
            auto opencv = std::make_shared<OpenCv<Texel>>(view.plain, from, to, threads_count, threads());
            opencv->compute_map();
            add({&view, "opencv", kNone, threads_count,
                 [opencv] {
                     opencv->compute_map();
                     opencv->remap();
                 },
                 points_by(opencv_point)});
            add({&view, "opencv_remap", kNone, threads_count, [opencv] { opencv->remap(); },
                 points_by(opencv_point)});
            if constexpr (!std::is_same_v<Texel, float>) {
                opencv->fix_map();
                add({&view, "opencv_fixed", kNone, threads_count, [opencv] { opencv->remap_fixed(); },
                     points_by(opencv_point)});
            }
        }
        add_memory(view);
    }

    void add_memory(const View& view) {
        auto traffic =
            std::make_shared<Traffic>(view.plain, m_texels.bytes(), 3 * size_of(m_texels.type()), all());
        add({&view, "memory", kNone, m_settings.threads,
             [=, this] { traffic->copy(m_picture.bytes(), threads()); }});
    }

    /// The largest distance, in levels, of what is drawn from the bilinear values at the points that are read.
    template <class Texel>
    double value_error(const View& view, double tol) {
        ReprojectOptions options;
        options.filter = Filter::bilinear;
        options.tol = tol;
        draw_ours(view, m_source, options, target(view), all());
        PlanOptions plan;
        plan.tol = tol;
        const Points points = plan_points(PanoramaPlan(view.map, plan), all());
        const Texel *texels = m_texels.as<Texel>(), *drawn = m_picture.as<Texel>();
        double worst = 0;
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (!well_inside(m_chart, points[k])) continue;
            const double x = points[k].x - 0.5, y = points[k].y - 0.5, ix = std::floor(x), iy = std::floor(y);
            const double fx = x - ix, fy = y - iy;
            const std::size_t row = 3 * static_cast<std::size_t>(m_chart.width());
            const Texel* p = texels + static_cast<std::size_t>(iy) * row + 3 * static_cast<std::size_t>(ix);
            for (std::size_t c = 0; c < 3; ++c) {
                const double above = p[c] + fx * (double(p[c + 3]) - p[c]);
                const double below = p[c + row] + fx * (double(p[c + row + 3]) - p[c + row]);
                worst = std::max(worst, std::fabs(above + fy * (below - above) - drawn[3 * k + c]));
            }
        }
        return worst;
    }

    /// Times all contenders together, then measures and checks their errors and adds their rows.
    void measure() {
        std::vector<Timed> draws;
        for (const Contender& c : m_contenders) draws.push_back({c.draw, c.threads});
        const std::vector<Times> times = time_interleaved(draws, m_settings.rounds);
        const auto plain_time = [&](const View* view) {
            for (std::size_t k = 0; k < times.size(); ++k)
                if (m_contenders[k].view == view && m_contenders[k].scheme == "double")
                    return times[k].median;
            return kNone;
        };
        fill_with_coordinates();
        for (std::size_t k = 0; k < times.size(); ++k) {
            const Contender& c = m_contenders[k];
            const double pixels = double(c.view->width()) * c.view->height();
            Row row{m_op,
                    c.view->name,
                    c.scheme,
                    c.tol,
                    c.view->width(),
                    c.threads,
                    times[k].median / pixels,
                    times[k].best / pixels,
                    plain_time(c.view) / times[k].median,
                    {},
                    c.bound,
                    c.exact_fraction};
            row.one_tap = c.one_tap;
            row.sharing = times[k].sharing;
            if (c.points && !m_settings.efficiency) {
                const Points points = c.points();
                std::vector<float> errors = distances(m_chart, points, c.view->truth);
                row.error = accuracy_of(errors);
                if (!std::isnan(c.tol)) {
                    check_bound(row);
                    check_error_picture(c);
                }
                check_drawn(c, points);
            }
            if (m_settings.wants_scheme(c.scheme)) m_report.add(row);
        }
    }

  private:
    void check_bound(const Row& row) {
        // What double leaves of a coordinate of thousands of pixels. No tolerance at all asks for exact pixels, whose
        // rounding may be known to less than that only, near a pole.
        const double slack = 1e-9;
        if (!(row.error.max <= row.bound_px * (1 + 1e-6) + slack) ||
            !(row.tol_px == 0 || row.bound_px <= row.tol_px * (1 + 1e-12) + slack))
            fail(
                row.case_name, row.scheme, row.tol_px,
                "largest error " + std::to_string(row.error.max) + ", bound " + std::to_string(row.bound_px));
    }

    /// The errors as the product reports them, which go on beyond the source's edges.
    void check_error_picture(const Contender& c) {
        // Float polynomials with and without fused multiply-adds, and the picture's own rounding.
        const double slack = 2e-4;
        ReprojectOptions options = c.options;
        options.output = Output::error;
        const View& view = *c.view;
        PlanOptions plan;
        plan.scheme = options.scheme;
        plan.tol = options.tol;
        plan.cull = false;
        const Points points = plan_points(PanoramaPlan(view.map, plan), all());
        std::vector<float> drawn(points.size());
        const ImageView picture = packed_view(reinterpret_cast<std::byte*>(drawn.data()), PixelType::float32,
                                              view.width(), view.height(), 1);
        reprojected_picture(view.map, options).draw(nullptr, view.box(), picture, all());
        double worst = 0;
        std::size_t at = 0;
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (!well_inside(m_chart, view.truth[k])) continue;
            const double off =
                std::fabs(distance(m_chart, points[k], view.truth[k]) - static_cast<double>(drawn[k]));
            if (off > worst) worst = off, at = k;
        }
        const auto width = static_cast<std::size_t>(view.width());
        if (!(worst <= slack))
            fail(view.name, c.scheme, c.tol,
                 "the error picture is off by " + std::to_string(worst) + " px at " +
                     std::to_string(at % width) + ", " + std::to_string(at / width) + ", where it says " +
                     std::to_string(drawn[at]));
    }

    void fill_with_coordinates() {
        if (m_texels.type() != PixelType::float32) return;
        m_texels.fill(all(), [&](int x, int y, int c) {
            return static_cast<float>(c == 0   ? x + 0.5 - 0.5 * m_chart.width()
                                      : c == 1 ? y + 0.5 - 0.5 * m_chart.height()
                                               : 0);
        });
        if (m_padded) m_padded.emplace(m_views.front()->plain, m_texels.as<float>(), all());
    }

    /// The points again, through what is drawn from a source that holds its own coordinates.
    void check_drawn(const Contender& c, const Points& points) {
        if (m_texels.type() != PixelType::float32 || !c.one_tap) return;
        // Values of up to a quarter of the source's width, interpolated in float.
        const double slack = 2.5e-7 * m_chart.width() + 1e-4;
        c.draw();
        const float* drawn = m_picture.as<float>();
        double worst = 0;
        for (std::size_t k = 0; k < points.size(); ++k)
            if (well_inside(m_chart, points[k]))
                worst = std::max(worst,
                                 distance(m_chart, points[k],
                                          {static_cast<double>(drawn[3 * k]) + 0.5 * m_chart.width(),
                                           static_cast<double>(drawn[3 * k + 1]) + 0.5 * m_chart.height()}));
        if (!(worst <= slack))
            fail(c.view->name, c.scheme, c.tol, "draws " + std::to_string(worst) + " px from where it says");
    }

    void fail(const std::string& case_name, const std::string& scheme, double tol, const std::string& what) {
        m_report.failures.push_back(case_name + ", " + scheme + ", tol " + std::to_string(tol) + ": " + what);
    }

    const Settings& m_settings;
    Report& m_report;
    std::string m_op;
    Chart m_chart;
    Pool m_pool, m_pair, m_all;
    Picture m_texels, m_picture;
    MemorySource m_source;
    std::optional<PaddedSource> m_padded;
    std::vector<std::unique_ptr<View>> m_views;
    std::vector<Contender> m_contenders;
};

Chart equirectangular(int width) {
    return Chart(Projection::equirectangular, width, width / 2, 360);
}

/// 360 degrees around, 45 degrees up and down at least.
Chart cylinder(int width) {
    return Chart(Projection::cylindrical, width, static_cast<int>(std::ceil(width / 3.14159265358979)), 360);
}

// --- bilinear, float

void run_bilinear(const Settings& settings, Report& report, const Chart& chart, const std::string& name) {
    // With the zenith in the picture.
    const std::string turned = name + "_rotated", raised = name + "_pitch_60";
    if (!settings.wants_case(name) && !settings.wants_case(turned) && !settings.wants_case(raised)) return;
    Scene scene(settings, report, chart, PixelType::float32, "pano");
    scene.add_view(name, settings.size, 90, {});
    scene.add_view(turned, settings.size, 90, kTurned);
    if (chart.projection() == Projection::equirectangular)
        scene.add_view(raised, settings.size, 90, {.pitch = 60});
    for (const auto& view : scene.views()) {
        scene.add_schemes(*view, {std::begin(kTols), std::end(kTols)});
        scene.add_rivals<float>(*view);
    }
    scene.measure();

    const int threads = settings.threads;
    const Row* ours = report.find(name, "automatic", kDefaultTol, threads);
    const auto rival = [&](const char* scheme) { return report.find(name, scheme); };
    const bool cylindrical = chart.projection() == Projection::cylindrical;
    report.add_speed_target(name + ": times the plain double loop's speed", 14, rival("double"), ours);
    report.add_speed_target(name + ": times OpenCV's map + remap", cylindrical ? 8 : 12, rival("opencv"),
                            ours);
    report.add_speed_target(name + ": times the exact SIMD scheme", 1.4, rival("simd_exact"), ours);
    report.add_speed_target(name + ": of the memory limit", 0.4, rival("memory"), ours);
    if (threads == 1)
        report.add_speed_target(name + ": two threads over one", 1.8, ours,
                                report.find(name, "automatic", kDefaultTol, 2));
    report.add_speed_target(name + ": tol 1e-5 over 1e-4", 1 / 1.7,
                            report.find(name, "automatic", 1e-4, threads),
                            report.find(name, "automatic", 1e-5, threads));
    report.add_speed_target(name + ": rotated 30/20/10 over straight", 0.8, ours,
                            report.find(turned, "automatic", kDefaultTol, threads));
}

// --- bilinear, float: other targets, and small pictures of large panoramas

/// A view and its small twin, of a quarter of its width.
struct Target {
    const char* name;
    Projection projection;
    double fov;
    Orientation orientation;
    bool has_large = true;  ///< else the small one alone is new
};
const Target kTargets[] = {{"rotated", Projection::rectilinear, 90, kTurned, false},
                           {"pitch_60", Projection::rectilinear, 90, {.pitch = 60}, false},
                           {"fisheye", Projection::fisheye, 180, {}},
                           {"fisheye_rotated", Projection::fisheye, 180, kTurned},
                           {"planet", Projection::stereographic, 240, {.pitch = -90}},
                           {"cube", Projection::cubemap, 90, {}},
                           {"mercator", Projection::mercator, 360, {}},
                           {"full_sphere", Projection::equirectangular, 360, {.roll = 2}}};

/// No larger than `size` squared pixels.
Chart target_chart(const Target& target, int size) {
    const int faces = faces_of(target.projection).rows;
    if (faces > 0) return Chart(target.projection, size / 3, size / 3 * faces, target.fov);
    const bool is_sphere = target.projection == Projection::equirectangular;
    return Chart(target.projection, size, is_sphere ? size / 2 : size, target.fov);
}

void run_targets(const Settings& settings, Report& report) {
    std::vector<std::pair<std::string, const Target*>> wanted[2];
    for (const Target& target : kTargets)
        for (const bool is_small : {false, true}) {
            const std::string name = std::string(target.name) + (is_small ? "_quarter" : "");
            if ((is_small || target.has_large) && settings.wants_case(name))
                wanted[is_small].emplace_back(name, &target);
        }
    if (wanted[0].empty() && wanted[1].empty()) return;
    Scene scene(settings, report, equirectangular(source_width(settings)), PixelType::float32, "pano");
    for (const bool is_small : {false, true})
        for (const auto& [name, target] : wanted[is_small])
            scene.add_view(name,
                           target_chart(*target, is_small ? std::max(16, settings.size / 4) : settings.size),
                           target->orientation);
    for (const auto& view : scene.views()) {
        scene.add_automatic(*view, {std::begin(kTols), std::end(kTols)});
        scene.add_kept(*view);
        scene.add_defaults(*view);
        scene.add_rivals<float>(*view);
    }
    scene.measure();
}

// --- bilinear, other types of pixels

constexpr double kFine = 1.0 / 256;

/// Pixels of whole levels, whose values may be off by `most_error` of them.
template <class Texel>
void run_levels(const Settings& settings, Report& report, const std::string& name, PixelType type,
                double most_error) {
    if (!settings.wants_case(name)) return;
    Scene scene(settings, report, equirectangular(source_width(settings)), type, "pano");
    scene.add_view(name, settings.size, 90, {});
    const View& view = *scene.views().front();
    scene.add_schemes(view, {1, 1.0 / 16, kDefaultTol, kFine, 0.001, 0});
    scene.add_rivals<Texel>(view);
    scene.measure();
    const auto ours = [&](double tol) { return report.find(name, "automatic", tol, settings.threads); };
    report.add_speed_target(name + ": times OpenCV's remap alone, map in float", 3,
                            report.find(name, "opencv_remap"), ours(kDefaultTol));
    report.add_speed_target(name + ": times OpenCV's remap alone, map in fixed point", 3,
                            report.find(name, "opencv_fixed"), ours(kDefaultTol));
    report.add_speed_target(name + ": times OpenCV's remap alone, at tol 1/256", 1.3,
                            report.find(name, "opencv_remap"), ours(kFine));
    report.add_speed_target(name + ": of the memory limit", 0.2, report.find(name, "memory"),
                            ours(kDefaultTol));
    if (ours(kFine)) report.add_limit(name + ": largest error at tol 1/256", kFine, ours(kFine)->error.max);
    if (ours(kDefaultTol))
        report.add_limit(name + ": largest error of a value, levels", most_error,
                         scene.value_error<Texel>(view, kDefaultTol));
}

/// Half beside float, drawn in the same rounds: it is to be the quicker one.
void run_half(const Settings& settings, Report& report) {
    const std::string name = "equirect_half";
    if (!settings.wants_case(name)) return;
    Scene scene(settings, report, equirectangular(source_width(settings)), PixelType::half, "pano");
    Scene wide(settings, report, equirectangular(source_width(settings)), PixelType::float32, "pano");
    scene.add_view(name, settings.size, 90, {});
    const View& view = *scene.views().front();
    scene.add_schemes(view, {kDefaultTol});
    ReprojectOptions options;
    options.filter = Filter::bilinear;
    scene.add({&view, "float", kNone, settings.threads, [&wide, &view, options] {
                   draw_ours(view, wide.source(), options, wide.target(view), wide.threads());
               }});
    scene.add_memory(view);
    scene.measure();
    report.add_speed_target(name + ": times float's speed", 1, report.find(name, "float"),
                            report.find(name, "automatic", kDefaultTol, settings.threads));
}

void run_types(const Settings& settings, Report& report) {
    // Half a level of rounding, 1/32 of the weights; in uint16 what float leaves of values and of points.
    run_levels<std::uint8_t>(settings, report, "equirect_uint8", PixelType::uint8, 0.5 + 1.0 / 32);
    run_levels<std::uint16_t>(settings, report, "equirect_uint16", PixelType::uint16, 1);
    run_half(settings, report);
}

// --- antialiased

using Polygon = std::vector<Point<double>>;

/// The part of a convex polygon where sign * (coordinate - limit) >= 0.
Polygon clipped(const Polygon& polygon, double Point<double>::*coordinate, double limit, double sign) {
    Polygon result;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point<double>&a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        const double da = sign * (a.*coordinate - limit), db = sign * (b.*coordinate - limit);
        if (da >= 0) result.push_back(a);
        if ((da >= 0) != (db >= 0)) {
            const double t = da / (da - db);
            result.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
        }
    }
    return result;
}

double area(const Polygon& polygon) {
    double twice = 0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point<double>&a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    return std::fabs(twice) / 2;
}

/// Variance of the exact average of white noise of variance 1 over a polygon of texels: the sum of squared
/// coverages.
double box_variance(const Polygon& polygon) {
    const auto [top, bottom] = std::minmax_element(polygon.begin(), polygon.end(),
                                                   [](const auto& a, const auto& b) { return a.y < b.y; });
    double squares = 0;
    for (double y = std::floor(top->y); y < bottom->y; ++y) {
        const Polygon row = clipped(clipped(polygon, &Point<double>::y, y, 1), &Point<double>::y, y + 1, -1);
        if (row.empty()) continue;
        const auto [left, right] = std::minmax_element(
            row.begin(), row.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
        for (double x = std::floor(left->x); x < right->x; ++x) {
            const double texel =
                area(clipped(clipped(row, &Point<double>::x, x, 1), &Point<double>::x, x + 1, -1));
            squares += texel * texel;
        }
    }
    const double all = area(polygon);
    return squares / (all * all);
}

/// Standard deviation of a view of white noise of variance 1, each pixel the average over its footprint: the
/// mean over some thousand pixels.
double ideal_noise(const View& view) {
    const int step = std::max(1, view.width() / 48);
    double sum = 0;
    int count = 0;
    for (int j = step / 2; j < view.height(); j += step)
        for (int i = step / 2; i < view.width(); i += step) {
            Polygon corners;
            for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
                Point<double> p{};
                int piece = 0;
                view.map.exact(double(i + dx), double(j + dy), 0, p, piece);
                corners.push_back(p);
            }
            sum += box_variance(corners);
            ++count;
        }
    return std::sqrt(sum / count);
}

double standard_deviation(const float* values, std::size_t count) {
    double mean = 0, squares = 0;
    for (std::size_t k = 0; k < count; ++k)
        mean += static_cast<double>(values[k]) / static_cast<double>(count);
    for (std::size_t k = 0; k < count; ++k) squares += (values[k] - mean) * (values[k] - mean);
    return std::sqrt(squares / static_cast<double>(count));
}

void run_antialias(const Settings& settings, Report& report) {
    const std::string names[] = {"antialias_half", "antialias_eighth"};
    if (!settings.wants_case(names[0]) && !settings.wants_case(names[1])) return;
    const Chart chart = equirectangular(source_width(settings));
    Scene scene(settings, report, chart, PixelType::float32, "pano");
    scene.texels().fill(scene.all(), noise);
    scene.add_view(names[0], settings.size / 2, 120, {});
    scene.add_view(names[1], settings.size / 8, 120, {});
    const Pyramid pyramid(scene.source());
    ReprojectOptions options;
    ReprojectOptions bilinear;
    bilinear.filter = Filter::bilinear;
    for (const auto& view_pointer : scene.views()) {
        const View& view = *view_pointer;
        const auto drawing = [&](const ReprojectOptions& how) {
            return [&scene, &view, &pyramid, how] {
                draw_ours(view, pyramid, how, scene.target(view), scene.threads());
            };
        };
        for (const auto& [name, how] : {std::pair{"automatic", options}, {"bilinear", bilinear}}) {
            Contender c{&view, name, options.tol, settings.threads, drawing(how)};
            scene.describe_ours(c, how);
            scene.add(std::move(c));
        }
        Contender with_levels{&view, "with_pyramid", options.tol, settings.threads, [&scene, &view, options] {
                                  const Pyramid fresh(scene.source());
                                  draw_ours(view, fresh, options, scene.target(view), scene.threads());
                              }};
        scene.describe_ours(with_levels, options);
        scene.add(std::move(with_levels));
        scene.add_rivals<float>(view);
    }
    // Noise first: measuring ends with another source.
    std::vector<double> excess;
    for (const auto& view : scene.views()) {
        draw_ours(*view, pyramid, options, scene.target(*view), scene.all());
        // Uniform noise in 0..1 has variance 1/12.
        const double ideal = ideal_noise(*view) * std::sqrt(1 / 12.0);
        excess.push_back(standard_deviation(scene.picture().as<float>(), 3 * view->truth.size()) / ideal - 1);
    }
    scene.measure();
    for (std::size_t k = 0; k < excess.size(); ++k) {
        const View& view = *scene.views()[k];
        const std::string title = view.name + " (" + std::to_string(view.width()) + " px)";
        report.add_speed_target(title + ": of our own bilinear rate", 0.25,
                                report.find(view.name, "bilinear"), report.find(view.name, "automatic"));
        report.add_limit(title + ": noise, relative distance from the ideal box figure", 0.05,
                         std::fabs(excess[k]));
    }
}

void run(const Settings& settings, Report& report) {
    std::printf("pano: instruction set %s, %d thread(s)\n", simd_target().c_str(), settings.threads);
    const int width = source_width(settings);
    run_bilinear(settings, report, equirectangular(width), "equirect");
    run_bilinear(settings, report, cylinder(width), "cylinder");
    run_targets(settings, report);
    run_types(settings, report);
    run_antialias(settings, report);
}

// --- bound over true error

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Prints one line on the polynomial blocks of a plan and returns the median of bound over largest true
/// error; NaN when there is none.
double report_blocks(const std::string& view, const PanoramaPlan& plan, const char* scheme,
                     const Points& truth, const ParallelFor& parallel_for) {
    std::mutex mutex;
    std::vector<double> ratios;
    int broken = 0;
    const int width = plan.map().target().width();
    parallel_for(plan.regions(), [&](std::int64_t region) {
        for (const Block& block : plan.blocks(region)) {
            if (block.kind != Block::Kind::polynomial && block.kind != Block::Kind::bicubic) continue;
            double worst = 0;
            for_points(plan, block, [&](int i, int j, const Point<double>& p) {
                const Point<double>& q = truth[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                                               static_cast<std::size_t>(i)];
                worst = std::max(worst, distance(plan.map().source(), p, q));
            });
            const std::lock_guard lock(mutex);
            if (!(worst <= block.bound)) ++broken;
            if (worst > 0) ratios.push_back(block.bound / worst);
        }
    });
    if (ratios.empty()) return kNone;
    std::vector<double> sorted = ratios;
    std::sort(sorted.begin(), sorted.end());
    std::printf("%-64s %-9s %8.4g %8zu %8.3f %8.3f %8.3f %7d\n", view.c_str(), scheme, plan.options().tol,
                sorted.size(), sorted[sorted.size() / 2], sorted[sorted.size() * 9 / 10], sorted.back(),
                broken);
    return median(ratios);
}

/// The benchmark's own views and seeded random ones between all projections.
std::vector<std::pair<std::string, Panorama>> bound_views(const Settings& settings) {
    std::vector<std::pair<std::string, Panorama>> views;
    const int width = source_width(settings);
    const Chart target(Projection::rectilinear, settings.size, settings.size, 90);
    for (const auto& [name, chart] :
         {std::pair{"equirect", equirectangular(width)}, {"cylinder", cylinder(width)}}) {
        views.emplace_back(name, Panorama(chart, target));
        views.emplace_back(std::string(name) + "_rotated", Panorama(chart, target, kTurned));
    }
    std::mt19937 random(2);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    const Projection all[] = {Projection::equirectangular, Projection::cylindrical, Projection::rectilinear,
                              Projection::fisheye,         Projection::equisolid,   Projection::stereographic,
                              Projection::mercator,        Projection::cubemap};
    const int n = std::max(64, settings.size / 4);
    for (const Projection from : all)
        for (const Projection to : all) {
            const bool from_cube = from == Projection::cubemap, to_cube = to == Projection::cubemap;
            const Chart source(from, from_cube ? n : 4 * n, from_cube ? 6 * n : 2 * n);
            const double fov = to_cube ? 90 : uniform(20, to == Projection::rectilinear ? 120 : 160);
            const Orientation o{uniform(-180, 180), uniform(-80, 80), uniform(-180, 180)};
            char name[96];
            std::snprintf(name, sizeof name, "%s to %s %.0f, %.0f/%.0f/%.0f",
                          std::string(name_of(from)).c_str(), std::string(name_of(to)).c_str(), fov, o.yaw,
                          o.pitch, o.roll);
            views.emplace_back(name, Panorama(source, Chart(to, n, to_cube ? 6 * n : n, fov), o));
        }
    return views;
}

void report_bounds(const Settings& settings) {
    Pool pool(static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
    std::printf("pano: proven bound over largest true error, per polynomial block\n");
    std::printf("%-64s %-9s %8s %8s %8s %8s %8s %7s\n", "view", "scheme", "tol px", "blocks", "median", "90%",
                "most", "broken");
    std::vector<double> medians;
    for (const auto& [name, map] : bound_views(settings)) {
        if (!settings.wants_case(name)) continue;
        const Points truth = true_points(map, pool.parallel_for());
        for (const auto& [scheme, scheme_name] : kSchemes) {
            if (scheme == Scheme::automatic ? settings.scheme != "automatic"
                                            : !settings.wants_scheme(scheme_name))
                continue;
            for (const double tol : kTols) {
                PlanOptions options;
                options.scheme = scheme;
                options.tol = tol;
                const double m =
                    report_blocks(name, PanoramaPlan(map, options), scheme_name, truth, pool.parallel_for());
                if (!std::isnan(m)) medians.push_back(m);
            }
        }
    }
    if (!medians.empty()) std::printf("median over views and tolerances: %.3f\n", median(medians));
}

const RegisterOp registered({"pano", run, report_bounds});

}  // namespace
}  // namespace anamorph::bench::op_pano
