// SPDX-License-Identifier: Apache-2.0
// Maps whose blocks are let go while other threads still read them. Also run with the thread sanitizer.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "anamorph/chart/chart.h"
#include "draw_map.h"

namespace anamorph::test_block_map {
namespace {

/// Blocks of 64 x 32 pixels at their own places, with the region's number for a bound.
class NumberedMap final : public BlockMap {
  public:
    NumberedMap(int side, std::size_t kept_regions)
        : BlockMap(side, side, {Box{0, 0, side, side}}, {.kept_regions = kept_regions}),
          m_columns(side / kRegion) {}

    bool exact(double x, double y, int, Point<double>& at, int& piece) const noexcept override {
        at = {x, y};
        piece = 0;
        return true;
    }
    Jacobian jacobian(double, double, int) const noexcept override { return {}; }
    double number_of(const Box& box) const { return box.y0 / kRegion * m_columns + box.x0 / kRegion; }

  protected:
    void plan(const Box& box, int, Blocks& blocks) const override {
        for (int y = box.y0; y < box.y1; y += 32)
            for (int x = box.x0; x < box.x1; x += 64) {
                Block block;
                block.box = {x, y, x + 64, y + 32};
                block.bound = number_of(box);
                blocks.push_back(block);
            }
    }

  private:
    int m_columns;
};

/// All items on four threads, in an order that makes them meet in the same regions.
void four_threads(std::int64_t count, const std::function<void(std::int64_t)>& body) {
    std::atomic<std::int64_t> next{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
        threads.emplace_back([&] {
            for (std::int64_t k = next++; k < count; k = next++) body(k);
        });
    for (std::thread& t : threads) t.join();
}

constexpr int kSide = 16 * BlockMap::kRegion;

TEST(ConcurrentBlocks, AreKeptForWhoeverReadsThem) {
    const NumberedMap map(kSide, 2);
    std::atomic<std::int64_t> seen{0}, wrong{0};
    four_threads(4 * map.regions(), [&](std::int64_t i) {
        const std::int64_t region = i % map.regions();
        for (const Block& block : map.blocks(region)) {
            ++seen;
            if (block.bound != static_cast<double>(region) || map.number_of(block.box) != block.bound)
                ++wrong;
        }
    });
    EXPECT_EQ(seen, 4 * std::int64_t{kSide} * kSide / (64 * 32));
    EXPECT_EQ(wrong, 0);
}

TEST(ConcurrentBlocks, AreCountedWholeInWhatWasReached) {
    const NumberedMap map(kSide, 2);
    const Reached reached = map.reached(four_threads);
    EXPECT_EQ(reached.max_error, static_cast<double>(map.regions() - 1));
    EXPECT_EQ(reached.exact_fraction, 1);
}

TEST(ConcurrentBlocks, AreDrawnWhole) {
    constexpr int kPart = 1200, kOffset = 700;
    const NumberedMap map(kSide, 2);
    const Border border(Chart(Projection::rectilinear, kSide, kSide), Wrap::black);
    std::vector<float> values(std::size_t{kPart} * kPart);
    const Box box{kOffset, kOffset, kOffset + kPart, kOffset + kPart};
    const ImageView view =
        packed_view(reinterpret_cast<std::byte*>(values.data()), PixelType::float32, kPart, kPart, 1);
    EXPECT_TRUE(
        test::draw_map(map, border, Filter::bilinear, Output::bound, nullptr, box, view, four_threads));
    for (int y = 0; y < kPart; y += 37)
        for (int x = 0; x < kPart; x += 41)
            ASSERT_EQ(values[static_cast<std::size_t>(y * kPart + x)],
                      map.number_of({kOffset + x, kOffset + y, 0, 0}))
                << x << ", " << y;
}

}  // namespace
}  // namespace anamorph::test_block_map
