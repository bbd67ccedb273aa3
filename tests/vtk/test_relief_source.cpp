// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphReliefSource.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkBMPWriter.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkImageAlgorithm.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedShortArray.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>

#include "support.h"

namespace test_relief_source {
namespace {

using Executive = vtkStreamingDemandDrivenPipeline;
using testing::HasSubstr;
using Picture = vtkSmartPointer<vtkImageData>;

/// Random numbers of a type: all of an integer's range, or -1 to 1.
Picture picture(int width, int height, int type = VTK_FLOAT, int components = 1, int left = 0,
                int bottom = 0) {
    std::mt19937 random(7);
    auto image = Picture::New();
    image->SetExtent(left, left + width - 1, bottom, bottom + height - 1, 0, 0);
    image->AllocateScalars(type, components);
    vtkDataArray* pixels = image->GetPointData()->GetScalars();
    const bool floating = type == VTK_FLOAT || type == VTK_DOUBLE;
    std::uniform_real_distribution<double> value(floating ? -1 : 0, floating ? 1 : pixels->GetDataTypeMax());
    for (vtkIdType i = 0; i < pixels->GetNumberOfTuples(); ++i)
        for (int c = 0; c < components; ++c)
            pixels->SetComponent(i, c, floating ? value(random) : std::floor(value(random)));
    return image;
}

vtkStructuredGrid* grid_of(vtkAnamorphReliefSource* source) {
    return source->GetOutput();
}

std::vector<double> heights(vtkStructuredGrid* grid) {
    return numbers(grid->GetPointData()->GetArray("Height"));
}

TEST(VtkRelief, RaisesThePlaneByTheEquationOfTheHeader) {
    const Picture image = picture(5, 4);
    vtkNew<vtkAnamorphReliefSource> source;
    source->SetInputData(image);
    source->SetOrigin(1, 2, 3);
    source->SetPoint1(1, 10, 3);
    source->SetPoint2(1, 2, 9);
    source->SetKeepAspect(false);
    source->SetHeightScale(2);
    source->SetHeightOffset(-0.5);
    source->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    source->Update();
    vtkStructuredGrid* grid = grid_of(source);
    int size[3];
    grid->GetDimensions(size);
    ASSERT_THAT(size, testing::ElementsAre(5, 4, 1));
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) {
            const vtkIdType i = y * 5 + x;
            const double h = 2 * image->GetScalarComponentAsDouble(x, y, 0, 0) - 0.5;
            double at[3], uv[2];
            grid->GetPoint(i, at);
            // (Point1 - Origin) x (Point2 - Origin) points along x.
            EXPECT_NEAR(at[0], 1 + h, 1e-12);
            EXPECT_NEAR(at[1], 2 + 8 * x / 4.0, 1e-12);
            EXPECT_NEAR(at[2], 3 + 6 * y / 3.0, 1e-12);
            EXPECT_NEAR(heights(grid)[static_cast<std::size_t>(i)], h, 1e-12);
            grid->GetPointData()->GetTCoords()->GetTuple(i, uv);
            EXPECT_NEAR(uv[0], (x + 0.5) / 5, 1e-6);
            EXPECT_NEAR(uv[1], (y + 0.5) / 4, 1e-6);
        }
}

/// The heights for a picture, with HeightScale 1.
std::vector<double> heights_of(vtkImageData* image,
                               const std::function<void(vtkAnamorphReliefSource*)>& set = {}) {
    vtkNew<vtkAnamorphReliefSource> source;
    source->SetInputData(image);
    source->SetHeightScale(1);
    source->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    if (set) set(source);
    source->Update();
    return heights(grid_of(source));
}

std::string error_of(vtkImageData* image, const std::function<void(vtkAnamorphReliefSource*)>& set = {}) {
    return errors_of(image, set);
}

void expect_near(const std::vector<double>& got, const std::vector<double>& wanted, double most) {
    ASSERT_EQ(got.size(), wanted.size());
    ASSERT_FALSE(got.empty());
    for (std::size_t i = 0; i < got.size(); ++i) ASSERT_NEAR(got[i], wanted[i], most) << i;
}

TEST(VtkRelief, WholeNumbersAreFractionsOfTheLargestOfTheirType) {
    for (const int type : {VTK_UNSIGNED_CHAR, VTK_UNSIGNED_SHORT, VTK_SHORT, VTK_INT}) {
        const Picture image = picture(4, 3, type);
        const double largest = image->GetPointData()->GetScalars()->GetDataTypeMax();
        std::vector<double> expected = numbers(image->GetPointData()->GetScalars());
        for (double& h : expected) h /= largest;
        expect_near(heights_of(image), expected, 1e-12);
    }
    const Picture image = picture(4, 3, VTK_DOUBLE);
    EXPECT_EQ(heights_of(image), numbers(image->GetPointData()->GetScalars()));
}

TEST(VtkRelief, HeightIsAComponentOrTheLuminance) {
    const Picture image = picture(4, 3, VTK_DOUBLE, 4);
    std::vector<double> second, luminance;
    for (vtkIdType i = 0; i < 12; ++i) {
        const double* p = image->GetPointData()->GetScalars()->GetTuple(i);
        second.push_back(p[1]);
        luminance.push_back(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]);
    }
    EXPECT_EQ(heights_of(image, [](auto* s) { s->SetComponent(1); }), second);
    expect_near(heights_of(image), luminance, 1e-12);
    const Picture two = picture(4, 3, VTK_DOUBLE, 2);
    EXPECT_EQ(heights_of(two), heights_of(two, [](auto* s) { s->SetComponent(0); }));
    EXPECT_THAT(error_of(two, [](auto* s) { s->SetComponent(2); }),
                HasSubstr("Component=2: must be an integer from -1 (luminance) to 1"));
}

TEST(VtkRelief, AnotherArrayMayBeChosenAndAnyLayoutIsRead) {
    const Picture image = picture(4, 3);
    vtkNew<vtkSOADataArrayTemplate<double>> apart;
    apart->SetName("apart");
    apart->SetNumberOfComponents(1);
    for (int i = 0; i < 12; ++i) apart->InsertNextTuple1(i);
    image->GetPointData()->AddArray(apart);
    EXPECT_EQ(heights_of(image, [](auto* s) { s->SetInputArrayToProcess(0, 0, 0, 0, "apart"); }),
              numbers(apart));
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetInputArrayToProcess(0, 0, 0, 0, "nothing"); }),
                HasSubstr("the picture has no such array of pixels"));
}

TEST(VtkRelief, EveryNthPixelOrAnyResolution) {
    const Picture image = picture(13, 9, VTK_DOUBLE);
    const auto pixel = [&](int x, int y) { return image->GetScalarComponentAsDouble(x, y, 0, 0); };
    std::vector<double> every_fourth, six_by_three;
    for (int y = 0; y < 9; y += 4)
        for (int x = 0; x < 13; x += 4) every_fourth.push_back(pixel(x, y));
    EXPECT_EQ(heights_of(image, [](auto* s) { s->SetSampleRate(4); }), every_fourth);
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 6; ++i) {
            const double at = i * 12 / 5.0;
            const int x = std::min(static_cast<int>(at), 11);
            six_by_three.push_back((x + 1 - at) * pixel(x, 4 * j) + (at - x) * pixel(x + 1, 4 * j));
        }
    expect_near(heights_of(image, [](auto* s) { s->SetResolution(6, 3); }), six_by_three, 1e-12);
    // 12 is no multiple of 5: as many points as fit, from the first pixel to the last.
    EXPECT_EQ(heights_of(image, [](auto* s) { s->SetSampleRate(5); }),
              heights_of(image, [](auto* s) { s->SetResolution(3, 2); }));
    // Never less than two.
    EXPECT_EQ(heights_of(image, [](auto* s) { s->SetSampleRate(VTK_INT_MAX); }).size(), 4u);
    const Picture column = picture(1, 9, VTK_DOUBLE);
    EXPECT_EQ(heights_of(column).size(), 18u);
    for (const int n : {1, -3})
        EXPECT_THAT(error_of(image, [n](auto* s) { s->SetResolution(n, 5); }),
                    HasSubstr("Resolution=" + std::to_string(n) + ": must be 0 or an integer of at least 2"));
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetResolution(VTK_INT_MAX, VTK_INT_MAX); }),
                HasSubstr("must be at most 2147483647 points"));
}

TEST(VtkRelief, SmoothingIsAGaussianMean) {
    const Picture image = picture(13, 9, VTK_DOUBLE);
    const double deviation = 1.3;
    std::vector<double> expected;
    for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 13; ++x) {
            double sum = 0, weights = 0;
            for (int b = std::max(y - 4, 0); b <= std::min(y + 4, 8); ++b)
                for (int a = std::max(x - 4, 0); a <= std::min(x + 4, 12); ++a) {
                    const double w =
                        std::exp(-((a - x) * (a - x) + (b - y) * (b - y)) / (2 * deviation * deviation));
                    sum += w * image->GetScalarComponentAsDouble(a, b, 0, 0);
                    weights += w;
                }
            expected.push_back(sum / weights);
        }
    expect_near(heights_of(image, [&](auto* s) { s->SetSmoothing(deviation); }), expected, 1e-12);
    EXPECT_EQ(heights_of(image, [](auto* s) { s->SetSmoothing(1e-300); }), heights_of(image));
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetSmoothing(kNan); }), HasSubstr("Smoothing=nan"));
}

TEST(VtkRelief, PixelsAreSquareIfAskedFor) {
    const auto bounds = [](vtkImageData* image, bool keep) {
        vtkNew<vtkAnamorphReliefSource> source;
        source->SetInputData(image);
        source->SetSize(8, 2);
        source->SetKeepAspect(keep);
        source->SetHeightScale(0);
        source->Update();
        double b[6];
        grid_of(source)->GetBounds(b);
        return std::vector<double>(b, b + 6);
    };
    const Picture image = picture(7, 5);
    EXPECT_THAT(bounds(image, false), testing::ElementsAre(-4, 4, -1, 1, 0, 0));
    EXPECT_THAT(bounds(image, true), testing::ElementsAre(-1.5, 1.5, -1, 1, 0, 0));
    image->SetSpacing(8, 1, 1);
    EXPECT_THAT(bounds(image, true), testing::ElementsAre(-4, 4, -1 / 3.0f, 1 / 3.0f, 0, 0));
}

TEST(VtkRelief, NormalsStandOnTheSurface) {
    // A slope of 0.5 along x and -2 along y: differences are exact.
    const Picture image = picture(5, 4, VTK_DOUBLE);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) image->SetScalarComponentFromDouble(x, y, 0, 0, 0.5 * x - 2 * y);
    vtkNew<vtkAnamorphReliefSource> source;
    source->SetInputData(image);
    source->SetSize(4, 3);
    source->SetHeightScale(1);
    source->Update();
    EXPECT_FALSE(grid_of(source)->GetPointData()->GetNormals());
    source->GenerateNormalsOn();
    source->Update();
    vtkDataArray* normals = grid_of(source)->GetPointData()->GetNormals();
    ASSERT_TRUE(normals);
    const double length = std::sqrt(0.25 + 4 + 1);
    for (vtkIdType i = 0; i < 20; ++i) {
        EXPECT_NEAR(normals->GetComponent(i, 0), -0.5 / length, 1e-6);
        EXPECT_NEAR(normals->GetComponent(i, 1), 2 / length, 1e-6);
        EXPECT_NEAR(normals->GetComponent(i, 2), 1 / length, 1e-6);
    }
}

// ---- Bad input ----

TEST(VtkRelief, WhatCannotBeRaisedIsAnError) {
    EXPECT_THAT(error_of(nullptr), HasSubstr("there is no picture: neither an input nor FileName"));
    vtkNew<vtkImageData> empty;
    EXPECT_THAT(error_of(empty), HasSubstr("the picture has no pixels"));
    vtkNew<vtkImageData> volume;
    volume->SetDimensions(3, 3, 2);
    volume->AllocateScalars(VTK_FLOAT, 1);
    EXPECT_THAT(error_of(volume), HasSubstr("the picture has 2 slices, but must have 1"));
    vtkNew<vtkImageData> bare;
    bare->SetDimensions(3, 3, 1);
    EXPECT_THAT(error_of(bare), HasSubstr("the picture has no such array of pixels"));

    const Picture image = picture(3, 3);
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetPoint2(1.5, -0.5, 0); }), HasSubstr("span no plane"));
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetPoint1(s->GetOrigin()); }), HasSubstr("span no plane"));
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetPoint1(1e300, 0, 0); }), HasSubstr("span no plane"));
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetSize(0, 1); }), HasSubstr("span no plane"));
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetOrigin(kInf, 0, 0); }), HasSubstr("Origin=inf"));
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetHeightScale(kNan); }), HasSubstr("HeightScale=nan"));
    EXPECT_THAT(error_of(image, [](auto* s) { s->SetHeightOffset(kInf); }), HasSubstr("HeightOffset=inf"));
    EXPECT_EQ(error_of(image), "");
}

TEST(VtkRelief, NanAndInfStayInTheirPoints) {
    const Picture image = picture(6, 5);
    image->SetScalarComponentFromDouble(2, 2, 0, 0, kNan);
    image->SetScalarComponentFromDouble(4, 1, 0, 0, kInf);
    vtkNew<vtkAnamorphReliefSource> source;
    source->SetInputData(image);
    source->GenerateNormalsOn();
    source->Update();
    const std::vector<double> h = heights(grid_of(source));
    for (std::size_t i = 0; i < h.size(); ++i) EXPECT_EQ(std::isfinite(h[i]), i != 14 && i != 10) << i;
    for (const double n : numbers(grid_of(source)->GetPointData()->GetNormals()))
        EXPECT_TRUE(std::isfinite(n));
}

// ---- Files ----

TEST(VtkRelief, PicturesAreReadFromFiles) {
    const Folder folder;
    const std::string name = folder.path("picture.png");
    const Picture image = picture(6, 5, VTK_UNSIGNED_CHAR, 3), other = picture(6, 5);
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName(name.c_str());
    writer->SetInputData(image);
    writer->Write();

    vtkNew<vtkAnamorphReliefSource> source;
    Errors errors(source);
    source->SetFileName(name.c_str());
    source->SetHeightScale(1);
    source->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    source->Update();
    EXPECT_EQ(heights(grid_of(source)), heights_of(image));
    // The file is read again when it is another.
    const Picture changed = picture(3, 4, VTK_UNSIGNED_CHAR, 3);
    writer->SetInputData(changed);
    writer->Write();
    std::filesystem::last_write_time(name, std::filesystem::last_write_time(name) + std::chrono::seconds(1));
    source->Modified();
    source->Update();
    EXPECT_EQ(heights(grid_of(source)), heights_of(changed));
    writer->SetInputData(image);
    writer->Write();
    source->Modified();
    source->Update();
    EXPECT_EQ(heights(grid_of(source)), heights_of(image));
    source->UpdatePiece(1, 2, 0);
    EXPECT_EQ(grid_of(source)->GetExtent()[1], 5);
    EXPECT_EQ(grid_of(source)->GetNumberOfPoints(), 20);
    source->SetInputData(other);  // goes before the file
    source->Update();
    EXPECT_EQ(heights(grid_of(source)), heights_of(other));
    EXPECT_EQ(errors.text(), "");
    source->SetInputConnection(nullptr);
    source->SetFileName(folder.path("missing.png").c_str());
    source->Update();
    EXPECT_THAT(errors.text(), HasSubstr("missing.png: there is no such file"));
    EXPECT_EQ(grid_of(source)->GetNumberOfPoints(), 0);  // not what was there before
    errors.clear();
    source->SetFileName(folder.write("text.png", "no picture").c_str());
    source->Update();
    EXPECT_THAT(errors.text(), HasSubstr("text.png: must be a picture that VTK's image readers know"));
    // Half of a picture, of which the reader itself makes an error but no error code.
    const std::string half = folder.path("half.bmp");
    vtkNew<vtkBMPWriter> bmp_writer;
    bmp_writer->SetFileName(half.c_str());
    bmp_writer->SetInputData(image);
    bmp_writer->Write();
    const auto size = std::filesystem::file_size(half);
    std::filesystem::resize_file(half, size / 2);
    source->SetFileName(half.c_str());
    for (int again = 0; again < 2; ++again) {
        errors.clear();
        source->Update();
        EXPECT_THAT(errors.text(), HasSubstr("half.bmp: it cannot be read"));
        EXPECT_EQ(grid_of(source)->GetNumberOfPoints(), 0);
    }
    errors.clear();
    bmp_writer->Write();
    source->Update();
    EXPECT_EQ(errors.text(), "");
    EXPECT_EQ(heights(grid_of(source)), heights_of(image));
}

// ---- The pipeline ----

/// Passes a picture, and notes which part of it is asked for, and when.
class Recorder : public vtkImageAlgorithm {
  public:
    static Recorder* New();
    vtkTypeMacro(Recorder, vtkImageAlgorithm);
    Picture image;
    std::vector<int> asked;
    double time = -1;

  protected:
    Recorder() { this->SetNumberOfInputPorts(0); }
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* out) override {
        const double range[2] = {0, 9};
        out->GetInformationObject(0)->Set(Executive::WHOLE_EXTENT(), image->GetExtent(), 6);
        out->GetInformationObject(0)->Set(Executive::TIME_RANGE(), range, 2);
        out->GetInformationObject(0)->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
        return 1;
    }
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* out) override {
        vtkInformation* info = out->GetInformationObject(0);
        const int* extent = info->Get(Executive::UPDATE_EXTENT());
        asked.assign(extent, extent + 6);
        if (info->Has(Executive::UPDATE_TIME_STEP())) time = info->Get(Executive::UPDATE_TIME_STEP());
        auto* data = vtkImageData::GetData(out);
        data->ShallowCopy(image);
        data->Crop(extent);
        data->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
        return 1;
    }
};
vtkStandardNewMacro(Recorder);

// VTK 9.1's own reader ends the program on these.
TEST(VtkRelief, APngFileThatIsNotWholeIsRefused) {
    const Folder folder;
    const std::string name = folder.path("whole.png");
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName(name.c_str());
    writer->SetInputData(picture(19, 13, VTK_UNSIGNED_CHAR, 3));
    writer->Write();
    std::ifstream file(name, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    ASSERT_GT(bytes.size(), 300u);
    const auto error_of_file = [&](const std::string& text) {
        return errors_of<vtkAnamorphReliefSource>(
            nullptr, [&](auto* r) { r->SetFileName(folder.write("a.png", text).c_str()); });
    };
    EXPECT_EQ(error_of_file(bytes), "");
    for (std::size_t length = 8; length < bytes.size(); length += length < 80 ? 1 : 29)
        EXPECT_THAT(error_of_file(bytes.substr(0, length)),
                    HasSubstr("the file ends before the picture does"))
            << length;
    for (std::size_t at = 8; at < bytes.size(); at += 41) {
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(damaged[at] ^ 1);
        EXPECT_THAT(error_of_file(damaged), testing::ContainsRegex("the file (ends before|is damaged)"))
            << at;
    }
    // A file that is mended is read.
    vtkNew<vtkAnamorphReliefSource> source;
    Errors errors(source);
    const std::string half = folder.write("half.png", bytes.substr(0, bytes.size() / 2));
    source->SetFileName(half.c_str());
    source->Update();
    EXPECT_THAT(errors.text(), HasSubstr("the file ends"));
    errors.clear();
    folder.write("half.png", bytes);
    source->Modified();
    source->Update();
    EXPECT_EQ(errors.text(), "");
    EXPECT_EQ(grid_of(source)->GetNumberOfPoints(), 19 * 13);
}

TEST(VtkRelief, PiecesAndGhostsMakeUpTheWholeAndReadWhatTheyNeed) {
    vtkNew<Recorder> recorder;
    recorder->image = picture(40, 61, VTK_FLOAT, 1, -5, 100);
    vtkNew<vtkAnamorphReliefSource> source;
    Errors errors(source);
    source->SetInputConnection(recorder->GetOutputPort());
    source->SetResolution(33, 47);
    source->SetSmoothing(0.9);
    source->GenerateNormalsOn();
    source->Update();
    EXPECT_THAT(recorder->asked, testing::ElementsAre(-5, 34, 100, 160, 0, 0));
    vtkNew<vtkStructuredGrid> whole;
    whole->DeepCopy(grid_of(source));
    ASSERT_EQ(whole->GetNumberOfPoints(), 33 * 47);
    for (const int pieces : {2, 4, 7})
        for (const int ghosts : {0, 1}) {
            vtkIdType cells = 0;
            for (int piece = 0; piece < pieces; ++piece) {
                recorder->Modified();  // else what it has already is enough
                source->UpdatePiece(piece, pieces, ghosts);
                vtkStructuredGrid* part = grid_of(source);
                vtkUnsignedCharArray* ghost = part->GetCellGhostArray();
                EXPECT_EQ(ghost != nullptr, ghosts > 0);
                for (vtkIdType i = 0; i < part->GetNumberOfCells(); ++i)
                    cells += !(ghost && ghost->GetValue(i));
                int e[6];
                part->GetExtent(e);
                for (int y = e[2]; y <= e[3]; ++y)
                    for (int x = e[0]; x <= e[1]; ++x) {
                        const vtkIdType i = (y - e[2]) * (e[1] - e[0] + 1) + x - e[0], k = y * 33 + x;
                        double a[3], b[3];
                        part->GetPoint(i, a);
                        whole->GetPoint(k, b);
                        ASSERT_THAT(a, testing::ElementsAreArray(b));
                        part->GetPointData()->GetNormals()->GetTuple(i, a);
                        whole->GetPointData()->GetNormals()->GetTuple(k, b);
                        ASSERT_THAT(a, testing::ElementsAreArray(b));
                    }
                // A row of points more, then 3 deviations.
                const double step = 60 / 46.0;
                EXPECT_GE(recorder->asked[2], 100 + std::floor((e[2] - 1) * step) - 3);
                EXPECT_LE(recorder->asked[3], 100 + std::ceil((e[3] + 1) * step) + 3);
                EXPECT_LE(recorder->asked[2], std::max(100 + (e[2] - 1) * step - 2, 100.0));
            }
            EXPECT_EQ(cells, 32 * 46);
        }
    EXPECT_EQ(errors.text(), "");
    EXPECT_TRUE(grid_of(source)->GetPointData()->GetArray("Height"));
    source->UpdatePiece(199, 200, 0);  // more pieces than rows
    EXPECT_EQ(errors.text(), "");
}

TEST(VtkRelief, TimeIsPassed) {
    vtkNew<Recorder> recorder;
    recorder->image = picture(4, 4);
    vtkNew<vtkAnamorphReliefSource> source;
    source->SetInputConnection(recorder->GetOutputPort());
    source->UpdateTimeStep(2.5);
    EXPECT_EQ(recorder->time, 2.5);
    EXPECT_EQ(grid_of(source)->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), 2.5);
    EXPECT_TRUE(source->GetOutputInformation(0)->Has(Executive::TIME_RANGE()));
}

TEST(VtkRelief, TheSameBitsForAnyThreadsAndBackend) {
    vtkNew<vtkAnamorphReliefSource> source;
    const Picture image = picture(150, 170);
    const std::vector<double> before = numbers(image->GetPointData()->GetScalars());
    source->SetInputData(image);
    source->SetSmoothing(2);
    source->GenerateNormalsOn();
    source->Update();
    const std::vector<double> points = coordinates(grid_of(source)),
                              normals = numbers(grid_of(source)->GetPointData()->GetNormals());
    for_any_threads([&] {
        source->Modified();
        source->Update();
        ASSERT_EQ(coordinates(grid_of(source)), points);
        ASSERT_EQ(numbers(grid_of(source)->GetPointData()->GetNormals()), normals);
    });
    EXPECT_EQ(numbers(image->GetPointData()->GetScalars()), before);
}

TEST(VtkRelief, ProgressRisesTo1AndAbortLeavesNothing) {
    vtkNew<vtkAnamorphReliefSource> source;
    vtkNew<ProgressObserver> progress;
    source->AddObserver(vtkCommand::ProgressEvent, progress);
    source->SetInputData(picture(20, 400));
    source->Update();
    ASSERT_GE(progress->reports.size(), 5u);
    EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
    EXPECT_EQ(progress->reports.back(), 1);
    progress->algorithm = source;
    progress->abort_at = 0.6;
    source->Modified();
    source->Update();
    EXPECT_EQ(grid_of(source)->GetNumberOfPoints(), 0);
    progress->abort_at = -1;
    source->SetAbortExecute(0);
    source->Modified();
    source->Update();
    EXPECT_EQ(grid_of(source)->GetNumberOfPoints(), 8000);
}

TEST(VtkRelief, UpdatesOnlyAfterAChangeOfAValue) {
    vtkNew<vtkAnamorphReliefSource> source;
    source->SetInputData(picture(4, 4));
    using Source = vtkAnamorphReliefSource;
    expect_modified_by<Source>(
        source, {[](Source* s) { s->SetFileName("name"); }, [](Source* s) { s->SetFileName(nullptr); },
                 [](Source* s) { s->SetOrigin(-1, 0, 0); }, [](Source* s) { s->SetPoint1(1, 0, 0); },
                 [](Source* s) { s->SetPoint2(0, 1, 0); }, [](Source* s) { s->KeepAspectOff(); },
                 [](Source* s) { s->SetHeightScale(3); }, [](Source* s) { s->SetHeightOffset(3); },
                 [](Source* s) { s->SetComponent(0); }, [](Source* s) { s->SetSampleRate(2); },
                 [](Source* s) { s->SetResolution(5, 6); }, [](Source* s) { s->SetSmoothing(1); },
                 [](Source* s) { s->GenerateNormalsOn(); }, [](Source* s) { s->SetSize(3, 4); },
                 [](Source* s) { s->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION); }});
    source->SetSampleRate(0);
    EXPECT_EQ(source->GetSampleRate(), 1);
    expect_executed_once(source);
}

TEST(VtkRelief, PrintsItsState) {
    vtkNew<vtkAnamorphReliefSource> source;
    source->SetSize(3, 4);
    source->SetFileName("face.png");
    expect_printed(source,
                   {"FileName: face.png", "Origin: -1.5 -2 0", "HeightScale: 0.1", "Resolution: 0 0"});
}

TEST(VtkRelief, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphReliefSource>("vtkAnamorphReliefSource");
}

}  // namespace
}  // namespace test_relief_source
