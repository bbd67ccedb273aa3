// SPDX-License-Identifier: Apache-2.0
// Mesh warps by a pixel shader as in Kim 2003, 5.3 and 5.4: each of a cell's two triangles is drawn with linear texture
// coordinates, which a program perturbs by thirteen products of Hermite basis functions, read from textures.
#pragma once

#include <memory>
#include <vector>

#include "anamorph/approx/mesh_plan.h"
#include "anamorph/machine/machine_map.h"
#include "anamorph/machine/machine_texture.h"
#include "anamorph/machine/shader_program.h"
#include "anamorph/number/number_format.h"
#include "anamorph/number_row.h"

namespace anamorph {

inline constexpr NumberRow kTableSizeRow{"table_size", 256, 2, 1024, NumberRow::closed, true};
inline constexpr NumberRow kTableWeightRow{"weight_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kShaderAddressRow{"address_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kShaderTextureRow{"texture_side", 2048, 1, 1 << 20, NumberRow::closed, true};

/// What a pixel-shader unit is made of.
struct ShaderUnit {
    NumberFormat arithmetic = kFloat24;  ///< of registers and all that is computed (with_format)
    NumberFormat texel = kFloat32;       ///< of the products' textures
    int table_size = static_cast<int>(kTableSizeRow.standard);        ///< of these, texels each way
    int weight_bits = static_cast<int>(kTableWeightRow.standard);     ///< of their bilinear weights
    int address_bits = static_cast<int>(kShaderAddressRow.standard);  ///< MachineMap
    int texture_side = static_cast<int>(kShaderTextureRow.standard);  ///< larger sources do not fit
};

/// The program. t0 are the linear texture coordinates, t1 the cell's s and t, s0 is the picture, s1 to s4 are the products,
/// c0 to c3 and c4 to c7 their factors for u and for v (eq. 5.5 and 5.7). The picture is read last.
extern const char* const kHermiteShader;

/// A mesh warp as a pixel-shader unit draws it.
class ShadedWarp final : public MachineMap {
  public:
    /// Throws Error naming `machine` where the source is larger than the unit's textures.
    ShadedWarp(const Mesh& mesh, const ShaderUnit& unit);

    /// The exact map.
    const MeshPlan& exact_plan() const { return *m_plan; }

  protected:
    UnitCoordinates coordinates(int x, int y, int piece) const override;
    double rounding(const Box& box, int piece) const override;

  private:
    ShadedWarp(std::shared_ptr<const MeshPlan> plan, const ShaderUnit& unit);
    template <class T>
    UnitCoordinates run(double x, double y) const;

    std::shared_ptr<const MeshPlan> m_plan;
    ShaderUnit m_unit;
    ShaderProgram m_program;
    std::vector<MachineTexture<4>> m_products;  ///< s1 to s4
};

}  // namespace anamorph
