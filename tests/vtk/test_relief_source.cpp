// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphReliefSource.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkImageAlgorithm.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedShortArray.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <sstream>

#include "support.h"

namespace {

using Executive = vtkStreamingDemandDrivenPipeline;
using testing::HasSubstr;
using Picture = vtkSmartPointer<vtkImageData>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Random numbers of a type: all of an integer's range, or -1 to 1.
Picture picture(int width, int height, int type = VTK_FLOAT, int components = 1, int left = 0,
                int bottom = 0) {
    std::mt19937 random(7);
    auto image = Picture::New();
    image->SetExtent(left, left + width - 1, bottom, bottom + height - 1, 0, 0);
    image->AllocateScalars(type, components);
    vtkDataArray* pixels = image->GetPointData()->GetScalars();
    const bool floating = type == VTK_FLOAT || type == VTK_DOUBLE;
    std::uniform_real_distribution<double> value(floating ? -1 : 0, floating ? 1 : pixels->GetDataTypeMax());
    for (vtkIdType i = 0; i < pixels->GetNumberOfTuples(); ++i)
        for (int c = 0; c < components; ++c)
            pixels->SetComponent(i, c, floating ? value(random) : std::floor(value(random)));
    return image;
}

vtkStructuredGrid* grid_of(vtkAnamorphReliefSource* source) {
    return source->GetOutput();
}

std::vector<double> heights(vtkStructuredGrid* grid) {
    return numbers(grid->GetPointData()->GetArray("Height"));
}

TEST(VtkRelief, RaisesThePlaneByTheEquationOfTheHeader) {
    const Picture image = picture(5, 4);
    vtkNew<vtkAnamorphReliefSource> source;
    source->SetInputData(image);
    source->SetOrigin(1, 2, 3);
    source->SetPoint1(1, 10, 3);
    source->SetPoint2(1, 2, 9);
    source->SetKeepAspect(false);
    source->SetHeightScale(2);
    source->SetHeightOffset(-0.5);
    source->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    source->Update();
    vtkStructuredGrid* grid = grid_of(source);
    int size[3];
    grid->GetDimensions(size);
    ASSERT_THAT(size, testing::ElementsAre(5, 4, 1));
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) {
            const vtkIdType i = y * 5 + x;
            const double h = 2 * image->GetScalarComponentAsDouble(x, y, 0, 0) - 0.5;
            double at[3], uv[2];
            grid->GetPoint(i, at);
            // (Point1 - Origin) x (Point2 - Origin) points along x.
            EXPECT_NEAR(at[0], 1 + h, 1e-12);
            EXPECT_NEAR(at[1], 2 + 8 * x / 4.0, 1e-12);
            EXPECT_NEAR(at[2], 3 + 6 * y / 3.0, 1e-12);
            EXPECT_NEAR(heights(grid)[static_cast<std::size_t>(i)], h, 1e-12);
            grid->GetPointData()->GetTCoords()->GetTuple(i, uv);
            EXPECT_NEAR(uv[0], (x + 0.5) / 5, 1e-6);
            EXPECT_NEAR(uv[1], (y + 0.5) / 4, 1e-6);
        }
}

}  // namespace
