// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphFigureGeometry.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <random>
#include <set>

#include "figure_support.h"
#include "support.h"

namespace test_figure_geometry {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
/// X(t, p) of the header, at the texture coordinates (u, v).
glm::dvec3 at(const Ball& ball, double u, double v) {
    const double t = kPi * (v - 0.5), p = 2 * kPi * (0.5 - u);
    const glm::dvec3 s(std::cos(t) * std::sin(p), std::sin(t), -std::cos(t) * std::cos(p));
    return ball.center + ball.turned(ball.axes * s);
}

vtkSmartPointer<vtkPolyData> surface(vtkPolyData* input,
                                     const std::function<void(vtkAnamorphFigureGeometry*)>& set = {}) {
    return drawn<vtkAnamorphFigureGeometry>(input, [&](auto* geometry) {
        geometry->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        if (set) set(geometry);
    });
}

glm::dvec3 tuple3(vtkDataArray* array, vtkIdType i) {
    return {array->GetComponent(i, 0), array->GetComponent(i, 1), array->GetComponent(i, 2)};
}

/// Calls `body` with weights and corners for random points of all triangles.
void for_points_of_triangles(
    vtkPolyData* data,
    const std::function<void(vtkIdType cell, const vtkIdType* corners, const double* w)>& body) {
    const unsigned seed = 4711;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(0, 1);
    vtkNew<vtkIdList> corners;
    for (vtkIdType cell = 0; cell < data->GetNumberOfCells(); ++cell) {
        data->GetCellPoints(cell, corners);
        ASSERT_EQ(corners->GetNumberOfIds(), 3);
        for (int k = 0; k < 3; ++k) {
            double a = share(random), b = share(random);
            if (a + b > 1) a = 1 - a, b = 1 - b;
            const double w[3] = {a, b, 1 - a - b};
            body(cell, corners->GetPointer(0), w);
        }
    }
}

const Ball kLimb{{10, 20, 30}, {21, 64, 24}, {0.5, -0.1, 0.7, 0.3}};

TEST(VtkFigureGeometry, NoTriangleIsFurtherOffThanTheTolerance) {
    const Ball balls[] = {kLimb,
                          {{0, 0, 0}, {5, 5, 5}, {1, 0, 0, 0}},
                          {{1, 2, 3}, {0.01, 500, 0.02}, {1, 1, 0, 0}},
                          {{0, 0, 0}, {50, 0, 20}, {1, 0, 1, 0}},
                          {{0, 0, 0}, {30, 20, 0}, {1, 0, 0, 0}},
                          {{0, 0, 0}, {0, 70, 0}, {1, 0, 0, 0}},
                          {{9, 9, 9}, {0, 0, 0}, {1, 0, 0, 0}}};
    for (const Ball& ball : balls)
        for (const double tolerance : {0.01, 0.25, 30.0}) {
            SCOPED_TRACE(tolerance);
            const auto data = surface(figures({ball}), [&](auto* g) { g->SetTolerance(tolerance); });
            vtkDataArray *texture = data->GetPointData()->GetTCoords(),
                         *points = data->GetPoints()->GetData(),
                         *bounds = data->GetCellData()->GetArray("ChordalBound");
            double most = 0;
            for_points_of_triangles(data, [&](vtkIdType cell, const vtkIdType* corners, const double* w) {
                glm::dvec3 p(0);
                glm::dvec2 uv(0);
                for (int k = 0; k < 3; ++k) {
                    p += w[k] * tuple3(points, corners[k]);
                    uv += w[k] * glm::dvec2(texture->GetComponent(corners[k], 0),
                                            texture->GetComponent(corners[k], 1));
                }
                const double off = glm::length(p - at(ball, uv.x, uv.y)),
                             bound = bounds->GetComponent(cell, 0);
                most = std::max(most, off);
                // Texture coordinates are rounded to 2^-24.
                ASSERT_LE(off, bound + 1e-6 * 500);
                ASSERT_LE(bound, tolerance);
            });
            // Nor is it much finer than asked for.
            if (ball.axes == glm::dvec3(5) && tolerance < 1) {
                EXPECT_GT(most, 0.3 * tolerance);
            }
        }
}

TEST(VtkFigureGeometry, VerticesLieOnTheEllipsoidWithItsNormals) {
    const auto data = surface(figures({kLimb}));
    vtkDataArray* normals = data->GetPointData()->GetNormals();
    ASSERT_GT(data->GetNumberOfPoints(), 100);
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
        const glm::dvec3 own =
            kLimb.turned_back(tuple3(data->GetPoints()->GetData(), i) - kLimb.center) / kLimb.axes;
        ASSERT_NEAR(glm::length(own), 1, 1e-12);
        const glm::dvec3 gradient = glm::normalize(kLimb.turned(own / kLimb.axes));
        ASSERT_LT(glm::length(tuple3(normals, i) - gradient), 1e-6);
    }
}

TEST(VtkFigureGeometry, TrianglesFaceOutwardsAndCloseTheSurface) {
    const auto data = surface(figures({kLimb}), [](auto* g) { g->SetTolerance(0.01); });
    vtkDataArray* points = data->GetPoints()->GetData();
    vtkNew<vtkIdList> corners;
    double volume = 0;
    for (vtkIdType cell = 0; cell < data->GetNumberOfCells(); ++cell) {
        data->GetCellPoints(cell, corners);
        glm::dvec3 p[3];
        for (int k = 0; k < 3; ++k) p[k] = tuple3(points, corners->GetId(k)) - kLimb.center;
        const double part = glm::dot(p[0], glm::cross(p[1], p[2])) / 6;
        ASSERT_GT(part, 0);
        volume += part;
    }
    EXPECT_NEAR(volume / (4 * kPi / 3 * 21 * 64 * 24), 1, 2e-3);
}

TEST(VtkFigureGeometry, ThePictureIsInFrontAndNotMirrored) {
    // At rest: a figure faces NUDES' +z, VTK's -z.
    const Ball ball{{0, 0, 0}, {1, 1, 1}, {1, 0, 0, 0}};
    const auto data = surface(figures({ball}), [](auto* g) { g->SetTolerance(0.001); });
    vtkDataArray *texture = data->GetPointData()->GetTCoords(), *points = data->GetPoints()->GetData();
    int front = 0;
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
        const double u = texture->GetComponent(i, 0), v = texture->GetComponent(i, 1);
        const glm::dvec3 p = tuple3(points, i);
        if (v > 0.5) {
            ASSERT_GT(p.y, -1e-6);
        }
        if (u > 0.3 && u < 0.7 && v > 0.3 && v < 0.7) {
            ++front;
            ASSERT_LT(p.z, 0);
            // Who looks at the face, along +z with y up, has -x on the right.
            if (u > 0.51) {
                ASSERT_LT(p.x, 0);
            }
        }
    }
    EXPECT_GT(front, 50);
}

// ---- Tolerance in pixels ----

TEST(VtkFigureGeometry, PixelsOfTheScriptsView) {
    const auto figure = figures({kLimb});
    const auto in_units = surface(figure, [](auto* g) { g->SetTolerance(0.5); });
    // 500 pixels for 1000 units: a quarter of a pixel is half a unit.
    const auto in_pixels = surface(figure, [](auto* g) {
        g->SetToleranceMode(vtkAnamorphFigureGeometry::PIXELS);
        g->SetTolerance(0.25);
    });
    EXPECT_EQ(coordinates(in_pixels), coordinates(in_units));
}

/// A camera in perspective, 400 x 400 pixels.
struct Camera {
    glm::dvec3 position, focus;
    double angle = 40;

    void set(vtkAnamorphFigureGeometry* geometry) const {
        geometry->SetToleranceMode(vtkAnamorphFigureGeometry::PIXELS);
        geometry->SetViewMode(vtkAnamorphFigureGeometry::CAMERA);
        geometry->SetViewSize(400, 400);
        geometry->SetCameraPosition(position.x, position.y, position.z);
        geometry->SetCameraFocalPoint(focus.x, focus.y, focus.z);
        geometry->SetCameraViewAngle(angle);
    }
    /// Pixels from the middle, and the depth. Up is y.
    glm::dvec3 image(const glm::dvec3& p) const {
        const glm::dvec3 away = glm::normalize(focus - position),
                         right = glm::normalize(glm::cross(away, glm::dvec3(0, 1, 0))),
                         up = glm::cross(right, away), q = p - position;
        const double depth = glm::dot(away, q), zoom = 200 / std::tan(angle / 2 * kPi / 180) / depth;
        return {zoom * glm::dot(right, q), zoom * glm::dot(up, q), depth};
    }
};

/// How far points of the triangles are off on the screen, most, and how many of them are seen, for each body.
struct Moved {
    std::vector<double> most;
    std::vector<vtkIdType> seen;
};

Moved moved(const Camera& camera, const std::vector<Ball>& balls, double tolerance) {
    const auto data = surface(figures(balls), [&](auto* g) {
        camera.set(g);
        g->SetTolerance(tolerance);
    });
    Moved result{std::vector<double>(balls.size()), std::vector<vtkIdType>(balls.size())};
    vtkDataArray *texture = data->GetPointData()->GetTCoords(), *points = data->GetPoints()->GetData(),
                 *bodies = data->GetCellData()->GetArray("BodyId");
    for_points_of_triangles(data, [&](vtkIdType cell, const vtkIdType* corners, const double* w) {
        glm::dvec3 p(0);
        glm::dvec2 uv(0);
        for (int k = 0; k < 3; ++k) {
            p += w[k] * tuple3(points, corners[k]);
            uv +=
                w[k] * glm::dvec2(texture->GetComponent(corners[k], 0), texture->GetComponent(corners[k], 1));
        }
        const auto body = static_cast<std::size_t>(bodies->GetComponent(cell, 0));
        const glm::dvec3 q = camera.image(at(balls[body], uv.x, uv.y));
        if (!(q.z > 0) || std::max(std::fabs(q.x), std::fabs(q.y)) > 200) return;  // not on the screen
        result.most[body] = std::max(result.most[body], glm::length(glm::dvec2(camera.image(p) - q)));
        ++result.seen[body];
    });
    return result;
}

TEST(VtkFigureGeometry, PixelsOfACameraInPerspective) {
    const Camera camera{{0, 0, 100}, {0, 0, 0}};
    const Moved both = moved(
        camera, {{{0, 0, 80}, {10, 15, 10}, {1, 0.2, 0, 0}}, {{0, 0, -900}, {10, 15, 10}, {1, 0.2, 0, 0}}},
        0.2);
    EXPECT_GT(both.seen[0], 4 * both.seen[1]);
    EXPECT_LE(both.most[0], 0.2);
    EXPECT_GT(both.most[0], 0.1 * 0.2);
    EXPECT_LE(both.most[1], 0.2);
}

TEST(VtkFigureGeometry, ACameraOnAStageOrInARoomNeedsNoMoreThanItSees) {
    const Ball stage{{500, -10, 500}, {6000, 10, 6000}, {1, 0, 0, 0}},
        turned{{500, -10, 500}, {6000, 6000, 10}, {std::sqrt(0.5), std::sqrt(0.5), 0, 0}},
        room{{500, 0, 500}, {6000, 5000, 7000}, {1, 0.1, 0, 0.2}},
        doll{{500, 90, 0}, {30, 90, 20}, {1, 0, 0, 0}};
    const Camera camera{{500, 300, 1500}, {500, 150, 0}};
    for (const Ball& large : {stage, turned, room}) {
        const Moved both = moved(camera, {large, doll}, 0.5);
        EXPECT_GT(both.seen[0], 1000);
        EXPECT_GT(both.seen[1], 10);
        for (const double most : both.most) EXPECT_LE(most, 0.5);
    }
    // Of which a thousandth of the distance to the focal point would need several millions.
    const auto triangles = [&](const Ball& ball) {
        return surface(figures({ball}),
                       [&](auto* g) {
                           camera.set(g);
                           g->SetTolerance(0.5);
                       })
            ->GetNumberOfCells();
    };
    EXPECT_LT(triangles(room), 60'000);
    EXPECT_LT(triangles(stage), 600'000);
}

// ---- Data ----

TEST(VtkFigureGeometry, ArraysOfTheBodiesAreTheCells) {
    const auto input = figures({kLimb, {{0, 0, 0}, {1, 2, 3}, {1, 0, 0, 0}}});
    vtkNew<vtkStringArray> names;
    names->SetName("Name");
    names->InsertNextValue("limb");
    names->InsertNextValue("ball");
    input->GetPointData()->AddArray(names);
    const auto data = surface(input);
    vtkCellData* cells = data->GetCellData();
    auto* out = vtkStringArray::SafeDownCast(cells->GetAbstractArray("Name"));
    vtkDataArray* bodies = cells->GetArray("BodyId");
    ASSERT_TRUE(out && bodies);
    ASSERT_EQ(out->GetNumberOfValues(), data->GetNumberOfCells());
    for (vtkIdType i = 0; i < data->GetNumberOfCells(); ++i)
        ASSERT_EQ(out->GetValue(i), bodies->GetComponent(i, 0) == 0 ? "limb" : "ball");
    EXPECT_EQ(out->GetValue(data->GetNumberOfCells() - 1), "ball");
    EXPECT_FALSE(cells->GetArray("Axes"));
    EXPECT_FALSE(cells->GetArray("Orientation"));
}

TEST(VtkFigureGeometry, AxesMayBeNegativeAndTurnsOfAnyLength) {
    Ball other = kLimb;
    other.axes.y = -other.axes.y;
    other.turn = 2.0 * other.turn;
    const std::vector<double> a = coordinates(surface(figures({kLimb}))),
                              b = coordinates(surface(figures({other})));
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-12);
}

TEST(VtkFigureGeometry, NanAndInfAreLeftOut) {
    const auto alone = surface(figures({kLimb}));
    for (const double bad : {kNan, kInf})
        for (int where = 0; where < 3; ++where) {
            Ball spoiled = kLimb;
            (where == 0 ? spoiled.center.y : where == 1 ? spoiled.axes.z : spoiled.turn.w) = bad;
            const auto data = surface(figures({spoiled, kLimb}));
            EXPECT_EQ(coordinates(data), coordinates(alone));
            EXPECT_EQ(data->GetCellData()->GetArray("BodyId")->GetComponent(0, 0), 1);
        }
    Ball unturned = kLimb;
    unturned.turn = {0, 0, 0, 0};
    EXPECT_EQ(surface(figures({unturned}))->GetNumberOfPoints(), 0);
}

TEST(VtkFigureGeometry, WhatCannotBeDoneIsAnError) {
    EXPECT_NE(errors_of<vtkAnamorphFigureGeometry>(nullptr), "");
    EXPECT_EQ(errors_of<vtkAnamorphFigureGeometry>(vtkNew<vtkPolyData>()), "");
    const auto bare = figures({kLimb});
    bare->GetPointData()->RemoveArray("Axes");
    EXPECT_THAT(errors_of<vtkAnamorphFigureGeometry>(bare), HasSubstr("the input has no array \"Axes\""));
    vtkNew<vtkDoubleArray> narrow;
    narrow->SetName("Axes");
    narrow->SetNumberOfTuples(1);
    bare->GetPointData()->AddArray(narrow);
    EXPECT_THAT(errors_of<vtkAnamorphFigureGeometry>(bare),
                HasSubstr("the array \"Axes\" has 1 components, but must have 3"));
    const auto figure = figures({kLimb});
    for (const double bad : {0.0, -1.0, kNan})
        EXPECT_THAT(errors_of<vtkAnamorphFigureGeometry>(figure, [&](auto* g) { g->SetTolerance(bad); }),
                    HasSubstr("must be a number above 0"));
    EXPECT_THAT(errors_of<vtkAnamorphFigureGeometry>(figure, [](auto* g) { g->SetTolerance(1e-9); }),
                HasSubstr("is too small"));
    // Large bodies need too many triangles; with the tolerance that the message names they do not.
    const auto large = figures({{{}, {6e5, 3e5, 5e5}, {1, 0, 0, 0}}, {{}, {5e5, 5e5, 5e5}, {1, 0, 0, 0}}});
    const std::string refused =
        errors_of<vtkAnamorphFigureGeometry>(large, [](auto* g) { g->SetTolerance(2); });
    EXPECT_THAT(refused, testing::ContainsRegex(
                             "Tolerance=2: needs [0-9]+ triangles, but there must be at most 4194304; "));
    const std::size_t named = refused.find("4194304; ");
    ASSERT_NE(named, std::string::npos);
    const double enough = std::stod(refused.substr(named + 9));
    EXPECT_NE(errors_of<vtkAnamorphFigureGeometry>(large, [&](auto* g) { g->SetTolerance(enough / 2); }), "");
    EXPECT_EQ(errors_of<vtkAnamorphFigureGeometry>(large, [&](auto* g) { g->SetTolerance(enough); }), "");
    const auto camera = [&](const std::function<void(vtkAnamorphFigureGeometry*)>& set) {
        return errors_of<vtkAnamorphFigureGeometry>(figure, [&](auto* g) {
            g->SetToleranceMode(vtkAnamorphFigureGeometry::PIXELS);
            g->SetViewMode(vtkAnamorphFigureGeometry::CAMERA);
            set(g);
        });
    };
    EXPECT_EQ(camera([](auto*) {}), "");
    EXPECT_THAT(camera([](auto* g) { g->SetCameraPosition(kNan, 0, 0); }), HasSubstr("CameraPosition=nan"));
    EXPECT_THAT(camera([](auto* g) { g->SetCameraPosition(500, 500, -500); }), HasSubstr("span no plane"));
    EXPECT_THAT(camera([](auto* g) { g->SetCameraViewUp(0, 0, 1); }), HasSubstr("span no plane"));
    EXPECT_THAT(camera([](auto* g) { g->SetCameraViewAngle(180); }), HasSubstr("CameraViewAngle=180"));
    EXPECT_THAT(camera([](auto* g) { g->SetViewSize(10, 0); }), HasSubstr("ViewSize=0"));
    EXPECT_THAT(camera([](auto* g) {
                    g->CameraParallelProjectionOn();
                    g->SetCameraParallelScale(-1);
                }),
                HasSubstr("CameraParallelScale=-1"));
}

// ---- The pipeline ----

TEST(VtkFigureGeometry, TheSameBitsForAnyThreadsAndTheInputIsLeftAlone) {
    std::vector<Ball> crowd;
    for (int i = 0; i < 100; ++i)
        crowd.push_back({{20.0 * i, i % 7, 0}, {9, 5.0 + i % 11, 8}, {1, 0.1 * i, 0.3, 0}});
    const auto input = figures(crowd);
    const std::vector<double> before = coordinates(input),
                              axes = numbers(input->GetPointData()->GetArray("Axes"));
    vtkNew<vtkAnamorphFigureGeometry> geometry;
    geometry->SetInputData(input);
    geometry->Update();
    const std::vector<double> points = coordinates(geometry->GetOutput());
    for_any_threads([&] {
        geometry->Modified();
        geometry->Update();
        ASSERT_EQ(coordinates(geometry->GetOutput()), points);
    });
    EXPECT_EQ(coordinates(input), before);
    EXPECT_EQ(numbers(input->GetPointData()->GetArray("Axes")), axes);
}

TEST(VtkFigureGeometry, ProgressRisesTo1AndAbortLeavesNothing) {
    std::vector<Ball> crowd(200, kLimb);
    vtkNew<vtkAnamorphFigureGeometry> geometry;
    vtkNew<ProgressObserver> progress;
    geometry->AddObserver(vtkCommand::ProgressEvent, progress);
    geometry->SetInputData(figures(crowd));
    geometry->SetTolerance(5);
    geometry->Update();
    ASSERT_GE(progress->reports.size(), 5u);
    EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
    EXPECT_EQ(progress->reports.back(), 1);
    progress->algorithm = geometry;
    progress->abort_at = 0.5;
    geometry->Modified();
    geometry->Update();
    EXPECT_EQ(geometry->GetOutput()->GetNumberOfPoints(), 0);
}

TEST(VtkFigureGeometry, UpdatesOnlyAfterAChangeOfAValue) {
    vtkNew<vtkAnamorphFigureGeometry> geometry;
    using Geometry = vtkAnamorphFigureGeometry;
    expect_modified_by<Geometry>(
        geometry,
        {[](Geometry* g) { g->SetToleranceMode(Geometry::PIXELS); }, [](Geometry* g) { g->SetTolerance(2); },
         [](Geometry* g) { g->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION); },
         [](Geometry* g) { g->SetViewMode(Geometry::CAMERA); }, [](Geometry* g) { g->SetViewSize(3, 4); },
         [](Geometry* g) { g->SetCameraPosition(1, 2, 3); },
         [](Geometry* g) { g->SetCameraFocalPoint(1, 2, -3); },
         [](Geometry* g) { g->SetCameraViewUp(1, 0, 0); },
         [](Geometry* g) { g->CameraParallelProjectionOn(); },
         [](Geometry* g) { g->SetCameraParallelScale(7); }, [](Geometry* g) { g->SetCameraViewAngle(50); }});
    geometry->SetInputData(figures({kLimb}));
    expect_executed_once(geometry);
}

TEST(VtkFigureGeometry, PrintsItsState) {
    expect_printed(vtkNew<vtkAnamorphFigureGeometry>(),
                   {"Tolerance: 0.25", "ToleranceMode: units", "ViewSize: 500 500", "CameraViewAngle: 30"});
}

TEST(VtkFigureGeometry, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphFigureGeometry>("vtkAnamorphFigureGeometry");
}

}  // namespace
}  // namespace test_figure_geometry
