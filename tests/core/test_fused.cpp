// SPDX-License-Identifier: Apache-2.0
// a b + c of floats, rounded once on every instruction set, against the C library's fma.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "test_fused.cpp"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

#include "anamorph/number/fused-inl.h"
#include "anamorph/number/portable.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::test::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// out[i] = a[i] b[i] + c[i], in vectors of as many lanes as `kMost` and the instruction set allow.
template <int kMost>
void FuseIn(const float* a, const float* b, const float* c, std::size_t count, float* out) {
    const hn::CappedTag<float, kMost> d;
    for (std::size_t i = 0; i < count; i += hn::MaxLanes(d))
        hn::StoreU(simd::HWY_NAMESPACE::Fused(hn::LoadU(d, a + i), hn::LoadU(d, b + i), hn::LoadU(d, c + i)),
                   d, out + i);
}

void FuseAll(int lanes, const float* a, const float* b, const float* c, std::size_t count, float* out) {
    lanes == 1   ? FuseIn<1>(a, b, c, count, out)
    : lanes == 2 ? FuseIn<2>(a, b, c, count, out)
    : lanes == 4 ? FuseIn<4>(a, b, c, count, out)
                 : FuseIn<16>(a, b, c, count, out);
}

}  // namespace anamorph::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::test {
HWY_EXPORT(FuseAll);

namespace {

struct Numbers {
    std::vector<float> a, b, c;

    void add(float x, float y, float z) {
        a.push_back(x);
        b.push_back(y);
        c.push_back(z);
    }
    /// Up to a multiple of the longest vector.
    void fill() {
        while (a.size() % 16 != 0) add(1, 1, 1);
    }
};

/// Where the sum is next to the middle of two floats, above and below, of all sizes down to those that are denormal.
void add_near_ties(Numbers& n, std::mt19937& random) {
    for (int e = -148; e <= 126; ++e)
        for (int k = 0; k < 40; ++k) {
            // c has a last bit of weight u; the product is u / 2 and a little that a double does not hold beside c.
            const float c = std::ldexp(static_cast<float>(random() % 0x800000 + 0x800000), e - 23);
            const int unit = std::max(e - 23, -149);
            const int half = unit - 1;
            const float x = std::ldexp(1 + std::ldexp(static_cast<float>(random() % 4), -23), half / 2);
            const float y =
                std::ldexp(1 - std::ldexp(static_cast<float>(random() % 4), -24), half - half / 2);
            for (const float sign : {1.0f, -1.0f}) {
                n.add(x, y, sign * c);
                n.add(-x, y, sign * c);
            }
        }
}

void add_any_bits(Numbers& n, std::mt19937& random) {
    const auto any = [&] { return bit_cast<float>(static_cast<std::uint32_t>(random())); };
    for (int i = 0; i < 200000; ++i) n.add(any(), any(), any());
    // As large as each other, so that much cancels.
    for (int i = 0; i < 200000; ++i) {
        const float a = any(), b = any();
        const float product = a * b;
        n.add(a, b,
              -bit_cast<float>(bit_cast<std::uint32_t>(product) + static_cast<std::uint32_t>(random() % 5)));
    }
}

void add_weights(Numbers& n, std::mt19937& random) {
    std::uniform_real_distribution<float> part(0, 1);
    for (int i = 0; i < 100000; ++i)
        n.add(part(random), static_cast<float>(static_cast<int>(random() % 511) - 255),
              static_cast<float>(random() % 256));
}

TEST(Fused, RoundsOnce) {
    constexpr unsigned kSeed = 20261129;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    Numbers n;
    const float special[] = {0.0f,  -0.0f,  1.0f,      -1.0f,      0x1p-149f, -0x1p-149f,      0x1p-126f,
                             3e38f, -3e38f, HUGE_VALF, -HUGE_VALF, NAN,       0x1.fffffep127f, 0x1.000002p0f};
    for (const float a : special)
        for (const float b : special)
            for (const float c : special) n.add(a, b, c);
    add_near_ties(n, random);
    add_any_bits(n, random);
    add_weights(n, random);
    n.fill();
    const std::size_t count = n.a.size();
    std::vector<float> exact(count), out(count);
    std::size_t once_or_twice = 0;
    for (std::size_t i = 0; i < count; ++i) {
        exact[i] = std::fma(n.a[i], n.b[i], n.c[i]);
        const double twice = double{n.a[i]} * n.b[i] + n.c[i];
        once_or_twice += static_cast<float>(twice) != exact[i] && !std::isnan(exact[i]);
    }
    EXPECT_GT(once_or_twice, 1000u);  // rounded to double and then to float
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
        for (const int lanes : {1, 2, 4, 16}) {
            SCOPED_TRACE(testing::Message() << hwy::TargetName(target) << ", " << lanes << " lanes");
            hwy::SetSupportedTargetsForTest(target);
            HWY_DYNAMIC_DISPATCH(FuseAll)(lanes, n.a.data(), n.b.data(), n.c.data(), count, out.data());
            std::size_t wrong = 0, at = 0;
            for (std::size_t i = 0; i < count; ++i)
                if (std::isnan(exact[i])
                        ? !std::isnan(out[i])
                        : bit_cast<std::uint32_t>(out[i]) != bit_cast<std::uint32_t>(exact[i])) {
                    at = i;
                    ++wrong;
                }
            EXPECT_EQ(wrong, 0u) << n.a[at] << " * " << n.b[at] << " + " << n.c[at] << " is " << exact[at]
                                 << ", not " << out[at];
        }
    hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace anamorph::test
#endif
