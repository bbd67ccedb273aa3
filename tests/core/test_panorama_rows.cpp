// SPDX-License-Identifier: Apache-2.0
// Rows of exact points by vectors, for every pair of projections in the list: against the formulas in long double,
// within the bound that exact blocks state.
#include "anamorph/panorama/panorama_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/image/block_sampler.h"
#include "anamorph/panorama/panorama.h"
#include "projection_cases.h"

namespace anamorph::test_panorama_rows {
namespace {

/// Distance in source pixels; around a source that turns, or from face to face, points of one ray are one.
double distance(const Chart& source, const Point<double>& p, int piece, const Point<DoubleDouble>& q,
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
                Point<DoubleDouble> q{};
                int q_piece = 0;
                const bool seen = map.exact<DoubleDouble>(px, py, k, q, q_piece);
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

TEST(PanoramaRows, AreWithinTheBoundThroughLenses) {
    const auto photo = [](Projection projection, const char* lens) {
        return Chart(projection, 600, 400, 100, PixelSpacing::edges, "", 1, LensModel::parse(lens));
    };
    const Chart sphere(Projection::equirectangular, 512, 256);
    const Chart lenses[] = {
        photo(Projection::rectilinear, "ptlens:a=0.02,b=-0.05,c=0.01,d=7,e=-3"),
        photo(Projection::rectilinear, "brown:k1=-0.15,k2=0.03,k3=-0.001,k4=0.01,k6=0.002"),
        photo(Projection::rectilinear, "3de4:k1=0.1,k2=0.02,d=-5"),
        photo(Projection::fisheye, "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003"),
        photo(Projection::equisolid, "ptlens:b=-0.1"),
        photo(Projection::stereographic, "ptlens:b=-0.45"),
        photo(Projection::orthographic, "3de4:k1=-0.2,k2=0.02")};
    std::int64_t compared = 0;
    for (const Chart& lens : lenses)
        for (const Panorama& map :
             {Panorama(lens, sphere, {20, 30, 40}), Panorama(sphere, lens, {20, 30, 40}),
              Panorama(lens, lens, {1, 2, 3}, {3, 2, 1})}) {
            Found found;
            compare(map, found);
            EXPECT_EQ(found.over, 0) << lens.lens()->model().text();
            EXPECT_LE(found.differ_in_seen, 2) << lens.lens()->model().text();
            compared += found.compared;
        }
    EXPECT_GT(compared, 20000);
}

}  // namespace
}  // namespace anamorph::test_panorama_rows
