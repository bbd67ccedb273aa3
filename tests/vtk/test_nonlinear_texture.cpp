// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphNonlinearTexture.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkIntArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPlaneSource.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkTriangle.h>
#include <vtkUnsignedCharArray.h>

#include <cmath>
#include <map>
#include <set>

#include "support.h"

namespace test_nonlinear_texture {
namespace {

using testing::HasSubstr;
using Filter = vtkAnamorphNonlinearTexture;
using Mesh = vtkSmartPointer<vtkPolyData>;

/// A square of n x n quadrilaterals, 2 wide, whose texture coordinates bend.
Mesh sheet(int n = 6, double bend = 0.05) {
    vtkNew<vtkPlaneSource> source;
    source->SetOrigin(-1, -1, 0);
    source->SetPoint1(1, -1, 0);
    source->SetPoint2(-1, 1, 0);
    source->SetResolution(n, n);
    source->Update();
    Mesh mesh = source->GetOutput();
    vtkDataArray* coordinates = mesh->GetPointData()->GetTCoords();
    for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i) {
        double p[3];
        mesh->GetPoint(i, p);
        coordinates->SetTuple2(i, 0.5 + p[0] / 2 + bend * std::sin(3 * p[1]),
                               0.5 + p[1] / 2 + bend * std::cos(2 * p[0]));
    }
    return mesh;
}

double field(vtkDataObject* object, const char* name) {
    auto* array = vtkDataArray::SafeDownCast(object->GetFieldData()->GetAbstractArray(name));
    return array ? array->GetComponent(0, 0) : kNan;
}

/// All that an output has, as numbers.
std::vector<double> everything(vtkPolyData* mesh) {
    std::vector<double> all = coordinates(mesh);
    for (vtkDataSetAttributes* arrays : {static_cast<vtkDataSetAttributes*>(mesh->GetPointData()),
                                         static_cast<vtkDataSetAttributes*>(mesh->GetCellData())})
        for (int i = 0; i < arrays->GetNumberOfArrays(); ++i) {
            const std::vector<double> part = numbers(arrays->GetArray(i));
            all.insert(all.end(), part.begin(), part.end());
        }
    for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i)
        for (int k = 0; k < mesh->GetCell(i)->GetNumberOfPoints(); ++k)
            all.push_back(static_cast<double>(mesh->GetCell(i)->GetPointId(k)));
    return all;
}

double area_of(vtkPolyData* mesh) {
    double sum = 0;
    for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i) {
        double p[3][3];
        for (int k = 0; k < 3; ++k) mesh->GetPoint(mesh->GetCell(i)->GetPointId(k), p[k]);
        sum += vtkTriangle::TriangleArea(p[0], p[1], p[2]);
    }
    return sum;
}

/// Sides that have a triangle on one side alone, by the places of their ends.
int open_sides(vtkPolyData* mesh) {
    std::map<std::array<double, 6>, int> sides;
    for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i)
        for (int k = 0; k < 3; ++k) {
            std::array<double, 6> side;
            mesh->GetPoint(mesh->GetCell(i)->GetPointId(k), side.data());
            mesh->GetPoint(mesh->GetCell(i)->GetPointId((k + 1) % 3), side.data() + 3);
            ++sides[side];
        }
    int open = 0;
    for (const auto& [side, count] : sides) {
        std::array<double, 6> back = side;
        std::rotate(back.begin(), back.begin() + 3, back.end());
        open += sides.count(back) == 0;
    }
    return open;
}

TEST(VtkNonlinearTexture, PolygonsAreCutUntilTheToleranceIsHeld) {
    vtkNew<Filter> filter;
    filter->SetInputData(sheet());
    vtkIdType before = 72;
    for (const double tol : {8.0, 1.0, 0.125}) {
        filter->SetTolerance(tol);
        filter->Update();
        vtkPolyData* out = filter->GetOutput();
        EXPECT_GT(out->GetNumberOfCells(), before);
        before = out->GetNumberOfCells();
        EXPECT_EQ(field(out, "anamorph:tol"), tol);
        EXPECT_LE(field(out, "anamorph:max_error"), tol);
        EXPECT_GT(field(out, "anamorph:max_error"), tol / 4);
        EXPECT_EQ(field(out, "anamorph:not_finite"), 0);
        EXPECT_NEAR(area_of(out), 4, 1e-12);
        EXPECT_EQ(out->GetPoints()->GetDataType(), VTK_DOUBLE);
        EXPECT_EQ(out->GetPointData()->GetTCoords()->GetDataType(), VTK_DOUBLE);
        EXPECT_STREQ(out->GetPointData()->GetTCoords()->GetName(), "TextureCoordinates");
    }
    // Texels are those of the texture's size, each way.
    filter->SetTextureWidth(64);
    filter->SetTextureHeight(64);
    filter->Update();
    EXPECT_LT(filter->GetOutput()->GetNumberOfCells(), before / 4);
}

TEST(VtkNonlinearTexture, WhatIsLinearIsNotCut) {
    const Mesh mesh = sheet(5, 0);
    vtkNew<Filter> filter;
    filter->SetInputData(mesh);
    filter->SetTolerance(0.001);
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetNumberOfCells(), 50);
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), mesh->GetNumberOfPoints());
}

TEST(VtkNonlinearTexture, ArraysAreInterpolatedOrCopiedAndTheInputStays) {
    const Mesh mesh = sheet();
    vtkNew<vtkDoubleArray> linear;
    linear->SetName("linear");
    for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i) {
        double p[3];
        mesh->GetPoint(i, p);
        linear->InsertNextValue(2 * p[0] - 3 * p[1] + 5);
    }
    mesh->GetPointData()->AddArray(linear);
    vtkNew<vtkIntArray> cells;
    cells->SetName("cells");
    for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i) cells->InsertNextValue(static_cast<int>(i) + 40);
    mesh->GetCellData()->AddArray(cells);
    vtkNew<vtkIdTypeArray> ids;
    ids->SetName("ids");
    for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i) ids->InsertNextValue(i);
    mesh->GetPointData()->SetGlobalIds(ids);
    vtkNew<vtkDoubleArray> said;
    said->SetName("said");
    said->InsertNextValue(7);
    mesh->GetFieldData()->AddArray(said);
    const std::vector<double> before = everything(mesh);
    vtkNew<Filter> filter;
    filter->SetInputData(mesh);
    filter->Update();
    vtkPolyData* out = filter->GetOutput();
    ASSERT_GT(out->GetNumberOfPoints(), 1000);
    for (vtkIdType i = 0; i < out->GetNumberOfPoints(); ++i) {
        double p[3];
        out->GetPoint(i, p);
        EXPECT_NEAR(out->GetPointData()->GetArray("linear")->GetComponent(i, 0), 2 * p[0] - 3 * p[1] + 5,
                    1e-12);
    }
    EXPECT_TRUE(out->GetPointData()->GetNormals());
    EXPECT_EQ(out->GetPointData()->GetGlobalIds(), nullptr);
    EXPECT_EQ(field(out, "said"), 7);
    // Each triangle lies in the quadrilateral that it is of.
    for (vtkIdType i = 0; i < out->GetNumberOfCells(); ++i) {
        const int cell = static_cast<int>(out->GetCellData()->GetArray("cells")->GetComponent(i, 0)) - 40;
        double bounds[6];
        out->GetCellBounds(i, bounds);
        EXPECT_GE(bounds[0], -1 + cell % 6 / 3.0 - 1e-6);
        EXPECT_LE(bounds[1], -1 + (cell % 6 + 1) / 3.0 + 1e-6);
        EXPECT_GE(bounds[2], -1 + cell / 6 / 3.0 - 1e-6);
    }
    EXPECT_EQ(everything(mesh), before);
}

/// A square whose two halves have points of their own at x = 0, and there other coordinates.
Mesh with_seam() {
    const Mesh mesh = sheet(6);
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> coordinates;
    coordinates->SetName("st");
    coordinates->SetNumberOfComponents(2);
    vtkNew<vtkCellArray> cells;
    std::map<std::pair<vtkIdType, bool>, vtkIdType> made;
    for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c) {
        const bool right = c % 6 >= 3;
        vtkIdType ids[4];
        for (int k = 0; k < 4; ++k) {
            const vtkIdType of = mesh->GetCell(c)->GetPointId(k);
            const auto [found, is_new] = made.try_emplace({of, right}, points->GetNumberOfPoints());
            ids[k] = found->second;
            if (!is_new) continue;
            points->InsertNextPoint(mesh->GetPoint(of));
            const double* t = mesh->GetPointData()->GetTCoords()->GetTuple2(of);
            // To the right it is bent three times as much.
            coordinates->InsertNextTuple2(right ? t[0] + 0.2 * t[1] * t[1] : t[0] + 0.5, t[1]);
        }
        cells->InsertNextCell(4, ids);
    }
    const Mesh torn = Mesh::New();
    torn->SetPoints(points);
    torn->SetPolys(cells);
    torn->GetPointData()->SetTCoords(coordinates);
    return torn;
}

TEST(VtkNonlinearTexture, SeamsAndTrianglesWithoutNumbersHaveNoCracks) {
    vtkNew<Filter> filter;
    filter->SetInputData(with_seam());
    filter->Update();
    vtkPolyData* out = filter->GetOutput();
    EXPECT_GT(out->GetNumberOfCells(), 1000);
    const auto on_border = [](vtkPolyData* mesh) {
        int count = 0;
        for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i)
            for (int k = 0; k < 3; ++k) {
                double p[3], q[3];
                mesh->GetPoint(mesh->GetCell(i)->GetPointId(k), p);
                mesh->GetPoint(mesh->GetCell(i)->GetPointId((k + 1) % 3), q);
                for (int c = 0; c < 2; ++c) count += p[c] == q[c] && std::fabs(p[c]) == 1;
            }
        return count;
    };
    EXPECT_EQ(open_sides(out), on_border(out));
    const Mesh broken = sheet();
    broken->GetPointData()->GetTCoords()->SetComponent(24, 0, kNan);
    filter->SetInputData(broken);
    filter->Update();
    out = filter->GetOutput();
    EXPECT_EQ(field(out, "anamorph:not_finite"), 6);
    EXPECT_EQ(open_sides(out), on_border(out));
    EXPECT_NEAR(area_of(out), 4, 1e-12);
    int nans = 0;
    for (const double x : numbers(out->GetPointData()->GetTCoords())) nans += std::isnan(x);
    EXPECT_EQ(nans, 1) << "it stays in its point";
}

TEST(VtkNonlinearTexture, PointsOfAllTypes) {
    std::vector<double> first;
    for (const int type : {VTK_FLOAT, VTK_DOUBLE, VTK_INT}) {
        const Mesh mesh = sheet(4);
        vtkNew<vtkPoints> points;
        points->SetDataType(type);
        for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i) {
            const double* p = mesh->GetPoint(i);
            points->InsertNextPoint(2 * p[0], 2 * p[1], 0);
        }
        mesh->SetPoints(points);
        vtkNew<Filter> filter;
        filter->SetInputData(mesh);
        filter->Update();
        if (first.empty()) first = everything(filter->GetOutput());
        EXPECT_EQ(everything(filter->GetOutput()), first) << type;
    }
    // Coordinates whose components are apart.
    const Mesh mesh = sheet(4);
    vtkNew<vtkSOADataArrayTemplate<float>> apart;
    apart->SetName("TextureCoordinates");
    apart->SetNumberOfComponents(2);
    apart->SetNumberOfTuples(mesh->GetNumberOfPoints());
    for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
        apart->SetTuple(i, mesh->GetPointData()->GetTCoords()->GetTuple2(i));
    vtkNew<Filter> filter;
    filter->SetInputData(mesh);
    filter->Update();
    const std::vector<double> packed = everything(filter->GetOutput());
    mesh->GetPointData()->SetTCoords(apart);
    filter->Modified();
    filter->Update();
    EXPECT_EQ(everything(filter->GetOutput()), packed);
}

TEST(VtkNonlinearTexture, EmptyMeshesAndBlocks) {
    vtkNew<Filter> filter;
    Errors errors(filter);
    filter->SetInputData(vtkNew<vtkPolyData>());
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    EXPECT_EQ(filter->GetOutput()->GetNumberOfCells(), 0);
    vtkNew<vtkMultiBlockDataSet> blocks;
    blocks->SetNumberOfBlocks(3);
    blocks->SetBlock(0, sheet());
    blocks->SetBlock(2, vtkNew<vtkPolyData>());
    vtkNew<Filter> of_blocks;
    Errors block_errors(of_blocks);
    of_blocks->SetInputDataObject(blocks);
    of_blocks->Update();
    EXPECT_EQ(block_errors.text(), "");
    auto* out = vtkMultiBlockDataSet::SafeDownCast(of_blocks->GetOutputDataObject(0));
    ASSERT_TRUE(out);
    EXPECT_GT(vtkPolyData::SafeDownCast(out->GetBlock(0))->GetNumberOfCells(), 1000);
    EXPECT_EQ(out->GetBlock(1), nullptr);
    vtkNew<vtkPartitionedDataSet> part;
    part->SetPartition(0, sheet());
    vtkNew<vtkPartitionedDataSetCollection> collection;
    collection->SetPartitionedDataSet(0, part);
    vtkNew<Filter> of_parts;
    of_parts->SetInputDataObject(collection);
    of_parts->Update();
    auto* parts = vtkPartitionedDataSetCollection::SafeDownCast(of_parts->GetOutputDataObject(0));
    ASSERT_TRUE(parts);
    EXPECT_GT(vtkPolyData::SafeDownCast(parts->GetPartitionAsDataObject(0, 0))->GetNumberOfCells(), 1000);
}

TEST(VtkNonlinearTexture, AnyNumberOfThreadsGivesTheSameBits) {
    std::vector<double> first;
    for_any_threads([&] {
        vtkNew<Filter> filter;
        filter->SetInputData(sheet());
        filter->Update();
        const std::vector<double> found = everything(filter->GetOutput());
        if (first.empty()) first = found;
        EXPECT_EQ(found, first);
    });
    EXPECT_GT(first.size(), 1000u);
}

TEST(VtkNonlinearTexture, RefusesInWords) {
    vtkNew<Filter> alone;
    Errors missing(alone);
    alone->Update();
    EXPECT_THAT(missing.text(), HasSubstr("the mesh is not given: input port 0 must be connected"));
    for (const double tol : {0.0, -1.0, kNan, kInf, 1e7})
        EXPECT_THAT(errors_of<Filter>(sheet(), [&](Filter* f) { f->SetTolerance(tol); }), HasSubstr("tol="));
    for (const int size : {0, -3, VTK_INT_MAX, VTK_INT_MIN}) {
        EXPECT_THAT(
            errors_of<Filter>(sheet(), [&](Filter* f) { f->SetTextureWidth(size); }),
            HasSubstr("texture_width=" + std::to_string(size) + ": must be an integer from 1 to 1048576"));
        EXPECT_THAT(errors_of<Filter>(sheet(), [&](Filter* f) { f->SetTextureHeight(size); }),
                    HasSubstr("texture_height="));
    }
    EXPECT_THAT(errors_of<Filter>(sheet(), [](Filter* f) { f->SetTolerance(1e-12); }),
                HasSubstr("tol=1e-12: must be larger: texture coordinates as large"));
    const Mesh without = sheet();
    without->GetPointData()->SetTCoords(nullptr);
    EXPECT_THAT(errors_of<Filter>(without), HasSubstr("the mesh has no texture coordinates"));
    for (const int components : {1, 3}) {
        const Mesh other = sheet();
        vtkNew<vtkFloatArray> array;
        array->SetName("st");
        array->SetNumberOfComponents(components);
        array->SetNumberOfTuples(other->GetNumberOfPoints());
        array->Fill(0);
        other->GetPointData()->SetTCoords(array);
        EXPECT_THAT(errors_of<Filter>(other),
                    HasSubstr("st=" + std::to_string(components) + " components: must"));
    }
}

TEST(VtkNonlinearTexture, ProgressRisesTo1AndAbortEmptiesTheOutput) {
    vtkNew<Filter> filter;
    filter->SetInputData(sheet(20));
    filter->SetTolerance(0.5);
    vtkNew<ProgressObserver> progress;
    progress->algorithm = filter;
    filter->AddObserver(vtkCommand::ProgressEvent, progress);
    filter->Update();
    ASSERT_GT(progress->reports.size(), 3u);
    EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
    EXPECT_EQ(progress->reports.back(), 1);
    progress->abort_at = 0.3;
    filter->Modified();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
    filter->SetAbortExecute(0);
}

TEST(VtkNonlinearTexture, CountsModificationsExecutesOnceAndPrints) {
    vtkNew<Filter> filter;
    expect_modified_by<Filter>(
        filter, {[](Filter* f) { f->SetTextureWidth(30); }, [](Filter* f) { f->SetTextureHeight(20); },
                 [](Filter* f) { f->SetTolerance(3); }});
    expect_printed(filter, {"TextureWidth: 30", "TextureHeight: 20", "Tolerance: 3"});
    filter->SetInputData(sheet());
    expect_executed_once(filter);
    expect_overridden<Filter>("vtkAnamorphNonlinearTexture");
}

}  // namespace
}  // namespace test_nonlinear_texture
