// SPDX-License-Identifier: Apache-2.0
// Whole films of figures: speed with the defaults.
//
// walkers: five figures of 20 ellipsoids that walk about for 120 frames, some of them out of the picture. embrace: two, which touch
// themselves in every frame. And each script of the folder ANAMORPH_NUDES (else of ../shared/nudes/scripts), where it is there.
//
// perform: the film from its program. hide: its frames as HIDE writes them, limbs with their hidden arcs as text (.2), without
// performing. draw: its frames as strokes of a page of 500 pixels, as svg, pdf and png have them. depth_tests: what one would write first,
// 24 points of every limb against all ellipsoids of the frame, of some frames; ratio_to_exact of hide and draw is against that. Times are an ellipsoid's
// in one frame. exact_fraction is the share of samples whose visibility agrees with a depth test in long double.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "../core/figure_outline_cases.h"
#include "anamorph/figure/files/ellipse_file.h"
#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script.h"
#include "anamorph/figure/outline/drawing.h"
#include "bench.h"
#include "figure_depth_tests.h"

namespace anamorph::bench::op_figure_films {
using namespace figure;
namespace {

constexpr int kSamples = 24, kSampledFrames = 8, kPage = 500;

struct Film {
    std::string name, script;
};

/// A figure with a trunk of eight ellipsoids and limbs of three on either side of both ends, and how it moves.
void add_figure(int number, int frames, bool touches, std::string& figures, std::string& movements) {
    const std::string own = "f" + std::to_string(number);
    const double angle = 2.4 * number;
    const std::string last_frame = std::to_string(frames);
    std::string names, shapes, joints;
    for (int k = 0; k < 8; ++k) {
        const std::string name = own + "trunk" + std::to_string(k);
        names += " " + name;
        shapes += "ellipsoid " + name + " 30 20 20\n";
        if (k > 0)
            joints += "joint " + own + "spine" + std::to_string(k) + " " + own + "trunk" +
                      std::to_string(k - 1) + " 0 18 0 " + name + " 0 -18 0\n";
    }
    movements += "repeat 0 1 moveto " + own + " " + own + "trunk0 " +
                 std::to_string(500 + 400 * std::cos(angle)) + " 250 " +
                 std::to_string(500 + 400 * std::sin(angle)) + "\n";
    constexpr const char* limbs[] = {"foot", "shin", "thigh", "hand", "farm", "uarm"};
    for (const char* side : {"l", "r"})
        for (int k = 0; k < 6; ++k) {
            const std::string name = own + side + limbs[k], joint = name + "j",
                              sign = *side == 'l' ? "" : "-";
            const std::string next = k == 2   ? own + "trunk0"
                                     : k == 5 ? own + "trunk7"
                                              : own + side + limbs[k + 1];
            names += " " + name;
            shapes += "ellipsoid " + name + " 10 40 10\n";
            joints +=
                "joint " + joint + " " + name + " 0 38 0 " + next + (k % 3 == 2 ? " 20 0 0\n" : " 0 -38 0\n");
            for (int f = 0; f < frames; f += 24)
                for (const int half : {0, 1})
                    movements += "quadratic " + std::to_string(f + 12 * half) + " " +
                                 std::to_string(f + 12 * half + 12) + " flex " + name + " " + joint + " " +
                                 (half ? (sign.empty() ? "-" : "") : sign) + "30\n";
        }
    movements += "linear 0 " + last_frame + " moveby " + own + " " + own + "trunk0 " +
                 std::to_string(std::lround(150 * std::cos(3 * angle))) + " 0 90\n";
    movements += "linear 0 " + last_frame + " spinby " + own + " " + own + "trunk0 " + own + "trunk0 360 y\n";
    movements += "repeat 0 " + last_frame + " ground " + own + "\n";
    if (touches)
        movements += "repeat 0 " + last_frame + " touch " + own + "lhand " + own + "rhand " + own + "luarm " +
                     own + "trunk7 " + own + "luarmj z\n";
    figures += "figure " + own + " 20" + names + "\n" + shapes + joints;
}

std::string script_of(int count, int frames, bool touches) {
    std::string figures, movements;
    for (int k = 0; k < count; ++k) add_figure(k, frames, touches, figures, movements);
    return figures + movements + "stop\n";
}

std::vector<Film> films(int frames) {
    std::vector<Film> all{{"walkers", script_of(5, frames, false)}, {"embrace", script_of(2, frames, true)}};
    const char* const given = std::getenv("ANAMORPH_NUDES");
    const std::filesystem::path folder =
        std::filesystem::path(given ? given : ANAMORPH_NUDES_FOLDER) / "scripts";
    std::error_code none;
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder, none))
        if (entry.path().extension() == ".n") found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    for (const std::filesystem::path& path : found) {
        std::ifstream file(path);
        all.push_back({path.stem().string(), {std::istreambuf_iterator<char>(file), {}}});
    }
    return all;
}

std::vector<FigureFrame> frames_of(const Program& program) {
    std::vector<FigureFrame> frames;
    Performance(program).for_each_frame([&](const FigureFrame& frame) {
        frames.push_back(frame);
        return true;
    });
    return frames;
}

std::vector<Ellipsoid> shapes_of(const FigureFrame& frame) {
    std::vector<Ellipsoid> shapes;
    for (const Body& body : frame.bodies) shapes.push_back(body.shape);
    return shapes;
}

/// Every how many frames one is looked at closely.
std::size_t stride_of(const std::vector<FigureFrame>& frames) {
    return std::max<std::size_t>(1, frames.size() / kSampledFrames);
}

void add_errors(const std::string& film, const std::vector<FigureFrame>& frames, Row& row, Report& report) {
    test::OutlineFindings all;
    for (std::size_t k = 0; k < frames.size(); k += stride_of(frames)) {
        const test::OutlineScene scene{shapes_of(frames[k]), view_of(frames[k])};
        all.add(test::examine(scene, outlines(scene.bodies, scene.view), kSamples));
    }
    row.error.max = all.worst_limb;
    row.exact_fraction =
        1 - static_cast<double>(all.wrong) / static_cast<double>(std::max<std::int64_t>(all.samples, 1));
    if (all.wrong || all.gaps)
        report.failures.push_back("figure, film " + film + ": " + std::to_string(all.wrong) +
                                  " wrong samples");
}

void measure(const Film& film, const Settings& settings, Report& report) {
    Program program;
    try {
        program = parse_program(film.script, film.name);
    } catch (const Error&) {
        return;  // a script that is not whole
    }
    const std::vector<FigureFrame> frames = frames_of(program);
    if (frames.empty() || frames[0].bodies.empty()) return;
    double bodies = 0, sampled = 0;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const auto count = static_cast<double>(frames[k].bodies.size());
        bodies += count;
        if (k % stride_of(frames) == 0) sampled += count;
    }
    std::size_t sum = 0;  // so that nothing is left out
    struct Contender {
        std::string scheme;
        std::function<void()> draw;
        double items;
    };
    const std::vector<Contender> contenders{
        {"depth_tests",
         [&] {
             for (std::size_t k = 0; k < frames.size(); k += stride_of(frames))
                 sum += static_cast<std::size_t>(
                     hidden_samples(shapes_of(frames[k]), view_of(frames[k]), kSamples));
         },
         sampled},
        {"perform", [&] { sum += frames_of(program).size(); }, bodies},
        {"hide",
         [&] {
             for (const FigureFrame& frame : frames) sum += ellipse_text(ellipses_of(frame, true)).size();
         },
         bodies},
        {"draw",
         [&] {
             for (const FigureFrame& frame : frames)
                 sum += draw(frame, view_of(frame, kPage / 1000.0), glm::dvec2(kPage), {}).strokes.size();
         },
         bodies}};
    std::vector<Timed> timed;
    for (const Contender& c : contenders) timed.push_back({c.draw, 1});
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    for (std::size_t k = 0; k < contenders.size(); ++k) {
        const Contender& c = contenders[k];
        if (!settings.wants_scheme(c.scheme)) continue;
        Row row;
        row.op = "figure";
        row.case_name = film.name;
        row.scheme = c.scheme;
        row.size = static_cast<int>(frames.size());
        row.ns_per_px = times[k].median / c.items;
        row.best_ns_per_px = times[k].best / c.items;
        row.ratio_to_exact =
            c.scheme == "perform" ? kNone : times[0].median / contenders[0].items / row.ns_per_px;
        if (c.scheme == "hide") add_errors(film.name, frames, row, report);
        report.add(row);
    }
    if (sum == 0) report.failures.push_back("figure, film " + film.name + ": nothing is drawn");
}

void run(const Settings& settings, Report& report) {
    for (const Film& film : films(std::clamp(settings.size / 16, 24, 120)))
        if (settings.wants_case(film.name)) measure(film, settings, report);
}

const RegisterOp registered({"figure", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_figure_films
