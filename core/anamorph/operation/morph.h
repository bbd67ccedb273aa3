// SPDX-License-Identifier: Apache-2.0
// The operation morph: pictures that turn into each other along corresponding lines.
#pragma once

#include <optional>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/machine/morph_unit.h"
#include "anamorph/morph/morph.h"
#include "anamorph/operation/operation.h"

namespace anamorph {

const Operation& morph_operation();

/// The keys of the pictures: a, b, c ...
const std::vector<std::string>& morph_pictures();

/// A morph as asked for, but for the features.
struct MorphRequest {
    std::vector<Size> pictures;
    int width = 0, height = 0;
    MorphOptions options;
    std::optional<double> pin_border;  ///< otherwise as the features say
    int frames = 1;
    double pixel_aspect = 1;  ///< width of a pixel over its height, where the picture has those of the first
    /// The unit that draws a morph of scheme hardware, in place of options.scheme and tol.
    std::optional<machine::MorphUnit> machine = {};

    /// The options of a frame of a film: t runs evenly from 0 in the first frame to 1 in the last; t_color
    /// does too unless it was given.
    MorphOptions frame_options(int frame) const;
};

/// Reads a request from a table's values. Without `size` the picture has that of the first; with one number,
/// its shape. Throws Error.
MorphRequest read_morph_request(const ParameterValues& values, const std::vector<Size>& pictures);

}  // namespace anamorph
