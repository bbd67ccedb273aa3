// SPDX-License-Identifier: Apache-2.0
// Every pixel of a panorama, exact ones too, against long double: none is farther from the truth than its
// bound, whatever the projections, sizes, fields of view and angles.
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <random>

#include "anamorph/chart/chart_formulas.h"
#include "anamorph/image/footprint.h"
#include "anamorph/panorama/panorama_plan.h"
#include "anamorph/plan/taylor.h"
#include "block_points.h"
#include "draw_map.h"
#include "panorama_oracle.h"

namespace anamorph {
namespace {

using enum Projection;
using oracle::chart_of;
using oracle::Real;
using oracle::Vector;
using oracle::View;

constexpr Projection kAll[] = {equirectangular, cylindrical, rectilinear, fisheye,    equisolid,
                               stereographic,   mercator,    cubemap,     cubemap3x2, cubecross};

struct Scene {
    View source, target;
    Orientation look;
    double tol;
    Scheme scheme = Scheme::automatic;
    Orientation held = {};
    std::optional<PlanCosts> costs = {};

    Panorama map() const { return {chart_of(source), chart_of(target), look, held}; }
    PlanOptions options() const {
        PlanOptions options;
        options.scheme = scheme;
        options.tol = tol;
        options.costs = costs;
        return options;
    }
};

std::string words(const Scene& s) {
    std::string text;
    for (const View* v : {&s.source, &s.target})
        text += std::string(name_of(v->projection)) + " " + std::to_string(v->width) + "x" +
                std::to_string(v->height) + " fov " + ::testing::PrintToString(v->fov) +
                (v->centers ? " centers " : " ") + v->lens.text() + " ";
    return text + "yaw " + ::testing::PrintToString(s.look.yaw) + " pitch " +
           ::testing::PrintToString(s.look.pitch) + " roll " + ::testing::PrintToString(s.look.roll) +
           " tol " + ::testing::PrintToString(s.tol) + " scheme " +
           std::to_string(static_cast<int>(s.scheme));
}

struct Findings {
    std::int64_t pixels = 0, over_bound = 0, over_tol = 0, lost = 0;
    std::int64_t cubic = 0, in_double = 0, thin = 0;  ///< blocks; of one row or column of pixels
    double worst = 0, worst_excess = -HUGE_VAL, worst_bound = 0;
    int worst_x = 0, worst_y = 0;
};

/// The distance of a point in use from the truth, on the face that it stands on; a turn counts nothing.
Real distance(const View& source, const Point<double>& used, const Point<long double>& truth) {
    Real dx = used.x - truth.x;
    if (source.projection == equirectangular || source.projection == cylindrical ||
        source.projection == mercator) {
        const Real period = 2 * oracle::kPi * oracle::scale(source).x;
        dx -= std::round(dx / period) * period;
    }
    return std::hypot(dx, used.y - truth.y);
}

/// Is it in the image, a few pixels within?
bool well_inside(const View& v, const Piece& piece, const Point<long double>& p) {
    const Box box = has_faces(v.projection) ? piece.box : Box{0, 0, v.width, v.height};
    return p.x > box.x0 + 0.01L && p.x < box.x1 - 0.01L && p.y > box.y0 + 0.01L && p.y < box.y1 - 0.01L;
}

/// Straight behind a lens that shows it all around its rim, and at a pole, any point in all directions will
/// do.
bool all_around(const View& source, const Vector& ray) {
    const bool lens = source.projection == fisheye || source.projection == equisolid;
    return lens ? ray.x == 0 && ray.y == 0 && ray.z < 0
                : source.projection == equirectangular && ray.x == 0 && ray.z == 0;
}

Real error_of(const Scene& scene, const Piece& piece, const Vector& ray, const Point<double>& used) {
    const Point<long double> truth = oracle::point_of(scene.source, piece, ray);
    if (!all_around(scene.source, ray)) return distance(scene.source, used, truth);
    if (scene.source.projection == equirectangular) return std::fabs(used.y - truth.y);
    const Real cx = Real(scene.source.width) / 2, cy = Real(scene.source.height) / 2;
    return std::fabs(std::hypot(used.x - cx, used.y - cy) - std::hypot(truth.x - cx, truth.y - cy));
}

Findings examine(const Scene& scene) {
    Findings found;
    const Panorama map = scene.map();
    const PanoramaPlan plan(map, scene.options());
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region)) {
            const Piece& target = map.target().pieces()[static_cast<std::size_t>(block.piece)];
            const bool drawn = test::has_points(block);
            const bool cubic = block.kind == Block::Kind::bicubic;
            found.cubic += cubic;
            found.in_double += cubic && block.precise;
            found.thin += cubic && (block.box.width() == 1 || block.box.height() == 1);
            for (int j = block.box.y0; j < block.box.y1; ++j) {
                const test::BlockRow row(plan, block, j);
                for (int i = block.box.x0; i < block.box.x1; ++i) {
                    ++found.pixels;
                    Vector ray;
                    const bool has_ray = oracle::ray_of(scene.target, target, i + 0.5L, j + 0.5L, ray);
                    ray = oracle::turned_back(oracle::rotated(ray, scene.look), scene.held);
                    Point<double> used{};
                    int piece = block.source_piece;
                    bool seen = drawn;
                    if (block.kind == Block::Kind::exact)
                        seen = static_cast<const BlockMap&>(plan).exact(block, i + 0.5, j + 0.5, used, piece);
                    else if (seen)
                        used = row.at(i);
                    if (!seen) {
                        for (const Piece& p : map.source().pieces())
                            found.lost +=
                                has_ray && !all_around(scene.source, ray) &&
                                well_inside(scene.source, p, oracle::point_of(scene.source, p, ray));
                        continue;
                    }
                    const Piece& on = map.source().pieces()[static_cast<std::size_t>(piece)];
                    const double error = static_cast<double>(error_of(scene, on, ray, used));
                    found.worst_bound = std::max(found.worst_bound, block.bound);
                    if (!(error <= block.bound)) ++found.over_bound;
                    // Nothing holds a tolerance where doubles are wider apart, far from the image, or at a
                    // pole.
                    const bool held = block.bound <= scene.tol || drawn;
                    if (scene.tol > 0 && held && !(error <= scene.tol)) ++found.over_tol;
                    if (!(error - block.bound <= found.worst_excess)) {
                        found.worst_excess = error - block.bound;
                        found.worst_x = i, found.worst_y = j;
                    }
                    found.worst = std::max(found.worst, error);
                }
            }
        }
    return found;
}

Findings expect_truth(const Scene& scene) {
    const Findings found = examine(scene);
    EXPECT_EQ(found.over_bound, 0) << words(scene) << ": " << found.worst_excess << " over its bound at "
                                   << found.worst_x << ' ' << found.worst_y;
    EXPECT_EQ(found.over_tol, 0) << words(scene) << ": " << found.worst;
    EXPECT_EQ(found.lost, 0) << words(scene);
    return found;
}

class Random {
  public:
    explicit Random(unsigned seed) : m_engine(seed) {}
    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(m_engine);
    }
    int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(m_engine); }
    bool chance(double share) { return between(0, 1) < share; }
    /// Any angle, a right one, nearly a right one, or far too many turns.
    double angle() {
        const double right = 90.0 * integer(-5, 5);
        switch (integer(0, 4)) {
            case 0:
                return right;
            case 1:
                return right + std::pow(10, between(-17, -1));
            case 2:
                return between(-1, 1) * std::pow(10, between(2, 15));
            default:
                return between(-200, 200);
        }
    }
    Scheme scheme() {
        return chance(0.2)   ? Scheme::residual
               : chance(0.3) ? Scheme::direct
               : chance(0.5) ? Scheme::blocks
                             : Scheme::automatic;
    }
    /// Often upright.
    Orientation look() { return {angle(), angle(), chance(0.5) ? 0 : angle()}; }
    Orientation orientation() { return {angle(), angle(), angle()}; }
    View view(Projection projection, bool large) {
        View v{projection, 0, 0, 90};
        const int size = static_cast<int>(large ? std::pow(2, between(3, 22)) : between(20, 90));
        v.width = size;
        v.height = std::max(1, static_cast<int>(size * between(0.3, 1.2)));
        const double widest = projection == rectilinear ? 179 : projection == stereographic ? 359.5 : 360;
        v.fov = chance(0.4)   ? Chart::default_fov(projection)
                : chance(0.3) ? widest
                : chance(0.3) ? std::pow(10, between(-4, 2))
                              : between(1, widest);
        if (projection == equirectangular && chance(0.7)) v.width = 2 * v.height, v.fov = 360;
        const int face = std::max(1, size / 4);
        if (projection == cubemap) v = {projection, face, 6 * face, 90};
        if (projection == cubemap3x2) v = {projection, 3 * face, 2 * face, 90};
        if (projection == cubecross) v = {projection, 4 * face, 3 * face, 90};
        return v;
    }

    /// What a view may be from top to bottom: with pixels that are not square, and its horizon anywhere.
    void lay(View& v) {
        const bool axial = v.projection == fisheye || v.projection == equisolid;
        const double highest = v.projection == equirectangular ? 180
                               : axial                         ? 360
                               : v.projection == stereographic ? 350
                                                               : 175;
        if (chance(0.7))
            v.vfov = chance(0.2) ? std::pow(10, between(-4, 2)) : chance(0.3) ? highest : between(1, highest);
        if (chance(0.7)) v.horizon = chance(0.3) ? 0.5 * v.height : between(-0.5, 1.5) * v.height;
    }

    /// Often none; else of a model that the projection may have, and tame enough not to fold within the picture.
    LensModel lens(const View& v) {
        if (v.projection != rectilinear && v.projection != fisheye && v.projection != equisolid &&
            v.projection != stereographic)
            return {};
        using enum LensModel::Kind;
        const LensModel::Kind own = v.projection == rectilinear ? brown
                                    : v.projection == fisheye   ? kb4
                                                                : ptlens;
        LensModel model{chance(0.4) ? own : chance(0.5) ? ptlens : chance(0.5) ? three_de4 : division, {}};
        model.values.resize(LensModel::names(model.kind).size());
        // The farthest corner, in the model's unit.
        const double unit = model.kind == ptlens || model.kind == three_de4 || model.kind == division
                                ? 1
                                : std::hypot(v.width, v.height) / 2 / static_cast<double>(oracle::scale(v).x);
        for (std::size_t i = 0; i + 2 < model.values.size() && i < 6; ++i)
            model.values[i] =
                chance(0.3) ? 0
                : model.kind == ptlens
                    ? between(-0.05, 0.05)
                    : between(-0.06, 0.06) / std::pow(unit, 2.0 * static_cast<double>(i % 3 + 1));
        if (model.kind == ptlens)
            for (const std::size_t i : {3, 4})
                model.values[i] = chance(0.5) ? 0 : between(-0.1, 0.1) * v.width;
        for (std::size_t i = 1; i <= 2; ++i)
            if (chance(0.3)) model.values[model.values.size() - i] = between(-0.1, 0.1) * v.width;
        return model;
    }

  private:
    std::mt19937 m_engine;
};

TEST(PanoramaTruth, NoPixelIsOverItsBound) {
    // More by the environment: rounds over all pairs, and a seed.
    const char* const rounds = std::getenv("ANAMORPH_TRUTH_ROUNDS");
    const char* const seed_text = std::getenv("ANAMORPH_TRUTH_SEED");
    const unsigned seed = seed_text ? static_cast<unsigned>(std::atoi(seed_text)) : 1987;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    constexpr double kTols[] = {1, 0.01, 1e-4, 1e-6, 0};
    std::int64_t pixels = 0;
    for (int round = 0; round < (rounds ? std::atoi(rounds) : 1); ++round)
        for (const Projection from : kAll)
            for (const Projection to : kAll) {
                Scene scene{random.view(from, true), random.view(to, false), {}, kTols[random.integer(0, 4)]};
                scene.look = random.look();
                scene.scheme = random.scheme();
                if (scene.source.width > 8 && scene.source.height > 48 && random.chance(0.2))
                    scene.source.centers = true;
                pixels += expect_truth(scene).pixels;
            }
    RecordProperty("pixels", std::to_string(pixels));
}

TEST(PanoramaTruth, NoPixelIsOverItsBoundOfPartsAndOblongPixels) {
    const char* const rounds = std::getenv("ANAMORPH_TRUTH_ROUNDS");
    const char* const seed_text = std::getenv("ANAMORPH_TRUTH_SEED");
    const unsigned seed = seed_text ? static_cast<unsigned>(std::atoi(seed_text)) : 2011;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    constexpr double kTols[] = {1, 0.01, 1e-4, 1e-6, 0};
    std::int64_t pixels = 0;
    for (int round = 0; round < (rounds ? std::atoi(rounds) : 3); ++round)
        for (const Projection from : kAll)
            for (const Projection to : kAll) {
                if (has_faces(from) || has_faces(to)) continue;
                Scene scene{random.view(from, true), random.view(to, false), {}, kTols[random.integer(0, 4)]};
                random.lay(scene.source);
                random.lay(scene.target);
                scene.look = random.look();
                if (random.chance(0.5)) scene.held = random.orientation();
                if (random.chance(0.5)) scene.held.ahead = random.angle();
                scene.scheme = random.scheme();
                if (scene.source.width > 8 && scene.source.height > 48 && random.chance(0.2))
                    scene.source.centers = true;
                pixels += expect_truth(scene).pixels;
            }
    EXPECT_GT(pixels, 400000);
}

TEST(PanoramaTruth, NoPixelIsOverItsBoundOfCamerasThatStandElsewhere) {
    const char* const rounds = std::getenv("ANAMORPH_TRUTH_ROUNDS");
    const char* const seed_text = std::getenv("ANAMORPH_TRUTH_SEED");
    const unsigned seed = seed_text ? static_cast<unsigned>(std::atoi(seed_text)) : 2013;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    constexpr double kTols[] = {1, 0.01, 1e-4, 1e-6, 0};
    std::int64_t pixels = 0;
    for (int round = 0; round < (rounds ? std::atoi(rounds) : 2); ++round)
        for (const Projection from : kAll)
            for (const Projection to : kAll) {
                Scene scene{random.view(from, true), random.view(to, false), {}, kTols[random.integer(0, 4)]};
                scene.look = random.look();
                if (random.chance(0.7)) scene.held = random.orientation();
                const double far = random.chance(0.2) ? 30 : random.chance(0.3) ? 3 : 0.4;
                scene.held.transfer = PlaneTransfer{
                    {random.between(-far, far), random.between(-far, far), random.between(-far, far)},
                    random.chance(0.3) ? 0 : random.angle(),
                    random.chance(0.3) ? 0 : random.between(-90, 90)};
                scene.scheme = random.scheme();
                pixels += expect_truth(scene).pixels;
            }
    EXPECT_GT(pixels, 400000);
}

// The matrix between local rays is off by no more than the map says, and of a camera far away by more than without one.
TEST(PanoramaTruth, MatricesOfCamerasFarAwayAreWithinTheirBound) {
    Random random(2014);
    const Chart chart(equirectangular, 400, 200);
    double worst = 0;
    for (int round = 0; round < 300; ++round) {
        const Orientation look = random.orientation();
        Orientation held = random.orientation();
        const double far = round % 3 == 0 ? 5e5 : round % 3 == 1 ? 500 : 0.5;
        held.transfer = PlaneTransfer{
            {random.between(-1, 1) * far, random.between(-1, 1) * far, random.between(-1, 1) * far},
            random.angle(),
            random.between(-90, 90)};
        const Panorama map(chart, chart, look, held);
        const Panorama::Local local = map.local_around(random.between(0, 400), random.between(40, 160), 0);
        const auto ahead = [](const Branch& branch) { return branch.around.angle / oracle::kPi * 180; };
        for (int column = 0; column < 3; ++column) {
            Vector v{column == 0 ? 1.0L : 0, column == 1 ? 1.0L : 0, column == 2 ? 1.0L : 0};
            // Frames of panoramas are turned about the vertical by the angle that their branches say.
            const auto turned_about = [](Vector& a, long double degrees) {
                const long double c = std::cos(degrees * oracle::kPi / 180),
                                  s = std::sin(degrees * oracle::kPi / 180);
                a = {a.x * c + a.z * s, a.y, a.z * c - a.x * s};
            };
            turned_about(v, ahead(local.target));
            v = oracle::rotated(v, look);
            // Whether a direction meets the plane or not, the matrix is one.
            Vector n{0, 0, 1};
            oracle::turn(n.y, n.z, held.transfer->pitch);
            oracle::turn(n.z, n.x, held.transfer->yaw);
            const Real along = n.x * v.x + n.y * v.y + n.z * v.z;
            v = {v.x - held.transfer->camera[0] * along, v.y - held.transfer->camera[1] * along,
                 v.z - held.transfer->camera[2] * along};
            Orientation turns = held;
            turns.transfer.reset();
            v = oracle::turned_back(v, turns);
            turned_about(v, -ahead(local.source));
            const Real expected[] = {v.x, v.y, v.z};
            for (int row = 0; row < 3; ++row) {
                const auto off = static_cast<double>(std::fabs(expected[row] - local.rotation[column][row]));
                EXPECT_LE(off, map.local_error()) << round;
                worst = std::max(worst, off);
            }
        }
    }
    EXPECT_GT(worst, 100 * Panorama::kLocalError);
}

TEST(PanoramaTruth, NoPixelIsOverItsBoundThroughLenses) {
    const char* const rounds = std::getenv("ANAMORPH_TRUTH_ROUNDS");
    const char* const seed_text = std::getenv("ANAMORPH_TRUTH_SEED");
    const unsigned seed = seed_text ? static_cast<unsigned>(std::atoi(seed_text)) : 1966;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    constexpr double kTols[] = {1, 0.01, 1e-4, 0};
    std::int64_t pixels = 0;
    int with_lens = 0, refused = 0;
    for (int round = 0; round < (rounds ? std::atoi(rounds) : 2); ++round)
        for (const Projection from : kAll)
            for (const Projection to : kAll) {
                Scene scene{random.view(from, true), random.view(to, false), {}, kTols[random.integer(0, 3)]};
                scene.source.lens = random.lens(scene.source);
                scene.target.lens = random.lens(scene.target);
                if (scene.source.lens.text() == "none" && scene.target.lens.text() == "none") continue;
                scene.look = random.look();
                if (random.chance(0.5)) scene.held = random.orientation();
                scene.scheme = random.scheme();
                try {
                    static_cast<void>(scene.map());
                } catch (const Error&) {
                    ++refused;
                    continue;
                }
                ++with_lens;
                pixels += expect_truth(scene).pixels;
            }
    EXPECT_GT(with_lens, 40);
    EXPECT_LT(refused, with_lens / 4);
    RecordProperty("pixels", std::to_string(pixels));
}

// What is wrong about a cost makes plans slower.
TEST(PanoramaTruth, NoBoundHangsOnACost) {
    const Scene scenes[] = {{{equirectangular, 600, 300, 360}, {rectilinear, 260, 120, 90}, {30, 20, 10}, 0},
                            {{cubemap, 1024, 6144, 90}, {fisheye, 120, 120, 180}, {-50, 70, 3}, 0}};
    int changed = 0;
    for (Scene scene : scenes)
        for (const Scheme scheme : {Scheme::automatic, Scheme::blocks})
            for (const double tol : {0.01, 1e-6}) {
                scene.scheme = scheme;
                scene.tol = tol;
                scene.costs.reset();
                const Findings usual = expect_truth(scene);
                for (double PlanCosts::*which :
                     {&PlanCosts::bound, &PlanCosts::further_bound, &PlanCosts::credit,
                      &PlanCosts::bound_pixels, &PlanCosts::polynomial, &PlanCosts::rounding,
                      &PlanCosts::double_pixel, &PlanCosts::direct_trial, &PlanCosts::direct_pixel,
                      &PlanCosts::precise_pixel, &PlanCosts::apart_pixel, &PlanCosts::precise_bound,
                      &PlanCosts::block})
                    for (const double times : {0.25, 4.0}) {
                        scene.costs = PlanCosts{};
                        *scene.costs.*which *= times;
                        const Findings found = expect_truth(scene);
                        changed += found.worst != usual.worst || found.cubic != usual.cubic;
                    }
            }
    // Without this the costs would not have been read.
    EXPECT_GT(changed, 0);
}

TEST(PanoramaTruth, TheWholePictureThroughALensIsUnderItsBounds) {
    const View sphere{equirectangular, 8192, 4096, 360};
    const auto lens = [](View view, const char* text) {
        view.lens = LensModel::parse(text);
        return view;
    };
    const View flat{rectilinear, 90, 60, 100}, fish{fisheye, 70, 70, 180}, photo{rectilinear, 6000, 4000, 80};
    const Scene scenes[] = {
        {sphere, lens(flat, "ptlens:a=0.02,b=-0.05,c=0.01,d=7,e=-3"), {10, 20, 30}, 0.01},
        {sphere, lens(flat, "brown:k1=-0.1,k2=0.01,k4=0.05"), {10, 80, 30}, 1e-4},
        {sphere, lens(flat, "3de4:k1=0.1,k2=0.02"), {170, 20, 0}, 0.01},
        {sphere, lens(fish, "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003"), {0, -90, 0}, 0.01},
        {lens(photo, "ptlens:a=0.02,b=-0.05,c=0.01"), flat, {5, 5, 5}, 0.01},
        {lens(photo, "brown:k1=-0.2,k2=0.05,p1=0.001,p2=-0.002,d=30,e=-20"), flat, {5, 5, 5}, 0.01},
        {lens(photo, "brown:k1=-0.2,k2=0.05,p1=0.001,s1=-0.002,s2=0.001,s3=0.001,d=30"),
         flat,
         {5, 5, 5},
         0.01},
        {lens(photo, "3de4:k1=-0.1,k2=0.02,d=30"), lens(flat, "ptlens:b=0.03"), {5, 5, 5}, 1e-4},
        // Lenses that fold in the picture, just beyond the circle that it holds.
        {lens(photo, "ptlens:b=-0.45"), flat, {0, 0, 0}, 0.01},
        {sphere, lens(flat, "ptlens:b=-0.45"), {0, 0, 0}, 0.01},
        {lens({fisheye, 3000, 2000, 150}, "3de4:k1=-0.6"), lens(fish, "kb4:k1=-0.05"), {0, 10, 0}, 0.01},
        // Pictures whose columns are azimuths, with edges that a lens bends.
        {lens({cylindrical, 6000, 2500, 200}, "ptlens:a=0.02,b=-0.05,c=0.01,d=30,e=-20"),
         flat,
         {80, 10, 5},
         0.01},
        {lens({cylindrical, 6000, 1500, 340}, "ptlens:a=0.01,b=-0.02"), flat, {170, 0, 20}, 0.01},
        {lens({equirectangular, 6000, 3000, 300}, "poly:k0=0.05"), fish, {120, 40, 5}, 0.01},
        {sphere, lens({cylindrical, 90, 60, 150}, "ptlens:b=0.05,c=-0.02"), {170, 20, 30}, 0.01},
        {sphere, lens({equirectangular, 90, 60, 250}, "poly:k0=-0.03"), {10, 80, 30}, 0.01},
        {lens({equirectangular, 6000, 3000, 300}, "ptlens:b=0.03"),
         lens({cylindrical, 90, 60, 150}, "ptlens:b=-0.03"),
         {5, 5, 5},
         1e-4},
    };
    for (Scene scene : scenes)
        for (const Scheme scheme : {Scheme::automatic, Scheme::blocks, Scheme::residual, Scheme::direct}) {
            scene.scheme = scheme;
            const Findings found = expect_truth(scene);
            EXPECT_LE(found.worst_bound, std::max(scene.tol, 1e-4)) << words(scene);
        }
}

TEST(PanoramaTruth, CubicBlocksAreUnderTheirBounds) {
    const View sources[] = {{equirectangular, 8192, 4096, 360}, {cylindrical, 8192, 2608, 360},
                            {mercator, 4096, 4096, 360},        {fisheye, 3000, 3000, 180},
                            {stereographic, 3000, 3000, 200},   {cubemap, 1024, 6144, 90}};
    // Regions are 512 pixels wide: the last of a picture may be a single column, or row.
    const View targets[] = {{rectilinear, 513, 65, 90},
                            {rectilinear, 61, 513, 20},
                            {equirectangular, 257, 129, 360},
                            {fisheye, 200, 1, 150},
                            {rectilinear, 1, 300, 1}};
    Findings all;
    for (const View& source : sources)
        for (const View& target : targets)
            for (const double tol : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
                Scene scene{source, target, {30, 20, 10}, tol};
                // So that there are some.
                scene.costs = PlanCosts{.double_pixel = 0.25};
                for (const Scheme scheme : {Scheme::automatic, Scheme::blocks}) {
                    scene.scheme = scheme;
                    const Findings found = expect_truth(scene);
                    EXPECT_LE(found.worst_bound, tol) << words(scene);
                    all.cubic += found.cubic;
                    all.in_double += found.in_double;
                    all.thin += found.thin;
                }
            }
    EXPECT_GT(all.cubic - all.in_double, 1000);
    EXPECT_GT(all.in_double, 1000);
    EXPECT_GT(all.thin, 0);
}

TEST(PanoramaTruth, HardViewsAreUnderTheirBounds) {
    const View sphere{equirectangular, 65536, 32768, 360};
    const Scene scenes[] = {
        // Straight behind an equisolid lens, and a view that is next to nothing wide.
        {{equisolid, 16384, 16384, 360}, {fisheye, 301, 301, 0.1}, {180, 0, 0}, 0},
        {{stereographic, 16384, 16384, 359}, {fisheye, 301, 301, 0.1}, {180, 0, 0}, 0},
        {{fisheye, 16384, 16384, 360}, {rectilinear, 101, 101, 1e-4}, {180, 0, 0}, 0},
        // Many turns.
        {sphere, {rectilinear, 96, 64, 90}, {1e12, 0, 0}, 0},
        {sphere, {rectilinear, 96, 64, 90}, {1e12, -3e14, 7e13}, 1e-4},
        // Poles in the middle of a pixel.
        {sphere, {rectilinear, 101, 101, 1e-3}, {30, 90, 0}, 0},
        {sphere, {rectilinear, 101, 101, 90}, {30, -90, 12}, 0.01},
        {{mercator, 4096, 4096, 360}, {rectilinear, 101, 101, 1}, {30, 90, 0}, 0.01},
        {{cylindrical, 4096, 4096, 360}, {rectilinear, 101, 101, 1}, {30, 90, 0}, 0.01},
        // The horizon of a lens in the middle of pixels.
        {{rectilinear, 2048, 2048, 90}, {equirectangular, 202, 101, 360}, {0, 0, 0}, 0},
        // Taller than wide.
        {sphere, {mercator, 2, 300, 360}, {20, 0, 0}, 0},
        {{mercator, 16, 2000, 360}, {mercator, 3, 330, 360}, {20, 0, 0}, 0},
        {sphere, {cylindrical, 2, 16384, 360}, {20, 30, 0}, 0},
        // Cells of a table, whose corners lie where no pixel's centre does.
        {{rectilinear, 3110, 3603, 179.99},
         {cubemap3x2, 6, 4, 90},
         {129.1118028, -12.25501377, 0},
         1.584,
         Scheme::residual},
    };
    for (const Scene& scene : scenes) {
        const Findings found = expect_truth(scene);
        EXPECT_LE(found.worst_bound, std::max(scene.tol, 1e-4)) << words(scene);
    }
}

// The two that were once off by .0108 and .0174 pixels.
TEST(PanoramaTruth, RoundingIsFarBelowAnyTolerance) {
    EXPECT_LT(examine({{equisolid, 16384, 16384, 360}, {fisheye, 301, 301, 0.1}, {180, 0, 0}, 0}).worst,
              1e-9);
    EXPECT_LT(
        examine({{equirectangular, 65536, 32768, 360}, {rectilinear, 96, 64, 90}, {1e12, 0, 0}, 0}).worst,
        1e-9);
}

// A bound is of use only near what it bounds.
TEST(PanoramaTruth, BoundsOfExactPixelsAreNotIdle) {
    for (const Projection from : kAll)
        for (const Projection to : kAll) {
            Random random(7);
            Scene scene{random.view(from, false), random.view(to, false), {20, 30, 40}, 0};
            for (View* v : {&scene.source, &scene.target})
                if (!has_faces(v->projection)) *v = {v->projection, 1000, 500, 100};
            scene.target.width = has_faces(to) ? scene.target.width : 64;
            scene.target.height = has_faces(to) ? scene.target.height : 48;
            const Findings found = expect_truth(scene);
            EXPECT_GT(found.worst, 0) << words(scene);
            EXPECT_LE(found.worst_bound, 1e-4) << words(scene);
        }
}

TEST(PanoramaTruth, StraightBehindALensIsItsRim) {
    // The middle of the back face, which faces of odd size have.
    for (const Projection lens : {fisheye, equisolid}) {
        const Panorama map({lens, 1000, 1000, 360}, {cubemap3x2, 15, 10});
        Point<double> p{};
        int piece = 0;
        ASSERT_TRUE(map.exact(12.5, 7.5, 5, p, piece)) << name_of(lens);
        EXPECT_NEAR(std::hypot(p.x - 500, p.y - 500), 500, 1e-9) << name_of(lens);
    }
    // Beyond the end of a lens that does not reach so far: out of its picture.
    const Panorama half({fisheye, 1000, 1000, 180}, {cubemap3x2, 15, 10});
    Point<double> p{};
    int piece = 0;
    ASSERT_TRUE(half.exact(12.5, 7.5, 5, p, piece));
    EXPECT_NEAR(std::hypot(p.x - 500, p.y - 500), 1000, 1e-9);
    const Panorama plane({stereographic, 1000, 1000, 359}, {cubemap3x2, 15, 10});
    EXPECT_FALSE(plane.exact(12.5, 7.5, 5, p, piece));
    // And ahead is the middle.
    ASSERT_TRUE(half.exact(7.5, 7.5, 4, p, piece));
    EXPECT_NEAR(p.x, 500, 1e-9);
    EXPECT_NEAR(p.y, 500, 1e-9);
}

TEST(PanoramaTruth, TallMercatorPicturesReachTheirPoles) {
    const Panorama map({equirectangular, 512, 256}, {mercator, 4, 1200, 360});
    for (const double y : {0.5, 10.5, 100.5, 1199.5}) {
        Point<double> p{};
        int piece = 0;
        ASSERT_TRUE(map.exact(0.5, y, 0, p, piece)) << y;
        EXPECT_NEAR(p.x, 64, 1e-9);
        EXPECT_NEAR(p.y, y < 600 ? 0 : 256, 1e-9);
    }
}

TEST(PanoramaTruth, TheErrorPictureIsAgainstLongDouble) {
    const View source{equirectangular, 65536, 32768, 360}, target{rectilinear, 96, 64, 90};
    const Scene scene{source, target, {33, 44, 55}, 0};
    const Panorama map = scene.map();
    const PanoramaPlan plan(map, scene.options());
    std::vector<float> pixels(96 * 64);
    const ImageView picture =
        packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, 96, 64, 1);
    ASSERT_TRUE(test::draw_map(plan, Border(map.source(), Wrap::automatic), Filter::bilinear, Output::error,
                               nullptr, {0, 0, 96, 64}, picture, serial_for));
    float most = 0;
    int seen = 0;
    PointsInDouble used;
    for (const Block& block : plan.blocks(0)) {
        ASSERT_TRUE(in_double(block));
        used.read(plan, block, 0, block.box.height());
        for (int j = block.box.y0; j < block.box.y1; ++j)
            for (int i = block.box.x0; i < block.box.x1; ++i, ++seen) {
                Vector ray;
                const Piece& piece = map.target().pieces()[0];
                ASSERT_TRUE(oracle::ray_of(target, piece, i + 0.5L, j + 0.5L, ray));
                const Point<long double> truth =
                    oracle::point_of(source, map.source().pieces()[0], oracle::rotated(ray, scene.look));
                const float error = pixels[static_cast<std::size_t>(j * 96 + i)];
                const Point<double> at = used.at(i - block.box.x0, j - block.box.y0);
                ASSERT_NEAR(error, static_cast<double>(distance(source, at, truth)), 1e-12);
                most = std::max(most, error);
            }
    }
    EXPECT_EQ(seen, 96 * 64);
    EXPECT_GT(most, 2e-12);
    EXPECT_LT(most, 1e-9);
}

// Rounding of Taylor polynomials, in all their coefficients together, is below its bound.
TEST(PanoramaTruth, TaylorPolynomialsRoundLessThanTheirBound) {
    Random random(5);
    int finite = 0, tried = 0;
    double most = 0;
    for (int round = 0; round < 20; ++round)
        for (const Projection from : kAll)
            for (const Projection to : kAll) {
                const Panorama map(chart_of(random.view(from, true)), chart_of(random.view(to, false)),
                                   {random.angle(), random.angle(), random.angle()});
                const int piece = random.integer(0, static_cast<int>(map.target().pieces().size()) - 1);
                const Box& box = map.target().pieces()[static_cast<std::size_t>(piece)].box;
                const double x = random.between(box.x0, box.x1), y = random.between(box.y0, box.y1);
                const double hx = random.between(0.1, 8), hy = random.between(0.1, 8),
                             d = random.between(0, 3);
                const Panorama::Local local = map.local_around(x, y, piece);
                const auto bound = taylor_rounding(map, {x - d, x + d}, {y - d, y + d}, hx, hy, local);
                ++tried;
                if (!(bound.error.x < 1 && bound.error.y < 1)) continue;
                ++finite;
                const double px = x + random.between(-d, d), py = y + random.between(-d, d);
                using J = Jet<double, 4>;
                using K = Jet<long double, 4>;
                const Point<J> p = map(J::variable(px, hx, 0), J::variable(py, 0, hy), local);
                const Point<K> q = map(K::variable(px, hx, 0), K::variable(py, 0, hy), local);
                const auto check = [&](const J& a, const K& b, double error, double size) {
                    Real off = 0, sum = 0;
                    for (int i = 0; i < J::kSize; ++i) {
                        off += std::fabs(a.c[i] - b.c[i]);
                        sum += std::fabs(b.c[i]);
                    }
                    EXPECT_LE(off, error) << name_of(from) << ' ' << name_of(to);
                    EXPECT_LE(sum, size) << name_of(from) << ' ' << name_of(to);
                    most = std::max(most, static_cast<double>(off / error));
                };
                check(p.x, q.x, bound.error.x, bound.size.x);
                check(p.y, q.y, bound.error.y, bound.size.y);
            }
    EXPECT_GT(finite, tried / 4);
    EXPECT_GT(most, 1e-4);
}

/// A source of given level sizes and nothing else.
class Sizes final : public Source {
  public:
    Sizes(int width, int height) {
        for (;; width = std::max(1, width / 2), height = std::max(1, height / 2)) {
            m_sizes.push_back({width, height});
            if (width == 1 && height == 1) break;
        }
    }
    PixelType type() const noexcept override { return PixelType::float32; }
    int channels() const noexcept override { return 1; }
    int levels() const noexcept override { return static_cast<int>(m_sizes.size()); }
    Size size(int level) const noexcept override { return m_sizes[static_cast<std::size_t>(level)]; }
    bool read(int, const Box&, std::byte*, std::ptrdiff_t) const noexcept override { return false; }

  private:
    std::vector<Size> m_sizes;
};

// Whatever is left out has no texel of the source in any tap, with the steepest footprints too.
TEST(PanoramaTruth, WhatIsCulledHasNoTexels) {
    const Scene scenes[] = {
        // Far more minified one way than the other.
        {{cylindrical, 4095, 4095, 60}, {equirectangular, 400, 200, 360}, {20, 10, 0}, 0.5, Scheme::blocks},
        {{rectilinear, 3000, 3000, 20}, {equirectangular, 600, 300, 360}, {20, 30, 0}, 0.5, Scheme::blocks},
        {{rectilinear, 30000, 7, 20}, {equirectangular, 600, 300, 360}, {20, 30, 0}, 0.5, Scheme::blocks},
        {{stereographic, 9000, 9000, 100}, {fisheye, 300, 300, 360}, {0, 20, 40}, 0.5, Scheme::blocks},
        {{fisheye, 9000, 9000, 30}, {equirectangular, 300, 150, 360}, {0, 20, 40}, 0.5, Scheme::blocks},
        // Magnified, where footprints reach least.
        {{rectilinear, 300, 200, 40}, {rectilinear, 1000, 700, 90}, {20, 10, 5}, 0.5, Scheme::automatic},
        {{fisheye, 200, 200, 60}, {rectilinear, 900, 700, 100}, {20, 10, 5}, 0.01, Scheme::blocks},
        // Direct blocks, and exact ones.
        {{fisheye, 9000, 9000, 30}, {equirectangular, 300, 150, 360}, {0, 20, 40}, 0.5, Scheme::automatic},
        {{rectilinear, 3000, 3000, 20}, {equirectangular, 600, 300, 360}, {20, 30, 0}, 0, Scheme::automatic},
        {{cylindrical, 4095, 4095, 60}, {fisheye, 400, 400, 200}, {20, 10, 0}, 1e-6, Scheme::automatic},
    };
    std::int64_t all_culled = 0;
    double coarsest = 0;
    for (const Scene& scene : scenes) {
        const Panorama map = scene.map();
        const PanoramaPlan plan(map, scene.options());
        const Sizes source(scene.source.width, scene.source.height);
        const FootprintChooser chooser(source);
        std::int64_t culled = 0, hit = 0;
        double widest = 0;
        for (std::int64_t region = 0; region < plan.regions(); ++region)
            for (const Block& block : plan.blocks(region)) {
                if (block.kind != Block::Kind::outside) continue;
                for (int j = block.box.y0; j < block.box.y1; ++j)
                    for (int i = block.box.x0; i < block.box.x1; ++i) {
                        Point<double> p{};
                        int piece = 0;
                        if (!map.exact(i + 0.5, j + 0.5, block.piece, p, piece)) continue;
                        ++culled;
                        const Jacobian jacobian = plan.jacobian(i + 0.5, j + 0.5, block.piece);
                        const Footprint f = chooser(jacobian);
                        const auto& scale = chooser.scale(f.level);
                        const Size size = source.size(f.level);
                        widest = std::max(widest, 1 / scale[0]);
                        for (int a = 0; a < f.taps_a; ++a)
                            for (int b = 0; b < f.taps_b; ++b) {
                                const Point<double> o = TapOffsets(f, jacobian, scale)(a, b);
                                const double u = p.x * scale[0] + o.x, v = p.y * scale[1] + o.y;
                                hit += u > -0.5 && u < size.width + 0.5 && v > -0.5 && v < size.height + 0.5;
                            }
                    }
            }
        EXPECT_EQ(hit, 0) << words(scene);
        all_culled += culled;
        coarsest = std::max(coarsest, widest);
    }
    EXPECT_GT(all_culled, 1000);
    EXPECT_GT(coarsest, 1);
}

/// Where the first block is that is drawn though all its pixels have source points, each `margin` times farther beyond the
/// image than it is steep.
std::string first_beyond(const Panorama& map, const PanoramaPlan& plan, double margin) {
    const Size size = map.source_size();
    const auto may_show = [&](double x, double y, int target_piece) {
        Point<double> p{};
        int piece = 0;
        if (!map.exact(x, y, target_piece, p, piece)) return true;
        const Jacobian j = plan.jacobian(x, y, target_piece);
        const double steps = std::fabs(j.x_i) + std::fabs(j.x_j) + std::fabs(j.y_i) + std::fabs(j.y_j);
        const double reach = margin * std::max(1.0, steps);
        return p.x > -reach && p.x < size.width + reach && p.y > -reach && p.y < size.height + reach;
    };
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region)) {
            bool shows = block.kind == Block::Kind::outside;
            for (int j = block.box.y0; j < block.box.y1 && !shows; ++j)
                for (int i = block.box.x0; i < block.box.x1 && !shows; ++i)
                    shows = may_show(i + 0.5, j + 0.5, block.piece);
            if (!shows) return std::to_string(block.box.x0) + ", " + std::to_string(block.box.y0);
        }
    return "";
}

// Block by block, not only where all of a region lies beyond an edge. (Next to a fold bounds are too wide to tell.)
TEST(PanoramaTruth, NoBlockIsDrawnThatLiesBeyondAnEdge) {
    const Chart view(rectilinear, 1024, 1024, 60);
    for (const char* lens : {"none", "3de4:k1=0.1,k2=0.03", "brown:k1=-0.1,k2=0.02,p1=0.002",
                             "brown:k1=-0.1,k2=0.02,s1=0.002,s4=-0.001"})
        for (const double tol : {0.01, 1e-3, 1e-6, 0.0}) {
            const Chart source(rectilinear, 2048, 2048, 90, PixelSpacing::edges, "", 1,
                               LensModel::parse(lens));
            const Panorama map(source, view, {30, 20, 10});
            PlanOptions options;
            options.tol = tol;
            EXPECT_EQ(first_beyond(map, PanoramaPlan(map, options), 50), "") << lens << ", tol " << tol;
        }
}

TEST(Rotation, AnglesAreReducedExactly) {
    const auto same = [](const Orientation& a, const Orientation& b) {
        const glm::dmat3 m = rotation(a), n = rotation(b);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) EXPECT_EQ(m[i][j], n[i][j]) << i << ' ' << j;
    };
    same({360e9 + 17, 0, 0}, {17, 0, 0});
    same({-1e12, 0, 0}, {-std::fmod(1e12, 360.0), 0, 0});
    same({0, 180, 0}, {180, 0, 180});
    const glm::dmat3 back = rotation({180, 0, 0});
    EXPECT_EQ(back[0][0], -1);
    EXPECT_EQ(back[2][0], 0);
    EXPECT_EQ(rotation({0, 90, 0})[2][1], -1);
}

}  // namespace
}  // namespace anamorph
