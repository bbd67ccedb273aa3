// SPDX-License-Identifier: Apache-2.0
#include "anamorph/joining.h"

namespace anamorph {

std::string why_drawn_apart(const std::string& operation, const ParameterValues& values, int count) {
    if (!values.knows("concatenate")) return operation + " does not join";
    if (!values.toggle("concatenate")) return "concatenate=0";
    return count > 1 ? "it is a film" : "";
}

Joined joined_sides(const ChainSide& outer, PixelKind pixels, const ChainSide& inner) {
    const auto refuse = [](const char* reason) { return Joined{{}, reason}; };
    if (!inner.picture.of_maps()) return refuse("its source is no picture of maps");
    if (pixels == PixelKind::color && (inner.space != outer.space || inner.stored != outer.stored))
        return refuse("colors are kept differently");
    if (!outer.picture.of_maps()) return refuse("it is no picture of maps");
    return joined_picture(*outer.picture.of_maps(), *inner.picture.of_maps(), inner.shown);
}

}  // namespace anamorph
