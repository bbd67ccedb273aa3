// SPDX-License-Identifier: Apache-2.0
// Morphs by two warps and a blend in the frame buffer (Kim 2003, 5.6): meshes, source points and colors against the paper's equations,
// written out here in long double, and against integers.
#include "anamorph/machine/morph_unit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "anamorph/image/source.h"
#include "anamorph/operation/operation.h"

namespace anamorph::test_morph_unit {
using namespace machine;
namespace {

using Real = long double;
using testing::HasSubstr;

constexpr int kSide = 26;

class Files final : public SideFileReader {
  public:
    explicit Files(std::string features) : m_features(std::move(features)) {}
    std::string text(const std::string&) const override { return m_features; }
    std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
        throw Error("there is no image " + name);
    }

  private:
    std::string m_features;
};

// Two lines, in the first picture and in the second.
const std::string kLines = R"({"features": [{"line": [[5, 6, 12, 8], [7, 5, 14, 11]]},
                                            {"line": [[18, 20, 8, 19], [17, 21, 9, 17]]}]})";

struct Drawn {
    std::vector<float> values;
    std::map<std::string, double> says;
};

/// What .morph makes of pictures of kSide x kSide whose texels are texel(k, x, y, channel).
template <class Texel>
Drawn drawn_by(const std::vector<Assignment>& more, const Texel& texel, int pictures = 2, int channels = 1,
               int alpha = -1, const std::string& lines = kLines, const Box& box = {0, 0, kSide, kSide}) {
    const Operation& morph = *find_operation("morph");
    ParameterValues values(*morph.parameters);
    values.assign({{"scheme", "hardware"}});
    values.assign(more);
    SideFiles files;
    files["features"] = {"lines.json", ""};
    SourceImage facts;
    facts.facts.width = facts.facts.height = kSide;
    facts.channels = channels;
    facts.alpha = alpha;
    const Files reader(lines);
    const std::vector<SourceImage> all(static_cast<std::size_t>(pictures), facts);
    const auto request = morph.read({values, all, files, reader})->picture(0, 0);
    const auto solved = request->solve();
    std::vector<std::vector<float>> texels(all.size());
    std::vector<std::unique_ptr<MemorySource>> sources;
    std::vector<const Source*> given;
    for (int k = 0; k < pictures; ++k) {
        auto& to = texels[static_cast<std::size_t>(k)];
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x)
                for (int c = 0; c < channels; ++c) to.push_back(static_cast<float>(texel(k, x, y, c)));
        sources.push_back(std::make_unique<MemorySource>(packed_view(
            reinterpret_cast<const std::byte*>(to.data()), PixelType::float32, kSide, kSide, channels)));
        given.push_back(sources.back().get());
    }
    Drawn drawn;
    const int shown = request->pixels == PixelKind::color   ? channels
                      : request->pixels == PixelKind::point ? 2
                                                            : 1;
    drawn.values.resize(static_cast<std::size_t>(box.width() * box.height() * shown));
    EXPECT_TRUE(solved->draw(given, box,
                             packed_view(reinterpret_cast<std::byte*>(drawn.values.data()),
                                         PixelType::float32, box.width(), box.height(), shown),
                             serial_for));
    for (const Attribute& a : solved->reached(serial_for))
        if (std::holds_alternative<double>(a.value)) drawn.says[a.name] = std::get<double>(a.value);
    return drawn;
}

double waves(int k, int x, int y, int c) {
    return 0.5 + 0.4 * std::sin(0.4 * x + 0.3 * y * (c + 1) + k);
}

std::string refusal_of(const std::vector<Assignment>& more, int pictures = 2, int channels = 1,
                       int alpha = -1) {
    try {
        drawn_by(more, waves, pictures, channels, alpha);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

struct Vec {
    Real x, y;
};

/// Where the point goes in picture k at time t: eq. 5.9 to 5.11 with a = 1, b = 2, p = 1/2.
Vec feature_point(Vec at, int k, Real t) {
    const Real lines[2][2][4] = {{{5, 6, 12, 8}, {7, 5, 14, 11}}, {{18, 20, 8, 19}, {17, 21, 9, 17}}};
    Vec sum{0, 0};
    Real weights = 0;
    for (const auto& line : lines) {
        Real l[4];
        for (int i = 0; i < 4; ++i) l[i] = line[0][i] * (1 - t) + line[1][i] * t;
        const Vec along{l[2] - l[0], l[3] - l[1]}, from{at.x - l[0], at.y - l[1]};
        const Real length = std::hypot(along.x, along.y);
        const Real u = (from.x * along.x + from.y * along.y) / (length * length),
                   v = (-from.x * along.y + from.y * along.x) / length;
        const Real* s = line[k];
        const Vec to{s[2] - s[0], s[3] - s[1]};
        const Real size = std::hypot(to.x, to.y);
        const Vec point{s[0] + u * to.x - v * to.y / size, s[1] + u * to.y + v * to.x / size};
        const Real distance = u < 0   ? std::hypot(from.x, from.y)
                              : u > 1 ? std::hypot(at.x - l[2], at.y - l[3])
                                      : std::fabs(v);
        const Real weight = std::pow(std::sqrt(length) / (1 + distance), 2);
        sum.x += weight * (point.x - at.x);
        sum.y += weight * (point.y - at.y);
        weights += weight;
    }
    return {at.x + sum.x / weights, at.y + sum.y / weights};
}

/// The Hermite patch through displacements at vertices, with Catmull-Rom derivatives, of a mesh of n x n cells.
Vec hermite_point(Vec at, int k, Real t, int n) {
    const Real cell = Real{kSide} / n;
    const auto displacement = [&](int i, int j) {
        const Vec p{i * cell, j * cell}, to = feature_point(p, k, t);
        return Vec{to.x - p.x, to.y - p.y};
    };
    // One beyond the border on either side, extrapolated.
    std::vector<std::vector<Vec>> d(static_cast<std::size_t>(n + 3),
                                    std::vector<Vec>(static_cast<std::size_t>(n + 3)));
    const auto twice = [](const Vec& a, const Vec& b) { return Vec{2 * a.x - b.x, 2 * a.y - b.y}; };
    const auto m = static_cast<std::size_t>(n);
    for (std::size_t i = 1; i <= m + 1; ++i)
        for (std::size_t j = 1; j <= m + 1; ++j)
            d[i][j] = displacement(static_cast<int>(i) - 1, static_cast<int>(j) - 1);
    for (std::size_t i = 1; i <= m + 1; ++i) {
        d[i][0] = twice(d[i][1], d[i][2]);
        d[i][m + 2] = twice(d[i][m + 1], d[i][m]);
    }
    for (std::size_t j = 0; j <= m + 2; ++j) {
        d[0][j] = twice(d[1][j], d[2][j]);
        d[m + 2][j] = twice(d[m + 1][j], d[m][j]);
    }
    const auto cubic = [](Real s, Real a, Real b, Real da, Real db) {
        return a * (2 * s * s * s - 3 * s * s + 1) + b * (3 * s * s - 2 * s * s * s) +
               da * (s * s * s - 2 * s * s + s) + db * (s * s * s - s * s);
    };
    const auto i = static_cast<std::size_t>(at.x / cell), j = static_cast<std::size_t>(at.y / cell);
    const Real s = at.x / cell - i, r = at.y / cell - j;
    // The tensor product is the cubic across of cubics down.
    const auto coordinate = [&](Real Vec::*c) {
        Real down[4];
        for (std::size_t a = 0; a < 4; ++a) {
            const auto& column = d[i + a];
            down[a] = cubic(r, column[j + 1].*c, column[j + 2].*c, (column[j + 2].*c - column[j].*c) / 2,
                            (column[j + 3].*c - column[j + 1].*c) / 2);
        }
        return cubic(s, down[1], down[2], (down[2] - down[0]) / 2, (down[3] - down[1]) / 2);
    };
    return {at.x + coordinate(&Vec::x), at.y + coordinate(&Vec::y)};
}

TEST(MorphUnit, SourcePointsAreThoseOfTheEquationsOnAMesh) {
    for (const int k : {0, 1})
        for (const int cells : {2, 5}) {
            const std::string machine =
                "kim-2003:levels=0,arithmetic=float32,table_size=1024,weight_bits=20,address_bits=20,cells=" +
                std::to_string(cells);
            const Drawn points = drawn_by(
                {{"t", "0.3"}, {"machine", machine}, {"output", "stmap"}, {"picture", k == 0 ? "a" : "b"}},
                waves);
            double most = 0;
            for (int y = 0; y < kSide; ++y)
                for (int x = 0; x < kSide; ++x) {
                    const Vec exact = hermite_point({x + 0.5L, y + 0.5L}, k, 0.3L, cells);
                    const auto i = static_cast<std::size_t>(2 * (y * kSide + x));
                    most = std::max({most, std::fabs(static_cast<double>(points.values[i] * kSide - exact.x)),
                                     std::fabs(static_cast<double>(points.values[i + 1] * kSide - exact.y))});
                }
            EXPECT_LT(most, 0.003) << k << " " << cells;
        }
}

/// `output=error` is the distance from the features' own map.
TEST(MorphUnit, ErrorsAreThoseAgainstTheFeatures) {
    const std::vector<Assignment> values = {{"t", "0.3"}, {"picture", "b"}, {"machine", "kim-2003:cells=6"}};
    const auto with = [&](const char* output) {
        std::vector<Assignment> all = values;
        all.push_back({"output", output});
        return drawn_by(all, waves);
    };
    const Drawn errors = with("error"), points = with("stmap"), bounds = with("bound");
    double most = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const auto i = static_cast<std::size_t>(y * kSide + x);
            const Vec exact = feature_point({x + 0.5L, y + 0.5L}, 1, 0.3L);
            const auto off = static_cast<double>(std::hypot(points.values[2 * i] * kSide - exact.x,
                                                            points.values[2 * i + 1] * kSide - exact.y));
            ASSERT_NEAR(errors.values[i], off, 1e-5);
            ASSERT_LE(errors.values[i], bounds.values[i]);
            most = std::max(most, off);
        }
    EXPECT_GT(most, 0.01);
    EXPECT_NEAR(errors.says.at("anamorph:max_error"), most, 1e-5);
    // Finer about the features and over all of the picture it is better.
    std::vector<Assignment> finer = values;
    finer[2].value = "kim-2003:cells=24";
    EXPECT_LT(drawn_by(finer, waves).says.at("anamorph:max_error"), most / 3);
}

/// Points at which the equations are evaluated: of 12 x 12 cells 169, as section 6.2 counts, and what cells that are cut add.
TEST(MorphUnit, MeshesAreFinerWhereFeaturesAre) {
    const auto map_of = [](const Line& line) {
        Features features;
        features.add_line({line, line});
        return FeatureMap(features, {{120, 120}, {120, 120}}, {120, 120}, {0.5, 0.5}, {});
    };
    MorphUnit unit;
    unit.levels = 0;
    const Line inside{{12, 12}, {18, 17}}, across{{12, 12}, {28, 13}};
    EXPECT_EQ(morph_meshes(map_of(inside), unit).evaluations, 169);
    unit.levels = 1;
    // One cell's middle; two cells' middles and that of their common edge; a corner's cell has two edges on the border too.
    EXPECT_EQ(morph_meshes(map_of(inside), unit).evaluations, 170);
    EXPECT_EQ(morph_meshes(map_of(across), unit).evaluations, 172);
    EXPECT_EQ(morph_meshes(map_of({{1, 1}, {8, 9}}), unit).evaluations, 172);
    const MorphMeshes meshes = morph_meshes(map_of(across), unit);
    ASSERT_EQ(meshes.meshes.size(), 2u);
    ASSERT_EQ(meshes.meshes[0].levels.size(), 1u);
    ASSERT_EQ(meshes.meshes[0].levels[0].cells.size(), 2u);
    EXPECT_EQ(meshes.meshes[0].levels[0].cells[0].column, 1);
    EXPECT_EQ(meshes.meshes[0].levels[0].cells[1].column, 2);
    // A level more: of four quarters the line meets one.
    unit.levels = 2;
    EXPECT_EQ(morph_meshes(map_of({{11, 11}, {13, 14}}), unit).evaluations, 171);
}

/// One number a picture: what is blended are integers.
TEST(MorphUnit, TheFrameBufferHoldsEightBits) {
    for (int n = 0; n <= 20; ++n) {
        const double t = n / 20.0, a = 0.31, b = 0.87;
        const auto flat = [&](int k, int, int, int) { return k == 0 ? a : b; };
        const Drawn drawn = drawn_by({{"t", shortest(t)}, {"machine", "kim-2003:arithmetic=float32"}}, flat);
        const long of_a = std::lround(255 * a), of_b = std::lround(255 * b),
                   alpha = std::lround(255 * double{static_cast<float>(t)});
        const long expected = n == 0    ? of_a
                              : n == 20 ? of_b
                                        : std::lround((of_b * alpha + of_a * (255 - alpha)) / 255.0);
        for (const float value : drawn.values) ASSERT_EQ(value, static_cast<float>(expected / 255.0)) << t;
    }
    const auto flat = [](int k, int, int, int) { return k == 0 ? 0.31 : 0.87; };
    EXPECT_NEAR(drawn_by({{"t", "0.3"}, {"machine", "kim-2003:buffer=float32"}}, flat).values[0],
                0.7 * 0.31 + 0.3 * 0.87, 1e-5);
    EXPECT_NEAR(drawn_by({{"t", "0.3"}, {"machine", "kim-2003:buffer=A16B16G16R16"}}, flat).values[0],
                0.7 * 0.31 + 0.3 * 0.87, 3e-5);
}

/// Three pictures, each blended over those before by its part.
TEST(MorphUnit, MorePicturesAreBlendedOneAfterTheOther) {
    const std::string lines = R"({"features": [{"line": [[5, 6, 12, 8], [7, 5, 14, 11], [5, 7, 12, 9]]}]})";
    const auto flat = [](int k, int, int, int) { return 0.2 + 0.3 * k; };
    const Drawn drawn = drawn_by(
        {{"shape_weights", "0.5,0.3,0.2"}, {"machine", "kim-2003:buffer=float32,arithmetic=float32"}}, flat,
        3, 1, -1, lines);
    EXPECT_NEAR(drawn.values[40], 0.5 * 0.2 + 0.3 * 0.5 + 0.2 * 0.8, 1e-6);
}

TEST(MorphUnit, SameBitsInAnyPart) {
    const std::vector<Assignment> values = {{"t", "0.4"}, {"filter", "bilinear"}};
    const Drawn whole = drawn_by(values, waves, 2, 3);
    const Box part{7, 3, 20, 19};
    const Drawn cut = drawn_by(values, waves, 2, 3, -1, kLines, part);
    for (int y = part.y0; y < part.y1; ++y)
        for (int i = 0; i < 3 * part.width(); ++i)
            ASSERT_EQ(cut.values[static_cast<std::size_t>((y - part.y0) * 3 * part.width() + i)],
                      whole.values[static_cast<std::size_t>((y * kSide + part.x0) * 3 + i)]);
    // At t = 0 the first picture is there, in 8 bits.
    const Drawn first = drawn_by(
        {{"t", "0"}, {"filter", "bilinear"}, {"machine", "kim-2003:arithmetic=float32,address_bits=16"}},
        waves);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            ASSERT_NEAR(first.values[static_cast<std::size_t>(y * kSide + x)], waves(0, x, y, 0), 0.51 / 255);
}

TEST(MorphUnit, WhatItCannotDoIsSaid) {
    EXPECT_EQ(refusal_of({{"t", "0.5"}}), "");
    EXPECT_EQ(refusal_of({{"t", "0.5"}, {"t_color", "1.5"}}),
              "machine: kim-2003 blends by an alpha from 0 to 1: the weight of picture a is -0.5");
    EXPECT_EQ(refusal_of({{"t", "1.5"}, {"t_color", "1"}}), "");
    EXPECT_EQ(refusal_of({{"output", "lines"}}), "output=lines: must be another with scheme=hardware");
    EXPECT_THAT(refusal_of({{"overscan", "5"}}), HasSubstr("must not be given with scheme=hardware"));
    EXPECT_EQ(
        refusal_of({}, 2, 4, 3),
        "picture a has 4 channels with alpha: must have at most 3 without alpha with scheme=hardware, which "
        "writes an alpha of its own");
    EXPECT_THAT(refusal_of({}, 2, 5), HasSubstr("picture a has 5 channels: must have at most 3"));
    EXPECT_THAT(refusal_of({{"machine", "kim-2003:texture_side=16"}}),
                HasSubstr("a source of 26x26 does not fit its textures"));
    EXPECT_EQ(refusal_of({{"machine", "kim-2003:cells=0"}}),
              "machine: cells=0: must be an integer from 1 to 128");
    EXPECT_EQ(refusal_of({{"machine", "kim-2003:levels=4"}}),
              "machine: levels=4: must be an integer from 0 to 3");
    EXPECT_EQ(refusal_of({{"machine", "kim-2003:buffer=8"}}),
              "machine: buffer=8: must be one of A16B16G16R16, X8R8G8B8, float32");
    EXPECT_THAT(refusal_of({{"machine", "kim-2003:alpha=1"}}), HasSubstr("\"alpha\": no such key"));
    EXPECT_EQ(refusal_of({{"machine", "ps20"}}),
              "machine=ps20: must be kim-2003, kim-2003:key=value,key=value or an object of JSON, {...}");
    EXPECT_EQ(refusal_of({{"scheme", "auto"}, {"machine", "new"}}).substr(0, 12), "machine=new:");
    EXPECT_EQ(refusal_of({{"scheme", "auto"}, {"machine", "kim-2003"}}),
              "machine=kim-2003: must be given with scheme=hardware only");
}

}  // namespace
}  // namespace anamorph::test_morph_unit
