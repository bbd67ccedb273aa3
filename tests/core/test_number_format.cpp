// SPDX-License-Identifier: Apache-2.0
// Number formats of hardware against lists of all their values, made another way.
#include "anamorph/machine/number_format.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/number/half.h"

namespace anamorph::test_number_format {
using namespace machine;
namespace {

/// A value, and whether its last bit is 0.
struct Stored {
    long double value;
    bool even;
};

std::vector<Stored> fixed_values(int bits, int fraction) {
    std::vector<Stored> all;
    for (long k = -(1L << (bits - 1)); k < 1L << (bits - 1); ++k)
        all.push_back({static_cast<long double>(k) / static_cast<long double>(1L << fraction), k % 2 == 0});
    return all;
}
std::vector<Stored> normalised_values(int bits) {
    std::vector<Stored> all;
    const long most = (1L << bits) - 1;
    for (long k = 0; k <= most; ++k) all.push_back({k / static_cast<long double>(most), k % 2 == 0});
    return all;
}
std::vector<Stored> half_values() {
    std::vector<Stored> all;
    for (int bits = 0xfbff; bits > 0x8000; --bits)
        all.push_back({float_from_half(static_cast<std::uint16_t>(bits)), bits % 2 == 0});
    for (int bits = 0; bits <= 0x7bff; ++bits)
        all.push_back({float_from_half(static_cast<std::uint16_t>(bits)), bits % 2 == 0});
    return all;
}
/// Of the binade of 2^exponent a few values, each followed by its neighbour.
std::vector<Stored> some_float24_values(int exponent) {
    std::vector<Stored> all;
    for (long k = 0x10000; k < 0x1ffff; k += 0xfff)
        for (const long i : {k, k + 1})
            all.push_back({std::ldexp(static_cast<long double>(i), exponent - 16), i % 2 == 0});
    return all;
}

/// Values round to themselves; what lies between two neighbours to the nearer, in the middle to the even one.
void expect_nearest(const NumberFormat& format, const std::vector<Stored>& all, std::size_t step = 1) {
    // k / (2^n - 1) and middles of two of them are no doubles, and known to a unit of rounding here.
    const bool is_double = format.kind != NumberFormat::Kind::normalised;
    const double near = is_double ? 0 : 0x1p-53;
    for (const Stored& s : all)
        ASSERT_NEAR(nearest(format, double(s.value)), double(s.value), near) << double(s.value);
    for (std::size_t i = 0; i + 1 < all.size(); i += step) {
        const long double below = all[i].value, above = all[i + 1].value, middle = (below + above) / 2;
        const double hair = double((above - below) * 1e-5L);
        bool beyond = false;
        ASSERT_NEAR(nearest(format, double(middle) - hair, beyond), double(below), near) << double(middle);
        ASSERT_NEAR(nearest(format, double(middle) + hair, beyond), double(above), near) << double(middle);
        ASSERT_FALSE(beyond);
        if (is_double) {
            const double tie = double(middle);
            ASSERT_EQ(nearest(format, tie), double(all[i].even ? below : above)) << tie;
            ASSERT_EQ(nearest(format, std::nextafter(tie, -HUGE_VAL)), double(below)) << tie;
            ASSERT_EQ(nearest(format, std::nextafter(tie, HUGE_VAL)), double(above)) << tie;
        }
    }
}

#ifdef __SIZEOF_INT128__  // processors of 32 bits have none
/// k of the nearest k / most to a value that is not negative, in whole numbers: value is m 2^-e.
long exact_normalised(double value, long most) {
    int exponent = 0;
    const auto m = static_cast<__int128>(std::ldexp(std::frexp(value, &exponent), 53));
    const int e = 53 - exponent;
    // k + 1/2 is one of (2 k + 1) 2^e.
    const __int128 twice = 2 * m * most, unit = static_cast<__int128>(1) << e;
    const auto below = static_cast<long>(twice / unit);  // floor(2 value most)
    const bool tie = twice % unit == 0 && below % 2 == 1;
    const long k = (below + 1) / 2;
    return tie && k % 2 == 1 ? k - 1 : k;
}

#endif

TEST(NumberFormat, RoundsToTheNearestOfAllItsValues) {
    expect_nearest(kSigned8, fixed_values(8, 7));
    expect_nearest(kSigned16, fixed_values(16, 15));
    expect_nearest(kFixed16, fixed_values(16, 12));
    expect_nearest(kUnsigned16, normalised_values(16));
    expect_nearest(kFloat16, half_values());
    for (int exponent = -62; exponent <= 63; ++exponent)
        expect_nearest(kFloat24, some_float24_values(exponent), 2);
}

#ifdef __SIZEOF_INT128__
/// Texels' middles are no doubles: the doubles beside them round to where they lie.
TEST(NumberFormat, NormalisedRoundAsWholeNumbersSayBesideEveryTie) {
    for (const int bits : {1, 2, 5, 8, 10, 12, 16}) {
        const NumberFormat format{NumberFormat::Kind::normalised, bits};
        const long most = (1L << bits) - 1;
        for (long k = 0; k <= most; ++k) {
            const double tie = (static_cast<double>(k) + 0.5) / static_cast<double>(most);
            double value = std::nextafter(std::nextafter(tie, 0), 0);
            for (int i = 0; i < 5; ++i, value = std::nextafter(value, 2)) {
                bool beyond = false;
                const long wanted = exact_normalised(value, most);
                const double got = nearest(format, value, beyond);
                ASSERT_EQ(got, static_cast<double>(std::min(wanted, most)) / static_cast<double>(most))
                    << bits << " bits, beside " << k << " and a half: " << value;
                ASSERT_EQ(beyond, wanted > most) << value;
            }
        }
        // -1/2 of a step is a tie, too: it is 0, and what lies beyond it is no texel.
        const double half = -0.5 / static_cast<double>(most);
        for (const double value : {std::nextafter(half, -1), half, std::nextafter(half, 0)}) {
            bool beyond = false;
            EXPECT_EQ(nearest(format, value, beyond), 0);
            EXPECT_EQ(beyond, std::fma(value, static_cast<double>(most), 0.5) < 0) << bits << " " << value;
        }
    }
}
#endif

TEST(NumberFormat, TwosComplementHasOneZero) {
    for (const NumberFormat& f : {kSigned8, kSigned16, kFixed16, kFixed32}) {
        EXPECT_FALSE(std::signbit(nearest(f, -0.0))) << name_of(f);
        EXPECT_FALSE(std::signbit(nearest(f, -1e-12))) << name_of(f);
        EXPECT_FALSE(std::signbit(nearest(f, -1e-320))) << name_of(f);
    }
    EXPECT_EQ((FormatNumber<kFixed16>(1.0) / FormatNumber<kFixed16>(-0.00001)).value, largest(kFixed16));
}

/// Fixed point of 32 bits, 16 of them behind the point, in whole numbers.
TEST(NumberFormat, Fixed32IsRoundedOnceAsWholeNumbersAre) {
    using Fixed32 = FormatNumber<kFixed32>;
    constexpr unsigned kSeed = 19;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937_64 random(kSeed);
    // Of n / d, which is not negative, ties to even.
    const auto rounded = [](std::int64_t n, std::int64_t d) {
        const std::int64_t twice = 2 * (n % d);
        std::int64_t k = n / d;
        if (twice > d || (twice == d && k % 2 == 1)) ++k;
        return k;
    };
    for (int i = 0; i < 20000; ++i) {
        // Of any size.
        const auto a = static_cast<std::int64_t>(random() % (1u << 31) >> random() % 31),
                   b = static_cast<std::int64_t>(random() % (1u << 31) >> random() % 31) + 1;
        const Fixed32 x(std::ldexp(double(a), -16)), y(std::ldexp(double(b), -16));
        const auto expect = [&](const Fixed32& got, std::int64_t wanted) {
            ASSERT_EQ(got.beyond, wanted > 0x7fffffff) << a << " " << b;
            ASSERT_EQ(std::ldexp(got.value, 16), double(std::min<std::int64_t>(wanted, 0x7fffffff)))
                << a << " " << b;
        };
        expect(x * y, rounded(a * b, 1 << 16));
        expect(x / y, rounded(a << 16, b));
        // The root's square is nearest: k - 1/2 and k + 1/2 lie beside it.
        const auto k = static_cast<std::int64_t>(std::ldexp(sqrt(x).value, 16)), four = a << 18;
        ASSERT_LE((2 * k - 1) * (k > 0 ? 2 * k - 1 : 0), four) << a;
        ASSERT_GE((2 * k + 1) * (2 * k + 1), four) << a;
    }
}

TEST(NumberFormat, FloatIsTheProcessorsFloat) {
    constexpr unsigned kSeed = 7;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937_64 random(kSeed);
    for (int i = 0; i < 100000; ++i) {
        const auto bits = random();
        double value = 0;
        static_assert(sizeof value == sizeof bits);
        std::memcpy(&value, &bits, sizeof value);
        // Half of them near what a float holds.
        if (i % 2 == 0) value = std::ldexp(1 + double(bits % 100003) / 100003, int(bits % 300) - 155);
        if (std::isnan(value)) continue;
        ASSERT_EQ(nearest(kFloat32, value), static_cast<double>(static_cast<float>(value))) << value;
    }
}

TEST(NumberFormat, HalfIsTheLibrarysHalf) {
    for (std::uint32_t bits = 0; bits < 0x7f800000u; bits += 997) {
        float value = 0;
        std::memcpy(&value, &bits, sizeof value);
        ASSERT_EQ(nearest(kFloat16, value), double(float_from_half(half_from_float(value)))) << value;
    }
}

TEST(NumberFormat, WhatLiesBeyondSaturatesOrWrapsAndIsSaid) {
    const auto expect = [](const NumberFormat& format, double value, double kept, bool is_beyond) {
        bool beyond = false;
        const double got = nearest(format, value, beyond);
        EXPECT_EQ(got, kept) << name_of(format) << " " << value;
        EXPECT_EQ(beyond, is_beyond) << name_of(format) << " " << value;
    };
    constexpr double kInf = HUGE_VAL;
    expect(kSigned8, 0.999, 127.0 / 128, true);
    expect(kSigned8, -1.001, -1, false);
    expect(kSigned8, -1.1, -1, true);
    expect(kSigned8, NAN, 0, true);
    expect(kFixed16, 1e12, 8 - 1.0 / 4096, true);
    expect(kFixed16, -kInf, -8, true);
    NumberFormat wrapped = kFixed16;
    wrapped.wraps = true;
    expect(wrapped, 8, -8, true);
    expect(wrapped, 9.5, -6.5, true);
    expect(wrapped, -8.25, 7.75, true);
    expect(wrapped, 16 * 1e9 + 3, 3, true);
    expect(wrapped, kInf, 0, true);
    expect(kUnsigned16, 1.5, 1, true);
    expect(kUnsigned16, -1e-9, 0, false);
    expect(kUnsigned16, -0.5, 0, true);
    expect(kFloat24, std::ldexp(1, 64), kInf, true);
    expect(kFloat24, largest(kFloat24), largest(kFloat24), false);
    expect(kFloat24, std::ldexp(0.99, -62), 0, false);
    expect(kFloat24, std::ldexp(0.999999, -62), std::ldexp(1, -62), false);
    EXPECT_TRUE(std::isnan(nearest(kFloat24, NAN)));
    EXPECT_EQ(largest(kFloat16), 65504);
    EXPECT_EQ(largest(kFloat32), double(std::numeric_limits<float>::max()));
}

TEST(NumberFormat, NumbersRememberThatTheyWereBeyond) {
    using Fixed16 = FormatNumber<kFixed16>;
    const Fixed16 large = Fixed16(4.0) * 3.0;
    EXPECT_EQ(large.value, 8 - 1.0 / 4096);
    EXPECT_TRUE(large.beyond);
    EXPECT_TRUE((large * 0.0 + 1.0).beyond);
    EXPECT_FALSE((Fixed16(4.0) - 3.0).beyond);
    EXPECT_TRUE((Fixed16(1.0) / 0.0).beyond);
    EXPECT_TRUE(sqrt(Fixed16(-1.0)).beyond);
}

TEST(NumberFormat, NamesReadBack) {
    for (const NumberFormat& f :
         {kFloat16, kFloat24, kFloat32, kFixed16, kFixed32, kSigned8, kSigned16, kUnsigned16})
        EXPECT_EQ(number_format_from_name(name_of(f), "format"), f);
    try {
        number_format_from_name("float64", "texel");
        FAIL();
    } catch (const Error& e) {
        EXPECT_STREQ(e.what(),
                     "texel=float64: must be one of float16, float24, float32, fixed16, fixed32, V8U8, "
                     "V16U16, G16R16");
    }
}

}  // namespace
}  // namespace anamorph::test_number_format
