// SPDX-License-Identifier: Apache-2.0
// What an antialiased pixel shows, against the mean of 16 x 16 rays through it, worked out in long double.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/image/pyramid.h"
#include "anamorph/panorama/reproject.h"
#include "panorama_oracle.h"

namespace anamorph::test_footprint_rays {
namespace {

using enum Projection;
using oracle::Real;
using oracle::Vector;
using oracle::View;

constexpr int kSide = 16;  ///< rays each way

struct Scene {
    View source, target;
    Orientation look;
};

/// Small pictures, wide fields of view, any orientation: the map differs much from pixel to pixel.
Scene strong_distortion(std::mt19937_64& random) {
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto whole = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    const auto view = [&](int low, int high) {
        switch (whole(0, 3)) {
            case 0:
                return View{rectilinear, whole(low, high), whole(low, high), number(20, 160)};
            case 1:
                return View{fisheye, whole(low, high), whole(low, high), number(30, 360)};
            case 2:
                return View{equisolid, whole(low, high), whole(low, high), number(30, 355)};
            default:
                return View{stereographic, whole(low, high), whole(low, high), number(30, 340)};
        }
    };
    const View source = view(32, 200), target = view(3, 40);
    return {source, target, {number(-180, 180), number(-90, 90), number(-180, 180)}};
}

/// Of a pixel.
struct Rays {
    double mean = 0;    ///< the share of its rays that meet the source
    bool whole = true;  ///< have all of them source points?
};
Rays rays_of(const Scene& s, int x, int y) {
    const Piece whole_source{{0, 0, s.source.width, s.source.height}},
        whole_target{{0, 0, s.target.width, s.target.height}};
    const auto source_point = [&](Real px, Real py, Point<Real>& p) {
        Vector ray;
        if (!oracle::ray_of(s.target, whole_target, px, py, ray)) return false;
        p = oracle::point_of(s.source, whole_source, oracle::rotated(ray, s.look));
        return std::isfinite(p.x) && std::isfinite(p.y);
    };
    Rays rays;
    Point<Real> p;
    int met = 0;
    for (int k = 0; k < kSide * kSide; ++k) {
        if (!source_point(x + (k % kSide + Real(0.5)) / kSide, y + (k / kSide + Real(0.5)) / kSide, p)) {
            rays.whole = false;
            continue;
        }
        const Real within = std::min({p.x, p.y, s.source.width - p.x, s.source.height - p.y});
        met += within >= 0;
    }
    rays.mean = double(met) / (kSide * kSide);
    return rays;
}

/// A picture of one channel that is 1 everywhere.
class Ones {
  public:
    explicit Ones(const Size& size)
        : m_values(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height), 1.0f),
          m_base(packed_view(reinterpret_cast<const std::byte*>(m_values.data()), PixelType::float32,
                             size.width, size.height, 1)),
          m_pyramid(m_base) {}

    std::vector<float> seen_through(const Panorama& map, double tol) const {
        const int width = map.target().width(), height = map.target().height();
        std::vector<float> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1.0f);
        ReprojectOptions options;
        options.tol = tol;
        EXPECT_TRUE(reprojected_picture(map, options)
                        .draw(&m_pyramid, {0, 0, width, height},
                              packed_view(reinterpret_cast<std::byte*>(values.data()), PixelType::float32,
                                          width, height, 1)));
        return values;
    }

  private:
    std::vector<float> m_values;
    MemorySource m_base;
    Pyramid m_pyramid;
};

TEST(FootprintRays, PixelsShowTheShareOfTheSourceThatTheirRaysMeet) {
    constexpr unsigned kSeed = 7;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937_64 random(kSeed);
    int mixed = 0;
    double worst = 0, worst_by_tol = 0;
    for (int k = 0; k < 100; ++k) {
        const Scene s = strong_distortion(random);
        const Panorama map(oracle::chart_of(s.source), oracle::chart_of(s.target), s.look);
        const Ones ones({s.source.width, s.source.height});
        const std::vector<float> exact = ones.seen_through(map, 0), near = ones.seen_through(map, 0.01);
        for (int y = 0; y < s.target.height; ++y)
            for (int x = 0; x < s.target.width; ++x) {
                const Rays rays = rays_of(s, x, y);
                if (!rays.whole) continue;
                const auto at = static_cast<std::size_t>(y * s.target.width + x);
                const double a = std::fabs(double{exact[at]} - rays.mean),
                             b = std::fabs(double{near[at]} - rays.mean);
                mixed += rays.mean > 0 && rays.mean < 1;
                worst = std::max({worst, a, b});
                worst_by_tol = std::max(worst_by_tol, std::fabs(double{exact[at]} - double{near[at]}));
            }
    }
    EXPECT_GT(mixed, 1500);
    // Texels of the coarse levels that large footprints read reach over the edges of these small sources: 7 pixels differ by
    // so much. With footprints that were not their pixels' own it was 81, up to .62, and .49 between tolerances.
    // Texels of the coarse levels that large footprints read reach over the edges of these small sources. With footprints that
    // were not their pixels' own it was .55, and .49 between tolerances.
    EXPECT_LE(worst, 0.2);
    EXPECT_LE(worst_by_tol, 0.15);
}

TEST(FootprintRays, WhereAPictureEndsItsPixelsAreWhole) {
    // The source shows all directions, so that a pixel is 1 wherever its middle has a ray, however few of its parts have.
    constexpr unsigned kSeed = 8;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937_64 random(kSeed);
    const Ones ones({128, 64});
    for (int k = 0; k < 60; ++k) {
        Scene s = strong_distortion(random);
        s.source = {equirectangular, 128, 64, 360};
        const Panorama map(oracle::chart_of(s.source), oracle::chart_of(s.target), s.look);
        const Piece all{{0, 0, s.target.width, s.target.height}};
        for (const double tol : {0.0, 0.01}) {
            const std::vector<float> values = ones.seen_through(map, tol);
            Vector ray;
            for (int y = 0; y < s.target.height; ++y)
                for (int x = 0; x < s.target.width; ++x)
                    ASSERT_NEAR(values[static_cast<std::size_t>(y * s.target.width + x)],
                                oracle::ray_of(s.target, all, x + Real(0.5), y + Real(0.5), ray) ? 1 : 0,
                                1e-5)
                        << x << ' ' << y;
        }
    }
}

TEST(FootprintRays, BehindAFisheyeIsWhatStandsThere) {
    // Straight behind is all of a circle. Where the picture ends before it, nothing is seen about it; a picture of all
    // directions has it as its rim.
    constexpr int kSource = 1000, kView = 65;
    const Ones ones({kSource, kSource});
    for (const double tol : {0.0, 0.01})
        for (const double fov : {100.0, 180.0, 230.0, 360.0})
            for (const int side : {kView, kView + 1}) {
                SCOPED_TRACE(testing::Message() << "fov " << fov << " tol " << tol << " side " << side);
                const Panorama map({fisheye, kSource, kSource, fov}, {rectilinear, side, side, 20},
                                   {180, 0, 0});
                for (const float value : ones.seen_through(map, tol))
                    if (fov == 360)
                        ASSERT_NEAR(value, 1, 0.02);
                    else
                        ASSERT_EQ(value, 0);
            }
}

}  // namespace
}  // namespace anamorph::test_footprint_rays
