// SPDX-License-Identifier: Apache-2.0
// The surfaces of the operation drape: their parameters and files.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "anamorph/operation/operation.h"
#include "anamorph/surface/drape.h"

namespace anamorph {

/// The files that `blend` names among surfaces: all names that have an ending.
LinkedFiles files_of_blend(const ParameterValues& values);

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

    /// A surface of `blend` that is a file: the surface itself moved by a list of deformations, or one of positions.
    struct Designed {
        std::vector<Deformation> deformations;
        std::shared_ptr<const surface::SampledField> positions;
    };

    SpaceFormula formula_of(const ParameterValues& values) const;
    void blend(const ParameterValues& values, surface::SurfaceSum& sum) const;

    double m_aspect;
    std::map<std::string, Designed> m_designed;  ///< by names in blend
    surface::SurfaceSum m_files;
    std::string m_missing;
    std::unique_ptr<Kept> m_kept = std::make_unique<Kept>();
};

}  // namespace anamorph
