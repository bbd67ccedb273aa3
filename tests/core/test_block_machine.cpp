// SPDX-License-Identifier: Apache-2.0
// The machine of 1987: what it visits of a plane at rest is known by hand; what it draws, by the surface's formula.
#include "anamorph/machine/block_machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "anamorph/machine/block_pixels.h"
#include "anamorph/machine/machine_text.h"
#include "anamorph/machine/surface_cost.h"
#include "anamorph/operation/operation.h"
#include "drape_oracle.h"

namespace anamorph::test_block_machine {
using namespace machine;
using namespace surface;
namespace {

CameraPose parallel_pose() {
    CameraPose pose;
    pose.perspective = false;
    pose.extent = 1;
    return pose;
}

std::shared_ptr<const DrapedSurface> surface_called(const std::string& name) {
    const auto& names = surface_names();
    const auto at = std::find(names.begin(), names.end(), name) - names.begin();
    return make_surface(static_cast<std::size_t>(at), SurfaceShape{});
}

BlockFrame frame_of(const BlockMachine& machine, const std::string& surface, const CameraPose& pose,
                    int screen, int picture) {
    const Camera camera(pose, glm::dmat3(1.0), glm::dvec3(0.0), {screen, screen});
    return MachineBlocks(machine, surface_called(surface), camera, {picture, picture}).draw_all(serial_for);
}

/// A picture of n x n in blocks of d on a screen of n x n: each of (n / d)^2 blocks is seen with w more pixels of each
/// side that has a neighbour, w = round(overlap / 2). Along an axis n + 2 w (n / d - 1) pixels are visited, and of segments
/// as large as blocks one for each, and where w > 0 both neighbours.
TEST(BlockMachine, VisitsOfAPlaneAtRestWhatIsKnownByHand) {
    for (const int n : {64, 256})
        for (const int d : {4, 8, 16})
            for (const double overlap : {0.0, 0.5, 2.0, 4.0}) {
                BlockMachine machine;
                machine.block = machine.segment = d;
                machine.overlap = overlap;
                const BlockFrame frame = frame_of(machine, "plane", parallel_pose(), n, n);
                const std::int64_t k = n / d, w = overlap >= 2 ? std::int64_t(overlap / 2) : 0;
                const std::int64_t along = n + 2 * w * (k - 1), segments = w > 0 ? 3 * k - 2 : k;
                EXPECT_EQ(frame.counts.blocks, k * k);
                EXPECT_EQ(frame.counts.pixels, along * along) << d << " " << overlap;
                EXPECT_EQ(frame.counts.segments, segments * segments) << d << " " << overlap;
                EXPECT_EQ(frame.counts.saturated, 0);
                EXPECT_EQ(frame.counts.addressed, frame.counts.segments * d * d);
                EXPECT_EQ(frame.counts.pixel_cycles, frame.counts.pixels);
                EXPECT_EQ(frame.counts.cracks, 0);
                for (int j = 0; j < n; ++j)
                    for (int i = 0; i < n; ++i) {
                        const auto at = static_cast<std::size_t>(j * n + i);
                        ASSERT_NE(frame.block[at], BlockFrame::kNone);
                        ASSERT_NEAR(frame.addresses[at].x, i + 0.5, 1e-9);
                        ASSERT_NEAR(frame.addresses[at].y, j + 0.5, 1e-9);
                    }
            }
}

/// Units share the pixels that a block has in a segment, 64 here; what is found one after the other is made so.
TEST(BlockMachine, UnitsShareSegments) {
    BlockMachine machine;
    machine.overlap = 0;
    machine.pixel_units = 10;
    EXPECT_EQ(frame_of(machine, "plane", parallel_pose(), 64, 64).counts.pixel_cycles, 64 * 7);
    machine.pixel_units = 64;
    EXPECT_EQ(frame_of(machine, "plane", parallel_pose(), 64, 64).counts.pixel_cycles, 64);
    machine.addresses = Addressing::repeated;
    EXPECT_EQ(frame_of(machine, "plane", parallel_pose(), 64, 64).counts.pixel_cycles, 64 * 64);
}

/// On an affine plane addresses are off by rounding alone: by half a unit for each number that docs/machines.md counts, of which what is
/// repeated adds up both across and down.
TEST(BlockMachine, AddressesAreOffByTheHalfUnitsOfTheirSums) {
    constexpr int kSide = 256;
    constexpr double kUnit = 0x1p-8;
    // Blocks of 8 texels are 7.6 pixels across and down, so that 4 pixels reach their borders, and one segment beyond.
    constexpr double kScale = 0.8, kTurn = 0.2;
    const double c = std::cos(kTurn), s = std::sin(kTurn);
    glm::dmat3 turn(1.0);
    turn[0] = {kScale * c, kScale * s, 0};
    turn[1] = {-kScale * s, kScale * c, 0};
    const Camera camera(parallel_pose(), turn, glm::dvec3(0.0), {kSide, kSide});
    struct Bound {
        Addressing addresses;
        double most;
    };
    for (const auto& [addresses, most] : {Bound{Addressing::direct, 1.5}, Bound{Addressing::segments, 3.5},
                                          Bound{Addressing::repeated, 4.5}}) {
        BlockMachine machine;
        machine.fraction_bits = 8;
        machine.overlap = 0;
        machine.addresses = addresses;
        const BlockFrame frame =
            MachineBlocks(machine, surface_called("plane"), camera, {kSide, kSide}).draw_all(serial_for);
        double worst = 0;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const std::size_t at = frame.index(x, y);
                if (frame.block[at] == BlockFrame::kNone) continue;
                // The turn and the scale undone, about the middle; y is up in space, and down on the screen and in the picture.
                const double dx = (x + 0.5 - kSide / 2) / kScale, up = (kSide / 2 - y - 0.5) / kScale;
                const double u = kSide / 2 + c * dx + s * up, v = kSide / 2 - (c * up - s * dx);
                worst = std::max({worst, std::fabs(frame.addresses[at].x - u) / kUnit,
                                  std::fabs(frame.addresses[at].y - v) / kUnit});
            }
        // The block's map in floats adds less than a twentieth of a unit.
        EXPECT_LT(worst, most + 0.05) << static_cast<int>(addresses);
        EXPECT_GT(worst, most / 2) << static_cast<int>(addresses);
    }
}

/// Smaller segments: (d / s)^2 for each block where they divide it.
TEST(BlockMachine, SegmentsDivideBlocks) {
    BlockMachine machine;
    machine.segment = 2;
    EXPECT_EQ(frame_of(machine, "plane", parallel_pose(), 64, 64).counts.segments, 64 * 16);
    machine.segment = 64;
    EXPECT_EQ(frame_of(machine, "plane", parallel_pose(), 64, 64).counts.segments, 64);
}

/// Where the surface is seen at an address, less the pixel's centre: O(d^2), and what fixed point adds.
double worst_of(const BlockMachine& machine, const std::string& surface, int n) {
    CameraPose pose;
    pose.position = {0.3, 0.2, 3};
    const BlockFrame frame = frame_of(machine, surface, pose, n, n);
    double worst = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto at = static_cast<std::size_t>(j * n + i);
            if (frame.block[at] == BlockFrame::kNone) continue;
            const test::OracleSight sight =
                test::oracle_sight(pose, {n, n},
                                   test::oracle_surface(surface, SurfaceShape{}, frame.addresses[at].x / n,
                                                        frame.addresses[at].y / n));
            worst = std::max(worst, double(std::hypot(sight.x - i - 0.5L, sight.y - j - 0.5L)));
        }
    return worst;
}

TEST(BlockMachine, AddressesLeadToTheirPixels) {
    BlockMachine machine;
    machine.address_bits = 36;
    machine.fraction_bits = 24;
    const double eight = worst_of(machine, "waves", 256);
    EXPECT_LT(eight, 1.5);
    machine.block = 4;
    const double four = worst_of(machine, "waves", 256);
    EXPECT_LT(four, 0.4 * eight);
    // Four bits behind the point: steps are off by 1/32, and that grows to the block's sides.
    machine.address_bits = 16;
    machine.fraction_bits = 4;
    const double coarse = worst_of(machine, "waves", 256);
    EXPECT_GT(coarse, 2 * four);
    EXPECT_LT(coarse, 1);
}

TEST(BlockMachine, AddressesThatDoNotFitSaturateAndAreCounted) {
    BlockMachine machine;
    machine.address_bits = 16;
    machine.fraction_bits = 8;
    // -128 to 128: three quarters of the picture are beyond. Blocks that share pixels visit these again, and a pixel
    // counts once.
    for (const double overlap : {0.0, 0.5, 4.0, 8.0}) {
        machine.overlap = overlap;
        const BlockFrame frame = frame_of(machine, "plane", parallel_pose(), 256, 256);
        // Of a block beyond, rectangle, address and all are the largest number, which lies in itself.
        EXPECT_GT(frame.counts.saturated, 0);
        for (int y = 0; y < 256; ++y)
            for (int x = 0; x < 256; ++x) {
                const std::size_t at = frame.index(x, y);
                const bool within = x < 120 && y < 120;
                if (within) {
                    ASSERT_FALSE(frame.beyond[at]);
                    ASSERT_NEAR(frame.addresses[at].x, x + 0.5, 1.0 / 256);
                } else if (x >= 136 && frame.block[at] != BlockFrame::kNone) {
                    ASSERT_TRUE(frame.beyond[at]);
                    ASSERT_EQ(frame.addresses[at].x, 128 - 1.0 / 256);
                }
            }
    }
}

TEST(BlockMachine, WhatIsNotSeenIsNotVisited) {
    CameraPose away;
    away.target = {0, 0, 10};
    const BlockFrame behind = frame_of(BlockMachine{}, "plane", away, 64, 64);
    EXPECT_EQ(behind.counts.blocks, 0);
    EXPECT_EQ(behind.counts.pixels, 0);
    CameraPose aside = parallel_pose();
    aside.position = {5, 0, 2};
    aside.target = {5, 0, 0};
    const BlockFrame beside = frame_of(BlockMachine{}, "plane", aside, 64, 64);
    EXPECT_EQ(beside.counts.blocks, 64);
    EXPECT_EQ(beside.counts.segments, 0);
    // On edge.
    CameraPose flat = parallel_pose();
    flat.position = {2, 0, 0};
    EXPECT_EQ(frame_of(BlockMachine{}, "plane", flat, 64, 64).counts.pixels, 0);
}

/// Fixed point in whole numbers of its unit.
struct Fixed {
    int bits, fraction;

    std::int64_t limited(std::int64_t units, bool& beyond) const {
        const std::int64_t half = std::int64_t{1} << (bits - 1), inside = std::clamp(units, -half, half - 1);
        beyond = beyond || inside != units;
        return inside;
    }
    /// The nearest one, ties to even.
    std::int64_t of(double value, bool& beyond) const {
        const double units = std::nearbyint(std::ldexp(value, fraction));
        return limited(static_cast<std::int64_t>(std::clamp(units, -1e15, 1e15)), beyond);
    }
    double value(std::int64_t units) const { return std::ldexp(static_cast<double>(units), -fraction); }
};

/// The machine written out in float, as its processors compute, and whole numbers: block and address of each pixel.
class Oracle {
  public:
    Oracle(const BlockMachine& machine, const std::string& surface, const CameraPose& pose, int n)
        : m_machine(machine), m_fixed{machine.address_bits, machine.fraction_bits}, m_n(n) {
        const int d = static_cast<int>(machine.block), count = n / d;
        const auto seen = [&](int i, int j) {
            const test::OracleSight at = test::oracle_sight(
                pose, {n, n},
                test::oracle_surface(surface, SurfaceShape{}, (i + 0.5L) * d / n, (j + 0.5L) * d / n));
            return std::array<float, 3>{float(double(at.x)), float(double(at.y)), float(double(at.ahead))};
        };
        for (int j = 0; j < count; ++j)
            for (int i = 0; i < count; ++i) {
                const auto c = seen(i, j), l = seen(i - 1, j), r = seen(i + 1, j), a = seen(i, j - 1),
                           b = seen(i, j + 1);
                const float sides = 2.0f * static_cast<float>(d);
                Block block;
                block.centre = c;
                for (std::size_t k = 0; k < 3; ++k) {
                    block.by_u[k] = (r[k] - l[k]) / sides;
                    block.by_v[k] = (b[k] - a[k]) / sides;
                }
                const float one = 1.0f / (block.by_u[0] * block.by_v[1] - block.by_v[0] * block.by_u[1]);
                block.inverse = {one * block.by_v[1], -one * block.by_v[0], -one * block.by_u[1],
                                 one * block.by_u[0]};
                const double half = machine.overlap / 2;
                block.u = (i + 0.5) * d;
                block.v = (j + 0.5) * d;
                block.low = {std::max(0.0, i * d - half), std::max(0.0, j * d - half)};
                block.high = {std::min(double(n), (i + 1) * d + half),
                              std::min(double(n), (j + 1) * d + half)};
                m_blocks.push_back(block);
            }
    }

    /// Compares all pixels. Returns how many of them show an address that was beyond the range.
    std::int64_t expect(const BlockFrame& frame) const {
        std::vector<Shown> shown(frame.block.size());
        for (const std::size_t k : order()) draw(static_cast<int>(k), shown);
        std::int64_t beyond = 0;
        for (std::size_t at = 0; at < shown.size(); ++at) {
            EXPECT_EQ(frame.block[at], shown[at].block)
                << at % std::size_t(m_n) << " " << at / std::size_t(m_n);
            if (testing::Test::HasFailure()) return 0;
            if (shown[at].block < 0) continue;
            EXPECT_EQ(frame.addresses[at].x, m_fixed.value(shown[at].address[0])) << at;
            EXPECT_EQ(frame.addresses[at].y, m_fixed.value(shown[at].address[1])) << at;
            EXPECT_EQ(frame.beyond[at], shown[at].beyond) << at;
            beyond += shown[at].beyond;
        }
        EXPECT_EQ(frame.counts.saturated, beyond);
        return beyond;
    }

  private:
    struct Shown {
        int block = -1;
        std::array<std::int64_t, 2> address{};
        bool beyond = false;
    };
    struct Block {
        std::array<float, 3> centre, by_u, by_v;
        std::array<float, 4> inverse;
        double u, v;
        std::array<double, 2> low, high;
    };

    /// From the farthest bucket to the nearest.
    std::vector<std::size_t> order() const {
        float near = HUGE_VALF, far = -HUGE_VALF;
        for (const Block& b : m_blocks) {
            near = std::min(near, b.centre[2]);
            far = std::max(far, b.centre[2]);
        }
        std::multimap<int, std::size_t> buckets;
        for (std::size_t k = 0; k < m_blocks.size(); ++k) {
            const double part = (double(far) - m_blocks[k].centre[2]) / (double(far) - near);
            buckets.emplace(std::min(static_cast<int>(part * m_machine.buckets), m_machine.buckets - 1), k);
        }
        std::vector<std::size_t> all;
        for (const auto& [bucket, k] : buckets) all.push_back(k);
        return all;
    }

    void draw(int number, std::vector<Shown>& shown) const {
        const Block& b = m_blocks[static_cast<std::size_t>(number)];
        const auto pixel = [&](float at) { return std::clamp(static_cast<int>(std::floor(at)), 0, m_n - 1); };
        const int x0 = pixel(b.centre[0]), y0 = pixel(b.centre[1]);
        const float dx = static_cast<float>(x0 + 0.5 - b.centre[0]),
                    dy = static_cast<float>(y0 + 0.5 - b.centre[1]);
        const float u = static_cast<float>(b.u), v = static_cast<float>(b.v);
        const float at[2] = {u + (b.inverse[0] * dx + b.inverse[1] * dy),
                             v + (b.inverse[2] * dx + b.inverse[3] * dy)};
        const Box box = reached(b);
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x) {
                Shown here{number};
                bool in = true, ends = false;
                for (std::size_t k = 0; k < 2; ++k) {
                    const std::int64_t to =
                        walked(at[k], b.inverse[2 * k], b.inverse[2 * k + 1], x, y, x0, y0, here.beyond);
                    in = in && to >= m_fixed.of(b.low[k], ends) && to <= m_fixed.of(b.high[k], ends);
                    here.address[k] = to;
                }
                if (in) shown[static_cast<std::size_t>(y * m_n + x)] = here;
            }
    }
    /// The segments that the block's parallelogram reaches.
    Box reached(const Block& b) const {
        double first[2] = {HUGE_VAL, HUGE_VAL}, last[2] = {-HUGE_VAL, -HUGE_VAL};
        for (const double u : {b.low[0], b.high[0]})
            for (const double v : {b.low[1], b.high[1]})
                for (std::size_t k = 0; k < 2; ++k) {
                    const double at = b.centre[k] + (u - b.u) * b.by_u[k] + (v - b.v) * b.by_v[k];
                    first[k] = std::min(first[k], at);
                    last[k] = std::max(last[k], at);
                }
        const int s = m_machine.segment;
        int from[2], to[2];
        for (std::size_t k = 0; k < 2; ++k) {
            from[k] = static_cast<int>(std::ceil(std::clamp(first[k] - 0.5, 0.0, double(m_n))));
            to[k] = static_cast<int>(std::floor(std::clamp(last[k] - 0.5, -1.0, m_n - 1.0)));
            if (to[k] < from[k]) return {0, 0, 0, 0};
            from[k] = from[k] / s * s;
            to[k] = std::min((to[k] / s + 1) * s, m_n);
        }
        return {from[0], from[1], to[0], to[1]};
    }
    /// Step by step, as the paper's Fig. 2.5 has it.
    std::int64_t walked(double at, double across, double down, int x, int y, int x0, int y0,
                        bool& beyond) const {
        const auto fixed = [&](double value) { return m_fixed.of(value, beyond); };
        const auto limited = [&](std::int64_t units) { return m_fixed.limited(units, beyond); };
        std::int64_t sum = fixed(at);
        if (m_machine.addresses == Addressing::direct)
            return limited(limited(sum + fixed((x - x0) * across)) + fixed((y - y0) * down));
        const int s = m_machine.addresses == Addressing::segments ? m_machine.segment : 1;
        const std::int64_t right = fixed(s * across), below = fixed(s * down);
        sum = limited(limited(sum - fixed(x0 % s * across)) - fixed(y0 % s * down));
        for (int k = y0 / s; k < y / s; ++k) sum = limited(sum + below);
        for (int k = y0 / s; k > y / s; --k) sum = limited(sum - below);
        for (int k = x0 / s; k < x / s; ++k) sum = limited(sum + right);
        for (int k = x0 / s; k > x / s; --k) sum = limited(sum - right);
        return limited(limited(sum + fixed(x % s * across)) + fixed(y % s * down));
    }

    BlockMachine m_machine;
    Fixed m_fixed;
    int m_n;
    std::vector<Block> m_blocks;
};

TEST(BlockMachine, IsTheMachineWrittenOutInWholeNumbers) {
    constexpr unsigned kSeed = 1987;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    const auto any = [&](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    std::int64_t beyond = 0;
    for (int round = 0; round < 48; ++round) {
        CameraPose pose;
        pose.position = {any(-1, 1), any(-1, 1), any(2, 4)};
        pose.perspective = round % 2 == 0;
        BlockMachine machine;
        machine.addresses =
            std::array{Addressing::segments, Addressing::repeated, Addressing::direct}[round % 3];
        machine.block = std::array{4, 8, 16}[round / 3 % 3];
        machine.segment = std::array{4, 8, 5}[round / 2 % 3];
        machine.overlap = std::array{0.0, 0.5, 2.0}[round % 3];
        machine.buckets = std::array{1, 7, 256}[round / 4 % 3];
        machine.fraction_bits = std::array{0, 2, 4, 8, 12}[round % 5];
        machine.address_bits = machine.fraction_bits + std::array{9, 6, 12, 5}[round / 3 % 4];
        const std::string surface = std::array{"waves", "torus", "sphere", "page_turn"}[round % 4];
        SCOPED_TRACE(testing::Message() << "round " << round << " " << surface);
        beyond += Oracle(machine, surface, pose, 64).expect(frame_of(machine, surface, pose, 64, 64));
        if (HasFailure()) return;
    }
    EXPECT_GT(beyond, 1000);
}

/// Too few bits behind the point open cracks between blocks, and their common area closes them.
TEST(BlockMachine, TooFewBitsOpenCracks) {
    CameraPose pose;
    pose.position = {0.3, 0.2, 1.4};
    const auto cracks = [&](int fraction_bits, double overlap) {
        BlockMachine machine;
        machine.fraction_bits = fraction_bits;
        machine.overlap = overlap;
        const BlockFrame frame = frame_of(machine, "waves", pose, 256, 256);
        std::int64_t empty = 0, full = 0;
        BlockMachine fine = machine;
        fine.address_bits = 36;
        fine.fraction_bits = 24;
        const BlockFrame all = frame_of(fine, "waves", pose, 256, 256);
        for (std::size_t k = 0; k < frame.block.size(); ++k) {
            empty += frame.block[k] == BlockFrame::kNone && all.block[k] != BlockFrame::kNone;
            full += all.block[k] != BlockFrame::kNone;
        }
        EXPECT_NEAR(double(frame.counts.cracks), double(empty), 0.001 * double(full));
        return frame.counts.cracks;
    };
    EXPECT_EQ(cracks(12, 0.5), 0);
    EXPECT_GT(cracks(4, 0), cracks(8, 0));
    EXPECT_GT(cracks(2, 0), cracks(4, 0));
    EXPECT_GT(cracks(2, 0), 50);
    // At its edges the picture has no neighbours.
    EXPECT_LT(cracks(2, 2), cracks(2, 0) / 5);
}

/// One bucket is the order of the picture; the more there are the fewer pixels show what lies behind.
TEST(BlockMachine, FewBucketsShowWhatLiesBehind) {
    CameraPose pose;
    pose.position = {1, 1.5, 2};
    const auto wrong = [&](int buckets) {
        BlockMachine machine;
        machine.buckets = buckets;
        return frame_of(machine, "torus", pose, 256, 256).counts.misordered;
    };
    EXPECT_GT(wrong(1), 1000);
    EXPECT_LT(wrong(16), wrong(1));
    EXPECT_LT(wrong(256), wrong(16));
    EXPECT_EQ(wrong(1 << 20), 0);
}

/// With depths for each pixel the nearest of the blocks that meet there is seen, but for the z-buffer's unit.
TEST(BlockMachine, DepthsOfPixelsHideWhatLiesBehind) {
    constexpr int kScreen = 128, kFine = 800;
    CameraPose pose;
    pose.position = {1, 1.5, 2};
    const auto sight = [&](double u, double v) {
        return test::oracle_sight(pose, {kScreen, kScreen},
                                  test::oracle_surface("torus", SurfaceShape{}, u, v));
    };
    // The nearest of many points of the surface that are seen at a pixel.
    std::vector<double> nearest(kScreen * kScreen, HUGE_VAL);
    for (int j = 0; j < kFine; ++j)
        for (int i = 0; i < kFine; ++i) {
            const test::OracleSight at = sight((i + 0.5) / kFine, (j + 0.5) / kFine);
            if (!(at.x >= 0 && at.x < kScreen && at.y >= 0 && at.y < kScreen)) continue;
            double& least =
                nearest[static_cast<std::size_t>(at.y) * kScreen + static_cast<std::size_t>(at.x)];
            least = std::min(least, double(at.ahead));
        }
    BlockMachine machine;
    const auto behind = [&] {
        const BlockFrame frame = frame_of(machine, "torus", pose, kScreen, kScreen);
        int count = 0;
        for (std::size_t k = 0; k < frame.block.size(); ++k) {
            if (frame.block[k] == BlockFrame::kNone) continue;
            const Point<double>& at = frame.addresses[k];
            count += double(sight(at.x / kScreen, at.y / kScreen).ahead) > nearest[k] + 0.1;
        }
        return count;
    };
    machine.buckets = 2;
    const int sorted = behind();
    machine.hidden = Hiding::z_buffer;
    const int fine = behind();
    machine.depth_bits = 3;
    const int coarse = behind();
    EXPECT_LT(fine, sorted / 5) << sorted;
    EXPECT_GT(coarse, fine);
}

TEST(BlockMachine, PartsOfAFrameAreThoseOfTheWhole) {
    constexpr int kScreen = 200;
    constexpr unsigned kSeed = 31;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    CameraPose pose;
    pose.position = {0.4, 0.6, 1.6};
    const Camera camera(pose, glm::dmat3(1.0), glm::dvec3(0.0), {kScreen, kScreen - 30});
    for (const Addressing addresses : {Addressing::segments, Addressing::repeated, Addressing::direct})
        for (const Hiding hidden : {Hiding::sort, Hiding::z_buffer})
            for (const int segment : {1, 8, 96})
                for (const int fraction : {4, 12}) {
                    BlockMachine machine;
                    machine.addresses = addresses;
                    machine.hidden = hidden;
                    machine.segment = segment;
                    machine.fraction_bits = fraction;
                    machine.address_bits = fraction + 7;
                    machine.buckets = 5;
                    const MachineBlocks blocks(machine, surface_called("torus"), camera, {90, 70});
                    const BlockFrame whole = blocks.draw_all(serial_for);
                    EXPECT_GT(whole.counts.pixels, 1000);
                    EXPECT_GT(whole.counts.saturated, 0);
                    for (int i = 0; i < 6; ++i) {
                        const auto at = [&](int most) {
                            return std::uniform_int_distribution<int>(0, most - 1)(random);
                        };
                        const int x = at(kScreen), y = at(kScreen - 30);
                        const Box box{x, y, x + 1 + at(kScreen - x), y + 1 + at(kScreen - 30 - y)};
                        const BlockFrame part = blocks.draw(box);
                        for (int row = box.y0; row < box.y1; ++row)
                            for (int column = box.x0; column < box.x1; ++column) {
                                const std::size_t p = part.index(column, row), w = whole.index(column, row);
                                ASSERT_EQ(part.block[p], whole.block[w]);
                                ASSERT_EQ(part.addresses[p].x, whole.addresses[w].x);
                                ASSERT_EQ(part.addresses[p].y, whole.addresses[w].y);
                                ASSERT_EQ(part.beyond[p], whole.beyond[w]);
                            }
                    }
                }
}

/// The pixels of a picture of `channels` floats that the machine shows.
std::vector<float> shown(const BlockMachine& machine, const std::vector<float>& picture, int n, int channels,
                         Filter filter, const CameraPose& pose, const std::string& surface) {
    const Camera camera(pose, glm::dmat3(1.0), glm::dvec3(0.0), {n, n});
    const auto map = std::make_shared<BlockMachineMap>(machine, surface_called(surface), camera, Size{n, n});
    const Chart flat(Projection::rectilinear, n, n);
    const MemorySource source(
        packed_view(reinterpret_cast<const std::byte*>(picture.data()), PixelType::float32, n, n, channels));
    std::vector<float> to(picture.size());
    EXPECT_TRUE(
        BlockPixels(map, machine, Border(flat, Wrap::clamp), filter)
            .draw(&source, {0, 0, n, n},
                  packed_view(reinterpret_cast<std::byte*>(to.data()), PixelType::float32, n, n, channels),
                  serial_for));
    return to;
}

/// The mean of a picture over a rectangle about a texel's centre, and 2.3's rule for its sides, summed texel by texel; weights
/// and texels of few bits.
TEST(BlockMachine, PixelsAreInterpolatedBetweenMeans) {
    constexpr int kSide = 64, kChannels = 3;
    constexpr unsigned kSeed = 23;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::vector<float> picture(kSide * kSide * kChannels);
    for (float& value : picture) value = std::uniform_real_distribution<float>(0, 1)(random);
    CameraPose pose;
    pose.position = {0.5, 0.7, 3.5};
    for (const Filter filter : {Filter::antialias, Filter::bilinear, Filter::nearest})
        for (const int texel_bits : {0, 4}) {
            BlockMachine machine;
            machine.weight_bits = 3;
            machine.texel_bits = texel_bits;
            const MachineBlocks blocks(machine, surface_called("waves"),
                                       Camera(pose, glm::dmat3(1.0), glm::dvec3(0.0), {kSide, kSide}),
                                       {kSide, kSide});
            const BlockFrame frame = blocks.draw_all(serial_for);
            const std::vector<float> drawn = shown(machine, picture, kSide, kChannels, filter, pose, "waves");
            const auto stored = [&](int i, int j, double width, double height, int c) {
                double sum = 0, area = 0;
                for (int y = j - 40; y <= j + 40; ++y)
                    for (int x = i - 40; x <= i + 40; ++x) {
                        const double across = std::min(x + 1.0, i + 0.5 + width / 2) -
                                              std::max(double(x), i + 0.5 - width / 2),
                                     down = std::min(y + 1.0, j + 0.5 + height / 2) -
                                            std::max(double(y), j + 0.5 - height / 2);
                        if (across <= 0 || down <= 0) continue;
                        const int at = std::clamp(y, 0, kSide - 1) * kSide + std::clamp(x, 0, kSide - 1);
                        sum += across * down * picture[static_cast<std::size_t>(at * kChannels + c)];
                        area += across * down;
                    }
                if (texel_bits == 0) return sum / area;
                return std::nearbyint(sum / area * 15) / 15;
            };
            double worst = 0;
            int compared = 0;
            for (std::size_t k = 0; k < frame.block.size(); k += 7) {
                if (frame.block[k] == BlockFrame::kNone) {
                    EXPECT_EQ(drawn[k * kChannels], 0);
                    continue;
                }
                const Jacobian& b = blocks.steps()[static_cast<std::size_t>(frame.block[k])];
                const bool means = filter == Filter::antialias;
                const double width = means ? std::max(1.0, std::fabs(b.x_i) + std::fabs(b.x_j)) : 1,
                             height = means ? std::max(1.0, std::fabs(b.y_i) + std::fabs(b.y_j)) : 1;
                const Point<double> at = frame.addresses[k];
                const int i = static_cast<int>(std::floor(at.x - 0.5)),
                          j = static_cast<int>(std::floor(at.y - 0.5));
                const double right = std::nearbyint((at.x - 0.5 - i) * 8) / 8,
                             below = std::nearbyint((at.y - 0.5 - j) * 8) / 8;
                for (int c = 0; c < kChannels; ++c) {
                    double expected = stored(static_cast<int>(std::floor(at.x)),
                                             static_cast<int>(std::floor(at.y)), 1, 1, c);
                    if (filter != Filter::nearest)
                        expected = (1 - below) * ((1 - right) * stored(i, j, width, height, c) +
                                                  right * stored(i + 1, j, width, height, c)) +
                                   below * ((1 - right) * stored(i, j + 1, width, height, c) +
                                            right * stored(i + 1, j + 1, width, height, c));
                    worst =
                        std::max(worst, std::fabs(expected - double(drawn[k * kChannels + std::size_t(c)])));
                }
                ++compared;
            }
            EXPECT_GT(compared, 50);
            EXPECT_LT(worst, 1e-6) << static_cast<int>(filter) << " " << texel_bits;
        }
}

/// What a point takes, counted by hand in the formulas of the surfaces.
TEST(BlockMachine, SurfacesTakeWhatTheirFormulasTake) {
    const auto cost = [](const std::string& name, std::vector<Deformation> bumps = {}) {
        const auto& names = surface_names();
        const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
        return cost_of({.parts = {{at}}, .deformations = std::move(bumps)});
    };
    // u by the aspect.
    EXPECT_EQ(cost("plane").point, (OperationCounts{1, 0, 0}));
    // Two angles; four sines and cosines; the radius, x, y and z.
    EXPECT_EQ(cost("sphere").point, (OperationCounts{6, 0, 4}));
    // A Gaussian: two extents, two squares, an exponential, V. One of Wendland's: extents, squares, a root, and
    // (1 - r)^4 (4 r + 1), with what stands for it at the centre.
    Deformation bump;
    EXPECT_EQ(cost("plane", std::vector(50, bump)).point, (OperationCounts{1 + 50 * 7, 0, 50}));
    EXPECT_EQ(cost("plane", std::vector(50, bump)).numbers, cost("plane").numbers + 50 * 7);
    bump.kernel = DeformationKernel::wendland_c2;
    EXPECT_EQ(cost("plane", {bump}).point, (OperationCounts{1 + 2 + 2 + 5 + 3, 0, 1}));
    bump.enabled = false;
    EXPECT_EQ(cost("plane", {bump}), cost("plane"));
    // Files: means of four values, three for each coordinate, and where these lie. Weighted, three for each summand more.
    const std::size_t shapes = surface_names().size();
    EXPECT_EQ(cost_of({.parts = {{shapes}}}).point, (OperationCounts{11, 0, 0}));
    EXPECT_EQ(cost_of({.parts = {{0, 0.5}, {shapes, 0.5}}}).point, (OperationCounts{1 + 11 + 2 * 3, 0, 0}));
    // A height: its mean, where it lies and its scale, along the sphere's normal, which costs as much as its point.
    const auto& names = surface_names();
    const auto sphere =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), "sphere") - names.begin());
    const std::vector<float> texels(16);
    EXPECT_EQ(cost_of({.parts = {{sphere}}, .heights = std::make_shared<SampledField>(texels, Size{4, 4}, 1)})
                  .point,
              (OperationCounts{6 + 6 + 3 + 2 + 1 + 3, 0, 8}));
    // Sine and cosine of one angle come together.
    SurfaceText text;
    text.px = "u*v";
    text.py = "u/v";
    text.pz = "sin(u)+sqrt(v)";
    EXPECT_EQ(cost_of({.parts = {{shapes + 1}}, .formula = parse_surface(text, {1, 0})}).point,
              (OperationCounts{1, 1, 3}));
}

/// The attributes of a picture that the operation drape makes of a source of 128 x 128.
std::map<std::string, double> reached_by_drape(const std::vector<Assignment>& more) {
    struct NoFiles final : SideFileReader {
        std::string text(const std::string& name) const override { throw Error("there is no file " + name); }
        std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
            throw Error("there is no image " + name);
        }
    };
    const Operation& drape = *find_operation("drape");
    ParameterValues values(*drape.parameters);
    values.assign({{"surface", "waves"}, {"scheme", "hardware"}});
    values.assign(more);
    SourceImage source;
    source.facts.width = source.facts.height = 128;
    const NoFiles files;
    std::map<std::string, double> numbers;
    for (const Attribute& a :
         drape.read({values, {source}, {}, files})->picture(0, 0)->solve()->reached(serial_for)) {
        if (std::holds_alternative<int>(a.value)) numbers[a.name] = std::get<int>(a.value);
        if (std::holds_alternative<double>(a.value)) numbers[a.name] = std::get<double>(a.value);
    }
    return numbers;
}

TEST(BlockMachine, OtherSchemesOfDrapesSayHowManyHolesThereAre) {
    for (const char* const scheme : {"oka", "oka-z"})
        EXPECT_EQ(reached_by_drape({{"scheme", scheme}}).count("anamorph:holes"), 0u) << scheme;
    for (const char* const scheme : {"auto", "exact", "oka", "oka-z"}) {
        const auto said = reached_by_drape({{"scheme", scheme}, {"holes", "1"}});
        ASSERT_EQ(said.count("anamorph:holes"), 1u) << scheme;
        EXPECT_EQ(said.at("anamorph:holes"), 0) << scheme;
    }
}

TEST(BlockMachine, IsASchemeOfDrapes) {
    auto standard = reached_by_drape({});
    EXPECT_EQ(standard, reached_by_drape({{"machine", "oka-1987"}}));
    EXPECT_EQ(standard["anamorph:patches"], 256);
    EXPECT_GT(standard["anamorph:max_error"], 0.05);
    EXPECT_LT(standard["anamorph:max_error"], 3);
    EXPECT_EQ(standard["anamorph:saturated_pixels"], 0);
    // 128 x 128 pixels at least, less than the host's 20000 cycles at 10 MHz.
    EXPECT_NEAR(standard["anamorph:frame_ms"], 2, 1e-9);
    auto fine = reached_by_drape({{"machine", "oka-1987:block=2"}});
    EXPECT_LT(fine["anamorph:max_error"], standard["anamorph:max_error"] / 2);
    EXPECT_GT(reached_by_drape(
                  {{"machine", "oka-1987:address_bits=16,fraction_bits=9"}})["anamorph:saturated_pixels"],
              100);
    EXPECT_EQ(standard["anamorph:cracks"], 0);
    EXPECT_EQ(standard["anamorph:blocks_left_out"], 0);
    // A floor on which the camera stands: the machine has no map of what begins behind it, and blocks drawn in parts are no machine's.
    const std::vector<Assignment> floor = {{"surface", "plane"},
                                           {"camera", "0,-0.1,0.08"},
                                           {"target", "0,0.3,0"},
                                           {"up", "0,0,1"},
                                           {"fov", "90"}};
    const auto on_floor = [&](const char* scheme, const char* key, const char* value) {
        std::vector<Assignment> all = floor;
        all.push_back({"scheme", scheme});
        all.push_back({key, value});
        return reached_by_drape(all).at("anamorph:blocks_left_out");
    };
    EXPECT_GT(on_floor("hardware", "machine", "oka-1987:block=32"), 0);
    EXPECT_LE(on_floor("hardware", "machine", "oka-1987:block=32"), 16);
    EXPECT_EQ(on_floor("oka", "block", "32"), 0);
    EXPECT_EQ(on_floor("oka-z", "block", "32"), 0);
    EXPECT_EQ(standard["anamorph:shown_ms"], 33);
    const auto message = [](const std::vector<Assignment>& more) -> std::string {
        try {
            reached_by_drape(more);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    };
    // Light takes time of the processors, which do not bind here; with it they do.
    EXPECT_EQ(message({{"shading", "phong"}}), "");
    EXPECT_GT(reached_by_drape({{"shading", "gouraud"},
                                {"light", "0,0,1,1,0,1,0,1,1"},
                                {"specular", "1"},
                                {"machine", "oka-1987:host_cycles=0,processors=1"}})["anamorph:frame_ms"],
              reached_by_drape({{"machine", "oka-1987:host_cycles=0,processors=1"}})["anamorph:frame_ms"]);
    EXPECT_EQ(message({{"machine", "oka-1987:light_bits=24"}}),
              "machine: light_bits=24: must be an integer from 0 to 23");
    EXPECT_EQ(message({{"output", "depth"}}),
              "output=depth: must be color, stmap, error or bound with scheme=hardware");
    EXPECT_EQ(message({{"background", "1"}}), "background=1: must not be given with scheme=hardware");
    EXPECT_EQ(message({{"filter", "bicubic"}}),
              "filter=bicubic: must be antialias, bilinear or nearest with scheme=hardware");
    EXPECT_EQ(message({{"machine", "oka-1987:addresses=jumps"}}),
              "machine: addresses=\"jumps\": must be one of direct, repeated, segments");
    EXPECT_EQ(message({{"machine", "oka-1987:frame_clock_ms=nan"}}),
              "machine: frame_clock_ms=nan: must be a number from 0 to 1e+06");
    EXPECT_EQ(message({{"machine", "ps20"}}),
              "machine=ps20: must be oka-1987, oka-1987:key=value,key=value or an object of JSON, {...}");
    EXPECT_EQ(message({{"machine", "oka-1987:processors=0"}}),
              "machine: processors=0: must be an integer from 1 to 4096");
    // What would mean nothing is not kept in silence.
    EXPECT_EQ(message({{"machine", "oka-1987:fraction_bits=22"}}), "");
    for (const char* bits : {"23", "24"})
        EXPECT_EQ(message({{"machine", std::string("oka-1987:fraction_bits=") + bits}}),
                  std::string("machine: fraction_bits=") + bits +
                      ": must be at most 22 with address_bits=24, as an address has a sign and whole texels");
    for (const char* scheme : {"auto", "exact", "hardware"})
        for (const char* key : {"block", "overlap"})
            EXPECT_EQ(message({{"scheme", scheme}, {key, "4"}}),
                      key + std::string("=4: must be given with scheme=oka or oka-z only"));
    for (const char* scheme : {"auto", "exact", "oka", "oka-z"})
        EXPECT_EQ(message({{"scheme", scheme}, {"machine", "oka-1987"}}),
                  "machine=oka-1987: must be given with scheme=hardware only");
    for (const char* count : {"0", "1"})
        EXPECT_EQ(message({{"holes", count}}),
                  std::string("holes=") + count + ": must not be given with scheme=hardware");
}

}  // namespace
}  // namespace anamorph::test_block_machine
