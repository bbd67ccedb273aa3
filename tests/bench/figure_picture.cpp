// SPDX-License-Identifier: Apache-2.0
// Figures as pixels: speed against error.
//
// picture_20, picture_2000: random ellipsoids of aspect ratios up to 1000, interpenetrating, without
// perspective, 512 x 512 pixels at most. id: the body that the ray through each pixel's middle meets; shaded_1:
// its colour; shaded: with 256 samples where a pixel has an edge. all_rays: what one would write first, every
// pixel against every ellipsoid (of 20). povray_id, povray_shaded: POV-Ray, if it is installed, by the trace
// time that it tells, of flat colours and of one light without shadows; each without antialiasing.
//
// exact_fraction of id is the share of pixels with POV-Ray's body: all of them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "../core/figure_picture_cases.h"
#include "anamorph/figure/image/figure_picture.h"
#include "bench.h"

namespace anamorph::bench::op_figure_picture {
using namespace figure;
namespace {

using figure_picture_cases::Scene;
using figure_picture_cases::SceneMaker;

Scene random_scene(int count, int size) {
    SceneMaker make(static_cast<unsigned>(count));
    const bool few = count < 100;
    Scene scene = make.scene(count, few ? 10 : 2, few ? 60 : 15, 1000, HUGE_VAL, size, size);
    scene.view.rotation = glm::dmat3(1.0);
    scene.view.middle = glm::dvec2(0.5 * size);
    return scene;
}

FigureFrame frame_of(const Scene& scene) {
    FigureFrame frame;
    for (const Ellipsoid& shape : scene.bodies) {
        Body body;
        body.shape = shape;
        frame.bodies.push_back(body);
    }
    return frame;
}

void draw(const Scene& scene, FigureStyle style, bool antialias, float* pixels) {
    FigureLook look;
    look.style = style;
    look.antialias = antialias;
    const int channels = channels_of(style);
    FigurePicture(frame_of(scene), scene.view, {scene.width, scene.height}, look)
        .draw({0, 0, scene.width, scene.height},
              packed_view(reinterpret_cast<std::byte*>(pixels), PixelType::float32, scene.width, scene.height,
                          channels));
}

/// The plain loop. Without perspective, along z.
std::vector<float> all_rays(const Scene& scene) {
    std::vector<float> pixels;
    for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
            const glm::dvec3 from((x + 0.5 - scene.view.middle.x) / scene.view.scale,
                                  (scene.height - y - 0.5 - scene.view.middle.y) / scene.view.scale, 0);
            double nearest = HUGE_VAL;
            std::size_t seen = 0;
            for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
                const Ellipsoid& e = scene.bodies[i];
                const glm::dmat3 own = glm::transpose(e.rotation);
                const glm::dvec3 o = own * (from - e.center) / e.axes, d = own[2] / e.axes;
                const double a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - 1;
                const double depth = b * b >= a * c ? (-b - std::sqrt(b * b - a * c)) / a : HUGE_VAL;
                if (depth < nearest) nearest = depth, seen = i + 1;
            }
            pixels.push_back(static_cast<float>(seen));
        }
    return pixels;
}

// --- POV-Ray -----------------------------------------------------------------------------------------------

std::string text_of(const Scene& scene, bool flat) {
    std::ostringstream text;
    text.precision(17);
    text << "#version 3.7; global_settings {assumed_gamma 1}\n"
         << "camera {orthographic location <0,0,-1000> right <200,0,0> up <0,200,0> direction <0,0,1>}\n";
    if (!flat) text << "light_source {<-1000,2000,-2000> rgb 1 shadowless}\n";
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Ellipsoid& e = scene.bodies[i];
        const std::size_t id = i + 1;
        text << "sphere {0,1 scale <" << e.axes.x << "," << e.axes.y << "," << e.axes.z << "> matrix <";
        for (int k = 0; k < 3; ++k)
            text << e.rotation[k].x << "," << e.rotation[k].y << "," << e.rotation[k].z << ",";
        text << e.center.x << "," << e.center.y << "," << e.center.z << "> pigment {rgb <"
             << static_cast<double>(id % 256) / 255 << "," << static_cast<double>(id / 256) / 255
             << ",1>} finish {" << (flat ? "ambient 1 diffuse 0" : "ambient 0.3 diffuse 0.7") << "}}\n";
    }
    return text.str();
}

struct Traced {
    double seconds = kNone;
    std::vector<float> ids;  ///< of flat colours
};

/// The ids that the colours of a PPM file say.
std::vector<float> read_ids(const std::string& name, int pixels) {
    std::ifstream file(name, std::ios::binary);
    const std::string all{std::istreambuf_iterator<char>(file), {}};
    std::vector<float> ids;
    const std::size_t size = 3 * static_cast<std::size_t>(pixels);
    if (all.size() < size) return ids;
    for (std::size_t at = all.size() - size; at < all.size(); at += 3) {
        const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(all[at + k]); };
        ids.push_back(byte(2) > 128 ? static_cast<float>(byte(0) + 256 * byte(1)) : 0);
    }
    return ids;
}

Traced trace(const Scene& scene, bool flat) {
    namespace fs = std::filesystem;
    if (std::system("command -v povray > /dev/null 2>&1") != 0) return {};
    const std::string folder = (fs::temp_directory_path() / "anamorph_bench_XXXXXX").string();
    std::vector<char> name(folder.begin(), folder.end());
    name.push_back('\0');
    if (!mkdtemp(name.data())) return {};
    const std::string base = std::string(name.data()) + "/scene";
    std::ofstream(base + ".pov") << text_of(scene, flat);
    const std::string size = " +W" + std::to_string(scene.width) + " +H" + std::to_string(scene.height);
    const std::string command = "povray +I" + base + ".pov +O" + base +
                                ".ppm +FP8 -A -D +WT1 File_Gamma=1.0" + size + " > " + base + ".txt 2>&1";
    Traced traced;
    if (std::system(command.c_str()) == 0) {
        std::ifstream log(base + ".txt");
        const std::string said{std::istreambuf_iterator<char>(log), {}};
        const std::size_t line = said.find("Trace Time:"), with = said.find(" with ", line);
        if (line != std::string::npos && with != std::string::npos)
            traced.seconds = std::atof(said.c_str() + with + 6);
        if (flat) traced.ids = read_ids(base + ".ppm", scene.width * scene.height);
    }
    fs::remove_all(name.data());
    return traced;
}

// --- The table ---------------------------------------------------------------------------------------------

struct Contender {
    std::string scheme;
    std::function<void()> draw;
};

class Case {
  public:
    Case(std::string name, Scene scene, const Settings& settings, Report& report)
        : m_name(std::move(name)),
          m_scene(std::move(scene)),
          m_settings(settings),
          m_report(report),
          m_pixels(static_cast<std::size_t>(4 * m_scene.width * m_scene.height)) {}

    void run() {
        if (!m_settings.wants_case(m_name)) return;
        std::vector<Contender> contenders;
        if (m_scene.bodies.size() <= 20) contenders.push_back({"all_rays", [this] { all_rays(m_scene); }});
        contenders.push_back({"id", [this] { draw(m_scene, FigureStyle::id, false, m_pixels.data()); }});
        contenders.push_back(
            {"shaded_1", [this] { draw(m_scene, FigureStyle::shaded, false, m_pixels.data()); }});
        contenders.push_back(
            {"shaded", [this] { draw(m_scene, FigureStyle::shaded, true, m_pixels.data()); }});
        std::erase_if(contenders, [&](const Contender& c) { return !m_settings.wants_scheme(c.scheme); });
        std::vector<Timed> timed;
        for (const Contender& c : contenders) timed.push_back({c.draw, 1});
        const std::vector<Times> times = time_interleaved(timed, m_settings.rounds);
        for (std::size_t k = 0; k < contenders.size(); ++k)
            add(contenders[k].scheme, times[k].median, times[k].best);
        compare_with_povray();
    }

  private:
    void add(const std::string& scheme, double nanoseconds, double best, double exact = kNone) {
        const double pixels = m_scene.width * m_scene.height;
        Row row;
        row.op = "figure";
        row.case_name = m_name;
        row.scheme = scheme;
        row.size = m_scene.width;
        row.ns_per_px = nanoseconds / pixels;
        row.best_ns_per_px = best / pixels;
        const Row* plain = m_report.find(m_name, "all_rays");
        row.ratio_to_exact = scheme == "all_rays" ? 1 : plain ? plain->ns_per_px / row.ns_per_px : kNone;
        row.exact_fraction = exact;
        m_report.add(row);
    }

    void compare_with_povray() {
        for (const bool flat : {true, false}) {
            const std::string scheme = flat ? "povray_id" : "povray_shaded";
            if (!m_settings.wants_scheme(scheme)) continue;
            double best = HUGE_VAL;
            std::vector<double> all;
            Traced traced;
            for (int i = 0; i < std::max(1, m_settings.rounds / 3); ++i) {
                traced = trace(m_scene, flat);
                if (!(traced.seconds > 0)) return;
                all.push_back(traced.seconds * 1e9);
                best = std::min(best, all.back());
            }
            std::sort(all.begin(), all.end());
            add(scheme, all[all.size() / 2], best, flat ? same_share(traced.ids) : kNone);
            const double wanted = m_scene.bodies.size() <= 20 ? 20 : 10;
            m_report.add_speed_target("figure: " + m_name + (flat ? ", id" : ", shaded") + " against POV-Ray",
                                      wanted, m_report.find(m_name, scheme),
                                      m_report.find(m_name, flat ? "id" : "shaded_1"));
        }
    }

    double same_share(const std::vector<float>& ids) {
        draw(m_scene, FigureStyle::id, false, m_pixels.data());
        const auto all = static_cast<std::size_t>(m_scene.width * m_scene.height);
        std::size_t same = 0;
        for (std::size_t i = 0; i < all; ++i) same += i < ids.size() && m_pixels[i] == ids[i];
        if (same < all)
            m_report.failures.push_back("figure: " + m_name + ": " + std::to_string(all - same) +
                                        " pixels differ from POV-Ray's");
        return static_cast<double>(same) / static_cast<double>(all);
    }

    std::string m_name;
    Scene m_scene;
    const Settings& m_settings;
    Report& m_report;
    std::vector<float> m_pixels;
};

void run(const Settings& settings, Report& report) {
    const int size = std::min(512, settings.size);
    Case("picture_20", random_scene(20, size), settings, report).run();
    Case("picture_2000", random_scene(2000, size), settings, report).run();
}

const RegisterOp registered({"figure", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_figure_picture
