// SPDX-License-Identifier: Apache-2.0
// ST-maps of the picture's own size, read as they stand: against their own numbers in long double, and against
// the mesh that the same numbers make.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/error.h"
#include "anamorph/image/block_reader.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_warp.h"
#include "anamorph/mesh/stmap_plan.h"
#include "each_instruction_set.h"

namespace anamorph::test_stmap_plan {
namespace {

constexpr unsigned kSeed = 31;
constexpr Size kTarget{141, 70}, kSource{300, 97};

/// A turned and bent picture with noise, parts of it folded.
std::vector<float> bent_map(double noise) {
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> between(-noise, noise);
    std::vector<float> uv;
    for (int y = 0; y < kTarget.height; ++y)
        for (int x = 0; x < kTarget.width; ++x) {
            const double s = (x + 0.5) / kTarget.width, t = (y + 0.5) / kTarget.height;
            uv.push_back(static_cast<float>(s + 0.2 * std::sin(4 * t) + between(random)));
            uv.push_back(static_cast<float>(t + 0.1 * std::cos(5 * s) + between(random)));
        }
    return uv;
}

WarpMap map_of(const std::vector<float>& uv, bool v_up = false) {
    return mesh_from_stmap(uv, kTarget.width, kTarget.height, "st.exr", v_up);
}
const ControlMesh& mesh_of(const WarpMap& map) {
    return std::get<ControlMesh>(map.shape);
}

long double place(long double sample, int from, int to, double centre, double amount) {
    const long double here = static_cast<long double>(centre) * to / from;
    const long double there = sample * to;
    // Not even in long double is `here` added and taken off without rounding.
    return amount == 1 ? there : here + (there - here) * static_cast<long double>(amount);
}

/// visit(block, i, j, point) for all pixels.
template <class Visit>
void each_pixel(const BlockMap& plan, const Visit& visit) {
    PointsInDouble exact;
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region)) {
            if (in_double(block)) exact.read(plan, block, 0, block.box.height());
            for (int j = 0; j < block.box.height(); ++j) {
                alignas(64) float x[simd::kRowRoom], y[simd::kRowRoom];
                block_row(plan, block, block.box, block.box.y0 + j, x, y);
                for (int i = 0; i < block.box.width(); ++i)
                    visit(block, block.box.x0 + i, block.box.y0 + j,
                          in_double(block)
                              ? exact.at(i, j)
                              : Point<double>{block.base_x + double{x[i]}, block.base_y + double{y[i]}});
            }
        }
}

TEST(StMapPlan, SaysWhatTheSamplesSay) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    for (const double noise : {0.0, 0.01, 30.0})
        for (const double amount : {1.0, 0.3, -2.0, 1e-9})
            for (const double tol : {0.0, 1e-5, 0.01})
                for (const bool v_up : {false, true}) {
                    const std::vector<float> uv = bent_map(noise);
                    const WarpMap map = map_of(uv, v_up);
                    ASSERT_TRUE(StMapPlan::serves(mesh_of(map), kTarget));
                    const StMapPlan plan(mesh_of(map), kTarget, kSource, amount, WarpScheme::automatic, tol,
                                         "st");
                    int pixels = 0, computed = 0;
                    each_pixel(plan, [&](const Block& block, int x, int y, const Point<double>& p) {
                        const float* at = &uv[2 * static_cast<std::size_t>(y * kTarget.width + x)];
                        const long double v = v_up ? 1 - static_cast<long double>(at[1]) : at[1];
                        const auto off = static_cast<double>(
                            std::hypot(p.x - place(at[0], kTarget.width, kSource.width, x + 0.5, amount),
                                       p.y - place(v, kTarget.height, kSource.height, y + 0.5, amount)));
                        ASSERT_LE(off, block.bound) << x << ", " << y << " amount " << amount;
                        ASSERT_TRUE(is_exact(block) || block.bound <= tol);
                        ++pixels;
                        computed += !is_exact(block);
                    });
                    EXPECT_EQ(pixels, kTarget.width * kTarget.height);
                    if (tol == 0.01 && noise < 1) {
                        EXPECT_EQ(computed, pixels);
                    }
                }
}

TEST(StMapPlan, BetweenSamplesAndInDerivativesItIsTheirMesh) {
    const WarpMap map = map_of(bent_map(0.01), true);
    const StMapPlan plan(mesh_of(map), kTarget, kSource, 0.7, WarpScheme::automatic, 0.01, "st");
    const MeshPlan mesh(Mesh(mesh_of(map), kTarget, kSource, 0.7), WarpScheme::automatic, 0.01);
    for (const double x : {0.0, 0.2, 0.5, 17.5, 40.25, 140.5, 140.9, 141.0})
        for (const double y : {0.0, 0.3, 12.5, 33.0, 69.5, 70.0}) {
            Point<double> a{}, b{};
            int piece = 0;
            ASSERT_TRUE(plan.exact(x, y, 0, a, piece) && mesh.exact(x, y, 0, b, piece));
            EXPECT_NEAR(a.x, b.x, 1e-9) << x << ", " << y;
            EXPECT_NEAR(a.y, b.y, 1e-9) << x << ", " << y;
            const Jacobian p = plan.jacobian(x, y, 0), q = mesh.jacobian(x, y, 0);
            for (const double difference : {p.x_i - q.x_i, p.y_i - q.y_i, p.x_j - q.x_j, p.y_j - q.y_j})
                EXPECT_NEAR(difference, 0, 1e-9) << x << ", " << y;
        }
}

TEST(StMapPlan, FoldsLikeTheirMesh) {
    const WarpMap map = map_of(bent_map(0.01));
    const StMapPlan plan(mesh_of(map), kTarget, kSource, 1, WarpScheme::automatic, 0.01, "st");
    const MeshPlan mesh(Mesh(mesh_of(map), kTarget, kSource, 1), WarpScheme::automatic, 0.01);
    const Box whole{0, 0, kTarget.width, kTarget.height};
    EXPECT_GT(mesh.folded_pixels(whole), 100);
    EXPECT_EQ(plan.folded_pixels(whole), mesh.folded_pixels(whole));
}

TEST(StMapPlan, OtherSizesAndDirectionsAreMeshes) {
    WarpMap map = map_of(bent_map(0));
    EXPECT_FALSE(StMapPlan::serves(mesh_of(map), {kTarget.width, kTarget.height + 1}));
    std::get<ControlMesh>(map.shape).direction = Direction::push;
    EXPECT_FALSE(StMapPlan::serves(mesh_of(map), kTarget));
    // And are drawn.
    EXPECT_GE(warped_picture(map, kTarget, {50, 40}, {}).reached().max_error, 0);
}

TEST(StMapPlan, RefusesWhatIsTooFarOrTooShort) {
    std::vector<float> uv = bent_map(0);
    uv[2 * (3 * kTarget.width + 7) + 1] = 1e8f;
    const WarpMap far = map_of(uv);
    EXPECT_THROW(warped_picture(far, kSource, kTarget, {}), Error);
    uv.pop_back();
    EXPECT_THROW(map_of(uv), Error);
}

/// Of plates of 20 and of 142 million pixels: more than 2^24, and wider than any other mesh.
TEST(StMapPlan, TakesMapsOfLargePlates) {
    const auto identity = [](const Size& size) {
        std::vector<float> uv;
        uv.reserve(2 * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
        for (int y = 0; y < size.height; ++y)
            for (int x = 0; x < size.width; ++x) {
                uv.push_back(static_cast<float>((x + 0.5) / size.width));
                uv.push_back(static_cast<float>((y + 0.5) / size.height));
            }
        return uv;
    };
    const Size plate{6144, 3240}, wide{16384, 40};
    for (const Size& size : {plate, wide}) {
        const WarpMap map = mesh_from_stmap(identity(size), size.width, size.height, "st.exr");
        const Picture warp = warped_picture(map, size, size, {});
        EXPECT_EQ(warp.maps[0].blocks->width(), size.width);
        Point<double> p{};
        int piece = 0;
        ASSERT_TRUE(warp.maps[0].blocks->exact(size.width - 0.5, size.height - 0.5, 0, p, piece));
        EXPECT_NEAR(p.x, size.width - 0.5, 1e-3);
        EXPECT_NEAR(p.y, size.height - 0.5, 1e-3);
    }
    // Of another size than its picture it is a mesh of all its pixels, as it is where it pushes.
    const WarpMap map = mesh_from_stmap(identity(wide), wide.width, wide.height, "st.exr");
    const Picture half = warped_picture(map, wide, {wide.width / 2, wide.height / 2}, {});
    Point<double> p{};
    int piece = 0;
    ASSERT_TRUE(half.maps[0].blocks->exact(100.5, 7.25, 0, p, piece));
    EXPECT_NEAR(p.x, 201, 1e-2);
    EXPECT_NEAR(p.y, 14.5, 1e-2);
}

TEST(StMapPlan, TheSameBitsOnAllInstructionSets) {
    std::vector<std::vector<double>> all;
    test::on_every_instruction_set([&] {
        std::vector<double> values;
        for (const double amount : {1.0, 0.3}) {
            const WarpMap map = map_of(bent_map(0.01));
            const StMapPlan plan(mesh_of(map), kTarget, kSource, amount, WarpScheme::automatic, 0.01, "st");
            each_pixel(plan, [&](const Block& block, int, int, const Point<double>& p) {
                values.insert(values.end(), {block.bound, p.x, p.y});
            });
        }
        all.push_back(values);
    });
    for (const std::vector<double>& values : all) EXPECT_EQ(values, all.front());
}

}  // namespace
}  // namespace anamorph::test_stmap_plan
