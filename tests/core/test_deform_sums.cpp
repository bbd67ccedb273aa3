// SPDX-License-Identifier: Apache-2.0
// Sums of displacements: each product rounded once to a whole number, whatever is added to what, in double and in whole numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "anamorph/deform/deform_kernels.h"
#include "anamorph/deform/deformed_surface.h"
#include "each_instruction_set.h"

namespace anamorph::test_deform_sums {
namespace {

using test::on_every_instruction_set;

/// A number with a random significand, from 2^least to 2^(least + 1).
double significand(std::mt19937_64& random, int least) {
    return std::ldexp(1 + static_cast<double>(random() >> 12) * 0x1p-52, least);
}
double odd(double share) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(share) | 1);
}

/// The nearest whole number to a product, of the C library's fused multiplication: magnitudes are below 2^51, and nothing lies in the
/// middle.
std::int64_t rounded_product(double weight, double share) {
    return static_cast<std::int64_t>(std::fma(weight, share, 0x1.8p52) - 0x1.8p52);
}

/// Gaussians on two rows of kGridBlock columns, with random factors: many products, rounded to double, lie in the middle of two whole numbers.
struct Terms {
    static constexpr int kCount = 40, kColumns = simd::kGridBlock;
    std::vector<double> columns, rows;
    std::vector<simd::GridTerm> terms;
    std::vector<std::int64_t> sums;

    explicit Terms(int exponent) {
        std::mt19937_64 random(7);
        for (int k = 0; k < kCount; ++k) {
            for (int i = 0; i < kColumns; ++i)
                columns.push_back(i == k ? 0 : odd(significand(random, -1 - static_cast<int>(random() % 3))));
            for (int r = 0; r < simd::kGridRows; ++r) rows.push_back(significand(random, -1));
        }
        sums.assign(std::size_t{3 * simd::kGridRows * kColumns}, 0);
        for (int k = 0; k < kCount; ++k) {
            simd::GridTerm term{&columns[static_cast<std::size_t>(k * kColumns)],
                                &rows[static_cast<std::size_t>(k * simd::kGridRows)],
                                0,
                                kColumns,
                                0,
                                simd::kGridRows,
                                {},
                                true};
            for (double& unit : term.units) unit = significand(random, exponent) * (random() % 2 ? 1 : -1);
            for (int r = 0; r < simd::kGridRows; ++r)
                for (int c = 0; c < 3; ++c)
                    for (int i = 0; i < kColumns; ++i)
                        sums[static_cast<std::size_t>((3 * r + c) * kColumns + i)] +=
                            rounded_product(term.units[c] * term.row[r], term.column[i]);
            terms.push_back(term);
        }
    }

    std::vector<std::int64_t> drawn(bool in_double) const {
        std::vector<std::int64_t> to(sums.size());
        simd::deform_band(simd::GridBand<double>{terms.data(), terms.size(), 0, simd::kGridRows, kColumns,
                                                 to.data(), 1, nullptr, nullptr, nullptr, false, false,
                                                 in_double});
        return to;
    }
};

TEST(DeformSums, ProductsAreRoundedOnce) {
    // Sums in double reach 2^50.
    const Terms small(43), large(49);
    int in_the_middle = 0;
    for (const simd::GridTerm& t : large.terms)
        for (int i = 0; i < Terms::kColumns; ++i) {
            const double product = t.units[0] * t.row[0] * t.column[i];
            in_the_middle += std::fabs(product - std::trunc(product)) == .5;
        }
    EXPECT_GT(in_the_middle, 20);
    on_every_instruction_set([&] {
        EXPECT_EQ(small.drawn(true), small.sums);
        EXPECT_EQ(small.drawn(false), small.sums);
        EXPECT_EQ(large.drawn(false), large.sums);
    });
}

std::vector<Deformation> random_list(bool plain) {
    std::mt19937 random(3);
    const auto number = [&](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    std::vector<Deformation> list(40);
    for (std::size_t k = 0; k < list.size(); ++k) {
        Deformation& d = list[k];
        // Some sums stand in the middle between two resolutions where F is 1.
        d.vector = {number(-6, 6), number(-6, 6), (static_cast<double>(k) + .5) * 0x1p-40};
        d.center = {number(0, 1), number(0, 1)};
        d.extent = {number(.05, .4), number(.05, .4)};
        if (k % 3 == 0) d.kernel = DeformationKernel::wendland_c2;
        if (k % 4 == 0) d.center = {.5, .5};
        if (!plain && k % 2 == 0) {
            d.extent_w = number(.1, .4);
            d.side = DeformationSide::front;
        }
    }
    return list;
}

/// A pair of bumps far away that makes the totals so large that sums are no longer in double, and moves no point.
std::vector<Deformation> with_large_ones(std::vector<Deformation> list) {
    Deformation large;
    large.vector = {900, 900, 900};
    large.center = {1e6, 1e6};
    large.extent = {.1, .1};
    list.insert(list.end(), 3, large);
    return list;
}

TEST(DeformSums, InDoubleAndInWholeNumbersTheSameBits) {
    std::vector<double> u, v;
    for (int i = 0; i < 75; ++i) u.push_back(i / 74.0);
    for (int j = 0; j < 23; ++j) v.push_back(j / 22.0);
    std::vector<glm::dvec2> points;
    PointDepths depths;
    for (const double y : v)
        for (const double x : u) {
            points.push_back({x, y});
            depths.w.push_back(.1 * x);
            depths.normal.push_back({.6, 0, .8});
        }
    const std::vector<Deformation> plain = random_list(true), deep = random_list(false);
    const DeformOptions options;
    const auto in_double = [&](const std::vector<Deformation>& list) {
        DisplacementSum sum(options);
        sum.apply(difference({}, list));
        return sum.stays_in_double();
    };
    ASSERT_TRUE(in_double(plain));
    ASSERT_FALSE(in_double(with_large_ones(plain)));
    std::vector<double> first, first_deep;
    on_every_instruction_set([&] {
        for (const auto& list : {plain, with_large_ones(plain)}) {
            std::vector<double> at_once(3 * points.size()), kept(at_once), scattered(at_once);
            deform_grid<double>(list, u, v, options, nullptr, at_once.data());
            DeformedGrid grid(u, v, options);
            for (const DeformationChange& change : difference({}, list)) {
                grid.apply(change);
                grid.update<double>(nullptr, kept.data());
            }
            grid.write<double>(nullptr, kept.data());
            DeformedPoints on_points(points, options);
            on_points.apply(difference({}, list));
            on_points.write<double>(nullptr, scattered.data());
            if (first.empty()) first = at_once;
            EXPECT_EQ(at_once, first);
            EXPECT_EQ(kept, first);
            EXPECT_EQ(scattered, first);
        }
        for (const auto& list : {deep, with_large_ones(deep)}) {
            std::vector<double> written(3 * points.size()), with_slopes(written);
            DeformedPoints on_points(points, depths, options);
            on_points.apply(difference({}, list));
            on_points.write<double>(nullptr, written.data());
            on_points.write_with_slopes<double>(list, nullptr, with_slopes.data(),
                                                [](const SurfaceSlopes&) {});
            if (first_deep.empty()) first_deep = written;
            EXPECT_EQ(written, first_deep);
            EXPECT_EQ(with_slopes, first_deep);
        }
    });
}

/// Sums that leave doubles on the way, and those that only might have, are whole numbers all the while.
TEST(DeformSums, WhatStaysInDouble) {
    const DeformOptions options;
    Deformation d;
    const auto moving = [&](double by) {
        d.vector = {0, 0, by};
        return d;
    };
    DisplacementSum sum(options);
    EXPECT_TRUE(sum.stays_in_double());
    // kMostInDouble is 1024 here, and half of that is for what is rounded.
    const std::vector<DeformationChange> some{{std::nullopt, moving(500)}}, none{{moving(500), std::nullopt}};
    sum.apply(some);
    EXPECT_TRUE(sum.stays_in_double());
    EXPECT_FALSE(sum.stays_in_double(some));
    sum.apply(none);
    EXPECT_FALSE(sum.stays_in_double(none));
    const std::vector<DeformationChange> few{{moving(100), moving(-100)}};
    EXPECT_TRUE(sum.stays_in_double(few));
}

/// Totals do not tell how large sums are where something is taken away before it is added.
TEST(DeformSums, TakenAwayBeforeItIsAdded) {
    Deformation d;
    d.kernel = DeformationKernel::wendland_c2;
    d.vector = {0x1p47, 0, 0};
    const DeformOptions options{.resolution = 1};
    on_every_instruction_set([&] {
        const std::vector<double> origin{0};
        DeformedGrid grid(origin, origin, options);
        DeformedPoints points(std::vector<glm::dvec2>{{0, 0}}, options);
        const auto check = [&](const DeformationChange& change, int times) {
            double moved[3], scattered[3];
            grid.apply(change);
            grid.update<double>(nullptr, moved);
            points.apply(change);
            points.write<double>(nullptr, scattered);
            EXPECT_EQ(moved[0], -times * 0x1p47);
            EXPECT_EQ(scattered[0], -times * 0x1p47);
        };
        for (int n = 1; n <= 24; ++n) check({d, std::nullopt}, n);
        for (int n = 23; n >= 0; --n) check({std::nullopt, d}, n);
    });
}

}  // namespace
}  // namespace anamorph::test_deform_sums
