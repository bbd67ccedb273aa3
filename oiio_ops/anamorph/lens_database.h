// SPDX-License-Identifier: Apache-2.0
// Lenses by their names, of Lensfun's database.
#pragma once

#include <OpenImageIO/imageio.h>

#include <vector>

#include "anamorph/operation/operation.h"

namespace anamorph {

/// Was Anamorph built with Lensfun?
bool has_lens_database();

/// Puts models of the core in the place of lenses of Lensfun's database, where `values` of an operation name some, as in
/// lens=lensfun:lens=NAME,camera=NAME,focal=35; what is not said there is what the upright source's metadata says. Where the source
/// is seen through such a lens and does not say its projection itself, `sources` learn that and the field of view. Returns what was
/// found, as anamorph:lens and anamorph:srclens. `specs`: of the upright sources. Throws Error naming the parameter, with
/// names that are near where there is no such lens.
Attributes find_lenses(const Operation& operation, ParameterValues& values,
                       const std::vector<OIIO::ImageSpec>& specs, std::vector<SourceImage>& sources);

}  // namespace anamorph
