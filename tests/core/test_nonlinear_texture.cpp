// SPDX-License-Identifier: Apache-2.0
// Texture coordinates that are cubic in triangles, against Hermite's and Bernstein's polynomials written out in long double.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "anamorph/error.h"
#include "anamorph/surface/nonlinear_texture.h"

namespace anamorph::test_nonlinear_texture {
using namespace surface;
namespace {

using testing::HasSubstr;
using Real = long double;

constexpr Size kTexture{1500, 700};

std::size_t at(std::int64_t i) {
    return static_cast<std::size_t>(i);
}

/// A sheet of (n + 1)^2 points over a curved surface, in triangles, with texture coordinates that bend.
TexturedMesh sheet(unsigned seed, int n, double bend, double noise = 0.2) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> some(-noise / n, noise / n);
    TexturedMesh mesh;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const double x = double(i) / n + some(random), y = double(j) / n + some(random);
            mesh.points.emplace_back(3 * x, 2 * y, 0.4 * std::sin(3 * x) * y);
            mesh.texture.push_back(
                {x + bend * std::sin(5 * y), y + bend * std::cos(4 * x) + 0.3 * bend * x * y});
        }
    const auto id = [&](int i, int j) { return std::int64_t{j} * (n + 1) + i; };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
            mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
        }
    mesh.slopes = fitted_slopes(mesh);
    return mesh;
}

/// Hermite's cubic on the side from p to q, a coordinate of it.
Real hermite(const TexturedMesh& mesh, std::int64_t p, std::int64_t q, bool v, Real t) {
    const glm::vec<3, Real> along =
        glm::vec<3, Real>(mesh.points[at(q)]) - glm::vec<3, Real>(mesh.points[at(p)]);
    const auto value = [&](std::int64_t i) {
        return Real(v ? mesh.texture[at(i)].y : mesh.texture[at(i)].x);
    };
    const auto slope = [&](std::int64_t i) {
        return glm::dot(glm::vec<3, Real>(v ? mesh.slopes[at(i)].v : mesh.slopes[at(i)].u), along);
    };
    return value(p) * (1 + 2 * t) * (1 - t) * (1 - t) + slope(p) * t * (1 - t) * (1 - t) +
           value(q) * t * t * (3 - 2 * t) + slope(q) * t * t * (t - 1);
}

/// The cubic in a triangle, a coordinate of it: the sides' cubics in powers of the weights, and 6 r s t times the middle point.
Real cubic(const TexturedMesh& mesh, std::int64_t triangle, bool v, const Real (&w)[3]) {
    const auto& corners = mesh.triangles[at(triangle)];
    Real value = 0, sides = 0, ends = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Real f = v ? mesh.texture[at(corners[i])].y : mesh.texture[at(corners[i])].x;
        value += f * w[i] * w[i] * w[i];
        ends += f;
        for (std::size_t j = 0; j < 3; ++j) {
            if (i == j) continue;
            const auto &p = mesh.points[at(corners[i])], &q = mesh.points[at(corners[j])];
            const auto& g = v ? mesh.slopes[at(corners[i])].v : mesh.slopes[at(corners[i])].u;
            Real slope = 0;
            for (int k = 0; k < 3; ++k) slope += Real(g[k]) * (Real(q[k]) - Real(p[k]));
            value += 3 * w[i] * w[i] * w[j] * (f + slope / 3);
            sides += f + slope / 3;
        }
    }
    return value + 6 * w[0] * w[1] * w[2] * (sides / 4 - ends / 6);
}

/// A corner of a part of a triangle: its weights in that, and its texture coordinates.
struct Corner {
    Real w[3];
    Point<double> texture;
};
Corner corner_of(const TexturedMesh& mesh, const CutMesh& cut, const CutMesh::Triangle& part, int k) {
    const auto& given = mesh.triangles[at(part.triangle)];
    const std::int64_t id = part.points[at(k)], count = static_cast<std::int64_t>(mesh.points.size());
    Corner corner{{0, 0, 0}, {0, 0}};
    if (id < count) {
        corner.texture = mesh.texture[at(id)];
        for (std::size_t i = 0; i < 3; ++i) corner.w[i] = given[i] == id;
        return corner;
    }
    const TexturedPoint& point = cut.points[at(id - count)];
    corner.texture = point.texture;
    const auto& from = mesh.triangles[at(point.triangle)];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if (given[i] == from[j]) corner.w[i] = point.weights[j];
    return corner;
}

TEST(NonlinearTexture, SidesAreHermiteAndTheMiddleOfACubicIsQuadraticWhereTheyAre) {
    const TexturedMesh mesh = sheet(3, 4, 0.08);
    const CutMesh cut = cut_texture(mesh, kTexture, 0.05);
    int on_sides = 0, within = 0;
    for (const TexturedPoint& point : cut.points) {
        const Real w[3] = {point.weights[0], point.weights[1], point.weights[2]};
        EXPECT_EQ(w[0] + w[1] + w[2], 1);
        const auto& corners = mesh.triangles[at(point.triangle)];
        for (const bool v : {false, true}) {
            const double seen = v ? point.texture.y : point.texture.x;
            EXPECT_NEAR(seen, double(cubic(mesh, point.triangle, v, w)), 2e-15);
            for (std::size_t i = 0; i < 3; ++i) {
                if (w[(i + 2) % 3] != 0) continue;
                ++on_sides;
                EXPECT_NEAR(seen, double(hermite(mesh, corners[i], corners[(i + 1) % 3], v, w[(i + 1) % 3])),
                            1e-15);
            }
        }
        for (int k = 0; k < 3; ++k) {
            Real place = 0;
            for (std::size_t i = 0; i < 3; ++i) place += w[i] * Real(mesh.points[at(corners[i])][k]);
            EXPECT_NEAR(point.place[k], double(place), 4e-15);
        }
        within += w[0] * w[1] * w[2] > 0;
    }
    EXPECT_GT(on_sides, 100);
    EXPECT_GT(within, 100);
}

TEST(NonlinearTexture, LinearInterpolationHoldsTheTolerance) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> share(0, 1);
        std::size_t before = 0;
        for (const double tol : {10.0, 1.0, 0.125, 0.02}) {
            const TexturedMesh mesh = sheet(seed, 5, 0.06);
            const CutMesh cut = cut_texture(mesh, kTexture, tol);
            EXPECT_LE(cut.max_error, tol);
            EXPECT_EQ(cut.not_finite, 0);
            Real worst = 0;
            for (const CutMesh::Triangle& part : cut.triangles) {
                Corner corners[3];
                for (int k = 0; k < 3; ++k) corners[k] = corner_of(mesh, cut, part, k);
                for (int n = 0; n < 3; ++n) {
                    Real a = share(random), b = share(random);
                    if (a + b > 1) a = 1 - a, b = 1 - b;
                    const Real t[3] = {a, b, 1 - a - b};
                    Real w[3] = {0, 0, 0}, linear[2] = {0, 0};
                    for (std::size_t k = 0; k < 3; ++k) {
                        for (std::size_t i = 0; i < 3; ++i) w[i] += t[k] * corners[k].w[i];
                        linear[0] += t[k] * Real(corners[k].texture.x);
                        linear[1] += t[k] * Real(corners[k].texture.y);
                    }
                    worst = std::max(
                        worst,
                        std::hypot((linear[0] - cubic(mesh, part.triangle, false, w)) * kTexture.width,
                                   (linear[1] - cubic(mesh, part.triangle, true, w)) * kTexture.height));
                }
            }
            EXPECT_LE(worst, cut.max_error) << seed << " " << tol;
            EXPECT_GT(worst, 0.2 * cut.max_error) << "the bound is no more than five times what it bounds";
            EXPECT_GT(cut.triangles.size(), before);
            // Finer by 2 either way is better by 4: triangles in proportion to 1 / tol, and some.
            EXPECT_LT(static_cast<double>(cut.triangles.size()), 50 + 12 * 1000 / tol);
            before = cut.triangles.size();
        }
    }
}

TEST(NonlinearTexture, NoPointLiesWithinASideAndAreasStay) {
    const TexturedMesh mesh = sheet(7, 6, 0.05);
    const CutMesh cut = cut_texture(mesh, kTexture, 0.3);
    std::map<std::pair<std::int64_t, std::int64_t>, int> directed;
    std::vector<Real> area(mesh.triangles.size(), 0);
    for (const CutMesh::Triangle& part : cut.triangles) {
        Corner c[3];
        for (int k = 0; k < 3; ++k) {
            c[k] = corner_of(mesh, cut, part, k);
            ++directed[{part.points[at(k)], part.points[at((k + 1) % 3)]}];
        }
        const Real signed_area = (c[1].w[1] - c[0].w[1]) * (c[2].w[2] - c[0].w[2]) -
                                 (c[1].w[2] - c[0].w[2]) * (c[2].w[1] - c[0].w[1]);
        EXPECT_GT(signed_area, 0) << "turned over";
        area[at(part.triangle)] += signed_area;
    }
    for (const Real a : area) EXPECT_EQ(a, 1);
    // Every side but those of the sheet's border has a triangle on either side.
    int border = 0;
    for (const auto& [side, count] : directed) {
        EXPECT_EQ(count, 1);
        border += directed.count({side.second, side.first}) == 0;
    }
    // Each of the sheet's 24 sides is a chain: as many points as sides lie on it.
    std::set<std::int64_t> on_border;
    for (const auto& [side, count] : directed)
        if (directed.count({side.second, side.first}) == 0) on_border.insert({side.first, side.second});
    EXPECT_EQ(static_cast<int>(on_border.size()), border);
    EXPECT_GT(border, 24);
}

TEST(NonlinearTexture, WhatIsLinearStays) {
    TexturedMesh mesh = sheet(9, 5, 0);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        mesh.points[i].z = 0.3 * mesh.points[i].x - 0.7 * mesh.points[i].y + 2;  // flat
        mesh.texture[i] = {0.2 + 0.3 * mesh.points[i].x,
                           0.1 - 0.2 * mesh.points[i].x + 0.4 * mesh.points[i].z};
    }
    mesh.slopes = fitted_slopes(mesh);
    for (const auto& slopes : mesh.slopes) {
        // The gradient of x in the plane z = 0.3 x - 0.7 y + 2, by its normal n: e - (e.n) n.
        const glm::dvec3 n = glm::normalize(glm::dvec3(-0.3, 0.7, 1)), e(1, 0, 0),
                         wanted = 0.3 * (e - glm::dot(e, n) * n);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(slopes.u[k], wanted[k], 1e-13);
    }
    const CutMesh cut = cut_texture(mesh, kTexture, 1e-6);
    EXPECT_EQ(cut.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(cut.points.size(), 0u);
}

TEST(NonlinearTexture, TheSameForAnyThreads) {
    const TexturedMesh mesh = sheet(11, 8, 0.05);
    const CutMesh one = cut_texture(mesh, kTexture, 0.1);
    const CutMesh turned = cut_texture(mesh, kTexture, 0.1, [](std::int64_t count, const auto& body) {
        for (std::int64_t i = count - 1; i >= 0; --i) body(i);
    });
    ASSERT_EQ(one.triangles.size(), turned.triangles.size());
    for (std::size_t i = 0; i < one.triangles.size(); ++i)
        EXPECT_EQ(one.triangles[i].points, turned.triangles[i].points);
    EXPECT_EQ(one.max_error, turned.max_error);
    ASSERT_EQ(one.points.size(), turned.points.size());
    for (std::size_t i = 0; i < one.points.size(); ++i) {
        EXPECT_EQ(one.points[i].place, turned.points[i].place);
        EXPECT_EQ(one.points[i].texture.x, turned.points[i].texture.x);
        EXPECT_EQ(one.points[i].texture.y, turned.points[i].texture.y);
    }
}

using Place = std::array<double, 3>;
Place place_of(const TexturedMesh& mesh, const CutMesh& cut, std::int64_t id) {
    const auto count = static_cast<std::int64_t>(mesh.points.size());
    const glm::dvec3& p = id < count ? mesh.points[at(id)] : cut.points[at(id - count)].place;
    return {p.x, p.y, p.z};
}
/// How many sides, by the places of their ends, have a triangle on one side alone.
int open_sides(const TexturedMesh& mesh, const CutMesh& cut) {
    std::map<std::pair<Place, Place>, int> directed;
    for (const CutMesh::Triangle& part : cut.triangles)
        for (int k = 0; k < 3; ++k)
            ++directed[{place_of(mesh, cut, part.points[at(k)]),
                        place_of(mesh, cut, part.points[at((k + 1) % 3)])}];
    int open = 0;
    for (const auto& [side, count] : directed) open += directed.count({side.second, side.first}) == 0;
    return open;
}
/// The triangles of a mesh by the places and texture coordinates of their corners, the least one first.
std::multiset<std::vector<double>> by_places(const TexturedMesh& mesh, const CutMesh& cut) {
    std::multiset<std::vector<double>> all;
    const auto count = static_cast<std::int64_t>(mesh.points.size());
    for (const CutMesh::Triangle& part : cut.triangles) {
        std::array<std::array<double, 5>, 3> corners;
        for (int k = 0; k < 3; ++k) {
            const std::int64_t id = part.points[at(k)];
            const Place p = place_of(mesh, cut, id);
            const auto& t = id < count ? mesh.texture[at(id)] : cut.points[at(id - count)].texture;
            corners[at(k)] = {p[0], p[1], p[2], t.x, t.y};
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        std::vector<double> numbers;
        for (const auto& corner : corners) numbers.insert(numbers.end(), corner.begin(), corner.end());
        all.insert(numbers);
    }
    return all;
}

TEST(NonlinearTexture, AnyNumberingAndAnyPiecesAreTheSame) {
    const TexturedMesh mesh = sheet(19, 6, 0.06);
    const auto whole = by_places(mesh, cut_texture(mesh, kTexture, 0.2));
    EXPECT_GT(whole.size(), 1000u);
    // Points and triangles in another order, which begin at other corners.
    std::mt19937 random(20);
    std::vector<std::int64_t> to(mesh.points.size());
    std::iota(to.begin(), to.end(), 0);
    std::shuffle(to.begin(), to.end(), random);
    TexturedMesh other = mesh;
    for (std::size_t i = 0; i < to.size(); ++i) {
        other.points[at(to[i])] = mesh.points[i];
        other.texture[at(to[i])] = mesh.texture[i];
    }
    std::shuffle(other.triangles.begin(), other.triangles.end(), random);
    for (auto& t : other.triangles) {
        for (auto& p : t) p = to[at(p)];
        std::rotate(t.begin(), t.begin() + random() % 3, t.end());
    }
    other.slopes = fitted_slopes(other);
    for (std::size_t i = 0; i < to.size(); ++i) {
        EXPECT_EQ(other.slopes[at(to[i])].u, mesh.slopes[i].u);
        EXPECT_EQ(other.slopes[at(to[i])].v, mesh.slopes[i].v);
    }
    // Where a triangle begins is how its own middle is rounded, in its last bits: as many triangles, at the same places.
    const CutMesh cut = cut_texture(other, kTexture, 0.2);
    EXPECT_EQ(open_sides(other, cut), open_sides(mesh, cut_texture(mesh, kTexture, 0.2)));
    EXPECT_EQ(by_places(other, cut).size(), whole.size());
    // In pieces: what the triangles about a point say of its slopes stays.
    std::multiset<std::vector<double>> parts;
    for (const std::size_t part : {0u, 1u, 2u}) {
        TexturedMesh piece = mesh;
        piece.triangles.clear();
        for (std::size_t i = part; i < mesh.triangles.size(); i += 3)
            piece.triangles.push_back(mesh.triangles[i]);
        parts.merge(by_places(piece, cut_texture(piece, kTexture, 0.2)));
    }
    EXPECT_EQ(parts, whole);
}

/// A mesh whose triangles share no point: each has corners of its own.
TexturedMesh torn(const TexturedMesh& mesh) {
    TexturedMesh apart;
    for (const auto& t : mesh.triangles) {
        const auto first = static_cast<std::int64_t>(apart.points.size());
        for (const std::int64_t p : t) {
            apart.points.push_back(mesh.points[at(p)]);
            apart.texture.push_back(mesh.texture[at(p)]);
        }
        apart.triangles.push_back({first, first + 1, first + 2});
    }
    return apart;
}

TEST(NonlinearTexture, PointsThatAreDoubledFit) {
    const TexturedMesh mesh = sheet(23, 5, 0.06);
    TexturedMesh apart = torn(mesh);
    apart.slopes = fitted_slopes(apart);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(apart.slopes[3 * t + k].u, mesh.slopes[at(mesh.triangles[t][k])].u)
                << "points alike are one";
    EXPECT_EQ(by_places(apart, cut_texture(apart, kTexture, 0.2)),
              by_places(mesh, cut_texture(mesh, kTexture, 0.2)));
    // Every triangle has another part of the texture, bent by more or less: seams everywhere.
    std::mt19937 random(24);
    std::uniform_real_distribution<double> some(0, 1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const double shift = some(random), scale = some(random);
        for (std::size_t k = 0; k < 3; ++k) {
            apart.texture[3 * t + k] = apart.texture[3 * t + k] * scale + Point<double>{shift, 0.5 * shift};
            auto& slopes = apart.slopes[3 * t + k];
            slopes.u *= scale * scale, slopes.v *= scale;
        }
    }
    const CutMesh cut = cut_texture(apart, kTexture, 0.2);
    EXPECT_GT(cut.triangles.size(), 1000u);
    EXPECT_LE(cut.max_error, 0.2);
    // Open is the border of the sheet alone, each of whose sides is cut by a rule of its own.
    int border = 0;
    for (const CutMesh::Triangle& part : cut.triangles)
        for (int k = 0; k < 3; ++k) {
            const Corner a = corner_of(apart, cut, part, k), b = corner_of(apart, cut, part, (k + 1) % 3);
            const std::size_t t = at(part.triangle);
            for (std::size_t s = 0; s < 3; ++s) {
                const std::int64_t p = mesh.triangles[t][s], q = mesh.triangles[t][(s + 1) % 3];
                const auto row = [](std::int64_t i) { return i / 6; };
                const auto column = [](std::int64_t i) { return i % 6; };
                const bool outer =
                    (row(p) == row(q) && row(p) % 5 == 0) || (column(p) == column(q) && column(p) % 5 == 0);
                border += outer && a.w[(s + 2) % 3] == 0 && b.w[(s + 2) % 3] == 0;
            }
        }
    EXPECT_EQ(open_sides(apart, cut), border);
}

TEST(NonlinearTexture, WhereASeamEndsItFitsToo) {
    // Two triangles whose common side has one point at one end, and two at the other.
    TexturedMesh mesh;
    mesh.points = {{0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -1, 0}};
    mesh.texture = {{0.1, 0.2}, {0.3, 0.5}, {0.9, 0.5}, {0.2, 0.8}, {0.4, 0.1}};
    mesh.triangles = {{0, 1, 3}, {2, 0, 4}};
    mesh.slopes.assign(5, {{0.3, 0.1, 0}, {0.2, -0.4, 0}});
    mesh.slopes[2].u.x = 5;
    const CutMesh cut = cut_texture(mesh, kTexture, 0.5);
    std::set<Place> on_side[2];
    for (const CutMesh::Triangle& part : cut.triangles)
        for (const std::int64_t p : part.points) {
            const Place place = place_of(mesh, cut, p);
            if (place[1] == 0) on_side[part.triangle].insert(place);
        }
    EXPECT_GT(on_side[1].size(), 20u);
    EXPECT_EQ(on_side[0], on_side[1]);
}

TEST(NonlinearTexture, WhatIsNoNumberHasNoBoundAndNoCracks) {
    TexturedMesh mesh = sheet(13, 4, 0.05);
    const CutMesh before = cut_texture(mesh, kTexture, 0.2);
    mesh.texture[6].x = NAN;
    mesh.texture[24].y = 1e305;
    mesh.slopes = fitted_slopes(mesh);
    CutMesh cut = cut_texture(mesh, kTexture, 0.2);
    // Six triangles about the inner point, and eight about those whose slopes are fitted to the corner.
    EXPECT_EQ(cut.not_finite, 14);
    EXPECT_LE(cut.max_error, 0.2);
    std::vector<int> parts(mesh.triangles.size(), 0);
    for (const CutMesh::Triangle& part : cut.triangles) ++parts[at(part.triangle)];
    int cut_along = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        EXPECT_GE(parts[i], 1);
        const auto& t = mesh.triangles[i];
        if (std::find(t.begin(), t.end(), 6) != t.end()) cut_along += parts[i] > 1;
    }
    EXPECT_EQ(cut_along, 6) << "along the sides that they share";
    // No side is open but those of the border: each of its 16 sides is a chain.
    std::set<Place> border;
    int open = 0;
    std::map<std::pair<Place, Place>, int> directed;
    for (const CutMesh::Triangle& part : cut.triangles)
        for (int k = 0; k < 3; ++k)
            ++directed[{place_of(mesh, cut, part.points[at(k)]),
                        place_of(mesh, cut, part.points[at((k + 1) % 3)])}];
    for (const auto& [side, count] : directed)
        if (directed.count({side.second, side.first}) == 0) {
            border.insert({side.first, side.second});
            ++open;
        }
    EXPECT_EQ(static_cast<int>(border.size()), open);
    // A place that is none.
    mesh = sheet(13, 4, 0.05);
    mesh.points[18].y = INFINITY;
    mesh.slopes = fitted_slopes(mesh);
    cut = cut_texture(mesh, kTexture, 0.2);
    EXPECT_EQ(cut.not_finite, 6);
    EXPECT_LE(cut.max_error, 0.2);
    EXPECT_LT(cut.triangles.size(), before.triangles.size() * 2);
    // No triangle, no points; a triangle that is a line.
    EXPECT_TRUE(cut_texture({}, kTexture, 1).triangles.empty());
    TexturedMesh line;
    line.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    line.texture = {{0, 0}, {0.5, 0.1}, {1, 0}};
    line.triangles = {{0, 1, 2}, {0, 0, 1}};
    line.slopes = fitted_slopes(line);
    EXPECT_LE(cut_texture(line, kTexture, 0.5).max_error, 0.5);
    // Two corners at one place: along its two long sides, and no inside.
    line.points[2] = line.points[1];
    line.triangles = {{0, 1, 2}};
    line.slopes.assign(3, {{3, 0, 0}, {0, 3, 0}});
    EXPECT_EQ(cut_texture(line, kTexture, 0.5).max_error, 0);
    EXPECT_GT(cut_texture(line, kTexture, 0.5).triangles.size(), 3u);
}

TEST(NonlinearTexture, SidesOnOneLineGiveTheSlopeAlongIt) {
    TexturedMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {2, 1e-9, 0}};
    mesh.texture = {{0.1, 0}, {0.3, 0}, {0.5, 0}};
    mesh.triangles = {{0, 1, 2}};
    for (const TextureSlopes& slopes : fitted_slopes(mesh)) {
        EXPECT_NEAR(slopes.u.x, 0.2, 1e-8);
        EXPECT_NEAR(slopes.u.y, 0, 1e-8);
    }
}

TEST(NonlinearTexture, WhatCannotBeHeldIsRefused) {
    const TexturedMesh mesh = sheet(15, 3, 0.1);
    const auto error = [&](const Size& size, double tol) -> std::string {
        try {
            cut_texture(mesh, size, tol, serial_for, 5000);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    };
    for (const double tol : {0.0, -1.0, double(NAN), double(INFINITY), 1e7})
        EXPECT_THAT(error(kTexture, tol), HasSubstr("tol=")) << tol;
    for (const int side : {0, -5, (1 << 20) + 1, 2147483647}) {
        EXPECT_THAT(error({side, 5}, 1), HasSubstr("texture_width=")) << side;
        EXPECT_THAT(error({5, side}, 1), HasSubstr("texture_height="));
        EXPECT_THAT(error({5, side}, 1), HasSubstr("must be an integer from 1 to 1048576"));
    }
    EXPECT_THAT(error(kTexture, 1e-14), HasSubstr("tol=1e-14: must be larger: texture coordinates as large"));
    EXPECT_THAT(error({1 << 20, 1 << 20}, 1e-4),
                HasSubstr("tol=1e-04: must be larger: more than 5000 triangles"));
    // What is there already counts, and what is made just fits.
    EXPECT_NO_THROW(cut_texture(mesh, kTexture, 1e5, serial_for, 18));
    EXPECT_THROW(cut_texture(mesh, kTexture, 1e5, serial_for, 17), Error);
    const auto needed = static_cast<std::int64_t>(cut_texture(mesh, kTexture, 1).triangles.size());
    EXPECT_NO_THROW(cut_texture(mesh, kTexture, 1, serial_for, needed));
    EXPECT_THROW(cut_texture(mesh, kTexture, 1, serial_for, needed - 1), Error);
    EXPECT_EQ(error({1 << 20, 1}, 1e5), "");
}

}  // namespace
}  // namespace anamorph::test_nonlinear_texture
