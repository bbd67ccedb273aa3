// SPDX-License-Identifier: Apache-2.0
// Functions of the C library, which plans are made with: rounded as the GNU C library of the desktop program rounds them. That is correct
// in all but one of a thousand values, and so are these, rounded from long double's 113 bits; musl's own are not in one of ten. The linker
// puts them in place of musl's (--wrap).
#include <algorithm>
#include <cmath>

extern "C" {

double __wrap_sin(double x) {
    return static_cast<double>(std::sin(static_cast<long double>(x)));
}
double __wrap_cos(double x) {
    return static_cast<double>(std::cos(static_cast<long double>(x)));
}
double __wrap_tan(double x) {
    return static_cast<double>(std::tan(static_cast<long double>(x)));
}
double __wrap_asin(double x) {
    return static_cast<double>(std::asin(static_cast<long double>(x)));
}
double __wrap_acos(double x) {
    return static_cast<double>(std::acos(static_cast<long double>(x)));
}
double __wrap_atan(double x) {
    return static_cast<double>(std::atan(static_cast<long double>(x)));
}
double __wrap_atan2(double y, double x) {
    return static_cast<double>(std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
}

/// The root of the sum of squares, less the first order of what rounding left in it (Borges 2020, "An Improved Algorithm for hypot(a,b)",
/// ACM TOMS 46).
double __wrap_hypot(double x, double y) {
    x = std::fabs(x), y = std::fabs(y);
    if (std::isinf(x) || std::isinf(y)) return HUGE_VAL;
    if (std::isnan(x) || std::isnan(y)) return x + y;
    const double more = std::max(x, y), less = std::min(x, y);
    if (less <= more * 0x1p-54) return more + less;
    const double scale = more > 0x1p511 ? 0x1p-600 : less < 0x1p-459 ? 0x1p600 : 1;
    const double a = more * scale, b = less * scale, root = std::sqrt(a * a + b * b);
    // root^2 - a^2 - b^2, from the nearer one of both on.
    double rest, far;
    if (root <= 2 * b) {
        const double beyond = root - b;
        rest = a * (2 * beyond - a);
        far = (beyond - 2 * (a - b)) * beyond;
    } else {
        const double beyond = root - a;
        rest = 2 * beyond * (a - 2 * b);
        far = (4 * beyond - b) * b + beyond * beyond;
    }
    return (root - (rest + far) / (2 * root)) / scale;
}

}  // extern "C"
