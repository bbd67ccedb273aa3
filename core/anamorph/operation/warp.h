// SPDX-License-Identifier: Apache-2.0
// The operation warp: a picture drawn through a control mesh, an ST-map or pairs of points.
#pragma once

#include <optional>

#include "anamorph/geometry/size.h"
#include "anamorph/machine/shaded_warp.h"
#include "anamorph/mesh/mesh_warp.h"
#include "anamorph/operation/operation.h"

namespace anamorph {

const Operation& warp_operation();

/// A warp as asked for, but for the mesh itself.
struct WarpRequest {
    Size source, target;
    std::optional<Box> display = {};  ///< the display window, where the target is another
    MeshWarpOptions options;
    int step = 1;                        ///< step of an ST-map: every step-th pixel is a vertex
    std::optional<Direction> direction;  ///< otherwise as the mesh says
    /// The unit that draws a warp of scheme hardware, in place of options.scheme and tol.
    std::optional<machine::ShaderUnit> machine = {};
    std::optional<machine::ShaderProgram> program = {};  ///< the user's program, in place of ours
    double pixel_aspect = 1;  ///< width of a pixel over its height, where the picture has those of the source
};

/// Reads a request from a table's values. Without `size` the picture has the source's; with one number, the
/// source's shape. Throws Error.
WarpRequest read_warp_request(const ParameterValues& values, const Size& source);

/// The picture's size, as read_warp_request has it, where `natural` stands in for the source's.
Size warp_target(const ParameterValues& values, const Size& natural);

/// A warp with every position in fractions of its image: for pictures of another size than the one that
/// positions in pixels are given for.
WarpMap in_fractions(const WarpMap& map, const Size& source, const Size& target);

}  // namespace anamorph
