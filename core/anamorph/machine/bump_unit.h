// SPDX-License-Identifier: Apache-2.0
// Environment-mapped bump mapping as Kim 2003 uses it (3.3 and 4.4) for a panorama viewer: texture coordinates that are linear on a
// projection plane (bump_plane.h), and a second texture, the bump map, which perturbs them pixel by pixel by what remains there
// (eq. 4.3, 4.4).
//
// Texture coordinates (u, v) run from 0 to 1 over the source image, u right, v down; so do screen coordinates (s, t) over the
// picture.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/machine/bump_plane.h"
#include "anamorph/machine/machine_map.h"
#include "anamorph/machine/machine_texture.h"
#include "anamorph/machine/number_format.h"
#include "anamorph/parameter/number_row.h"

namespace anamorph::machine {

inline constexpr NumberRow kBumpSizeRow{"size", 256, 0, 4096, NumberRow::closed, true};
inline constexpr NumberRow kBumpWeightRow{"weight_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kBumpAddressRow{"address_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kTextureSideRow{"texture_side", 4096, 1, 1 << 20, NumberRow::closed, true};
inline constexpr NumberRow kPlanesRow{"planes", 1, 1, 16, NumberRow::closed, true};
inline constexpr NumberRow kPlaneXRow{"x_max", 0, 0, 1000};
inline constexpr NumberRow kPlaneYRow{"y_max", 0, 0, 1000};

/// Graphics cards that section 4.4 names. any has no limits; reference is the DirectX reference rasterizer.
enum class BumpCard { any, reference, geforce3, geforce4, radeon, radeon8500, radeon9700 };
inline constexpr BumpCard kBumpCards[] = {BumpCard::any,       BumpCard::reference, BumpCard::geforce3,
                                          BumpCard::geforce4,  BumpCard::radeon,    BumpCard::radeon8500,
                                          BumpCard::radeon9700};

/// The parts and numbers of a bump unit.
struct BumpUnit {
    /// The edge of a bump map. clamp: the texels cover the plane's range, and what lies beyond the centres of the
    /// outer ones is like these; border: the outermost texels lie outside of the range.
    enum class Edge { clamp, border };
    /// Where the screen is projected onto the plane. vertex: at the corners of its trapezoid, by software, before it is drawn
    /// (4.5.1); pixel: at each pixel, by the matrices of eq. 4.5 and a division (4.4.1, Fig. 4.5).
    enum class Projecting { vertex, pixel };

    BumpCard card = BumpCard::any;
    Projecting projecting = Projecting::vertex;
    PlaneOptions planes = {};
    int size =
        static_cast<int>(kBumpSizeRow.standard);  ///< texels of the bump map each way; 0: there is none
    NumberFormat texel = kSigned16;
    bool scaled = true;  ///< texels are divided by the largest, so that they use all of their range (4.4.3)
    int weight_bits = static_cast<int>(kBumpWeightRow.standard);  ///< bits of the bump map's bilinear weights
    Edge edge = Edge::clamp;
    NumberFormat arithmetic =
        kFloat32;  ///< format of texture coordinates and all that is done with them (with_format)
    int address_bits = static_cast<int>(kBumpAddressRow.standard);  ///< as in MachineMap
    int texture_side = static_cast<int>(kTextureSideRow.standard);  ///< side of the largest source that fits
};

/// Throws Error naming `machine` and the key where a unit's card cannot do what the unit does (4.4.1 and 4.4.3).
void check_card(const BumpUnit& unit);
/// Checks that a unit can throw a panorama onto a scene, which is drawn by a graphics card of today with the unit's tables
/// (vtkAnamorphProjectionShader). Throws Error naming `machine` and the key.
void check_on_scene(const BumpUnit& unit, const Chart& source);
/// The texels that a card's bump maps have.
NumberFormat texel_of(BumpCard card);
/// The name of a card, as users write it.
std::string name_of(BumpCard card);

/// A bump unit set up for one projection plane of a view.
class BumpStage {
  public:
    /// `source` and `target`: the view's charts.
    BumpStage(const Chart& source, const Chart& target, const ProjectionPlane& plane, const BumpUnit& unit);

    /// The coordinates at a screen coordinate.
    UnitCoordinates operator()(double s, double t) const;
    /// The number of texels of the bump map that are beyond the range of their format.
    int saturated_texels() const { return m_saturated; }

    /// The matrices of eq. 4.5 without what serves a camera at another place: the product with an eye ray (X, Y, 1) is
    /// (u q, v q, q), of texture coordinates, and, of the bump map's, from 0 to 1 over that.
    const glm::dmat3& linear_matrix() const { return m_linear; }
    const glm::dmat3& bump_matrix() const { return m_bump; }
    /// The bump map, none where it has no texels, and what these are multiplied with to be perturbations in texture coordinates.
    const MachineTexture<2>* bumps() const { return m_bumps.get(); }
    const std::array<double, 2>& scale() const { return m_scale; }
    /// The corners of the trapezoid as they are drawn, a fan of triangles about the first.
    struct Corner {
        glm::dvec2 screen;  ///< (s, t)
        /// Texture coordinates, those of the bump map, and 1, all times q: what is interpolated linearly over the screen.
        std::array<double, 5> numbers;
    };
    const std::vector<Corner>& corners() const { return m_corners; }

  private:
    void make_bumps(const Chart& source, const ProjectionPlane& plane);
    void set_matrices(const ProjectionPlane& plane);
    void set_corners(const ProjectionPlane& plane);
    template <class T>
    std::array<T, 5> numbers_at(double s, double t) const;

    BumpUnit m_unit;
    EyeCorners m_eye;
    glm::dmat3 m_linear{1}, m_bump{1};
    std::vector<Corner> m_corners;
    std::array<double, 2> m_scale{1, 1};  ///< factors of texels
    std::unique_ptr<const MachineTexture<2>> m_bumps;
    int m_saturated = 0;
};

/// The reading back of coordinates (section 4.6): a texture of size x size texels that hold their own texture
/// coordinates is drawn in place of the source, to a picture of the same format.
class ReadBack {
  public:
    explicit ReadBack(int size = 256, const NumberFormat& format = kUnsigned16, int weight_bits = 8);
    Point<double> operator()(const Point<double>& at) const;

  private:
    NumberFormat m_format;
    MachineTexture<2> m_texture;
};

/// A panorama as a bump unit draws it.
class BumpedPanorama final : public MachineMap {
  public:
    /// Throws Error naming `machine` where the view cannot be drawn so (projection_planes(), check_card()), or the source is
    /// larger than the unit's textures.
    BumpedPanorama(const Panorama& map, const BumpUnit& unit);

    /// The number of texels of its bump maps that were beyond their format's range.
    int saturated_texels() const;
    /// The coordinates at a screen coordinate, of the plane that draws it.
    UnitCoordinates at(double s, double t) const;
    /// One stage for each projection plane, from the left to the right.
    const std::vector<BumpStage>& stages() const { return m_stages; }

  protected:
    UnitCoordinates coordinates(int x, int y, int piece) const override;
    double rounding(const Box& box, int piece) const override;

  private:
    Panorama m_map;
    EyeCorners m_eye;
    std::vector<glm::dvec3>
        m_between;  ///< normals of the planes through the axis that divide the stages, to the right
    std::vector<BumpStage> m_stages;
};

}  // namespace anamorph::machine
