// SPDX-License-Identifier: Apache-2.0
// Time, names, calls; frames in any order; and what no script should do.
#include "anamorph/figure/language/performance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "anamorph/figure/language/timing.h"
#include "figure_cases.h"

namespace anamorph::test_figure_perform {
using namespace figure;
namespace {

using namespace figure_cases;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kOne = "figure f 1 a\nellipsoid a 5 5 5\n";

double x_of(const FigureFrame& frame) {
    return frame.bodies.at(0).shape.center.x;
}

std::vector<double> places(const std::string& script, Dialect dialect = Dialect::classic) {
    Performance p = perform(script, dialect);
    std::vector<double> out;
    for (const FigureFrame& frame : all_frames(p)) out.push_back(std::round(1000 * x_of(frame)) / 1000);
    return out;
}

// --- Shares

// What the two kinds of shares mean: frac sums to 1, and prop is frac as a share of what is left of it.
TEST(FigureShares, SumToOneAndLeaveNothing) {
    for (const Distribution d : {Distribution::linear, Distribution::quadratic, Distribution::cubic,
                                 Distribution::accelerate, Distribution::decelerate})
        for (const int n : {1, 2, 3, 4, 5, 8, 13, 100, 1001}) {
            SCOPED_TRACE(std::string(name_of(d)) + " " + std::to_string(n));
            double left = 1;
            for (int a = 1; a <= n; ++a) {
                const Shares s = shares_of(d, a, n);
                EXPECT_NEAR(s.prop, s.frac / left, 1e-9 / left);
                left -= s.frac;
            }
            EXPECT_NEAR(left, 0, 1e-12);
            EXPECT_NEAR(shares_of(d, n, n).prop, 1, 1e-12);
        }
    EXPECT_EQ(shares_of(Distribution::repeat, 3, 7).frac, 1);
    EXPECT_EQ(shares_of(Distribution::repeat, 3, 7).prop, 1);
}

// --- Time

TEST(FigureTime, FramesOfASubroutineCountFromItsSmallest) {
    // The subroutine's zero is 10; called at 2, its first frame is 3 and the call ends it after 4.
    EXPECT_THAT(places(kOne + "call 2 4 s\nrepeat 0 1 moveto f a 100 0 0\n"
                              "subroutine s\nlinear 10 14 moveby f world 8 0 0\nendsub s\nstop"),
                ElementsAre(100, 100, 102, 104));
}

TEST(FigureTime, CallAsAnActionIsTheFirstFrameEachTime) {
    EXPECT_THAT(
        places(kOne + "repeat 0 3 call s\nsubroutine s\naccel 5 9 moveby f world 10 0 0\nendsub s\nstop"),
        ElementsAre(1, 2, 3));
}

TEST(FigureTime, SpeedInterpolatesAndSkips) {
    EXPECT_THAT(places(kOne + "speed 2\nlinear 0 2 moveby f world 8 0 0\nstop"), ElementsAre(2, 4, 6, 8));
    // A speed below zero shows every third frame.
    Performance p = perform(kOne + "speed -3\nlinear 0 10 moveby f world 10 0 0\nstop");
    EXPECT_EQ(p.first_frame(), 3);
    EXPECT_EQ(p.last_frame(), 9);
    EXPECT_EQ(p.frame_count(), 3);
    std::vector<int> numbers;
    for (const FigureFrame& frame : all_frames(p)) numbers.push_back(frame.number);
    EXPECT_THAT(numbers, ElementsAre(3, 6, 9));
    EXPECT_EQ(x_of(p.frame(7)), 7);  // the others are there
}

TEST(FigureTime, ViewShowsAPart) {
    Performance p = perform(kOne + "view 3 5\nlinear 0 10 moveby f world 10 0 0\nstop");
    EXPECT_EQ(p.first_frame(), 4);
    EXPECT_EQ(p.last_frame(), 5);
    EXPECT_EQ(all_frames(p).size(), 2u);
    Performance none = perform(kOne + "view 50 60\nlinear 0 10 moveby f world 10 0 0\nstop");
    EXPECT_EQ(none.frame_count(), 0);
    EXPECT_TRUE(all_frames(none).empty());
}

// Frame numbers may be variables: 4 is known only after frame 1 has set it.
TEST(FigureTime, VariableFrames) {
    for (const Dialect dialect : {Dialect::classic, Dialect::strict})
        EXPECT_THAT(places("variables 2 from to\n" + kOne +
                               "repeat 0 1 set from 2\nrepeat 0 1 add to from from\n"
                               "linear from to moveby f world 8 0 0\nstop",
                           dialect),
                    ElementsAre(0, 0, 4, 8));
}

TEST(FigureTime, NothingToDoIsNoFrame) {
    Performance p = perform(kOne + "linear 9 3 moveby f world 1 0 0\nstop");
    EXPECT_EQ(p.frame_count(), 0);
    EXPECT_EQ(p.frame(0).bodies.size(), 1u);  // the figures at rest are there
    EXPECT_THAT(error_of([&] { p.frame(1); }), HasSubstr("frame=1: must be an integer from 0 to 0"));
}

// --- Names in variables

TEST(FigureVariables, HoldNames) {
    Performance p = perform(
        "figure f 2 a b\nellipsoid a 10 40 20\nellipsoid b 10 40 20\njoint j a 0 40 0 b 0 -40 0\n"
        "variables 5 who part at way does\n"
        "repeat 0 1 set who f\nrepeat 0 1 set part b\nrepeat 0 1 set at j\nrepeat 0 1 set way x\n"
        "repeat 0 1 set does s\nrepeat 0 1 bendby part at world 90 way\ncall 1 2 does\n"
        "subroutine s\nrepeat 0 1 moveto who part 1 2 3\nendsub s\nstop",
        Dialect::strict);
    expect_near(body_named(p.frame(1), "b").shape.center, {0, 40, 40}, 1e-12);
    expect_near(body_named(p.frame(2), "b").shape.center, {1, 2, 3}, 1e-12);
    // Strict: an axis is no joint.
    EXPECT_THAT(error_of([] {
                    perform(kOne + "variables 1 v\nrepeat 0 1 set v x\n  repeat 0 1 bendby a v a 1 x\nstop",
                            Dialect::strict)
                        .frame(1);
                }),
                HasSubstr("own.n:5:14: the variable v holds an axis, but must hold a joint"));
}

// --- Parameters of subroutines

const std::string kTwo =
    "figure f 2 a b\nellipsoid a 10 40 20\nellipsoid b 10 40 20\njoint j a 0 40 0 b 0 -40 0\nvariables 3 u v "
    "w\n";

/// A script whose subroutine has parameters does what one does in which the values are written.
TEST(FigureParameters, StandForWhatIsHandedOver) {
    const auto with = [](const std::string& part, const std::string& at, const std::string& angle,
                         const std::string& way, const std::string& last) {
        return kTwo + "repeat 0 1 set u 30\n" + "linear 1 " + last + " bendby " + part + " " + at + " a " +
               angle + " " + way + "\ncubic 2 " + last + " moveby f world 3 " + angle + " 0\nstop";
    };
    const std::string called =
        kTwo +
        "repeat 0 1 set u 30\ncall 1 9 wave 6 b j 20 x 9 f\n"
        "subroutine wave 6 part at angle way last whole\nlinear 1 last bendby part at a angle way\n"
        "cubic 2 last moveby whole world 3 angle 0\nendsub wave\nstop";
    Performance ours = perform(called, Dialect::strict),
                wanted = perform(with("b", "j", "20", "x", "9"), Dialect::strict);
    ASSERT_EQ(wanted.frame_count(), 9);
    ASSERT_EQ(ours.frame_count(), 9);
    for (int f = 1; f <= 9; ++f)
        for (const char* name : {"a", "b"}) {
            SCOPED_TRACE(numbered(name, f));
            const Body is = body_named(ours.frame(f), name), body = body_named(wanted.frame(f), name);
            EXPECT_EQ(is.shape.center, body.shape.center);
            EXPECT_EQ(is.shape.rotation, body.shape.rotation);
        }
}

TEST(FigureParameters, AreHandedOnAndSetVariables) {
    Performance p = perform(
        kTwo +
            "repeat 0 1 set u 5\ncall 0 3 outer 2 u f\nrepeat 1 2 moveby f world u 0 0\n"
            "subroutine outer 2 n who\nrepeat 0 3 call inner 3 n who 2\nendsub outer\n"
            "subroutine inner 3 m it by\nrepeat 0 1 multiply m m by\nrepeat 0 1 moveby it world 0 m 0\n"
            "endsub inner\nstop",
        Dialect::strict);
    // u is 10, 20, 40 in frames 1, 2, 3, and so far it rises.
    expect_near(body_named(p.frame(1), "a").shape.center, {0, 10, 0}, 1e-12);
    expect_near(body_named(p.frame(2), "a").shape.center, {20, 30, 0}, 1e-12);
    expect_near(body_named(p.frame(3), "a").shape.center, {20, 70, 0}, 1e-12);
}

TEST(FigureParameters, NamePicturesJointsAndFiguresThatAreMade) {
    Performance p = perform(
        "figure f 1 a\nellipsoid a 10 10 10\nfigure g 1 b\nellipsoid b 10 10 10\n"
        "call 0 1 dress 4 a cloth grip loose\n"
        "subroutine dress 4 it with new part\nrepeat 0 1 texture it with 1 2\n"
        "repeat 0 1 attach it new b 0 0 0\nrepeat 0 1 detach b new part\nrepeat 0 1 moveby part world 7 0 0\n"
        "endsub dress\nstop",
        Dialect::strict);
    const FigureFrame frame = p.frame(1);
    EXPECT_EQ(body_named(frame, "a").texture, "cloth");
    expect_near(body_named(frame, "b").shape.center, {7, 0, 0}, 1e-12);
}

TEST(FigureParameters, NamePicturesThatAreHandedOn) {
    Performance p = perform(
        "figure f 1 a\nellipsoid a 10 10 10\ncall 0 1 first 2 cloth a\n"
        "subroutine first 2 p q\nrepeat 0 1 call second 2 q p\nendsub first\n"
        "subroutine second 2 p q\nrepeat 0 1 texture p q 1 2\nendsub second\nstop",
        Dialect::strict);
    EXPECT_EQ(body_named(p.frame(1), "a").texture, "cloth");
}

TEST(FigureParameters, OfSubroutinesThatAreHandedOverMayCallThemselves) {
    const auto failure = [](const std::string& inner) {
        return error_of([&] {
            perform(kTwo + "call 0 1 wave 2 wave 3\nsubroutine wave 2 again n\nrepeat 0 1 " + inner +
                        "\nendsub wave\nstop",
                    Dialect::strict)
                .frame(1);
        });
    };
    EXPECT_EQ(failure("moveby f world n 0 0"), "no error");
    EXPECT_THAT(failure("call again 2 again n"), HasSubstr("subroutines call each other without end"));
    EXPECT_THAT(failure("call again 1 n"), HasSubstr("hands over 1 values, but the parameters of"));
}

TEST(FigureParameters, ASubroutineInAVariableIsCheckedWhenItIsCalled) {
    const auto failure = [](const std::string& values) {
        return error_of([&] {
            perform(kTwo + "repeat 0 1 set u wave\nrepeat 0 1 call u " + values +
                        "\nsubroutine wave 1 who\nrepeat 0 1 moveby who world 1 0 0\nendsub wave\nstop",
                    Dialect::strict)
                .frame(1);
        });
    };
    EXPECT_EQ(failure("1 f"), "no error");
    EXPECT_THAT(failure(""),
                HasSubstr("own.n:7:12: call hands over 0 values, but the parameters of \"wave\" are 1"));
    EXPECT_THAT(failure("1 8"), HasSubstr("own.n:9:12: call hands over a number, but the parameter \"who\""));
    EXPECT_THAT(failure("1 j"), HasSubstr("hands over a joint"));
}

TEST(FigureDebug, TellsEachActionOnce) {
    std::vector<std::string> lines;
    PerformanceOptions options;
    options.message = [&](const std::string& line) { lines.push_back(line); };
    const std::string script =
        kTwo +
        "linear 0 2 moveby f a 8 0 0\ncall 1 2 s\nsubroutine s\nrepeat 0 1 set u b\nrepeat 0 1 "
        "spinby f u world 1 x\nendsub s\n";
    Performance p(program_of(script + "debug 0\nstop"), options);
    p.frame(2);
    const std::vector<std::string> said = lines;
    EXPECT_THAT(said,
                ElementsAre("frame 1, own.n:6:12: linear 1/2 moveby f a 8 0 0",
                            "frame 2, own.n:6:12: linear 2/2 moveby f a 8 0 0",
                            "frame 2, own.n:7:6: call 1/1 s", "frame 2, own.n:9:12: s: repeat 1/1 set u=-1 b",
                            "frame 2, own.n:10:12: s: repeat 1/1 spinby f u=b world 1 x"));
    p.frame(1);
    p.frame(2);
    EXPECT_EQ(lines, said);
    lines.clear();
    Performance(program_of(script + "debug 1\nstop"), options).frame(2);
    EXPECT_TRUE(lines.empty());
}

TEST(FigureVariables, Calculate) {
    std::vector<std::string> lines;
    PerformanceOptions options;
    options.message = [&](const std::string& line) { lines.push_back(line); };
    Performance p(
        program_of("variables 3 p q r\n" + kOne +
                   "repeat 0 1 print p\nrepeat 0 1 set p 8\nrepeat 0 1 set q -3\n"
                   "repeat 0 1 add r p q\nrepeat 0 1 print r\nrepeat 0 1 subtract r p q\nrepeat 0 1 print r\n"
                   "repeat 0 1 multiply r p q\nrepeat 0 1 print r\nrepeat 0 1 divide r q p\n"
                   "repeat 0 1 print r\n"
                   "repeat 0 1 invert p\nrepeat 0 1 print p\nrepeat 0 1 negate p\nrepeat 0 1 print p\n"
                   "repeat 0 1 set p 0\nrepeat 0 1 invert p\nrepeat 1 3 print p\nstop"),
        options);
    p.frame(3);
    const std::vector<std::string> said = lines;
    EXPECT_THAT(said, ElementsAre("frame 1, p -1", "frame 1, r 5", "frame 1, r 11", "frame 1, r -24",
                                  "frame 1, r -0.375", "frame 1, p 0.125", "frame 1, p -0.125",
                                  "frame 2, p 0", "frame 3, p 0"));
    // Performed again, nothing is said again.
    p.frame(1);
    p.frame(3);
    EXPECT_EQ(lines, said);
}

TEST(FigureVariables, ReadPlaces) {
    std::vector<double> seen;
    PerformanceOptions options;
    options.message = [&](const std::string& line) {
        seen.push_back(std::stod(line.substr(line.rfind(' '))));
    };
    const auto values = [&](const std::string& action) {
        seen.clear();
        Performance p(
            program_of("variables 3 p q r\nfigure f 2 a b\nellipsoid a 10 40 20\nellipsoid b 1 2 3\n"
                       "joint j a 0 40 0 b 0 -40 0\nrepeat 0 1 spinby f a world 90 x\nrepeat 0 1 " +
                       action + " p q r\nrepeat 0 1 print p\nrepeat 0 1 print q\nrepeat 0 1 print r\nstop"),
            options);
        p.frame(1);
        return glm::dvec3(seen.at(0), seen.at(1), seen.at(2));
    };
    expect_near(values("centre b"), {0, 0, 80}, 1e-12);
    expect_near(values("axes b"), {1, 2, 3}, 0);
    expect_near(values("linkx j"), {0, 0, 40}, 1e-12);
    expect_near(values("angles a world"), {180, 0, 90}, 1e-9);
    expect_near(values("angles a b"), {0, 0, 0}, 1e-9);
}

// --- Any frame

/// Frames are the same to the bit.
void expect_same(const FigureFrame& a, const FigureFrame& b) {
    ASSERT_EQ(a.bodies.size(), b.bodies.size());
    EXPECT_EQ(a.number, b.number);
    for (std::size_t i = 0; i < a.bodies.size(); ++i) {
        EXPECT_EQ(a.bodies[i].shape, b.bodies[i].shape);
        EXPECT_EQ(a.bodies[i].color, b.bodies[i].color);
    }
    for (std::size_t j = 0; j < a.joints.size(); ++j) EXPECT_EQ(a.joints[j].position, b.joints[j].position);
    EXPECT_EQ(a.figures, b.figures);
}

const std::string kDance =
    "figure f 3 a b c\nellipsoid a 10 40 20\nellipsoid b 10 40 20\nellipsoid c 7 9 3\n"
    "joint j a 0 40 0 b 0 -40 0\njoint k b 3 1 4 c 0 0 0\nfigure g 1 d\nellipsoid d 5 5 5\n"
    "linear 0 300 moveby f world 500 1 2\ncall 0 40 swing\ncall 60 100 swing\ncall 110 260 swing\n"
    "repeat 40 41 attach b l d 1 2 3\nrepeat 130 131 detach d l h\nlinear 100 101 colour c 1 2 3\n"
    "linear 400 500 moveto g d 9 9 9\n"
    "subroutine swing\nquadratic 0 20 flex b j 100\ncubic 20 40 flex b j -110\nlinear 7 30 rotate c k 77\n"
    "linear 3 150 spinby f b world 200 y\nendsub swing\nstop";

TEST(FigureFrames, AreTheSameInAnyOrder) {
    Performance forward = perform(kDance);
    const std::vector<FigureFrame> frames = all_frames(forward);
    ASSERT_EQ(frames.size(), 500u);
    constexpr unsigned kSeed = 20031;
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    // Room for hundreds of states, for some, and for none.
    for (const std::size_t memory : {std::size_t{1} << 24, std::size_t{20000}, std::size_t{0}}) {
        PerformanceOptions options;
        options.memory = memory;
        Performance p(program_of(kDance), options);
        std::mt19937 random(kSeed);
        for (int i = 0; i < 300; ++i) {
            const std::size_t f = random() % frames.size();
            expect_same(p.frame(static_cast<int>(f) + 1), frames[f]);
        }
        for (std::size_t f = frames.size(); f-- > 0;)
            expect_same(p.frame(static_cast<int>(f) + 1), frames[f]);
        if (HasFailure()) return;
    }
}

// A million frames, one at a time, forwards, and then a part of them backwards.
TEST(FigureFrames, AMillionOneAtATime) {
    constexpr int kFrames = 1000000;
    Performance p = perform(kOne + "linear 0 1000000 moveby f world 1000 0 0\nstop");
    ASSERT_EQ(p.last_frame(), kFrames);
    double worst = 0;
    for (int f = 1; f <= kFrames; ++f) worst = std::max(worst, std::abs(x_of(p.frame(f)) - f * 1e-3));
    for (int f = kFrames; f > kFrames - 50000; --f)
        worst = std::max(worst, std::abs(x_of(p.frame(f)) - f * 1e-3));
    EXPECT_LT(worst, 1e-6);
}

// What lies between two movements costs nothing.
TEST(FigureFrames, FarApart) {
    Performance p =
        perform(kOne + "repeat 0 1 moveto f a 1 0 0\nrepeat 900000000 900000001 moveto f a 2 0 0\nstop");
    EXPECT_EQ(x_of(p.frame(900000001)), 2);
    EXPECT_EQ(x_of(p.frame(450000000)), 1);
}

TEST(FigureFrames, TenThousandEllipsoids) {
    std::string script = "figure chain 10000";
    const auto name = [](int i) { return numbered(" e", i); };
    for (int i = 0; i < 10000; ++i) script += name(i);
    for (int i = 0; i < 10000; ++i) script += "\nellipsoid" + name(i) + " 1 2 1";
    for (int i = 1; i < 10000; ++i)
        script += "\njoint j" + std::to_string(i) + name(i - 1) + " 0 2 0" + name(i) + " 0 -2 0";
    Performance p = perform(script + "\nlinear 0 2 bendby e5000 j5000 world 180 x\nstop");
    const FigureFrame frame = p.frame(2);
    ASSERT_EQ(frame.bodies.size(), 10000u);
    // Folded back at y = 4 * 4999 + 2.
    expect_near(body_named(frame, "e9999").shape.center, {0, 2 * (4 * 4999 + 2) - 4 * 9999, 0}, 1e-6);
}

// --- What goes wrong

TEST(FigureErrors, NameTheLine) {
    const auto error = [](const std::string& script, Dialect dialect = Dialect::classic) {
        return error_of([&] {
            Performance p = perform(kOne + "variables 2 v w\n" + script + "\nstop", dialect);
            all_frames(p);
        });
    };
    EXPECT_THAT(error("repeat 0 1 divide v 1 0"),
                HasSubstr("own.n:4:12: divide in frame 1: a division by zero"));
    EXPECT_THAT(error("repeat 0 1 grofig f a 1 0 1"),
                HasSubstr("own.n:4:12: grofig in frame 1: a factor is zero"));
    EXPECT_THAT(error("repeat 0 1 moveby f v 1 0 0"), HasSubstr("holds -1, which is not an ellipsoid"));
    EXPECT_THAT(error("repeat 0 1 moveby f a v 0 0", Dialect::strict), HasSubstr("used before it is set"));
    EXPECT_THAT(error("repeat 0 99 multiply v v v\nrepeat 0 1 set v 1000\nrepeat 1 9999 multiply v v 1000"),
                HasSubstr("the variable v overflows"));
    EXPECT_THAT(error("repeat 0 2000 grofig f a 1000 1 1"),
                HasSubstr("own.n:4:15: grofig in frame 103: the ellipsoid a is out of all bounds"));
    EXPECT_THAT(error("repeat 0 1 detach a k h\nrepeat 1 2 attach a k a 0 0 0"),
                HasSubstr("own.n:4:12: detach in frame 1: there is no joint k at this moment"));
    EXPECT_THAT(error("repeat 1 2 attach a k a 0 0 0\nrepeat 2 3 attach a k a 0 0 0"),
                HasSubstr("own.n:5:12: attach in frame 2: the joint k is in use"));
    EXPECT_THAT(error("repeat 1 2 attach a k a 0 0 0", Dialect::strict), HasSubstr("closes a ring"));
}

TEST(FigureErrors, AFrameThatFailsLeavesTheOthers) {
    Performance p = perform(kOne + "linear 0 10 moveby f world 10 0 0\nrepeat 5 6 grofig f a 0 1 1\nstop");
    EXPECT_NEAR(x_of(p.frame(5)), 5, 1e-12);
    EXPECT_THAT(error_of([&] { p.frame(8); }), HasSubstr("frame 6: a factor is zero"));
    EXPECT_NEAR(x_of(p.frame(4)), 4, 1e-12);
    EXPECT_THAT(error_of([&] { p.frame(6); }), HasSubstr("frame 6: a factor is zero"));
}

TEST(FigureErrors, SubroutinesThatCallThemselves) {
    const std::string once =
        kOne + "call 0 5 s\nsubroutine s\ncall 0 5 s\nrepeat 0 1 moveby f a 1 0 0\nendsub s\nstop";
    EXPECT_THAT(error_of([&] { perform(once).frame(1); }), HasSubstr("call each other without end"));
    // Twice each time: nothing deep, but very many.
    std::string many = kOne + "call 0 5 s0\n";
    for (int i = 0; i < 60; ++i) {
        const std::string s = numbered("s", i), next = numbered("s", i + 1);
        many += "subroutine " + s + "\ncall 0 5 " + next + "\ncall 0 5 " + next + "\nendsub " + s + "\n";
    }
    many += "subroutine s60\nrepeat 0 1 moveby f a 1 0 0\nendsub s60\nstop";
    EXPECT_THAT(error_of([&] { perform(many).frame(1); }), HasSubstr("a frame has more than 10000 calls"));
    // One below the other, deep: no ring, and said to be none.
    std::string deep = kOne + "call 0 1 s0\n";
    for (int i = 0; i < 1000; ++i)
        deep += "subroutine " + numbered("s", i) + "\ncall 0 1 " + numbered("s", i + 1) + "\nendsub " +
                numbered("s", i) + "\n";
    deep += "subroutine s1000\nrepeat 0 1 moveby f a 1 0 0\nendsub s1000\nstop";
    EXPECT_THAT(error_of([&] { perform(deep).frame(1); }),
                HasSubstr("more than 200 subroutines call each the next"));
    // Later each time, it comes to an end: moves in frames 1, 3 and 5.
    EXPECT_THAT(
        places(kOne + "call 0 6 s\nsubroutine s\nrepeat 0 1 moveby f a 1 0 0\ncall 2 6 s\nendsub s\nstop"),
        ElementsAre(1, 1, 2, 2, 3, 3));
}

TEST(FigureErrors, ScriptsThatNeverEnd) {
    Performance p = perform(kOne + "variables 1 v\nrepeat 0 1 set v 2\nrepeat 0 v add v v 1\nstop");
    EXPECT_EQ(p.frame(500).number, 500);  // as far as is asked
    EXPECT_THAT(error_of([&] { p.last_frame(); }), HasSubstr("does not end"));
}

// --- Shapes

TEST(FigureShapes, ZeroAndNegativeAxes) {
    Performance p = perform(
        "figure f 2 disc needle\nellipsoid disc 30 0 30\nellipsoid needle 0 -40 0\n"
        "joint j disc 0 0 0 needle 0 -40 0\nrepeat 0 1 ground f\nrepeat 1 2 balance needle j world x\n"
        "repeat 2 3 touch needle disc needle world j x\nrepeat 3 4 grofig f disc 2 -1 1\nstop");
    const FigureFrame frame = p.frame(1);
    EXPECT_EQ(body_named(frame, "disc").shape.center.y, 0);
    EXPECT_EQ(body_named(frame, "needle").shape.axes, glm::dvec3(0, 40, 0));
    for (int f = 1; f <= 4; ++f)
        for (const Body& body : p.frame(f).bodies)
            for (int k = 0; k < 3; ++k) {
                EXPECT_TRUE(std::isfinite(body.shape.center[k]));
                EXPECT_GE(body.shape.axes[k], 0);
            }
}

// A ring of three: what lies beyond a joint is the whole ring, which therefore turns as one.
TEST(FigureShapes, RingOfJoints) {
    const std::string ring =
        "figure f 3 a b c\nellipsoid a 5 5 5\nellipsoid b 5 5 5\nellipsoid c 5 5 5\n"
        "joint j a 5 0 0 b -5 0 0\njoint k b 0 5 0 c 0 -5 0\njoint l c 9 0 0 a 0 9 0\n"
        "repeat 0 1 bendby b j world 90 z\nstop";
    Performance p = perform(ring);
    const FigureFrame frame = p.frame(1);
    // About the joint at (5, 0, 0): a from the left to below it, b from the right to above it.
    expect_near(body_named(frame, "a").shape.center, {5, -5, 0}, 1e-12);
    expect_near(body_named(frame, "b").shape.center, {5, 5, 0}, 1e-12);
    EXPECT_THAT(error_of([&] { perform(ring, Dialect::strict); }),
                HasSubstr("the joint \"l\" closes a ring"));
}

// A figure in pieces: the piece of its first ellipsoid moves, the others do not, and still belong to it.
TEST(FigureShapes, FigureInPieces) {
    Performance p =
        perform("figure f 2 a b\nellipsoid a 5 5 5\nellipsoid b 5 5 5\nrepeat 0 1 moveby f a 7 0 0\nstop");
    const FigureFrame frame = p.frame(1);
    EXPECT_EQ(body_named(frame, "a").shape.center.x, 7);
    EXPECT_EQ(body_named(frame, "b").shape.center.x, 0);
    EXPECT_EQ(body_named(frame, "b").figure, 0);
    EXPECT_THAT(frame.figures, ElementsAre("f"));
}

}  // namespace
}  // namespace anamorph::test_figure_perform
