// SPDX-License-Identifier: Apache-2.0
// A map as a machine computes it, pixel by pixel, beside the exact one.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/plan/block.h"

namespace anamorph::machine {

/// Texture coordinates as a unit computed them: from 0 to 1 over the source image, u right, v down.
struct UnitCoordinates {
    Point<double> at;
    bool beyond;       ///< was a number beyond the range of its format?
    bool seen = true;  ///< is the pixel drawn?
};

/// Blocks whose source points are a machine's. A block's bound is the largest distance of its pixels' source points from the
/// exact ones, of which each is measured, and the rounding of these.
class MachineMap : public BlockMap {
  public:
    /// `exact`: the map that is to be drawn, of one layer and one source piece. The source is read at multiples of
    /// 2^-address_bits of its texels, at 0 where coordinates are no finite numbers. `turn`: Chart::turn of the source.
    MachineMap(std::shared_ptr<const BlockMap> exact, const std::vector<Box>& pieces, const Size& source,
               double turn, int address_bits);

    /// The number of the picture's pixels whose coordinates were beyond the range of a format.
    std::int64_t saturated_pixels(const ParallelFor& parallel_for) const;

    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    bool truth(double x, double y, int piece, Point<DoubleDouble>& source_point,
               int& source_piece) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;

  protected:
    /// The coordinates of the pixel whose left upper corner is (x, y).
    virtual UnitCoordinates coordinates(int x, int y, int piece) const = 0;
    /// The largest distance of exact() from the truth on a box, in source pixels.
    virtual double rounding(const Box& box, int piece) const = 0;

    void plan(const Box& box, int piece, Blocks& blocks) const override;

    /// The point where the source is read, in its pixels.
    Point<double> source_point(const UnitCoordinates& coordinates) const;

  private:
    struct Region;

    std::int64_t compute(const Box& box, int piece, Region& region) const;
    double distance(const Point<double>& used, const Point<double>& exact) const;
    double bound_over(const Box& box, int piece, const Region& region) const;

    std::shared_ptr<const BlockMap> m_exact;
    Size m_source;
    double m_turn, m_address_unit;
    mutable std::mutex m_mutex;
    mutable std::map<std::array<int, 3>, std::int64_t> m_saturated;  ///< in regions, by piece and corner
};

/// The largest bound of a map's blocks that meet a box.
double most_bound(const BlockMap& map, const Box& box);

/// Throws Error naming `machine` where a source is larger than textures of side x side.
void check_texture_side(const Size& source, int side);

}  // namespace anamorph::machine
