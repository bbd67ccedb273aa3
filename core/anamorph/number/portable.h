// SPDX-License-Identifier: Apache-2.0
// What the standard has of numbers as bits and as text, for standard libraries that lack some of it yet: libc++ has bit_cast from version 14
// on, writes floating numbers from 14 on and reads them from 20 on. Called without std::, these are the standard's own where there are such.
#pragma once

#include <bit>
#include <charconv>
#include <version>

namespace anamorph {

/// What stands in for the standard's own, by the C library, in the C locale. Compiled everywhere, so that they can be compared.
namespace portable {
/// Reads a number as std::from_chars does, with formats general and fixed.
std::from_chars_result read_number(const char* first, const char* last, double& value,
                                   std::chars_format format = std::chars_format::general);
/// Writes the fewest digits that read back as the same number, as std::to_chars does.
std::to_chars_result write_number(char* first, char* last, double value);
/// Writes a float so.
std::to_chars_result write_number(char* first, char* last, float value);
/// Writes a number with so many digits behind the point.
std::to_chars_result write_fixed(char* first, char* last, double value, int digits);
}  // namespace portable

#ifdef __cpp_lib_bit_cast
using std::bit_cast;
#else
template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
    return __builtin_bit_cast(To, from);
}
#endif

using std::from_chars;
using std::to_chars;
#ifndef __cpp_lib_to_chars
inline std::from_chars_result from_chars(const char* first, const char* last, double& value,
                                         std::chars_format format = std::chars_format::general) {
    return portable::read_number(first, last, value, format);
}
inline std::to_chars_result to_chars(char* first, char* last, double value) {
    return portable::write_number(first, last, value);
}
inline std::to_chars_result to_chars(char* first, char* last, float value) {
    return portable::write_number(first, last, value);
}
inline std::to_chars_result to_chars(char* first, char* last, double value, std::chars_format, int digits) {
    return portable::write_fixed(first, last, value, digits);
}
#endif

}  // namespace anamorph
