// SPDX-License-Identifier: Apache-2.0
// Scenes of ellipsoids for the tests of their pictures, and what a view ray meets of them: the textbook's
// quadratic in the scene's coordinates, in long double.
#pragma once

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <vector>

#include "anamorph/figure/body/ellipsoid.h"
#include "anamorph/figure/outline/outline_view.h"

namespace anamorph::figure_picture_cases {

using Real = long double;
using RealVector = glm::vec<3, Real>;

struct Scene {
    std::vector<figure::Ellipsoid> bodies;
    figure::View view;
    int width = 64, height = 48;
};

/// The surface that a ray meets first.
struct Met {
    int body = -1;
    bool far_side = false;
    Real depth = HUGE_VALL;
    RealVector point{0.0L};  ///< in the scene
    /// The least change that would alter this: the least difference to the next depth, relative to the size
    /// of what is met, and the least distance from a limb, relative to the body.
    Real doubt = HUGE_VALL;
};

struct Ray {
    RealVector origin, direction;  ///< the direction's depth is 1
};

/// The view ray through a point of the picture, in pixels from its upper left.
inline Ray ray_at(const Scene& scene, Real x, Real y) {
    const figure::View& view = scene.view;
    const glm::mat<3, 3, Real> back = glm::transpose(glm::mat<3, 3, Real>(view.rotation));
    const Real up = scene.height - y;
    if (!view.perspective())
        return {RealVector(view.center) +
                    back * RealVector((x - view.middle.x) / view.scale, (up - view.middle.y) / view.scale, 0),
                back * RealVector(0, 0, 1)};
    const Real zoom = static_cast<Real>(view.scale) * view.eye_distance;
    return {RealVector(view.center) - back * RealVector(0, 0, view.eye_distance),
            back * RealVector((x - view.middle.x) / zoom, (up - view.middle.y) / zoom, 1)};
}

inline Met meet(const Scene& scene, Real x, Real y) {
    const Ray ray = ray_at(scene, x, y);
    Met met;
    std::vector<Real> depths;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const figure::Ellipsoid& e = scene.bodies[i];
        const glm::mat<3, 3, Real> own = glm::transpose(glm::mat<3, 3, Real>(e.rotation));
        const RealVector axes(e.axes), o = own * (ray.origin - RealVector(e.center)) / axes,
                                       d = own * ray.direction / axes;
        const Real a = glm::dot(d, d), b = glm::dot(o, d);
        // 1 - the square of the least distance from the centre, of the unit sphere.
        const RealVector closest = o - d * (b / a);
        const Real inside = 1 - glm::dot(closest, closest);
        met.doubt = std::min(met.doubt, std::fabs(inside));
        if (inside < 0) continue;
        const Real half = std::sqrt(inside / a);
        Real depth = -b / a - half;
        bool far_side = false;
        if (scene.view.perspective()) {
            met.doubt = std::min(met.doubt, std::fabs(depth - scene.view.near) / scene.view.near);
            if (depth < scene.view.near) depth = -b / a + half, far_side = true;
            met.doubt = std::min(met.doubt, std::fabs(depth - scene.view.near) / scene.view.near);
            if (depth < scene.view.near) continue;
        }
        depths.push_back(depth);
        if (depth < met.depth) {
            met.depth = depth;
            met.body = static_cast<int>(i);
            met.far_side = far_side;
            met.point = ray.origin + ray.direction * depth;
        }
    }
    for (const Real depth : depths)
        if (depth != met.depth) met.doubt = std::min(met.doubt, (depth - met.depth) / std::fabs(met.depth));
    return met;
}

/// Makes bodies and views by a seed.
class SceneMaker {
  public:
    explicit SceneMaker(unsigned seed) : m_random(seed) {}

    double number(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(m_random);
    }
    glm::dmat3 turn() {
        // One by one: in this order, by every compiler.
        glm::dvec4 q;
        for (int k = 3; k >= 0; --k) q[k] = number(-1, 1);
        return glm::mat3_cast(glm::normalize(glm::dquat(q.w, q.x, q.y, q.z)));
    }
    /// A body in a cube of that half side about the origin, the longest axis between `least` and `most`,
    /// others down to a share of 1 / aspect of it.
    figure::Ellipsoid body(double spread, double least, double most, double aspect) {
        figure::Ellipsoid e;
        for (int k = 0; k < 3; ++k) e.center[k] = number(-spread, spread);
        const double longest = std::exp(number(std::log(least), std::log(most)));
        for (int k = 0; k < 3; ++k) e.axes[k] = longest * std::exp(-number(0, std::log(aspect)));
        e.axes[static_cast<int>(number(0, 2.999))] = longest;
        e.rotation = turn();
        return e;
    }
    /// A scene of about 200 units. `eye`: the eye's distance from the middle; infinite for none.
    Scene scene(int count, double least, double most, double aspect, double eye, int width = 64,
                int height = 48) {
        Scene s;
        s.width = width;
        s.height = height;
        s.view.rotation = turn();
        s.view.middle = {0.5 * width + number(-1, 1), 0.5 * height + number(-1, 1)};
        s.view.scale = width / 200.0;
        s.view.eye_distance = eye;
        for (int i = 0; i < count; ++i) s.bodies.push_back(body(90, least, most, aspect));
        return s;
    }

  private:
    std::mt19937 m_random;
};

}  // namespace anamorph::figure_picture_cases
