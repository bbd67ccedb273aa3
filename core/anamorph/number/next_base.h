// SPDX-License-Identifier: Apache-2.0
// The state that vectors read bases with (number/read_bases.h), once for all instruction sets.
#pragma once

#include <cstdint>

#include "anamorph/number/reading_order.h"

namespace anamorph::simd {

/// The bases that are still to be read, of the type that is read. Once a row's formula stands in one function its reads are
/// at known places. (By the usual model plugins would call a function for each.)
static thread_local const void* t_next __attribute__((tls_model("initial-exec"))) = nullptr;

/// The order in which bases are read, or nothing: blocks are drawn without keeping it, which takes longer
/// than the drawing.
template <class Order>
static thread_local Order t_order;

/// Stands for a ReadingOrder that is not kept.
struct NoOrder {
    struct Number {
        constexpr Number(int = 0) {}  // NOLINT: the number of a constant is 0
    };
    static constexpr Number next(BaseOperation, Number = 0, Number = 0, Number = 0) { return {}; }
    static constexpr std::uint64_t sum() { return 0; }
};

}  // namespace anamorph::simd
