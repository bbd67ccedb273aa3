// SPDX-License-Identifier: Apache-2.0
// Environment-mapped bump mapping as Kim 2003 uses it (3.3 and 4.4): texture coordinates are interpolated linearly over
// the picture, and a second texture, the bump map, perturbs them pixel by pixel by what remains (eq. 4.3, 4.4).
//
// Texture coordinates (u, v) run from 0 to 1 over the source image, u right, v down; so do screen coordinates (s, t) over a
// piece of the picture.
#pragma once

#include <memory>
#include <vector>

#include "anamorph/machine/machine_map.h"
#include "anamorph/machine/machine_texture.h"
#include "anamorph/machine/number_format.h"
#include "anamorph/panorama/panorama_residual.h"
#include "anamorph/parameter/number_row.h"

namespace anamorph::machine {

inline constexpr NumberRow kBumpSizeRow{"size", 256, 0, 4096, NumberRow::closed, true};
inline constexpr NumberRow kBumpWeightRow{"weight_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kBumpAddressRow{"address_bits", 8, 0, 23, NumberRow::closed, true};
inline constexpr NumberRow kTextureSideRow{"texture_side", 4096, 1, 1 << 20, NumberRow::closed, true};

/// The parts and numbers of a bump unit.
struct BumpUnit {
    /// The edge of a bump map. clamp: the texels cover the picture, and what lies beyond the centres of the
    /// outer ones is like these; border: the outermost texels lie outside of the picture.
    enum class Edge { clamp, border };

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

/// A bump unit set up for one piece of a picture.
class BumpStage {
  public:
    BumpStage(const Panorama& map, int piece, const BumpUnit& unit);

    /// The coordinates at a screen coordinate.
    UnitCoordinates operator()(double s, double t) const;
    /// The number of texels of the bump map that are beyond the range of their format.
    int saturated_texels() const { return m_saturated; }

  private:
    void make_bumps(const Panorama& map, int piece, const LinearPart& linear);
    std::vector<std::array<double, 2>> residuals(const Panorama& map, int piece,
                                                 const LinearPart& linear) const;

    BumpUnit m_unit;
    /// The linear part in texture coordinates, by 2 s - 1 and 2 t - 1.
    LinearPart m_linear;
    /// Numbers of the position in the bump map, which is s * m_span + m_first.
    double m_span = 0, m_first = 0;
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
    /// Throws Error naming `machine` where the source has several pieces or is larger than the unit's textures.
    BumpedPanorama(const Panorama& map, const BumpUnit& unit);

    /// The number of texels of its bump maps that were beyond their format's range.
    int saturated_texels() const;

  protected:
    UnitCoordinates coordinates(int x, int y, int piece) const override;
    double rounding(const Box& box, int piece) const override;

  private:
    Panorama m_map;
    std::vector<Box> m_pieces;
    std::vector<BumpStage> m_stages;
};

}  // namespace anamorph::machine
