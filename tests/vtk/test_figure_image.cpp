// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphFigureImage.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphFigureReader.h>
#include <vtkCommand.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "figure_support.h"
#include "support.h"

namespace {

using testing::HasSubstr;
using Image = vtkAnamorphFigureImage;

const Ball kNear{{500, 500, -200}, {100, 100, 100}, {1, 0, 0, 0}},
    kFar{{600, 500, -800}, {100, 100, 100}, {1, 0, 0, 0}};

vtkSmartPointer<vtkImageData> image(const std::vector<Ball>& balls, const std::function<void(Image*)>& set) {
    vtkNew<Image> filter;
    filter->SetInputData(figures(balls));
    filter->SetViewSize(100, 80);
    set(filter);
    filter->Update();
    return filter->GetOutput();
}

double value(vtkImageData* image, int x, int y, int c = 0) {
    return image->GetScalarComponentAsDouble(x, y, 0, c);
}

TEST(VtkFigureImage, IdsAreThoseOfTheFirstBodyThatARayMeets) {
    // 1000 units are 80 pixels high; the middle of the window is that of the picture.
    const auto ids = image({kNear, kFar}, [](Image* f) { f->SetStyle(Image::BODY_ID); });
    ASSERT_EQ(ids->GetDimensions()[0], 100);
    ASSERT_EQ(ids->GetDimensions()[1], 80);
    EXPECT_STREQ(ids->GetPointData()->GetScalars()->GetName(), "BodyId");
    const double unit = 1000.0 / 80;
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 100; ++x) {
            const double px = 500 + (x + 0.5 - 50) * unit, py = 500 + (y + 0.5 - 40) * unit;
            const auto inside = [&](const Ball& b) {
                return std::hypot(px - b.center.x, py - b.center.y) < 100;
            };
            ASSERT_EQ(value(ids, x, y), inside(kNear) ? 0 : inside(kFar) ? 1 : -1) << x << " " << y;
        }
}

TEST(VtkFigureImage, DepthIsThatOfTheSphere) {
    const auto depth = image({kNear, kFar}, [](Image* f) {
        f->SetStyle(Image::DEPTH);
        f->SetViewMode(Image::CAMERA);
        f->SetCameraPosition(500, 500, 300);
        f->SetCameraFocalPoint(500, 500, -200);
    });
    // On the axis of the camera, between four pixels, the near sphere is 400 away.
    EXPECT_NEAR(value(depth, 50, 40), 400, 1);
    EXPECT_GE(value(depth, 50, 40), 400);
    EXPECT_NEAR(value(depth, 0, 0), 1e30, 1e24);
}

/// Red on its right, blue in its upper half; the first row is the lowest.
vtkSmartPointer<vtkImageData> quarters(int slices = 1) {
    auto texture = vtkSmartPointer<vtkImageData>::New();
    texture->SetDimensions(64, 32, slices);
    texture->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c)
                texture->SetScalarComponentFromDouble(x, y, 0, c,
                                                      (c == 0 && x >= 32) || (c == 2 && y >= 16) ? 255 : 0);
    return texture;
}

TEST(VtkFigureImage, TexturesShowTheirMiddleToTheObserver) {
    const auto input = figures({kNear, {{200, 500, -200}, {100, 100, 100}, {1, 0, 0, 0}}});
    vtkNew<vtkStringArray> names;
    names->SetName("Texture");
    names->InsertNextValue("quarters");
    names->InsertNextValue("another");
    input->GetPointData()->AddArray(names);
    vtkNew<Image> filter;
    filter->SetInputData(input);
    filter->SetViewSize(100, 100);
    filter->SetLighting(Image::LAMBERT);
    const auto at = [&](int x, int y) {
        filter->Update();
        return std::array{value(filter->GetOutput(), x, y, 0) > 30, value(filter->GetOutput(), x, y, 2) > 30};
    };
    const auto plain = at(46, 46);
    for (const int mapping : {Image::LATLONG, Image::LINEAR, Image::OCTAHEDRAL}) {
        SCOPED_TRACE(mapping);
        filter->RemoveAllTextures();
        filter->AddTexture("quarters", quarters());
        filter->SetTextureMapping(mapping);
        EXPECT_EQ(at(46, 46), (std::array{false, false}));
        EXPECT_EQ(at(54, 46), (std::array{true, false}));
        EXPECT_EQ(at(46, 54), (std::array{false, true}));
        EXPECT_EQ(at(54, 54), (std::array{true, true}));
        EXPECT_EQ(at(16, 46), plain) << "the other body has a texture that is not there";
    }
    // Moved by half of its width.
    vtkNew<vtkDoubleArray> offsets;
    offsets->SetName("TextureOffset");
    offsets->SetNumberOfComponents(2);
    for (int i = 0; i < 2; ++i) offsets->InsertNextTuple2(32, 0);
    input->GetPointData()->AddArray(offsets);
    input->Modified();
    filter->SetTextureMapping(Image::LATLONG);
    EXPECT_EQ(at(46, 46), (std::array{true, false}));
    EXPECT_EQ(at(54, 46), (std::array{false, false}));
    filter->RemoveAllTextures();
    EXPECT_EQ(at(46, 46), plain);
    Errors errors(filter);
    filter->AddTexture("thick", quarters(2));
    filter->Update();
    EXPECT_THAT(errors.text(), HasSubstr("texture thick has 2 slices, but must have 1"));
}

TEST(VtkFigureImage, ColorsAreTheBodiesAndCoverageIsAlpha) {
    auto input = figures({kNear});
    vtkNew<vtkUnsignedCharArray> colors;
    colors->SetName("Color");
    colors->SetNumberOfComponents(3);
    colors->InsertNextTuple3(200, 100, 0);
    input->GetPointData()->AddArray(colors);
    vtkNew<Image> filter;
    filter->SetInputData(input);
    filter->SetViewSize(100, 100);
    filter->Update();
    vtkImageData* seen = filter->GetOutput();
    ASSERT_EQ(seen->GetNumberOfScalarComponents(), 4);
    double alpha = 0;
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x) {
            alpha += value(seen, x, y, 3) / 255;
            if (value(seen, x, y, 3) < 255) continue;
            EXPECT_NEAR(value(seen, x, y, 0), 2 * value(seen, x, y, 1), 2);
            EXPECT_EQ(value(seen, x, y, 2), 0);
        }
    // The area of the disc, of radius 10 pixels; samples and bytes err by less than half a percent.
    EXPECT_NEAR(alpha, 3.14159265 * 100, 1.5);
    // From above: the upper half is lighter, and the image's rows go up.
    EXPECT_GT(value(seen, 50, 57), value(seen, 50, 43) + 30);
    filter->SetLighting(Image::BLINN);
    filter->Update();
    EXPECT_GT(value(filter->GetOutput(), 46, 54), value(filter->GetOutput(), 57, 43) + 30);
}

TEST(VtkFigureImage, OutlinesAndSticks) {
    for (const int style : {Image::OUTLINE, Image::STICK}) {
        const auto lines = image({kNear}, [&](Image* f) { f->SetStyle(style); });
        double alpha = 0;
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 100; ++x) alpha += value(lines, x, y, 3) / 255;
        // Lines of 1 pixel: around a circle of radius 8, or along its diameter.
        const double length = style == Image::OUTLINE ? 2 * 3.14159265 * 8 : 16;
        EXPECT_NEAR(alpha, length, 1) << style;
    }
}

TEST(VtkFigureImage, BlocksBecomeAnImageEach) {
    vtkNew<vtkMultiBlockDataSet> blocks;
    blocks->SetNumberOfBlocks(2);
    blocks->SetBlock(0, figures({kNear}));
    vtkNew<Image> filter;
    Errors errors(filter);
    filter->SetInputData(blocks);
    filter->Update();
    auto* output = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(output);
    EXPECT_EQ(errors.text(), "");
    auto* first = vtkImageData::SafeDownCast(output->GetBlock(0));
    ASSERT_TRUE(first);
    vtkNew<Image> alone;
    alone->SetInputData(figures({kNear}));
    alone->Update();
    const std::vector<double> wanted = numbers(alone->GetOutput()->GetPointData()->GetScalars());
    EXPECT_EQ(wanted.size(), std::size_t{4 * 500 * 500});
    EXPECT_EQ(numbers(first->GetPointData()->GetScalars()), wanted);
}

/// A figure in all parts of the picture, which moves.
const char* const kLarge =
    "figure f 1 a\nellipsoid a 450 400 40\nrepeat 0 1 moveto f a 450 500 300\nlinear 0 4 moveby f world 100 "
    "0 0\nstop\n";

/// A script's figure.
class Film {
  public:
    Film() {
        m_reader->SetFileName(m_folder.write("film.nudes", kLarge).c_str());
        filter->SetInputConnection(m_reader->GetOutputPort());
        filter->SetViewSize(70, 50);
        filter->SetStyle(Image::BODY_ID);
    }
    vtkNew<Image> filter;

  private:
    Folder m_folder;
    vtkNew<vtkAnamorphFigureReader> m_reader;
};

TEST(VtkFigureImage, PartsOfTheImageAreThoseOfTheWhole) {
    Film film;
    Image* filter = film.filter;
    Errors errors(filter);
    for (const int style : {Image::SHADED, Image::OUTLINE, Image::DEPTH, Image::BODY_ID}) {
        filter->SetStyle(style);
        filter->Update();
        vtkNew<vtkImageData> whole;
        whole->DeepCopy(filter->GetOutput());
        const auto expect_part = [&](int points) {
            int e[6];
            vtkImageData* part = filter->GetOutput();
            part->GetExtent(e);
            EXPECT_EQ(part->GetNumberOfPoints(), points);
            for (int y = e[2]; y <= e[3]; ++y)
                for (int x = e[0]; x <= e[1]; ++x)
                    for (int c = 0; c < whole->GetNumberOfScalarComponents(); ++c)
                        ASSERT_EQ(part->GetScalarComponentAsDouble(x, y, 0, c),
                                  whole->GetScalarComponentAsDouble(x, y, 0, c))
                            << style << " " << x << " " << y;
        };
        const int extent[6] = {11, 53, 20, 31, 0, 0};
        filter->Modified();
        filter->UpdateExtent(extent);
        expect_part(43 * 12);
        int all = 0;
        for (int piece = 0; piece < 3; ++piece) {
            filter->Modified();
            filter->UpdatePiece(piece, 3, 0);
            const int points = static_cast<int>(filter->GetOutput()->GetNumberOfPoints());
            EXPECT_LT(points, 70 * 50);
            expect_part(points);
            all += points;
            const std::vector<double> seen = numbers(filter->GetOutput()->GetPointData()->GetScalars());
            if (style == Image::BODY_ID) {
                EXPECT_NE(std::count(seen.begin(), seen.end(), 0), 0) << "piece " << piece;
            }
        }
        EXPECT_GE(all, 70 * 50);
    }
    EXPECT_EQ(errors.text(), "");
}

TEST(VtkFigureImage, ATimeThatIsAskedForIsSeen) {
    Film film;
    const auto at = [&](double time) {
        film.filter->UpdateTimeStep(time);
        vtkImageData* seen = film.filter->GetOutput();
        EXPECT_EQ(seen->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), time);
        return numbers(seen->GetPointData()->GetScalars());
    };
    film.filter->UpdateInformation();
    EXPECT_EQ(film.filter->GetOutputInformation(0)->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()),
              4);
    const std::vector<double> first = at(1), last = at(4);
    EXPECT_NE(first, last);
    EXPECT_EQ(at(1), first);
}

TEST(VtkFigureImage, NoBodiesAreAnEmptyPictureAndNoInputIsAnError) {
    const auto empty = image({}, [](Image* f) { f->SetStyle(Image::BODY_ID); });
    for (const double id : numbers(empty->GetPointData()->GetScalars())) ASSERT_EQ(id, -1);
    EXPECT_EQ(empty->GetNumberOfPoints(), 100 * 80);
    vtkNew<Image> alone;
    Errors errors(alone);
    alone->Update();
    EXPECT_THAT(errors.text(), HasSubstr("0 connections"));
}

TEST(VtkFigureImage, ProgressRisesTo1AndAbortLeavesNothing) {
    vtkNew<Image> filter;
    vtkNew<ProgressObserver> progress;
    filter->AddObserver(vtkCommand::ProgressEvent, progress);
    filter->SetInputData(figures({kNear, kFar}));
    filter->Update();
    ASSERT_GE(progress->reports.size(), 4u);
    EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
    EXPECT_EQ(progress->reports.back(), 1);
    progress->algorithm = filter;
    progress->abort_at = 0.4;
    filter->Modified();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
    progress->abort_at = -1;
    filter->SetAbortExecute(0);
    filter->Modified();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 500 * 500);
}

TEST(VtkFigureImage, WhatCannotBeDoneIsAnError) {
    const auto error = [](const std::function<void(Image*)>& set) {
        vtkNew<Image> filter;
        Errors errors(filter);
        filter->SetInputData(figures({kNear}));
        set(filter);
        filter->Update();
        return errors.text();
    };
    EXPECT_THAT(error([](Image* f) { f->SetViewSize(0, 10); }), HasSubstr("ViewSize"));
    EXPECT_THAT(error([](Image* f) { f->SetViewSize(10, 100000); }), HasSubstr("ViewSize"));
    EXPECT_THAT(error([](Image* f) { f->SetInputData(vtkNew<vtkPolyData>()); }), "");
}

TEST(VtkFigureImage, TheSameBitsForAnyThreads) {
    std::vector<Ball> crowd;
    for (int i = 0; i < 40; ++i)
        crowd.push_back({{300 + 37.0 * (i % 10), 300 + 11.0 * i, -40.0 * (i % 7)},
                         {9.0 + i % 30, 45, 20},
                         {1, 0.1 * i, 0.3, 0.05 * i}});
    vtkNew<Image> filter;
    filter->SetInputData(figures(crowd));
    filter->SetViewSize(120, 90);
    filter->Update();
    const std::vector<double> wanted = numbers(filter->GetOutput()->GetPointData()->GetScalars());
    for_any_threads([&] {
        filter->Modified();
        filter->Update();
        ASSERT_EQ(numbers(filter->GetOutput()->GetPointData()->GetScalars()), wanted);
    });
}

TEST(VtkFigureImage, UpdatesOnlyAfterAChangeOfAValue) {
    vtkNew<Image> filter;
    expect_modified_by<Image>(
        filter,
        {[](Image* f) { f->SetStyle(Image::DEPTH); }, [](Image* f) { f->SetLighting(Image::BLINN); },
         [](Image* f) { f->AntialiasOff(); }, [](Image* f) { f->SetTextureMapping(Image::LINEAR); },
         [](Image* f) { f->SetViewMode(Image::CAMERA); }, [](Image* f) { f->SetViewSize(30, 20); },
         [](Image* f) { f->SetCameraPosition(1, 2, 3); }, [](Image* f) { f->SetCameraFocalPoint(1, 2, 0); },
         [](Image* f) { f->SetCameraViewUp(0, 1, 1); }, [](Image* f) { f->CameraParallelProjectionOn(); },
         [](Image* f) { f->SetCameraParallelScale(9); }, [](Image* f) { f->SetCameraViewAngle(50); }});
    filter->SetInputData(figures({kNear}));
    filter->Update();
    const vtkMTimeType made = filter->GetOutput()->GetMTime();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetMTime(), made);
}

TEST(VtkFigureImage, PrintsItsState) {
    expect_printed(
        vtkNew<Image>(),
        {"Style: shaded", "Lighting: rasel", "Antialias: 1", "ViewMode: script", "ViewSize: 500 500",
         "CameraPosition: 500 500 1500", "CameraFocalPoint: 500 500 ", "CameraViewUp: 0 1 0",
         "CameraParallelProjection: 0", "CameraParallelScale: ", "CameraViewAngle: 30"});
}

TEST(VtkFigureImage, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphFigureImage>("vtkAnamorphFigureImage");
}

}  // namespace
