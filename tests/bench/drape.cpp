// SPDX-License-Identifier: Apache-2.0
// Pictures on surfaces: the time of a frame against how far points are off on the screen.
//
// Pictures and screens are square and of the same size, three channels of floats, bilinear. A frame is cut and drawn anew
// each time, as for a camera that moves; the bounds of the surface's patches, which do not depend on it, are kept. oka and
// oka-z are the paper's, with blocks of `block` pixels; `auto` holds a tolerance; `exact` finds each pixel's own point. Errors
// are measured in long double at every pixel.
//
// Beside them: `inner_loop_8` is what oka's blocks of 8 pixels cost when all that is left of them is addresses that step from
// pixel to pixel, the texels and the pixels, far to near; `ray_march` walks along each ray to the Gaussian surface in double;
// `moving` is auto at .125 with a camera that is elsewhere each frame, on two threads; `four_times` the screen and
// `texture_4` and `texture_16` times the texels, antialiased, next to `antialias`, the same at the usual sizes.
//
// With --bounds: how far points are off in texels of the picture, next to those of `exact`; pixels within the surface that show
// nothing (holes) and pixels beyond it that show something (spurious); and the bound over the true error, in the median over
// the patches drawn.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "anamorph/image/pyramid.h"
#include "anamorph/surface/drape.h"
#include "anamorph/surface/oka.h"
#include "bench.h"
#include "pixels.h"

namespace anamorph::bench::op_drape {
using namespace surface;
namespace {

constexpr double kTols[] = {0.5, 0.125, 0.03125};
constexpr double kBlocks[] = {4, 8, 16, 32, 64};
constexpr double kMostOfBlocks = 3, kLeastOfMarch = 150, kMostOfLoop = 1.15, kMostOfSize = 1.15;

struct Case {
    std::string name;
    std::shared_ptr<SharedTree> surface;
};

std::shared_ptr<SharedTree> surface_of(const std::string& name, const SurfaceShape& shape,
                                       const std::vector<Deformation>& deformations = {}) {
    const auto& names = surface_names();
    const auto which = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    return std::make_shared<SharedTree>(make_surface(which, shape, deformations));
}

std::vector<Deformation> gaussians() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Deformation> bumps(50);
    for (Deformation& d : bumps) {
        d.center = {uniform(random), uniform(random)};
        d.extent = glm::dvec2(0.03 + 0.1 * uniform(random));
        d.vector = {0, 0, 0.1 * uniform(random) - 0.03};
    }
    return bumps;
}

std::vector<Case> cases() {
    SurfaceShape whole, page;
    whole.angle = 360;
    page.direction = 30;
    std::mt19937 random(8);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<float> heights(256 * 256);
    for (float& h : heights) h = static_cast<float>(uniform(random));
    SurfaceSum relief;
    relief.heights = std::make_shared<SampledField>(smoothed(heights, {256, 256}, 4), Size{256, 256}, 1);
    relief.height_scale = 0.3;
    return {{"cylinder", surface_of("cylinder", {})},
            {"sphere", surface_of("sphere", whole)},
            {"page_turn", surface_of("page_turn", page)},
            {"gaussians", surface_of("plane", {}, gaussians())},
            {"relief", std::make_shared<SharedTree>(make_surface(relief))},
            {"ripples", surface_of("ripples", {})},
            {"waves", surface_of("waves", {})},
            {"torus", surface_of("torus", whole)}};
}

/// Draws one case's frames.
class Drawing {
  public:
    Drawing(int size, int texture, int threads)
        : m_size{size, size},
          m_texture{texture, texture},
          m_pool(threads),
          m_texels(bytes(m_texture, 3)),
          m_picture(bytes(m_size, 3)) {
        float* values = m_texels.as<float>();
        for (std::size_t i = 0; i < bytes(m_texture, 3) / sizeof(float); ++i)
            values[i] = static_cast<float>(i * 2654435761u % 65536) / 65536;
        m_pose.position = {0.3, 0.5, 1.6};
        m_source = std::make_unique<MemorySource>(texels());
        m_pyramid = std::make_unique<Pyramid>(*m_source);
    }

    Camera camera() const { return Camera(m_pose, glm::dmat3(1.0), glm::dvec3(0.0), m_size); }
    /// Elsewhere from now on.
    void move() {
        m_pose.position.x = 0.3 * std::cos(m_moved);
        m_pose.position.y = 0.5 * std::sin(m_moved += 0.1);
    }
    const Size& texture() const { return m_texture; }
    const float* values() const { return m_texels.as<float>(); }
    float* picture() const { return m_picture.as<float>(); }
    int size() const { return m_size.width; }

    Drape drape(const Case& c, const DrapeOptions& options) const {
        return {c.surface, camera(), m_texture, options};
    }
    void draw(const Case& c, const DrapeOptions& options) {
        const Source& source = averages(options.filter) ? static_cast<const Source&>(*m_pyramid) : *m_source;
        drape(c, options)
            .draw(&source, whole(),
                  packed_view(m_picture.bytes(), PixelType::float32, m_size.width, m_size.height, 3),
                  m_pool.parallel_for());
    }
    std::vector<float> drawn(const Case& c, DrapeOptions options, Output output, DrapeOutput own,
                             int channels) {
        options.output = output;
        options.own = own;
        std::vector<float> values(bytes(m_size, channels) / sizeof(float));
        drape(c, options)
            .draw(nullptr, whole(),
                  packed_view(reinterpret_cast<std::byte*>(values.data()), PixelType::float32, m_size.width,
                              m_size.height, channels),
                  m_pool.parallel_for());
        return values;
    }
    Accuracy error(const Case& c, const DrapeOptions& options) {
        std::vector<float> errors = drawn(c, options, Output::error, DrapeOutput::shared, 1);
        std::erase(errors, 0.0f);
        return errors.empty() ? Accuracy{0, 0, 0} : accuracy_of(errors);
    }

  private:
    static std::size_t bytes(const Size& size, int channels) {
        return sizeof(float) * static_cast<std::size_t>(channels) * static_cast<std::size_t>(size.width) *
               static_cast<std::size_t>(size.height);
    }
    ConstImageView texels() const {
        return packed_view<const std::byte>(m_texels.bytes(), PixelType::float32, m_texture.width,
                                            m_texture.height, 3);
    }
    Box whole() const { return {0, 0, m_size.width, m_size.height}; }

    Size m_size, m_texture;
    CameraPose m_pose;
    double m_moved = 0;
    Pool m_pool;
    Buffer m_texels, m_picture;
    std::unique_ptr<MemorySource> m_source;
    std::unique_ptr<Pyramid> m_pyramid;
};

/// What is left of oka's blocks when all that a frame needs but once has been done: spans of rows, with the
/// address of the first pixel and the steps to the next, (2.12).
class InnerLoop {
  public:
    InnerLoop(const Case& c, const Drawing& drawing, double side) : m_drawing(drawing) {
        OkaBlocks cut;
        cut.side = side;
        const Camera camera = drawing.camera();
        const Size texture = drawing.texture(), count = oka_block_count(texture, cut);
        std::vector<std::pair<double, OkaBlock>> blocks;
        for (int j = 0; j < count.height; ++j)
            for (int i = 0; i < count.width; ++i)
                if (OkaBlock b; oka_block(c.surface->tree.surface(), camera, texture, cut, i, j, b))
                    blocks.emplace_back(-b.centre.z, b);
        std::sort(blocks.begin(), blocks.end(),
                  [](const auto& a, const auto& b) { return a.first < b.first; });
        for (const auto& [depth, block] : blocks) add(block);
    }
    /// Bilinear, three floats, far to near.
    void draw() const {
        const int width = m_drawing.texture().width;
        const float* const texels = m_drawing.values();
        for (const Span& s : m_spans) {
            float* to = m_drawing.picture() + 3 * s.first;
            float x = s.x, y = s.y;
            for (int n = 0; n < s.count; ++n, to += 3, x += s.step_x, y += s.step_y) {
                const int i = static_cast<int>(x), j = static_cast<int>(y);
                const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
                const float* const p = texels + 3 * (std::ptrdiff_t{j} * width + i);
                const float* const q = p + std::ptrdiff_t{3} * width;
                for (int k = 0; k < 3; ++k)
                    to[k] = (1 - b) * ((1 - a) * p[k] + a * p[k + 3]) + b * ((1 - a) * q[k] + a * q[k + 3]);
            }
        }
    }

  private:
    struct Span {
        std::ptrdiff_t first;
        int count;
        float x, y, step_x, step_y;
    };

    /// The start of a span of texels, of a row or column of `size`, so that it lies within: a texel from its edges.
    static float inside(float start, float length, int size) {
        const float low = 1 - std::min(0.0f, length),
                    high = static_cast<float>(size - 3) - std::max(0.0f, length);
        return std::max(low, std::min(start, high));
    }
    void add(const OkaBlock& b) {
        // (2.11), in texels.
        const Size texture = m_drawing.texture();
        const double d = b.by_u.x * b.by_v.y - b.by_v.x * b.by_u.y, size = m_drawing.size();
        if (d == 0) return;
        const double u_x = b.by_v.y / d, u_y = -b.by_v.x / d, v_x = -b.by_u.y / d, v_y = b.by_u.x / d;
        const double reach_x =
                         std::fabs(b.by_u.x) * (b.u1 - b.u0) / 2 + std::fabs(b.by_v.x) * (b.v1 - b.v0) / 2,
                     reach_y =
                         std::fabs(b.by_u.y) * (b.u1 - b.u0) / 2 + std::fabs(b.by_v.y) * (b.v1 - b.v0) / 2;
        const auto first = [&](double at) {
            return std::max(0, static_cast<int>(std::ceil(at + (size - 1) / 2)));
        };
        const auto end = [&](double at) {
            return std::min(static_cast<int>(size), static_cast<int>(std::floor(at + (size - 1) / 2)) + 1);
        };
        for (int y = first(b.centre.y - reach_y); y < end(b.centre.y + reach_y); ++y) {
            Span s{0,
                   0,
                   0,
                   0,
                   static_cast<float>(u_x * texture.width),
                   static_cast<float>(v_x * texture.height)};
            for (int x = first(b.centre.x - reach_x); x < end(b.centre.x + reach_x); ++x) {
                const double dx = x - (size - 1) / 2 - b.centre.x, dy = y - (size - 1) / 2 - b.centre.y,
                             u = b.u + dx * u_x + dy * u_y, v = b.v + dx * v_x + dy * v_y;
                if (!(u >= b.u0 && u < b.u1 && v >= b.v0 && v < b.v1)) continue;
                if (s.count++ > 0) continue;
                s.first = std::ptrdiff_t{y} * m_drawing.size() + x;
                s.x = static_cast<float>(u * texture.width - 0.5);
                s.y = static_cast<float>(v * texture.height - 0.5);
            }
            if (s.count == 0) continue;
            // What is read lies within the picture: a span at its edge is moved inwards.
            const auto steps = static_cast<float>(s.count - 1);
            s.x = inside(s.x, steps * s.step_x, texture.width);
            s.y = inside(s.y, steps * s.step_y, texture.height);
            m_spans.push_back(s);
        }
    }

    const Drawing& m_drawing;
    std::vector<Span> m_spans;
};

/// Rays through every 8th pixel either way, to the sheet raised by the deformations: in equal steps through the slab
/// that holds it, then by halving.
class RayMarch {
  public:
    static constexpr int kEvery = 8, kSteps = 32, kHalvings = 8;

    RayMarch(const Drawing& drawing, const std::vector<Deformation>& bumps)
        : m_drawing(drawing), m_bumps(bumps) {
        for (const Deformation& d : bumps) {
            m_low += std::min(0.0, d.vector.z);
            m_high += std::max(0.0, d.vector.z);
        }
    }
    void draw() const {
        const Camera camera = m_drawing.camera();
        // The eye and the screen's axes, in space.
        const glm::dmat3 turn = glm::transpose(camera.matrix());
        const glm::dvec3 eye = -(turn * camera.offset());
        for (int y = 0; y < m_drawing.size(); y += kEvery)
            for (int x = 0; x < m_drawing.size(); x += kEvery) {
                const double half = m_drawing.size() / 2.0;
                const glm::dvec3 ray = turn * glm::dvec3((x + 0.5 - half) / camera.focal(),
                                                         (y + 0.5 - half) / camera.focal(), 1);
                const double at = march(eye, ray);
                m_drawing.picture()[3 * (y * m_drawing.size() + x)] = static_cast<float>(at);
            }
    }

  private:
    double height(double x, double y) const {
        double z = 0;
        for (const Deformation& d : m_bumps) {
            const double s = (x + 0.5 - d.center.x) / d.extent.x, t = (y + 0.5 - d.center.y) / d.extent.y;
            z += d.vector.z * std::exp(-(s * s + t * t));
        }
        return z;
    }
    double march(const glm::dvec3& eye, const glm::dvec3& ray) const {
        const auto above = [&](double t) {
            const glm::dvec3 p = eye + t * ray;
            return p.z > height(p.x, p.y);
        };
        double from = (m_high - eye.z) / ray.z;
        const double step = ((m_low - eye.z) / ray.z - from) / kSteps;
        int n = 0;
        while (n < kSteps && above(from + step)) {
            from += step;
            ++n;
        }
        double to = from + step;
        for (int k = 0; k < kHalvings; ++k) {
            const double middle = (from + to) / 2;
            (above(middle) ? from : to) = middle;
        }
        return from;
    }

    const Drawing& m_drawing;
    std::vector<Deformation> m_bumps;
    double m_low = 0, m_high = 0;
};

struct Way {
    std::string name;
    DrapeOptions options;
};

std::vector<Way> ways() {
    std::vector<Way> all{{"defaults", {}}};
    DrapeOptions options;
    options.filter = Filter::bilinear;
    for (const double tol : kTols) {
        options.tol = tol;
        all.push_back({"auto", options});
    }
    options.tol = kTols[1];
    options.scheme = DrapeScheme::exact;
    all.push_back({"exact", options});
    for (const double block : kBlocks) {
        options.block = block;
        options.scheme = DrapeScheme::oka;
        all.push_back({"oka_" + std::to_string(static_cast<int>(block)), options});
        options.scheme = DrapeScheme::oka_z;
        all.push_back({"oka-z_" + std::to_string(static_cast<int>(block)), options});
    }
    return all;
}

/// A contender, the pixels it draws, and its row.
struct Entry {
    Timed timed;
    double pixels;
    Row row;
};

Entry entry(const Case& c, const std::string& scheme, std::function<void()> draw, double pixels, int size,
            int threads) {
    Entry e{{std::move(draw), threads}, pixels, {}};
    e.row.op = "drape";
    e.row.case_name = c.name;
    e.row.scheme = scheme;
    e.row.size = size;
    e.row.threads = threads;
    e.row.ratio_to_exact = kNone;
    return e;
}

/// The schemes, of one case.
void add_ways(const Settings& settings, const Case& c, Drawing& drawing, std::vector<Entry>& entries) {
    for (const Way& way : ways()) {
        if (!settings.wants_scheme(way.name)) continue;
        Entry e = entry(
            c, way.name, [&drawing, &c, way] { drawing.draw(c, way.options); },
            double(settings.size) * settings.size, settings.size, settings.threads);
        e.row.tol_px = way.name == "auto" || way.name == "defaults" ? way.options.tol : kNone;
        if (!settings.efficiency) e.row.error = drawing.error(c, way.options);
        const Reached reached = drawing.drape(c, way.options).reached(serial_for);
        e.row.bound_px = reached.max_error;
        e.row.exact_fraction = reached.exact_fraction;
        entries.push_back(e);
    }
}

/// What they are compared with.
void add_others(const Settings& settings, const Case& c, Drawing& drawing, std::vector<Entry>& entries) {
    const int size = settings.size;
    const double pixels = double(size) * size;
    DrapeOptions options;
    options.filter = Filter::bilinear;
    for (const double block : kBlocks) {
        const std::string name = "inner_loop_" + std::to_string(static_cast<int>(block));
        if (!settings.wants_scheme(name)) continue;
        const auto loop = std::make_shared<InnerLoop>(c, drawing, block);
        entries.push_back(entry(
            c, name, [loop] { loop->draw(); }, pixels, size, 1));
    }
    if (settings.wants_scheme("ray_march") && c.name == "gaussians") {
        const auto march = std::make_shared<RayMarch>(drawing, gaussians());
        entries.push_back(entry(
            c, "ray_march", [march] { march->draw(); }, pixels / (RayMarch::kEvery * RayMarch::kEvery), size,
            1));
    }
    if (settings.wants_scheme("moving") && c.name == "page_turn") {
        const auto moving = std::make_shared<Drawing>(size, size, 2);
        const auto draw = [moving, &c, options] {
            moving->move();
            moving->draw(c, options);
        };
        entries.push_back(entry(c, "moving", draw, pixels, size, 2));
    }
    options.filter = Filter::antialias;
    const auto sized = [&](const char* name, int screen, int texture) {
        if (!settings.wants_scheme(name) || c.name != "cylinder") return;
        const auto other = std::make_shared<Drawing>(screen, texture, 1);
        entries.push_back(entry(
            c, name, [other, &c, options] { other->draw(c, options); }, double(screen) * screen, screen, 1));
    };
    sized("antialias", size, size);
    sized("four_times", 2 * size, size);
    sized("texture_4", size, 2 * size);
    sized("texture_16", size, 4 * size);
}

void add_targets(Report& report, const std::string& name) {
    const auto limit = [&](const std::string& what, double wanted, const Row* row, const Row* base) {
        if (row && base)
            report.targets.push_back({name + what, wanted, row->ns_per_px / base->ns_per_px,
                                      row->best_ns_per_px / base->best_ns_per_px, true});
    };
    const Row *held = report.find(name, "auto", 0.125), *blocks = report.find(name, "oka_8");
    limit(" at .125: times the paper's blocks of 8 pixels", kMostOfBlocks, held, blocks);
    for (const double block : kBlocks) {
        const std::string side = std::to_string(static_cast<int>(block));
        limit(": the paper's blocks of " + side + " pixels, times their inner loop", kMostOfLoop,
              report.find(name, "oka_" + side), report.find(name, "inner_loop_" + side));
    }
    const Row* usual = report.find(name, "antialias");
    limit(": four times the screen, per pixel", kMostOfSize, report.find(name, "four_times"), usual);
    limit(": sixteen times the texels instead of four", kMostOfSize, report.find(name, "texture_16"),
          report.find(name, "texture_4"));
    report.add_speed_target(name + " at .125: times as fast as a ray march", kLeastOfMarch,
                            report.find(name, "ray_march"), held);
    if (const Row* moving = report.find(name, "moving"))
        std::printf("%s, the camera moving, two threads: %.1f frames a second of %d x %d\n", name.c_str(),
                    1e9 / (moving->ns_per_px * moving->size * moving->size), moving->size, moving->size);
}

void measure(const Settings& settings, Report& report, const Case& c, Drawing& drawing) {
    std::vector<Entry> entries;
    add_ways(settings, c, drawing, entries);
    add_others(settings, c, drawing, entries);
    std::vector<Timed> timed;
    for (const Entry& e : entries) timed.push_back(e.timed);
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    for (std::size_t k = 0; k < entries.size(); ++k) {
        Row& row = entries[k].row;
        row.ns_per_px = times[k].median / entries[k].pixels;
        row.best_ns_per_px = times[k].best / entries[k].pixels;
        row.sharing = times[k].sharing;
        report.add(row);
        if (row.scheme == "auto" && !settings.efficiency && !(row.error.max <= row.tol_px))
            report.failures.push_back(c.name + ": auto is off by more than its tolerance");
    }
    add_targets(report, c.name);
}

void run(const Settings& settings, Report& report) {
    Drawing drawing(settings.size, settings.size, settings.threads);
    for (const Case& c : cases())
        if (settings.wants_case(c.name)) measure(settings, report, c, drawing);
}

/// Does body(neighbour) hold of all eight pixels about k, and of k?
template <class Body>
bool all_about(int x, int y, int size, const Body& body) {
    if (x < 1 || y < 1 || x + 1 >= size || y + 1 >= size) return false;
    for (int j = y - 1; j <= y + 1; ++j)
        for (int i = x - 1; i <= x + 1; ++i)
            if (!body(static_cast<std::size_t>(j * size + i))) return false;
    return true;
}

/// The median, over the patches that show at least a few pixels, of the bound over the largest error.
double bound_over_error(Drawing& drawing, const Case& c, const DrapeOptions& options) {
    const std::vector<float> errors = drawing.drawn(c, options, Output::error, DrapeOutput::shared, 1),
                             bounds = drawing.drawn(c, options, Output::bound, DrapeOutput::shared, 1),
                             patches = drawing.drawn(c, options, Output::color, DrapeOutput::patch, 1);
    std::map<float, std::array<float, 3>> found;  // pixels, error, bound
    for (std::size_t k = 0; k < patches.size(); ++k) {
        if (patches[k] < 0) continue;
        std::array<float, 3>& one = found[patches[k]];
        one = {one[0] + 1, std::max(one[1], errors[k]), bounds[k]};
    }
    std::vector<float> ratios;
    for (const auto& [patch, one] : found)
        if (one[0] >= 16) ratios.push_back(one[2] / one[1]);
    if (ratios.empty()) return kNone;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    return *middle;
}

void report_coverage(const Case& c, const Way& way, Drawing& drawing, const std::vector<float>& truth) {
    const std::vector<float> points = drawing.drawn(c, way.options, Output::stmap, DrapeOutput::shared, 2);
    const int size = drawing.size();
    int holes = 0, spurious = 0;
    std::vector<float> texels;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const auto k = static_cast<std::size_t>(y * size + x);
            const bool is = points[2 * k] >= 0, should = truth[2 * k] >= 0;
            if (is && should)
                texels.push_back(static_cast<float>(std::hypot(
                    (points[2 * k] - truth[2 * k]) * static_cast<float>(drawing.texture().width),
                    (points[2 * k + 1] - truth[2 * k + 1]) * static_cast<float>(drawing.texture().height))));
            else if (should)
                holes += all_about(x, y, size, [&](std::size_t n) { return truth[2 * n] >= 0; });
            else if (is)
                spurious += all_about(x, y, size, [&](std::size_t n) { return truth[2 * n] < 0; });
        }
    const Accuracy a = accuracy_of(texels);
    std::printf("%-12s %-10s %8.4g %11.3g %11.3g %11.3g %7d %9d %12.3g\n", c.name.c_str(), way.name.c_str(),
                way.name == "auto" ? way.options.tol : kNone, a.mean, a.p99, a.max, holes, spurious,
                bound_over_error(drawing, c, way.options));
    std::fflush(stdout);
}

void report_bounds(const Settings& settings) {
    Drawing drawing(settings.size, settings.size, settings.threads);
    std::printf("%-12s %-10s %8s %11s %11s %11s %7s %9s %12s\n", "case", "scheme", "tol px", "mean texels",
                "p99 texels", "max texels", "holes", "spurious", "bound/error");
    DrapeOptions exact;
    exact.scheme = DrapeScheme::exact;
    exact.tol = 0.01;
    for (const Case& c : cases()) {
        if (!settings.wants_case(c.name)) continue;
        const std::vector<float> truth = drawing.drawn(c, exact, Output::stmap, DrapeOutput::shared, 2);
        for (const Way& way : ways())
            if (settings.wants_scheme(way.name)) report_coverage(c, way, drawing, truth);
    }
}

const RegisterOp registered({"drape", run, report_bounds});

}  // namespace
}  // namespace anamorph::bench::op_drape
