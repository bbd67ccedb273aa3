// SPDX-License-Identifier: Apache-2.0
// What a projector does not see of a room with a ball, a box and a leaning board in it, pixel by pixel, against rays in long double
// through every triangle, which share nothing with the core or OpenGL.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAppendPolyData.h>
#include <vtkCell.h>
#include <vtkPlaneSource.h>
#include <vtkPolyData.h>
#include <vtkSphereSource.h>
#include <vtkTransform.h>
#include <vtkTransformPolyDataFilter.h>
#include <vtkTriangleFilter.h>

#include <optional>

#include "thrown_scene.h"

namespace {

using Real = long double;
using Vector = std::array<Real, 3>;

Vector minus(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector along(const Vector& from, const Vector& way, Real t) {
    return {from[0] + t * way[0], from[1] + t * way[1], from[2] + t * way[2]};
}
Real dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector unit(const Vector& a) {
    const Real length = std::sqrt(dot(a, a));
    return {a[0] / length, a[1] / length, a[2] / length};
}

using Triangle = std::array<Vector, 3>;

/// Where a ray meets a triangle, in lengths of `way` (Moeller and Trumbore 1997).
std::optional<Real> meeting(const Triangle& t, const Vector& from, const Vector& way) {
    const Vector a = minus(t[1], t[0]), b = minus(t[2], t[0]), p = cross(way, b);
    const Real volume = dot(a, p);
    if (volume == 0) return {};
    const Vector to = minus(from, t[0]);
    const Real u = dot(to, p) / volume;
    if (!(u >= 0 && u <= 1)) return {};
    const Vector q = cross(to, a);
    const Real v = dot(way, q) / volume;
    if (!(v >= 0 && u + v <= 1)) return {};
    return dot(b, q) / volume;
}

/// Triangles in a ball around all of them.
struct Body {
    std::vector<Triangle> triangles;
    Vector middle{};
    Real radius = 0;

    explicit Body(vtkAlgorithm& source) {
        vtkNew<vtkTriangleFilter> cut;
        cut->SetInputConnection(source.GetOutputPort());
        cut->Update();
        vtkPolyData* mesh = cut->GetOutput();
        for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i) {
            Triangle triangle;
            for (vtkIdType k = 0; k < 3; ++k) {
                const double* p = mesh->GetCell(i)->GetPoints()->GetPoint(k);
                triangle[static_cast<std::size_t>(k)] = {p[0], p[1], p[2]};
            }
            triangles.push_back(triangle);
        }
        double centre[3];
        mesh->GetCenter(centre);
        middle = {centre[0], centre[1], centre[2]};
        radius = mesh->GetLength() / 2 * 1.001;
    }
    bool may_meet(const Vector& from, const Vector& way) const {
        const Vector off = cross(minus(middle, from), way);
        return dot(off, off) <= radius * radius * dot(way, way);
    }
};

/// A window onto the room, in which what is painted is dark, and all else white.
class Scene {
  public:
    static constexpr int kWidth = 320, kHeight = 240;
    static constexpr Real kViewAngle = 90;
    const Vector projector_at{-0.3L, 0.2L, 0.1L};

    Scene() {
        walls->SetXLength(4);
        walls->SetYLength(4);
        walls->SetZLength(4);
        ball->SetCenter(0.7, 0.1, -0.9);
        ball->SetRadius(0.5);
        ball->SetThetaResolution(24);
        ball->SetPhiResolution(16);
        box->SetCenter(-1.2, -1.5, 1.1);
        box->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        ball->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        walls->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        board->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        board->SetOrigin(-1.9, -2, -1.2);
        board->SetPoint1(-0.9, -2, -1.7);
        board->SetPoint2(-1.95, 0.2, -1.8);
        for (vtkAlgorithm* source : std::initializer_list<vtkAlgorithm*>{walls, ball, box, board}) {
            all->AddInputConnection(source->GetOutputPort());
            bodies.emplace_back(*source);
        }
        all->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        mapper->SetInputConnection(all->GetOutputPort());
        actor->SetMapper(mapper);
        actor->GetProperty()->LightingOff();
        renderer->AddActor(actor);
        renderer->SetBackground(1, 1, 1);
        window->SetMultiSamples(0);
        window->SetOffScreenRendering(1);
        window->SetSize(kWidth, kHeight);
        window->AddRenderer(renderer);
        projector->SetPanorama(texture_of(64, 32, [](int, int) { return Colour{9, 99, 199}; }));
        projector->SetPosition(static_cast<double>(projector_at[0]), static_cast<double>(projector_at[1]),
                               static_cast<double>(projector_at[2]));
        projector->SetOccluderConnection(all->GetOutputPort());
        shader->AddProjector(projector);
        shader->AddTo(actor);
    }

    void look(const Vector& eye, const Vector& at) {
        m_eye = eye;
        m_ahead = unit(minus(at, eye));
        m_right = unit(cross(m_ahead, {0, 1, 0}));
        m_up = cross(m_right, m_ahead);
        vtkCamera* camera = renderer->GetActiveCamera();
        camera->SetPosition(double(eye[0]) + m_away, double(eye[1]) + m_away, double(eye[2]) + m_away);
        camera->SetFocalPoint(double(at[0]) + m_away, double(at[1]) + m_away, double(at[2]) + m_away);
        camera->SetViewUp(0, 1, 0);
        camera->SetViewAngle(double(kViewAngle));
        camera->SetClippingRange(0.01, 20);
    }

    /// Draws the room with all that is in it, the projector too, as far away along each axis; look() follows.
    void move(double away) {
        m_away = away;
        vtkNew<vtkTransform> shift;
        shift->Translate(away, away, away);
        vtkNew<vtkTransformPolyDataFilter> moved;
        moved->SetTransform(shift);
        moved->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        moved->SetInputConnection(all->GetOutputPort());
        mapper->SetInputConnection(moved->GetOutputPort());
        projector->SetOccluderConnection(moved->GetOutputPort());
        projector->SetPosition(double(projector_at[0]) + away, double(projector_at[1]) + away,
                               double(projector_at[2]) + away);
    }

    /// What the projector paints, in rows from the bottom.
    std::vector<bool> painted() {
        window->Render();
        vtkNew<vtkUnsignedCharArray> pixels;
        window->GetPixelData(0, 0, kWidth - 1, kHeight - 1, 0, pixels);
        std::vector<bool> is;
        for (vtkIdType i = 0; i < kWidth * kHeight; ++i) is.push_back(pixels->GetValue(3 * i) < 128);
        return is;
    }

    /// What is seen at a place of the window: how far, as a multiple of way_to(), and of which body.
    struct Seen {
        Real far = HUGE_VALL;
        std::size_t body = 0;
    };
    Seen seen(Real x, Real y) const {
        Seen nearest;
        const Vector way = way_to(x, y);
        for (std::size_t k = 0; k < bodies.size(); ++k) {
            if (!bodies[k].may_meet(m_eye, way)) continue;
            for (const Triangle& triangle : bodies[k].triangles) {
                const auto t = meeting(triangle, m_eye, way);
                if (t && *t > 0 && *t < nearest.far) nearest = {*t, k};
            }
        }
        return nearest;
    }
    Vector point(Real x, Real y, Real t) const { return along(m_eye, way_to(x, y), t); }
    /// Does a triangle stand before a point, further from it than a share of its distance?
    bool hidden(const Vector& point, Real touching) const {
        const Vector way = minus(point, projector_at);
        for (const Body& body : bodies) {
            if (!body.may_meet(projector_at, way)) continue;
            for (const Triangle& triangle : body.triangles) {
                const auto t = meeting(triangle, projector_at, way);
                if (t && *t > 0 && *t < 1 - touching) return true;
            }
        }
        return false;
    }

    vtkNew<vtkCubeSource> walls, box;
    vtkNew<vtkSphereSource> ball;
    vtkNew<vtkPlaneSource> board;
    vtkNew<vtkAppendPolyData> all;
    vtkNew<vtkPolyDataMapper> mapper;
    vtkNew<vtkActor> actor;
    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkRenderWindow> window;
    vtkNew<vtkAnamorphPanoramaProjector> projector;
    vtkNew<vtkAnamorphProjectionShader> shader;
    std::vector<Body> bodies;

  private:
    Vector way_to(Real x, Real y) const {
        const Real scale = 2 * std::tan(kViewAngle / 360 * std::numbers::pi_v<Real>) / kHeight;
        return along(along(m_ahead, m_right, (x - kWidth / 2) * scale), m_up, (y - kHeight / 2) * scale);
    }

    Vector m_eye{}, m_ahead{}, m_right{}, m_up{};
    double m_away = 0;
};

/// Three views of the room.
constexpr std::array<std::array<Vector, 2>, 3> kViews{{{{{0.4L, 0.3L, 1.2L}, {0.6L, 0, -1}}},
                                                       {{{1.5L, 1.1L, -1.2L}, {-0.8L, -1.3L, 0.4L}}},
                                                       {{{1.9L, -0.6L, -1.9L}, {0.2L, 0.1L, -0.6L}}}}};

/// What rays in long double say of a pixel.
struct Truth {
    enum Says {
        lit,
        hidden,
        uncertain
    } says = lit;          ///< uncertain where another body begins within a hundredth of a pixel
    Vector point{};        ///< what is seen
    std::size_t body = 0;  ///< of which body
};

std::vector<Truth> truth_of(const Scene& scene) {
    std::vector<Scene::Seen> seen;
    for (int j = 0; j < Scene::kHeight; ++j)
        for (int i = 0; i < Scene::kWidth; ++i) seen.push_back(scene.seen(i + 0.5L, j + 0.5L));
    const auto body_at = [&](int i, int j) {
        const int x = std::clamp(i, 0, Scene::kWidth - 1), y = std::clamp(j, 0, Scene::kHeight - 1);
        return seen[static_cast<std::size_t>(y * Scene::kWidth + x)].body;
    };
    std::vector<Truth> all;
    for (int j = 0; j < Scene::kHeight; ++j)
        for (int i = 0; i < Scene::kWidth; ++i) {
            const Scene::Seen& here = seen[all.size()];
            Truth truth{Truth::lit, scene.point(i + 0.5L, j + 0.5L, here.far), here.body};
            if (scene.hidden(truth.point, 0x1p-16L)) truth.says = Truth::hidden;
            for (const auto& [di, dj] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}})
                if (body_at(i + di, j + dj) != here.body &&
                    scene.seen(i + 0.5L + 0.01L * di, j + 0.5L + 0.01L * dj).body != here.body)
                    truth.says = Truth::uncertain;
            all.push_back(truth);
        }
    return all;
}

std::vector<Truth> wrong_in(const std::vector<bool>& painted, const std::vector<Truth>& truth) {
    std::vector<Truth> wrong;
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (truth[i].says != Truth::uncertain && painted[i] != (truth[i].says == Truth::lit))
            wrong.push_back(truth[i]);
    return wrong;
}

int count(const std::vector<Truth>& truth, Truth::Says says) {
    return static_cast<int>(
        std::count_if(truth.begin(), truth.end(), [&](const Truth& t) { return t.says == says; }));
}

/// Is the truth another within the bound of the map from a point of a wall: .5 texels across and down, or 4 / size of the
/// distance before it?
bool is_within_bound(const Scene& scene, const Truth& pixel, int size) {
    const bool is_hidden = pixel.says == Truth::hidden;
    if (scene.hidden(pixel.point, 4.0L / size) != is_hidden) return true;
    const Vector ray = minus(pixel.point, scene.projector_at);
    std::size_t ahead = 0, wall = 0;
    for (const std::size_t k : {1U, 2U}) {
        if (std::fabs(ray[k]) > std::fabs(ray[ahead])) ahead = k;
        if (std::fabs(pixel.point[k]) > std::fabs(pixel.point[wall])) wall = k;
    }
    // A face is 2 wide at a distance of 1. A hair more than half a texel, for the rounding of float.
    const Real texel = 2.0L / size * std::fabs(ray[ahead]);
    for (int k = 0; k < 121; ++k) {
        Vector moved = ray;
        moved[(ahead + 1) % 3] += (k % 11 - 5) / 5.0L * 0.501L * texel;
        moved[(ahead + 2) % 3] += (k / 11 - 5) / 5.0L * 0.501L * texel;
        const Vector there = along(scene.projector_at, moved, ray[wall] / moved[wall]);
        if (scene.hidden(there, 0x1p-16L) != is_hidden || scene.hidden(there, 4.0L / size) != is_hidden)
            return true;
    }
    return false;
}

TEST(VtkProjectionShadows, ThoseOfRaysAreExactAndThoseOfTheMapWithinItsBound) {
    constexpr int kSize = 1024;
    Scene scene;
    scene.projector->SetShadowSize(kSize);
    std::size_t of_map = 0, on_walls = 0;
    for (const auto& [eye, at] : kViews) {
        scene.look(eye, at);
        const std::vector<Truth> truth = truth_of(scene);
        EXPECT_LT(count(truth, Truth::uncertain), 200);
        EXPECT_GT(count(truth, Truth::hidden), 2500);
        scene.projector->SetShadowsToMap();
        const std::vector<Truth> by_map = wrong_in(scene.painted(), truth);
        scene.projector->SetShadowsToRays();
        const std::vector<Truth> by_rays = wrong_in(scene.painted(), truth);
        std::cout << "wrong pixels: " << by_map.size() << " by the map, " << by_rays.size() << " by rays\n";
        // Pixels that a border crosses within the rounding of float: 1e-3 of some 1500 pixels of borders.
        EXPECT_LE(by_rays.size(), 3U);
        of_map += by_map.size();
        for (const Truth& pixel : by_map)
            if (pixel.body == 0) {
                ++on_walls;
                EXPECT_TRUE(is_within_bound(scene, pixel, kSize))
                    << double(pixel.point[0]) << " " << double(pixel.point[1]) << " "
                    << double(pixel.point[2]);
            }
    }
    EXPECT_GT(of_map, 20U) << "or else the map would do";
    EXPECT_GT(on_walls, 5U);
}

TEST(VtkProjectionShadows, FarFromTheOriginNoSurfaceHidesItself) {
    // The points of the mesh are floats there, 6e-5 off at 1000. A surface that hid itself would be thousands of pixels; along
    // borders and where bodies touch 80 are wrong at 1000, few at 100.
    Scene scene;
    scene.projector->SetShadowsToRays();
    scene.look(kViews[0][0], kViews[0][1]);
    const std::vector<Truth> truth = truth_of(scene);
    for (const double away : {100.0, 1000.0}) {
        scene.move(away);
        scene.look(kViews[0][0], kViews[0][1]);
        EXPECT_LE(wrong_in(scene.painted(), truth).size(), away / 8) << away;
    }
}

TEST(VtkProjectionShadows, InStillsTheyAreThoseOfRaysAndOfTheMapInInteraction) {
    Scene scene;
    scene.projector->SetShadowSize(64);
    scene.look(kViews[0][0], kViews[0][1]);
    const std::vector<bool> by_map = scene.painted();
    scene.projector->SetShadowsToRays();
    const std::vector<bool> by_rays = scene.painted();
    EXPECT_NE(by_rays, by_map);
    scene.projector->SetShadowsToRaysInStills();
    EXPECT_EQ(scene.painted(), by_rays);
    scene.window->SetDesiredUpdateRate(15);
    EXPECT_EQ(scene.painted(), by_map);
    const int draws = scene.shader->GetNumberOfShadowDraws(scene.actor);
    for (const double rate : {0.0001, 15.0, 0.002}) {
        scene.window->SetDesiredUpdateRate(rate);
        scene.painted();
    }
    EXPECT_EQ(scene.shader->GetNumberOfShadowDraws(scene.actor), draws) << "neither is made again";
    EXPECT_EQ(scene.painted(), by_rays);
    scene.ball->SetRadius(0.6);
    EXPECT_NE(scene.painted(), by_rays);
    scene.projector->SetOccluderConnection(nullptr);
    const std::vector<bool> nothing_hides = scene.painted();
    EXPECT_EQ(std::count(nothing_hides.begin(), nothing_hides.end(), false), 0);
}

}  // namespace
