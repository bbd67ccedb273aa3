// SPDX-License-Identifier: Apache-2.0
// Figures in outline: speed against error.
//
// 512 frames of three walking figures of 22 ellipsoids each. outlines: limbs with their hidden arcs.
// perspective: the same from an eye near by. limbs: nothing hidden (what VISIB draws). crossings: outlines
// and the curves in which bodies pass through each other, to 0.1 pixels. depth_tests: what one would write
// first, 100 points of every limb against all ellipsoids of the frame. many: one frame of 10,000 ellipsoids.
//
// Times are an ellipsoid's ("px"). Errors are distances of samples from the limb, relative to the ellipsoid's
// size; exact_fraction is the share of samples whose visibility agrees with a depth test in long double.
//
// --bounds: 10^5 seeded scenes of small, large interpenetrating, needle and tangent bodies against depth
// tests, on all processors (--size N: N scenes of each of the four kinds and two projections instead of
// 12500).
#include <cmath>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "../core/figure_outline_cases.h"
#include "anamorph/figure/outline/outline.h"
#include "bench.h"
#include "figure_depth_tests.h"
#include "pixels.h"

namespace anamorph::bench::op_figure {
using namespace figure;
namespace {

constexpr int kFrames = 512, kFigures = 3, kMany = 10000, kSamples = 100;
constexpr double kTurn = 2 * std::numbers::pi;

using Frames = std::vector<std::vector<Ellipsoid>>;

/// A bone hangs on the far end of another, and swings.
struct Bone {
    int on;
    double length, thickness, spread, lean, swing, phase;
};
// Torso, neck and head; then arms, hands, legs, feet with two bones each, left and right.
constexpr Bone kBones[22] = {
    {-1, 60, 28, 0, 0, .1, 0},    {0, 70, 36, 0, 0, .1, .5},     {1, 25, 14, 0, 0, .1, 1},
    {2, 40, 28, 0, 0, .2, 1},     {1, 70, 14, -.5, 2.6, .6, 0},  {4, 65, 11, 0, 2.9, .5, 0},
    {5, 25, 9, 0, 3, .3, .2},     {6, 15, 6, 0, 3, .3, .4},      {1, 70, 14, .5, 2.6, .6, 3},
    {8, 65, 11, 0, 2.9, .5, 3},   {9, 25, 9, 0, 3, .3, 3.2},     {10, 15, 6, 0, 3, .3, 3.4},
    {-1, 95, 20, -.25, 3, .5, 3}, {12, 90, 14, 0, 3.3, .4, 3.5}, {13, 20, 10, 0, 2, .2, 3},
    {14, 35, 9, 0, 1.6, .2, 3},   {-1, 95, 20, .25, 3, .5, 0},   {16, 90, 14, 0, 3.3, .4, .5},
    {17, 20, 10, 0, 2, .2, 0},    {18, 35, 9, 0, 1.6, .2, 0},    {3, 12, 5, -.3, 1.5, 0, 0},
    {3, 12, 5, .3, 1.5, 0, 0}};

std::vector<Ellipsoid> walkers(int frame) {
    std::vector<Ellipsoid> bodies;
    for (int figure = 0; figure < kFigures; ++figure) {
        glm::dvec3 ends[22];
        const double time = 0.2 * frame + figure;
        const glm::dvec3 hips(300 + 200 * figure + 60 * std::sin(.01 * frame + figure), 200,
                              500 + 80 * std::cos(.02 * frame + 2 * figure));
        for (int k = 0; k < 22; ++k) {
            const Bone& bone = kBones[k];
            const double lean = bone.lean + bone.swing * std::sin(time + bone.phase);
            const glm::dvec3 along = glm::normalize(
                glm::dvec3(bone.spread + .3 * std::sin(lean), std::cos(lean), .95 * std::sin(lean)));
            const glm::dvec3 from = bone.on < 0 ? hips : ends[bone.on];
            ends[k] = from + along * (.9 * bone.length);
            const glm::dvec3 side = glm::normalize(glm::cross(along, glm::dvec3(0, .1, 1)));
            bodies.push_back({from + along * (.45 * bone.length),
                              {bone.thickness, .5 * bone.length, .8 * bone.thickness},
                              {side, along, glm::cross(side, along)}});
        }
    }
    return bodies;
}

View window(double eye_distance) {
    View view;
    view.center = {500, 250, 500};
    view.middle = {500, 500};
    view.eye_distance = eye_distance;
    const glm::dvec3 right = glm::normalize(glm::dvec3(.9, .1, .4)),
                     away = glm::normalize(glm::cross(right, glm::dvec3(0, 1, 0)));
    view.rotation = glm::transpose(glm::dmat3(right, glm::cross(away, right), away));
    return view;
}

struct Contender {
    std::string case_name, scheme;
    std::function<void()> draw;
    double ellipsoids;
    const Frames* frames = nullptr;
    View view{};
    OutlineOptions options{};
};

void draw_all(const Frames& frames, const View& view, const OutlineOptions& options) {
    for (const std::vector<Ellipsoid>& bodies : frames) outlines(bodies, view, options);
}

/// Samples of some frames against the truth, unless they hold so many bodies that it takes too long.
void add_errors(const Contender& c, Row& row, Report& report) {
    if (!c.frames || !c.options.hide || c.frames->front().size() > 1000) return;
    test::OutlineFindings all;
    for (std::size_t k = 0; k < c.frames->size(); k += 64) {
        test::OutlineScene scene{(*c.frames)[k], c.view};
        const Outlines found = outlines(scene.bodies, c.view, c.options);
        all.add(test::examine(scene, found, 24));
    }
    row.error.max = all.worst_limb;
    row.exact_fraction = 1 - static_cast<double>(all.wrong) / static_cast<double>(all.samples);
    if (all.wrong || all.gaps || !(all.worst_limb <= 1e-9))
        report.failures.push_back("figure: " + c.case_name + ", " + c.scheme + ": " +
                                  std::to_string(all.wrong) + " wrong samples, off the limb by up to " +
                                  std::to_string(all.worst_limb));
}

void run(const Settings& settings, Report& report) {
    // Fewer frames for quick runs.
    const int count = std::min(kFrames, std::max(1, settings.size / 4));
    Frames frames, many(1);
    for (int f = 0; f < count; ++f) frames.push_back(walkers(f));
    test::SceneMaker random(1);
    for (int k = 0; k < std::min(kMany, 20 * count); ++k) many[0].push_back(random.body(400, 1, 12));

    const View flat = window(HUGE_VAL), near_by = window(900);
    OutlineOptions limbs, crossings;
    limbs.hide = false;
    crossings.crossings = true;
    Frames few;
    for (std::size_t f = 0; f < frames.size(); f += 32) few.push_back(frames[f]);
    std::int64_t hidden = 0;
    const auto ours = [&](const char* scheme, const Frames& of, const View& view,
                          const OutlineOptions& options, const char* case_name) {
        return Contender{case_name,
                         scheme,
                         [&of, view, options] { draw_all(of, view, options); },
                         static_cast<double>(of.size() * of[0].size()),
                         &of,
                         view,
                         options};
    };
    std::vector<Contender> contenders;
    contenders.push_back({"walk_66", "depth_tests",
                          [&] {
                              for (const auto& bodies : few) hidden += hidden_samples(bodies, flat, kSamples);
                          },
                          static_cast<double>(66 * few.size())});
    contenders.push_back(ours("outlines", frames, flat, {}, "walk_66"));
    contenders.push_back(ours("perspective", frames, near_by, {}, "walk_66"));
    contenders.push_back(ours("limbs", frames, flat, limbs, "walk_66"));
    contenders.push_back(ours("crossings", few, flat, crossings, "walk_66"));
    contenders.push_back(ours("outlines", many, flat, {}, "many"));
    std::erase_if(contenders, [&](const Contender& c) {
        return !settings.wants_case(c.case_name) || !settings.wants_scheme(c.scheme);
    });
    std::vector<Timed> timed;
    for (const Contender& c : contenders) timed.push_back({c.draw, 1});
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    for (std::size_t k = 0; k < contenders.size(); ++k) {
        const Contender& c = contenders[k];
        Row row;
        row.op = "figure";
        row.case_name = c.case_name;
        row.scheme = c.scheme;
        row.size = count;
        row.ns_per_px = times[k].median / c.ellipsoids;
        row.best_ns_per_px = times[k].best / c.ellipsoids;
        row.ratio_to_exact = contenders[0].scheme == "depth_tests" && c.case_name == "walk_66"
                                 ? times[0].median / contenders[0].ellipsoids / row.ns_per_px
                                 : kNone;
        add_errors(c, row, report);
        report.add(row);
    }
    if (const Row* row = report.find("walk_66", "outlines")) {
        const double all = kFrames * 66 * 1e-9;
        report.targets.push_back({"figure: 512 frames of 66 ellipsoids in outline, s (HIDE of 2003: .14)",
                                  .14, row->ns_per_px * all, row->best_ns_per_px * all, true});
    }
}

void report_scenes(const Settings& settings) {
    const int scenes = settings.size == Settings{}.size ? 12500 : settings.size;
    Pool pool(static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
    std::printf("figure: visibility of outline samples against depth tests, %d scenes each\n", scenes);
    std::printf("%-8s %-12s %12s %12s %8s %8s %8s %8s %10s\n", "scenes", "view", "samples", "hidden", "wrong",
                "near", "grazing", "gaps", "off limb");
    for (const test::Family family : test::kFamilies)
        for (const bool perspective : {false, true}) {
            std::mutex mutex;
            test::OutlineFindings all;
            pool.parallel_for()(scenes, [&](std::int64_t k) {
                const test::OutlineScene scene =
                    test::SceneMaker(static_cast<std::uint64_t>(k)).scene(family, perspective);
                const test::OutlineFindings found =
                    test::examine(scene, outlines(scene.bodies, scene.view), 48);
                const std::lock_guard lock(mutex);
                all.add(found);
            });
            std::printf("%-8s %-12s %12lld %12lld %8lld %8lld %8lld %8lld %10.2g\n", test::name_of(family),
                        perspective ? "perspective" : "orthographic", static_cast<long long>(all.samples),
                        static_cast<long long>(all.hidden), static_cast<long long>(all.wrong),
                        static_cast<long long>(all.near), static_cast<long long>(all.grazing),
                        static_cast<long long>(all.gaps), all.worst_limb);
        }
}

const RegisterOp registered({"figure", run, report_scenes});

}  // namespace
}  // namespace anamorph::bench::op_figure
