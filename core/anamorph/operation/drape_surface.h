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

/// The rows of a surface, but for how it is turned and moved.
ParameterTable drape_surface_rows();

/// What an operation's files say of a surface, read once for all its frames.
class DrapeSurfaces {
  public:
    /// `aspect`: width over height of the picture. Throws Error.
    DrapeSurfaces(const OperationInput& input, double aspect);

    /// What in the files is no number, in words; empty where there is nothing.
    const std::string& missing() const { return m_missing; }
    /// The surface of a frame's values, in which `frame` is the frame. Throws Error.
    surface::SurfaceSum sum_of(const ParameterValues& values) const;
    /// Its patches, which frames share as long as the surface stays.
    std::shared_ptr<surface::SharedTree> tree_of(const surface::SurfaceSum& sum) const;

  private:
    struct Kept {
        std::mutex mutex;
        std::vector<std::pair<surface::SurfaceSum, std::shared_ptr<surface::SharedTree>>>
            trees;  ///< the last one first
    };

    SpaceFormula formula_of(const ParameterValues& values) const;

    double m_aspect;
    surface::SurfaceSum m_files;
    std::string m_missing;
    std::unique_ptr<Kept> m_kept = std::make_unique<Kept>();
};

}  // namespace anamorph
