// SPDX-License-Identifier: Apache-2.0
// Mesh warps by a pixel shader as in Kim 2003, 5.3 and 5.4: each of a cell's two triangles is drawn with linear texture
// coordinates, which a program perturbs by thirteen products of Hermite basis functions, read from textures.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "anamorph/machine/machine_map.h"
#include "anamorph/machine/machine_texture.h"
#include "anamorph/machine/number_format.h"
#include "anamorph/machine/shader_run.h"
#include "anamorph/mesh/mesh_plan.h"
#include "anamorph/parameter/number_row.h"

namespace anamorph::machine {

inline constexpr NumberRow kTableSizeRow{"table_size", 256, 2, 1024, NumberRow::closed, true};
inline constexpr NumberRow kTableWeightRow{"weight_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kShaderAddressRow{"address_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kShaderTextureRow{"texture_side", 2048, 1, 1 << 20, NumberRow::closed, true};

inline constexpr NumberRow kShaderAlphaRow{"alpha", 1, 0, 1};

/// What registers and textures of a warp's program hold.
enum class ShaderLayout {
    /// Ours (kWarpSlots): all constants of u, then all of v; texels of the tables stand from edge to edge of a cell.
    ours,
    /// That of the printed program (Kim 2003, Appendix A): c0, c1 and c5 are factors of s1, s2 and s4 for u, c2, c3 and c6 for v;
    /// c4 = (factor of s3.x for u, for v, 0, alpha), where s3.x is the product that the triangle alone has. t1 is (s, t) in the
    /// cell itself; texels of the tables stand at their centres.
    printed
};

/// The parts and numbers of a pixel-shader unit.
struct ShaderUnit {
    ShaderLayout layout = ShaderLayout::ours;
    double alpha = kShaderAlphaRow.standard;  ///< of the printed layout: what the program writes as alpha
    NumberFormat arithmetic = kFloat24;       ///< format of registers and all that is computed (with_format)
    NumberFormat texel = kFloat32;            ///< format of the products' textures
    int table_size = static_cast<int>(kTableSizeRow.standard);        ///< texels of these textures each way
    int weight_bits = static_cast<int>(kTableWeightRow.standard);     ///< bits of their bilinear weights
    int address_bits = static_cast<int>(kShaderAddressRow.standard);  ///< as in MachineMap
    int texture_side = static_cast<int>(kShaderTextureRow.standard);  ///< the largest side of a source
};

/// The slots of a program of a warp, with what one of our layout finds there at a pixel's centre: t0 = (u, v, 0, 1), the
/// linear texture coordinates; t1 = (s, t, 0, 1), where in the tables of products the cell's s and t are; s0,
/// the picture; s1 to s4, the products; c0 to c3 and c4 to c7, their factors for u and for v (eq. 5.5 and
/// 5.7); c8 and c9 = (width, height, 1 / width, 1 / height) of the source and of the picture that is drawn.
/// All other constants are 0 or the program's own, which go before these.
inline constexpr ShaderSlots kWarpSlots{5, 2, 0};

/// The texts of the programs of either layout: ours, which reads the picture last, and the printed one.
const char* warp_program(ShaderLayout layout);

/// Does a program of a warp read the picture once? Only then is it a map, to where it does; pixels that it kills have no point.
bool reads_picture_once(const ShaderProgram& program);

/// A mesh warp as a pixel-shader unit draws it.
class ShadedWarp final : public MachineMap {
  public:
    /// Draws by the program of the unit's layout. Throws Error naming `machine` where the source is larger than the unit's textures.
    ShadedWarp(const Mesh& mesh, const ShaderUnit& unit);
    /// Draws by the given program, which was assembled for kWarpSlots, in place of the layout's. Throws as the other
    /// does.
    ShadedWarp(const Mesh& mesh, const ShaderUnit& unit, ShaderProgram program);

    const ShaderProgram& program() const { return m_program; }
    /// The exact map.
    const MeshPlan& exact_plan() const { return *m_plan; }
    /// A function that gives the picture's four components at a point of the source, in its pixels.
    using ReadPicture = std::function<std::array<double, 4>(const Point<double>& at)>;
    /// The colour oC0 that the program gives the pixel whose left upper corner is (x, y); 0 where it kills
    /// it.
    std::array<double, 4> color(int x, int y, const ReadPicture& read) const;

    /// The coordinates at which the program reads the picture, last, for the pixel whose left upper corner is (x, y).
    UnitCoordinates texture_coordinates(int x, int y) const;

  protected:
    UnitCoordinates coordinates(int x, int y, int piece) const override;
    double rounding(const Box& box, int piece) const override;

  private:
    ShadedWarp(std::shared_ptr<const MeshPlan> plan, const ShaderUnit& unit, ShaderProgram program);
    struct Place;
    Place place_of(double x, double y) const;
    template <class T>
    ShaderInputs<T> inputs(const Place& place) const;
    std::size_t texture_of(int sampler, int triangle) const;
    /// The result of a program for a pixel.
    template <class T>
    struct Drawn {
        ShaderVector<T> color;
        bool killed;
    };
    template <class T, class Read>
    Drawn<T> run(int x, int y, const Read& read) const;

    std::shared_ptr<const MeshPlan> m_plan;
    ShaderUnit m_unit;
    ShaderProgram m_program;
    std::vector<MachineTexture<4>> m_products;  ///< the textures (texture_of)
};

}  // namespace anamorph::machine
