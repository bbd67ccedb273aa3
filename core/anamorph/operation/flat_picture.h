// SPDX-License-Identifier: Apache-2.0
// The picture of an operation that is one map from a flat picture to another.
#pragma once

#include <functional>
#include <memory>

#include "anamorph/image/picture.h"
#include "anamorph/operation/operation.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

struct FlatRequest {
    Size source, target;
    PlanOptions plan;
    Filter filter;
    Wrap wrap;
    Output output;
    Attributes says = {};  ///< besides the tolerance
};

/// What rows of the table say: filter, wrap, output, scheme and tol.
FlatRequest flat_request(const ParameterValues& values, const Size& source, const Size& target);

/// The map, and what it says of its picture beyond what every picture reached.
struct FlatMap {
    std::shared_ptr<const BlockMap> blocks;
    std::function<Attributes(const ParallelFor& parallel_for)> says = {};
};
/// That of a picture of so many pixels.
using MakeFlatMap = std::function<FlatMap(const Size& pixels)>;

std::unique_ptr<const Pictures> flat_pictures(const FlatRequest& request, const MakeFlatMap& make_map);

}  // namespace anamorph
