// SPDX-License-Identifier: Apache-2.0
#include "cell_corners.h"

#include <algorithm>
#include <string>
#include <type_traits>

#include "anamorph/error.h"
#include "vtkAOSDataArrayTemplate.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

namespace anamorph_vtk {
namespace {

void check(vtkCellArray* cells, vtkIdType count, const char* name) {
    vtkDataArray* const ids = cells ? cells->GetConnectivityArray() : nullptr;
    if (!ids) return;
    const vtkIdType size = ids->GetNumberOfValues();
    bool found = false;
    vtkIdType outside = count;
    const auto look = [&](const auto* list, vtkIdType length) {
        using T = std::remove_cv_t<std::remove_pointer_t<decltype(list)>>;
        const auto* const end = list + length;
        const auto* const at =
            std::find_if(list, end, [count](T id) { return id < 0 || vtkIdType{id} >= count; });
        found = at != end;
        if (found) outside = *at;
    };
    if (auto* longs = vtkAOSDataArrayTemplate<vtkTypeInt64>::FastDownCast(ids))
        look(longs->GetPointer(0), size);
    else if (auto* ints = vtkAOSDataArrayTemplate<vtkTypeInt32>::FastDownCast(ids))
        look(ints->GetPointer(0), size);
    else
        for (vtkIdType i = 0; i < size && !found; ++i) {
            const auto id = static_cast<vtkIdType>(ids->GetComponent(i, 0));
            look(&id, 1);
        }
    if (found)
        throw anamorph::Error(std::string(name) + " has a cell with a corner at point " +
                              std::to_string(outside) + ": its points are " +
                              (count > 0 ? "0 to " + std::to_string(count - 1) : "none"));
}

}  // namespace

void check_corners(vtkPointSet* mesh, const char* name) {
    const vtkIdType count = mesh->GetNumberOfPoints();
    if (auto* surface = vtkPolyData::SafeDownCast(mesh))
        for (vtkCellArray* cells :
             {surface->GetVerts(), surface->GetLines(), surface->GetPolys(), surface->GetStrips()})
            check(cells, count, name);
    else if (auto* grid = vtkUnstructuredGrid::SafeDownCast(mesh))
        check(grid->GetCells(), count, name);
}

}  // namespace anamorph_vtk
