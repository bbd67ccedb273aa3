// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/near_far.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anamorph/error.h"
#include "anamorph/image/block_sampler.h"
#include "anamorph/morph/near_far_kernels.h"
#include "each_feature_block.h"
#include "feature_families.h"

namespace anamorph::test_near_far {
namespace {

/// The worst pixel of a plan, and what it promised.
struct Outcome {
    double error = 0, bound = 0, over = 0;  ///< over: the most by which an error exceeds its block's bound
    double exact_fraction = 0;
    std::int64_t pixels = 0;
};

Outcome measure(const FeatureMap& map, double tol) {
    const NearFar field(map, {tol, {0, 1}});
    Outcome out;
    each_feature_block(field, [&](int k, const Block& block, const BlockPoints& points) {
        out.bound = std::max(out.bound, block.bound);
        out.pixels += std::int64_t{block.box.width()} * block.box.height();
        if (!points.x) {
            out.exact_fraction += double(block.box.width()) * block.box.height();
            return;
        }
        for (int j = block.box.y0; j < block.box.y1; ++j)
            for (int i = block.box.x0; i < block.box.x1; ++i) {
                const Point<double> truth = map(i + 0.5, j + 0.5, k);
                const std::ptrdiff_t at = (j - block.box.y0) * points.row_stride + i - block.box.x0;
                const double error = std::hypot(block.base_x + double(points.x[at]) - truth.x,
                                                block.base_y + double(points.y[at]) - truth.y);
                // A NaN counts as the worst there is.
                out.error = std::isnan(error) ? HUGE_VAL : std::max(out.error, error);
                out.over = std::isnan(error) ? HUGE_VAL : std::max(out.over, error - block.bound);
            }
    });
    out.exact_fraction /= static_cast<double>(out.pixels);
    return out;
}

FeatureMap map_of(const Features& features, Size size, const LineWeights& weights, double t = 0.5) {
    return FeatureMap(features, {size, size}, size, {1 - t, t}, weights);
}

void expect_holds(const FeatureMap& map, double tol) {
    const Outcome o = measure(map, tol);
    EXPECT_LE(o.over, 0) << "a pixel is farther off than its bound; error " << o.error << " bound "
                         << o.bound;
    EXPECT_LE(o.bound, tol);
    EXPECT_EQ(o.pixels, std::int64_t{2} * map.target().width * map.target().height);
}

constexpr double kTols[] = {1, 0.25, 0.1, 1.0 / 16, 1.0 / 64, 0.005};

TEST(NearFar, NoPixelIsOverItsBoundAndNoBoundOverTheTolerance) {
    constexpr unsigned kSeed = 5;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    for (const std::string& family : families::names())
        for (const LineWeights& w :
             {LineWeights{2, 1, 0.5}, LineWeights{1, 2, 0.5}, LineWeights{0.1, 0.5, 1},
              LineWeights{0.01, 2, 0}, LineWeights{0.01, 1, 0.5}, LineWeights{1, 1.5, 0.5}}) {
            SCOPED_TRACE(testing::Message() << family << " a " << w.a << " b " << w.b << " p " << w.p);
            const auto features = families::Maker(220, kSeed).make(family, 32);
            const FeatureMap map = map_of(*features, {220, 150}, w, 0.3);
            for (const double tol : kTols) {
                SCOPED_TRACE(testing::Message() << "tol " << tol);
                expect_holds(map, tol);
            }
        }
}

// Where every pixel is exact, its own rounding is bounded as finely as is asked for.
TEST(NearFar, SmallTolerancesHold) {
    for (const std::string& family : families::names())
        for (const LineWeights& w :
             {LineWeights{2, 1, 0.5}, LineWeights{1, 2, 0}, LineWeights{0.01, 1.5, 0.5}}) {
            const auto features = families::Maker(150, 3).make(family, 60);
            const FeatureMap map = map_of(*features, {150, 130}, w, 0.3);
            for (const double tol : {1e-4, 1e-6, 1e-7}) {
                SCOPED_TRACE(testing::Message() << family << " a " << w.a << " tol " << tol);
                expect_holds(map, tol);
            }
        }
}

TEST(NearFar, ManySeedsHold) {
    for (unsigned seed = 100; seed < 112; ++seed)
        for (const std::string& family : families::names()) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << " " << family);
            std::mt19937 random(seed);
            std::uniform_real_distribution<double> unit(0, 1);
            const auto features =
                families::Maker(160, seed).make(family, 3 + static_cast<int>(60 * unit(random)));
            const LineWeights w{std::pow(10, 2 * unit(random) - 2), 2 * unit(random), unit(random)};
            const FeatureMap map = map_of(*features, {131, 97}, w, unit(random));
            expect_holds(map, std::pow(10, -3 * unit(random)));
        }
}

/// Peano's kernel of order 3 of interpolation at the roots of T_K: e(s, t), the error at s for f = (s - t)+^2
/// / 2.
class PeanoKernel {
  public:
    explicit PeanoKernel(int k) : m_k(static_cast<std::size_t>(k)) {
        for (std::size_t i = 0; i < m_k; ++i) {
            const double angle = (2 * double(i) + 1) * std::numbers::pi / (2 * k);
            m_node[m_k - 1 - i] = std::cos(angle);
            m_lebesgue += 1 / std::tan(angle / 2) / k;
        }
    }
    struct Size {
        double most = 0, integral = 0;  ///< of |e| over t
    };
    Size size(double s) const {
        double l[8];
        for (std::size_t i = 0; i < m_k; ++i) {
            l[i] = 1;
            for (std::size_t j = 0; j < m_k; ++j)
                if (j != i) l[i] *= (s - m_node[j]) / (m_node[i] - m_node[j]);
        }
        // Between -1, the nodes, s and 1 it is a parabola in t.
        double cut[11] = {-1, s, 1};
        std::copy_n(m_node, m_k, cut + 3);
        std::sort(cut, cut + m_k + 3);
        Size out;
        for (std::size_t n = 0; n + 1 < m_k + 3; ++n) {
            const double from = cut[n], to = cut[n + 1], middle = 0.5 * (from + to);
            double a = 0, b = 0, c = 0;  // e = (a - 2 b t + c t^2) / 2
            const auto term = [&](double weight, double at) {
                if (at <= middle) return;
                a += weight * at * at;
                b += weight * at;
                c += weight;
            };
            term(1, s);
            for (std::size_t i = 0; i < m_k; ++i) term(-l[i], m_node[i]);
            // Its extremes, and the integral from root to root.
            const double root = std::sqrt(std::max(b * b - a * c, 0.0));
            double at[5] = {from, (b - root) / c, b / c, (b + root) / c, to};
            for (double& t : at) t = t > from && t < to ? t : t >= to ? to : from;
            std::sort(at, at + 5);
            const auto integral = [&](double t) { return 0.5 * t * (a - t * (b - t * c / 3)); };
            for (int i = 0; i < 5; ++i) {
                out.most = std::max(out.most, std::fabs(0.5 * (a - at[i] * (2 * b - at[i] * c))));
                if (i > 0) out.integral += std::fabs(integral(at[i]) - integral(at[i - 1]));
            }
        }
        return out;
    }

    /// Is |e| at most `jump`, and its integral over t at most `third`, for all s in [from, to]? |de/ds| is at
    /// most 1 + (K - 1)^2 Lebesgue_K: less (s - t)^2 / 4, which interpolation keeps, f is at most 1 and its
    /// slope too, its interpolant at most Lebesgue_K, and a polynomial's slope (K - 1)^2 times that (Markov).
    bool below(double jump, double third, double from, double to) const {
        const double s = 0.5 * (from + to), steps = 0.5 * (to - from);
        const double slope = 1 + double((m_k - 1) * (m_k - 1)) * m_lebesgue;
        const Size z = size(s);
        constexpr double kRounding = 1e-9;
        if (z.most + slope * steps + kRounding <= jump && z.integral + 2 * slope * steps + kRounding <= third)
            return true;
        return steps > 1e-8 && below(jump, third, from, s) && below(jump, third, s, to);
    }

  private:
    std::size_t m_k;
    double m_node[8], m_lebesgue = 0;
};

TEST(NearFar, PeanosKernelsStayBelowTheirSuprema) {
    for (const int k : {4, 5, 6, 8}) {
        SCOPED_TRACE(testing::Message() << "K " << k);
        const PeanoKernel kernel(k);
        const double jump = double(simd::jump_error(k)), third = double(simd::third_error(k));
        // Turned about 0 it only changes its sign.
        EXPECT_TRUE(kernel.below(jump, third, 0, 1));
        // And they are not far above.
        EXPECT_FALSE(kernel.below(0.93 * jump, 1, 0, 1));
        EXPECT_FALSE(kernel.below(1, 0.93 * third, 0, 1));
    }
}

/// The weight of a line from (0, 0) to (length, 0), in double.
double weight_at(double x, double y, double length, const LineWeights& w) {
    return std::pow(w.a + feature_detail::distance_to_line(-x, x - length, y), -w.b);
}

/// Interpolates values at the K x K Chebyshev nodes, and compares on a grid: the largest difference.
template <class F>
double interpolation_error(int k, const F& f) {
    constexpr int kGrid = 25;
    std::vector<double> node(static_cast<std::size_t>(k));
    for (int i = 0; i < k; ++i)
        node[static_cast<std::size_t>(i)] = std::cos((2 * i + 1) * std::numbers::pi / (2 * k));
    const auto lagrange = [&](int i, double s) {
        double l = 1;
        for (int j = 0; j < k; ++j)
            if (j != i)
                l *= (s - node[static_cast<std::size_t>(j)]) /
                     (node[static_cast<std::size_t>(i)] - node[static_cast<std::size_t>(j)]);
        return l;
    };
    double worst = 0;
    for (int a = 0; a <= kGrid; ++a)
        for (int b = 0; b <= kGrid; ++b) {
            const double s = 2.0 * a / kGrid - 1, t = 2.0 * b / kGrid - 1;
            double p = 0;
            for (int i = 0; i < k; ++i)
                for (int j = 0; j < k; ++j)
                    p += lagrange(i, s) * lagrange(j, t) *
                         f(node[static_cast<std::size_t>(i)], node[static_cast<std::size_t>(j)]);
            worst = std::max(worst, std::fabs(f(s, t) - p));
        }
    return worst;
}

TEST(NearFar, InterpolationErrorsStayBelowTheirClosedForms) {
    constexpr unsigned kSeed = 31;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> unit(0, 1);
    int known = 0, close = 0;
    for (int n = 0; n < 3000; ++n) {
        constexpr int kDegrees[] = {4, 5, 6, 8};
        const int k = kDegrees[static_cast<int>(4 * unit(random))];
        const LineWeights w{unit(random) < 0.3 ? 0 : 5 * unit(random), std::pow(4, unit(random) * 2 - 1), 0};
        const double half = 4 + 28 * unit(random), length = 100 * unit(random) * unit(random) + 1;
        const double angle = 6.2832 * unit(random), c = std::cos(angle), s = std::sin(angle);
        // The cell stands at the origin of its region, the line anywhere around it and turned.
        const double away = half * (1 + 4 * unit(random)), turn = 6.2832 * unit(random);
        const double x0 = away * std::cos(turn) + 0.5 * length, y0 = away * std::sin(turn);
        alignas(64) float data[simd::LineTable::kFields * 16] = {}, factor[16] = {1};
        const auto put = [&](int field, double v) { data[field * 16] = static_cast<float>(v); };
        for (int i = 1; i < 16; ++i) data[i] = 1e6f;
        put(simd::LineTable::kBefore, -x0);
        put(simd::LineTable::kBehind, x0 - length);
        put(simd::LineTable::kBeside, y0);
        put(simd::LineTable::kAlongX, c);
        put(simd::LineTable::kAlongY, s);
        put(simd::LineTable::kSlope, 1 / half);
        const simd::LineTable table{data, 16, factor, 1};
        alignas(64) float out[9][16];
        simd::LineBounds bounds{out[0], out[1], out[2], out[3], out[4], {out[5], out[6], out[7], out[8]},
                                {},     0};
        const float lebesgue = k == 4 ? 1.8478f : k == 5 ? 1.9889f : k == 6 ? 2.1045f : 2.2872f;
        simd::bound_lines(table, {0, 0, static_cast<float>(half)},
                          {static_cast<float>(w.a), static_cast<float>(w.b)}, k, lebesgue, bounds);
        if (!(bounds.value[0] < HUGE_VALF)) continue;
        ++known;
        const auto weight = [&](double u, double v) {
            return weight_at(x0 + half * (u * c + v * s), y0 + half * (v * c - u * s), length, w);
        };
        SCOPED_TRACE(testing::Message() << "line " << n << " K " << k << " a " << w.a << " b " << w.b);
        const double error = interpolation_error(k, weight);
        const double slack = 1e-6 * double(bounds.most[0]);
        EXPECT_LE(error, double(bounds.value[0]) + slack);
        EXPECT_LE(interpolation_error(k, [&](double u, double v) { return u * weight(u, v); }),
                  double(bounds.linear[0]) + slack);
        EXPECT_LE(interpolation_error(k, [&](double u, double v) { return v * weight(u, v); }),
                  double(bounds.linear[0]) + slack);
        close += error > 0.1 * double(bounds.value[0]);
    }
    // The test looks at something, and the bounds are of use.
    EXPECT_GT(known, 1500);
    EXPECT_GT(close, known / 100);
}

TEST(NearFar, MostPixelsAreNotComputedInDouble) {
    const auto features = families::Maker(300, 3).make("random", 32);
    const Outcome o = measure(map_of(*features, {300, 300}, {1, 2, 0.5}), 1.0 / 16);
    EXPECT_EQ(o.exact_fraction, 0);
}

TEST(NearFar, CoincidentAndCrossingLinesHold) {
    Features features;
    // One line three times, to three places; its reverse; and a star through one point.
    for (const double d : {10.0, -7.0, 3.0})
        features.add_line({{{20, 60}, {100, 60}}, {{20 + d, 60}, {100, 60 - d}}});
    features.add_line({{{100, 60}, {20, 60}}, {{110, 50}, {15, 61}}});
    for (int i = 0; i < 8; ++i) {
        const double c = 40 * std::cos(0.4 * i), s = 40 * std::sin(0.4 * i);
        features.add_line({{{64 - c, 80 - s}, {64 + c, 80 + s}}, {{60 - s, 84 - c}, {68 + s, 76 + c}}});
    }
    for (const double a : {1.0, 0.01, 0.0})
        for (const double b : {0.5, 1.0, 2.0})
            for (const double tol : kTols) {
                SCOPED_TRACE(testing::Message() << "a " << a << " b " << b << " tol " << tol);
                expect_holds(map_of(features, {140, 130}, {a, b, 0.5}), tol);
            }
}

TEST(NearFar, PixelsExactlyOnALineWithoutAHold) {
    Features features;
    features.add_line({{{10.5, 30.5}, {90.5, 30.5}}, {{10.5, 44.5}, {90.5, 38.5}}});
    features.add_line({{{50.5, 10.5}, {50.5, 70.5}}, {{54.5, 10.5}, {59.5, 70.5}}});
    features.add_line({{{3.5, 3.5}, {80.5, 80.5}}, {{3.5, 8.5}, {80.5, 70.5}}});
    for (const double b : {0.5, 1.0, 2.0, 8.0})
        for (const double t : {0.0, 0.5}) expect_holds(map_of(features, {100, 90}, {0, b, 0.5}, t), 1.0 / 64);
}

TEST(NearFar, AllExponentsHold) {
    const auto features = families::Maker(120, 8).make("random", 20);
    for (const double b : {0.0, 0.1, 1.7, 2.3, 8.0, 16.0})
        for (const double tol : {1.0, 1.0 / 64}) {
            SCOPED_TRACE(testing::Message() << "b " << b << " tol " << tol);
            expect_holds(map_of(*features, {120, 90}, {0.5, b, 0.5}), tol);
        }
}

TEST(NearFar, LinesAMillionPixelsAwayHold) {
    Features features;
    features.add_line({{{20, 20}, {80, 30}}, {{25, 22}, {78, 40}}});
    features.add_line({{{1e6, 2e5}, {1.1e6, 3e5}}, {{1e6 + 40, 2e5}, {1.1e6, 3e5 + 90}}});
    features.add_line({{{-1e6, 50}, {1e6, 51}}, {{-1e6, 60}, {1e6, 40}}});
    for (const double b : {0.5, 1.0, 2.0})
        for (const double tol : kTols) expect_holds(map_of(features, {150, 140}, {1, b, 0.5}), tol);
}

TEST(NearFar, LinesWhoseDistanceHasNoSquareInFloatsHold) {
    // A line that begins above the picture, so far away that the square of its distance is infinite as a
    // float, and that weighs more than the one in the picture all the same.
    const Features::Frame frame{150e-13, 140e-13};
    const auto at = [](double x, double y) { return Point<double>{x * 1e-13, y * 1e-13}; };
    for (const double distance : {1e19, 3e19, 1e21}) {
        SCOPED_TRACE(distance);
        Features features;
        for (const int shape : {0, 1}) features.set_frame(shape, frame);
        features.add_line({{at(20, 20), at(80, 30)}, {at(45, 52), at(98, 40)}}, 1e-12);
        const Line away{at(0, distance), at(1e-9 * distance, distance)};
        features.add_line({away, away});
        // Exact blocks say what double makes of such places: more than the tolerance.
        for (const double b : {0.25, 0.5, 1.0})
            EXPECT_LE(measure(map_of(features, {150, 140}, {1, b, 0}), 0.1).over, 0) << "b " << b;
    }
}

TEST(NearFar, SumsOfWeightsThatFloatsCannotHoldAreExact) {
    for (const double a : {0.08, 0.09, 0.1, 0.11}) {
        SCOPED_TRACE(a);
        Features features;
        features.add_line({{{10.5, 10}, {10.5, 118}}, {{90.5, 10}, {90.5, 118}}});
        features.add_line({{{118.5, 10}, {118.5, 118}}, {{38.5, 10}, {38.5, 118}}});
        expect_holds(map_of(features, {128, 128}, {a, 12, 0}, 0), 1);
    }
}

TEST(NearFar, OddSymmetricMapsHold) {
    // Turned about the middle of the picture, and of its cells: every test at a midpoint sees the identity.
    for (const double middle : {64.0, 128.0, 100.0}) {
        Features features;
        for (int i = 0; i < 6; ++i) {
            const double x = 9.0 * i + 12, y = 5.0 * i + 3, d = 20.0 - 3 * i;
            features.add_line({{{middle + x, middle + y}, {middle + x + 20, middle - y}},
                               {{middle + x + d, middle + y}, {middle + x + 20, middle - y + d}}});
            features.add_line({{{middle - x, middle - y}, {middle - x - 20, middle + y}},
                               {{middle - x - d, middle - y}, {middle - x - 20, middle + y - d}}});
        }
        for (const double tol : kTols) expect_holds(map_of(features, {200, 200}, {1, 1, 0.5}, 0), tol);
    }
}

TEST(NearFar, ThousandsOfLinesHold) {
    const auto features = families::Maker(400, 77).make("short", 3000);
    const FeatureMap map = map_of(*features, {150, 70}, {1, 2, 0.5});
    for (const double tol : {1.0, 1.0 / 16}) expect_holds(map, tol);
}

TEST(NearFar, AHundredThousandLinesHold) {
    const auto features = families::Maker(4000, 78).make("random", 100000);
    const FeatureMap map = map_of(*features, {2000, 2000}, {1, 2, 0.5});
    const NearFar field(map, {1.0 / 16, {0, 1}});
    // One region of many; the truth costs 1e5 lines a pixel.
    const std::int64_t region = field.regions_in({640, 640, 641, 641}).front();
    double over = -HUGE_VAL, bound = 0;
    int count = 0;
    each_feature_block(field, region, [&](int k, const Block& block, const BlockPoints& points) {
        bound = std::max(bound, block.bound);
        if (!points.x || count++ % 7) return;
        for (const int at : {0, block.box.width() - 1}) {
            const Point<double> truth = map(block.box.x0 + at + 0.5, block.box.y0 + 0.5, k);
            over = std::max(over, std::hypot(block.base_x + double(points.x[at]) - truth.x,
                                             block.base_y + double(points.y[at]) - truth.y) -
                                      block.bound);
        }
    });
    EXPECT_LE(over, 0);
    EXPECT_LE(bound, 1.0 / 16);
}

TEST(NearFar, PowersAreAsGoodAsStated) {
    // A line that ends at the node, seen from x away with a = 0: its weight is x^-b, x as it is.
    const float nodes[4] = {0, 0, 0, 0};
    const std::int32_t first = 0;
    for (const float b : {0.0f, 0.1f, 0.5f, 1.0f, 1.3f, 2.0f, 3.0f, 7.5f})
        for (double log = std::log(1e-6); log < std::log(1e12); log += 0.00731) {
            simd::FieldLine line{};
            line.before = static_cast<float>(std::exp(log));
            if (line.before < simd::kLeastDistance || b * std::fabs(log) > 80) continue;
            line.behind = -1;
            line.factor = 1;
            double sums[16 * 8] = {};
            simd::node_sums(&line, &first, 1, {0, 0, 0}, {0, b}, 4, nodes, sums);
            const long double truth =
                std::pow(static_cast<long double>(line.before), -static_cast<long double>(b));
            const double u = std::fabs(static_cast<double>(sums[0] / truth - 1)) / 0x1p-24;
            ASSERT_LE(u, simd::weight_rounding(double(b), std::fabs(log)) - 5 * double(b))
                << line.before << " to the power of " << -b;
        }
}

TEST(NearFar, EveryInstructionSetHolds) {
    const auto features = families::Maker(160, 21).make("crossing", 24);
    const FeatureMap map = map_of(*features, {160, 130}, {0.1, 2, 0.5});
    const FeatureMap other = map_of(*features, {160, 130}, {0.1, 1.3, 0.5});
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        for (const double tol : {0.25, 0.005}) {
            expect_holds(map, tol);
            expect_holds(other, tol);
        }
    }
    simd::use_instruction_set("");
}

/// All that a plan says and places: blocks, bounds and points, byte by byte.
std::vector<std::uint8_t> bytes_of(const FeatureMap& map, double tol) {
    const NearFar field(map, {tol, {0, 1}});
    std::vector<std::uint8_t> bytes;
    const auto put = [&](const auto& value) {
        const auto* at = reinterpret_cast<const std::uint8_t*>(&value);
        bytes.insert(bytes.end(), at, at + sizeof value);
    };
    each_feature_block(field, [&](int k, const Block& block, const BlockPoints& points) {
        for (const int n : {k, block.box.x0, block.box.y0, block.box.x1, block.box.y1,
                            static_cast<int>(block.kind), int{block.base_x}, int{block.base_y}})
            put(n);
        put(block.bound);
        if (!points.x) return;
        for (int j = 0; j < block.box.height(); ++j)
            for (int i = 0; i < block.box.width(); ++i) {
                put(points.x[j * points.row_stride + i]);
                put(points.y[j * points.row_stride + i]);
            }
    });
    return bytes;
}

TEST(NearFar, EveryInstructionSetGivesTheSameBits) {
    for (const std::string& family : families::names())
        for (const LineWeights& w : {LineWeights{1, 2, 0.5}, LineWeights{0.01, 1, 0.5},
                                     LineWeights{0.1, 0.5, 1}, LineWeights{0.1, 1.3, 0.5}}) {
            const auto features = families::Maker(200, 22).make(family, 40);
            const FeatureMap map = map_of(*features, {200, 150}, w, 0.3);
            for (const double tol : {0.25, 0.01}) {
                simd::use_instruction_set("");
                const std::vector<std::uint8_t> best = bytes_of(map, tol);
                for (const char* const* set = simd::instruction_sets(); *set; ++set) {
                    ASSERT_TRUE(simd::use_instruction_set(*set));
                    EXPECT_TRUE(bytes_of(map, tol) == best)
                        << *set << " " << family << " a " << w.a << " b " << w.b << " tol " << tol;
                }
            }
        }
    simd::use_instruction_set("");
}

/// Beier and Neely's map in long double, written out: the source point of (x, y) in shape `k`, from the
/// features alone.
class Oracle {
  public:
    /// `scale`: pixels for a unit of the features' lines.
    Oracle(const Features& features, double size_x, double size_y, double t, const LineWeights& w,
           double scale = 1)
        : m_weights(w), m_scale(scale) {
        for (std::size_t i = 0; i < features.size(); ++i)
            add(features.line(i, 0), features.line(i, 1), static_cast<long double>(features.weight(i)), t);
        if (features.border_weight() > 0) {
            const Line edges[] = {{{0, 0}, {size_x, 0}},
                                  {{size_x, 0}, {size_x, size_y}},
                                  {{size_x, size_y}, {0, size_y}},
                                  {{0, size_y}, {0, 0}}};
            for (const Line& e : edges) add(e, e, static_cast<long double>(features.border_weight()), t);
        }
    }
    void at(double px, double py, int k, long double& sx, long double& sy) const {
        const auto a = static_cast<long double>(m_weights.a), b = static_cast<long double>(m_weights.b);
        const auto p = static_cast<long double>(m_weights.p);
        long double sum = 0, dx = 0, dy = 0;
        for (const Pair& l : m_pairs) {
            const long double ex = l.qx - l.px, ey = l.qy - l.py, xx = px - l.px, yy = py - l.py;
            const long double square = ex * ex + ey * ey, length = std::sqrt(square);
            const long double u = (xx * ex + yy * ey) / square, v = (yy * ex - xx * ey) / length;
            const long double qx = px - l.qx, qy = py - l.qy;
            const long double distance = u < 0   ? std::sqrt(xx * xx + yy * yy)
                                         : u > 1 ? std::sqrt(qx * qx + qy * qy)
                                                 : std::fabs(v);
            const long double* s = l.shape[k];
            const long double fx = s[2] - s[0], fy = s[3] - s[1], own = std::sqrt(fx * fx + fy * fy);
            const long double weight = l.weight * std::pow(std::pow(length, p) / (a + distance), b);
            sum += weight;
            dx += weight * (s[0] + u * fx - v * fy / own - px);
            dy += weight * (s[1] + u * fy + v * fx / own - py);
        }
        sx = px + dx / sum;
        sy = py + dy / sum;
    }

  private:
    struct Pair {
        long double px, py, qx, qy, shape[2][4], weight;
    };
    void add(const Line& from, const Line& to, long double weight, double t) {
        const long double s = t * m_scale, r = (1 - static_cast<long double>(t)) * m_scale, u = m_scale;
        const auto mix = [&](double x, double y) { return r * x + s * y; };
        m_pairs.push_back({mix(from.p.x, to.p.x),
                           mix(from.p.y, to.p.y),
                           mix(from.q.x, to.q.x),
                           mix(from.q.y, to.q.y),
                           {{u * from.p.x, u * from.p.y, u * from.q.x, u * from.q.y},
                            {u * to.p.x, u * to.p.y, u * to.q.x, u * to.q.y}},
                           weight});
    }
    LineWeights m_weights;
    long double m_scale;
    std::vector<Pair> m_pairs;
};

/// Where both shapes are seen at every pixel, as the oracle says.
std::vector<Point<long double>> truth_of(const Oracle& oracle, Size size) {
    std::vector<Point<long double>> truth;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            for (int k = 0; k < 2; ++k) {
                Point<long double> p;
                oracle.at(x + 0.5, y + 0.5, k, p.x, p.y);
                truth.push_back(p);
            }
    return truth;
}

/// Every pixel of a plan against the truth: the largest error, error less bound, and bound.
Outcome against(const std::vector<Point<long double>>& truth, const FeatureMap& map, double tol) {
    const NearFar field(map, {tol, {0, 1}});
    const Size size = map.target();
    Outcome out;
    out.over = -HUGE_VAL;
    out.bound = field.reached(serial_for).max_error;
    each_feature_block(field, [&](int k, const Block& block, const BlockPoints& points) {
        for (int j = block.box.y0; j < block.box.y1; ++j)
            for (int i = block.box.x0; i < block.box.x1; ++i) {
                const std::ptrdiff_t at = (j - block.box.y0) * points.row_stride + i - block.box.x0;
                const Point<double> used = points.x ? Point<double>{block.base_x + double(points.x[at]),
                                                                    block.base_y + double(points.y[at])}
                                                    : map(i + 0.5, j + 0.5, k);
                const Point<long double>& p = truth[static_cast<std::size_t>((j * size.width + i) * 2 + k)];
                const auto error = static_cast<double>(std::hypot(used.x - p.x, used.y - p.y));
                out.error = std::isnan(error) ? HUGE_VAL : std::max(out.error, error);
                out.over = std::isnan(error) ? HUGE_VAL : std::max(out.over, error - block.bound);
                ++out.pixels;
            }
    });
    return out;
}

TEST(NearFar, NoPixelIsOverToleranceOrBoundByAnOracleOnAnyInstructionSet) {
    constexpr unsigned kSeed = 41;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    const Size size{100, 36};
    int n = 0;
    for (const std::string& family : families::names())
        for (const LineWeights& w :
             {LineWeights{1, 2, 0.5}, LineWeights{0.1, 0.5, 1}, LineWeights{0.01, 1, 0},
              LineWeights{0.3, 1.3, 0.5}, LineWeights{0, 2, 0.5}}) {
            Features features = *families::Maker(100, kSeed).make(family, 16);
            if (n++ % 2) features.pin_border(1);
            const FeatureMap map = map_of(features, size, w, 0.3);
            const auto truth = truth_of(Oracle(features, size.width, size.height, 0.3, w), size);
            for (const char* const* set = simd::instruction_sets(); *set; ++set)
                for (const double tol : {1.0, 0.1, 0.01, 1e-3, 1e-6, 0.0}) {
                    ASSERT_TRUE(simd::use_instruction_set(*set));
                    SCOPED_TRACE(testing::Message() << *set << " " << family << " a " << w.a << " b " << w.b
                                                    << " p " << w.p << " tol " << tol);
                    const Outcome o = against(truth, map, tol);
                    EXPECT_LE(o.over, 0) << "error " << o.error;
                    EXPECT_LE(o.error, tol > 0 ? tol : 1e-9);
                    EXPECT_LE(o.bound, tol > 0 ? tol : 1e-6);
                    EXPECT_GT(o.bound, 0);
                    EXPECT_EQ(o.pixels, std::int64_t{2} * size.width * size.height);
                }
        }
    simd::use_instruction_set("");
}

// A line of ten pixels so far away that rounding its ends to double turns what it says of the picture by
// many pixels, though all that it says is a step aside.
TEST(NearFar, LinesWhosePlaceIsRoundedInDoubleHold) {
    const Size size{70, 40};
    constexpr double kMixture = 0.3;
    for (const double distance : {1e6, 1e9, 1e12})
        for (const double b : {0.0, 0.5, 2.0})
            for (const bool another : {false, true}) {
                SCOPED_TRACE(testing::Message() << "distance " << distance << " b " << b
                                                << (another ? " and a line in the picture" : ""));
                const double scale = distance > 1e9 ? 1024 : 1;
                Features features;
                for (const int shape : {0, 1})
                    features.set_frame(shape, {size.width / scale, size.height / scale});
                const auto line = [&](double x, double y, double dx, double dy) {
                    return Line{{x / scale, y / scale}, {(x + dx) / scale, (y + dy) / scale}};
                };
                const double x = 0.9 * distance, y = 0.3 * distance;
                features.add_line({line(x, y, 8, 6), line(x + 5, y + 3, 8, 6)});
                features.add_line({line(-y, x, 9, 5), line(4 - y, x + 1, 9, 5)});
                if (another) features.add_line({line(10, 10, 30, 9), line(13, 11, 30, 8)});
                const LineWeights w{1, b, 0.5};
                const FeatureMap map(features, {size, size}, size, {1 - kMixture, kMixture}, w);
                const auto truth =
                    truth_of(Oracle(features, size.width, size.height, kMixture, w, scale), size);
                for (const double tol : {1.0, 0.1, 1e-3, 1e-5}) {
                    const Outcome o = against(truth, map, tol);
                    EXPECT_LE(o.over, 0) << "error " << o.error << " bound " << o.bound << " tol " << tol;
                }
            }
}

TEST(NearFar, OneShapeAlone) {
    const auto features = families::Maker(150, 9).make("face", 32);
    const FeatureMap map = map_of(*features, {150, 150}, {1, 2, 0.5});
    const NearFar field(map, {0.05, {1}});
    double worst = 0;
    each_feature_block(field, [&](int k, const Block& block, const BlockPoints& points) {
        EXPECT_EQ(k, 1);
        const Point<double> truth = map(block.box.x0 + 0.5, block.box.y0 + 0.5, 1);
        worst = std::max(worst, std::hypot(block.base_x + double(points.x[0]) - truth.x,
                                           block.base_y + double(points.y[0]) - truth.y));
    });
    EXPECT_LE(worst, 0.05);
}

TEST(NearFar, ExactLayersAreTheSameInWhicheverOrderTheyAreAskedFor) {
    const auto features = families::Maker(150, 9).make("face", 32);
    const FeatureMap map = map_of(*features, {150, 150}, {1, 2, 0.5});
    const NearFar forwards(map, {0, {0, 1}}), backwards(map, {0, {0, 1}});
    const auto at_middle = [](const NearFar& field, const Block& block) {
        PointsInDouble points;
        points.read(field, block, 3, 9);
        return points.at(5, 2);
    };
    for (std::int64_t r = 0; r < forwards.regions(); ++r) {
        const SharedBlocks blocks = forwards.blocks(r), others = backwards.blocks(r);
        for (std::size_t i = 0; i < blocks.size(); i += 2) {
            Point<double> to[2], back[2];
            // The second one twice: what waited for it is gone then.
            for (const std::size_t k : {0, 1, 1}) to[k] = at_middle(forwards, blocks[i + k]);
            for (const std::size_t k : {1, 0, 0}) back[k] = at_middle(backwards, others[i + k]);
            for (const std::size_t k : {0, 1}) {
                const Point<double> truth = map(blocks[i].box.x0 + 5.5, blocks[i].box.y0 + 5.5, int(k));
                EXPECT_EQ(to[k].x, truth.x);
                EXPECT_EQ(to[k].y, truth.y);
                EXPECT_EQ(back[k].x, truth.x);
                EXPECT_EQ(back[k].y, truth.y);
            }
        }
    }
}

TEST(NearFar, LinesAlongTheCurveMakeTheSameMap) {
    const auto features = families::Maker(150, 10).make("crossing", 40);
    const FeatureMap map = map_of(*features, {150, 150}, {1, 2, 0.5}), sorted = map.along_curve();
    ASSERT_EQ(sorted.size(), map.size());
    for (int y = 0; y < 150; y += 7)
        for (int x = 0; x < 150; x += 7)
            for (int shape = 0; shape < 2; ++shape) {
                const Point<long double> p = map(x + 0.5L, y + 0.5L, shape),
                                         q = sorted(x + 0.5L, y + 0.5L, shape);
                EXPECT_NEAR(double(p.x), double(q.x), 1e-12);
                EXPECT_NEAR(double(p.y), double(q.y), 1e-12);
            }
}

TEST(NearFar, ARowAloneIsThatOfBothShapesTogether) {
    const auto features = families::Maker(150, 9).make("face", 32);
    const FeatureMap map = map_of(*features, {150, 150}, {1, 2, 0.5});
    const NearFar field(map, {0.02, {0, 1}});
    int compared = 0;
    each_feature_block(field, [&](int, const Block& block, const BlockPoints& points) {
        if (!points.x) return;
        // Every third pixel on, so that rows begin anywhere.
        const int row = block.box.height() / 2, begin = block.box.width() / 3, end = block.box.width();
        float x[simd::kRowRoom], y[simd::kRowRoom];
        field.computed_row(block, row, begin, end, x, y);
        for (int i = begin; i < end; ++i, ++compared) {
            ASSERT_EQ(x[i - begin], points.x[row * points.row_stride + i]);
            ASSERT_EQ(y[i - begin], points.y[row * points.row_stride + i]);
        }
    });
    EXPECT_GT(compared, 1000);
}

TEST(NearFar, BadTolerancesAreNamed) {
    const auto features = families::Maker(100, 1).make("short", 2);
    const FeatureMap map = map_of(*features, {100, 100}, {});
    EXPECT_THROW(NearFar(map, {-1, {0, 1}}), Error);
    EXPECT_THROW(NearFar(map, {NAN, {0, 1}}), Error);
}

}  // namespace
}  // namespace anamorph::test_near_far
