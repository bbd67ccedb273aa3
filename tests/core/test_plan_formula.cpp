// SPDX-License-Identifier: Apache-2.0
// A map that is nothing but its formula gets blocks whose bounds hold, by any scheme.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "anamorph/plan/formula_plan_impl.h"
#include "block_points.h"

namespace anamorph::test_plan_formula {
namespace {

/// A lens: radii r, in units of `unit` target pixels from a centre, become r (1 + k1 r^2 + k2 r^4), up to a
/// largest radius. The same centre of the source, which is `scale` times as large.
struct Lens : PlaneMap<Lens> {
    double cx, cy, unit, k1, k2, largest, scale;

    Lens(const Size& target, double times, const Point<double>& centre, double pixels, double a, double b,
         double limit = 100)
        : PlaneMap(target, {int(target.width * times), int(target.height * times)}),
          cx(centre.x),
          cy(centre.y),
          unit(pixels),
          k1(a),
          k2(b),
          largest(limit),
          scale(times) {}

    template <class T>
    T radius_squared(const T& x, const T& y) const {
        return square(T((x - cx) / T(unit))) + square(T((y - cy) / T(unit)));
    }
    template <class T>
    T inside(const T& x, const T& y) const {
        return largest * largest - radius_squared(x, y);
    }
    template <class T>
    Point<T> source_point(const T& x, const T& y) const {
        const T r2 = radius_squared(x, y), k = (r2 * k2 + k1) * r2 + 1.0;
        return {((x - cx) * k + cx) * scale, ((y - cy) * k + cy) * scale};
    }
};

struct Truth {
    bool seen;
    long double x, y;
};
/// In polar coordinates.
Truth truth_of(const Lens& lens, long double x, long double y) {
    const long double u = x - lens.cx, v = y - lens.cy, r = std::hypot(u, v) / lens.unit;
    const long double bent = lens.unit * (r + lens.k1 * std::pow(r, 3.0L) + lens.k2 * std::pow(r, 5.0L));
    const long double angle = std::atan2(v, u);
    return {r < lens.largest, lens.scale * (lens.cx + bent * std::cos(angle)),
            lens.scale * (lens.cy + bent * std::sin(angle))};
}

struct Findings {
    double worst_excess = -HUGE_VAL, worst = 0, worst_bound = 0;
    std::int64_t pixels = 0, exact = 0, lost = 0;
};

/// A pixel's point as a block gives it. False where it gives none.
bool used_point(const FormulaPlan<Lens>& plan, const Block& block, int i, int j, const test::BlockRow& row,
                Point<double>& p) {
    int piece = 0;
    if (block.kind == Block::Kind::exact)
        return static_cast<const BlockMap&>(plan).exact(block, i + 0.5, j + 0.5, p, piece);
    if (!test::has_points(block)) return false;
    p = row.at(i);
    return true;
}

void examine(const Lens& lens, const FormulaPlan<Lens>& plan, const Block& block, Findings& found) {
    constexpr double kFilter = 4;
    const Size size = lens.source_size();
    for (int j = block.box.y0; j < block.box.y1; ++j) {
        const test::BlockRow row(plan, block, j);
        for (int i = block.box.x0; i < block.box.x1; ++i) {
            ++found.pixels;
            found.exact += block.kind == Block::Kind::exact;
            Point<double> p{};
            const Truth truth = truth_of(lens, i + 0.5L, j + 0.5L);
            if (used_point(plan, block, i, j, row, p)) {
                const auto error = static_cast<double>(std::hypot(p.x - truth.x, p.y - truth.y));
                found.lost += !truth.seen;
                found.worst = std::max(found.worst, error);
                found.worst_excess = std::max(found.worst_excess, error - block.bound);
            } else
                found.lost += truth.seen && truth.x > -kFilter && truth.x < size.width + kFilter &&
                              truth.y > -kFilter && truth.y < size.height + kFilter;
        }
    }
    found.worst_bound = std::max(found.worst_bound, block.bound);
}

Findings examine(const Lens& lens, const PlanOptions& options) {
    Findings found;
    const FormulaPlan<Lens> plan(lens, options);
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region)) examine(lens, plan, block, found);
    return found;
}

TEST(FormulaPlan, ALensHoldsEveryToleranceByEveryScheme) {
    constexpr unsigned kSeed = 1987;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (const double tol : {1.0, 1.0 / 16, 0.01, 1e-3, 1e-4, 1e-6, 1e-9, 0.0})
        for (const Scheme scheme : {Scheme::automatic, Scheme::blocks, Scheme::residual, Scheme::exact}) {
            const Lens lens({540, 90}, between(0.5, 20), {between(-100, 800), between(-50, 200)},
                            between(200, 900), between(-0.3, 0.6), between(-0.1, 0.3),
                            between(0, 1) < 0.5 ? between(0.2, 0.9) : 100);
            SCOPED_TRACE(::testing::Message() << "tol " << tol << " scheme " << static_cast<int>(scheme));
            PlanOptions options;
            options.tol = tol;
            options.scheme = scheme;
            const Findings found = examine(lens, options);
            EXPECT_EQ(found.pixels, 540 * 90);
            EXPECT_LE(found.worst_excess, 0);
            EXPECT_EQ(found.lost, 0);
            EXPECT_LE(found.worst_bound, tol > 0 ? tol : 1e-9);
            if (tol >= 0.01 && (scheme == Scheme::automatic || scheme == Scheme::blocks)) {
                EXPECT_LT(found.exact, found.pixels / 2);
            }
        }
}

// Farther from the picture than doubles can tell, pixels are exact in long double.
TEST(FormulaPlan, BoundsOfRoundingHoldWhereItMatters) {
    const Lens lens({64, 48}, 1, {-3e7, 1e6}, 1e7, 0.1, 0.02);
    PlanOptions options;
    options.cull = false;
    options.tol = 1e-9;
    const Findings found = examine(lens, options);
    EXPECT_LE(found.worst_excess, 0);
    EXPECT_GT(found.worst_bound, 0);
    EXPECT_GT(found.worst, 0);
}

// What the parts of a block share is no less than what any of them has by itself.
TEST(FormulaPlan, SharedRoundingIsThatOfEveryPart) {
    using namespace plan_detail;
    const Lens lens({600, 400}, 1, {200, 100}, 300, 0.2, 0.1);
    PlanOptions options;
    const BoxBounds<Lens> bounds(lens, options, 0);
    CostModel account({}, true, {});
    PolynomialStrategy<Lens> polynomials(bounds, options.tol, account);
    const Box block{384, 256, 448, 288};
    const auto place = bounds.place_about(block);
    PolynomialStrategy<Lens>::Known known;
    polynomials.know({&block, 1}, place.local, &known);
    const auto alone = polynomials.bound_of(known);
    EXPECT_EQ(alone.rounding, HUGE_VAL);
    using Parts = PolynomialStrategy<Lens>::Parts;
    for (const Size& size : {Size{16, 16}, Size{32, 8}, Size{64, 16}}) {
        const Parts parts{size.width, size.height, Parts::placed};
        const double shared = polynomials.with_rounding(alone, block, parts, place.local).rounding;
        double most = 0;
        for_boxes(block, size.width, size.height, [&](const Box& part) {
            const double own = bounds.rounding_over(part, half(size.width), half(size.height), place.local);
            EXPECT_LE(own, shared * (1 + 1e-12));
            most = std::max(most, own);
        });
        EXPECT_LT(shared, 4 * most);
    }
    // Nothing to share: one part, or none that is placed.
    EXPECT_EQ(polynomials.with_rounding(alone, block, {64, 32, Parts::placed}, place.local).rounding,
              HUGE_VAL);
    EXPECT_EQ(polynomials.with_rounding(alone, block, {16, 16, Parts::renewed}, place.local).rounding,
              HUGE_VAL);
}

TEST(FormulaPlan, LinearPartIsTheDerivativeAtTheCentre) {
    const Lens lens({600, 400}, 2, {200, 100}, 300, 0.2, 0.1);
    const LinearPart linear = linear_part(lens, 0);
    for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, {0.1, 0.0}, {0.0, 0.1}, {-0.1, 0.1}}) {
        const Truth truth = truth_of(lens, 300 + dx, 200 + dy);
        const Point<double> p = linear(300 + dx, 200 + dy);
        EXPECT_NEAR(p.x, double(truth.x), 1e-3);
        EXPECT_NEAR(p.y, double(truth.y), 1e-3);
    }
    // None there: the middle of the source, the same everywhere.
    const LinearPart none = linear_part(Lens({600, 400}, 2, {0, 0}, 300, 0.2, 0.1, 0.5), 0);
    EXPECT_EQ(none(7, 8).x, 600);
    EXPECT_EQ(none(7, 8).y, 400);
}

TEST(FormulaPlan, BlocksDoNotDependOnTheOrderOfRegions) {
    const Lens lens({1300, 1100}, 3, {600, 500}, 700, -0.1, 0.2);
    const FormulaPlan<Lens> forward(lens, {}), backward(lens, {});
    for (std::int64_t region = backward.regions(); region-- > 0;) backward.blocks(region);
    for (std::int64_t region = 0; region < forward.regions(); ++region) {
        const SharedBlocks a = forward.blocks(region), b = backward.blocks(region);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t k = 0; k < a.size(); ++k) {
            EXPECT_EQ(a[k].box, b[k].box);
            EXPECT_EQ(a[k].bound, b[k].bound);
            EXPECT_EQ(std::memcmp(a[k].x, b[k].x, sizeof a[k].x), 0);
            EXPECT_EQ(std::memcmp(a[k].y, b[k].y, sizeof a[k].y), 0);
        }
    }
}

}  // namespace
}  // namespace anamorph::test_plan_formula
