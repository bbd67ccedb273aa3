// SPDX-License-Identifier: Apache-2.0
#include "automatic_plane.h"

#include <algorithm>
#include <cmath>

#include "deformed_mesh.h"
#include "vtkAOSDataArrayTemplate.h"
#include "vtkCellArray.h"
#include "vtkCommunicator.h"
#include "vtkDataArrayRange.h"
#include "vtkIdList.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace anamorph_vtk {
namespace {

/// The bounds are those of no points if there are more than DeformedMesh takes, which refuses them.
Bounds bounds_of(vtkPointSet* mesh) {
    Bounds bounds;
    const vtkIdType count = mesh->GetNumberOfPoints();
    for (vtkIdType i = 0; i < count && count <= DeformedMesh::kMostPoints; ++i) {
        double p[3];
        mesh->GetPoints()->GetPoint(i, p);
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
        for (int c = 0; c < 3; ++c) {
            bounds.least[c] = std::min(bounds.least[c], p[c]);
            bounds.most[c] = std::max(bounds.most[c], p[c]);
        }
    }
    return bounds;
}

/// A hash of whole numbers (FNV-1a by words), the same on every machine.
class Hash {
  public:
    void add(std::int64_t number) {
        m_value = (m_value ^ static_cast<std::uint64_t>(number)) * 0x100000001b3u;
    }

    template <class T>
    bool add_dense(vtkDataArray* array) {
        auto* dense = vtkAOSDataArrayTemplate<T>::FastDownCast(array);
        for (vtkIdType i = 0; dense && i < dense->GetNumberOfValues(); ++i) add(dense->GetValue(i));
        return dense != nullptr;
    }
    void add(vtkDataArray* array) {
        if (add_dense<vtkTypeInt64>(array) || add_dense<vtkTypeInt32>(array)) return;
        for (const double value : vtk::DataArrayValueRange(array)) add(static_cast<std::int64_t>(value));
    }
    void add(vtkCellArray* cells) {
        add(cells ? cells->GetNumberOfCells() : 0);
        if (!cells || cells->GetNumberOfCells() == 0) return;
        add(cells->GetOffsetsArray());
        add(cells->GetConnectivityArray());
    }
    std::uint64_t value() const { return m_value; }

  private:
    std::uint64_t m_value = 0xcbf29ce484222325u;
};

/// A hash of the numbers of points and cells, and of which points the cells have.
std::uint64_t topology_of(vtkPointSet* mesh) {
    Hash hash;
    hash.add(mesh->GetDataObjectType());
    hash.add(mesh->GetNumberOfPoints());
    if (auto* surface = vtkPolyData::SafeDownCast(mesh)) {
        for (vtkCellArray* cells :
             {surface->GetVerts(), surface->GetLines(), surface->GetPolys(), surface->GetStrips()})
            hash.add(cells);
    } else if (auto* grid = vtkStructuredGrid::SafeDownCast(mesh)) {
        int size[3];
        grid->GetDimensions(size);
        for (const int n : size) hash.add(n);
    } else if (auto* cells = vtkUnstructuredGrid::SafeDownCast(mesh)) {
        hash.add(cells->GetCells());
        for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i) hash.add(cells->GetCellType(i));
    } else {
        vtkNew<vtkIdList> points;
        for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i) {
            mesh->GetCellPoints(i, points);
            hash.add(points->GetNumberOfIds());
            for (const vtkIdType id : *points) hash.add(id);
        }
    }
    return hash.value();
}

/// Neither of the two longest, in the order of x, y, z.
int across_of(const Bounds& bounds) {
    int across = 2;
    for (const int c : {1, 0})
        if (bounds.length(c) < bounds.length(across)) across = c;
    return across;
}

/// Its parameters are coordinates.
anamorph::ParameterPlane plane_across(int across, const Bounds& bounds) {
    glm::dvec3 origin(0.0), axes[2] = {glm::dvec3(0.0), glm::dvec3(0.0)};
    origin[across] = bounds.least[across] / 2 + bounds.most[across] / 2;
    int next = 0;
    for (int c = 0; c < 3; ++c)
        if (c != across) axes[next++][c] = 1;
    return {origin, axes[0], axes[1]};
}

bool is_flat_along_an_axis(const Bounds& bounds, int across) {
    return bounds.length((across + 1) % 3) == 0 || bounds.length((across + 2) % 3) == 0;
}

}  // namespace

void Bounds::add(const Bounds& other) {
    for (int c = 0; c < 3; ++c) {
        least[c] = std::min(least[c], other.least[c]);
        most[c] = std::max(most[c], other.most[c]);
    }
}

void AutomaticPlane::look_at(const std::vector<vtkPointSet*>& meshes) {
    m_meshes.resize(meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i)
        if (m_meshes[i].time != meshes[i]->GetMTime())
            m_meshes[i] = {meshes[i]->GetMTime(), bounds_of(meshes[i]), topology_of(meshes[i])};
}

std::vector<std::uint64_t> AutomaticPlane::topologies() const {
    std::vector<std::uint64_t> all;
    for (const Mesh& mesh : m_meshes) all.push_back(mesh.topology);
    return all;
}

anamorph::ParameterPlane AutomaticPlane::of(const std::vector<vtkPointSet*>& meshes,
                                            vtkMultiProcessController* controller) {
    look_at(meshes);
    int same = m_across && topologies() == m_chosen_with ? 1 : 0;
    Bounds bounds;
    for (const Mesh& mesh : m_meshes) bounds.add(mesh.bounds);
    if (distributed(controller)) {
        const Bounds own = bounds;
        const int own_same = same;
        controller->AllReduce(own.least, bounds.least, 3, vtkCommunicator::MIN_OP);
        controller->AllReduce(own.most, bounds.most, 3, vtkCommunicator::MAX_OP);
        controller->AllReduce(&own_same, &same, 1, vtkCommunicator::MIN_OP);
    }
    // Data without points tell nothing, and nothing is forgotten for them.
    if (bounds.empty()) return {};
    if (same == 0 || is_flat_along_an_axis(bounds, *m_across)) {
        m_across = across_of(bounds);
        m_chosen_with = topologies();
    }
    return plane_across(*m_across, bounds);
}

}  // namespace anamorph_vtk
