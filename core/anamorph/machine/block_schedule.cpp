// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/block_schedule.h"

#include <algorithm>
#include <cmath>

#include "anamorph/number/portable.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::machine {
namespace {

/// Products for a block beside the surface's: affine transformation 9, projection 2, differences 4 (2.4 to 2.7), inverse 6
/// (2.11). And divisions: by the depth, by the determinant. With depths: 2 differences more, and 4 for what a pixel gains.
constexpr int kMultiplies = 9 + 2 + 4 + 6, kDivisions = 2, kDepthMultiplies = 2 + 4;

/// Cycles of the processors: products and divisions of all blocks, which they share, and the sort, which one list goes through:
/// each block, and each bucket.
double processor_cycles(const BlockMachine& machine, double blocks, const SurfaceCost& cost) {
    const auto products_of = [&](const OperationCounts& counts) {
        return counts.products + double(machine.function_multiplies) * counts.functions;
    };
    const double of_surface =
        machine.surface_multiplies ? *machine.surface_multiplies : products_of(cost.point);
    const int divisions =
        kDivisions + (machine.surface_multiplies ? 0 : cost.point.divisions) + cost.light.divisions;
    const bool in_depth = machine.hidden == Hiding::z_buffer;
    const double products =
        std::ceil((of_surface + products_of(cost.light) + kMultiplies + (in_depth ? kDepthMultiplies : 0)) /
                  machine.multipliers);
    const double of_blocks =
        std::ceil(blocks / machine.processors) * (products + double(divisions) * machine.division_cycles);
    return of_blocks + (in_depth ? 0 : blocks * machine.sort_cycles + machine.buckets);
}

/// Cycles of the address controller: a step from segment to segment; or a step, or four products, for each pixel of them.
double controller_cycles(const BlockMachine& machine, const BlockCounts& counts) {
    const double for_pixels = machine.addresses == Addressing::segments   ? 0
                              : machine.addresses == Addressing::repeated ? double(counts.addressed)
                                                                          : 4.0 * double(counts.addressed);
    return double(counts.blocks) * machine.block_cycles + double(counts.segments) * machine.segment_cycles +
           for_pixels;
}

std::vector<MachineStage> stages_of(const BlockMachine& machine, const BlockCounts& counts,
                                    const SurfaceCost& cost, const Size& picture, const Size& screen) {
    const double blocks = double(counts.blocks), pixels = double(counts.pixels);
    const double pixel_bytes =
        machine.texel_bits > 0 ? 3 * std::ceil(machine.texel_bits / 8.0) : kBytesOfPixel;
    const double scanned = double(screen.width) * screen.height, image = scanned * pixel_bytes;
    const double texels = double(picture.width) * picture.height;
    const double told = (kNumbersOfFrame + cost.numbers) * kBytesOfNumber * machine.processors;
    // A depth is read and, where it is the least so far, written.
    const double depth = machine.hidden == Hiding::z_buffer ? std::ceil(machine.depth_bits / 8.0) : 0;
    std::vector<MachineStage> stages(MachineSchedule::kStages);
    stages[MachineSchedule::host] = {"host computer", double(machine.host_cycles), 0, told, "programs",
                                     2 * told};
    stages[MachineSchedule::processors] = {"micro-coded processors",
                                           processor_cycles(machine, blocks, cost),
                                           told,
                                           blocks * kBytesOfBlock,
                                           "block data memory",
                                           2 * blocks * kBytesOfBlock};
    stages[MachineSchedule::controller] = {
        "address controller", controller_cycles(machine, counts), blocks * kBytesOfBlock, 0, "", 0};
    // Four texels are read, a pixel is written.
    stages[MachineSchedule::pixels] = {"pixel processor",
                                       double(counts.pixel_cycles),
                                       pixels * (4 * pixel_bytes + depth),
                                       pixels * (pixel_bytes + depth),
                                       "output image memory",
                                       2 * image};
    stages[MachineSchedule::output] = {"output", scanned, image, 0, "", 0};
    stages[MachineSchedule::input] = {"input",
                                      texels,
                                      texels * kBytesOfPixel,
                                      texels * pixel_bytes,
                                      "input image memory",
                                      2 * texels * pixel_bytes};
    return stages;
}

/// The cycles of the two stages that draw, each frame.
double drawing_cycles(const std::vector<MachineStage>& stages) {
    return std::max(stages[MachineSchedule::controller].cycles, stages[MachineSchedule::pixels].cycles);
}

/// Cycles from one shown frame to the next. Without a clock the slowest stage sets them. With one, a frame is drawn while the one
/// before is shown, and is shown from the next tick on: drawing and output take whole ticks. What lies before them needs none:
/// if it is slower, some frames come a tick later than others.
double period_of(const std::vector<MachineStage>& stages, double tick) {
    using S = MachineSchedule;
    double shown = std::max(drawing_cycles(stages), stages[S::output].cycles);
    if (tick > 0) shown = std::ceil(shown / tick) * tick;
    return std::max({shown, stages[S::host].cycles, stages[S::processors].cycles, stages[S::input].cycles});
}

/// What stages wait once the buffers have filled: those before the slowest one for room behind them, those after it for what
/// it makes. Of the two that draw, the faster one waits for the other, too: the queue between them is full, or empty.
void set_waits(std::vector<MachineStage>& stages, double period) {
    using S = MachineSchedule;
    const double drawing = drawing_cycles(stages);
    const bool host_binds = stages[S::host].cycles == period,
               maps_bind =
                   host_binds || stages[S::processors].cycles == period || stages[S::input].cycles == period;
    for (const S::Place place : {S::host, S::input}) stages[place].blocked = period - stages[place].cycles;
    const auto wait = [&](S::Place place, bool for_input, double busy) {
        (for_input ? stages[place].starved : stages[place].blocked) = period - busy;
    };
    wait(S::processors, host_binds, stages[S::processors].cycles);
    wait(S::controller, maps_bind, drawing);
    wait(S::pixels, maps_bind, drawing);
    wait(S::output, true, stages[S::output].cycles);
    stages[S::controller].blocked += drawing - stages[S::controller].cycles;
    stages[S::pixels].starved += drawing - stages[S::pixels].cycles;
}

/// Follows frames through the stages.
class FrameRun {
  public:
    explicit FrameRun(MachineSchedule& schedule) : m_schedule(schedule) {
        for (std::size_t f = 0; f < S::kFrames; ++f) add_frame(f);
    }

  private:
    using S = MachineSchedule;

    const MachineVisit& at(std::size_t frame, S::Place stage) const {
        return m_schedule.frames[frame][stage];
    }
    /// When a stage is done with a frame; at the start it is with those before the first.
    double done(S::Place stage, std::size_t frame, std::size_t before = 0) const {
        return frame < before ? 0 : at(frame - before, stage).end;
    }

    /// A stage begins when it is done with the frame before, what it reads is there, and the half of the buffer that it
    /// fills is free again, which has held the frame before the last.
    void add_frame(std::size_t f) {
        m_schedule.frames.emplace_back(std::size_t{S::kStages});
        visit(S::host, f, 0, done(S::processors, f, 2));
        visit(S::processors, f, done(S::host, f), done(S::pixels, f, 2));
        visit(S::input, f, 0, done(S::pixels, f, 2));
        for (const S::Place drawing : {S::controller, S::pixels}) {
            visit(drawing, f, std::max(done(S::processors, f), done(S::input, f)), free_output(f));
            m_schedule.frames[f][drawing].end = at(f, drawing).begin + drawing_cycles(m_schedule.stages);
        }
        visit(S::output, f, done(S::pixels, f), 0);
        if (m_schedule.tick > 0) show_at_tick(m_schedule.frames[f][S::output]);
    }
    void visit(S::Place place, std::size_t f, double input, double room) {
        const double ready = done(place, f, 1), fed = std::max(ready, input), begin = std::max(fed, room);
        m_schedule.frames[f][place] = {ready, fed, begin, begin + m_schedule.stages[place].cycles};
    }
    /// When the half of the output image memory is free that a frame is drawn to: the frame before the last, which it holds, is shown
    /// until the last one is where there is a clock, and else once.
    double free_output(std::size_t f) const {
        if (m_schedule.tick == 0) return done(S::output, f, 2);
        return f < 2 ? 0 : at(f - 1, S::output).begin;
    }
    /// A frame is shown from a tick on, for as many ticks as it takes to put it out.
    void show_at_tick(MachineVisit& visit) const {
        const double tick = m_schedule.tick;
        visit.begin = std::ceil(visit.fed / tick) * tick;
        visit.end = visit.begin + std::ceil(m_schedule.stages[S::output].cycles / tick) * tick;
    }

    MachineSchedule& m_schedule;
};

/// A number with so many digits behind the point, whatever the locale.
std::string rounded(double value, int digits) {
    char text[64];
    return {text, to_chars(text, text + sizeof text, value, std::chars_format::fixed, digits).ptr};
}

/// The timeline of the first frames: a row for each stage, and below it one for each half of the buffer that it fills.
class Timeline {
  public:
    explicit Timeline(const MachineSchedule& schedule)
        : m_schedule(schedule), m_end(schedule.frames[kShown - 1][MachineSchedule::output].end) {}

    std::string draw() {
        using S = MachineSchedule;
        add_keys();
        for (const S::Place place : {S::host, S::processors, S::input, S::controller, S::pixels, S::output}) {
            add_stage(place);
            if (!m_schedule.stages[place].buffer.empty()) add_buffer(place);
        }
        add_axis();
        add_text(
            8, m_y + 56,
            rounded(m_schedule.frame_ms(), 3) + " ms a frame, " + rounded(1000 / m_schedule.frame_ms(), 2) +
                " frames a second; the bottleneck is the " + m_schedule.bottleneck().name +
                (m_schedule.tick > 0 ? "; one is shown every " + rounded(m_schedule.shown_ms(), 3) + " ms"
                                     : ""));
        return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(kLeft + kWidth + 30) +
               "\" height=\"" + rounded(m_y + 70, 0) +
               "\" font-family=\"sans-serif\" font-size=\"12\">\n<defs><pattern id=\"blocked\" width=\"6\" "
               "height=\"6\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">"
               "<path d=\"M0 0V6\" stroke=\"#888\" stroke-width=\"3\"/></pattern></defs>\n"
               "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n" +
               m_text + "</svg>\n";
    }

  private:
    static constexpr std::size_t kShown = 5;
    static constexpr int kLeft = 190, kWidth = 720;
    static constexpr const char* kColors[kShown] = {"#4477aa", "#ee6677", "#228833", "#ccbb44", "#aa3377"};
    static constexpr const char *kStarved = "#dddddd", *kBlocked = "url(#blocked)";

    double across(double cycles) const { return kLeft + cycles / m_end * kWidth; }

    void add_text(double x, double y, const std::string& what, const char* more = "") {
        m_text +=
            "<text x=\"" + rounded(x, 1) + "\" y=\"" + rounded(y, 1) + "\"" + more + ">" + what + "</text>\n";
    }
    void add_rect(double x, double width, double y, double height, const std::string& fill,
                  const std::string& title) {
        m_text += "<rect x=\"" + rounded(x, 2) + "\" y=\"" + rounded(y, 1) + "\" width=\"" +
                  rounded(width, 2) + "\" height=\"" + rounded(height, 1) + "\" fill=\"" + fill +
                  "\"><title>" + title + "</title></rect>\n";
    }
    /// From one time to another; nothing where they are the same.
    void add_bar(double from, double to, double y, double height, const std::string& fill,
                 const std::string& what) {
        if (to > from)
            add_rect(across(from), across(to) - across(from), y, height, fill,
                     what + ", " + rounded(m_schedule.ms(from), 3) + " to " + rounded(m_schedule.ms(to), 3) +
                         " ms");
    }
    static std::string frame_text(std::size_t f) { return "frame " + std::to_string(f + 1); }

    void add_keys() {
        double x = kLeft;
        const auto key = [&](const std::string& fill, const std::string& what, double width) {
            add_rect(x, 14, 10, 14, fill, what);
            add_text(x + 20, 22, what);
            x += width;
        };
        for (std::size_t f = 0; f < kShown; ++f) key(kColors[f], frame_text(f), 85);
        key(kStarved, "waits for input", 130);
        key(kBlocked, "waits for room", 130);
    }

    void add_stage(std::size_t s) {
        const MachineStage& stage = m_schedule.stages[s];
        add_text(8, m_y + 15, stage.name);
        for (std::size_t f = 0; f < kShown; ++f) {
            const MachineVisit& visit = m_schedule.frames[f][s];
            const double worked = visit.begin + stage.cycles;
            add_bar(visit.ready, visit.fed, m_y, 20, kStarved, stage.name + ": waits for input");
            if (s == MachineSchedule::output)
                add_bar(visit.fed, visit.begin, m_y, 20, kStarved, stage.name + ": waits for the clock");
            else
                add_bar(visit.fed, visit.begin, m_y, 20, kBlocked, stage.name + ": waits for room");
            add_bar(visit.begin, worked, m_y, 20, kColors[f], stage.name + ": " + frame_text(f));
            const bool full = s == MachineSchedule::controller;
            add_bar(worked, visit.end, m_y, 20, full ? kBlocked : kStarved,
                    stage.name + (full ? ": waits for room, in all" : ": waits for input, in all"));
        }
        m_y += 26;
    }

    /// When what reads a stage's buffer is done with a frame.
    double read_until(std::size_t stage, std::size_t frame) const {
        using S = MachineSchedule;
        const auto& at = m_schedule.frames;
        if (stage == S::host) return at[frame][S::processors].end;
        if (stage == S::pixels)
            return m_schedule.tick > 0 ? at[frame + 1][S::output].begin : at[frame][S::output].end;
        return at[frame][S::pixels].end;
    }

    /// A half holds a frame from when it is begun until what reads it is done with it.
    void add_buffer(std::size_t s) {
        add_text(20, m_y + 12, m_schedule.stages[s].buffer, " fill=\"#555555\" font-size=\"11\"");
        for (std::size_t f = 0; f < kShown; ++f)
            add_bar(m_schedule.frames[f][s].begin, std::min(read_until(s, f), m_end),
                    m_y + (f % 2 == 0 ? 0 : 9), 7, kColors[f],
                    m_schedule.stages[s].buffer + ": " + frame_text(f));
        m_y += 24;
    }

    /// Milliseconds by 1, 2 or 5 times a power of ten, ten ticks at most.
    void add_axis() {
        const double whole = m_schedule.ms(m_end);
        double step = std::pow(10, std::floor(std::log10(whole / 10)));
        for (const double by : {2.0, 2.5, 2.0})
            if (whole / step > 10) step *= by;
        const double y = m_y + 4;
        m_text += "<path d=\"M" + std::to_string(kLeft) + " " + rounded(y, 1) + "H" +
                  std::to_string(kLeft + kWidth) + "\" stroke=\"black\"/>\n";
        for (int i = 0; i * step <= whole; ++i) {
            const double x = kLeft + i * step / whole * kWidth;
            m_text += "<path d=\"M" + rounded(x, 1) + " 30V" + rounded(y + 5, 1) +
                      "\" stroke=\"black\" stroke-opacity=\".3\"/>\n";
            add_text(x, y + 18, shortest(static_cast<float>(i * step)), " text-anchor=\"middle\"");
        }
        add_text(kLeft + kWidth / 2.0, y + 34, "time since the start, ms", " text-anchor=\"middle\"");
    }

    const MachineSchedule& m_schedule;
    double m_end, m_y = 38;
    std::string m_text;
};

}  // namespace

const MachineStage& MachineSchedule::bottleneck() const {
    return *std::max_element(stages.begin(), stages.end(), [](const MachineStage& a, const MachineStage& b) {
        return a.cycles < b.cycles;
    });
}

int MachineSchedule::ticks_late(std::size_t frame) const {
    if (tick == 0 || frame == 0) return 0;
    const double after = frames[frame][output].begin - frames[frame - 1][output].begin;
    return static_cast<int>(std::min(std::round(after / tick) - 1, 1e9));
}

MachineSchedule schedule_of(const BlockMachine& machine, const BlockCounts& counts, const SurfaceCost& cost,
                            const Size& picture, const Size& screen) {
    MachineSchedule schedule;
    schedule.counts = counts;
    schedule.clock_mhz = machine.clock_mhz;
    schedule.tick = machine.frame_clock_ms * machine.clock_mhz * 1000;
    schedule.stages = stages_of(machine, counts, cost, picture, screen);
    schedule.period = period_of(schedule.stages, schedule.tick);
    set_waits(schedule.stages, schedule.period);
    FrameRun{schedule};
    return schedule;
}

std::string schedule_csv(const MachineSchedule& schedule) {
    std::string text =
        "stage,cycles,ms,utilisation,starved_ms,blocked_ms,bytes_read,bytes_written,buffer_bytes\n";
    for (const MachineStage& stage : schedule.stages) {
        text += stage.name;
        for (const double value : {stage.cycles, schedule.ms(stage.cycles), schedule.utilisation(stage),
                                   schedule.ms(stage.starved), schedule.ms(stage.blocked), stage.bytes_read,
                                   stage.bytes_written, stage.buffer_bytes})
            text += "," + shortest(value);
        text += "\n";
    }
    return text;
}

std::string schedule_frames_csv(const MachineSchedule& schedule) {
    using S = MachineSchedule;
    std::string text = "frame,drawn_ms,shown_ms,ticks_late\n";
    for (std::size_t f = 0; f < schedule.frames.size(); ++f)
        text += std::to_string(f + 1) + "," + shortest(schedule.ms(schedule.frames[f][S::pixels].end)) + "," +
                shortest(schedule.ms(schedule.frames[f][S::output].begin)) + "," +
                std::to_string(schedule.ticks_late(f)) + "\n";
    return text;
}

std::string schedule_svg(const MachineSchedule& schedule) {
    return Timeline(schedule).draw();
}

}  // namespace anamorph::machine
