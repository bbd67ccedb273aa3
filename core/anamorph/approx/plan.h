// SPDX-License-Identifier: Apache-2.0
// A pull map made cheap with its bound: the picture cut into blocks, each with polynomials for the source
// point and a proven bound of their error, split where the bound exceeds the tolerance, exact where no block
// holds it.
//
// Blocks are anchored to the pieces of the whole target image: what part of the picture is asked for, in what
// order and by how many threads changes none of them.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/map/panorama.h"

namespace anamorph {

/// exact: every pixel in double. blocks: quadratic polynomials on blocks. residual: Kim's decomposition
/// (3.1), one linear map and a bilinear table of residuals (4.3, 4.4). automatic: the fastest that holds.
enum class Scheme { automatic, exact, blocks, residual };

/// A rectangle of target pixels with one way to find their source points.
///
/// For a polynomial block, with s and t in [-1, 1] running over the pixel centres of the block (s right, t
/// down), the source point is base + (x or y)[0] + [1] s + [2] t + [3] s^2 + [4] s t + [5] t^2, in source
/// pixels, the sum evaluated in float by Block-wide loops as ((([5] t + [2]) t + [0]) + s (([4] t + [1]) + s
/// [3])).
struct Block {
    enum class Kind : std::uint8_t { polynomial, exact, outside };

    Box box;
    Kind kind = Kind::exact;
    int piece = 0;         ///< of the target
    int source_piece = 0;  ///< polynomial blocks only
    std::int32_t base_x = 0, base_y = 0;
    float x[6] = {}, y[6] = {};
    double bound = 0;  ///< of the distance to the exact source point, in source pixels
};

/// What a picture reached: the largest proven bound in use and the fraction of pixels evaluated exactly.
struct Reached {
    double max_error = 0;
    double exact_fraction = 0;
};

struct PlanOptions {
    Scheme scheme = Scheme::automatic;
    double tol = 0.01;  ///< source pixels
    int degree = 2;     ///< of the polynomials of scheme blocks: 1 or 2
    /// Source points that lie outside the source image by more than a filter's support need not be found.
    bool cull = true;
    /// Blocks may run over the seam of a source that closes on itself, with x beyond its edges.
    bool across_seam = true;
};

class Plan {
  public:
    /// Throws Error when tol is negative or not a number.
    Plan(const Panorama& map, const PlanOptions& options);

    const Panorama& map() const { return m_map; }
    const PlanOptions& options() const { return m_options; }

    /// The picture is planned region by region: at most kRegion pixels square, anchored to each piece.
    static constexpr int kRegion = 512;
    std::int64_t regions() const { return m_regions; }
    Box region_box(std::int64_t region) const { return place_of(region).box; }
    /// The regions that meet a box of the picture.
    std::vector<std::int64_t> regions_in(const Box& box) const;

    /// The blocks of a region, which cover its box without overlap. Computed when first asked for and kept
    /// for a while; thread safe.
    std::shared_ptr<const std::vector<Block>> blocks(std::int64_t region) const;

    /// Over the whole picture.
    Reached reached(const ParallelFor& parallel_for) const;

  private:
    struct Place {
        Box box;
        int piece;
    };
    /// Regions of one piece, numbered row by row.
    struct Grid {
        std::int64_t first;
        int columns, rows;
    };
    struct Cache;

    Place place_of(std::int64_t region) const;

    Panorama m_map;
    PlanOptions m_options;
    std::vector<Grid> m_grids;
    std::int64_t m_regions = 0;
    std::shared_ptr<Cache> m_cache;
};

}  // namespace anamorph
