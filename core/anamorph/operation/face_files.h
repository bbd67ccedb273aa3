// SPDX-License-Identifier: Apache-2.0
// Cubes whose faces are six files, by one name with {face} in it.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>

#include "anamorph/chart/chart.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {

/// The six files that a name stands for.
struct FaceFiles {
    Projection layout;                        ///< the layout that their pictures fill, cubemap or cubemap3x2
    std::array<std::string, 6> names;         ///< in the order of the layout's pieces
    std::string words;                        ///< what stands in place of {face}: "px, nx, py, ny, pz, nz"
    std::array<std::string, 6> identities{};  ///< as SideFile has them, which a host fills in
};

/// Has the name of a file, before the first `?`, {face} in it?
bool has_face(std::string_view name);

/// All words that may stand in place of {face}, those of each way of naming in brackets, for messages and documentation.
std::string face_words();

/// Finds the files that a name with {face} stands for: those of the one way of naming whose six files are there. Names of axes and
/// numbers are those of `from` among the values, which may be cubemap or cubemap3x2; by default +x to -z are OpenEXR's faces, as
/// with the key `face`, all others those of OpenGL. `key`: the parameter that has the name. Throws Error where no six are there, or
/// those of several.
FaceFiles find_face_files(const std::string& key, const std::string& name, const ParameterValues& values,
                          const std::function<bool(const std::string& name)>& exists);

}  // namespace anamorph
