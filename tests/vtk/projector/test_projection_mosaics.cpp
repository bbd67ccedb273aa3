// SPDX-License-Identifier: Apache-2.0
// Concentric mosaics thrown onto a scene, against slit cameras in long double, which share no formula with what they test: a slit stands
// where a tangent from a point touches its circle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "thrown_scene.h"

namespace {

using Real = long double;
using Vector = std::array<Real, 3>;
constexpr Real kPi = std::numbers::pi_v<Real>;

Real dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector vector_of(const double* v) {
    return {v[0], v[1], v[2]};
}
Vector scaled(const Vector& v, Real by) {
    return {v[0] * by, v[1] * by, v[2] * by};
}
Vector sum(const Vector& a, const Vector& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The plane of the circles: right, up and ahead.
struct Frame {
    Vector right, up, ahead, centre;

    explicit Frame(vtkAnamorphPanoramaProjector& projector) : centre(vector_of(projector.GetPosition())) {
        ahead = vector_of(projector.GetDirection());
        ahead = scaled(ahead, 1 / std::sqrt(dot(ahead, ahead)));
        right = cross(ahead, vector_of(projector.GetViewUp()));
        right = scaled(right, 1 / std::sqrt(dot(right, right)));
        up = cross(right, ahead);
    }
    Vector turned(const Vector& v) const { return {dot(v, right), dot(v, up), dot(v, ahead)}; }
    Vector local(const Vector& point) const { return turned(sum(point, scaled(centre, -1))); }
    Vector world(const Vector& v) const {
        return sum(sum(scaled(right, v[0]), scaled(up, v[1])), scaled(ahead, v[2]));
    }
};

struct Stack {
    int circles, width, rows;  // cylinders, of square texels
    double radius;

    Real radius_of(int circle) const { return radius * (Real(2 * circle) / (circles - 1) - 1); }
};

/// Where a circle's slits show a point: column and row, in texels of its panorama.
std::array<Real, 2> slit_of(const Stack& stack, const Vector& point, Real q) {
    const Real rho2 = point[0] * point[0] + point[2] * point[2];
    // The touching points of both tangents lie on the polar line: q^2 / rho^2 along the point, and aside.
    const Real along = q * q / rho2, aside = q * std::sqrt(rho2 - q * q) / rho2;
    // Of a positive radius the slit is to the right of where it looks.
    const Real tx = along * point[0] + aside * point[2], tz = along * point[2] - aside * point[0];
    const Real ux = point[0] - tx, uz = point[2] - tz;
    return {(std::atan2(ux, uz) / (2 * kPi) + Real(0.5)) * stack.width,
            Real(0.5) * stack.rows - point[1] / std::hypot(ux, uz) * stack.width / (2 * kPi)};
}

/// A line of sight from above: its offset to the right of the centre, and whether the point lies beyond where it touches a circle.
struct Sight {
    Real offset;
    bool is_ahead;
};
Sight sight_of(const Vector& point, const Vector& way) {
    const Real length = std::hypot(way[0], way[2]), ux = way[0] / length, uz = way[2] / length;
    return {point[0] * uz - point[2] * ux, point[0] * ux + point[2] * uz > 0};
}

/// A panorama of byte texels, read between four.
Real texel_at(const std::vector<unsigned char>& texels, const Stack& stack, int circle, Real x, Real y) {
    y = std::clamp<Real>(y, 0.5L, stack.rows - 0.5L);
    const Real fx = std::floor(x - 0.5L), fy = std::floor(y - 0.5L);
    const auto at = [&](Real i, Real j) {
        const int column = (static_cast<int>(i) + stack.width) % stack.width;
        const int row = std::clamp(static_cast<int>(j), 0, stack.rows - 1);
        return static_cast<Real>(
            texels[static_cast<std::size_t>((circle * stack.rows + row) * stack.width + column)]);
    };
    const Real wx = x - 0.5L - fx, wy = y - 0.5L - fy;
    return (1 - wy) * ((1 - wx) * at(fx, fy) + wx * at(fx + 1, fy)) +
           wy * ((1 - wx) * at(fx, fy + 1) + wx * at(fx + 1, fy + 1));
}

vtkSmartPointer<vtkTexture> stack_texture(const std::vector<unsigned char>& texels, const Stack& stack) {
    const auto texture = texture_of(stack.width, stack.rows * stack.circles, [&](int i, int j) {
        const unsigned char grey = texels[static_cast<std::size_t>(j * stack.width + i)];
        return Colour{grey, grey, grey};
    });
    texture->InterpolateOn();
    texture->RepeatOn();
    return texture;
}

/// A room, and mosaics about a place in it, aslant.
struct Scene {
    Stack stack;
    glm::dvec3 middle;
    Room room{middle};
    vtkNew<vtkAnamorphPanoramaProjector> projector;
    vtkNew<vtkAnamorphProjectionShader> shader;
    anamorph::Orientation orientation{};
    glm::dvec3 from{0.4, 0.3, 0.7};

    explicit Scene(const Stack& of, const glm::dvec3& about = glm::dvec3(0.0)) : stack(of), middle(about) {
        projector->SetProjectionName("cylindrical");
        projector->SetPosition(middle.x - 0.3, middle.y + 0.2, middle.z + 0.1);
        projector->SetOrientation(25, 5, -4);
        projector->SetCircles(stack.circles);
        projector->SetCircleRadius(stack.radius);
        shader->AddProjector(projector);
        shader->HideUnpaintedOn();
        shader->AddTo(room.actor);
    }
    void look(const anamorph::Orientation& to, const glm::dvec3& at) {
        orientation = to;
        from = at;
        room.look(to, at);
    }
    Vector eye() const { return {middle.x + from.x, middle.y + from.y, middle.z + from.z}; }

    /// The point of a wall that a pixel shows, and the way to it.
    std::pair<Vector, Vector> seen(int i, int j, bool parallel = false) const {
        const glm::dmat3 r = anamorph::rotation(orientation);
        const auto axis = [&](int k) { return Vector{r[k].x, -r[k].y, -r[k].z}; };
        const Real half = parallel ? kParallel : std::tan(Room::kViewAngle / 360 * kPi);
        const Real x = (i + 0.5L - Room::kWidth / 2) * 2 * half / Room::kHeight,
                   y = (j + 0.5L - Room::kHeight / 2) * 2 * half / Room::kHeight;
        const Vector aside = sum(scaled(axis(0), x), scaled(axis(1), y));
        const Vector way = parallel ? axis(2) : sum(aside, axis(2));
        const Vector start = parallel ? sum(eye(), aside) : eye();
        Real nearest = HUGE_VALL;
        for (std::size_t k = 0; k < 3; ++k) {
            const Real wall =
                (way[k] > 0 ? Room::kHalf : -Room::kHalf) + middle[static_cast<int>(k)] - start[k];
            if (way[k] != 0) nearest = std::min(nearest, wall / way[k]);
        }
        return {sum(start, scaled(way, nearest)), way};
    }
    static constexpr double kParallel = 0.6;
};

struct Seen {
    int painted = 0, wrongly_painted = 0;
    Real worst = 0;
};

/// Compares each pixel of a picture with what two slits show. `viewpoint`: where they are seen from, if not by the camera.
Seen compare(Scene& scene, const std::vector<unsigned char>& texels, bool parallel = false,
             const std::optional<Vector>& viewpoint = {}) {
    const Frame frame(*scene.projector);
    const Stack& stack = scene.stack;
    const std::vector<Colour> picture = scene.room.picture();
    Seen seen;
    for (int j = 0; j < Room::kHeight; ++j)
        for (int i = 0; i < Room::kWidth; ++i) {
            const auto [world, way] = scene.seen(i, j, parallel);
            const Vector point = frame.local(world);
            const Vector sight = frame.turned(viewpoint ? sum(world, scaled(*viewpoint, -1)) : way);
            const auto [offset, is_ahead] = sight_of(point, sight);
            const Colour& c = picture[static_cast<std::size_t>(j * Room::kWidth + i)];
            const bool painted = c != kNoPlace;
            const Real rho = std::hypot(point[0], point[2]);
            const bool sees = rho > stack.radius && is_ahead && std::fabs(offset) <= stack.radius;
            const Real place = std::clamp<Real>((offset / stack.radius + 1) / 2, 0, 1) * (stack.circles - 1);
            const int first = std::min(static_cast<int>(place), stack.circles - 2);
            Real colour = 0, all = 0;
            bool is_at_border =
                std::fabs(std::fabs(offset) - stack.radius) < 1e-4L || std::fabs(rho - stack.radius) < 1e-4L;
            for (int k = first; sees && k < first + 2; ++k) {
                const auto at = slit_of(stack, point, stack.radius_of(k));
                is_at_border |= std::min(std::fabs(at[1]), std::fabs(at[1] - stack.rows)) < 0.1L;
                if (!(at[1] >= 0 && at[1] <= stack.rows)) continue;
                const Real share = 1 - std::fabs(place - k);
                colour += share * texel_at(texels, stack, k, at[0], at[1]);
                all += share;
            }
            if (is_at_border) continue;
            seen.painted += painted;
            if (painted != (all > 0)) {
                ++seen.wrongly_painted;
            } else if (painted)
                seen.worst = std::max(seen.worst, std::fabs(colour / all - c[0]));
        }
    return seen;
}

/// A texture of waves, each panorama's another, of up to 40 greys a texel, and never white.
std::vector<unsigned char> waves(const Stack& stack) {
    std::vector<unsigned char> texels;
    std::mt19937 random(7);
    for (int k = 0; k < stack.circles; ++k) {
        const double phase = std::uniform_real_distribution<double>(0, 6)(random);
        for (int j = 0; j < stack.rows; ++j)
            for (int i = 0; i < stack.width; ++i)
                texels.push_back(static_cast<unsigned char>(std::lround(
                    120 + 55 * std::sin(2 * M_PI * i / 16 + phase) + 55 * std::sin(j / 3.0 + 2 * phase))));
    }
    return texels;
}

constexpr Stack kStack{5, 1024, 384, 1.2};
const std::vector<std::pair<anamorph::Orientation, glm::dvec3>>& views() {
    static const std::vector<std::pair<anamorph::Orientation, glm::dvec3>> all = {
        {{0, 0, 0}, {0.4, 0.3, 0.7}},       {{100, 20, 0}, {-0.9, -0.1, 0.6}},
        {{190, -10, 5}, {-0.3, 0.9, -0.8}}, {{280, 5, -30}, {0.2, -0.6, 0.1}},
        {{45, 0, 0}, {-1.6, 0.1, 1.5}},  // outside of the circles
    };
    return all;
}

TEST(ProjectionMosaics, ShowWhatTheSlitsOfTwoCirclesSee) {
    // Bytes, the eight bits of the card's weights in slopes of 40 greys, twice, and .02 texels.
    constexpr Real kMost = 2.2;
    for (const int circles : {2, 8})
        for (const glm::dvec3& middle : {glm::dvec3(0.0), glm::dvec3(4000, -2500, 700)}) {
            Scene scene({circles, kStack.width, kStack.rows, kStack.radius}, middle);
            const std::vector<unsigned char> texels = waves(scene.stack);
            const auto texture = stack_texture(texels, scene.stack);
            scene.projector->SetPanorama(texture);
            int painted = 0;
            for (const auto& [orientation, from] : views()) {
                scene.look(orientation, from);
                const Seen seen = compare(scene, texels);
                EXPECT_EQ(seen.wrongly_painted, 0) << circles << " " << orientation.yaw;
                EXPECT_LT(seen.worst, kMost) << circles << " " << orientation.yaw;
                painted += seen.painted;
            }
            EXPECT_GT(painted, 100000);
        }
}

TEST(ProjectionMosaics, AreSeenFromAViewpointOrInParallel) {
    Scene scene(kStack);
    const std::vector<unsigned char> texels = waves(scene.stack);
    const auto texture = stack_texture(texels, scene.stack);
    scene.projector->SetPanorama(texture);
    vtkCamera* camera = scene.room.renderer->GetActiveCamera();
    camera->SetParallelScale(Scene::kParallel);
    for (const auto& [orientation, from] : views()) {
        scene.look(orientation, from);
        camera->ParallelProjectionOn();
        const Seen parallel = compare(scene, texels, true);
        EXPECT_EQ(parallel.wrongly_painted, 0);
        EXPECT_LT(parallel.worst, 2.2) << orientation.yaw;
        camera->ParallelProjectionOff();
        scene.projector->FollowCameraOff();
        scene.projector->SetViewpoint(0.1, 0.4, 0.5);
        const Seen still = compare(scene, texels, false, Vector{0.1L, 0.4L, 0.5L});
        EXPECT_EQ(still.wrongly_painted, 0);
        EXPECT_LT(still.worst, 2.2) << orientation.yaw;
        EXPECT_GT(still.painted, 10000);
        scene.projector->FollowCameraOn();
    }
}

/// What slits of a circle see of the room's walls, whose colours say where they are, is where it was.
TEST(ProjectionMosaics, OfARoomShowTheRoom) {
    Scene scene({5, 1024, 450, 1.2});
    const Stack& stack = scene.stack;
    const Frame frame(*scene.projector);
    const auto colour_of = [](const Vector& at) {
        return 120 + 60 * std::sin(3 * at[0] + 1) * std::sin(4 * at[1]) + 50 * std::sin(5 * at[2] + at[0]);
    };
    std::vector<unsigned char> texels;
    for (int k = 0; k < stack.circles; ++k)
        for (int j = 0; j < stack.rows; ++j)
            for (int i = 0; i < stack.width; ++i) {
                const Real turn = ((i + 0.5L) / stack.width - 0.5L) * 2 * kPi, q = stack.radius_of(k);
                const Vector slit{q * std::cos(turn), 0, -q * std::sin(turn)};
                const Vector way{std::sin(turn), (0.5L * stack.rows - j - 0.5L) * 2 * kPi / stack.width,
                                 std::cos(turn)};
                const Vector start = sum(frame.world(slit), frame.centre), along = frame.world(way);
                Real nearest = HUGE_VALL;
                for (std::size_t a = 0; a < 3; ++a)
                    if (along[a] != 0)
                        nearest = std::min(
                            nearest, ((along[a] > 0 ? Room::kHalf : -Room::kHalf) - start[a]) / along[a]);
                texels.push_back(
                    static_cast<unsigned char>(std::lround(colour_of(sum(start, scaled(along, nearest))))));
            }
    const auto texture = stack_texture(texels, stack);
    scene.projector->SetPanorama(texture);
    int painted = 0;
    for (const auto& [orientation, from] : views()) {
        scene.look(orientation, from);
        const std::vector<Colour> picture = scene.room.picture();
        for (int j = 0; j < Room::kHeight; ++j)
            for (int i = 0; i < Room::kWidth; ++i) {
                const Colour& c = picture[static_cast<std::size_t>(j * Room::kWidth + i)];
                if (c == kNoPlace) continue;
                ++painted;
                ASSERT_NEAR(colour_of(scene.seen(i, j).first), c[0], 4)
                    << orientation.yaw << " " << i << " " << j;
            }
    }
    EXPECT_GT(painted, 80000);
}

TEST(ProjectionMosaics, LevelsDoNotMixCircles) {
    // 384 rows can be halved seven times; and 75 not at all.
    for (const int rows : {384, 75}) {
        Scene scene({5, rows == 384 ? 4096 : 800, rows, 1.2});
        std::vector<unsigned char> texels;
        for (int k = 0; k < scene.stack.circles; ++k)
            texels.insert(texels.end(), static_cast<std::size_t>(rows * scene.stack.width),
                          k % 2 == 0 ? 20 : 220);
        const auto texture = stack_texture(texels, scene.stack);
        texture->MipmapOn();
        texture->SetMaximumAnisotropicFiltering(1);
        scene.projector->SetPanorama(texture);
        for (const auto& [orientation, from] : views()) {
            scene.look(orientation, from);
            const Seen seen = compare(scene, texels);
            EXPECT_LT(seen.worst, 1.2) << rows << " " << orientation.yaw;
        }
    }
}

std::vector<std::string> errors_of(Scene& scene) {
    std::vector<std::string> errors;
    vtkNew<vtkCallbackCommand> heard;
    heard->SetClientData(&errors);
    heard->SetCallback([](vtkObject*, unsigned long, void* data, void* text) {
        static_cast<std::vector<std::string>*>(data)->emplace_back(static_cast<const char*>(text));
    });
    const unsigned long tag = scene.shader->AddObserver(vtkCommand::ErrorEvent, heard);
    scene.room.picture();
    scene.shader->RemoveObserver(tag);
    return errors;
}

TEST(ProjectionMosaics, RefuseWhatHasNoMeaning) {
    using ::testing::Contains;
    using ::testing::HasSubstr;
    using ::testing::IsEmpty;
    Scene scene(kStack);
    const std::vector<unsigned char> texels = waves(scene.stack);
    const auto texture = stack_texture(texels, scene.stack);
    scene.projector->SetPanorama(texture);
    EXPECT_THAT(errors_of(scene), IsEmpty());
    scene.projector->SetCircles(7);
    EXPECT_THAT(errors_of(scene), Contains(HasSubstr("must divide the panorama's height, 1920")));
    scene.projector->SetCircles(5);
    for (const double radius : {0.0, -1.0, HUGE_VAL, std::nan("")}) {
        scene.projector->SetCircleRadius(1);
        scene.room.picture();
        scene.projector->SetCircleRadius(radius);
        EXPECT_THAT(errors_of(scene), Contains(HasSubstr("CircleRadius"))) << radius;
    }
    scene.projector->SetCircleRadius(1);
    scene.projector->SetProjectionName("fisheye");
    EXPECT_THAT(errors_of(scene), Contains(HasSubstr("whose rows are a full turn")));
    scene.projector->SetProjectionName("cylindrical");
    for (const int mode : {1, 2}) {
        scene.shader->SetMode(mode);
        EXPECT_THAT(errors_of(scene), Contains(HasSubstr("must be direct for concentric mosaics")));
    }
    scene.shader->SetModeToDirect();
    scene.projector->SetOccluderConnection(scene.room.cube->GetOutputPort());
    EXPECT_THAT(errors_of(scene), Contains(HasSubstr("must be none for concentric mosaics")));
    scene.projector->SetOccluderConnection(nullptr);
    EXPECT_THAT(errors_of(scene), IsEmpty());
    EXPECT_GT(compare(scene, texels).painted, 0);
}

}  // namespace
