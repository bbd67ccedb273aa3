// SPDX-License-Identifier: Apache-2.0
// What plans of scheme automatic cost, counted: never much more than pixels that are direct, which serve at any tolerance.
#include <gtest/gtest.h>

#include <type_traits>

#include "anamorph/chart/chart_jets.h"
#include "anamorph/panorama/direct_rows.h"
#include "anamorph/panorama/panorama.h"
#include "anamorph/plan/formula_plan_impl.h"

namespace anamorph::test_plan_costs {
namespace {

/// A panorama that counts how often it is asked for bounds and polynomials, up to four at once.
struct Counted : Panorama {
    using Panorama::Panorama;
    static inline int bounds, polynomials;

    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        bounds += std::is_same_v<T, simd::BoundJets>;
        polynomials += std::is_same_v<T, simd::TaylorJets>;
        return Panorama::operator()(x, y, local);
    }
};

// Costs as tests/bench/costs.md has them, in exact pixels of a fisheye.
constexpr double kBounds = 1050, kPolynomials = 190, kBlock = 45, kPixel = 0.9, kApartPixel = 0.6;

/// Exact pixels that a picture's plan costs more than direct pixels in double would, per pixel.
double loss_of(const Chart& target, const Orientation& orientation, double tol, double pixel_saves) {
    const Counted map(Chart(Projection::equirectangular, 8192, 4096, 360), target, orientation);
    const Size size = map.target_size();
    const auto local = map.local_around(0.5 * size.width, 0.5 * size.height, 0);
    const ReadOrders orders{simd::direct_order<float>(map.target(), map.source(), local),
                            simd::direct_order<double>(map.target(), map.source(), local)};
    PlanOptions options;
    options.tol = tol;
    const FormulaPlan<Counted> plan(map, options, orders);
    double loss = 0, pixels = 0;
    const std::int64_t step = std::max<std::int64_t>(1, plan.regions() / 12);
    for (std::int64_t region = 0; region < plan.regions(); region += step) {
        Counted::bounds = Counted::polynomials = 0;
        for (const Block& block : plan.blocks(region)) {
            const double count = 1.0 * block.box.width() * block.box.height();
            pixels += count;
            if (block.kind == Block::Kind::polynomial || block.kind == Block::Kind::bicubic)
                loss += kBlock - pixel_saves * count;
        }
        loss += kBounds * Counted::bounds + kPolynomials * Counted::polynomials;
    }
    return loss / pixels;
}

TEST(PlanCosts, AutomaticIsHardlyDearerThanDirectPixels) {
    constexpr Orientation kTurned{30, 20, 10};
    const Chart fisheye(Projection::fisheye, 2048, 2048, 180),
        straight(Projection::rectilinear, 512, 512, 90);
    const Chart sphere(Projection::equirectangular, 2048, 1024, 360);
    for (const double tol : {1e-3, 1e-4, 1e-5, 1e-6}) {
        SCOPED_TRACE(tol);
        // What may be ventured is a 16th, before it is known to be lost.
        EXPECT_LT(loss_of(fisheye, {}, tol, kPixel), 0.125);
        EXPECT_LT(loss_of(fisheye, kTurned, tol, kPixel), 0.125);
        EXPECT_LT(loss_of(sphere, {.roll = 2}, tol, kPixel), 0.125);
        EXPECT_LT(loss_of(straight, {}, tol, kApartPixel), 0.125);
        EXPECT_LT(loss_of(straight, kTurned, tol, kApartPixel), 0.125);
    }
    // Polynomials are left where they pay.
    EXPECT_LT(loss_of(Chart(Projection::rectilinear, 2048, 2048, 90), kTurned, 1e-5, kPixel), -0.3);
    EXPECT_LT(loss_of(Chart(Projection::mercator, 2048, 2048, 360), {}, 1e-4, kPixel), -0.1);
}

}  // namespace
}  // namespace anamorph::test_plan_costs
