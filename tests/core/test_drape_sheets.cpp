// SPDX-License-Identifier: Apache-2.0
// Scheme exact: which of several sheets is seen, where they lie nearer to each other than facets are to any of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "drape_oracle.h"
#include "drape_scene.h"

namespace anamorph::test_drape_sheets {
using namespace surface;
namespace {

using test::kHalfTurn;
using test::Real;
using test::Scene;
using test::Shown;

/// Upright walls over a curve in the plane of x and z: Curve::point(u) gives x and z.
template <class Curve>
class Wall final : public DrapedSurface {
  public:
    explicit Wall(const Curve& curve) : m_curve(curve) {}
    glm::dvec3 position(double u, double v) const noexcept override {
        double x, z;
        m_curve.point(u, x, z);
        return {x, 0.5 - v, z};
    }
    double rounding(double u, double) const noexcept override {
        Interval x, z;
        m_curve.point(Interval(u), x, z);
        return 8 * std::max(x.hi - x.lo, z.hi - z.lo);
    }
    SurfaceFrame frame(double u, double v) const noexcept override {
        Jet<double, 1> x, z;
        m_curve.point(Jet<double, 1>::variable(u, 1, 0), x, z);
        return {{x.c[0], 0.5 - v, z.c[0]}, {x.c[1], 0, z.c[1]}, {0, -1, 0}};
    }
    std::array<DoubleDouble, 3> truth(DoubleDouble u, DoubleDouble v) const noexcept override {
        DoubleDouble x, z;
        m_curve.point(u, x, z);
        return {x, 0.5 - v, z};
    }
    SurfaceRange range(const Interval& u, const Interval& v) const noexcept override {
        using J = Jet<Interval, 2>;
        J x, z;
        m_curve.point(J::variable(u, 1.0, 0.0), x, z);
        return {x, J(J(0.5) - J::variable(v, 0.0, 1.0)), z};
    }
    Certainty missing(const Interval&, const Interval&) const noexcept override { return Certainty::no; }

  private:
    Curve m_curve;
};

/// Two turns about the axis, the second one 1e-6 outside of the first.
struct Spiral {
    template <class T>
    void point(const T& u, T& x, T& z) const {
        T s, c;
        sin_cos(T((u - 0.5) * (4 * kPi)), s, c);
        const T radius = u * 2e-6 + 0.5;
        x = s * radius;
        z = c * radius;
    }
    static std::array<Real, 2> at(Real u) {
        const Real turn = (u - 0.5L) * 4 * kHalfTurn, radius = 0.5L + 2e-6L * u;
        return {radius * std::sin(turn), radius * std::cos(turn)};
    }
};

/// A figure of eight: it goes through itself at the axis.
struct Eight {
    template <class T>
    void point(const T& u, T& x, T& z) const {
        T s, c;
        sin_cos(T(u * (2 * kPi)), s, c);
        x = s * c * 0.9;
        z = s * 0.6;
    }
    static std::array<Real, 2> at(Real u) {
        const Real turn = 2 * kHalfTurn * u;
        return {0.45L * std::sin(2 * turn), 0.6L * std::sin(turn)};
    }
};

/// Of the points of a curve on the ray from `eye` along `d`, in the plane, u of the nearest that is `near` or more along
/// it; -1 where there is none. By where the curve changes sides.
template <class Curve>
Real nearest_on_ray(const std::array<Real, 2>& eye, const std::array<Real, 2>& d, Real& ahead) {
    const auto side = [&](Real u) {
        const auto p = Curve::at(u);
        return (p[0] - eye[0]) * d[1] - (p[1] - eye[1]) * d[0];
    };
    constexpr int kSteps = 2000;
    Real best = -1;
    ahead = HUGE_VALL;
    for (int i = 0; i < kSteps; ++i) {
        Real from = Real(i) / kSteps, to = Real(i + 1) / kSteps;
        if ((side(from) > 0) == (side(to) > 0)) continue;
        for (int k = 0; k < 70; ++k) {
            const Real middle = (from + to) / 2;
            ((side(middle) > 0) == (side(from) > 0) ? from : to) = middle;
        }
        const auto p = Curve::at(from);
        const Real along = (p[0] - eye[0]) * d[0] + (p[1] - eye[1]) * d[1];
        if (along <= 0 || along >= ahead) continue;
        ahead = along;
        best = from;
    }
    return best;
}

/// Pixels of a level view of the curve's wall that show another point than the nearest, by more than 1e-7 of it; `seen`: those
/// that show any.
template <class Curve>
int wrong_points(DrapeScheme scheme, double tol, int& seen) {
    Scene scene;
    scene.own = std::make_shared<Wall<Curve>>(Curve{});
    scene.pose.position = {0.31, 0.02, 1.9};
    scene.pose.target = {0.02, 0.02, 0.01};
    scene.pose.fov = 45;
    scene.picture = {1000, 1000};
    const Shown shown(scene);
    SurfaceTree& tree = shown.tree()->tree;
    const DrapeMap map(cut_into_facets(tree, shown.camera(), tol), shown.camera(), scene.picture, tol,
                       scheme == DrapeScheme::exact ? tree.shared_surface() : nullptr);
    const Real vx = scene.pose.target.x - Real(scene.pose.position.x),
               vz = scene.pose.target.z - Real(scene.pose.position.z), length = std::hypot(vx, vz);
    const std::array<Real, 2> eye{scene.pose.position.x, scene.pose.position.z},
        view{vx / length, vz / length}, right{-view[1], view[0]};
    const Real half = std::tan(scene.pose.fov * kHalfTurn / 360), width = scene.screen.width;
    int wrong = 0;
    seen = 0;
    for (int x = 0; x < scene.screen.width; x += 4) {
        const Real across = half * (2 * (x + 0.5L) / width - 1);
        Real ahead = 0;
        const Real u =
            nearest_on_ray<Curve>(eye, {view[0] + across * right[0], view[1] + across * right[1]}, ahead);
        for (int y = 40; y < 80; ++y) {
            Point<double> p{};
            int piece = 0;
            if (!map.exact(x + 0.5, y + 0.5, 0, p, piece)) continue;
            ++seen;
            wrong += !(std::fabs(p.x / scene.picture.width - u) <= 1e-7L);
        }
    }
    return wrong;
}

TEST(DrapeSheets, SheetsAMillionthApartAreSeenInTheirOrder) {
    for (const double tol : {1.0, 0.125}) {
        int seen = 0;
        // The ends of the curve, and its silhouettes, are a column.
        EXPECT_LE(wrong_points<Spiral>(DrapeScheme::exact, tol, seen), 40) << tol;
        EXPECT_GT(seen, 700);
        // Facets do not tell.
        EXPECT_GT(wrong_points<Spiral>(DrapeScheme::automatic, tol, seen), seen / 4) << tol;
    }
}

TEST(DrapeSheets, ASurfaceThatGoesThroughItselfIsSeenInItsOrder) {
    for (const double tol : {4.0, 1.0, 0.125}) {
        int seen = 0;
        EXPECT_LE(wrong_points<Eight>(DrapeScheme::exact, tol, seen), 40) << tol;
        EXPECT_GT(seen, 700);
    }
}

}  // namespace
}  // namespace anamorph::test_drape_sheets
