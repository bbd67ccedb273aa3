// SPDX-License-Identifier: Apache-2.0
// Warps that a pixel-shader unit draws, by our program or by the user's.
#pragma once

#include <memory>
#include <optional>

#include "anamorph/operation/operation.h"
#include "anamorph/operation/warp.h"

namespace anamorph {

/// The program that `program` names; none where it is not given. Throws Error naming the line.
std::optional<machine::ShaderProgram> read_shader(const OperationInput& input);

/// The picture of a request with a machine. Throws Error.
std::unique_ptr<const SolvedPicture> shaded_picture(const WarpMap& map, const WarpRequest& request);

}  // namespace anamorph
