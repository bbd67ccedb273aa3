// SPDX-License-Identifier: Apache-2.0
// Distortion both ways, with every number, up to where lenses fold; against the formulas written out in long double.
#include "anamorph/chart/lens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "anamorph/chart/chart_formulas.h"
#include "anamorph/error.h"
#include "panorama_oracle.h"

namespace anamorph {
namespace {

using oracle::chart_of;
using oracle::LensOracle;
using oracle::View;
using testing::HasSubstr;
using Real = long double;

constexpr unsigned kSeed = 1966;
constexpr int kWidth = 1500, kHeight = 1000;

View view_of(const std::string& lens) {
    return oracle::view_through(lens, {kWidth, kHeight}, 100);
}

const char* const kLenses[] = {"ptlens:a=0.01,b=-0.03,c=0.02",
                               "ptlens:a=-0.02,b=0.05,c=-0.03,d=12.5,e=-40",
                               "ptlens:a=0.01,b=-0.03,g=60,t=-45,d=12.5,e=-40",
                               "ptlens:b=-0.45",  // folds a little beyond the inner circle
                               "ptlens:a=-0.2",
                               "ptlens",
                               "brown:k1=-0.2,k2=0.05,k3=-0.004",
                               "brown:k1=0.3,k2=0.1,d=-7",
                               "brown:k1=0.1,k2=0.02,k3=0.001,k4=0.15,k5=0.01,k6=0.002",
                               "brown:k4=0.3",
                               "brown:k1=-0.1,k2=0.02,p1=0.002,p2=-0.003",
                               "brown:p1=-0.01,d=30",
                               "brown:k1=-0.1,k2=0.02,s1=0.002,s2=-0.001,s3=-0.003,s4=0.0005",
                               "brown:k1=0.1,p1=0.002,p2=-0.001,s1=-0.003,s2=0.0004,d=9",
                               "brown:k1=0.05,k4=0.02,p1=0.005,p2=0.02,e=-20",
                               "3de4:k1=0.1,k2=0.03",
                               "3de4:k1=-0.25,d=20,e=10",
                               "3de4:k1=-0.5,k2=0.2",
                               "division:k1=-0.25",
                               "division:k1=0.2,k2=-0.05,d=-15,e=8",
                               "poly:k0=0.03,k2=-0.04,k4=0.005",
                               "poly:k0=-0.02,k1=0.02,k2=-0.03,k3=0.01,k4=0.002,d=7,e=-12",
                               "ocam:a0=-400,a2=5e-4,a3=-1e-7,a4=2e-10,d=4.5,e=-3",
                               "ocam:a0=500,a2=-2e-4,a4=-1e-10",
                               "ocam:a0=-400,a2=5e-4,affine_c=0.9,affine_d=0.02,affine_e=-0.04,e=-3",
                               "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003",
                               "kb4:k1=-0.1,k2=0.02,k3=-0.003,k4=0.0002,e=3"};

/// Points of the plane about a lens's centre, in the plane's unit: some near the centre, some near the end, all
/// within `reach`.
template <class Body>
void for_points(double reach, const Body& body) {
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 400; ++i) {
        const double r = reach * (i % 4 == 0   ? 1 - std::pow(10, -12 * uniform(random))
                                  : i % 4 == 1 ? std::pow(10, -12 * uniform(random))
                                               : uniform(random));
        const double angle = 7 * uniform(random);
        body(Point<double>{r * std::cos(angle), r * std::sin(angle)});
    }
}

/// The observed points of a lens.
template <class Body>
void for_observed(const Lens& lens, const Body& body) {
    const LensTerms& terms = lens.terms();
    for_points(lens.reach(), [&](const Point<double>& p) {
        body(Point<double>{p.x + terms.shift_x.value(), p.y + terms.shift_y.value()});
    });
}

TEST(Lens, ObservedPointsComeBack) {
    for (const char* text : kLenses) {
        const Chart chart = chart_of(view_of(text));
        const Lens& lens = *chart.lens();
        int tight = 0;
        for_observed(lens, [&](const Point<double>& p) {
            if (!(lens.inside(p) >= 0)) return;
            // Where a lens nearly folds, one of the ways is as steep as a root: the bound of rounding knows.
            const auto expect_back = [&](const auto& point, const auto& there_and_back) {
                using T = std::remove_cvref_t<decltype(point.x)>;
                using R = Rounded<T>;
                const Point<T> q = there_and_back(point);
                const Point<R> bound = there_and_back(Point<R>{R(double(point.x)), R(double(point.y))});
                EXPECT_FALSE(fabs(q.x - point.x) > bound.x.error) << text;
                EXPECT_FALSE(fabs(q.y - point.y) > bound.y.error) << text;
                tight += bound.x.error <= 1e4 * R::kUnit * lens.reach();
            };
            const auto by_ideal = [&](const auto& q) { return lens.observed(lens.ideal(q)); };
            const auto by_observed = [&](const auto& q) { return lens.ideal(lens.observed(q)); };
            expect_back(p, by_ideal);
            expect_back(Point<DoubleDouble>{p.x, p.y}, by_ideal);
            const Point<double> u = lens.ideal(p);
            expect_back(u, by_observed);
            expect_back(Point<DoubleDouble>{u.x, u.y}, by_observed);
        });
        EXPECT_GT(tight, 600) << text;
    }
}

TEST(Lens, FormulasAreThoseOfTheModels) {
    for (const char* text : kLenses) {
        const View view = view_of(text);
        const LensOracle truth(view);
        const Chart chart = chart_of(view);
        const Lens& lens = *chart.lens();
        const Real scale = oracle::scale(view).x;
        const auto to_pixels = [&](const Point<Real>& p) {
            return Point<Real>{p.x * scale + kWidth / 2, p.y * scale + kHeight / 2};
        };
        std::int64_t compared = 0;
        for_observed(lens, [&](const Point<double>& p) {
            if (!(lens.inside(p) > 1e-6)) return;
            const Point<Real> observed{p.x, p.y}, ideal = lens.ideal(observed);
            const Point<Real> expected = truth.ideal(view, to_pixels(observed));
            const Point<Real> found = to_pixels(ideal);
            EXPECT_NEAR(static_cast<double>(found.x - expected.x), 0, 1e-9)
                << text << ' ' << p.x << ' ' << p.y;
            EXPECT_NEAR(static_cast<double>(found.y - expected.y), 0, 1e-9)
                << text << ' ' << p.x << ' ' << p.y;
            const Point<Real> back = truth.observed(view, to_pixels(ideal));
            EXPECT_NEAR(static_cast<double>(back.x - to_pixels(observed).x), 0, 1e-9) << text;
            EXPECT_NEAR(static_cast<double>(back.y - to_pixels(observed).y), 0, 1e-9) << text;
            ++compared;
        });
        EXPECT_GT(compared, 300);
    }
}

// The radius rises to the lens's end and not beyond, where it folds.
TEST(Lens, EndsWhereItFolds) {
    const auto end_of = [](const char* text) {
        const Chart chart = chart_of(view_of(text));
        const LensTerms& terms = chart.lens()->terms();
        return terms.to_observed ? terms.ideal_end : terms.observed_end;
    };
    // R = r (1.45 - 0.45 r^2), r (1.2 - 0.2 r^3), r (1 - 0.25 r^2) and r - 0.2 r^3.
    EXPECT_NEAR(end_of("ptlens:b=-0.45"), std::sqrt(1.45 / 1.35), 1e-9);
    EXPECT_NEAR(end_of("ptlens:a=-0.2"), std::cbrt(1.2 / 0.8), 1e-9);
    EXPECT_NEAR(end_of("3de4:k1=-0.25"), std::sqrt(1 / 0.75), 1e-9);
    EXPECT_NEAR(end_of("brown:k1=-0.2"), std::sqrt(1 / 0.6), 1e-9);
    EXPECT_LE(end_of("brown:k1=-0.2"), std::sqrt(1 / 0.6));
    for (const char* text : kLenses) {
        const View view = view_of(text);
        const LensOracle truth(view);
        const Chart chart = chart_of(view);
        const LensTerms& terms = chart.lens()->terms();
        const Real end = terms.to_observed ? terms.ideal_end : terms.observed_end;
        for (int i = 0; i < 1000; ++i)
            EXPECT_LT(truth.formula(end * i / 1000), truth.formula(end * (i + 1) / 1000)) << text;
    }
}

TEST(Lens, IntervalsEnclose) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const char* text : kLenses) {
        const Chart chart = chart_of(view_of(text));
        const Lens& lens = *chart.lens();
        double widest = 0;
        for_observed(lens, [&](const Point<double>& p) {
            const double w = lens.reach() * std::pow(10, -1 - 10 * uniform(random));
            const Point<Interval> box{{p.x - w, p.x + w}, {p.y - w, p.y + w}};
            const Point<Interval> ideal = lens.ideal(box), observed = lens.observed(box);
            for (int i = 0; i < 8; ++i) {
                const Point<Real> q{p.x + w * (2 * uniform(random) - 1), p.y + w * (2 * uniform(random) - 1)};
                if (lens.inside(q) >= 0) {
                    const Point<Real> r = lens.ideal(q);
                    EXPECT_TRUE(ideal.x.lo <= r.x && r.x <= ideal.x.hi) << text;
                    EXPECT_TRUE(ideal.y.lo <= r.y && r.y <= ideal.y.hi) << text;
                }
                if (lens.sees(q) >= 0) {
                    const Point<Real> r = lens.observed(q);
                    EXPECT_TRUE(observed.x.lo <= r.x && r.x <= observed.x.hi) << text;
                    EXPECT_TRUE(observed.y.lo <= r.y && r.y <= observed.y.hi) << text;
                }
            }
            if (w < 1e-9 && lens.inside(p) > 0.1) widest = std::max(widest, (ideal.x.hi - ideal.x.lo) / w);
        });
        EXPECT_LT(widest, 1000) << text;
    }
}

// The coefficients of a jet are derivatives: against differences of the function in long double.
TEST(Lens, JetsAreDerivatives) {
    for (const char* text : kLenses) {
        const Chart chart = chart_of(view_of(text));
        const Lens& lens = *chart.lens();
        const Point<double> p{0.31 * lens.reach(), -0.22 * lens.reach()};
        const double h = 1e-3 * lens.reach(), dx = 0.7 * h, dy = -0.4 * h;
        for (const bool to_ideal : {true, false}) {
            using J = Jet<double, 5>;
            const Point<J> at{J::variable(p.x, dx, 0), J::variable(p.y, dy, 0)};
            const Point<J> jet = to_ideal ? lens.ideal(at) : lens.observed(at);
            const auto value = [&](int i) {
                const Point<Real> q{p.x + Real(dx) * i, p.y + Real(dy) * i};
                return to_ideal ? lens.ideal(q).x : lens.observed(q).x;
            };
            // Central differences of order k over k! are the coefficients, but for h^2.
            const Real v[7] = {value(-3), value(-2), value(-1), value(0), value(1), value(2), value(3)};
            const Real differences[] = {(v[4] - v[2]) / 2, (v[4] - 2 * v[3] + v[2]) / 2,
                                        (v[5] - 2 * v[4] + 2 * v[2] - v[1]) / 12,
                                        (v[5] - 4 * v[4] + 6 * v[3] - 4 * v[2] + v[1]) / 24,
                                        (v[6] - 4 * v[5] + 5 * v[4] - 5 * v[2] + 4 * v[1] - v[0]) / 240};
            for (int k = 1; k <= 5; ++k)
                EXPECT_NEAR(
                    jet.x.at(k, 0), static_cast<double>(differences[k - 1]),
                    5e-3 * std::fabs(jet.x.at(k, 0)) + 1e-5 * std::pow(1e-3, k) * lens.reach() + 1e-18)
                    << text << ' ' << k << ' ' << to_ideal;
        }
    }
}

// Jets of intervals over a box hold the jets at its points.
TEST(Lens, JetsOfIntervalsEnclose) {
    for (const char* text : kLenses) {
        const Chart chart = chart_of(view_of(text));
        const Lens& lens = *chart.lens();
        const double w = 0.01 * lens.reach();
        const Point<double> p{0.31 * lens.reach(), -0.22 * lens.reach()};
        using I = Jet<Interval, 4>;
        using K = Jet<Real, 4>;
        const Point<I> box{I::variable({p.x - w, p.x + w}, 1, 0), I::variable({p.y - w, p.y + w}, 0, 1)};
        for (const bool to_ideal : {true, false}) {
            const Point<I> all = to_ideal ? lens.ideal(box) : lens.observed(box);
            for (int i = -1; i <= 1; ++i)
                for (int j = -1; j <= 1; ++j) {
                    const Point<K> at{K::variable(p.x + i * w, 1, 0), K::variable(p.y + j * w, 0, 1)};
                    const Point<K> one = to_ideal ? lens.ideal(at) : lens.observed(at);
                    for (int k = 0; k < K::kSize; ++k) {
                        EXPECT_TRUE(all.x.c[k].lo <= one.x.c[k] && one.x.c[k] <= all.x.c[k].hi) << text << k;
                        EXPECT_TRUE(all.y.c[k].lo <= one.y.c[k] && one.y.c[k] <= all.y.c[k].hi) << text << k;
                    }
                }
        }
    }
}

// Rounding is below its bound: of values, and of jets in all their coefficients together.
TEST(Lens, RoundingIsBelowItsBound) {
    using R = Rounded<double>;
    using J = Jet<double, 4>;
    using K = Jet<Real, 4>;
    for (const char* text : kLenses) {
        const View view = view_of(text);
        const Chart chart = chart_of(view);
        const Lens& lens = *chart.lens();
        int finite = 0;
        double most = 0;
        for_observed(lens, [&](const Point<double>& p) {
            if (!(lens.inside(p) >= 1e-3)) return;
            const double h = 1e-3 * lens.reach();
            const auto check = [&](const auto& through) {
                const Point<double> value = through(p);
                const Point<Real> truth = through(Point<Real>{p.x, p.y});
                const Point<R> bound = through(Point<R>{R(p.x), R(p.y)});
                const double off = static_cast<double>(std::fabs(value.x - truth.x));
                EXPECT_LE(off, bound.x.error) << text;
                most = std::max(most, off / bound.x.error);
                const Point<J> jet = through(Point<J>{J::variable(p.x, h, 0), J::variable(p.y, 0, h)});
                const Point<K> exact = through(Point<K>{K::variable(p.x, h, 0), K::variable(p.y, 0, h)});
                const Point<R> norm = through(Point<R>{R(p.x, h, 0), R(p.y, h, 0)});
                if (!(norm.x.error < 1e-6)) return;
                ++finite;
                Real sum = 0, size = 0;
                for (int k = 0; k < J::kSize; ++k) {
                    sum += std::fabs(jet.x.c[k] - exact.x.c[k]);
                    size += std::fabs(exact.x.c[k]);
                }
                EXPECT_LE(sum, norm.x.error) << text;
                EXPECT_LE(size, norm.x.computed_size()) << text;
            };
            check([&](const auto& point) { return lens.ideal(point); });
            if (lens.sees(p) >= 0) check([&](const auto& point) { return lens.observed(point); });
        });
        EXPECT_GT(finite, 100) << text;
        EXPECT_GT(most, 1e-4) << text;
    }
}

TEST(Lens, HalfThePixelsAreTheSameLens) {
    const Chart chart = chart_of(view_of("ptlens:a=0.02,b=-0.05,d=12,e=-40"));
    const Chart half = chart.resized(kWidth / 2, kHeight / 2);
    for (const double x : {10.0, 700.0, 1400.0}) {
        const Ray<double> a = chart.ray(x, 300.0), b = half.ray(x / 2, 150.0);
        EXPECT_NEAR(a.x / a.z, b.x / b.z, 1e-12);
        EXPECT_NEAR(a.y / a.z, b.y / b.z, 1e-12);
    }
}

TEST(LensModel, ReadsWhatItWrites) {
    for (const char* text : kLenses) {
        const LensModel model = LensModel::parse(text), again = LensModel::parse(model.text());
        EXPECT_EQ(again.kind, model.kind);
        EXPECT_EQ(again.values, model.values);
    }
    EXPECT_EQ(LensModel::parse("brown:k2=0.5,p1=-0.25,d=3").text(), "brown:k2=0.5,p1=-0.25,d=3");
    EXPECT_EQ(LensModel::parse("brown:s4=-0.5,s1=0.25,e=3").text(), "brown:s1=0.25,s4=-0.5,e=3");
    EXPECT_EQ(LensModel::parse("none").text(), "none");
    EXPECT_EQ(LensModel::parse("3de4:k2=1e-3").values, (std::vector<double>{0, 1e-3, 0, 0}));
}

void expect_refused(const std::string& text, const std::string& rule) {
    try {
        static_cast<void>(chart_of(view_of(text)));
        ADD_FAILURE() << text << " was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.parameter(), "lens");
        EXPECT_THAT(error.what(), HasSubstr(rule)) << text;
        EXPECT_THAT(error.what(), HasSubstr(text.substr(0, 4))) << text;
    }
}

TEST(LensModel, RefusesWhatItCannotRead) {
    expect_refused("", "must begin with one of none, ptlens, brown, 3de4, kb4, division, poly, ocam");
    expect_refused("plens:a=1", "must begin with one of");
    expect_refused("none:a=1", "none has no values");
    for (const char* text :
         {"ptlens:", "ptlens:k1=1", "ptlens:a=0.1,", "ptlens:=1", "ptlens: a=1", "ptlens:A=1"})
        expect_refused(text, "must be followed by values of a, b, c, g, t, d, e, as in ptlens:a=0.1");
    expect_refused("ptlens:a=0.1,a=0.2", "a must be given once");
    for (const char* text : {"brown:k1", "brown:k1=", "brown:k1=x", "brown:k1=1x", "brown:k1=nan",
                             "brown:k1=inf", "brown:k1=1e7", "brown:k1=-2000000", "brown:k1= 1"})
        expect_refused(text, "k1 must be a number from -1000000 to 1000000");
    expect_refused("brown:s2=nan", "s2 must be a number from -1000000 to 1000000");
    expect_refused("brown:s5=1",
                   "must be followed by values of k1, k2, k3, k4, k5, k6, p1, p2, s1, s2, s3, s4, d, e");
}

TEST(Lens, RefusesToFoldWithinThePicture) {
    // Radii in pixels: r (1.9 - 0.9 r^2) ends at 0.839 of 500, where it has become 1.0628 times as much.
    expect_refused("ptlens:b=-0.9,d=400", "folds at a radius of 531.3 pixels: must not within 900");
    expect_refused("ptlens:a=0.5,b=0.5,c=0.5", "folds at a radius of 0 pixels");
    expect_refused("brown:k1=-1", "folds at a radius of");
    // A tangential part takes up half of the rest before the picture folds.
    expect_refused("brown:p1=0.5", "ends at a radius of");
    expect_refused("brown:s1=0.5", "ends at a radius of");
    expect_refused("brown:s4=-0.5", "ends at a radius of");
    expect_refused("3de4:k1=-3", "folds at a radius of");
    expect_refused("division:k1=4", "folds at a radius of");
    expect_refused("kb4:k1=-2", "folds at a radius of");
    expect_refused("poly:k0=-1", "folds at a radius of 0 pixels");
    expect_refused("poly:k4=-1", "folds at a radius of");
    expect_refused("ocam:a2=1e-4", "folds at a radius of 0 pixels");
    expect_refused("ocam:a0=-400,a2=-0.005", "folds at a radius of");
    for (const char* affine : {"affine_c=0", "affine_c=-1", "affine_c=11", "affine_d=1.5", "affine_e=-2",
                               "affine_c=0.1,affine_d=0.5,affine_e=0.19"})
        expect_refused(std::string("ocam:a0=-400,") + affine,
                       "affine_c must be from 0.1 to 10, affine_d and affine_e from -1 to 1, and affine_c - "
                       "affine_d affine_e at least 0.01");
    expect_refused("ocam:a0=-400,affine_d=nan", "affine_d must be a number from");
    for (const char* sheared : {"ptlens:g=2001", "ptlens:g=-1e6", "ptlens:t=-2001", "ptlens:g=999,t=1495"})
        expect_refused(sheared, "g must be at most the picture's height and t its width");
    expect_refused("ptlens:g=inf", "g must be a number from");
}

TEST(Lens, IsRefusedWherePicturesHaveNone) {
    const auto rule = [](Projection projection, const char* text) -> std::string {
        try {
            const FaceGrid faces = faces_of(projection);
            const int across = std::max(1, faces.columns), down = std::max(1, faces.rows);
            const double fov = rows_turn(projection) ? 200 : 0;
            static_cast<void>(Chart(projection, 64 * across, 64 * down, fov, PixelSpacing::edges, "src", 1,
                                    LensModel::parse(text)));
        } catch (const Error& error) {
            EXPECT_EQ(error.parameter(), "srclens");
            return error.what();
        }
        return "";
    };
    for (const Projection p : kProjections) {
        const Lensed lensed = with_projection(p, [](auto formulas) { return formulas.lensed; });
        const bool none = lensed == Lensed::no;
        EXPECT_EQ(rule(p, "ptlens:b=0.01") != "", none) << name_of(p);
        const bool turns = p == Projection::cylindrical || p == Projection::equirectangular;
        EXPECT_EQ(rule(p, "3de4:k1=0.01") != "", none || turns) << name_of(p);
        EXPECT_EQ(rule(p, "division:k1=-0.01") != "", none || turns) << name_of(p);
        EXPECT_EQ(rule(p, "brown:k1=0.01") != "", p != Projection::rectilinear) << name_of(p);
        EXPECT_EQ(rule(p, "poly:k0=0.01") != "", none) << name_of(p);
        EXPECT_EQ(rule(p, "kb4:k1=0.01") != "", p != Projection::fisheye) << name_of(p);
        EXPECT_EQ(rule(p, "ocam:a0=-20") != "", p != Projection::stereographic) << name_of(p);
    }
    EXPECT_THAT(rule(Projection::cylindrical, "division:k1=0.1"),
                HasSubstr("must be ptlens or poly for cylindrical"));
    EXPECT_THAT(rule(Projection::cubemap, "ptlens"),
                HasSubstr("must be none for cubemap, which has no lens"));
    EXPECT_THAT(rule(Projection::fisheye, "brown:k1=1"), HasSubstr("brown must be of a rectilinear picture"));
}

}  // namespace
}  // namespace anamorph
