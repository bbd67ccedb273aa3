// SPDX-License-Identifier: Apache-2.0
// The hot loops of near/far (morph/near_far.h), compiled for every instruction set Highway knows: what is
// known of lines over a cell, sums over far lines at Chebyshev nodes, polynomials moved between bases, and
// the pixels of a cell.
//
// Frames. Positions are relative to the centre of a region, in pixels of the target; displacements are in
// pixels of the shapes' pictures, less a reference that all lines of the region share. Up to two shapes: x
// and y of the first, x and y of the second.
//
// Every processor gives the same bits.
//
// Errors, with u = 2^-24, R the region's half side, products and sums rounded apart. before, behind and
// beside err by u (2 |value| + 7.8 R): what is stored is rounded, as are x, y and their products with the
// direction; together, as a vector, by u (2 r + 11 R). a + dist errs by u (5 (a + r) + 11 R), a weight
// relatively by b times that over a + r, plus kWeightRounding u (for exponents other than 0, 1/2, 1 and 2:
// plus kPowerRounding u b (1 + |log(a + r)|)), a displacement by u (4 |value| + 10 R slope). Sums run over at
// most 16 lines before they are added in double. Near lines of a fine cell are carried as two floats, on the
// grid of 2^-13 and the rest: the first part's products and differences are exact for |x| <= 32 (before,
// behind, beside as far as 2^11), so that they err by u (|value| + 1/64) and the 11 R above is kFineRounding.
#pragma once

#include <cstddef>
#include <cstdint>

namespace anamorph::simd {

inline constexpr int kComponents = 4;
inline constexpr int kSums = 1 + kComponents;  ///< sums of weights, and of weighted displacements
inline constexpr int kMaxDegree = 8;           ///< the largest K: coefficients each way

/// The unit roundoff u of float.
inline constexpr float kFloatRounding = 0x1p-24f;
/// The half side R of a region, in pixels.
inline constexpr float kRegionHalf = 64;
/// The rounding of a weight, in units of u: its factor is stored and multiplied by, 2; x^-b of a float is off by 3 (1 /
/// x^2 and 1 / sqrt(x) by 2; 2^t by 3), and through t = -b log2(x) by b (1.7 + 3 |log(x)|): log2(x) is off by
/// |log2(x)| + 2.4 units, b and the product are rounded. tests/core measures it against long double.
inline constexpr double kWeightRounding = 6;
inline constexpr double kPowerRounding = 3;
inline constexpr double kFineRounding = 0x1p-5;
/// The least value of a + dist; smaller ones count as this.
inline constexpr float kLeastDistance = 1e-6f;
/// The largest magnitude of the logarithm of a + dist: distances end at 1e12 pixels.
inline constexpr float kMostLog = 29;

/// The relative error of a weight in units of u, apart from that of the line's place. `log`: at least |log(a + dist)|.
constexpr double weight_rounding(double b, double log) {
    const bool fast = b == 0 || b == 0.5 || b == 1 || b == 2;
    return 5 * b + kWeightRounding + (fast ? 0 : kPowerRounding * b * (1 + log));
}

/// The rounding of a line's place that bounds allow for, in pixels: kPlaceRelative a pixel of distance, and
/// kPlaceApart. A distance r and its sums and differences with a cell's diagonal (at most 1.5 R) err by u (6
/// r + 11 R + 5 R) < 16 u r + 7e-5: more than 9e-4 is left.
inline constexpr float kPlaceRelative = 16 * kFloatRounding, kPlaceApart = 1e-3f;

/// The number of lines that node_sums adds up in float; below, the relative error of these sums and of the products in
/// them.
inline constexpr int kNodeRun = 16;
inline constexpr double kNodeRounding = (kNodeRun + 2) * 0x1p-24;

/// The number of near lines that are added up in a run; then the runs are added up: near_additions() is the
/// number of additions that a line's term goes through, at most.
inline constexpr int kNearRun = 32;
constexpr int near_additions(int lines) {
    return lines <= kNearRun ? lines : kNearRun + (lines + kNearRun - 1) / kNearRun;
}

/// The number of lines that are added up in float in each of 16 lanes; the lanes are added up in four steps,
/// and the rest in double.
inline constexpr int kSumLanes = 16;
/// The largest relative error of such a sum of positive numbers: 20 additions, and 4 steps to make each of them.
inline constexpr double kSumRounding = 24 * 0x1p-24;

/// A line as seen from the region's centre: how far the centre lies before p, behind q and beside the line;
/// its direction; its factor; and its displacement there and per pixel right and down.
struct FieldLine {
    float before, behind, beside, along_x, along_y, factor;
    float at[kComponents], right[kComponents], down[kComponents];
    /// The differences of the exact before, behind, beside and direction from the floats above.
    float before_rest, behind_rest, beside_rest, along_x_rest, along_y_rest;
};

/// A table of FieldLines, field by field: field f of line i stands at data[f * stride + i]. count may be any; up to the
/// next multiple of 16 there are lines of factor 0, as may be among the others.
struct LineTable {
    enum Field {
        kBefore,
        kBehind,
        kBeside,
        kAlongX,
        kAlongY,
        kSlope,  ///< the most that the displacement changes over a pixel right plus a pixel down
        kAt,
        kRight = kAt + kComponents,
        kDown = kRight + kComponents,
        kFields = kDown + kComponents
    };
    const float* data;
    std::ptrdiff_t stride;
    const float* factor;
    int count;
};

struct WeightParameters {
    float a, b;
    float log = kMostLog;  ///< at least |log(a + dist)|
};

/// A square cell: its centre and half side.
struct CellFrame {
    float x, y, half;
};

/// Interpolation at the roots of T_K, for K = 4, 5, 6 and 8, of a function on [-1, 1] whose second derivative
/// jumps: the error is at most jump_error(K) a unit of the jump, plus third_error(K) a unit of the third
/// derivative on either side. Suprema of Peano's kernel of order 3 and of its integral: tests/core proves
/// them.
constexpr float jump_error(int k) {
    return k == 4 ? 0.0194f : k == 5 ? 0.0132f : k == 6 ? 0.0080f : 0.0044f;
}
constexpr float third_error(int k) {
    return k == 4 ? 0.0165f : k == 5 ? 0.0081f : k == 6 ? 0.0051f : 0.0024f;
}

/// Bounds of lines over a cell: arrays of as many numbers as LineTable has room for.
struct LineBounds {
    float* most;   ///< the greatest weight in the cell
    float* least;  ///< the least weight in the cell
    float* value;  ///< most times the error of the weight in proportion, of its interpolation and by rounding
                   ///< at the nodes; infinite where unknown
    float* linear;   ///< as `value`, of the weight times an offset, times the displacement's change
    float* nearest;  ///< a + dist, the least in the cell
    float* displacement[kComponents];  ///< displacements at the centre
    double center[kSums];              ///< sums at the centre
    double least_sum;
};
/// Finds the bounds of lines over a cell. K: coefficients each way (4, 5, 6 or 8); lebesgue: K's Lebesgue constant.
void bound_lines(const LineTable& lines, const CellFrame& cell, const WeightParameters& weights, int k,
                 float lebesgue, LineBounds& bounds);

/// Sums over lines of their bounds: m the greatest weight, r the greatest distance of the
/// displacement from a reference (the reach), d = a + dist.
struct LineSums {
    double value = 0;       ///< sum of the weights' errors
    double error = 0;       ///< sum of the weighted displacements' errors
    double least = 0;       ///< sum of the least weights
    double most = 0;        ///< sum of m
    double reach = 0;       ///< sum of m r
    double slope = 0;       ///< sum of m times the displacement's change per pixel
    double near = 0;        ///< sum of m / d
    double near_reach = 0;  ///< sum of m r / d
    double farthest = 0;    ///< the greatest r
};
/// The sums that bound the spread of all lines' displacements.
struct SpreadSums {
    double heavy = 0;       ///< the greatest r of lines with m > much
    double light = 0;       ///< sum m r of the others
    double farthest = 0;    ///< the greatest r
    double most = 0;        ///< sum m
    double reach = 0;       ///< sum m r
    double slope = 0;       ///< sum of m times the displacement's change per pixel
    double near_reach = 0;  ///< sum m r / d
};
/// Bounds displacements over a cell.
/// reach[i]: the greatest distance of a line's displacement from `center` (kComponents numbers) in the cell;
/// error[i]: value * (the distance at the cell's centre) + linear + offset * most.
SpreadSums bound_displacements(const LineTable& lines, const CellFrame& cell, const float* center, float much,
                               float offset, const LineBounds& bounds, float* reach, float* error);

/// A division of lines into near and far ones: far are those whose parts, unit * (error + spread * value), are the least
/// and together at most 1.
struct Selection {
    int near = 0, far = 0;  ///< numbers of lines
    LineSums sums;          ///< over the far lines
};
/// Selects the near and the far lines. near, far: their places in the table, with room for 16 more; part: room for as
/// many numbers as LineTable.
Selection select_lines(const LineTable& lines, const LineBounds& bounds, const float* reach,
                       const float* error, float spread, float unit, float* part, std::int32_t* near,
                       std::int32_t* far);

/// Adds the kSums sums over `count` lines at the K x K nodes of a cell: sums[(row * K + column) * 8 + c].
void node_sums(const FieldLine* lines, const std::int32_t* which, int count, const CellFrame& cell,
               const WeightParameters& weights, int k, const float* nodes, double* sums);

/// Computes to = L from R^T for K x K matrices of kSums numbers (8 doubles apart), plus `more` where that is not null.
void transform(const double* left, const double* right, int k, const double* from, const double* more,
               double* to);
/// Computes to = L from R^T for L and R that are 0 below the diagonal.
void shift(const double* left, const double* right, int k, const double* from, double* to);
/// Rounds coefficients to float, and finds the sums of their magnitudes (8 numbers).
void round_coefficients(const double* from, int k, float* to, float* sizes);

/// A cell of near lines and a polynomial in s, t in [-1, 1] (s = (x - cell.x) / cell.half):
/// coefficient of t^n s^m for sum c at coefficients[(n * K + m) * 8 + c]; none with k = 0.
struct FieldCell {
    CellFrame frame;
    int k;
    const float* coefficients;
    const FieldLine* near_lines;  ///< as seen from the origin of `frame`
    int near_count;
    WeightParameters weights;
    bool fine = false;
};
/// The output for source points less the base, of `width` <= 64 pixels of `height` rows from (x, y) on (centres of pixels in
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
