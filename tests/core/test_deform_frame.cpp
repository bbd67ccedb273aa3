// SPDX-License-Identifier: Apache-2.0
// Bumps with frames of their own, held against long double written out; their mirror images and names, and their files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <vector>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/deform/deformation_reach.h"
#include "anamorph/deform/deformed_surface.h"
#include "anamorph/deform/plane_warp.h"
#include "anamorph/error.h"
#include "each_instruction_set.h"

namespace anamorph::test_deform_frame {
namespace {

using ::testing::HasSubstr;
using Real = long double;
using Real3 = std::array<Real, 3>;

class Random {
  public:
    explicit Random(unsigned seed) : m_engine(seed) {}
    double number(double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(m_engine);
    }
    glm::dvec4 turn() { return {number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)}; }

  private:
    std::mt19937 m_engine;
};

/// Bumps with frames of all sizes; `ratio`: of their extents.
std::vector<Deformation> bumps(unsigned seed, int count, double ratio) {
    Random random(seed);
    std::vector<Deformation> list;
    for (int k = 0; k < count; ++k) {
        Deformation d;
        d.vector = {random.number(-1, 1), random.number(-1, 1), random.number(-1, 1)};
        d.center = {random.number(0, 1), random.number(0, 1)};
        d.center_w = random.number(-.5, .5);
        const auto extent = [&] { return .6 * std::pow(ratio, -random.number(0, 1)); };
        d.extent = {extent(), extent()};
        d.extent_w = extent();
        d.orientation = std::pow(10., k % 5 - 2) * random.turn();
        if (k % 2) d.kernel = DeformationKernel::wendland_c2;
        if (k % 3 == 2) d.side = k % 2 ? DeformationSide::front : DeformationSide::back;
        list.push_back(d);
    }
    return list;
}

Real3 cross(const Real3& a, const Real3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// F S of a bump at a point, with the frame as a turn of the difference by the quaternion's conjugate.
Real share_of(const Deformation& d, const Real3& p, glm::dvec3 n) {
    const Real3 q{d.orientation.y, d.orientation.z, d.orientation.w},
        from{p[0] - d.center.x, p[1] - d.center.y, p[2] - d.center_w};
    const Real w = d.orientation.x, length = w * w + q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    const Real3 once = cross(q, from), twice = cross(q, once);
    const Real extent[3] = {d.extent.x, d.extent.y, d.extent_w};
    Real squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Real x = (from[k] + 2 * (twice[k] - w * once[k]) / length) / extent[k];
        squared += x * x;
    }
    const Real r = std::sqrt(squared);
    Real f = d.kernel == DeformationKernel::gaussian ? std::exp(-squared)
             : r < 1                                 ? std::pow(1 - r, Real(4)) * (4 * r + 1)
                                                     : 0;
    if (d.side != DeformationSide::both) {
        const Real size = std::sqrt(Real(d.vector.x) * d.vector.x + Real(d.vector.y) * d.vector.y +
                                    Real(d.vector.z) * d.vector.z);
        Real t = 2 * (d.vector.x * n.x + d.vector.y * n.y + d.vector.z * n.z) / size;
        if (d.side == DeformationSide::back) t = -t;
        t = std::min(std::max(t, Real(0)), Real(1));
        f *= t * t * (3 - 2 * t);
    }
    return f;
}

struct Cloud {
    std::vector<glm::dvec2> parameters;
    PointDepths depths;

    Real3 place(std::size_t i) const { return {parameters[i].x, parameters[i].y, depths.w[i]}; }
};
Cloud cloud(unsigned seed, int count, const std::vector<Deformation>& list) {
    Random random(seed);
    Cloud points;
    for (int i = 0; i < count; ++i) {
        // Half of them near a bump, however thin.
        glm::dvec3 p(random.number(-.2, 1.2), random.number(-.2, 1.2), random.number(-.8, .8));
        if (i % 2) {
            const Deformation& d = list[static_cast<std::size_t>(i) % list.size()];
            const double far = 2 * std::min({d.extent.x, d.extent.y, d.extent_w});
            p = glm::dvec3(d.center, d.center_w) +
                far * glm::dvec3(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1));
        }
        points.parameters.push_back(glm::dvec2(p));
        points.depths.w.push_back(p.z);
        points.depths.normal.push_back(
            glm::normalize(glm::dvec3(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1)) +
                           glm::dvec3(0, 0, 1e-3)));
    }
    return points;
}

std::vector<double> written(DeformedPoints& surface, std::size_t count) {
    std::vector<double> out(3 * count);
    surface.write<double>(nullptr, out.data());
    return out;
}

std::string fault_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_LE(std::string(error.what()).size(), 400u);
        return error.what();
    }
    return "no fault";
}

TEST(DeformFrame, PointsAreWhereTheFormulaHasThem) {
    for (unsigned seed = 1; seed <= 3; ++seed)
        for (const double ratio : {1., 10., 1e3, 1e6})
            for (const double cutoff : {0., 1e-4}) {
                SCOPED_TRACE("seed " + std::to_string(seed) + ", ratio " + std::to_string(ratio));
                const std::vector<Deformation> list = bumps(seed, 24, ratio);
                const Cloud points = cloud(seed + 10, 3000, list);
                DeformedPoints surface(points.parameters, points.depths, {cutoff, 0x1p-44});
                surface.apply(difference({}, list));
                const std::vector<double> out = written(surface, 3000);
                Real most = 0, moved = 0;
                for (std::size_t i = 0; i < 3000; ++i) {
                    Real3 exact{};
                    for (const Deformation& d : list) {
                        const Real f = share_of(d, points.place(i), points.depths.normal[i]);
                        for (std::size_t c = 0; c < 3; ++c) exact[c] += d.vector[static_cast<int>(c)] * f;
                    }
                    for (std::size_t c = 0; c < 3; ++c) {
                        most = std::max(most, std::fabs(out[3 * i + c] - exact[c]));
                        moved = std::max(moved, std::fabs(exact[c]));
                    }
                    const glm::dvec3 read = displacement_at(list, points.parameters[i], points.depths.w[i],
                                                            points.depths.normal[i]);
                    for (std::size_t c = 0; c < 3; ++c)
                        ASSERT_NEAR(read[static_cast<int>(c)], static_cast<double>(exact[c]),
                                    1e-13 * (ratio + 1));
                }
                EXPECT_LE(most, surface.error_bound());
                EXPECT_LT(surface.error_bound(), 20 * cutoff + 1e-13 * (ratio + 10));
                EXPECT_GT(moved, .3);
            }
}

TEST(DeformFrame, DerivativesAreThoseOfTheFormula) {
    const unsigned seed = 5;
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::vector<Deformation> list = bumps(seed, 20, 4);
    const Cloud points = cloud(6, 1500, list);
    DeformedPoints surface(points.parameters, points.depths, {0, 0x1p-50});
    Real most = 0;
    surface.slopes(list, nullptr, [&](const SurfaceSlopes& slopes) {
        ASSERT_EQ(slopes.parameters, 6);
        for (int k = 0; k < slopes.count; ++k) {
            const auto i = static_cast<std::size_t>(slopes.point(k));
            const Real h = 1e-5L;
            for (std::size_t way = 0; way < 3; ++way) {
                Real3 exact{};
                for (const Deformation& d : list) {
                    const auto at = [&](Real step) {
                        Real3 p = points.place(i);
                        p[way] += step;
                        return share_of(d, p, points.depths.normal[i]);
                    };
                    // Central differences of the fourth order.
                    const Real by = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
                    for (std::size_t c = 0; c < 3; ++c) exact[c] += d.vector[static_cast<int>(c)] * by;
                }
                for (std::size_t c = 0; c < 3; ++c)
                    most = std::max(most, std::fabs(slopes.by[3 * way + c][k] - exact[c]));
            }
        }
    });
    EXPECT_LT(most, 1e-9);
    EXPECT_GT(most, 0);
}

TEST(DeformFrame, SameBitsForAnyHistoryAndInstructions) {
    const std::vector<Deformation> list = bumps(4, 20, 100), others = bumps(77, 12, 1e5);
    const Cloud points = cloud(3, 3001, list);
    std::vector<double> expected;
    double bound = 0;
    test::on_every_instruction_set([&] {
        DeformedPoints surface(points.parameters, points.depths, {});
        surface.apply(difference({}, list));
        const std::vector<double> out = written(surface, 3001);
        if (expected.empty()) expected = out;
        EXPECT_EQ(out, expected);
        bound = surface.error_bound();
    });
    DeformedPoints surface(points.parameters, points.depths, {});
    std::vector<double> out(3 * 3001);
    surface.write<double>(nullptr, out.data());
    for (const Deformation& d : others) surface.apply(DeformationChange{std::nullopt, d});
    for (auto d = list.rbegin(); d != list.rend(); ++d) surface.apply(DeformationChange{std::nullopt, *d});
    surface.update<double>(nullptr, out.data());
    EXPECT_NE(out, expected);
    for (const Deformation& d : others) surface.apply(DeformationChange{d, std::nullopt});
    surface.update<double>(nullptr, out.data());
    EXPECT_EQ(out, expected);
    EXPECT_EQ(surface.error_bound(), bound);
    // Many cells: what a bump reaches is not missed.
    std::vector<Deformation> thin = bumps(9, 40, 1e4);
    const Cloud many = cloud(10, 100000, thin);
    DeformedPoints cells(many.parameters, many.depths, {1e-3, 0x1p-40});
    cells.apply(difference({}, thin));
    const std::vector<double> in_cells = written(cells, 100000);
    for (std::size_t i = 0; i < 100000; i += 7) {
        DeformedPoints one(std::span(&many.parameters[i], 1), {{many.depths.w[i]}, {many.depths.normal[i]}},
                           {1e-3, 0x1p-40});
        one.apply(difference({}, thin));
        const std::vector<double> alone = written(one, 1);
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(in_cells[3 * i + c], alone[c]) << i;
    }
}

TEST(DeformFrame, AFrameLaysTheDepthAlongANormal) {
    Random random(21);
    for (int k = 0; k < 2000; ++k) {
        glm::dvec3 n(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1));
        if (k % 4 == 1) n = {random.number(-1e-9, 1e-9), random.number(-1e-9, 1e-9), -1};
        if (k % 4 == 2) n *= std::pow(10., k % 600 - 300);
        if (k == 3) n = {0, 0, -5};
        if (k == 7) n = {0, 0, 1e-300};
        Deformation d;
        d.orientation = frame_at(n);
        const auto turn = turn_of<double>(d);
        const double largest = std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)});
        const glm::dvec3 unit = glm::normalize(n / largest);
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(turn[static_cast<std::size_t>(j)][2], unit[j], 3e-15);
    }
    EXPECT_THAT(fault_of([] { frame_at({0, 0, 0}); }), HasSubstr("normal=0,0,0: must have a direction"));
    EXPECT_THAT(fault_of([] { frame_at({0, std::nan(""), 0}); }), HasSubstr("must have a direction"));
    // Without a turn a bump has the bits that it has without a frame.
    Deformation d;
    EXPECT_FALSE(d.has_frame());
    d.orientation = {-3, 0, 0, 0};
    EXPECT_FALSE(d.has_frame());
}

TEST(DeformFrame, WhatMakesNoFrameIsRefused) {
    Deformation d;
    d.orientation = {1, 0, 0, 1};
    EXPECT_THAT(fault_of([&] { check_deformation(d); }), HasSubstr("the extent must have a third number"));
    d.extent_w = 1;
    EXPECT_EQ(fault_of([&] { check_deformation(d); }), "no fault");
    for (const glm::dvec4 q : {glm::dvec4(0.0), glm::dvec4(1e-101, 0, 0, 0), glm::dvec4(0, 1e101, 0, 0)}) {
        d.orientation = q;
        EXPECT_THAT(fault_of([&] { check_deformation(d); }), HasSubstr("orientation="));
    }
    for (const double bad : {std::nan(""), HUGE_VAL}) {
        d.orientation = {1, 0, bad, 0};
        EXPECT_THAT(fault_of([&] { check_deformation(d); }), HasSubstr("must be a finite number"));
    }
    d.orientation = {0, 1, 1, 0};
    d.extent = {1, 0x1p-20};
    EXPECT_EQ(fault_of([&] { check_deformation(d); }), "no fault");
    d.extent = {1, 0x1.fp-21};
    EXPECT_THAT(fault_of([&] { check_deformation(d); }), HasSubstr("at most 2^20 times the least"));
    EXPECT_THAT(fault_of([&] { PlaneWarp({}, {d}); }), HasSubstr("at most 2^20"));
    d.extent = {1, 1};
    d.vector = {1, 0, 0};
    EXPECT_THAT(fault_of([&] {
                    DeformedGrid({0, 1}, {0, 1}).apply(DeformationChange{std::nullopt, d});
                }),
                HasSubstr("extent=1: there are no depths"));
    // So many with frames so thin that their error has no room.
    d.extent = {1, 0x1p-20};
    DisplacementSum sum({0, 0x1p-45});
    d.vector = {1, 1, 1};
    bool refused = false;
    for (int k = 0; k < 100000 && !refused; ++k) {
        const double before = sum.error_bound();
        const DeformationChange change{std::nullopt, d};
        refused = fault_of([&] { sum.apply(std::span(&change, 1)); }) != "no fault";
        if (refused) {
            EXPECT_EQ(sum.error_bound(), before);
        }
        EXPECT_GE(sum.error_bound(), before);
    }
    EXPECT_TRUE(refused);
}

// --- Images

TEST(DeformMirror, ImagesAreWhatTheMirrorShows) {
    for (const DeformationMirror mirror : {DeformationMirror::u, DeformationMirror::v}) {
        const std::size_t axis = mirror == DeformationMirror::u ? 0 : 1;
        const double at = .375;
        std::vector<DeformationEntry> entries;
        for (const Deformation& d : bumps(31, 15, 5)) {
            entries.emplace_back(d);
            entries.back().mirror = mirror;
            entries.back().mirror_at = at;
        }
        const DeformationsWithImages all = with_images(entries);
        ASSERT_EQ(all.list.size(), 30u);
        const Cloud points = cloud(32, 500, bumps(31, 15, 5));
        for (std::size_t k = 0; k < 15; ++k) {
            EXPECT_EQ(all.list[k], entries[k].deformation);
            EXPECT_EQ(all.entry[15 + k], k);
            // The image at the mirrored point, with the mirrored normal, is the mirrored displacement.
            for (std::size_t i = 0; i < 500; ++i) {
                Real3 there = points.place(i);
                there[axis] = 2 * Real(at) - there[axis];
                glm::dvec3 normal = points.depths.normal[i];
                normal[static_cast<int>(axis)] *= -1;
                EXPECT_NEAR(
                    static_cast<double>(share_of(all.list[k], points.place(i), points.depths.normal[i])),
                    static_cast<double>(share_of(all.list[15 + k], there, normal)), 1e-14);
            }
            glm::dvec3 vector = all.list[k].vector;
            vector[static_cast<int>(axis)] *= -1;
            EXPECT_EQ(all.list[15 + k].vector, vector);
        }
    }
    // On the line, and along it, a bump is its own image.
    DeformationEntry own;
    own.deformation.center = {.5, .3};
    own.deformation.vector = {0, 1, 2};
    own.mirror = DeformationMirror::u;
    own.mirror_at = .5;
    EXPECT_EQ(with_images({own}).list.size(), 1u);
    own.deformation.vector.x = 1;
    EXPECT_EQ(with_images({own}).list.size(), 2u);
    // Where steps are not at right angles, along the other parameter nothing changes.
    MirrorSteps steps;
    const ParameterPlane plane({0, 0, 0}, {1, 0, 0}, {.5, 2, 0});
    steps = {plane.axis_u(), plane.gradient_u(), plane.axis_v(), plane.gradient_v()};
    own.deformation.center.x = 0;
    own.deformation.vector = plane.axis_v();
    EXPECT_EQ(with_images({own}, steps).list[1].vector, plane.axis_v());
    own.deformation.vector = plane.axis_u();
    EXPECT_EQ(with_images({own}, steps).list[1].vector, -plane.axis_u());
}

TEST(DeformMirror, FilesHaveFramesImagesAndNames) {
    const std::string json = R"({"deformations": [
        {"vector": [1, 0, 2], "center": [0.25, 2, 3], "extent": [4, 5, 6], "orientation": [1, 2, 0.5, -1],
         "mirror": "u", "mirror_at": 0.5, "name": "left \\ brow"},
        {"vector": [0, 0, 1], "center": [1, 2], "extent": [4, 5], "name": "chin"}]})";
    const std::vector<DeformationEntry> list = parse_entries_json(json, "a.json");
    ASSERT_EQ(list.size(), 2u);
    EXPECT_EQ(list[0].deformation.orientation, glm::dvec4(1, 2, .5, -1));
    EXPECT_EQ(list[0].mirror, DeformationMirror::u);
    EXPECT_EQ(list[0].mirror_at, .5);
    EXPECT_EQ(list[0].name, "left \\ brow");
    EXPECT_EQ(list[1].name, "chin");
    EXPECT_EQ(list[1].mirror, DeformationMirror::none);
    EXPECT_EQ(parse_entries_json(entries_json(list), "a.json"), list);
    EXPECT_EQ(parse_entries_csv(entries_csv(list), "a.csv"), list);
    const std::string csv =
        "# a face\n0.25,2,4,5,1,0,2,gaussian,1,3,6,both,1,2,0.5,-1,u,0.5,left \\ brow\n"
        "1,2,4,5,0,0,1,gaussian,1,0,0,both,1,0,0,0,none,0,chin\n";
    EXPECT_EQ(parse_entries_file(csv, "A.CSV"), list);
    EXPECT_EQ(parse_entries_csv("1,2,4,5,0,0,1,gaussian,1,3,6,both,1,2,0.5,-1\n", "a.csv")[0]
                  .deformation.orientation,
              glm::dvec4(1, 2, .5, -1));
    // What surfaces read has the images.
    const std::vector<Deformation> all = parse_deformations_json(json, "a.json");
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(all[2].center.x, .75);
    EXPECT_EQ(all[2].vector, glm::dvec3(-1, 0, 2));
    EXPECT_EQ(all[2].orientation, glm::dvec4(1, 2, -.5, 1));
    EXPECT_EQ(parse_deformations_csv(csv, "a.csv"), all);
    // Random lists read back to the bit.
    Random random(44);
    std::vector<DeformationEntry> many;
    for (const Deformation& d : bumps(45, 60, 100)) {
        many.emplace_back(d);
        many.back().mirror = static_cast<DeformationMirror>(static_cast<int>(random.number(0, 3)));
        many.back().mirror_at = random.number(-1, 1);
        if (random.number(0, 1) < .7) many.back().name = "bump \xc3\xa9 #" + std::to_string(many.size());
    }
    EXPECT_EQ(parse_entries_json(entries_json(many), "a.json"), many);
    EXPECT_EQ(parse_entries_csv(entries_csv(many), "a.csv"), many);
}

TEST(DeformMirror, BadFilesAreRefused) {
    const auto with = [](const std::string& more) {
        return fault_of([&] {
            parse_deformations_json(
                R"({"deformations": [{"vector": [0, 0, 1], "center": [0, 0, 0], "extent": [1, 1, 1], )" +
                    more + "}]}",
                "x.json");
        });
    };
    EXPECT_EQ(with(R"("name": "")"), "no fault");
    for (const auto& [more, words] : std::vector<std::pair<std::string, std::string>>{
             {R"("mirror": "w")", "mirror=w: must be none, u or v"},
             {R"("mirror": 1)", "mirror: must be a name in quotes"},
             {R"("mirror_at": "0")", "mirror_at: must be a number"},
             {R"("mirror": "u", "mirror_at": 1e308)", "mirror_at=1e+308: the centre of the image"},
             {R"("orientation": [1, 0, 0])", "orientation: must be a list of 4 numbers"},
             {R"("orientation": [0, 0, 0, 0])", "orientation=0: "},
             {R"("name": 3)", "name: must be a name in quotes"},
             {R"("name": "a,b")", "without commas"},
             {R"("name": " a")", "without blanks at its ends"},
             {R"("name": "a\nb")", "control characters"},
             {R"("name": ")" + std::string(101, 'a') + "\"", "at most 100 bytes"},
             {R"("names": "a")", "names: must be one of"}})
        EXPECT_THAT(with(more), HasSubstr(words));
    for (const std::string row :
         {"0,0,1,1,0,0,1,gaussian,1,0,1,both,1", "0,0,1,1,0,0,1,gaussian,1,0,1,both,1,0,0,0,u",
          "0,0,1,1,0,0,1,gaussian,1,0,1,both,1,0,0,0,u,0,a,b"})
        EXPECT_THAT(fault_of([&] { parse_deformations_csv(row, "x.csv"); }), HasSubstr("fields")) << row;
}

}  // namespace
}  // namespace anamorph::test_deform_frame
