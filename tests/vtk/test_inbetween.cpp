// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphInbetween.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
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
#include <limits>
#include <random>
#include <sstream>

#include "support.h"

namespace {

using Executive = vtkStreamingDemandDrivenPipeline;
using testing::HasSubstr;
using Shape = vtkSmartPointer<vtkPolyData>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

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

}  // namespace
