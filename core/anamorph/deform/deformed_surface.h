// SPDX-License-Identifier: Apache-2.0
// Surfaces deformed by lists of bumps (deformation.h), on grids and on points of the texture plane.
//
// Displacements are added in fixed point: whole multiples of `resolution` in 64 bits. Whole numbers add
// without rounding, so the surface has the same bits for any order of the list, any history of edits that led
// to it, any number of threads and any cut of a surface into pieces; what was added and taken away again
// leaves no trace. On another instruction set a contribution may differ in its last place.
//
// Errors. A Gaussian is cut off where it is certain to be below `cutoff`: a point whose distance from the
// centre, along u or along v, is more than sqrt(-log(cutoff)) extents is not moved. A contribution is off by
// at most half a resolution and by 16 2^-53 of V (simd/deform.h). error_bound() is the sum of all this.
// Range: a component of V is less than 2^50 resolutions, their magnitudes together less than 2^62.
//
// Surfaces are arrays of points x, y, z without gaps, float or double, rounded once from base + displacement.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "anamorph/deform/deformation.h"
#include "anamorph/error.h"

namespace anamorph {

struct DeformOptions {
    double cutoff = 1e-7;         ///< of V, from 0 (nothing is cut off) to 0.5
    double resolution = 0x1p-40;  ///< of the displacement: a power of two from 2^-500 to 2^500
};

/// What lists amount to: the promises of fixed point, kept in whole numbers.
class DisplacementSum {
  public:
    /// Throws Error on options out of range.
    explicit DisplacementSum(const DeformOptions& options);

    const DeformOptions& options() const { return m_options; }
    /// In extents: where a kernel is cut off.
    double reach(DeformationKernel kernel) const;
    /// Takes note of changes. Throws Error naming the field if they leave the range, and then changes
    /// nothing.
    void apply(std::span<const DeformationChange> changes);
    /// No component of the displacement is farther than this from eq. (4.1).
    double error_bound() const;

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

/// A surface over a grid of u (of its columns) and v (of its rows), point (i, j) at j * columns + i. F of a
/// Gaussian is a product of a factor of the column and one of the row.
class DeformedGrid {
  public:
    /// u and v in any order. Throws Error on values that are not finite, on empty or too many ones.
    DeformedGrid(std::vector<double> u, std::vector<double> v, const DeformOptions& options = {});

    /// Takes changes of the list; update() or write() carries them out. Throws Error if they are refused.
    void apply(std::span<const DeformationChange> changes);
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

    double error_bound() const { return m_sum.error_bound(); }

  private:
    template <class T>
    GridPart draw(bool all, const T* base, T* out, const ParallelFor& parallel_for, T* displacement);

    std::vector<double> m_u, m_v;
    DisplacementSum m_sum;
    std::vector<DeformationChange> m_pending;
    std::vector<std::int64_t> m_sums;  ///< simd::GridBand
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
    /// Throws Error that names the point on values that are not finite, and on 2^31 points or more.
    DeformedPoints(std::span<const glm::dvec2> points, const DeformOptions& options = {});

    void apply(std::span<const DeformationChange> changes);
    void apply(const DeformationChange& change) { apply(std::span(&change, 1)); }

    /// As in DeformedGrid. Returns the number of points that were written.
    template <class T>
    std::int64_t update(const T* base, T* out, const ParallelFor& parallel_for = serial_for,
                        T* displacement = nullptr);
    template <class T>
    void write(const T* base, T* out, const ParallelFor& parallel_for = serial_for,
               T* displacement = nullptr);

    double error_bound() const { return m_sum.error_bound(); }

  private:
    struct Cell {
        std::size_t begin, end;  ///< slots, multiples of simd::kPointBlock
        glm::dvec2 least, most;  ///< of its points
    };
    template <class T>
    std::int64_t draw(bool all, const T* base, T* out, const ParallelFor& parallel_for, T* displacement);

    DisplacementSum m_sum;
    std::vector<Cell> m_cells;
    std::vector<std::size_t> m_cell_rows;  ///< first cell of each row of cells, and the end
    std::vector<double> m_u, m_v;          ///< by slot; NaN where a slot is empty
    std::vector<std::int32_t> m_point;     ///< by slot; -1 where it is empty
    std::vector<std::int64_t> m_sums[3];   ///< by slot
    std::vector<DeformationChange> m_pending;
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
