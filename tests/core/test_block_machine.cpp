// SPDX-License-Identifier: Apache-2.0
// The machine of 1987: what it visits of a plane at rest is known by hand; what it draws, by the surface's formula.
#include "anamorph/machine/block_machine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "anamorph/machine/machine_text.h"
#include "anamorph/operation/operation.h"
#include "drape_oracle.h"

namespace anamorph {
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
    return run_block_machine(machine, *surface_called(surface), camera, {picture, picture});
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
                for (int j = 0; j < n; ++j)
                    for (int i = 0; i < n; ++i) {
                        const auto at = static_cast<std::size_t>(j * n + i);
                        ASSERT_NE(frame.block[at], BlockFrame::kNone);
                        ASSERT_NEAR(frame.addresses[at].x, i + 0.5, 1e-9);
                        ASSERT_NEAR(frame.addresses[at].y, j + 0.5, 1e-9);
                    }
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
        // A block whose reference address saturates is wrong in all of its pixels, its share of the common area too.
        const int right = 128 - (overlap >= 2 ? static_cast<int>(overlap / 2) : 0);
        EXPECT_EQ(frame.counts.saturated, 256 * 256 - right * right) << overlap;
        EXPECT_EQ(frame.addresses.back().x, 128 - 1.0 / 256);
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
    for (const char* const scheme : {"auto", "exact", "oka", "oka-z"}) {
        const auto said = reached_by_drape({{"scheme", scheme}});
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
    const auto message = [](const std::vector<Assignment>& more) -> std::string {
        try {
            reached_by_drape(more);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_EQ(message({{"shading", "phong"}}), "shading=phong: must be none with scheme=hardware");
    EXPECT_EQ(message({{"output", "depth"}}),
              "output=depth: must be color, stmap, error or bound with scheme=hardware");
    EXPECT_EQ(message({{"background", "1"}}), "background=1: must not be given with scheme=hardware");
    EXPECT_EQ(message({{"machine", "ps20"}}),
              "machine=ps20: must be oka-1987, oka-1987:key=value,key=value or an object of JSON, {...}");
    EXPECT_EQ(message({{"machine", "oka-1987:processors=0"}}),
              "machine: processors=0: must be an integer from 1 to 4096");
}

}  // namespace
}  // namespace anamorph
