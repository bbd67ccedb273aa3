// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphPanoramaView.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkImageExtractComponents.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <cmath>
#include <sstream>

#include "support.h"

namespace test_panorama_view {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Whose texels say which direction they show: its three components.
vtkSmartPointer<vtkImageData> directions(int width, int height) {
    const auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_FLOAT, 3);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const double yaw = ((i + 0.5) / width - 0.5) * 2 * kPi, pitch = ((j + 0.5) / height - 0.5) * kPi;
            const double v[3] = {std::sin(yaw) * std::cos(pitch), std::sin(pitch),
                                 std::cos(yaw) * std::cos(pitch)};
            for (int c = 0; c < 3; ++c) image->SetScalarComponentFromDouble(i, j, 0, c, v[c]);
        }
    return image;
}

TEST(VtkPanoramaView, PixelsShowTheirDirections) {
    vtkNew<vtkAnamorphPanoramaView> view;
    view->SetInputData(directions(1024, 512));
    view->SetYaw(130);
    view->SetPitch(35);
    view->SetViewAngle(70);
    view->SetViewSize(80, 60);
    view->Update();
    vtkImageData* seen = view->GetOutput();
    ASSERT_EQ(seen->GetNumberOfPoints(), 80 * 60);
    EXPECT_STREQ(seen->GetPointData()->GetScalars()->GetName(), "Colors");
    const double focal = 40 / std::tan(35 * kPi / 180), cp = std::cos(35 * kPi / 180),
                 sp = std::sin(35 * kPi / 180);
    const double cy = std::cos(130 * kPi / 180), sy = std::sin(130 * kPi / 180);
    double worst = 0;
    for (int j = 0; j < 60; ++j)
        for (int i = 0; i < 80; ++i) {
            const double x = i + 0.5 - 40, y = j + 0.5 - 30, n = std::sqrt(x * x + y * y + focal * focal);
            const double up = (y * cp + focal * sp) / n, ahead = (focal * cp - y * sp) / n, right = x / n;
            const double truth[3] = {right * cy + ahead * sy, up, ahead * cy - right * sy};
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, std::fabs(truth[c] - seen->GetScalarComponentAsDouble(i, j, 0, c)));
        }
    // tol, 0.01 texels, is 6e-5 radians; the chord of a texel is off its arc by 5e-6.
    EXPECT_LT(worst, 8e-5);
    EXPECT_GT(view->GetMaxError(), 0);
    EXPECT_LE(view->GetMaxError(), 0.01);
}

TEST(VtkPanoramaView, PartsAreTheSameAsTheWhole) {
    vtkNew<vtkAnamorphPanoramaView> view, part;
    for (vtkAnamorphPanoramaView* v : {view.Get(), part.Get()}) {
        v->SetInputData(directions(128, 64));
        v->SetViewSize(50, 40);
        v->SetYaw(175);
    }
    view->Update();
    const int extent[6] = {7, 31, 5, 38, 0, 0};
    part->UpdateExtent(extent);
    int got[6];
    part->GetOutput()->GetExtent(got);
    EXPECT_THAT(got, testing::ElementsAreArray(extent));
    for (int j = extent[2]; j <= extent[3]; ++j)
        for (int i = extent[0]; i <= extent[1]; ++i)
            ASSERT_EQ(part->GetOutput()->GetScalarComponentAsDouble(i, j, 0, 1),
                      view->GetOutput()->GetScalarComponentAsDouble(i, j, 0, 1));
}

TEST(VtkPanoramaView, TypesAndComponents) {
    for (const int type : {VTK_UNSIGNED_CHAR, VTK_UNSIGNED_SHORT, VTK_FLOAT})
        for (int components = 1; components <= 4; ++components) {
            vtkNew<vtkImageData> image;
            image->SetDimensions(32, 16, 1);
            image->AllocateScalars(type, components);
            image->GetPointData()->GetScalars()->Fill(type == VTK_UNSIGNED_SHORT ? 65535
                                                      : type == VTK_FLOAT        ? 3
                                                                                 : 255);
            vtkNew<vtkAnamorphPanoramaView> view;
            view->SetInputData(image);
            view->SetViewSize(9, 7);
            view->Update();
            vtkDataArray* colors = view->GetOutput()->GetPointData()->GetScalars();
            ASSERT_NE(colors, nullptr);
            EXPECT_EQ(colors->GetDataType(), type);
            EXPECT_EQ(colors->GetNumberOfComponents(), components);
            EXPECT_EQ(colors->GetComponent(20, 0), image->GetPointData()->GetScalars()->GetComponent(0, 0));
        }
}

TEST(VtkPanoramaView, ProjectionsAndLenses) {
    vtkNew<vtkAnamorphPanoramaView> view;
    view->SetInputData(directions(96, 96));
    view->SetProjection(3);
    view->SetFieldOfView(200);
    view->SetLens("kb4:k1=0.02");
    view->Update();
    EXPECT_EQ(view->GetOutput()->GetNumberOfPoints(), 500 * 500);
    view->SetViewAngle(500);
    EXPECT_EQ(view->GetViewAngle(), 179);
}

TEST(VtkPanoramaView, SaysWhatIsWrong) {
    vtkNew<vtkAnamorphPanoramaView> view;
    Errors errors(view);
    const auto error = [&] {
        errors.clear();
        view->Modified();
        view->Update();
        return errors.text();
    };
    view->SetInputData(directions(64, 32));
    EXPECT_EQ(error(), "");
    view->SetViewSize(0, 10);
    EXPECT_THAT(error(), testing::HasSubstr("ViewSize=0: must be an integer from 1 to 65536"));
    view->SetViewSize(20, 10);
    view->SetTolerance(-1);
    EXPECT_EQ(view->GetTolerance(), 0);
    view->SetYaw(std::nan(""));
    EXPECT_THAT(error(), testing::HasSubstr("yaw=nan"));
    view->SetYaw(1e300);
    EXPECT_EQ(error(), "");
    view->SetLens("none:");
    EXPECT_THAT(error(), testing::HasSubstr("srclens"));
    view->SetLens(nullptr);
    view->SetFieldOfView(-3);
    EXPECT_THAT(error(), testing::HasSubstr("srcfov=-3"));
    view->SetFieldOfView(0);
    view->SetProjection(7);
    EXPECT_THAT(error(), testing::HasSubstr("64x32"));
    view->SetProjection(0);
    vtkNew<vtkImageData> thick;
    thick->SetDimensions(4, 2, 2);
    thick->AllocateScalars(VTK_FLOAT, 1);
    view->SetInputData(thick);
    EXPECT_THAT(error(), testing::HasSubstr("the panorama has 2 slices, but must have 1"));
    EXPECT_EQ(view->GetOutput()->GetNumberOfPoints(), 0);
    view->SetInputData(directions(64, 32));
    EXPECT_EQ(error(), "") << "and goes on";
    std::ostringstream text;
    view->Print(text);
    EXPECT_THAT(text.str(), testing::HasSubstr("Projection: equirectangular"));
    const vtkMTimeType before = view->GetMTime();
    view->SetViewAngle(view->GetViewAngle());
    view->SetViewSize(20, 10);
    EXPECT_EQ(view->GetMTime(), before);
}

}  // namespace
}  // namespace test_panorama_view
