// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphFigureOutline.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "figure_support.h"
#include "support.h"

namespace test_figure_outline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Outline = vtkAnamorphFigureOutline;

const Ball kNear{{500, 500, -200}, {100, 100, 100}, {1, 0, 0, 0}},
    kFar{{600, 500, -800}, {100, 100, 100}, {1, 0, 0, 0}},
    kInside{{500, 500, -210}, {50, 60, 50}, {1, 0, 0, 0}};

std::vector<glm::dvec3> points_of(vtkPolyData* data, vtkIdType cell) {
    vtkNew<vtkIdList> ids;
    data->GetCellPoints(cell, ids);
    std::vector<glm::dvec3> points;
    for (vtkIdType k = 0; k < ids->GetNumberOfIds(); ++k) {
        double p[3];
        data->GetPoint(ids->GetId(k), p);
        points.push_back({p[0], p[1], p[2]});
    }
    return points;
}

TEST(VtkFigureOutline, ANearerSphereHidesAnArc) {
    const auto data = drawn<Outline>(figures({kNear, kFar}));
    ASSERT_EQ(data->GetNumberOfLines(), 2);
    EXPECT_THAT(cell_numbers(data, "BodyId"), ElementsAre(0, 1));
    EXPECT_THAT(cell_numbers(data, "Visible"), ElementsAre(1, 1));
    EXPECT_THAT(cell_numbers(data, "OtherBodyId"), ElementsAre(-1, -1));
    const std::vector<glm::dvec3> near = points_of(data, 0), far = points_of(data, 1);
    EXPECT_EQ(near.front(), near.back());
    // Seen along -z, limbs are circles in the planes of the centres.
    for (const glm::dvec3& p : near) ASSERT_NEAR(glm::length(p - kNear.center), 100, 1e-9);
    for (const glm::dvec3& p : far) {
        ASSERT_NEAR(p.z, -800, 1e-9);
        ASSERT_NEAR(glm::length(p - kFar.center), 100, 1e-9);
        ASSERT_GE(p.x, 550 - 1e-9);
    }
    // The circles cross at x = 550, y = 500 -+ sqrt(100^2 - 50^2).
    EXPECT_NEAR(far.front().x, 550, 1e-9);
    EXPECT_NEAR(std::fabs(far.front().y - 500), std::sqrt(7500.0), 1e-9);
    EXPECT_NEAR(std::fabs(far.back().y - 500), std::sqrt(7500.0), 1e-9);
}

TEST(VtkFigureOutline, HiddenArcsAreRemovedKeptOrNone) {
    const auto input = figures({kNear, kFar, kInside});
    EXPECT_THAT(cell_numbers(drawn<Outline>(input), "BodyId"), ElementsAre(0, 1));
    const auto kept = drawn<Outline>(input, [](auto* f) { f->SetHidden(Outline::KEPT); });
    EXPECT_THAT(cell_numbers(kept, "BodyId"), ElementsAre(0, 1, 1, 2));
    EXPECT_THAT(cell_numbers(kept, "Visible"), ElementsAre(1, 1, 0, 0));
    for (const glm::dvec3& p : points_of(kept, 2)) ASSERT_LE(p.x, 550 + 1e-9);
    const auto all = drawn<Outline>(input, [](auto* f) { f->SetHidden(Outline::TRANSPARENT); });
    EXPECT_THAT(cell_numbers(all, "BodyId"), ElementsAre(0, 1, 2));
    EXPECT_THAT(cell_numbers(all, "Visible"), ElementsAre(1, 1, 1));
}

TEST(VtkFigureOutline, ChordsHoldTheTolerance) {
    for (const double tolerance : {0.01, 0.1, 2.0}) {
        const auto data = drawn<Outline>(figures({kNear}), [&](auto* f) { f->SetTolerance(tolerance); });
        const std::vector<glm::dvec3> p = points_of(data, 0);
        double most = 0;
        for (std::size_t i = 0; i + 1 < p.size(); ++i)
            most = std::max(most, 100 - glm::length(0.5 * (p[i] + p[i + 1]) - kNear.center));
        // Half a pixel a unit.
        EXPECT_LE(0.5 * most, tolerance);
        EXPECT_GT(0.5 * most, 0.1 * tolerance);
    }
}

TEST(VtkFigureOutline, TheScriptsViewIsFollowed) {
    const auto input = figures({kNear, kFar});
    vtkNew<vtkDoubleArray> center, rotation;
    center->SetName("ViewCenter");
    center->SetNumberOfComponents(3);
    center->InsertNextTuple3(500, 500, -500);
    rotation->SetName("ViewRotation");
    rotation->SetNumberOfComponents(9);
    // Along x: z is to the right.
    const double rows[9] = {0, 0, 1, 0, 1, 0, 1, 0, 0};
    rotation->InsertNextTuple(rows);
    input->GetFieldData()->AddArray(center);
    input->GetFieldData()->AddArray(rotation);
    const auto data = drawn<Outline>(input);
    ASSERT_EQ(data->GetNumberOfLines(), 2);
    for (vtkIdType cell = 0; cell < 2; ++cell) {
        EXPECT_EQ(points_of(data, cell).front(), points_of(data, cell).back());
        for (const glm::dvec3& p : points_of(data, cell))
            ASSERT_NEAR(p.x, cell == 0 ? kNear.center.x : kFar.center.x, 1e-9);
    }
}

TEST(VtkFigureOutline, ACameraInPerspectiveSeesTheNearerSide) {
    const auto data = drawn<Outline>(figures({kNear}), [](auto* f) {
        f->SetViewMode(Outline::CAMERA);
        f->SetCameraPosition(500, 500, 0);
        f->SetCameraFocalPoint(500, 500, -200);
    });
    // Tangents from 200 before a sphere of radius 100 touch it 100^2 / 200 before its centre.
    ASSERT_EQ(data->GetNumberOfLines(), 1);
    for (const glm::dvec3& p : points_of(data, 0)) {
        ASSERT_NEAR(p.z, -150, 1e-9);
        ASSERT_NEAR(glm::length(p - kNear.center), 100, 1e-9);
    }
}

TEST(VtkFigureOutline, CurvesWhereBodiesMeet) {
    // Spheres of radius 100 whose centres are 120 apart along x meet where x is halfway, in a circle of
    // radius 80, half of which is before the other.
    const Ball other{{620, 500, -200}, {100, 100, 100}, {1, 0, 0, 0}};
    const auto data = drawn<Outline>(figures({kNear, other}), [](auto* f) {
        f->CrossingsOn();
        f->SetTolerance(0.01);
        f->SetHidden(Outline::KEPT);
    });
    const std::vector<double> others = cell_numbers(data, "OtherBodyId"),
                              visible = cell_numbers(data, "Visible");
    int curves = 0;
    for (vtkIdType cell = 0; cell < data->GetNumberOfCells(); ++cell) {
        if (others[static_cast<std::size_t>(cell)] != 1) continue;
        const bool seen = visible[static_cast<std::size_t>(cell)] == 1;
        curves += seen ? 1 : 10;
        for (const glm::dvec3& p : points_of(data, cell)) {
            ASSERT_NEAR(p.x, 560, 0.05);
            ASSERT_NEAR(std::hypot(p.y - 500, p.z + 200), 80, 0.05);
            if (seen) {
                ASSERT_GT(p.z, -200.1);
            } else {
                ASSERT_LT(p.z, -199.9);
            }
        }
    }
    EXPECT_EQ(curves, 11);
    EXPECT_THAT(cell_numbers(drawn<Outline>(figures({kNear, other})), "OtherBodyId"), testing::Each(-1));
}

TEST(VtkFigureOutline, NeighboursAreConnectedAlongTheirTangents) {
    const Ball upper{{500, 700, -200}, {100, 100, 100}, {1, 0, 0, 0}};
    const auto input = figures({kNear, upper});
    vtkNew<vtkDoubleArray> bodies, positions;
    bodies->SetName("JointBodies");
    bodies->SetNumberOfComponents(2);
    bodies->InsertNextTuple2(0, 1);
    positions->SetName("JointPosition");
    positions->SetNumberOfComponents(3);
    positions->InsertNextTuple3(500, 600, -200);
    input->GetFieldData()->AddArray(bodies);
    input->GetFieldData()->AddArray(positions);
    const auto data = drawn<Outline>(input, [](auto* f) { f->ConnectedOn(); });
    const std::vector<double> others = cell_numbers(data, "OtherBodyId"), ids = cell_numbers(data, "BodyId");
    int strokes = 0;
    for (vtkIdType cell = 0; cell < data->GetNumberOfCells(); ++cell) {
        const auto k = static_cast<std::size_t>(cell);
        const std::vector<glm::dvec3> points = points_of(data, cell);
        if (others[k] >= 0) {
            ++strokes;
            for (const glm::dvec3& p : points) {
                EXPECT_NEAR(std::fabs(p.x - 500), 100, 1e-6);
                EXPECT_NEAR(std::fabs(p.y - 600), 100, 1e-6);
            }
        } else {
            // Of the lower sphere the lower half is left, of the upper one the upper.
            for (const glm::dvec3& p : points) ASSERT_GE(ids[k] == 0 ? 500 - p.y : p.y - 700, -1e-6);
        }
    }
    EXPECT_EQ(strokes, 2);
}

// ---- Input ----

TEST(VtkFigureOutline, WhatCannotBeDoneIsAnError) {
    EXPECT_NE(errors_of<Outline>(nullptr), "");
    EXPECT_EQ(errors_of<Outline>(vtkNew<vtkPolyData>()), "");
    const auto bare = figures({kNear});
    bare->GetPointData()->RemoveArray("Orientation");
    EXPECT_THAT(errors_of<Outline>(bare), HasSubstr("the input has no array \"Orientation\""));
    for (const double bad : {0.0, kNan})
        EXPECT_THAT(errors_of<Outline>(figures({kNear}), [&](auto* f) { f->SetTolerance(bad); }),
                    HasSubstr("must be a number above 0"));
    // A tolerance that cannot be held is found before curves are followed, which takes long.
    vtkNew<ProgressObserver> progress;
    EXPECT_THAT(errors_of<Outline>(figures({kNear, kInside}),
                                   [&](auto* f) {
                                       f->CrossingsOn();
                                       f->SetTolerance(1e-300);
                                       f->AddObserver(vtkCommand::ProgressEvent, progress);
                                   }),
                HasSubstr("must be a tolerance that a million chords can hold"));
    for (const double report : progress->reports) EXPECT_TRUE(report <= 0.1 || report == 1) << report;
    Ball vast = kNear;
    vast.axes.x = 1e60;
    EXPECT_NE(errors_of<Outline>(figures({vast})), "");
}

TEST(VtkFigureOutline, NanIsLeftOut) {
    Ball spoiled = kNear;
    spoiled.axes.y = kNan;
    const auto data = drawn<Outline>(figures({spoiled, kFar}));
    EXPECT_EQ(coordinates(data), coordinates(drawn<Outline>(figures({kFar}))));
    EXPECT_THAT(cell_numbers(data, "BodyId"), ElementsAre(1));
}

TEST(VtkFigureOutline, BlocksWithNoneAndEmptyOnes) {
    vtkNew<vtkMultiBlockDataSet> blocks;
    blocks->SetNumberOfBlocks(3);
    blocks->SetBlock(0, figures({kNear}));
    blocks->SetBlock(2, vtkNew<vtkPolyData>());
    vtkNew<Outline> filter;
    Errors errors(filter);
    filter->SetInputData(blocks);
    filter->Update();
    auto* output = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(output);
    EXPECT_EQ(vtkPolyData::SafeDownCast(output->GetBlock(0))->GetNumberOfLines(), 1);
    EXPECT_EQ(output->GetBlock(1), nullptr);
    EXPECT_EQ(errors.text(), "");
}

TEST(VtkFigureOutline, TheSameBitsForAnyThreads) {
    std::vector<Ball> crowd;
    for (int i = 0; i < 90; ++i)
        crowd.push_back({{300 + 37.0 * (i % 10), 300 + 21.0 * i, -40.0 * (i % 7)},
                         {9.0 + i % 30, 45, 20},
                         {1, 0.1 * i, 0.3, 0.05 * i}});
    const auto input = figures(crowd);
    vtkNew<Outline> filter;
    filter->SetInputData(input);
    filter->CrossingsOn();
    filter->Update();
    const std::vector<double> points = coordinates(filter->GetOutput());
    EXPECT_GT(points.size(), 3000u);
    for_any_threads([&] {
        filter->Modified();
        filter->Update();
        ASSERT_EQ(coordinates(filter->GetOutput()), points);
    });
}

TEST(VtkFigureOutline, ProgressRisesTo1AndAbortLeavesNothing) {
    vtkNew<Outline> filter;
    vtkNew<ProgressObserver> progress;
    filter->AddObserver(vtkCommand::ProgressEvent, progress);
    filter->SetInputData(figures(std::vector<Ball>(70, kNear)));
    filter->Update();
    ASSERT_GE(progress->reports.size(), 3u);
    EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
    EXPECT_EQ(progress->reports.back(), 1);
    progress->algorithm = filter;
    progress->abort_at = 0.3;
    filter->Modified();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
}

TEST(VtkFigureOutline, UpdatesOnlyAfterAChangeOfAValue) {
    vtkNew<Outline> filter;
    expect_modified_by<Outline>(
        filter, {[](Outline* f) { f->SetHidden(Outline::KEPT); }, [](Outline* f) { f->CrossingsOn(); },
                 [](Outline* f) { f->ConnectedOn(); }, [](Outline* f) { f->SetTolerance(3); },
                 [](Outline* f) { f->SetOutputPointsPrecision(vtkAlgorithm::SINGLE_PRECISION); }});
    filter->SetInputData(figures({kNear}));
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetPoints()->GetDataType(), VTK_FLOAT);
    const vtkMTimeType made = filter->GetOutput()->GetMTime();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetMTime(), made);
}

TEST(VtkFigureOutline, PrintsItsState) {
    expect_printed(vtkNew<Outline>(),
                   {"Hidden: removed", "Crossings: 0", "Tolerance: 0.1", "ViewMode: script"});
}

TEST(VtkFigureOutline, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphFigureOutline>("vtkAnamorphFigureOutline");
}

}  // namespace
}  // namespace test_figure_outline
