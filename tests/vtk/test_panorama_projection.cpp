// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphPanoramaProjection.h>  // first: it stands alone

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAppendPolyData.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCubeSource.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkIntArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPlaneSource.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSphereSource.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStructuredGrid.h>
#include <vtkTriangle.h>
#include <vtkTriangleFilter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <set>

#include "support.h"

namespace test_panorama_projection {
namespace {

using testing::HasSubstr;
using Filter = vtkAnamorphPanoramaProjection;
using Mesh = vtkSmartPointer<vtkPolyData>;
constexpr double kPi = std::numbers::pi;

vtkPolyData* painted(Filter* filter) {
    return vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0));
}
vtkPolyData* rest(Filter* filter) {
    return vtkPolyData::SafeDownCast(filter->GetOutputDataObject(1));
}
double field(vtkDataObject* object, const char* name) {
    auto* array = vtkDataArray::SafeDownCast(object->GetFieldData()->GetAbstractArray(name));
    return array ? array->GetComponent(0, 0) : kNan;
}

/// A cube from -1 to 1, which the projector is in.
Mesh room() {
    vtkNew<vtkCubeSource> source;
    source->SetXLength(2);
    source->SetYLength(2);
    source->SetZLength(2);
    source->Update();
    return source->GetOutput();
}
Mesh wall(double z = -1, double half = 1) {
    vtkNew<vtkPlaneSource> source;
    source->SetOrigin(-half, -half, z);
    source->SetPoint1(half, -half, z);
    source->SetPoint2(-half, half, z);
    source->Update();
    return source->GetOutput();
}

double area_of(vtkPolyData* mesh) {
    double sum = 0;
    for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i) {
        double p[3][3];
        for (int k = 0; k < 3; ++k) mesh->GetPoint(mesh->GetCell(i)->GetPointId(k), p[k]);
        sum += vtkTriangle::TriangleArea(p[0], p[1], p[2]);
    }
    return sum;
}

/// All that an output has, as numbers.
std::vector<double> everything(vtkPolyData* mesh) {
    std::vector<double> all = coordinates(mesh);
    for (vtkDataSetAttributes* arrays : {static_cast<vtkDataSetAttributes*>(mesh->GetPointData()),
                                         static_cast<vtkDataSetAttributes*>(mesh->GetCellData())})
        for (int i = 0; i < arrays->GetNumberOfArrays(); ++i) {
            const std::vector<double> part = numbers(arrays->GetArray(i));
            all.insert(all.end(), part.begin(), part.end());
        }
    for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i)
        for (int k = 0; k < 3; ++k) all.push_back(static_cast<double>(mesh->GetCell(i)->GetPointId(k)));
    return all;
}

/// The worst distance in texels between interpolated coordinates and the formula, at random points of the cells.
template <class Truth>
double worst_error(Filter* filter, const Truth& truth, bool closed) {
    vtkPolyData* mesh = painted(filter);
    vtkDataArray* texels = mesh->GetPointData()->GetTCoords();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0, 1);
    double worst = 0;
    for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i) {
        double a = share(random), b = share(random);
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const double weights[] = {1 - a - b, a, b};
        double x[3] = {}, uv[2] = {};
        for (int k = 0; k < 3; ++k) {
            const vtkIdType id = mesh->GetCell(i)->GetPointId(k);
            double p[3];
            mesh->GetPoint(id, p);
            for (int c = 0; c < 3; ++c) x[c] += weights[k] * p[c];
            for (int c = 0; c < 2; ++c) uv[c] += weights[k] * texels->GetComponent(id, c);
        }
        double exact[2];
        truth(x, exact);
        double across = std::fabs(exact[0] - uv[0]);
        if (closed) across = std::min(across, 1 - across);
        worst = std::max(worst, std::hypot(across * filter->GetPanoramaWidth(),
                                           (exact[1] - uv[1]) * filter->GetPanoramaHeight()));
    }
    return worst;
}

TEST(VtkPanoramaProjection, ACylinderIsThrownByEquation4_1) {
    vtkNew<Filter> filter;
    filter->SetInputData(room());
    filter->SetProjection(Filter::CYLINDRICAL);
    filter->SetPanoramaWidth(1024);
    filter->SetPanoramaHeight(512);
    filter->SetPosition(0.2, -0.1, 0.3);
    filter->SetTolerance(0.25);
    filter->Update();
    ASSERT_GT(painted(filter)->GetNumberOfCells(), 100);
    const auto truth = [](const double* p, double* uv) {
        const double x = p[0] - 0.2, y = p[1] + 0.1, z = p[2] - 0.3;
        uv[0] = std::atan2(x, -z) / (2 * kPi) + 0.5;
        // The cylinder is as high as its texels are square.
        uv[1] = y / std::sqrt(x * x + z * z) / (2 * kPi * 512 / 1024) + 0.5;
    };
    EXPECT_LE(worst_error(filter, truth, true), 0.25);
    EXPECT_EQ(field(painted(filter), "anamorph:tol"), 0.25);
    EXPECT_LE(field(painted(filter), "anamorph:max_error"), 0.25);
    EXPECT_GT(field(painted(filter), "anamorph:max_error"), 0.05);
    EXPECT_NEAR(area_of(painted(filter)) + area_of(rest(filter)), 24, 1e-4);
    // Above and below the cylinder.
    EXPECT_EQ(field(rest(filter), "anamorph:no_direction"), 0);
    for (const double why : numbers(rest(filter)->GetCellData()->GetArray("Painting"))) EXPECT_EQ(why, 1);
}

TEST(VtkPanoramaProjection, EveryProjectionPaintsARoom) {
    for (int projection = Filter::EQUIRECTANGULAR; projection <= Filter::DUAL_FISHEYE_TB; ++projection) {
        SCOPED_TRACE(projection);
        vtkNew<Filter> filter;
        Errors errors(filter);
        filter->SetInputData(room());
        filter->SetProjection(projection);
        const bool faces[] = {projection == Filter::CUBEMAP, projection == Filter::CUBECROSS,
                              projection == Filter::CUBEMAP_3X2 || projection == Filter::EAC,
                              projection == Filter::OCTAHEDRAL};
        const bool is_high = projection == Filter::DUAL_FISHEYE_TB;
        filter->SetPanoramaWidth(faces[0] || is_high ? 100 : faces[1] ? 400 : faces[2] ? 300 : 400);
        filter->SetPanoramaHeight(faces[0] ? 600 : faces[1] ? 300 : faces[2] ? 200 : faces[3] ? 400 : 200);
        filter->SetTolerance(1);
        filter->Update();
        EXPECT_EQ(errors.text(), "");
        EXPECT_GT(painted(filter)->GetNumberOfCells(), 10);
        EXPECT_NEAR(area_of(painted(filter)) + area_of(rest(filter)), 24, 1e-4);
        double range[2];
        for (int c = 0; c < 2; ++c) {
            painted(filter)->GetPointData()->GetTCoords()->GetRange(range, c);
            EXPECT_GE(range[0], -1e-4);
            EXPECT_LE(range[1], 1 + 1e-4);
        }
    }
}

TEST(VtkPanoramaProjection, WhatIsHiddenIsNotPainted) {
    vtkNew<Filter> filter;
    filter->SetInputData(wall(-2, 2));
    filter->SetInputData(1, wall(-1, 0.5));
    filter->SetPanoramaWidth(1440);
    filter->SetPanoramaHeight(720);
    filter->SetTolerance(1);
    filter->Update();
    // The shadow of a square of 1 is one of 2; its border, 8 long, is known to an eighth of a texel.
    const double texel = 2 * 2 * kPi / 1440;
    EXPECT_NEAR(area_of(painted(filter)), 16 - 4, 8 * 0.125 * texel);
    std::set<double> why;
    for (const double w : numbers(rest(filter)->GetCellData()->GetArray("Painting"))) why.insert(w);
    EXPECT_EQ(why, std::set<double>{2});
    filter->OcclusionOff();
    filter->Update();
    EXPECT_NEAR(area_of(painted(filter)), 16, 1e-5);
    EXPECT_EQ(rest(filter)->GetNumberOfCells(), 0);
}

TEST(VtkPanoramaProjection, BlankedCellsHideNothing) {
    const Mesh blanked = wall(-1, 0.5);
    vtkNew<vtkUnsignedCharArray> ghosts;
    ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
    ghosts->InsertNextValue(vtkDataSetAttributes::HIDDENCELL);
    blanked->GetCellData()->AddArray(ghosts);
    vtkNew<vtkMultiBlockDataSet> blocks;
    blocks->SetBlock(0, wall(-2, 2));
    vtkNew<Filter> filter;
    filter->SetInputData(blocks);
    filter->SetInputData(1, blanked);
    const auto painted_area = [&] {
        filter->Update();
        auto* out = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
        return area_of(vtkPolyData::SafeDownCast(out->GetBlock(0)));
    };
    EXPECT_NEAR(painted_area(), 16, 1e-5) << "among the occluders";
    filter->RemoveAllInputConnections(1);
    blocks->SetBlock(1, blanked);
    blocks->Modified();
    EXPECT_NEAR(painted_area(), 16, 1e-5) << "in the scene";
    // What another piece has, too, hides.
    ghosts->SetValue(0, vtkDataSetAttributes::DUPLICATECELL);
    ghosts->Modified();
    blanked->Modified();
    filter->Modified();
    EXPECT_LT(painted_area(), 13);
}

TEST(VtkPanoramaProjection, ASurfaceHidesItsFarSideAndNotItself) {
    vtkNew<vtkSphereSource> ball;
    ball->SetCenter(0, 0, -3);
    ball->SetThetaResolution(64);
    ball->SetPhiResolution(64);
    ball->SetRadius(1);
    vtkNew<Filter> filter;
    filter->SetInputConnection(ball->GetOutputPort());
    filter->SetTolerance(2);
    filter->Update();
    // The cap that is seen has the height r - r^2 / d.
    EXPECT_NEAR(area_of(painted(filter)), 2 * kPi * (1 - 1.0 / 3), 0.1);
    // What touches hides nothing: the same wall twice, and a room that the projector is in.
    filter->SetInputData(wall());
    filter->SetInputData(1, wall());
    filter->Update();
    EXPECT_NEAR(area_of(painted(filter)), 4, 1e-5);
    vtkNew<Filter> inside;
    inside->SetInputData(room());
    inside->SetTolerance(2);
    inside->Update();
    EXPECT_NEAR(area_of(painted(inside)), 24, 1e-4);
}

TEST(VtkPanoramaProjection, BlocksHideEachOtherAndStayBlocks) {
    vtkNew<vtkMultiBlockDataSet> blocks;
    blocks->SetNumberOfBlocks(4);
    blocks->SetBlock(0, wall(-2, 2));
    blocks->SetBlock(2, vtkNew<vtkPolyData>());
    blocks->SetBlock(3, wall(-1, 0.5));
    vtkNew<Filter> filter;
    filter->SetInputData(blocks);
    filter->SetTolerance(4);
    filter->Update();
    auto* out = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(out);
    ASSERT_EQ(out->GetNumberOfBlocks(), 4u);
    EXPECT_EQ(out->GetBlock(1), nullptr);
    EXPECT_EQ(vtkPolyData::SafeDownCast(out->GetBlock(2))->GetNumberOfCells(), 0);
    EXPECT_NEAR(area_of(vtkPolyData::SafeDownCast(out->GetBlock(0))), 12, 0.2);
    EXPECT_NEAR(area_of(vtkPolyData::SafeDownCast(out->GetBlock(3))), 1, 1e-5);

    vtkNew<vtkPartitionedDataSet> part;
    part->SetPartition(0, wall());
    vtkNew<vtkPartitionedDataSetCollection> collection;
    collection->SetPartitionedDataSet(0, part);
    filter->SetInputData(collection);
    filter->Update();
    auto* parts = vtkPartitionedDataSetCollection::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(parts);
    EXPECT_NEAR(area_of(vtkPolyData::SafeDownCast(parts->GetPartition(0, 0))), 4, 1e-5);
}

TEST(VtkPanoramaProjection, ArraysAreInterpolatedOrCopiedAndTheInputStays) {
    const Mesh scene = wall();
    const vtkIdType points = scene->GetNumberOfPoints();
    vtkNew<vtkDoubleArray> linear;
    linear->SetName("linear");
    vtkNew<vtkIntArray> cells;
    cells->SetName("cells");
    for (vtkIdType i = 0; i < points; ++i) {
        double p[3];
        scene->GetPoint(i, p);
        linear->InsertNextValue(2 * p[0] - 3 * p[1] + 5);
    }
    for (vtkIdType i = 0; i < scene->GetNumberOfCells(); ++i)
        cells->InsertNextValue(static_cast<int>(i) + 40);
    scene->GetPointData()->AddArray(linear);
    scene->GetCellData()->AddArray(cells);
    vtkNew<vtkDoubleArray> said;
    said->SetName("said");
    said->InsertNextValue(7);
    scene->GetFieldData()->AddArray(said);
    const std::vector<double> before = everything(scene);
    vtkNew<Filter> filter;
    filter->SetInputData(scene);
    filter->SetTolerance(0.5);
    filter->Update();
    vtkPolyData* out = painted(filter);
    ASSERT_GT(out->GetNumberOfPoints(), 100);
    vtkDataArray* found = out->GetPointData()->GetArray("linear");
    ASSERT_TRUE(found);
    for (vtkIdType i = 0; i < out->GetNumberOfPoints(); ++i) {
        double p[3];
        out->GetPoint(i, p);
        EXPECT_NEAR(found->GetComponent(i, 0), 2 * p[0] - 3 * p[1] + 5, 1e-6);
    }
    for (const double c : numbers(out->GetCellData()->GetArray("cells"))) EXPECT_EQ(c, 40);
    EXPECT_EQ(field(out, "said"), 7);
    EXPECT_STREQ(out->GetPointData()->GetTCoords()->GetName(), "PanoramaCoordinates");
    // Those that the plane had stay as another array.
    EXPECT_TRUE(out->GetPointData()->GetArray("TextureCoordinates"));
    EXPECT_TRUE(out->GetPointData()->GetNormals());
    EXPECT_EQ(everything(scene), before);
    // Corners are shared: half as many points as triangles, and some at the border.
    EXPECT_LT(out->GetNumberOfPoints(), 0.7 * static_cast<double>(out->GetNumberOfCells()));
}

TEST(VtkPanoramaProjection, SurfacesOfOtherDataSets) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(3, 3, 3);
    image->SetOrigin(-1, -1, -1);
    vtkNew<Filter> filter;
    filter->SetInputData(image);
    filter->SetTolerance(4);
    filter->Update();
    EXPECT_NEAR(area_of(painted(filter)), 24, 1e-4);
    const vtkNew<vtkPolyData> polygons;
    const vtkNew<vtkUnstructuredGrid> cells;
    const vtkNew<vtkStructuredGrid> grid;
    const vtkNew<vtkImageData> nothing;
    for (vtkDataSet* empty : std::initializer_list<vtkDataSet*>{polygons, cells, grid, nothing}) {
        Errors errors(filter);
        filter->SetInputData(empty);
        filter->Update();
        EXPECT_EQ(errors.text(), "");
        EXPECT_EQ(painted(filter)->GetNumberOfCells(), 0);
    }
}

TEST(VtkPanoramaProjection, PointsOfAllTypesAndOfNone) {
    for (const int type : {VTK_FLOAT, VTK_DOUBLE, VTK_INT}) {
        vtkNew<vtkPoints> points;
        points->SetDataType(type);
        for (const auto& [x, y] : {std::pair(-3, -3), std::pair(3, -3), std::pair(0, 3)})
            points->InsertNextPoint(x, y, -4);
        // One that is nowhere, and one at the projector.
        points->InsertNextPoint(type == VTK_INT ? 0 : kNan, 0, 0);
        points->InsertNextPoint(0, 0, 0);
        vtkNew<vtkCellArray> cells;
        cells->InsertNextCell({0, 1, 2});
        cells->InsertNextCell({0, 1, 3});
        cells->InsertNextCell({0, 1, 4});
        vtkNew<vtkPolyData> scene;
        scene->SetPoints(points);
        scene->SetPolys(cells);
        vtkNew<Filter> filter;
        Errors errors(filter);
        filter->SetInputData(scene);
        filter->SetTolerance(30);
        filter->OcclusionOff();
        filter->Update();
        EXPECT_EQ(errors.text(), "");
        EXPECT_EQ(painted(filter)->GetPoints()->GetDataType(), type == VTK_FLOAT ? VTK_FLOAT : VTK_DOUBLE);
        EXPECT_GT(field(rest(filter), "anamorph:no_direction"), 0);
        EXPECT_GT(area_of(painted(filter)), 18);
        for (const double x : coordinates(painted(filter))) EXPECT_TRUE(std::isfinite(x));
    }
}

TEST(VtkPanoramaProjection, AnyNumberOfThreadsGivesTheSameBits) {
    std::vector<double> first;
    for_any_threads([&] {
        vtkNew<Filter> filter;
        filter->SetInputData(room());
        filter->SetInputData(1, wall(-0.5, 0.3));
        filter->SetTolerance(3);
        filter->Update();
        const std::vector<double> found = everything(painted(filter));
        if (first.empty()) first = found;
        EXPECT_EQ(found, first);
    });
    EXPECT_GT(first.size(), 1000u);
}

TEST(VtkPanoramaProjection, PiecesOfASceneFitAndAreItsUnion) {
    vtkNew<vtkSphereSource> ball;
    ball->SetThetaResolution(20);
    ball->SetPhiResolution(16);
    ball->SetRadius(2);
    ball->Update();
    const Mesh whole = ball->GetOutput();
    const auto triangles_of = [](vtkPolyData* mesh, bool occlusion) {
        vtkNew<Filter> filter;
        filter->SetInputData(mesh);
        filter->SetPosition(0.3, 0.2, -0.4);
        filter->SetOcclusion(occlusion);
        filter->SetTolerance(8);
        filter->Update();
        std::multiset<std::vector<double>> found;
        vtkPolyData* out = painted(filter);
        for (vtkIdType i = 0; i < out->GetNumberOfCells(); ++i) {
            std::vector<double> corners;
            for (int k = 0; k < 3; ++k) {
                double p[3];
                const vtkIdType id = out->GetCell(i)->GetPointId(k);
                out->GetPoint(id, p);
                corners.insert(corners.end(), p, p + 3);
                for (int c = 0; c < 2; ++c)
                    corners.push_back(out->GetPointData()->GetTCoords()->GetComponent(id, c));
            }
            found.insert(corners);
        }
        return found;
    };
    std::multiset<std::vector<double>> parts;
    for (const int part : {0, 1, 2}) {
        vtkNew<vtkPolyData> piece;
        piece->SetPoints(whole->GetPoints());
        vtkNew<vtkCellArray> cells;
        for (vtkIdType i = part; i < whole->GetNumberOfCells(); i += 3)
            cells->InsertNextCell(whole->GetCell(i));
        piece->SetPolys(cells);
        parts.merge(triangles_of(piece, false));
    }
    EXPECT_EQ(parts, triangles_of(whole, false));
}

TEST(VtkPanoramaProjection, RefusesInWords) {
    vtkNew<Filter> alone;
    Errors missing(alone);
    alone->Update();
    EXPECT_NE(missing.text(), "");
    const auto with_wall = [](const std::function<void(Filter*)>& set) {
        vtkNew<Filter> filter;
        Errors errors(filter);
        filter->SetInputData(wall());
        set(filter);
        filter->Update();
        EXPECT_EQ(painted(filter)->GetNumberOfPoints(), 0);
        return errors.text();
    };
    EXPECT_THAT(with_wall([](Filter* f) { f->SetTolerance(0); }),
                HasSubstr("tol=0: must be a number above 0"));
    EXPECT_THAT(with_wall([](Filter* f) { f->SetTolerance(kNan); }), HasSubstr("tol=nan: must be"));
    EXPECT_THAT(with_wall([](Filter* f) { f->SetDirection(0, 0, 0); }),
                HasSubstr("direction=0,0,0: must be"));
    EXPECT_THAT(with_wall([](Filter* f) { f->SetViewUp(0, 0, 2); }),
                HasSubstr("up=0,0,2: must not be along"));
    EXPECT_THAT(with_wall([](Filter* f) { f->SetPosition(kInf, 0, 0); }),
                HasSubstr("position=inf,0,0: must be"));
    EXPECT_THAT(with_wall([](Filter* f) { f->SetPanoramaWidth(0); }),
                HasSubstr("panorama size=0x2048: must be"));
    EXPECT_THAT(with_wall([](Filter* f) { f->SetFieldOfView(361); }), HasSubstr("panorama fov=361: must be"));
    EXPECT_THAT(with_wall([](Filter* f) { f->SetLens("fish"); }), HasSubstr("lens=fish"));
    EXPECT_THAT(with_wall([](Filter* f) { f->SetProjection(Filter::CUBEMAP); }),
                HasSubstr("needs square faces"));
}

TEST(VtkPanoramaProjection, ProgressRisesTo1AndAbortEmptiesTheOutput) {
    vtkNew<Filter> filter;
    vtkNew<vtkSphereSource> ball;
    ball->SetThetaResolution(40);
    ball->SetPhiResolution(40);
    filter->SetInputConnection(ball->GetOutputPort());
    filter->SetTolerance(8);
    vtkNew<ProgressObserver> progress;
    progress->algorithm = filter;
    filter->AddObserver(vtkCommand::ProgressEvent, progress);
    filter->Update();
    ASSERT_GT(progress->reports.size(), 3u);
    EXPECT_TRUE(std::is_sorted(progress->reports.begin(), progress->reports.end()));
    EXPECT_EQ(progress->reports.back(), 1);
    progress->abort_at = 0.3;
    filter->Modified();
    filter->Update();
    EXPECT_EQ(painted(filter)->GetNumberOfPoints(), 0);
    filter->SetAbortExecute(0);
}

TEST(VtkPanoramaProjection, CountsModificationsExecutesOnceAndPrints) {
    vtkNew<Filter> filter;
    expect_modified_by<Filter>(
        filter, {[](Filter* f) { f->SetProjection(Filter::EAC); }, [](Filter* f) { f->SetPanoramaWidth(30); },
                 [](Filter* f) { f->SetPanoramaHeight(20); }, [](Filter* f) { f->SetFieldOfView(90); },
                 [](Filter* f) { f->SetPanniniDistance(2); }, [](Filter* f) { f->SetProjectionAlpha(0.25); },
                 [](Filter* f) { f->SetVerticalFieldOfView(70); }, [](Filter* f) { f->SetLens("none"); },
                 [](Filter* f) { f->SetPosition(1, 2, 3); }, [](Filter* f) { f->SetDirection(1, 0, 3); },
                 [](Filter* f) { f->SetViewUp(0, 0, 3); }, [](Filter* f) { f->SetTolerance(3); },
                 [](Filter* f) { f->OcclusionOff(); }});
    expect_printed(filter, {"Projection: eac", "PanoramaWidth: 30", "Position: 1 2 3", "Tolerance: 3",
                            "Lens: none", "ProjectionAlpha: 0.25", "VerticalFieldOfView: 70"});
    filter->SetInputData(room());
    expect_executed_once(filter);
    expect_overridden<Filter>("vtkAnamorphPanoramaProjection");
}

/// A picture of noise in a file, in bytes of so many channels.
std::string noise_file(const std::string& name, int width, int height, int channels) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, channels);
    std::mt19937 random(17);
    auto* to = static_cast<unsigned char*>(image->GetScalarPointer());
    for (int i = 0; i < width * height * channels; ++i) to[i] = static_cast<unsigned char>(random());
    vtkNew<vtkPNGWriter> writer;
    const std::string path = testing::TempDir() + name;
    writer->SetFileName(path.c_str());
    writer->SetInputData(image);
    writer->Write();
    return path;
}

TEST(VtkPanoramaProjection, ErrorsCountInTexelsOfThePictureWhichGoesWithWhatIsPainted) {
    vtkNew<Filter> with, without;
    for (Filter* filter : {with.Get(), without.Get()}) filter->SetInputData(room());
    with->SetPicture(noise_file("panorama_rgb.png", 64, 32, 3));
    without->SetPanoramaWidth(64);
    without->SetPanoramaHeight(32);
    with->Update();
    without->Update();
    ASSERT_GT(painted(with)->GetNumberOfCells(), 0);
    EXPECT_EQ(painted(with)->GetNumberOfCells(), painted(without)->GetNumberOfCells());
    EXPECT_EQ(field(painted(with), "anamorph:max_error"), field(painted(without), "anamorph:max_error"));
    EXPECT_EQ(with->GetUsedTolerance(), 0.125);
    const auto texels = [](vtkDataObject* data) {
        return vtkUnsignedCharArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("anamorph:picture"));
    };
    ASSERT_TRUE(texels(painted(with)));
    EXPECT_FALSE(texels(painted(without)) || texels(rest(with)));
    EXPECT_EQ(texels(painted(with))->GetNumberOfTuples(), 64 * 32);
    std::mt19937 random(17);
    for (int i = 0; i < 64 * 32 * 3; ++i)
        ASSERT_EQ(texels(painted(with))->GetValue(i), static_cast<unsigned char>(random())) << i;
    auto* size =
        vtkIntArray::SafeDownCast(painted(with)->GetFieldData()->GetAbstractArray("anamorph:picture_size"));
    ASSERT_TRUE(size && size->GetNumberOfValues() == 2);
    EXPECT_EQ(size->GetValue(0), 64);
    EXPECT_EQ(size->GetValue(1), 32);
    // Written again with another size, it is read again.
    noise_file("panorama_rgb.png", 16, 8, 1);
    std::filesystem::last_write_time(with->GetPicture(),
                                     std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
    with->Modified();
    with->Update();
    EXPECT_EQ(texels(painted(with))->GetNumberOfTuples(), 16 * 8);
    EXPECT_EQ(texels(painted(with))->GetComponent(0, 0), texels(painted(with))->GetComponent(0, 2));
}

TEST(VtkPanoramaProjection, LargePicturesGoAsMeansOfTheirTexels) {
    vtkNew<Filter> filter;
    filter->SetInputData(wall());
    filter->SetTolerance(1000);
    filter->SetPicture(noise_file("panorama_large.png", 8192, 2050, 1));
    filter->Update();
    auto* texels = vtkUnsignedCharArray::SafeDownCast(
        painted(filter)->GetFieldData()->GetAbstractArray("anamorph:picture"));
    ASSERT_TRUE(texels && texels->GetNumberOfTuples() == 4096 * 1025);
    std::mt19937 random(17);
    std::vector<unsigned char> noise(8192u * 2050u);
    for (unsigned char& texel : noise) texel = static_cast<unsigned char>(random());
    for (const int at : {0, 4095, 4096 * 500 + 77, 4096 * 1025 - 1}) {
        const int x = 2 * (at % 4096), y = 2 * (at / 4096);
        const auto from = [&](int i, int j) {
            return noise[static_cast<std::size_t>(8192 * (y + j) + x + i)];
        };
        const double mean = (from(0, 0) + from(1, 0) + from(0, 1) + from(1, 1)) / 4.0;
        EXPECT_NEAR(texels->GetComponent(at, 1), mean, 0.5) << at;
    }
}

TEST(VtkPanoramaProjection, PicturesThatAreNoneAreNamed) {
    const std::string broken = testing::TempDir() + "broken.png";
    std::ofstream(broken) << "no picture";
    for (const auto& [path, words] :
         {std::pair<std::string, const char*>{"/no/such.png", "there is no such file"},
          {broken, "broken.png"}}) {
        vtkNew<Filter> filter;
        filter->SetInputData(wall());
        filter->SetPicture(path);
        Errors errors(filter);
        filter->Update();
        EXPECT_THAT(errors.text(), testing::AllOf(HasSubstr("Picture"), HasSubstr(words)));
        EXPECT_EQ(painted(filter)->GetNumberOfCells(), 0);
    }
}

TEST(VtkPanoramaProjection, WithABudgetItIsCoarserAndSaysSo) {
    vtkNew<Filter> fine, coarse, ample;
    for (Filter* filter : {fine.Get(), coarse.Get(), ample.Get()}) {
        filter->SetInputData(room());
        filter->SetPanoramaWidth(512);
        filter->SetPanoramaHeight(256);
    }
    coarse->SetTimeBudget(1e-9);
    ample->SetTimeBudget(1e9);
    for (const double none : {-1.0, kNan, 0.0}) {
        fine->SetTimeBudget(none);
        EXPECT_EQ(fine->GetTimeBudget(), 0) << none;
    }
    for (Filter* filter : {fine.Get(), coarse.Get(), ample.Get()}) {
        filter->Update();
        EXPECT_NEAR(area_of(painted(filter)), 24, 1e-3);
        EXPECT_EQ(field(painted(filter), "anamorph:tol"), filter->GetUsedTolerance());
        EXPECT_LE(field(painted(filter), "anamorph:max_error"), filter->GetUsedTolerance());
    }
    EXPECT_EQ(coarse->GetUsedTolerance(), 0.125 * 4096);
    EXPECT_LT(painted(coarse)->GetNumberOfCells() * 10, painted(fine)->GetNumberOfCells());
    EXPECT_EQ(ample->GetUsedTolerance(), 0.125);
    EXPECT_EQ(painted(ample)->GetNumberOfCells(), painted(fine)->GetNumberOfCells());
    // Without the budget it is as fine as any.
    coarse->SetTimeBudget(0);
    coarse->Update();
    EXPECT_EQ(painted(coarse)->GetNumberOfCells(), painted(fine)->GetNumberOfCells());
}

}  // namespace
}  // namespace test_panorama_projection
