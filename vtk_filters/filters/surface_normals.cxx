// SPDX-License-Identifier: Apache-2.0
#include "surface_normals.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "anamorph/error.h"
#include "vtkAOSDataArrayTemplate.h"
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

glm::dvec3 unit(glm::dvec3 v) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

/// Fixed point for sums of unit vectors times angles up to 2 pi: 2^16 corners at a point.
constexpr double kCornerUnit = 0x1p-44;

/// What the corners of cells at one point add up to.
class CornerSum {
  public:
    CornerSum(const Triples& points, const std::vector<glm::dvec2>& parameters,
              const anamorph::SurfaceSlopes& slopes, int k)
        : m_points(points),
          m_parameters(parameters),
          m_id(slopes.point(k)),
          m_at(points[m_id]),
          m_parameter(parameters[static_cast<std::size_t>(m_id)]),
          m_by_u(slopes.by_u(k)),
          m_by_v(slopes.by_v(k)) {}

    /// The corners that a cell has at the point.
    void add_cell(vtkIdType count, const vtkIdType* cell) {
        for (vtkIdType i = 0; i < count; ++i)
            if (cell[i] == m_id)
                add_corner(neighbour(count, cell, i, 1), neighbour(count, cell, i, count - 1),
                           count > 3 ? area_of(count, cell) : glm::dvec3(0.0));
    }

    glm::dvec3 sum() const { return kCornerUnit * glm::dvec3(m_sum[0], m_sum[1], m_sum[2]); }

  private:
    glm::dvec2 parameter(vtkIdType id) const { return m_parameters[static_cast<std::size_t>(id)]; }

    /// The neighbour of a corner, one way around or the other.
    vtkIdType neighbour(vtkIdType count, const vtkIdType* cell, vtkIdType i, vtkIdType step) const {
        vtkIdType k = (i + step) % count;
        while (k != i && !is_finite(parameter(cell[k]))) k = (k + step) % count;
        return cell[k];
    }

    /// Twice the area of a polygon along its normal, undeformed.
    glm::dvec3 area_of(vtkIdType count, const vtkIdType* cell) const {
        const glm::dvec3 first = m_points[cell[0]];
        glm::dvec3 area(0.0), edge = m_points[cell[1]] - first;
        for (vtkIdType i = 2; i < count; ++i) {
            const glm::dvec3 next = m_points[cell[i]] - first;
            area += glm::cross(edge, next);
            edge = next;
        }
        return area;
    }

    /// area: of the polygon, undeformed, if its corner may go inwards.
    void add_corner(vtkIdType next, vtkIdType previous, const glm::dvec3& area) {
        const glm::dvec3 to_next = m_points[next] - m_at, to_previous = m_points[previous] - m_at;
        const auto edge = [&](vtkIdType to, const glm::dvec3& undeformed) {
            const glm::dvec2 ds = parameter(to) - m_parameter;
            return unit(undeformed + ds.x * m_by_u + ds.y * m_by_v);
        };
        const glm::dvec3 a = edge(next, to_next), b = edge(previous, to_previous), across = glm::cross(a, b);
        const double sine = glm::length(across);
        if (!(sine > 0)) return;
        double angle = std::atan2(sine, glm::dot(a, b));
        // A corner that goes inwards: the polygon has the rest of the turn, on the other side.
        if (glm::dot(glm::cross(to_next, to_previous), area) < 0) angle -= 2 * std::numbers::pi;
        const glm::dvec3 weighted = across * (angle / sine);
        for (int c = 0; c < 3; ++c) m_sum[c] += std::llround(weighted[c] / kCornerUnit);
    }

    const Triples& m_points;
    const std::vector<glm::dvec2>& m_parameters;
    std::int64_t m_id;
    glm::dvec3 m_at;
    glm::dvec2 m_parameter;
    glm::dvec3 m_by_u, m_by_v;
    std::int64_t m_sum[3] = {};
};

}  // namespace

Triples::Triples(vtkDataArray* array) : m_array(array) {
    if (auto* floats = vtkAOSDataArrayTemplate<float>::FastDownCast(array)) m_floats = floats->GetPointer(0);
    if (auto* doubles = vtkAOSDataArrayTemplate<double>::FastDownCast(array))
        m_doubles = doubles->GetPointer(0);
}

glm::dvec3 Triples::operator[](std::int64_t i) const {
    if (m_floats) return {m_floats[3 * i], m_floats[3 * i + 1], m_floats[3 * i + 2]};
    if (m_doubles) return {m_doubles[3 * i], m_doubles[3 * i + 1], m_doubles[3 * i + 2]};
    double tuple[3];
    m_array->GetTuple(i, tuple);
    return {tuple[0], tuple[1], tuple[2]};
}

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

SurfaceNormals::SurfaceNormals(vtkPointSet* mesh, const std::vector<glm::dvec2>& parameters,
                               const anamorph::ParameterPlane* plane, vtkDataArray* normals)
    : m_points(mesh->GetPoints()->GetData()),
      m_normals(normals),
      m_parameters(parameters),
      m_on_plane(plane != nullptr) {
    if (plane) m_plane = *plane;
    m_exact = plane && normals;
    if (m_exact) return;
    m_mesh = vtkSmartPointer<vtkPointSet>::Take(mesh->NewInstance());
    m_mesh->CopyStructure(mesh);
    m_ghosts = ghosts_of(mesh);
    link_cells();
}

void SurfaceNormals::link_cells() {
    const vtkIdType cells = m_mesh->GetNumberOfCells();
    m_first.assign(m_parameters.size() + 1, 0);
    if (cells == 0) return;
    if (cells > std::numeric_limits<std::uint32_t>::max())
        throw anamorph::Error("the mesh has " + std::to_string(cells) +
                              " cells, allowed are fewer than 2^32");
    m_mesh->GetCellType(0);  // builds what is built on demand, on this thread
    CellReader reader;
    const auto each_point = [&](const auto& body) {
        for (vtkIdType id = 0; id < cells; ++id) {
            if (hidden(m_ghosts, id)) continue;
            read_cell(m_mesh, id, reader, [&](vtkIdType count, const vtkIdType* points) {
                for (vtkIdType i = 0; i < count; ++i) body(static_cast<std::size_t>(points[i]), id);
            });
        }
    };
    each_point([&](std::size_t point, vtkIdType) { ++m_first[point]; });
    std::inclusive_scan(m_first.begin(), m_first.end(), m_first.begin());
    m_cells.resize(static_cast<std::size_t>(m_first.back()));
    // Backwards into what was counted: m_first[i] then is where point i begins.
    each_point([&](std::size_t point, vtkIdType id) {
        m_cells[static_cast<std::size_t>(--m_first[point])] = static_cast<std::uint32_t>(id);
    });
}

void SurfaceNormals::turn(const anamorph::SurfaceSlopes& slopes, Normals& to) const {
    for (int k = 0; k < slopes.count; ++k) {
        const glm::dvec3 n = m_normals[slopes.point(k)];
        for (int c = 0; c < 3; ++c) to[c][k] = n[c];
    }
    anamorph::turn_normals(slopes, m_plane.gradient_u(), m_plane.gradient_v(), to);
}

void SurfaceNormals::add_corners(const anamorph::SurfaceSlopes& slopes, Normals& to) const {
    CellReader reader;
    for (int k = 0; k < slopes.count; ++k) {
        CornerSum corners(m_points, m_parameters, slopes, k);
        const auto id = static_cast<std::size_t>(slopes.point(k));
        std::uint32_t last = 0;
        for (std::int64_t i = m_first[id]; i < m_first[id + 1]; ++i) {
            const std::uint32_t cell = m_cells[static_cast<std::size_t>(i)];
            // A cell that comes to the point twice stands there twice.
            if (i > m_first[id] && cell == last) continue;
            last = cell;
            read_cell(m_mesh, cell, reader,
                      [&](vtkIdType count, const vtkIdType* around) { corners.add_cell(count, around); });
        }
        glm::dvec3 normal = unit(corners.sum());
        if (normal == glm::dvec3(0.0) && m_on_plane)
            normal = anamorph::normal_of({glm::dvec3(0.0), slopes.by_u(k), slopes.by_v(k)}, m_plane.axis_u(),
                                         m_plane.axis_v());
        for (int c = 0; c < 3; ++c) to[c][k] = normal[c];
    }
}

template <class T>
void SurfaceNormals::write(const anamorph::SurfaceSlopes& slopes, T* out) const {
    Normals normals = {};
    if (m_exact)
        turn(slopes, normals);
    else
        add_corners(slopes, normals);
    for (int k = 0; k < slopes.count; ++k)
        for (int c = 0; c < 3; ++c) out[3 * slopes.point(k) + c] = static_cast<T>(normals[c][k]);
}

template void SurfaceNormals::write(const anamorph::SurfaceSlopes&, float*) const;
template void SurfaceNormals::write(const anamorph::SurfaceSlopes&, double*) const;

}  // namespace anamorph_vtk
