// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphInbetween.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphReliefSource.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkHyperTreeGrid.h>
#include <vtkIdTypeArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkIntArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataAlgorithm.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkSphereSource.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringArray.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <cmath>
#include <initializer_list>
#include <random>

#include "anamorph/deform/key_frames.h"
#include "support.h"

namespace test_inbetween {
namespace {

using Executive = vtkStreamingDemandDrivenPipeline;
using testing::HasSubstr;
using Shape = vtkSmartPointer<vtkPolyData>;

Shape sphere(int resolution = 12) {
    vtkNew<vtkSphereSource> source;
    source->SetThetaResolution(resolution);
    source->SetPhiResolution(resolution);
    source->Update();
    return source->GetOutput();
}

/// A copy with the connectivity of `shape` and random points.
Shape moved(vtkPolyData* shape, unsigned seed, int type = VTK_FLOAT) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> offset(-1, 1);
    auto result = Shape::New();
    result->ShallowCopy(shape);
    vtkNew<vtkPoints> points;
    points->SetDataType(type);
    for (vtkIdType i = 0; i < shape->GetNumberOfPoints(); ++i) {
        double x[3];
        shape->GetPoint(i, x);
        points->InsertNextPoint(x[0] + offset(random), x[1] + offset(random), x[2] + offset(random));
    }
    result->SetPoints(points);
    return result;
}

void add_inputs(vtkAnamorphInbetween* filter, const std::vector<Shape>& shapes) {
    for (const Shape& shape : shapes) filter->AddInputData(shape);
}

void set_weights(vtkAnamorphInbetween* filter, const std::vector<double>& weights) {
    filter->SetNumberOfWeights(static_cast<int>(weights.size()));
    for (std::size_t i = 0; i < weights.size(); ++i) filter->SetWeight(static_cast<int>(i), weights[i]);
}

vtkPolyData* surface_of(vtkAnamorphInbetween* filter) {
    return vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0));
}

/// Eq. (4.3), rounded to float.
std::vector<double> sum_of(const std::vector<Shape>& shapes, const std::vector<double>& weights) {
    std::vector<double> sum(coordinates(shapes[0]).size());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const std::vector<double> x = coordinates(shapes[i]);
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weights[i] * x[k];
    }
    return sum;
}

void expect_near(const std::vector<double>& got, const std::vector<double>& wanted, double most) {
    ASSERT_EQ(got.size(), wanted.size());
    ASSERT_FALSE(got.empty());
    for (std::size_t i = 0; i < got.size(); ++i) ASSERT_NEAR(got[i], wanted[i], most) << i;
}

TEST(VtkInbetween, AddsShapesByWeightsWithinAndOutsideOf0To1) {
    const Shape base = sphere();
    const std::vector<Shape> shapes{base, moved(base, 1), moved(base, 2)};
    for (const std::vector<double>& weights :
         {std::vector<double>{0.25, 0.25, 0.5}, {1, 0, 0}, {2.5, -3, 1.5}}) {
        vtkNew<vtkAnamorphInbetween> filter;
        add_inputs(filter, shapes);
        set_weights(filter, weights);
        filter->Update();
        expect_near(coordinates(surface_of(filter)), sum_of(shapes, weights), 1e-6);
    }
}

TEST(VtkInbetween, WithoutWeightsEveryInputHasTheSame) {
    const Shape base = sphere();
    const std::vector<Shape> shapes{base, moved(base, 1), moved(base, 2), moved(base, 3)};
    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, shapes);
    filter->Update();
    expect_near(coordinates(surface_of(filter)), sum_of(shapes, {0.25, 0.25, 0.25, 0.25}), 1e-6);
    filter->SetModeToDeltas();
    filter->Update();
    EXPECT_EQ(coordinates(surface_of(filter)), coordinates(base));
}

TEST(VtkInbetween, WeightsThatDoNotSumTo1AreAnErrorOrAreNormalized) {
    const Shape base = sphere();
    const std::vector<Shape> shapes{base, moved(base, 1)};
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    add_inputs(filter, shapes);
    set_weights(filter, {3, 1});
    filter->Update();
    EXPECT_THAT(errors.text(), HasSubstr("weights=sum 4: the sum must be 1"));
    EXPECT_EQ(surface_of(filter)->GetNumberOfPoints(), 0);
    errors.clear();
    filter->NormalizeWeightsOn();
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    expect_near(coordinates(surface_of(filter)), sum_of(shapes, {0.75, 0.25}), 1e-6);
    set_weights(filter, {1, -1});
    filter->Update();
    EXPECT_THAT(errors.text(), HasSubstr("weights=sum 0: cannot be normalized"));
}

TEST(VtkInbetween, WeightsThatAreRefusedAreNamed) {
    const Shape base = sphere();
    const struct {
        std::vector<double> weights;
        const char* message;
    } cases[] = {{{1}, "Weights=1 numbers: must be none, or one for each input, 2"},
                 {{1, 0, 0}, "Weights=3 numbers"},
                 {{kNan, 1}, "weights[0]=nan"},
                 {{1, kInf}, "weights[1]=inf"}};
    for (const auto& c : cases) {
        vtkNew<vtkAnamorphInbetween> filter;
        Errors errors(filter);
        add_inputs(filter, {base, moved(base, 1)});
        set_weights(filter, c.weights);
        filter->Update();
        EXPECT_THAT(errors.text(), HasSubstr(c.message));
        EXPECT_EQ(surface_of(filter)->GetNumberOfPoints(), 0);
    }
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    add_inputs(filter, {base, base});
    for (const int index : {-1, 2}) {
        filter->SetBaseIndex(index);
        filter->Update();
        EXPECT_THAT(errors.text(),
                    HasSubstr("BaseIndex=" + std::to_string(index) + ": must be an input from 0 to 1"));
    }
}

TEST(VtkInbetween, OneInputIsPassed) {
    const Shape base = sphere();
    vtkNew<vtkAnamorphInbetween> filter;
    filter->SetInputData(base);
    filter->Update();
    EXPECT_EQ(coordinates(surface_of(filter)), coordinates(base));
    filter->SetWeight(0, 2);
    filter->NormalizeWeightsOn();
    filter->Update();
    EXPECT_EQ(coordinates(surface_of(filter)), coordinates(base));
    filter->SetModeToDeltas();
    filter->Update();
    EXPECT_EQ(coordinates(surface_of(filter)), coordinates(base));
}

TEST(VtkInbetween, NoInputIsAnErrorAndNoCrash) {
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    filter->Update();
    EXPECT_NE(errors.text(), "");
}

TEST(VtkInbetween, EmptyInputsGiveEmptyOutputs) {
    const vtkSmartPointer<vtkPointSet> empties[] = {vtkSmartPointer<vtkPolyData>::New(),
                                                    vtkSmartPointer<vtkUnstructuredGrid>::New(),
                                                    vtkSmartPointer<vtkStructuredGrid>::New()};
    for (const auto& empty : empties) {
        vtkNew<vtkAnamorphInbetween> filter;
        Errors errors(filter);
        vtkNew<ProgressObserver> progress;
        filter->AddObserver(vtkCommand::ProgressEvent, progress);
        const auto other = vtk::TakeSmartPointer(empty->NewInstance());
        filter->AddInputData(empty);
        filter->AddInputData(other);
        filter->Update();
        EXPECT_EQ(errors.text(), "");
        ASSERT_TRUE(filter->GetOutputDataObject(0));
        EXPECT_STREQ(filter->GetOutputDataObject(0)->GetClassName(), empty->GetClassName());
        EXPECT_EQ(progress->reports.back(), 1);
    }
}

// ---- Deltas and masks ----

vtkSmartPointer<vtkDataArray> array_of(int type, const char* name, int components, vtkIdType tuples,
                                       double value) {
    const auto array = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(type));
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(tuples);
    for (int c = 0; c < components; ++c) array->FillComponent(c, value + c);
    return array;
}

/// A mask of one number for each point, in [-1, 2].
vtkSmartPointer<vtkDataArray> add_mask(vtkPolyData* shape, const char* name, int type = VTK_FLOAT) {
    const auto mask = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(type));
    mask->SetName(name);
    for (vtkIdType i = 0; i < shape->GetNumberOfPoints(); ++i)
        mask->InsertNextTuple1(static_cast<double>(i % 4) - 1);
    shape->GetPointData()->AddArray(mask);
    return mask;
}

TEST(VtkInbetween, DeltasAreSeenInTheirRegions) {
    const Shape base = sphere();
    const std::vector<Shape> shapes{moved(base, 1), base, moved(base, 2)};
    add_mask(base, "of the base");
    add_mask(shapes[2], "of the shape", VTK_INT);
    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, shapes);
    filter->SetModeToDeltas();
    filter->SetBaseIndex(1);
    set_weights(filter, {0.5, 77, -2});
    const auto expected = [&](bool first_masked, bool second_masked) {
        std::vector<double> x = coordinates(base);
        for (std::size_t k = 0; k < x.size(); ++k) {
            const double mask = static_cast<double>(k / 3 % 4) - 1, from = x[k];
            x[k] += 0.5 * (first_masked ? mask : 1) * (coordinates(shapes[0])[k] - from);
            x[k] += -2 * (second_masked ? mask : 1) * (coordinates(shapes[2])[k] - from);
        }
        return x;
    };
    filter->Update();
    expect_near(coordinates(surface_of(filter)), expected(false, false), 3e-6);
    filter->SetMaskArrayName(0, "of the base");
    filter->SetMaskArrayName(2, "of the shape");
    filter->Update();
    expect_near(coordinates(surface_of(filter)), expected(true, true), 3e-6);
    filter->SetMaskArrayName(0, "");
    filter->Update();
    expect_near(coordinates(surface_of(filter)), expected(false, true), 3e-6);
}

TEST(VtkInbetween, MasksReachAllPointsOfLargeSurfaces) {
    const Shape base = sphere(540);  // more than a stretch
    const Shape shape = Shape::New();
    shape->ShallowCopy(base);
    vtkNew<vtkPoints> points;
    points->DeepCopy(base->GetPoints());
    for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i) points->SetPoint(i, 7, 8, 9);
    shape->SetPoints(points);
    const auto mask = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(VTK_FLOAT));
    mask->SetName("mask");
    for (vtkIdType i = 0; i < base->GetNumberOfPoints(); ++i) mask->InsertNextTuple1(i % 4099 == 7);
    base->GetPointData()->AddArray(mask);
    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, {base, shape});
    filter->SetModeToDeltas();
    set_weights(filter, {0, 1});
    filter->SetMaskArrayName(1, "mask");
    filter->Update();
    const std::vector<double> from = coordinates(base), got = coordinates(surface_of(filter));
    ASSERT_GT(from.size(), std::size_t{3} << 18);
    for (std::size_t i = 0; i < from.size(); ++i)
        ASSERT_EQ(got[i], i / 3 % 4099 == 7 ? 7 + static_cast<double>(i % 3) : from[i]) << i;
}

TEST(VtkInbetween, MasksOfCellsAreMeansOfTheirPoints) {
    const Shape base = sphere();
    const Shape shape = moved(base, 1);
    for (const Shape& s : {base, shape}) {
        vtkNew<vtkDoubleArray> array;
        array->SetName("temperature");
        for (vtkIdType i = 0; i < s->GetNumberOfCells(); ++i) array->InsertNextValue(s == base ? 1 : 11);
        s->GetCellData()->AddArray(array);
    }
    add_mask(base, "mask");
    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, {base, shape});
    filter->SetModeToDeltas();
    set_weights(filter, {0, 1});
    filter->SetMaskArrayName(1, "mask");
    filter->Update();
    vtkDataArray* got = surface_of(filter)->GetCellData()->GetArray("temperature");
    ASSERT_TRUE(got);
    vtkNew<vtkIdList> points;
    for (vtkIdType i = 0; i < base->GetNumberOfCells(); ++i) {
        base->GetCellPoints(i, points);
        double mean = 0;
        for (const vtkIdType id : *points)
            mean += (static_cast<double>(id % 4) - 1) / static_cast<double>(points->GetNumberOfIds());
        EXPECT_NEAR(got->GetComponent(i, 0), 1 + 10 * mean, 1e-5);
    }
}

TEST(VtkInbetween, MasksThatAreRefusedAreNamed) {
    const Shape base = sphere();
    const Shape shape = moved(base, 1);
    vtkNew<vtkFloatArray> pairs;
    pairs->SetName("pairs");
    pairs->SetNumberOfComponents(2);
    pairs->SetNumberOfTuples(base->GetNumberOfPoints());
    base->GetPointData()->AddArray(pairs);
    add_mask(base, "nan", VTK_DOUBLE)->SetComponent(5, 0, kNan);
    add_mask(base, "large", VTK_DOUBLE)->SetComponent(6, 0, 1e300);
    const std::pair<const char*, const char*> cases[] = {
        {"nothing", "Masks[1]=nothing: neither the base nor input 1 has"},
        {"pairs", "Masks[1]=pairs: must be one number for each point"},
        {"nan", "Masks[1]=nan: it is nan at point 5"},
        {"large", "Masks[1]=large: it is 1e+300 at point 6"}};
    for (const auto& [name, message] : cases) {
        vtkNew<vtkAnamorphInbetween> filter;
        Errors errors(filter);
        add_inputs(filter, {base, shape});
        filter->SetModeToDeltas();
        filter->SetMaskArrayName(1, name);
        filter->Update();
        EXPECT_THAT(errors.text(), HasSubstr(message));
    }
}

// ---- Topology ----

std::string error_of(const std::vector<vtkSmartPointer<vtkDataObject>>& inputs, int base = 0) {
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    filter->SetBaseIndex(base);
    for (const auto& input : inputs) filter->AddInputDataObject(input);
    filter->Update();
    return errors.text();
}

TEST(VtkInbetween, TheInputThatDiffersIsNamedAndWhere) {
    const Shape base = sphere();
    const Shape copy = Shape::New();
    copy->DeepCopy(base);
    EXPECT_EQ(error_of({base, copy}), "");  // other arrays, the same numbers

    EXPECT_THAT(error_of({base, base, sphere(13)}),
                HasSubstr("input 2 has 145 points, not 122 (compared with input 0)"));
    EXPECT_THAT(error_of({sphere(13), base, base}, 2),
                HasSubstr("input 0 has 145 points, not 122 (compared with input 2)"));

    const Shape other = Shape::New();
    other->DeepCopy(base);
    vtkNew<vtkIdList> points;
    other->GetPolys()->GetCellAtId(7, points);
    std::swap(*points->GetPointer(0), *points->GetPointer(1));
    other->GetPolys()->ReplaceCellAtId(7, points);
    EXPECT_THAT(error_of({base, other}), HasSubstr("input 1 has other points in number 7 of its polygons"));

    const Shape fewer = Shape::New();
    fewer->ShallowCopy(base);
    vtkNew<vtkCellArray> one;
    one->InsertNextCell({0, 1, 2});
    fewer->SetPolys(one);
    EXPECT_THAT(error_of({base, fewer}), HasSubstr("input 1 has 1 polygons, not 240"));
    EXPECT_THAT(error_of({fewer, base}), HasSubstr("input 1 has 240 polygons, not 1"));
    const Shape lines = Shape::New();
    lines->ShallowCopy(base);
    lines->SetLines(one);
    EXPECT_THAT(error_of({base, lines}), HasSubstr("input 1 has 1 lines, not 0"));
    const Shape others = Shape::New();
    others->ShallowCopy(base);
    others->SetVerts(one);
    EXPECT_THAT(error_of({base, others}), HasSubstr("input 1 has 1 vertices, not 0"));
    others->SetVerts(nullptr);
    others->SetStrips(one);
    EXPECT_THAT(error_of({base, others}), HasSubstr("input 1 has 1 strips, not 0"));

    EXPECT_THAT(error_of({base, vtkSmartPointer<vtkUnstructuredGrid>::New()}),
                HasSubstr("input 1 is a vtkUnstructuredGrid, not a vtkPolyData"));
}

TEST(VtkInbetween, ADifferenceIsFoundAnywhereInALargeSurface) {
    const Shape base = sphere(120), copy = Shape::New(), narrow = Shape::New();
    copy->DeepCopy(base);
    narrow->DeepCopy(base);
    narrow->GetPolys()->ConvertTo32BitStorage();
    EXPECT_EQ(error_of({base, copy, narrow}), "");
    const vtkIdType cells = base->GetNumberOfPolys();
    // 3 numbers of 8 bytes a cell: in the first piece that is compared, on both sides of a border of pieces, and in the last.
    for (const vtkIdType cell : {vtkIdType{0}, vtkIdType{2730}, vtkIdType{2731}, cells / 2, cells - 1}) {
        const Shape other = Shape::New();
        other->DeepCopy(base);
        vtkNew<vtkIdList> points;
        other->GetPolys()->GetCellAtId(cell, points);
        std::swap(*points->GetPointer(1), *points->GetPointer(2));
        other->GetPolys()->ReplaceCellAtId(cell, points);
        EXPECT_THAT(
            error_of({base, copy, other, narrow}),
            HasSubstr("input 2 has other points in number " + std::to_string(cell) + " of its polygons"));
    }
    // The same points in all, but of other cells.
    const Shape joined = Shape::New();
    joined->DeepCopy(base);
    auto* offsets = joined->GetPolys()->GetOffsetsArray64();
    offsets->SetValue(cells - 1, offsets->GetValue(cells - 1) + 1);
    EXPECT_THAT(error_of({base, joined}), HasSubstr("input 1 has other points in number " +
                                                    std::to_string(cells - 2) + " of its polygons"));
}

vtkSmartPointer<vtkUnstructuredGrid> unstructured(int type, std::initializer_list<vtkIdType> ids) {
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    vtkNew<vtkPoints> points;
    for (int i = 0; i < 8; ++i) points->InsertNextPoint(i & 1, i >> 1 & 1, i >> 2);
    grid->SetPoints(points);
    const std::vector<vtkIdType> list(ids);
    if (type == VTK_POLYHEDRON) {
        vtkNew<vtkIdList> faces;  // a tetrahedron; the last face is given
        for (const vtkIdType id : {4, 3, 0, 1, 2, 3, 0, 1, 4, 3, 1, 2, 4, 3}) faces->InsertNextId(id);
        for (const vtkIdType id : ids) faces->InsertNextId(id);
        grid->InsertNextCell(type, faces);
    } else {
        grid->InsertNextCell(type, static_cast<vtkIdType>(list.size()), list.data());
    }
    return grid;
}

TEST(VtkInbetween, GridsAreComparedByTypeOfCellPointsAndFaces) {
    const auto tetra = unstructured(VTK_TETRA, {0, 1, 2, 4});
    EXPECT_EQ(error_of({tetra, unstructured(VTK_TETRA, {0, 1, 2, 4})}), "");
    EXPECT_THAT(error_of({tetra, unstructured(VTK_QUAD, {0, 1, 2, 4})}),
                HasSubstr("input 1 has another type of cell 0"));
    EXPECT_THAT(error_of({tetra, unstructured(VTK_TETRA, {0, 1, 2, 5})}),
                HasSubstr("input 1 has other points in number 0 of its cells"));
    const auto solid = unstructured(VTK_POLYHEDRON, {2, 0, 4});
    EXPECT_EQ(error_of({solid, unstructured(VTK_POLYHEDRON, {2, 0, 4})}), "");
    EXPECT_THAT(error_of({solid, unstructured(VTK_POLYHEDRON, {0, 2, 4})}),
                HasSubstr("input 1 has other faces at cell 0"));

    vtkNew<vtkStructuredGrid> wide, high;
    vtkNew<vtkPoints> points;
    points->SetNumberOfPoints(6);
    for (int i = 0; i < 6; ++i) points->SetPoint(i, i, 0, 0);
    wide->SetDimensions(3, 2, 1);
    high->SetDimensions(2, 3, 1);
    wide->SetPoints(points);
    high->SetPoints(points);
    EXPECT_EQ(error_of({wide.Get(), wide.Get()}), "");
    EXPECT_THAT(error_of({wide.Get(), high.Get()}),
                HasSubstr("input 1 is a grid of another extent than input 0"));
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    filter->AddInputData(wide);
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    filter->AddInputData(high);
    filter->Update();
    EXPECT_NE(errors.text(), "");
    auto* grid = vtkStructuredGrid::SafeDownCast(filter->GetOutputDataObject(0));
    EXPECT_EQ(grid->GetNumberOfPoints(), 0);  // not what was there before
    filter->RemoveInputConnection(0, 1);
    filter->Update();
    EXPECT_EQ(grid->GetNumberOfPoints(), 6);
}

TEST(VtkInbetween, WhatWasComparedIsComparedAgainAfterAChange) {
    const Shape base = sphere(), shape = Shape::New();
    shape->DeepCopy(base);
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    add_inputs(filter, {base, shape});
    filter->Update();
    ASSERT_EQ(errors.text(), "");
    vtkNew<vtkIdList> points;
    shape->GetPolys()->GetCellAtId(3, points);
    std::swap(*points->GetPointer(0), *points->GetPointer(1));
    shape->GetPolys()->ReplaceCellAtId(3, points);
    shape->Modified();
    filter->Update();
    EXPECT_THAT(errors.text(), HasSubstr("input 1 has other points in number 3 of its polygons"));
}

TEST(VtkInbetween, ConnectivityIsSharedAndInputsAreNotChanged) {
    const Shape base = sphere();
    const std::vector<Shape> shapes{base, moved(base, 1), moved(base, 2)};
    std::vector<std::vector<double>> before;
    std::vector<vtkMTimeType> times;
    for (const Shape& s : shapes) {
        before.push_back(coordinates(s));
        times.push_back(s->GetMTime());
    }
    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, shapes);
    filter->Update();
    EXPECT_EQ(surface_of(filter)->GetPolys(), base->GetPolys());
    EXPECT_NE(surface_of(filter)->GetPoints(), base->GetPoints());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        EXPECT_EQ(coordinates(shapes[i]), before[i]);
        EXPECT_EQ(shapes[i]->GetMTime(), times[i]);
    }
}

// ---- Numbers ----

TEST(VtkInbetween, NanAndInfStayInTheirPointsAndWeight0DoesNotReadThem) {
    const Shape base = sphere();
    const Shape shape = moved(base, 1);
    shape->GetPoints()->SetPoint(7, kNan, 0, 0);
    shape->GetPoints()->SetPoint(9, 0, kInf, 0);
    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, {base, shape});
    const auto not_finite = [&] {
        std::vector<std::size_t> result;
        const std::vector<double> x = coordinates(surface_of(filter));
        for (std::size_t i = 0; i < x.size(); ++i)
            if (!std::isfinite(x[i])) result.push_back(i);
        return result;
    };
    filter->Update();
    EXPECT_THAT(not_finite(), testing::ElementsAre(21, 28));
    set_weights(filter, {1, 0});
    filter->Update();
    EXPECT_THAT(not_finite(), testing::IsEmpty());
}

TEST(VtkInbetween, PointsOfAnyTypeAndPrecision) {
    const Shape base = sphere();
    const Shape single = moved(base, 1), twofold = moved(base, 2, VTK_DOUBLE);
    const Shape whole = Shape::New();
    whole->ShallowCopy(base);
    vtkNew<vtkPoints> integers;
    integers->SetDataTypeToInt();
    for (vtkIdType i = 0; i < base->GetNumberOfPoints(); ++i) integers->InsertNextPoint(i, -i, 3);
    whole->SetPoints(integers);
    const Shape apart = Shape::New();
    apart->ShallowCopy(base);
    vtkNew<vtkSOADataArrayTemplate<double>> columns;
    columns->SetNumberOfComponents(3);
    for (vtkIdType i = 0; i < base->GetNumberOfPoints(); ++i)
        columns->InsertNextTuple3(0.1 * static_cast<double>(i), 1, 2);
    vtkNew<vtkPoints> points;
    points->SetData(columns);
    apart->SetPoints(points);

    const struct {
        std::vector<Shape> shapes;
        int asked, type;
    } cases[] = {{{base, single}, vtkAlgorithm::DEFAULT_PRECISION, VTK_FLOAT},
                 {{base, single}, vtkAlgorithm::DOUBLE_PRECISION, VTK_DOUBLE},
                 {{base, twofold}, vtkAlgorithm::DEFAULT_PRECISION, VTK_DOUBLE},
                 {{twofold, twofold}, vtkAlgorithm::SINGLE_PRECISION, VTK_FLOAT},
                 {{single, whole}, vtkAlgorithm::DEFAULT_PRECISION, VTK_DOUBLE},
                 {{whole, apart}, vtkAlgorithm::DEFAULT_PRECISION, VTK_DOUBLE}};
    for (const auto& c : cases) {
        vtkNew<vtkAnamorphInbetween> filter;
        add_inputs(filter, c.shapes);
        set_weights(filter, {0.25, 0.75});
        filter->SetOutputPointsPrecision(c.asked);
        filter->Update();
        EXPECT_EQ(surface_of(filter)->GetPoints()->GetDataType(), c.type);
        expect_near(coordinates(surface_of(filter)), sum_of(c.shapes, {0.25, 0.75}),
                    c.type == VTK_FLOAT ? 1e-6 : 1e-12);
    }
}

TEST(VtkInbetween, TheSameBitsForAnyThreadsAndBackend) {
    const Shape base = sphere(200);
    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, {base, moved(base, 1), moved(base, 2)});
    set_weights(filter, {0.3, 1.1, -0.4});
    filter->Update();
    const std::vector<double> points = coordinates(surface_of(filter)),
                              normals = numbers(surface_of(filter)->GetPointData()->GetNormals());
    ASSERT_FALSE(normals.empty());
    for_any_threads([&] {
        filter->Modified();
        filter->Update();
        ASSERT_EQ(coordinates(surface_of(filter)), points);
        ASSERT_EQ(numbers(surface_of(filter)->GetPointData()->GetNormals()), normals);
    });
}

// ---- Arrays ----

TEST(VtkInbetween, FloatingArraysThatAllHaveAreBlendedAndOthersPassedFromTheBase) {
    const Shape base = sphere();
    const Shape shape = moved(base, 1);
    const vtkIdType points = base->GetNumberOfPoints(), cells = base->GetNumberOfCells();
    vtkPointData *a = base->GetPointData(), *b = shape->GetPointData();
    a->AddArray(array_of(VTK_FLOAT, "float", 2, points, 1));
    b->AddArray(array_of(VTK_FLOAT, "float", 2, points, 5));
    a->GetArray("float")->SetComponentName(1, "second");
    a->SetActiveScalars("float");
    a->AddArray(array_of(VTK_FLOAT, "mixed", 1, points, 1));
    b->AddArray(array_of(VTK_DOUBLE, "mixed", 1, points, 5));
    a->AddArray(array_of(VTK_INT, "whole", 1, points, 1));
    b->AddArray(array_of(VTK_INT, "whole", 1, points, 5));
    a->AddArray(array_of(VTK_FLOAT, "base only", 1, points, 1));
    b->AddArray(array_of(VTK_FLOAT, "shape only", 1, points, 1));
    a->AddArray(array_of(VTK_FLOAT, "other size", 1, points, 1));
    b->AddArray(array_of(VTK_FLOAT, "other size", 2, points, 5));
    a->AddArray(array_of(VTK_FLOAT, "too long", 1, points + 1, 1));
    b->AddArray(array_of(VTK_FLOAT, "too long", 1, points + 1, 5));
    a->AddArray(array_of(VTK_UNSIGNED_CHAR, "vtkGhostType", 1, points, 0));
    a->SetGlobalIds(array_of(VTK_ID_TYPE, "ids", 1, points, 3));
    base->GetCellData()->AddArray(array_of(VTK_DOUBLE, "cells", 1, cells, 1));
    shape->GetCellData()->AddArray(array_of(VTK_DOUBLE, "cells", 1, cells, 5));
    const auto shared = array_of(VTK_DOUBLE, "shared", 1, cells, 1);
    base->GetCellData()->AddArray(shared);
    shape->GetCellData()->AddArray(shared);
    vtkNew<vtkStringArray> names;
    names->SetName("names");
    names->SetNumberOfValues(points);
    a->AddArray(names);
    base->GetFieldData()->AddArray(array_of(VTK_DOUBLE, "field", 1, 3, 1));

    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, {base, shape});
    set_weights(filter, {0.25, 0.75});
    filter->Update();
    vtkPointData* out = surface_of(filter)->GetPointData();
    EXPECT_EQ(out->GetNumberOfArrays(), a->GetNumberOfArrays());
    EXPECT_EQ(out->GetArray("float")->GetTuple2(3)[0], 4);
    EXPECT_EQ(out->GetArray("float")->GetTuple2(3)[1], 5);
    EXPECT_EQ(out->GetArray("float")->GetDataType(), VTK_FLOAT);
    EXPECT_STREQ(out->GetArray("float")->GetComponentName(1), "second");
    EXPECT_EQ(out->GetScalars(), out->GetArray("float"));
    EXPECT_EQ(out->GetArray("mixed")->GetTuple1(3), 4);
    EXPECT_EQ(out->GetArray("mixed")->GetDataType(), VTK_DOUBLE);
    for (const char* name : {"whole", "base only", "other size", "too long", "names", "ids", "vtkGhostType"})
        EXPECT_EQ(out->GetAbstractArray(name), a->GetAbstractArray(name)) << name;
    EXPECT_EQ(out->GetGlobalIds(), a->GetGlobalIds());
    EXPECT_FALSE(out->GetArray("shape only"));
    EXPECT_EQ(surface_of(filter)->GetCellData()->GetArray("cells")->GetTuple1(3), 4);
    EXPECT_EQ(surface_of(filter)->GetCellData()->GetArray("shared"), shared);
    EXPECT_TRUE(surface_of(filter)->GetFieldData()->GetArray("field"));
}

TEST(VtkInbetween, NormalsAreMadeUnitLengthOrDropped) {
    const Shape base = sphere();
    const Shape shape = moved(base, 1);
    const auto normals = array_of(VTK_FLOAT, "Normals", 3, base->GetNumberOfPoints(), 0);
    for (vtkIdType i = 0; i < normals->GetNumberOfTuples(); ++i) normals->SetTuple3(i, 0, 0, 1);
    double opposite[3];
    base->GetPointData()->GetNormals()->GetTuple(4, opposite);
    normals->SetTuple3(4, -opposite[0], -opposite[1], -opposite[2]);
    shape->GetPointData()->SetNormals(normals);
    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, {base, shape});
    filter->Update();
    vtkDataArray* got = surface_of(filter)->GetPointData()->GetNormals();
    ASSERT_TRUE(got);
    for (vtkIdType i = 0; i < got->GetNumberOfTuples(); ++i) {
        double a[3], n[3];
        base->GetPointData()->GetNormals()->GetTuple(i, a);
        got->GetTuple(i, n);
        const double length = std::hypot(a[0], a[1], a[2] + 1);
        if (i == 4) {
            EXPECT_THAT(n, testing::ElementsAre(0, 0, 0));
        } else if (length > 1e-3) {
            EXPECT_NEAR(n[0], a[0] / length, 1e-5);
            EXPECT_NEAR(n[2], (a[2] + 1) / length, 1e-5);
        }
    }
    filter->SetNormals(vtkAnamorphInbetween::DROP_NORMALS);
    filter->Update();
    EXPECT_FALSE(surface_of(filter)->GetPointData()->GetNormals());
    EXPECT_TRUE(base->GetPointData()->GetNormals());

    // Those of one input only are not those of the blend.
    filter->SetNormals(vtkAnamorphInbetween::RENORMALIZE_NORMALS);
    shape->GetPointData()->RemoveArray("Normals");
    shape->Modified();
    filter->Update();
    EXPECT_FALSE(surface_of(filter)->GetPointData()->GetArray("Normals"));
    // Neither are those that have no name to be found by, as from NumPy.
    base->GetPointData()->GetNormals()->SetName(nullptr);
    base->Modified();
    filter->Update();
    EXPECT_FALSE(surface_of(filter)->GetPointData()->GetNormals());
    EXPECT_TRUE(base->GetPointData()->GetNormals());
}

// ---- Composites ----

TEST(VtkInbetween, BlocksAreBlendedAndMissingAndEmptyOnesStay) {
    const Shape base = sphere(), shape = moved(base, 1);
    vtkNew<vtkMultiBlockDataSet> inputs[2];
    for (int i = 0; i < 2; ++i) {
        vtkNew<vtkMultiBlockDataSet> nested;
        nested->SetBlock(0, i ? shape : base);
        inputs[i]->SetNumberOfBlocks(4);
        inputs[i]->SetBlock(1, i ? base : shape);
        inputs[i]->SetBlock(2, vtkNew<vtkPolyData>());
        inputs[i]->SetBlock(3, nested);
        inputs[i]->GetMetaData(1u)->Set(vtkCompositeDataSet::NAME(), "face");
        inputs[i]->GetFieldData()->AddArray(array_of(VTK_INT, "field", 1, 1, i));
    }
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    filter->AddInputDataObject(inputs[0]);
    filter->AddInputDataObject(inputs[1]);
    set_weights(filter, {0.25, 0.75});
    filter->Update();
    ASSERT_EQ(errors.text(), "");
    auto* output = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(output);
    ASSERT_EQ(output->GetNumberOfBlocks(), 4u);
    EXPECT_FALSE(output->GetBlock(0));
    EXPECT_STREQ(output->GetMetaData(1u)->Get(vtkCompositeDataSet::NAME()), "face");
    EXPECT_EQ(output->GetFieldData()->GetArray("field"), inputs[0]->GetFieldData()->GetArray("field"));
    expect_near(coordinates(vtkPolyData::SafeDownCast(output->GetBlock(1))),
                sum_of({shape, base}, {0.25, 0.75}), 1e-6);
    ASSERT_TRUE(output->GetBlock(2));
    EXPECT_EQ(vtkPolyData::SafeDownCast(output->GetBlock(2))->GetNumberOfPoints(), 0);
    auto* nested = vtkMultiBlockDataSet::SafeDownCast(output->GetBlock(3));
    ASSERT_TRUE(nested);
    expect_near(coordinates(vtkPolyData::SafeDownCast(nested->GetBlock(0))),
                sum_of({base, shape}, {0.25, 0.75}), 1e-6);

    filter->SetBaseIndex(1);
    filter->Update();
    EXPECT_EQ(output->GetFieldData()->GetArray("field"), inputs[1]->GetFieldData()->GetArray("field"));
    filter->SetBaseIndex(0);

    inputs[1]->SetBlock(1, sphere(13));
    inputs[1]->Modified();
    filter->Update();
    EXPECT_THAT(errors.text(), HasSubstr("block 2 of input 1 has 145 points, not 122"));
    errors.clear();
    inputs[1]->SetBlock(1, nullptr);
    filter->Update();
    EXPECT_THAT(errors.text(), HasSubstr("block 2 of input 1 is a missing piece, not a vtkPolyData"));
    errors.clear();
    inputs[1]->SetNumberOfBlocks(2);
    filter->Update();
    EXPECT_THAT(errors.text(), HasSubstr("input 1 has other blocks"));
}

TEST(VtkInbetween, CollectionsOfPartitionsAreBlended) {
    const Shape base = sphere(), shape = moved(base, 1);
    vtkNew<vtkPartitionedDataSetCollection> inputs[2];
    for (int i = 0; i < 2; ++i) {
        vtkNew<vtkPartitionedDataSet> parts;
        parts->SetPartition(0, i ? shape : base);
        parts->SetPartition(2, i ? base : shape);
        inputs[i]->SetPartitionedDataSet(1, parts);
    }
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    for (const auto& input : inputs) filter->AddInputDataObject(input);
    set_weights(filter, {0.25, 0.75});
    filter->Update();
    ASSERT_EQ(errors.text(), "");
    auto* output = vtkPartitionedDataSetCollection::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(output);
    ASSERT_EQ(output->GetNumberOfPartitionedDataSets(), 2u);
    ASSERT_EQ(output->GetNumberOfPartitions(1), 3u);
    expect_near(coordinates(vtkPolyData::SafeDownCast(output->GetPartition(1, 0))),
                sum_of({base, shape}, {0.25, 0.75}), 1e-6);
    EXPECT_FALSE(output->GetPartition(1, 1));
    expect_near(coordinates(vtkPolyData::SafeDownCast(output->GetPartition(1, 2))),
                sum_of({shape, base}, {0.25, 0.75}), 1e-6);

    vtkNew<vtkPartitionedDataSet> pictures;
    pictures->SetPartition(0, vtkNew<vtkHyperTreeGrid>());
    for (const auto& input : inputs) input->SetPartitionedDataSet(0, pictures);
    filter->Modified();
    filter->Update();
    EXPECT_THAT(errors.text(),
                HasSubstr("is a vtkHyperTreeGrid, not a point set, image data or a rectilinear grid"));
}

// ---- Time ----

/// Points at (t, 2, 3) for the time t that is asked for, of one triangle; from `change` on there are two.
class Clock : public vtkPolyDataAlgorithm {
  public:
    static Clock* New();
    vtkTypeMacro(Clock, vtkPolyDataAlgorithm);
    std::vector<double> steps, range;
    double change = 1e300;
    std::vector<double> asked;

  protected:
    Clock() { this->SetNumberOfInputPorts(0); }
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* out) override {
        vtkInformation* info = out->GetInformationObject(0);
        if (!steps.empty()) info->Set(Executive::TIME_STEPS(), steps.data(), static_cast<int>(steps.size()));
        if (!range.empty()) info->Set(Executive::TIME_RANGE(), range.data(), 2);
        return 1;
    }
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* out) override {
        vtkInformation* info = out->GetInformationObject(0);
        const double time =
            info->Has(Executive::UPDATE_TIME_STEP()) ? info->Get(Executive::UPDATE_TIME_STEP()) : -1;
        asked.push_back(time);
        auto* data = vtkPolyData::GetData(out);
        vtkNew<vtkPoints> points;
        vtkNew<vtkCellArray> polys;
        for (int k = 0; k < (time >= change ? 2 : 1); ++k) {
            for (int i = 0; i < 3; ++i) points->InsertNextPoint(time, 2, 3);
            polys->InsertNextCell({3 * k, 3 * k + 1, 3 * k + 2});
        }
        data->SetPoints(points);
        data->SetPolys(polys);
        data->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
        return 1;
    }
};
vtkStandardNewMacro(Clock);

std::vector<double> times_of(vtkAlgorithm* filter, vtkInformationDoubleVectorKey* key) {
    filter->UpdateInformation();
    vtkInformation* info = filter->GetOutputInformation(0);
    const double* values = info->Get(key);
    return values ? std::vector<double>(values, values + info->Length(key)) : std::vector<double>();
}

TEST(VtkInbetween, KeyFramesGiveTheWeightsOfAnyTime) {
    const Shape base = sphere();
    const std::vector<Shape> shapes{base, moved(base, 1), moved(base, 2)};
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    add_inputs(filter, shapes);
    set_weights(filter, {7, 7});  // not read
    // Shape 0 at 1, shape 1 at 2, half of shapes 0 and 2 at 4; given in another order.
    filter->AddKey(4, 2, 0.5);
    filter->AddKey(1, 0, 1);
    filter->AddKey(2, 1, 1);
    filter->AddKey(4, 0, 0.5);
    EXPECT_THAT(times_of(filter, Executive::TIME_STEPS()), testing::ElementsAre(1, 2, 4));
    EXPECT_THAT(times_of(filter, Executive::TIME_RANGE()), testing::ElementsAre(1, 4));

    const auto expect_weights = [&](double time, const std::vector<double>& weights) {
        SCOPED_TRACE(time);
        filter->UpdateTimeStep(time);
        expect_near(coordinates(surface_of(filter)), sum_of(shapes, weights), 1e-6);
        EXPECT_EQ(surface_of(filter)->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), time);
    };
    filter->Update();  // no time: the first key
    expect_near(coordinates(surface_of(filter)), sum_of(shapes, {1, 0, 0}), 1e-6);
    expect_weights(-5, {1, 0, 0});
    expect_weights(1, {1, 0, 0});
    expect_weights(1.25, {0.75, 0.25, 0});
    expect_weights(2, {0, 1, 0});
    expect_weights(3.5, {0.375, 0.25, 0.375});
    expect_weights(4, {0.5, 0, 0.5});
    expect_weights(99, {0.5, 0, 0.5});
    expect_weights(kInf, {0.5, 0, 0.5});

    filter->SetInterpolation(vtkAnamorphInbetween::STEP);
    expect_weights(3.9, {0, 1, 0});
    // Hermite from 1 to 2 at the middle: (v1 + v2) / 2 + (m1 - m2) / 8; slopes by the ends and by neighbours.
    filter->SetInterpolation(vtkAnamorphInbetween::CATMULL_ROM);
    const double m0 = (-1 - (0.5 - 1) / 3) / 8, m1 = 1.0 / 8, m2 = (0 - 0.5 / 3) / 8;
    expect_weights(1.5, {0.5 + m0, 0.5 + m1, m2});
    // Monotone: the weight of input 1 turns at 2, that of 0 too, so slopes there are 0; those of 2 start from
    // 0.
    filter->SetInterpolation(vtkAnamorphInbetween::MONOTONE_CUBIC);
    const double w0 = 0.5 - 1.0 / 8, w1 = 0.5 + 1.0 / 8;
    expect_weights(1.5, {w0 / (w0 + w1), w1 / (w0 + w1), 0});
    filter->UpdateTimeStep(3);
    EXPECT_EQ(errors.text(), "");
    filter->UpdateTimeStep(kNan);
    EXPECT_THAT(errors.text(), HasSubstr("time=nan"));

    filter->ClearKeys();
    set_weights(filter, {0, 0, 1});
    EXPECT_THAT(times_of(filter, Executive::TIME_STEPS()), testing::IsEmpty());
    EXPECT_THAT(times_of(filter, Executive::TIME_RANGE()), testing::IsEmpty());
    filter->Update();
    EXPECT_EQ(coordinates(surface_of(filter)), coordinates(shapes[2]));
}

TEST(VtkInbetween, MonotoneInterpolationIsNormalizedBetweenTheKeys) {
    const Shape base = sphere();
    const std::vector<Shape> shapes{base, moved(base, 1), moved(base, 2)};
    const std::vector<double> times{0, 1, 3, 4};
    const std::vector<std::vector<double>> weights{{1, 0, 0}, {0.5, 0.5, 0}, {0.3, 0.1, 0.6}, {0.2, 0, 0.8}};
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    add_inputs(filter, shapes);
    filter->SetInterpolation(vtkAnamorphInbetween::MONOTONE_CUBIC);
    for (std::size_t k = 0; k < times.size(); ++k)
        for (int i = 0; i < 3; ++i) filter->AddKey(times[k], i, weights[k][static_cast<std::size_t>(i)]);
    filter->UpdateTimeStep(2.2);
    std::vector<double> expected =
        anamorph::KeyFrames(times, weights, anamorph::KeyInterpolation::monotone_cubic).at(2.2);
    const double sum = expected[0] + expected[1] + expected[2];
    ASSERT_GT(std::fabs(sum - 1), 1e-3);
    for (double& w : expected) w /= sum;
    expect_near(coordinates(surface_of(filter)), sum_of(shapes, expected), 1e-6);
    EXPECT_EQ(errors.text(), "");
    filter->SetModeToDeltas();  // the base has the rest
    filter->UpdateTimeStep(2.2);
    for (double& w : expected) w *= sum;
    expected[0] = 1 - expected[1] - expected[2];
    expect_near(coordinates(surface_of(filter)), sum_of(shapes, expected), 1e-6);
}

TEST(VtkInbetween, KeysThatAreRefusedAreNamed) {
    struct Key {
        double time;
        int input;
        double weight;
    };
    const Shape base = sphere();
    const std::pair<std::vector<Key>, const char*> cases[] = {
        {{{0, 0, 1}, {kNan, 1, 1}}, "Keys[1].Time=nan"},
        {{{kInf, 0, 1}}, "Keys[0].Time=inf"},
        {{{0, 2, 1}}, "Keys[0].Input=2: must be an input from 0 to 1"},
        {{{0, -1, 1}}, "Keys[0].Input=-1"},
        {{{0, 0, 1}, {1, 1, 1}, {0, 0, 1}}, "Keys[2].Time=0: input 0 has a key at this time already"},
        {{{0, 0, 1}, {3, 1, 0.5}}, "Keys at time 3: weights=sum 0.5: the sum must be 1"},
        {{{0, 0, kNan}}, "Keys at time 0: weights[0]=nan"},
        {{{0, 0, 1}, {3, 1, 0}}, "Keys at time 3: weights=sum 0"}};
    for (const auto& [keys, message] : cases) {
        vtkNew<vtkAnamorphInbetween> filter;
        Errors errors(filter);
        add_inputs(filter, {base, moved(base, 1)});
        for (const Key& key : keys) filter->AddKey(key.time, key.input, key.weight);
        filter->UpdateTimeStep(0.5);
        EXPECT_THAT(errors.text(), HasSubstr(message));
    }
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    add_inputs(filter, {base, moved(base, 1)});
    filter->AddKey(0, 0, 3);
    filter->AddKey(0, 1, 1);
    filter->NormalizeWeightsOn();
    filter->Update();
    EXPECT_EQ(errors.text(), "");
}

TEST(VtkInbetween, InputsAreAskedForTheSameTime) {
    vtkNew<Clock> clocks[2];
    clocks[0]->steps = {0, 2};
    clocks[0]->range = {0, 2};
    clocks[1]->range = {1, 7};
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    for (const auto& clock : clocks) filter->AddInputConnection(clock->GetOutputPort());
    filter->AddKey(1, 0, 1);
    filter->AddKey(3, 1, 1);
    EXPECT_THAT(times_of(filter, Executive::TIME_STEPS()), testing::ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(times_of(filter, Executive::TIME_RANGE()), testing::ElementsAre(0, 7));
    for (const double time : {2.5, 0.0, 9.0}) {
        filter->UpdateTimeStep(time);
        EXPECT_EQ(clocks[0]->asked.back(), time);
        EXPECT_EQ(clocks[1]->asked.back(), time);
        EXPECT_NEAR(coordinates(surface_of(filter))[0], time, 1e-6);
    }
    // Without keys, the times of the inputs are passed, and so is the request.
    filter->ClearKeys();
    EXPECT_THAT(times_of(filter, Executive::TIME_STEPS()), testing::ElementsAre(0, 2));
    filter->UpdateTimeStep(1.5);
    EXPECT_EQ(clocks[1]->asked.back(), 1.5);
    EXPECT_EQ(surface_of(filter)->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), 1.5);
    EXPECT_EQ(errors.text(), "");
}

TEST(VtkInbetween, TopologyMayChangeOverTimeIfItDoesInAllInputs) {
    vtkNew<Clock> clocks[2];
    for (const auto& clock : clocks) {
        clock->range = {0, 9};
        clock->change = 4;
    }
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    for (const auto& clock : clocks) filter->AddInputConnection(clock->GetOutputPort());
    for (const auto& [time, cells] : {std::pair{1.0, 1}, {5.0, 2}, {2.0, 1}}) {
        filter->UpdateTimeStep(time);
        EXPECT_EQ(surface_of(filter)->GetNumberOfCells(), cells);
    }
    EXPECT_EQ(errors.text(), "");
    clocks[1]->change = 6;
    clocks[1]->Modified();
    filter->UpdateTimeStep(5);
    EXPECT_THAT(errors.text(), HasSubstr("input 1 has 3 points, not 6"));
    EXPECT_EQ(surface_of(filter)->GetNumberOfPoints(), 0);
    errors.clear();
    filter->UpdateTimeStep(7);
    EXPECT_EQ(errors.text(), "");
    EXPECT_EQ(surface_of(filter)->GetNumberOfCells(), 2);
}

// ---- The pipeline ----

TEST(VtkInbetween, PiecesAndGhostsMakeUpTheWhole) {
    vtkNew<vtkImageData> picture;
    picture->SetDimensions(23, 17, 1);
    picture->AllocateScalars(VTK_FLOAT, 1);
    for (int y = 0; y < 17; ++y)
        for (int x = 0; x < 23; ++x) picture->SetScalarComponentFromDouble(x, y, 0, 0, std::sin(x * y));
    vtkNew<vtkAnamorphReliefSource> reliefs[2];
    vtkNew<vtkAnamorphInbetween> filter;
    Errors errors(filter);
    for (int i = 0; i < 2; ++i) {
        reliefs[i]->SetInputData(picture);
        reliefs[i]->SetHeightScale(1 + i);
        filter->AddInputConnection(reliefs[i]->GetOutputPort());
    }
    set_weights(filter, {0.3, 0.7});
    filter->Update();
    vtkNew<vtkStructuredGrid> whole;
    whole->DeepCopy(filter->GetOutputDataObject(0));
    ASSERT_EQ(whole->GetNumberOfPoints(), 23 * 17);
    for (const int pieces : {2, 5})
        for (const int ghosts : {0, 1}) {
            vtkIdType cells = 0;
            for (int piece = 0; piece < pieces; ++piece) {
                filter->UpdatePiece(piece, pieces, ghosts);
                auto* part = vtkStructuredGrid::SafeDownCast(filter->GetOutputDataObject(0));
                vtkUnsignedCharArray* ghost = part->GetCellGhostArray();
                EXPECT_EQ(ghost != nullptr, ghosts > 0);
                for (vtkIdType i = 0; i < part->GetNumberOfCells(); ++i)
                    cells += !(ghost && ghost->GetValue(i));
                int e[6];
                part->GetExtent(e);
                for (int y = e[2]; y <= e[3]; ++y)
                    for (int x = e[0]; x <= e[1]; ++x) {
                        double a[3], b[3];
                        part->GetPoint((y - e[2]) * (e[1] - e[0] + 1) + x - e[0], a);
                        whole->GetPoint(y * 23 + x, b);
                        ASSERT_THAT(a, testing::ElementsAreArray(b));
                    }
            }
            EXPECT_EQ(cells, 22 * 16);
        }
    EXPECT_EQ(errors.text(), "");
}

TEST(VtkInbetween, ProgressRisesTo1AndAbortLeavesNothing) {
    const Shape base = sphere(600);  // more than a stretch
    vtkNew<vtkAnamorphInbetween> filter;
    vtkNew<ProgressObserver> progress;
    filter->AddObserver(vtkCommand::ProgressEvent, progress);
    add_inputs(filter, {base, moved(base, 1)});
    filter->Update();
    ASSERT_GE(progress->reports.size(), 4u);
    EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
    EXPECT_EQ(progress->reports.back(), 1);
    EXPECT_EQ(surface_of(filter)->GetNumberOfPoints(), base->GetNumberOfPoints());

    progress->reports.clear();
    progress->algorithm = filter;
    progress->abort_at = 0.3;
    filter->Modified();
    filter->Update();
    EXPECT_EQ(surface_of(filter)->GetNumberOfPoints(), 0);
    EXPECT_LT(progress->reports.size() < 2 ? 0 : progress->reports[progress->reports.size() - 2], 0.9);
    progress->abort_at = -1;
    filter->SetAbortExecute(0);
    filter->Modified();
    filter->Update();
    EXPECT_EQ(surface_of(filter)->GetNumberOfPoints(), base->GetNumberOfPoints());
}

TEST(VtkInbetween, UpdatesOnlyAfterAChangeOfAValue) {
    const Shape base = sphere();
    vtkNew<vtkAnamorphInbetween> filter;
    add_inputs(filter, {base, moved(base, 1)});
    using Filter = vtkAnamorphInbetween;
    expect_modified_by<Filter>(
        filter, {[](Filter* f) { f->SetNumberOfWeights(2); },
                 [](Filter* f) { f->SetWeight(0, 0.25), f->SetWeight(1, 0.75); },
                 [](Filter* f) { f->SetBaseIndex(1); }, [](Filter* f) { f->NormalizeWeightsOn(); },
                 [](Filter* f) { f->SetNumberOfMasks(2); }, [](Filter* f) { f->SetMaskArrayName(0, "mask"); },
                 [](Filter* f) { f->SetNumberOfKeys(1); }, [](Filter* f) { f->SetKey(0, 1, 1, 1); },
                 [](Filter* f) { f->SetInterpolation(Filter::CATMULL_ROM); },
                 [](Filter* f) { f->SetNormals(Filter::DROP_NORMALS); },
                 [](Filter* f) { f->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION); },
                 [](Filter* f) { f->ClearKeys(); }, [](Filter* f) { f->SetMaskArrayName(0, nullptr); },
                 [](Filter* f) { f->SetModeToDeltas(); }});
    const Errors errors(filter);
    const vtkMTimeType time = filter->GetMTime();
    filter->SetWeight(-1, 1);
    EXPECT_THAT(errors.text(), HasSubstr("index=-1: must be an integer from 0 to 1048575"));
    filter->SetNumberOfKeys(VTK_INT_MAX);
    EXPECT_THAT(errors.text(), HasSubstr("count=2147483647: must be an integer from 0 to 1048576"));
    EXPECT_EQ(filter->GetMTime(), time);
    EXPECT_EQ(filter->GetWeight(1), 0.75);
    EXPECT_EQ(filter->GetWeight(2), 0);
    EXPECT_EQ(filter->GetWeight(-1), 0);
    EXPECT_STREQ(filter->GetMaskArrayName(5), "");
    EXPECT_EQ(filter->GetKeyTime(0), 0);
    expect_executed_once(filter);
}

TEST(VtkInbetween, PrintsItsState) {
    vtkNew<vtkAnamorphInbetween> filter;
    filter->SetWeight(1, 2.5);
    filter->SetMaskArrayName(0, "mouth");
    filter->AddKey(1, 2, 3);
    expect_printed(filter, {"Mode: weighted sum", "Weights: 0 2.5", "Masks: \"mouth\"", "(1, 2, 3)"});
}

TEST(VtkInbetween, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphInbetween>("vtkAnamorphInbetween");
}

}  // namespace
}  // namespace test_inbetween
