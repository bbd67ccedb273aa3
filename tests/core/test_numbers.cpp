// SPDX-License-Identifier: Apache-2.0
// Every formula of map/projection/, of deformations and of feature lines, read with every number; and with one that
// the library does not know: the float of 24 bits that pixel shaders of 2003 had.
#include "anamorph/number/number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/deform/deformation.h"
#include "anamorph/map/feature_lines.h"
#include "projection_cases.h"

namespace anamorph::test {

/// 1 bit of sign, 7 of exponent, 16 of fraction; rounded to nearest after every operation.
struct Float24 {
    double value = 0;

    Float24() = default;
    Float24(double exact) {  // NOLINT: a number is one, rounded
        int exponent = 0;
        const double fraction = std::frexp(exact, &exponent);
        value = std::ldexp(std::nearbyint(std::ldexp(fraction, 17)), exponent - 17);
        if (exponent < -62) value = 0;
        if (exponent > 64) value = std::copysign(HUGE_VAL, exact);
    }
    friend Float24 operator-(Float24 a) { return -a.value; }
    friend Float24 operator+(Float24 a, Float24 b) { return a.value + b.value; }
    friend Float24 operator-(Float24 a, Float24 b) { return a.value - b.value; }
    friend Float24 operator*(Float24 a, Float24 b) { return a.value * b.value; }
    friend Float24 operator/(Float24 a, Float24 b) { return a.value / b.value; }
    friend Float24 square(Float24 a) { return a * a; }
    friend Float24 sqrt(Float24 a) { return std::sqrt(a.value); }
    friend Float24 root(Float24 a) { return std::sqrt(a.value); }
    friend void sin_cos(Float24 a, Float24& s, Float24& c) { s = std::sin(a.value), c = std::cos(a.value); }
    friend Float24 atan2(Float24 b, Float24 a) { return std::atan2(b.value, a.value); }
    friend Float24 exp(Float24 a) { return std::exp(a.value); }
    friend Float24 log(Float24 a) { return std::log(a.value); }
    friend Float24 asinh(Float24 a) { return std::asinh(a.value); }
    friend Float24 min(Float24 a, Float24 b) { return std::min(a.value, b.value); }
    friend Float24 max(Float24 a, Float24 b) { return std::max(a.value, b.value); }
    friend bool is_zero(Float24 a) { return a.value == 0; }
    friend bool is_negative(Float24 a) { return a.value < 0; }
    friend Float24 without_hair(Float24 a) { return a.value < 0 && a.value > -1e-3 ? Float24(0) : a; }
    friend Float24 scaled_sinh(Float24 a, Float24& s) {
        s = std::tanh(a.value);
        return 1 / std::cosh(a.value);
    }
    friend double enlarger(Float24, Float24) { return 1; }
};

}  // namespace anamorph::test

namespace anamorph {
namespace {

using test::Float24;

static_assert(FormulaNumber<double> && FormulaNumber<long double> && FormulaNumber<Interval>);
static_assert(FormulaNumber<Jet<double, 4>> && FormulaNumber<Jet<Interval, 2>>);
static_assert(FormulaNumber<Float24>);

double middle(double a) {
    return a;
}
double middle(long double a) {
    return static_cast<double>(a);
}
double middle(const Interval& a) {
    return 0.5 * (a.lo + a.hi);
}
double middle(Float24 a) {
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

template <class T>
class Numbers : public testing::Test {
  public:
    /// Of the size of the number's own rounding.
    static constexpr double kClose = std::is_same_v<T, Float24> ? 2e-3 : 1e-9;
};

using AllNumbers = testing::Types<double, long double, Interval, Rounded<double>, Jet<double, 1>,
                                  Jet<double, 4>, Jet<Interval, 1>, Jet<Interval, 3>, Float24>;
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
using DeformationNumbers =
    testing::Types<double, long double, Interval, Jet<double, 2>, Jet<Interval, 2>, Float24>;
TYPED_TEST_SUITE(FormulaNumbers, DeformationNumbers);

TYPED_TEST(FormulaNumbers, ReadKernelsOfDeformations) {
    using T = TypeParam;
    for (const double squared : {0.04, 0.3, 0.81}) {
        EXPECT_NEAR(middle(gaussian_of(T(squared))), std::exp(-squared), TestFixture::kClose);
        const double r = std::sqrt(squared);
        EXPECT_NEAR(middle(wendland_of(T(squared))), std::pow(1 - r, 4) * (4 * r + 1), TestFixture::kClose);
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
