// SPDX-License-Identifier: Apache-2.0
// Rows of exact points by vectors, for every pair of projections in the list: against the formulas in long double,
// within the bound that exact blocks state.
#include "anamorph/simd/panorama_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/map/panorama.h"
#include "anamorph/simd/block_sampler.h"
#include "projection_cases.h"

namespace anamorph {
namespace {

/// Distance in source pixels; around a source that turns, or from face to face, points of one ray are one.
double distance(const Chart& source, const Point<double>& p, int piece, const Point<long double>& q,
                int q_piece) {
    if (piece != q_piece) return 0;
    double dx = static_cast<double>(p.x - q.x);
    if (const double turn = source.turn(); turn < HUGE_VAL) dx -= std::round(dx / turn) * turn;
    return std::hypot(dx, static_cast<double>(p.y - q.y));
}

struct Found {
    std::int64_t compared = 0, over = 0, differ_in_seen = 0;
};

/// Some rows of every piece of the target.
void compare(const Panorama& map, Found& found) {
    const Chart &source = map.source(), &target = map.target();
    for (std::size_t piece = 0; piece < target.pieces().size(); ++piece) {
        const Box& box = target.pieces()[piece].box;
        const int count = std::min(box.width(), simd::kExactRow), k = static_cast<int>(piece);
        for (int y = box.y0; y < box.y1; y += 7) {
            simd::ExactRow row;
            simd::exact_row(target, source, map.turn(), k, box.x0 + 0.5, y + 0.5, count, row);
            for (int i = 0; i < count; ++i) {
                const double px = box.x0 + i + 0.5, py = y + 0.5;
                const double bound = map.exact_error<double>(px, py, k);
                Point<long double> q{};
                int q_piece = 0;
                const bool seen = map.exact<long double>(px, py, k, q, q_piece);
                if (!(bound < 1)) continue;
                if (seen != (row.seen[i] != 0)) {
                    ++found.differ_in_seen;
                    continue;
                }
                if (!seen) continue;
                ++found.compared;
                if (!(distance(source, {row.x[i], row.y[i]}, static_cast<int>(row.piece[i]), q, q_piece) <=
                      bound))
                    ++found.over;
            }
        }
    }
}

TEST(PanoramaRows, AreWithinTheBoundOfExactPixelsForEveryPairOfProjections) {
    constexpr unsigned kSeed = 4001;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> angle(-180, 180);
    Found all;
    for (const Projection from : kProjections)
        for (const Projection to : kProjections) {
            Found found;
            const Chart source = test::example_chart(from, 512), target = test::example_chart(to, 48);
            compare({source, target, {angle(random), angle(random), angle(random)}}, found);
            compare({source, target, {0, 0, 0}}, found);
            EXPECT_EQ(found.over, 0) << name_of(from) << " to " << name_of(to);
            // Where a lens ends, rounding decides.
            EXPECT_LE(found.differ_in_seen, 2) << name_of(from) << " to " << name_of(to);
            all.compared += found.compared;
        }
    EXPECT_GT(all.compared, 100000);
}

}  // namespace
}  // namespace anamorph
