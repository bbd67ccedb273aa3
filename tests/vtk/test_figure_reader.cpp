// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphFigureReader.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkFieldData.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

#include <cmath>
#include <functional>

#include "figure_support.h"
#include "support.h"

namespace test_figure_reader {
namespace {

using Executive = vtkStreamingDemandDrivenPipeline;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

vtkDataArray* array_of(vtkAnamorphFigureReader* reader, const char* name) {
    return reader->GetOutput()->GetPointData()->GetArray(name);
}

std::string text_of(vtkFieldData* data, const char* name, vtkIdType i) {
    auto* array = vtkStringArray::SafeDownCast(data->GetAbstractArray(name));
    return array ? std::string(array->GetValue(i)) : "no such array";
}

std::vector<double> steps_of(vtkAnamorphFigureReader* reader) {
    vtkInformation* info = reader->GetOutputInformation(0);
    const double* steps = info->Get(Executive::TIME_STEPS());
    return std::vector<double>(steps, steps + info->Length(Executive::TIME_STEPS()));
}

double time_of(vtkAnamorphFigureReader* reader) {
    return reader->GetOutput()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP());
}

TEST(VtkFigureReader, APointForEachEllipsoidInVtksSpace) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    reader->SetFileName(folder.write("two.n", kTwoBodies).c_str());
    reader->Update();
    vtkPolyData* output = reader->GetOutput();
    ASSERT_EQ(output->GetNumberOfPoints(), 2);
    EXPECT_EQ(output->GetNumberOfVerts(), 2);
    EXPECT_EQ(output->GetNumberOfLines(), 0);
    // a is at (100, 200, 300) + (10, 0, -2). The joint is 40 above it; b, first 20 above the joint, has been
    // turned by 90 degrees about x, which takes y to z. VTK's z is the negative.
    EXPECT_THAT(coordinates(output), ElementsAre(110, 200, -298, DoubleNear(110, 1e-12),
                                                 DoubleNear(240, 1e-12), DoubleNear(-318, 1e-12)));
    EXPECT_THAT(numbers(array_of(reader, "Axes")), ElementsAre(10, 40, 20, 5, 20, 8));
    // In VTK's space the turn takes y to -z: by -90 degrees about x.
    const double half = std::sqrt(0.5);
    EXPECT_THAT(numbers(array_of(reader, "Orientation")),
                ElementsAre(1, 0, 0, 0, DoubleNear(half, 1e-12), DoubleNear(-half, 1e-12), 0, 0));
    EXPECT_THAT(numbers(output->GetPointData()->GetScalars()), ElementsAre(10, 20, 30, 255, 128, 64));
    vtkPointData* data = output->GetPointData();
    EXPECT_EQ(text_of(data, "Texture", 0), "");
    EXPECT_EQ(text_of(data, "Texture", 1), "wood");
    EXPECT_EQ(data->GetArray("TextureOffset")->GetComponent(1, 1), 4);
    EXPECT_EQ(text_of(data, "Name", 1), "b");
    EXPECT_EQ(text_of(data, "Figure", 1), "f");
    EXPECT_THAT(numbers(output->GetFieldData()->GetArray("JointBodies")), ElementsAre(0, 1));
    EXPECT_THAT(numbers(output->GetFieldData()->GetArray("JointPosition")), ElementsAre(110, 240, -298));
    EXPECT_EQ(text_of(output->GetFieldData(), "JointName", 0), "j");
    EXPECT_THAT(numbers(output->GetFieldData()->GetArray("ViewCenter")), ElementsAre(500, 500, -500));
    EXPECT_THAT(numbers(output->GetFieldData()->GetArray("ViewRotation")),
                ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, -1));
}

TEST(VtkFigureReader, JointsAsLines) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    reader->SetFileName(folder.write("two.n", kTwoBodies).c_str());
    reader->JointsOn();
    reader->Update();
    vtkIdType count;
    const vtkIdType* ends;
    ASSERT_EQ(reader->GetOutput()->GetNumberOfLines(), 1);
    reader->GetOutput()->GetLines()->GetCellAtId(0, count, ends);
    EXPECT_EQ(std::vector<vtkIdType>(ends, ends + count), (std::vector<vtkIdType>{0, 1}));
}

TEST(VtkFigureReader, ThePlaceAndTurnOfTheView) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    // `observe 0 90 0` turns z to x: what was to the right is then nearest.
    reader->SetFileName(
        folder.write("v.n", "repeat 0 1 place 1 2 3\nrepeat 0 1 observe 0 90 0\nstop").c_str());
    reader->Update();
    vtkFieldData* field = reader->GetOutput()->GetFieldData();
    EXPECT_THAT(numbers(field->GetArray("ViewCenter")), ElementsAre(1, 2, -3));
    const std::vector<double> rows = numbers(field->GetArray("ViewRotation"));
    ASSERT_EQ(rows.size(), 9u);
    EXPECT_NEAR(rows[2], -1, 1e-12);  // right is where z was, which VTK negates
    EXPECT_NEAR(rows[4], 1, 1e-12);
    EXPECT_NEAR(rows[6], -1, 1e-12);  // away is where -x was
}

// ---- Time ----

TEST(VtkFigureReader, TimesAreTheFramesShown) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    Errors errors(reader);
    reader->SetFileName(folder.write("two.n", kTwoBodies).c_str());
    reader->UpdateInformation();
    EXPECT_THAT(steps_of(reader), ElementsAre(1, 2, 3, 4));
    const double* range = reader->GetOutputInformation(0)->Get(Executive::TIME_RANGE());
    EXPECT_THAT(std::vector<double>(range, range + 2), ElementsAre(1, 4));
    for (const auto& [asked, frame] : {std::pair{-5.0, 1.0},
                                       {1, 1},
                                       {1.9, 1},
                                       {2, 2},
                                       {3.5, 3},
                                       {4, 4},
                                       {99, 4},
                                       {1e300, 4},
                                       {kNan, 1},
                                       {2, 2}}) {
        reader->UpdateTimeStep(asked);
        EXPECT_EQ(time_of(reader), frame) << asked;
        EXPECT_NEAR(coordinates(reader->GetOutput())[0], 100 + 10 * frame, 1e-9) << asked;
    }
    EXPECT_EQ(errors.text(), "");
}

TEST(VtkFigureReader, OnlyWhatTheScriptShows) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    reader->SetFileName(folder.write("s.n", "speed -3\nlinear 0 10 moveby every world 1 2 3\nstop").c_str());
    reader->UpdateInformation();
    EXPECT_THAT(steps_of(reader), ElementsAre(3, 6, 9));
    reader->UpdateTimeStep(8.5);
    EXPECT_EQ(time_of(reader), 6);
    reader->SetFileName(folder.write("v.n", "view 3 5\nlinear 0 10 moveby every world 1 2 3\nstop").c_str());
    reader->UpdateInformation();
    EXPECT_THAT(steps_of(reader), ElementsAre(4, 5));
    reader->SetFileName(folder.write("long.n", "linear 0 5000000 moveby every world 1 2 3\nstop").c_str());
    reader->UpdateInformation();
    EXPECT_FALSE(reader->GetOutputInformation(0)->Has(Executive::TIME_STEPS()));
    EXPECT_EQ(reader->GetOutputInformation(0)->Get(Executive::TIME_RANGE())[1], 5000000);
}

TEST(VtkFigureReader, WithoutFramesFiguresAreAtRest) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    Errors errors(reader);
    reader->SetFileName(folder.write("rest.n", "figure f 1 a\nellipsoid a 1 2 3\nstop").c_str());
    reader->Update();
    EXPECT_EQ(errors.text(), "");
    EXPECT_EQ(reader->GetOutput()->GetNumberOfPoints(), 1);
    EXPECT_FALSE(reader->GetOutputInformation(0)->Has(Executive::TIME_RANGE()));
}

TEST(VtkFigureReader, AFrameIsTheSameInAnyOrder) {
    const Folder folder;
    const std::string path = folder.write("two.n", kTwoBodies);
    vtkNew<vtkAnamorphFigureReader> one;
    one->SetFileName(path.c_str());
    for (const int frame : {4, 1, 3, 2, 4}) {
        one->UpdateTimeStep(frame);
        vtkNew<vtkAnamorphFigureReader> other;
        other->SetFileName(path.c_str());
        other->UpdateTimeStep(frame);
        EXPECT_EQ(coordinates(one->GetOutput()), coordinates(other->GetOutput()));
        EXPECT_EQ(numbers(array_of(one, "Orientation")), numbers(array_of(other, "Orientation")));
    }
}

// ---- Files ----

std::string error_of(const std::string& path, const std::function<void(vtkAnamorphFigureReader*)>& set = {}) {
    return errors_of<vtkAnamorphFigureReader>(nullptr, [&](auto* reader) {
        reader->SetFileName(path.c_str());
        if (set) set(reader);
    });
}

TEST(VtkFigureReader, WhatCannotBeReadIsAnError) {
    const Folder folder;
    EXPECT_THAT(error_of(""), HasSubstr("FileName=: must be the name of a script"));
    EXPECT_THAT(error_of(folder.path("none.n")), HasSubstr("there is no such file"));
    EXPECT_THAT(error_of(folder.path("")), HasSubstr("there is no such file"));
    const std::string bad =
        folder.write("bad.n", "figure f 1 a\nellipsoid a 1 x 3\nlinear 0 1 moveby f a 1 oops 3\nstop");
    EXPECT_THAT(error_of(bad), HasSubstr("bad.n:2:15: error: found \"x\""));
    EXPECT_THAT(error_of(bad), HasSubstr("(and 1 more)"));
    const std::string late =
        folder.write("late.n", "variables 1 v\nlinear 2 3 divide v 1 0\nrepeat 0 1 set v 1\nstop");
    EXPECT_THAT(error_of(late, [](auto* r) { r->UpdateTimeStep(3); }), HasSubstr("late.n:2:"));
}

TEST(VtkFigureReader, AnErrorIsOverWhenItsCauseIs) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    Errors errors(reader);
    reader->SetFileName(folder.path("two.n").c_str());
    reader->Update();
    EXPECT_NE(errors.text(), "");
    errors.clear();
    folder.write("two.n", kTwoBodies);
    reader->Modified();
    reader->Update();
    EXPECT_EQ(errors.text(), "");
    EXPECT_EQ(reader->GetOutput()->GetNumberOfPoints(), 2);
    folder.write("two.n", "figure");
    reader->Modified();
    reader->Update();
    EXPECT_NE(errors.text(), "");
    EXPECT_EQ(reader->GetOutput()->GetNumberOfPoints(), 0);  // not what was there before
    folder.write("two.n", "stop");
    reader->Modified();
    reader->Update();
    EXPECT_EQ(reader->GetOutput()->GetNumberOfPoints(), 0);
}

TEST(VtkFigureReader, LibrariesAndIncludes) {
    const Folder folder;
    const std::string library = folder.write("lib.n", "figure f 1 a\nellipsoid a 1 2 3"),
                      plain = folder.write("plain.n", "linear 0 2 moveby f a 1 2 3\nstop"),
                      includes = folder.write("inc.n", "include lib.n\nlinear 0 2 moveby f a 1 2 3\nstop");
    EXPECT_THAT(error_of(plain), HasSubstr("plain.n:1:"));
    EXPECT_EQ(error_of(plain, [&](auto* r) { r->AddLibrary(library.c_str()); }), "");
    EXPECT_EQ(error_of(includes), "");
    EXPECT_THAT(error_of(plain, [&](auto* r) { r->AddLibrary("none.n"); }), HasSubstr("none.n"));
    vtkNew<vtkAnamorphFigureReader> reader;
    Errors errors(reader);
    reader->SetLibrary(2, "x");
    EXPECT_EQ(reader->GetNumberOfLibraries(), 3);
    EXPECT_STREQ(reader->GetLibrary(0), "");
    EXPECT_EQ(reader->GetLibrary(3), nullptr);
    reader->SetLibrary(-1, "x");
    EXPECT_THAT(errors.text(), HasSubstr("Library index=-1: must be"));
    reader->ClearLibraries();
    EXPECT_EQ(reader->GetNumberOfLibraries(), 0);
}

TEST(VtkFigureReader, Dialects) {
    const Folder folder;
    const std::string path =
        folder.write("d.n", "figure f 1 a\nellipsoid a -1 2 3\nlinear 0 1 moveby f a 1 2 3\nstop");
    EXPECT_EQ(error_of(path), "");
    EXPECT_THAT(error_of(path, [](auto* r) { r->SetDialect(vtkAnamorphFigureReader::STRICT); }),
                HasSubstr("d.n:2:"));
}

TEST(VtkFigureReader, SaysWhatItCanRead) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    EXPECT_EQ(reader->CanReadFile(folder.write("two.n", kTwoBodies).c_str()), 1);
    EXPECT_EQ(reader->CanReadFile(folder.write("cut.n", kTwoBodies.substr(0, 100)).c_str()), 1);
    EXPECT_EQ(reader->CanReadFile(folder.write("letter.n", "Dear reader, this is no script.").c_str()), 0);
    EXPECT_EQ(reader->CanReadFile(folder.write("zero.n", std::string(100, '\0')).c_str()), 0);
    EXPECT_EQ(reader->CanReadFile(folder.path("none.n").c_str()), 0);
    EXPECT_EQ(reader->CanReadFile(folder.path("").c_str()), 0);
    EXPECT_EQ(reader->CanReadFile(nullptr), 0);
}

// ---- The pipeline ----

TEST(VtkFigureReader, AllIsInTheFirstPiece) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    reader->SetFileName(folder.write("two.n", kTwoBodies).c_str());
    for (const int pieces : {1, 2, 3}) {
        vtkIdType points = 0;
        for (int piece = 0; piece < pieces; ++piece) {
            reader->UpdatePiece(piece, pieces, 0);
            points += reader->GetOutput()->GetNumberOfPoints();
        }
        EXPECT_EQ(points, 2);
    }
}

TEST(VtkFigureReader, PrecisionOfThePoints) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    reader->SetFileName(folder.write("two.n", kTwoBodies).c_str());
    reader->Update();
    EXPECT_EQ(reader->GetOutput()->GetPoints()->GetDataType(), VTK_DOUBLE);
    reader->SetOutputPointsPrecision(vtkAlgorithm::SINGLE_PRECISION);
    reader->Update();
    EXPECT_EQ(reader->GetOutput()->GetPoints()->GetDataType(), VTK_FLOAT);
}

TEST(VtkFigureReader, UpdatesOnlyAfterAChangeOfAValue) {
    const Folder folder;
    vtkNew<vtkAnamorphFigureReader> reader;
    using Reader = vtkAnamorphFigureReader;
    expect_modified_by<Reader>(
        reader, {[](Reader* r) { r->SetFileName("name"); }, [](Reader* r) { r->SetFileName(nullptr); },
                 [](Reader* r) { r->SetDialect(Reader::STRICT); },
                 [](Reader* r) { r->SetNumberOfLibraries(1); }, [](Reader* r) { r->SetLibrary(0, "a"); },
                 [](Reader* r) { r->ClearLibraries(); }, [](Reader* r) { r->JointsOn(); },
                 [](Reader* r) { r->SetOutputPointsPrecision(vtkAlgorithm::SINGLE_PRECISION); }});
    reader->SetFileName(folder.write("two.n", kTwoBodies).c_str());
    expect_executed_once(reader);
}

TEST(VtkFigureReader, PrintsItsState) {
    vtkNew<vtkAnamorphFigureReader> reader;
    reader->SetFileName("walk.n");
    reader->AddLibrary("fred.n");
    expect_printed(reader, {"FileName: walk.n", "Dialect: classic", "Libraries: fred.n", "Joints: 0"});
}

TEST(VtkFigureReader, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphFigureReader>("vtkAnamorphFigureReader");
}

}  // namespace
}  // namespace test_figure_reader
