// SPDX-License-Identifier: Apache-2.0
// The roots of a quadric along an ellipse, all of them and no others: against sign changes in long double.
#include "anamorph/figure/outline/outline_roots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace anamorph::test_outline_roots {
using namespace figure;
namespace {

using Real = long double;
constexpr Real kTurn = 2 * std::numbers::pi_v<Real>;

Real value_of(const WaveSquares& f, Real t) {
    const Real c = std::cos(t), s = std::sin(t);
    const auto square = [&](const Wave& q) {
        const Real at = q.k + q.c * c + q.s * s;
        return at * at;
    };
    return square(f.x) + square(f.y) + square(f.z) - square(f.w);
}

/// Where sign f is least between two angles: golden section.
Real least_of(const WaveSquares& f, Real low, Real high, int sign) {
    constexpr Real kGolden = 0.618033988749894848L;
    for (int i = 0; i < 50; ++i) {
        const Real left = high - kGolden * (high - low), right = low + kGolden * (high - low);
        if (sign * value_of(f, left) < sign * value_of(f, right))
            high = right;
        else
            low = left;
    }
    return 0.5L * (low + high);
}

/// Where f changes its sign between two of many samples. Doubtful: in some place f comes to zero only within the noise, and so may have
/// two roots or none.
struct SampledRoots {
    std::vector<Real> angles;
    bool doubtful = false;

    SampledRoots(const WaveSquares& f, Real noise) {
        constexpr int kSamples = 720;
        constexpr Real kStep = kTurn / kSamples, kBend = kStep * kStep / 8;
        Real size = 0;
        for (const Wave& q : {f.x, f.y, f.z, f.w}) {
            const Real reach = std::fabs(q.k) + std::fabs(q.c) + std::fabs(q.s);
            size += reach * reach;
        }
        // |f''| is at most 4 of the sum of squares; so is what f differs from its chord, at most.
        const Real unseen = 4 * size * kBend + noise;
        Real before = value_of(f, 0);
        for (int k = 1; k <= kSamples; ++k) {
            Real low = (k - 1) * kStep, high = k * kStep;
            const Real after = value_of(f, high);
            if ((before < 0) != (after < 0)) {
                for (int i = 0; i < 64; ++i) {
                    const Real middle = 0.5L * (low + high);
                    ((value_of(f, middle) < 0) == (before < 0) ? low : high) = middle;
                }
                angles.push_back(low);
            } else if (std::min(std::fabs(before), std::fabs(after)) <= unseen) {
                const int sign = before < 0 ? -1 : 1;
                const Real least = least_of(f, (k - 1) * kStep, k * kStep, sign);
                if (sign * value_of(f, least) <= noise) doubtful = true;
            }
            before = after;
        }
        // Two roots between which f stays within the noise.
        for (std::size_t k = 0; k < angles.size(); ++k) {
            const bool last = k + 1 == angles.size();
            const Real from = angles[k], to = last ? angles[0] + kTurn : angles[k + 1];
            const Real middle = 0.5L * (from + to);
            if (std::fabs(value_of(f, middle)) <= noise) doubtful = true;
        }
    }
};

class RandomWaves {
  public:
    explicit RandomWaves(std::uint64_t seed) : m_random(seed) {}

    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(m_random);
    }
    Wave wave(double size) { return {size * between(-1, 1), size * between(-1, 1), size * between(-1, 1)}; }
    /// Paths about quadrics as outlines have them: cylinders and cones, ellipsoids; wide, narrow, flat; of one harmonic alone.
    WaveSquares squares(int kind) {
        WaveSquares f;
        const double wide = std::pow(10, between(-1, 1)),
                     narrow = wide * std::pow(10, kind % 3 == 0 ? between(-5, 0) : 0);
        f.x = wave(wide);
        f.y = wave(narrow);
        f.w.k = 1;
        if (kind % 2) f.z = wave(wide);
        if (kind % 5 == 0) f.w = {1 + between(-.3, .3), between(-.3, .3), between(-.3, .3)};
        if (kind % 7 == 0) {  // a circle's limb before a circle, which may lie about its middle
            f.y.c = -f.x.s;
            f.y.s = f.x.c;
            if (kind % 14 == 0) f.x.k = f.y.k = f.z.k = 0;
        }
        if (kind % 11 == 0) f.x.s = f.y.c = f.x.k = 0;  // alike on both sides of an axis
        f.noise = 1e-13 * wide * wide;
        return f;
    }

  private:
    std::mt19937_64 m_random;
};

/// Makes the least or the greatest value of f, near where it is asked for, that much: a path that comes close to a surface.
void bring_close(WaveSquares& f, Real value) {
    Real best = 0;
    for (int k = 0; k < 180; ++k)
        if (value_of(f, k * kTurn / 180) < value_of(f, best)) best = k * kTurn / 180;
    best = least_of(f, best - kTurn / 180, best + kTurn / 180, 1);
    const Real squares = value_of(f, best) + static_cast<Real>(f.w.k) * f.w.k;
    if (f.w.c == 0 && f.w.s == 0 && squares > value) f.w.k = static_cast<double>(std::sqrt(squares - value));
}

void expect_all(const WaveSquares& f, int n, std::vector<int>& counts) {
    const SampledRoots truth(f, f.noise);
    if (truth.doubtful) return;
    ++counts[truth.angles.size()];
    Roots found;
    add_roots(f, found);
    ASSERT_EQ(found.count, static_cast<int>(truth.angles.size())) << n;
    for (int k = 0; k < found.count; ++k) {
        ASSERT_GE(found.angle[k], 0) << n;
        ASSERT_LT(found.angle[k], 2 * std::numbers::pi) << n;
        Real off = kTurn;
        for (const Real angle : truth.angles)
            off = std::min(off, std::fabs(std::remainder(found.angle[k] - angle, kTurn)));
        // What the noise is of the slope; next to a tangent its root.
        const Real slope =
            std::fabs(value_of(f, found.angle[k] + 1e-7L) - value_of(f, found.angle[k] - 1e-7L)) / 2e-7L;
        ASSERT_LE(off, 1e-14L + 2 * f.noise / slope) << n;
    }
}

TEST(OutlineRoots, AreAllThatChangeTheSign) {
    constexpr std::uint64_t kSeed = 4040;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    RandomWaves random(kSeed);
    std::vector<int> counts(5);
    for (int n = 0; n < 3000; ++n) {
        expect_all(random.squares(n), n, counts);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(counts[0], 300);
    EXPECT_GT(counts[2], 300);
    EXPECT_GT(counts[4], 100);
}

// Two roots that are nearly one, and none that is nearly two.
TEST(OutlineRoots, NearTangentsAreNeitherMissedNorDoubled) {
    constexpr std::uint64_t kSeed = 4041;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    RandomWaves random(kSeed);
    std::vector<int> counts(5);
    for (int n = 0; n < 1000; ++n) {
        WaveSquares f = random.squares(n);
        const double close = std::pow(10, random.between(-12, -1));
        bring_close(f, n % 2 ? close : -close);
        expect_all(f, n, counts);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(counts[0], 150);
    EXPECT_GT(counts[2], 150);
}

}  // namespace
}  // namespace anamorph::test_outline_roots
