// SPDX-License-Identifier: Apache-2.0
// What the tests of figures share: scripts performed, and frames compared as the originals' print them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script.h"

namespace anamorph::figure_cases {

/// A name with a number: "s7".
inline std::string numbered(const char* name, int i) {
    std::string out(name);
    out += std::to_string(i);
    return out;
}

inline figure::Program program_of(const std::string& text,
                                  figure::Dialect dialect = figure::Dialect::classic) {
    figure::ScriptOptions options;
    options.dialect = dialect;
    return figure::parse_program(text, "own.n", options);
}

inline figure::Performance perform(const std::string& text,
                                   figure::Dialect dialect = figure::Dialect::classic) {
    return figure::Performance(program_of(text, dialect));
}

inline std::vector<figure::FigureFrame> all_frames(figure::Performance& performance) {
    std::vector<figure::FigureFrame> frames;
    performance.for_each_frame([&](const figure::FigureFrame& frame) {
        frames.push_back(frame);
        return true;
    });
    return frames;
}

inline const figure::Body& body_named(const figure::FigureFrame& frame, const std::string& name) {
    const auto found = std::find_if(frame.bodies.begin(), frame.bodies.end(),
                                    [&](const figure::Body& b) { return b.name == name; });
    if (found == frame.bodies.end()) throw Error("no ellipsoid " + name);
    return *found;
}

/// The message of the Error that `body` throws.
template <class Function>
std::string error_of(const Function& body) {
    try {
        body();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find_first_of("\r\n"), std::string::npos);
        return error.what();
    }
    return "no error";
}

inline void expect_near(const glm::dvec3& value, const glm::dvec3& wanted, double tolerance) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(value[k], wanted[k], tolerance) << "coordinate " << k;
}

/// The angle in degrees of the turn between two orientations.
inline double turn_between(const glm::dmat3& a, const glm::dmat3& b) {
    return figure::angles_of_rotation(a * glm::transpose(b)).z;
}

inline std::optional<std::string> text_of_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::nullopt;
    return std::string(std::istreambuf_iterator<char>(file), {});
}

/// Fails unless every number of a frame is within two units of the last digit that the originals print: 0.2
/// of a length, 0.2 degrees, 2 of a colour.
inline void expect_as_printed(const figure::FigureFrame& frame, const figure::FigureFrame& printed) {
    constexpr double kTwoUnits = 0.2 + 1e-9;
    SCOPED_TRACE("frame " + std::to_string(printed.number));
    EXPECT_EQ(frame.number, printed.number);
    expect_near(frame.place, printed.place, kTwoUnits);
    EXPECT_LE(turn_between(frame.observer, printed.observer), kTwoUnits);
    ASSERT_EQ(frame.bodies.size(), printed.bodies.size());
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
        const figure::Body &ours = frame.bodies[i], &theirs = printed.bodies[i];
        SCOPED_TRACE(theirs.name);
        EXPECT_EQ(ours.name, theirs.name);
        expect_near(ours.shape.axes, theirs.shape.axes, kTwoUnits);
        expect_near(ours.shape.center, theirs.shape.center, kTwoUnits);
        EXPECT_LE(turn_between(ours.shape.rotation, theirs.shape.rotation), kTwoUnits);
        expect_near(ours.color, theirs.color, 2);
    }
    ASSERT_EQ(frame.joints.size(), printed.joints.size());
    for (std::size_t j = 0; j < frame.joints.size(); ++j) {
        SCOPED_TRACE(printed.joints[j].name);
        EXPECT_EQ(frame.joints[j].name, printed.joints[j].name);
        EXPECT_EQ(frame.joints[j].first, printed.joints[j].first);
        EXPECT_EQ(frame.joints[j].second, printed.joints[j].second);
        expect_near(frame.joints[j].position, printed.joints[j].position, kTwoUnits);
    }
}

}  // namespace anamorph::figure_cases
