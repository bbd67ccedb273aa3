// SPDX-License-Identifier: Apache-2.0
#include "scene_shadow.h"

#include <algorithm>
#include <cmath>

#include "vtkCellArray.h"
#include "vtkGenericCell.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStaticCellLocator.h"

namespace anamorph_vtk {

void append_triangles(vtkPolyData* mesh, TriangleList& to) {
    vtkCellArray* cells = mesh->GetPolys();
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i) {
        cells->GetCellAtId(i, count, corners);
        glm::dvec3 p[3];
        bool finite = count == 3;
        for (int k = 0; k < 3 && finite; ++k) {
            mesh->GetPoint(corners[k], &p[k].x);
            finite = std::isfinite(p[k].x) && std::isfinite(p[k].y) && std::isfinite(p[k].z);
        }
        if (finite) to.insert(to.end(), p, p + 3);
    }
}

TriangleList of_all_ranks(const TriangleList& own, vtkMultiProcessController* controller) {
    const auto ranks = static_cast<std::size_t>(controller->GetNumberOfProcesses());
    const auto count = static_cast<vtkIdType>(3 * own.size());
    std::vector<vtkIdType> counts(ranks), offsets(ranks);
    controller->AllGather(&count, counts.data(), 1);
    vtkIdType total = 0;
    for (std::size_t r = 0; r < ranks; ++r) {
        offsets[r] = total;
        total += counts[r];
    }
    // One more each, so that there is an address.
    TriangleList mine = own, all(static_cast<std::size_t>(total / 3) + 1);
    mine.emplace_back(0.0);
    controller->AllGatherV(&mine[0].x, &all[0].x, count, counts.data(), offsets.data());
    all.pop_back();
    return all;
}

SceneShadow::SceneShadow(const TriangleList& triangles, const glm::dvec3& projector)
    : m_projector(projector), m_mesh(vtkSmartPointer<vtkPolyData>::New()) {
    if (triangles.empty()) return;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(static_cast<vtkIdType>(triangles.size()));
    vtkNew<vtkCellArray> cells;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto id = static_cast<vtkIdType>(i);
        points->SetPoint(id, &triangles[i].x);
        if (i % 3 == 0) cells->InsertNextCell({id, id + 1, id + 2});
    }
    m_mesh->SetPoints(points);
    m_mesh->SetPolys(cells);
    m_locator = vtkSmartPointer<vtkStaticCellLocator>::New();
    m_locator->SetDataSet(m_mesh);
    m_locator->BuildLocator();
}

SceneShadow::~SceneShadow() = default;

bool SceneShadow::hides(const glm::dvec3& point) const {
    if (!m_locator) return false;
    const glm::dvec3 end = point - (point - m_projector) * kTouching;
    vtkNew<vtkGenericCell> cell;
    double t = 0, x[3], parameters[3];
    int part = 0;
    vtkIdType hit = -1;
    return m_locator->IntersectWithLine(&m_projector.x, &end.x, 0, t, x, parameters, part, hit, cell) != 0;
}

}  // namespace anamorph_vtk
