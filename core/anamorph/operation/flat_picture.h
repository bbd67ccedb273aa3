// SPDX-License-Identifier: Apache-2.0
// The picture of an operation that is one map from a flat picture to another.
#pragma once

#include <functional>
#include <memory>

#include "anamorph/approx/formula_plan.h"
#include "anamorph/operation/operation.h"
#include "anamorph/render/picture.h"

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

/// The blocks of the map, of a picture of so many pixels.
using FlatBlocks = std::function<std::shared_ptr<const BlockMap>(const Size& pixels)>;

std::unique_ptr<const Pictures> flat_pictures(const FlatRequest& request, const FlatBlocks& blocks);

}  // namespace anamorph
