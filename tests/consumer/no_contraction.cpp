// SPDX-License-Identifier: Apache-2.0
// Are products rounded before they are added, in the formulas of the installed headers?
#include <anamorph/geometry/point.h>

#include <cstdio>

int main(int argc, char**) {
    if (!__builtin_cpu_supports("fma")) return 0;
    // Known at run time alone. A row of the product is a a less what that rounds to: 0, or what rounding it takes.
    const double a = 1 + argc * 0x1p-30;
    volatile double kept = a * a;
    const double rounded = kept;
    const glm::dmat3 matrix(a, -rounded, 0, -rounded, a, 0, 0, 0, 1);
    const auto first = anamorph::transform(matrix, anamorph::Ray<double>{a, 1, 0});
    const auto second = anamorph::transform(matrix, anamorph::Ray<double>{1, a, 0});
    const bool shows = __builtin_fma(a, a, -rounded) != 0;
    if (shows && first.x == 0 && second.y == 0) return 0;
    std::printf("a product was not rounded: %g and %g are left of it\n", first.x, second.y);
    return 1;
}
