// SPDX-License-Identifier: Apache-2.0
// Warps that a pixel-shader unit draws, by our program or by the user's.
#pragma once

#include <memory>
#include <optional>

#include "anamorph/image/point_sampler.h"
#include "anamorph/operation/operation.h"
#include "anamorph/operation/warp.h"

namespace anamorph {

/// The program that `program` names; none where it is not given. Throws Error naming the line.
std::optional<machine::ShaderProgram> read_shader(const OperationInput& input);
/// Are colors those that a program makes, of the user's or the printed one?
bool runs_program(const WarpRequest& request);
/// Throws Error where a program makes the colors and a source's pixel does not fit a register.
void check_program_channels(const WarpRequest& request, int channels);

/// What a program finds of a source's pixel: its first `channels` channels, at most 4, in order; those that it has not are 0,
/// and the fourth is 1. Sets `ok` to false where the source could not be read. It refers to `sampler` and `ok`.
machine::ShadedWarp::ReadPicture register_reader(PointSampler& sampler, Filter filter, std::size_t channels,
                                                 bool& ok);

/// The picture of a request with a machine. Throws Error.
std::unique_ptr<const SolvedPicture> shaded_picture(const WarpMap& map, const WarpRequest& request);

}  // namespace anamorph
