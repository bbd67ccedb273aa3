// SPDX-License-Identifier: Apache-2.0
// The picture of an operation that is one map from a picture to another.
#pragma once

#include <functional>
#include <memory>

#include "anamorph/image/picture.h"
#include "anamorph/operation/operation.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

struct FlatRequest {
    Chart source;
    Size target;
    PlanOptions plan;
    Filter filter;
    Wrap wrap;
    Output output;
    Attributes says = {};  ///< besides the tolerance

    Size source_size() const { return {source.width(), source.height()}; }
};

/// From a flat picture, with what rows of the table say: filter, wrap, output, scheme and tol.
FlatRequest flat_request(const ParameterValues& values, const Size& source, const Size& target);

/// The map, and what it says of its picture beyond what every picture reached.
struct FlatMap {
    std::shared_ptr<const BlockMap> blocks;
    std::function<Attributes(const ParallelFor& parallel_for)> says = {};
};
/// That of a picture of so many pixels.
using MakeFlatMap = std::function<FlatMap(const Size& pixels)>;

/// The faces of a picture that is a source.
SourceFaces faces_of(const Chart& source);

std::unique_ptr<const Pictures> flat_pictures(const FlatRequest& request, const MakeFlatMap& make_map);

}  // namespace anamorph
