// SPDX-License-Identifier: Apache-2.0
// Second derivatives of panoramas: differences of texels in long double are means of them, and lie in what is said of them.
#include "anamorph/projector/derivative_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "panorama_oracle.h"

namespace anamorph::test_derivative_cells {
namespace {

using oracle::Real;
using oracle::View;
using Triangle = std::array<glm::dvec3, 3>;

const View kViews[] = {
    {Projection::equirectangular, 4096, 2048, 360}, {Projection::cylindrical, 2000, 600, 360},
    {Projection::mercator, 2000, 900, 200},         {Projection::fisheye, 1500, 1500, 220},
    {Projection::equisolid, 1500, 1500, 180},       {Projection::stereographic, 1200, 1200, 240},
    {Projection::rectilinear, 1600, 900, 100}};

glm::dvec3 random_vector(std::mt19937& random) {
    std::normal_distribution<double> part;
    // In this order, so that all compilers make the same.
    glm::dvec3 v;
    for (int k = 0; k < 3; ++k) v[k] = part(random);
    return v;
}

/// A triangle of rays, of any scale and slant, about as wide as `width` of its distance.
Triangle random_triangle(std::mt19937& random, double width) {
    const double scale = std::exp2(static_cast<double>(random() % 200) - 100);
    const glm::dvec3 about = glm::normalize(random_vector(random));
    Triangle triangle;
    for (glm::dvec3& corner : triangle) corner = (about + width * random_vector(random)) * scale;
    return triangle;
}

/// Four times F(a) - F(b) - F(c) + F(d), of the image point F of rays.
Point<Real> difference(const View& view, const Chart& chart, const std::array<oracle::Vector, 4>& rays) {
    Point<Real> sum{0, 0}, first{};
    for (std::size_t i = 0; i < 4; ++i) {
        Point<Real> p = oracle::point_of(view, chart.pieces()[0], rays[i]);
        if (i == 0) first = p;
        // Those of a full turn go on beyond it.
        if (chart.closed()) p.x = first.x + std::remainder(p.x - first.x, Real(chart.width()));
        const Real sign = i == 0 || i == 3 ? 4 : -4;
        sum.x += sign * p.x;
        sum.y += sign * p.y;
    }
    return sum;
}

/// How far off a middle two coordinates are, over what they may be off.
double share(const Point<Real>& found, double at_x, double off_x, double at_y, double off_y) {
    constexpr double kRounding = 1e-10;
    const auto of = [](Real value, double at, double off) {
        return (static_cast<double>(std::fabs(value - at)) - kRounding) / off;
    };
    return std::max(of(found.x, at_x, off_x), of(found.y, at_y, off_y));
}

TEST(DerivativeCells, DifferencesOfTexelsLieInTheForms) {
    for (const View& view : kViews) {
        SCOPED_TRACE(name_of(view.projection));
        const Chart chart = oracle::chart_of(view);
        const DerivativeCells cells(chart);
        std::mt19937 random(3);
        int known = 0;
        double most = 0;
        for (int i = 0; i < 20000; ++i) {
            const double width = std::exp2(-3 - static_cast<double>(random() % 8));
            const Triangle t = random_triangle(random, width);
            const glm::dvec3 f = t[2] - t[0];
            const auto forms = cells.over(t, (t[0] + t[1] + t[2]) / 3.0, t[1] - t[0], &f);
            if (!forms) continue;
            ++known;
            // Differences over half of a side are a quarter of means of the forms.
            const auto at = [&](Real s, Real u) {
                const auto part = [&](int k) {
                    return t[0][k] + s * (t[1][k] - Real(t[0][k])) + u * (t[2][k] - Real(t[0][k]));
                };
                return oracle::Vector{part(0), part(1), part(2)};
            };
            const auto p = at(0.5, 0), q = at(0, 0.5);
            const auto &x = forms->x, &y = forms->y;
            most = std::max(
                {most,
                 share(difference(view, chart, {at(0, 0), p, p, at(1, 0)}), x.ee, x.off_ee, y.ee, y.off_ee),
                 share(difference(view, chart, {at(0, 0), q, q, at(0, 1)}), x.ff, x.off_ff, y.ff, y.off_ff),
                 share(difference(view, chart, {at(0, 0), p, q, at(0.5, 0.5)}), x.ef, x.off_ef, y.ef,
                       y.off_ef)});
        }
        EXPECT_LE(most, 1);
        // They are not much wider than they have to be.
        EXPECT_GT(most, 0.1);
        EXPECT_GT(known, 1000);
    }
}

TEST(DerivativeCells, AnEdgeHasTheFormOfATriangleAlongIt) {
    const Chart chart(Projection::equirectangular, 4096, 2048);
    const DerivativeCells cells(chart);
    const std::array edge{glm::dvec3(1, .2, .3), glm::dvec3(1, .21, .32)};
    const glm::dvec3 e = edge[1] - edge[0], middle = 0.5 * (edge[0] + edge[1]), none(0.0);
    const auto alone = cells.over(edge, middle, e), with = cells.over(edge, middle, e, &none);
    ASSERT_TRUE(alone && with);
    EXPECT_EQ(alone->x.ee, with->x.ee);
    EXPECT_EQ(alone->y.off_ee, with->y.off_ee);
    EXPECT_EQ(alone->x.off_ff, 0);
}

TEST(DerivativeCells, NothingIsKnownOfPolesNorBesideThePanoramaNorOfWhatIsWideOrNoNumber) {
    const Chart closed(Projection::equirectangular, 4096, 2048), open(Projection::rectilinear, 400, 400, 90);
    const DerivativeCells whole(closed), part(open);
    const auto is_known = [](const DerivativeCells& cells, const glm::dvec3& a, const glm::dvec3& b) {
        return cells.over(std::array{a, b}, 0.5 * (a + b), b - a).has_value();
    };
    EXPECT_TRUE(is_known(whole, {.1, 0, 1}, {.12, 0, 1}));
    EXPECT_TRUE(is_known(part, {.1, 0, 1}, {.12, 0, 1}));
    // Through the pole and next to it.
    EXPECT_FALSE(is_known(whole, {-.01, 1, 0}, {.01, 1, 0}));
    EXPECT_FALSE(is_known(whole, {0.001, 1, 0}, {.02, 1, 0}));
    // Across the border, beside it and behind.
    EXPECT_FALSE(is_known(part, {.99, 0, 1}, {1.01, 0, 1}));
    EXPECT_FALSE(is_known(part, {1.2, 0, 1}, {1.21, 0, 1}));
    EXPECT_FALSE(is_known(part, {.1, 0, -1}, {.12, 0, -1}));
    EXPECT_FALSE(is_known(whole, {-.2, 0, 1}, {.2, 0, 1}));
    EXPECT_FALSE(is_known(whole, {.1, 0, 1}, {.1, 0, 1}));
    for (const double bad : {0.0, HUGE_VAL, -HUGE_VAL, static_cast<double>(NAN)}) {
        EXPECT_FALSE(is_known(whole, {bad, bad, bad}, {.01, 0, 1})) << bad;
        EXPECT_FALSE(is_known(whole, {.1, bad * 0, 1}, {.12, bad, bad}) && bad != 0) << bad;
    }
}

}  // namespace
}  // namespace anamorph::test_derivative_cells
