// SPDX-License-Identifier: Apache-2.0
// Deformations with frames, images and names: as lists and tables have them, and on surfaces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphDeform.h>
#include <vtkAnamorphDeformTransform.h>
#include <vtkAnamorphDeformationList.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPlaneSource.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSphereSource.h>
#include <vtkTable.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "support.h"

namespace test_deform_frames {
namespace {

glm::dvec3 point(vtkPolyData* mesh, vtkIdType i) {
    glm::dvec3 p;
    mesh->GetPoint(i, &p.x);
    return p;
}

TEST(VtkDeformFrames, ListsTablesAndFilesHaveThem) {
    vtkNew<vtkAnamorphDeformationList> list, read;
    list->AddDeformation(.25, 0, .5, .5, 1, 0, 1);
    list->AddDeformation(0, 0, 1, 1, 0, 0, 1);
    const vtkMTimeType before = list->GetMTime();
    list->SetOrientation(0, 1, 0, 0, 0);
    list->SetMirror(0, 0, 0);
    list->SetName(0, nullptr);
    EXPECT_EQ(list->GetMTime(), before);
    vtkNew<vtkTable> table;
    list->WriteTable(table);
    EXPECT_EQ(table->GetNumberOfColumns(), 9);
    list->SetDepth(0, 1, 2);
    list->SetOrientation(0, 1, 2, .5, -1);
    list->SetMirror(0, vtkAnamorphDeformationList::MIRROR_U, .5);
    list->SetName(1, "chin");
    EXPECT_GT(list->GetMTime(), before);
    list->SetDeformation(0, .25, 0, .5, .5, 2, 0, 1);  // the rest stays
    EXPECT_EQ(list->GetOrientation(0)[3], -1);
    EXPECT_EQ(list->GetMirror(0)[1], .5);
    EXPECT_EQ(list->GetNumberOfDepths(), 1);
    list->WriteTable(table);
    EXPECT_EQ(table->GetNumberOfColumns(), 19);
    EXPECT_EQ(read->ReadTable(table), 1);
    EXPECT_EQ(read->GetAll(), list->GetAll());
    for (const char* name : {"frames.json", "frames.csv"}) {
        const std::string path = testing::TempDir() + name;
        ASSERT_EQ(list->WriteFile(path.c_str()), 1);
        ASSERT_EQ(read->ReadFile(path.c_str()), 1);
        EXPECT_EQ(read->GetAll(), list->GetAll()) << name;
    }
    // They go where their row goes.
    list->MoveDeformation(1, 0);
    EXPECT_EQ(list->GetName(0), "chin");
    EXPECT_EQ(list->GetOrientation(1)[1], 2);
    list->RemoveDeformation(0);
    EXPECT_EQ(list->GetName(0), "");
    EXPECT_EQ(list->GetMirror(0)[0], 1);
    list->InsertDeformation(0, 0, 0, 1, 1, 0, 0, 1);
    EXPECT_EQ(list->GetOrientation(0)[0], 1);
    EXPECT_EQ(list->GetOrientation(1)[0], 1);
    EXPECT_EQ(list->GetOrientation(1)[1], 2);
}

TEST(VtkDeformFrames, AnAnchoredBumpStandsOnTheSideOfASphere) {
    vtkNew<vtkSphereSource> ball;
    ball->SetRadius(1);
    ball->SetThetaResolution(90);
    ball->SetPhiResolution(90);
    ball->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputConnection(ball->GetOutputPort());
    filter->AutomaticPlaneOff();
    const double u = .6, v = -.5, w = std::sqrt(1 - u * u - v * v);
    for (const double sign : {1., -1.}) {
        filter->RemoveAllDeformations();
        filter->AddDeformation(u, v, .3, .2, 0, 0, sign * .5);
        filter->Update();
        EXPECT_EQ(filter->AnchorDeformation(0), 1);
        EXPECT_NEAR(filter->GetDepth(0)[0], w, 2e-3);
        EXPECT_EQ(filter->GetDepth(0)[1], .2);
        const double* numbers = filter->GetDeformation(0);
        const glm::dvec3 vector(numbers[4], numbers[5], numbers[6]);
        EXPECT_NEAR(glm::length(vector), .5, 1e-12);
        EXPECT_NEAR(glm::dot(glm::normalize(vector), glm::dvec3(u, v, w)), sign, 1e-3);
        filter->Update();
        // What is moved lies about the anchor, by the distance along the surface; the far side stays.
        vtkPolyData *in = ball->GetOutput(), *out = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0));
        double most = 0, place = 0;
        for (vtkIdType i = 0; i < in->GetNumberOfPoints(); ++i) {
            const double moved = glm::length(point(out, i) - point(in, i)),
                         apart = glm::length(point(in, i) - glm::dvec3(u, v, w));
            if (moved > most) {
                most = moved;
                place = apart;
            }
            if (apart > 1.4) {
                EXPECT_LT(moved, 1e-6);
            }
        }
        EXPECT_NEAR(most, .5, .02);
        EXPECT_LT(place, .06);
    }
    // Below, the part that is nearest in depth.
    filter->SetDepth(0, -.9, .2);
    EXPECT_EQ(filter->AnchorDeformation(0), 1);
    EXPECT_NEAR(filter->GetDepth(0)[0], -w, 2e-3);
    // Beside the surface, with texture coordinates, and of no deformation, there is nothing to hold on to.
    filter->AddDeformation(3, 3, 1, 1, 0, 0, 1);
    filter->Update();
    Errors errors(filter);
    EXPECT_EQ(filter->AnchorDeformation(1), 0);
    EXPECT_THAT(errors.text(), testing::HasSubstr("no part of the surface is over the deformation's centre"));
}

TEST(VtkDeformFrames, ImagesAreThoseOfThePlane) {
    vtkNew<vtkPlaneSource> square;
    square->SetOrigin(-1, -1, 0);
    square->SetPoint1(1, -1, 0);
    square->SetPoint2(-1, 1, 0);
    square->SetResolution(40, 40);
    square->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputConnection(square->GetOutputPort());
    filter->AutomaticPlaneOff();
    filter->GenerateOverlayOn();
    filter->AddDeformation(0, .3, .3, .3, 0, 0, .1);
    filter->AddDeformation(.5, .1, .3, .2, .2, .1, .3);
    filter->SetMirror(1, vtkAnamorphDeformationList::MIRROR_U, 0);
    filter->Update();
    auto* out = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0));
    for (vtkIdType j = 0; j < 41; ++j)
        for (vtkIdType i = 0; i < 41; ++i) {
            const glm::dvec3 p = point(out, 41 * j + i), q = point(out, 41 * j + 40 - i);
            EXPECT_NEAR(p.x, -q.x, 1e-12);
            EXPECT_NEAR(p.y, q.y, 1e-12);
            EXPECT_NEAR(p.z, q.z, 1e-12);
        }
    // The overlay has the image under its deformation's number.
    vtkDataArray* numbers = filter->GetOverlay()->GetCellData()->GetArray("Deformation");
    int of_second = 0;
    for (vtkIdType i = 0; i < numbers->GetNumberOfTuples(); ++i) of_second += numbers->GetTuple1(i) == 1;
    EXPECT_EQ(numbers->GetNumberOfTuples(), 9);
    EXPECT_EQ(of_second, 6);
    // The transform has it too.
    vtkNew<vtkAnamorphDeformTransform> transform;
    transform->SetDeformationList(filter->GetDeformationList());
    for (const glm::dvec3 p : {glm::dvec3(.45, .15, 0), glm::dvec3(-.45, .15, 0), glm::dvec3(.1, -.2, 1)}) {
        double a[3], b[3];
        transform->TransformPoint(&p.x, a);
        const double mirrored[3] = {-p.x, p.y, p.z};
        transform->TransformPoint(mirrored, b);
        EXPECT_NEAR(a[0], -b[0], 1e-12);
        EXPECT_NEAR(a[1], b[1], 1e-12);
        EXPECT_NEAR(a[2], b[2], 1e-12);
    }
}

TEST(VtkDeformFrames, WhatMakesNoSenseIsRefused) {
    vtkNew<vtkPlaneSource> square;
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputConnection(square->GetOutputPort());
    Errors errors(filter);
    const auto said = [&](const auto& set) {
        filter->RemoveAllDeformations();
        filter->AddDeformation(0, 0, 1, 1, 0, 0, 1);
        set();
        errors.clear();
        filter->Update();
        return errors.text();
    };
    EXPECT_THAT(said([&] { filter->SetOrientation(0, 1, 1, 0, 0); }),
                testing::HasSubstr("deformation 0: orientation=1,0,0: must be without a turn"));
    EXPECT_THAT(said([&] { filter->SetOrientation(0, 0, 0, 0, 0); }), testing::HasSubstr("orientation=0: "));
    EXPECT_THAT(said([&] { filter->SetMirror(0, 3, 0); }),
                testing::HasSubstr("mirror=3: must be 0 (none), 1 (u) or 2 (v)"));
    EXPECT_THAT(said([&] { filter->SetMirror(0, 1, std::nan("")); }), testing::HasSubstr("mirror_at=nan"));
    EXPECT_THAT(said([&] { filter->SetDeformationName(0, "a,b"); }), testing::HasSubstr("name=a,b: must be"));
    EXPECT_EQ(said([&] { filter->SetDeformationName(0, "brow"); }), "");
}

}  // namespace
}  // namespace test_deform_frames
