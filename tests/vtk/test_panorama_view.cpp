// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphPanoramaView.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkImageExtractComponents.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <array>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

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

/// A pixel's first three components.
std::array<double, 3> at(vtkImageData* image, int i, int j) {
    return {image->GetScalarComponentAsDouble(i, j, 0, 0), image->GetScalarComponentAsDouble(i, j, 0, 1),
            image->GetScalarComponentAsDouble(i, j, 0, 2)};
}

/// The ray of a pixel of a rectilinear view that looks straight ahead, right, up and forward.
std::array<double, 3> ray_at(double i, double j, double width, double height, double focal) {
    const double x = i + 0.5 - width / 2, y = j + 0.5 - height / 2,
                 n = std::sqrt(x * x + y * y + focal * focal);
    return {x / n, y / n, focal / n};
}

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                     (a[2] - b[2]) * (a[2] - b[2]));
}

TEST(VtkPanoramaView, KeysAreThoseOfRecipes) {
    vtkNew<vtkAnamorphPanoramaView> view;
    view->SetInputData(directions(1024, 512));
    view->SetViewSize(80, 60);
    // By height, with pixels beyond the view, whose indices go on; rows go up.
    view->SetKeys("vfov=40&overscan=4x3");
    view->Update();
    int extent[6];
    view->GetOutput()->GetExtent(extent);
    EXPECT_THAT(extent, testing::ElementsAre(-4, 83, -3, 62, 0, 0));
    double worst = 0;
    for (int j = -3; j < 63; ++j)
        for (int i = -4; i < 84; ++i)
            worst = std::max(worst, distance(at(view->GetOutput(), i, j),
                                             ray_at(i, j, 80, 60, 30 / std::tan(20 * kPi / 180))));
    EXPECT_LT(worst, 1.2e-4);
    // A part of it alone.
    vtkNew<vtkAnamorphPanoramaView> part;
    part->SetInputData(directions(1024, 512));
    part->SetViewSize(80, 60);
    part->SetKeys("vfov=40&overscan=4x3");
    const int asked[6] = {-4, 10, -3, -1, 0, 0};
    part->UpdateExtent(asked);
    part->GetOutput()->GetExtent(extent);
    EXPECT_THAT(extent, testing::ElementsAreArray(asked));
    for (int j = -3; j < 0; ++j)
        for (int i = -4; i < 11; ++i)
            ASSERT_EQ(at(part->GetOutput(), i, j), at(view->GetOutput(), i, j)) << i << " " << j;
    // How the panorama's camera was held undoes how the view's is; another projection has its own field of view.
    view->SetKeys("srcyaw=130&srcpitch=35&srcroll=-20");
    view->SetYaw(130);
    view->SetPitch(35);
    view->SetRoll(-20);
    view->SetViewAngle(70);
    view->Update();
    EXPECT_LT(distance(at(view->GetOutput(), 7, 50), ray_at(7, 50, 80, 60, 40 / std::tan(35 * kPi / 180))),
              1e-4);
    view->SetKeys("to=equirectangular&size=64x32&yaw=0&pitch=0&roll=0&filter=bicubic");
    view->Update();
    view->GetOutput()->GetExtent(extent);
    EXPECT_THAT(extent, testing::ElementsAre(0, 63, 0, 31, 0, 0));
    const double lon = (10.5 / 64 - 0.5) * 2 * kPi, lat = (20.5 / 32 - 0.5) * kPi;
    EXPECT_LT(distance(at(view->GetOutput(), 10, 20),
                       {std::sin(lon) * std::cos(lat), std::sin(lat), std::cos(lon) * std::cos(lat)}),
              2e-4);
}

TEST(VtkPanoramaView, CoverageIsAComponentOrAPicture) {
    vtkNew<vtkAnamorphPanoramaView> view;
    view->SetInputData(directions(96, 96));
    view->SetProjection(3);
    view->SetFieldOfView(100);
    view->SetViewAngle(120);
    view->SetViewSize(60, 60);
    view->SetKeys("alpha=1");
    view->Update();
    vtkImageData* seen = view->GetOutput();
    ASSERT_EQ(seen->GetNumberOfScalarComponents(), 4);
    EXPECT_STREQ(seen->GetPointData()->GetScalars()->GetName(), "Colors");
    EXPECT_EQ(seen->GetScalarComponentAsDouble(0, 30, 0, 3), 0);
    EXPECT_EQ(seen->GetScalarComponentAsDouble(30, 30, 0, 3), 1);
    std::vector<double> alphas;
    for (int i = 0; i < 60; ++i) alphas.push_back(seen->GetScalarComponentAsDouble(i, 31, 0, 3));
    view->SetKeys("output=coverage");
    view->Update();
    seen = view->GetOutput();
    ASSERT_EQ(seen->GetNumberOfScalarComponents(), 1);
    EXPECT_EQ(seen->GetScalarType(), VTK_FLOAT);
    EXPECT_STREQ(seen->GetPointData()->GetScalars()->GetName(), "coverage");
    for (int i = 0; i < 60; ++i)
        EXPECT_EQ(seen->GetScalarComponentAsDouble(i, 31, 0, 0), alphas[static_cast<std::size_t>(i)]);
    // What stands behind it is told beforehand, and the view says what was reached.
    view->SetKeys("output=stmap");
    view->UpdateInformation();
    vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(
        view->GetOutputInformation(0), vtkDataObject::FIELD_ASSOCIATION_POINTS,
        vtkDataSetAttributes::SCALARS);
    EXPECT_EQ(scalars->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()), 2);
    EXPECT_EQ(scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE()), VTK_FLOAT);
    view->Update();
    EXPECT_NE(view->GetOutput()->GetFieldData()->GetAbstractArray("anamorph:max_error"), nullptr);
    // Bytes stay bytes.
    vtkNew<vtkImageData> bytes;
    bytes->SetDimensions(32, 16, 1);
    bytes->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    bytes->GetPointData()->GetScalars()->Fill(200);
    view->SetProjection(0);
    view->SetFieldOfView(0);
    view->SetInputData(bytes);
    view->SetKeys("alpha=1");
    view->Update();
    EXPECT_EQ(view->GetOutput()->GetScalarType(), VTK_UNSIGNED_CHAR);
    EXPECT_EQ(view->GetOutput()->GetScalarComponentAsDouble(3, 4, 0, 1), 255);
}

/// Of the double sphere and the enhanced unified model, whose numbers calibrations have.
TEST(VtkPanoramaView, ProjectionsHaveTwoNumbersAndAHeight) {
    // Where a direction is in the picture, by the formula of Usenko and others, in focal lengths.
    const double xi = -0.2, alpha = 0.6;
    const auto sphere = [&](double x, double y, double z) {
        const double first = std::sqrt(x * x + y * y + z * z), moved = xi * first + z,
                     second = std::sqrt(x * x + y * y + moved * moved),
                     below = alpha * second + (1 - alpha) * moved;
        return std::array<double, 2>{x / below, y / below};
    };
    const double half = 75 * kPi / 180, edge = sphere(std::sin(half), 0, std::cos(half))[0];
    constexpr int kSide = 512;
    vtkNew<vtkImageData> picture;
    picture->SetDimensions(kSide, kSide / 2, 1);
    picture->AllocateScalars(VTK_FLOAT, 2);
    for (int j = 0; j < kSide / 2; ++j)
        for (int i = 0; i < kSide; ++i) {
            // The picture's columns and rows; its rows are half as high as its columns are wide.
            picture->SetScalarComponentFromDouble(i, j, 0, 0, i + 0.5);
            picture->SetScalarComponentFromDouble(i, j, 0, 1, 1);
        }
    vtkNew<vtkAnamorphPanoramaView> view;
    view->SetInputData(picture);
    view->SetProjection(vtkAnamorphPanoramaProjection::DOUBLE_SPHERE);
    view->SetFieldOfView(150);
    view->SetPanniniDistance(xi);
    view->SetProjectionAlpha(alpha);
    view->SetViewSize(41, 41);
    view->SetViewAngle(80);
    view->Update();
    const double focal = 20.5 / std::tan(40 * kPi / 180);
    double worst = 0;
    for (int i = 0; i < 41; ++i) {
        const double u = sphere(i + 0.5 - 20.5, 0, focal)[0] / edge * kSide / 2 + kSide / 2.0;
        worst = std::max(worst, std::fabs(view->GetOutput()->GetScalarComponentAsDouble(i, 20, 0, 0) - u));
    }
    EXPECT_LT(worst, 0.02);
    // A whole sphere in a square.
    view->SetInputData(directions(512, 512));
    view->SetProjection(vtkAnamorphPanoramaProjection::EQUIRECTANGULAR);
    view->SetFieldOfView(0);
    view->SetVerticalFieldOfView(180);
    view->Update();
    for (const auto& [i, j] : {std::pair{3, 4}, {20, 35}, {38, 11}})
        EXPECT_LT(distance(at(view->GetOutput(), i, j), ray_at(i, j, 41, 41, focal)), 2e-4);
}

TEST(VtkPanoramaView, RefusesKeysThatAreNotItsOwn) {
    vtkNew<vtkAnamorphPanoramaView> view;
    Errors errors(view);
    const auto error = [&](const char* keys) {
        errors.clear();
        view->SetKeys(keys);
        view->Modified();
        view->Update();
        return errors.text();
    };
    view->SetInputData(directions(64, 32));
    EXPECT_EQ(error("filter=bicubic&clamp=1"), "");
    for (const char* key : {"src=a.exr", "keys=a.json", "tile=64", "mip=1", "hash=1", "frames=2",
                            "subimage=0", "concatenate=0", "colorspace=linear"})
        EXPECT_THAT(error(key), testing::HasSubstr("must be given in recipes only")) << key;
    EXPECT_THAT(error("nonsense=1"), testing::HasSubstr("nonsense=1: there is no such parameter"));
    EXPECT_THAT(error("yaw=nan"), testing::HasSubstr("yaw=nan"));
    EXPECT_THAT(error("yaw"), testing::HasSubstr("yaw"));
    EXPECT_THAT(error("size=70000x10"), testing::HasSubstr("size=70000x10: must be at most 65536"));
    EXPECT_THAT(error("overscan=40000"), testing::HasSubstr("overscan"));
    EXPECT_THAT(error("lens=lensfun:lens=x,crop=1,focal=35"), testing::HasSubstr("lens"));
    EXPECT_THAT(error("image=1"), testing::HasSubstr("image=1"));
    EXPECT_EQ(view->GetOutput()->GetNumberOfPoints(), 0);
    view->SetProjectionAlpha(1.5);
    EXPECT_THAT(error(nullptr), testing::HasSubstr("srce=1.5"));
    view->SetProjectionAlpha(0.5);
    view->SetVerticalFieldOfView(-1);
    EXPECT_THAT(error(""), testing::HasSubstr("srcvfov=-1"));
    view->SetVerticalFieldOfView(0);
    EXPECT_EQ(error(""), "");
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
