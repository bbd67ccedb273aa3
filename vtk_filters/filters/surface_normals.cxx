// SPDX-License-Identifier: Apache-2.0
#include "surface_normals.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <string>

#include "anamorph/error.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataSetAttributes.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkUnsignedCharArray.h"

namespace anamorph_vtk {
namespace {

using anamorph::DisplacementJet;

/// What a thread needs to read cells.
struct CellReader {
    vtkNew<vtkIdList> points;
    vtkNew<vtkGenericCell> cell;
    vtkNew<vtkIdList> triangles;
    vtkNew<vtkPoints> coordinates;
};

template <class Body>
void read_cell(vtkPointSet* mesh, vtkIdType id, CellReader& reader, const Body& body) {
    const int type = mesh->GetCellType(id);
    switch (type) {
        case VTK_TRIANGLE:
        case VTK_QUAD:
        case VTK_POLYGON:
            mesh->GetCellPoints(id, reader.points);
            body(reader.points->GetNumberOfIds(), reader.points->GetPointer(0));
            return;
        case VTK_PIXEL: {
            mesh->GetCellPoints(id, reader.points);
            const vtkIdType* p = reader.points->GetPointer(0);
            const vtkIdType around[4] = {p[0], p[1], p[3], p[2]};
            body(4, around);
            return;
        }
        case VTK_TRIANGLE_STRIP: {
            mesh->GetCellPoints(id, reader.points);
            const vtkIdType* p = reader.points->GetPointer(0);
            for (vtkIdType i = 0; i + 2 < reader.points->GetNumberOfIds(); ++i) {
                const vtkIdType triangle[3] = {p[i], p[i + 1 + i % 2], p[i + 2 - i % 2]};
                body(3, triangle);
            }
            return;
        }
        case VTK_EMPTY_CELL:
        case VTK_VERTEX:
        case VTK_POLY_VERTEX:
        case VTK_LINE:
        case VTK_POLY_LINE:
            return;
        default: {
            mesh->GetCell(id, reader.cell);
            if (reader.cell->GetCellDimension() != 2) return;
            reader.cell->Triangulate(0, reader.triangles, reader.coordinates);
            for (vtkIdType i = 0; i + 2 < reader.triangles->GetNumberOfIds(); i += 3)
                body(3, reader.triangles->GetPointer(i));
        }
    }
}

bool hidden(vtkUnsignedCharArray* ghosts, vtkIdType cell) {
    return ghosts && (ghosts->GetValue(cell) & vtkDataSetAttributes::HIDDENCELL) != 0;
}

/// The marks of ghost cells, one for each cell; null where there are none.
vtkUnsignedCharArray* ghosts_of(vtkPointSet* mesh) {
    vtkUnsignedCharArray* ghosts = mesh->GetCellGhostArray();
    if (ghosts && ghosts->GetNumberOfTuples() != mesh->GetNumberOfCells())
        throw anamorph::Error(std::string("the array ") + ghosts->GetName() + " of the cells has " +
                              std::to_string(ghosts->GetNumberOfTuples()) + " tuples, needed are " +
                              std::to_string(mesh->GetNumberOfCells()));
    return ghosts;
}

glm::dvec3 point_of(vtkPointSet* mesh, vtkIdType id) {
    double p[3];
    mesh->GetPoints()->GetPoint(id, p);
    return {p[0], p[1], p[2]};
}

glm::dvec3 unit(glm::dvec3 v) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

/// n after the Jacobian I + by_u grad_u^T + by_v grad_v^T.
glm::dvec3 moved_normal(glm::dvec3 n, const anamorph::ParameterPlane& plane, const DisplacementJet& jet) {
    n = unit(n);
    // Two tangents with a x b = n.
    const glm::dvec3 other = std::fabs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 a = unit(glm::cross(other, n)), b = glm::cross(n, a);
    const auto moved = [&](glm::dvec3 t) {
        return t + glm::dot(plane.gradient_u(), t) * jet.by_u + glm::dot(plane.gradient_v(), t) * jet.by_v;
    };
    return unit(glm::cross(moved(a), moved(b)));
}

/// Fixed point for sums of unit vectors times angles up to 2 pi: 2^16 corners at a point.
constexpr double kCornerUnit = 0x1p-44;

/// The corners of cells at some points.
class CornerSums {
  public:
    CornerSums(const NormalsOf& of, const std::vector<vtkIdType>& points,
               const std::vector<DisplacementJet>& jets)
        : m_of(of),
          m_jets(jets),
          m_slot(static_cast<std::size_t>(of.mesh->GetNumberOfPoints()), -1),
          m_sums(points.size()) {
        for (std::size_t k = 0; k < points.size(); ++k)
            m_slot[static_cast<std::size_t>(points[k])] = static_cast<std::int64_t>(k);
    }

    void add_cell(vtkIdType count, const vtkIdType* points) {
        // The neighbour of a corner, one way around or the other.
        const auto neighbour = [&](vtkIdType i, vtkIdType step) {
            vtkIdType k = (i + step) % count;
            while (k != i && !is_finite((*m_of.parameters)[static_cast<std::size_t>(points[k])]))
                k = (k + step) % count;
            return points[k];
        };
        const glm::dvec3 area = count > 3 ? area_of(count, points) : glm::dvec3(0.0);
        for (vtkIdType i = 0; i < count; ++i) {
            const std::int64_t slot = m_slot[static_cast<std::size_t>(points[i])];
            if (slot >= 0)
                add_corner(static_cast<std::size_t>(slot), points[i], neighbour(i, 1),
                           neighbour(i, count - 1), area);
        }
    }

    glm::dvec3 sum(std::size_t k) const {
        return kCornerUnit * glm::dvec3(m_sums[k][0], m_sums[k][1], m_sums[k][2]);
    }

  private:
    /// Twice the area of a polygon along its normal, undeformed.
    glm::dvec3 area_of(vtkIdType count, const vtkIdType* points) const {
        const glm::dvec3 first = point_of(m_of.mesh, points[0]);
        glm::dvec3 area(0.0), edge = point_of(m_of.mesh, points[1]) - first;
        for (vtkIdType i = 2; i < count; ++i) {
            const glm::dvec3 next = point_of(m_of.mesh, points[i]) - first;
            area += glm::cross(edge, next);
            edge = next;
        }
        return area;
    }

    /// area: of the polygon, undeformed, if its corner may go inwards.
    void add_corner(std::size_t slot, vtkIdType at, vtkIdType next, vtkIdType previous,
                    const glm::dvec3& area) {
        const DisplacementJet& jet = m_jets[slot];
        const glm::dvec3 p = point_of(m_of.mesh, at);
        const glm::dvec2 s = (*m_of.parameters)[static_cast<std::size_t>(at)];
        const glm::dvec3 to_next = point_of(m_of.mesh, next) - p,
                         to_previous = point_of(m_of.mesh, previous) - p;
        const auto edge = [&](vtkIdType to, const glm::dvec3& undeformed) {
            const glm::dvec2 ds = (*m_of.parameters)[static_cast<std::size_t>(to)] - s;
            return unit(undeformed + ds.x * jet.by_u + ds.y * jet.by_v);
        };
        const glm::dvec3 a = edge(next, to_next), b = edge(previous, to_previous), across = glm::cross(a, b);
        const double sine = glm::length(across);
        if (!(sine > 0)) return;
        double angle = std::atan2(sine, glm::dot(a, b));
        // A corner that goes inwards: the polygon has the rest of the turn, on the other side.
        if (glm::dot(glm::cross(to_next, to_previous), area) < 0) angle -= 2 * std::numbers::pi;
        const glm::dvec3 weighted = across * (angle / sine);
        for (int c = 0; c < 3; ++c)
            std::atomic_ref<std::int64_t>(m_sums[slot][static_cast<std::size_t>(c)])
                .fetch_add(std::llround(weighted[c] / kCornerUnit), std::memory_order_relaxed);
    }

    const NormalsOf& m_of;
    const std::vector<DisplacementJet>& m_jets;
    std::vector<std::int64_t> m_slot;  ///< of a point in `points`, or -1
    std::vector<std::array<std::int64_t, 3>> m_sums;
};

constexpr std::int64_t kChunk = 4096;

std::int64_t chunks_of(std::int64_t count) {
    return (count + kChunk - 1) / kChunk;
}

}  // namespace

bool is_finite(glm::dvec2 parameters) {
    return std::isfinite(parameters.x) && std::isfinite(parameters.y);
}

std::vector<glm::dvec2> with_finite_parameters(std::vector<glm::dvec2> parameters) {
    const auto good = std::find_if(parameters.begin(), parameters.end(), is_finite);
    const glm::dvec2 other = good == parameters.end() ? glm::dvec2(0.0) : *good;
    std::replace_if(parameters.begin(), parameters.end(), std::not_fn(is_finite), other);
    return parameters;
}

void for_each_surface_cell(vtkPointSet* mesh,
                           const std::function<void(vtkIdType count, const vtkIdType* points)>& body) {
    CellReader reader;
    vtkUnsignedCharArray* ghosts = ghosts_of(mesh);
    for (vtkIdType id = 0; id < mesh->GetNumberOfCells(); ++id)
        if (!hidden(ghosts, id)) read_cell(mesh, id, reader, body);
}

template <class T>
void write_normals(const NormalsOf& of, const std::vector<vtkIdType>& points, T* out,
                   const anamorph::ParallelFor& parallel_for) {
    if (points.empty()) return;
    std::vector<glm::dvec2> parameters(points.size());
    for (std::size_t k = 0; k < points.size(); ++k)
        parameters[k] = (*of.parameters)[static_cast<std::size_t>(points[k])];
    parameters = with_finite_parameters(std::move(parameters));
    std::vector<DisplacementJet> jets(points.size());
    anamorph::displacement_jets(*of.list, parameters, of.options, jets.data(), parallel_for);

    const bool exact = of.plane && of.normals;
    CornerSums corners(of, exact ? std::vector<vtkIdType>() : points, jets);
    if (const vtkIdType cells = exact ? 0 : of.mesh->GetNumberOfCells(); cells > 0) {
        of.mesh->GetCellType(0);  // builds what is built on demand, on this thread
        vtkNew<vtkIdList> first;
        of.mesh->GetCellPoints(0, first);
        vtkUnsignedCharArray* ghosts = ghosts_of(of.mesh);
        parallel_for(chunks_of(cells), [&](std::int64_t chunk) {
            CellReader reader;
            for (vtkIdType id = chunk * kChunk; id < std::min<vtkIdType>((chunk + 1) * kChunk, cells); ++id)
                if (!hidden(ghosts, id))
                    read_cell(of.mesh, id, reader, [&](vtkIdType count, const vtkIdType* around) {
                        corners.add_cell(count, around);
                    });
        });
    }

    const auto normal_at = [&](std::size_t k) {
        if (exact) {
            double n[3];
            of.normals->GetTuple(points[k], n);
            return moved_normal({n[0], n[1], n[2]}, *of.plane, jets[k]);
        }
        const glm::dvec3 sum = unit(corners.sum(k));
        if (sum != glm::dvec3(0.0) || !of.plane) return sum;
        return normal_of(jets[k], of.plane->axis_u(), of.plane->axis_v());
    };
    const auto count = static_cast<std::int64_t>(points.size());
    parallel_for(chunks_of(count), [&](std::int64_t chunk) {
        for (std::int64_t i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, count); ++i) {
            const auto k = static_cast<std::size_t>(i);
            const glm::dvec3 normal = normal_at(k);
            for (int c = 0; c < 3; ++c) out[3 * points[k] + c] = static_cast<T>(normal[c]);
        }
    });
}

template void write_normals(const NormalsOf&, const std::vector<vtkIdType>&, float*,
                            const anamorph::ParallelFor&);
template void write_normals(const NormalsOf&, const std::vector<vtkIdType>&, double*,
                            const anamorph::ParallelFor&);

}  // namespace anamorph_vtk
