// SPDX-License-Identifier: Apache-2.0
// The surfaces of the operation drape: their parameters and files.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "anamorph/operation/operation.h"
#include "anamorph/surface/drape.h"

namespace anamorph {

/// The rows of a surface, without those by which it is turned and moved.
ParameterTable drape_surface_rows();

/// The surfaces that an operation's files and values describe; the files are read once for all frames.
class DrapeSurfaces {
  public:
    /// Reads the files. `aspect`: width over height of the picture. Throws Error.
    DrapeSurfaces(const OperationInput& input, double aspect);

    /// Says what in the files is no number; empty where all are numbers.
    const std::string& missing() const { return m_missing; }
    /// The surface of a frame's values, in which `frame` is the frame. Throws Error.
    surface::SurfaceSum sum_of(const ParameterValues& values) const;
    /// The patches of a surface, which frames share as long as the surface stays.
    std::shared_ptr<surface::SharedTree> tree_of(const surface::SurfaceSum& sum) const;

  private:
    struct Kept {
        std::mutex mutex;
        std::vector<std::pair<surface::SurfaceSum, std::shared_ptr<surface::SharedTree>>>
            trees;  ///< the latest one first
    };

    SpaceFormula formula_of(const ParameterValues& values) const;

    double m_aspect;
    surface::SurfaceSum m_files;
    std::string m_missing;
    std::unique_ptr<Kept> m_kept = std::make_unique<Kept>();
};

}  // namespace anamorph
