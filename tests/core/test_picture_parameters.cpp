// SPDX-License-Identifier: Apache-2.0
// What the tables of warps and morphs make of their values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "anamorph/operation/morph.h"
#include "anamorph/operation/warp.h"

namespace anamorph::test_picture_parameters {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <class Body>
std::string error_of(const Body& body) {
    try {
        body();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

WarpRequest warp(const std::vector<Assignment>& assignments, const Size& source = {300, 200}) {
    ParameterValues values(*warp_operation().parameters);
    values.assign(assignments);
    return read_warp_request(values, source);
}

MorphRequest morph(const std::vector<Assignment>& assignments,
                   const std::vector<Size>& pictures = {{300, 200}, {64, 64}}) {
    ParameterValues values(*morph_operation().parameters);
    values.assign(assignments);
    return read_morph_request(values, pictures);
}

TEST(PictureParameters, EveryDefaultIsAllowed) {
    for (const Operation* operation : operations())
        for (const Parameter& p : *operation->parameters) {
            SCOPED_TRACE(operation->name + " " + p.name);
            EXPECT_FALSE(p.documentation.empty());
            ParameterValues values(*operation->parameters);
            if (!p.default_value.empty()) {
                EXPECT_NO_THROW(values.assign({{p.name, p.default_value}}));
            }
        }
}

TEST(WarpRequest, ReadsItsValues) {
    const WarpRequest plain = warp({});
    EXPECT_EQ(plain.target.width, 300);
    EXPECT_EQ(plain.target.height, 200);
    EXPECT_EQ(plain.options.tol, 0.01);
    EXPECT_EQ(plain.options.scheme, WarpScheme::automatic);
    EXPECT_EQ(plain.options.filter, Filter::antialias);
    EXPECT_EQ(plain.options.output, Output::color);
    EXPECT_FALSE(plain.options.folds);
    EXPECT_EQ(plain.options.amount, 1);
    EXPECT_FALSE(plain.direction);
    const WarpRequest other = warp({{"size", "150"},
                                    {"scheme", "residual"},
                                    {"output", "folds"},
                                    {"direction", "push"},
                                    {"amount", "-0.5"}});
    EXPECT_EQ(other.target.width, 150);
    EXPECT_EQ(other.target.height, 100);
    EXPECT_EQ(other.options.scheme, WarpScheme::residual);
    EXPECT_TRUE(other.options.folds);
    EXPECT_EQ(other.direction, Direction::push);
    EXPECT_EQ(other.options.amount, -0.5);
    EXPECT_EQ(warp({{"size", "1"}}, {1000, 1}).target.height, 1);
    EXPECT_FALSE(plain.options.draws_mesh);
    EXPECT_TRUE(warp({{"output", "mesh"}}).options.draws_mesh);
    EXPECT_EQ(warp({{"output", "mesh"}}).options.output, Output::color);
}

TEST(WarpRequest, PixelsAsFractions) {
    WarpMap map;
    ControlMesh mesh;
    mesh.vertices = {{0, 0}, {300, 0}, {30, 100}, {300, 200}};
    mesh.x_lines = {0, 50};
    mesh.y_lines = {0, 25};
    mesh.levels = {{{{0, 0}}, {{1, 1, {150, 50}}}}};
    map.shape = mesh;
    const auto pulled = std::get<ControlMesh>(in_fractions(map, {300, 200}, {100, 50}).shape);
    EXPECT_EQ(pulled.units, Units::fractions);
    EXPECT_DOUBLE_EQ(pulled.vertices[2].x, 0.1);
    EXPECT_DOUBLE_EQ(pulled.vertices[2].y, 0.5);
    EXPECT_DOUBLE_EQ(pulled.x_lines[1], 0.5);
    EXPECT_DOUBLE_EQ(pulled.y_lines[1], 0.5);
    EXPECT_DOUBLE_EQ(pulled.levels[0].vertices[0].at.y, 0.25);
    // A mesh that pushes lies in the source.
    std::get<ControlMesh>(map.shape).direction = Direction::push;
    const auto pushed = std::get<ControlMesh>(in_fractions(map, {100, 50}, {300, 200}).shape);
    EXPECT_DOUBLE_EQ(pushed.vertices[2].x, 0.1);
    EXPECT_DOUBLE_EQ(pushed.x_lines[1], 0.5);
    map.shape = ControlPoints{Units::pixels, {{50, 25, 30, 100}}};
    const auto points = std::get<ControlPoints>(in_fractions(map, {300, 200}, {100, 50}).shape);
    EXPECT_DOUBLE_EQ(points.pairs[0].x, 0.5);
    EXPECT_DOUBLE_EQ(points.pairs[0].v, 0.5);
    // What is in fractions stays.
    EXPECT_EQ(std::get<ControlPoints>(in_fractions({"p", points}, {7, 7}, {7, 7}).shape).pairs[0].x,
              points.pairs[0].x);
}

TEST(MorphRequest, ReadsItsValues) {
    const MorphRequest plain = morph({});
    EXPECT_EQ(plain.width, 300);
    EXPECT_EQ(plain.height, 200);
    EXPECT_EQ(plain.options.t, 0.5);
    EXPECT_FALSE(plain.options.t_color);
    EXPECT_EQ(plain.options.weight_a, 1);
    EXPECT_EQ(plain.options.weight_b, 2);
    EXPECT_EQ(plain.options.weight_p, 0.5);
    EXPECT_FALSE(plain.pin_border);
    EXPECT_EQ(plain.frames, 1);
    const MorphRequest other =
        morph({{"t", "0.25"}, {"t_color", "0"}, {"pin_border", "0"}, {"output", "lines"}});
    EXPECT_EQ(other.frame_options(0).t, 0.25);
    EXPECT_EQ(other.options.t_color, 0);
    EXPECT_EQ(other.pin_border, 0);
    EXPECT_TRUE(other.options.lines);
    const std::vector<Size> three = {{8, 8}, {8, 8}, {8, 8}};
    EXPECT_EQ(morph({{"shape_weights", "0.5,0.25,0.25"}}, three).options.shape_weights,
              (std::vector<double>{0.5, 0.25, 0.25}));
    EXPECT_THAT(error_of([&] { morph({}, three); }), HasSubstr("shape_weights is not given"));
    EXPECT_THAT(error_of([&] {
                    morph({{"t", "1"}, {"shape_weights", "0,1,0"}}, three);
                }),
                HasSubstr("t=1: must not be given together with shape_weights"));
}

TEST(MorphRequest, APictureIsChosenByItsKey) {
    struct Case {
        std::vector<Assignment> given;
        Output output;
        std::optional<int> picture;
    };
    const Case cases[] = {{{}, Output::color, {}},
                          {{{"output", "stmap"}}, Output::stmap, {}},
                          {{{"output", "stmap"}, {"picture", "b"}}, Output::stmap, 1},
                          {{{"picture", "a"}}, Output::color, 0},
                          {{{"output", "error"}, {"picture", "b"}}, Output::error, 1}};
    for (const Case& c : cases) {
        const MorphOptions options = morph(c.given).options;
        EXPECT_EQ(options.output, c.output);
        EXPECT_EQ(options.picture, c.picture);
        EXPECT_FALSE(options.lines);
    }
    EXPECT_EQ(error_of([] {
                  morph({{"picture", "c"}});
              }),
              "picture=c: must be one of the pictures that are given, a to b");
}

/// Makes the morph that a table's values ask for.
void make_morph(const std::vector<Assignment>& assignments) {
    const MorphRequest r = morph(assignments);
    auto features = std::make_shared<Features>();
    features->add_line({{{40, 40}, {80, 38}}, {{4, 5}, {8, 7}}});
    features->pin_border(r.pin_border.value_or(0));
    const Picture made =
        morphed_picture(features, r.pictures, {r.width, r.height}, r.frame_options(r.frames - 1));
}

TEST(MorphRequest, WhatARowAllowsIsWhatTheMorphTakes) {
    int ends = 0;
    for (const Parameter& p : *morph_operation().parameters) {
        const bool number = p.type == ParameterType::number, whole = p.type == ParameterType::whole;
        if (!number && !whole) continue;
        SCOPED_TRACE(p.name);
        const auto ask = [&](double value) {
            return error_of([&] { make_morph({{p.name, shortest(value)}}); });
        };
        for (const double end : {p.minimum, p.maximum}) {
            // Where there is no end, a number as large as any.
            const double beyond = end == p.minimum ? -HUGE_VAL : HUGE_VAL;
            EXPECT_EQ(ask(std::isfinite(end) ? end : std::copysign(1e300, end)), "no error");
            if (!std::isfinite(end)) continue;
            const double step = whole ? end + std::copysign(1.0, beyond) : std::nextafter(end, beyond);
            EXPECT_EQ(ask(step), p.name + "=" + shortest(step) + ": " + p.rule());
            ++ends;
        }
    }
    EXPECT_EQ(ends, 14);
}

TEST(MorphRequest, WeightsAreNamedAsTheyWereGiven) {
    const std::string allowed = ": must be 2 numbers from -1e+06 to 1e+06, one for each picture, with sum 1";
    for (const std::string name : {"shape_weights", "color_weights"}) {
        for (const std::string value : {"1.50, 1.5", "0.5", "0.2,0.2,0.6", "0.5,0.499"})
            EXPECT_EQ(error_of([&] { morph({{name, value}}); }), name + "=" + value + allowed);
        EXPECT_EQ(error_of([&] { make_morph({{name, "1e6,-999999"}}); }), "no error");
        EXPECT_EQ(error_of([&] {
                      morph({{name, "1000001,-1000000"}});
                  }),
                  name + "=1000001,-1000000: must be numbers from -1e+06 to 1e+06, separated by commas");
    }
}

TEST(MorphRequest, AFilmRunsOverT) {
    const MorphRequest film = morph({{"frames", "5"}});
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(film.frame_options(i).t, i / 4.0);
        EXPECT_FALSE(film.frame_options(i).t_color);
    }
    EXPECT_EQ(morph({{"frames", "3"}, {"t_color", "0"}}).frame_options(2).t_color, 0);
    EXPECT_THAT(error_of([] {
                    morph({{"frames", "3"}, {"t", "0.5"}});
                }),
                HasSubstr("t=0.5: must not be given together with frames"));
    EXPECT_THAT(error_of([] { morph({{"frames", "0"}}); }), HasSubstr("frames=0"));
}

}  // namespace
}  // namespace anamorph::test_picture_parameters
