// SPDX-License-Identifier: Apache-2.0
// Surfaces deformed by lists of bumps (deformation.h), on grids and on points of the texture plane.
//
// Displacements are added in fixed point: whole multiples of `resolution` in 64 bits. Whole numbers add
// without rounding, so the surface has the same bits for any order of the list, any history of edits that led
// to it, any number of threads and any cut of a surface into pieces; what was added and taken away again
// leaves no trace. All instruction sets give the same bits.
//
// Errors. A Gaussian is cut off where it is certain to be below `cutoff`: a point whose distance from the
// centre, along u or along v, is more than sqrt(-log(cutoff)) extents is not moved. A contribution is off by
// at most half a resolution and by 16 2^-53 of V, 64 where it has depth or side, and with a frame by 32 (K + 1) more, K the ratio of its
// greatest half axis to its least (deform/deform_kernels.h). error_bound() is the
// sum of all this. Along w a Gaussian is cut off as along u and v.
// Range: a component of V is less than 2^50 resolutions, their magnitudes together less than 2^62.
//
// Surfaces are arrays of points x, y, z without gaps, float or double, rounded once from base + displacement.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "anamorph/deform/deformation.h"
#include "anamorph/error.h"
#include "anamorph/line_vector.h"
#include "anamorph/parallel_for.h"

namespace anamorph {

namespace simd {
struct PointTerm;
struct TermPoints;
}  // namespace simd

/// How exactly displacements are added.
struct DeformOptions {
    double cutoff = kCutoffRow.standard;  ///< share of V below which Gaussians are cut off; 0: none are
    double resolution = 0x1p-40;          ///< step of the displacement: a power of two from 2^-500 to 2^500
};

/// The totals of a list of deformations: the magnitudes of its displacements, and the bound of their error.
class DisplacementSum {
  public:
    /// An empty sum. Throws Error on options out of range.
    explicit DisplacementSum(const DeformOptions& options);

    const DeformOptions& options() const { return m_options; }
    /// The distance from the centre, in extents, at which a kernel is cut off.
    double reach(DeformationKernel kernel) const;
    /// Adds changes of the list to the totals. Throws Error naming the field if they leave the range, and then
    /// changes nothing.
    void apply(std::span<const DeformationChange> changes);
    /// The largest error of a component of the displacement against eq. (4.1).
    double error_bound() const;
    /// A bound of the magnitude of every component of the displacement.
    double most() const;
    /// Do the sums stay where doubles hold them (simd::kMostInDouble), while changes that the totals have are carried out in any order?
    bool stays_in_double(std::span<const DeformationChange> changes = {}) const;

  private:
    struct Totals {
        std::int64_t units[3] = {};     ///< magnitudes of V
        std::int64_t gaussian[3] = {};  ///< magnitudes of V of the Gaussians
        std::int64_t deep[3] = {};      ///< magnitudes of V of those with depth or side
        std::int64_t framed[3] = {};    ///< those of V of those with a frame, times what it errs by
        std::int64_t count = 0;
    };
    void add(Totals& totals, const Deformation& deformation, int sign) const;

    DeformOptions m_options;
    Totals m_totals;
};

/// A part of a grid: columns and rows [begin, end).
struct GridPart {
    int column_begin = 0, row_begin = 0, column_end = 0, row_end = 0;

    bool empty() const { return column_begin >= column_end || row_begin >= row_end; }
    bool operator==(const GridPart&) const = default;
};

/// The derivatives of the displacement at some points of a surface.
struct SurfaceSlopes {
    static constexpr int kMost = 256;  ///< points at once; what is computed with them has as much room

    int count;
    std::int64_t first;          ///< the points are first, first + 1, ...
    const std::int32_t* points;  ///< the numbers of the points, unless null
    /// by[c][k]: derivative of component c at point k by u; by[3 + c][k]: by v; where there are 6 parameters, and so on by the depth
    /// w and by the three coordinates of the normal.
    double (*by)[kMost];
    int parameters = 2;  ///< 2, or 6

    /// The number of the k-th point.
    std::int64_t point(int k) const { return points ? points[k] : first + k; }
    /// The derivative of the displacement by u at the k-th point.
    glm::dvec3 by_u(int k) const { return {by[0][k], by[1][k], by[2][k]}; }
    /// The derivative of the displacement by v at the k-th point.
    glm::dvec3 by_v(int k) const { return {by[3][k], by[4][k], by[5][k]}; }
};
/// A function that receives the derivatives at all points, each point once, a batch at a time, from several threads.
using TakeSlopes = std::function<void(const SurfaceSlopes&)>;

/// Turns normals[c][k], of any length, into the unit normals of the displaced surface at the points of `slopes`:
/// space moves with the Jacobian I + D_u grad(u)^T + D_v grad(v)^T + D_w grad(w)^T. They are 0 where there is no direction.
/// Derivatives by the normal are not read.
void turn_normals(const SurfaceSlopes& slopes, glm::dvec3 gradient_u, glm::dvec3 gradient_v,
                  double (&normals)[3][SurfaceSlopes::kMost], glm::dvec3 gradient_w = glm::dvec3(0.0));

/// Vertex normals of a deformed surface at some points: the sum over the corners of its cells there of the corner's
/// normal times its angle (Thuermer and Wuethrich 1998). Edges of the cells are the undeformed surface's tangents, and
/// become e + D_u du + D_v dv, and so on for each parameter. Sums are in fixed point, so that the order of the corners, up to 2^16 at a point, does
/// not matter.
class CornerSums {
  public:
    /// Keeps a reference to `slopes`.
    explicit CornerSums(const SurfaceSlopes& slopes) : m_slopes(slopes) {}

    /// An edge to a neighbour on the undeformed surface: the differences in space, in the parameters (u, v), and where slopes have
    /// derivatives by them in depth and normal.
    struct Edge {
        glm::dvec3 points;
        glm::dvec2 parameters;
        double depth = 0;
        glm::dvec3 normal{0.0};
    };
    /// Adds a corner at the k-th point, between the edges to the next point of the cell and to the one before.
    void add(int k, const Edge& next, const Edge& previous, bool goes_inwards);
    /// The unit normal at the k-th point, when all corners are added; 0 where there is none.
    glm::dvec3 normal(int k);

  private:
    void carry_out();

    static constexpr int kMost = 128;

    const SurfaceSlopes& m_slopes;
    std::int64_t m_sums[SurfaceSlopes::kMost][3] = {};
    int m_count = 0;
    int m_point[kMost];
    double m_by[18][kMost], m_next[3][kMost], m_previous[3][kMost], m_next_by[6][kMost],
        m_previous_by[6][kMost], m_turns[kMost];
};

/// What bumps with depth or side read of points beside their parameters: one for each point.
struct PointDepths {
    std::vector<double> w;           ///< what is not finite is not moved by bumps with depth
    std::vector<glm::dvec3> normal;  ///< of length 1, or 0: neither side
};

/// A surface over a grid of u (of its columns) and v (of its rows), point (i, j) at j * columns + i. F of a
/// Gaussian is a product of a factor of the column and one of the row.
class DeformedGrid {
  public:
    /// Constructs the grid; u and v may be in any order. Throws Error where one of them is empty or too long or has a value
    /// that is not finite.
    DeformedGrid(std::vector<double> u, std::vector<double> v, const DeformOptions& options = {});

    /// Registers changes of the list, which update() or write() carries out. Throws Error if they leave the range, or a bump has
    /// depth or side, which points of a grid have not.
    void apply(std::span<const DeformationChange> changes);
    /// Registers one change of the list.
    void apply(const DeformationChange& change) { apply(std::span(&change, 1)); }

    /// Writes base + displacement where the changes since the last update() or write() have moved something,
    /// and returns that part; a little around it may be written too. Where `base` is null, `out` gets the
    /// displacement alone. `out` is not `base`. `displacement`, unless null, gets the displacement as well.
    template <class T>
    GridPart update(const T* base, T* out, const ParallelFor& parallel_for = serial_for,
                    T* displacement = nullptr);
    /// Writes all points.
    template <class T>
    void write(const T* base, T* out, const ParallelFor& parallel_for = serial_for,
               T* displacement = nullptr);

    /// Sets offsets that are added to the displacements written from now on: three numbers a point, in double,
    /// which are not copied; null: none, as at first. The caller then has to write all points.
    void set_offsets(const double* offsets) { m_offsets = offsets; }

    /// No component of a displacement is farther from eq. (4.1) than this, offsets aside.
    double error_bound() const { return m_sum.error_bound(); }

    /// Gives `take` the derivatives of a list's displacement at the points that `changes` move, and at a few around
    /// them; at all points if `changes` is null. They are summed in double in a fixed order: the same bits for any
    /// order of the list, and whatever other points there are. A Gaussian that is cut off is missing up to
    /// 2 reach cutoff |V| / a of a derivative.
    void slopes(const std::vector<Deformation>& list, const std::vector<DeformationChange>* changes,
                const TakeSlopes& take, const ParallelFor& parallel_for = serial_for) const;

  private:
    template <class T>
    GridPart draw(bool all, const T* base, T* out, const ParallelFor& parallel_for, T* displacement);

    std::vector<double> m_u, m_v;
    DisplacementSum m_sum;
    std::vector<DeformationChange> m_pending;
    LineVector<std::int64_t> m_sums;  ///< simd::GridBand
    const double* m_offsets = nullptr;
};

/// Writes base + displacement of all points of a grid once, faster than DeformedGrid, which can be edited.
/// The points have the same bits. Returns the error bound (DisplacementSum::error_bound()).
template <class T>
double deform_grid(const std::vector<Deformation>& list, std::span<const double> u, std::span<const double> v,
                   const DeformOptions& options, const T* base, T* out,
                   const ParallelFor& parallel_for = serial_for);

/// A surface over any points of the texture plane. The points are sorted into cells, and a deformation is added in
/// the cells within its cutoff only.
class DeformedPoints {
  public:
    /// A surface of these points (u, v), not deformed yet. Throws Error that names the point on values that are not finite, and on
    /// 2^31 points or more.
    DeformedPoints(std::span<const glm::dvec2> points, const DeformOptions& options = {});
    /// A surface whose points have depths and normals too, as many as points, that bumps with depth or side need; others are then
    /// given with the same bits, and slopes have six parameters. Throws Error also on sizes that do not fit and on normals
    /// that are not finite.
    DeformedPoints(std::span<const glm::dvec2> points, const PointDepths& depths,
                   const DeformOptions& options);

    /// Takes changes of the list; update() or write() carries them out. Throws Error if they are refused.
    void apply(std::span<const DeformationChange> changes);
    /// Registers one change of the list.
    void apply(const DeformationChange& change) { apply(std::span(&change, 1)); }

    /// Writes what changes have moved, as DeformedGrid::update() does; returns the number of points that were written.
    template <class T>
    std::int64_t update(const T* base, T* out, const ParallelFor& parallel_for = serial_for,
                        T* displacement = nullptr);
    /// Writes all points.
    template <class T>
    void write(const T* base, T* out, const ParallelFor& parallel_for = serial_for,
               T* displacement = nullptr);

    /// Writes all points, deformed by a list and by no changes that were taken before, and gives `take` the
    /// derivatives at all points. It gives the same bits as write() and slopes(), and is faster.
    template <class T>
    void write_with_slopes(const std::vector<Deformation>& list, const T* base, T* out,
                           const TakeSlopes& take, const ParallelFor& parallel_for = serial_for,
                           T* displacement = nullptr);

    /// Adds to the displacements that are written from now on, as DeformedGrid::set_offsets() does.
    void set_offsets(const double* offsets) { m_offsets = offsets; }

    /// No component of a displacement is farther from eq. (4.1) than this, offsets aside.
    double error_bound() const { return m_sum.error_bound(); }

    /// Gives `take` the derivatives of the displacement, as DeformedGrid::slopes() does.
    void slopes(const std::vector<Deformation>& list, const std::vector<DeformationChange>* changes,
                const TakeSlopes& take, const ParallelFor& parallel_for = serial_for) const;

  private:
    struct Cell {
        std::size_t begin, end;  ///< slots, multiples of simd::kPointBlock
        glm::dvec2 least, most;  ///< bounds of the parameters of its points
    };
    template <class T>
    std::int64_t draw(bool all, const T* base, T* out, const ParallelFor& parallel_for, T* displacement);
    /// Writes the points of a cell's slots, and returns their number.
    template <class T>
    std::int64_t write_slots(std::size_t begin, std::size_t end, const T* base, T* out,
                             T* displacement) const;
    simd::TermPoints term_points(std::size_t slot) const;
    /// Throws Error on changes that need depths where there are none.
    void check_depth(std::span<const DeformationChange> changes) const;
    /// Calls body(cell, near) for cells with points: for all of them if `all`, else for those within the cutoff of a
    /// term of `visiting`. near: the terms of `terms` within whose cutoff the cell is.
    void each_cell(
        const std::vector<simd::PointTerm>& visiting, bool all, const std::vector<simd::PointTerm>& terms,
        const ParallelFor& parallel_for,
        const std::function<void(const Cell&, const std::vector<const simd::PointTerm*>&)>& body) const;

    DisplacementSum m_sum;
    std::vector<Cell> m_cells;
    std::vector<std::size_t> m_cell_rows;  ///< first cell of each row of cells, and the end
    LineVector<double> m_u, m_v;           ///< by slot; NaN where a slot is empty
    LineVector<double> m_w, m_normal[3];   ///< by slot, where there are depths
    std::vector<std::int32_t> m_point;     ///< by slot; -1 where it is empty
    LineVector<std::int64_t> m_sums[3];    ///< by slot
    std::vector<DeformationChange> m_pending;
    const double* m_offsets = nullptr;
};

/// Finds the displacement and its derivatives at points of the texture plane, summed in double in a fixed order: a
/// point's numbers do not depend on the order of the list nor on the other points. It is fastest where neighbours
/// in `points` are close together. A Gaussian that is cut off is missing up to 2 reach cutoff |V| / a of a
/// derivative. `out` has room for as many as `points`. Throws Error on points that are not finite and on lists out of
/// range or with depths or sides.
void displacement_jets(const std::vector<Deformation>& list, std::span<const glm::dvec2> points,
                       const DeformOptions& options, DisplacementJet* out,
                       const ParallelFor& parallel_for = serial_for);

/// Unit normals of the deformed surface at points of the texture plane, from the kernels' exact derivatives.
/// base_u and base_v: the undeformed surface's derivatives at every point, or one for all (a plane). The order of
/// sums, the cutoff, `out` and errors are those of displacement_jets(). Throws Error also on sizes that do not fit.
void deformed_normals(const std::vector<Deformation>& list, std::span<const glm::dvec2> points,
                      std::span<const glm::dvec3> base_u, std::span<const glm::dvec3> base_v,
                      const DeformOptions& options, glm::dvec3* out,
                      const ParallelFor& parallel_for = serial_for);

}  // namespace anamorph
