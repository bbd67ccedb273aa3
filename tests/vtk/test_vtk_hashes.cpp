// SPDX-License-Identifier: Apache-2.0
// What VTK's filters compute has the hashes of tests/data/vtk_hashes.txt with every instruction set, as the core's pictures have
// (tests/core/test_picture_hash.cpp). Where a formula is right to change them, the test says the new lines.
#include <gtest/gtest.h>
#include <vtkAnamorphDeform.h>
#include <vtkAnamorphDeformImage.h>
#include <vtkAnamorphDrape.h>
#include <vtkAnamorphFigureGeometry.h>
#include <vtkAnamorphFigureImage.h>
#include <vtkAnamorphFigureOutline.h>
#include <vtkAnamorphImageMorph.h>
#include <vtkAnamorphImageWarp.h>
#include <vtkAnamorphInbetween.h>
#include <vtkAnamorphPanoramaView.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <span>

#include "../core/each_instruction_set.h"
#include "anamorph/image/picture_hash.h"
#include "figure_support.h"
#include "support.h"

namespace test_vtk_hashes {
namespace {

using anamorph::PictureHasher;

constexpr std::pair<int, const char*> kPixelTypes[] = {
    {VTK_UNSIGNED_CHAR, "uint8"}, {VTK_UNSIGNED_SHORT, "uint16"}, {VTK_FLOAT, "float"}};

/// 0 to 1, less than that, in steps of 2^-24, with no help of a library.
double part(std::uint32_t place, std::uint32_t seed) {
    std::uint32_t n = place * 0x9e3779b1u + seed * 0x85ebca77u;
    n = (n ^ (n >> 15)) * 0x2c1b3c6du;
    n = (n ^ (n >> 12)) * 0x297a2d39u;
    return static_cast<double>((n ^ (n >> 15)) >> 8) * 0x1p-24;
}

/// A bent plane of 41 x 31 points of float or double, in triangles, with texture coordinates.
vtkSmartPointer<vtkPolyData> sheet(int type, std::uint32_t seed = 0) {
    constexpr int kColumns = 41, kRows = 31;
    vtkNew<vtkPoints> points;
    points->SetDataType(type);
    vtkNew<vtkFloatArray> uv;
    uv->SetNumberOfComponents(2);
    vtkNew<vtkCellArray> triangles;
    for (int j = 0; j < kRows; ++j)
        for (int i = 0; i < kColumns; ++i) {
            const double u = i / (kColumns - 1.0), v = j / (kRows - 1.0);
            const auto place = static_cast<std::uint32_t>(j * kColumns + i);
            points->InsertNextPoint(2 * u - 1 + 0.01 * part(place, 3 * seed), 2 * v - 1, u * v * (1 - u));
            uv->InsertNextTuple2(u, v);
            if (i + 1 < kColumns && j + 1 < kRows) {
                const vtkIdType p = j * kColumns + i;
                const vtkIdType lower[] = {p, p + 1, p + kColumns},
                                upper[] = {p + 1, p + kColumns + 1, p + kColumns};
                triangles->InsertNextCell(3, lower);
                triangles->InsertNextCell(3, upper);
            }
        }
    auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points);
    mesh->SetPolys(triangles);
    mesh->GetPointData()->SetTCoords(uv);
    return mesh;
}

vtkSmartPointer<vtkImageData> texture(int type, int components) {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(64, 48, 1);
    image->AllocateScalars(type, components);
    vtkDataArray* pixels = image->GetPointData()->GetScalars();
    const double scale = type == VTK_FLOAT ? 1 : type == VTK_UNSIGNED_CHAR ? 256 : 65536;
    for (vtkIdType i = 0; i < pixels->GetNumberOfTuples(); ++i)
        for (int c = 0; c < components; ++c) {
            const double v = scale * part(static_cast<std::uint32_t>(i * 4 + c), 7);
            pixels->SetComponent(i, c, type == VTK_FLOAT ? v : std::floor(v));
        }
    return image;
}

/// The hash of the numbers of arrays, whose names are the line's.
class Lines {
  public:
    void add(const std::string& name, std::initializer_list<vtkDataArray*> arrays) {
        PictureHasher hasher;
        for (vtkDataArray* array : arrays) {
            ASSERT_TRUE(array) << name;
            ASSERT_GT(array->GetNumberOfTuples(), 0) << name;
            const int bytes = array->GetDataTypeSize();
            const auto count = static_cast<std::size_t>(array->GetNumberOfValues() * bytes);
            hasher.add_numbers(
                {static_cast<const std::byte*>(array->GetVoidPointer(0)), count},
                {bytes, array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE});
        }
        ASSERT_TRUE(m_lines.emplace(name, anamorph::hash_digits(hasher.hash())).second) << name;
    }
    const std::map<std::string, std::string>& lines() const { return m_lines; }

  private:
    std::map<std::string, std::string> m_lines;
};

/// What a filter makes, which is to have no error.
template <class Data>
Data* made(vtkAlgorithm* filter) {
    Errors errors(filter);
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    return Data::SafeDownCast(filter->GetOutputDataObject(0));
}

void add_points(Lines& lines, const std::string& name, vtkAlgorithm* filter) {
    auto* mesh = made<vtkPolyData>(filter);
    ASSERT_TRUE(mesh) << name;
    if (vtkDataArray* const normals = mesh->GetPointData()->GetNormals())
        lines.add(name, {mesh->GetPoints()->GetData(), normals});
    else
        lines.add(name, {mesh->GetPoints()->GetData()});
}

void add_picture(Lines& lines, const std::string& name, vtkAlgorithm* filter) {
    auto* image = made<vtkImageData>(filter);
    ASSERT_TRUE(image) << name;
    lines.add(name, {image->GetPointData()->GetScalars()});
}

void deform(Lines& lines) {
    for (const int type : {VTK_FLOAT, VTK_DOUBLE})
        for (const bool turned : {false, true}) {
            vtkNew<vtkAnamorphDeform> filter;
            filter->SetInputData(sheet(type));
            filter->SetNumberOfDeformations(9);
            for (int k = 0; k < 9; ++k) {
                const auto p = [&](std::uint32_t i) { return part(i, static_cast<std::uint32_t>(k) + 20); };
                filter->SetDeformation(k, 2 * p(1) - 1, 2 * p(2) - 1, 0.2 + p(3) / 2, 0.2 + p(4) / 2,
                                       p(5) - 0.5, p(6) - 0.5, p(7) - 0.5, k % 2, true);
                if (turned) {
                    filter->SetDepth(k, p(11) / 4, 0.2 + p(12));
                    filter->SetOrientation(k, 1, p(8), p(9), p(10) - 0.5);
                }
            }
            add_points(
                lines,
                std::string("deform ") + (type == VTK_FLOAT ? "float" : "double") + (turned ? " turned" : ""),
                filter);
        }
}

void inbetween(Lines& lines) {
    for (const int type : {VTK_FLOAT, VTK_DOUBLE}) {
        vtkNew<vtkAnamorphInbetween> filter;
        filter->SetNumberOfWeights(3);
        for (int k = 0; k < 3; ++k) {
            filter->AddInputData(sheet(type, static_cast<std::uint32_t>(k) + 1));
            filter->SetWeight(k, k == 0 ? 0.3 : k == 1 ? 1.1 : -0.4);
        }
        add_points(lines, std::string("inbetween ") + (type == VTK_FLOAT ? "float" : "double"), filter);
    }
}

void drape(Lines& lines) {
    using Drape = vtkAnamorphDrape;
    int turn = 0;
    for (const int surface : {Drape::CYLINDER, Drape::SPHERE, Drape::TORUS, Drape::WAVES})
        for (const auto& [type, type_name] : kPixelTypes) {
            const int filter_kind = std::array{Drape::BILINEAR, Drape::BICUBIC, Drape::ANTIALIAS,
                                               Drape::PYRAMID}[static_cast<std::size_t>(turn++ % 4)];
            vtkNew<Drape> filter;
            filter->SetInputData(texture(type, type == VTK_UNSIGNED_SHORT ? 4 : 3));
            filter->SetSurface(surface);
            filter->SetViewSize(64, 48);
            filter->SetCameraPosition(0.6, 0.7, 2.4);
            filter->SetFilter(filter_kind);
            filter->SetShading(surface == Drape::TORUS   ? Drape::PHONG
                               : surface == Drape::WAVES ? Drape::GOURAUD
                                                         : Drape::NONE);
            filter->SetSpecular(0.4);
            add_picture(lines,
                        "drape " + std::to_string(surface) + " " + type_name + " filter " +
                            std::to_string(filter_kind),
                        filter);
        }
}

const std::vector<Ball>& balls() {
    static const std::vector<Ball> two{{{420, 480, -200}, {150, 60, 90}, {1, 0.2, 0.3, 0.1}},
                                       {{600, 520, -300}, {110, 210, 60}, {0.6, -0.3, 0.2, 0.7}}};
    return two;
}

void figure_images(Lines& lines) {
    using Image = vtkAnamorphFigureImage;
    for (const int style : {Image::SHADED, Image::DEPTH, Image::BODY_ID})
        for (const int lighting : {Image::RASEL, Image::LAMBERT, Image::BLINN}) {
            if (style != Image::SHADED && lighting != Image::RASEL) continue;
            vtkNew<Image> filter;
            filter->SetInputData(figures(balls()));
            filter->SetViewSize(80, 64);
            filter->SetStyle(style);
            filter->SetLighting(lighting);
            add_picture(lines,
                        "figure style " + std::to_string(style) + " lighting " + std::to_string(lighting),
                        filter);
        }
}

void figure_lines(Lines& lines) {
    vtkNew<vtkAnamorphFigureImage> picture;
    picture->SetInputData(figures(balls()));
    picture->SetViewSize(80, 64);
    picture->SetStyle(vtkAnamorphFigureImage::OUTLINE);
    add_picture(lines, "figure outline", picture);
    vtkNew<vtkAnamorphFigureOutline> outline;
    outline->SetInputData(figures(balls()));
    add_points(lines, "outline points", outline);
    for (const int precision : {vtkAlgorithm::SINGLE_PRECISION, vtkAlgorithm::DOUBLE_PRECISION}) {
        vtkNew<vtkAnamorphFigureGeometry> geometry;
        geometry->SetInputData(figures(balls()));
        geometry->SetTolerance(5);
        geometry->SetOutputPointsPrecision(precision);
        add_points(lines,
                   std::string("figure points ") +
                       (precision == vtkAlgorithm::SINGLE_PRECISION ? "float" : "double"),
                   geometry);
    }
}

/// A mesh of 5 x 4 points over texture(), each some pixels from where it was.
vtkSmartPointer<vtkPolyData> moved_grid() {
    vtkNew<vtkPoints> points;
    points->SetDataType(VTK_DOUBLE);
    vtkNew<vtkDoubleArray> uv;
    uv->SetNumberOfComponents(2);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 5; ++i) {
            const auto place = static_cast<std::uint32_t>(5 * j + i);
            const double u = i / 4.0, v = j / 3.0;
            points->InsertNextPoint(63 * u + 8 * part(place, 51) - 4, 47 * v + 8 * part(place, 52) - 4, 0);
            uv->InsertNextTuple2(u, v);
        }
    auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points);
    mesh->GetPointData()->SetTCoords(uv);
    return mesh;
}

void warps(Lines& lines) {
    using Warp = vtkAnamorphImageWarp;
    for (const auto& [type, type_name] : kPixelTypes)
        for (const int interpolation : {Warp::NEAREST, Warp::LINEAR, Warp::CUBIC, Warp::ANTIALIAS})
            for (const int direction : {Warp::PUSH, Warp::PULL}) {
                vtkNew<Warp> filter;
                filter->SetInputDataObject(0, texture(type, type == VTK_FLOAT ? 4 : 3));
                filter->SetInputDataObject(1, moved_grid());
                filter->SetDirection(direction);
                filter->SetInterpolation(interpolation);
                add_picture(lines,
                            std::string("warp ") + type_name + " filter " + std::to_string(interpolation) +
                                (direction == Warp::PUSH ? " push" : " pull"),
                            filter);
            }
}

/// Three lines, each end some pixels from where it was.
vtkSmartPointer<vtkPolyData> features(std::uint32_t seed) {
    constexpr double kEnds[][2] = {{12, 10}, {40, 14}, {50, 8}, {56, 38}, {16, 36}, {42, 34}};
    vtkNew<vtkPoints> points;
    points->SetDataType(VTK_DOUBLE);
    vtkNew<vtkCellArray> cells;
    for (std::uint32_t k = 0; k < 6; ++k) {
        points->InsertNextPoint(kEnds[k][0] + 4 * part(k, seed), kEnds[k][1] + 4 * part(k, seed + 1), 0);
        if (k % 2) {
            const vtkIdType ends[] = {k - 1, k};
            cells->InsertNextCell(2, ends);
        }
    }
    auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points);
    mesh->SetLines(cells);
    return mesh;
}

void morphs(Lines& lines) {
    using Morph = vtkAnamorphImageMorph;
    for (const auto& [type, type_name] : kPixelTypes)
        for (const int interpolation : {Morph::NEAREST, Morph::LINEAR, Morph::CUBIC, Morph::ANTIALIAS}) {
            vtkNew<Morph> filter;
            const auto image = texture(type, type == VTK_FLOAT ? 4 : 3);
            filter->SetInputDataObject(0, image);
            filter->SetInputDataObject(1, image);
            filter->SetInputDataObject(2, features(61));
            filter->SetInputDataObject(3, features(71));
            filter->SetInterpolation(interpolation);
            filter->SetShape(0.3);
            filter->SetColorFollowsShape(false);
            filter->SetPinBorder(interpolation == Morph::LINEAR ? 1 : 0);
            filter->SetWeightB(interpolation == Morph::CUBIC ? 1.5 : 2);
            add_picture(lines, std::string("morph ") + type_name + " filter " + std::to_string(interpolation),
                        filter);
        }
}

void deformed_images(Lines& lines) {
    using Deform = vtkAnamorphDeformImage;
    for (const int interpolation : {Deform::NEAREST, Deform::LINEAR, Deform::CUBIC})
        for (const bool inverse : {false, true}) {
            vtkNew<Deform> filter;
            filter->SetInputData(texture(VTK_FLOAT, 3));
            filter->AddDeformation(30, 20, 15, 18, 6, -4, 0);
            filter->AddDeformation(44, 30, 12, 14, -3, 5, 0, 1);
            filter->SetInterpolation(interpolation);
            filter->SetInverse(inverse);
            add_picture(
                lines, "deformed image filter " + std::to_string(interpolation) + (inverse ? " inverse" : ""),
                filter);
        }
}

void views(Lines& lines) {
    for (const auto& [type, type_name] : kPixelTypes) {
        vtkNew<vtkAnamorphPanoramaView> filter;
        filter->SetInputData(texture(type, 3));
        filter->SetViewSize(64, 48);
        filter->SetYaw(40);
        filter->SetPitch(20);
        add_picture(lines, std::string("view ") + type_name, filter);
    }
}

TEST(VtkHashes, EveryInstructionSetComputesTheSame) {
    std::ifstream file(ANAMORPH_VTK_HASHES);
    std::map<std::string, std::string> known;
    for (std::string line; std::getline(file, line);)
        if (!line.empty() && line[0] != '#') known[line.substr(33)] = line.substr(0, 32);
    int sets = 0;
    anamorph::test::on_every_instruction_set([&] {
        ++sets;
        Lines lines;
        deform(lines);
        inbetween(lines);
        drape(lines);
        figure_images(lines);
        figure_lines(lines);
        warps(lines);
        morphs(lines);
        deformed_images(lines);
        views(lines);
        std::string wrong;
        for (const auto& [name, digits] : lines.lines())
            if (const auto line = known.find(name); line == known.end() || line->second != digits)
                wrong += digits + " " + name + "\n";
        EXPECT_EQ(wrong, "");
        EXPECT_EQ(known.size(), lines.lines().size());
    });
#if defined(__x86_64__) || defined(__i386__)
    EXPECT_GE(sets, 2);  // arm64 has one
#endif
}

}  // namespace
}  // namespace test_vtk_hashes
