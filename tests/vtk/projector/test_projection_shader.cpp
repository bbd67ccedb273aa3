// SPDX-License-Identifier: Apache-2.0
// Panoramas thrown fragment by fragment, against the core's formulas in long double.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphPanoramaProjection.h>
#include <vtkAppendPolyData.h>
#include <vtkCallbackCommand.h>
#include <vtkCell.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPointData.h>
#include <vtkSphereSource.h>
#include <vtkVersion.h>
#include <vtkWeakPointer.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "anamorph/projector/projection_bake.h"
#include "thrown_scene.h"

#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 3, 0)
#include <vtkCompositePolyDataMapper.h>
using CompositeMapper = vtkCompositePolyDataMapper;
#else
#include <vtkCompositePolyDataMapper2.h>
using CompositeMapper = vtkCompositePolyDataMapper2;
#endif

namespace {

using anamorph::Chart;
using anamorph::DoubleDouble;
using anamorph::Point;
using anamorph::Projection;
using anamorph::Projector;
using anamorph::Ray;

/// About so many texels across, as the projection's faces or field of view have it.
Chart chart_of(Projection projection, double fov = 0) {
    constexpr int kTexels = 2048;
    const anamorph::FaceGrid grid = anamorph::faces_of(projection);
    if (grid.columns > 0) {
        const int face = kTexels / std::max(grid.columns, grid.rows);
        return {projection, grid.columns * face, grid.rows * face, fov};
    }
    const double degrees = fov > 0 ? fov : Chart::default_fov(projection);
    const double height = kTexels * anamorph::natural_aspect(projection, degrees);
    return {projection, kTexels, static_cast<int>(std::lround(height)), fov};
}

/// Throws a chart's panorama at an angle.
vtkSmartPointer<vtkAnamorphPanoramaProjector> projector_of(const Chart& chart, vtkTexture* texture,
                                                           const glm::dvec3& at = {-0.3, 0.2, 0.1}) {
    const auto projector = vtkSmartPointer<vtkAnamorphPanoramaProjector>::New();
    projector->SetPanorama(texture);
    projector->SetProjection(static_cast<int>(chart.projection()));
    projector->SetFieldOfView(chart.fov());
    projector->SetPosition(at.x, at.y, at.z);
    projector->SetOrientation(25, 15, -10);
    return projector;
}

Projector core_of(const Chart& chart, vtkAnamorphPanoramaProjector& projector) {
    const auto vector = [](const double* v) { return glm::dvec3(v[0], v[1], v[2]); };
    return Projector(chart, {vector(projector.GetPosition()), vector(projector.GetDirection()),
                             vector(projector.GetViewUp())});
}

/// How many pixels of two pictures are not the same.
int differences(const std::vector<Colour>& a, const std::vector<Colour>& b) {
    int count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
    return count;
}

Ray<DoubleDouble> in_pairs(const Ray<long double>& ray) {
    return {DoubleDouble(ray.x), DoubleDouble(ray.y), DoubleDouble(ray.z)};
}
Point<long double> point_of(const Chart& chart, const Ray<long double>& ray, int piece) {
    const Point<DoubleDouble> p = chart.point(in_pairs(ray), piece);
    return {static_cast<long double>(p.x), static_cast<long double>(p.y)};
}

/// The larger of the distances across and down from a texel's middle to where a ray meets the panorama.
long double distance(const Chart& chart, const Ray<long double>& ray, const std::array<int, 2>& place,
                     int piece) {
    const Point<long double> truth = point_of(chart, ray, piece);
    long double across = std::fabs(place[0] + 0.5L - truth.x);
    if (chart.closed()) across = std::min(across, std::fabs(chart.width() - across));
    return std::max(across, std::fabs(place[1] + 0.5L - truth.y));
}

/// On a border of two pieces either will do.
long double least_distance(const Chart& chart, const Ray<long double>& ray, const std::array<int, 2>& place) {
    const auto along = [&](int piece) {
        const glm::dvec3& f = chart.pieces()[static_cast<std::size_t>(piece)].toward;
        return (ray.x * f.x + ray.y * f.y + ray.z * f.z) / std::hypot(ray.x, ray.y, ray.z);
    };
    const int first = chart.piece_of(in_pairs(ray));
    long double least = HUGE_VALL;
    for (int p = 0; p < static_cast<int>(chart.pieces().size()); ++p)
        if (along(p) > along(first) - 1e-6L) least = std::min(least, distance(chart, ray, place, p));
    return least;
}

/// How far inside a panorama a ray is, in texels; negative outside.
long double texels_within(const Chart& chart, const Ray<long double>& ray) {
    if (chart.pieces().size() > 1) return HUGE_VALL;
    if (!(chart.sees(in_pairs(ray)) > 0)) return -HUGE_VALL;
    const Point<long double> p = point_of(chart, ray, 0);
    const long double down = std::min(p.y, chart.height() - p.y);
    return chart.closed() ? down : std::min({p.x, chart.width() - p.x, down});
}

struct Findings {
    long double worst = 0;
    int painted = 0, unpainted = 0, wrong = 0;
};

/// Of a picture of places.
void compare(const Room& room, const std::vector<Colour>& picture, const Projector& projector,
             Findings& findings) {
    const Chart& chart = projector.panorama();
    for (int j = 0; j < Room::kHeight; ++j)
        for (int i = 0; i < Room::kWidth; ++i) {
            const Colour& c = picture[static_cast<std::size_t>(j * Room::kWidth + i)];
            const Ray<long double> ray = room.ray(projector, i, j);
            const long double within = texels_within(chart, ray);
            const bool painted = c != kNoPlace;
            ++(painted ? findings.painted : findings.unpainted);
            // The border itself may go either way.
            if (painted != (within >= 0) && std::fabs(within) > 0.1L) ++findings.wrong;
            if (painted && within >= 0)
                findings.worst = std::max(findings.worst, least_distance(chart, ray, place_of_colour(c)));
        }
}

using Mode = vtkAnamorphProjectionShader::Modes;

/// A picture of places, from several sides.
Findings throw_places(const Chart& chart, const glm::dvec3& middle = glm::dvec3(0.0),
                      Mode mode = vtkAnamorphProjectionShader::DIRECT, double* bound = nullptr) {
    Room room(middle);
    const auto texture = texture_of(chart.width(), chart.height(), colour_of_place);
    texture->InterpolateOff();
    const auto projector = projector_of(chart, texture, middle + glm::dvec3(-0.3, 0.2, 0.1));
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    shader->HideUnpaintedOn();
    shader->SetMode(mode);
    shader->AddTo(room.actor);
    Findings findings;
    for (const double yaw : {20.0, 140.0, 260.0}) {
        room.look({yaw, yaw / 4 - 40, 15});
        compare(room, room.picture(), core_of(chart, *projector), findings);
    }
    if (bound) *bound = shader->GetResidualBound(room.actor);
    return findings;
}

TEST(VtkProjectionShader, DirectIsExactForEveryProjection) {
    for (const Projection projection : anamorph::kProjections) {
        SCOPED_TRACE(std::string(anamorph::name_of(projection)));
        const Findings findings = throw_places(chart_of(projection));
        EXPECT_LE(findings.worst, 0.6L);
        EXPECT_EQ(findings.wrong, 0);
        EXPECT_GT(findings.painted, 10000);
    }
}

TEST(VtkProjectionShader, ScenesFarFromTheOriginAreExact) {
    const Findings findings = throw_places(chart_of(Projection::equirectangular), {4e6, -3e6, 5e5});
    EXPECT_LE(findings.worst, 0.6L);
    EXPECT_EQ(findings.unpainted, 0);
}

TEST(VtkProjectionShader, ResidualsHoldTheirBound) {
    for (const Projection projection :
         {Projection::cylindrical, Projection::equirectangular, Projection::mercator, Projection::hammer,
          Projection::fisheye, Projection::pannini}) {
        SCOPED_TRACE(std::string(anamorph::name_of(projection)));
        double bound = 0;
        const Findings findings = throw_places(chart_of(projection), glm::dvec3(0.0),
                                               vtkAnamorphProjectionShader::RESIDUAL, &bound);
        EXPECT_GT(bound, 0);
        EXPECT_LE(bound, 0.25);
        // Half a texel to its border, and the rounding of float and of the texture unit's weights.
        EXPECT_LE(findings.worst, 0.5L + bound + 0.01L);
        EXPECT_EQ(findings.wrong, 0);
    }
}

/// Rises and falls by 8 levels a texel; its peaks are 30 texels apart.
double wave(double at) {
    return 8 + 8 * std::fabs(std::fmod(at, 60) - 30);
}

/// How far picture and formula are apart at most, in texels, where waves do not turn.
long double worst_of_waves(const Room& room, const std::vector<Colour>& picture, const Projector& projector) {
    long double worst = 0;
    for (int j = 0; j < Room::kHeight; ++j)
        for (int i = 0; i < Room::kWidth; ++i) {
            const Ray<long double> ray = room.ray(projector, i, j);
            const Point<long double> truth =
                point_of(projector.panorama(), ray, projector.panorama().piece_of(in_pairs(ray)));
            const double at[2] = {static_cast<double>(truth.x), static_cast<double>(truth.y)};
            for (std::size_t k = 0; k < 2; ++k) {
                const double place = std::fmod(at[k], 30);
                if (place < 3 || place > 27) continue;
                const int level = picture[static_cast<std::size_t>(j * Room::kWidth + i)][k];
                worst = std::max(worst, std::fabs(level - wave(at[k])) / 8.0L);
            }
        }
    return worst;
}

TEST(VtkProjectionShader, MultipassIsAsGoodAsItsPlanes) {
    const Chart chart(Projection::equirectangular, 1920, 960);
    const auto texture = texture_of(chart.width(), chart.height(), [](int i, int j) {
        return Colour{static_cast<unsigned char>(std::lround(wave(i + 0.5))),
                      static_cast<unsigned char>(std::lround(wave(j + 0.5))), 0};
    });
    texture->InterpolateOn();
    const auto projector = projector_of(chart, texture);
    Room room;
    room.look({20, 10, 15});
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    shader->AddTo(room.actor);
    for (const auto& [mode, size, most] : {std::tuple(vtkAnamorphProjectionShader::DIRECT, 0, 0.1L),
                                           std::tuple(vtkAnamorphProjectionShader::RESIDUAL, 0, 0.1L),
                                           std::tuple(vtkAnamorphProjectionShader::MULTIPASS, 512, 0.5L),
                                           std::tuple(vtkAnamorphProjectionShader::MULTIPASS, 2048, 0.2L)}) {
        SCOPED_TRACE(mode);
        shader->SetMode(mode);
        shader->SetPlaneSize(size);
        const long double worst = worst_of_waves(room, room.picture(), core_of(chart, *projector));
        EXPECT_LE(worst, most);
    }
}

/// Smooth, with 1.25 levels a texel at most; not rounded to levels.
std::array<double, 3> smooth_colour(int i, int j) {
    const auto level = [](double phase) { return 127 + 100 * std::sin(phase); };
    return {level(i * 2 * std::numbers::pi / 512), level(j * 2 * std::numbers::pi / 512),
            level((i + j) * 2 * std::numbers::pi / 1024)};
}

/// What bilinear interpolation makes of a panorama whose rows close.
std::array<double, 3> interpolated(const Chart& chart, const Point<double>& at) {
    const double x = at.x - 0.5, y = std::clamp(at.y, 0.5, chart.height() - 0.5) - 0.5;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    std::array<double, 3> sum{};
    for (int corner = 0; corner < 4; ++corner) {
        const int right = corner % 2, down = corner / 2;
        const double weight = (right ? x - i : 1 - (x - i)) * (down ? y - j : 1 - (y - j));
        const int column = (i + right + chart.width()) % chart.width();
        const std::array<double, 3> c = smooth_colour(column, std::min(j + down, chart.height() - 1));
        for (std::size_t k = 0; k < 3; ++k) sum[k] += weight * c[k];
    }
    return sum;
}

/// The largest distance of a picture from exact colours, in levels.
double worst_level(const std::vector<Colour>& picture,
                   const std::function<std::array<double, 3>(int, int)>& exact) {
    double worst = 0;
    for (int j = 0; j < Room::kHeight; ++j)
        for (int i = 0; i < Room::kWidth; ++i) {
            const std::array<double, 3> colour = exact(i, j);
            const Colour& c = picture[static_cast<std::size_t>(j * Room::kWidth + i)];
            for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, std::fabs(c[k] - colour[k]));
        }
    return worst;
}

/// In float: texture units may round mixtures of bytes to bytes.
vtkSmartPointer<vtkTexture> smooth_texture(int width, int height) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_FLOAT, 3);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
            for (int k = 0; k < 3; ++k)
                image->SetScalarComponentFromDouble(i, height - 1 - j, 0, k,
                                                    smooth_colour(i, j)[static_cast<std::size_t>(k)] / 255);
    const auto texture = vtkSmartPointer<vtkTexture>::New();
    texture->SetInputData(image);
    texture->SetColorModeToDirectScalars();
    texture->InterpolateOn();
    return texture;
}

TEST(VtkProjectionShader, AgreesWithTheFilter) {
    const Chart chart(Projection::equirectangular, 1024, 512);
    const auto projector = projector_of(chart, smooth_texture(chart.width(), chart.height()));
    const Projector core = core_of(chart, *projector);
    Room room;
    room.look({20, 10, 15});
    const auto exact = [&](int i, int j) {
        const Point<long double> truth = point_of(chart, room.ray(core, i, j), 0);
        return interpolated(chart, {static_cast<double>(truth.x), static_cast<double>(truth.y)});
    };
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    shader->AddTo(room.actor);
    EXPECT_LE(worst_level(room.picture(), exact), 0.6);
    shader->RemoveFrom(room.actor);

    vtkNew<vtkAnamorphPanoramaProjection> filter;
    filter->SetInputConnection(room.mapper->GetInputConnection(0, 0));
    filter->SetPanoramaWidth(chart.width());
    filter->SetPanoramaHeight(chart.height());
    filter->SetPosition(projector->GetPosition());
    filter->SetDirection(projector->GetDirection());
    filter->SetViewUp(projector->GetViewUp());
    filter->SetTolerance(0.06);
    filter->OcclusionOff();
    room.mapper->SetInputConnection(filter->GetOutputPort());
    room.actor->SetTexture(projector->GetPanorama());
    // Texture coordinates at poles and on triangles' borders are less exact; one pixel in a thousand may be.
    int off = 0;
    const std::vector<Colour> picture = room.picture();
    worst_level(picture, [&](int i, int j) {
        const auto colour = exact(i, j);
        const Colour& c = picture[static_cast<std::size_t>(j * Room::kWidth + i)];
        for (std::size_t k = 0; k < 3; ++k) off += std::fabs(c[k] - colour[k]) > 0.6;
        return colour;
    });
    EXPECT_LE(off, Room::kWidth * Room::kHeight / 1000);
}

TEST(VtkProjectionShader, SharesAreThoseOfTheCore) {
    const Chart chart(Projection::equirectangular, 1024, 512),
        narrow(Projection::cylindrical, 1024, 400, 300);
    const auto texture = smooth_texture(chart.width(), chart.height());
    const auto other_texture = texture_of(1024, 400, [](int i, int) {
        return Colour{static_cast<unsigned char>(i / 8), 20, 200};
    });
    other_texture->InterpolateOn();
    const auto first = projector_of(chart, texture),
               second = projector_of(narrow, other_texture, {0.9, -0.5, 0.6});
    second->SetFade(100);
    const Projector cores[] = {core_of(chart, *first), core_of(narrow, *second)};
    Room room;
    room.look({20, 10, 15});
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(first);
    shader->AddProjector(second);
    shader->AddTo(room.actor);
    const auto exact = [&](int i, int j) {
        std::array<double, 3> sum{};
        double all = 0;
        for (int k = 0; k < 2; ++k) {
            Point<double> at{};
            const Room::Wall wall = room.wall(i, j);
            const double share = share_of(cores[k], wall.point, wall.normal, k == 0 ? 0 : 100, at);
            if (!(share > 0)) continue;
            const auto colour = k == 0
                                    ? interpolated(chart, at)
                                    : std::array<double, 3>{std::clamp(at.x - 0.5, 0.0, 1023.0) / 8, 20, 200};
            for (std::size_t c = 0; c < 3; ++c) sum[c] += share * colour[c];
            all += share;
        }
        for (double& c : sum) c /= all;
        return sum;
    };
    // The second picture has steps of one level.
    EXPECT_LE(worst_level(room.picture(), exact), 1.6);
    shader->RemoveProjector(second);
    EXPECT_GT(worst_level(room.picture(), exact), 20);
}

/// A room's picture of places, thrown with its middle at the origin.
std::vector<Colour> picture_of_places(const std::function<void(Room&)>& change) {
    const Chart chart = chart_of(Projection::equirectangular);
    const auto texture = texture_of(chart.width(), chart.height(), colour_of_place);
    texture->InterpolateOff();
    Room room;
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector_of(chart, texture));
    shader->AddTo(room.actor);
    change(room);
    return room.picture();
}

TEST(VtkProjectionShader, ServesEveryWayThatVtkDraws) {
    const auto plain = picture_of_places([](Room&) {});
    constexpr int kFew = Room::kWidth * Room::kHeight / 200;
    // Nearest texels change here and there by rounding.
    EXPECT_LE(differences(plain, picture_of_places([](Room& room) {
                              room.cube->SetCenter(-1, -2, 3);
                              room.actor->SetPosition(1, 2, -3);
                          })),
              kFew);
    // By a geometry shader, which darkens the edges.
    const auto outside = [](bool edges) {
        return picture_of_places([=](Room& room) {
            room.look({0, 0, 0}, {1, 1, 5});
            room.actor->GetProperty()->SetEdgeVisibility(edges);
        });
    };
    const auto with = outside(true), without = outside(false);
    int same = 0, other = 0;
    for (std::size_t i = 0; i < with.size(); ++i)
        if (without[i] != kNoPlace) {
            const bool near =
                std::abs(with[i][0] - without[i][0]) <= 3 && std::abs(with[i][1] - without[i][1]) <= 3;
            ++(near ? same : other);
        }
    EXPECT_GT(same, 10 * other);
    EXPECT_GT(same, 3000);
    EXPECT_LE(differences(plain, picture_of_places([](Room& room) {
                              vtkNew<CompositeMapper> mapper;
                              vtkNew<vtkMultiBlockDataSet> blocks;
                              room.cube->Update();
                              blocks->SetBlock(0, room.cube->GetOutput());
                              mapper->SetInputDataObject(blocks);
                              room.actor->SetMapper(mapper);
                          })),
              kFew);
    EXPECT_LE(differences(plain, picture_of_places([](Room& room) {
                              room.actor->GetProperty()->LightingOn();
                              room.actor->GetProperty()->SetAmbient(1);
                              room.actor->GetProperty()->SetDiffuse(0);
                          })),
              kFew);
}

TEST(VtkProjectionShader, ParallelCamerasAreServed) {
    const Chart chart = chart_of(Projection::equirectangular);
    const auto texture = texture_of(chart.width(), chart.height(), colour_of_place);
    texture->InterpolateOff();
    const auto projector = projector_of(chart, texture);
    const Projector core = core_of(chart, *projector);
    Room room;
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    shader->AddTo(room.actor);
    vtkCamera* camera = room.renderer->GetActiveCamera();
    camera->SetPosition(0, 0, 0);
    camera->SetFocalPoint(0, 0, -1);
    camera->SetViewUp(0, 1, 0);
    camera->ParallelProjectionOn();
    camera->SetParallelScale(1.2);
    const std::vector<Colour> picture = room.picture();
    long double worst = 0;
    for (int j = 0; j < Room::kHeight; ++j)
        for (int i = 0; i < Room::kWidth; ++i) {
            const double scale = 2.4 / Room::kHeight;
            const glm::dvec3 point((i + 0.5 - Room::kWidth / 2) * scale,
                                   -(j + 0.5 - Room::kHeight / 2) * scale, -Room::kHalf);
            const glm::dvec3 ray = core.ray(point);
            worst = std::max(
                worst,
                least_distance(chart, {ray.x, ray.y, ray.z},
                               place_of_colour(picture[static_cast<std::size_t>(j * Room::kWidth + i)])));
        }
    EXPECT_LE(worst, 0.6L);
}

TEST(VtkProjectionShader, LensesOfEveryModelAreServed) {
    for (const auto& [projection, lens] :
         {std::pair(Projection::rectilinear, "brown:k1=-0.1,k2=0.02,p1=0.001,p2=-0.002,s1=0.001,s4=-0.0005"),
          std::pair(Projection::rectilinear, "ptlens:a=0.01,b=-0.03,c=0.01"),
          std::pair(Projection::rectilinear, "3de4:k1=0.05,k2=-0.01"),
          std::pair(Projection::fisheye, "kb4:k1=0.02,k2=-0.004"),
          std::pair(Projection::fisheye, "3de4:k1=0.05,k2=-0.01")}) {
        SCOPED_TRACE(lens);
        const Chart chart(projection, 1600, 1200, 110, anamorph::PixelSpacing::edges, "", 1,
                          anamorph::LensModel::parse(lens));
        const auto texture = texture_of(chart.width(), chart.height(), colour_of_place);
        texture->InterpolateOff();
        const auto projector = projector_of(chart, texture);
        projector->SetLens(lens);
        Room room;
        room.look({25, 10, 0});
        vtkNew<vtkAnamorphProjectionShader> shader;
        shader->AddProjector(projector);
        shader->HideUnpaintedOn();
        shader->AddTo(room.actor);
        Findings findings;
        compare(room, room.picture(), core_of(chart, *projector), findings);
        EXPECT_LE(findings.worst, 0.6L);
        EXPECT_EQ(findings.wrong, 0);
        EXPECT_GT(findings.painted, 10000);
    }
}

/// The corners of the triangles of a mesh.
std::vector<glm::dvec3> corners_of(vtkPolyData* mesh) {
    std::vector<glm::dvec3> corners;
    for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell) {
        vtkPoints* points = mesh->GetCell(cell)->GetPoints();
        for (vtkIdType i = 2; i < points->GetNumberOfPoints(); ++i)
            for (const vtkIdType corner : {vtkIdType{0}, i - 1, i}) {
                const double* p = points->GetPoint(corner);
                corners.emplace_back(p[0], p[1], p[2]);
            }
    }
    return corners;
}

TEST(VtkProjectionShader, HiddenPointsAreThoseOfTheCore) {
    const Chart chart(Projection::equirectangular, 256, 128);
    const auto projector = projector_of(chart, smooth_texture(256, 128));
    const Projector core = core_of(chart, *projector);
    // The room hides itself, and a ball and a box in it hide parts of it; they are not drawn.
    Room room;
    vtkNew<vtkSphereSource> ball;
    ball->SetCenter(0.6, 0.1, -0.9);
    ball->SetRadius(0.4);
    vtkNew<vtkCubeSource> box;
    box->SetCenter(-1.2, -0.6, 1.1);
    vtkNew<vtkAppendPolyData> all;
    for (vtkAlgorithm* source : std::initializer_list<vtkAlgorithm*>{room.cube, ball, box})
        all->AddInputConnection(source->GetOutputPort());
    all->Update();
    const anamorph::Occluders truth(corners_of(all->GetOutput()), core.pose().position);
    projector->SetOccluderConnection(all->GetOutputPort());
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    shader->HideUnpaintedOn();
    shader->AddTo(room.actor);
    int hidden = 0, wrong = 0, border = 0;
    for (const double yaw : {20.0, 140.0, 260.0}) {
        room.look({yaw, -10, 5});
        const std::vector<Colour> picture = room.picture();
        std::vector<bool> hides;
        for (int j = 0; j < Room::kHeight; ++j)
            for (int i = 0; i < Room::kWidth; ++i) hides.push_back(truth.hides(room.wall(i, j).point));
        const auto at = [&](int i, int j) { return static_cast<std::size_t>(j * Room::kWidth + i); };
        for (int j = 1; j + 1 < Room::kHeight; ++j)
            for (int i = 1; i + 1 < Room::kWidth; ++i) {
                const bool here = hides[at(i, j)];
                hidden += here;
                const bool inner = hides[at(i - 1, j)] == here && hides[at(i + 1, j)] == here &&
                                   hides[at(i, j - 1)] == here && hides[at(i, j + 1)] == here;
                border += !inner;
                wrong += inner && (picture[at(i, j)] == kNoPlace) != here;
            }
    }
    EXPECT_GT(hidden, 5000);
    EXPECT_LT(border, 3000);
    EXPECT_EQ(wrong, 0);
    // Moved occluders, and none.
    room.look({20, -10, 5});
    const auto before = room.picture();
    ball->SetCenter(0.6, 0.6, -0.2);
    EXPECT_GT(differences(room.picture(), before), 500);
    projector->SetOccluderConnection(nullptr);
    const auto picture = room.picture();
    EXPECT_EQ(std::count(picture.begin(), picture.end(), kNoPlace), 0);
}

TEST(VtkProjectionShader, TheMapOfOccludersIsDrawnWhenItChangesAndShared) {
    const auto projector =
        projector_of(Chart(Projection::equirectangular, 256, 128), smooth_texture(256, 128));
    Room room;
    room.look({20, -10, 5});
    vtkNew<vtkSphereSource> ball;
    ball->SetCenter(0.6, 0.1, -0.9);
    ball->SetRadius(0.4);
    vtkNew<vtkActor> other;
    other->SetMapper(room.mapper);
    room.renderer->AddActor(other);
    projector->SetOccluderConnection(ball->GetOutputPort());
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    shader->AddTo(room.actor);
    shader->AddTo(other);
    room.picture();
    EXPECT_EQ(shader->GetNumberOfShadowDraws(room.actor), 1);
    room.look({60, 0, 0});
    room.picture();
    projector->SetOrientation(70, -20, 5);
    projector->SetFade(2);
    room.picture();
    EXPECT_EQ(shader->GetNumberOfShadowDraws(room.actor), 1) << "all of them once";
    EXPECT_EQ(shader->GetNumberOfShadowDraws(other), 1);
    ball->SetRadius(0.5);
    room.picture();
    projector->SetPosition(0.1, 0.1, 0.1);
    room.picture();
    projector->SetShadowSize(64);
    room.picture();
    EXPECT_EQ(shader->GetNumberOfShadowDraws(other), 4);
    projector->SetOccluderConnection(nullptr);
    room.picture();
    EXPECT_EQ(shader->GetNumberOfShadowDraws(other), 0);
    EXPECT_EQ(shader->GetNumberOfShadowDraws(nullptr), 0);
}

TEST(VtkProjectionShader, TheLargestMapOfOccludersIsOne) {
    const auto projector =
        projector_of(Chart(Projection::equirectangular, 256, 128), smooth_texture(256, 128));
    Room room;
    room.look({20, -10, 5});
    vtkNew<vtkSphereSource> ball;
    ball->SetCenter(0.6, 0.1, -0.9);
    ball->SetRadius(0.4);
    projector->SetOccluderConnection(ball->GetOutputPort());
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    shader->HideUnpaintedOn();
    shader->AddTo(room.actor);
    projector->SetShadowSize(512);
    const auto coarse = room.picture();
    projector->SetShadowSize(4096);
    const auto fine = room.picture();
    const auto hidden = std::count(fine.begin(), fine.end(), kNoPlace);
    EXPECT_GT(hidden, 500);
    EXPECT_NEAR(static_cast<double>(std::count(coarse.begin(), coarse.end(), kNoPlace)),
                static_cast<double>(hidden), 0.1 * static_cast<double>(hidden));
}

TEST(VtkProjectionShader, PicturesHaveAnyChannels) {
    for (const int channels : {1, 2, 3, 4}) {
        SCOPED_TRACE(channels);
        vtkNew<vtkImageData> image;
        image->SetDimensions(8, 4, 1);
        image->AllocateScalars(VTK_UNSIGNED_CHAR, channels);
        for (vtkIdType i = 0; i < 32; ++i)
            for (int c = 0; c < channels; ++c)
                image->GetPointData()->GetScalars()->SetComponent(
                    i, c, channels % 2 == 0 && c == channels - 1 ? 128 : 50 + 60 * c);
        vtkNew<vtkTexture> texture;
        texture->SetInputData(image);
        Room room;
        room.actor->ForceTranslucentOn();
        vtkNew<vtkAnamorphProjectionShader> shader;
        shader->AddProjector(projector_of(Chart(Projection::equirectangular, 8, 4), texture));
        shader->AddTo(room.actor);
        // Half of it on a white ground where it is transparent.
        const double alpha = channels % 2 == 0 ? 128. / 255 : 1;
        const Colour shown = room.picture()[Room::kWidth * Room::kHeight / 2];
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(shown[static_cast<std::size_t>(c)],
                        alpha * (channels < 3 ? 50 : 50 + 60 * c) + (1 - alpha) * 255, 2);
    }
}

/// A wall, triangles without an area beside it, and, where VTK can draw with them, some without a place or an end.
vtkSmartPointer<vtkPolyData> hard_triangles(bool endless) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const glm::dvec3 corners[] = {{-9, -9, -2}, {9, -9, -2},   {0, 15, -2}, {0, 0, -1},     {0, 0, -1},
                                  {0, 0, -1},   {0, 0, -1},    {0, 1, -1},  {0, 2, -1},     {1, 0, -1},
                                  {1, 1, -1},   {kNan, 0, -1}, {0, 0, 0},   {1e30, 0, 0.1}, {0, 1e30, 0.1}};
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    const auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points);
    mesh->AllocateEstimate(5, 3);
    for (const glm::dvec3& p : corners)
        if (endless || points->GetNumberOfPoints() < 9) points->InsertNextPoint(p.x, p.y, p.z);
    for (vtkIdType i = 0; i < (endless ? 15 : 9); i += 3) {
        const vtkIdType ids[] = {i, i + 1, i + 2};
        mesh->InsertNextCell(VTK_TRIANGLE, 3, ids);
    }
    return mesh;
}

TEST(VtkProjectionShader, HardTrianglesHarmNothing) {
    // On the axis of a cylinder and at the projector there is no direction: nothing is painted, and nothing else changes.
    const Chart chart(Projection::cylindrical, 512, 128);
    const auto texture = texture_of(chart.width(), chart.height(), [](int, int) {
        return Colour{9, 99, 199};
    });
    const auto projector = projector_of(chart, texture, {0, 0, 0});
    projector->SetOrientation(0, 90, 0);
    projector->SetOccluderData(hard_triangles(true));
    for (const int mode : {0, 1, 2, 3}) {
        projector->SetShadows(mode % 2);
        Room room;
        room.look({0, 0, 0}, {0, 0, 0});
        room.mapper->SetInputData(hard_triangles(false));
        vtkNew<vtkAnamorphProjectionShader> shader;
        shader->AddProjector(projector);
        shader->SetMode(mode);
        shader->HideUnpaintedOn();
        shader->AddTo(room.actor);
        const std::vector<Colour> picture = room.picture();
        int painted = 0;
        for (const Colour& c : picture)
            painted += std::abs(c[0] - 9) <= 2 && std::abs(c[1] - 99) <= 2 && std::abs(c[2] - 199) <= 2;
        // The axis meets the wall in the middle of the view.
        EXPECT_EQ(picture[static_cast<std::size_t>(Room::kHeight / 2 * Room::kWidth + Room::kWidth / 2)],
                  kNoPlace);
        EXPECT_GT(painted, 1000) << mode;
        EXPECT_EQ(painted + std::count(picture.begin(), picture.end(), kNoPlace),
                  Room::kWidth * Room::kHeight);
        room.mapper->SetInputData(vtkSmartPointer<vtkPolyData>::New());
        const auto empty = room.picture();
        EXPECT_EQ(std::count(empty.begin(), empty.end(), kNoPlace), Room::kWidth * Room::kHeight);
    }
}

/// VTK's errors of an object.
class Errors {
  public:
    explicit Errors(vtkObject* object, unsigned long event = vtkCommand::ErrorEvent) {
        m_command->SetCallback([](vtkObject*, unsigned long, void* to, void* text) {
            static_cast<std::vector<std::string>*>(to)->emplace_back(static_cast<char*>(text));
        });
        m_command->SetClientData(&texts);
        object->AddObserver(event, m_command);
    }
    std::vector<std::string> texts;

  private:
    vtkNew<vtkCallbackCommand> m_command;
};

TEST(VtkProjectionShader, BadValuesAreSaidOnceAndPaintNothing) {
    using testing::ElementsAre;
    using testing::HasSubstr;
    const Chart chart(Projection::cubemap, 64, 384);
    const auto projector = projector_of(chart, nullptr);
    vtkNew<vtkAnamorphProjectionShader> shader;
    const Errors errors(shader);
    Room room;
    const auto own = room.picture();
    shader->AddProjector(projector);
    shader->AddTo(room.actor);
    EXPECT_EQ(room.picture(), own);
    EXPECT_EQ(room.picture(), own);
    EXPECT_THAT(errors.texts, ElementsAre(HasSubstr("must be a texture with an image as its input")));
    projector->SetPanorama(smooth_texture(100, 50));
    EXPECT_EQ(room.picture(), own);
    EXPECT_THAT(errors.texts.back(), HasSubstr("needs square faces"));
    projector->SetPanorama(smooth_texture(64, 384));
    EXPECT_NE(room.picture(), own);
    EXPECT_EQ(errors.texts.size(), 2);
    projector->SetViewUp(projector->GetDirection());
    room.picture();
    EXPECT_THAT(errors.texts.back(), HasSubstr("must not be along the direction"));
    projector->SetOrientation(0, 0, 0);
    projector->SetPosition(std::nan(""), 0, 0);
    room.picture();
    EXPECT_THAT(errors.texts.back(), HasSubstr("must be finite"));
    projector->SetPosition(0, 0, 0);
    shader->SetModeToResidual();
    EXPECT_EQ(room.picture(), own);
    EXPECT_THAT(errors.texts.back(), HasSubstr("must be direct or multipass"));
    shader->SetModeToMultipass();
    shader->SetVerticalReach(-1);
    EXPECT_EQ(room.picture(), own);
    EXPECT_THAT(errors.texts.back(), HasSubstr("must be a number above 0"));
    EXPECT_EQ(errors.texts.size(), 6);
}

/// The bump unit of Kim 2003, 4.4, on a full equirectangular panorama, written out in long double: planes across level directions, linear
/// coordinates by the derivatives in the middle, and what is left in a table of signed numbers of `bits` bits behind the point.
class WrittenOutUnit {
  public:
    WrittenOutUnit(int width, int planes, long double reach, int size, int bits, bool scaled, int weight_bits)
        : m_width(width),
          m_planes(planes),
          m_reach(reach),
          m_size(size),
          m_weights(std::ldexp(1.0L, weight_bits)) {
        const long double unit = std::ldexp(1.0L, bits);
        std::vector<long double> left[2];
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i) {
                const long double x = reach * node(i), y = node(j);
                left[0].push_back((std::atan(x) - x) / (2 * kPi));
                left[1].push_back((std::atan(y / std::sqrt(1 + x * x)) - y) / kPi);
            }
        for (std::size_t c = 0; c < 2; ++c) {
            long double most = 0;
            for (const long double r : left[c]) most = std::max(most, std::fabs(r));
            const long double scale = scaled ? most / (1 - 1 / unit) : 1;
            for (const long double r : left[c])
                m_table[c].push_back(std::clamp(std::nearbyint(r / scale * unit), -unit, unit - 1) / unit *
                                     scale);
        }
    }

    /// The texel that a ray finds; `on_tie`: is a weight so near a tie that float may round it either way?
    std::array<long double, 2> texel(const Ray<long double>& r, bool& on_tie) const {
        int best = 0;
        long double most = -HUGE_VALL;
        for (int g = 0; g < m_planes; ++g) {
            const long double a = 2 * kPi * g / m_planes, along = r.x * std::sin(a) + r.z * std::cos(a);
            if (along > most) most = along, best = g;
        }
        const long double a = 2 * kPi * best / m_planes, height = m_width / 2;
        const long double x = (r.x * std::cos(a) - r.z * std::sin(a)) / most, y = r.y / most;
        on_tie = false;
        if (!(most > 0) || std::fabs(x) > m_reach || std::fabs(y) > 1)
            return {m_width * (0.5L + std::atan2(r.x, r.z) / (2 * kPi)),
                    height * (0.5L + std::atan2(r.y, std::hypot(r.x, r.z)) / kPi)};
        return {m_width * (0.5L + (a + x) / (2 * kPi) + read(0, x, y, on_tie)),
                height * (0.5L + y / kPi + read(1, x, y, on_tie))};
    }

  private:
    static constexpr long double kPi = std::numbers::pi_v<long double>;

    long double node(int i) const { return 2.0L * i / (m_size - 1) - 1; }
    long double read(std::size_t c, long double x, long double y, bool& on_tie) const {
        const auto split = [&](long double at, int& first) {
            const long double place = (at + 1) / 2 * (m_size - 1);
            first = std::min(static_cast<int>(place), m_size - 2);
            const long double weight = (place - first) * m_weights, rounded = std::nearbyint(weight);
            on_tie = on_tie || std::fabs(std::fabs(weight - rounded) - 0.5L) < 2e-6L * m_size * m_weights;
            return rounded / m_weights;
        };
        int i = 0, j = 0;
        const long double s = split(x / m_reach, i), t = split(y, j);
        const auto at = [&](int a, int b) {
            return m_table[c][static_cast<std::size_t>((j + b) * m_size + i + a)];
        };
        return (1 - t) * ((1 - s) * at(0, 0) + s * at(1, 0)) + t * ((1 - s) * at(0, 1) + s * at(1, 1));
    }

    int m_width, m_planes;
    long double m_reach;
    int m_size;
    long double m_weights;
    std::vector<long double> m_table[2];
};

TEST(VtkProjectionShader, BumpMapsOf2003AreReadAsWrittenOut) {
    constexpr int kPanorama = 2048;
    const Chart chart(Projection::equirectangular, kPanorama, kPanorama / 2);
    const auto texture = texture_of(chart.width(), chart.height(), colour_of_place);
    texture->InterpolateOff();
    struct Case {
        const char* keys;
        int planes, size, bits;
        bool scaled;
        int weight_bits;
    };
    double bound_of_8 = 0, bound_of_16 = 0;
    for (const Case& c :
         {Case{"planes=4,size=64,texel=V8U8", 4, 64, 7, true, 8},
          Case{"planes=4,card=geforce4", 4, 256, 7, true, 8},
          Case{"planes=4,size=64,texel=V16U16,card=radeon8500", 4, 64, 15, true, 8},
          Case{"planes=1,size=128,texel=V16U16,scaled=false", 1, 128, 15, false, 8},
          Case{"planes=2,size=32,texel=V8U8,weight_bits=5", 2, 32, 7, true, 5},
          Case{"planes=1,size=16,texel=V16U16,weight_bits=2,x_max=1,y_max=1", 1, 16, 15, true, 2}}) {
        SCOPED_TRACE(c.keys);
        Room room;
        const auto projector = projector_of(chart, texture, {-0.3, 0.2, 0.1});
        vtkNew<vtkAnamorphProjectionShader> shader;
        const Errors errors(shader);
        shader->AddProjector(projector);
        shader->HideUnpaintedOn();
        shader->SetModeToResidual();
        shader->SetMachine((std::string("embm-2003:projecting=pixel,") + c.keys).c_str());
        shader->AddTo(room.actor);
        const long double reach = c.planes > 2 ? 1 + 0x1p-10L : 1;
        const WrittenOutUnit unit(kPanorama, c.planes, reach, c.size, c.bits, c.scaled, c.weight_bits);
        const Projector core = core_of(chart, *projector);
        long double worst = 0, from_formula = 0;
        int compared = 0, ties = 0;
        for (const double yaw : {20.0, 140.0, 260.0}) {
            room.look({yaw, yaw / 4 - 40, 15});
            const auto picture = room.picture();
            for (int j = 0; j < Room::kHeight; ++j)
                for (int i = 0; i < Room::kWidth; ++i) {
                    const Colour& colour = picture[static_cast<std::size_t>(j * Room::kWidth + i)];
                    const Ray<long double> ray = room.ray(core, i, j);
                    bool on_tie = false;
                    const auto model = unit.texel(ray, on_tie);
                    if (colour == kNoPlace || model[1] < 1 || model[1] > chart.height() - 1) continue;
                    ties += on_tie;
                    ++compared;
                    const auto place = place_of_colour(colour);
                    from_formula = std::max(from_formula, least_distance(chart, ray, place));
                    if (on_tie) continue;
                    const long double across =
                        std::fabs(std::remainder(place[0] + 0.5L - model[0], 1.0L * kPanorama));
                    worst = std::max({worst, across, std::fabs(place[1] + 0.5L - model[1])});
                }
        }
        EXPECT_THAT(errors.texts, testing::IsEmpty());
        EXPECT_GT(compared, 50000);
        EXPECT_LT(ties, compared / 2);
        // Half a texel to its border, and the rounding of float.
        EXPECT_LE(worst, 0.5L + 0.002L);
        const double bound = shader->GetResidualBound(room.actor);
        EXPECT_LE(from_formula, 0.5L + bound + 0.01L);
        EXPECT_GT(from_formula, 0.5L + 0.25L * bound) << "the bound is no more than four times what is off";
        if (c.size == 64) (c.bits == 7 ? bound_of_8 : bound_of_16) = bound;
    }
    EXPECT_GT(bound_of_8, 3 * bound_of_16);
}

TEST(VtkProjectionShader, MachinesThatCannotAreRefused) {
    using testing::HasSubstr;
    const auto projector = projector_of(Chart(Projection::equirectangular, 100, 50), smooth_texture(100, 50));
    vtkNew<vtkAnamorphProjectionShader> shader;
    const Errors errors(shader);
    Room room;
    const auto own = room.picture();
    shader->AddProjector(projector);
    shader->SetModeToResidual();
    shader->AddTo(room.actor);
    for (const auto& [text, said] :
         {std::pair("embm-2003", "machine: projecting=vertex: must be pixel"),
          std::pair("embm-2003:card=geforce3", "machine: projecting=vertex: must be pixel"),
          std::pair("embm-2003:card=geforce3,projecting=pixel", "must be vertex with card=geforce3"),
          std::pair("embm-2003:card=radeon,projecting=pixel", "must be vertex with card=radeon"),
          std::pair("embm-2003:card=geforce4,projecting=pixel,texel=V16U16",
                    "must be V8U8 with card=geforce4"),
          std::pair("embm-2003:projecting=pixel,size=1", "machine: size=1: must be at least 2"),
          std::pair("embm-2003:projecting=pixel,edge=border", "machine: edge=border: must be clamp"),
          std::pair("embm-2003:projecting=pixel,arithmetic=float24",
                    "machine: arithmetic=float24: must be float32"),
          std::pair("embm-2003:projecting=pixel,address_bits=4", "machine: address_bits=4: must be 8"),
          std::pair("embm-2003:projecting=pixel,texture_side=64", "must be at most 64 either way"),
          std::pair("embm-2003:projecting=pixel,y_max=1000", "must have a projection plane"),
          std::pair("embm-2003:planes=17", "planes=17"), std::pair("oka-1987", "machine"),
          std::pair("embm-2003:projecting=pixel,texel=V4U4", "texel")}) {
        SCOPED_TRACE(text);
        shader->SetMachine(text);
        EXPECT_EQ(room.picture(), own);
        ASSERT_FALSE(errors.texts.empty());
        EXPECT_THAT(errors.texts.back(), HasSubstr(said));
        EXPECT_LE(errors.texts.back().size(), 700u);
    }
    // Before tables are made, which would take minutes.
    shader->SetMachine("embm-2003:projecting=pixel,size=4096,planes=16");
    EXPECT_EQ(room.picture(), own);
    EXPECT_THAT(errors.texts.back(), HasSubstr("machine: size=4096: times the number of directions must be"));
    shader->SetMachine(nullptr);
    shader->SetTableSize(4096);
    shader->SetNumberOfDirections(32);
    EXPECT_EQ(room.picture(), own);
    EXPECT_THAT(errors.texts.back(), HasSubstr("TableSize=4096: times the number of directions must be"));
    shader->SetTableSize(256);
    shader->SetNumberOfDirections(4);
    const auto count = errors.texts.size();
    shader->SetMachine("embm-2003:projecting=pixel");
    const vtkMTimeType set = shader->GetMTime();
    shader->SetMachine("embm-2003:projecting=pixel");
    EXPECT_EQ(shader->GetMTime(), set);
    EXPECT_STREQ(shader->GetMachine(), "embm-2003:projecting=pixel");
    EXPECT_NE(room.picture(), own);
    EXPECT_EQ(errors.texts.size(), count);
    // It is of mode residual alone.
    const Errors warnings(shader, vtkCommand::WarningEvent);
    shader->SetMachine("nothing");
    for (const int mode : {vtkAnamorphProjectionShader::DIRECT, vtkAnamorphProjectionShader::MULTIPASS}) {
        const auto told = warnings.texts.size();
        shader->SetMode(mode);
        EXPECT_NE(room.picture(), own);
        EXPECT_EQ(room.picture(), room.picture());
        EXPECT_EQ(errors.texts.size(), count);
        ASSERT_EQ(warnings.texts.size(), told + 1);
        EXPECT_THAT(warnings.texts.back(), HasSubstr("Machine=nothing: is of mode residual alone"));
    }
    shader->SetMachine(nullptr);
    EXPECT_STREQ(shader->GetMachine(), "");
}

TEST(VtkProjectionShader, MachinesRefuseTheSourcesThatPanoRefuses) {
    using testing::HasSubstr;
    for (const Projection source :
         {Projection::fisheye, Projection::pannini, Projection::stereographic, Projection::cylindrical}) {
        const Chart chart(source, 100, 50, 90);
        SCOPED_TRACE(std::string(name_of(source)));
        const auto projector = projector_of(chart, smooth_texture(100, 50));
        Room room;
        const auto own = room.picture();
        vtkNew<vtkAnamorphProjectionShader> shader;
        const Errors errors(shader);
        shader->AddProjector(projector);
        shader->SetModeToResidual();
        shader->SetMachine("embm-2003:projecting=pixel,planes=4,card=geforce4");
        shader->AddTo(room.actor);
        const auto seen = room.picture();
        if (source == Projection::cylindrical) {
            EXPECT_TRUE(errors.texts.empty());
            EXPECT_NE(seen, own);
            continue;
        }
        EXPECT_EQ(seen, own);
        ASSERT_FALSE(errors.texts.empty());
        EXPECT_THAT(errors.texts.back(),
                    HasSubstr("machine: embm-2003 draws rectilinear views, without a lens, of cylindrical, "
                              "equirectangular and mercator panoramas: the source's projection is " +
                              std::string(name_of(source))));
    }
}

TEST(VtkProjectionShader, AProjectorThatWasNeverTurnedPaintsNothing) {
    for (const int mode : {0, 1, 2}) {
        const auto projector =
            projector_of(Chart(Projection::equirectangular, 256, 128), smooth_texture(256, 128));
        projector->SetViewUp(projector->GetDirection());
        vtkNew<vtkSphereSource> ball;
        ball->SetCenter(0.6, 0.1, -1.2);
        projector->SetOccluderConnection(ball->GetOutputPort());
        Room room;
        const auto own = room.picture();
        vtkNew<vtkAnamorphProjectionShader> shader;
        const Errors errors(shader);
        shader->AddProjector(projector);
        shader->SetMode(mode);
        shader->AddTo(room.actor);
        EXPECT_EQ(differences(room.picture(), own), 0);
        EXPECT_THAT(errors.texts,
                    testing::ElementsAre(testing::HasSubstr("must not be along the direction")));
        projector->SetOrientation(0, 0, 0);
        EXPECT_GT(differences(room.picture(), own), 10000);
    }
}

TEST(VtkProjectionShader, WindowsComeAndGo) {
    const Chart chart(Projection::equirectangular, 256, 128);
    const auto projector = projector_of(chart, smooth_texture(chart.width(), chart.height()));
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    for (const int mode : {0, 1, 2}) {
        shader->SetMode(mode);
        Room first, second;
        shader->AddTo(first.actor);
        const auto picture = first.picture();
        first.window->Finalize();
        EXPECT_EQ(first.picture(), picture);
        shader->AddTo(second.actor);
        EXPECT_LE(differences(second.picture(), picture), 10);
        shader->RemoveFrom(first.actor);
        EXPECT_NE(first.picture(), picture);
    }
}

TEST(VtkProjectionShader, NothingStaysOfIt) {
    vtkWeakPointer<vtkObject> left[4];
    {
        const auto projector =
            projector_of(Chart(Projection::equirectangular, 256, 128), smooth_texture(256, 128));
        vtkNew<vtkSphereSource> ball;
        ball->SetCenter(0.6, 0.1, -1.2);
        projector->SetOccluderConnection(ball->GetOutputPort());
        vtkNew<vtkAnamorphProjectionShader> shader;
        shader->AddProjector(projector);
        shader->SetModeToMultipass();
        Room room;
        shader->AddTo(room.actor);
        room.picture();
        left[0] = projector;
        left[1] = shader;
        left[2] = projector->GetPanorama();
        left[3] = room.actor;
    }
    for (const auto& object : left) EXPECT_EQ(object, nullptr);
}

TEST(VtkPanoramaProjector, IsAsVtkClassesAre) {
    vtkNew<vtkAnamorphPanoramaProjector> projector;
    EXPECT_STREQ(projector->GetProjectionName(), "equirectangular");
    const vtkMTimeType before = projector->GetMTime();
    projector->SetProjection(0);
    projector->SetPanorama(nullptr);
    projector->SetOrientation(0, 0, 0);
    EXPECT_EQ(projector->GetMTime(), before);
    projector->SetProjectionName("fisheye");
    EXPECT_EQ(projector->GetProjection(), 3);
    EXPECT_GT(projector->GetMTime(), before);
    const Errors errors(projector);
    projector->SetProjectionName("round");
    projector->SetProjectionName(nullptr);
    EXPECT_EQ(errors.texts.size(), 2);
    EXPECT_EQ(projector->GetProjection(), 3);
    std::ostringstream text;
    projector->Print(text);
    EXPECT_THAT(text.str(), testing::HasSubstr("Projection: fisheye"));
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    const vtkMTimeType added = shader->GetMTime();
    projector->SetFade(3);
    EXPECT_GT(shader->GetMTime(), added);
    text.str("");
    shader->Print(text);
    EXPECT_THAT(text.str(), testing::HasSubstr("Mode: direct"));
}

TEST(VtkPanoramaProjector, YawGoesRightPitchUpAndRollClockwise) {
    vtkNew<vtkAnamorphPanoramaProjector> projector;
    const auto expect = [&](const glm::dvec3& direction, const glm::dvec3& up) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(projector->GetDirection()[k], direction[k], 1e-12);
            EXPECT_NEAR(projector->GetViewUp()[k], up[k], 1e-12);
        }
    };
    projector->SetOrientation(90, 0, 0);
    expect({1, 0, 0}, {0, 1, 0});
    projector->SetOrientation(0, 90, 0);
    expect({0, 1, 0}, {0, 0, 1});
    projector->SetOrientation(0, 0, 90);
    expect({0, 0, -1}, {1, 0, 0});
}

}  // namespace
