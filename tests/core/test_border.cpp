// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/border.h"
#include "projection_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <ostream>
#include <tuple>
#include <vector>

namespace anamorph {

static bool operator==(const Texel& a, const Texel& b) {
    return a.none == b.none && (a.none || (a.x == b.x && a.y == b.y));
}
static void PrintTo(const Texel& t, std::ostream* out) {
    *out << (t.none ? "none " : "") << t.x << ',' << t.y;
}
static void PrintTo(const Box& b, std::ostream* out) {
    *out << b.x0 << ',' << b.y0 << ',' << b.x1 << ',' << b.y1;
}

}  // namespace anamorph

namespace anamorph::test_border {
namespace {

constexpr Texel kNone{0, 0, true};
constexpr std::int64_t kExtremes[] = {std::numeric_limits<std::int64_t>::min(),
                                      std::numeric_limits<std::int64_t>::max(),
                                      std::numeric_limits<std::int64_t>::min() + 1,
                                      std::numeric_limits<std::int32_t>::min(),
                                      std::numeric_limits<std::int32_t>::max(),
                                      -1'000'000'007,
                                      1'000'000'007,
                                      -1,
                                      0,
                                      5};

Chart chart_for(Projection projection, int n, PixelSpacing spacing = PixelSpacing::edges) {
    return test::example_chart(projection, n, spacing);
}

constexpr Projection kCubes[] = {Projection::cubemap, Projection::cubemap3x2, Projection::cubecross};

TEST(Border, TexelsInsideStandForThemselvesAndAllOthersLieInside) {
    for (const Projection projection : kProjections)
        for (const PixelSpacing spacing : {PixelSpacing::edges, PixelSpacing::centers})
            for (const Wrap wrap : {Wrap::automatic, Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror})
                for (const int divisor : {1, 2, 4, 5}) {
                    const Chart chart = chart_for(projection, 20, spacing);
                    const Border border(chart, wrap);
                    const Size level{chart.width() / divisor, chart.height() / divisor};
                    for (int piece = 0; piece < static_cast<int>(chart.pieces().size()); ++piece) {
                        const Box box = border.interior(piece, level);
                        for (int y = box.y0 - 6; y < box.y1 + 6; ++y)
                            for (int x = box.x0 - 6; x < box.x1 + 6; ++x) {
                                const Texel texel = border.resolve(x, y, piece, level);
                                const bool inside = x >= box.x0 && x < box.x1 && y >= box.y0 && y < box.y1;
                                if (inside) {
                                    ASSERT_EQ(texel, (Texel{x, y}));
                                } else if (wrap != Wrap::automatic) {
                                    ASSERT_EQ(texel.none, wrap == Wrap::black);
                                }
                                ASSERT_TRUE(texel.none || (texel.x >= 0 && texel.x < level.width &&
                                                           texel.y >= 0 && texel.y < level.height));
                            }
                        for (const std::int64_t y : kExtremes)
                            for (const std::int64_t x : kExtremes) {
                                const Texel texel = border.resolve(x, y, piece, level);
                                ASSERT_TRUE(texel.none || (texel.x >= 0 && texel.x < level.width &&
                                                           texel.y >= 0 && texel.y < level.height));
                            }
                    }
                }
}

TEST(Border, RunsAreWhatResolvesTexelByTexel) {
    for (const Projection projection : kProjections)
        for (const PixelSpacing spacing : {PixelSpacing::edges, PixelSpacing::centers})
            for (const Wrap wrap :
                 {Wrap::automatic, Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror}) {
                const Chart chart = chart_for(projection, 10, spacing);
                const Border border(chart, wrap);
                const Size level{chart.width(), chart.height()};
                const int piece = static_cast<int>(chart.pieces().size()) - 1;
                const Box box = border.interior(piece, level);
                for (const int limit : {1, 7, 100})
                    for (int y = box.y0 - 25; y < box.y1 + 25; ++y)
                        for (int x = box.x0 - 45; x < box.x1 + 45; ++x) {
                            const TexelRun run = border.resolve_run(x, y, piece, level, limit);
                            ASSERT_GE(run.count, 1);
                            ASSERT_LE(run.count, limit);
                            for (int k = 0; k < run.count; ++k)
                                ASSERT_EQ(border.resolve(x + k, y, piece, level),
                                          (Texel{run.first.x + k, run.first.y, run.first.none}));
                        }
                for (const std::int64_t y : kExtremes)
                    for (const std::int64_t x : kExtremes)
                        ASSERT_GE(border.resolve_run(x, y, piece, level, 1 << 20).count, 1);
            }
    // A row of a panorama is one run on either side of the seam.
    const Chart chart(Projection::equirectangular, 16, 8);
    EXPECT_EQ(Border(chart, Wrap::automatic).resolve_run(-5, 3, 0, Size{16, 8}, 100).count, 5);
    EXPECT_EQ(Border(chart, Wrap::automatic).resolve_run(0, 3, 0, Size{16, 8}, 100).count, 16);
    EXPECT_EQ(Border(chart, Wrap::automatic).resolve_run(0, -1, 0, Size{16, 8}, 100).count, 8);
}

TEST(Border, OddAndTinyLevelsAreSafe) {
    for (const Projection projection : kProjections)
        for (const PixelSpacing spacing : {PixelSpacing::edges, PixelSpacing::centers})
            for (const Size level : {Size{1, 1}, {2, 1}, {1, 2}, {3, 7}, {5, 3}}) {
                const Chart chart = chart_for(projection, 16, spacing);
                const Border border(chart, Wrap::automatic);
                for (int piece = 0; piece < static_cast<int>(chart.pieces().size()); ++piece) {
                    ASSERT_FALSE(border.interior(piece, level).empty());
                    for (int y = -9; y < 9; ++y)
                        for (int x = -9; x < 9; ++x) {
                            const Texel texel = border.resolve(x, y, piece, level);
                            ASSERT_TRUE(texel.none || (texel.x >= 0 && texel.x < level.width &&
                                                       texel.y >= 0 && texel.y < level.height));
                        }
                }
            }
}

TEST(Border, PlainModesAreOpenImageIOs) {
    const Chart chart(Projection::rectilinear, 4, 3);
    const Size level{4, 3};
    const auto row = [&](Wrap wrap) {
        std::vector<int> columns;
        for (int x = -6; x < 10; ++x) columns.push_back(Border(chart, wrap).resolve(x, 1, 0, level).x);
        return columns;
    };
    EXPECT_EQ(row(Wrap::clamp), (std::vector<int>{0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 3, 3, 3, 3, 3, 3}));
    EXPECT_EQ(row(Wrap::periodic), (std::vector<int>{2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1}));
    EXPECT_EQ(row(Wrap::mirror), (std::vector<int>{2, 3, 3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0, 0, 1}));
    EXPECT_EQ(Border(chart, Wrap::black).resolve(-1, 1, 0, level), kNone);
    EXPECT_EQ(Border(chart, Wrap::automatic).resolve(4, 1, 0, level), kNone);
    EXPECT_EQ(Border(chart, Wrap::automatic).resolve(1, 3, 0, level), kNone);
    EXPECT_EQ(Border(chart, Wrap::mirror).resolve(-2, 4, 0, level), (Texel{1, 1}));
}

TEST(Border, PlainModesStayOnTheirFace) {
    const Chart chart = chart_for(Projection::cubemap3x2, 8);
    const Size level{24, 16};
    // Piece 4, the front, is the middle of the lower row.
    EXPECT_EQ(Border(chart, Wrap::periodic).interior(4, level), (Box{8, 8, 16, 16}));
    EXPECT_EQ(Border(chart, Wrap::periodic).resolve(7, 16, 4, level), (Texel{15, 8}));
    EXPECT_EQ(Border(chart, Wrap::mirror).resolve(7, 17, 4, level), (Texel{8, 14}));
    EXPECT_EQ(Border(chart, Wrap::clamp).resolve(-100, 17, 4, level), (Texel{8, 15}));
    EXPECT_EQ(Border(chart, Wrap::black).resolve(16, 9, 4, level), kNone);
    EXPECT_EQ(Border(chart, Wrap::periodic).interior(4, Size{12, 8}), (Box{4, 4, 8, 8}));
}

TEST(Border, TheQuartersOfAnOctahedronHaveNoEdgesWhereTheyMeet) {
    const Chart chart = chart_for(Projection::octahedral, 8);
    const Size level{16, 16};
    for (int piece = 0; piece < 4; ++piece) {
        SCOPED_TRACE(piece);
        for (const Wrap wrap : {Wrap::automatic, Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror}) {
            EXPECT_EQ(Border(chart, wrap).interior(piece, level), (Box{0, 0, 16, 16}));
            EXPECT_EQ(Border(chart, wrap).resolve(7, 8, piece, level), (Texel{7, 8}));
        }
        EXPECT_EQ(Border(chart, Wrap::black).resolve(16, 8, piece, level), kNone);
        EXPECT_EQ(Border(chart, Wrap::clamp).resolve(-3, 9, piece, level), (Texel{0, 9}));
        EXPECT_EQ(Border(chart, Wrap::periodic).resolve(17, 9, piece, level), (Texel{1, 9}));
        EXPECT_EQ(Border(chart, Wrap::mirror).resolve(3, -2, piece, level), (Texel{3, 1}));
    }
}

TEST(Border, BesideALensOfTwoIsNotTheOther) {
    // Each lens sees 60 degrees from its axis, which is as far as its half of the picture reaches.
    const Chart chart(Projection::dual_fisheye, 40, 20, 120);
    const Border border(chart, Wrap::automatic);
    for (int piece = 0; piece < 2; ++piece)
        for (const int x : {20 * piece - 1, 20 * piece + 20})
            EXPECT_EQ(border.resolve(x, 9, piece, Size{40, 20}), kNone) << piece << ' ' << x;
    // With more than 180 degrees one goes on in the other.
    const Border wide(Chart(Projection::dual_fisheye, 40, 20, 200), Wrap::automatic);
    EXPECT_FALSE(wide.resolve(20, 9, 0, Size{40, 20}).none);
}

TEST(Border, PanoramasCloseAndGoOverThePoles) {
    const Chart chart(Projection::equirectangular, 16, 8);
    const Border border(chart, Wrap::automatic);
    const Size level{16, 8};
    EXPECT_EQ(border.resolve(-1, 3, 0, level), (Texel{15, 3}));
    EXPECT_EQ(border.resolve(16, 3, 0, level), (Texel{0, 3}));
    EXPECT_EQ(border.resolve(37, 3, 0, level), (Texel{5, 3}));
    EXPECT_EQ(border.resolve(3, -1, 0, level), (Texel{11, 0}));
    EXPECT_EQ(border.resolve(11, -2, 0, level), (Texel{3, 1}));
    EXPECT_EQ(border.resolve(3, 8, 0, level), (Texel{11, 7}));
    EXPECT_EQ(border.resolve(-1, 9, 0, level), (Texel{7, 6}));
    // All the way around.
    EXPECT_EQ(border.resolve(3, 16 + 2, 0, level), (Texel{3, 2}));
    // Half the size.
    EXPECT_EQ(border.resolve(-1, -1, 0, Size{8, 4}), (Texel{3, 0}));
}

TEST(Border, BetweenCentresTheLastTexelRepeatsTheFirst) {
    const Chart chart(Projection::equirectangular, 16, 8, 0, PixelSpacing::centers);
    const Border border(chart, Wrap::automatic);
    const Size level{16, 8};
    EXPECT_EQ(border.interior(0, level), (Box{0, 0, 16, 8}));
    EXPECT_EQ(border.resolve(15, 3, 0, level), (Texel{15, 3}));
    EXPECT_EQ(border.resolve(16, 3, 0, level), (Texel{1, 3}));
    EXPECT_EQ(border.resolve(-1, 3, 0, level), (Texel{14, 3}));
    // Row 0 stands on the pole, row -1 is row 1 of the other side.
    EXPECT_EQ(border.resolve(2, -1, 0, level), (Texel{9, 1}));
    EXPECT_EQ(border.resolve(2, 8, 0, level), (Texel{9, 6}));
    // On a coarse level the overlap is a small part of a texel.
    EXPECT_EQ(border.resolve(4, 1, 0, Size{4, 2}), (Texel{0, 1}));
    EXPECT_EQ(border.resolve(0, -1, 0, Size{4, 2}), (Texel{2, 0}));
}

TEST(Border, WhatDoesNotCloseIsBlackBeyond) {
    const Size level{16, 8};
    const Chart half(Projection::equirectangular, 16, 8, 180);
    EXPECT_EQ(Border(half, Wrap::automatic).resolve(16, 3, 0, level), kNone);
    EXPECT_EQ(Border(half, Wrap::automatic).resolve(3, -1, 0, level), kNone);
    for (const Projection projection : {Projection::cylindrical, Projection::mercator}) {
        const Chart closed(projection, 16, 8);
        EXPECT_EQ(Border(closed, Wrap::automatic).resolve(-2, 3, 0, level), (Texel{14, 3}));
        EXPECT_EQ(Border(closed, Wrap::automatic).resolve(-2, -1, 0, level), kNone);
        EXPECT_EQ(Border(closed, Wrap::automatic).resolve(3, 8, 0, level), kNone);
    }
    const Chart strip(Projection::equirectangular, 16, 5);
    EXPECT_EQ(Border(strip, Wrap::automatic).resolve(3, 5, 0, Size{16, 5}), kNone);
}

double angle_between(const Ray<double>& a, const Ray<double>& b) {
    const double dot = a.x * b.x + a.y * b.y + a.z * b.z;
    const double x = a.y * b.z - a.z * b.y, y = a.z * b.x - a.x * b.z, z = a.x * b.y - a.y * b.x;
    return std::atan2(std::sqrt(x * x + y * y + z * z), dot);
}

/// The ray through the centre of a texel of a level.
Ray<double> ray_of(const Chart& chart, int x, int y, int piece, const Size& level) {
    return chart.ray((x + 0.5) * chart.width() / level.width, (y + 0.5) * chart.height() / level.height,
                     piece);
}

int piece_at(const Border& border, const Chart& chart, const Texel& texel, const Size& level) {
    for (int i = 0; i < static_cast<int>(chart.pieces().size()); ++i) {
        const Box box = border.interior(i, level);
        if (texel.x >= box.x0 && texel.x < box.x1 && texel.y >= box.y0 && texel.y < box.y1) return i;
    }
    return -1;
}

// The texel found beyond an edge looks where the extended face does, to within half a texel's diagonal.
TEST(Border, CubeFacesGoOnOnTheirNeighbours) {
    for (const Projection projection : kCubes)
        for (const PixelSpacing spacing : {PixelSpacing::edges, PixelSpacing::centers})
            for (const int divisor : {1, 4}) {
                const int n = 32 / divisor;
                const Chart chart = chart_for(projection, 32, spacing);
                const Border border(chart, Wrap::automatic);
                const Size level{chart.width() / divisor, chart.height() / divisor};
                const double allowed = 1.01 * std::sqrt(2.0) / (spacing == PixelSpacing::edges ? n : n - 1);
                for (int piece = 0; piece < 6; ++piece) {
                    const Box box = border.interior(piece, level);
                    ASSERT_EQ(box.width(), n);
                    for (int y = box.y0 - n / 2; y < box.y1 + n / 2; ++y)
                        for (int x = box.x0 - n / 2; x < box.x1 + n / 2; ++x) {
                            const Texel texel = border.resolve(x, y, piece, level);
                            const int found = piece_at(border, chart, texel, level);
                            ASSERT_GE(found, 0);
                            const double angle = angle_between(ray_of(chart, x, y, piece, level),
                                                               ray_of(chart, texel.x, texel.y, found, level));
                            ASSERT_LE(angle, allowed)
                                << piece << ": " << x << ' ' << y << " -> " << texel.x << ' ' << texel.y;
                        }
                }
            }
}

// The first row beyond each edge of each face is the neighbour's outermost row, each texel of it once.
TEST(Border, CubeEdgesMeetWithoutASeam) {
    const int n = 16;
    for (const Projection projection : kCubes) {
        const Chart chart = chart_for(projection, n);
        const Border border(chart, Wrap::automatic);
        const Size level{chart.width(), chart.height()};
        for (int piece = 0; piece < 6; ++piece) {
            const Box box = border.interior(piece, level);
            for (int side = 0; side < 4; ++side) {
                std::vector<std::pair<int, int>> seen;
                for (int i = 0; i < n; ++i) {
                    const int x = side == 0 ? box.x0 - 1 : side == 1 ? box.x1 : box.x0 + i;
                    const int y = side == 2 ? box.y0 - 1 : side == 3 ? box.y1 : box.y0 + i;
                    const Texel texel = border.resolve(x, y, piece, level);
                    const int other = piece_at(border, chart, texel, level);
                    ASSERT_NE(other, piece);
                    const Box face = border.interior(other, level);
                    ASSERT_TRUE(texel.x == face.x0 || texel.x == face.x1 - 1 || texel.y == face.y0 ||
                                texel.y == face.y1 - 1);
                    seen.emplace_back(texel.x, texel.y);
                }
                std::sort(seen.begin(), seen.end());
                ASSERT_EQ(std::unique(seen.begin(), seen.end()), seen.end()) << piece << " side " << side;
            }
        }
    }
}

}  // namespace
}  // namespace anamorph::test_border
