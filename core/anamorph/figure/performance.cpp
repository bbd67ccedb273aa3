// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/performance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "anamorph/error.h"
#include "anamorph/figure/actions.h"
#include "anamorph/figure/figure_state.h"

namespace anamorph {
namespace {

constexpr int kLargestFrame = 1000000000;
constexpr int kDeepestCall = 200;
constexpr int kMostCalls = 10000;  // of subroutines in one frame

/// Frames of a movement, on the clock of its subroutine.
struct Span {
    double start = 0, stop = 0;
    bool holds(double frame) const { return start < frame && frame <= stop; }
};

}  // namespace

struct Performance::Impl {
    Impl(Program p, PerformanceOptions o) : program(std::move(p)), options(std::move(o)) {
        speed = std::max(program.speed, 1);
        for (std::size_t s = 0; s < program.subroutines.size(); ++s)
            constant_zeros.push_back(constant_zero(s));
        state = figures_at_rest(program);
        kept.emplace(0, state);
        kept_bytes = state.bytes();
        find_constant_end();
    }

    // --- When things happen

    double frame_number(const Operand& operand, const ScriptPosition& position) const {
        const double value = std::round(FigureAction::number(program, state, operand, position));
        return std::clamp(value, -1.0 * kLargestFrame, 1.0 * kLargestFrame);
    }

    Span span_of(const Movement& m) const {
        Span span{frame_number(m.start, m.position), frame_number(m.stop, m.position)};
        if (span.start == span.stop) span.stop += 1;
        return {span.start * speed, span.stop * speed};
    }

    std::optional<double> constant_zero(std::size_t subroutine) const {
        std::optional<double> zero;
        for (const Movement& m : program.subroutines[subroutine].movements)
            if (m.start.kind == OperandKind::number) {
                const double start = frame_number(m.start, m.position) * speed;
                zero = std::min(zero.value_or(start), start);
            }
        return zero;
    }

    /// The frame of a subroutine's clock that comes just before its first.
    double zero_of(int subroutine) const {
        const auto s = static_cast<std::size_t>(subroutine);
        if (constant_zeros[s]) return *constant_zeros[s];
        double zero = std::numeric_limits<double>::infinity();
        for (const Movement& m : program.subroutines[s].movements) zero = std::min(zero, span_of(m).start);
        return std::isfinite(zero) ? zero : 0;
    }

    /// Sets `end` where the script's own frame numbers are all numbers.
    void find_constant_end() {
        double last = 0;
        for (const Movement& m : program.subroutines[0].movements) {
            if (m.start.kind != OperandKind::number || m.stop.kind != OperandKind::number) return;
            const Span span = span_of(m);
            if (span.start < span.stop) last = std::max(last, span.stop - zero_of(0));
        }
        end = static_cast<int>(std::min(last, 1.0 * kLargestFrame));
    }

    // --- Performing

    void perform_subroutine(int subroutine, double clock, int depth) {
        if (depth > kDeepestCall || ++calls > kMostCalls)
            throw Error("frame " + std::to_string(performing) +
                        ": subroutines call each other without end, by way of " +
                        program.subroutines[static_cast<std::size_t>(subroutine)].name);
        for (const Movement& m : program.subroutines[static_cast<std::size_t>(subroutine)].movements) {
            const Span span = span_of(m);
            if (!span.holds(clock)) continue;
            idle = false;
            if (m.action == Action::call) {
                const int called =
                    FigureAction::index(program, state, m.operands[0], OperandKind::subroutine, m.position);
                // A call runs on from frame to frame; as an action, `call` is the first frame each time.
                const double since = m.distribution == Distribution::call ? clock - span.start : 1;
                perform_subroutine(called, zero_of(called) + since, depth + 1);
                continue;
            }
            const Shares shares = shares_of(m.distribution, clock - span.start, span.stop - span.start);
            FigureAction(program, state, m, shares, performing, say).perform();
        }
    }

    void check_state() const {
        for (std::size_t i = 1; i < state.bodies.size(); ++i) {
            const auto& b = state.bodies[i];
            for (int k = 0; k < 3; ++k)
                if (!std::isfinite(b.center[k]) || !std::isfinite(b.axes[k]) || !std::isfinite(b.color[k]) ||
                    !std::isfinite(b.turn[k]))
                    throw Error("frame " + std::to_string(performing) + ": the ellipsoid " +
                                program.ellipsoids[i].name + " is out of all bounds");
        }
    }

    /// Performs the frame after the one that `state` is at.
    void perform_next() {
        performing = now + 1;
        calls = 0;
        idle = true;
        perform_subroutine(0, zero_of(0) + performing, 0);
        check_state();
        check_overlaps(program, state, performing);
        now = performing;
        told = std::max(told, now);
    }

    /// While nothing happens, the frame before the next in which something does.
    int idle_until() const {
        double next = kLargestFrame;
        const double zero = zero_of(0);
        for (const Movement& m : program.subroutines[0].movements) {
            const Span span = span_of(m);
            if (span.start < span.stop && span.stop - zero > now) next = std::min(next, span.start - zero);
        }
        return static_cast<int>(std::max(next, 1.0 * now));
    }

    void go_to(int number) {
        // The state at hand, or the last that was kept before.
        const auto after = kept.upper_bound(number);
        const auto before = std::prev(after);
        if (now > number || now < before->first) {
            state = before->second;
            now = before->first;
        }
        try {
            while (now < number) {
                perform_next();
                if (idle) now = std::max(now, std::min(number, idle_until()));
                keep();
            }
        } catch (...) {
            state = kept.begin()->second;
            now = 0;
            throw;
        }
    }

    void keep() {
        if (now - std::prev(kept.upper_bound(now))->first < interval) return;
        kept_bytes += state.bytes();
        kept.emplace(now, state);
        while (kept_bytes > options.memory && kept.size() > 2) thin_out();
    }

    /// Doubles the interval between the states that are kept.
    void thin_out() {
        interval *= 2;
        int last = 0;
        for (auto it = std::next(kept.begin()); it != kept.end();) {
            if (it->first - last < interval) {
                kept_bytes -= it->second.bytes();
                it = kept.erase(it);
            } else {
                last = it++->first;
            }
        }
    }

    /// The last frame in which the script has something to do.
    int last() {
        while (!end) {
            // Numbers of frames are variables: the script ends where none lies ahead.
            go_to(now);
            bool pending = false;
            const double zero = zero_of(0);
            for (const Movement& m : program.subroutines[0].movements) {
                const Span span = span_of(m);
                pending = pending || (span.start < span.stop && span.stop - zero > now);
            }
            if (!pending || now >= kLargestFrame)
                end = now;
            else
                go_to(now + 1);
        }
        return *end;
    }

    Program program;
    PerformanceOptions options;
    int speed = 1;
    std::vector<std::optional<double>> constant_zeros;
    std::optional<int> end;

    FigureState state;  ///< after frame `now`
    int now = 0, performing = 0, told = 0, calls = 0;
    bool idle = false;
    std::map<int, FigureState> kept;  ///< frame 0 always
    std::size_t kept_bytes = 0;
    int interval = 8;
    /// Passes messages on the first time that a frame is performed.
    std::function<void(const std::string&)> say = [this](const std::string& line) {
        if (options.message && performing > told) options.message(line);
    };
};

Performance::Performance(Program program, PerformanceOptions options)
    : m_impl(std::make_unique<Impl>(std::move(program), std::move(options))) {}
Performance::~Performance() = default;
Performance::Performance(Performance&&) noexcept = default;
Performance& Performance::operator=(Performance&&) noexcept = default;

int Performance::frame_step() const {
    return std::max(-m_impl->program.speed, 1);
}

int Performance::first_frame() const {
    const auto& view = m_impl->program.view;
    const long long from = view ? std::max(static_cast<long long>((*view)[0]) * m_impl->speed, 0LL) : 0LL;
    const long long step = frame_step();
    return static_cast<int>(std::min((from / step + 1) * step, 2LL * kLargestFrame));
}

int Performance::last_frame() {
    int last = m_impl->last();
    const auto& view = m_impl->program.view;
    if (view)
        last =
            static_cast<int>(std::min<long long>(last, static_cast<long long>((*view)[1]) * m_impl->speed));
    return std::max(last, 0) / frame_step() * frame_step();
}

int Performance::frame_count() {
    const long long first = first_frame(), last = last_frame();
    return last < first ? 0 : static_cast<int>((last - first) / frame_step() + 1);
}

FigureFrame Performance::frame(int number) {
    if (number < 0 || number > m_impl->last())
        throw Error("frame", std::to_string(number), "allowed are 0 to " + std::to_string(m_impl->last()));
    m_impl->go_to(number);
    return frame_of(m_impl->state, m_impl->program, number);
}

void Performance::for_each_frame(const std::function<bool(const FigureFrame&)>& body) {
    const int last = last_frame(), step = frame_step();
    for (long long f = first_frame(); f <= last; f += step)
        if (!body(frame(static_cast<int>(f)))) return;
}

const Program& Performance::program() const {
    return m_impl->program;
}

}  // namespace anamorph
