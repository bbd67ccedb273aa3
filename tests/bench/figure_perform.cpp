// SPDX-License-Identifier: Apache-2.0
// Scripts of NUDES: speed.
//
// A figure of 20 ellipsoids that walks for 1920 frames in 80 calls of a subroutine. parse: the text read into
// a program; the time is a character's. perform: all frames in order; a frame's. random: frames in random
// order of a performance that has been through once, so that states are kept; a frame's. ratio_to_exact:
// against one frame by performing all before it (restart), on average.
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script.h"
#include "bench.h"

namespace anamorph::bench::op_figure_perform {
using namespace figure;
namespace {

constexpr int kCalls = 80, kCallFrames = 24, kFrames = kCalls * kCallFrames, kAsked = 64;
constexpr const char* kLimbs[] = {"foot", "shin", "thigh", "uarm", "farm", "hand"};

/// A trunk of eight ellipsoids, and limbs of three on either side of both ends.
std::string walk() {
    std::string bodies, joints, swings;
    const auto body = [&](const std::string& name) { bodies += " " + name; };
    std::string shapes;
    for (int k = 0; k < 8; ++k) {
        const std::string name = "trunk" + std::to_string(k);
        body(name);
        shapes += "ellipsoid " + name + " 30 20 20\n";
        if (k > 0)
            joints += "joint spine" + std::to_string(k) + " trunk" + std::to_string(k - 1) + " 0 18 0 " +
                      name + " 0 -18 0\n";
    }
    for (const char* side : {"l", "r"})
        for (int k = 0; k < 6; ++k) {
            const std::string name = std::string(side) + kLimbs[k], joint = name + "j";
            const bool last = k % 3 == 2;
            const std::string next =
                last ? (k == 2 ? "trunk0" : "trunk7") : std::string(side) + kLimbs[k + 1];
            body(name);
            shapes += "ellipsoid " + name + " 10 40 10\n";
            joints += "joint " + joint + " " + name + " 0 38 0 " + next + (last ? " 20 0 0\n" : " 0 -38 0\n");
            const std::string sign = *side == 'l' ? "" : "-";
            swings += "quadratic 0 12 flex " + name + " " + joint + " " + sign + "30\n";
            swings += "quadratic 12 24 flex " + name + " " + joint + " " + sign + "-30\n";
        }
    std::string text = "figure walker 20" + bodies + "\n" + shapes + joints;
    text += "subroutine step\n" + swings + "linear 0 24 moveby walker trunk0 0 0 10\n";
    text += "repeat 0 24 ground walker\nendsub step\n";
    for (int k = 0; k < kCalls; ++k)
        text += "call " + std::to_string(kCallFrames * k) + " " + std::to_string(kCallFrames * (k + 1)) +
                " step\n";
    return text + "stop\n";
}

void run(const Settings& settings, Report& report) {
    if (!settings.wants_case("script")) return;
    const std::string text = walk();
    const Program program = parse_program(text, "walk");
    Performance played(program);
    played.frame(kFrames);
    std::mt19937 random(11);
    std::vector<int> asked;
    for (int k = 0; k < kAsked; ++k) asked.push_back(std::uniform_int_distribution(1, kFrames)(random));
    double sum = 0;  // so that nothing is left out
    struct Contender {
        std::string scheme;
        std::function<void()> draw;
        double items;
    };
    const Contender contenders[] = {
        {"parse", [&] { sum += static_cast<double>(parse_program(text, "walk").joints.size()); },
         static_cast<double>(text.size())},
        {"perform",
         [&] {
             Performance performance(program);
             performance.for_each_frame([&](const FigureFrame& frame) {
                 sum += frame.bodies[0].shape.center.x;
                 return true;
             });
         },
         1.0 * kFrames},
        {"random",
         [&] {
             for (const int frame : asked) sum += played.frame(frame).bodies[0].shape.center.x;
         },
         1.0 * kAsked}};
    std::vector<Timed> timed;
    for (const Contender& c : contenders) timed.push_back({c.draw, 1});
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    const double restart = times[1].median * 0.5;
    for (std::size_t k = 0; k < std::size(contenders); ++k) {
        if (!settings.wants_scheme(contenders[k].scheme)) continue;
        Row row;
        row.op = "figure";
        row.case_name = "script";
        row.scheme = contenders[k].scheme;
        row.size = k == 0 ? static_cast<int>(text.size()) : kFrames;
        row.ns_per_px = times[k].median / contenders[k].items;
        row.best_ns_per_px = times[k].best / contenders[k].items;
        row.ratio_to_exact = k == 0 ? kNone : restart / row.ns_per_px;
        report.add(row);
    }
    if (!(sum > 0)) report.failures.push_back("figure, script: the walker does not get anywhere");
}

const RegisterOp registered({"figure", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_figure_perform
