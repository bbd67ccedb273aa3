// SPDX-License-Identifier: Apache-2.0
// Surfaces that are blended with designed ones (Oka 1987, 4.2): against (4.1) and (4.3) written out in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/operation/drape_surface.h"
#include "drape_oracle.h"

namespace anamorph::test_drape_blend {
using namespace surface;
namespace {

using test::Real;
using test::Vector;

/// Files in memory: texts, and images of three channels of which each texel's are its place and 1.
class Files final : public SideFileReader {
  public:
    std::map<std::string, std::string> texts;

    std::string text(const std::string& name) const override {
        const auto found = texts.find(name);
        if (found == texts.end()) throw Error(name + ": cannot be read");
        return found->second;
    }
    std::unique_ptr<SideImage> image(const std::string& key, const std::string& name) const override {
        if (name == "none.exr") throw Error(key, name, "cannot be opened");
        class Plane final : public SideImage {
          public:
            Size size() const override { return {9, 5}; }
            int channels() const override { return 3; }
            std::vector<float> read(int) override {
                std::vector<float> texels;
                for (int j = 0; j < 5; ++j)
                    for (int i = 0; i < 9; ++i)
                        for (const float value : {float(i), float(j), 1.0f}) texels.push_back(value);
                return texels;
            }
        };
        return std::make_unique<Plane>();
    }
};

SurfaceSum sum_of(const std::vector<Assignment>& assignments, const Files& reader) {
    ParameterValues values(*find_operation("drape")->parameters);
    values.assign(assignments);
    SideFiles files;
    for (const LinkedFile& file : files_of_blend(values)) files[file.key] = {file.name, "", file.image};
    if (values.given("deform")) files["deform"] = {values.text("deform"), ""};
    return DrapeSurfaces({values, {}, files, reader}, 1).sum_of(values);
}

/// V F of (4.1) and (4.2), v up.
Vector moved_by(const std::vector<Deformation>& list, Real u, Real v) {
    Vector sum{};
    for (const Deformation& d : list) {
        const Real x = (u - d.center.x) / d.extent.x, y = (1 - v - d.center.y) / d.extent.y;
        const Real share = std::exp(-x * x - y * y);
        for (std::size_t k = 0; k < 3; ++k) sum[k] += share * d.vector[static_cast<int>(k)];
    }
    return sum;
}

TEST(DrapeBlend, DesignedSurfacesAreWeighedAsThePaperSays) {
    constexpr unsigned kSeed = 42;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    const auto any = [&](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    std::map<std::string, std::vector<Deformation>> lists;
    Files files;
    for (const std::string name : {"smile.json", "frown.csv", "relief.json"}) {
        std::vector<Deformation>& list = lists[name];
        for (int k = 0; k < 6; ++k)
            list.push_back(
                {{any(-1, 1), any(-1, 1), any(-1, 1)}, {any(0, 1), any(0, 1)}, {any(0.1, 1), any(0.1, 1)}});
        files.texts[name] = name == "frown.csv" ? deformations_csv(list) : deformations_json(list);
    }
    const Real smile = 1.25L, frown = -0.5L, sphere = 0.375L;
    const auto made = make_surface(sum_of({{"surface", "cylinder"},
                                           {"deform", "relief.json"},
                                           {"blend", "smile.json,sphere,frown.csv"},
                                           {"weights", "1.25,0.375,-0.5"}},
                                          files));
    for (int k = 0; k < 500; ++k) {
        const double u = any(0, 1), v = any(0, 1);
        const Vector plain = test::oracle_surface("cylinder", SurfaceShape{}, u, v),
                     round = test::oracle_surface("sphere", SurfaceShape{}, u, v),
                     s = moved_by(lists["smile.json"], u, v), f = moved_by(lists["frown.csv"], u, v),
                     always = moved_by(lists["relief.json"], u, v);
        const glm::dvec3 at = made->position(u, v);
        const double allowed = made->rounding(u, v) + 1e-14;
        for (std::size_t c = 0; c < 3; ++c) {
            // (4.3), whose coefficients have the sum 1; what deforms the sum comes last.
            const Real rest = 1 - smile - frown - sphere;
            const Real expected = rest * plain[c] + smile * (plain[c] + s[c]) + frown * (plain[c] + f[c]) +
                                  sphere * round[c] + always[c];
            ASSERT_NEAR(at[static_cast<int>(c)], double(expected), allowed) << u << " " << v;
        }
    }
}

/// Positions of a file beside others, and the surface of its texels' places: texel centres at + 0.5.
TEST(DrapeBlend, PositionsOfFilesAreWeighedToo) {
    const Files files;
    const auto made = make_surface(
        sum_of({{"surface", "plane"}, {"blend", "baked.exr,other.exr"}, {"weights", "0.25,0.125"}}, files));
    for (int j = 1; j < 4; ++j)
        for (int i = 1; i < 8; ++i) {
            const double u = (i + 0.5) / 9, v = (j + 0.5) / 5;
            const glm::dvec3 at = made->position(u, v);
            EXPECT_NEAR(at.x, 0.625 * (u - 0.5) + 0.375 * i, 1e-12);
            EXPECT_NEAR(at.y, 0.625 * (0.5 - v) + 0.375 * j, 1e-12);
            EXPECT_NEAR(at.z, 0.375, 1e-12);
        }
}

TEST(DrapeBlend, WhatIsWrongIsNamed) {
    Files files;
    files.texts["smile.json"] =
        R"({"deformations": [{"vector": [0, 0, 1], "center": [0, 0], "extent": [1, 0]}]})";
    const auto message = [&](const std::string& blend, const std::string& weights) -> std::string {
        try {
            sum_of({{"blend", blend}, {"weights", weights}}, files);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_EQ(message("cube", "1"),
              "blend=cube: must be names of surfaces, separated by commas, or of files: lists of "
              "deformations (.json, .csv) "
              "or pictures of positions");
    EXPECT_EQ(message("smile.json", "1"),
              "smile.json: deformations[0]: extent=0: must be a number from 1e-300 to 1e+300");
    EXPECT_EQ(message("absent.json", "1"), "absent.json: cannot be read");
    EXPECT_EQ(message("none.exr", "1"), "blend=none.exr: cannot be opened");
    EXPECT_EQ(message("baked.exr", "inf"), "weights=inf: must be finite numbers, separated by commas");
    EXPECT_EQ(message("baked.exr", "2e6"), "weights=2e+06: must be numbers from -1e6 to 1e6");
    EXPECT_EQ(message("baked.exr,sphere", "1"), "weights=1 numbers: must be as many as surfaces in blend, 2");
    EXPECT_EQ(message("positions", "1"), "positions is not given: must be a picture of x, y and z");
}

}  // namespace
}  // namespace anamorph::test_drape_blend
