// SPDX-License-Identifier: Apache-2.0
#include "painted_mesh.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

namespace anamorph_vtk {
namespace {

/// A number's bits, with one zero: what is no number equals itself.
std::uint64_t bits_of(double number) {
    return std::bit_cast<std::uint64_t>(number + 0.0);
}

}  // namespace

bool PaintedMesh::Key::operator==(const Key& other) const {
    return from == other.from && std::equal(at.begin(), at.end(), other.at.begin(),
                                            [](double a, double b) { return bits_of(a) == bits_of(b); });
}

std::size_t PaintedMesh::Hash::operator()(const Key& key) const {
    std::uint64_t sum = 0;
    // Each step spreads what came before over all bits.
    const auto add = [&sum](std::uint64_t more) {
        sum = (sum ^ more) * 0x9E3779B97F4A7C15u;
        sum ^= sum >> 32;
    };
    for (const vtkIdType id : key.from) add(static_cast<std::uint64_t>(id));
    for (const double number : key.at) add(bits_of(number));
    return static_cast<std::size_t>(sum);
}

PaintedMesh::PaintedMesh(vtkPolyData* scene, const anamorph::Size* size)
    : m_scene(scene), m_size(size), m_mesh(vtkSmartPointer<vtkPolyData>::New()) {
    vtkNew<vtkPoints> points;
    points->SetDataType(scene->GetPoints() ? scene->GetPoints()->GetDataType() : VTK_FLOAT);
    // What is interpolated between whole numbers is none.
    if (points->GetDataType() != VTK_FLOAT) points->SetDataTypeToDouble();
    m_mesh->SetPoints(points);
    m_mesh->SetPolys(vtkNew<vtkCellArray>());
    vtkPointData* arrays = m_mesh->GetPointData();
    arrays->CopyGlobalIdsOff();
    arrays->CopyPedigreeIdsOff();
    arrays->CopyFieldOff(vtkDataSetAttributes::GhostArrayName());
    arrays->InterpolateAllocate(scene->GetPointData());
    m_mesh->GetCellData()->CopyGlobalIdsOff();
    m_mesh->GetCellData()->CopyAllocate(scene->GetCellData());
    if (!size) return;
    m_texels = vtkSmartPointer<vtkDoubleArray>::New();
    m_texels->SetName("PanoramaCoordinates");
    m_texels->SetNumberOfComponents(2);
}

vtkIdType PaintedMesh::point_of(const anamorph::PaintedCorner& corner, vtkIdType cell,
                                const std::array<vtkIdType, 3>& corners) {
    Key key{{-1, -1, -1}, {corner.point.x, corner.point.y, corner.point.z, corner.texel.x, corner.texel.y}};
    vtkIdList* ids = m_ids;
    ids->Reset();
    std::array<double, 3> weights{};
    for (int i = 0; i < 3; ++i) {
        if (corner.weights[i] == 0) continue;
        const auto k = static_cast<std::size_t>(ids->GetNumberOfIds());
        weights[k] = corner.weights[i];
        key.from[k] = corners[static_cast<std::size_t>(i)];
        ids->InsertNextId(key.from[k]);
    }
    if (ids->GetNumberOfIds() == 3)
        key.from = {-2, -2, cell};
    else
        std::sort(key.from.begin(), key.from.end());
    if (!m_size) key.at[3] = key.at[4] = 0;
    const auto [found, is_new] = m_points.try_emplace(key, m_mesh->GetNumberOfPoints());
    if (!is_new) return found->second;
    const vtkIdType id = m_mesh->GetPoints()->InsertNextPoint(&corner.point.x);
    m_mesh->GetPointData()->InterpolatePoint(m_scene->GetPointData(), id, ids, weights.data());
    // Texture coordinates go up.
    if (m_size)
        m_texels->InsertNextTuple2(corner.texel.x / m_size->width, 1 - corner.texel.y / m_size->height);
    return id;
}

void PaintedMesh::add(const anamorph::PaintedTriangle& piece, vtkIdType cell,
                      const std::array<vtkIdType, 3>& corners) {
    vtkIdType ids[3];
    for (std::size_t i = 0; i < 3; ++i) ids[i] = point_of(piece.corners[i], cell, corners);
    const vtkIdType id = m_mesh->GetPolys()->InsertNextCell(3, ids);
    m_mesh->GetCellData()->CopyData(m_scene->GetCellData(), cell, id);
}

void PaintedMesh::finish(vtkPolyData* out) {
    if (m_texels) {
        // Those of the scene stay, as an array like others.
        m_mesh->GetPointData()->AddArray(m_texels);
        m_mesh->GetPointData()->SetActiveTCoords(m_texels->GetName());
    }
    m_mesh->GetFieldData()->PassData(m_scene->GetFieldData());
    out->ShallowCopy(m_mesh);
    m_points.clear();
}

}  // namespace anamorph_vtk
