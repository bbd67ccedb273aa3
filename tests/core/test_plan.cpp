// SPDX-License-Identifier: Apache-2.0
// The promise: no pixel's source point is farther from the exact one than its block's bound, and no bound
// than tol.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "anamorph/image/block_sampler.h"
#include "anamorph/panorama/panorama_plan.h"
#include "block_points.h"
#include "projection_cases.h"

namespace anamorph::test_plan {
namespace {

struct View {
    Projection source, target;
    int source_width = 1024, target_width = 96;
    double source_fov = 0, target_fov = 0;
    Orientation look;
    PixelSpacing spacing = PixelSpacing::edges;
};

struct Findings {
    double worst_excess = -HUGE_VAL;  ///< error - bound
    double worst_bound = 0;
    std::int64_t pixels = 0, exact_pixels = 0, lost = 0;
    std::vector<double> ratios;  ///< bound over largest true error, a block
};

/// Distance in source pixels, x counted around a source that closes on itself.
double distance(const Chart& source, double x, double y, const Point<DoubleDouble>& exact) {
    double dx = static_cast<double>(x - exact.x);
    if (source.closed()) dx -= std::round(dx / source.period()) * source.period();
    return std::hypot(dx, static_cast<double>(y - exact.y));
}

/// Looks at every pixel of every block.
Findings examine(const Panorama& map, const PlanOptions& options) {
    Findings found;
    const PanoramaPlan plan(map, options);
    std::vector<int> covered(static_cast<std::size_t>(map.target().width()) *
                             static_cast<std::size_t>(map.target().height()));
    for (std::int64_t r = 0; r < plan.regions(); ++r)
        for (const Block& block : plan.blocks(r)) {
            EXPECT_TRUE(block.kind == Block::Kind::outside ||
                        (block.box.width() <= simd::kMaxRow && block.box.height() <= 32));
            const bool drawn = test::has_points(block);
            double largest = 0;
            for (int j = block.box.y0; j < block.box.y1; ++j) {
                const test::BlockRow row(plan, block, j);
                for (int i = block.box.x0; i < block.box.x1; ++i) {
                    ++covered[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.target().width()) +
                              static_cast<std::size_t>(i)];
                    ++found.pixels;
                    if (block.kind == Block::Kind::exact) {
                        ++found.exact_pixels;
                        continue;
                    }
                    Point<DoubleDouble> p{};
                    int piece = 0;
                    const bool seen =
                        map.exact(DoubleDouble(i + 0.5), DoubleDouble(j + 0.5), block.piece, p, piece);
                    if (!drawn) {
                        const bool within = seen && p.x > -4 && p.x < map.source().width() + 4 && p.y > -4 &&
                                            p.y < map.source().height() + 4;
                        found.lost += within;
                        continue;
                    }
                    if (!seen || piece != block.source_piece) {
                        ++found.lost;
                        continue;
                    }
                    largest = std::max(largest, distance(map.source(), row.at(i).x, row.at(i).y, p));
                }
            }
            if (!drawn) continue;
            found.worst_excess = std::max(found.worst_excess, largest - block.bound);
            found.worst_bound = std::max(found.worst_bound, block.bound);
            if (largest > 0) found.ratios.push_back(block.bound / largest);
        }
    // Every pixel of every piece exactly once.
    std::int64_t wanted = 0;
    for (const Piece& piece : map.target().pieces())
        wanted += std::int64_t{piece.box.width()} * piece.box.height();
    EXPECT_EQ(found.pixels, wanted);
    EXPECT_LE(*std::max_element(covered.begin(), covered.end()), 1);
    return found;
}

void expect_promise(const View& view, double tol, Scheme scheme, std::vector<double>* ratios = nullptr) {
    const Panorama map(test::chart_of_width(view.source, view.source_width, view.source_fov, view.spacing),
                       test::chart_of_width(view.target, view.target_width, view.target_fov), view.look);
    PlanOptions options;
    options.tol = tol;
    options.scheme = scheme;
    const Findings found = examine(map, options);
    EXPECT_LE(found.worst_excess, 0);
    EXPECT_LE(found.worst_bound, tol);
    EXPECT_EQ(found.lost, 0);
    if (ratios) ratios->insert(ratios->end(), found.ratios.begin(), found.ratios.end());
}

constexpr double kTols[] = {1, 1.0 / 16, 0.01, 0.001};

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

/// Random views of each pair of projections for which `takes` says so, at each tolerance: `judge(tol, median)` hears how many times
/// their true errors the bounds of half of the blocks are at most.
template <class Takes, class Judge>
void expect_promises(unsigned seed, const Takes& takes, const Judge& judge) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (const double tol : kTols) {
        std::vector<double> ratios;
        for (const Projection source : kProjections)
            for (const Projection target : kProjections) {
                if (!takes(source, target)) continue;
                View view;
                view.source = source;
                view.target = target;
                view.source_width = static_cast<int>(between(256, 9000));
                view.target_width = static_cast<int>(between(48, 130));
                if (target == Projection::rectilinear) view.target_fov = between(1, 170);
                if (source == Projection::equirectangular && between(0, 1) < 0.3)
                    view.source_fov = between(60, 359);
                view.look = {between(-180, 180), between(-90, 90), between(-180, 180)};
                if (between(0, 1) < 0.2) view.spacing = PixelSpacing::centers;
                SCOPED_TRACE(::testing::Message()
                             << name_of(source) << " -> " << name_of(target) << " tol " << tol);
                expect_promise(view, tol, Scheme::blocks, &ratios);
                expect_promise(view, tol, Scheme::automatic);
                expect_promise(view, tol, Scheme::direct);
            }
        judge(tol, median(ratios));
    }
}

// A ball shows all directions up to its rim, where derivatives have no end and their bounds are wider.
bool shows_a_rim(Projection projection) {
    return projection == Projection::mirror_ball;
}

TEST(Plan, HoldsTheToleranceForEveryPairOfProjections) {
    const auto takes = [](Projection source, Projection target) {
        return !shows_a_rim(source) && !shows_a_rim(target);
    };
    expect_promises(20031, takes, [](double tol, double times) {
        EXPECT_LT(times, 2) << "bound over true error, tol " << tol;
        ::testing::Test::RecordProperty("median_bound_over_error_at_" + std::to_string(tol),
                                        std::to_string(times));
    });
}

TEST(Plan, HoldsTheToleranceUpToARim) {
    const auto takes = [](Projection source, Projection target) {
        return shows_a_rim(source) || shows_a_rim(target);
    };
    expect_promises(20032, takes, [](double tol, double times) {
        // Below that hardly a block is left.
        if (tol > 0.001) {
            EXPECT_LT(times, 8) << "bound over true error, tol " << tol;
        }
    });
}

TEST(Plan, HoldsTheToleranceInHardViews) {
    using enum Projection;
    const View views[] = {
        {equirectangular, rectilinear, 8192, 128, 0, 90, {10, 90, 0}},       // pole in the middle
        {equirectangular, rectilinear, 8192, 128, 0, 100, {-170, -70, 33}},  // pole and seam
        {equirectangular, rectilinear, 65536, 128, 0, 1e-3, {180, 0, 0}},    // seam, tiny field of view
        {equirectangular, rectilinear, 65536, 128, 0, 179.9, {0, 0, 0}},     // widest field of view
        {cylindrical, rectilinear, 4096, 128, 0, 90, {0, 90, 0}},            // along the cylinder's axis
        {mercator, rectilinear, 4096, 128, 0, 120, {90, -85, 0}},
        {rectilinear, equirectangular, 2048, 160, 120, 360, {0, 0, 0}},  // the horizon of the lens in view
        {rectilinear, fisheye, 2048, 128, 179.9, 360, {40, 50, 60}},
        {fisheye, equirectangular, 2048, 160, 360, 360, {77, -20, 5}},  // axis and antipode in view
        {stereographic, equirectangular, 2048, 160, 359, 360, {0, 90, 0}},
        {equisolid, stereographic, 2048, 128, 360, 350, {0, 180, 0}},
        {equirectangular, stereographic, 8192, 128, 0, 359.9, {0, -90, 0}},  // little planet
        {cubemap, rectilinear, 2048, 128, 0, 90, {45, 35.26, 0}},            // a corner of the cube
        {equirectangular, cubecross, 2048, 128, 0, 0, {1e-9, 1e-9, 0}},
        {equirectangular, rectilinear, 2, 64, 0, 90, {0, 0, 0}},         // a source of two pixels
        {equirectangular, equirectangular, 4096, 2, 0, 0.5, {0, 0, 0}},  // a picture of two pixels
    };
    for (const View& view : views)
        for (const double tol : kTols)
            for (const Scheme scheme :
                 {Scheme::automatic, Scheme::blocks, Scheme::residual, Scheme::direct}) {
                SCOPED_TRACE(::testing::Message()
                             << name_of(view.source) << " -> " << name_of(view.target) << " fov "
                             << view.target_fov << " pitch " << view.look.pitch << " tol " << tol);
                expect_promise(view, tol, scheme);
            }
}

TEST(Plan, ZeroToleranceIsExactEverywhere) {
    const Panorama map(Chart(Projection::equirectangular, 512, 256),
                       Chart(Projection::rectilinear, 100, 70, 90));
    PlanOptions options;
    options.tol = 0;
    const PanoramaPlan plan(map, options);
    const Reached reached = plan.reached(serial_for);
    EXPECT_EQ(reached.exact_fraction, 1);
    // What rounding costs, which is not nothing.
    EXPECT_GT(reached.max_error, 0);
    EXPECT_LT(reached.max_error, 1e-9);
}

TEST(Plan, ReachedIsTheLargestBoundAndTheExactShare) {
    const Panorama map(Chart(Projection::equirectangular, 4096, 2048),
                       Chart(Projection::rectilinear, 300, 200, 100), {0, 80, 0});
    const PanoramaPlan plan(map, {});
    double bound = 0;
    std::int64_t exact = 0;
    for (std::int64_t r = 0; r < plan.regions(); ++r)
        for (const Block& b : plan.blocks(r)) {
            bound = std::max(bound, b.bound);
            if (b.kind == Block::Kind::exact) exact += std::int64_t{b.box.width()} * b.box.height();
        }
    const Reached reached = plan.reached(serial_for);
    EXPECT_EQ(reached.max_error, bound);
    EXPECT_GT(exact, 0);
    EXPECT_DOUBLE_EQ(reached.exact_fraction, double(exact) / (300 * 200));
}

TEST(Plan, FindsTheRegionsOfABox) {
    for (const Projection projection :
         {Projection::rectilinear, Projection::cubecross, Projection::cubemap}) {
        const Panorama map(Chart(Projection::equirectangular, 512, 256),
                           test::chart_of_width(projection, 4000, 0));
        const PanoramaPlan plan(map, {});
        for (const Box& box : {Box{0, 0, 1, 1}, Box{500, 300, 1700, 1030}, Box{1023, 1023, 1025, 1025},
                               Box{-5, -5, 0, 100}, Box{0, 0, 4000, 6000}}) {
            std::vector<std::int64_t> expected;
            for (std::int64_t r = 0; r < plan.regions(); ++r)
                if (!intersection(plan.region_box(r), box).empty()) expected.push_back(r);
            EXPECT_EQ(plan.regions_in(box), expected) << name_of(projection);
        }
    }
    // A picture far too large to draw costs nothing to begin.
    const Panorama huge(Chart(Projection::equirectangular, 512, 256),
                        Chart(Projection::rectilinear, 1 << 24, 1 << 24, 90));
    constexpr std::int64_t kColumns = (std::int64_t{1} << 24) / BlockMap::kRegion;
    EXPECT_EQ(PanoramaPlan(huge, {}).regions(), kColumns * kColumns);
    EXPECT_EQ(PanoramaPlan(huge, {}).regions_in({1 << 23, 1 << 23, (1 << 23) + 1, (1 << 23) + 1}).size(), 1u);
}

TEST(Plan, RefusesATolerance) {
    const Panorama map(Chart(Projection::equirectangular, 512, 256),
                       Chart(Projection::rectilinear, 100, 70, 90));
    for (const double tol : {-1.0, double(NAN), HUGE_VAL}) {
        PlanOptions options;
        options.tol = tol;
        try {
            const PanoramaPlan plan(map, options);
            ADD_FAILURE() << "tol " << tol << " was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.parameter(), "tol");
        }
    }
}

// Where cells of a table hold the tolerance they serve, and where none can, all is exact in whole blocks.
TEST(Plan, TablesServeWhereTheyCan) {
    const Chart sphere(Projection::equirectangular, 2048, 1024), view(Projection::rectilinear, 512, 512, 90);
    const auto exact_fraction = [&](double tol) {
        PlanOptions options;
        options.scheme = Scheme::residual;
        options.tol = tol;
        return PanoramaPlan(Panorama(sphere, view, {30, 20, 10}), options).reached(serial_for).exact_fraction;
    };
    EXPECT_EQ(exact_fraction(0.2), 0);
    EXPECT_LT(exact_fraction(0.1), 0.01);
    EXPECT_LT(exact_fraction(0.05), 0.9);
    EXPECT_EQ(exact_fraction(1e-6), 1);
}

}  // namespace
}  // namespace anamorph::test_plan
