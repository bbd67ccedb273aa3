// SPDX-License-Identifier: Apache-2.0
// Formulas that push: inverses hold their bounds against closed ones and against searches by brute force, whatever way they are read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/formula/pushed_plan.h"
#include "anamorph/formula/text_map.h"
#include "block_points.h"
#include "mesh_cases.h"

namespace anamorph {
namespace {

using Real = long double;
constexpr Real kPi = std::numbers::pi_v<Real>;
// With instruments in every operation, fewer of them are looked at.
#ifdef ANAMORPH_SANITIZED
constexpr bool kHasTime = false;
#else
constexpr bool kHasTime = true;
#endif

PlaneFormula pushing(const std::string& u, const std::string& v, const Size& picture, const Size& source,
                     const std::string& let = "") {
    FormulaText text;
    text.u = u;
    text.v = v;
    text.let = let;
    return parse_formula(text, {picture, source, 0, false, true});
}
PushedMap map_of(const std::string& u, const std::string& v, const Size& picture, const Size& source,
                 const std::string& let = "") {
    return {pushing(u, v, picture, source, let), picture, picture, source};
}

/// A formula, and its inverse worked out by hand.
struct Case {
    std::string name, let, u, v;
    Size source, picture;
    std::function<Point<Real>(Real x, Real y)> inverse;
};

/// r solves r + k r^3 = value, by bisection.
Real cubic_root(Real k, Real value) {
    Real low = 0, high = value + 1;
    for (int i = 0; i < 100; ++i) {
        const Real r = (low + high) / 2;
        (r + k * r * r * r < value ? low : high) = r;
    }
    return low;
}
std::vector<Case> cases() {
    const auto about = [](Real x, Real y, const Size& size) {
        const Real half = std::min(size.width, size.height) / Real{2};
        return Point<Real>{(x - size.width / Real{2}) / half, (size.height / Real{2} - y) / half};
    };
    return {
        {"affine",
         "",
         "2*x+y/3-40",
         "150-x/4+y",
         {200, 160},
         {300, 280},
         [](Real x, Real y) {
             const Real a = x + 40, b = y - 150;
             const Real right = (a - b / 3) / (2 + Real{1} / 12);
             return Point<Real>{right, b + right / 4};
         }},
        {"perspective",
         "w=1+s/2+t/4",
         "200*s/w",
         "150*t/w",
         {256, 192},
         {160, 120},
         [](Real x, Real y) {
             const Real a = x / 200, b = y / 150, w = 1 / (1 - a / 2 - b / 4);
             return Point<Real>{256 * a * w, 192 * b * w};
         }},
        // Each slope of the formula changes, but none of what is straightened.
        {"slanted perspective",
         "w=1+0.01*x",
         "(2*x+3*y)/w",
         "(2*y+0.1*x)/w",
         {64, 48},
         {128, 96},
         [](Real x, Real y) {
             const Real a = 2 - x / 100, c = Real{0.1L} - y / 100, det = 2 * a - 3 * c;
             return Point<Real>{(2 * x - 3 * y) / det, (a * y - c * x) / det};
         }},
        {"without a slope in the middle",
         "",
         "64+60*px^3",
         "2*y",
         {64, 48},
         {128, 96},
         [](Real x, Real y) {
             return Point<Real>{32 + 24 * std::cbrt((x - 64) / 60), y / 2};
         }},
        {"slanted crease",
         "",
         "2*x",
         "min(2*y,40+y+0.2*x)",
         {64, 48},
         {128, 96},
         [](Real x, Real y) {
             return Point<Real>{x / 2, y / 2 <= 40 + x / 10 ? y / 2 : y - 40 - x / 10};
         }},
        // Where the second half comes to lie on the first one, it is the one farther right.
        {"over itself",
         "",
         "if(x<50,x,x-20.3)",
         "y",
         {100, 80},
         {100, 80},
         [](Real x, Real y) {
             if (x >= 79.7L) return Point<Real>{-100, -100};
             return Point<Real>{x < 29.7L ? x : x + 20.3L, y};
         }},
        // The square of a complex number; of its two roots the lower one, if that lies in the source.
        {"squares",
         "p=x-30;q=y-20",
         "90+(p^2-q^2)/30",
         "60+2*p*q/30",
         {100, 80},
         {240, 200},
         [](Real x, Real y) {
             const Real re = 30 * (x - 90), im = 30 * (y - 60), size = std::hypot(re, im);
             const Real b = std::sqrt((size - re) / 2), a = b > 0 ? im / (2 * b) : std::sqrt(re);
             const bool is_lower_inside = 30 + a >= 0 && 30 + a <= 100 && 20 + b <= 80;
             return is_lower_inside ? Point<Real>{30 + a, 20 + b} : Point<Real>{30 - a, 20 - b};
         }},
        // What lies beyond the source would be elsewhere.
        {"jumps at its edges",
         "",
         "width*mod(s,1)*(0.7+0.3*t)",
         "height*mod(t,1)*(0.8+0.2*s)",
         {90, 90},
         {140, 140},
         [](Real x, Real y) {
             const Real a = x / 140, b = y / 140;
             Real s = a, t = b;
             for (int n = 0; n < 200; ++n) {
                 s = 10 * a / (7 + 3 * t);
                 t = 5 * b / (4 + s);
             }
             return Point<Real>{90 * s, 90 * t};
         }},
        // The pixels of the middle row lie where the angle goes from pi to -pi.
        {"through angles",
         "",
         "width/2+height/2*r*cos(a)",
         "height/2-height/2*r*sin(a)",
         {65, 65},
         {65, 65},
         [](Real x, Real y) {
             return Point<Real>{x, y};
         }},
        {"mirrored",
         "",
         "width-x",
         "y+3",
         {90, 70},
         {90, 70},
         [](Real x, Real y) {
             return Point<Real>{90 - x, y - 3};
         }},
        {"swirl",
         "w=0.8*exp(-3*r^2)",
         "width/2+height/2*r*cos(a+w)",
         "height/2-height/2*r*sin(a+w)",
         {240, 240},
         {200, 200},
         [about](Real x, Real y) {
             const Point<Real> p = about(x, y, {200, 200});
             const Real r = std::hypot(p.x, p.y), a = std::atan2(p.y, p.x) - 0.8L * std::exp(-3 * r * r);
             return Point<Real>{120 + 120 * r * std::cos(a), 120 - 120 * r * std::sin(a)};
         }},
        {"barrel",
         "k=0.3;z=1+k*r^2",
         "width/2+80*px*z",
         "height/2-80*py*z",
         {200, 200},
         {240, 220},
         [](Real x, Real y) {
             const Real px = (x - 120) / 80, py = (110 - y) / 80, value = std::hypot(px, py);
             const Real z = value > 0 ? cubic_root(0.3L, value) / value : 1;
             return Point<Real>{100 + 100 * px * z, 100 - 100 * py * z};
         }},
        {"strip of a disc",
         "",
         "width*(0.5+a/(2*pi))",
         "height*(1-r)",
         {160, 160},
         {220, 90},
         [](Real x, Real y) {
             const Real a = 2 * kPi * (x / 220 - Real{0.5}), r = 1 - y / 90;
             return Point<Real>{80 + 80 * r * std::cos(a), 80 - 80 * r * std::sin(a)};
         }},
        {"disc of a strip",
         "",
         "width/2*(1+t*cos(2*pi*s))",
         "height/2*(1+t*sin(2*pi*s))",
         {300, 100},
         {180, 180},
         [](Real x, Real y) {
             const Real px = x / 90 - 1, py = y / 90 - 1;
             Real a = std::atan2(py, px) / (2 * kPi);
             if (a < 0) a += 1;
             return Point<Real>{300 * a, 100 * std::hypot(px, py)};
         }},
        {"logarithm",
         "",
         "width*log(1+3*s)/log(4)",
         "height*(exp(t)-1)/(exp(1)-1)",
         {180, 140},
         {200, 160},
         [](Real x, Real y) {
             return Point<Real>{180 * (std::pow(Real{4}, x / 200) - 1) / 3,
                                140 * std::log1p(y / 160 * (std::exp(Real{1}) - 1))};
         }},
        {"Mercator",
         "lat=pi*(0.5-t)*0.9",
         "x",
         "height/2-40*asinh(tan(lat))",
         {160, 200},
         {160, 240},
         [](Real x, Real y) {
             const Real lat = std::atan(std::sinh((120 - y) / 40));
             return Point<Real>{x, 200 * (Real{0.5} - lat / (kPi * Real{0.9}))};
         }},
        {"sinusoidal",
         "lat=pi*(0.5-t)",
         "width/2+(x-120)*cos(lat)",
         "y",
         {240, 120},
         {240, 120},
         [](Real x, Real y) {
             return Point<Real>{120 + (x - 120) / std::sin(kPi * y / 120), y};
         }},
        {"torn at odd places",
         "",
         "if(x<17.3,2*x,2*x+40)",
         "y+9.1*floor(y/20.7)",
         {64, 48},
         {168, 70},
         [](Real x, Real y) {
             const Real right = x < 34.6L ? x / 2 : (x - 40) / 2, k = std::floor(y / 29.8L),
                        down = y - 9.1L * k;
             const bool is_seen = (x < 34.6L || x >= 74.6L) && down < 20.7L * (k + 1);
             return is_seen ? Point<Real>{right, down} : Point<Real>{-100, -100};
         }},
        {"torn",
         "",
         "if(x<80,x,x+30)",
         "if(y<64,y,y+10)",
         {160, 128},
         {200, 140},
         [](Real x, Real y) {
             const Point<Real> none{-100, -100};
             if ((x >= 80 && x < 110) || (y >= 64 && y < 74)) return none;
             return Point<Real>{x < 80 ? x : x - 30, y < 64 ? y : y - 10};
         }},
        {"half of a disc", "", "x+sqrt(py)", "if(px>0.25,1/0,y)", {120, 120}, {120, 120}, [](Real x, Real y) {
             // Only above the middle, and left of px = 1/4.
             if (y >= 60) return Point<Real>{-100, -100};
             const Real right = x - std::sqrt((60 - y) / 60);
             return right < 75 ? Point<Real>{right, y} : Point<Real>{-100, -100};
         }}};
}

Case case_named(const std::string& name) {
    for (const Case& c : cases())
        if (c.name == name) return c;
    throw std::invalid_argument("no case is named " + name);
}

/// How far a point is within the source; negative outside.
Real depth(const Point<Real>& p, const Size& size) {
    return std::min({p.x, p.y, size.width - p.x, size.height - p.y});
}

struct Findings {
    int pixels = 0, exact = 0, over = 0, above_tol = 0, lost = 0, extra = 0;
    double worst = 0;
};

/// All pixels of all blocks against a closed inverse. Within a hair of the source's edge, or of a jump, a pixel may be seen or not.
Findings examine(const PushedPlan& plan, const Case& c) {
    Findings found;
    const double tol = plan.options().tol;
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region)) {
            found.above_tol += tol > 0 && !(block.bound <= tol);
            for (int j = block.box.y0; j < block.box.y1; ++j) {
                const test::BlockRow row(plan, block, j);
                for (int i = block.box.x0; i < block.box.x1; ++i) {
                    ++found.pixels;
                    found.exact += is_exact(block);
                    const Point<Real> truth = c.inverse(i + Real{0.5}, j + Real{0.5});
                    const Real inside = depth(truth, c.source);
                    Point<double> p{};
                    int piece = 0;
                    const bool is_seen =
                        test::has_points(block) || (block.kind == Block::Kind::exact &&
                                                    plan.BlockMap::exact(block, i + 0.5, j + 0.5, p, piece));
                    if (test::has_points(block)) p = row.at(i);
                    found.lost += !is_seen && inside > 1e-6L;
                    found.extra += is_seen && inside < -1e-6L;
                    if (!is_seen || inside <= 1e-6L) continue;
                    const double off = static_cast<double>(std::hypot(p.x - truth.x, p.y - truth.y));
                    // The truth is rounded, too.
                    found.over += !(off <= block.bound + 1e-14);
                    found.worst = std::max(found.worst, off);
                }
            }
        }
    return found;
}

TEST(PushedMap, BlocksHoldTheirBoundsAgainstClosedInverses) {
    int exact = 0, pixels = 0;
    for (const Case& c : cases())
        for (const Scheme scheme : {Scheme::automatic, Scheme::blocks, Scheme::residual, Scheme::exact})
            for (const double tol : {0.01, 1.0, 1e-4, 1e-8}) {
                if ((scheme != Scheme::automatic || !kHasTime) && tol != 0.01) continue;
                // On a crease the sides are not told apart by less than 2^-20, and a disc's middle is of all angles.
                if ((c.name == "slanted crease" || c.name == "through angles") && tol < 1e-4) continue;
                SCOPED_TRACE(testing::Message()
                             << c.name << ", scheme " << static_cast<int>(scheme) << ", tol " << tol);
                PlanOptions options;
                options.scheme = scheme;
                options.tol = tol;
                const PushedMap map = map_of(c.u, c.v, c.picture, c.source, c.let);
                const Findings found = examine(PushedPlan(map, options), c);
                EXPECT_EQ(found.pixels, c.picture.width * c.picture.height);
                EXPECT_EQ(found.over, 0) << found.worst;
                EXPECT_EQ(found.above_tol, 0);
                EXPECT_EQ(found.lost, 0);
                EXPECT_EQ(found.extra, 0);
                if (scheme != Scheme::automatic || tol != 0.01) continue;
                exact += found.exact;
                pixels += found.pixels;
            }
    EXPECT_LT(exact, pixels * 2 / 3);
}

// What is wrong about a cost makes plans slower.
TEST(PushedMap, NoBoundHangsOnACost) {
    for (const Case& c : cases()) {
        if (c.name != "swirl" && c.name != "sinusoidal") continue;
        const PushedMap map = map_of(c.u, c.v, c.picture, c.source, c.let);
        for (double PlanCosts::*which :
             {&PlanCosts::bound, &PlanCosts::further_bound, &PlanCosts::bound_pixels, &PlanCosts::polynomial,
              &PlanCosts::rounding, &PlanCosts::double_pixel})
            for (const double times : {0.25, 4.0})
                for (const double tol : {0.01, 1e-7}) {
                    if (!kHasTime && (times < 1 || tol < 0.01)) continue;
                    PlanOptions options;
                    options.tol = tol;
                    options.costs = PushedMap::kCosts;
                    *options.costs.*which *= times;
                    const Findings found = examine(PushedPlan(map, options), c);
                    EXPECT_EQ(found.over + found.above_tol + found.lost + found.extra, 0)
                        << c.name << " " << times << " " << tol;
                }
    }
}

// A level of a pyramid has fewer pixels than the formula speaks of.
TEST(PushedMap, IsReadAtOtherSizesOfThePicture) {
    // In the second, a column of pixels then lies where the formula has no slope.
    for (const char* name : {"swirl", "without a slope in the middle"}) {
        const Case c = case_named(name);
        const Size fewer{75, 60};
        const PushedMap map(pushing(c.u, c.v, c.picture, c.source, c.let), c.picture, fewer, c.source);
        Case small = c;
        small.inverse = [c, fewer](Real x, Real y) {
            return c.inverse(x * c.picture.width / fewer.width, y * c.picture.height / fewer.height);
        };
        const Findings found = examine(PushedPlan(map, {}), small);
        EXPECT_EQ(found.over + found.above_tol + found.lost + found.extra, 0) << name;
    }
}

// The last levels of a pyramid, and what a formula makes smaller than a pixel, have a picture as well.
TEST(PushedMap, LessThanAPixelIsNoLine) {
    const Case c = case_named("swirl");
    for (const Size& size : {Size{1, 1}, {2, 2}, {5, 3}}) {
        const PushedMap map(pushing(c.u, c.v, c.picture, c.source, c.let), c.picture, size, c.source);
        for (int j = 0; j < size.height; ++j)
            for (int i = 0; i < size.width; ++i) {
                const Point<Real> truth = c.inverse((i + Real{0.5}) * c.picture.width / size.width,
                                                    (j + Real{0.5}) * c.picture.height / size.height);
                Point<double> p{};
                int piece = 0;
                ASSERT_TRUE(map.exact(i + 0.5, j + 0.5, 0, p, piece)) << i << "," << j;
                EXPECT_LE(std::hypot(p.x - truth.x, p.y - truth.y), 1e-4) << i << "," << j;
            }
    }
    // Most of it is mirrored, so what is not is what comes last.
    const PushedMap small = map_of("20.502-.004*s+.01*max(s-.75,0)", "20.499+.002*t", {64, 48}, {32, 24});
    Point<double> p{};
    int piece = 0;
    ASSERT_TRUE(small.exact(20.5, 20.5, 0, p, piece));
    EXPECT_EQ(small.preimages(20.5, 20.5).count, 2);
    EXPECT_NEAR(p.x, 16, 1e-6);
    EXPECT_NEAR(p.y, 12, 1e-6);
}

/// Of a source whose first `share` of a side is cut on for ever, if it meets the target; the rest is one to one.
struct HardCell {
    double share;
    int* seen;
    SeenPart see(const Part& s, const Part&, const Bounds& target) const {
        ++*seen;
        SeenPart part{target, 8, std::nullopt, s.half * 16 > share};
        if (s.middle - s.half >= share) part.sheet = Sheet::of_fold(0, s, s, {});
        return part;
    }
    Sheet fold(const Part& s, const Part& t) const { return Sheet::of_fold(0, s, t, {}); }
};

// By what the first parts do of the source it is foreseen whether all of it takes too many.
TEST(PushedMap, WhatIsHopelessIsGivenUpEarly) {
    constexpr std::size_t kMost = SheetCutter::kFirst * 4;
    const auto seen_with = [](int cuts, double foreseen, bool* all) {
        int seen = 0;
        SheetCutter cutter({0, 0, 1, 1}, {1, cuts, kMost, 0, foreseen});
        *all = cutter.cut(HardCell{0.25, &seen});
        return seen;
    };
    bool all = true;
    EXPECT_EQ(seen_with(40, HUGE_VAL, &all), static_cast<int>(kMost + 1));
    EXPECT_FALSE(all);
    EXPECT_LE(seen_with(40, 4.0 * kMost, &all), static_cast<int>(SheetCutter::kFirst + 2));
    EXPECT_FALSE(all);
    // Its quarter takes 2^16 parts, and the rest few.
    EXPECT_LT(seen_with(17, 4.0 * kMost, &all), static_cast<int>(kMost));
    EXPECT_TRUE(all);
}

/// All source points of a target point, by Newton's method from everywhere, in long double.
std::vector<Point<Real>> searched(const std::function<Point<Real>(Real, Real)>& f, const Size& source, Real x,
                                  Real y) {
    std::vector<Point<Real>> found;
    constexpr int kPerPixel = 2;
    for (int j = 0; j < source.height * kPerPixel; ++j)
        for (int i = 0; i < source.width * kPerPixel; ++i) {
            Point<Real> p{(i + Real{0.5}) / kPerPixel, (j + Real{0.5}) / kPerPixel};
            const Point<Real> first = f(p.x, p.y);
            if (std::max(std::fabs(first.x - x), std::fabs(first.y - y)) > 6) continue;
            for (int n = 0; n < 40; ++n) {
                constexpr Real kStep = 1e-7L;
                const Point<Real> at = f(p.x, p.y), right = f(p.x + kStep, p.y), left = f(p.x - kStep, p.y),
                                  down = f(p.x, p.y + kStep), up = f(p.x, p.y - kStep);
                const Real a = (right.x - left.x) / (2 * kStep), b = (down.x - up.x) / (2 * kStep),
                           c = (right.y - left.y) / (2 * kStep), d = (down.y - up.y) / (2 * kStep),
                           det = a * d - b * c;
                const Real ex = at.x - x, ey = at.y - y;
                p.x -= (d * ex - b * ey) / det;
                p.y -= (a * ey - c * ex) / det;
            }
            const Point<Real> at = f(p.x, p.y);
            if (!(std::hypot(at.x - x, at.y - y) < 1e-12L) || depth(p, source) < 0) continue;
            const auto is_near = [&](const Point<Real>& q) {
                return std::hypot(p.x - q.x, p.y - q.y) < 1e-6L;
            };
            if (std::none_of(found.begin(), found.end(), is_near)) found.push_back(p);
        }
    return found;
}

// Where a formula folds, all source points are found, and the one that counts is the lowest of those that are not turned over.
TEST(PushedMap, FindsAllSourcePointsOfWhatFolds) {
    constexpr unsigned kSeed = 611;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    const Size size{24, 20};
    int several = 0;
    for (int n = 0; n < (kHasTime ? 4 : 2); ++n) {
        const double a = random.between(2, 5), b = random.between(2, 5), k = random.between(0.3, 0.7),
                     l = random.between(0.3, 0.7);
        const auto text = [](double value) {
            std::ostringstream out;
            out.precision(17);
            out << value;
            return out.str();
        };
        // From the left to the right, most of it is turned over, and what is not is what comes last.
        const bool is_mirrored = n % 2 == 1;
        const std::string across = "x+" + text(a) + "*sin(" + text(k) + "*(x+y))";
        const PushedMap map = map_of(is_mirrored ? "width-(" + across + ")" : across,
                                     "y+" + text(b) + "*sin(" + text(l) + "*(y-x))", size, size);
        const auto f = [=](Real x, Real y) {
            const Real u = x + a * std::sin(Real{k} * (x + y));
            return Point<Real>{is_mirrored ? size.width - u : u, y + b * std::sin(Real{l} * (y - x))};
        };
        const PlanOptions options;
        const PushedPlan plan(map, options);
        for (int j = n % 2; j < size.height; j += 3)
            for (int i = n / 2; i < size.width; i += 4) {
                const Real x = i + Real{0.5}, y = j + Real{0.5};
                std::vector<Point<Real>> all = searched(f, size, x, y);
                const Preimages found = map.preimages(i + 0.5, j + 0.5);
                if (found.on_fold) continue;
                ASSERT_EQ(found.count, all.size()) << n << ": " << i << "," << j;
                if (all.empty()) continue;
                several += all.size() > 1;
                const auto is_turned = [&](const Point<Real>& p) {
                    const Real ux = 1 + a * k * std::cos(Real{k} * (p.x + p.y)), uy = ux - 1,
                               vy = 1 + b * l * std::cos(Real{l} * (p.y - p.x)), vx = 1 - vy;
                    return ux * vy - uy * vx < 0;
                };
                const auto best =
                    *std::min_element(all.begin(), all.end(), [&](const auto& p, const auto& q) {
                        return std::tuple(is_turned(p), -p.y, -p.x) < std::tuple(is_turned(q), -q.y, -q.x);
                    });
                EXPECT_LE(std::hypot(found.best.at.x - best.x, found.best.at.y - best.y),
                          found.error + 1e-12L)
                    << n << ": " << i << "," << j;
            }
    }
    EXPECT_GT(several, kHasTime ? 30 : 5);
}

// Jets of the inverse of a swirl are those of the swirl the other way round, which is read as it stands.
TEST(PushedMap, JetsAreThoseOfTheOtherWayRound) {
    const Size size{256, 256};
    const std::string turn = "w=0.8*exp(-3*r^2)", x = "128+128*r*cos(a", y = "128-128*r*sin(a";
    const PushedMap pushed = map_of(x + "+w)", y + "+w)", size, size, turn);
    FormulaText text;
    text.let = turn;
    text.u = x + "-w)";
    text.v = y + "-w)";
    const TextMap pulled(parse_formula(text, {size, size}), size, size, size);
    constexpr unsigned kSeed = 612;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    int boxes = 0, tight = 0;
    for (int n = 0; n < 300; ++n) {
        const double w = random.between(0.5, 12), h = random.between(0.5, 12), cx = random.between(20, 236),
                     cy = random.between(20, 236);
        const auto local = pushed.local_around(cx, cy, 0);
        const Interval across(cx - w, cx + w), down(cy - h, cy + h);
        if (pushed.cover(across, down, 0, local, true) != Cover::inside) continue;
        ++boxes;
        const auto variables = [&](auto number, const auto& at_x, const auto& at_y) {
            using J = decltype(number);
            return Point<J>{J::variable(at_x, 1, 0), J::variable(at_y, 0, 1)};
        };
        const simd::BoundJets jx = simd::BoundJets::variable({across, across, cx, across}, {1, 1, 1, 1},
                                                             {0, 0, 0, 0}),
                              jy = simd::BoundJets::variable({down, down, cy, down}, {0, 0, 0, 0},
                                                             {1, 1, 1, 1});
        const Point<simd::BoundJets> bound = pushed(jx, jy, local);
        const simd::TaylorJets tx = simd::TaylorJets::variable({cx, cx, cx, cx}, {w, w, w, w}, {0, 0, 0, 0}),
                               ty = simd::TaylorJets::variable({cy, cy, cy, cy}, {0, 0, 0, 0}, {h, h, h, h});
        const Point<simd::TaylorJets> taylor = pushed(tx, ty, local);
        using R = Rounded<double>;
        const Point<R> rounded = pushed(R(Interval(cx), w, 0), R(Interval(cy), h, 0), local);
        // They are rounded, too: by some 1e-15 of what they are.
        using L = Jet<double, 4>;
        const Point<L> truth = pulled.source_point(L::variable(cx, w, 0), L::variable(cy, 0, h));
        double off_x = 0, off_y = 0;
        for (int k = 0; k < L::kSize; ++k) {
            off_x += std::fabs(truth.x.c[k] - taylor.x.c[k][1]);
            off_y += std::fabs(truth.y.c[k] - taylor.y.c[k][1]);
        }
        // Coefficients are rounded, besides their point.
        const double point = pushed.exact_error<double>(Interval(cx), Interval(cy), 0);
        EXPECT_TRUE(rounded.x.error > point && rounded.y.error > point) << n;
        EXPECT_LE(off_x, rounded.x.error + 1e-12) << n;
        EXPECT_LE(off_y, rounded.y.error + 1e-12) << n;
        tight += std::max(rounded.x.error, rounded.y.error) < 1e-9;
        for (int m = 0; m < 5; ++m) {
            using J = Jet<double, 5>;
            const double px = m ? random.between(across.lo, across.hi) : cx,
                         py = m ? random.between(down.lo, down.hi) : cy;
            const Point<J> p = pulled.source_point(variables(J(), px, py).x, variables(J(), px, py).y);
            for (int k = 0; k < J::kSize; ++k) {
                const double hair = 1e-9 * std::fabs(p.x.c[k]) + 1e-9 * std::fabs(p.y.c[k]) + 1e-11;
                EXPECT_LE(bound.x.c[k].lo[0] - hair, p.x.c[k]) << n << " " << k;
                EXPECT_GE(bound.x.c[k].hi[0] + hair, p.x.c[k]) << n << " " << k;
                EXPECT_LE(bound.y.c[k].lo[0] - hair, p.y.c[k]) << n << " " << k;
                EXPECT_GE(bound.y.c[k].hi[0] + hair, p.y.c[k]) << n << " " << k;
            }
        }
    }
    EXPECT_GT(boxes, 100);
    EXPECT_GT(tight, boxes / 2);
}

TEST(PushedMap, PixelsWithoutAPointAreCounted) {
    for (const Case& c : cases()) {
        const PushedMap map = map_of(c.u, c.v, c.picture, c.source, c.let);
        std::int64_t missing = 0, unsure = 0;
        for (int j = 0; j < c.picture.height; ++j)
            for (int i = 0; i < c.picture.width; ++i) {
                const Real inside = depth(c.inverse(i + Real{0.5}, j + Real{0.5}), c.source);
                missing += inside < 0;
                unsure += std::fabs(inside) <= 1e-6L;
            }
        const std::int64_t counted = map.undefined_pixels({0, 0, c.picture.width, c.picture.height});
        EXPECT_LE(std::llabs(counted - missing), unsure) << c.name;
    }
}

// A pixel whose source point is a fold's own: it is found, and its bound says how far off that may be.
TEST(PushedMap, BoundsSpanWhatIsOnAFold) {
    const Size size{20, 12};
    const PushedMap map = map_of("(x-10.3)^2/10+5.5", "y", size, size);
    for (int j = 0; j < size.height; ++j) {
        Point<double> p{};
        int piece = 0;
        ASSERT_TRUE(map.exact(5.5, j + 0.5, 0, p, piece));
        const double off = std::hypot(p.x - 10.3, p.y - (j + 0.5));
        EXPECT_GT(off, 0);
        EXPECT_LE(off, map.exact_error<double>(Interval(5.5), Interval(j + 0.5), 0));
        EXPECT_LT(off, 1e-5);
    }
}

// In pairs of doubles points are closer than in double, and kept in double within their bounds.
TEST(PushedMap, PointsInPairsOfDoublesHoldTheirBounds) {
    for (const Case& c : cases()) {
        if (c.name != "logarithm" && c.name != "perspective" && c.name != "Mercator") continue;
        const PushedMap map = map_of(c.u, c.v, c.picture, c.source, c.let);
        for (int j = 3; j < c.picture.height; j += 7)
            for (int i = 2; i < c.picture.width; i += 5) {
                const Interval x(i + 0.5), y(j + 0.5);
                const Point<Real> truth = c.inverse(i + Real{0.5}, j + Real{0.5});
                Point<DoubleDouble> found{};
                int piece = 0;
                if (depth(truth, c.source) < 1e-6L) continue;
                ASSERT_TRUE(map.exact<DoubleDouble>(i + 0.5, j + 0.5, 0, found, piece));
                const Point<Real> p{static_cast<Real>(found.x), static_cast<Real>(found.y)};
                const double off = static_cast<double>(
                    std::hypot(static_cast<double>(p.x) - truth.x, static_cast<double>(p.y) - truth.y));
                EXPECT_LE(off, map.exact_error<DoubleDouble>(x, y, 0)) << c.name << " " << i << "," << j;
                EXPECT_LT(map.exact_error<DoubleDouble>(x, y, 0), map.exact_error<double>(x, y, 0)) << c.name;
                // Before it is kept in double: what rounding of the truth itself leaves.
                EXPECT_LE(std::hypot(p.x - truth.x, p.y - truth.y), 1e-15L) << c.name << " " << i << "," << j;
            }
    }
}

// Where creases cross, and along one that is a fold as well, source points are told apart.
TEST(PushedMap, PointsNearCreasesLeadBack) {
    const Size source{101, 77}, picture{160, 120};
    const PushedMap map =
        map_of("width*(0.5-0.9396*abs(s-0.7342)-0.1737*abs(t-0.8371))",
               "height*(0.3707*max(t,0.5668)+0.8653*min(t,0.2552)+0.1*s-0.07708)", picture, source);
    int seen = 0;
    for (int j = 0; j < picture.height; ++j)
        for (int i = 0; i < picture.width; ++i) {
            const Preimages all = map.preimages(i + 0.5, j + 0.5);
            if (all.count == 0) continue;
            ++seen;
            const Real s = all.best.at.x / Real{101}, t = all.best.at.y / Real{77};
            const Real u = 160 * (0.5L - 0.9396L * std::fabs(s - 0.7342L) - 0.1737L * std::fabs(t - 0.8371L)),
                       v = 120 * (0.3707L * std::max(t, Real{0.5668L}) +
                                  0.8653L * std::min(t, Real{0.2552L}) + 0.1L * s - 0.07708L);
            // Slopes are no larger than 2.
            EXPECT_LE(std::hypot(u - (i + 0.5L), v - (j + 0.5L)), 2 * all.error + 1e-12L) << i << "," << j;
            EXPECT_LE(all.error, 1e-5) << i << "," << j;
        }
    EXPECT_GT(seen, 1000);
}

// Source points in one row are not told apart by how they are rounded.
TEST(PushedMap, OfOneRowTheRightmostCounts) {
    const Size size{64, 48};
    const PushedMap map = map_of("mod(4.6*x,64)", "1.278*y", size, size);
    for (int j = 0; j < 48; ++j)
        for (int i = 0; i < 64; ++i) {
            const Preimages all = map.preimages(i + 0.5, j + 0.5);
            ASSERT_GT(all.count, 3);
            double right = (i + 0.5) / 4.6;
            while (right + 64 / 4.6 < 64) right += 64 / 4.6;
            EXPECT_NEAR(all.best.at.x, right, 1e-9) << i << "," << j;
        }
}

TEST(PushedMap, WhatCannotBeInvertedIsRefused) {
    const Size size{100, 80};
    for (const auto& [u, v] :
         std::vector<std::pair<std::string, std::string>>{{"if(x+y<90,x,x+30)", "y"},
                                                          {"1e308*x*x", "y"},
                                                          {"if(x+0.3*y<40,2*x,2*x+0.001)", "2*y"},
                                                          {"5", "7"},
                                                          {"2*x+y", "4*x+2*y"}}) {
        constexpr std::size_t kMostParts = 1 << 14;
        try {
            const PushedMap map(pushing(u, v, size, size), size, size, size, kMostParts);
            ADD_FAILURE() << u;
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("the formula ")) << u;
        }
    }
    // Nothing of these lies in the picture.
    for (const auto& [u, v] :
         std::vector<std::pair<std::string, std::string>>{{"x+1000", "y"}, {"log(-1-x)", "y"}}) {
        const PushedMap map = map_of(u, v, size, size);
        EXPECT_EQ(map.undefined_pixels({0, 0, 100, 80}), 8000) << u;
    }
}

}  // namespace
}  // namespace anamorph
