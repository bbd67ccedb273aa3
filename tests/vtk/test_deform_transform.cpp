// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphDeformTransform.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphDeform.h>
#include <vtkAnamorphDeformationList.h>
#include <vtkGeneralTransform.h>
#include <vtkImageData.h>
#include <vtkImageReslice.h>
#include <vtkNew.h>
#include <vtkPlaneSource.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkTransformFilter.h>

#include <cmath>
#include <random>
#include <string>

#include "support.h"

namespace test_deform_transform {
namespace {

using testing::HasSubstr;

/// Bumps that do not fold.
void add_bumps(vtkAnamorphDeformationList* list, unsigned seed, double size) {
    std::mt19937 engine(seed);
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine);
    };
    for (int k = 0; k < 15; ++k)
        list->AddDeformation(number(-1, 1), number(-1, 1), number(.3, .8), number(.3, .8),
                             number(-size, size), number(-size, size), number(-size, size), k % 2);
}

}  // namespace

TEST(VtkDeformTransform, MovesPointsAsTheFilterDoes) {
    vtkNew<vtkPlaneSource> plane;
    plane->SetOrigin(-1, -1, 0);
    plane->SetPoint1(1, -1, 0);
    plane->SetPoint2(-1, 1, 0);
    plane->SetResolution(30, 30);
    plane->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    vtkNew<vtkAnamorphDeform> deform;
    deform->SetInputConnection(plane->GetOutputPort());
    deform->SetCutoff(0);
    add_bumps(deform->GetDeformationList(), 1, .1);
    deform->Update();
    vtkNew<vtkAnamorphDeformTransform> transform;
    transform->SetDeformationList(deform->GetDeformationList());
    vtkNew<vtkTransformFilter> filter;
    filter->SetInputConnection(plane->GetOutputPort());
    filter->SetTransform(transform);
    filter->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    const auto compare = [&] {
        deform->Update();
        filter->Update();
        const std::vector<double> a = coordinates(filter->GetOutput()),
                                  b = coordinates(deform->GetPolyDataOutput());
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(a[k], b[k], 1e-9);
        // Its normals are turned by our derivatives; the filter's are of the deformed surface.
        const std::vector<double> n = numbers(filter->GetOutput()->GetPointData()->GetNormals()),
                                  m = numbers(deform->GetPolyDataOutput()->GetPointData()->GetNormals());
        ASSERT_EQ(n.size(), m.size());
        for (std::size_t k = 0; k < n.size(); ++k) ASSERT_NEAR(n[k], m[k], 1e-6);
    };
    compare();
    // An edit of the list reaches both.
    const vtkMTimeType time = transform->GetMTime();
    deform->SetDeformation(2, 0, 0, .4, .4, .1, .2, .3);
    EXPECT_GT(transform->GetMTime(), time);
    compare();
}

TEST(VtkDeformTransform, InverseRoundTripAndDerivatives) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        vtkNew<vtkAnamorphDeformTransform> transform;
        transform->SetOrigin(.1, .2, .3);
        transform->SetAxis1(1, .1, .2);
        transform->SetAxis2(-.2, 1.5, .1);
        add_bumps(transform->GetDeformationList(), seed, .03);
        ASSERT_EQ(transform->GetFold(), vtkAnamorphDeformTransform::NO_FOLD);
        vtkAbstractTransform* inverse = transform->GetInverse();
        std::mt19937 engine(seed);
        std::uniform_real_distribution<double> number(-1.5, 1.5);
        for (int i = 0; i < 200; ++i) {
            const double p[3] = {number(engine), number(engine), number(engine)};
            double q[3], back[3], forth[3][3], inverted[3][3];
            transform->TransformPoint(p, q);
            inverse->TransformPoint(q, back);
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(back[c], p[c], 1e-12);
            // The derivative of the inverse is the inverse of the derivative.
            transform->InternalTransformDerivative(p, q, forth);
            inverse->InternalTransformDerivative(q, back, inverted);
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) {
                    double sum = 0;
                    for (int c = 0; c < 3; ++c) sum += forth[a][c] * inverted[c][b];
                    ASSERT_NEAR(sum, a == b, 1e-10);
                }
            // Row r of a derivative is that of coordinate r.
            for (int c = 0; c < 3; ++c) {
                constexpr double kStep = 1e-5;
                double ahead[3], behind[3], to[3], from[3];
                std::copy(p, p + 3, ahead);
                std::copy(p, p + 3, behind);
                ahead[c] += kStep;
                behind[c] -= kStep;
                transform->TransformPoint(ahead, to);
                transform->TransformPoint(behind, from);
                for (int r = 0; r < 3; ++r) ASSERT_NEAR((to[r] - from[r]) / (2 * kStep), forth[r][c], 1e-6);
            }
            // In float.
            const float single[3] = {float(p[0]), float(p[1]), float(p[2])};
            float moved[3];
            transform->TransformPoint(single, moved);
            const double same[3] = {single[0], single[1], single[2]};
            transform->TransformPoint(same, q);
            for (int c = 0; c < 3; ++c) ASSERT_EQ(moved[c], static_cast<float>(q[c]));
        }
        EXPECT_EQ(vtkAnamorphDeformTransform::SafeDownCast(inverse)->GetNumberOfFailures(), 0);
    }
}

TEST(VtkDeformTransform, FoldsAreReported) {
    vtkNew<vtkAnamorphDeformTransform> transform;
    transform->GetDeformationList()->AddDeformation(.5, .25, 1, 1, 3, 0, 0);
    EXPECT_EQ(transform->GetFold(), vtkAnamorphDeformTransform::FOLD);
    EXPECT_NE(transform->GetFoldParameters()[0], 0);
    const Errors warnings(transform, vtkCommand::WarningEvent);
    transform->Inverse();
    transform->Update();
    EXPECT_THAT(warnings.text(), HasSubstr("fold the plane at u="));
    for (double x = -3; x < 6; x += .01) {
        const double p[3] = {x, .3, 0};
        double q[3];
        transform->TransformPoint(p, q);
        EXPECT_TRUE(std::isfinite(q[0]));
    }
    transform->GetDeformationList()->SetDeformation(0, .5, .25, 1, 1, 1, 0, 3);
    EXPECT_EQ(transform->GetFold(), vtkAnamorphDeformTransform::NO_FOLD);
    EXPECT_EQ(transform->GetNumberOfFailures(), 0);
    const double nan[3] = {std::nan(""), 0, 0};
    double q[3];
    transform->TransformPoint(nan, q);
    EXPECT_TRUE(std::isnan(q[0]));
    EXPECT_EQ(transform->GetNumberOfFailures(), 1);
}

TEST(VtkDeformTransform, CopiesAndConcatenates) {
    vtkNew<vtkAnamorphDeformTransform> transform;
    add_bumps(transform->GetDeformationList(), 3, .03);
    transform->SetAxis1(2, 0, 0);
    const double p[3] = {.1, -.2, .3};
    double expected[3], q[3];
    transform->TransformPoint(p, expected);

    const auto made = vtkSmartPointer<vtkAbstractTransform>::Take(transform->MakeTransform());
    EXPECT_STREQ(made->GetClassName(), "vtkAnamorphDeformTransform");
    made->DeepCopy(transform);
    made->TransformPoint(p, q);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(q[c], expected[c]);
    // A copy is a copy: editing it leaves the first alone.
    vtkAnamorphDeformTransform::SafeDownCast(made)->GetDeformationList()->RemoveAllDeformations();
    made->TransformPoint(p, q);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(q[c], p[c]);
    transform->TransformPoint(p, q);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(q[c], expected[c]);
    // Its inverse follows it.
    vtkAbstractTransform* inverse = transform->GetInverse();
    transform->GetDeformationList()->AddDeformation(0, 0, 1, 1, .1, .1, .1);
    transform->TransformPoint(p, q);
    inverse->TransformPoint(q, q);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(q[c], p[c], 1e-12);

    vtkNew<vtkGeneralTransform> both;
    both->Concatenate(transform);
    both->Concatenate(inverse);
    both->TransformPoint(p, q);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(q[c], p[c], 1e-12);
}

TEST(VtkDeformTransform, ErrorsMoveNothing) {
    vtkNew<vtkAnamorphDeformTransform> transform;
    const Errors errors(transform);
    transform->GetDeformationList()->AddDeformation(0, 0, 0, 1, 1, 1, 1);
    const double p[3] = {0, 0, 0};
    double q[3];
    transform->TransformPoint(p, q);
    EXPECT_THAT(errors.text(), HasSubstr("deformation 0: extent=0"));
    EXPECT_EQ(q[0], 0);
    transform->GetDeformationList()->RemoveAllDeformations();
    transform->SetAxis1(0, 2, 0);
    transform->TransformPoint(p, q);
    EXPECT_THAT(errors.text(), HasSubstr("axis_u and axis_v"));
    const vtkMTimeType time = transform->GetMTime();
    transform->SetAxis1(transform->GetAxis1());
    EXPECT_EQ(transform->GetMTime(), time);
    expect_printed(transform, {"Axis1: 0 2 0"});
}

TEST(VtkDeformTransform, ReslicesImages) {
    // A ramp along x, read through a shift of x by a wide bump: the picture changes by the shift.
    vtkNew<vtkImageData> ramp;
    ramp->SetDimensions(64, 32, 1);
    ramp->AllocateScalars(VTK_DOUBLE, 1);
    for (int j = 0; j < 32; ++j)
        for (int i = 0; i < 64; ++i) ramp->SetScalarComponentFromDouble(i, j, 0, 0, i);
    vtkNew<vtkAnamorphDeformTransform> transform;
    transform->GetDeformationList()->AddDeformation(32, 16, 12, 8, 3, 0, 0);
    vtkNew<vtkImageReslice> reslice;
    reslice->SetInputData(ramp);
    reslice->SetResliceTransform(transform);
    reslice->SetInterpolationModeToLinear();
    for (const bool inverse : {false, true}) {
        if (inverse) transform->Inverse();
        reslice->Update();
        for (int j = 4; j < 28; j += 3)
            for (int i = 8; i < 56; i += 5) {
                const double p[3] = {double(i), double(j), 0};
                double q[3];
                transform->TransformPoint(p, q);
                // vtkImageReslice rounds positions to 2^-17.
                EXPECT_NEAR(reslice->GetOutput()->GetScalarComponentAsDouble(i, j, 0, 0), q[0], 1e-5);
            }
    }
    double q[3];
    const double middle[3] = {35, 16, 0};
    transform->TransformPoint(middle, q);
    EXPECT_NEAR(q[0], 32, 1e-12);
}

}  // namespace test_deform_transform
