// SPDX-License-Identifier: Apache-2.0
// The blocks of a warp through points held against its own map in long double.
#pragma once

#include "anamorph/mesh/mesh_scattered.h"
#include "warp_findings.h"

namespace anamorph::test {

inline Findings findings_of(const ScatteredPlan& plan) {
    return examine(plan, [&](double x, double y) {
        const CubicTriangle& t = plan.map().triangle_at(x, y);
        return plan.map().at(t, static_cast<long double>(x), static_cast<long double>(y));
    });
}

}  // namespace anamorph::test
