// SPDX-License-Identifier: Apache-2.0
// Views whose rays, or the way back from them, are text, against rays written in C++, turned and projected in long double by code
// that shares nothing with what it judges.
#include "anamorph/panorama/formula_view.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <random>
#include <span>

#include "anamorph/panorama/formula_view_plan.h"
#include "anamorph/panorama/inverse_view_plan.h"
#include "block_points.h"
#include "each_instruction_set.h"
#include "panorama_oracle.h"

namespace anamorph::test_formula_view {
namespace {

using enum Projection;
using oracle::kPi;
using oracle::Real;
using oracle::Vector;
using oracle::View;

/// Rays of a view: x to the right, y up, z forward; false where there is none. px and py as in texts, s and t too.
using RayAt = std::function<bool(Real px, Real py, Real s, Real t, Vector& ray)>;

/// A view as text, and its rays.
struct Rays {
    const char* name;
    RayText text;
    RayAt at;
};
/// The same the other way.
struct Directions {
    const char* name;
    DirectionText text;
    RayAt at;
};

const Rays kRays[] = {
    {"flat",
     {},
     [](Real px, Real py, Real, Real, Vector& ray) {
         return ray = {px, py, 1}, true;
     }},
    {"fisheye",
     {"k*px", "k*py", "cos(r*pi/2)", {}, "k=if(r==0,pi/2,sin(r*pi/2)/r)"},
     [](Real px, Real py, Real, Real, Vector& ray) {
         const Real r = std::hypot(px, py), angle = std::atan2(py, px), t = r * kPi / 2;
         ray = {std::sin(t) * std::cos(angle), std::sin(t) * std::sin(angle), std::cos(t)};
         return true;
     }},
    {"all around",
     {"cos(e)*sin(l)", "sin(e)", "cos(e)*cos(l)", {}, "e=(0.5-t)*pi;l=(2*s-1)*pi"},
     [](Real, Real, Real s, Real t, Vector& ray) {
         const Real e = kPi / 2 - kPi * t, l = 2 * kPi * s - kPi;
         ray = {std::cos(e) * std::sin(l), std::sin(e), std::cos(e) * std::cos(l)};
         return true;
     }},
    {"planet",
     {"2*k*px", "2*k*py", "1-(k*r)^2", {{"k", "2.5"}}, "k=1"},
     [](Real px, Real py, Real, Real, Vector& ray) {
         // From the angle, twice that of the point seen from the far pole.
         const Real t = 2 * std::atan(2.5L * std::hypot(px, py)), angle = std::atan2(py, px);
         ray = {std::sin(t) * std::cos(angle), std::sin(t) * std::sin(angle), std::cos(t)};
         return true;
     }},
    {"with an edge",
     {"px+0.2*sin(5*py)", "py", "sqrt(0.8-r^2)"},
     [](Real px, Real py, Real, Real, Vector& ray) {
         const Real rest = 0.8L - px * px - py * py;
         ray = {px + 0.2L * std::sin(5 * py), py, std::sqrt(rest)};
         return rest > 0;
     }},
    {"two eyes",
     {"4*mod(s,0.5)-1", "py", "if(s<0.5,1,-1)"},
     [](Real, Real py, Real s, Real, Vector& ray) {
         ray = {s < 0.5L ? 4 * s - 1 : 4 * s - 3, py, s < 0.5L ? Real(1) : Real(-1)};
         return true;
     }},
    {"none in the middle",
     {"px", "py", "0"},
     [](Real px, Real py, Real, Real, Vector& ray) {
         return ray = {px, py, 0}, px != 0 || py != 0;
     }},
};

const View kSources[] = {{equirectangular, 512, 256, 360},
                         {cubemap, 96, 576, 90},
                         {fisheye, 300, 300, 200},
                         {rectilinear, 320, 240, 100},
                         {mercator, 400, 300, 360},
                         oracle::view_through("brown:k1=-0.1,k2=0.02", {300, 200}, 70),
                         oracle::view_through("kb4:k1=0.03", {300, 300}, 170)};

Vector direction(Real lon, Real lat) {
    return {std::cos(lat) * std::sin(lon), std::sin(lat), std::cos(lat) * std::cos(lon)};
}
/// Winkel tripel with its parallel at 60 degrees north, 1 for pi / 2 of latitude.
Point<Real> winkel(Real lon, Real lat) {
    const Real b = std::acos(std::cos(lat) * std::cos(lon / 2)), over = b == 0 ? 1 : b / std::sin(b);
    return {(lon * 0.5L + 2 * std::cos(lat) * std::sin(lon / 2) * over) / kPi,
            (lat + std::sin(lat) * over) / kPi};
}

const Directions kDirections[] = {
    {"all around",
     {},
     [](Real px, Real py, Real, Real, Vector& ray) {
         ray = direction(px * kPi / 2, py * kPi / 2);
         return std::fabs(px) <= 2 && std::fabs(py) <= 1;
     }},
    {"equal areas",
     {"lon*k", "sin(lat)", {}, "k=0.6"},
     [](Real px, Real py, Real, Real, Vector& ray) {
         ray = direction(px / 0.6L, std::asin(py));
         return std::fabs(px / 0.6L) <= kPi && std::fabs(py) <= 1;
     }},
    {"sinusoidal",
     {"lon*cos(lat)/2", "lat/2"},
     [](Real px, Real py, Real, Real, Vector& ray) {
         const Real lat = 2 * py, lon = 2 * px / std::cos(lat);
         ray = direction(lon, lat);
         return std::fabs(lat) <= kPi / 2 && std::fabs(lon) <= kPi;
     }},
    {"winkel",
     {"(lon*0.5+2*cos(lat)*sin(lon/2)*over)/(1.01*pi)",
      "(lat+sin(lat)*over)/(1.01*pi)",
      {},
      "q=sin(lat/2)^2+cos(lat)*sin(lon/4)^2;"
      "over=if(q<0.001,1+q*(2/3+q*(8/15+q*(16/35+q*128/315))),asin(sqrt(q))/sqrt(q*(1-q)))"},
     [](Real px, Real py, Real, Real, Vector& ray) {
         // No pixel is on the line that is the pole.
         px *= 1.01L;
         py *= 1.01L;
         // Newton's iteration with slopes by differences, from the flat picture.
         Real lon = px * kPi / 1.7L, lat = py * kPi / 2;
         for (int i = 0; i < 60; ++i) {
             const Real h = 1e-7L;
             const Point<Real> f = winkel(lon, lat), a = winkel(lon + h, lat), b = winkel(lon - h, lat),
                               c = winkel(lon, lat + h), d = winkel(lon, lat - h);
             const Real xx = (a.x - b.x) / (2 * h), yx = (a.y - b.y) / (2 * h), xy = (c.x - d.x) / (2 * h),
                        yy = (c.y - d.y) / (2 * h), x = px - f.x, y = py - f.y, of = xx * yy - xy * yx;
             lon = std::clamp(lon + (yy * x - xy * y) / of, -kPi * 1.1L, kPi * 1.1L);
             lat = std::clamp(lat + (xx * y - yx * x) / of, -kPi / 2 + 1e-6L, kPi / 2 - 1e-6L);
         }
         const Point<Real> f = winkel(lon, lat);
         ray = direction(lon, lat);
         return std::hypot(f.x - px, f.y - py) < 1e-15L && std::fabs(lon) < kPi;
     }},
};

struct Scene {
    const View& source;
    Size picture, target;
    Orientation look, held;
    PlanOptions options;

    FormulaSetting setting() const { return {picture, {source.width, source.height}}; }
    FormulaView map(const RayText& text) const {
        return {oracle::chart_of(source), parse_rays(text, setting()), picture, target, look, held};
    }
    InverseView map(const DirectionText& text) const {
        return {oracle::chart_of(source),
                parse_directions(text, setting(), InverseView::kGlobe),
                picture,
                target,
                look,
                held};
    }
    /// The source's ray of a point of the target.
    bool ray(const RayAt& at, Real x, Real y, Vector& ray) const {
        x = x * picture.width / target.width;
        y = y * picture.height / target.height;
        const Real half = std::min(picture.width, picture.height) / Real(2);
        const Real px = (x - picture.width / Real(2)) / half, py = (picture.height / Real(2) - y) / half;
        if (!at(px, py, x / picture.width, y / picture.height, ray)) return false;
        const Real length = std::hypot(ray.x, ray.y, ray.z);
        ray = {ray.x / length, -ray.y / length, ray.z / length};
        ray = oracle::turned_back(oracle::rotated(ray, look), held);
        return true;
    }
};

Real distance(const View& source, const Point<double>& used, const Point<Real>& truth) {
    Real dx = used.x - truth.x;
    if (source.projection == equirectangular || source.projection == mercator)
        dx -= std::round(dx / source.width) * source.width;
    return std::hypot(dx, used.y - truth.y);
}

/// In the image, a hair within.
bool well_inside(const View& v, const Piece& piece, const Point<Real>& p) {
    const Box box = has_faces(v.projection) ? piece.box : Box{0, 0, v.width, v.height};
    return p.x > box.x0 + 0.01L && p.x < box.x1 - 0.01L && p.y > box.y0 + 0.01L && p.y < box.y1 - 0.01L;
}

struct Findings {
    int pixels = 0, in_blocks = 0, over_bound = 0, over_tol = 0, lost = 0, seen_without_ray = 0;
};

template <class Plan>
Findings examine(const Scene& scene, const Plan& plan, const RayAt& ray_at) {
    Findings found;
    const std::vector<Piece>& pieces = plan.map().source().pieces();
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region))
            for (int j = block.box.y0; j < block.box.y1; ++j) {
                const test::BlockRow row(plan, block, j);
                for (int i = block.box.x0; i < block.box.x1; ++i) {
                    ++found.pixels;
                    Vector ray{};
                    const bool has_ray = scene.ray(ray_at, i + 0.5L, j + 0.5L, ray);
                    Point<double> used{};
                    int piece = block.source_piece;
                    bool seen = test::has_points(block);
                    found.in_blocks += seen;
                    if (seen)
                        used = row.at(i);
                    else if (block.kind == Block::Kind::exact)
                        seen = static_cast<const BlockMap&>(plan).exact(block, i + 0.5, j + 0.5, used, piece);
                    if (!seen) {
                        for (const Piece& p : pieces)
                            found.lost += has_ray && well_inside(scene.source, p,
                                                                 oracle::point_of(scene.source, p, ray));
                        continue;
                    }
                    if (!has_ray) {
                        // On the edge, as far as long double tells, the bound says that nothing is known.
                        found.seen_without_ray += std::isfinite(block.bound);
                        continue;
                    }
                    const Piece& on = pieces[static_cast<std::size_t>(piece)];
                    const Real error = distance(scene.source, used, oracle::point_of(scene.source, on, ray));
                    found.over_bound += !(error <= block.bound);
                    found.over_tol += test::has_points(block) && !(error <= scene.options.tol);
                }
            }
    return found;
}

/// Turned, of several sizes, by all schemes.
template <class Plan, class Formula>
int expect_truth(const Formula& view, std::span<const View> sources, const std::vector<Scheme>& schemes,
                 std::mt19937& random, int& scenes) {
    const auto angle = [&](double most) { return std::uniform_real_distribution<>(-most, most)(random); };
    const Size sizes[] = {{160, 120}, {65, 65}, {48, 97}};
    const double tols[] = {0.01, 0.125, 1e-4, 1e-7, 0};
    int in_blocks = 0;
    for (const View& source : sources)
        for (const Scheme scheme : schemes) {
            const Size& picture = sizes[scenes % 3];
            const bool is_level = scenes % 5 == 4;
            const Size target = is_level ? Size{picture.width / 2, picture.height / 2} : picture;
            PlanOptions options;
            options.scheme = scheme;
            options.tol = tols[scenes++ % 5];
            const Orientation look{angle(180), angle(90), angle(180)};
            const Orientation held =
                scenes % 2 ? Orientation{} : Orientation{angle(180), angle(90), angle(180)};
            SCOPED_TRACE(std::string(view.name) + " in " + std::string(name_of(source.projection)) +
                         " scheme " + std::to_string(static_cast<int>(scheme)) + " tol " +
                         std::to_string(options.tol) + " yaw " + std::to_string(look.yaw));
            const Scene scene{source, picture, target, look, held, options};
            const Findings found = examine(scene, Plan(scene.map(view.text), options), view.at);
            EXPECT_EQ(found.pixels, target.width * target.height);
            EXPECT_EQ(found.over_bound, 0);
            EXPECT_EQ(found.over_tol, 0);
            EXPECT_EQ(found.lost, 0);
            EXPECT_EQ(found.seen_without_ray, 0);
            in_blocks += found.in_blocks;
        }
    return in_blocks;
}

TEST(FormulaView, RaysOfAnyFormulaHoldTheToleranceInAnySource) {
    constexpr unsigned kSeed = 7;
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    std::mt19937 random(kSeed);
    int in_blocks = 0, scenes = 0;
    for (const Rays& rays : kRays)
        in_blocks += expect_truth<FormulaViewPlan>(
            rays, kSources, {Scheme::automatic, Scheme::blocks, Scheme::exact, Scheme::residual}, random,
            scenes);
    EXPECT_GT(in_blocks, 10000);
}

TEST(FormulaView, DirectionsOfAnyFormulaHoldTheToleranceInAnySource) {
    constexpr unsigned kSeed = 8;
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    std::mt19937 random(kSeed);
    int scenes = 0;
    for (const Directions& directions : kDirections)
        expect_truth<InverseViewPlan>(directions, std::span(kSources).first(3),
                                      {Scheme::automatic, Scheme::exact}, random, scenes);
}

/// How many of the pixels that two maps show have points that are farther apart than both bounds, and how many only one shows.
template <class A, class B>
std::pair<int, int> differences(const View& source, const Size& size, const A& a, const B& b) {
    int apart = 0, alone = 0;
    for (double y = 0.5; y < size.height; ++y)
        for (double x = 0.5; x < size.width; ++x) {
            Point<double> p{}, q{};
            int piece_p = 0, piece_q = 0;
            const bool has_p = a.exact(x, y, 0, p, piece_p), has_q = b.exact(x, y, 0, q, piece_q);
            alone += has_p != has_q;
            if (!has_p || !has_q) continue;
            const Interval at_x(x), at_y(y);
            const double bound =
                a.template exact_error<double>(at_x, at_y, 0) + b.template exact_error<double>(at_x, at_y, 0);
            apart += !(distance(source, p, {q.x, q.y}) <= bound * (1 + 1e-12)) || !std::isfinite(bound);
        }
    return {apart, alone};
}

TEST(FormulaView, ListedProjectionsAsTextAreTheSame) {
    struct Listed {
        Projection projection;
        Size size;
        double fov;
        RayText text;
    };
    const Size square{90, 90}, wide{120, 60};
    const Listed all[] = {
        {equirectangular, wide, 360, {"cos(e)*sin(l)", "sin(e)", "cos(e)*cos(l)", {}, "l=px*pi/2;e=py*pi/2"}},
        {cylindrical, square, 200, {"sin(l)", "py*w", "cos(l)", {}, "w=pi*100/180;l=px*w"}},
        {rectilinear, square, 100, {"k*px", "k*py", "1", {}, "k=tan(pi*50/180)"}},
        {fisheye, square, 180, {"k*px", "k*py", "cos(q)", {}, "q=r*pi/2;k=sin(q)/r"}},
        {equisolid, square, 180, {"k*px", "k*py", "cos(q)", {}, "q=2*asin(r*sin(pi/4));k=sin(q)/r"}},
        {stereographic, square, 180, {"2*px", "2*py", "1-r^2"}},
        {mercator, square, 360, {"sin(px*pi)", "sinh(py*pi)", "cos(px*pi)"}},
        {pannini,
         square,
         120,
         {"X*S", "Y*S", "C", {}, "w=2*tan(pi/6);X=px*w;Y=py*w;q=X^2/4;C=(1-q)/(1+q);S=(C+1)/2"}},
        {orthographic, square, 160, {"k*px", "k*py", "sqrt(1-(k*r)^2)", {}, "k=sin(pi*80/180)"}},
    };
    const Orientation look{33, -21, 12};
    const View& source = kSources[0];
    for (const Listed& listed : all) {
        SCOPED_TRACE(std::string(name_of(listed.projection)));
        const Scene scene{source, listed.size, listed.size, look, {}, {}};
        const Chart target(listed.projection, listed.size.width, listed.size.height, listed.fov);
        const auto [apart, alone] = differences(source, listed.size, scene.map(listed.text),
                                                Panorama(oracle::chart_of(source), target, look));
        EXPECT_EQ(apart, 0);
        EXPECT_EQ(alone, 0);
    }
}

TEST(FormulaView, ListedProjectionsAsTextOfDirectionsAreTheSame) {
    struct Listed {
        Projection projection;
        DirectionText text;
    };
    const Listed all[] = {
        {equirectangular, {}},
        {sinusoidal, {"lon*cos(lat)/(pi/2)", "lat/(pi/2)"}},
        {hammer, {"2*cos(lat)*sin(lon/2)/k", "sin(lat)/k", {}, "k=sqrt(1+cos(lat)*cos(lon/2))"}},
    };
    const Orientation look{33, -21, 12};
    const View& source = kSources[0];
    for (const Listed& listed : all) {
        SCOPED_TRACE(std::string(name_of(listed.projection)));
        const Scene scene{source, {120, 60}, {120, 60}, look, {}, {}};
        const Chart target(listed.projection, 120, 60, 360);
        const auto [apart, alone] = differences(source, {120, 60}, scene.map(listed.text),
                                                Panorama(oracle::chart_of(source), target, look));
        EXPECT_EQ(apart, 0);
        EXPECT_EQ(alone, 0);
    }
}

TEST(FormulaView, RowsAreExactOnEveryInstructionSet) {
    const Size picture{101, 67};
    for (const Rays& rays : kRays)
        for (const View& source : kSources) {
            SCOPED_TRACE(std::string(rays.name) + " in " + std::string(name_of(source.projection)));
            const Scene scene{source, picture, picture, {30, 20, 10}, {-5, 12, 3}, {}};
            const FormulaView map = scene.map(rays.text);
            std::vector<double> first;
            test::on_every_instruction_set([&] {
                std::vector<double> all;
                for (int j = 0; j < picture.height; ++j) {
                    std::vector<double> x(101), y(101);
                    std::vector<std::int32_t> piece(101);
                    map.exact_row(0.5, j + 0.5, 101, x.data(), y.data(), piece.data());
                    for (int i = 0; i < 101; ++i) {
                        const auto k = static_cast<std::size_t>(i);
                        double alone_x = 0, alone_y = 0;
                        std::int32_t alone = 0;
                        map.exact_row(i + 0.5, j + 0.5, 1, &alone_x, &alone_y, &alone);
                        ASSERT_EQ(std::memcmp(&alone_x, &x[k], sizeof(double)), 0) << i << " " << j;
                        ASSERT_EQ(alone, piece[k]);
                        Point<DoubleDouble> truth{};
                        int at = 0;
                        const Interval in_x(i + 0.5), in_y(j + 0.5);
                        const double bound = map.exact_error<double>(in_x, in_y, 0) +
                                             map.exact_error<DoubleDouble>(in_x, in_y, 0);
                        if (!std::isfinite(bound)) continue;
                        ASSERT_EQ(map.exact<DoubleDouble>(i + 0.5, j + 0.5, 0, truth, at), piece[k] >= 0);
                        if (piece[k] < 0 || at != piece[k]) continue;
                        ASSERT_LE(distance(source, {x[k], y[k]},
                                           {static_cast<Real>(truth.x), static_cast<Real>(truth.y)}),
                                  bound)
                            << i << " " << j;
                    }
                    all.insert(all.end(), x.begin(), x.end());
                    all.insert(all.end(), y.begin(), y.end());
                }
                if (first.empty()) first = all;
                EXPECT_EQ(std::memcmp(first.data(), all.data(), all.size() * sizeof(double)), 0);
            });
        }
}

TEST(FormulaView, PixelsWithoutARayHaveNoSourcePoint) {
    const Scene scene{kSources[0], {65, 65}, {65, 65}, {}, {}, {}};
    Point<double> point{};
    int piece = 0;
    const FormulaView middle = scene.map(kRays[6].text), edge = scene.map(kRays[4].text);
    EXPECT_FALSE(middle.exact(32.5, 32.5, 0, point, piece));
    EXPECT_TRUE(middle.exact(33.5, 32.5, 0, point, piece));
    EXPECT_FALSE(edge.exact(0.5, 32.5, 0, point, piece));
    EXPECT_TRUE(edge.exact(32.5, 32.5, 0, point, piece));
    const FormulaView huge = scene.map(RayText{"px*1e300*1e300", "py", "1"});
    EXPECT_FALSE(huge.exact(0.5, 0.5, 0, point, piece));
    const InverseView globe = scene.map(kDirections[2].text);
    EXPECT_FALSE(globe.exact(0.5, 0.5, 0, point, piece));
    EXPECT_TRUE(globe.exact(32.5, 30.5, 0, point, piece));
}

/// The largest bound of all pixels.
template <class Plan>
double largest_bound(const Plan& plan) {
    double most = 0;
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region)) most = std::max(most, block.bound);
    return most;
}

TEST(FormulaView, PixelsWithoutARayAreCountedAndHaveNoBound) {
    const Scene scene{kSources[0], {128, 64}, {128, 64}, {}, {}, {}};
    const auto undefined = [&](const auto& map) {
        const Box whole{0, 0, 128, 64};
        return map.undefined_pixels(whole);
    };
    const FormulaViewPlan plan(scene.map(RayText{"if(s<0.25,0,px)", "if(s<0.25,0,py)", "if(s<0.25,0,1)"}),
                               scene.options);
    EXPECT_EQ(undefined(plan.map()), 32 * 64);
    EXPECT_LE(largest_bound(plan), scene.options.tol);
    EXPECT_EQ(undefined(scene.map(RayText{"0", "0", "0"})), 128 * 64);
    EXPECT_EQ(undefined(scene.map(RayText{"px", "py", "sqrt(t-0.5)"})), 128 * 32);
    EXPECT_EQ(undefined(scene.map(kRays[0].text)), 0);
    // An equirectangular half of the globe, 64 pixels wide.
    EXPECT_EQ(undefined(scene.map(DirectionText{"lon*k", "lat*k", {}, "k=if(lon>0,2/pi,sqrt(-1))"})),
              64 * 64);
}

TEST(FormulaView, OfTwoDirectionsTheOneThatIsTakenHasItsOwnBound) {
    const Scene scene{kSources[0], {101, 67}, {101, 67}, {40, 20, 10}, {}, {}};
    for (const auto& [x, y] :
         {std::pair("abs(lon)*2/pi", "lat*2/pi"), std::pair("lon*2/pi", "abs(lat)*2/pi")}) {
        const InverseView map = scene.map(DirectionText{x, y});
        int large = 0;
        for (double row = 0.5; row < 67; ++row)
            for (double column = 0.5; column < 101; ++column) {
                const double bound = map.exact_error<double>(Interval(column), Interval(row), 0);
                large += !(bound < 1e-6);
            }
        // But on the fold itself, a column or a row.
        EXPECT_LE(large, 101) << x;
    }
}

TEST(FormulaView, SmoothFormulasAreDrawnByBlocks) {
    PlanOptions options;
    const Scene scene{kSources[0], {512, 512}, {512, 512}, {20, 10, 5}, {}, options};
    const Findings flat = examine(scene, FormulaViewPlan(scene.map(kRays[0].text), options), kRays[0].at);
    EXPECT_EQ(flat.in_blocks, flat.pixels);
    const Directions& equal_areas = kDirections[1];
    const Findings found =
        examine(scene, InverseViewPlan(scene.map(equal_areas.text), options), equal_areas.at);
    EXPECT_GT(found.in_blocks, 0.75 * found.pixels);
}

}  // namespace
}  // namespace anamorph::test_formula_view
