// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphFigureImage.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCommand.h>
#include <vtkImageData.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkUnsignedCharArray.h>

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
    EXPECT_TRUE(vtkImageData::SafeDownCast(output->GetBlock(0)));
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
        filter, {[](Image* f) { f->SetStyle(Image::DEPTH); }, [](Image* f) { f->SetLighting(Image::BLINN); },
                 [](Image* f) { f->AntialiasOff(); }});
    filter->SetInputData(figures({kNear}));
    filter->Update();
    const vtkMTimeType made = filter->GetOutput()->GetMTime();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetMTime(), made);
}

TEST(VtkFigureImage, PrintsItsState) {
    expect_printed(vtkNew<Image>(), {"Style: shaded", "Lighting: rasel", "Antialias: 1", "ViewMode: script"});
}

TEST(VtkFigureImage, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphFigureImage>("vtkAnamorphFigureImage");
}

}  // namespace
