// SPDX-License-Identifier: Apache-2.0
#include "explicit_points.h"

#include <algorithm>
#include <limits>
#include <string>

#include "anamorph/error.h"
#include "execution.h"
#include "smp_for.h"
#include "vtkAlgorithm.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkDataArray.h"
#include "vtkDataObjectTree.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStructuredGrid.h"
#include "vtkUniformGrid.h"
#include "vtkUniformGridAMR.h"
#include "vtkVersionMacros.h"
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 6, 0)
#include "vtkCartesianGrid.h"
#endif

namespace anamorph_vtk {
namespace {

using anamorph::Error;

constexpr const char* kAllowed =
    "must be a point set, image data, a rectilinear grid, or blocks or an AMR of these";

/// Are the points of a data set implied by its axes?
bool is_implied(vtkDataObject* data) {
    return vtkImageData::SafeDownCast(data) || vtkRectilinearGrid::SafeDownCast(data);
}

void check_size(const char* class_name, const int (&size)[3]) {
    double count = 1;
    for (const int n : size) count *= std::max(n, 0);
    if (count > std::numeric_limits<std::int32_t>::max())
        throw Error(std::string("the ") + class_name + " has " + std::to_string(size[0]) + "x" +
                    std::to_string(size[1]) + "x" + std::to_string(size[2]) +
                    " points, but must have fewer than 2^31");
}

/// What has an extent, as a structured grid: `grid` has no points yet.
template <class Grid>
void copy_all_but_points(Grid* from, vtkStructuredGrid* grid) {
    int size[3];
    from->GetDimensions(size);
    check_size(from->GetClassName(), size);
    grid->SetExtent(from->GetExtent());
    grid->GetPointData()->ShallowCopy(from->GetPointData());
    grid->GetCellData()->ShallowCopy(from->GetCellData());
    grid->GetFieldData()->PassData(from->GetFieldData());
    if (from->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
        grid->GetInformation()->CopyEntry(from->GetInformation(), vtkDataObject::DATA_TIME_STEP());
}

void set_points(vtkDataSet* from, int type, vtkStructuredGrid* grid) {
    const vtkIdType count = from->GetNumberOfPoints();
    vtkNew<vtkPoints> points;
    points->SetDataType(type);
    points->SetNumberOfPoints(count);
    constexpr vtkIdType kStretch = 4096;
    anamorph::smp_for((count + kStretch - 1) / kStretch, [&](std::int64_t k) {
        for (vtkIdType i = k * kStretch; i < std::min((k + 1) * kStretch, count); ++i) {
            double p[3];
            from->GetPoint(i, p);
            points->SetPoint(i, p);
        }
    });
    grid->SetPoints(points);
}

/// The type of the points of a rectilinear grid.
int type_of_axes(vtkRectilinearGrid* grid) {
    int size[3];
    grid->GetDimensions(size);
    vtkDataArray* const axes[3] = {grid->GetXCoordinates(), grid->GetYCoordinates(), grid->GetZCoordinates()};
    bool all_float = true;
    for (int c = 0; c < 3; ++c) {
        const vtkIdType count = axes[c] ? axes[c]->GetNumberOfTuples() : 0;
        if (count < size[c])
            throw Error(std::string("the rectilinear grid has ") + std::to_string(count) +
                        " coordinates in " + "xyz"[c] + ", but must have " + std::to_string(size[c]));
        all_float = all_float && axes[c] && axes[c]->GetDataType() == VTK_FLOAT;
    }
    return all_float ? VTK_FLOAT : VTK_DOUBLE;
}

}  // namespace

void require_points(vtkInformation* port) {
    port->Remove(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE());
    for (const char* type :
         {"vtkCompositeDataSet", "vtkPointSet", "vtkImageData", "vtkRectilinearGrid", "vtkDataObject"})
        port->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), type);
}

void make_output_of_points(vtkInformation* output, vtkDataObject* input, const char* name) {
    if (vtkUniformGridAMR::SafeDownCast(input))
        make_output(output, vtkNew<vtkMultiBlockDataSet>());
    else if (vtkDataObjectTree::SafeDownCast(input) || vtkPointSet::SafeDownCast(input))
        make_output(output, input);
    else if (is_implied(input))
        make_output(output, vtkNew<vtkStructuredGrid>());
    else
        throw Error(std::string(name) + " is a " + (input ? input->GetClassName() : "missing one") + ": it " +
                    kAllowed);
}

vtkSmartPointer<vtkDataObject> without_levels(vtkDataObject* data) {
    auto* levels = vtkUniformGridAMR::SafeDownCast(data);
    if (!levels) return data;
    auto blocks = vtkSmartPointer<vtkMultiBlockDataSet>::New();
    blocks->SetNumberOfBlocks(levels->GetNumberOfLevels());
    for (unsigned int level = 0; level < levels->GetNumberOfLevels(); ++level) {
        vtkNew<vtkMultiBlockDataSet> grids;
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 6, 0)
        const unsigned int count = levels->GetNumberOfBlocks(level);
        const auto grid = [&](unsigned int i) { return levels->GetDataSetAsCartesianGrid(level, i); };
#else
        const unsigned int count = levels->GetNumberOfDataSets(level);
        const auto grid = [&](unsigned int i) { return levels->GetDataSet(level, i); };
#endif
        grids->SetNumberOfBlocks(count);
        for (unsigned int i = 0; i < count; ++i) grids->SetBlock(i, static_cast<vtkDataObject*>(grid(i)));
        blocks->SetBlock(level, grids);
    }
    blocks->GetFieldData()->PassData(levels->GetFieldData());
    if (levels->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
        blocks->GetInformation()->CopyEntry(levels->GetInformation(), vtkDataObject::DATA_TIME_STEP());
    return blocks;
}

vtkSmartPointer<vtkPointSet> new_point_set_like(vtkDataObject* data) {
    if (is_implied(data)) return vtkSmartPointer<vtkStructuredGrid>::New();
    if (!vtkPointSet::SafeDownCast(data)) return nullptr;
    return vtkSmartPointer<vtkPointSet>::Take(vtkPointSet::SafeDownCast(data->NewInstance()));
}

vtkSmartPointer<vtkPointSet> with_explicit_points(vtkDataObject* data) {
    if (auto* image = vtkImageData::SafeDownCast(data)) {
        auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
        copy_all_but_points(image, grid);
        set_points(image, VTK_DOUBLE, grid);
        return grid;
    }
    if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(data)) {
        auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
        copy_all_but_points(rectilinear, grid);
        set_points(rectilinear, type_of_axes(rectilinear), grid);
        return grid;
    }
    return vtkPointSet::SafeDownCast(data);
}

vtkMTimeType time_of_points(vtkDataObject* data) {
    vtkMTimeType time = data->GetMTime();
    if (auto* grid = vtkRectilinearGrid::SafeDownCast(data))
        for (vtkDataArray* axis : {grid->GetXCoordinates(), grid->GetYCoordinates(), grid->GetZCoordinates()})
            if (axis) time = std::max(time, axis->GetMTime());
    return time;
}

}  // namespace anamorph_vtk
