// SPDX-License-Identifier: Apache-2.0
// What stands in where a standard library lacks texts of floating numbers does what the standard's own does.
#include <gtest/gtest.h>

#include <bit>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include "anamorph/number/portable.h"

namespace anamorph::test_portable {
namespace {

#ifdef __cpp_lib_to_chars

/// All bits, and what is nearly a whole number or a short one.
template <class Number, class Bits>
std::vector<Number> numbers() {
    std::vector<Number> list = {0,
                                -Number{0},
                                1,
                                -1,
                                Number{0.1},
                                Number{1e5},
                                Number{123456},
                                Number{1e22},
                                Number{1e-5},
                                std::numeric_limits<Number>::max(),
                                std::numeric_limits<Number>::min(),
                                std::numeric_limits<Number>::denorm_min(),
                                std::numeric_limits<Number>::infinity(),
                                -std::numeric_limits<Number>::infinity()};
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        const auto value = std::bit_cast<Number>(static_cast<Bits>(random()));
        if (std::isfinite(value)) list.push_back(value);
        list.push_back(static_cast<Number>(static_cast<std::int64_t>(random()) >> (random() % 60)));
        list.push_back(static_cast<Number>(static_cast<int>(random() % 20001) - 10000) / 1000);
    }
    return list;
}

template <class Number>
std::string written(Number value, std::to_chars_result (*write)(char*, char*, Number)) {
    char text[400];
    const auto [end, error] = write(text, text + sizeof text, value);
    EXPECT_EQ(error, std::errc());
    return {text, end};
}
template <class Number>
std::string by_standard(Number value) {
    return written<Number>(value, [](char* a, char* b, Number v) { return std::to_chars(a, b, v); });
}
template <class Number>
std::string portably(Number value) {
    return written<Number>(value, [](char* a, char* b, Number v) { return portable::write_number(a, b, v); });
}

TEST(Portable, WritesTheShortestTexts) {
    for (const double value : numbers<double, std::uint64_t>())
        ASSERT_EQ(portably(value), by_standard(value));
    for (const float value : numbers<float, std::uint32_t>()) ASSERT_EQ(portably(value), by_standard(value));
}

TEST(Portable, WritesDigitsBehindThePoint) {
    for (const double value : numbers<double, std::uint64_t>()) {
        char ours[400], theirs[400];
        char* const end = portable::write_fixed(ours, std::end(ours), value, 2).ptr;
        ASSERT_EQ(
            std::string(ours, end),
            std::string(theirs,
                        std::to_chars(theirs, std::end(theirs), value, std::chars_format::fixed, 2).ptr));
    }
    char small[3];
    EXPECT_EQ(portable::write_fixed(small, std::end(small), 12.5, 2).ec, std::errc::value_too_large);
    EXPECT_EQ(portable::write_number(small, std::end(small), 12.5).ec, std::errc::value_too_large);
}

/// What both read of a text: the number, how far, and what is said.
void expect_same(const std::string& text, std::chars_format format) {
    double ours = 7, theirs = 7;
    const char *const first = text.data(), *const last = first + text.size();
    const auto a = portable::read_number(first, last, ours, format);
    const auto b = std::from_chars(first, last, theirs, format);
    EXPECT_EQ(a.ec, b.ec) << text;
    EXPECT_EQ(a.ptr - first, b.ptr - first) << text;
    EXPECT_TRUE(std::isnan(ours) ? std::isnan(theirs)
                                 : std::bit_cast<std::uint64_t>(ours) == std::bit_cast<std::uint64_t>(theirs))
        << text << ": " << ours << " and " << theirs;
}

TEST(Portable, ReadsAsTheStandardDoes) {
    constexpr auto kGeneral = std::chars_format::general, kFixed = std::chars_format::fixed;
    for (const char* const text : {"",
                                   "-",
                                   "+1",
                                   " 1",
                                   "1 ",
                                   "1.5x",
                                   ".5",
                                   "5.",
                                   ".",
                                   "-.e5",
                                   "1e5",
                                   "1e",
                                   "1e+",
                                   "1e+5",
                                   "1E-5",
                                   "1e5.5",
                                   "0x10",
                                   "1,5",
                                   "1e400",
                                   "-1e400",
                                   "1e-400",
                                   "0e-400",
                                   "0e999999",
                                   "inf",
                                   "-INF",
                                   "infinite",
                                   "infinity",
                                   "nan",
                                   "-nan(a_1)",
                                   "nan(",
                                   "nano",
                                   "--1",
                                   "1e-310",
                                   "4.9e-324",
                                   "2.2250738585072011e-308",
                                   "9007199254740993",
                                   "1.7976931348623159e308",
                                   "in",
                                   "na",
                                   "-i"})
        for (const auto format : {kGeneral, kFixed}) expect_same(text, format);
    for (const double value : numbers<double, std::uint64_t>()) expect_same(by_standard(value), kGeneral);
    // Texts of the characters that numbers have.
    std::mt19937 random(2);
    for (int i = 0; i < 50000; ++i) {
        std::string text;
        for (std::size_t k = random() % 9; k > 0; --k) text += "0123456789.eE+-infa("[random() % 20];
        expect_same(text, random() % 4 ? kGeneral : kFixed);
    }
}

#endif

}  // namespace
}  // namespace anamorph::test_portable
