// SPDX-License-Identifier: Apache-2.0
// Long chains: what is counted grows with their length, not with its square.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "anamorph/figure/language/figure_state.h"
#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script.h"

namespace anamorph::test_figure_chain {
using namespace figure;
namespace {

/// Single ellipsoids that are attached in one frame, in the order of `joints`.
std::string chain_script(const std::vector<int>& joints) {
    std::string text;
    for (std::size_t i = 0; i <= joints.size(); ++i) {
        const std::string n = std::to_string(i);
        text += "figure f" + n + " 1 e" + n + "\nellipsoid e" + n + " 10 10 10\n";
    }
    for (const int i : joints) {
        const std::string n = std::to_string(i);
        text += "repeat 0 1 attach e" + n + " j" + n + " e" + std::to_string(i + 1) + " 5 0 0\n";
    }
    return text + "stop\n";
}

TEST(FigureChain, AttachingThreeThousandJointsVisitsEachAFewTimes) {
    constexpr int kJoints = 3000;
    std::vector<int> order;
    for (int i = 0; i < kJoints; ++i) order.push_back(i);
    for (const bool backwards : {false, true}) {
        if (backwards) std::reverse(order.begin(), order.end());
        FigureState state = figures_at_rest(parse_program(chain_script(order), "chain"));
        const FigureState before = state;
        for (const int i : order) own_topology(state).attach(i, i + 1, i + 2);
        EXPECT_LE(state.topology->visited, 8u * kJoints);
        EXPECT_EQ(before.topology->joint_order.size(), 0u);
        for (int i = 1; i <= kJoints + 1; ++i) ASSERT_EQ(state.topology->figure_of(i), 2);
        EXPECT_EQ(part_from(state, 1, -1).bodies.size(), kJoints + 1u);
    }
    // Through the language: one figure of all.
    Performance performance(parse_program(chain_script(order), "chain"));
    const FigureFrame frame = performance.frame(1);
    EXPECT_EQ(frame.figures.size(), 1u);
    EXPECT_EQ(frame.joints.size(), std::size_t{kJoints});
}

TEST(FigureChain, FiguresAreThoseOfTheGraph) {
    // Against labels that are spread again and again until nothing changes.
    for (unsigned seed = 0; seed < 50; ++seed) {
        std::mt19937 random(seed);
        constexpr int kBodies = 40;
        std::vector<int> order(kBodies - 1);
        for (int i = 0; i < kBodies - 1; ++i) order[static_cast<std::size_t>(i)] = i;
        FigureState state = figures_at_rest(parse_program(chain_script(order), "chain"));
        std::vector<int> label(kBodies + 1);
        for (int i = 1; i <= kBodies; ++i) label[static_cast<std::size_t>(i)] = i + 1;
        std::vector<std::pair<int, int>> joined;
        for (int j = 0; j < 25; ++j) {
            const int a = 1 + static_cast<int>(random() % kBodies),
                      b = 1 + static_cast<int>(random() % kBodies);
            own_topology(state).attach(j, a, b);
            joined.push_back({a, b});
        }
        for (bool changed = true; changed;) {
            changed = false;
            for (const auto& [a, b] : joined) {
                int &x = label[static_cast<std::size_t>(a)], &y = label[static_cast<std::size_t>(b)];
                changed = changed || x != y;
                x = y = std::min(x, y);
            }
        }
        Topology again = *state.topology;
        again.connect(state.bodies.size());
        for (int i = 1; i <= kBodies; ++i) {
            ASSERT_EQ(state.topology->figure_of(i), label[static_cast<std::size_t>(i)]) << "seed " << seed;
            ASSERT_EQ(again.figure_of(i), label[static_cast<std::size_t>(i)]) << "seed " << seed;
            EXPECT_EQ(again.joints_of[static_cast<std::size_t>(i)],
                      state.topology->joints_of[static_cast<std::size_t>(i)]);
        }
    }
}

}  // namespace
}  // namespace anamorph::test_figure_chain
