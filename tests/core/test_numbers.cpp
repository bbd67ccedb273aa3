// SPDX-License-Identifier: Apache-2.0
// Every formula of chart/projection/, of deformations, of feature lines and of meshes, read with every number, those of
// hardware among them.
#include "anamorph/machine/number_format.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <type_traits>

#include "anamorph/chart/chart_formulas.h"
#include "anamorph/deform/deformation.h"
#include "anamorph/mesh/mesh.h"
#include "anamorph/morph/feature_lines.h"
#include "anamorph/panorama/panorama.h"
#include "anamorph/plan/residual.h"
#include "projection_cases.h"

namespace anamorph {
using namespace machine;
namespace {

using Float16 = FormatNumber<kFloat16>;
using Float24 = FormatNumber<kFloat24>;
using Float32 = FormatNumber<kFloat32>;
using Fixed16 = FormatNumber<kFixed16>;
using Fixed32 = FormatNumber<kFixed32>;

static_assert(FormulaNumber<double> && FormulaNumber<DoubleDouble> && FormulaNumber<Interval>);
static_assert(FormulaNumber<Jet<double, 4>> && FormulaNumber<Jet<Interval, 2>>);
static_assert(FormulaNumber<Float16> && FormulaNumber<Float24> && FormulaNumber<Fixed16> &&
              FormulaNumber<Fixed32>);

double middle(double a) {
    return a;
}
double middle(const DoubleDouble& a) {
    return static_cast<double>(a);
}
double middle(const Interval& a) {
    return 0.5 * (a.lo + a.hi);
}
template <NumberFormat kFormat>
double middle(const FormatNumber<kFormat>& a) {
    return a.value;
}
template <class Real>
double middle(const Rounded<Real>& a) {
    return middle(a.range);
}
template <class T, int N>
double middle(const Jet<T, N>& a) {
    return middle(a.c[0]);
}

constexpr double close_of(const void*) {
    return 1e-9;
}
template <NumberFormat kFormat>
constexpr double close_of(const FormatNumber<kFormat>*) {
    return kFormat == kFloat16 || kFormat == kFixed16 ? 0.1 : kFormat == kFloat32 ? 2e-5 : 2e-3;
}

template <class T>
class Numbers : public testing::Test {
  public:
    /// Of the size of the number's own rounding.
    static constexpr double kClose = close_of(static_cast<T*>(nullptr));
};

using AllNumbers =
    testing::Types<double, DoubleDouble, Interval, Rounded<double>, Jet<double, 1>, Jet<double, 4>,
                   Jet<Interval, 1>, Jet<Interval, 3>, Float16, Float24, Float32, Fixed16, Fixed32>;
TYPED_TEST_SUITE(Numbers, AllNumbers);

TYPED_TEST(Numbers, ReadEveryProjection) {
    using T = TypeParam;
    constexpr unsigned kSeed = 91;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(-0.8, 0.8);
    for (const Projection projection : kProjections) {
        Setting setting;
        setting.half_width = 1;
        setting.reach = 1000;
        // The lower right one of an octahedron's quarters.
        setting.centre_x = setting.centre_y = 0.5;
        for (int i = 0; i < 50; ++i) {
            const double lift = projection == Projection::octahedral ? 0.9 : 0;
            const double x = 0.5 * (uniform(random) + lift), y = 0.5 * (uniform(random) + lift);
            with_projection(projection, [&](auto formulas) {
                const Ray<double> ray = formulas.ray(Point<double>{x, y}, setting);
                const Ray<T> r = formulas.ray(Point<T>{T(x), T(y)}, setting);
                const double near = TestFixture::kClose;
                EXPECT_NEAR(middle(r.x), ray.x, near) << name_of(projection);
                EXPECT_NEAR(middle(r.y), ray.y, near) << name_of(projection);
                EXPECT_NEAR(middle(r.z), ray.z, near) << name_of(projection);
                const Point<T> p = formulas.point(Ray<T>{T(ray.x), T(ray.y), T(ray.z)}, setting);
                EXPECT_NEAR(middle(p.x), x, 4 * near) << name_of(projection);
                EXPECT_NEAR(middle(p.y), y, 4 * near) << name_of(projection);
                EXPECT_GE(middle(formulas.inside(Point<T>{T(x), T(y)}, setting)), 0) << name_of(projection);
                EXPECT_GT(middle(formulas.sees(r, setting)), 0) << name_of(projection);
            });
        }
    }
}

TYPED_TEST(Numbers, ReadEveryLens) {
    using T = TypeParam;
    for (const char* text :
         {"ptlens:a=0.01,b=-0.03,c=0.02,d=5", "ptlens:b=0.03", "brown:k1=-0.2,k2=0.05,k4=0.02",
          "3de4:k1=0.1,k2=0.03", "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003"}) {
        const bool fisheye = std::string_view(text).starts_with("kb4");
        const Chart chart(fisheye ? Projection::fisheye : Projection::rectilinear, 300, 200, 100,
                          PixelSpacing::edges, "", 1, LensModel::parse(text));
        const Lens& lens = *chart.lens();
        for (const Point<double> p : {Point<double>{0.3, -0.2}, {0.01, 0.7}, {-0.6, 0.1}}) {
            const Point<double> ideal = lens.ideal(p), observed = lens.observed(p);
            const Point<T> q{T(p.x), T(p.y)}, i = lens.ideal(q), o = lens.observed(q);
            const double near = TestFixture::kClose;
            EXPECT_NEAR(middle(i.x), ideal.x, near) << text;
            EXPECT_NEAR(middle(i.y), ideal.y, near) << text;
            EXPECT_NEAR(middle(o.x), observed.x, near) << text;
            EXPECT_NEAR(middle(o.y), observed.y, near) << text;
            EXPECT_GT(middle(lens.inside(q)), 0) << text;
            EXPECT_GT(middle(lens.sees(q)), 0) << text;
        }
    }
}

template <class T>
class FormulaNumbers : public Numbers<T> {};
// Bounds of rounding are asked of projections only.
using DeformationNumbers = testing::Types<double, DoubleDouble, Interval, Jet<double, 2>, Jet<Interval, 2>,
                                          Float16, Float24, Float32, Fixed16, Fixed32>;
TYPED_TEST_SUITE(FormulaNumbers, DeformationNumbers);

TYPED_TEST(FormulaNumbers, ReadKernelsOfDeformations) {
    using T = TypeParam;
    for (const double squared : {0.04, 0.3, 0.81}) {
        EXPECT_NEAR(middle(gaussian_of(T(squared))), std::exp(-squared), TestFixture::kClose);
        const double r = std::sqrt(squared);
        EXPECT_NEAR(middle(wendland_of(T(squared))), std::pow(1 - r, 4) * (4 * r + 1), TestFixture::kClose);
    }
}

TYPED_TEST(FormulaNumbers, ReadHermitePatches) {
    using T = TypeParam;
    const std::array<double, 4> exact = hermite_basis(0.3);
    const std::array<T, 4> basis = hermite_basis(T(0.3));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(middle(basis[i]), exact[i], TestFixture::kClose);
}

TYPED_TEST(FormulaNumbers, ReadLinearParts) {
    using T = TypeParam;
    const LinearPart part{0, 0, {0.4, -0.3}, {0.25, 0.5}, {-0.125, 0.75}};
    const Point<T> at = part.at(T(0.3), T(-0.7));
    EXPECT_NEAR(middle(at.x), 0.4 + 0.25 * 0.3 + 0.125 * 0.7, TestFixture::kClose);
    EXPECT_NEAR(middle(at.y), -0.3 + 0.5 * 0.3 - 0.75 * 0.7, TestFixture::kClose);
}

TYPED_TEST(FormulaNumbers, ReadPanoramas) {
    using T = TypeParam;
    const Panorama map(Chart(Projection::cylindrical, 200, 60), Chart(Projection::rectilinear, 64, 64, 90),
                       {10, 5});
    for (const double x : {20.5, 40.5}) {
        const auto local = map.local_around(x, 30.5, 0);
        const Point<double> exact = map(x, 30.5, local);
        const Point<T> p = map(T(x), T(30.5), local);
        if constexpr (std::is_same_v<T, Fixed16>) {
            // Pixels are beyond -8 to 8, and it says so.
            EXPECT_TRUE(p.x.beyond && p.y.beyond);
            continue;
        }
        EXPECT_NEAR(middle(p.x), exact.x, 100 * TestFixture::kClose);
        EXPECT_NEAR(middle(p.y), exact.y, 100 * TestFixture::kClose);
    }
}

TEST(Float24Lines, ReadFeatureFormulas) {
    using namespace feature_detail;
    // A line along x from the origin: u |e| is x, v is y.
    const Float24 along = along_line(Float24(3.0), Float24(4.0), Float24(1.0), Float24(0.0));
    const Float24 beside = beside_line(Float24(3.0), Float24(4.0), Float24(1.0), Float24(0.0));
    EXPECT_EQ(along.value, 3);
    EXPECT_EQ(beside.value, 4);
    EXPECT_NEAR(displacement_by_line(Float24(0.5), Float24(0.1), along, Float24(-0.2), beside).value, 0,
                1e-4);
}

}  // namespace
}  // namespace anamorph
