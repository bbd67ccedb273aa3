// SPDX-License-Identifier: Apache-2.0
// Bodies that others hide, against rays in long double: whatever the ray through the middle of a pixel meets first has to be among
// those that may be seen, and of a crowd most are not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "anamorph/figure/image/occlusion.h"

namespace anamorph::test_figure_occlusion {
namespace {

using anamorph::figure::OccludedBodies;
using anamorph::figure::OcclusionView;

struct Shape {
    glm::dvec3 center, lengths;
    glm::dmat3 turn;
};

struct Crowd {
    std::vector<Shape> shapes;
    OccludedBodies bodies;

    void add(const Shape& shape) {
        shapes.push_back(shape);
        glm::dmat3 axes = shape.turn;
        for (int k = 0; k < 3; ++k) axes[k] *= shape.lengths[k];
        bodies.add(shape.center, axes);
    }
};

Crowd crowd_of(int count, double size, double aspect, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> even(-1, 1);
    std::normal_distribution<double> normal;
    Crowd crowd;
    for (int i = 0; i < count; ++i) {
        const glm::dquat turn =
            glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
        Shape shape{{even(random), even(random), even(random)}, {}, glm::mat3_cast(turn)};
        for (int k = 0; k < 3; ++k) shape.lengths[k] = size * std::pow(aspect, even(random));
        crowd.add(shape);
    }
    return crowd;
}

/// The number of the body that a line from `from` to `to` enters first; -1: none.
int first_met(const std::vector<Shape>& shapes, const glm::dvec4& from, const glm::dvec4& to) {
    long double nearest = std::numeric_limits<long double>::infinity();
    int found = -1;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        long double a = 0, b = 0, c = -1;
        for (int k = 0; k < 3; ++k) {
            long double start = 0, way = 0;
            for (int x = 0; x < 3; ++x) {
                const long double p = static_cast<long double>(from[x]) / from.w,
                                  q = static_cast<long double>(to[x]) / to.w;
                start += (p - shapes[i].center[x]) * shapes[i].turn[k][x];
                way += (q - p) * shapes[i].turn[k][x];
            }
            start /= shapes[i].lengths[k];
            way /= shapes[i].lengths[k];
            a += way * way;
            b += start * way;
            c += start * start;
        }
        const long double root = b * b - a * c;
        if (!(root >= 0)) continue;
        if (const long double t = (-b - std::sqrt(root)) / a; t < nearest) {
            nearest = t;
            found = static_cast<int>(i);
        }
    }
    return found;
}

/// How many bodies are left out; all that are met have to be there.
double share_left_out(const Crowd& crowd, const OcclusionView& view) {
    const std::vector<std::uint32_t> seen = crowd.bodies.seen(view);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    const glm::dmat4 back = glm::inverse(view.to_clip);
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            const double across = (x + 0.5) * 2 / view.width - 1, up = (y + 0.5) * 2 / view.height - 1;
            const int met = first_met(crowd.shapes, back * glm::dvec4(across, up, -1, 1),
                                      back * glm::dvec4(across, up, 1, 1));
            if (met >= 0) {
                EXPECT_TRUE(std::binary_search(seen.begin(), seen.end(), static_cast<std::uint32_t>(met)))
                    << met << " at " << x << ", " << y;
            }
        }
    return 1 - double(seen.size()) / double(crowd.bodies.size());
}

OcclusionView view_from(const glm::dvec3& eye, int width, int height, double degrees, double near = 1,
                        double far = 20) {
    OcclusionView view;
    view.width = width;
    view.height = height;
    view.to_clip = glm::perspective(glm::radians(degrees), double(width) / height, near, far) *
                   glm::lookAt(eye, glm::dvec3(0.1, 0, 0), glm::dvec3(0, 1, 0));
    return view;
}

TEST(Occlusion, WhatRaysMeetFirstIsAmongTheSeen) {
    unsigned seed = 0;
    for (const double size : {0.003, 0.03, 0.15})
        for (const double aspect : {1.0, 3.0, 100.0}) {
            const Crowd crowd = crowd_of(250, size, aspect, ++seed);
            share_left_out(crowd, view_from({2, 3, 9}, 41, 27, 15));
            OcclusionView parallel = view_from({2, 3, 9}, 33, 47, 15);
            parallel.to_clip = glm::ortho(-0.5, 0.7, -0.9, 0.9, 1.0, 20.0) *
                               glm::lookAt(glm::dvec3(2, -3, 9), glm::dvec3(0.1, 0, 0), glm::dvec3(0, 1, 0));
            share_left_out(crowd, parallel);
        }
}

TEST(Occlusion, LargeBodiesNextToTheEyeReachNearerThanTheirMiddlesTell) {
    for (unsigned seed = 100; seed < 160; ++seed) {
        const Crowd crowd = crowd_of(120, 0.12, 4, seed);
        share_left_out(crowd, view_from({1, 1, 1.6}, 90, 11, 100, 0.05, 6));
        share_left_out(crowd, view_from({1.2, 0.4, 1.4}, 9, 70, 70, 0.05, 6));
    }
}

TEST(Occlusion, OfACrowdMostAreHidden) {
    EXPECT_GT(share_left_out(crowd_of(1500, 0.1, 1.5, 7), view_from({2, 3, 9}, 36, 36, 17)), 0.7);
    // What hides has to cover a pixel, not its middle alone, where pixels take several samples.
    const Crowd crowd = crowd_of(1500, 0.1, 1.5, 7);
    OcclusionView view = view_from({2, 3, 9}, 36, 36, 17);
    const std::size_t by_middles = crowd.bodies.seen(view).size();
    view.reach = 0.75;
    EXPECT_GT(crowd.bodies.seen(view).size(), by_middles + 50);
}

TEST(Occlusion, FarFromTheOriginAsNearIt) {
    Crowd near = crowd_of(300, 0.07, 3, 9), far;
    const glm::dvec3 away(1e6, -3e5, 2e6);
    for (Shape shape : near.shapes) {
        shape.center += away;
        far.add(shape);
    }
    OcclusionView view = view_from({2, 3, 9}, 40, 40, 17);
    const double share = share_left_out(near, view);
    view.to_clip = view.to_clip * glm::translate(glm::dmat4(1), -away);
    EXPECT_NEAR(share_left_out(far, view), share, 0.02);
}

TEST(Occlusion, WhatIsNotInFrontHidesNothing) {
    Crowd crowd = crowd_of(100, 0.1, 1, 3);
    // The eye is within the crowd, and within a body.
    EXPECT_EQ(crowd.bodies.seen(view_from({0, 0, 0.1}, 20, 20, 60, 0.01)).size(), 100u);
    crowd.bodies.add_none();
    EXPECT_EQ(crowd.bodies.seen(view_from({0, 0, 0.1}, 20, 20, 60, 0.01)).size(), 100u);
    crowd.bodies.add({0, std::numeric_limits<double>::infinity(), 0}, glm::dmat3(1));
    EXPECT_EQ(crowd.bodies.seen(view_from({0, 0, 9}, 20, 20, 60)).size(), 101u);
    EXPECT_TRUE(OccludedBodies().seen(view_from({0, 0, 9}, 20, 20, 60)).empty());
}

TEST(Occlusion, IsTheSameOnThreads) {
    const Crowd crowd = crowd_of(9000, 0.03, 3, 5);
    const OcclusionView view = view_from({2, 3, 9}, 97, 61, 17);
    const auto on_threads = [](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        std::vector<std::thread> threads;
        for (std::int64_t i = count; i-- > 0;) threads.emplace_back([&body, i] { body(i); });
        for (std::thread& thread : threads) thread.join();
    };
    EXPECT_EQ(crowd.bodies.seen(view), crowd.bodies.seen(view, on_threads));
}

}  // namespace
}  // namespace anamorph::test_figure_occlusion
