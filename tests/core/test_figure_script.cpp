// SPDX-License-Identifier: Apache-2.0
// The language: what is read, and what is said about what is not.
#include "anamorph/figure/language/script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <map>
#include <random>
#include <string>

#include "anamorph/error.h"
#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script_table.h"

namespace anamorph::test_figure_script {
using namespace figure;
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kFigure =
    "figure f 2 a b\n"
    "ellipsoid a 10 40 20\n"
    "ellipsoid b 10 40 20\n"
    "joint j a 0 40 0 b 0 -40 0\n"
    "variables 3 u v w\n";

Script parse(const std::string& text, Dialect dialect = Dialect::classic) {
    ScriptOptions options;
    options.dialect = dialect;
    return parse_script(text, "own.n", options);
}

std::vector<std::string> messages(const Script& script) {
    std::vector<std::string> out;
    for (const Diagnostic& d : script.diagnostics) out.push_back(d.text());
    return out;
}

/// The movements of a script that must be right.
std::vector<Movement> movements(const std::string& text, Dialect dialect = Dialect::classic) {
    const Script script = parse(kFigure + text, dialect);
    EXPECT_TRUE(script.ok()) << testing::PrintToString(messages(script));
    return script.program.subroutines[0].movements;
}

// --- What is read

TEST(FigureScript, DeclarationsAndMovements) {
    const Program p =
        parse_program(kFigure + "linear 0 4 moveto f a 100 -2.5 +3\nstop what follows is not read", "own.n");
    ASSERT_EQ(p.ellipsoids.size(), 3u);  // world is the first
    EXPECT_EQ(p.ellipsoids[2].name, "b");
    EXPECT_EQ(p.ellipsoids[2].axes, glm::dvec3(10, 40, 20));
    ASSERT_EQ(p.joints.size(), 1u);
    EXPECT_EQ(p.joints[0].first, 1);
    EXPECT_EQ(p.joints[0].second_offset, glm::dvec3(0, -40, 0));
    EXPECT_EQ(p.figures.at(2).ellipsoids, (std::vector<int>{1, 2}));
    ASSERT_EQ(p.subroutines[0].movements.size(), 1u);
    const Movement& m = p.subroutines[0].movements[0];
    EXPECT_EQ(m.distribution, Distribution::linear);
    EXPECT_EQ(m.stop, (Operand{OperandKind::number, 4, 0}));
    EXPECT_EQ(m.action, Action::moveto);
    EXPECT_EQ(m.operands[0], (Operand{OperandKind::figure, 0, 2}));
    EXPECT_EQ(m.operands[3].number, -2.5);
    EXPECT_EQ(p.where(m.position), "own.n:6:12");
}

TEST(FigureScript, OrderIsOfFirstMention) {
    const Program p = parse_program(
        "figure f 3 x1 y1 z1\nellipsoid y1 1 1 1\nellipsoid q 1 1 1\nellipsoid z1 1 1 1\n"
        "ellipsoid x1 2 2 2\nstop",
        "own.n");
    std::vector<std::string> names;
    for (const auto& e : p.ellipsoids) names.push_back(e.name);
    EXPECT_THAT(names, ElementsAre("world", "x1", "y1", "z1", "q"));
}

// Comments end a line, wherever they begin, and so serve as a mark that a statement goes on.
TEST(FigureScript, CommentsAndLines) {
    const auto m = movements("linear*comment\n0 4 * it goes on\n\tmoveby f world*0 0 0\r\n 1 2\n\n 3\nstop");
    ASSERT_EQ(m.size(), 1u);
    EXPECT_EQ(m[0].operands[2].number, 1);
    EXPECT_EQ(m[0].operands[4].number, 3);
    EXPECT_EQ(m[0].position.line, 8);
}

// Every keyword of the table, in full and as short as it can be: the first that begins so is meant.
TEST(FigureScript, EveryActionAndItsShortForms) {
    const std::map<char, std::string> samples = {{'n', "1.5"}, {'v', "v"},        {'e', "a"},    {'j', "j"},
                                                 {'J', "new"}, {'f', "f"},        {'F', "part"}, {'a', "x"},
                                                 {'s', "s"},   {'i', "wall.ppm"}, {'*', "b"}};
    int actions = 0;
    for (const auto& entry : script_table::entries()) {
        if (entry.operands.empty()) continue;
        ++actions;
        std::string operands;
        for (const char letter : entry.operands) operands += " " + samples.at(letter);
        for (std::size_t length = 1; length <= entry.word.size(); ++length) {
            const std::string word(entry.word.substr(0, length));
            SCOPED_TRACE(word);
            // The first of the table that begins so, by a look at the whole table.
            const script_table::Entry* meant = nullptr;
            for (const auto& other : script_table::entries())
                if (!meant && !other.operands.empty() && other.word.starts_with(word)) meant = &other;
            if (meant != &entry) continue;
            const auto m = movements("repeat 0 1 " + word + operands + "\nsubroutine s\nendsub s\nstop");
            ASSERT_EQ(m.size(), 1u);
            EXPECT_EQ(m[0].action, entry.action);
            EXPECT_EQ(m[0].operands.size(), entry.operands.size());
        }
    }
    EXPECT_EQ(actions, 42);  // 40 actions, two with a second spelling
}

TEST(FigureScript, ShortFormsOfScripts) {
    const std::pair<const char*, Action> actions[] = {{"mov", Action::moveby},  {"link", Action::linkx},
                                                      {"col", Action::colour},  {"sub", Action::subtract},
                                                      {"bend", Action::bendby}, {"spin", Action::spinto},
                                                      {"gro", Action::grofig},  {"obs", Action::observe}};
    for (const auto& [word, action] : actions)
        EXPECT_EQ(script_table::find_action(word)->action, action) << word;
    const std::pair<const char*, Distribution> distributions[] = {
        {"rep", Distribution::repeat},     {"lin", Distribution::linear},
        {"quad", Distribution::quadratic}, {"acce", Distribution::accelerate},
        {"dec", Distribution::decelerate}, {"cub", Distribution::cubic}};
    for (const auto& [word, d] : distributions)
        EXPECT_EQ(script_table::find_statement(word)->distribution, d) << word;
    EXPECT_EQ(script_table::find_statement("end")->keyword, script_table::Keyword::endsub);
    EXPECT_EQ(script_table::find_statement("sub")->keyword, script_table::Keyword::subroutine);
    EXPECT_EQ(script_table::find_statement("ell")->keyword, script_table::Keyword::ellipsoid);
    EXPECT_EQ(script_table::find_statement("moveby"), nullptr);
}

TEST(FigureScript, Numbers) {
    const auto number = [](const std::string& token, Dialect dialect = Dialect::classic) {
        const Script script = parse(kFigure + "repeat 0 1 set v " + token + "\nstop", dialect);
        return script.ok() ? script.program.subroutines[0].movements.at(0).operands[1].number : NAN;
    };
    EXPECT_EQ(number("12"), 12);
    EXPECT_EQ(number("+70.5"), 70.5);
    EXPECT_EQ(number("-.25"), -0.25);
    EXPECT_EQ(number("5."), 5);
    EXPECT_EQ(number("0.1"), 0.1);
    // Signs anywhere, each minus turning it: as the original reads.
    EXPECT_EQ(number("5-"), -5);
    EXPECT_EQ(number("--5"), 5);
    EXPECT_EQ(number("1-2"), -12);
    for (const char* const odd : {"5-", "--5", "1-2"})
        EXPECT_TRUE(std::isnan(number(odd, Dialect::strict))) << odd;
    // No exponents, no second point, nothing that is no number.
    for (const char* const bad : {"1.2.3", "1e3", "0x10", ".", "1,5", "inf", "nan"})
        EXPECT_TRUE(std::isnan(number(bad))) << bad;
    EXPECT_TRUE(std::isnan(number(std::string(400, '9'))));
}

TEST(FigureScript, NumbersDoNotDependOnTheLocale) {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* const name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"})
        if (std::setlocale(LC_ALL, name)) break;
    EXPECT_EQ(movements("repeat 0 1 set v 1.5\nstop").at(0).operands[1].number, 1.5);
    std::setlocale(LC_ALL, before.c_str());
}

TEST(FigureScript, VariablesComeFirst) {
    // `x` is an axis until a variable of that name is declared; names may be used ahead of that.
    EXPECT_EQ(movements("repeat 0 1 spinby f a world 1 x\nstop").at(0).operands[4].kind, OperandKind::axis);
    const auto m = movements("variable 1 x\nrepeat 0 1 spinby f a world 1 x\nstop");
    EXPECT_EQ(m.at(0).operands[4].kind, OperandKind::variable);
}

TEST(FigureScript, NamesAheadOfTheirDeclaration) {
    const std::string script =
        "call 0 4 turn\nlinear 0 1 moveby g c n 0 0\nvariables 1 n\nfigure g 1 c\nellipsoid c 1 1 1\n"
        "subroutine turn\nrepeat 0 1 set v 1\nendsub turn\nstop";
    const auto m = movements(script);
    ASSERT_EQ(m.size(), 2u);
    EXPECT_EQ(m[0].operands[0], (Operand{OperandKind::subroutine, 0, 1}));
    EXPECT_EQ(m[1].operands[0], (Operand{OperandKind::figure, 0, 3}));
    EXPECT_EQ(m[1].operands[2].kind, OperandKind::variable);
    // Strict: subroutines only.
    EXPECT_THAT(messages(parse(kFigure + script, Dialect::strict)),
                ElementsAre(HasSubstr("7:19: error: found \"g\", expected a figure"),
                            HasSubstr("found \"c\", expected an ellipsoid"),
                            HasSubstr("found \"n\", expected a number or a variable")));
}

TEST(FigureScript, SpeedViewDebugLimit) {
    const Program p =
        parse_program(kFigure + "speed -4\nview 3 9\ndebug 0\nlimit j -1 1 -2 2 -3 3\nstop", "own.n");
    EXPECT_EQ(p.speed, -4);
    EXPECT_EQ(p.view.value(), (std::array<int, 2>{3, 9}));
    EXPECT_TRUE(p.trace);
    EXPECT_FALSE(parse_program("debug 1\nstop", "own.n").trace);
    EXPECT_TRUE(parse_program("debug 1\ndebug -3\nstop", "own.n").trace);
    EXPECT_EQ(p.joints[0].limit.value(), (std::array<double, 6>{-1, 1, -2, 2, -3, 3}));
}

// --- Parameters of subroutines

TEST(FigureScript, ParametersAreReadWhereStrict) {
    const std::string text =
        kFigure +
        "call 0 4 wave 2 b v\nsubroutine wave 2 limb turn\nlinear 0 4 bendby limb j a turn x\n"
        "repeat 0 1 set u turn\nendsub wave\nsubroutine none 0\nendsub none\nstop";
    const Script script = parse(text, Dialect::strict);
    ASSERT_TRUE(script.ok()) << testing::PrintToString(messages(script));
    const Movement& call = script.program.subroutines[0].movements.at(0);
    ASSERT_EQ(call.operands.size(), 3u);
    EXPECT_EQ(call.operands[1], (Operand{OperandKind::ellipsoid, 0, 2}));
    EXPECT_EQ(call.operands[2], (Operand{OperandKind::variable, 0, 2}));
    const Subroutine& wave = script.program.subroutines.at(1);
    EXPECT_THAT(wave.parameters, ElementsAre("limb", "turn"));
    EXPECT_EQ(wave.movements.at(0).operands[0], (Operand{OperandKind::parameter, 0, 0}));
    EXPECT_EQ(wave.movements.at(1).operands[1], (Operand{OperandKind::parameter, 0, 1}));
    // The original has none: what follows the name is passed over, and the names mean nothing.
    EXPECT_THAT(messages(parse(text)), testing::Contains(HasSubstr("7:11: error: found \"limb\"")).Times(0));
    EXPECT_FALSE(parse(text).ok());
}

TEST(FigureScript, WhatIsWrongWithParameters) {
    const auto error = [](const std::string& call, const std::string& sub) {
        const Script script =
            parse(kFigure + call + "\nsubroutine wave " + sub + "\nendsub wave\nstop", Dialect::strict);
        return script.diagnostics.empty() ? std::string("none") : script.diagnostics[0].text();
    };
    const std::string bends = "1 limb\nlinear 0 4 bendby limb j a 90 x";
    EXPECT_EQ(error("call 0 4 wave 1 b", bends), "none");
    EXPECT_EQ(error("repeat 0 4 call wave 1 b", bends), "none");
    EXPECT_THAT(error("call 0 4 wave", bends),
                AllOf(HasSubstr("own.n:6:6: error"),
                      HasSubstr("call hands over 0 values, but the parameters of \"wave\" are 1")));
    EXPECT_THAT(error("call 0 4 wave 2 b b", bends), HasSubstr("hands over 2 values"));
    EXPECT_THAT(
        error("call 0 4 wave 1 90", bends),
        HasSubstr(
            "call hands over a number, but the parameter \"limb\" of \"wave\" stands for an ellipsoid"));
    EXPECT_THAT(error("call 0 4 wave 1 j", bends), HasSubstr("hands over a joint"));
    EXPECT_THAT(error("call 0 4 wave 1 bb", bends), HasSubstr("found \"bb\", expected a number or a name"));
    EXPECT_THAT(error("call 0 4 wave b", bends), HasSubstr("found \"b\", expected a declaration"));
    EXPECT_THAT(error("call 0 4 wave -1", bends), HasSubstr("expected the number of values handed over"));
    EXPECT_THAT(error("call 0 4 wave 2000000", bends),
                HasSubstr("expected the number of values handed over"));
    EXPECT_THAT(error("call 0 4 wave 1 5", "1 n\nrepeat 0 1 set n 3"),
                HasSubstr("hands over a number, but the parameter \"n\" of \"wave\" stands for a variable"));
    EXPECT_THAT(error("call 0 4 wave 1 b", "1 limb\nlinear 0 limb moveby f a 1 0 0"),
                HasSubstr("hands over an ellipsoid, but the parameter \"limb\""));
    EXPECT_THAT(error("call 0 4 wave 2 b b", "2 limb limb"), HasSubstr("\"limb\" is declared twice"));
    EXPECT_THAT(error("call 0 4 wave 1 b", "1 a"), HasSubstr("\"a\" is the name of an ellipsoid as well"));
    EXPECT_THAT(error("call 0 4 wave 1 b", "1.5 limb"), HasSubstr("expected the number of parameters"));
    EXPECT_THAT(error("call 0 4 wave 1 b", "3 limb"), HasSubstr("expected a name for a parameter"));
    EXPECT_THAT(error("call 0 4 wave 1 b", "1 late\nvariables 1 late"),
                HasSubstr("7:19: error: \"late\" is the name of a variable as well"));
    EXPECT_THAT(error("call 0 4 wave 1 b", "1 bendby"), HasSubstr("expected a name for a parameter"));
    EXPECT_THAT(error("call 0 4 wave 1 nan", bends), HasSubstr("found \"nan\""));
    // What is handed on is checked where it comes from.
    EXPECT_THAT(
        error("call 0 4 wave 1 90\nsubroutine on 1 it\nlinear 0 4 bendby it j a 90 x\nendsub on",
              "1 limb\ncall 0 4 on 1 limb"),
        HasSubstr("hands over a number, but the parameter \"limb\" of \"wave\" stands for an ellipsoid"));
    // One inside of another has parameters of its own.
    EXPECT_THAT(error("call 0 4 wave 3 b b b", "3 k l m\nsubroutine inner 1 n\nrepeat 0 1 set u m"),
                HasSubstr("begins inside of another"));
    // They are known in their subroutine alone.
    EXPECT_THAT(messages(parse(kFigure + "subroutine s 1 limb\nendsub s\nrepeat 0 1 set u limb\nstop",
                               Dialect::strict)),
                ElementsAre(HasSubstr("found \"limb\", expected a number or a name")));
}

TEST(FigureScript, ASubroutineBegunWithinAnotherHasNoneOfItsParameters) {
    const Script script =
        parse(kFigure +
                  "subroutine outer 2 limb turn\nsubroutine inner\nlinear 0 2 bendby limb j a turn x\n"
                  "endsub inner\nendsub outer\nstop",
              Dialect::strict);
    EXPECT_FALSE(script.ok());
    EXPECT_THAT(messages(script), testing::Contains(HasSubstr("found \"limb\"")));
}

// --- Libraries

TEST(FigureScript, LibrariesAndIncludes) {
    const std::map<std::string, std::string> files = {
        {"ball.n", "figure ball 1 e\nellipsoid e 5 5 5\nrepeat 0 1 moveto ball e 7 0 0\n"},
        {"twice.n", "include ball.n"},
        {"bad.n", "figure b 1\n"},
        {"self.n", "include self.n"},
        {"stop.n", "variables 1 s\nstop\nvariables 1 t"}};
    const auto with = [&](const std::string& text, std::vector<std::string> libraries = {}) {
        ScriptOptions options;
        options.include = [&](const std::string& name) {
            const auto file = files.find(name);
            return file == files.end() ? std::nullopt : std::optional(file->second);
        };
        options.libraries = std::move(libraries);
        return parse_script(text, "main.n", options);
    };
    const std::string dance = "repeat 1 2 moveby ball world 1 0 0\nstop";
    for (const Script& script :
         {with(dance, {"ball.n"}), with("include ball.n\n" + dance), with("include twice.n\n" + dance)}) {
        ASSERT_TRUE(script.ok()) << testing::PrintToString(messages(script));
        Performance p(script.program);
        EXPECT_EQ(p.frame(2).bodies.at(0).shape.center.x, 8);
        const auto& m = script.program.subroutines[0].movements;
        EXPECT_EQ(script.program.where(m[0].position), "ball.n:3:12");
        EXPECT_THAT(script.program.where(m[1].position), HasSubstr("main.n:"));
    }
    // Messages name the file that is wrong.
    EXPECT_THAT(messages(with("stop", {"bad.n"})),
                ElementsAre("bad.n:1:1: error: figure is not complete: found the end of the text, expected a "
                            "name for an ellipsoid (figure name count ellipsoid ...)"));
    EXPECT_THAT(messages(with("\n include none.n\nstop")),
                ElementsAre("main.n:2:2: error: include none.n: there is no such file"));
    EXPECT_THAT(messages(with("include self.n\nstop")),
                ElementsAre(HasSubstr("self.n:1:1: error: include self.n")));
    // A stop ends its own text.
    EXPECT_THAT(messages(with("include stop.n\nstop")),
                ElementsAre("stop.n:2:1: warning: a library has no stop (included at main.n:1:1)"));
}

// --- What is said

TEST(FigureScript, SeveralErrorsInOneRun) {
    const Script script = parse(kFigure +
                                "linear 0 1 moveby f hed 1 2 3\n"
                                "linear 0 x jump f\n"
                                "linear 0 1 moveto f a 1 2\n"
                                "repeat 0 1 set 5 v\n"
                                "repeat 0 1 flex b j 10 20\n"
                                "ellipsoid a 1 2 3\n"
                                "quadratic 0 1 moveby f a 1 2 3\n"
                                "stop");
    EXPECT_FALSE(script.ok());
    EXPECT_THAT(
        messages(script),
        ElementsAre("own.n:7:12: error: found \"jump\", expected an action (linear frame frame action ...)",
                    "own.n:8:12: error: moveto is not complete: found \"repeat\", expected a number or a "
                    "variable (moveto figure ellipsoid x y z)",
                    "own.n:9:16: error: found \"5\", expected a variable (set variable value)",
                    "own.n:10:24: warning: found \"20\" after the end of a statement: the rest of the line "
                    "is passed over",
                    "own.n:11:11: error: the ellipsoid \"a\" is declared twice",
                    "own.n:6:21: error: found \"hed\", expected an ellipsoid (moveby figure ellipsoid "
                    "x y z)"));
    const Diagnostic& first = script.diagnostics[0];
    EXPECT_EQ(first.found, "jump");
    EXPECT_EQ(first.expected, "an action");
    EXPECT_EQ(first.line, 7);
    EXPECT_EQ(first.column, 12);
}

TEST(FigureScript, WhatEachDeclarationNeeds) {
    const auto error = [](const std::string& text) {
        const Script script = parse(kFigure + text + "\nstop");
        std::string all;
        for (const std::string& message : messages(script)) all += message + "\n";
        return all;
    };
    EXPECT_THAT(error("figure h 0"), HasSubstr("expected the number of ellipsoids, an integer"));
    EXPECT_THAT(error("figure h 2 p"), HasSubstr("found \"stop\", expected a name for an ellipsoid"));
    EXPECT_THAT(error("figure f 1 p\nellipsoid p 1 1 1"), HasSubstr("the figure \"f\" is declared twice"));
    EXPECT_THAT(error("figure h 1 p"), HasSubstr("the ellipsoid \"p\" is declared nowhere"));
    EXPECT_THAT(error("ellipsoid p 1 v 1"), HasSubstr("found \"v\", expected a number"));
    EXPECT_THAT(error("joint j a 0 0 0 b 0 0 0"), HasSubstr("the joint \"j\" is declared twice"));
    EXPECT_THAT(error("joint k a 0 0 0 b 0 0"), HasSubstr("expected a number, a coordinate"));
    EXPECT_THAT(error("joint k world 0 0 0 b 0 0 0"), HasSubstr("does not connect world"));
    EXPECT_THAT(error("limit k 0 0 0 0 0 0"), HasSubstr("found \"k\", expected a joint"));
    EXPECT_THAT(error("limit j 1 0 0 0 0 0"), HasSubstr("smallest angle is above the largest"));
    EXPECT_THAT(error("variables 2 q"), HasSubstr("found \"stop\", expected a name for a variable"));
    EXPECT_THAT(error("variables 1 linear"), HasSubstr("found \"linear\", expected a name"));
    EXPECT_THAT(error("speed 0"), HasSubstr("found \"0\", expected an integer other than 0"));
    EXPECT_THAT(error("view 1 1.5"), HasSubstr("found \"1.5\", expected a frame"));
    EXPECT_THAT(error("subroutine s\nendsub t"), HasSubstr("expected the end of \"s\""));
    EXPECT_THAT(error("subroutine s"), HasSubstr("the subroutine s has no end"));
    EXPECT_THAT(error("endsub s"), HasSubstr("a subroutine ends that has not begun"));
    EXPECT_THAT(error("subroutine s\nsubroutine t\nendsub t"), HasSubstr("inside of another"));
    EXPECT_THAT(error("call 0 1 s"), HasSubstr("found \"s\", expected a subroutine"));
    EXPECT_THAT(error("copy a"), HasSubstr("a word of the first versions"));
    EXPECT_THAT(error("repeat 0 1 set v \x01"), HasSubstr("the character 1 is not allowed"));
    EXPECT_EQ(messages(parse("")).at(0), "own.n:1:1: error: found the end of the text, expected stop");
}

TEST(FigureScript, StrictRefusesWhatClassicWarnsOf) {
    const std::pair<const char*, const char*> cases[] = {
        {"variables 1 a", "\"a\" is the name of an ellipsoid as well"},
        {"ellipsoid p 1 -2 1", "an axis is negative"},
        {"joint k a 0 0 0 b 0 0 0", "the joint \"k\" closes a ring"},
        {"linear 5 3 moveby f a 1 2 3", "the frames run backwards"}};
    for (const auto& [text, message] : cases) {
        SCOPED_TRACE(text);
        const std::string script = kFigure + text + "\nstop";
        EXPECT_THAT(messages(parse(script)), ElementsAre(AllOf(HasSubstr("warning"), HasSubstr(message))));
        EXPECT_THAT(messages(parse(script, Dialect::strict)),
                    ElementsAre(AllOf(HasSubstr("error"), HasSubstr(message))));
    }
    EXPECT_THAT(messages(parse(kFigure + "variables 1 u\nstop")), IsEmpty());
    EXPECT_THAT(messages(parse(kFigure + "variables 1 u\nstop", Dialect::strict)),
                ElementsAre(HasSubstr("the variable \"u\" is declared twice")));
    const std::string itself =
        kFigure + "subroutine s\ncall 2 6 t\nendsub s\nsubroutine t\ncall 0 1 s\nendsub t\nstop";
    EXPECT_THAT(messages(parse(itself)), IsEmpty());
    EXPECT_THAT(messages(parse(itself, Dialect::strict)),
                ElementsAre(HasSubstr("subroutines call themselves")));
}

// As the originals read: of two statements on a line the first is performed, and words and numbers that a
// statement does not need are no error.
TEST(FigureScript, WhatFollowsAStatementOnItsLine) {
    const std::string text = kFigure +
                             "repeat 0 1 set v 1 repeat 0 1 set v 2\nrepeat 0 1 flex b j 10 20 %&/ more\n"
                             "repeat 0 1 set u\n 3 * a comment\nrepeat 0 1 set w 4\nview 0 9 10\nstop";
    const Script classic = parse(text);
    EXPECT_THAT(
        messages(classic),
        ElementsAre("own.n:6:20: warning: found \"repeat\" after the end of a statement: a statement "
                    "begins on a new line, and the rest of this one is passed over",
                    "own.n:7:24: warning: found \"20\" after the end of a statement: the rest of the "
                    "line is passed over",
                    "own.n:11:10: warning: found \"10\" after the end of a statement: the rest of the "
                    "line is passed over"));
    const auto& m = classic.program.subroutines[0].movements;
    ASSERT_EQ(m.size(), 4u);
    EXPECT_EQ(m[0].operands[1].number, 1);
    EXPECT_EQ(m[2].operands[1].number, 3);
    EXPECT_EQ(m[3].operands[1].number, 4);
    // Strict: statements may share a line, and what none needs is an error.
    const Script strict = parse(kFigure + "repeat 0 1 set v 1 repeat 0 1 set v 2 stop", Dialect::strict);
    EXPECT_EQ(strict.program.subroutines[0].movements.size(), 2u);
    EXPECT_FALSE(parse(kFigure + "repeat 0 1 flex b j 10 20 stop", Dialect::strict).ok());
}

// Drivers of the originals write the largest number they know for the last frame.
TEST(FigureScript, ViewToTheEnd) {
    for (const Dialect dialect : {Dialect::classic, Dialect::strict}) {
        const Script script =
            parse(kFigure + "view 0 1073741823\nlinear 0 3 moveby f a 1 0 0\nstop", dialect);
        ASSERT_TRUE(script.ok()) << testing::PrintToString(messages(script));
        EXPECT_EQ(Performance(script.program).frame_count(), 3);
    }
}

TEST(FigureScript, SaysWhatWasMeant) {
    const auto said = [](const std::string& text) { return messages(parse(kFigure + text + "\nstop")); };
    EXPECT_THAT(
        said("repaet 0 1 set v 1"),
        ElementsAre("own.n:6:1: error: found \"repaet\", expected a declaration or a movement, did you "
                    "mean \"repeat\"?"));
    EXPECT_THAT(
        said("repeat 0 1 movby f a 1 2 3"),
        ElementsAre("own.n:6:12: error: found \"movby\", expected an action, did you mean \"moveby\"? "
                    "(repeat frame frame action ...)"));
    EXPECT_THAT(
        said("figure g 1 head\nellipsoid head 1 1 1\nrepeat 0 1 moveby g haed 1 2 3"),
        ElementsAre("own.n:8:21: error: found \"haed\", expected an ellipsoid, did you mean \"head\"? "
                    "(moveby figure ellipsoid x y z)"));
    EXPECT_THAT(said("moveby f a 1 2 3"), ElementsAre(AllOf(HasSubstr("own.n:6:1: error: found \"moveby\""),
                                                            HasSubstr("linear 0 9 moveby"))));
    // A signature names as many operands as the table wants.
    for (const auto& entry : script_table::entries())
        if (entry.keyword == script_table::Keyword::action) {
            EXPECT_EQ(static_cast<std::size_t>(std::count(entry.usage.begin(), entry.usage.end(), ' ') + 1),
                      entry.operands.size())
                << entry.word;
        }
}

TEST(FigureScript, WarnsOfShortFormsThatMayMeanSomethingElse) {
    EXPECT_THAT(
        messages(parse(kFigure + "repeat 0 1 bend b j world 90 x\nrep 0 1 bend b j world 90 x\nstop")),
        ElementsAre("own.n:6:12: warning: \"bend\" is taken for \"bendby\", and not for \"bendto\""));
    EXPECT_THAT(messages(parse(kFigure + "quad 0 1 bendb b j world 90 x\nacce 0 1 colo a 1 2 3\nstop")),
                IsEmpty());
}

TEST(FigureScript, JointsThatAreNotAtTheirEllipsoid) {
    const std::string four =
        "figure f 4 a b c d\nellipsoid a 1 1 1\nellipsoid b 1 1 1\nellipsoid c 1 1 1\n"
        "ellipsoid d 1 1 1\njoint j a 1 0 0 b -1 0 0\njoint k b 1 0 0 c -1 0 0\n"
        "joint l c 1 0 0 d 0 0 0\n";
    for (const char* const action : {"flex a k 9", "rotate d j 9", "abduct a l 9", "grojnt a k 1 2 1",
                                     "movjnt k a 1 2 3", "drag d a k world x", "detach a l g"})
        for (const Dialect dialect : {Dialect::classic, Dialect::strict}) {
            SCOPED_TRACE(action);
            const Script script = parse(four + "repeat 0 1 " + action + "\nstop", dialect);
            EXPECT_THAT(messages(script), ElementsAre(AllOf(HasSubstr("own.n:9:12: error: "),
                                                            HasSubstr("is not at the joint"))));
        }
    // In what is never performed it is no error; and what `attach` makes is not known before.
    EXPECT_THAT(messages(parse(four + "subroutine s\nrepeat 0 1 flex a k 9\nendsub s\nstop")),
                ElementsAre(HasSubstr("warning: flex: the ellipsoid \"a\" is not at the joint \"k\", which "
                                      "connects \"b\" and \"c\"")));
    EXPECT_THAT(messages(parse(four + "call 0 1 s\nsubroutine s\nrepeat 0 1 flex a k 9\nendsub s\nstop")),
                ElementsAre(HasSubstr("error: flex")));
    EXPECT_THAT(messages(parse(four + "repeat 0 1 detach b k g\nrepeat 0 1 attach a k d 0 0 0\n"
                                      "repeat 1 2 flex a k 9\nstop")),
                IsEmpty());
}

TEST(FigureScript, ByteOrderMark) {
    for (const Dialect dialect : {Dialect::classic, Dialect::strict})
        EXPECT_THAT(messages(parse("\xef\xbb\xbf" + kFigure + "stop", dialect)), IsEmpty());
    EXPECT_THAT(messages(parse("\xef\xbb\xbf jump\nstop")), ElementsAre(HasSubstr("own.n:1:2: error")));
}

// Who can have a script read must not be able to have any file shown.
TEST(FigureScript, ShowsNothingOfFilesThatAreNoScripts) {
    const std::string secrets[] = {"root:secret:0:0:\nlinear 0 1 secret\n", "secret 1 2 3\n",
                                   std::string("figure f 1 secret\0\n", 19), "s secret"};
    for (const std::string& secret : secrets) {
        ScriptOptions options;
        options.include = [&](const std::string&) { return std::optional(secret); };
        for (const bool library : {false, true}) {
            if (library) options.libraries = {"/etc/secrets"};
            const std::string text = library ? "stop" : "include /etc/secrets\nstop";
            const Script script = parse_script(text, "own.n", options);
            EXPECT_THAT(messages(script), ElementsAre(HasSubstr("/etc/secrets: it is not a script")));
            for (const Diagnostic& d : script.diagnostics) EXPECT_EQ(d.found, "");
        }
    }
}

TEST(FigureScript, MessagesOfIncludedFilesSayWhoIncludes) {
    ScriptOptions options;
    options.include = [](const std::string& name) {
        return std::optional<std::string>(name == "one.n" ? "* one\n\n include two.n\n"
                                                          : "figure f 1 a\nlinear 0 1 jump\n");
    };
    EXPECT_THAT(
        messages(parse_script("\ninclude one.n\nellipsoid a 1 1 1\nstop", "own.n", options)),
        ElementsAre("two.n:2:12: error: found \"jump\", expected an action (linear frame frame action "
                    "...) (included at one.n:3:2, at own.n:2:1)"));
}

TEST(FigureScript, PassesOver) {
    const Script script = parse(kFigure + "repeat 0 1 opacty a 5\nrepeat 0 1 set v 3\nstop");
    EXPECT_TRUE(script.ok());
    EXPECT_THAT(messages(script), ElementsAre("own.n:6:12: warning: \"opacty\" is passed over"));
    EXPECT_EQ(script.program.subroutines[0].movements.size(), 1u);
}

TEST(FigureScript, StopsAfterManyErrors) {
    std::string text;
    for (int i = 0; i < 5000; ++i) text += "jump\n";
    EXPECT_FALSE(parse(text + "stop").ok());
    std::string errors = kFigure;
    for (int i = 0; i < 5000; ++i) errors += "linear 0 1 moveby f 5 1 2 3\n";
    const Script script = parse(errors + "stop");
    EXPECT_EQ(script.diagnostics.size(), 101u);
    EXPECT_THAT(script.diagnostics.back().message, HasSubstr("the rest is not read"));
}

// --- Any text

const std::string kWhole =
    kFigure +
    "limit j -9 9 -9 9 -9 9\nspeed 1\nview 0 9 * comment\n"
    "figure g 1 c\nellipsoid c 5 5 5\n"
    "call 1 4 s\nrepeat 0 1 attach a k c 1 2 3\nrepeat 1 2 detach c k h\n"
    "linear 0 2 touch b c b world j z\nrepeat 0 1 texture a w.ppm 1 2\nrepeat 0 1 set v -5.5\n"
    "subroutine s\nquadratic 0 3 flex b j v\nrepeat 0 1 set w 5\nendsub s\nstop";

TEST(FigureScript, TruncatedAtEveryByte) {
    for (const Dialect dialect : {Dialect::classic, Dialect::strict})
        for (std::size_t size = 0; size <= kWhole.size(); ++size) {
            SCOPED_TRACE(kWhole.substr(0, size));
            // Of the last word, "st" is enough.
            EXPECT_EQ(parse(kWhole.substr(0, size), dialect).ok(), size + 2 >= kWhole.size());
        }
}

// Bytes taken out, put in and exchanged: an answer or diagnostics, never more.
TEST(FigureScript, DamagedAnywhere) {
    constexpr unsigned kSeed = 1981;
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    std::mt19937 random(kSeed);
    int performed = 0;
    for (int i = 0; i < 3000; ++i) {
        std::string text = kWhole;
        for (int k = 0; k < 1 + i % 3; ++k) {
            const std::size_t at = random() % text.size(), from = random() % text.size();
            if (random() % 2)
                text.erase(at, 1 + random() % 3);
            else
                text[at] = text[from];
        }
        const Script script = parse(text, i % 2 ? Dialect::classic : Dialect::strict);
        for (const std::string& message : messages(script)) EXPECT_EQ(message.find('\n'), std::string::npos);
        if (!script.ok()) continue;
        try {
            Performance p(script.program);
            int frames = 0;
            p.for_each_frame([&](const FigureFrame&) { return ++frames < 20; });
            ++performed;
        } catch (const Error& error) {
            EXPECT_STRNE(error.what(), "");
        }
    }
    EXPECT_GT(performed, 100);
}

}  // namespace
}  // namespace anamorph::test_figure_script
