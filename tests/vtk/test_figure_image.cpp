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

namespace test_figure_image {
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

/// A body that is turned, and what its own axes are in NUDES' space: z goes away.
const Ball kTurned{{500, 500, -200}, {200, 150, 180}, {0.8, 0.3, -0.4, 0.2}};

TEST(VtkFigureImage, SolidColorsAreOfThePointInTheBodysOwnAxes) {
    const auto at = [&](int x, int y) {
        // Where the ray in the middle of a pixel enters the ellipsoid: |M (o + t d)| = 1 in its own axes.
        const double unit = 1000.0 / 80;
        const glm::dvec3 o(500 + (x + 0.5 - 50) * unit, 500 + (y + 0.5 - 40) * unit, 1000), d(0, 0, -1);
        const glm::dvec3 a = kTurned.turned_back(o - kTurned.center) / kTurned.axes,
                         b = kTurned.turned_back(d) / kTurned.axes;
        const double half = glm::dot(a, b) / glm::dot(b, b),
                     root = half * half - (glm::dot(a, a) - 1) / glm::dot(b, b);
        if (root < 0.05) return glm::dvec3(NAN);
        glm::dvec3 own = (a + (-half - std::sqrt(root)) * b) * kTurned.axes;
        own.z = -own.z;
        return own;
    };
    const auto seen = image({kTurned}, [](Image* f) {
        f->SetAntialias(false);
        f->SetSolid(Image::FORMULA);
        f->SetSolidScale(400);
        f->SetSolidRed("k+x/scale");
        f->SetSolidGreen("k+y/scale");
        f->SetSolidBlue("k+z/scale");
        f->SetSolidDefinitions("k=0.5");
    });
    int compared = 0;
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 100; ++x) {
            const glm::dvec3 own = at(x, y);
            if (std::isnan(own.x) || value(seen, x, y, 3) < 255) continue;
            // The light is the same for all three: their shares of the sum are the colors'.
            double sum = 0, wanted = 0;
            for (int c = 0; c < 3; ++c) sum += value(seen, x, y, c), wanted += 0.5 + own[c] / 400;
            if (sum < 200) continue;
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(value(seen, x, y, c) / sum, (0.5 + own[c] / 400) / wanted, 1.5 / sum)
                    << x << " " << y << " " << c;
            ++compared;
        }
    EXPECT_GT(compared, 100);
}

TEST(VtkFigureImage, PresetsAreFormulasAndEmptyTextsOwnColors) {
    const auto colors = [](int solid, const char* red) {
        const auto seen = image({kTurned}, [&](Image* f) {
            f->SetSolid(solid);
            f->SetSolidRed(red);
        });
        return numbers(seen->GetPointData()->GetScalars());
    };
    const auto plain = colors(Image::NONE, "");
    EXPECT_EQ(colors(Image::FORMULA, ""), plain);
    EXPECT_EQ(colors(Image::FORMULA, "own_red"), plain);
    for (const int solid : {Image::WOOD, Image::MARBLE, Image::CHECKER}) {
        EXPECT_NE(colors(solid, ""), plain) << solid;
        EXPECT_EQ(colors(solid, "x"), colors(solid, "")) << "texts are of FORMULA alone";
    }
}

TEST(VtkFigureImage, HeightsTurnNormals) {
    vtkNew<vtkImageData> heights, upside_down, level;
    for (vtkImageData* data : {heights.Get(), upside_down.Get(), level.Get()}) {
        data->SetDimensions(64, 32, 1);
        data->AllocateScalars(VTK_FLOAT, 1);
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 64; ++x) {
                const double wave = 0.5 + 0.25 * std::sin(2 * 3.14159265358979 * x / 8.0) * std::cos(0.5 * y);
                data->SetScalarComponentFromDouble(x, y, 0, 0,
                                                   data == level     ? 0.3
                                                   : data == heights ? wave
                                                                     : 1 - wave);
            }
    }
    const auto lit = [&](vtkImageData* data, double scale, int mapping = Image::LATLONG) {
        const auto seen = image({kTurned}, [&](Image* f) {
            f->SetLighting(Image::LAMBERT);
            f->SetBumpScale(scale);
            f->SetTextureMapping(mapping);
            if (data) f->SetInputData(1, data);
        });
        return numbers(seen->GetPointData()->GetScalars());
    };
    const auto difference = [](const std::vector<double>& a, const std::vector<double>& b) {
        double most = 0;
        for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::fabs(a[i] - b[i]));
        return most;
    };
    const auto plain = lit(nullptr, 20);
    EXPECT_EQ(lit(level, 20), plain) << "no slope";
    EXPECT_EQ(lit(heights, 0), plain);
    EXPECT_GT(difference(lit(heights, 20), plain), 20);
    // What is high in one is low in the other: the same slopes.
    EXPECT_LE(difference(lit(upside_down, -20), lit(heights, 20)), 1);
    EXPECT_GT(difference(lit(upside_down, 20), lit(heights, 20)), 20);
    EXPECT_GT(difference(lit(heights, 20, Image::OCTAHEDRAL), lit(heights, 20)), 20);
    // Alpha is the bodies' own.
    const auto bumpy = lit(heights, 20);
    for (std::size_t i = 3; i < plain.size(); i += 4) ASSERT_EQ(bumpy[i], plain[i]);
}

TEST(VtkFigureImage, APartOfAPictureOfHeightsIsThatOfTheWhole) {
    vtkNew<vtkImageData> heights;
    heights->SetDimensions(9, 300, 1);
    heights->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    for (int y = 0; y < 300; ++y)
        for (int x = 0; x < 9; ++x)
            for (int c = 0; c < 3; ++c)
                heights->SetScalarComponentFromDouble(x, y, 0, c, (x * 37 + y * y * 5 + c * 91) % 256);
    vtkNew<Image> filter;
    filter->SetInputData(figures({kTurned}));
    filter->SetInputData(1, heights);
    filter->SetViewSize(60, 40);
    filter->Update();
    vtkNew<vtkImageData> whole;
    whole->DeepCopy(filter->GetOutput());
    const int extent[6] = {30, 35, 10, 25, 0, 0};
    filter->Modified();
    filter->UpdateExtent(extent);
    ASSERT_EQ(filter->GetOutput()->GetNumberOfPoints(), 6 * 16);
    for (int y = 10; y <= 25; ++y)
        for (int x = 30; x <= 35; ++x)
            for (int c = 0; c < 4; ++c)
                ASSERT_EQ(value(filter->GetOutput(), x, y, c), value(whole, x, y, c)) << x << " " << y;
    // Blocks of composite data have the same heights.
    vtkNew<vtkMultiBlockDataSet> blocks;
    blocks->SetNumberOfBlocks(2);
    blocks->SetBlock(1, figures({kTurned}));
    vtkNew<Image> several;
    Errors errors(several);
    several->SetInputData(blocks);
    several->SetInputData(1, heights);
    several->SetViewSize(60, 40);
    several->Update();
    EXPECT_EQ(errors.text(), "");
    auto* output = vtkMultiBlockDataSet::SafeDownCast(several->GetOutputDataObject(0));
    ASSERT_TRUE(output);
    auto* second = vtkImageData::SafeDownCast(output->GetBlock(1));
    ASSERT_TRUE(second);
    EXPECT_EQ(numbers(second->GetPointData()->GetScalars()), numbers(whole->GetPointData()->GetScalars()));
}

TEST(VtkFigureImage, FormulasKnowTheFrame) {
    Film film;
    film.filter->SetStyle(Image::SHADED);
    film.filter->SetSolid(Image::FORMULA);
    film.filter->SetSolidRed("frame/8");
    film.filter->SetSolidGreen("0.5");
    for (const int frame : {1, 4}) {
        film.filter->UpdateTimeStep(frame);
        vtkImageData* seen = film.filter->GetOutput();
        EXPECT_NEAR(value(seen, 35, 25, 0) / value(seen, 35, 25, 1), frame / 4.0, 0.02) << frame;
    }
}

double field(vtkImageData* image, const char* name) {
    vtkDataArray* array = image->GetFieldData()->GetArray(name);
    return array ? array->GetComponent(0, 0) : -1;
}

TEST(VtkFigureImage, FewerLinesStandForBodies) {
    const double radius = 100 * 80 / 1000.0, chords = 0.1;  // of kNear in pixels
    const auto drawn = [&](int outlines, double tolerance) {
        return image({kNear}, [&](Image* f) {
            f->SetStyle(Image::OUTLINE);
            f->SetOutlines(outlines);
            f->SetOutlineTolerance(tolerance);
        });
    };
    const auto length = [](vtkImageData* lines) {
        double alpha = 0;
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 100; ++x) alpha += value(lines, x, y, 3) / 255;
        return alpha;
    };
    const auto limbs = drawn(Image::LIMBS, 1);
    EXPECT_NEAR(field(limbs, "anamorph:max_error"), chords, 1e-12);
    // A box whose half-sides are 2 / (1 + sqrt(3)) of the radius is a square from the front.
    const double share = 2 / (1 + std::sqrt(3.0));
    const auto box = drawn(Image::BOXES, 1);
    EXPECT_NEAR(length(box), 8 * share * radius, 2);
    EXPECT_NEAR(field(box, "anamorph:max_error"), (1 - share) * radius + chords, 1e-9);
    // The levels' errors, in shares of the radius: a dot 1, its axis 1 as well, a box 0.27, contours less.
    const auto level = [&](double tolerance) {
        const auto lines = drawn(Image::LEVELS, tolerance);
        EXPECT_LE(field(lines, "anamorph:max_error"), tolerance + chords + 1e-9);
        return numbers(lines->GetPointData()->GetScalars());
    };
    EXPECT_EQ(level(0.3 * radius), numbers(box->GetPointData()->GetScalars()));
    EXPECT_NE(level(1.1 * radius), level(0.3 * radius));
    EXPECT_NEAR(length(drawn(Image::LEVELS, 1.1 * radius)), 3.14, 0.3) << "a dot, twice as wide as a line";
    EXPECT_EQ(level(0.2 * radius),
              numbers(drawn(Image::CONTOURS, 0.2 * radius)->GetPointData()->GetScalars()));
    EXPECT_GT(length(drawn(Image::CYLINDERS, 1)), 4 * radius);
    // The figures of the array Figure are levels of their own: two that are far apart are dots, and as one they are not.
    const std::vector<Ball> apart = {{{300, 500, -200}, {60, 60, 60}, {1, 0, 0, 0}},
                                     {{700, 500, -200}, {60, 60, 60}, {1, 0, 0, 0}}};
    const auto ink = [&](bool named) {
        auto input = figures(apart);
        vtkNew<vtkStringArray> names;
        names->SetName("Figure");
        names->InsertNextValue("one");
        names->InsertNextValue("two");
        if (named) input->GetPointData()->AddArray(names);
        vtkNew<Image> filter;
        filter->SetInputData(input);
        filter->SetViewSize(100, 80);
        filter->SetStyle(Image::OUTLINE);
        filter->SetOutlines(Image::LEVELS);
        filter->SetOutlineTolerance(6);
        filter->Update();
        return length(filter->GetOutput());
    };
    EXPECT_NEAR(ink(true), 6.28, 0.6);
    EXPECT_GT(ink(false), 8);
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
    // Numbers are checked whether or not the style has a use for them; texts where they are read.
    for (const double wrong : {0.0, 1e7, -1.0, double(NAN), double(INFINITY)}) {
        EXPECT_THAT(error([&](Image* f) { f->SetSolidScale(wrong); }),
                    HasSubstr("must be a number from 0.001 to 1e+06"));
        EXPECT_THAT(error([&](Image* f) { f->SetOutlineTolerance(wrong); }), HasSubstr("OutlineTolerance="));
    }
    for (const int wrong : {0, 17, -2147483647})
        EXPECT_THAT(error([&](Image* f) { f->SetSolidSamples(wrong); }),
                    HasSubstr("SolidSamples=" + std::to_string(wrong) + ": must be an integer from 1 to 16"));
    for (const double wrong : {1.1e6, -2e6, double(NAN)})
        EXPECT_THAT(error([&](Image* f) { f->SetBumpScale(wrong); }), HasSubstr("BumpScale="));
    EXPECT_THAT(error([](Image* f) {
                    f->SetSolid(Image::FORMULA);
                    f->SetSolidGreen("x+");
                }),
                HasSubstr("SolidGreen=x+: column 3"));
    EXPECT_THAT(error([](Image* f) {
                    f->SetSolid(Image::FORMULA);
                    f->SetSolidDefinitions("k=");
                }),
                HasSubstr("SolidDefinitions"));
    EXPECT_EQ(error([](Image* f) { f->SetSolidGreen("x+"); }), "");
    EXPECT_THAT(error([](Image* f) { f->SetInputData(1, quarters(2)); }),
                HasSubstr("Bump has 2 slices, but must have 1"));
    EXPECT_EQ(error([](Image* f) {
                  f->SetInputData(1, quarters(2));
                  f->SetStyle(Image::DEPTH);
              }),
              "");
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
}  // namespace test_figure_image
