// SPDX-License-Identifier: Apache-2.0
// speed_vs_error --csv FILE [--op NAME] [--size N] [--threads N] [--case NAME] [--scheme NAME] [--rounds N]
// speed_vs_error --bounds [...]
// speed_vs_error --calibrate [...]: what the planner's costs are here (costs.cpp).
// speed_vs_error --efficiency [...]: how well 2 and 16 threads are used, on a machine that may do other things meanwhile.
// --instructions NAME: one of Highway's instruction sets (AVX3, AVX2, SSE2 ...), in place of the machine's best.
//
// Measures how fast each scheme draws and how far it is from the exact map, next to what else one could use,
// all in one run. The CSV has a line per case, scheme and tolerance; a summary goes to standard output.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <numeric>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "anamorph/image/block_sampler.h"
#include "bench.h"
#include "output_file.h"
#include "pixels.h"

namespace anamorph::bench {
namespace {

std::vector<Op>& ops() {
    static std::vector<Op> list;
    return list;
}

double now_ns(int threads) {
    timespec t{};
    clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &t);
    return static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
}

int whole_number(std::string_view option, const char* text, int least, int most) {
    char* end = nullptr;
    const long value = std::strtol(text, &end, 10);
    if (end == text || *end || value < least || value > most)
        throw std::invalid_argument(std::string(option) + " " + text + ": must be " + std::to_string(least) +
                                    " to " + std::to_string(most));
    return static_cast<int>(value);
}

void use_instructions(const std::string& name) {
    if (simd::use_instruction_set(name.c_str())) return;
    std::string names;
    for (const char* const* set = simd::instruction_sets(); *set; ++set)
        names += (names.empty() ? "" : ", ") + std::string(*set);
    throw std::invalid_argument("--instructions " + name + ": must be one of " + names);
}

Settings parse(int argc, char** argv) {
    Settings s;
    for (int i = 1; i < argc; ++i) {
        const std::string_view option = argv[i];
        if (option == "--bounds" || option == "--calibrate" || option == "--efficiency") {
            (option == "--bounds" ? s.bounds : option == "--calibrate" ? s.calibrate : s.efficiency) = true;
            continue;
        }
        if (i + 1 == argc) throw std::invalid_argument(std::string(option) + ": needs a value");
        const char* value = argv[++i];
        if (option == "--csv")
            s.csv = value;
        else if (option == "--op")
            s.op = value;
        else if (option == "--case")
            s.case_name = value;
        else if (option == "--scheme")
            s.scheme = value;
        else if (option == "--instructions")
            use_instructions(value);
        else if (option == "--size")
            s.size = whole_number(option, value, 16, 8192);
        else if (option == "--threads")
            s.threads = whole_number(option, value, 1, 1024);
        else if (option == "--rounds")
            s.rounds = whole_number(option, value, 1, 1000);
        else
            throw std::invalid_argument(
                std::string(option) +
                ": must be one of --csv, --op, --size, --threads, --case, --scheme, --rounds, "
                "--bounds, --calibrate and --efficiency");
    }
    if (s.csv.empty() && !s.bounds && !s.calibrate && !s.efficiency)
        throw std::invalid_argument("--csv: a file to write is needed");
    const auto known = [&](const Op& op) { return op.name == s.op; };
    if (s.op != "all" && std::none_of(ops().begin(), ops().end(), known)) {
        std::string names = "all";
        for (const Op& op : ops()) names += ", " + op.name;
        throw std::invalid_argument("--op " + s.op + ": must be one of " + names);
    }
    return s;
}

void write_csv(std::ostream& out, const Report& report) {
    out << "op,case,scheme,tol_px,size,threads,ns_per_px,ratio_to_exact,mean_error_px,p99_error_px,max_error_"
           "px,"
           "bound_px,exact_fraction,cycles,frames_per_second\n";
    for (const Row& r : report.rows)
        out << r.op << ',' << r.case_name << ',' << r.scheme << ',' << r.tol_px << ',' << r.size << ','
            << r.threads << ',' << r.ns_per_px << ',' << r.ratio_to_exact << ',' << r.error.mean << ','
            << r.error.p99 << ',' << r.error.max << ',' << r.bound_px << ',' << r.exact_fraction << ','
            << r.cycles << ',' << r.frames_per_second << '\n';
}

void print_head() {
    std::printf("%-20s %-16s %9s %3s %9s %9s %8s %9s %9s %9s %9s %6s\n", "case", "scheme", "tol px", "thr",
                "ns/px", "best", "x double", "mean err", "p99 err", "max err", "bound", "exact");
}

void print_row(const Row& r) {
    std::printf("%-20s %-16s %9.4g %3d %9.3f %9.3f %8.2f %9.2g %9.2g %9.2g %9.2g %6.3f\n",
                r.case_name.c_str(), r.scheme.c_str(), r.tol_px, r.threads, r.ns_per_px, r.best_ns_per_px,
                r.ratio_to_exact, r.error.mean, r.error.p99, r.error.max, r.bound_px, r.exact_fraction);
    std::fflush(stdout);
}

void print_targets(const Report& report) {
    if (report.targets.empty()) return;
    std::printf("\n%-78s %8s %9s %9s\n", "target", "wanted", "reached", "best");
    for (const Target& t : report.targets) {
        const bool pass = t.at_most ? t.reached <= t.wanted : t.reached >= t.wanted;
        std::printf("%-78s %2s %5.4g %9.4g %9.4g  %s\n", t.what.c_str(), t.at_most ? "<=" : ">=", t.wanted,
                    t.reached, t.reached_by_best, pass ? "pass" : "MISS");
    }
}

/// Does a row measure what else one could use? A copy of memory is a limit, and no way to draw.
bool is_peer(const Row& row) {
    constexpr std::string_view kPeers[] = {"double",       "simd_exact",   "opencv",      "opencv_remap",
                                           "opencv_fixed", "oiio_st_warp", "vtk_reslice", "xmorph"};
    return std::find(std::begin(kPeers), std::end(kPeers), row.scheme) != std::end(kPeers);
}

/// The tolerance at which cells are compared, source pixels.
constexpr double kUsualTol = 0.01;

/// The fastest peer of a row in the same cell, which filters alike; null if there is none.
const Row* best_peer(const Report& report, const Row& ours) {
    const Row* best = nullptr;
    for (const Row& r : report.rows)
        if (is_peer(r) && r.op == ours.op && r.case_name == ours.case_name && r.size == ours.size &&
            r.threads == ours.threads && r.one_tap == ours.one_tap &&
            (!best || r.ns_per_px < best->ns_per_px))
            best = &r;
    return best;
}

/// The cells in which the best peer comes nearest, or is ahead, those first; and how far off that peer is.
void print_weakest(const Report& report) {
    struct Cell {
        const Row *ours, *peer;
        double ratio() const { return peer->ns_per_px / ours->ns_per_px; }
    };
    std::vector<Cell> cells;
    for (const Row& ours : report.rows) {
        if (!(ours.scheme == "automatic" || ours.scheme == "auto") || ours.tol_px != kUsualTol) continue;
        if (const Row* best = best_peer(report, ours)) cells.push_back({&ours, best});
    }
    if (cells.empty()) return;
    std::sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.ratio() < b.ratio(); });
    std::printf("\nleast ratios to the best peer, at tol %g:\n", kUsualTol);
    constexpr std::size_t kShown = 8;
    for (std::size_t i = 0; i < std::min(kShown, cells.size()); ++i) {
        const Row &ours = *cells[i].ours, &peer = *cells[i].peer;
        std::printf("  %.2f (%s %s, %d x %d, against %s", cells[i].ratio(), ours.op.c_str(),
                    ours.case_name.c_str(), ours.size, ours.size, peer.scheme.c_str());
        if (peer.error.max > kUsualTol) std::printf(", which is off by up to %.2g", peer.error.max);
        std::printf(")\n");
    }
}

/// What users get who set nothing (scheme `defaults`), beside the same picture read at one point a pixel.
void print_defaults(const Report& report) {
    bool first = true;
    for (const Row& ours : report.rows) {
        if (ours.scheme != "defaults") continue;
        const Row* bare = report.find(ours.case_name, "automatic", ours.tol_px, ours.threads);
        if (!bare) bare = report.find(ours.case_name, "auto", ours.tol_px, ours.threads);
        if (!bare) continue;
        if (first) std::printf("\nwith the defaults, beside bilinear at the same tolerance:\n");
        first = false;
        std::printf("  %-20s %9.3f ns/px, %.2f times %.3f\n", ours.case_name.c_str(), ours.ns_per_px,
                    ours.ns_per_px / bare->ns_per_px, bare->ns_per_px);
    }
}

/// The number of threads by whose sharing drawings are looked at, or 0.
int s_sharing = 0;

/// Draws on 1, 2 and 16 threads, and prints how these share the work.
int print_efficiency(const Settings& given) {
    constexpr int kThreads[] = {1, 2, 16};
    Report reports[std::size(kThreads)];
    for (std::size_t k = 0; k < std::size(kThreads); ++k) {
        look_at_sharing(kThreads[k]);
        Settings settings = given;
        settings.threads = kThreads[k];
        reports[k].is_quiet = true;
        for (const Op& op : ops())
            if (settings.op == "all" || settings.op == op.name) op.run(settings, reports[k]);
    }
    std::printf(
        "\nspeed on free cores by the parts' own times, and processor time over that of one thread:\n");
    std::printf("%-20s %-16s %9s %8s %9s %8s %8s %10s %9s %9s\n", "case", "scheme", "tol px", "ms",
                "2: speed", "time", "waits", "16: speed", "time", "waits");
    for (const Row& row : reports[0].rows) {
        const Sharing& one = row.sharing;
        if (std::isnan(one.speed_on_two)) continue;
        const Row* on[2] = {reports[1].find(row.case_name, row.scheme, row.tol_px, 2),
                            reports[2].find(row.case_name, row.scheme, row.tol_px, 16)};
        const auto time = [&](const Row* r) {
            return r ? r->sharing.processor_ns / one.processor_ns : kNone;
        };
        const auto waits = [](const Row* r) { return r ? r->sharing.waits : kNone; };
        std::printf("%-20s %-16s %9.4g %8.2f %9.2f %8.2f %8.0f %10.1f %9.2f %9.0f\n", row.case_name.c_str(),
                    row.scheme.c_str(), row.tol_px, one.processor_ns * 1e-6, one.speed_on_two, time(on[0]),
                    waits(on[0]), one.speed_on_sixteen, time(on[1]), waits(on[1]));
    }
    return 0;
}

int run(int argc, char** argv) {
    const Settings settings = parse(argc, argv);
    if (settings.efficiency) return print_efficiency(settings);
    if (settings.calibrate) {
        print_costs(settings);
        return 0;
    }
    std::optional<anamorph::command::OutputFile> csv;
    if (!settings.bounds) {
        csv.emplace(settings.csv);  // before the work, which is long
        print_head();
    }
    Report report;
    for (const Op& op : ops()) {
        if (settings.op != "all" && settings.op != op.name) continue;
        if (!settings.bounds)
            op.run(settings, report);
        else if (op.report_bounds)
            op.report_bounds(settings);
    }
    if (settings.bounds) return 0;
    if (report.rows.empty())
        throw std::invalid_argument("--case " + settings.case_name + " --scheme " + settings.scheme +
                                    ": no such row");
    std::ostringstream table;
    write_csv(table, report);
    csv->write(table.str());
    csv->close();
    print_targets(report);
    print_weakest(report);
    print_defaults(report);
    for (const std::string& failure : report.failures)
        std::fprintf(stderr, "speed_vs_error: %s\n", failure.c_str());
    return report.failures.empty() ? 0 : 1;
}

}  // namespace

RegisterOp::RegisterOp(Op op) {
    ops().push_back(std::move(op));
}

void Report::add(const Row& row) {
    rows.push_back(row);
    if (!is_quiet) print_row(row);
}

const Row* Report::find(const std::string& case_name, const std::string& scheme, double tol_px,
                        int threads) const {
    for (const Row& r : rows)
        if (r.case_name == case_name && r.scheme == scheme && (std::isnan(tol_px) || r.tol_px == tol_px) &&
            (threads == 0 || r.threads == threads))
            return &r;
    return nullptr;
}

void Report::add_speed_target(const std::string& what, double wanted, const Row* slow, const Row* fast) {
    if (slow && fast)
        targets.push_back(
            {what, wanted, slow->ns_per_px / fast->ns_per_px, slow->best_ns_per_px / fast->best_ns_per_px});
}

void Report::add_limit(const std::string& what, double at_most, double reached) {
    targets.push_back({what, at_most, reached, reached, true});
}

void look_at_sharing(int threads) {
    s_sharing = threads;
}

/// The sharing of a drawing, of the run that took least.
Sharing sharing_of(const Timed& drawing) {
    constexpr int kRuns = 4;
    Sharing found;
    for (int run = 0; run < kRuns; ++run) {
        const Shares shares(drawing.draw);
        if (!shares.has_loops()) return {};
        if (shares.all_ns() >= found.processor_ns) continue;
        found = {shares.speed_on(2), shares.speed_on(16), shares.all_ns(), shares.waits(s_sharing)};
    }
    return found;
}

std::vector<Times> time_interleaved(const std::vector<Timed>& contenders, int rounds) {
    if (s_sharing > 0) {
        std::vector<Times> shared;
        for (const Timed& drawing : contenders) shared.push_back({kNone, kNone, sharing_of(drawing)});
        return shared;
    }
    constexpr double kQuick = 40e6;
    constexpr int kSlowEvery = 3;
    std::vector<std::vector<double>> times(contenders.size());
    std::vector<std::size_t> order(contenders.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::mt19937 random(1);
    const auto once = [&](std::size_t i) {
        const double start = now_ns(contenders[i].threads);
        contenders[i].draw();
        return now_ns(contenders[i].threads) - start;
    };
    std::vector<bool> quick;
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        contenders[i].draw();
        quick.push_back(once(i) < kQuick);
    }
    for (int round = 0; round < rounds; ++round) {
        std::shuffle(order.begin(), order.end(), random);
        for (const std::size_t i : order) {
            if (quick[i])
                times[i].push_back(std::min(once(i), once(i)));
            else if (round % kSlowEvery == 0)
                times[i].push_back(once(i));
        }
    }
    std::vector<Times> result;
    for (std::vector<double>& t : times) {
        std::sort(t.begin(), t.end());
        result.push_back({t[t.size() / 2], t.front(), {}});
    }
    return result;
}

Accuracy accuracy_of(std::vector<float>& errors) {
    if (errors.empty()) return {};
    double sum = 0;
    for (const float e : errors) sum += e;
    const auto p99 = errors.begin() + static_cast<std::ptrdiff_t>((errors.size() - 1) * 99 / 100);
    std::nth_element(errors.begin(), p99, errors.end());
    return {sum / static_cast<double>(errors.size()), *p99, *std::max_element(p99, errors.end())};
}

}  // namespace anamorph::bench

int main(int argc, char** argv) {
    try {
        return anamorph::bench::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "speed_vs_error: %s\n", error.what());
        return 1;
    }
}
