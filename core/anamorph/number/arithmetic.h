// SPDX-License-Identifier: Apache-2.0
// What is proven of numbers holds for IEEE arithmetic: every operation gives the exact result rounded once to its own type, an
// infinity or NaN where there is none. Options that let the compiler do otherwise are errors here, as far as it says that it has
// them. Whoever links Anamorph::core compiles with the options that it does not tell of: -ffp-contract=off, and of GCC
// -fno-tree-slp-vectorize.
#pragma once

#include <cfloat>
#include <limits>

#if defined(__FAST_MATH__)
#error "Anamorph's bounds do not hold with -ffast-math or -Ofast: compile without"
#elif defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "Anamorph's bounds do not hold with -ffinite-math-only: compile without"
#elif defined(__ASSOCIATIVE_MATH__)
#error "Anamorph's bounds do not hold with -fassociative-math or -funsafe-math-optimizations: compile without"
#elif defined(__RECIPROCAL_MATH__)
#error "Anamorph's bounds do not hold with -freciprocal-math: compile without"
#elif defined(_M_FP_FAST)
#error "Anamorph's bounds do not hold with /fp:fast: compile without"
#endif
// 16 lets half floats alone be computed in another type.
#if !defined(FLT_EVAL_METHOD) || (FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16)
#error \
    "Anamorph's bounds hold where float and double are computed as such: FLT_EVAL_METHOD must be 0 (-mfpmath=sse)"
#endif

namespace anamorph {

static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);

/// The unit roundoff of Real: half the spacing of its numbers, relative to their magnitude.
template <class Real>
constexpr double unit_roundoff() {
    return static_cast<double>(std::numeric_limits<Real>::epsilon() / 2);
}

}  // namespace anamorph
