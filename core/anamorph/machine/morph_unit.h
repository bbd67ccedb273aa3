// SPDX-License-Identifier: Apache-2.0
// Feature morphs as Kim 2003, 5.6, draws them: the equations of the features are evaluated at the vertices of a mesh, which is finer
// where features are; each picture is warped over that mesh by the printed pixel shader, and the second is blended over the
// first in the frame buffer, by its alpha.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "anamorph/machine/machine_map.h"
#include "anamorph/machine/shaded_warp.h"
#include "anamorph/mesh/mesh_data.h"
#include "anamorph/morph/near_far.h"
#include "anamorph/parameter/number_row.h"

namespace anamorph::machine {

inline constexpr NumberRow kMorphCellsRow{"cells", 12, 1, 128, NumberRow::closed, true};
inline constexpr NumberRow kMorphLevelsRow{"levels", 1, 0, 3, NumberRow::closed, true};

/// The parts and numbers of a unit that draws morphs.
struct MorphUnit {
    ShaderUnit shader{.layout = ShaderLayout::printed};
    int cells = static_cast<int>(kMorphCellsRow.standard);  ///< of the mesh, each way
    int levels = static_cast<int>(
        kMorphLevelsRow.standard);     ///< how often cells that a feature meets are cut into four
    NumberFormat buffer = kUnsigned8;  ///< a channel of the frame buffer, and what is blended there
};

/// The meshes over which the pictures of a morph are warped.
struct MorphMeshes {
    std::vector<ControlMesh> meshes;  ///< one a shape
    std::int64_t evaluations =
        0;  ///< points at which the features' equations were evaluated, for all shapes at once
};
MorphMeshes morph_meshes(const FeatureMap& map, const MorphUnit& unit);

/// One picture of a morph, warped over its mesh. Its errors are those of the mesh and of the shader, against the features' map.
class MorphWarp final : public MachineMap {
  public:
    /// `alpha`: what the program writes as alpha. Throws Error as ShadedWarp does.
    MorphWarp(const std::shared_ptr<const FeatureMap>& map, int shape, const ControlMesh& mesh,
              const MorphUnit& unit, double alpha);

    /// As ShadedWarp::color().
    std::array<double, 4> color(int x, int y, const ShadedWarp::ReadPicture& read) const {
        return m_warp.color(x, y, read);
    }

  protected:
    UnitCoordinates coordinates(int x, int y, int piece) const override;
    double rounding(const Box& box, int piece) const override;

  private:
    /// The exact map, and what it refers to.
    struct Exact {
        std::shared_ptr<const FeatureMap> map;
        NearFar blocks;
    };
    MorphWarp(std::shared_ptr<const Exact> exact, int shape, const ControlMesh& mesh, const MorphUnit& unit,
              double alpha);

    std::shared_ptr<const Exact> m_exact;
    ShadedWarp m_warp;
};

/// Blends a color over what stands in the frame buffer, by alpha: both are rounded to its format before, and what comes out after.
double blended(const NumberFormat& buffer, double color, double alpha, double below);

}  // namespace anamorph::machine
