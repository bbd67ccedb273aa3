// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphFigureSkeleton.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphFigureReader.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "figure_support.h"
#include "support.h"

namespace test_figure_skeleton {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Skeleton = vtkAnamorphFigureSkeleton;

const Ball kBone{{500, 300, -500}, {10, 100, 20}, {1, 0, 0, 0}},
    kDot{{100, 100, -100}, {1, 1, 1}, {1, 0, 0, 0}}, kNeedle{{300, 500, -100}, {50, 1, 1}, {1, 0, 0, 0}};

TEST(VtkFigureSkeleton, TheLongestAxisOfEachBody) {
    const auto data = drawn<Skeleton>(figures({kBone, kNeedle}));
    EXPECT_EQ(data->GetNumberOfLines(), 2);
    EXPECT_THAT(coordinates(data),
                ElementsAre(500, 200, -500, 500, 400, -500, 250, 500, -100, 350, 500, -100));
    EXPECT_THAT(cell_numbers(data, "BodyId"), ElementsAre(0, 1));
    EXPECT_THAT(cell_numbers(data, "Detail"), testing::Each(double{Skeleton::BODY}));
    EXPECT_THAT(cell_numbers(data, "Radius"), testing::Each(0));
}

TEST(VtkFigureSkeleton, FromJointToJoint) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    reader->SetFileName(
        folder
            .write("limbs.n",
                   "figure f 3 a b c\nellipsoid a 1 9 1\nellipsoid b 1 9 1\nellipsoid c 1 9 1\n"
                   "joint j a 0 100 0 b 0 -100 0\njoint k b 0 100 0 c 0 -100 0\n"
                   "repeat 0 1 moveto f b 500 500 500\nstop")
            .c_str());
    vtkNew<Skeleton> filter;
    filter->SetInputConnection(reader->GetOutputPort());
    filter->SetMode(Skeleton::JOINTS);
    filter->Update();
    // a and c from their centres to their joints, b from joint to joint.
    EXPECT_THAT(coordinates(filter->GetOutput()),
                ElementsAre(500, 300, -500, 500, 400, -500, 500, 400, -500, 500, 600, -500, 500, 700, -500,
                            500, 600, -500));
    auto* names = vtkStringArray::SafeDownCast(filter->GetOutput()->GetCellData()->GetAbstractArray("Name"));
    ASSERT_TRUE(names);
    EXPECT_EQ(names->GetValue(2), "c");
    // Without joints there is nothing to draw.
    EXPECT_EQ(
        drawn<Skeleton>(figures({kBone}), [](auto* f) { f->SetMode(Skeleton::JOINTS); })->GetNumberOfCells(),
        0);
}

TEST(VtkFigureSkeleton, SpheresLieInsideAndComeNearTheSurface) {
    const auto data = drawn<Skeleton>(figures({kBone}), [](auto* f) {
        f->SetMode(Skeleton::SPHERES);
        f->SetTolerance(2);
    });
    const std::vector<double> centers = coordinates(data), radii = cell_numbers(data, "Radius");
    ASSERT_GT(radii.size(), 5u);
    ASSERT_EQ(centers.size(), 3 * radii.size());
    EXPECT_EQ(data->GetNumberOfVerts(), static_cast<vtkIdType>(radii.size()));
    // Points of the surface, by angles: none is further than 2 from the nearest sphere, nor inside of one.
    for (int i = 0; i <= 40; ++i)
        for (int j = 0; j < 40; ++j) {
            const double t = (i / 40.0 - 0.5) * 3.141592653589793, p = j / 20.0 * 3.141592653589793;
            const glm::dvec3 at =
                kBone.center +
                kBone.axes * glm::dvec3(std::cos(t) * std::cos(p), std::sin(t), std::cos(t) * std::sin(p));
            double nearest = HUGE_VAL;
            for (std::size_t k = 0; k < radii.size(); ++k)
                nearest = std::min(nearest, glm::length(at - glm::dvec3(centers[3 * k], centers[3 * k + 1],
                                                                        centers[3 * k + 2])) -
                                                radii[k]);
            ASSERT_LE(nearest, 2);
            ASSERT_GE(nearest, -1e-9);
        }
}

TEST(VtkFigureSkeleton, LevelOfDetail) {
    const auto data =
        drawn<Skeleton>(figures({kBone, kDot, kNeedle}), [](auto* f) { f->SetLevelOfDetail(3); });
    // 500 pixels for 1000 units: the dot is a pixel wide, the needle 50 by 1, the bone 100 by 10.
    EXPECT_EQ(data->GetNumberOfVerts(), 1);
    EXPECT_EQ(data->GetNumberOfLines(), 2);
    EXPECT_THAT(cell_numbers(data, "BodyId"), ElementsAre(1, 0, 2));
    EXPECT_THAT(cell_numbers(data, "Detail"),
                ElementsAre(double{Skeleton::DOT}, double{Skeleton::BODY}, double{Skeleton::LINE}));
    double at[3];
    data->GetPoint(0, at);
    EXPECT_THAT(at, ElementsAre(100, 100, -100));
    // Behind the observer there is nothing.
    const auto behind = drawn<Skeleton>(figures({kBone}), [](auto* f) {
        f->SetViewMode(Skeleton::CAMERA);
        f->SetCameraPosition(500, 300, -900);
        f->SetCameraFocalPoint(500, 300, -1900);
    });
    EXPECT_EQ(behind->GetNumberOfCells(), 0);
}

TEST(VtkFigureSkeleton, WhatCannotBeDoneIsAnError) {
    EXPECT_NE(errors_of<Skeleton>(nullptr), "");
    EXPECT_EQ(errors_of<Skeleton>(vtkNew<vtkPolyData>()), "");
    const auto bare = figures({kBone});
    bare->GetPointData()->RemoveArray("Axes");
    EXPECT_THAT(errors_of<Skeleton>(bare), HasSubstr("the input has no array \"Axes\""));
    for (const double bad : {-1.0, kNan})
        EXPECT_THAT(errors_of<Skeleton>(figures({kBone}), [&](auto* f) { f->SetLevelOfDetail(bad); }),
                    HasSubstr("must be a number of at least 0"));
    for (const double bad : {0.0, kNan})
        EXPECT_THAT(errors_of<Skeleton>(figures({kBone}), [&](auto* f) { f->SetTolerance(bad); }),
                    HasSubstr("must be a number above 0"));
    EXPECT_THAT(errors_of<Skeleton>(figures({kBone}),
                                    [](auto* f) {
                                        f->SetMode(Skeleton::SPHERES);
                                        f->SetTolerance(1e-9);
                                    }),
                HasSubstr("needs more than 10000 spheres"));
}

TEST(VtkFigureSkeleton, NanIsLeftOut) {
    Ball spoiled = kBone;
    spoiled.center.x = kInf;
    const auto data = drawn<Skeleton>(figures({spoiled, kNeedle}));
    EXPECT_EQ(coordinates(data), coordinates(drawn<Skeleton>(figures({kNeedle}))));
    EXPECT_THAT(cell_numbers(data, "BodyId"), ElementsAre(1));
}

TEST(VtkFigureSkeleton, UpdatesOnlyAfterAChangeOfAValue) {
    vtkNew<Skeleton> filter;
    expect_modified_by<Skeleton>(
        filter, {[](Skeleton* f) { f->SetMode(Skeleton::SPHERES); },
                 [](Skeleton* f) { f->SetLevelOfDetail(2); }, [](Skeleton* f) { f->SetTolerance(3); },
                 [](Skeleton* f) { f->SetOutputPointsPrecision(vtkAlgorithm::SINGLE_PRECISION); }});
    filter->SetInputData(figures({kBone}));
    vtkNew<ProgressObserver> progress;
    filter->AddObserver(vtkCommand::ProgressEvent, progress);
    filter->Update();
    EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
    EXPECT_EQ(progress->reports.back(), 1);
    const vtkMTimeType made = filter->GetOutput()->GetMTime();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetMTime(), made);
}

TEST(VtkFigureSkeleton, PrintsItsState) {
    expect_printed(vtkNew<Skeleton>(), {"Mode: axes", "LevelOfDetail: 0", "Tolerance: 1"});
}

TEST(VtkFigureSkeleton, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphFigureSkeleton>("vtkAnamorphFigureSkeleton");
}

}  // namespace
}  // namespace test_figure_skeleton
