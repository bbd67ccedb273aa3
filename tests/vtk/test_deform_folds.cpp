// SPDX-License-Identifier: Apache-2.0
// Where deformations fold space, and images that are resampled through them: against the formula written out in long double.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphDeform.h>
#include <vtkAnamorphDeformImage.h>
#include <vtkAnamorphDeformTransform.h>
#include <vtkAnamorphDeformationList.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPlaneSource.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "support.h"

namespace test_deform_folds {
namespace {

using Real = long double;
using Real3 = std::array<Real, 3>;
using Bump = std::array<double, 9>;

/// p + sum V F, over the plane z = 0.
Real3 moved(const std::vector<Bump>& list, const Real3& p) {
    Real3 q = p;
    for (const Bump& b : list) {
        if (b[8] == 0) continue;
        const Real x = (p[0] - b[0]) / b[2], y = (p[1] - b[1]) / b[3], r = std::sqrt(x * x + y * y);
        const Real f = b[7] == 0 ? std::exp(-r * r) : r < 1 ? std::pow(1 - r, Real(4)) * (4 * r + 1) : 0;
        for (std::size_t c = 0; c < 3; ++c) q[c] += b[4 + c] * f;
    }
    return q;
}

Real determinant(const std::vector<Bump>& list, const Real3& p) {
    const Real h = 1e-5L;
    Real3 by[3];
    for (std::size_t k = 0; k < 3; ++k) {
        Real3 a = p, b = p;
        a[k] += h;
        b[k] -= h;
        const Real3 there = moved(list, a), here = moved(list, b);
        for (std::size_t c = 0; c < 3; ++c) by[k][c] = (there[c] - here[c]) / (2 * h);
    }
    return by[0][0] * (by[1][1] * by[2][2] - by[1][2] * by[2][1]) -
           by[1][0] * (by[0][1] * by[2][2] - by[0][2] * by[2][1]) +
           by[2][0] * (by[0][1] * by[1][2] - by[0][2] * by[1][1]);
}

std::vector<Bump> bumps(unsigned seed, double size) {
    std::mt19937 engine(seed);
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine);
    };
    std::vector<Bump> list;
    for (int k = 0; k < 6; ++k)
        list.push_back({number(-1, 1), number(-1, 1), number(.3, .7), number(.3, .7), number(-size, size),
                        number(-size, size), number(-1, 1), k % 2 ? 1. : 0., k == 4 ? 0. : 1.});
    return list;
}
template <class Filter>
void add(Filter* filter, const std::vector<Bump>& list) {
    for (const Bump& b : list) filter->AddDeformation(b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8]);
}

TEST(VtkDeformFolds, TheArrayIsTheDeterminantAndTheWorstIsTold) {
    for (const unsigned seed : {1u, 2u, 3u})
        for (const double size : {.05, .6}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", size " << size);
            vtkNew<vtkPlaneSource> square;
            square->SetOrigin(-1, -1, 0);
            square->SetPoint1(1, -1, 0);
            square->SetPoint2(-1, 1, 0);
            square->SetResolution(30, 30);
            square->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
            vtkNew<vtkAnamorphDeform> filter;
            filter->SetInputConnection(square->GetOutputPort());
            filter->AutomaticPlaneOff();
            filter->SetCutoff(0);
            const std::vector<Bump> list = bumps(seed, size);
            add(filter.Get(), list);
            Errors warnings(filter, vtkCommand::WarningEvent);
            filter->Update();
            EXPECT_EQ(vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0))
                          ->GetPointData()
                          ->GetArray("Jacobian"),
                      nullptr);
            filter->ComputeFoldsOn();
            filter->Update();
            auto* out = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0));
            vtkDataArray* array = out->GetPointData()->GetArray("Jacobian");
            ASSERT_NE(array, nullptr);
            double least = 1e9;
            Real3 place{};
            for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) {
                double p[3];
                square->GetOutput()->GetPoint(i, p);
                const Real exact = determinant(list, {p[0], p[1], p[2]});
                ASSERT_NEAR(array->GetTuple1(i), static_cast<double>(exact), 1e-7) << i;
                if (static_cast<double>(exact) < least) {
                    least = static_cast<double>(exact);
                    place = {p[0], p[1], p[2]};
                }
            }
            EXPECT_NEAR(filter->GetLeastJacobian(), least, 1e-7);
            for (int c = 0; c < 3; ++c)
                EXPECT_EQ(filter->GetLeastJacobianPoint()[c],
                          static_cast<double>(place[static_cast<std::size_t>(c)]));
            EXPECT_EQ(warnings.text().find("fold space, worst at x=") != std::string::npos, least <= 0);
            EXPECT_EQ(size<.1, least> 0);
            // The transform, which looks everywhere, knows of it as well.
            vtkNew<vtkAnamorphDeformTransform> transform;
            transform->SetDeformationList(filter->GetDeformationList());
            if (least <= 0) {
                EXPECT_EQ(transform->GetFold(), vtkAnamorphDeformTransform::FOLD);
            }
            // An edit, and back, leaves nothing.
            const std::vector<double> before = numbers(array);
            filter->SetDeformationEnabled(0, false);
            filter->Update();
            filter->SetDeformationEnabled(0, true);
            filter->Update();
            EXPECT_EQ(numbers(vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0))
                                  ->GetPointData()
                                  ->GetArray("Jacobian")),
                      before);
        }
    // With depth, the third way counts; texture coordinates are refused.
    vtkNew<vtkPlaneSource> square;
    square->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputConnection(square->GetOutputPort());
    filter->AutomaticPlaneOff();
    filter->ComputeFoldsOn();
    filter->AddDeformation(-.5, -.5, 1, 1, 0, 0, 2);
    filter->SetDepth(0, .5, 1);
    filter->Update();
    // F = e^-.25 at the first point, and dF/dw = e^-.25.
    EXPECT_NEAR(vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0))
                    ->GetPointData()
                    ->GetArray("Jacobian")
                    ->GetTuple1(0),
                1 + 2 * std::exp(-.25), 1e-6);
    filter->SetParameterModeToTextureCoordinates();
    Errors errors(filter);
    filter->Update();
    EXPECT_THAT(errors.text(), testing::HasSubstr("ComputeFolds=1: the parameters must be those of a plane"));
}

/// A volume whose scalars are its points' places, turned, off the origin, with other arrays beside.
vtkSmartPointer<vtkImageData> volume() {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetExtent(-2, 17, 3, 20, -1, 8);
    image->SetOrigin(-1.1, -1.4, -.3);
    image->SetSpacing(.12, .11, .1);
    image->SetDirectionMatrix(.8, -.6, 0, .6, .8, 0, 0, 0, 1);
    vtkNew<vtkDoubleArray> places;
    places->SetName("place");
    places->SetNumberOfComponents(3);
    vtkNew<vtkUnsignedCharArray> bytes;
    bytes->SetName("bytes");
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
        double p[3];
        image->GetPoint(i, p);
        places->InsertNextTuple(p);
        bytes->InsertNextValue(static_cast<unsigned char>(i % 200 + 20));
    }
    image->GetPointData()->SetScalars(places);
    image->GetPointData()->AddArray(bytes);
    return image;
}

TEST(VtkDeformImage, WhatIsShownComesFromWhereTheInverseSays) {
    const auto image = volume();
    for (const unsigned seed : {4u, 5u}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        std::vector<Bump> list = bumps(seed, .08);
        for (Bump& b : list) b[6] *= .1;
        vtkNew<vtkAnamorphDeformImage> filter;
        filter->SetInputData(image);
        filter->SetBackground(-9);
        add(filter.Get(), list);
        std::vector<double> expected;
        for_any_threads([&] {
            filter->Modified();
            filter->Update();
            vtkImageData* out = filter->GetOutput();
            ASSERT_EQ(out->GetNumberOfPoints(), image->GetNumberOfPoints());
            const std::vector<double> found = numbers(out->GetPointData()->GetScalars());
            if (expected.empty()) expected = found;
            ASSERT_EQ(found, expected);
        });
        vtkImageData* out = filter->GetOutput();
        EXPECT_EQ(filter->GetNumberOfFailures(), 0);
        EXPECT_EQ(out->GetFieldData()->GetArray("anamorph:failures")->GetTuple1(0), 0);
        // A linear field is interpolated exactly: the value is the place it comes from, which moves to this point.
        // VTK interpolates at places rounded to 2^-16 of the distance of points, each way: at most .12 (.8 + .6) of it, and
        // the bumps enlarge that by less than 2.
        constexpr double kPlace = 2 * .12 * 1.4 * 0x1p-16;
        int inside = 0;
        for (vtkIdType i = 0; i < out->GetNumberOfPoints(); ++i) {
            double from[3], p[3];
            out->GetPoint(i, p);
            out->GetPointData()->GetScalars()->GetTuple(i, from);
            if (from[0] == -9) continue;
            ++inside;
            const Real3 to = moved(list, {from[0], from[1], from[2]});
            for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(static_cast<double>(to[c]), p[c], kPlace) << i;
        }
        EXPECT_GT(inside, out->GetNumberOfPoints() / 2);
        EXPECT_EQ(out->GetPointData()->GetArray("bytes")->GetDataType(), VTK_UNSIGNED_CHAR);
        // Parts are parts of the whole.
        const int part[6] = {2, 9, 5, 6, 0, 4};
        vtkNew<vtkAnamorphDeformImage> other;
        other->SetInputData(image);
        other->SetBackground(-9);
        add(other.Get(), list);
        other->UpdateExtent(part);
        for (int k = 0; k <= 4; ++k)
            for (int j = 5; j <= 6; ++j)
                for (int i = 2; i <= 9; ++i)
                    for (int c = 0; c < 3; ++c)
                        ASSERT_EQ(other->GetOutput()->GetScalarComponentAsDouble(i, j, k, c),
                                  out->GetScalarComponentAsDouble(i, j, k, c));
        // Undone, it is what it was, where nothing came from beyond.
        vtkNew<vtkAnamorphDeformImage> back;
        back->SetInputConnection(filter->GetOutputPort());
        back->InverseOn();
        back->SetDeformationList(filter->GetDeformationList());
        back->SetBackground(-9);
        back->Update();
        int same = 0;
        for (vtkIdType i = 0; i < out->GetNumberOfPoints(); ++i) {
            double p[3], value[3];
            image->GetPoint(i, p);
            back->GetOutput()->GetPointData()->GetScalars()->GetTuple(i, value);
            same +=
                std::fabs(value[0] - p[0]) + std::fabs(value[1] - p[1]) + std::fabs(value[2] - p[2]) < .02;
        }
        EXPECT_GT(same, out->GetNumberOfPoints() / 3);
    }
}

TEST(VtkDeformImage, NumbersOfEveryType) {
    // Of those that VTK's interpolator does not know the values are an int's.
    const auto image = volume();
    for (const int type : {VTK_BIT, VTK_LONG, VTK_UNSIGNED_LONG, VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG,
                           VTK_ID_TYPE, VTK_SIGNED_CHAR, VTK_SHORT}) {
        SCOPED_TRACE(type);
        for (const int mode : {0, 1, 2}) {
            const auto with = vtkSmartPointer<vtkImageData>::New();
            with->CopyStructure(image);
            for (const int kind : {type, VTK_INT}) {
                const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(kind));
                array->SetName(kind == type ? "numbers" : "int");
                array->SetNumberOfComponents(type == VTK_BIT ? 1 : 2);
                array->SetNumberOfTuples(image->GetNumberOfPoints());
                for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
                    for (int c = 0; c < array->GetNumberOfComponents(); ++c)
                        array->SetComponent(i, c,
                                            static_cast<double>((i * 7 + c) % (type == VTK_BIT ? 2 : 100)));
                with->GetPointData()->AddArray(array);
            }
            vtkNew<vtkAnamorphDeformImage> filter;
            Errors warnings(filter, vtkCommand::WarningEvent);
            filter->SetInputData(with);
            filter->SetInterpolation(mode);
            filter->AddDeformation(.3, .4, .5, .5, .08, .05, 0);
            filter->Update();
            vtkPointData* const made = filter->GetOutput()->GetPointData();
            ASSERT_TRUE(made->GetArray("numbers"));
            EXPECT_EQ(made->GetArray("numbers")->GetDataType(), type == VTK_BIT ? VTK_UNSIGNED_CHAR : type);
            std::vector<double> expected = numbers(made->GetArray("int"));
            for (double& value : expected) {  // which cubic may overshoot
                if (type == VTK_BIT) value = std::min(value, 1.);
                if (made->GetArray("numbers")->GetDataTypeMin() == 0) value = std::max(value, 0.);
            }
            EXPECT_EQ(numbers(made->GetArray("numbers")), expected);
            EXPECT_GT(*std::max_element(expected.begin(), expected.end()), type == VTK_BIT ? 0 : 50);
            EXPECT_EQ(warnings.text(), "");
        }
    }
}

TEST(VtkDeformImage, FoldsBackgroundsAndBadInput) {
    vtkNew<vtkAnamorphDeformImage> filter;
    Errors errors(filter), warnings(filter, vtkCommand::WarningEvent);
    filter->Update();
    EXPECT_THAT(errors.text(), testing::HasSubstr("the image"));
    errors.clear();
    const auto image = volume();
    filter->SetInputData(image);
    filter->Update();  // an empty list changes nothing
    EXPECT_EQ(errors.text(), "");
    for (const char* name : {"bytes"})
        EXPECT_EQ(numbers(filter->GetOutput()->GetPointData()->GetArray(name)),
                  numbers(image->GetPointData()->GetArray(name)));
    // What comes from beyond is the background, as far as bytes go.
    filter->AddDeformation(0, 0, 50, 50, 100, 0, 0);
    for (const auto& [background, byte] : {std::pair(300., 255.), std::pair(-4., 0.), std::pair(kNan, 0.)}) {
        filter->SetBackground(background);
        filter->Update();
        EXPECT_EQ(filter->GetOutput()->GetPointData()->GetArray("bytes")->GetTuple1(0), byte);
    }
    EXPECT_THAT(warnings.text(), testing::HasSubstr("fold the plane at u="));
    filter->SetNumberOfDeformations(0);
    filter->AddDeformation(0, 0, 1, 1, 0, 0, 1);
    filter->GetDeformationList()->SetDepth(0, 0, 1);
    filter->Update();
    EXPECT_THAT(errors.text(), testing::HasSubstr("extent=1: a transform of space"));
    errors.clear();
    filter->SetNumberOfDeformations(0);
    filter->SetAxis2(2, 0, 0);
    filter->Update();
    EXPECT_NE(errors.text(), "");
    errors.clear();
    filter->SetAxis2(0, 1, 0);
    filter->SetFileName("no such file.json");
    filter->Update();
    EXPECT_THAT(errors.text(), testing::HasSubstr("no such file.json: cannot be read"));
    filter->SetFileName(nullptr);
    // Neither points nor arrays.
    vtkNew<vtkImageData> empty;
    filter->SetInputData(empty);
    errors.clear();
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
    expect_printed(filter, {"Inverse: ", "Interpolation: Linear", "NumberOfFailures: 0"});
}

}  // namespace
}  // namespace test_deform_folds
