// SPDX-License-Identifier: Apache-2.0
// The benchmark's frame: what the command line asks for, the table of results, the list of operations, and
// clocks.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace anamorph::bench {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Settings {
    std::string csv, op = "all", case_name, scheme;
    int size = 2048;  ///< side of the picture in pixels
    int threads = 1;
    int rounds = 15;
    bool bounds = false;     ///< report bounds over true errors instead of times
    bool calibrate = false;  ///< report the planner's costs instead
    /// Report how well 2 and 16 threads are used instead, by the processor's time of each part of a drawing.
    bool efficiency = false;

    bool wants_case(const std::string& name) const { return lists(case_name, name); }
    bool wants_scheme(const std::string& name) const { return lists(scheme, name); }

  private:
    /// Is a word one of several, a,b,c? All are where these are empty.
    static bool lists(const std::string& several, const std::string& one) {
        return several.empty() || ("," + several + ",").find("," + one + ",") != std::string::npos;
    }
};

/// Distances from the exact source points, in source pixels.
struct Accuracy {
    double mean = kNone, p99 = kNone, max = kNone;
};

/// How threads share a drawing. `speed_on_two` and `speed_on_sixteen` are over one thread, on cores that are free.
struct Sharing {
    double speed_on_two = kNone, speed_on_sixteen = kNone;
    double processor_ns = kNone;  ///< of all threads
    double waits = kNone;         ///< how often threads waited for one another
};

/// One line of the table. Where a number makes no sense for a scheme, it is NaN.
struct Row {
    std::string op, case_name, scheme;
    double tol_px = kNone;
    int size = 0, threads = 1;
    double ns_per_px = 0;       ///< median over the rounds (Times)
    double best_ns_per_px = 0;  ///< least over the rounds (not in the CSV)
    double ratio_to_exact = 0;  ///< how many times faster than the plain double loop of the same case
    Accuracy error;
    double bound_px = kNone, exact_fraction = kNone;
    double cycles = kNone, frames_per_second = kNone;  ///< those of a machine that is modelled
    bool one_tap = true;  ///< does each pixel come from one point, not from an average? (not in the CSV)
    Sharing sharing{};    ///< where efficiency is asked for (not in the CSV)
};

/// A promise about the table: `reached` is to be at least (or at most) `wanted`.
struct Target {
    std::string what;
    double wanted, reached, reached_by_best;
    bool at_most = false;
};

struct Report {
    std::vector<Row> rows;
    std::vector<Target> targets;
    std::vector<std::string> failures;  ///< failures of the checks that the benchmark makes of itself
    bool is_quiet = false;              ///< are rows kept and not printed?

    /// Keeps a row and prints it.
    void add(const Row& row);
    /// The row of a case and scheme (with this tolerance, unless NaN, on so many threads, unless 0), or null.
    const Row* find(const std::string& case_name, const std::string& scheme, double tol_px = kNone,
                    int threads = 0) const;
    /// Adds the target that `fast` takes at most 1 / `wanted` of the time of `slow`, if both were measured.
    void add_speed_target(const std::string& what, double wanted, const Row* slow, const Row* fast);
    void add_limit(const std::string& what, double at_most, double reached);
};

/// One operation of the product. `run` adds rows and targets; `report_bounds` prints.
struct Op {
    std::string name;
    std::function<void(const Settings&, Report&)> run;
    std::function<void(const Settings&)> report_bounds;
};

/// Every file of an operation registers it: `const RegisterOp registered({...});` at namespace scope.
struct RegisterOp {
    explicit RegisterOp(Op op);
};

/// A way to draw that is to be timed.
struct Timed {
    std::function<void()> draw;
    int threads = 1;
};
/// Times of one run in ns: of the processor where one thread draws, so that programs that run beside count
/// less; of the clock on the wall where several do.
struct Times {
    double median = 0, best = 0;
    Sharing sharing{};
};
/// Are drawings looked at for how threads share them (Settings::efficiency)? All that follow.
void look_at_sharing(int threads);
/// Runs all contenders in turn, in another order every round, so that whatever else the machine does hits all
/// alike. Quick ones run twice in a row and the better of the two counts; slow ones sit out two rounds of
/// three.
std::vector<Times> time_interleaved(const std::vector<Timed>& contenders, int rounds);

/// Prints what the planner's costs are on this machine.
void print_costs(const Settings& settings);

/// Mean, 99th percentile and largest of `errors`, which it reorders.
Accuracy accuracy_of(std::vector<float>& errors);

}  // namespace anamorph::bench
