// SPDX-License-Identifier: Apache-2.0
#include "scene_shadow.h"

#include <cmath>

#include "cell_corners.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkTriangleFilter.h"
#include "vtkUnsignedCharArray.h"

namespace anamorph_vtk {

vtkSmartPointer<vtkPolyData> triangulated(vtkPolyData* mesh) {
    check_corners(mesh);
    vtkNew<vtkPolyData> copy;
    copy->ShallowCopy(mesh);
    vtkNew<vtkTriangleFilter> filter;
    filter->SetInputData(copy);
    filter->PassVertsOff();
    filter->PassLinesOff();
    filter->Update();
    return filter->GetOutput();
}

void for_shown(vtkPolyData* triangles, const std::function<void(const vtkIdType*)>& body) {
    vtkCellArray* cells = triangles->GetPolys();
    auto* ghosts = vtkUnsignedCharArray::SafeDownCast(
        triangles->GetCellData()->GetArray(vtkDataSetAttributes::GhostArrayName()));
    if (ghosts && ghosts->GetNumberOfTuples() != cells->GetNumberOfCells()) ghosts = nullptr;
    for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i) {
        if (ghosts && (ghosts->GetValue(i) & vtkDataSetAttributes::HIDDENCELL) != 0) continue;
        vtkIdType count = 0;
        const vtkIdType* corners = nullptr;
        cells->GetCellAtId(i, count, corners);
        if (count == 3) body(corners);
    }
}

void append_triangles(vtkPolyData* triangles, TriangleList& to) {
    for_shown(triangles, [&](const vtkIdType* corners) {
        glm::dvec3 p[3];
        bool finite = true;
        for (int k = 0; k < 3; ++k) {
            triangles->GetPoint(corners[k], &p[k].x);
            finite = finite && std::isfinite(p[k].x) && std::isfinite(p[k].y) && std::isfinite(p[k].z);
        }
        if (finite) to.insert(to.end(), p, p + 3);
    });
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

}  // namespace anamorph_vtk
