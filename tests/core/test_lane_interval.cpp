// SPDX-License-Identifier: Apache-2.0
// Vectors of intervals, on every instruction set that this machine has: they hold the results of their members in long
// double, and are what single intervals are.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "anamorph/number/interval.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "test_lane_interval.cpp"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::test::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"
// behind lanes.h
#include "anamorph/number/lane_interval.h"

constexpr double kScale = 0x1.8p-3;

/// Results of function `which` of (a[i], b[i]), in the order of kFunctions.
void EvaluateIntervals(int which, const Interval* a, const Interval* b, std::size_t count, Interval* out) {
    using I = LaneInterval<hn::CappedTag<double, 4>>;
    for (std::size_t i = 0; i + I::kCount <= count; i += I::kCount) {
        I::Ends x, y;
        for (int k = 0; k < I::kCount; ++k) {
            x.set(k, a[i + static_cast<std::size_t>(k)]);
            y.set(k, b[i + static_cast<std::size_t>(k)]);
        }
        const I u = I::of(x), v = I::of(y);
        I s, r;
        switch (which) {
            case 0:
                r = u + v;
                break;
            case 1:
                r = u - v;
                break;
            case 2:
                r = u * v;
                break;
            case 3:
                r = u / v;
                break;
            case 4:
                r = square(u);
                break;
            case 5:
                r = sqrt(u);
                break;
            case 6:
                r = atan2(u, v);
                break;
            case 7:
                sin_cos(u, r, s);
                break;
            case 8:
                sin_cos(u, s, r);
                break;
            case 9:
                r = exp(u);
                break;
            case 10:
                r = log(u);
                break;
            case 11:
                r = asinh(u);
                break;
            case 12:
                scaled_sinh(u, r);
                break;
            case 13:
                r = -u;
                break;
            default:
                r = u * (which == 14 ? kScale : -kScale);
        }
        const I::Ends e = r.ends();
        for (int k = 0; k < I::kCount; ++k) out[i + static_cast<std::size_t>(k)] = e[k];
    }
}

}  // namespace anamorph::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::test {
namespace {

HWY_EXPORT(EvaluateIntervals);

struct Function {
    const char* name;
    std::function<long double(long double, long double)> of_members;
    std::function<Interval(const Interval&, const Interval&)> of_one;
    bool same_bits = true;
};
const Function kFunctions[] = {
    {"+", [](auto a, auto b) { return a + b; }, [](auto& a, auto& b) { return a + b; }},
    {"-", [](auto a, auto b) { return a - b; }, [](auto& a, auto& b) { return a - b; }},
    {"*", [](auto a, auto b) { return a * b; }, [](auto& a, auto& b) { return a * b; }},
    {"/", [](auto a, auto b) { return a / b; }, [](auto& a, auto& b) { return a / b; }},
    {"square", [](auto a, auto) { return a * a; }, [](auto& a, auto&) { return square(a); }},
    {"sqrt", [](auto a, auto) { return std::sqrt(a); }, [](auto& a, auto&) { return sqrt(a); }},
    {"atan2", [](auto a, auto b) { return std::atan2(a, b); }, [](auto& a, auto& b) { return atan2(a, b); },
     false},
    {"sin", [](auto a, auto) { return std::sin(a); }, [](auto& a, auto&) { return sin(a); }},
    {"cos", [](auto a, auto) { return std::cos(a); }, [](auto& a, auto&) { return cos(a); }},
    {"exp", [](auto a, auto) { return std::exp(a); }, [](auto& a, auto&) { return exp(a); }},
    {"log", [](auto a, auto) { return std::log(a); }, [](auto& a, auto&) { return log(a); }},
    {"asinh", [](auto a, auto) { return std::asinh(a); }, [](auto& a, auto&) { return asinh(a); }},
    {"tanh", [](auto a, auto) { return std::tanh(a); }, [](auto& a, auto&) { return tanh(a); }},
    {"negative", [](auto a, auto) { return -a; }, [](auto& a, auto&) { return -a; }},
    {"scaled", [](auto a, auto) { return a * 0.1875L; }, [](auto& a, auto&) { return a * 0.1875; }},
    {"scaled down", [](auto a, auto) { return a * -0.1875L; }, [](auto& a, auto&) { return a * -0.1875; }}};

constexpr std::size_t kCases = 1 << 13;

class Random {
  public:
    /// Of any magnitude, moderate more often, or an edge case.
    double number() {
        constexpr double kEdges[] = {0,
                                     -0.0,
                                     1,
                                     -1,
                                     std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::quiet_NaN(),
                                     std::numeric_limits<double>::max(),
                                     std::numeric_limits<double>::min(),
                                     -std::numeric_limits<double>::min(),
                                     std::numeric_limits<double>::denorm_min()};
        if (below(12) == 0) return kEdges[below(std::size(kEdges))];
        const double exponent = below(4) == 0 ? between(-1070, 1020) : between(-8, 8);
        return std::ldexp(between(-1, 1), static_cast<int>(exponent));
    }
    Interval interval() {
        const double a = number();
        if (below(4) == 0) return a;
        const double b =
            below(3) == 0 ? number() : a + std::fabs(a) * std::ldexp(between(0, 1), -int(below(40)));
        return {std::min(a, b), std::max(a, b)};
    }
    /// A member.
    double of(const Interval& a) {
        const double k = below(3) == 0 ? static_cast<double>(below(2)) : between(0, 1);
        return std::clamp(a.lo + (a.hi - a.lo) * k, a.lo, a.hi);
    }
    std::size_t below(std::size_t count) { return m_engine() % count; }
    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(m_engine);
    }

  private:
    std::mt19937_64 m_engine{2003};
};

bool same(double a, double b) {
    return a == b || (std::isnan(a) && std::isnan(b));
}

void examine(int which, const std::vector<Interval>& a, const std::vector<Interval>& b,
             const std::vector<Interval>& got) {
    const Function& f = kFunctions[which];
    Random random;
    int unlike = 0, lost = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Interval one = f.of_one(a[i], b[i]), &r = got[i];
        unlike += f.same_bits && !(same(one.lo, r.lo) && same(one.hi, r.hi));
        if (!std::isfinite(a[i].lo) || !std::isfinite(a[i].hi) || !std::isfinite(b[i].lo) ||
            !std::isfinite(b[i].hi)) {
            // No bound of what is not known.
            lost += !f.same_bits && std::isfinite(r.lo) && std::isfinite(r.hi) &&
                    !(r.lo <= -3.14 && r.hi >= 3.14) && !(same(one.lo, r.lo) && same(one.hi, r.hi));
            continue;
        }
        for (int k = 0; k < 4; ++k) {
            const long double exact = f.of_members(random.of(a[i]), random.of(b[i]));
            // NaN ends bound nothing.
            lost += std::isfinite(exact) && (exact < r.lo || exact > r.hi);
        }
    }
    EXPECT_EQ(unlike, 0);
    EXPECT_EQ(lost, 0);
}

TEST(NumbersLaneInterval, HoldsItsMembersOnEveryInstructionSet) {
    Random random;
    std::vector<Interval> a(kCases), b(kCases), got(kCases);
    for (Interval& x : a) x = random.interval();
    for (Interval& x : b) x = random.interval();
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        for (int which = 0; which < static_cast<int>(std::size(kFunctions)); ++which) {
            SCOPED_TRACE(::testing::Message() << kFunctions[which].name << " on " << hwy::TargetName(target));
            HWY_DYNAMIC_DISPATCH(EvaluateIntervals)(which, a.data(), b.data(), kCases, got.data());
            examine(which, a, b, got);
        }
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace anamorph::test
#endif
