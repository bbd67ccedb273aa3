// SPDX-License-Identifier: Apache-2.0
// Grids whose points are implied by their axes, in the filters that move points: they come out as structured grids, as
// those of vtkWarpScalar do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAMRBox.h>
#include <vtkAnamorphDeform.h>
#include <vtkAnamorphInbetween.h>
#include <vtkCallbackCommand.h>
#include <vtkCellData.h>
#include <vtkCommand.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkHyperTreeGrid.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMatrix3x3.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkOverlappingAMR.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkRTAnalyticSource.h>
#include <vtkRectilinearGrid.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStructuredGrid.h>
#include <vtkTable.h>
#include <vtkTrivialProducer.h>
#include <vtkUniformGrid.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWarpScalar.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "support.h"

namespace test_grids {
namespace {

using testing::HasSubstr;
using Executive = vtkStreamingDemandDrivenPipeline;

/// A terrain: 12 x 9 points from (3, -2), a turned and unequal grid, with all that a grid can carry.
vtkSmartPointer<vtkImageData> terrain(double slope = 1, int slices = 1) {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetExtent(3, 14, -2, 6, 5, 4 + slices);
    image->SetOrigin(.25, -1.5, 2);
    image->SetSpacing(.5, .25, .125);
    vtkNew<vtkMatrix3x3> turned;  // about z
    turned->SetElement(0, 0, .6);
    turned->SetElement(0, 1, -.8);
    turned->SetElement(1, 0, .8);
    turned->SetElement(1, 1, .6);
    image->SetDirectionMatrix(turned);
    vtkNew<vtkFloatArray> heights;
    heights->SetName("height");
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
        heights->InsertNextValue(static_cast<float>(slope * std::sin(.3 * static_cast<double>(i))));
    image->GetPointData()->SetScalars(heights);
    image->AllocateCellGhostArray()->FillValue(0);
    image->GetCellGhostArray()->SetValue(7, vtkDataSetAttributes::HIDDENCELL);
    vtkNew<vtkDoubleArray> field;
    field->SetName("sea level");
    field->InsertNextValue(-3);
    image->GetFieldData()->AddArray(field);
    return image;
}

vtkSmartPointer<vtkRectilinearGrid> terraces(int type) {
    auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
    grid->SetDimensions(5, 4, 3);
    const auto axis = [type](std::vector<double> values) {
        auto array = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(type));
        for (const double value : values) array->InsertNextTuple1(value);
        return array;
    };
    grid->SetXCoordinates(axis({0, 1, 3, 3.5, 4}));
    grid->SetYCoordinates(axis({-2, 0, .5, 7}));
    grid->SetZCoordinates(axis({0, .25, 1}));
    return grid;
}

void bump(vtkAnamorphDeform* filter) {
    filter->AddDeformation(2, 1, 1.5, 2, .1, -.2, 1);
    filter->AddDeformation(3, 2, 2, 1, 0, .3, -.5, 1);
}

/// A structured grid of the same points, made of them one by one.
vtkSmartPointer<vtkStructuredGrid> written_out(vtkDataSet* data, int type) {
    auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
    int extent[6];
    if (auto* image = vtkImageData::SafeDownCast(data))
        image->GetExtent(extent);
    else
        vtkRectilinearGrid::SafeDownCast(data)->GetExtent(extent);
    grid->SetExtent(extent);
    vtkNew<vtkPoints> points;
    points->SetDataType(type);
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) points->InsertNextPoint(data->GetPoint(i));
    grid->SetPoints(points);
    grid->GetPointData()->ShallowCopy(data->GetPointData());
    grid->GetCellData()->ShallowCopy(data->GetCellData());
    return grid;
}

vtkStructuredGrid* grid_of(vtkAlgorithm* filter) {
    return vtkStructuredGrid::SafeDownCast(filter->GetOutputDataObject(0));
}

/// What a filter makes of a data set.
std::vector<double> deformed(vtkDataObject* data) {
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(data);
    bump(filter);
    filter->Update();
    std::vector<double> all = coordinates(vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0)));
    const std::vector<double> normals =
        numbers(vtkDataSet::SafeDownCast(filter->GetOutputDataObject(0))->GetPointData()->GetNormals());
    all.insert(all.end(), normals.begin(), normals.end());
    return all;
}

}  // namespace

TEST(VtkGrids, DeformTakesThemForTheirPoints) {
    for (const int slices : {1, 4}) {
        const auto image = terrain(1, slices);
        EXPECT_EQ(deformed(image), deformed(written_out(image, VTK_DOUBLE)));
    }
    for (const int type : {VTK_FLOAT, VTK_DOUBLE, VTK_INT}) {
        const auto grid = terraces(type);
        EXPECT_EQ(deformed(grid), deformed(written_out(grid, type == VTK_FLOAT ? VTK_FLOAT : VTK_DOUBLE)));
    }
}

TEST(VtkGrids, DeformKeepsExtentsArraysAndBlanks) {
    const auto image = terrain();
    const vtkMTimeType time = image->GetMTime();
    vtkNew<vtkAnamorphDeform> filter;
    const Errors errors(filter);
    filter->SetInputData(image);
    bump(filter);
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    vtkStructuredGrid* out = grid_of(filter);
    ASSERT_TRUE(out);
    EXPECT_TRUE(std::equal(out->GetExtent(), out->GetExtent() + 6, image->GetExtent()));
    int whole[6];
    filter->GetOutputInformation(0)->Get(Executive::WHOLE_EXTENT(), whole);
    EXPECT_TRUE(std::equal(whole, whole + 6, image->GetExtent()));
    EXPECT_EQ(out->GetPoints()->GetDataType(), VTK_DOUBLE);
    EXPECT_EQ(out->GetPointData()->GetScalars(), image->GetPointData()->GetScalars());
    EXPECT_EQ(out->GetCellGhostArray(), image->GetCellGhostArray());
    EXPECT_FALSE(out->IsCellVisible(7));
    EXPECT_TRUE(out->IsCellVisible(8));
    EXPECT_TRUE(out->GetFieldData()->GetAbstractArray("sea level"));
    EXPECT_EQ(image->GetMTime(), time);
    EXPECT_EQ(image->GetFieldData()->GetNumberOfArrays(), 1);
    // The class and the points that vtkWarpScalar has, where nothing moves.
    vtkNew<vtkWarpScalar> warp;
    warp->SetInputData(image);
    warp->SetScaleFactor(0);
    warp->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    warp->Update();
    filter->RemoveAllDeformations();
    filter->Update();
    EXPECT_STREQ(warp->GetOutputDataObject(0)->GetClassName(), out->GetClassName());
    EXPECT_EQ(coordinates(grid_of(filter)),
              coordinates(vtkPointSet::SafeDownCast(warp->GetOutputDataObject(0))));
}

TEST(VtkGrids, DeformFollowsEditsAndTheGrid) {
    const auto image = terrain(1, 16);
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(image);
    filter->SetComputeNormals(false);
    bump(filter);
    filter->SetDeformation(1, 3.5, 3.5, .4, .4, 0, .3, -.5, 1);
    filter->Update();
    const vtkIdType all = image->GetNumberOfPoints();
    EXPECT_EQ(filter->GetNumberOfPointsComputed(), all);
    filter->SetDeformationEnabled(1, false);
    filter->Update();
    EXPECT_LT(filter->GetNumberOfPointsComputed(), all);  // kept from before
    filter->SetDeformationEnabled(1, true);
    image->SetOrigin(.5, 0, 0);
    image->Modified();
    filter->Update();
    EXPECT_EQ(filter->GetNumberOfPointsComputed(), all);
    filter->RemoveAllDeformations();
    bump(filter);
    filter->Update();
    const std::vector<double> moved = deformed(image);
    EXPECT_EQ(coordinates(grid_of(filter)),
              std::vector<double>(moved.begin(), moved.begin() + static_cast<std::ptrdiff_t>(3 * all)));
    // An axis of a rectilinear grid has a time of its own.
    const auto grid = terraces(VTK_DOUBLE);
    filter->SetInputData(grid);
    filter->Update();
    grid->GetXCoordinates()->SetTuple1(4, 20);
    grid->GetXCoordinates()->Modified();
    filter->Modified();
    filter->Update();
    const std::vector<double> again = deformed(grid);
    EXPECT_EQ(coordinates(grid_of(filter)), std::vector<double>(again.begin(), again.begin() + 180));
}

TEST(VtkGrids, DeformTakesThemInTreesAndLevels) {
    const auto image = terrain();
    vtkNew<vtkMultiBlockDataSet> blocks;
    blocks->SetNumberOfBlocks(4);
    blocks->SetBlock(0, image);
    blocks->SetBlock(2, terraces(VTK_FLOAT));
    blocks->SetBlock(3, vtkNew<vtkTable>());
    blocks->GetMetaData(2u)->Set(vtkCompositeDataSet::NAME(), "terraces");
    vtkNew<vtkAnamorphDeform> filter;
    const Errors errors(filter);
    filter->SetInputData(blocks);
    filter->AutomaticPlaneOff();
    bump(filter);
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    auto* out = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(out);
    EXPECT_TRUE(vtkStructuredGrid::SafeDownCast(out->GetBlock(0)));
    EXPECT_FALSE(out->GetBlock(1));
    EXPECT_TRUE(vtkStructuredGrid::SafeDownCast(out->GetBlock(2)));
    EXPECT_TRUE(vtkTable::SafeDownCast(out->GetBlock(3)));
    EXPECT_STREQ(out->GetMetaData(2u)->Get(vtkCompositeDataSet::NAME()), "terraces");

    vtkNew<vtkPartitionedDataSet> parts;
    parts->SetPartition(0, image);
    vtkNew<vtkPartitionedDataSetCollection> collection;
    collection->SetPartitionedDataSet(0, parts);
    filter->SetInputData(collection);
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    auto* collected = vtkPartitionedDataSetCollection::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(collected);
    EXPECT_TRUE(vtkStructuredGrid::SafeDownCast(collected->GetPartition(0, 0)));

    vtkNew<vtkOverlappingAMR> levels;
    const int per_level[2] = {1, 2};
    levels->Initialize(2, per_level);
    const double origin[3] = {0, 0, 0};
    levels->SetOrigin(origin);
    levels->SetGridDescription(VTK_XYZ_GRID);
    const auto add = [&](unsigned int level, unsigned int i, double x, double spacing) {
        vtkNew<vtkUniformGrid> grid;
        grid->SetOrigin(x, 0, 0);
        grid->SetSpacing(spacing, spacing, spacing);
        grid->SetDimensions(5, 5, 5);
        grid->AllocateCellGhostArray()->FillValue(0);
        if (level == 0) grid->GetCellGhostArray()->SetValue(3, vtkDataSetAttributes::REFINEDCELL);
        const double spacings[3] = {spacing, spacing, spacing};
        levels->SetSpacing(level, spacings);
        const vtkAMRBox box(grid->GetOrigin(), grid->GetDimensions(), spacings, origin, VTK_XYZ_GRID);
        levels->SetAMRBox(level, i, box);
        levels->SetDataSet(level, i, grid);
    };
    add(0, 0, 0, 1);
    add(1, 0, 0, .5);
    add(1, 1, 2, .5);
    filter->SetInputData(levels);
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    auto* out_levels = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(out_levels);
    ASSERT_EQ(out_levels->GetNumberOfBlocks(), 2u);
    auto* fine = vtkMultiBlockDataSet::SafeDownCast(out_levels->GetBlock(1));
    ASSERT_TRUE(fine);
    ASSERT_EQ(fine->GetNumberOfBlocks(), 2u);
    auto* grid = vtkStructuredGrid::SafeDownCast(
        vtkMultiBlockDataSet::SafeDownCast(out_levels->GetBlock(0))->GetBlock(0));
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->GetNumberOfPoints(), 125);
    EXPECT_FALSE(grid->IsCellVisible(3));
}

TEST(VtkGrids, DeformOfPiecesIsThatOfTheWhole) {
    vtkNew<vtkRTAnalyticSource> wavelet;
    wavelet->SetWholeExtent(-6, 6, -5, 5, -3, 4);
    const auto run = [&](int pieces, std::map<std::vector<double>, std::vector<double>>& points) {
        for (int piece = 0; piece < pieces; ++piece) {
            vtkNew<vtkAnamorphDeform> filter;
            const Errors errors(filter);
            filter->SetInputConnection(wavelet->GetOutputPort());
            filter->AutomaticPlaneOff();
            filter->SetAxis1(0, 1, 0);
            filter->SetAxis2(0, 0, 1);
            bump(filter);
            filter->UpdatePiece(piece, pieces, 0);
            EXPECT_EQ(errors.text(), "");
            vtkStructuredGrid* out = grid_of(filter);
            ASSERT_TRUE(out);
            auto* image = vtkImageData::SafeDownCast(wavelet->GetOutputDataObject(0));
            EXPECT_TRUE(std::equal(out->GetExtent(), out->GetExtent() + 6, image->GetExtent()));
            for (vtkIdType i = 0; i < out->GetNumberOfPoints(); ++i) {
                const double *from = image->GetPoint(i), *to = out->GetPoint(i);
                const std::vector<double> key(from, from + 3), value(to, to + 3);
                EXPECT_EQ(points.emplace(key, value).first->second, value);
            }
        }
    };
    std::map<std::vector<double>, std::vector<double>> whole, parts;
    run(1, whole);
    run(5, parts);
    EXPECT_EQ(whole.size(), 13u * 11 * 8);
    EXPECT_EQ(parts, whole);
}

TEST(VtkGrids, EmptyAndThinOnes) {
    for (const bool rectilinear : {false, true}) {
        vtkSmartPointer<vtkDataSet> empty;
        if (rectilinear)
            empty = vtkSmartPointer<vtkRectilinearGrid>::New();
        else
            empty = vtkSmartPointer<vtkImageData>::New();
        for (const bool blend : {false, true}) {
            vtkSmartPointer<vtkAlgorithm> filter;
            if (blend)
                filter = vtkSmartPointer<vtkAnamorphInbetween>::New();
            else
                filter = vtkSmartPointer<vtkAnamorphDeform>::New();
            const Errors errors(filter);
            filter->SetInputDataObject(0, empty);
            filter->Update();
            EXPECT_EQ(errors.text(), "");
            EXPECT_EQ(grid_of(filter)->GetNumberOfPoints(), empty->GetNumberOfPoints());
        }
    }
    // A row of points, and one point.
    for (const int n : {7, 1}) {
        vtkNew<vtkImageData> image;
        image->SetDimensions(n, 1, 1);
        EXPECT_EQ(deformed(image), deformed(written_out(image, VTK_DOUBLE)));
    }
}

TEST(VtkGrids, WhatIsRefusedIsNamed) {
    vtkNew<vtkHyperTreeGrid> trees;
    vtkNew<vtkTable> table;
    vtkNew<vtkImageData> huge;
    huge->SetDimensions(2000, 2000, 2000);
    vtkNew<vtkImageData> beyond;  // the product is no vtkIdType
    beyond->SetExtent(0, 2147483646, 0, 2147483646, 0, 2147483646);
    const auto crooked = terraces(VTK_DOUBLE);
    crooked->GetYCoordinates()->SetNumberOfTuples(2);
    const char* const allowed =
        ": it must be a point set, image data, a rectilinear grid, or blocks or an AMR of these";
    for (const auto& [data, words] : std::map<vtkDataObject*, std::string>{
             {trees, std::string("is a vtkHyperTreeGrid") + allowed},
             {table, std::string("is a vtkTable") + allowed},
             {huge, "the vtkImageData has 2000x2000x2000 points, but must have fewer than 2^31"},
             {beyond, "points, but must have fewer than 2^31"},
             {crooked, "the rectilinear grid has 2 coordinates in y, but must have 4"}}) {
        vtkNew<vtkAnamorphDeform> deform;
        const Errors errors(deform);
        deform->SetInputData(data);
        deform->Update();
        EXPECT_THAT(errors.text(), HasSubstr(words));
        vtkNew<vtkAnamorphInbetween> blend;
        const Errors blend_errors(blend);
        blend->AddInputData(data);
        blend->Update();
        EXPECT_THAT(blend_errors.text(), HasSubstr(words));
    }
}

TEST(VtkGrids, InbetweenBlendsArraysAndPoints) {
    const auto a = terrain(1), b = terrain(-2);
    b->SetOrigin(1.25, -1.5, 2);
    vtkNew<vtkAnamorphInbetween> blend;
    const Errors errors(blend);
    blend->AddInputData(a);
    blend->AddInputData(b);
    blend->SetWeight(0, .25);
    blend->SetWeight(1, .75);
    blend->Update();
    EXPECT_EQ(errors.text(), "");
    vtkStructuredGrid* out = grid_of(blend);
    ASSERT_TRUE(out);
    EXPECT_TRUE(std::equal(out->GetExtent(), out->GetExtent() + 6, a->GetExtent()));
    EXPECT_FALSE(out->IsCellVisible(7));
    for (vtkIdType i = 0; i < out->GetNumberOfPoints(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double from = a->GetPoint(i)[c], to = b->GetPoint(i)[c];
            ASSERT_NEAR(out->GetPoint(i)[c], .25 * from + .75 * to, 1e-14);
        }
        ASSERT_NEAR(out->GetPointData()->GetScalars()->GetTuple1(i),
                    .25 * a->GetPointData()->GetScalars()->GetTuple1(i) +
                        .75 * b->GetPointData()->GetScalars()->GetTuple1(i),
                    1e-6);
    }
    // Where all have the same axes, points are those, to the bit.
    b->SetOrigin(a->GetOrigin());
    b->Modified();
    blend->Update();
    EXPECT_EQ(coordinates(grid_of(blend)), coordinates(written_out(a, VTK_DOUBLE)));
    // Another extent, and another class.
    b->SetExtent(0, 11, -2, 6, 5, 5);
    b->Modified();
    blend->Update();
    EXPECT_THAT(errors.text(), HasSubstr("input 1 is a grid of another extent than input 0"));
}

TEST(VtkGrids, InbetweenTakesThemInTrees) {
    const auto tree = [](double slope) {
        auto blocks = vtkSmartPointer<vtkMultiBlockDataSet>::New();
        blocks->SetBlock(0, terrain(slope));
        blocks->SetBlock(1, terraces(VTK_FLOAT));
        return blocks;
    };
    vtkNew<vtkAnamorphInbetween> blend;
    const Errors errors(blend);
    blend->AddInputData(tree(1));
    blend->AddInputData(tree(3));
    blend->Update();
    EXPECT_EQ(errors.text(), "");
    auto* out = vtkMultiBlockDataSet::SafeDownCast(blend->GetOutputDataObject(0));
    ASSERT_TRUE(out);
    auto* first = vtkStructuredGrid::SafeDownCast(out->GetBlock(0));
    auto* second = vtkStructuredGrid::SafeDownCast(out->GetBlock(1));
    ASSERT_TRUE(first && second);
    EXPECT_EQ(second->GetPoints()->GetDataType(), VTK_FLOAT);
    EXPECT_NEAR(first->GetPointData()->GetScalars()->GetTuple1(5), 2 * std::sin(1.5), 1e-6);
}

TEST(VtkGrids, AbortEmptiesTheOutput) {
    const auto image = terrain(1, 200);
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(image);
    bump(filter);
    const Errors errors(filter);
    const auto stop = [](vtkObject* caller, unsigned long, void*, void*) {
        vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
    };
    vtkNew<vtkCallbackCommand> command;
    command->SetCallback(stop);
    filter->AddObserver(vtkCommand::ProgressEvent, command);
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    EXPECT_EQ(grid_of(filter)->GetNumberOfPoints(), 0);
}

}  // namespace test_grids
