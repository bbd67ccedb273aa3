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
#include "cell_corners.h"
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
                              std::to_string(ghosts->GetNumberOfTuples()) + " tuples, but must have " +
                              std::to_string(mesh->GetNumberOfCells()));
    return ghosts;
}

/// What the corners of cells need of the undeformed mesh.
class Cells {
  public:
    Cells(const Triples& points, const std::vector<glm::dvec2>& parameters,
          const anamorph::PointDepths* depths)
        : m_points(points), m_parameters(parameters), m_depths(depths) {}

    /// The corners that a cell has at a point, which is the k-th of the sums.
    void add_corners(vtkIdType count, const vtkIdType* cell, std::int64_t point, int k,
                     anamorph::CornerSums& sums) const {
        for (vtkIdType i = 0; i < count; ++i) {
            if (cell[i] != point) continue;
            const anamorph::CornerSums::Edge next = edge(point, neighbour(count, cell, i, 1)),
                                             previous = edge(point, neighbour(count, cell, i, count - 1));
            // A corner that goes inwards: the polygon has the rest of the turn, on the other side.
            const bool goes_inwards =
                count > 3 && glm::dot(glm::cross(next.points, previous.points), area_of(count, cell)) < 0;
            sums.add(k, next, previous, goes_inwards);
        }
    }

  private:
    glm::dvec2 parameter(vtkIdType id) const { return m_parameters[static_cast<std::size_t>(id)]; }

    anamorph::CornerSums::Edge edge(vtkIdType from, vtkIdType to) const {
        anamorph::CornerSums::Edge edge{m_points[to] - m_points[from], parameter(to) - parameter(from)};
        if (m_depths) {
            const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
            const double depth = m_depths->w[b] - m_depths->w[a];
            edge.depth = std::isfinite(depth) ? depth : 0;
            edge.normal = m_depths->normal[b] - m_depths->normal[a];
        }
        return edge;
    }

    /// The neighbour of a corner, one way around or the other.
    vtkIdType neighbour(vtkIdType count, const vtkIdType* cell, vtkIdType i, vtkIdType step) const {
        const auto after = [&](vtkIdType k) { return k + step < count ? k + step : k + step - count; };
        vtkIdType k = after(i);
        while (k != i && !is_finite(parameter(cell[k]))) k = after(k);
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

    const Triples& m_points;
    const std::vector<glm::dvec2>& m_parameters;
    const anamorph::PointDepths* m_depths;
};

}  // namespace

Triples::Triples(vtkDataArray* array) : m_array(array) {
    if (auto* floats = vtkAOSDataArrayTemplate<float>::FastDownCast(array)) m_floats = floats->GetPointer(0);
    if (auto* doubles = vtkAOSDataArrayTemplate<double>::FastDownCast(array))
        m_doubles = doubles->GetPointer(0);
}

glm::dvec3 Triples::read(std::int64_t i) const {
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
                               const anamorph::ParameterPlane* plane, vtkDataArray* normals,
                               const anamorph::PointDepths* depths)
    : m_points(mesh->GetPoints()->GetData()),
      m_normals(normals),
      m_parameters(parameters),
      m_depths(depths),
      m_on_plane(plane != nullptr) {
    if (plane) m_plane = *plane;
    m_exact = plane && normals;
    if (m_exact) return;
    check_corners(mesh);
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
                              " cells, but must have fewer than 2^32");
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
    anamorph::turn_normals(slopes, m_plane.gradient_u(), m_plane.gradient_v(), to, m_plane.normal());
}

void SurfaceNormals::add_corners(const anamorph::SurfaceSlopes& slopes, Normals& to) const {
    const Cells cells(m_points, m_parameters, m_depths);
    anamorph::CornerSums sums(slopes);
    CellReader reader;
    for (int k = 0; k < slopes.count; ++k) {
        const auto id = static_cast<std::size_t>(slopes.point(k));
        std::uint32_t last = 0;
        for (std::int64_t i = m_first[id]; i < m_first[id + 1]; ++i) {
            const std::uint32_t cell = m_cells[static_cast<std::size_t>(i)];
            // A cell that comes to the point twice stands there twice.
            if (i > m_first[id] && cell == last) continue;
            last = cell;
            read_cell(m_mesh, cell, reader, [&](vtkIdType count, const vtkIdType* around) {
                cells.add_corners(count, around, slopes.point(k), k, sums);
            });
        }
    }
    for (int k = 0; k < slopes.count; ++k) {
        glm::dvec3 normal = sums.normal(k);
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
