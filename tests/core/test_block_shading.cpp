// SPDX-License-Identifier: Apache-2.0
// Shading by the machine of 1987 (section 5): light of blocks, linear over each, written out in long double.
#include "anamorph/machine/block_shading.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "anamorph/machine/block_pixels.h"
#include "drape_oracle.h"

namespace anamorph::test_block_shading {
using namespace machine;
using namespace surface;
namespace {

using test::Real;
using test::Vector;

constexpr int kSide = 64;

Vector unit(const Vector& a) {
    const Real size = std::hypot(a[0], a[1], a[2]);
    return {a[0] / size, a[1] / size, a[2] / size};
}
Real dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Waves before a camera without perspective that looks along -z.
class Model {
  public:
    explicit Model(const DrapeLighting& lighting) : m_lighting(lighting) {}

    /// The normal at a texel, by differences of the surface, towards the viewer.
    static Vector normal(Real u, Real v) {
        const Real h = 1e-6L;
        const auto point = [](Real s, Real t) {
            return test::oracle_surface("waves", SurfaceShape{}, s / kSide, t / kSide);
        };
        const Vector right = point(u + h, v), left = point(u - h, v), below = point(u, v + h),
                     above = point(u, v - h);
        Vector a, b;
        for (std::size_t i = 0; i < 3; ++i) {
            a[i] = right[i] - left[i];
            b[i] = above[i] - below[i];
        }
        return unit({a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]});
    }
    /// What light makes of white.
    std::array<Real, 2> light(const Vector& n) const {
        std::array<Real, 2> sum{m_lighting.ambient, 0};
        for (const glm::dvec3& l : m_lighting.lights) {
            const Real facing = dot(n, {l.x, l.y, l.z});
            if (facing <= 0) continue;
            sum[0] += m_lighting.diffuse * facing;
            sum[1] += m_lighting.specular * std::pow(std::max(Real(0), dot(n, unit({l.x, l.y, l.z + 1}))),
                                                     Real(m_lighting.shininess));
        }
        return sum;
    }
    /// White at an address of the block with this centre, lit.
    Real pixel(Point<double> centre, double side, Point<double> at, int light_bits) const {
        const auto linear = [&](const auto& of) {
            const Real by_u =
                           (of(centre.x + side, centre.y) - of(centre.x - side, centre.y)) / (2 * Real(side)),
                       by_v =
                           (of(centre.x, centre.y + side) - of(centre.x, centre.y - side)) / (2 * Real(side));
            return of(centre.x, centre.y) + (at.x - centre.x) * by_u + (at.y - centre.y) * by_v;
        };
        std::array<Real, 2> lit;
        if (m_lighting.shading == DrapeShading::gouraud)
            for (std::size_t k = 0; k < 2; ++k)
                lit[k] = linear([&](Real u, Real v) { return light(normal(u, v))[k]; });
        else {
            Vector n;
            for (std::size_t k = 0; k < 3; ++k)
                n[k] = linear([&](Real u, Real v) { return normal(u, v)[k]; });
            lit = light(unit(n));
        }
        Real sum = 0;
        for (const Real part : lit)
            sum +=
                std::max(Real(0), std::round(std::ldexp(part, light_bits)) / std::ldexp(Real(1), light_bits));
        return sum;
    }

  private:
    DrapeLighting m_lighting;
};

struct Scene {
    Camera camera;
    std::shared_ptr<const BlockMachineMap> map;
    std::shared_ptr<const DrapedSurface> surface;

    explicit Scene(const BlockMachine& machine, const std::string& name = "waves",
                   const SurfaceShape& shape = {})
        : camera(pose(), glm::dmat3(1.0), glm::dvec3(0.0), {kSide, kSide}) {
        const auto& names = surface_names();
        surface = make_surface(
            static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()), shape);
        map = std::make_shared<BlockMachineMap>(machine, surface, camera, Size{kSide, kSide});
    }
    static CameraPose pose() {
        CameraPose pose;
        pose.perspective = false;
        pose.extent = 1.1;
        pose.position = {0, 0, 4};
        return pose;
    }
    /// A picture of one colour and alpha, drawn.
    std::vector<float> draw(const BlockMachine& machine, const DrapeLighting& lighting,
                            std::vector<float> pixel, int alpha) const {
        const int channels = static_cast<int>(pixel.size());
        std::vector<float> texels, to(kSide * kSide * pixel.size());
        for (int i = 0; i < kSide * kSide; ++i) texels.insert(texels.end(), pixel.begin(), pixel.end());
        const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                              PixelType::float32, kSide, kSide, channels));
        BlockPixels pixels(map, machine, Border(Chart(Projection::rectilinear, kSide, kSide), Wrap::clamp),
                           Filter::bilinear);
        pixels.light({machine, surface, camera, {kSide, kSide}, map->blocks_of_machine(), lighting}, alpha);
        EXPECT_TRUE(pixels.draw(
            &source, {0, 0, kSide, kSide},
            packed_view(reinterpret_cast<std::byte*>(to.data()), PixelType::float32, kSide, kSide, channels),
            serial_for));
        return to;
    }
};

DrapeLighting lighting_of(DrapeShading shading) {
    DrapeLighting lighting;
    lighting.shading = shading;
    lighting.lights = {glm::dvec3(0.48, 0.6, 0.64), glm::dvec3(-0.6, 0, 0.8)};
    lighting.ambient = 0.1;
    lighting.diffuse = 0.5;
    lighting.specular = 0.3;
    lighting.shininess = 9;
    return lighting;
}

/// Where the processors' floats decide how a pixel is rounded, it may be a unit off.
TEST(BlockShading, IsLinearOverBlocks) {
    for (const DrapeShading shading : {DrapeShading::gouraud, DrapeShading::phong})
        for (const double block : {8.0, 4.0})
            for (const int bits : {4, 8, 20}) {
                BlockMachine machine;
                machine.block = block;
                machine.light_bits = bits;
                const Scene scene(machine);
                const DrapeLighting lighting = lighting_of(shading);
                const std::vector<float> drawn = scene.draw(machine, lighting, {1}, -1);
                const Model model(lighting);
                const BlockFrame& frame = scene.map->frame();
                const int across = static_cast<int>(kSide / block);
                ASSERT_EQ(frame.counts.blocks, across * across);
                int compared = 0, off = 0;
                for (std::size_t k = 0; k < frame.block.size(); ++k) {
                    const int number = frame.block[k];
                    if (number == BlockFrame::kNone) {
                        ASSERT_EQ(drawn[k], 0);
                        continue;
                    }
                    const Point<double> centre{(number % across + 0.5) * block,
                                               (number / across + 0.5) * block};
                    const Real wanted = model.pixel(centre, block, frame.addresses[k], bits),
                               unit = std::ldexp(Real(1), -bits);
                    const Real error = std::fabs(wanted - drawn[k]);
                    ASSERT_LE(error, 2 * unit + 2e-6L) << k;
                    off += error > 2e-6L;
                    ++compared;
                }
                EXPECT_GT(compared, 3000);
                EXPECT_LE(off, bits <= 8 ? compared / 200 : compared) << bits;
            }
}

/// Smaller blocks come nearer to the light of the surface itself.
TEST(BlockShading, ComesToTheSurfaceWithSmallerBlocks) {
    for (const DrapeShading shading : {DrapeShading::gouraud, DrapeShading::phong}) {
        const DrapeLighting lighting = lighting_of(shading);
        const Model model(lighting);
        double mean[2];
        for (const int fine : {0, 1}) {
            BlockMachine machine;
            machine.block = fine ? 2 : 8;
            machine.light_bits = 20;
            const Scene scene(machine);
            const std::vector<float> drawn = scene.draw(machine, lighting, {1}, -1);
            const BlockFrame& frame = scene.map->frame();
            mean[fine] = 0;
            for (std::size_t k = 0; k < frame.block.size(); ++k) {
                if (frame.block[k] == BlockFrame::kNone) continue;
                const auto lit = model.light(Model::normal(frame.addresses[k].x, frame.addresses[k].y));
                mean[fine] += std::fabs(double(lit[0] + lit[1] - drawn[k])) / (kSide * kSide);
            }
        }
        EXPECT_GT(mean[0], 0.001);
        EXPECT_LT(mean[1], mean[0] / 8) << mean[0];
    }
}

/// A whole ball, light from the camera: normals beyond its silhouette, which point away, are turned round to those before it.
TEST(BlockShading, GoesOnBeyondSilhouettes) {
    for (const DrapeShading shading : {DrapeShading::gouraud, DrapeShading::phong}) {
        BlockMachine machine;
        machine.block = 4;
        machine.light_bits = 20;
        SurfaceShape ball;
        ball.angle = 360;
        const Scene scene(machine, "sphere", ball);
        DrapeLighting lighting;
        lighting.shading = shading;
        const std::vector<float> drawn = scene.draw(machine, lighting, {1}, -1);
        double worst = 0;
        int seen = 0;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const double px = (x + 0.5 - kSide / 2) * 1.1 / kSide,
                             py = (y + 0.5 - kSide / 2) * 1.1 / kSide, square = 0.25 - px * px - py * py;
                if (!(square > 1e-4)) continue;
                const double wanted = lighting.ambient + lighting.diffuse * std::sqrt(square) / 0.5;
                worst = std::max(worst, std::fabs(drawn[static_cast<std::size_t>(y * kSide + x)] - wanted));
                ++seen;
            }
        EXPECT_GT(seen, 2500);
        EXPECT_LT(worst, 0.09);
    }
}

/// What goes on linearly beyond where light ends would be less than none.
TEST(BlockShading, LightIsNotNegative) {
    BlockMachine machine;
    const Scene scene(machine);
    DrapeLighting lighting;
    lighting.shading = DrapeShading::gouraud;
    lighting.ambient = 0;
    lighting.lights = {{1, 0, 0}};
    const std::vector<float> drawn = scene.draw(machine, lighting, {1}, -1);
    EXPECT_EQ(*std::min_element(drawn.begin(), drawn.end()), 0);
    EXPECT_GT(*std::max_element(drawn.begin(), drawn.end()), 0.3f);
}

/// Colours that are multiplied by alpha shine as far as they are there, and alpha stays.
TEST(BlockShading, AlphaStays) {
    BlockMachine machine;
    const Scene scene(machine);
    const DrapeLighting lighting = lighting_of(DrapeShading::phong);
    const std::vector<float> white = scene.draw(machine, lighting, {1}, -1),
                             half = scene.draw(machine, lighting, {0.5f, 0.5f}, 1);
    int shown = 0;
    for (std::size_t k = 0; k < white.size(); ++k) {
        ASSERT_FLOAT_EQ(half[2 * k], white[k] / 2);
        ASSERT_EQ(half[2 * k + 1], white[k] > 0 ? 0.5f : 0.0f);
        shown += white[k] > 0;
    }
    EXPECT_GT(shown, 3000);
}

TEST(BlockShading, TakesWhatIsCountedByHand) {
    DrapeLighting lighting = lighting_of(DrapeShading::none);
    EXPECT_EQ(cost_of(lighting), OperationCounts{});
    // A normal; two lights of 3 and 6 products; two differences each of intensity and highlight.
    lighting.shading = DrapeShading::gouraud;
    EXPECT_EQ(cost_of(lighting), (OperationCounts{12 + 2 * 9 + 4, 1 + 2, 1 + 4}));
    lighting.specular = 0;
    EXPECT_EQ(cost_of(lighting), (OperationCounts{12 + 2 * 3 + 2, 1, 1}));
    lighting.shading = DrapeShading::phong;
    EXPECT_EQ(cost_of(lighting), (OperationCounts{12 + 6, 1, 1}));
}

}  // namespace
}  // namespace anamorph::test_block_shading
