// SPDX-License-Identifier: Apache-2.0
// The plane of the parameters that is taken from data: that of the two directions in which they are longest.
// Once chosen, the two stay while the data have the same points and cells by number and connectivity: a
// surface that moves or turns over time keeps its parameters.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "anamorph/deform/plane_warp.h"
#include "ranks.h"
#include "vtkType.h"

class vtkMultiProcessController;
class vtkPointSet;

namespace anamorph_vtk {

/// The least and the largest coordinates of finite points.
struct Bounds {
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double least[3] = {kInfinity, kInfinity, kInfinity}, most[3] = {-kInfinity, -kInfinity, -kInfinity};

    bool empty() const { return !(least[0] <= most[0]); }
    double length(int c) const { return most[c] - least[c]; }
    void add(const Bounds& other);
};

class AutomaticPlane {
  public:
    /// The plane of all meshes of all ranks of the controller (may be null), which call this together.
    anamorph::ParameterPlane of(const std::vector<vtkPointSet*>& meshes,
                                vtkMultiProcessController* controller);
    /// Forgets the choice: the next data choose anew.
    void forget() { m_across.reset(); }

  private:
    struct Mesh {
        vtkMTimeType time = 0;
        Bounds bounds;
        std::uint64_t topology = 0;
    };
    /// Looks at meshes that have changed.
    void look_at(const std::vector<vtkPointSet*>& meshes);
    std::vector<std::uint64_t> topologies() const;

    std::vector<Mesh> m_meshes;
    std::optional<int> m_across;               ///< the direction that is in neither axis
    std::vector<std::uint64_t> m_chosen_with;  ///< the topologies that m_across was chosen with
};

}  // namespace anamorph_vtk
