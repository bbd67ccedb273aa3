// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphDrape.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringArray.h>
#include <vtkStructuredGrid.h>
#include <vtkTable.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVariant.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include "anamorph/image/pyramid.h"
#include "anamorph/operation/operation.h"
#include "anamorph/operation/side_files.h"
#include "anamorph/surface/surface.h"
#include "support.h"

namespace test_drape {
namespace {

using testing::HasSubstr;
using Drape = vtkAnamorphDrape;
using Picture = vtkSmartPointer<vtkImageData>;

/// Random numbers, of whole ones all but 0, which hides what it is the alpha of.
Picture picture(int width, int height, int type = VTK_UNSIGNED_CHAR, int components = 3) {
    std::mt19937 random(5);
    auto image = Picture::New();
    image->SetExtent(-3, width - 4, 7, height + 6, 2, 2);
    image->AllocateScalars(type, components);
    vtkDataArray* pixels = image->GetPointData()->GetScalars();
    const double most = type == VTK_FLOAT ? 1 : pixels->GetDataTypeMax();
    std::uniform_real_distribution<double> value(type == VTK_FLOAT ? 0.1 : 1, most);
    for (vtkIdType i = 0; i < pixels->GetNumberOfTuples(); ++i)
        for (int c = 0; c < components; ++c) {
            const double v = value(random);
            pixels->SetComponent(i, c, type == VTK_FLOAT ? static_cast<float>(v) : std::floor(v));
        }
    return image;
}

vtkDataArray* drawn(Drape* filter) {
    filter->Update();
    return filter->GetOutput()->GetPointData()->GetScalars();
}

std::vector<double> drawn_numbers(Drape* filter) {
    return numbers(drawn(filter));
}

/// The view in which a flat texture fills the image, pixel on pixel.
void look_straight(Drape* filter, int width, int height) {
    filter->SetViewSize(width, height);
    filter->CameraParallelProjectionOn();
    filter->SetCameraParallelScale(0.5);
}

TEST(VtkDrape, APlaneSeenStraightOnGivesTheTextureBack) {
    for (const int type : {VTK_UNSIGNED_CHAR, VTK_UNSIGNED_SHORT, VTK_FLOAT})
        for (const int components : {1, 2, 3, 4}) {
            SCOPED_TRACE(testing::Message() << type << " " << components);
            const Picture texture = picture(37, 23, type, components);
            vtkNew<Drape> filter;
            Errors errors(filter);
            filter->SetInputData(texture);
            look_straight(filter, 37, 23);
            filter->SetFilter(Drape::NEAREST);
            vtkDataArray* seen = drawn(filter);
            ASSERT_EQ(errors.text(), "");
            ASSERT_TRUE(seen);
            EXPECT_STREQ(seen->GetName(), "Colors");
            EXPECT_EQ(seen->GetDataType(), type);
            const std::vector<double> wanted = numbers(texture->GetPointData()->GetScalars()),
                                      found = numbers(seen);
            ASSERT_EQ(found.size(), wanted.size());
            // Color is multiplied by alpha while it is read: a rounding of float or two.
            for (std::size_t i = 0; i < wanted.size(); ++i)
                ASSERT_NEAR(found[i], wanted[i], type == VTK_FLOAT ? 1e-6 : 0) << i;
            EXPECT_LT(filter->GetMaxError(), 0.125);
        }
}

TEST(VtkDrape, AntialiasedWholePixelsAreThoseOfTheTexture) {
    const Picture texture = picture(40, 40, VTK_UNSIGNED_CHAR, 3);
    vtkNew<Drape> filter;
    filter->SetInputData(texture);
    look_straight(filter, 40, 40);
    const std::vector<double> wanted = numbers(texture->GetPointData()->GetScalars()),
                              found = drawn_numbers(filter);
    // Points are within 1/64 of the tolerance, 0.002 pixels; neighbours differ by up to 254 either way.
    for (std::size_t i = 0; i < wanted.size(); ++i) ASSERT_NEAR(found[i], wanted[i], 2) << i;
}

TEST(VtkDrape, ASphereHasTheSilhouetteTheDepthAndTheNormalsOfASphere) {
    constexpr int kSide = 100;
    constexpr double kPixel = 1.2 / kSide;
    vtkNew<Drape> filter;
    filter->SetInputData(picture(64, 64));
    filter->SetSurface(Drape::SPHERE);
    filter->SetAngle(360);
    filter->SetViewSize(kSide, kSide);
    filter->CameraParallelProjectionOn();
    filter->SetCameraParallelScale(0.6);
    filter->SetStyle(Drape::DEPTH);
    const std::vector<double> depth = drawn_numbers(filter);
    filter->SetStyle(Drape::NORMAL);
    const std::vector<double> normals = drawn_numbers(filter);
    ASSERT_EQ(depth.size(), std::size_t{kSide * kSide});
    ASSERT_EQ(normals.size(), 3 * depth.size());
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            SCOPED_TRACE(testing::Message() << x << " " << y);
            const auto i = static_cast<std::size_t>(y * kSide + x);
            const double px = (x + 0.5 - kSide / 2) * kPixel, py = (y + 0.5 - kSide / 2) * kPixel,
                         r = std::hypot(px, py);
            if (r > 0.5 + 0.125 * kPixel) {
                ASSERT_EQ(static_cast<float>(depth[i]), 1e30f);
            }
            if (r < 0.5 - 0.125 * kPixel) {
                ASSERT_LT(depth[i], 2);
            }
            // A sphere rises by r / pz per unit; a point is within 0.125 pixels along the screen.
            if (r > 0.4) continue;
            const double pz = std::sqrt(0.25 - r * r);
            ASSERT_NEAR(depth[i], 2 - pz, 2 * 0.125 * kPixel * (1 + r / pz));
            const double dot =
                (normals[3 * i] * px + normals[3 * i + 1] * py + normals[3 * i + 2] * pz) / 0.5;
            ASSERT_GT(dot, 0.99);  // within 8 degrees: normals of patches' corners, interpolated
        }
}

TEST(VtkDrape, TextureCoordinatesGoUpAndAreThoseOfThePlane) {
    vtkNew<Drape> filter;
    filter->SetInputData(picture(20, 10));  // 2 wide and 1 high
    filter->SetStyle(Drape::TEXTURE_COORDINATES);
    look_straight(filter, 40, 40);  // sees the middle half
    vtkDataArray* seen = drawn(filter);
    EXPECT_STREQ(seen->GetName(), "TextureCoordinates");
    const std::vector<double> found = numbers(seen);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x) {
            const auto i = static_cast<std::size_t>(2 * (y * 40 + x));
            ASSERT_NEAR(found[i], 0.25 + 0.5 * (x + 0.5) / 40, 1e-4);
            ASSERT_NEAR(found[i + 1], (y + 0.5) / 40, 1e-4);
        }
    filter->SetCameraParallelScale(1);
    EXPECT_EQ(drawn(filter)->GetComponent(0, 0), -1);
    EXPECT_EQ(drawn(filter)->GetComponent(0, 1), -1);
}

// ---- The core's operation, through the same numbers ----

/// A file as numbers whose rows go down, or as text.
struct File {
    anamorph::Size size{};
    int channels = 0;
    std::vector<float> values = {};
    std::string text = {};
};

/// Side files by key, under the key's name.
struct Files final : anamorph::SideFileReader {
    struct Image final : anamorph::SideImage {
        explicit Image(const File& of) : file(of) {}
        anamorph::Size size() const override { return file.size; }
        int channels() const override { return file.channels; }
        std::vector<float> read(int count) override {
            std::vector<float> some;
            for (std::size_t i = 0; i < file.values.size(); ++i)
                if (static_cast<int>(i) % file.channels < count) some.push_back(file.values[i]);
            return some;
        }
        const File& file;
    };
    std::string text(const std::string& name) const override { return all.at(name).text; }
    std::unique_ptr<anamorph::SideImage> image(const std::string&, const std::string& name) const override {
        return std::make_unique<Image>(all.at(name));
    }
    anamorph::SideFiles names() const {
        anamorph::SideFiles names;
        for (const auto& [key, file] : all) names[key] = {key, "", file.channels > 0};
        return names;
    }
    std::map<std::string, File> all;
};

/// What the operation draws of a texture of unsigned char, with rows that go down; `Value`: of its pixels.
template <class Value>
std::vector<Value> by_operation(vtkImageData* texture, const std::vector<anamorph::Assignment>& arguments,
                                const anamorph::Size& screen, int channels, const Files& files = {}) {
    int size[3];
    texture->GetDimensions(size);
    const int components = texture->GetNumberOfScalarComponents();
    const auto* from = static_cast<const unsigned char*>(texture->GetScalarPointer());
    std::vector<unsigned char> texels;
    for (int y = size[1] - 1; y >= 0; --y)
        texels.insert(texels.end(), from + y * size[0] * components, from + (y + 1) * size[0] * components);
    const anamorph::MemorySource memory(
        anamorph::packed_view(reinterpret_cast<const std::byte*>(texels.data()), anamorph::PixelType::uint8,
                              size[0], size[1], components),
        components == 4 ? 3 : -1);
    const anamorph::Pyramid pyramid(memory);
    const anamorph::Operation& drape = *anamorph::find_operation("drape");
    anamorph::ParameterValues values(*drape.parameters);
    values.assign(arguments);
    anamorph::SourceImage source;
    source.facts.width = size[0];
    source.facts.height = size[1];
    source.channels = components;
    source.alpha = components == 4 ? 3 : -1;
    std::vector<Value> pixels(static_cast<std::size_t>(screen.width * screen.height * channels));
    const auto type = sizeof(Value) == 1 ? anamorph::PixelType::uint8 : anamorph::PixelType::float32;
    EXPECT_TRUE(drape.read({values, {source}, files.names(), files})
                    ->picture(0, 0)
                    ->solve()
                    ->draw({&pyramid}, {0, 0, screen.width, screen.height},
                           anamorph::packed_view(reinterpret_cast<std::byte*>(pixels.data()), type,
                                                 screen.width, screen.height, channels),
                           anamorph::serial_for));
    return pixels;
}

/// The same rows from the last one up.
template <class Value>
std::vector<double> turned_over(const std::vector<Value>& pixels, std::size_t row) {
    std::vector<double> result;
    for (std::size_t end = pixels.size(); end > 0; end -= row)
        for (std::size_t i = end - row; i < end; ++i) result.push_back(static_cast<double>(pixels[i]));
    return result;
}

const anamorph::Size kScreen{90, 60};
const char* const kFilters[] = {"nearest", "bilinear",    "bicubic",      "antialias",
                                "pyramid", "summed_area", "sharp_bicubic"};
const char* const kStyles[] = {"color", "stmap", "depth", "normal"};

/// What is drawn of a surface.
struct Case {
    int surface;
    bool parallel;
    int filter, style, components;
};

void set(Drape* filter, const Case& c) {
    filter->SetSurface(c.surface);
    filter->SetAngle(222);
    filter->SetRadius(0.3);
    filter->SetTube(0.13);
    filter->SetAmplitude(0.07);
    filter->SetWavelength(0.4);
    filter->SetPhase(0.3);
    filter->SetDirection(33);
    filter->SetTurn(0.6);
    filter->SetViewSize(kScreen.width, kScreen.height);
    filter->SetCameraPosition(0.9, 0.7, 1.5);
    filter->SetCameraFocalPoint(0.1, 0, 0);
    filter->SetCameraViewUp(0.1, 1, 0);
    filter->SetCameraViewAngle(47);
    filter->SetCameraParallelProjection(c.parallel);
    filter->SetCameraParallelScale(0.7);
    filter->SetTolerance(0.25);
    filter->SetBackground(0.2, 0.4, 0.6, 0.5);
    filter->SetFilter(c.filter);
    filter->SetStyle(c.style);
}

/// The operation's views have a width, VTK's a height.
std::string fov_of(double view_angle, double aspect) {
    const double half = anamorph::surface::kPi / 360;
    return anamorph::shortest(std::atan(aspect * std::tan(view_angle * half)) / half);
}

std::vector<anamorph::Assignment> arguments_of(const Case& c) {
    const double aspect = 90.0 / 60.0;
    return {{"surface", anamorph::surface::surface_names()[static_cast<std::size_t>(c.surface)]},
            {"angle", "222"},
            {"radius", "0.3"},
            {"tube", "0.13"},
            {"amplitude", "0.07"},
            {"wavelength", "0.4"},
            {"phase", "0.3"},
            {"direction", "33"},
            {"turn", "0.6"},
            {"size", "90x60"},
            {"camera", "0.9,0.7,1.5"},
            {"target", "0.1,0,0"},
            {"up", "0.1,1,0"},
            {"view", c.parallel ? "parallel" : "perspective"},
            {"fov", fov_of(47, aspect)},
            {"extent", anamorph::shortest(2 * 0.7 * aspect)},
            {"tol", "0.25"},
            {"filter", kFilters[c.filter]},
            {"output", kStyles[c.style]},
            {"background", c.components == 4 ? "0.2,0.4,0.6,0.5" : "0.2,0.4,0.6"}};
}

/// What the operation draws, as VTK says it.
std::vector<double> wanted_of(const Case& c, vtkImageData* texture,
                              const std::vector<anamorph::Assignment>& arguments) {
    const int channels[] = {c.components, 2, 1, 3};
    const int count = channels[c.style];
    const auto row = static_cast<std::size_t>(kScreen.width * count);
    if (c.style == Drape::COLOR)
        return turned_over(by_operation<unsigned char>(texture, arguments, kScreen, count), row);
    std::vector<double> wanted = turned_over(by_operation<float>(texture, arguments, kScreen, count), row);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        if (c.style == Drape::DEPTH && std::isinf(wanted[k])) wanted[k] = 1e30f;
        if (c.style == Drape::TEXTURE_COORDINATES && k % 2 == 1 && wanted[k] >= 0)
            wanted[k] = 1 - static_cast<float>(wanted[k]);
    }
    return wanted;
}

TEST(VtkDrape, EverySurfaceHasThePixelsOfTheOperation) {
    ASSERT_EQ(anamorph::surface::all_surface_names().size(), std::size_t{Drape::NumberOfSurfaces});
    for (int surface = Drape::PLANE; surface <= Drape::RIPPLES; ++surface)
        for (const bool parallel : {false, true})
            for (int i = 0; i < 9; ++i) {
                SCOPED_TRACE(testing::Message() << surface << " " << parallel << " " << i);
                // Colors by each filter, then what else is drawn.
                const Case c{surface, parallel, i < 6 ? i : 3, i < 6 ? 0 : i - 5, i % 2 ? 4 : 3};
                const Picture texture = picture(80, 50, VTK_UNSIGNED_CHAR, c.components);
                vtkNew<Drape> filter;
                filter->SetInputData(texture);
                set(filter, c);
                ASSERT_EQ(drawn_numbers(filter), wanted_of(c, texture, arguments_of(c)));
            }
}

// ---- The paper's own schemes ----

const char* const kSchemes[] = {"auto", "exact", "oka", "oka-z", "hardware"};

/// What the filter draws by a scheme is the operation's picture.
void expect_scheme(const Case& c, int scheme, const std::string& machine = "") {
    SCOPED_TRACE(testing::Message() << kSchemes[scheme] << " surface " << c.surface << " style " << c.style
                                    << " filter " << c.filter << " " << machine);
    const Picture texture = picture(80, 50, VTK_UNSIGNED_CHAR, c.components);
    vtkNew<Drape> filter;
    Errors errors(filter);
    filter->SetInputData(texture);
    set(filter, c);
    std::vector<anamorph::Assignment> arguments = arguments_of(c);
    if (scheme == Drape::HARDWARE) {
        filter->SetBackground(0, 0, 0, 0);
        arguments.pop_back();
    }
    filter->SetScheme(scheme);
    filter->SetBlock(5.5);
    filter->SetOverlap(0.75);
    arguments.push_back({"scheme", kSchemes[scheme]});
    if (scheme == Drape::OKA || scheme == Drape::OKA_Z)
        arguments.insert(arguments.end(), {{"block", "5.5"}, {"overlap", "0.75"}});
    if (!machine.empty()) {
        filter->SetMachine(machine.c_str());
        arguments.push_back({"machine", machine});
    }
    const std::vector<double> seen = drawn_numbers(filter);
    ASSERT_EQ(errors.text(), "");
    ASSERT_EQ(seen, wanted_of(c, texture, arguments));
}

TEST(VtkDrape, EverySchemeHasThePixelsOfTheOperation) {
    for (const int scheme : {Drape::AUTO, Drape::EXACT, Drape::OKA, Drape::OKA_Z, Drape::HARDWARE})
        for (const int surface : {Drape::CYLINDER, Drape::PAGE_TURN, Drape::RIPPLES})
            for (const bool parallel : {false, true}) {
                const bool by_machine = scheme == Drape::HARDWARE;
                for (const int filter : {Drape::NEAREST, Drape::BILINEAR, Drape::ANTIALIAS})
                    expect_scheme({surface, parallel, filter, Drape::COLOR, filter ? 4 : 3}, scheme);
                for (int style = Drape::TEXTURE_COORDINATES;
                     style <= (by_machine ? Drape::TEXTURE_COORDINATES : Drape::NORMAL); ++style)
                    expect_scheme({surface, parallel, Drape::ANTIALIAS, style, 3}, scheme);
            }
}

TEST(VtkDrape, AMachineHasThePixelsOfTheOperation) {
    for (const char* machine : {"oka-1987", "oka-1987:block=4,fraction_bits=2,overlap=0",
                                R"({"block": 16, "weight_bits": 3, "texel_bits": 5})"})
        for (const int style : {Drape::COLOR, Drape::TEXTURE_COORDINATES})
            expect_scheme({Drape::WAVES, false, Drape::BILINEAR, style, 4}, Drape::HARDWARE, machine);
}

TEST(VtkDrape, SchemesOfThePaperAreOfSeveralPictures) {
    vtkNew<Drape> filter;
    filter->SetInputData(picture(40, 32));
    filter->SetSurface(Drape::RIPPLES);
    filter->SetViewSize(64, 64);
    filter->SetCameraPosition(0.5, 0.6, 1.7);
    std::vector<std::vector<double>> seen;
    for (int scheme = Drape::AUTO; scheme <= Drape::HARDWARE; ++scheme) {
        filter->SetScheme(scheme);
        seen.push_back(drawn_numbers(filter));
        EXPECT_GT(filter->GetMaxError(), 0) << scheme;
        // Only blocks of 8 pixels are off by more than was asked for.
        EXPECT_EQ(filter->GetMaxError() > filter->GetTolerance(), scheme >= Drape::OKA) << scheme;
        for (std::size_t i = 0; i + 1 < seen.size(); ++i) EXPECT_NE(seen[i], seen.back()) << scheme << i;
    }
    // Finer blocks and addresses are nearer.
    const double coarse = filter->GetMaxError();
    filter->SetMachine("oka-1987:block=2,fraction_bits=16");
    filter->Update();
    EXPECT_LT(filter->GetMaxError(), coarse / 2);
}

TEST(VtkDrape, WhatTheMachineSaysIsInFields) {
    const Picture texture = picture(40, 32);
    vtkNew<Drape> filter;
    filter->SetInputData(texture);
    filter->SetSurface(Drape::WAVES);
    filter->SetViewSize(64, 64);
    filter->SetScheme(Drape::HARDWARE);
    filter->SetMachine("oka-1987:fraction_bits=2,overlap=0");
    filter->Update();
    const anamorph::Operation& drape = *anamorph::find_operation("drape");
    anamorph::ParameterValues values(*drape.parameters);
    values.assign({{"surface", "waves"},
                   {"scheme", "hardware"},
                   {"machine", "oka-1987:fraction_bits=2,overlap=0"},
                   {"size", "64x64"},
                   {"camera", "0,0,2"},
                   {"fov", fov_of(30, 1)}});
    anamorph::SourceImage source;
    source.facts.width = 40;
    source.facts.height = 32;
    source.channels = 3;
    const Files files;
    const anamorph::Attributes wanted = drape.read({values, {source}, files.names(), files})
                                            ->picture(0, 0)
                                            ->solve()
                                            ->reached(anamorph::serial_for);
    EXPECT_GE(wanted.size(), 8u);
    vtkFieldData* fields = filter->GetOutput()->GetFieldData();
    for (const anamorph::Attribute& attribute : wanted) {
        if (attribute.name == "anamorph:max_error") {
            EXPECT_EQ(std::get<double>(attribute.value), filter->GetMaxError());
            continue;
        }
        vtkAbstractArray* array = fields->GetAbstractArray(attribute.name.c_str());
        ASSERT_TRUE(array) << attribute.name;
        ASSERT_EQ(array->GetNumberOfTuples(), 1);
        const vtkVariant value = array->GetVariantValue(0);
        if (const auto* text = std::get_if<std::string>(&attribute.value))
            EXPECT_EQ(value.ToString(), *text);
        else if (const auto* number = std::get_if<double>(&attribute.value))
            EXPECT_EQ(value.ToDouble(), *number) << attribute.name;
        else
            EXPECT_EQ(value.ToInt(), std::get<int>(attribute.value)) << attribute.name;
    }
    filter->SetScheme(Drape::OKA);
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetFieldData()->GetNumberOfArrays(), 0);
}

TEST(VtkDrape, WhatASchemeCannotMeanIsAnErrorThatNamesTheProperty) {
    const auto error = [](int scheme, const std::function<void(Drape*)>& set) {
        return errors_of<Drape>(picture(8, 8), [&](Drape* f) {
            f->SetScheme(scheme);
            set(f);
        });
    };
    for (int scheme = Drape::AUTO; scheme <= Drape::HARDWARE; ++scheme) {
        EXPECT_EQ(error(scheme, [](Drape*) {}), "");
        for (const double value : {kNan, kInf, -kInf, -1.0, 0.24, 4097.0, 2147483648.0}) {
            EXPECT_THAT(error(scheme, [=](Drape* f) { f->SetBlock(value); }), HasSubstr("Block="));
            if (value == 0.24) continue;
            EXPECT_THAT(error(scheme, [=](Drape* f) { f->SetOverlap(value); }), HasSubstr("Overlap="));
        }
        for (const char* machine : {"oka-1988", "oka-1987:block=0", "oka-1987:block=nan", "{\"block\": 4",
                                    "oka-1987:no_such_key=1", "ps20"})
            EXPECT_THAT(error(scheme, [=](Drape* f) { f->SetMachine(machine); }), HasSubstr("Machine"))
                << machine;
    }
    EXPECT_THAT(error(Drape::HARDWARE, [](Drape* f) { f->SetStyle(Drape::DEPTH); }),
                HasSubstr("Style=depth: must be color or texture coordinates with Scheme=hardware"));
    EXPECT_THAT(error(Drape::HARDWARE, [](Drape* f) { f->SetStyle(Drape::COVERAGE); }),
                HasSubstr("Style=coverage: must be"));
    EXPECT_THAT(error(Drape::HARDWARE, [](Drape* f) { f->SetStyle(Drape::NORMAL); }),
                HasSubstr("Style=normal: must be"));
    EXPECT_THAT(error(Drape::HARDWARE, [](Drape* f) { f->SetBackground(0, 0.5, 0, 1); }),
                HasSubstr("Background=0,0.5,0,1: must be 0,0,0,0 with Scheme=hardware"));
    for (const auto& [filter, word] : {std::pair{Drape::BICUBIC, "bicubic"},
                                       {Drape::SHARP_BICUBIC, "sharp_bicubic"},
                                       {Drape::PYRAMID, "pyramid"},
                                       {Drape::SUMMED_AREA, "summed_area"}}) {
        const int chosen = filter;
        EXPECT_THAT(error(Drape::HARDWARE, [=](Drape* f) { f->SetFilter(chosen); }),
                    HasSubstr(std::string("Filter=") + word + ": must be antialias, bilinear or nearest"));
    }
}

TEST(VtkDrape, PartsAndThreadsGiveTheBitsOfTheWholeByTheMachineToo) {
    vtkNew<Drape> filter;
    filter->SetInputData(picture(30, 20));
    filter->SetSurface(Drape::PAGE_TURN);
    filter->SetScheme(Drape::HARDWARE);
    filter->SetViewSize(70, 50);
    const std::vector<double> whole = drawn_numbers(filter);
    for_any_threads([&] {
        filter->Modified();
        ASSERT_EQ(drawn_numbers(filter), whole);
    });
    const int extent[6] = {11, 53, 20, 31, 0, 0};
    filter->Modified();
    filter->UpdateExtent(extent);
    vtkImageData* part = filter->GetOutput();
    ASSERT_EQ(part->GetNumberOfPoints(), 43 * 12);
    for (int y = 20; y <= 31; ++y)
        for (int x = 11; x <= 53; ++x)
            for (int c = 0; c < 3; ++c)
                ASSERT_EQ(part->GetScalarComponentAsDouble(x, y, 0, c),
                          whole[static_cast<std::size_t>(3 * (y * 70 + x) + c)]);
}

// ---- Light, sampled surfaces, reliefs, blends, deformations ----

/// What is set of a filter, and the same as the operation's arguments and files.
struct Scene {
    std::function<void(Drape*)> set;
    std::vector<anamorph::Assignment> arguments;
    Files files = {};
};

/// The filter's pixels are the operation's, from a camera of VTK's view angle on a square.
void expect_pixels_of_operation(const Scene& scene) {
    const Picture texture = picture(40, 32, VTK_UNSIGNED_CHAR, 3);
    vtkNew<Drape> filter;
    Errors errors(filter);
    filter->SetInputData(texture);
    filter->SetViewSize(64, 64);
    filter->SetCameraPosition(0.5, 0.6, 1.7);
    scene.set(filter);
    const std::vector<double> seen = drawn_numbers(filter);
    ASSERT_EQ(errors.text(), "");
    std::vector<anamorph::Assignment> arguments = scene.arguments;
    arguments.insert(arguments.end(), {{"size", "64x64"}, {"camera", "0.5,0.6,1.7"}, {"fov", fov_of(30, 1)}});
    const std::vector<double> wanted = turned_over(
        by_operation<unsigned char>(texture, arguments, {64, 64}, 3, scene.files), std::size_t{64 * 3});
    ASSERT_EQ(seen, wanted);
    EXPECT_GT(std::count_if(seen.begin(), seen.end(), [](double v) { return v > 0; }), 1000);
}

/// The texels of an image whose rows go up, as numbers of a file; whole ones as fractions of 255.
File file_of(vtkImageData* image) {
    int size[3];
    image->GetDimensions(size);
    vtkDataArray* array = image->GetPointData()->GetScalars();
    File file{{size[0], size[1]}, array->GetNumberOfComponents(), {}, {}};
    for (int y = size[1] - 1; y >= 0; --y)
        for (int x = 0; x < size[0]; ++x)
            for (int c = 0; c < file.channels; ++c) {
                const auto value = static_cast<float>(array->GetComponent(y * size[0] + x, c));
                file.values.push_back(array->GetDataType() == VTK_UNSIGNED_CHAR ? value / 255.0f : value);
            }
    return file;
}

/// A saddle over the whole of the texture as an image of positions.
Picture saddle(int width, int height, int type = VTK_FLOAT) {
    auto image = Picture::New();
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(type, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) / width - 0.5, v = (y + 0.5) / height - 0.5,
                         p[3] = {1.1 * u, 0.9 * v, 0.4 * (u * u - v * v)};
            for (int c = 0; c < 3; ++c) image->SetScalarComponentFromDouble(x, y, 0, c, p[c]);
        }
    return image;
}

/// The same as points, in the plane of the first two indices or the last two.
vtkSmartPointer<vtkStructuredGrid> grid_of(vtkImageData* positions, bool last = false) {
    int size[3];
    positions->GetDimensions(size);
    auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
    last ? grid->SetDimensions(1, size[0], size[1]) : grid->SetDimensions(size[0], size[1], 1);
    vtkNew<vtkPoints> points;
    vtkDataArray* array = positions->GetPointData()->GetScalars();
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) points->InsertNextPoint(array->GetTuple3(i));
    grid->SetPoints(points);
    return grid;
}

/// Deformations as columns of a table, and the same as a file.
const char* const kBumps =
    "center_u,center_v,extent_u,extent_v,x,y,z\n0.4,0.6,0.2,0.3,0.05,0,0.2\n0.7,0.3,0.1,0.1,0,0,-0.15\n";

vtkSmartPointer<vtkTable> table_of_bumps() {
    const double bumps[2][7] = {{0.4, 0.6, 0.2, 0.3, 0.05, 0, 0.2}, {0.7, 0.3, 0.1, 0.1, 0, 0, -0.15}};
    const char* const names[] = {"center_u", "center_v", "extent_u", "extent_v", "x", "y", "z"};
    auto table = vtkSmartPointer<vtkTable>::New();
    for (int c = 0; c < 7; ++c) {
        vtkNew<vtkDoubleArray> column;
        column->SetName(names[c]);
        for (const auto& bump : bumps) column->InsertNextValue(bump[c]);
        table->AddColumn(column);
    }
    return table;
}

File bumps_as_file() {
    return {{},
            0,
            {},
            R"({"deformations": [{"vector": [0.05, 0, 0.2], "center": [0.4, 0.6], "extent": [0.2, 0.3]},
                                 {"vector": [0, 0, -0.15], "center": [0.7, 0.3], "extent": [0.1, 0.1]}]})"};
}

TEST(VtkDrape, ShadingHasThePixelsOfTheOperation) {
    for (const auto& [shading, word] : {std::pair{Drape::GOURAUD, "gouraud"}, {Drape::PHONG, "phong"}})
        for (const int surface : {Drape::SPHERE, Drape::PAGE_TURN, Drape::RIPPLES}) {
            SCOPED_TRACE(testing::Message() << word << " " << surface);
            const int chosen = shading;
            expect_pixels_of_operation(
                {[=](Drape* f) {
                     f->SetSurface(surface);
                     f->SetShading(chosen);
                     f->SetNumberOfLights(2);
                     f->SetLight(0, 1, 2, 3);
                     f->SetLight(1, -3e5, 0, 1e5);
                     f->SetAmbient(0.1);
                     f->SetDiffuse(0.5);
                     f->SetSpecular(0.4);
                     f->SetShininess(9);
                 },
                 {{"surface", anamorph::surface::surface_names()[std::size_t(surface)]},
                  {"shading", word},
                  {"light", "1,2,3,-3e5,0,1e5"},
                  {"ambient", "0.1"},
                  {"diffuse", "0.5"},
                  {"specular", "0.4"},
                  {"shininess", "9"}}});
        }
}

TEST(VtkDrape, TheMachineShadesAsInTheOperation) {
    for (const auto& [shading, word] : {std::pair{Drape::GOURAUD, "gouraud"}, {Drape::PHONG, "phong"}}) {
        const int chosen = shading;
        expect_pixels_of_operation({[=](Drape* f) {
                                        f->SetSurface(Drape::SPHERE);
                                        f->SetShading(chosen);
                                        f->SetScheme(Drape::HARDWARE);
                                        f->SetLight(0, 1, 2, 3);
                                        f->SetSpecular(0.4);
                                    },
                                    {{"surface", "sphere"},
                                     {"shading", word},
                                     {"scheme", "hardware"},
                                     {"light", "1,2,3"},
                                     {"specular", "0.4"}}});
    }
}

TEST(VtkDrape, ASampledSurfaceHasThePixelsOfTheOperation) {
    for (const int type : {VTK_FLOAT, VTK_DOUBLE})
        for (int as = 0; as < 3; ++as) {
            SCOPED_TRACE(testing::Message() << type << " " << as);
            const Picture positions = saddle(9, 7, type);
            vtkSmartPointer<vtkDataObject> input = positions;
            if (as > 0) input = grid_of(positions, as == 2);
            Scene scene{[&](Drape* f) {
                            f->SetInputData(1, input);
                            f->SetSurface(Drape::POSITIONS);
                        },
                        {{"surface", "positions"}, {"positions", "positions"}}};
            scene.files.all["positions"] = file_of(positions);
            expect_pixels_of_operation(scene);
        }
}

TEST(VtkDrape, ArraysOfInputsAreChosenByName) {
    const Picture positions = saddle(9, 7), named = saddle(9, 7);
    const vtkSmartPointer<vtkDataArray> array = named->GetPointData()->GetScalars();
    array->SetName("Place");
    named->GetPointData()->SetScalars(picture(9, 7)->GetPointData()->GetScalars());
    named->GetPointData()->AddArray(array);
    Scene scene{[&](Drape* f) {
                    f->SetInputData(1, named);
                    f->SetSurface(Drape::POSITIONS);
                    f->SetPositionsArrayName("Place");
                },
                {{"surface", "positions"}, {"positions", "positions"}}};
    scene.files.all["positions"] = file_of(positions);
    expect_pixels_of_operation(scene);
    EXPECT_THAT(errors_of<Drape>(picture(4, 4),
                                 [&](Drape* f) {
                                     f->SetInputData(2, named);
                                     f->SetHeightArrayName("None");
                                 }),
                HasSubstr("the input Height has no point array"));
}

TEST(VtkDrape, AnInputThatNoSurfaceNamesIsNotLookedAt) {
    expect_pixels_of_operation({[&](Drape* f) { f->SetInputData(1, vtkNew<vtkStructuredGrid>()); }, {}});
}

TEST(VtkDrape, ReliefsHaveThePixelsOfTheOperation) {
    for (const int type : {VTK_UNSIGNED_CHAR, VTK_FLOAT})
        for (const int components : {1, 2, 4}) {
            SCOPED_TRACE(testing::Message() << type << " " << components);
            const Picture heights = picture(17, 13, type, components);
            Scene scene{[&](Drape* f) {
                            f->SetInputData(2, heights);
                            f->SetSurface(Drape::CYLINDER);
                            f->SetHeightScale(0.2);
                            f->SetHeightSmooth(1.5);
                        },
                        {{"surface", "cylinder"},
                         {"height", "height"},
                         {"height_scale", "0.2"},
                         {"height_smooth", "1.5"}}};
            scene.files.all["height"] = file_of(heights);
            expect_pixels_of_operation(scene);
        }
}

TEST(VtkDrape, DeformationsOfATableOrAFileHaveThePixelsOfTheOperation) {
    const Folder folder;
    const std::string name = folder.write("bumps.csv", kBumps);
    for (const bool by_table : {true, false}) {
        SCOPED_TRACE(by_table);
        Scene scene{[&](Drape* f) {
                        if (by_table)
                            f->SetInputData(3, table_of_bumps());
                        else
                            f->SetDeformationFileName(name.c_str());
                    },
                    {{"deform", "deform"}}};
        scene.files.all["deform"] = bumps_as_file();
        expect_pixels_of_operation(scene);
    }
}

TEST(VtkDrape, BlendsHaveThePixelsOfTheOperation) {
    const Picture positions = saddle(9, 7), heights = picture(17, 13);
    Scene sampled{[&](Drape* f) {
                      f->SetSurface(Drape::SPHERE);
                      f->SetBlendWeight(Drape::POSITIONS, 0.7);
                      f->SetBlendWeight(Drape::PAGE_TURN, -0.2);
                      f->SetBlendWeight(Drape::SPHERE, 5);  // it counts for nothing
                      f->SetInputData(1, positions);
                      f->SetInputData(3, table_of_bumps());
                      f->SetShading(Drape::PHONG);
                  },
                  {{"surface", "sphere"},
                   {"blend", "page_turn,positions"},
                   {"weights", "-0.2,0.7"},
                   {"positions", "positions"},
                   {"deform", "deform"},
                   {"shading", "phong"}}};
    sampled.files.all = {{"positions", file_of(positions)}, {"deform", bumps_as_file()}};
    expect_pixels_of_operation(sampled);
    Scene relief{[&](Drape* f) {
                     f->SetBlendWeight(Drape::TORUS, 0.3);
                     f->SetBlendWeight(Drape::WAVES, 0.5);
                     f->SetInputData(2, heights);
                     f->SetInputData(3, table_of_bumps());
                     f->SetShading(Drape::GOURAUD);
                 },
                 {{"blend", "torus,waves"},
                  {"weights", "0.3,0.5"},
                  {"height", "height"},
                  {"deform", "deform"},
                  {"shading", "gouraud"}}};
    relief.files.all = {{"height", file_of(heights)}, {"deform", bumps_as_file()}};
    expect_pixels_of_operation(relief);
}

TEST(VtkDrape, FormulasHaveThePixelsOfTheOperation) {
    Scene moebius{[](Drape* f) {
                      f->SetSurface(Drape::FORMULA);
                      f->SetFormulaX("cos(c)*(1+w*cos(c/2))/2");
                      f->SetFormulaY("sin(c)*(1+w*cos(c/2))/2");
                      f->SetFormulaZ("w*sin(c/2)/2");
                      f->SetFormulaDefinitions("w=(v-.5)*.6;c=2*pi*u+frame");
                      f->SetFrame(2);
                      f->SetInputData(3, table_of_bumps());
                      f->SetShading(Drape::PHONG);
                  },
                  {{"surface", "formula"},
                   {"px", "cos(c)*(1+w*cos(c/2))/2"},
                   {"py", "sin(c)*(1+w*cos(c/2))/2"},
                   {"pz", "w*sin(c/2)/2"},
                   {"let", "w=(v-.5)*.6;c=2*pi*u+frame"},
                   {"frame", "2"},
                   {"deform", "deform"},
                   {"shading", "phong"}}};
    moebius.files.all = {{"deform", bumps_as_file()}};
    expect_pixels_of_operation(moebius);
    const Scene half_a_roof{[](Drape* f) {
                                f->SetBlendWeight(Drape::FORMULA, 0.5);
                                f->SetFormulaZ("-abs(u-.3)");
                            },
                            {{"blend", "formula"}, {"weights", "0.5"}, {"pz", "-abs(u-.3)"}}};
    expect_pixels_of_operation(half_a_roof);
}

TEST(VtkDrape, ANewPictureOrListOfAnInputIsSeen) {
    const Folder folder;
    const Picture heights = picture(17, 13, VTK_FLOAT, 1);
    vtkNew<Drape> filter;
    filter->SetInputData(picture(30, 20));
    filter->SetInputData(2, heights);
    filter->SetDeformationFileName(folder.write("bumps.csv", kBumps).c_str());
    filter->SetCameraPosition(1, 0, 2);
    std::vector<std::vector<double>> seen = {drawn_numbers(filter)};
    heights->GetPointData()->GetScalars()->SetComponent(100, 0, 5);
    heights->GetPointData()->GetScalars()->Modified();
    seen.push_back(drawn_numbers(filter));
    filter->SetHeightSmooth(3);
    seen.push_back(drawn_numbers(filter));
    folder.write("bumps.csv", "0.5,0.5,0.2,0.2,0,0,0.3\n");
    filter->Modified();
    seen.push_back(drawn_numbers(filter));
    for (std::size_t i = 1; i < seen.size(); ++i) EXPECT_NE(seen[i], seen[i - 1]) << i;
}

TEST(VtkDrape, HiddenPointsAndSuchThatAreNoNumbersAreHolesThatAreNamed) {
    const Picture positions = saddle(30, 30);
    const vtkSmartPointer<vtkStructuredGrid> grid = grid_of(positions);
    vtkNew<Drape> filter;
    Errors errors(filter);
    filter->SetInputData(picture(30, 30));
    filter->SetSurface(Drape::POSITIONS);
    filter->SetInputData(1, grid);
    filter->SetViewSize(100, 100);
    filter->SetStyle(Drape::DEPTH);
    const auto holes = [&] {
        const std::vector<double> seen = drawn_numbers(filter);
        return std::count_if(seen.begin(), seen.end(), [](double depth) { return depth > 1e29; });
    };
    const auto whole = holes();
    EXPECT_FALSE(filter->GetOutput()->GetFieldData()->GetAbstractArray("anamorph:missing"));
    const auto expect_hole = [&](const char* missing) {
        // Cubics that the texel is part of: 4 x 4 cells of a thirtieth of the surface.
        const auto more = holes() - whole;
        EXPECT_GT(more, 30);
        EXPECT_LT(more, 400);
        auto* array = vtkStringArray::SafeDownCast(
            filter->GetOutput()->GetFieldData()->GetAbstractArray("anamorph:missing"));
        ASSERT_TRUE(array);
        EXPECT_EQ(array->GetValue(0), missing);
    };
    grid->BlankPoint(12 * 30 + 17);
    grid->Modified();
    expect_hole("1 texels of positions, the first at 17,17");
    positions->SetScalarComponentFromDouble(5, 20, 0, 1, kNan);
    positions->Modified();
    filter->SetInputData(1, positions);
    expect_hole("1 texels of positions, the first at 5,9");
    EXPECT_EQ(errors.text(), "");
}

// ---- What every filter holds ----

TEST(VtkDrape, WhatCannotBeDoneIsAnErrorThatNamesTheProperty) {
    const auto error = [](const std::function<void(Drape*)>& set) {
        return errors_of<Drape>(picture(8, 8), set);
    };
    EXPECT_EQ(error([](Drape*) {}), "");
    EXPECT_THAT(errors_of<Drape>(nullptr), HasSubstr("the texture is not given"));
    const std::pair<const char*, void (Drape::*)(double)> numbers_of[] = {
        {"Angle", &Drape::SetAngle},
        {"Radius", &Drape::SetRadius},
        {"Tube", &Drape::SetTube},
        {"Amplitude", &Drape::SetAmplitude},
        {"Wavelength", &Drape::SetWavelength},
        {"Phase", &Drape::SetPhase},
        {"Direction", &Drape::SetDirection},
        {"Turn", &Drape::SetTurn},
        {"Tolerance", &Drape::SetTolerance},
        {"CameraParallelScale", &Drape::SetCameraParallelScale},
        {"CameraViewAngle", &Drape::SetCameraViewAngle}};
    for (const auto& [name, set] : numbers_of) {
        for (const double value : {kNan, kInf, 1e12, -1e12}) {
            if (set == &Drape::SetRadius && !std::isnan(value)) continue;  // clamped
            EXPECT_THAT(error([value, set = set](Drape* f) { (f->*set)(value); }),
                        HasSubstr(std::string(name) + "="))
                << value;
        }
    }
    EXPECT_THAT(error([](Drape* f) { f->SetRadius(1e-6); }), HasSubstr("Radius=1e-06: must be"));
    EXPECT_THAT(error([](Drape* f) { f->SetBackground(0, kNan, 0, 0); }), HasSubstr("Background=nan"));
    EXPECT_THAT(error([](Drape* f) { f->SetCameraPosition(0, kNan, 2); }), HasSubstr("CameraPosition=nan"));
    EXPECT_THAT(error([](Drape* f) { f->SetCameraPosition(0, 0, 0); }),
                HasSubstr("CameraPosition=0,0,0: must be away"));
    EXPECT_THAT(error([](Drape* f) { f->SetCameraFocalPoint(1e12, 0, 0); }), HasSubstr("CameraFocalPoint="));
    EXPECT_THAT(error([](Drape* f) { f->SetCameraViewUp(0, 0, 0); }), HasSubstr("CameraViewUp=0,0,0"));
    EXPECT_THAT(error([](Drape* f) { f->SetCameraViewUp(0, 0, 1); }), HasSubstr("CameraViewUp=0,0,1"));
    EXPECT_THAT(error([](Drape* f) { f->SetViewSize(0, 10); }), HasSubstr("ViewSize=0"));
    EXPECT_THAT(error([](Drape* f) { f->SetViewSize(10, 100000); }), HasSubstr("ViewSize=100000"));
    EXPECT_THAT(error([](Drape* f) { f->SetShininess(-1); }), HasSubstr("Shininess=-1: must be"));
    EXPECT_THAT(error([](Drape* f) { f->SetLight(0, 0, kNan, 1); }), HasSubstr("Light="));
    EXPECT_THAT(error([](Drape* f) { f->SetLight(0, 0, 0, 0); }), HasSubstr("Light=0,0,0: must be"));
    EXPECT_THAT(error([](Drape* f) { f->SetBlendWeight(Drape::SPHERE, kNan); }), HasSubstr("BlendWeights="));
    EXPECT_THAT(error([](Drape* f) { f->SetBlendWeight(Drape::SPHERE, 1e7); }),
                HasSubstr("BlendWeights=1e+07"));
    // Too fine for the grid of a picture as wide as this.
    EXPECT_THAT(error([](Drape* f) {
                    f->SetViewSize(65536, 1);
                    f->SetTolerance(0.001);
                }),
                HasSubstr("Tolerance=0.001: must be at least"));
}

TEST(VtkDrape, ATextureThatCannotBeReadIsAnError) {
    EXPECT_THAT(errors_of<Drape>(vtkNew<vtkImageData>()), HasSubstr("the texture has no pixels"));
    EXPECT_THAT(errors_of<Drape>(picture(4, 4, VTK_DOUBLE)), HasSubstr("of type double"));
    EXPECT_THAT(errors_of<Drape>(picture(4, 4, VTK_FLOAT, 5)), HasSubstr("5 components"));
    vtkNew<vtkImageData> volume;
    volume->SetDimensions(3, 3, 3);
    volume->AllocateScalars(VTK_FLOAT, 1);
    EXPECT_THAT(errors_of<Drape>(volume), HasSubstr("3 slices"));
    vtkNew<vtkImageData> bare;
    bare->SetDimensions(3, 3, 1);
    EXPECT_THAT(errors_of<Drape>(bare), HasSubstr("no point array"));
    const Picture short_one = picture(4, 4);
    short_one->GetPointData()->GetScalars()->SetNumberOfTuples(3);
    EXPECT_THAT(errors_of<Drape>(short_one), HasSubstr("no point array"));
}

TEST(VtkDrape, WhatIsNotInAListIsAnErrorAndChangesNothing) {
    vtkNew<Drape> filter;
    Errors errors(filter);
    const vtkMTimeType before = filter->GetMTime();
    const std::pair<std::function<void()>, const char*> calls[] = {
        {[&] { filter->SetLight(1, 0, 0, 1); }, "light 1 is not in the list, which has 1"},
        {[&] { EXPECT_FALSE(filter->GetLight(-1)); }, "light -1 is not"},
        {[&] { filter->SetNumberOfLights(-1); }, "NumberOfLights=-1: must be"},
        {[&] { filter->SetNumberOfLights(1 << 30); }, "must be an integer from 0 to"},
        {[&] { filter->SetBlendWeight(-1, 1); }, "surface=-1: must be"},
        {[&] { filter->SetBlendWeight(9, 1); }, "surface=9: must be an integer from 0 to 8"}};
    for (const auto& [call, text] : calls) {
        errors.clear();
        call();
        EXPECT_THAT(errors.text(), HasSubstr(text));
    }
    EXPECT_EQ(filter->GetMTime(), before);
}

TEST(VtkDrape, WhatOtherInputsLackIsAnError) {
    const auto error = [](const std::function<void(Drape*)>& set) {
        return errors_of<Drape>(picture(8, 8), set);
    };
    EXPECT_THAT(error([](Drape* f) { f->SetSurface(Drape::POSITIONS); }),
                HasSubstr("Positions is not given"));
    EXPECT_THAT(error([](Drape* f) {
                    f->SetSurface(Drape::FORMULA);
                    f->SetFormulaZ("2*w");
                }),
                HasSubstr("FormulaZ=2*w: column 3: expected a name that is known"));
    EXPECT_THAT(error([](Drape* f) { f->SetBlendWeight(Drape::POSITIONS, 0.5); }),
                HasSubstr("Positions is not given"));
    const auto positions = [&](vtkDataObject* data) {
        return error([data](Drape* f) {
            f->SetSurface(Drape::POSITIONS);
            f->SetInputData(1, data);
        });
    };
    EXPECT_THAT(positions(vtkNew<vtkStructuredGrid>()), HasSubstr("the input Positions has no points"));
    EXPECT_THAT(positions(vtkNew<vtkImageData>()), HasSubstr("the input Positions has no points"));
    EXPECT_THAT(positions(vtkNew<vtkTable>()), HasSubstr("vtkTable"));
    EXPECT_THAT(positions(picture(4, 4, VTK_UNSIGNED_CHAR, 3)), HasSubstr("of type unsigned char"));
    EXPECT_THAT(positions(picture(4, 4, VTK_FLOAT, 2)), HasSubstr("has 2 channels: must have 3"));
    vtkNew<vtkImageData> volume;
    volume->SetDimensions(3, 3, 3);
    volume->AllocateScalars(VTK_FLOAT, 3);
    EXPECT_THAT(positions(volume), HasSubstr("several layers"));
    const auto height = [&](vtkDataObject* data, int surface) {
        return error([=](Drape* f) {
            f->SetSurface(surface);
            f->SetInputData(2, data);
        });
    };
    EXPECT_EQ(height(picture(4, 4), Drape::PLANE), "");
    EXPECT_THAT(height(picture(4, 4), Drape::PAGE_TURN), HasSubstr("surface must not be page_turn"));
    EXPECT_THAT(height(vtkNew<vtkImageData>(), Drape::PLANE), HasSubstr("the input Height has no points"));
    vtkNew<vtkImageData> bare;
    bare->SetDimensions(3, 3, 1);
    EXPECT_THAT(height(bare, Drape::PLANE), HasSubstr("the input Height has no point array"));
    EXPECT_THAT(error([](Drape* f) { f->SetDeformationFileName("/no/such.json"); }),
                HasSubstr("/no/such.json: cannot be read"));
    const vtkSmartPointer<vtkTable> table = table_of_bumps();
    table->GetColumn(2)->SetVariantValue(1, 0);
    EXPECT_THAT(error([&](Drape* f) { f->SetInputData(3, table); }), HasSubstr("deformation 1: extent=0"));
    table->RemoveColumnByName("z");
    EXPECT_THAT(error([&](Drape* f) { f->SetInputData(3, table); }), HasSubstr("no column z"));
    EXPECT_EQ(error([&](Drape* f) { f->SetInputData(3, vtkNew<vtkTable>()); }), "");
}

TEST(VtkDrape, NumbersThatAreNoneStayInTheirTexels) {
    const Picture texture = picture(16, 16, VTK_FLOAT, 1);
    texture->GetPointData()->GetScalars()->SetComponent(5 * 16 + 3, 0, kNan);
    vtkNew<Drape> filter;
    Errors errors(filter);
    filter->SetInputData(texture);
    filter->SetFilter(Drape::BILINEAR);
    look_straight(filter, 16, 16);
    const std::vector<double> seen = drawn_numbers(filter);
    EXPECT_EQ(errors.text(), "");
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            if (std::abs(x - 3) > 1 || std::abs(y - 5) > 1) {
                ASSERT_TRUE(std::isfinite(seen[static_cast<std::size_t>(16 * y + x)])) << x << " " << y;
            }
}

TEST(VtkDrape, OtherArraysAndLayoutsAreRead) {
    const Picture texture = picture(12, 9, VTK_UNSIGNED_CHAR, 3);
    vtkNew<Drape> filter;
    filter->SetInputData(texture);
    filter->SetSurface(Drape::WAVES);
    filter->SetViewSize(50, 40);
    const std::vector<double> wanted = drawn_numbers(filter);
    vtkDataArray* from = texture->GetPointData()->GetScalars();
    vtkNew<vtkSOADataArrayTemplate<unsigned char>> planes;
    planes->SetName("Planes");
    planes->SetNumberOfComponents(3);
    planes->SetNumberOfTuples(from->GetNumberOfTuples());
    for (vtkIdType i = 0; i < from->GetNumberOfTuples(); ++i)
        for (int c = 0; c < 3; ++c) planes->SetComponent(i, c, from->GetComponent(i, c));
    texture->GetPointData()->SetScalars(nullptr);
    texture->GetPointData()->AddArray(planes);
    filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Planes");
    filter->Modified();
    EXPECT_EQ(drawn_numbers(filter), wanted);
}

TEST(VtkDrape, PartsOfTheImageAreThoseOfTheWhole) {
    vtkNew<Drape> filter;
    Errors errors(filter);
    filter->SetInputData(picture(30, 20));
    filter->SetSurface(Drape::PAGE_TURN);
    filter->SetViewSize(70, 50);
    vtkNew<vtkImageData> whole;
    drawn(filter);
    whole->DeepCopy(filter->GetOutput());
    const auto compare = [&] {
        int e[6];
        vtkImageData* part = filter->GetOutput();
        part->GetExtent(e);
        for (int y = e[2]; y <= e[3]; ++y)
            for (int x = e[0]; x <= e[1]; ++x)
                for (int c = 0; c < 3; ++c)
                    ASSERT_EQ(part->GetScalarComponentAsDouble(x, y, 0, c),
                              whole->GetScalarComponentAsDouble(x, y, 0, c));
    };
    const int extent[6] = {11, 53, 20, 31, 0, 0};
    filter->Modified();
    filter->UpdateExtent(extent);
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 43 * 12);
    compare();
    for (int piece = 0; piece < 3; ++piece) {
        filter->Modified();
        filter->UpdatePiece(piece, 3, 1);
        EXPECT_LT(filter->GetOutput()->GetNumberOfPoints(), 70 * 50);
        compare();
    }
    EXPECT_EQ(errors.text(), "");
}

TEST(VtkDrape, AViewDoesNotDependOnThoseBefore) {
    vtkNew<Drape> filter;
    filter->SetInputData(picture(30, 20));
    filter->SetSurface(Drape::TORUS);
    filter->SetViewSize(70, 50);
    const std::vector<double> wanted = drawn_numbers(filter);
    filter->SetCameraPosition(0.4, 0.5, 0.6);
    EXPECT_NE(drawn_numbers(filter), wanted);
    filter->SetTube(0.1);
    drawn(filter);
    filter->SetTube(0.2);
    filter->SetCameraPosition(0, 0, 2);
    EXPECT_EQ(drawn_numbers(filter), wanted);
    EXPECT_GT(filter->GetMaxError(), 0);
    EXPECT_LE(filter->GetMaxError(), filter->GetTolerance());
    Errors errors(filter);
    filter->SetAngle(kNan);
    filter->Update();
    EXPECT_EQ(filter->GetMaxError(), 0);
}

TEST(VtkDrape, ScalarsAreAnnounced) {
    vtkNew<Drape> filter;
    vtkNew<vtkImageData> texture;
    texture->DeepCopy(picture(8, 8, VTK_UNSIGNED_SHORT, 4));
    texture->SetSpacing(3, 4, 5);
    texture->SetOrigin(3, 4, 5);
    filter->SetInputData(texture);
    const std::pair<int, int> types[] = {
        {VTK_UNSIGNED_SHORT, 4}, {VTK_FLOAT, 2}, {VTK_FLOAT, 1}, {VTK_FLOAT, 3}};
    for (int output = Drape::COLOR; output <= Drape::NORMAL; ++output) {
        filter->SetStyle(output);
        filter->UpdateInformation();
        vtkInformation* information = filter->GetOutputInformation(0);
        EXPECT_EQ(vtkImageData::GetScalarType(information), types[output].first);
        EXPECT_EQ(vtkImageData::GetNumberOfScalarComponents(information), types[output].second);
        filter->Update();
        EXPECT_EQ(filter->GetOutput()->GetScalarType(), types[output].first);
        EXPECT_EQ(filter->GetOutput()->GetSpacing()[0], 1);
        EXPECT_EQ(filter->GetOutput()->GetOrigin()[1], 0);
    }
}

TEST(VtkDrape, TheSameBitsForAnyThreadsAndTheInputStays) {
    const Picture texture = picture(90, 70, VTK_UNSIGNED_CHAR, 4);
    const std::vector<double> before = numbers(texture->GetPointData()->GetScalars());
    vtkNew<Drape> filter;
    filter->SetInputData(texture);
    filter->SetSurface(Drape::RIPPLES);
    filter->SetViewSize(300, 200);
    const std::vector<double> wanted = drawn_numbers(filter);
    for_any_threads([&] {
        filter->Modified();
        ASSERT_EQ(drawn_numbers(filter), wanted);
    });
    EXPECT_EQ(numbers(texture->GetPointData()->GetScalars()), before);
}

/// A picture of 8 x 8 pixels of 10 times the time that is asked for.
class Clock : public vtkImageAlgorithm {
  public:
    static Clock* New() { return new Clock; }
    vtkTypeMacro(Clock, vtkImageAlgorithm);

  protected:
    Clock() { this->SetNumberOfInputPorts(0); }
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override {
        using Pipeline = vtkStreamingDemandDrivenPipeline;
        const double steps[3] = {1, 2, 4}, range[2] = {1, 4};
        vtkInformation* output = outputs->GetInformationObject(0);
        output->Set(Pipeline::TIME_STEPS(), steps, 3);
        output->Set(Pipeline::TIME_RANGE(), range, 2);
        output->Set(Pipeline::WHOLE_EXTENT(), 0, 7, 0, 7, 0, 0);
        return 1;
    }
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override {
        const double time =
            outputs->GetInformationObject(0)->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
        vtkImageData* image = vtkImageData::GetData(outputs);
        image->SetExtent(0, 7, 0, 7, 0, 0);
        image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
        image->GetPointData()->GetScalars()->FillComponent(0, 10 * time);
        image->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
        return 1;
    }
};

TEST(VtkDrape, ATimeThatIsAskedForIsSeen) {
    vtkNew<Clock> clock;
    vtkNew<Drape> filter;
    filter->SetInputConnection(clock->GetOutputPort());
    look_straight(filter, 8, 8);
    filter->UpdateInformation();
    EXPECT_EQ(filter->GetOutputInformation(0)->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()), 3);
    for (const double time : {1., 4., 2., 2.}) {
        filter->UpdateTimeStep(time);
        EXPECT_EQ(filter->GetOutput()->GetScalarComponentAsDouble(4, 4, 0, 0), 10 * time);
        EXPECT_EQ(filter->GetOutput()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), time);
    }
}

TEST(VtkDrape, ProgressRisesTo1AndAbortLeavesNothing) {
    vtkNew<Drape> filter;
    vtkNew<ProgressObserver> progress;
    filter->AddObserver(vtkCommand::ProgressEvent, progress);
    filter->SetInputData(picture(50, 50));
    filter->SetSurface(Drape::SPHERE);
    filter->Update();
    ASSERT_GE(progress->reports.size(), 4u);
    EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
    EXPECT_EQ(progress->reports.back(), 1);
    progress->algorithm = filter;
    progress->abort_at = 0.3;
    filter->Modified();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
    progress->abort_at = -1;
    filter->SetAbortExecute(0);
    filter->Modified();
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 500 * 500);
}

TEST(VtkDrape, UpdatesOnlyAfterAChangeOfAValue) {
    vtkNew<Drape> filter;
    filter->SetInputData(picture(4, 4));
    expect_modified_by<Drape>(filter,
                              {[](Drape* f) { f->SetSurface(Drape::CYLINDER); },
                               [](Drape* f) { f->SetAngle(90); },
                               [](Drape* f) { f->SetRadius(0.4); },
                               [](Drape* f) { f->SetTube(0.1); },
                               [](Drape* f) { f->SetAmplitude(0.1); },
                               [](Drape* f) { f->SetWavelength(0.1); },
                               [](Drape* f) { f->SetPhase(0.1); },
                               [](Drape* f) { f->SetDirection(5); },
                               [](Drape* f) { f->SetTurn(0.1); },
                               [](Drape* f) { f->SetViewSize(30, 20); },
                               [](Drape* f) { f->SetCameraPosition(0, 1, 2); },
                               [](Drape* f) { f->SetCameraFocalPoint(0, 0.1, 0); },
                               [](Drape* f) { f->SetCameraViewUp(0.1, 1, 0); },
                               [](Drape* f) { f->CameraParallelProjectionOn(); },
                               [](Drape* f) { f->SetCameraParallelScale(0.7); },
                               [](Drape* f) { f->SetCameraViewAngle(40); },
                               [](Drape* f) { f->SetTolerance(0.5); },
                               [](Drape* f) { f->SetFilter(Drape::BICUBIC); },
                               [](Drape* f) { f->SetBackground(1, 0, 0, 1); },
                               [](Drape* f) { f->SetStyle(Drape::DEPTH); },
                               [](Drape* f) { f->SetScheme(Drape::OKA_Z); },
                               [](Drape* f) { f->SetBlock(4); },
                               [](Drape* f) { f->SetOverlap(1); },
                               [](Drape* f) { f->SetMachine("oka-1987"); },
                               [](Drape* f) { f->SetBlendWeight(Drape::PLANE, 0.1); },
                               [](Drape* f) { f->SetHeightScale(0.3); },
                               [](Drape* f) { f->SetHeightSmooth(0.3); },
                               [](Drape* f) { f->SetDeformationFileName("none.csv"); },
                               [](Drape* f) { f->SetDeformationFileName(nullptr); },
                               [](Drape* f) { f->SetFormulaX("u"); },
                               [](Drape* f) { f->SetFormulaY("v"); },
                               [](Drape* f) { f->SetFormulaZ("u*v"); },
                               [](Drape* f) { f->SetFormulaDefinitions("k=1"); },
                               [](Drape* f) { f->SetFrame(3); },
                               [](Drape* f) { f->SetShading(Drape::PHONG); },
                               [](Drape* f) { f->SetNumberOfLights(2); },
                               [](Drape* f) { f->SetLight(1, 1, 0, 0); },
                               [](Drape* f) { f->SetAmbient(0.3); },
                               [](Drape* f) { f->SetDiffuse(0.3); },
                               [](Drape* f) { f->SetSpecular(0.3); },
                               [](Drape* f) { f->SetShininess(3); },
                               [](Drape* f) { f->SetPositionsConnection(f->GetInputConnection(0, 0)); },
                               [](Drape* f) { f->SetHeightConnection(f->GetInputConnection(0, 0)); }});
    filter->SetSurface(99);
    EXPECT_EQ(filter->GetSurface(), Drape::FORMULA);
    filter->SetSurface(Drape::SPHERE);
    expect_executed_once(filter);
}

TEST(VtkDrape, PrintsItsState) {
    vtkNew<Drape> filter;
    filter->SetSurface(Drape::PAGE_TURN);
    expect_printed(filter, {"Surface: page_turn",
                            "Angle: 180",
                            "Radius: 0",
                            "Tube: 0.2",
                            "Amplitude: 0.05",
                            "Wavelength: 0.5",
                            "Phase: 0",
                            "Direction: 0",
                            "Turn: 0.5",
                            "ViewSize: 500 500",
                            "CameraPosition: 0 0 2",
                            "CameraFocalPoint: 0 0 0",
                            "CameraViewUp: 0 1 0",
                            "CameraParallelProjection: 0",
                            "CameraParallelScale: 0.5",
                            "CameraViewAngle: 30",
                            "Tolerance: 0.125",
                            "Filter: antialias",
                            "Background: 0 0 0 0",
                            "BlendWeights: 0 0 0 0 0 0 0 0 0",
                            "HeightScale: 0.1",
                            "HeightSmooth: 1",
                            "DeformationFileName: (none)",
                            "FormulaX: (none)",
                            "FormulaDefinitions: (none)",
                            "Frame: 0",
                            "PositionsArrayName: (none)",
                            "HeightArrayName: (none)",
                            "Shading: none",
                            "Light: 0 0 1",
                            "Ambient: 0.2",
                            "Diffuse: 0.8",
                            "Specular: 0",
                            "Shininess: 20",
                            "Style: color",
                            "Scheme: auto",
                            "Block: 8",
                            "Overlap: 0.5",
                            "Machine: (none)",
                            "MaxError: 0"});
}

TEST(VtkDrape, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphDrape>("vtkAnamorphDrape");
}

/// An image of bytes of three components, of one color but for its left half.
vtkSmartPointer<vtkImageData> halves(int width, int height, std::array<int, 3> left,
                                     std::array<int, 3> right) {
    const auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
            for (int c = 0; c < 3; ++c)
                image->SetScalarComponentFromDouble(
                    i, j, 0, c, (i < width / 2 ? left : right)[static_cast<std::size_t>(c)]);
    return image;
}

// The far side's own picture, of another size, is seen from there the right way round, and nothing of it from here.
TEST(VtkDrape, TheFarSideHasItsOwnPicture) {
    vtkNew<Drape> drape;
    drape->SetInputData(halves(40, 30, {250, 0, 0}, {0, 250, 0}));
    drape->SetInputData(4, halves(90, 20, {0, 0, 250}, {200, 200, 200}));
    drape->SetViewSize(60, 60);
    drape->SetFilter(Drape::NEAREST);
    const auto at = [&](int i) {
        std::array<int, 3> color{};
        for (int c = 0; c < 3; ++c)
            color[static_cast<std::size_t>(c)] =
                static_cast<int>(drape->GetOutput()->GetScalarComponentAsDouble(i, 30, 0, c));
        return color;
    };
    drape->SetCameraPosition(0, 0, 3);
    drape->Update();
    EXPECT_EQ(at(25), (std::array<int, 3>{250, 0, 0}));
    EXPECT_EQ(at(35), (std::array<int, 3>{0, 250, 0}));
    drape->SetCameraPosition(0, 0, -3);
    drape->Update();
    EXPECT_EQ(at(25), (std::array<int, 3>{0, 0, 250}));
    EXPECT_EQ(at(35), (std::array<int, 3>{200, 200, 200}));
    Errors errors(drape);
    const auto error = [&](vtkImageData* back) {
        errors.clear();
        drape->SetInputData(4, back);
        drape->Update();
        return errors.text();
    };
    vtkNew<vtkImageData> grey, floats;
    grey->SetDimensions(4, 4, 1);
    grey->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    floats->SetDimensions(4, 4, 1);
    floats->AllocateScalars(VTK_FLOAT, 3);
    EXPECT_THAT(error(grey), HasSubstr("Back=1 components: must have as many as the texture, 3"));
    EXPECT_THAT(error(floats), HasSubstr("must be of the texture's type"));
    EXPECT_THAT(error(vtkNew<vtkImageData>()), HasSubstr("the input Back"));
    drape->SetScheme(Drape::HARDWARE);
    EXPECT_THAT(error(halves(40, 30, {1, 1, 1}, {2, 2, 2})), HasSubstr("Scheme=hardware"));
}

// Coverage is what a white texture shows over nothing.
TEST(VtkDrape, CoverageIsTheShareOfAPixel) {
    vtkNew<vtkImageData> white;
    white->SetDimensions(32, 32, 1);
    white->AllocateScalars(VTK_FLOAT, 1);
    white->GetPointData()->GetScalars()->Fill(1);
    vtkNew<Drape> drape;
    drape->SetInputData(white);
    drape->SetViewSize(80, 60);
    drape->SetSurface(Drape::CYLINDER);
    drape->SetFilter(Drape::ANTIALIAS);
    drape->SetCameraPosition(0.4, 0.7, 2.2);
    drape->Update();
    std::vector<double> colors;
    for (vtkIdType i = 0; i < 80 * 60; ++i)
        colors.push_back(drape->GetOutput()->GetPointData()->GetScalars()->GetComponent(i, 0));
    drape->SetStyle(Drape::COVERAGE);
    drape->Update();
    vtkDataArray* coverage = drape->GetOutput()->GetPointData()->GetScalars();
    EXPECT_STREQ(coverage->GetName(), "Coverage");
    int partly = 0;
    for (vtkIdType i = 0; i < 80 * 60; ++i) {
        const double share = coverage->GetComponent(i, 0);
        ASSERT_NEAR(share, colors[static_cast<std::size_t>(i)], 1e-5) << i;
        partly += share > 0.01 && share < 0.99;
    }
    EXPECT_GT(partly, 20);
}

}  // namespace
}  // namespace test_drape
