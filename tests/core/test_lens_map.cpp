// SPDX-License-Identifier: Apache-2.0
// A lens's distortion taken off a picture or put on one, in blocks: against the models in long double.
#include "anamorph/lens/lens_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "anamorph/error.h"
#include "anamorph/formula/text_map.h"
#include "anamorph/lens/lens_plan.h"
#include "block_points.h"
#include "panorama_oracle.h"

namespace anamorph::test_lens_map {
namespace {

using oracle::chart_of;
using oracle::LensOracle;
using oracle::View;
using Real = long double;

constexpr Size kPicture = {310, 206};

View view_of(const std::string& lens) {
    return oracle::view_through(lens, kPicture, 80);
}

const char* const kLenses[] = {"ptlens:a=0.01,b=-0.03,c=0.02",
                               "ptlens:a=-0.02,b=0.05,c=-0.03,d=12.5,e=-20",
                               "ptlens:b=-0.45",
                               "brown:k1=-0.2,k2=0.05,k3=-0.004",
                               "brown:k1=0.1,k2=0.02,k3=0.001,k4=0.15,k5=0.01,k6=0.002",
                               "brown:k1=-0.1,k2=0.02,p1=0.002,p2=-0.003",
                               "brown:k1=-0.1,k2=0.02,p2=-0.003,s1=0.002,s4=-0.001",
                               "poly:k0=-0.02,k1=0.02,k2=-0.03,k3=0.01,k4=0.002",
                               "3de4:k1=-0.25,d=20,e=10",
                               "3de4:k1=0.1,k2=0.03",
                               "ptlens:a=-0.01,b=0.02,g=12,t=-7,d=5,e=-3",
                               "division:k1=-0.3",
                               "division:k1=0.1,k2=0.03,d=9",
                               "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003"};

/// Where a lens's centre is, from the picture's middle, in pixels.
Point<Real> centre_of(const View& view) {
    return oracle::lens_of(view).centre(view);
}

/// The true source point of a target point; not a number where there is none.
class Truth {
  public:
    Truth(const View& view, LensMode mode, const Size& covered, const Size& target, const Size& source)
        : m_view(view),
          m_lens(view),
          m_mode(mode),
          m_covered(covered),
          m_target(target),
          m_source(source),
          m_centre(centre_of(view)) {}

    Point<Real> operator()(Real x, Real y) const {
        const auto from_middle = [](Real at, int pixels, int shown) {
            return (at / pixels - Real(1) / 2) * shown;
        };
        Point<Real> p{from_middle(x, m_target.width, m_covered.width) + Real(kPicture.width) / 2,
                      from_middle(y, m_target.height, m_covered.height) + Real(kPicture.height) / 2};
        // The oracle's ideal picture has the axis in its middle; the centre stands where it is in the observed one.
        if (m_mode == LensMode::undistort) p = {p.x - m_centre.x, p.y - m_centre.y};
        Point<Real> q = m_mode == LensMode::undistort ? m_lens.observed(m_view, p) : m_lens.ideal(m_view, p);
        if (m_mode == LensMode::distort) q = {q.x + m_centre.x, q.y + m_centre.y};
        return {q.x - Real(kPicture.width) / 2 + Real(m_source.width) / 2,
                q.y - Real(kPicture.height) / 2 + Real(m_source.height) / 2};
    }

  private:
    View m_view;
    LensOracle m_lens;
    LensMode m_mode;
    Size m_covered, m_target, m_source;
    Point<Real> m_centre;
};

struct Findings {
    std::int64_t over = 0, lost = 0, pixels = 0, exact = 0;
    double bound = 0;
};

Findings examine(const LensPlan& plan, const Truth& truth) {
    Findings found;
    const Size source = plan.map().source_size();
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region)) {
            found.bound = std::max(found.bound, block.bound);
            const bool drawn = test::has_points(block);
            for (int j = block.box.y0; j < block.box.y1; ++j) {
                const test::BlockRow row(plan, block, j);
                for (int i = block.box.x0; i < block.box.x1; ++i) {
                    ++found.pixels;
                    found.exact += block.kind == Block::Kind::exact;
                    const Point<Real> at = truth(i + 0.5L, j + 0.5L);
                    Point<double> p{};
                    int piece = 0;
                    bool seen = drawn;
                    if (drawn)
                        p = row.at(i);
                    else if (block.kind == Block::Kind::exact)
                        seen = static_cast<const BlockMap&>(plan).exact(block, i + 0.5, j + 0.5, p, piece);
                    constexpr double kFilter = 4;
                    const bool in_source = at.x > -kFilter && at.x < source.width + kFilter &&
                                           at.y > -kFilter && at.y < source.height + kFilter;
                    if (!seen)
                        found.lost += in_source;
                    else if (std::isfinite(at.x))
                        found.over += std::hypot(p.x - at.x, p.y - at.y) > block.bound;
                }
            }
        }
    return found;
}

TEST(LensMap, EveryLensHoldsEveryToleranceBothWays) {
    constexpr unsigned kSeed = 1971;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    const double tols[] = {1, 1.0 / 16, 0.01, 1e-3, 1e-4, 1e-6, 0};
    for (const char* text : kLenses)
        for (const LensMode mode : {LensMode::undistort, LensMode::distort}) {
            const double tol = tols[random() % std::size(tols)];
            SCOPED_TRACE(::testing::Message()
                         << text << " mode " << static_cast<int>(mode) << " tol " << tol);
            const View view = view_of(text);
            const Size target{kPicture.width + static_cast<int>(random() % 60) - 30, kPicture.height},
                source{kPicture.width + static_cast<int>(random() % 20), kPicture.height - 7};
            PlanOptions options;
            options.tol = tol;
            const LensPlan plan(LensMap(chart_of(view), mode, target, target, source), options);
            const Findings found = examine(plan, Truth(view, mode, target, target, source));
            EXPECT_EQ(found.over, 0);
            EXPECT_EQ(found.lost, 0);
            EXPECT_EQ(found.pixels, std::int64_t{target.width} * target.height);
            EXPECT_LE(found.bound, tol > 0 ? tol : 1e-6);
            // Where the model is a formula, not the root of one.
            const bool formula = (mode == LensMode::undistort) != std::string(text).starts_with("3de4");
            if (formula && tol >= 0.01) {
                EXPECT_LT(found.exact, found.pixels / 3);
            }
        }
}

// Levels of a pyramid show the same with fewer pixels, which may not be square.
TEST(LensMap, LevelsShowTheSame) {
    const View view = view_of("brown:k1=-0.2,k2=0.05,k3=-0.004");
    for (const LensMode mode : {LensMode::undistort, LensMode::distort}) {
        const Size covered{401, 303}, target{200, 151};
        const LensPlan plan(LensMap(chart_of(view), mode, covered, target, kPicture), {});
        const Findings found = examine(plan, Truth(view, mode, covered, target, kPicture));
        EXPECT_EQ(found.over, 0);
        EXPECT_EQ(found.lost, 0);
    }
}

TEST(LensMap, CoveringCutsNothingOff) {
    for (const char* text : kLenses)
        for (const LensMode mode : {LensMode::undistort, LensMode::distort}) {
            SCOPED_TRACE(::testing::Message() << text << " mode " << static_cast<int>(mode));
            const View view = view_of(text);
            const LensOracle lens(view);
            const Size all = LensMap::covering(chart_of(view), mode, kPicture);
            EXPECT_EQ((all.width - kPicture.width) % 2, 0);
            EXPECT_EQ((all.height - kPicture.height) % 2, 0);
            // How far from the middle points of the picture's outline go, with those of a lens that ends before.
            Real across = 0, down = 0;
            for (int i = 0; i <= 4000; ++i) {
                const Real s = i / Real(4000), w = kPicture.width, h = kPicture.height;
                for (const Point<Real> p : {Point<Real>{s * w, 0}, {s * w, h}, {0, s * h}, {w, s * h}}) {
                    const Point<Real> c = centre_of(view);
                    Point<Real> q = mode == LensMode::undistort ? lens.ideal(view, p)
                                                                : lens.observed(view, {p.x - c.x, p.y - c.y});
                    if (mode == LensMode::undistort) q = {q.x + c.x, q.y + c.y};
                    if (!std::isfinite(q.x)) continue;
                    across = std::max(across, std::fabs(q.x - w / 2));
                    down = std::max(down, std::fabs(q.y - h / 2));
                }
            }
            EXPECT_GE(all.width / Real(2), across - 1e-5L);
            EXPECT_GE(all.height / Real(2), down - 1e-5L);
            // Nor much more, but for lenses that end within the picture, where its outline does not come.
            const std::string name = text;
            if (name == "ptlens:b=-0.45" || (name.starts_with("3de4:k1=-0.25") && mode == LensMode::distort))
                continue;
            EXPECT_LE(all.width / Real(2), across + 2);
            EXPECT_LE(all.height / Real(2), down + 2);
        }
}

// By the models' own formulas about (cx, cy), as OpenCV and 3DEqualizer have them: the principal point stays where it is.
TEST(LensMap, KeepsThePrincipalPoint) {
    const double fov = 80, d = 12, e = -6;
    const Real w = kPicture.width, h = kPicture.height, cx = w / 2 + d, cy = h / 2 + e,
               f = w / 2 / std::tan(Real(fov) * std::numbers::pi_v<Real> / 360),
               diagonal = std::hypot(w, h) / 2, k1 = -0.1L, k2 = 0.02L, p1 = 0.002L, p2 = -0.003L;
    const auto brown = [&](Real x, Real y) {
        x = (x - cx) / f, y = (y - cy) / f;
        const Real r2 = x * x + y * y, s = 1 + k1 * r2 + k2 * r2 * r2;
        return Point<Real>{cx + f * (x * s + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)),
                           cy + f * (y * s + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y)};
    };
    const auto three_de4 = [&](Real x, Real y) {
        x = (x - cx) / diagonal, y = (y - cy) / diagonal;
        const Real r2 = x * x + y * y, s = 1 + k1 * r2 + k2 * r2 * r2;
        return Point<Real>{cx + diagonal * x * s, cy + diagonal * y * s};
    };
    const auto expect = [&](const char* lens, LensMode mode, const auto& formula) {
        SCOPED_TRACE(lens);
        const Chart chart(Projection::rectilinear, kPicture.width, kPicture.height, fov, PixelSpacing::edges,
                          "", 1, LensModel::parse(lens));
        const LensMap map(chart, mode, kPicture, kPicture, kPicture);
        double most = 0;
        for (int y = 0; y < kPicture.height; y += 5)
            for (int x = 0; x < kPicture.width; x += 5) {
                const Point<double> p = map.source_point(x + 0.5, y + 0.5);
                const Point<Real> q = formula(x + 0.5L, y + 0.5L);
                most = std::max(most, static_cast<double>(std::hypot(p.x - q.x, p.y - q.y)));
            }
        EXPECT_LT(most, 1e-9);
    };
    expect("brown:k1=-0.1,k2=0.02,p1=0.002,p2=-0.003,d=12,e=-6", LensMode::undistort, brown);
    expect("3de4:k1=-0.1,k2=0.02,d=12,e=-6", LensMode::distort, three_de4);
    const auto nothing = [](Real x, Real y) { return Point<Real>{x, y}; };
    for (const LensMode mode : {LensMode::undistort, LensMode::distort})
        for (const char* lens : {"3de4:k1=0,d=12,e=-6", "brown:d=12,e=-6", "ptlens:d=12,e=-6"})
            expect(lens, mode, nothing);
}

TEST(LensMap, NeedsALens) {
    EXPECT_THROW(
        LensMap(Chart(Projection::rectilinear, 10, 10), LensMode::distort, {10, 10}, {10, 10}, {10, 10}),
        Error);
}

TEST(LensMap, LensesAsTextAreTheSame) {
    struct Written {
        std::string lens;
        LensMode mode;
        std::string
            let;  ///< X and Y in the model's unit, the unit w in pixels, and U and V on the other side
    };
    const std::string about = "X=(x-width/2)/w;Y=(y-height/2)/w;q=X*X+Y*Y;";
    const Written all[] = {
        {"ptlens:a=0.01,b=-0.03,c=0.02", LensMode::undistort,
         "w=height/2;" + about + "n=sqrt(q);k=0.01*n^3-0.03*n^2+0.02*n+1-0.01+0.03-0.02;U=X*k;V=Y*k"},
        {"3de4:k1=0.1,k2=0.03", LensMode::distort,
         "w=hypot(width,height)/2;" + about + "k=1+0.1*q+0.03*q^2;U=X*k;V=Y*k"},
        {"brown:k1=-0.1,k2=0.02,p1=0.002,p2=-0.003", LensMode::undistort,
         "w=width/2/tan(pi*40/180);" + about +
             "k=1-0.1*q+0.02*q^2;U=X*k+2*0.002*X*Y-0.003*(q+2*X^2);V=Y*k+0.002*(q+2*Y^2)-2*0.003*X*Y"},
    };
    for (const Written& written : all) {
        SCOPED_TRACE(written.lens);
        FormulaText text;
        text.let = written.let;
        text.u = "width/2+w*U";
        text.v = "height/2+w*V";
        const TextMap in_words(parse_formula(text, {kPicture, kPicture}), kPicture, kPicture, kPicture);
        const LensMap compiled(chart_of(view_of(written.lens)), written.mode, kPicture, kPicture, kPicture);
        for (double y = 0.5; y < kPicture.height; y += 3)
            for (double x = 0.5; x < kPicture.width; x += 3) {
                Point<double> p{}, q{};
                int piece = 0;
                ASSERT_TRUE(in_words.exact(x, y, 0, p, piece));
                ASSERT_TRUE(compiled.exact(x, y, 0, q, piece)) << x << " " << y;
                const double bound = in_words.exact_error<double>(Interval(x), Interval(y), 0) +
                                     compiled.exact_error<double>(Interval(x), Interval(y), 0);
                ASSERT_LE(std::hypot(p.x - q.x, p.y - q.y), bound) << x << " " << y;
            }
    }
}

}  // namespace
}  // namespace anamorph::test_lens_map
