// SPDX-License-Identifier: Apache-2.0
#include "scene_shadow.h"

#include <cmath>

#include "vtkCellArray.h"
#include "vtkMultiProcessController.h"
#include "vtkPolyData.h"

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

}  // namespace anamorph_vtk
