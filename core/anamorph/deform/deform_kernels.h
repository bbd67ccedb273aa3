// SPDX-License-Identifier: Apache-2.0
// Hot loops of deformed surfaces (deform/deformed_surface.h) and of inbetweening (deform/inbetween.h),
// compiled for every instruction set Highway knows.
//
// Displacements are added as whole numbers of a resolution, a power of two: V F / resolution is rounded to
// the nearest whole number, so adding a term and adding it with V of the other sign cancel to
// the bit, and order does not matter. Each component of V / resolution is less than kMostUnits, and so is
// what is added at once. Contributions err by half a unit, and relatively by kKernelError 2^-53.
//
// What is rounded is the exact product of a weight w, V / resolution and perhaps a factor of F, and of a share f < 2, the rest of F, of
// which the last bit is 1 where it is not 0. The product never lies in the middle of two whole numbers: as w < 2^50 is a multiple of
// some power of two up to 2^49 and of no greater one, and f of one up to 2^-52, w f is a multiple of 2^-3 at most, and not of
// twice that. So where a sum of whole numbers is below twice kMostInDouble, it does not matter whether a product is rounded before it is added to
// the sum or as the sum with it is, once: a sum that stands next to 3 * 2^51, where doubles are the whole numbers, takes one fused
// multiplication and addition.
#pragma once

#include <cstddef>
#include <cstdint>

namespace anamorph::simd {

/// The largest magnitude that is rounded by adding 1.5 * 2^52.
inline constexpr double kMostUnits = 0x1p50;
/// Sums up to twice this magnitude are whole numbers where doubles next to 1.5 * 2^52 are: what was there, and what is added.
inline constexpr double kMostInDouble = 0x1p50;
/// The error of a kernel's value, in units of 2^-53: the distance over the extent errs by 2.5, times the
/// kernel's greatest change with it, 2 t^2 e^(-t^2) <= 0.74, each way; exponential functions err by 4, the
/// weight by 1, and the last bit of the share makes 2. Wendland's kernel: deep ones below, r off by 3.5, and 2 for the last bit.
inline constexpr double kKernelError = 16;
/// The same of a bump with depth or side. Three ways: 2.5 * 0.74 each, and 12 for exponential functions, products and the last bit; Wendland's
/// kernel changes by |r F'(r)| = 20 r^2 (1 - r)^3 <= 0.7 where r errs by 4.5, and its polynomial errs by 10. S errs by 3, its
/// greatest slope, times 9 units of n . V / |V| (its direction errs by 3, of each product one, and two sums), and by 6 of its own.
inline constexpr double kDeepError = 64;
/// What is added to that for a bump with a frame, times the ratio K of its greatest half axis to its least. Each number of R errs by 9 (turn_of),
/// p - c by one, products and sums by 3: x_k errs by 13 |p - c|_1 / a_k, where |p - c|_1 <= 3^(1/2) |p - c| and |p - c| <= a_max r,
/// and by 2.5 of itself. So x errs by at most 3^(1/2) (22.6 K + 2.5) r, and F by |r F'(r)| <= 0.74 times that: 29 K + 3.3.
inline constexpr double kFrameError = 32;

inline constexpr int kGridBlock = 32;  ///< columns that are culled together; tables are padded to it
inline constexpr int kGridRows = 2;    ///< rows drawn together; rows of sums are padded to it
inline constexpr int kPointBlock = 8;  ///< points handled together; cells of points are padded to it

/// One direction of a kernel: what it makes of t = (x - center) inverse_extent. A Gaussian's factor is
/// exp(-t^2), and 0 where |t| > reach; otherwise it is t^2, beyond 1 perhaps a smaller number above 1.
struct AxisKernel {
    double center, inverse_extent, reach;
    bool gaussian;
    bool shares = false;  ///< are Gaussians' factors, without slopes, the shares of products (above)?
};
/// out[i] = the factor at x[i], slope[i] = its derivative by x, unless slope is null. count: any.
void axis_factors(const AxisKernel& kernel, const double* x, int count, double* out, double* slope);

/// A deformation over a grid. Gaussian: F = column[i] row[j]; otherwise F is Wendland's function of
/// r^2 = column[i] + row[j].
struct GridTerm {
    const double*
        column;  ///< values for columns [column_begin, column_end), multiples of kGridBlock; Gaussians': shares
    const double* row;  ///< values for rows [row_begin, row_end), multiples of kGridRows
    int column_begin, column_end, row_begin, row_end;
    double units[3];  ///< V / resolution
    bool gaussian;
};

/// The position at which the sums of row `row`, a multiple of kGridRows, begin. From there on follow, for
/// every kGridBlock columns, those of x, y and z of the first row, then those of the next.
constexpr std::ptrdiff_t grid_sums(int row, int columns) {
    const std::ptrdiff_t blocks = (std::ptrdiff_t{columns} + kGridBlock - 1) / kGridBlock;
    return std::ptrdiff_t{3} * row * blocks * kGridBlock;
}

/// Rows of a grid. Without sums (null) they start at zero and are not kept. out = base + displacement, three
/// numbers a point without gaps, rows of `columns` points; without base (null): the displacement alone. It is
/// sums * resolution, plus the offset unless that is null, rounded once.
template <class T>
struct GridBand {
    const GridTerm* terms;
    std::size_t count;
    int row_begin, row_end;  ///< row_begin is a multiple of kGridRows
    int columns;
    std::int64_t* sums;
    double resolution;
    const double* offset;  ///< laid out as base is
    const T* base;
    T* out;       ///< null: sums only
    bool all;     ///< write blocks too that no term reaches
    bool stream;  ///< write past the caches: for surfaces larger than these
    bool
        in_double;  ///< is what is added up to kMostInDouble in all? Sums that are beyond it before are looked for.
};
void deform_band(const GridBand<float>& band);
void deform_band(const GridBand<double>& band);

/// A deformation at single points: F counts where |u - center| inverse_extent <= reach, each way.
struct PointTerm {
    double center[2], inverse_extent[2];
    double reach;
    double vector[3];
    double units[3];  ///< V / resolution
    bool gaussian;
    bool has_depth = false, has_side = false;
    double center_w = 0, inverse_extent_w = 0;  ///< where has_depth
    double direction[3] = {};                   ///< side_direction() where has_side
    bool has_frame = false;
    double turn[3][3] = {};  ///< R where has_frame; the inverse extents are then along its columns
    double box[2] = {};      ///< 1 / how far r = 1 reaches along u and v, where has_frame
};
/// Points: their parameters, and where terms have depth or side their depths w, which may be infinite, and unit normals; w is null
/// where no term has either.
struct TermPoints {
    const double *u, *v, *w = nullptr;
    const double* normal[3] = {};
};
/// The derivatives that terms with depth or side have: by u, v, w and the three coordinates of the normal, three components each.
inline constexpr int kPlainSlopes = 6, kDeepSlopes = 18;

/// Adds terms to sums[c][i] of points. count: a multiple of kPointBlock; NaN points get nothing. in_double: as in GridBand.
void deform_points(const PointTerm* const* terms, std::size_t term_count, const TermPoints& points,
                   std::size_t count, std::int64_t* const sums[3], bool in_double);
/// Adds V dF/du to slopes[0], slopes[1] and slopes[2], V dF/dv to slopes[3], slopes[4] and slopes[5], and so on where points have w
/// (kDeepSlopes), term after term; all instruction sets give the same bits.
void add_point_slopes(const PointTerm* const* terms, std::size_t term_count, const TermPoints& points,
                      std::size_t count, double* const* slopes);
/// Does what deform_points() and add_point_slopes() do, with the same bits.
void deform_points_with_slopes(const PointTerm* const* terms, std::size_t term_count,
                               const TermPoints& points, std::size_t count, std::int64_t* const sums[3],
                               double* const* slopes, bool in_double);

/// A deformation over a stretch of one row of a grid, with the derivatives of its factors (axis_factors).
struct RowTerm {
    const double *column, *column_slope;  ///< for the stretch's points
    double row, row_slope;
    double vector[3];
    bool gaussian;
};
/// Adds to slopes as add_point_slopes does, with the same bits. count: a multiple of kPointBlock.
void add_row_slopes(const RowTerm* terms, std::size_t term_count, std::size_t count, double* const slopes[6]);

/// Unit normals: normals[c][i], of any length, become those of the surface that is displaced with the
/// derivatives slopes[0..2][i] by u and slopes[3..5][i] by v, and by w if `by_depth` (turned_normal). gradients: of
/// u, v and w. What has no direction becomes 0. count: a multiple of kPointBlock.
void turn_normals(const double* const* slopes, bool by_depth, const double (&gradients)[3][3],
                  std::size_t count, double* const normals[3]);

/// Corners of cells of a surface, displaced: an edge e becomes e + D_u du + D_v dv, and so on for each parameter.
struct CornerEdges {
    int parameters;                             ///< 2, or 6 with the depth and the normal
    const double* by[kDeepSlopes];              ///< D_u and D_v (and so on) at the corner
    const double *next[3], *previous[3];        ///< the edges to the neighbours
    const double *next_by[6], *previous_by[6];  ///< their changes of the parameters
    const double* turns;  ///< 0, or 2 pi for corners that go inwards: it is taken from the angle
};
/// out[c][i] = the normal of a corner times its angle (corner_normal), in whole multiples of `unit`; 0 where
/// an edge has no direction. count: a multiple of kPointBlock.
void corner_normals(const CornerEdges& corners, double unit, std::size_t count, double* const out[3]);

/// out[i] = sum_k weights[k] shapes[k][i], added in double in the order of the shapes and rounded once. Errs
/// by half a unit in the last place of the result, plus (shape_count + 1) 2^-53 of the sum of the magnitudes.
void blend(const float* const* shapes, const double* weights, std::size_t shape_count, std::size_t count,
           float* out);
void blend(const double* const* shapes, const double* weights, std::size_t shape_count, std::size_t count,
           double* out);
/// out[i] = base[i] + sum_k weights[k] masks[k][i] (shapes[k][i] - base[i]), with 1 for a mask that is null.
/// Errs as blend() does, with shape_count + 4.
void blend_masked(const float* const* shapes, const float* const* masks, const double* weights,
                  std::size_t shape_count, const float* base, std::size_t count, float* out);
void blend_masked(const double* const* shapes, const float* const* masks, const double* weights,
                  std::size_t shape_count, const double* base, std::size_t count, double* out);

}  // namespace anamorph::simd
