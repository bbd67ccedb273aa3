// SPDX-License-Identifier: Apache-2.0
// Scheme exact: each pixel's own point of the surface, against ray tracing in closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "anamorph/operation/operation.h"
#include "drape_oracle.h"
#include "drape_scene.h"

namespace anamorph::test_drape_exact {
using namespace surface;
namespace {

using test::kHalfTurn;
using test::Real;
using test::Scene;
using test::Shown;
using test::Vector;

class NoFiles final : public SideFileReader {
  public:
    std::string text(const std::string& name) const override { throw Error("there is no file " + name); }
    std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
        throw Error("there is no image " + name);
    }
};

/// The map of a scene with points of their own.
DrapeMap exact_map(const Scene& scene, const Shown& shown, const Camera& camera, double tol) {
    SurfaceTree& tree = shown.tree()->tree;
    return {cut_into_facets(tree, camera, tol), camera, scene.picture, tol, tree.shared_surface()};
}

TEST(DrapeExact, PointsAreSeenInTheMiddlesOfTheirPixels) {
    for (const std::string& name : surface_names())
        for (const glm::dvec3 position : {glm::dvec3(0.1, 0.2, 2), glm::dvec3(1.1, 0.7, 1.3)}) {
            Scene scene{name};
            scene.shape.angle = name == "cylinder" ? 200 : 360;
            scene.shape.direction = 33;
            scene.pose.position = position;
            const Shown shown(scene);
            const Camera camera = shown.camera();
            const DrapeMap map = exact_map(scene, shown, camera, 0.125);
            int seen = 0, exact = 0;
            for (int y = 0; y < scene.screen.height; ++y)
                for (int x = 0; x < scene.screen.width; ++x) {
                    Point<double> p{};
                    int piece = 0;
                    if (!map.exact(x + 0.5, y + 0.5, 0, p, piece)) continue;
                    const auto region = map.region_at(x, y);
                    const double bound = map.bound_at(region->pixels(), region->pixels().index(x, y));
                    const test::OracleSight at =
                        test::oracle_sight(scene.pose, scene.screen,
                                           test::oracle_surface(name, scene.shape, p.x / scene.picture.width,
                                                                p.y / scene.picture.height));
                    const Real error = std::hypot(at.x - (x + 0.5L), at.y - (y + 0.5L));
                    // What dividing by the picture's size loses.
                    EXPECT_LE(error, bound + 1e-12L) << name;
                    EXPECT_LE(bound, 0.125) << name;
                    ++seen;
                    exact += bound <= kExactError;
                }
            // The others are at silhouettes, where the surface folds, and on borders.
            EXPECT_GT(exact, 0.96 * seen) << name;
            EXPECT_GT(seen, 1000) << name;
        }
}

/// The nearest point of a surface on a ray from `o` along `d`, at least `near` far along it: u and v.
using Hit = std::optional<std::array<Real, 2>>;

Vector along(const Vector& o, const Vector& d, Real t) {
    return {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
}

/// The places along the ray, in their order.
std::vector<Real> roots_of_square(Real a, Real b, Real c) {
    const Real discriminant = b * b - a * c;
    if (discriminant < 0) return {};
    const Real root = std::sqrt(discriminant);
    return {(-b - root) / a, (-b + root) / a};
}

Hit trace(const std::string& name, const SurfaceShape& s, const Vector& o, const Vector& d, Real near) {
    const Real turn = s.angle * kHalfTurn / 180;
    std::vector<Real> places;
    std::function<std::array<Real, 2>(const Vector&)> parameters;
    const auto east = [&](const Vector& p) { return std::atan2(p[0], p[2]) / turn + Real(0.5); };
    if (name == "plane") {
        places = {-o[2] / d[2]};
        parameters = [&](const Vector& p) {
            return std::array{p[0] / s.aspect + Real(0.5), Real(0.5) - p[1]};
        };
    } else if (name == "cylinder") {
        const Real r = s.aspect / turn;
        places = roots_of_square(d[0] * d[0] + d[2] * d[2], o[0] * d[0] + o[2] * d[2],
                                 o[0] * o[0] + o[2] * o[2] - r * r);
        parameters = [&](const Vector& p) { return std::array{east(p), Real(0.5) - p[1]}; };
    } else if (name == "sphere") {
        places =
            roots_of_square(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], o[0] * d[0] + o[1] * d[1] + o[2] * d[2],
                            o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - Real(0.25));
        parameters = [&](const Vector& p) { return std::array{east(p), std::acos(2 * p[1]) / kHalfTurn}; };
    } else {
        // A torus is met where its distance from the circle in its middle changes sides.
        const auto outside = [&](Real t) {
            const Vector p = along(o, d, t);
            return std::hypot(std::hypot(p[0], p[2]) - Real(0.5), p[1]) - Real(s.tube);
        };
        constexpr int kSteps = 1500;
        const Real most = 4;
        for (int i = 0; i < kSteps; ++i) {
            Real from = most * i / kSteps, to = most * (i + 1) / kSteps;
            if ((outside(from) > 0) == (outside(to) > 0)) continue;
            for (int k = 0; k < 64; ++k) {
                const Real middle = (from + to) / 2;
                ((outside(middle) > 0) == (outside(from) > 0) ? from : to) = middle;
            }
            places.push_back(from);
        }
        parameters = [&](const Vector& p) {
            const Real round = std::atan2(p[1], std::hypot(p[0], p[2]) - Real(0.5));
            return std::array{east(p), Real(0.5) - round / (2 * kHalfTurn)};
        };
    }
    for (const Real t : places) {
        if (!(t >= near)) continue;
        const auto [u, v] = parameters(along(o, d, t));
        if (u >= 0 && u <= 1 && v >= 0 && v <= 1) return std::array{u, v};
    }
    return {};
}

TEST(DrapeExact, AgreesWithRayTracing) {
    for (const std::string name : {"plane", "cylinder", "sphere", "torus"}) {
        Scene scene{name};
        scene.shape.angle = name == "cylinder" ? 150 : 360;
        scene.shape.aspect = 1.25;
        scene.pose.position = {0.9, 0.8, 1.4};
        scene.picture = {512, 512};
        const Shown shown(scene);
        const Camera camera = shown.camera();
        const DrapeMap map = exact_map(scene, shown, camera, 0.01);
        // The screen's axes in space.
        const glm::dvec3 view = glm::normalize(scene.pose.target - scene.pose.position),
                         right = glm::normalize(glm::cross(view, scene.pose.up)),
                         up = glm::cross(right, view);
        const Real focal = scene.screen.width / 2.0L / std::tan(scene.pose.fov * kHalfTurn / 360);
        const Vector eye{scene.pose.position.x, scene.pose.position.y, scene.pose.position.z};
        int different = 0, off = 0, seen = 0;
        for (int y = 0; y < scene.screen.height; ++y)
            for (int x = 0; x < scene.screen.width; ++x) {
                const Real i = x + 0.5L - scene.screen.width / 2.0L,
                           j = y + 0.5L - scene.screen.height / 2.0L;
                Vector d;
                for (int k = 0; k < 3; ++k)
                    d[static_cast<std::size_t>(k)] = view[k] + (right[k] * i - up[k] * j) / focal;
                const Hit hit = trace(name, scene.shape, eye, d, 1e-3L);
                Point<double> p{};
                int piece = 0;
                const bool is_seen = map.exact(x + 0.5, y + 0.5, 0, p, piece);
                seen += is_seen;
                if (is_seen != hit.has_value()) {
                    ++different;
                    continue;
                }
                if (!is_seen) continue;
                const Real texels = std::hypot(p.x - 512 * (*hit)[0], p.y - 512 * (*hit)[1]);
                different += texels > 1;
                off += texels > 1e-7L;
            }
        const int pixels = scene.screen.width * scene.screen.height;
        EXPECT_LE(different, pixels / 1000) << name;
        EXPECT_LE(off, seen / 50) << name;
        EXPECT_GT(seen, 2000) << name;
    }
}

TEST(DrapeExact, SaysHowMuchIsExact) {
    Scene scene{"waves"};
    scene.pose.position = {0.1, 0.1, 1};
    scene.pose.fov = 30;
    DrapeOptions options;
    options.scheme = DrapeScheme::exact;
    Shown shown(scene, options);
    const std::vector<float> bounds = shown.values(Output::bound), errors = shown.values(Output::error);
    for (std::size_t k = 0; k < bounds.size(); ++k) EXPECT_LE(errors[k], bounds[k]);
    EXPECT_LE(*std::max_element(bounds.begin(), bounds.end()), 1e-9f);
    const Drape drape(shown.tree(), shown.camera(), scene.picture, options);
    EXPECT_EQ(drape.reached(serial_for).exact_fraction, 1);
    EXPECT_LE(drape.reached(serial_for).max_error, kExactError);
}

TEST(DrapeExact, StartsThatAreOffMuchMoreOneWayAreCertifiedToo) {
    // Some starts of this view are off along v a thousand times more than along u.
    const Operation& operation = *find_operation("drape");
    ParameterValues values(*operation.parameters);
    values.assign({{"surface", "sphere"},
                   {"angle", "238.01434427194636"},
                   {"radius", "0.75663636518251898"},
                   {"scale", "1.0434308451960836"},
                   {"scheme", "exact"},
                   {"size", "134x70"},
                   {"tol", "0.125"},
                   {"move", "0.18385474966938101,-0.053147391787501976,0.035253114827887504"},
                   {"camera", "0.023839545238308116,0.48206524582351601,0.10340418296712837"},
                   {"target", "-0.040293802956459672,0.1562146424685763,-0.1804183116087715"},
                   {"fov", "98.348685860373621"},
                   {"output", "bound"}});
    SourceImage source;
    source.facts.width = 77;
    source.facts.height = 68;
    source.channels = 3;
    const NoFiles none;
    const auto pictures = operation.read({values, {source}, {}, none});
    const Box pixel{41, 48, 42, 49};
    float bound = -1;
    const auto solved = pictures->picture(0, 0)->solve();
    solved->draw({}, pixel, packed_view(reinterpret_cast<std::byte*>(&bound), PixelType::float32, 1, 1, 1),
                 serial_for);
    EXPECT_GE(bound, 0);
    EXPECT_LE(bound, 1e-9f);
}

}  // namespace
}  // namespace anamorph::test_drape_exact
