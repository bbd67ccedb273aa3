// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphProjectionBake.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPlaneSource.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkSmartPointer.h>
#include <vtkSphereSource.h>
#include <vtkWeakPointer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "support.h"

namespace test_projection_bake {
namespace {

using testing::HasSubstr;
using Bake = vtkAnamorphProjectionBake;
constexpr double kPi = std::numbers::pi;

vtkSmartPointer<vtkPolyData> wall(double z = -1, double half = 1) {
    vtkNew<vtkPlaneSource> source;
    source->SetOrigin(-half, -half, z);
    source->SetPoint1(half, -half, z);
    source->SetPoint2(-half, half, z);
    source->Update();
    return source->GetOutput();
}

/// Two components: how far a pixel is from the left, and from the lower border.
vtkSmartPointer<vtkImageData> coordinates(int width, int height, int type = VTK_FLOAT) {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(type, 2);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            image->SetScalarComponentFromDouble(i, j, 0, 0, i + (type == VTK_FLOAT ? 0.5 : 0));
            image->SetScalarComponentFromDouble(i, j, 0, 1, j + (type == VTK_FLOAT ? 0.5 : 0));
        }
    return image;
}

TEST(VtkProjectionBake, TexelsShowWhatTheFormulaSays) {
    vtkNew<Bake> bake;
    bake->SetInputData(0, wall());
    bake->AddInputData(1, coordinates(400, 200));
    bake->AddProjector(0, 0, 0.5, 0, 0, -1, 0, 1, 0);
    bake->SetWidth(31);
    bake->SetHeight(21);
    bake->Update();
    vtkImageData* out = bake->GetOutput();
    ASSERT_EQ(out->GetNumberOfScalarComponents(), 3);
    ASSERT_EQ(out->GetScalarType(), VTK_FLOAT);
    for (int j = 0; j < 21; ++j)
        for (int i = 0; i < 31; ++i) {
            const double x = (i + 0.5) / 31 * 2 - 1, y = (j + 0.5) / 21 * 2 - 1, z = 1.5;
            EXPECT_NEAR(out->GetScalarComponentAsDouble(i, j, 0, 0),
                        (std::atan2(x, z) / (2 * kPi) + 0.5) * 400, 1e-3);
            EXPECT_NEAR(out->GetScalarComponentAsDouble(i, j, 0, 1),
                        (std::atan2(y, std::hypot(x, z)) / kPi + 0.5) * 200, 1e-3);
            EXPECT_EQ(out->GetScalarComponentAsDouble(i, j, 0, 2), 1);
        }
    EXPECT_EQ(
        vtkDataArray::SafeDownCast(out->GetFieldData()->GetAbstractArray("anamorph:painted"))->GetTuple1(0),
        31 * 21);
}

TEST(VtkProjectionBake, TwoProjectorsPaintWhatEitherSees) {
    vtkNew<Bake> bake;
    bake->SetInputData(0, wall());
    for (int k = 0; k < 2; ++k) bake->AddInputData(1, coordinates(100, 50, VTK_UNSIGNED_CHAR));
    bake->AddProjector(0, 0, 1, 0, 0, -1, 0, 1, 0);
    bake->AddProjector(0.5, 0.5, 0, 0, 0, -1, 0, 1, 0);
    bake->SetInputData(2, wall(0.5, 0.1));
    bake->SetWidth(64);
    bake->SetHeight(64);
    bake->Update();
    vtkImageData* out = bake->GetOutput();
    EXPECT_EQ(out->GetScalarType(), VTK_UNSIGNED_CHAR);
    EXPECT_EQ(out->GetScalarComponentAsDouble(32, 32, 0, 2), 255);
    // The middle is seen by the second alone: its panorama's lower left.
    EXPECT_NEAR(out->GetScalarComponentAsDouble(32, 32, 0, 0), (0.5 - std::atan2(0.5, 1) / (2 * kPi)) * 100,
                1.5);
    bake->RemoveAllProjectors();
    bake->AddProjector(0, 0, 1, 0, 0, -1, 0, 1, 0);
    bake->RemoveAllInputConnections(1);
    bake->AddInputData(1, coordinates(100, 50, VTK_UNSIGNED_CHAR));
    bake->Update();
    EXPECT_EQ(bake->GetOutput()->GetScalarComponentAsDouble(32, 32, 0, 2), 0);
    EXPECT_EQ(bake->GetOutput()->GetScalarComponentAsDouble(2, 2, 0, 2), 255);
    bake->OcclusionOff();
    bake->Update();
    EXPECT_EQ(bake->GetOutput()->GetScalarComponentAsDouble(32, 32, 0, 2), 255);
}

TEST(VtkProjectionBake, GivesThePartThatIsAskedFor) {
    vtkNew<Bake> bake, part;
    for (Bake* one : {bake.Get(), part.Get()}) {
        one->SetInputData(0, wall());
        one->AddInputData(1, coordinates(400, 200));
        one->AddProjector(0, 0, 0.5, 0, 0, -1, 0, 1, 0);
        one->SetWidth(31);
        one->SetHeight(21);
    }
    bake->Update();
    int extent[6] = {5, 17, 3, 11, 0, 0};
    part->UpdateExtent(extent);
    EXPECT_THAT(std::vector<int>(part->GetOutput()->GetExtent(), part->GetOutput()->GetExtent() + 6),
                testing::ElementsAreArray(extent));
    for (int j = extent[2]; j <= extent[3]; ++j)
        for (int i = extent[0]; i <= extent[1]; ++i)
            for (int c = 0; c < 3; ++c)
                EXPECT_EQ(part->GetOutput()->GetScalarComponentAsDouble(i, j, 0, c),
                          bake->GetOutput()->GetScalarComponentAsDouble(i, j, 0, c));
}

TEST(VtkProjectionBake, RefusesInWords) {
    const auto said = [](const std::function<void(Bake*)>& set) {
        vtkNew<Bake> bake;
        Errors errors(bake);
        bake->SetInputData(0, wall());
        bake->AddInputData(1, coordinates(100, 50));
        bake->AddProjector(0, 0, 0, 0, 0, -1, 0, 1, 0);
        set(bake);
        bake->Update();
        return errors.text();
    };
    EXPECT_EQ(said([](Bake*) {}), "");
    EXPECT_THAT(said([](Bake* b) { b->RemoveAllProjectors(); }), HasSubstr("projectors=0: must be as many"));
    EXPECT_THAT(said([](Bake* b) { b->SetWidth(0); }), HasSubstr("size=0: must be"));
    EXPECT_THAT(said([](Bake* b) { b->SetFade(kNan); }), HasSubstr("fade=nan: must be"));
    EXPECT_THAT(said([](Bake* b) { b->SetMargin(65); }), HasSubstr("margin=65: must be"));
    EXPECT_THAT(said([](Bake* b) { b->SetFieldOfView(361); }), HasSubstr("panorama fov=361: must be"));
    EXPECT_THAT(said([](Bake* b) { b->SetInputData(1, vtkNew<vtkImageData>()); }),
                HasSubstr("panorama=0: must be an image"));
    EXPECT_THAT(said([](Bake* b) {
                    vtkNew<vtkSphereSource> bare;
                    bare->Update();
                    b->SetInputData(0, bare->GetOutput());
                }),
                HasSubstr("mesh=no texture coordinates: must have them"));
    EXPECT_EQ(said([](Bake* b) { b->SetInputData(0, vtkNew<vtkPolyData>()); }), "");
}

/// A projector in the middle, and a small texture.
vtkSmartPointer<Bake> small_bake(vtkPolyData* mesh, vtkImageData* picture) {
    auto bake = vtkSmartPointer<Bake>::New();
    bake->SetInputData(0, mesh);
    bake->AddInputData(1, picture);
    bake->AddProjector(0, 0, 0, 0, 0, -1, 0, 1, 0);
    bake->SetWidth(40);
    bake->SetHeight(30);
    return bake;
}

std::vector<double> baked(vtkPolyData* mesh, vtkImageData* picture) {
    const auto bake = small_bake(mesh, picture);
    bake->Update();
    return numbers(bake->GetOutput()->GetPointData()->GetScalars());
}

/// The same numbers, component by component.
template <class Number>
vtkSmartPointer<vtkDataArray> apart(vtkDataArray* array) {
    auto copy = vtkSmartPointer<vtkSOADataArrayTemplate<Number>>::New();
    copy->SetNumberOfComponents(array->GetNumberOfComponents());
    copy->SetNumberOfTuples(array->GetNumberOfTuples());
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) copy->SetTuple(i, array->GetTuple(i));
    return copy;
}

TEST(VtkProjectionBake, ArraysOfAnyLayoutAndTypeGiveTheSame) {
    const auto mesh = wall(), other = vtkSmartPointer<vtkPolyData>::New();
    const auto picture = coordinates(100, 50), other_picture = vtkSmartPointer<vtkImageData>::New();
    other->DeepCopy(mesh);
    other->GetPoints()->SetData(apart<float>(mesh->GetPoints()->GetData()));
    other->GetPointData()->SetTCoords(apart<double>(mesh->GetPointData()->GetTCoords()));
    other_picture->DeepCopy(picture);
    other_picture->GetPointData()->SetScalars(apart<double>(picture->GetPointData()->GetScalars()));
    const auto before = numbers(mesh->GetPoints()->GetData());
    const auto wanted = baked(mesh, picture);
    EXPECT_EQ(baked(other, other_picture), wanted);
    EXPECT_EQ(numbers(mesh->GetPoints()->GetData()), before);
    for_any_threads([&] { EXPECT_EQ(baked(mesh, picture), wanted); });
}

TEST(VtkProjectionBake, LensesAndPanninisDistanceCount) {
    // Seen from 1 in front of it, the wall reaches 45 degrees each way.
    for (const bool pannini : {false, true}) {
        const auto bake = small_bake(wall(), coordinates(400, 400));
        bake->SetProjection(pannini ? 11 : 2);
        bake->SetFieldOfView(120);
        bake->SetFade(0);
        const double d = 0.5, k1 = -0.02;
        if (pannini)
            bake->SetPanniniDistance(d);
        else
            bake->SetLens("brown:k1=-0.02");
        bake->Update();
        for (int i = 0; i < 40; ++i) {
            // Level: across the middle rows, which are 1/30 up and down.
            const double x = (i + 0.5) / 40 * 2 - 1, y = 1. / 30, half = 60 * kPi / 180, a = std::atan(x);
            const double place =
                pannini ? (d + 1) * std::sin(a) / (d + std::cos(a)) : x * (1 + k1 * (x * x + y * y));
            const double border = pannini ? (d + 1) * std::sin(half) / (d + std::cos(half)) : std::tan(half);
            EXPECT_NEAR(bake->GetOutput()->GetScalarComponentAsDouble(i, 15, 0, 0),
                        (place / border + 1) * 200, 1e-2)
                << pannini << " " << i;
        }
    }
    const auto bake = small_bake(wall(), coordinates(100, 50));
    bake->SetLens("thick:a=1");
    Errors errors(bake);
    bake->Update();
    EXPECT_THAT(errors.text(), HasSubstr("thick"));
}

TEST(VtkProjectionBake, ProjectionsHaveTwoNumbersAndAHeight) {
    // The double sphere, by the formula of Usenko and others, with numbers as calibrations have them.
    const double xi = -0.25, alpha = 0.6;
    const auto sphere = [&](double x, double y, double z) {
        const double first = std::sqrt(x * x + y * y + z * z), moved = xi * first + z,
                     second = std::sqrt(x * x + y * y + moved * moved);
        return x / (alpha * second + (1 - alpha) * moved);
    };
    const auto bake = small_bake(wall(), coordinates(400, 400));
    bake->SetProjection(vtkAnamorphPanoramaProjection::DOUBLE_SPHERE);
    bake->SetFieldOfView(150);
    bake->SetFade(0);
    bake->SetPanniniDistance(xi);
    bake->SetProjectionAlpha(alpha);
    bake->Update();
    const double half = 75 * kPi / 180, border = sphere(std::sin(half), 0, std::cos(half));
    for (int i = 0; i < 40; ++i)
        EXPECT_NEAR(bake->GetOutput()->GetScalarComponentAsDouble(i, 15, 0, 0),
                    (sphere((i + 0.5) / 40 * 2 - 1, 1. / 30, 1) / border + 1) * 200, 1e-2)
            << i;
    // A whole sphere in a square: rows are half as far apart.
    const auto squeezed = small_bake(wall(), coordinates(400, 400));
    squeezed->SetFade(0);
    squeezed->SetVerticalFieldOfView(180);
    squeezed->Update();
    for (int j = 0; j < 30; ++j) {
        const double x = 1. / 40, y = (j + 0.5) / 30 * 2 - 1, lat = std::atan2(y, std::hypot(x, 1));
        EXPECT_NEAR(squeezed->GetOutput()->GetScalarComponentAsDouble(20, j, 0, 1), 200 + lat / kPi * 400,
                    1e-2)
            << j;
    }
    Errors errors(bake);
    const auto error = [&](double e, double vfov) {
        errors.clear();
        bake->SetProjectionAlpha(e);
        bake->SetVerticalFieldOfView(vfov);
        bake->Update();
        return errors.text();
    };
    EXPECT_THAT(error(std::nan(""), 0), HasSubstr("panorama e=nan"));
    EXPECT_THAT(error(1.01, 0), HasSubstr("panorama e=1.01: must be a number from 0 to 1"));
    EXPECT_THAT(error(0.5, 361), HasSubstr("panorama vfov=361"));
}

TEST(VtkProjectionBake, HardTrianglesHarmNothing) {
    const auto picture = coordinates(100, 50);
    const auto wanted = baked(wall(), picture);
    // A point and a coordinate that are none, without an area in space or in the texture, about the projector, without an end.
    const auto mesh = wall();
    auto* coordinates_of = mesh->GetPointData()->GetTCoords();
    const auto add = [&](std::initializer_list<std::array<double, 5>> corners) {
        std::vector<vtkIdType> ids;
        for (const auto& c : corners) {
            ids.push_back(mesh->GetPoints()->InsertNextPoint(c[0], c[1], c[2]));
            coordinates_of->InsertNextTuple2(c[3], c[4]);
        }
        mesh->GetPolys()->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
    };
    add({{kNan, 0, -1, 0, 0}, {1, 0, -1, 1, 0}, {0, 1, -1, 0, 1}});
    add({{0, 0, -1, kNan, 0}, {1, 0, -1, 1, 0}, {0, 1, -1, 0, kInf}});
    add({{0, 0, -1, 0.5, 0.5}, {0, 0, -1, 0.5, 0.5}, {0, 0, -1, 0.5, 0.5}});
    add({{kInf, 0, -1, 0.1, 0.1}, {1, 0, -kInf, 0.2, 0.1}, {0, 1, -1, 0.1, 0.2}});
    add({{-1, -1, 0, 3, 3}, {1, -1, 0, 4, 3}, {0, 1, 0, 3, 4}});
    EXPECT_EQ(baked(mesh, picture), wanted);
    // And nothing at all.
    const auto none = baked(vtkSmartPointer<vtkPolyData>::New(), picture);
    EXPECT_EQ(none.size(), wanted.size());
    EXPECT_TRUE(std::all_of(none.begin(), none.end(), [](double v) { return v == 0; }));
}

TEST(VtkProjectionBake, ProgressRisesTo1AbortEmptiesTheOutputAndNothingStays) {
    vtkWeakPointer<Bake> left;
    {
        const auto bake = small_bake(wall(), coordinates(100, 50));
        left = bake;
        bake->SetHeight(400);
        vtkNew<ProgressObserver> progress;
        progress->algorithm = bake;
        bake->AddObserver(vtkCommand::ProgressEvent, progress);
        bake->Update();
        ASSERT_GT(progress->reports.size(), 3u);
        EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
        EXPECT_EQ(progress->reports.back(), 1);
        progress->abort_at = 0.3;
        bake->Modified();
        bake->Update();
        EXPECT_EQ(bake->GetOutput()->GetNumberOfPoints(), 0);
        bake->SetAbortExecute(0);
    }
    EXPECT_EQ(left, nullptr);
}

TEST(VtkProjectionBake, CountsModificationsExecutesOnceAndPrints) {
    vtkNew<Bake> bake;
    expect_modified_by<Bake>(
        bake,
        {[](Bake* b) { b->SetProjection(1); }, [](Bake* b) { b->SetFieldOfView(90); },
         [](Bake* b) { b->SetWidth(20); }, [](Bake* b) { b->SetHeight(10); }, [](Bake* b) { b->SetFade(3); },
         [](Bake* b) { b->SetPanniniDistance(2); }, [](Bake* b) { b->SetProjectionAlpha(0.25); },
         [](Bake* b) { b->SetVerticalFieldOfView(70); }, [](Bake* b) { b->SetLens("none"); },
         [](Bake* b) { b->SetMargin(2); }, [](Bake* b) { b->OcclusionOff(); }});
    bake->AddProjector(0, 0, 0, 0, 0, -1, 0, 1, 0);
    expect_printed(bake,
                   {"Projection: cylindrical", "NumberOfProjectors: 1", "Width: 20", "Margin: 2",
                    "PanniniDistance: 2", "ProjectionAlpha: 0.25", "VerticalFieldOfView: 70", "Lens: none"});
    bake->SetInputData(0, wall());
    bake->AddInputData(1, coordinates(100, 50));
    expect_executed_once(bake);
    expect_overridden<Bake>("vtkAnamorphProjectionBake");
}

}  // namespace
}  // namespace test_projection_bake
