// SPDX-License-Identifier: Apache-2.0
// How long the machine of 1987 takes: counts known by hand, and what holds for every schedule.
#include "anamorph/machine/block_schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

namespace anamorph::test_block_schedule {
using namespace machine;
namespace {

using S = MachineSchedule;

constexpr SurfaceCost kTwentyProducts{{20, 0, 0}, 9};

/// Counts of a frame that one pixel unit draws.
BlockCounts counts_of(std::int64_t blocks, std::int64_t segments, std::int64_t pixels) {
    BlockCounts counts;
    counts.blocks = blocks;
    counts.segments = segments;
    counts.pixels = counts.pixel_cycles = pixels;
    return counts;
}

/// A plane at rest on a screen of n x n, as large as its picture, in blocks of d and segments as large: each is visited once.
MachineSchedule plane_at_rest(int d, int n) {
    BlockMachine machine;
    machine.block = machine.segment = d;
    const std::int64_t blocks = std::int64_t{n / d} * (n / d);
    machine.frame_clock_ms = 0;
    return schedule_of(machine, counts_of(blocks, blocks, std::int64_t{n} * n), kTwentyProducts, {n, n},
                       {n, n});
}

/// The default: 512 x 512 in blocks of 8 in 33 ms; smaller blocks bind the processors, larger pictures the pixel processor.
TEST(BlockSchedule, IsThatOfTheCounts) {
    const MachineSchedule standard = plane_at_rest(8, 512);
    EXPECT_LE(standard.frame_ms(), 33);
    // 4096 blocks on two processors, 41 products and two divisions of 16 cycles each; two cycles for each block in the list, and one
    // for each of 256 buckets.
    EXPECT_EQ(standard.stages[S::processors].cycles, 2048 * (41 + 32) + 2 * 4096 + 256);
    EXPECT_EQ(standard.stages[S::controller].cycles, 4096 * (8 + 4));
    EXPECT_EQ(standard.stages[S::pixels].cycles, 512 * 512);
    EXPECT_EQ(standard.bottleneck().name, "pixel processor");
    const MachineSchedule small = plane_at_rest(4, 512), large = plane_at_rest(8, 1024);
    EXPECT_EQ(small.bottleneck().name, "micro-coded processors");
    EXPECT_GT(small.frame_ms(), 33);
    EXPECT_EQ(large.bottleneck().name, "pixel processor");
    EXPECT_NEAR(large.frame_ms(), 1024 * 1024 / 1e4, 1e-9);
}

/// Where the pixel processor is the slowest, all before it wait for room; where the processors are, all after them for input.
TEST(BlockSchedule, SaysWhatStagesWaitFor) {
    const MachineSchedule pixels = plane_at_rest(8, 512);
    EXPECT_EQ(pixels.stages[S::host].blocked, 512 * 512 - 20000);
    EXPECT_EQ(pixels.stages[S::processors].blocked, 512 * 512 - (2048 * 73 + 2 * 4096 + 256));
    EXPECT_EQ(pixels.stages[S::controller].blocked, 512 * 512 - 4096 * 12);
    const MachineSchedule processors = plane_at_rest(4, 512);
    const double period = 8192 * 73 + 2 * 16384 + 256;
    EXPECT_EQ(processors.stages[S::host].blocked, period - 20000);
    EXPECT_EQ(processors.stages[S::pixels].starved, period - 512 * 512);
    // The controller waits for the next frame's blocks, and within a frame for the pixel processor.
    EXPECT_EQ(processors.stages[S::controller].starved, period - 512 * 512);
    EXPECT_EQ(processors.stages[S::controller].blocked, 512 * 512 - 16384 * 12);
    EXPECT_EQ(processors.stages[S::output].starved, period - 512 * 512);
}

TEST(BlockSchedule, WhatIsReadIsWhatIsVisited) {
    BlockMachine machine;
    const BlockCounts counts = counts_of(1000, 5000, 70000);
    const MachineSchedule s = schedule_of(machine, counts, kTwentyProducts, {100, 50}, {300, 200});
    // Sixteen numbers and the surface's nine, of four bytes, to each of two processors.
    EXPECT_EQ(s.stages[S::host].bytes_written, 25 * 4 * 2);
    EXPECT_EQ(s.stages[S::input].bytes_written, 100 * 50 * 3);
    EXPECT_EQ(s.stages[S::input].buffer_bytes, 2 * 100 * 50 * 3);
    EXPECT_EQ(s.stages[S::processors].bytes_written, 1000 * 24);
    EXPECT_EQ(s.stages[S::controller].bytes_read, s.stages[S::processors].bytes_written);
    EXPECT_EQ(s.stages[S::processors].buffer_bytes, 2 * s.stages[S::processors].bytes_written);
    // Four texels for a pixel, of three bytes.
    EXPECT_EQ(s.stages[S::pixels].bytes_read, 70000 * 12);
    EXPECT_EQ(s.stages[S::pixels].bytes_written, 70000 * 3);
    EXPECT_EQ(s.stages[S::pixels].buffer_bytes, 2 * 300 * 200 * 3);
    EXPECT_EQ(s.stages[S::output].bytes_read, 300 * 200 * 3);
}

TEST(BlockSchedule, NoStageWorksMoreThanThereIsTime) {
    constexpr unsigned kSeed = 29;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    const auto any = [&](int least, int most) {
        return std::uniform_int_distribution<int>(least, most)(random);
    };
    for (int i = 0; i < 2000; ++i) {
        BlockMachine machine;
        machine.processors = any(1, 5);
        machine.multipliers = any(1, 60);
        machine.division_cycles = any(1, 40);
        machine.host_cycles = any(0, 200000);
        machine.pixel_units = any(1, 5);
        machine.segment_cycles = any(1, 60);
        machine.frame_clock_ms = 0;
        const BlockCounts counts = counts_of(any(0, 9000), any(0, 20000), any(0, 600000));
        const Size screen{any(1, 700), any(1, 700)}, picture{any(1, 700), any(1, 700)};
        const MachineSchedule s =
            schedule_of(machine, counts, {{any(0, 100), any(0, 9), any(0, 9)}, any(0, 50)}, picture, screen);
        const double period = s.bottleneck().cycles;
        ASSERT_EQ(s.period, period);
        for (const MachineStage& stage : s.stages) {
            ASSERT_LE(s.utilisation(stage), 1);
            ASSERT_GE(std::min({stage.cycles, stage.starved, stage.blocked}), 0);
            ASSERT_EQ(stage.cycles + stage.starved + stage.blocked, period) << stage.name;
        }
        for (std::size_t f = 0; f < S::kFrames; ++f)
            for (std::size_t k = 0; k < S::kStages; ++k) {
                const MachineVisit& visit = s.frames[f][k];
                ASSERT_LE(visit.ready, visit.fed);
                ASSERT_LE(visit.fed, visit.begin);
                ASSERT_LE(visit.begin + s.stages[k].cycles, visit.end);
                // One frame at a time.
                if (f > 0) {
                    ASSERT_GE(visit.begin, s.frames[f - 1][k].end);
                }
                // After the buffer was filled, and not into a half that is still being read.
                if (k > 0 && k != S::pixels && k != S::input) {
                    ASSERT_GE(visit.begin, s.frames[f][k - 1].end);
                }
                if (k == S::controller || k == S::pixels) {
                    ASSERT_GE(visit.begin, s.frames[f][S::input].end);
                }
                if (f > 1 && k < S::output && k != S::controller) {
                    ASSERT_GE(visit.begin, s.frames[f - 2][k + 1].end);
                }
            }
    }
}

/// Frames that are followed one by one come to wait what the table says, and to leave the machine once a period.
TEST(BlockSchedule, FramesComeToTheTable) {
    for (const auto& [host, blocks, segments, pixels, width] : {std::array{1000, 100, 200, 50000, 150},
                                                                {200000, 100, 200, 50000, 150},
                                                                {1000, 9000, 200, 50000, 150},
                                                                {1000, 100, 60000, 50000, 150},
                                                                {1000, 2000, 4000, 20000, 150},
                                                                {1000, 100, 200, 50000, 2000}}) {
        BlockMachine machine;
        machine.host_cycles = host;
        machine.frame_clock_ms = 0;
        const MachineSchedule s = schedule_of(machine, counts_of(blocks, segments, pixels), kTwentyProducts,
                                              {width, 100}, {150, 100});
        const std::size_t last = S::kFrames - 1;
        const double period = s.bottleneck().cycles;
        for (std::size_t k = 0; k < S::kStages; ++k) {
            const MachineVisit& visit = s.frames[last][k];
            const double within = visit.end - visit.begin - s.stages[k].cycles;
            EXPECT_EQ(visit.end - s.frames[last - 1][k].end, period) << s.stages[k].name;
            EXPECT_EQ(visit.fed - visit.ready + (k == S::pixels ? within : 0), s.stages[k].starved)
                << s.stages[k].name << " " << period;
            EXPECT_EQ(visit.begin - visit.fed + (k == S::controller ? within : 0), s.stages[k].blocked)
                << s.stages[k].name << " " << period;
        }
    }
}

/// Four blocks of 8 x 8 on a screen of 16 x 16, by hand.
TEST(BlockSchedule, FourBlocksByHand) {
    BlockCounts counts;
    counts.blocks = counts.segments = 4;
    counts.pixels = counts.addressed = 256;
    counts.pixel_cycles = 4 * ((64 + 9) / 10);  // of ten units, which share the pixels of a segment
    const SurfaceCost bumpy{{2, 1, 3}, 9 + 7};
    BlockMachine machine;
    machine.pixel_units = 10;
    machine.buckets = 5;
    const auto schedule = [&] { return schedule_of(machine, counts, bumpy, {16, 16}, {16, 16}); };
    // Two blocks a processor: 2 + 3 x 4 + 21 products and 1 + 2 divisions of 16; four blocks and five buckets are sorted.
    EXPECT_EQ(schedule().stages[S::processors].cycles, 2 * (35 + 48) + 4 * 2 + 5);
    EXPECT_EQ(schedule().stages[S::controller].cycles, 4 * 8 + 4 * 4);
    EXPECT_EQ(schedule().stages[S::pixels].cycles, 28);
    EXPECT_EQ(schedule().stages[S::host].bytes_written, (16 + 16) * 4 * 2);
    machine.addresses = Addressing::repeated;
    EXPECT_EQ(schedule().stages[S::controller].cycles, 4 * 8 + 4 * 4 + 256);
    machine.addresses = Addressing::direct;
    EXPECT_EQ(schedule().stages[S::controller].cycles, 4 * 8 + 4 * 4 + 4 * 256);
    // By depths nothing is sorted, six products a block are more, and two bytes a pixel are read and written.
    machine.hidden = Hiding::z_buffer;
    EXPECT_EQ(schedule().stages[S::processors].cycles, 2 * (41 + 48));
    EXPECT_EQ(schedule().stages[S::pixels].bytes_read, 256 * (12 + 2));
    EXPECT_EQ(schedule().stages[S::pixels].bytes_written, 256 * (3 + 2));
    // Light takes 5 products, two functions and a division more.
    SurfaceCost lit = bumpy;
    lit.light = {5, 1, 2};
    EXPECT_EQ(schedule_of(machine, counts, lit, {16, 16}, {16, 16}).stages[S::processors].cycles,
              2 * (41 + 13 + 48 + 16));
    machine.surface_multiplies = 20;
    EXPECT_EQ(schedule().stages[S::processors].cycles, 2 * (20 + 27 + 32));
    machine.texel_bits = 12;
    EXPECT_EQ(schedule().stages[S::pixels].bytes_read, 256 * (24 + 2));
}

/// A frame that is not ready at a tick is shown at the next one; what the clock allows is what is shown.
TEST(BlockSchedule, WhatMissesATickIsShownLater) {
    BlockMachine machine;
    machine.host_cycles = 0;
    // The sort takes 256 cycles of an empty list.
    const auto of_ms = [&](double drawing, std::int64_t blocks = 0) {
        return schedule_of(machine, counts_of(blocks, 0, std::llround(drawing * 1e4)), kTwentyProducts,
                           {8, 8}, {8, 8});
    };
    EXPECT_EQ(of_ms(32).shown_ms(), 33);
    EXPECT_EQ(of_ms(33).shown_ms(), 33);
    // Of two halves one is shown until the other is ready: each frame that takes longer misses a tick.
    EXPECT_EQ(of_ms(34).shown_ms(), 66);
    EXPECT_EQ(of_ms(40).frame_ms(), 40);
    EXPECT_EQ(of_ms(66).shown_ms(), 66);
    EXPECT_EQ(of_ms(67).shown_ms(), 99);
    const MachineSchedule late = of_ms(40);
    for (std::size_t f = 2; f < S::kFrames; ++f) EXPECT_EQ(late.ticks_late(f), 1) << f;
    EXPECT_EQ(of_ms(32).ticks_late(5), 0);
    // A screen that takes 105 ms to put out is shown every fourth tick.
    const MachineSchedule large =
        schedule_of(machine, counts_of(0, 0, 10), kTwentyProducts, {8, 8}, {1024, 1024});
    EXPECT_EQ(large.shown_ms(), 132);
    for (std::size_t f = 1; f < S::kFrames; ++f) EXPECT_EQ(large.ticks_late(f), 3) << f;
    // Processors need no tick: where they take 40 ms, five frames are shown in 200 ms, at the ticks that follow.
    machine.surface_multiplies = 0;
    machine.sort_cycles = 0;
    machine.buckets = 1;
    machine.division_cycles = 1;
    machine.processors = 1;
    const MachineSchedule waiting = of_ms(1, 400000 / 23);
    EXPECT_NEAR(waiting.frame_ms(), 40, 0.01);
    EXPECT_NEAR(waiting.shown_ms(), 40, 0.05);
    int ticks = 0;
    for (std::size_t f = 1; f < S::kFrames; ++f) {
        EXPECT_LE(waiting.ticks_late(f), 1);
        ticks += waiting.ticks_late(f);
    }
    EXPECT_NEAR(ticks, 11 * (40.0 / 33 - 1), 1);
    EXPECT_TRUE(schedule_frames_csv(late).starts_with(
        "frame,drawn_ms,shown_ms,ticks_late\n1,40.0256,66,0\n2,80.0256,99,0\n3,139,165,1\n"))
        << schedule_frames_csv(late);
}

TEST(BlockSchedule, IsATableAndATimeline) {
    const MachineSchedule standard = plane_at_rest(8, 512);
    const std::string csv = schedule_csv(standard);
    EXPECT_TRUE(csv.starts_with(
        "stage,cycles,ms,utilisation,starved_ms,blocked_ms,bytes_read,bytes_written,buffer_bytes\n"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
    EXPECT_NE(csv.find("\npixel processor,262144,26.2144,1,0,0,3145728,786432,1572864\n"), std::string::npos)
        << csv;
    const std::string svg = schedule_svg(standard);
    EXPECT_NE(svg.find("26.214 ms a frame, 38.15 frames a second; the bottleneck is the pixel processor"),
              std::string::npos);
    EXPECT_NE(svg.find("time since the start, ms"), std::string::npos);
    // Five frames: 26.2144 ms to read the first picture and to draw each of them, and the last one is put out.
    EXPECT_NE(svg.find("output: frame 5, 157.286 to 183.501 ms"), std::string::npos) << svg;
    EXPECT_NE(svg.find(">160</text>"), std::string::npos);
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
}

}  // namespace
}  // namespace anamorph::test_block_schedule
