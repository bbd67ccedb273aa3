// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chart/chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/panorama/panorama.h"
#include "projection_cases.h"

namespace anamorph::test_chart {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr unsigned kSeed = 307;

constexpr PixelSpacing kSpacings[] = {PixelSpacing::edges, PixelSpacing::centers};

Chart chart_for(Projection projection, int n, PixelSpacing spacing, double fov = 0) {
    return test::example_chart(projection, n, spacing, fov);
}

double length(const Ray<double>& r) {
    return std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z);
}

double angle_between(const Ray<double>& a, const Ray<double>& b) {
    const Ray<double> cross{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return std::atan2(length(cross), a.x * b.x + a.y * b.y + a.z * b.z);
}

void expect_direction(const Ray<double>& ray, double x, double y, double z, double allowed = 1e-12) {
    EXPECT_LE(angle_between(ray, {x, y, z}), allowed) << ray.x << ' ' << ray.y << ' ' << ray.z;
}

TEST(Chart, PointsComeBackFromTheirRays) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    for (const Projection projection : kProjections)
        for (const PixelSpacing spacing : kSpacings)
            for (const double fov : test::fovs_of(projection)) {
                const Chart chart = chart_for(projection, 512, spacing, fov);
                int tried = 0;
                for (int i = 0; i < 2000; ++i) {
                    const int piece = static_cast<int>(random() % chart.pieces().size());
                    const Box& box = chart.pieces()[static_cast<std::size_t>(piece)].box;
                    // Between the centres of the outer pixels, as the seam is one point for two.
                    const double x =
                        std::uniform_real_distribution<double>(box.x0 + 0.6, box.x1 - 0.6)(random);
                    const double y =
                        std::uniform_real_distribution<double>(box.y0 + 0.6, box.y1 - 0.6)(random);
                    if (!(chart.inside(x, y, piece) > 1e-3)) continue;
                    ++tried;
                    const Ray<double> ray = chart.ray(x, y, piece);
                    // Two fisheyes of more than 180 degrees show the same twice.
                    if (!(chart.sees(chart.local_ray(x, y, chart.branch(piece)), piece) > 0)) continue;
                    ASSERT_EQ(chart.piece_of(ray), piece);
                    const Point<double> p = chart.point(ray, piece);
                    // Near the poles of a sphere, or the rim of a fisheye, a ray pins its point less sharply.
                    ASSERT_NEAR(p.x, x, 1e-7)
                        << name_of(projection) << " fov " << fov << " at " << x << ' ' << y;
                    ASSERT_NEAR(p.y, y, 1e-7)
                        << name_of(projection) << " fov " << fov << " at " << x << ' ' << y;
                }
                EXPECT_GT(tried, 200) << name_of(projection) << ' ' << fov;
            }
}

TEST(Chart, RaysComeBackFromTheirPoints) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::normal_distribution<double> normal;
    for (const Projection projection : kProjections)
        for (const PixelSpacing spacing : kSpacings) {
            const Chart chart = chart_for(projection, 512, spacing);
            for (int i = 0; i < 2000; ++i) {
                const Ray<double> ray{normal(random), normal(random), normal(random)};
                const int piece = chart.piece_of(ray);
                if (piece == 0 && !(chart.sees(ray) > 0.01) && !has_faces(projection)) continue;
                const Point<double> p = chart.point(ray, piece);
                ASSERT_LE(angle_between(chart.ray(p.x, p.y, piece), ray), 1e-9) << name_of(projection);
            }
        }
}

TEST(Chart, DoubleAgreesWithLongDouble) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::normal_distribution<double> normal;
    for (const Projection projection : kProjections) {
        const Chart chart = chart_for(projection, 8192, PixelSpacing::edges);
        for (int i = 0; i < 2000; ++i) {
            const Ray<double> ray{normal(random), normal(random), normal(random)};
            // Where the scale of the chart does not explode.
            if (ray.z < 0.05 * length(ray) && !has_faces(projection)) continue;
            const Ray<DoubleDouble> precise{ray.x, ray.y, ray.z};
            const int piece = chart.piece_of(ray);
            ASSERT_EQ(chart.piece_of(precise), piece);
            const Point<double> p = chart.point(ray, piece);
            const Point<DoubleDouble> q = chart.point(precise, piece);
            ASSERT_NEAR(p.x, static_cast<double>(q.x), 1e-8) << name_of(projection);
            ASSERT_NEAR(p.y, static_cast<double>(q.y), 1e-8) << name_of(projection);
        }
    }
}

TEST(Chart, LocalFormulasAgreeWithThoseAroundStraightAhead) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> near(-0.3, 0.3);
    for (const Projection projection : kProjections) {
        const Chart chart = chart_for(projection, 256, PixelSpacing::edges);
        for (int i = 0; i < 2000; ++i) {
            const int piece = static_cast<int>(random() % chart.pieces().size());
            const Box& box = chart.pieces()[static_cast<std::size_t>(piece)].box;
            const double x = std::uniform_real_distribution<double>(box.x0, box.x1)(random);
            const double y = std::uniform_real_distribution<double>(box.y0 + 1, box.y1 - 1)(random);
            if (!(chart.inside(x, y, piece) > 1e-3)) continue;
            const Branch branch = chart.branch_around(x, y, piece);
            ASSERT_EQ(branch.piece, piece);
            const double u = x + near(random), v = y + near(random);
            const Ray<double> local = chart.local_ray(u, v, branch);
            // The quarters of an octahedron end where they meet.
            if (projection == Projection::octahedral && !(chart.sees(local, piece) > 0)) continue;
            ASSERT_LE(angle_between(transform(branch.axes, local), chart.ray(u, v, piece)), 1e-12)
                << name_of(projection);
            // Also across the seam, where the point of a single ray jumps by the width.
            const Point<double> p = chart.local_point(local, branch);
            ASSERT_NEAR(p.x, u, 1e-8) << name_of(projection) << ' ' << x << ' ' << y;
            ASSERT_NEAR(p.y, v, 1e-8) << name_of(projection) << ' ' << x << ' ' << y;
        }
    }
}

TEST(Chart, FieldOfViewRunsFromEdgeToEdge) {
    for (const Projection projection : kProjections) {
        if (has_faces(projection)) continue;
        for (const PixelSpacing spacing : kSpacings)
            for (const double fov : test::fovs_of(projection)) {
                const Chart chart(projection, 300, 200, fov, spacing);
                EXPECT_EQ(chart.fov(), fov);
                const double edge = spacing == PixelSpacing::edges ? 0 : 0.5;
                for (const double side : {-1.0, 1.0}) {
                    const Ray<double> ray = chart.ray(side < 0 ? edge : 300 - edge, 100.0);
                    EXPECT_NEAR(ray.y, 0, 1e-12);
                    // The angle from the middle's ray, of half the field of view.
                    const double half = fov / 2 * kPi / 180;
                    const double ahead = projection == Projection::mirror_ball ? -ray.z : ray.z;
                    EXPECT_NEAR(std::fabs(std::atan2(ray.x, ahead)), half, 1e-12 + 1e-9 * half)
                        << name_of(projection) << ' ' << fov;
                    if (fov < 360) {
                        EXPECT_GT(ray.x * side, 0);
                    }
                }
            }
    }
}

TEST(Chart, DefaultFieldsOfView) {
    const auto fov = [](Projection projection) {
        return chart_for(projection, 8, PixelSpacing::edges).fov();
    };
    for (const Projection p : {Projection::equirectangular, Projection::cylindrical, Projection::mercator})
        EXPECT_EQ(fov(p), 360);
    for (const Projection p : {Projection::fisheye, Projection::equisolid, Projection::stereographic})
        EXPECT_EQ(fov(p), 180);
    for (const Projection p :
         {Projection::rectilinear, Projection::cubemap, Projection::cubemap3x2, Projection::cubecross})
        EXPECT_EQ(fov(p), 90);
}

TEST(Chart, TheMiddleLooksAheadRightIsRightAndDownIsDown) {
    for (const Projection projection : kProjections) {
        if (has_faces(projection)) continue;
        for (const PixelSpacing spacing : kSpacings) {
            const Chart chart(projection, 300, 200, 80, spacing);
            // But for the ball, which shows the camera there.
            const double ahead = projection == Projection::mirror_ball ? -1 : 1;
            expect_direction(chart.ray(150.0, 100.0), 0, 0, ahead);
            const Point<double> p = chart.point(Ray<double>{0, 0, 5 * ahead}, 0);
            EXPECT_NEAR(p.x, 150, 1e-12);
            EXPECT_NEAR(p.y, 100, 1e-12);
            EXPECT_GT(chart.ray(160.0, 100.0).x, 0);
            EXPECT_GT(chart.ray(150.0, 110.0).y, 0);
            EXPECT_LT(chart.ray(150.0, 90.0).y, 0);
            // Square pixels at the centre.
            const double step = 1e-3;
            const double across = angle_between(chart.ray(150 + step, 100.0), chart.ray(150.0, 100.0));
            const double down = angle_between(chart.ray(150.0, 100 + step), chart.ray(150.0, 100.0));
            EXPECT_NEAR(down / across, spacing == PixelSpacing::edges ? 1 : 299.0 / 300 * 200 / 199, 1e-6)
                << name_of(projection);
        }
    }
}

TEST(Chart, LensFormulas) {
    const auto plane = [](Projection projection, const Ray<double>& ray) {
        const Chart chart(projection, 400, 400, 100);
        const Point<double> p = chart.point(ray, 0);
        return Point<double>{(p.x - 200) / chart.scale_x(), (p.y - 200) / chart.scale_y()};
    };
    // Azimuth 50 degrees, elevation 35 degrees down.
    const double a = 50 * kPi / 180, e = 35 * kPi / 180;
    const Ray<double> ray{std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)};
    const double t = std::acos(ray.z), k = 1 / std::hypot(ray.x, ray.y);
    const auto expect = [&](Projection projection, double x, double y) {
        const Point<double> p = plane(projection, {3 * ray.x, 3 * ray.y, 3 * ray.z});
        EXPECT_NEAR(p.x, x, 1e-12) << name_of(projection);
        EXPECT_NEAR(p.y, y, 1e-12) << name_of(projection);
    };
    expect(Projection::rectilinear, ray.x / ray.z, ray.y / ray.z);
    expect(Projection::equirectangular, a, e);
    expect(Projection::cylindrical, a, std::tan(e));
    expect(Projection::mercator, a, std::log(std::tan(kPi / 4 + e / 2)));
    expect(Projection::fisheye, t * ray.x * k, t * ray.y * k);
    expect(Projection::equisolid, 2 * std::sin(t / 2) * ray.x * k, 2 * std::sin(t / 2) * ray.y * k);
    expect(Projection::stereographic, 2 * std::tan(t / 2) * ray.x * k, 2 * std::tan(t / 2) * ray.y * k);
    expect(Projection::orthographic, std::sin(t) * ray.x * k, std::sin(t) * ray.y * k);
    expect(Projection::sinusoidal, a * std::cos(e), e);
    const double hammer = std::sqrt(2 / (1 + std::cos(e) * std::cos(a / 2)));
    expect(Projection::hammer, 2 * hammer * std::cos(e) * std::sin(a / 2), hammer * std::sin(e));
    expect(Projection::pannini, 2 * std::tan(a / 2), 2 / (1 + std::cos(a)) * std::tan(e));
    // Of d = 1, which is beta and xi, and e = 1/2, which is their alpha.
    expect(Projection::eucm, 2 * std::tan(t / 2) * ray.x * k, 2 * std::tan(t / 2) * ray.y * k);
    expect(Projection::double_sphere, 4 * std::tan(t / 4) * ray.x * k, 4 * std::tan(t / 4) * ray.y * k);
}

// EUCM with beta = 1 and the double sphere model with xi = 0 are the unified model with its xi = alpha / (1 - alpha).
TEST(Chart, ModelsOfSpheresMeet) {
    for (const double alpha : {0.0, 0.25, 0.5, 0.75}) {
        const auto chart = [](Projection projection, const Distance& d) {
            return Chart(projection, 600, 400, 110, PixelSpacing::edges, "", d);
        };
        const Chart unified = chart(Projection::unified, alpha / (1 - alpha)),
                    others[] = {chart(Projection::eucm, {1, alpha}),
                                chart(Projection::double_sphere, {0, alpha})};
        for (const Chart& other : others)
            for (const double x : {3.0, 250.5, 599.0})
                for (const double y : {1.0, 220.0}) {
                    const Ray<DoubleDouble> there = unified.ray<DoubleDouble>(x, y);
                    const Point<DoubleDouble> p = other.point(there, 0);
                    // alpha / (1 - alpha) of 3/4 and 1/4 is 3 and 1/3, rounded.
                    EXPECT_NEAR(static_cast<double>(p.x - x), 0, 1e-13) << name_of(other.projection());
                    EXPECT_NEAR(static_cast<double>(p.y - y), 0, 1e-13) << name_of(other.projection());
                }
    }
}

TEST(Chart, NumbersOfProjectionsAreTheirs) {
    const auto refused = [](Projection projection, double d, double e) -> std::string {
        try {
            static_cast<void>(Chart(projection, 60, 40, 80, PixelSpacing::edges, "src", {d, e}));
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refused(Projection::eucm, 1000, 1), "");
    EXPECT_EQ(refused(Projection::eucm, 0.001, 0), "");
    EXPECT_EQ(refused(Projection::double_sphere, -0.999, 0.5), "");
    EXPECT_EQ(refused(Projection::double_sphere, 1, 1), "");
    EXPECT_EQ(refused(Projection::rectilinear, -0.999, 1), "");
    EXPECT_EQ(refused(Projection::eucm, 0, 1), "srcd=0: must be from 0.001 to 1000 for eucm");
    EXPECT_EQ(refused(Projection::eucm, 1, 1.01), "srce=1.01: must be from 0 to 1 for eucm");
    EXPECT_EQ(refused(Projection::double_sphere, 1.01, 0.5),
              "srcd=1.01: must be from -0.999 to 1 for double_sphere");
    EXPECT_EQ(refused(Projection::double_sphere, 0, NAN), "srce=nan: must be from 0 to 1 for double_sphere");
    EXPECT_EQ(refused(Projection::unified, -0.5, 0.5), "srcd=-0.5: must be from 0 to 1000 for unified");
    EXPECT_EQ(refused(Projection::unified, 1001, 0.5), "srcd=1001: must be from 0 to 1000 for unified");
}

TEST(Chart, APanoramasCornersAndPoles) {
    const Chart chart(Projection::equirectangular, 8, 4);
    EXPECT_TRUE(chart.closed());
    EXPECT_TRUE(chart.reaches_poles());
    EXPECT_EQ(chart.period(), 8);
    for (const double x : {0.0, 3.0, 8.0}) {
        expect_direction(chart.ray(x, 0.0), 0, -1, 0);
        expect_direction(chart.ray(x, 4.0), 0, 1, 0);
    }
    expect_direction(chart.ray(0.0, 2.0), 0, 0, -1);
    expect_direction(chart.ray(8.0, 2.0), 0, 0, -1);
    expect_direction(chart.ray(6.0, 2.0), 1, 0, 0);
    expect_direction(chart.ray(2.0, 2.0), -1, 0, 0);
    EXPECT_GE(chart.inside(1.0, 0.0), 0);
    EXPECT_LT(chart.inside(1.0, -0.01), 0);
    EXPECT_LT(chart.inside(1.0, 4.01), 0);

    const Chart centers(Projection::equirectangular, 9, 5, 0, PixelSpacing::centers);
    EXPECT_TRUE(centers.closed());
    EXPECT_EQ(centers.period(), 8);
    expect_direction(centers.ray(0.5, 2.5), 0, 0, -1);
    expect_direction(centers.ray(8.5, 2.5), 0, 0, -1);
    const Chart poles(Projection::equirectangular, 10, 5, 0, PixelSpacing::centers);
    EXPECT_TRUE(poles.reaches_poles());
    expect_direction(poles.ray(3.5, 0.5), 0, -1, 0);
    expect_direction(poles.ray(3.5, 4.5), 0, 1, 0);

    EXPECT_FALSE(Chart(Projection::equirectangular, 8, 4, 359).closed());
    EXPECT_FALSE(Chart(Projection::equirectangular, 8, 3).reaches_poles());
    EXPECT_FALSE(Chart(Projection::cylindrical, 8, 4).reaches_poles());
    EXPECT_TRUE(Chart(Projection::mercator, 8, 4).closed());
    EXPECT_FALSE(Chart(Projection::fisheye, 8, 4, 360).closed());
}

TEST(Chart, FisheyesEndWhereTheSphereDoes) {
    const Chart fisheye(Projection::fisheye, 100, 100, 360), equisolid(Projection::equisolid, 100, 100, 360);
    for (const Chart& chart : {fisheye, equisolid}) {
        EXPECT_GE(chart.inside(0.0, 50.0), 0);
        EXPECT_GE(chart.inside(50.0, 100.0), 0);
        EXPECT_LT(chart.inside(2.0, 2.0), 0);
        // All of the rim looks straight back.
        expect_direction(chart.ray(100.0, 50.0), 0, 0, -1, 1e-7);
        expect_direction(chart.ray(50.0, 0.0), 0, 0, -1, 1e-7);
        expect_direction(chart.ray(50.0, 50.0), 0, 0, 1);
    }
    EXPECT_GE(Chart(Projection::stereographic, 100, 100, 350).inside(0.0, 0.0), 0);
}

// OpenEXR's environment map: faces +X, -X, +Y, -Y, +Z, -Z from top to bottom; its X axis points to our left
// and its Y axis up, its Z axis ahead.
TEST(Chart, TheCubemapIsOpenExrs) {
    const Chart chart(Projection::cubemap, 10, 60);
    const auto exr = [](double x, double y, double z) { return Ray<double>{-x, -y, z}; };
    struct Face {
        Ray<double> centre, right, down;  ///< in our frame
    };
    const Face faces[] = {
        {exr(1, 0, 0), exr(0, 0, 1), exr(0, -1, 0)},  {exr(-1, 0, 0), exr(0, 0, -1), exr(0, -1, 0)},
        {exr(0, 1, 0), exr(1, 0, 0), exr(0, 0, -1)},  {exr(0, -1, 0), exr(1, 0, 0), exr(0, 0, 1)},
        {exr(0, 0, 1), exr(-1, 0, 0), exr(0, -1, 0)}, {exr(0, 0, -1), exr(1, 0, 0), exr(0, -1, 0)}};
    for (int i = 0; i < 6; ++i) {
        const Face& f = faces[i];
        const double x = 5, y = 10 * i + 5;
        expect_direction(chart.ray(x, y, i), f.centre.x, f.centre.y, f.centre.z);
        expect_direction(chart.ray(10.0, y, i), f.centre.x + f.right.x, f.centre.y + f.right.y,
                         f.centre.z + f.right.z);
        expect_direction(chart.ray(x, y + 5, i), f.centre.x + f.down.x, f.centre.y + f.down.y,
                         f.centre.z + f.down.z);
        EXPECT_EQ(chart.piece_of(f.centre), i);
    }
}

TEST(Chart, OtherCubesStandUpright) {
    const auto looks = [](const Chart& chart, double column, double row) {
        const int n = chart.pieces()[0].box.width();
        for (int i = 0; i < 6; ++i) {
            const Box& box = chart.pieces()[static_cast<std::size_t>(i)].box;
            if (box.x0 == column * n && box.y0 == row * n)
                return chart.ray((column + 0.5) * n, (row + 0.5) * n, i);
        }
        return Ray<double>{0, 0, 0};
    };
    const Chart six(Projection::cubemap3x2, 12, 8), cross(Projection::cubecross, 16, 12);
    expect_direction(looks(six, 0, 0), 1, 0, 0);
    expect_direction(looks(six, 1, 0), -1, 0, 0);
    expect_direction(looks(six, 2, 0), 0, -1, 0);
    expect_direction(looks(six, 0, 1), 0, 1, 0);
    expect_direction(looks(six, 1, 1), 0, 0, 1);
    expect_direction(looks(six, 2, 1), 0, 0, -1);
    expect_direction(looks(cross, 1, 0), 0, -1, 0);
    expect_direction(looks(cross, 0, 1), -1, 0, 0);
    expect_direction(looks(cross, 1, 1), 0, 0, 1);
    expect_direction(looks(cross, 2, 1), 1, 0, 0);
    expect_direction(looks(cross, 3, 1), 0, 0, -1);
    expect_direction(looks(cross, 1, 2), 0, 1, 0);
    // In the cross, faces that touch in the picture meet there.
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) {
            const Box &a = cross.pieces()[static_cast<std::size_t>(i)].box,
                      &b = cross.pieces()[static_cast<std::size_t>(j)].box;
            for (const double t : {0.3, 2.0, 3.9}) {
                if (a.x1 == b.x0 && a.y0 == b.y0) {
                    EXPECT_LE(angle_between(cross.ray<double>(a.x1, a.y0 + t, i),
                                            cross.ray<double>(b.x0, b.y0 + t, j)),
                              1e-12);
                }
                if (a.y1 == b.y0 && a.x0 == b.x0) {
                    EXPECT_LE(angle_between(cross.ray<double>(a.x0 + t, a.y1, i),
                                            cross.ray<double>(b.x0 + t, b.y0, j)),
                              1e-12);
                }
            }
        }
}

TEST(Chart, ALocalRayIsSeenByItsFaceAlone) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::normal_distribution<double> normal;
    const Chart chart(Projection::cubemap3x2, 24, 16);
    for (int i = 0; i < 1000; ++i) {
        const Ray<double> ray{normal(random), normal(random), normal(random)};
        int seen = 0;
        for (int piece = 0; piece < 6; ++piece) {
            const Ray<double> local = transform(glm::transpose(chart.branch(piece).axes), ray);
            if (!(chart.sees(local) > 0)) continue;
            ++seen;
            EXPECT_EQ(chart.piece_of(ray), piece);
            const Point<double> p = chart.local_point(local, chart.branch(piece));
            const Box& box = chart.pieces()[static_cast<std::size_t>(piece)].box;
            EXPECT_TRUE(p.x >= box.x0 && p.x <= box.x1 && p.y >= box.y0 && p.y <= box.y1);
        }
        EXPECT_EQ(seen, 1);
    }
}

TEST(Chart, NamesOfProjections) {
    for (const Projection projection : kProjections) {
        EXPECT_EQ(projection_from_name(name_of(projection)), projection);
        EXPECT_THAT(projection_names(), HasSubstr(std::string(name_of(projection))));
    }
    EXPECT_EQ(projection_from_name("latlong"), Projection::equirectangular);
    for (const char* bad : {"", "Equirectangular", "cube", "latlong "}) try {
            projection_from_name(bad, "to");
            ADD_FAILURE() << bad;
        } catch (const Error& e) {
            EXPECT_EQ(e.parameter(), "to");
            EXPECT_THAT(e.what(), HasSubstr("to=" + std::string(bad) + ":"));
            EXPECT_THAT(e.what(), HasSubstr("stereographic"));
        }
}

struct Refused {
    Projection projection;
    int width, height;
    double fov;
    PixelSpacing spacing;
    const char *parameter, *value, *allowed;
};

TEST(Chart, ErrorsNameTheParameterItsValueAndWhatIsAllowed) {
    constexpr PixelSpacing kEdges = PixelSpacing::edges, kCenters = PixelSpacing::centers;
    const Refused cases[] = {
        {Projection::rectilinear, 10, 10, 180, kEdges, "srcfov", "180", "below 180"},
        {Projection::rectilinear, 10, 10, -5, kEdges, "srcfov", "-5", "above 0"},
        {Projection::equirectangular, 10, 10, 360.5, kEdges, "srcfov", "360.5", "up to 360"},
        {Projection::stereographic, 10, 10, 360, kEdges, "srcfov", "360", "below 360"},
        {Projection::fisheye, 10, 10, kNan, kEdges, "srcfov", "nan", "up to 360"},
        {Projection::cylindrical, 10, 10, kInfinity, kEdges, "srcfov", "inf", "up to 360"},
        {Projection::mercator, 10, 10, -kInfinity, kEdges, "srcfov", "-inf", "up to 360"},
        {Projection::cubemap, 10, 60, 80, kEdges, "srcfov", "80", "90 degrees"},
        {Projection::cubemap, 10, 60, kNan, kEdges, "srcfov", "nan", "90 degrees"},
        {Projection::cubemap, 10, 59, 0, kEdges, "source size", "10x59", "6 down"},
        {Projection::cubemap3x2, 30, 22, 0, kEdges, "source size", "30x22", "3 across"},
        {Projection::cubecross, 10, 10, 0, kEdges, "source size", "10x10", "square"},
        {Projection::rectilinear, 0, 10, 0, kEdges, "source size", "0x10", "1x1"},
        {Projection::rectilinear, 10, -3, 0, kEdges, "source size", "10x-3", "1x1"},
        {Projection::rectilinear, 1 << 25, 10, 0, kEdges, "source size", "33554432x10", "16777216"},
        {Projection::equirectangular, 1, 10, 0, kCenters, "source size", "1x10", "at least 2"},
        {Projection::cubemap, 1, 6, 0, kCenters, "source size", "1x6", "at least 2"},
    };
    for (const Refused& c : cases) try {
            Chart(c.projection, c.width, c.height, c.fov, c.spacing, "src");
            ADD_FAILURE() << c.parameter << '=' << c.value;
        } catch (const Error& e) {
            EXPECT_EQ(e.parameter(), c.parameter);
            EXPECT_THAT(e.what(), testing::StartsWith(std::string(c.parameter) + "=" + c.value + ":"));
            EXPECT_THAT(e.what(), HasSubstr(c.allowed));
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        }
}

TEST(Chart, WhatIsNoNumberGivesNone) {
    for (const Projection projection : kProjections) {
        const Chart chart = chart_for(projection, 16, PixelSpacing::edges);
        for (const double bad : {kNan, kInfinity, -kInfinity}) {
            const Ray<double> ray = chart.ray(bad, 3.0);
            EXPECT_FALSE(std::isfinite(ray.x + ray.y + ray.z)) << name_of(projection);
            for (const Ray<double>& r :
                 {Ray<double>{bad, 1, 1}, Ray<double>{1, bad, 1}, Ray<double>{1, 1, bad}}) {
                const int piece = chart.piece_of(r);
                ASSERT_GE(piece, 0);
                ASSERT_LT(piece, static_cast<int>(chart.pieces().size()));
                const Point<double> p = chart.point(r, piece);
                if (std::isnan(bad)) {
                    EXPECT_TRUE(std::isnan(p.x + p.y)) << name_of(projection);
                }
                const Branch branch = chart.branch_around(r);
                EXPECT_TRUE(std::isfinite(branch.around.angle + branch.along.angle));
            }
        }
    }
}

// --- the camera
// ----------------------------------------------------------------------------------------------------

Ray<double> turned(const Orientation& orientation, double x, double y, double z) {
    return transform(rotation(orientation), Ray<double>{x, y, z});
}

TEST(Orientation, YawIsToTheRightPitchUpRollClockwise) {
    expect_direction(turned({90, 0, 0}, 0, 0, 1), 1, 0, 0);
    expect_direction(turned({-90, 0, 0}, 0, 0, 1), -1, 0, 0);
    expect_direction(turned({180, 0, 0}, 0, 0, 1), 0, 0, -1);
    expect_direction(turned({0, 90, 0}, 0, 0, 1), 0, -1, 0);
    expect_direction(turned({0, -90, 0}, 0, 0, 1), 0, 1, 0);
    // The camera's right side sinks when it rolls clockwise.
    expect_direction(turned({0, 0, 90}, 1, 0, 0), 0, 1, 0);
    expect_direction(turned({0, 0, 90}, 0, 0, 1), 0, 0, 1);
    // Rolled first, then pitched, then turned.
    const double d = kPi / 180;
    expect_direction(turned({40, 25, 77}, 0, 0, 1), std::sin(40 * d) * std::cos(25 * d), -std::sin(25 * d),
                     std::cos(40 * d) * std::cos(25 * d));
    expect_direction(turned({40, 25, 0}, 1, 0, 0), std::cos(40 * d), 0, -std::sin(40 * d));
    expect_direction(turned({0, 90, 90}, 1, 0, 0), 0, 0, 1);
}

TEST(Orientation, IsARotation) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> angle(-720, 720);
    for (int i = 0; i < 200; ++i) {
        const glm::dmat3 m = rotation({angle(random), angle(random), angle(random)});
        const glm::dmat3 unit = m * glm::transpose(m);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) EXPECT_NEAR(unit[a][b], a == b ? 1 : 0, 1e-14);
        EXPECT_NEAR(glm::determinant(m), 1, 1e-14);
    }
}

TEST(Panorama, AViewLooksWhereItIsTurned) {
    const Chart source(Projection::equirectangular, 3600, 1800), target(Projection::rectilinear, 200, 200);
    const auto centre = [&](const Orientation& orientation) {
        Point<double> p{};
        int piece = -1;
        EXPECT_TRUE(Panorama(source, target, orientation).exact(100.0, 100.0, 0, p, piece));
        EXPECT_EQ(piece, 0);
        return p;
    };
    // Ten pixels a degree from the middle.
    EXPECT_NEAR(centre({0, 0, 0}).x, 1800, 1e-9);
    EXPECT_NEAR(centre({30, 0, 0}).x, 2100, 1e-9);
    EXPECT_NEAR(centre({-30, 0, 0}).x, 1500, 1e-9);
    EXPECT_NEAR(centre({0, 20, 0}).y, 700, 1e-9);
    EXPECT_NEAR(centre({30, -20, 50}).y, 1100, 1e-9);
    EXPECT_NEAR(centre({30, -20, 50}).x, 2100, 1e-9);
    // The right edge of a 90-degree view is 45 degrees to the right; rolled clockwise, 45 degrees down.
    Point<double> p{};
    int piece = 0;
    ASSERT_TRUE(Panorama(source, target).exact(200.0, 100.0, 0, p, piece));
    EXPECT_NEAR(p.x, 2250, 1e-9);
    ASSERT_TRUE(Panorama(source, target, {0, 0, 90}).exact(200.0, 100.0, 0, p, piece));
    EXPECT_NEAR(p.x, 1800, 1e-9);
    EXPECT_NEAR(p.y, 1350, 1e-9);
}

TEST(Panorama, LocalMapsAgreeWithTheExactOne) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> angle(-180, 180);
    for (const Projection from : kProjections)
        for (const Projection to : kProjections)
            for (int view = 0; view < 4; ++view) {
                const Chart source = chart_for(from, 256, PixelSpacing::edges);
                const Chart target =
                    chart_for(to, 64, view % 2 ? PixelSpacing::centers : PixelSpacing::edges);
                const Panorama map(source, target, {angle(random), angle(random) / 2, angle(random)});
                for (int i = 0; i < 40; ++i) {
                    const int piece = static_cast<int>(random() % target.pieces().size());
                    const Box& box = target.pieces()[static_cast<std::size_t>(piece)].box;
                    const double x = std::uniform_real_distribution<double>(box.x0, box.x1)(random);
                    const double y = std::uniform_real_distribution<double>(box.y0, box.y1)(random);
                    Point<double> exact{};
                    int source_piece = 0;
                    if (!map.exact(x, y, piece, exact, source_piece)) continue;
                    const Panorama::Local local = map.local_around(x, y, piece);
                    ASSERT_EQ(local.source.piece, source_piece);
                    Point<double> p = map(x, y, local);
                    if (source.closed())
                        p.x -= std::round((p.x - exact.x) / source.period()) * source.period();
                    // Near a singularity of the source's chart coordinates run away together.
                    const double allowed = 1e-9 * (1 + std::fabs(exact.x) + std::fabs(exact.y));
                    ASSERT_NEAR(p.x, exact.x, 100 * allowed) << name_of(from) << " to " << name_of(to);
                    ASSERT_NEAR(p.y, exact.y, 100 * allowed) << name_of(from) << " to " << name_of(to);
                }
            }
}

TEST(Panorama, WhatTheSourceDoesNotSeeHasNoPoint) {
    Point<double> p{};
    int piece = 0;
    const Chart flat(Projection::rectilinear, 100, 100), view(Projection::rectilinear, 100, 100);
    EXPECT_TRUE(Panorama(flat, view, {80, 0, 0}).exact(50.0, 50.0, 0, p, piece));
    EXPECT_FALSE(Panorama(flat, view, {100, 0, 0}).exact(50.0, 50.0, 0, p, piece));
    EXPECT_FALSE(Panorama(flat, view, {180, 0, 0}).exact(50.0, 50.0, 0, p, piece));
    // The corner of a full fisheye shows nothing.
    EXPECT_FALSE(Panorama(flat, Chart(Projection::fisheye, 100, 100, 360)).exact(1.0, 1.0, 0, p, piece));
    for (const double bad : {kNan, kInfinity}) {
        EXPECT_FALSE(Panorama(flat, view).exact(bad, 3.0, 0, p, piece));
        EXPECT_FALSE(Panorama(flat, view).exact(3.0, bad, 0, p, piece));
    }
    // The pole of a cylinder is infinitely far.
    EXPECT_FALSE(Panorama(Chart(Projection::cylindrical, 100, 100), Chart(Projection::equirectangular, 8, 4),
                          {0, 0, 0})
                     .exact(4.0, -1.0, 0, p, piece));
}

TEST(Panorama, RefusesAnglesThatAreNoNumbers) {
    const Chart chart(Projection::equirectangular, 8, 4);
    const std::pair<Orientation, const char*> cases[] = {
        {{kNan, 0, 0}, "yaw"}, {{0, kInfinity, 0}, "pitch"}, {{0, 0, -kInfinity}, "roll"}};
    for (const auto& [orientation, name] : cases) try {
            Panorama(chart, chart, orientation);
            ADD_FAILURE() << name;
        } catch (const Error& e) {
            EXPECT_EQ(e.parameter(), name);
            EXPECT_THAT(e.what(), HasSubstr("finite"));
        }
}

}  // namespace
}  // namespace anamorph::test_chart
