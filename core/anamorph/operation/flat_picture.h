// SPDX-License-Identifier: Apache-2.0
// The picture of an operation that is one map from a picture to another.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

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
    std::shared_ptr<const Attributes> says = {};  ///< attributes besides the tolerance, if there are any
    std::optional<Box> display = {};              ///< the display window, where the target is another
    bool adds_alpha = false;                      ///< as Picture has it
    DataChannels data = {};

    Size source_size() const { return {source.width(), source.height()}; }
};

/// Adds attributes to those of a request.
void add_to(FlatRequest& request, Attributes more);

/// The attributes of a request that has a single one.
std::shared_ptr<const Attributes> saying(Attribute attribute);

/// A request for a picture made from a flat one, with what rows of the table say: filter, wrap, output,
/// scheme and tol.
FlatRequest flat_request(const ParameterValues& values, const SourceFacts& source, const Size& target);

/// A map, and what it says of its picture beyond what every picture reached.
struct FlatMap {
    std::shared_ptr<const BlockMap> blocks;
    std::function<Attributes(const ParallelFor& parallel_for)> says = {};
};
/// A function that makes the map for a picture of so many pixels.
using MakeFlatMap = std::function<FlatMap(const Size& pixels)>;

/// The fraction of a map's pixels that have no point of their own, wherever the source ends.
template <class Map>
double undefined_fraction(const Map& map, const ParallelFor& parallel_for) {
    constexpr int kRows = 128;
    const Size size = map.target_size();
    std::atomic<std::int64_t> count{0};
    parallel_for((size.height + kRows - 1) / kRows, [&](std::int64_t i) {
        const int top = static_cast<int>(i) * kRows;
        count += map.undefined_pixels({0, top, size.width, std::min(top + kRows, size.height)});
    });
    return static_cast<double>(count) / (static_cast<double>(size.width) * size.height);
}
/// The map of a plan, whose picture says undefined_fraction().
template <class Plan>
FlatMap with_undefined_fraction(std::shared_ptr<const Plan> plan) {
    return {
        plan, [plan](const ParallelFor& parallel_for) {
            return Attributes{{"anamorph:undefined_fraction", undefined_fraction(plan->map(), parallel_for)}};
        }};
}

/// The faces of a picture that is a source.
SourceFaces faces_of(const Chart& source);

std::unique_ptr<const Pictures> flat_pictures(const FlatRequest& request, const MakeFlatMap& make_map);

}  // namespace anamorph
