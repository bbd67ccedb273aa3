// SPDX-License-Identifier: Apache-2.0
// Morphs that a pixel-shader unit draws: two warps and a blend.
#pragma once

#include <memory>
#include <vector>

#include "anamorph/operation/morph.h"
#include "anamorph/operation/operation.h"

namespace anamorph {

/// Throws Error where pictures do not fit what the program makes of them: it writes an alpha of its own.
void check_shaded_sources(const std::vector<SourceImage>& sources);

/// The picture of a request with a machine, of the options of one frame. Throws Error.
std::unique_ptr<const SolvedPicture> shaded_morph(const std::shared_ptr<const Features>& features,
                                                  const MorphRequest& request, const MorphOptions& options);

}  // namespace anamorph
