// SPDX-License-Identifier: Apache-2.0
// Motions and crystals as figures: what their files say, worked out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <random>

#include "anamorph/error.h"
#include "anamorph/figure/body/displacement.h"
#include "anamorph/figure/body/eigenvectors.h"
#include "anamorph/figure/files/frame_file.h"
#include "anamorph/figure/files/motion_file.h"

namespace anamorph::test_motion_file {
using namespace figure;
namespace {

using testing::HasSubstr;

std::string error_of(const std::string& text, const char* name) {
    try {
        read_motion(text, name);
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        return error.what();
    }
    return "none";
}

// An upper arm of 40 along x and a forearm of 30 on it; frame 2 moves the root and bends the elbow.
const std::string kArm = R"(HIERARCHY
ROOT upper arm
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT elbow {
    OFFSET 40 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 30 0 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.04
0 0 0 0 0 0   0 0 0
10 20 5 0 0 0   90 0 0
)";

/// The ends of a body's longest axis, the smaller x (then y) first.
std::pair<glm::dvec3, glm::dvec3> ends_of(const Body& body) {
    const glm::dvec3 along = body.shape.axes.y * body.shape.rotation[1];
    glm::dvec3 a = body.shape.center - along, b = body.shape.center + along;
    if (a.x > b.x + 1e-9 || (std::fabs(a.x - b.x) < 1e-9 && a.y > b.y)) std::swap(a, b);
    return {a, b};
}

TEST(Bvh, BonesAreEllipsoidsFromJointToJoint) {
    const auto motion = read_motion(kArm, "arm.bvh");
    EXPECT_EQ(motion->frame_count(), 2);
    EXPECT_DOUBLE_EQ(motion->frames_per_second(), 25);
    const FigureFrame first = motion->frame(1), second = motion->frame(2);
    ASSERT_EQ(first.bodies.size(), 2u);
    EXPECT_EQ(first.figures, std::vector<std::string>{"upper arm"});
    EXPECT_EQ(first.bodies[0].name, "upper arm");
    EXPECT_EQ(first.bodies[1].name, "elbow");
    ASSERT_EQ(first.joints.size(), 1u);
    // The joints' places in both frames: x from 0 to 70, y from 0 to 50; 70 units fill 900.
    const double scale = 900.0 / 70;
    const auto window = [&](double x, double y, double z) {
        return glm::dvec3(500 + scale * (x - 35), 500 + scale * (y - 25), 500 - scale * (z - 2.5));
    };
    const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::distance(a, b) < 1e-9; };
    EXPECT_TRUE(near(first.bodies[0].shape.center, window(20, 0, 0)));
    EXPECT_TRUE(near(first.bodies[1].shape.center, window(55, 0, 0)));
    EXPECT_TRUE(near(first.joints[0].position, window(40, 0, 0)));
    EXPECT_TRUE(near(second.bodies[0].shape.center, window(30, 20, 5)));
    EXPECT_TRUE(near(second.bodies[1].shape.center, window(50, 35, 5)));
    EXPECT_TRUE(near(second.joints[0].position, window(50, 20, 5)));
    // Longer than the bone by a little, and along it.
    const auto [low, high] = ends_of(second.bodies[1]);
    EXPECT_NEAR(glm::length(high - low), 1.08 * 30 * scale, 1e-9);
    EXPECT_NEAR(high.y - low.y, glm::length(high - low), 1e-9);
    for (const Body& body : second.bodies) EXPECT_NEAR(glm::determinant(body.shape.rotation), 1, 1e-12);
    // Frame 0 is the skeleton at rest.
    EXPECT_TRUE(near(motion->frame(0).bodies[1].shape.center, window(55, 0, 0)));
}

TEST(Bvh, TurnsAreMirroredWithSpace) {
    // About y by 90 degrees, x goes to -z, which away from the observer is +z.
    std::string text = kArm;
    text.replace(text.find("0 0 0 0 0 0   0 0 0"), 19, "0 0 0 0 0 90   0 0 0");
    const FigureFrame frame = read_motion(text, "arm.bvh")->frame(1);
    const glm::dvec3 along = frame.bodies[0].shape.rotation[1];
    EXPECT_NEAR(std::fabs(along.z), 1, 1e-12);
    EXPECT_GT(frame.bodies[1].shape.center.z, frame.bodies[0].shape.center.z);
}

TEST(Bvh, SaysWhatIsWrongAndWhere) {
    const auto with = [](const char* what, const char* instead) {
        std::string text = kArm;
        text.replace(text.find(what), std::string(what).size(), instead);
        return error_of(text, "arm.bvh");
    };
    EXPECT_EQ(with("OFFSET 40 0 0", "OFFSET 40 x 0"),
              "arm.bvh: line 7: \"x\" is here, but an offset must be here, a number from -1e9 to 1e9");
    EXPECT_THAT(with("Zrotation", "Wrotation"), HasSubstr("line 5: \"Wrotation\" is here, but a channel"));
    EXPECT_THAT(with("Frames: 2", "Frames: 3"), HasSubstr("the file ends, but the value of a channel"));
    // A frame more than the file says.
    EXPECT_EQ(with("Frames: 2", "Frames: 1"), "none");
    EXPECT_THAT(with("Frames: 2", "Frames: -1"), HasSubstr("the number of frames must be an integer from 0"));
    EXPECT_THAT(with("0.04", "0"), HasSubstr("the time of a frame must be at least 1e-6 seconds"));
    EXPECT_THAT(with("0.04", "1e-320"), HasSubstr("the time of a frame"));
    EXPECT_THAT(with("0.04", "nan"), HasSubstr("the time of a frame"));
    EXPECT_THAT(with("10 20", "inf 20"), HasSubstr("the value of a channel"));
    EXPECT_THAT(with("CHANNELS 3", "CHANNELS 9"), HasSubstr("an integer from 0 to 6"));
    EXPECT_THAT(with("ROOT", "JOINT"), HasSubstr("ROOT or MOTION must be here"));
    EXPECT_THAT(with("OFFSET 40 0 0", "OFFSET 0 0 0"), "none");
    EXPECT_THAT(error_of("", "a.bvh"), HasSubstr("HIERARCHY must be here"));
    EXPECT_THAT(error_of("HIERARCHY ROOT a { OFFSET 0 0 0 } MOTION Frames: 0 Frame Time: 1", "a.bvh"),
                HasSubstr("no bone"));
    EXPECT_THAT(error_of("HIERARCHY ROOT a { OFFSET 0 0 0 MOTION", "a.bvh"),
                HasSubstr("a } is missing before MOTION"));
    const auto motion = read_motion(kArm, "arm.BVH");
    EXPECT_THROW(motion->frame(3), Error);
    EXPECT_THROW(motion->frame(-1), Error);
}

TEST(Bvh, BranchesHangTogether) {
    const auto motion = read_motion(R"(HIERARCHY
ROOT hips { OFFSET 0 0 0 CHANNELS 0
JOINT left { OFFSET -10 0 0 CHANNELS 0 JOINT knee { OFFSET 0 0 0 CHANNELS 0 End Site { OFFSET 0 -40 0 } } }
JOINT right { OFFSET 10 0 0 CHANNELS 0 End Site { OFFSET 0 -40 0 } }
} MOTION Frames: 0 Frame Time: 1)",
                                    "legs.bvh");
    EXPECT_EQ(motion->frame_count(), 0);
    const FigureFrame frame = motion->frame(0);
    std::vector<std::string> names;
    for (const Body& body : frame.bodies) names.push_back(body.name);
    // The bone from left to knee has no length.
    EXPECT_THAT(names, testing::ElementsAre("hips-left", "knee", "hips-right", "right"));
    std::vector<std::pair<int, int>> joints;
    for (const Joint& joint : frame.joints) joints.push_back({joint.first, joint.second});
    EXPECT_THAT(joints, testing::ElementsAre(testing::Pair(0, 1), testing::Pair(0, 2), testing::Pair(2, 3)));
}

// --- Crystals

const std::string kCell = R"(data_test
_cell_length_a 10.0(2)
_cell_length_b 12
_cell_length_c 8
_cell_angle_alpha 90
_cell_angle_beta 110
_cell_angle_gamma 90
loop_
_atom_site_label _atom_site_type_symbol
_atom_site_fract_x _atom_site_fract_y _atom_site_fract_z _atom_site_U_iso_or_equiv
C1 C 0.1 0.2 0.3 0.02
O1 O2- 0.1(1) 0.3 0.3 .
'H 2' H 0.5 0.5 0.5 0.01
X1 ? ? 0 0 1
loop_
_atom_site_aniso_label
_atom_site_aniso_U_11 _atom_site_aniso_U_22 _atom_site_aniso_U_33
_atom_site_aniso_U_12 _atom_site_aniso_U_13 _atom_site_aniso_U_23
C1 0.02 0.03 0.05 0.001 0.012 -0.004
)";

TEST(Crystal, AtomsAreEllipsoidsOfDisplacement) {
    const FigureFrame frame = read_motion(kCell, "test.cif")->frame(1);
    ASSERT_EQ(frame.bodies.size(), 3u);
    EXPECT_EQ(frame.bodies[2].name, "H 2");
    // C and O are 1.2 Angstrom apart, a bond; H is far.
    ASSERT_EQ(frame.joints.size(), 1u);
    EXPECT_EQ(frame.joints[0].name, "C1-O1");
    const double scale = glm::distance(frame.bodies[0].shape.center, frame.bodies[1].shape.center) / 1.2;
    EXPECT_NEAR(frame.bodies[2].shape.axes.x, scale * 1.5381722544550522 * .1, 1e-6 * scale);
    EXPECT_NEAR(frame.bodies[1].shape.axes.x, scale * .15, 1e-9 * scale);
    // In directions along the reciprocal axes the mean square displacement is U_ii (International Tables D,
    // 1.9): <(u.n)^2> with n = a*/|a*| and the like.
    const double beta = 110 * std::numbers::pi / 180;
    const glm::dvec3 a(10, 0, 0), b(0, 12, 0), c(8 * std::cos(beta), 0, 8 * std::sin(beta));
    const glm::dvec3 reciprocal[3] = {glm::normalize(glm::cross(b, c)), glm::normalize(glm::cross(c, a)),
                                      glm::normalize(glm::cross(a, b))};
    const Ellipsoid& shape = frame.bodies[0].shape;
    const auto square_along = [&](glm::dvec3 n) {
        n.z = -n.z;
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            const double part = glm::dot(n, shape.rotation[k]) * shape.axes[k] / (scale * 1.5381722544550522);
            sum += part * part;
        }
        return sum;
    };
    EXPECT_NEAR(square_along(reciprocal[0]), .02, 1e-12);
    EXPECT_NEAR(square_along(reciprocal[1]), .03, 1e-12);
    EXPECT_NEAR(square_along(reciprocal[2]), .05, 1e-12);
    EXPECT_NEAR(glm::determinant(shape.rotation), 1, 1e-12);
    // U_13 is what is displaced along both a* and c*: from the sum of the two directions.
    const double both = square_along(reciprocal[0] + reciprocal[2]);
    EXPECT_NEAR((both - .02 - .05) / 2, .012, 1e-12);
}

/// The probability within s, by Simpson's rule over the density of distances in long double.
long double held_within(long double s) {
    const int steps = 20000;
    const auto density = [](long double r) {
        return std::sqrt(2 / std::numbers::pi_v<long double>) * r * r * std::exp(-r * r / 2);
    };
    long double sum = 0;
    for (int i = 0; i <= steps; ++i)
        sum += density(s * i / steps) * (i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2);
    return sum * s / steps / 3;
}

TEST(Crystal, EllipsoidsHoldWhatTheySay) {
    for (const double probability : {1e-12, 1e-3, .2, .4999999, .5, .5000001, .9, .999})
        EXPECT_NEAR(static_cast<double>(held_within(displacement_scale(probability)) / probability), 1, 1e-13)
            << probability;
    // Where 1 - probability counts: the quantiles of chi-squared with 3 degrees of freedom in tables, to the digits that these have.
    EXPECT_NEAR(std::pow(displacement_scale(.999), 2), 16.2662, 5e-5);
    EXPECT_NEAR(std::pow(displacement_scale(.99), 2), 11.3449, 5e-5);
    EXPECT_LT(displacement_scale(1 - 0x1p-53), 10);
    EXPECT_GT(displacement_scale(1e-300), 0);
    for (const double bad : {0., 1., -1., 2., static_cast<double>(NAN)})
        EXPECT_THROW(displacement_scale(bad), Error) << bad;
}

TEST(Crystal, AnotherProbabilityMovesNoAtom) {
    const FigureFrame half = read_motion(kCell, "test.cif")->frame(1),
                      most = read_motion(kCell, "test.cif", .9)->frame(1);
    const double larger = displacement_scale(.9) / displacement_scale(.5);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(half.bodies[i].shape.center, most.bodies[i].shape.center);
        // The second atom has no displacement.
        for (int k = 0; k < 3; ++k)
            EXPECT_DOUBLE_EQ(most.bodies[i].shape.axes[k],
                             half.bodies[i].shape.axes[k] * (i == 1 ? 1 : larger));
    }
    EXPECT_THROW(read_motion(kCell, "test.cif", 1), Error);
}

TEST(Crystal, SaysWhatIsWrong) {
    const auto with = [](const char* what, const char* instead) {
        std::string text = kCell;
        text.replace(text.find(what), std::string(what).size(), instead);
        return error_of(text, "test.cif");
    };
    EXPECT_EQ(with("_cell_length_b 12", ""), "test.cif: _cell_length_b: is missing");
    EXPECT_THAT(with("_cell_length_b 12", "_cell_length_b -1"), HasSubstr("must be at least 0.1"));
    EXPECT_THAT(with("_cell_length_b 12", "_cell_length_b 1e-160"), HasSubstr("must be at least 0.1"));
    EXPECT_THAT(with("_cell_length_b 12", "_cell_length_b twelve"),
                HasSubstr("line 3: _cell_length_b=twelve"));
    EXPECT_THAT(with("110", "0"), HasSubstr("angles of the cell must span a volume"));
    EXPECT_THAT(with("0.1 0.2 0.3 0.02", "0.1 nan 0.3 0.02"),
                HasSubstr("line 11: _atom_site_fract_y=nan: must be a number"));
    EXPECT_THAT(with("0.3 0.3 .\n", "0.3 far .\n"), HasSubstr("line 12: _atom_site_fract_z=far"));
    EXPECT_THAT(
        with("C1 C 0.1", "C1 C"),
        HasSubstr("line 8: a loop of 6 tags ends before line 15, after 23 values: must have whole rows"));
    EXPECT_THAT(error_of("data_x _cell_length_a", "a.cif"), HasSubstr("_cell_length_a has no value"));
    EXPECT_THAT(error_of("", "a.cif"), HasSubstr("_cell_length_a: is missing"));
    // Not positive definite: flat.
    std::string flat = kCell;
    flat.replace(flat.find("C1 0.02 0.03"), 12, "C1 0.02 -0.3");
    EXPECT_EQ(read_motion(flat, "a.cif")->frame(1).bodies[0].shape.axes.z, 0);
}

TEST(Crystal, ReadsTextFieldsQuotesAndComments) {
    const std::string text =
        "# a comment\ndata_first\n_publ_text\n;\n loop_ _cell_length_a 3\n;\n"
        "_name 'it''s' # 'quoted'\n_other \"a 'b' c\"\n" +
        kCell;
    EXPECT_EQ(read_motion(text, "a.cif")->frame(1).bodies.size(), 3u);
}

TEST(Eigenvectors, OfSymmetricMatrices) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 200; ++k) {
        glm::dmat3 a;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j <= i; ++j) a[i][j] = a[j][i] = normal(random);
        const glm::dmat3 v = eigenvectors(a);
        double before = HUGE_VAL;
        for (int i = 0; i < 3; ++i) {
            const double value = glm::dot(v[i], a * v[i]);
            EXPECT_LE(value, before + 1e-12);
            EXPECT_LE(glm::length(a * v[i] - value * v[i]), 1e-12);
            before = value;
        }
    }
}

// --- Frames

TEST(Frames, AreReadAsAMotion) {
    const auto arm = read_motion(kArm, "arm.bvh");
    std::string text = frame_text(arm->frame(1)) + frame_text(arm->frame(2));
    text += frames_end_text(arm->frame(2));
    const auto frames = read_motion(text, "arm.3");
    EXPECT_EQ(frames->frame_count(), 2);
    EXPECT_LE(glm::distance(frames->frame(2).bodies[1].shape.center, arm->frame(2).bodies[1].shape.center),
              .1);
    EXPECT_THAT(error_of("", "a.3"), HasSubstr("has no frame"));
}

}  // namespace
}  // namespace anamorph::test_motion_file
