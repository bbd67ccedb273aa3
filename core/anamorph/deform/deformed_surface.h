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
// at most half a resolution and by 16 2^-53 of V (deform/deform_kernels.h). error_bound() is the sum of all this.
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
}

/// How exactly displacements are added.
struct DeformOptions {
    double cutoff = kCutoffRow.standard;  ///< of V; 0: nothing is cut off
    double resolution = 0x1p-40;          ///< of the displacement: a power of two from 2^-500 to 2^500
};

/// The sums of what lists add to the surface, in fixed point, with the bound of their error.
class DisplacementSum {
  public:
    /// An empty sum. Throws Error on options out of range.
    explicit DisplacementSum(const DeformOptions& options);

    const DeformOptions& options() const { return m_options; }
    /// The distance from the centre, in extents, at which a kernel is cut off.
    double reach(DeformationKernel kernel) const;
    /// Takes note of changes. Throws Error naming the field if they leave the range, and then changes
    /// nothing.
    void apply(std::span<const DeformationChange> changes);
    /// No component of the displacement is farther than this from eq. (4.1).
    double error_bound() const;
    /// No component of the displacement is larger.
    double most() const;

  private:
    struct Totals {
        std::int64_t units[3] = {};     ///< magnitudes of V
        std::int64_t gaussian[3] = {};  ///< those of Gaussians
        std::int64_t count = 0;
    };
    void add(Totals& totals, const Deformation& deformation, int sign) const;

    DeformOptions m_options;
    Totals m_totals;
};

/// Columns and rows [begin, end).
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
    const std::int32_t* points;  ///< or, unless null, these
    double (*by)[kMost];         ///< by[c][k]: component c at the k-th of them by u, by[3 + c][k] by v

    /// The number of the k-th of the points.
    std::int64_t point(int k) const { return points ? points[k] : first + k; }
    /// The derivative of the displacement by u at the k-th point.
    glm::dvec3 by_u(int k) const { return {by[0][k], by[1][k], by[2][k]}; }
    /// The derivative by v.
    glm::dvec3 by_v(int k) const { return {by[3][k], by[4][k], by[5][k]}; }
};
/// Called with points that belong together, from several threads, with each point once.
using TakeSlopes = std::function<void(const SurfaceSlopes&)>;

/// normals[c][k], of any length, become the unit normals of the displaced surface at the points of `slopes`:
/// space moves with the Jacobian I + D_u grad(u)^T + D_v grad(v)^T. 0 where there is no direction.
void turn_normals(const SurfaceSlopes& slopes, glm::dvec3 gradient_u, glm::dvec3 gradient_v,
                  double (&normals)[3][SurfaceSlopes::kMost]);

/// Sums of what the corners of surface cells have for a normal at some points: each its own normal times its
/// angle (Thuermer and Wuethrich 1998). Edges of the cells are the undeformed surface's tangents, and become
/// e + D_u du + D_v dv. Sums are in fixed point: the order of the corners does not matter, of which there are
/// up to 2^16 at a point.
class CornerSums {
  public:
    /// Keeps a reference to `slopes`.
    explicit CornerSums(const SurfaceSlopes& slopes) : m_slopes(slopes) {}

    /// An edge to a neighbour, undeformed, and its change of parameters.
    struct Edge {
        glm::dvec3 points;
        glm::dvec2 parameters;
    };
    /// A corner at the k-th point, between the edges to the next point of the cell and to the one before.
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
    double m_by[6][kMost], m_next[3][kMost], m_previous[3][kMost], m_next_by[2][kMost],
        m_previous_by[2][kMost], m_turns[kMost];
};

/// A surface over a grid of u (of its columns) and v (of its rows), point (i, j) at j * columns + i. F of a
/// Gaussian is a product of a factor of the column and one of the row.
class DeformedGrid {
  public:
    /// u and v in any order. Throws Error on values that are not finite, on empty or too many ones.
    DeformedGrid(std::vector<double> u, std::vector<double> v, const DeformOptions& options = {});

    /// Takes changes of the list; update() or write() carries them out. Throws Error if they are refused.
    void apply(std::span<const DeformationChange> changes);
    /// Takes one change.
    void apply(const DeformationChange& change) { apply(std::span(&change, 1)); }

    /// Writes base + displacement where the changes since the last update() or write() have moved something,
    /// and returns that part; a little around it may be written too. `base` may be null: the displacement
    /// alone. `out` is not `base`. `displacement`, unless null, gets the displacement beside.
    template <class T>
    GridPart update(const T* base, T* out, const ParallelFor& parallel_for = serial_for,
                    T* displacement = nullptr);
    /// Writes all points.
    template <class T>
    void write(const T* base, T* out, const ParallelFor& parallel_for = serial_for,
               T* displacement = nullptr);

    /// Adds to the displacements that are written from now on: three numbers a point, in double, which are
    /// not copied; null: nothing, as at first. All points are to be written then.
    void set_offsets(const double* offsets) { m_offsets = offsets; }

    /// No component of a displacement is farther from eq. (4.1) than this, offsets aside.
    double error_bound() const { return m_sum.error_bound(); }

    /// Gives `take` the derivatives of the displacement by a list at the points that changes reach, and at a
    /// few around them; at all points if `changes` is null. They are added in double in an order of its own:
    /// the same bits for any order of the list, and whatever other points there are. A Gaussian that is cut
    /// off is missing up to 2 reach cutoff |V| / a of a derivative.
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
/// The same bits. Returns error_bound().
template <class T>
double deform_grid(const std::vector<Deformation>& list, std::span<const double> u, std::span<const double> v,
                   const DeformOptions& options, const T* base, T* out,
                   const ParallelFor& parallel_for = serial_for);

/// A surface over any points of the texture plane. They are sorted into cells; a deformation visits the cells
/// that it reaches.
class DeformedPoints {
  public:
    /// A surface of these points (u, v), not deformed yet. Throws Error that names the point on values that are not finite, and on
    /// 2^31 points or more.
    DeformedPoints(std::span<const glm::dvec2> points, const DeformOptions& options = {});

    /// Takes changes of the list; update() or write() carries them out. Throws Error if they are refused.
    void apply(std::span<const DeformationChange> changes);
    /// Takes one change.
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
    /// derivatives at all points. The same bits as write() and slopes(), and faster.
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
        glm::dvec2 least, most;  ///< of its points
    };
    template <class T>
    std::int64_t draw(bool all, const T* base, T* out, const ParallelFor& parallel_for, T* displacement);
    /// Writes the points of a cell's slots; how many they are.
    template <class T>
    std::int64_t write_slots(std::size_t begin, std::size_t end, const T* base, T* out,
                             T* displacement) const;
    /// Calls body(cell, near) for cells with points, unless `all` only for those that a term of `visiting`
    /// reaches; near: the terms of `terms` that reach it.
    void each_cell(
        const std::vector<simd::PointTerm>& visiting, bool all, const std::vector<simd::PointTerm>& terms,
        const ParallelFor& parallel_for,
        const std::function<void(const Cell&, const std::vector<const simd::PointTerm*>&)>& body) const;

    DisplacementSum m_sum;
    std::vector<Cell> m_cells;
    std::vector<std::size_t> m_cell_rows;  ///< first cell of each row of cells, and the end
    LineVector<double> m_u, m_v;           ///< by slot; NaN where a slot is empty
    std::vector<std::int32_t> m_point;     ///< by slot; -1 where it is empty
    LineVector<std::int64_t> m_sums[3];    ///< by slot
    std::vector<DeformationChange> m_pending;
    const double* m_offsets = nullptr;
};

/// The displacement and its derivatives at points of the texture plane, added in double in an order of its
/// own: a point's numbers do not depend on the order of the list nor on the other points, which are best
/// close together. A cut off Gaussian is missing up to 2 reach cutoff |V| / a of a derivative. out: as many
/// as points. Throws Error on points that are not finite and lists that are refused.
void displacement_jets(const std::vector<Deformation>& list, std::span<const glm::dvec2> points,
                       const DeformOptions& options, DisplacementJet* out,
                       const ParallelFor& parallel_for = serial_for);

/// Unit normals of the deformed surface at points of the texture plane, from the kernels' exact derivatives.
/// base_u and base_v: the undeformed surface's derivatives at every point, or one for all (a plane). As
/// displacement_jets otherwise. Throws Error on sizes that do not fit.
void deformed_normals(const std::vector<Deformation>& list, std::span<const glm::dvec2> points,
                      std::span<const glm::dvec3> base_u, std::span<const glm::dvec3> base_v,
                      const DeformOptions& options, glm::dvec3* out,
                      const ParallelFor& parallel_for = serial_for);

}  // namespace anamorph
