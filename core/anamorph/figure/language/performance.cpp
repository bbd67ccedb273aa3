// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/language/performance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <type_traits>

#include "anamorph/error.h"
#include "anamorph/figure/language/actions.h"
#include "anamorph/figure/language/figure_state.h"
#include "anamorph/figure/language/script_parser.h"
#include "anamorph/figure/language/script_symbols.h"
#include "anamorph/figure/language/script_table.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {

using text_file::excerpt;

namespace {

constexpr int kMostUnknownFrames = 1000000;
constexpr std::size_t kDeepestCall = 200;
constexpr int kMostCalls = 10000;  // of subroutines in one frame

/// Frames of a movement, on the clock of its subroutine.
struct Span {
    double start = 0, stop = 0;
    bool holds(double frame) const { return start < frame && frame <= stop; }
};

/// The name of an entry of a table; its number where there is none.
template <class Table>
std::string entry_name(const Table& table, double at) {
    if (!(at >= 0 && at < static_cast<double>(table.size()))) return shortest(at);
    const auto& entry = table[static_cast<std::size_t>(at)];
    if constexpr (std::is_same_v<Table, std::vector<std::string>>)
        return excerpt(entry);
    else
        return excerpt(entry.name);
}

/// A value of a kind as scripts write it.
std::string written(const Program& program, OperandKind kind, double value) {
    switch (kind) {
        case OperandKind::ellipsoid:
            return entry_name(program.ellipsoids, value);
        case OperandKind::joint:
            return entry_name(program.joints, value);
        case OperandKind::figure:
            return entry_name(program.figures, value);
        case OperandKind::subroutine:
            return entry_name(program.subroutines, value);
        case OperandKind::image:
            return entry_name(program.images, value);
        case OperandKind::axis:
            return entry_name(std::vector<std::string>{"x", "y", "z"}, value);
        default:
            return shortest(value);
    }
}

/// An operand in a trace: as written, a variable with what it holds.
std::string told_of(const Program& program, const FigureState& state, const Operand& operand) {
    if (operand.kind == OperandKind::number) return shortest(operand.number);
    if (operand.kind != OperandKind::variable) return written(program, operand.kind, operand.index);
    const FigureState::Value& value = state.variables[static_cast<std::size_t>(operand.index)];
    return excerpt(program.variables[static_cast<std::size_t>(operand.index)]) + "=" +
           written(program, value.kind, value.number);
}

}  // namespace

struct Performance::Impl {
    Impl(Program p, PerformanceOptions o) : program(std::move(p)), options(std::move(o)) {
        speed = std::max(program.speed, 1);
        state = figures_at_rest(program);
        kept.emplace(0, state);
        kept_bytes = state.bytes();
        find_constant_spans();
    }

    // --- When things happen

    static double frame_number(double value) {
        return std::clamp(std::round(value), -1.0 * kLargestFrame, 1.0 * kLargestFrame);
    }

    Span span_between(double start, double stop) const {
        const double first = frame_number(start), last = frame_number(stop);
        return {first * speed, (last == first ? last + 1 : last) * speed};
    }

    void find_constant_spans() {
        spans.resize(program.subroutines.size());
        zeros.resize(program.subroutines.size());
        for (std::size_t s = 0; s < spans.size(); ++s)
            for (const Movement& m : program.subroutines[s].movements) {
                const bool constant_start = m.start.kind == OperandKind::number;
                if (constant_start) {
                    const double start = frame_number(m.start.number) * speed;
                    zeros[s] = std::min(zeros[s].value_or(start), start);
                }
                const bool constant = constant_start && m.stop.kind == OperandKind::number;
                spans[s].push_back(constant ? std::optional(span_between(m.start.number, m.stop.number))
                                            : std::nullopt);
            }
        if (std::any_of(spans[0].begin(), spans[0].end(), [](const auto& span) { return !span; })) return;
        end = static_cast<int>(last_pending(0));
    }

    /// What a subroutine was called with; the script itself has nothing.
    using Values = std::vector<Operand>;

    /// An operand, or what was handed over for it.
    static const Operand& handed_over(const Operand& operand, const Values& values) {
        return operand.kind == OperandKind::parameter ? values[static_cast<std::size_t>(operand.index)]
                                                      : operand;
    }

    /// An operand where `letter` is asked for. Throws Error where something else was handed over.
    const Operand& value_of(std::size_t s, const Movement& m, const Operand& operand, char letter,
                            const Values& values) const {
        const Operand& value = handed_over(operand, values);
        if (operand.kind == OperandKind::parameter && !fits(letter, value))
            throw Error(
                program.where(m.position) + ": " +
                wrong_value(program.subroutines[s], static_cast<std::size_t>(operand.index), letter, value));
        return value;
    }

    Span span_of(std::size_t s, std::size_t i, const Values& values) const {
        if (spans[s][i]) return *spans[s][i];
        const Movement& m = program.subroutines[s].movements[i];
        return span_between(
            FigureAction::number(program, state, value_of(s, m, m.start, 'n', values), m.position),
            FigureAction::number(program, state, value_of(s, m, m.stop, 'n', values), m.position));
    }

    /// A movement with what was handed over in the place of parameters.
    Movement with_values(std::size_t s, const Movement& m, const Values& values) const {
        Movement out = m;
        const std::string_view letters = script_table::operands_of(m.action);
        for (std::size_t k = 0; k < out.operands.size(); ++k)
            out.operands[k] = value_of(s, m, m.operands[k], k < letters.size() ? letters[k] : '*', values);
        return out;
    }

    /// The span of a movement, but nothing where variables are not ready for it.
    std::optional<Span> span_ahead(std::size_t s, std::size_t i, const Values& values) const {
        if (spans[s][i]) return spans[s][i];
        const Movement& m = program.subroutines[s].movements[i];
        for (const Operand* named : {&m.start, &m.stop}) {
            const Operand* operand = &handed_over(*named, values);
            if (operand->kind != OperandKind::variable || program.dialect == Dialect::classic) continue;
            const auto& value = state.variables[static_cast<std::size_t>(operand->index)];
            if (!value.set || value.kind != OperandKind::number) return std::nullopt;
        }
        return span_of(s, i, values);
    }

    /// The frame of a subroutine's clock that comes just before its first.
    double zero_of(int subroutine, const Values& values) const {
        const auto s = static_cast<std::size_t>(subroutine);
        if (zeros[s]) return *zeros[s];
        double zero = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < spans[s].size(); ++i)
            if (const auto span = span_ahead(s, i, values)) zero = std::min(zero, span->start);
        return std::isfinite(zero) ? zero : 0;
    }

    /// The last frame of the script's own movements after `frame`, or `frame` when there is none.
    double last_pending(double frame) const {
        const double zero = zero_of(0, {});
        double last = frame;
        for (std::size_t i = 0; i < spans[0].size(); ++i) {
            const auto span = span_ahead(0, i, {});
            if (span && span->start < span->stop) last = std::max(last, span->stop - zero);
        }
        return std::min(last, 1.0 * kLargestFrame);
    }

    // --- Performing

    /// Counts a call; throws Error where there are too many, or too many inside of each other.
    void check_calls(const Movement& m, int called) {
        const bool deep = calling.size() == kDeepestCall;
        if (++calls <= kMostCalls && !deep) return;
        const bool ring = std::find(calling.begin(), calling.end(), called) != calling.end();
        throw Error(program.where(m.position) + ": call in frame " + std::to_string(performing) + ": " +
                    (ring   ? "subroutines call each other without end"
                     : deep ? "more than " + std::to_string(kDeepestCall) + " subroutines call each the next"
                            : "a frame has more than " + std::to_string(kMostCalls) + " calls"));
    }

    void perform_subroutine(int subroutine, double clock, const Values& values) {
        const auto s = static_cast<std::size_t>(subroutine);
        for (std::size_t i = 0; i < spans[s].size(); ++i) {
            const Span span = span_of(s, i, values);
            if (!span.holds(clock)) continue;
            const Movement& written = program.subroutines[s].movements[i];
            std::optional<Movement> bound;
            if (!values.empty()) bound = with_values(s, written, values);
            const Movement& m = bound ? *bound : written;
            idle = false;
            if (program.trace) trace(subroutine, m, clock - span.start, span.stop - span.start);
            if (m.action == Action::call) {
                const int called =
                    FigureAction::index(program, state, m.operands[0], OperandKind::subroutine, m.position);
                check_calls(m, called);
                const Values handed(m.operands.begin() + 1, m.operands.end());
                const std::string fault =
                    wrong_count(program.subroutines[static_cast<std::size_t>(called)], handed.size());
                if (!fault.empty()) throw Error(program.where(m.position) + ": " + fault);
                // A call runs on from frame to frame; as an action, `call` is the first frame each time.
                const double since = m.distribution == Distribution::call ? clock - span.start : 1;
                calling.push_back(called);
                perform_subroutine(called, zero_of(called, handed) + since, handed);
                calling.pop_back();
                continue;
            }
            const Shares shares = shares_of(m.distribution, clock - span.start, span.stop - span.start);
            FigureAction(program, state, m, shares, performing, say).perform();
        }
    }

    /// Tells what is done, `step` of `steps`, with the values that operands have.
    void trace(int subroutine, const Movement& m, double step, double steps) const {
        if (performing <= told) return;
        std::string line = "frame " + std::to_string(performing) + ", " + program.where(m.position) + ": ";
        if (subroutine > 0)
            line += excerpt(program.subroutines[static_cast<std::size_t>(subroutine)].name) + ": ";
        line += std::string(name_of(m.distribution)) + " " + shortest(step) + "/" + shortest(steps);
        if (m.distribution != Distribution::call) line += std::string(" ") + name_of(m.action);
        for (const Operand& operand : m.operands) line += " " + told_of(program, state, operand);
        say(line);
    }

    /// Performs the frame after the one that `state` is at.
    void perform_next() {
        performing = now + 1;
        calls = 0;
        calling.clear();
        idle = true;
        perform_subroutine(0, zero_of(0, {}) + performing, {});
        check_overlaps(program, state, performing);
        now = performing;
        told = std::max(told, now);
    }

    /// While nothing happens, the frame before the next in which something does.
    int idle_until() const {
        double next = kLargestFrame;
        const double zero = zero_of(0, {});
        for (std::size_t i = 0; i < spans[0].size(); ++i) {
            const auto span = span_ahead(0, i, {});
            if (span && span->start < span->stop && span->stop - zero > now)
                next = std::min(next, span->start - zero);
        }
        return static_cast<int>(std::max(next, 1.0 * now));
    }

    // --- States kept

    void go_to(int number) {
        if (number < now) restore(number);
        const auto before = std::prev(kept.upper_bound(number));
        if (now < before->first) restore(number);
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

    /// Goes back to the last state kept at or before a frame.
    void restore(int number) {
        const auto far = std::prev(kept.upper_bound(number));
        auto near = recent.upper_bound(number);
        const bool has_near = near != recent.begin() && (--near)->first > far->first;
        now = has_near ? near->first : far->first;
        state = has_near ? near->second : far->second;
        // What is performed from here on is kept for a while: the next frame asked for may be the one before.
        if (!has_near) recent.clear();
    }

    void keep() {
        const auto last = std::prev(kept.upper_bound(now))->first;
        if (now - last >= interval) {
            kept_bytes += state.bytes();
            kept.emplace(now, state);
            while (kept_bytes > options.memory / 4 * 3 && kept.size() > 2) thin_out();
            recent.clear();
        } else if (now == last) {
            recent.clear();
        } else if (now < told) {
            const auto room = std::max<std::size_t>(options.memory / 4 / state.bytes(), 1);
            const auto stride = static_cast<long long>(static_cast<std::size_t>(interval) / room + 1);
            if (now % stride == 0) recent.emplace(now, state);
        }
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

    // --- Where it ends

    /// Whether the script has something to do in a frame or after it. Where numbers of frames are variables,
    /// that takes performing: it ends where none lies ahead.
    bool reaches(int number) {
        while (!end && reached < number) {
            go_to(reached);
            if (last_pending(now) > now) {
                if (reached == kMostUnknownFrames)
                    throw Error("the script does not end within " + std::to_string(kMostUnknownFrames) +
                                " frames");
                go_to(++reached);
            } else {
                end = now;
            }
        }
        return end ? number <= *end : true;
    }

    int last() {
        while (!end) reaches(reached + 1);
        return *end;
    }

    Program program;
    PerformanceOptions options;
    int speed = 1;
    std::vector<std::vector<std::optional<Span>>> spans;  ///< of each movement; nothing where it is variable
    std::vector<std::optional<double>> zeros;  ///< of each subroutine; nothing where it is variable
    std::optional<int> end;
    int reached = 0;  ///< the last frame known to be there, while `end` is not

    FigureState state;  ///< after frame `now`
    int now = 0, performing = 0, told = 0, calls = 0;
    std::vector<int> calling;  ///< the subroutines being performed, each called by the one before
    bool idle = false;
    std::map<int, FigureState> kept;  ///< frame 0 always
    std::size_t kept_bytes = 0;
    long long interval = 8;
    std::map<int, FigureState> recent;  ///< some between two that are kept
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
        last = static_cast<int>(
            std::clamp<long long>(static_cast<long long>((*view)[1]) * m_impl->speed, 0, last));
    return std::max(last, 0) / frame_step() * frame_step();
}

FigureFrame Performance::frame(int number) {
    if (number < 0 || !m_impl->reaches(number))
        throw Error("frame", std::to_string(number),
                    "must be an integer from 0 to " + std::to_string(m_impl->last()));
    m_impl->go_to(number);
    return frame_of(m_impl->state, m_impl->program, number);
}

void Performance::for_each_frame(const std::function<bool(const FigureFrame&)>& body) {
    const long long step = frame_step();
    const auto& view = m_impl->program.view;
    const long long stop = view ? static_cast<long long>((*view)[1]) * m_impl->speed : kLargestFrame;
    for (long long f = first_frame(); f <= stop && m_impl->reaches(static_cast<int>(f)); f += step)
        if (!body(frame(static_cast<int>(f)))) return;
}

const std::vector<std::string>& Performance::images() const {
    return m_impl->program.images;
}

const Program& Performance::program() const {
    return m_impl->program;
}

}  // namespace anamorph::figure
