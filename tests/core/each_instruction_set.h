// SPDX-License-Identifier: Apache-2.0
// Tests on every instruction set that the machine has.
#pragma once

#include <gtest/gtest.h>

#include "anamorph/image/block_sampler.h"

namespace anamorph::test {

/// Calls body() on each instruction set; then the best one is chosen again.
template <class Body>
void on_every_instruction_set(const Body& body) {
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        body();
    }
    simd::use_instruction_set("");
}

}  // namespace anamorph::test
