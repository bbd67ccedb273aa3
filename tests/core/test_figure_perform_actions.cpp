// SPDX-License-Identifier: Apache-2.0
// Scripts of our own, for what the scripts of the 1980s do not use. Expected values are derived by hand, as
// the comments say, or by a formula that the product does not use.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "anamorph/figure/body/ellipsoid_distance.h"
#include "figure_cases.h"

namespace anamorph::test_figure_perform_actions {
using namespace figure;
namespace {

using namespace figure_cases;
using testing::HasSubstr;

// a stands at the origin, b on top of it at y = 80; they meet at y = 40. c is alone, at the origin.
const std::string kTwo =
    "figure f 2 a b\nellipsoid a 10 40 20\nellipsoid b 10 40 20\njoint j a 0 40 0 b 0 -40 0\n"
    "figure g 1 c\nellipsoid c 5 5 5\n";

glm::dvec3 center(const FigureFrame& frame, const std::string& name) {
    return body_named(frame, name).shape.center;
}

// --- groell, cubic, texture, attach, detach: one script

// cubic over 4 frames: shares 1, 4, 4, 1 of 10. A factor of 16 so grows to 16^(0.1), 16^(0.5), 16^(0.9), 16.
TEST(FigureOwnScripts, GroellCubic) {
    Performance p = perform(kTwo + "cubic 0 4 groell a 1 16 0.5\nstop");
    const double shares[] = {0, 0.1, 0.5, 0.9, 1};
    for (int f = 1; f <= 4; ++f) {
        const FigureFrame frame = p.frame(f);
        expect_near(body_named(frame, "a").shape.axes,
                    {10, 40 * std::pow(16, shares[f]), 20 * std::pow(0.5, shares[f])}, 1e-12);
        EXPECT_EQ(center(frame, "a"), glm::dvec3(0));
        EXPECT_EQ(frame.joints[0].position, glm::dvec3(0, 40, 0));  // joints stay
    }
}

// c is put at x = 200 and attached to a at (0, 10, 5). Turning f by a right angle about z takes x to y and y
// to -x. Taken apart again, c stays where it is; the name h then means it, and f the rest.
TEST(FigureOwnScripts, AttachSpinDetach) {
    Performance p = perform(kTwo +
                            "repeat 0 1 moveto g c 200 0 0\nrepeat 0 1 attach a k c 0 10 5\n"
                            "linear 1 3 spinby f a world 90 z\nrepeat 3 4 detach c k h\n"
                            "repeat 4 5 moveby f world 1 2 3\nrepeat 4 5 moveby h world 0 0 50\nstop");
    const FigureFrame attached = p.frame(3);
    expect_near(center(attached, "c"), {0, 200, 0}, 1e-12);
    expect_near(center(attached, "b"), {-80, 0, 0}, 1e-12);
    ASSERT_EQ(attached.joints.size(), 2u);
    expect_near(attached.joints[1].position, {-10, 0, 5}, 1e-12);
    EXPECT_EQ(attached.figures, std::vector<std::string>{"f"});
    const FigureFrame apart = p.frame(5);
    ASSERT_EQ(apart.joints.size(), 1u);
    EXPECT_THAT(apart.figures, testing::ElementsAre("f", "h"));
    expect_near(center(apart, "c"), {0, 200, 50}, 1e-12);
    expect_near(center(apart, "a"), {1, 2, 3}, 1e-12);
}

TEST(FigureOwnScripts, AttachTakesItsPlaceFromTheSecondWhereStrict) {
    Performance p = perform(kTwo + "repeat 0 1 moveto g c 200 0 0\nrepeat 0 1 attach a k c 0 10 5\nstop",
                            Dialect::strict);
    expect_near(p.frame(1).joints[1].position, {200, 10, 5}, 0);
}

TEST(FigureOwnScripts, TextureUntilColoured) {
    Performance p = perform(kTwo +
                            "repeat 0 1 texture a bricks.ppm 12 -7\n"
                            "linear 1 3 colour a 55 28 164\nstop");
    const Body textured = body_named(p.frame(1), "a");
    EXPECT_EQ(textured.texture, "bricks.ppm");
    EXPECT_EQ(textured.texture_offset, glm::dvec2(12, -7));
    // Half of the way from 255 128 64, then all of it.
    EXPECT_EQ(body_named(p.frame(2), "a").color, glm::dvec3(155, 78, 114));
    EXPECT_EQ(body_named(p.frame(3), "a").color, glm::dvec3(55, 28, 164));
    EXPECT_EQ(body_named(p.frame(3), "a").texture, "");
}

// --- balance

// Beyond the joint at the origin are a ball of radius 10 (mass 1000) at (40, 0, 0) and one of radius 20 (mass
// 8000) at (40, 45, 30). Their centre of mass is (40, 40, 80 / 3); about x only y and z turn, so it ends up
// at y = sqrt(40^2 + (80 / 3)^2), z = 0, and x stays.
TEST(FigureOwnScripts, BalanceLiftsTheCentreOfMass) {
    Performance p = perform(
        "figure f 3 stand small large\nellipsoid stand 5 5 5\nellipsoid small 10 10 10\n"
        "ellipsoid large 20 20 20\njoint foot stand 0 0 0 small -40 0 0\n"
        "joint arm small 0 45 30 large 0 0 0\nrepeat 0 1 balance small foot world x\nstop");
    const FigureFrame frame = p.frame(1);
    const glm::dvec3 mass = (center(frame, "small") + 8.0 * center(frame, "large")) / 9.0;
    expect_near(mass, {40, std::hypot(40.0, 80.0 / 3), 0}, 1e-9);
    EXPECT_EQ(center(frame, "stand"), glm::dvec3(0));
}

// --- limit

// b bends about x by 30 degrees a frame: at 45 it is held in the strict dialect. The classic one goes on.
TEST(FigureOwnScripts, LimitHolds) {
    const std::string script = kTwo + "limit j -30 45 0 0 0 0\nrepeat 0 3 bendby b j a 30 x\nstop";
    Performance strict = perform(script, Dialect::strict), classic = perform(script);
    const double held[] = {0, 30, 45, 45};
    for (int f = 1; f <= 3; ++f) {
        SCOPED_TRACE(f);
        const double angle = held[f] * kRadiansPerDegree, free = 30 * f * kRadiansPerDegree;
        expect_near(center(strict.frame(f), "b"), {0, 40 + 40 * std::cos(angle), 40 * std::sin(angle)}, 1e-9);
        expect_near(center(classic.frame(f), "b"), {0, 40 + 40 * std::cos(free), 40 * std::sin(free)}, 1e-9);
    }
}

// The limit is of the second ellipsoid as seen from the first. Turning the first forwards turns the second
// backwards against it: that ends at -30.
TEST(FigureOwnScripts, LimitHoldsTheOtherSide) {
    Performance p =
        perform(kTwo + "limit j -30 45 0 0 0 0\nrepeat 0 1 bendby a j world 60 x\nstop", Dialect::strict);
    const double angle = 30 * kRadiansPerDegree;
    expect_near(center(p.frame(1), "a"), {0, 40 - 40 * std::cos(angle), -40 * std::sin(angle)}, 1e-9);
    EXPECT_EQ(center(p.frame(1), "b"), glm::dvec3(0, 80, 0));
}

// A turn about x, y and z in this order is limited angle by angle.
TEST(FigureOwnScripts, LimitOfEachAngle) {
    Performance p = perform(kTwo +
                                "limit j -90 90 -10 10 -5 90\n"
                                "repeat 0 1 bendby b j b 20 x\nrepeat 1 2 bendby b j b 50 y\n"
                                "repeat 2 3 bendby b j b -40 z\nstop",
                            Dialect::strict);
    const auto angles = [&](int f) { return xyz_of_rotation(body_named(p.frame(f), "b").shape.rotation); };
    expect_near(angles(1), {20, 0, 0}, 1e-9);
    expect_near(angles(2), {20, 10, 0}, 1e-9);
    expect_near(angles(3), {20, 10, -5}, 1e-9);
}

// --- abut

// Balls of radius 5 and 10 whose centres are 9 apart across the way meet at 12 along it: 12^2 + 9^2 = 15^2.
TEST(FigureOwnScripts, AbutBalls) {
    Performance p = perform(
        "figure f 1 a\nellipsoid a 5 5 5\nfigure g 1 b\nellipsoid b 10 10 10\n"
        "repeat 0 1 moveto g b 100 9 0\nlinear 1 3 abut a b world x\nstop");
    EXPECT_NEAR(center(p.frame(2), "a").x, (100 - 12) / 2.0, 1e-9);  // half of the way
    expect_near(center(p.frame(3), "a"), {100 - 12, 0, 0}, 1e-9);
}

// From inside the shorter way out is taken: at x = 3 it is the one ahead. And what passes by goes to the
// closest.
TEST(FigureOwnScripts, AbutFromInsideAndPast) {
    const std::string balls = "figure f 1 a\nellipsoid a 5 5 5\nfigure g 1 b\nellipsoid b 10 10 10\n";
    Performance inside = perform(balls + "repeat 0 1 moveto f a 3 0 0\nrepeat 0 1 abut a b world x\nstop");
    EXPECT_NEAR(center(inside.frame(1), "a").x, 15, 1e-9);
    Performance past = perform(balls + "repeat 0 1 moveto f a 70 40 0\nrepeat 0 1 abut a b world x\nstop");
    expect_near(center(past.frame(1), "a"), {0, 40, 0}, 1e-7);
}

// An ellipsoid of half axis 30 along the way, then turned so that the one of 20 lies along it.
TEST(FigureOwnScripts, AbutEllipsoid) {
    const std::string start =
        "figure f 1 a\nellipsoid a 30 20 10\nfigure g 1 b\nellipsoid b 5 5 5\n"
        "repeat 0 1 moveto g b 100 0 0\n";
    Performance flat = perform(start + "repeat 0 1 abut a b world x\nstop");
    EXPECT_NEAR(center(flat.frame(1), "a").x, 100 - 35, 1e-9);
    Performance turned =
        perform(start + "repeat 0 1 spinby f a world 90 z\nrepeat 0 1 abut a b world x\nstop");
    EXPECT_NEAR(center(turned.frame(1), "a").x, 100 - 25, 1e-9);
}

// --- drag

// Grounded, the ball a has its centre at y = 10, where the joint is; b, of radius 5, is 30 from it and starts
// 30 degrees off the top. It rests on the ground where 10 + 30 cos t - 5 = 0, t = 99.59 degrees. The original
// turns 10 + 1 + 0.1 degrees a frame at most.
TEST(FigureOwnScripts, Drag) {
    const std::string script =
        "figure f 2 a b\nellipsoid a 10 10 10\nellipsoid b 5 5 5\njoint j a 0 0 0 b 0 -30 0\n"
        "repeat 0 1 bendby b j world 30 x\nrepeat 1 12 drag b b j a x\nstop";
    const double t = std::acos(-1.0 / 6);
    Performance strict = perform(script, Dialect::strict), classic = perform(script);
    const FigureFrame exact = strict.frame(2);
    expect_near(center(exact, "a"), {0, 10, 0}, 1e-9);
    expect_near(center(exact, "b"), {0, 10 + 30 * std::cos(t), 30 * std::sin(t)}, 1e-9);
    for (int f = 2; f <= 7; ++f) {
        const double angle = (30 + 11.1 * (f - 1)) * kRadiansPerDegree;
        expect_near(center(classic.frame(f), "b"), {0, 10 + 30 * std::cos(angle), 30 * std::sin(angle)},
                    1e-9);
    }
    // Then it is as close as its smallest step, 0.01 degrees, lets it.
    const glm::dvec3 b = center(classic.frame(12), "b");
    EXPECT_NEAR(std::atan2(b.z, b.y - 10), t, 0.0051 * kRadiansPerDegree);
}

// A long ellipsoid: its lowest point is found by looking at many of its surface.
TEST(FigureOwnScripts, DragEllipsoidReachesTheGround) {
    Performance p = perform(
        "figure f 2 a b\nellipsoid a 12 8 30\nellipsoid b 6 25 9\njoint j a 0 0 20 b 3 -28 4\n"
        "repeat 0 1 spinby f a world 25 y\nrepeat 0 1 drag b b j a x\nstop",
        Dialect::strict);
    const FigureFrame frame = p.frame(1);
    for (const char* const name : {"a", "b"}) {
        const Ellipsoid& e = body_named(frame, name).shape;
        double low = 1e9;
        constexpr int kSteps = 2000;
        for (int i = 0; i <= kSteps; ++i)
            for (int k = 0; k < 2 * kSteps; ++k) {
                const double u = std::numbers::pi * i / kSteps, v = std::numbers::pi * k / kSteps;
                const glm::dvec3 s(std::sin(u) * std::cos(v), std::cos(u), std::sin(u) * std::sin(v));
                low = std::min(low, e.center.y + e.axes.x * s.x * e.rotation[0].y +
                                        e.axes.y * s.y * e.rotation[1].y + e.axes.z * s.z * e.rotation[2].y);
            }
        EXPECT_NEAR(low, 0, 1e-4) << name;
    }
}

// --- touch

// The ball b, of radius 10, swings at 40 from the joint in the origin; c, of radius 5, is 50 from it on the x
// axis. They touch where 40^2 + 50^2 - 2 40 50 cos t = 15^2, t = 14.36 degrees above it: the first place
// reached.
TEST(FigureOwnScripts, TouchBalls) {
    for (const Dialect dialect : {Dialect::classic, Dialect::strict}) {
        Performance p = perform(
            "figure f 2 a b\nellipsoid a 3 3 3\nellipsoid b 10 10 10\njoint j a 0 0 0 b 0 -40 0\n"
            "figure g 1 c\nellipsoid c 5 5 5\nrepeat 0 1 moveto g c 50 0 0\n"
            "repeat 0 1 touch b c b world j z\nstop",
            dialect);
        const double t = std::acos((1600 + 2500 - 225) / 4000.0);
        expect_near(center(p.frame(1), "b"), {40 * std::cos(t), 40 * std::sin(t), 0}, 1e-9);
    }
}

// Overlapping, they are turned apart; out of reach, to the closest.
TEST(FigureOwnScripts, TouchFromInsideAndOutOfReach) {
    const std::string arm =
        "figure f 2 a b\nellipsoid a 3 3 3\nellipsoid b 10 10 10\njoint j a 0 0 0 b 0 -40 0\n"
        "figure g 1 c\nellipsoid c 5 5 5\n";
    Performance inside =
        perform(arm + "repeat 0 1 moveto g c 1 50 0\nrepeat 0 1 touch b c b world j z\nstop");
    const FigureFrame frame = inside.frame(1);
    EXPECT_NEAR(glm::distance(center(frame, "b"), center(frame, "c")), 15, 1e-9);
    EXPECT_LT(center(frame, "b").x, 0);  // the shorter way out
    Performance far = perform(arm + "repeat 0 1 moveto g c 300 0 0\nrepeat 0 1 touch b c b world j z\nstop");
    expect_near(center(far.frame(1), "b"), {40, 0, 0}, 1e-5);
}

// Ellipsoids of any shape: they touch where they end up, and by a scan of everything nearer, nowhere before.
TEST(FigureOwnScripts, TouchIsTheNearest) {
    constexpr unsigned kSeed = 2003;
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto numbers = [&](double low, double high) {
        std::string text;
        for (int k = 0; k < 3; ++k) {
            text += ' ';
            text += std::to_string(low + (high - low) * unit(random));
        }
        return text;
    };
    int touching = 0;
    for (int i = 0; i < 80; ++i) {
        SCOPED_TRACE(i);
        Performance p = perform("figure f 2 a b\nellipsoid a 3 3 3\nellipsoid b" + numbers(2, 40) +
                                "\njoint j a 0 0 0 b" + numbers(-40, 40) + "\nfigure g 1 c\nellipsoid c" +
                                numbers(2, 20) + "\nrepeat 0 1 moveto g c" + numbers(-45, 45) +
                                "\nrepeat 0 1 spinto g c world" + numbers(0, 180) +
                                "\nrepeat 1 2 touch b c b world j z\nstop");
        const FigureFrame before = p.frame(1), after = p.frame(2);
        const Ellipsoid from = body_named(before, "b").shape, still = body_named(before, "c").shape;
        const auto apart = [&](double angle) {
            const glm::dmat3 turn = glm::mat3_cast(turn_about({0, 0, 1}, angle));
            return contact_of({turn * from.center, from.axes, turn * from.rotation}, still).ratio > 1;
        };
        // The joint is in the origin, about which the centre turned; b was not turned before.
        const glm::dvec3 x = body_named(after, "b").shape.rotation[0];
        const double angle = std::atan2(x.y, x.x) / kRadiansPerDegree;
        const bool touches =
            std::abs(contact_of(body_named(after, "b").shape, body_named(after, "c").shape).ratio - 1) < 1e-9;
        touching += touches;
        const double scanned = touches ? std::abs(angle) - 1e-6 : 180;
        for (double t = 0; t < scanned; t += 0.5)
            ASSERT_TRUE(apart(t) == apart(0) && apart(-t) == apart(0)) << t << " before " << angle;
    }
    EXPECT_GT(touching, 20);
}

// --- grojnt, movjnt, growto

// a grows to twice its height about the joint at y = 40: its centre goes to -40, and the joint below it from
// -40 to -120, which takes c along.
TEST(FigureOwnScripts, GrojntTakesLimbsAlong) {
    Performance p = perform(
        "figure f 3 a b c\nellipsoid a 10 40 20\nellipsoid b 10 40 20\nellipsoid c 5 5 5\n"
        "joint j a 0 40 0 b 0 -40 0\njoint k a 0 -40 0 c 0 5 0\nlinear 0 2 grojnt a j 1 2 1\nstop");
    const FigureFrame frame = p.frame(2);
    expect_near(center(frame, "a"), {0, -40, 0}, 1e-12);
    expect_near(body_named(frame, "a").shape.axes, {10, 80, 20}, 1e-12);
    EXPECT_EQ(center(frame, "b"), glm::dvec3(0, 80, 0));
    expect_near(center(frame, "c"), {0, -125, 0}, 1e-12);
    expect_near(frame.joints[1].position, {0, -120, 0}, 1e-12);
}

// After a quarter turn about z, the y axis of a points to -x: so the joint and b move there.
TEST(FigureOwnScripts, MovjntInAxesOfTheEllipsoid) {
    Performance p = perform(kTwo + "repeat 0 1 spinby f a world 90 z\nlinear 1 3 movjnt j a 0 8 1\nstop");
    expect_near(center(p.frame(2), "b"), {-84, 0, 0.5}, 1e-12);
    expect_near(center(p.frame(3), "b"), {-88, 0, 1}, 1e-12);
    expect_near(p.frame(3).joints[0].position, {-48, 0, 1}, 1e-12);
    EXPECT_EQ(center(p.frame(3), "a"), glm::dvec3(0));
}

// The centres reach 80 up: made 200 they are 2.5 times as far apart.
TEST(FigureOwnScripts, Growto) {
    Performance p = perform(kTwo + "linear 0 3 growto f a 7 200 7\nstop");
    expect_near(center(p.frame(3), "b"), {0, 200, 0}, 1e-9);
    expect_near(body_named(p.frame(3), "b").shape.axes, {10, 100, 20}, 1e-9);
}

// --- ground

TEST(FigureOwnScripts, GroundEndsGroundedWhereStrict) {
    const std::string script = kTwo + "linear 0 2 ground f\nstop";
    EXPECT_EQ(center(perform(script, Dialect::strict).frame(2), "a").y, 40);
    EXPECT_EQ(center(perform(script).frame(2), "a").y, 30);  // as printed in grnd.3
}

// --- forbid, allow

TEST(FigureOwnScripts, ForbiddenEllipsoidsStop) {
    const std::string start = "figure f 1 a\nellipsoid a 5 5 5\nfigure g 1 b\nellipsoid b 10 10 10\n";
    const std::string run = "repeat 0 1 moveto g b 30 0 0\nlinear 1 31 moveby f world 30 0 0\nstop";
    Performance p = perform(start + "repeat 0 1 forbid a b\n" + run);
    EXPECT_NEAR(center(p.frame(15), "a").x, 14, 1e-9);
    EXPECT_THAT(error_of([&] { p.frame(18); }), HasSubstr("frame 17: the ellipsoids a and b meet"));
    EXPECT_NEAR(center(p.frame(15), "a").x, 14, 1e-9);
    Performance allowed = perform(start + "repeat 0 1 forbid world world\nrepeat 0 1 allow b a\n" + run);
    EXPECT_NEAR(center(allowed.frame(31), "a").x, 30, 1e-9);
    // The two parts of a figure overlap at their joint, which world does not mean; named, they are meant.
    const std::string joined =
        "figure f 2 a b\nellipsoid a 5 5 5\nellipsoid b 5 5 5\njoint j a 0 4 0 b 0 -4 0\n";
    EXPECT_NO_THROW(perform(joined + "repeat 0 1 forbid world world\nstop").frame(1));
    EXPECT_THROW(perform(joined + "repeat 0 1 forbid a b\nstop").frame(1), Error);
}

}  // namespace
}  // namespace anamorph::test_figure_perform_actions
