// SPDX-License-Identifier: Apache-2.0
// Mesh and point files of any bytes, read as far as a point of the map that they describe.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_warp.h"
#include "expect_error.h"

using namespace anamorph;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    fuzz::expect_no_failure_but_error([&] {
        const WarpMap map = parse_warp_file(text, data[0] & 1 ? "fuzz.csv" : "fuzz.json");
        MeshWarpOptions options;
        options.tol = 1.0 / 16;
        options.amount = data[0] / 64.0;
        const Picture warp = warped_picture(map, {64, 48}, {40, 32}, options);
        Point<double> point{};
        int piece = 0;
        if (warp.maps.front().blocks->exact(20.5, 16.5, 0, point, piece))
            fuzz::require(std::isfinite(point.x) && std::isfinite(point.y), "a source point is a number");
        const Reached reached = warp.reached();
        fuzz::require(reached.max_error <= options.tol, "the tolerance holds");
    });
    return 0;
}
