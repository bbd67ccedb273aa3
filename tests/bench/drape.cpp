// SPDX-License-Identifier: Apache-2.0
// Pictures on surfaces: the time of a frame against how far points are off on the screen.
//
// Pictures and screens are square and of the same size, three channels of floats, bilinear. A frame is cut and drawn anew
// each time, as for a camera that moves; the bounds of the surface's patches, which do not depend on it, are kept. oka and
// oka-z are the paper's, with blocks of `block` pixels; `auto` holds a tolerance; `exact` finds each pixel's own point. Errors
// are measured in long double at every pixel.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "anamorph/drape/drape.h"
#include "bench.h"
#include "pixels.h"

namespace anamorph::bench {
namespace {

constexpr double kTols[] = {0.5, 0.125, 0.03125};
constexpr double kBlocks[] = {4, 8, 16, 32, 64};
constexpr double kMostOfBlocks = 3;

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

std::vector<Case> cases() {
    SurfaceShape whole, page;
    whole.angle = 360;
    page.direction = 30;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Deformation> bumps(50);
    for (Deformation& d : bumps) {
        d.center = {uniform(random), uniform(random)};
        d.extent = glm::dvec2(0.03 + 0.1 * uniform(random));
        d.vector = {0, 0, 0.1 * uniform(random) - 0.03};
    }
    std::vector<float> heights(256 * 256);
    for (float& h : heights) h = static_cast<float>(uniform(random));
    SurfaceSum relief;
    relief.heights = std::make_shared<SampledField>(smoothed(heights, {256, 256}, 4), Size{256, 256}, 1);
    relief.height_scale = 0.3;
    return {{"cylinder", surface_of("cylinder", {})},
            {"sphere", surface_of("sphere", whole)},
            {"page_turn", surface_of("page_turn", page)},
            {"gaussians", surface_of("plane", {}, bumps)},
            {"relief", std::make_shared<SharedTree>(make_surface(relief))}};
}

/// Draws one case's frames.
class Drawing {
  public:
    explicit Drawing(const Settings& settings)
        : m_size{settings.size, settings.size},
          m_pool(settings.threads),
          m_texels(bytes(3)),
          m_picture(bytes(3)) {
        float* values = m_texels.as<float>();
        for (std::size_t i = 0; i < bytes(3) / sizeof(float); ++i)
            values[i] = static_cast<float>(i * 2654435761u % 65536) / 65536;
        m_pose.position = {0.3, 0.5, 1.6};
    }

    Drape drape(const Case& c, const DrapeOptions& options) const {
        return {c.surface, Camera(m_pose, glm::dmat3(1.0), glm::dvec3(0.0), m_size), m_size, options};
    }
    void draw(const Case& c, const DrapeOptions& options) {
        const MemorySource source(packed_view<const std::byte>(m_texels.bytes(), PixelType::float32,
                                                               m_size.width, m_size.height, 3));
        drape(c, options)
            .draw(&source, whole(),
                  packed_view(m_picture.bytes(), PixelType::float32, m_size.width, m_size.height, 3),
                  m_pool.parallel_for());
    }
    Accuracy error(const Case& c, DrapeOptions options) {
        options.output = Output::error;
        std::vector<float> errors(bytes(1) / sizeof(float));
        drape(c, options)
            .draw(nullptr, whole(),
                  packed_view(reinterpret_cast<std::byte*>(errors.data()), PixelType::float32, m_size.width,
                              m_size.height, 1),
                  m_pool.parallel_for());
        std::erase(errors, 0.0f);
        if (errors.empty()) return {0, 0, 0};
        std::sort(errors.begin(), errors.end());
        return {std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size()),
                errors[errors.size() * 99 / 100], errors.back()};
    }

  private:
    std::size_t bytes(int channels) const {
        return sizeof(float) * static_cast<std::size_t>(channels) * static_cast<std::size_t>(m_size.width) *
               static_cast<std::size_t>(m_size.height);
    }
    Box whole() const { return {0, 0, m_size.width, m_size.height}; }

    Size m_size;
    CameraPose m_pose;
    Pool m_pool;
    Buffer m_texels, m_picture;
};

struct Way {
    std::string name;
    DrapeOptions options;
};

std::vector<Way> ways() {
    std::vector<Way> all;
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

void measure(const Settings& settings, Report& report, const Case& c, Drawing& drawing) {
    std::vector<Timed> timed;
    std::vector<Row> rows;
    for (const Way& way : ways()) {
        if (!settings.wants_scheme(way.name)) continue;
        timed.push_back({[&drawing, &c, way] { drawing.draw(c, way.options); }, settings.threads});
        Row row;
        row.op = "drape";
        row.case_name = c.name;
        row.scheme = way.name;
        row.tol_px = way.name == "auto" ? way.options.tol : kNone;
        row.size = settings.size;
        row.threads = settings.threads;
        row.ratio_to_exact = kNone;
        row.error = drawing.error(c, way.options);
        const Reached reached = drawing.drape(c, way.options).reached(serial_for);
        row.bound_px = reached.max_error;
        row.exact_fraction = reached.exact_fraction;
        rows.push_back(row);
    }
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double pixels = double(settings.size) * settings.size;
        rows[k].ns_per_px = times[k].median / pixels;
        rows[k].best_ns_per_px = times[k].best / pixels;
        report.add(rows[k]);
        if (rows[k].scheme == "auto" && !(rows[k].error.max <= rows[k].tol_px))
            report.failures.push_back(c.name + ": auto is off by more than its tolerance");
    }
    const Row *held = report.find(c.name, "auto", 0.125), *blocks = report.find(c.name, "oka_8");
    if (!held || !blocks) return;
    char what[96];
    std::snprintf(what, sizeof what, "%s at .125: times the paper's blocks of 8 pixels", c.name.c_str());
    report.targets.push_back({what, kMostOfBlocks, held->ns_per_px / blocks->ns_per_px,
                              held->best_ns_per_px / blocks->best_ns_per_px, true});
}

void run(const Settings& settings, Report& report) {
    Drawing drawing(settings);
    for (const Case& c : cases())
        if (settings.wants_case(c.name)) measure(settings, report, c, drawing);
}

const RegisterOp registered({"drape", run, nullptr});

}  // namespace
}  // namespace anamorph::bench
