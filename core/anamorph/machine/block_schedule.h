// SPDX-License-Identifier: Apache-2.0
// The time that the machine of Oka 1987 takes for what it visits (block_machine.h). Between its parts stand
// double buffers: while one half is filled, the other is read. So the host computer, the micro-coded
// processors, the input, the drawing parts and the output each work on another frame; the address controller and the
// pixel processor, which draw, on the same one, and between these two stands a queue of addresses. Frames are shown
// at the ticks of a clock: one that is not ready is shown at a later tick, and the frame before it until then.
#pragma once

#include <string>
#include <vector>

#include "anamorph/machine/block_machine.h"
#include "anamorph/machine/surface_cost.h"

namespace anamorph::machine {

/// A part of the machine and what it does in a frame, once the buffers have filled. The cycles that it works
/// and waits are together the time from one shown frame to the next, on average.
struct MachineStage {
    std::string name;
    double cycles;                     ///< cycles that it works
    double bytes_read, bytes_written;  ///< bytes of memories for blocks and images
    std::string buffer;                ///< the buffer that it fills; may be none
    double buffer_bytes;               ///< bytes of both halves of that buffer
    double starved = 0;                ///< cycles that it waits for what it reads
    double blocked = 0;                ///< cycles that it waits for room for what it writes
};

/// A frame at a stage, in cycles since the machine was started.
struct MachineVisit {
    double ready;       ///< when the stage is done with the frame before
    double fed;         ///< when what it reads is there
    double begin, end;  ///< when there is room, and it works; of the two that draw, until both are done
};

/// The times that frames take. Stages work at once, so that the slowest one sets the rate, or the clock does.
struct MachineSchedule {
    /// The stages: the host, the processors, the two that draw, the output, in the order in which a frame passes them; and the input,
    /// which reads a picture while the host and the processors work.
    enum Place : std::size_t { host, processors, controller, pixels, output, input, kStages };
    /// The number of frames that are followed from the start.
    static constexpr std::size_t kFrames = 12;

    BlockCounts counts;
    double clock_mhz = 0;
    double tick = 0;    ///< cycles from one tick of the frame clock to the next; 0 where there is none
    double period = 0;  ///< cycles from one shown frame to the next, on average
    std::vector<MachineStage> stages;
    std::vector<std::vector<MachineVisit>> frames;  ///< each frame at each stage

    /// The slowest stage.
    const MachineStage& bottleneck() const;
    double ms(double cycles) const { return cycles / (clock_mhz * 1000); }
    /// The time that the slowest stage takes for a frame.
    double frame_ms() const { return ms(bottleneck().cycles); }
    /// The time from one shown frame to the next, on average.
    double shown_ms() const { return ms(period); }
    /// The part of its time that a stage works.
    double utilisation(const MachineStage& stage) const { return stage.cycles / period; }
    /// How many ticks later than the one after the frame before a frame is shown, of kFrames; 0 without a clock.
    int ticks_late(std::size_t frame) const;
};

/// Bytes of a pixel and of a texel as sources have them, of a block's data and of a number; and the numbers of a frame that
/// describe no surface: an affine transformation and a viewpoint.
inline constexpr double kBytesOfPixel = 3, kBytesOfBlock = 24, kBytesOfNumber = 4, kNumbersOfFrame = 16;

/// `cost`: what a point of the surface takes. `picture`: the size of the source.
MachineSchedule schedule_of(const BlockMachine& machine, const BlockCounts& counts, const SurfaceCost& cost,
                            const Size& picture, const Size& screen);

/// A table with a line for each stage:
/// stage,cycles,ms,utilisation,starved_ms,blocked_ms,bytes_read,bytes_written,buffer_bytes.
std::string schedule_csv(const MachineSchedule& schedule);
/// A table with a line for each of the first frames: frame,drawn_ms,shown_ms,ticks_late.
std::string schedule_frames_csv(const MachineSchedule& schedule);
/// A diagram of the first frames on their way through the stages and the buffers between them, over time.
std::string schedule_svg(const MachineSchedule& schedule);

}  // namespace anamorph::machine
