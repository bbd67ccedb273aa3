// SPDX-License-Identifier: Apache-2.0
// The hot loops of near/far (approx/near_far.h), compiled for every instruction set Highway knows: what is
// known of lines over a cell, sums over far lines at Chebyshev nodes, polynomials moved between bases, and
// the pixels of a cell.
//
// Frames. Positions are relative to the centre of a region, in pixels of the target; displacements are in
// pixels of the shapes' pictures, less a reference that all lines of the region share. Up to two shapes: x
// and y of the first, x and y of the second.
//
// Errors, with u = 2^-24, R the region's half side. before, behind and beside err by u (2 |value| + 7.8 R):
// what is stored is rounded, as are x, y and their products with the direction; together, as a vector, by u
// (2 r + 11 R). a + dist errs by u (5 (a + r) + 11 R), a weight relatively by b times that over a + r, plus
// kWeightRounding u (for exponents other than 0, 1/2, 1 and 2: plus kPowerRounding u b (1 + |log(a + r)|)), a
// displacement by u (4 |value| + 10 R slope). Sums run over at most 8 lines before they are added in double.
#pragma once

#include <cstdint>

namespace anamorph::simd {

inline constexpr int kComponents = 4;
inline constexpr int kSums = 1 + kComponents;  ///< of weights, and of weighted displacements
inline constexpr int kMaxDegree = 8;           ///< K: coefficients each way

inline constexpr double kWeightRounding = 6;
inline constexpr double kPowerRounding = 12;
/// a + dist is never taken below this.
inline constexpr float kLeastDistance = 1e-6f;

/// A line as seen from the region's centre: how far the centre lies before p, behind q and beside the line;
/// its direction; its factor; and its displacement there and per pixel right and down.
struct FieldLine {
    float before, behind, beside, along_x, along_y, factor;
    float at[kComponents], right[kComponents], down[kComponents];
};

/// The same, number by number: field f of line i stands at data[f * stride + i]. count may be any; up to the
/// next multiple of 16 there is room, and lines of factor 0.
struct LineTable {
    enum Field {
        kBefore,
        kBehind,
        kBeside,
        kAlongX,
        kAlongY,
        kFactor,
        kSlope,  ///< the most that the displacement changes over a pixel right plus a pixel down
        kAt,
        kFields = kAt + kComponents
    };
    const float* data;
    std::ptrdiff_t stride;
    const float* right;  ///< kComponents fields more each
    const float* down;
    int count;
};

struct WeightParameters {
    float a, b;
};

/// A square cell: its centre and half side.
struct CellFrame {
    float x, y, half;
};

/// What is known of lines over a cell: arrays of as many numbers as LineTable has room for.
struct LineBounds {
    float* most;     ///< the greatest weight in the cell
    float* least;    ///< the least
    float* value;    ///< most times the interpolation's relative error of the weight; infinite where unknown
    float* linear;   ///< the same of the weight times an offset in the cell, times the displacement's change
    float* nearest;  ///< a + dist, the least in the cell
    float* displacement[kComponents];  ///< at the centre
    double center[kSums];              ///< sums at the centre
    double least_sum;
};
/// K: coefficients each way (4, 6 or 8); lebesgue: K's Lebesgue constant.
void bound_lines(const LineTable& lines, const CellFrame& cell, const WeightParameters& weights, int k,
                 float lebesgue, LineBounds& bounds);

/// Sums and maxima over lines, of the greatest weight m, the reach r, a + dist d, and the displacement's
/// change per pixel.
struct SpreadSums {
    double farthest = 0;  ///< max r
    double heavy = 0;     ///< max r of lines with m > much
    double light = 0;     ///< sum m r of the others
    double steep = 0;     ///< sum m r / d
    double slope = 0;     ///< sum m * change
    /// Sums of m, m r, m / d, m r / d over lines that may be far (not heavy, error known).
    double most = 0, reach = 0, near = 0, near_reach = 0;
};
/// reach[i]: the greatest distance of a line's displacement from `center` (kComponents numbers) in the cell;
/// error[i]: value * (the distance at the cell's centre) + linear.
SpreadSums bound_displacements(const LineTable& lines, const CellFrame& cell, const float* center, float much,
                               const LineBounds& bounds, float* reach, float* error);

/// Adds the kSums sums over `count` lines at the K x K nodes of a cell: sums[(row * K + column) * 8 + c].
void node_sums(const FieldLine* lines, const std::int32_t* which, int count, const CellFrame& cell,
               const WeightParameters& weights, int k, const float* nodes, double* sums);

/// to = L from R^T for K x K matrices of kSums numbers (8 doubles apart).
void transform(const double* left, const double* right, int k, const double* from, double* to);

/// The pixels of a cell of near lines and a polynomial in s, t in [-1, 1] (s = (x - cell.x) / cell.half):
/// coefficient of t^n s^m for sum c at coefficients[(n * K + m) * 8 + c]; none with k = 0.
struct FieldCell {
    CellFrame frame;
    int k;
    const float* coefficients;
    const FieldLine* near_lines;  ///< as seen from the origin of `frame`
    int near_count;
    WeightParameters weights;
};
/// Source points less the base, of `width` <= 64 pixels of `height` rows from (x, y) on (centres of pixels in
/// the region's frame): offset[c] + slope[c] * (x or y) + displacement. Rows of each output are `stride` >=
/// width + 16 floats apart.
struct FieldOutput {
    float x, y;
    int width, height;
    float offset[kComponents], slope[kComponents];
    int components;  ///< 2 or 4
    float* to[kComponents];
    std::ptrdiff_t stride;
};
void field_points(const FieldCell& cell, const FieldOutput& output);

}  // namespace anamorph::simd
