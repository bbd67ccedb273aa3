// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/features_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "anamorph/error.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::test_features_file {
namespace {

using testing::HasSubstr;

void expect_line(const Line& line, double x0, double y0, double x1, double y1) {
    EXPECT_NEAR(line.p.x, x0, 1e-9);
    EXPECT_NEAR(line.p.y, y0, 1e-9);
    EXPECT_NEAR(line.q.x, x1, 1e-9);
    EXPECT_NEAR(line.q.y, y1, 1e-9);
}

/// The message of the Error that reading `text` throws: one line that names the file.
template <class Parse>
std::string message(const Parse& parse, const std::string& text) {
    try {
        parse(text, "lines.file");
    } catch (const Error& error) {
        const std::string what = error.what();
        EXPECT_EQ(what.find_first_of("\r\n"), std::string::npos) << what;
        EXPECT_THAT(what, testing::StartsWith("lines.file: "));
        return what;
    }
    return "no error";
}

// --- JSON -------------------------------------------------------------------------------------------------

TEST(FeaturesJson, LinesPolylinesAndCurves) {
    const Features f = parse_features_json(
        R"x({"sizes": [[600, 400], [800, 600]], "pin_border": true,
            "features": [{"line": [[10, 20, 90, 25], [12, 30, 95, 20]], "name": "brow", "weight": 2},
                         {"polyline": [[[0, 0], [3, 4], [6, 4]], [[1, 1], [4, 5], [7, 5]]]},
                         {"curve": [[[0, 0], [0, 9], [9, 9], [9, 0]], [[0, 0], [1, 0], [2, 0], [3, 0]]]}]})x",
        "face.json");
    EXPECT_EQ(f.shapes(), 2);
    ASSERT_GT(f.size(), 4u);
    expect_line(f.line(0, 1), 12, 30, 95, 20);
    EXPECT_EQ(f.weight(0), 2);
    EXPECT_EQ(f.name(0), "brow");
    EXPECT_EQ(f.name(1), "line 2");
    expect_line(f.line(2, 1), 4, 5, 7, 5);
    EXPECT_EQ(f.frame(1).width, 800);
    EXPECT_EQ(f.border_weight(), 1);
}

TEST(FeaturesJson, ThreeShapes) {
    const Features f =
        parse_features_json(R"x({"features": [{"line": [[0,0,1,0], [0,0,2,0], [0,0,3,0]]}]})x", "three");
    EXPECT_EQ(f.shapes(), 3);
    expect_line(f.line(0, 2), 0, 0, 3, 0);
}

TEST(FeaturesJson, BadFilesAreNamed) {
    const auto bad = [](const std::string& text) { return message(parse_features_json, text); };
    EXPECT_THAT(bad(""), HasSubstr("no JSON"));
    EXPECT_THAT(bad(std::string(100000, '[')), HasSubstr("deep"));
    EXPECT_THAT(bad(R"x({"features": [{"line": [[0,0,1,0], [0)x"), HasSubstr("no JSON"));
    EXPECT_THAT(bad("[]"), HasSubstr("must be an object"));
    EXPECT_THAT(bad(R"x({"features": []})x"), HasSubstr("features: must be a list of one or more"));
    EXPECT_THAT(bad(R"x({"fetures": []})x"), HasSubstr("fetures: must be one of"));
    EXPECT_THAT(bad(R"x({"features": [{"line": [[0,0,1,0], [0,0,1,0]]}, {"line": [[0,0,1], [0,0,1,0]]}]})x"),
                HasSubstr("features[1]: must be a list of 4 numbers"));
    EXPECT_THAT(bad(R"x({"features": [{"line": [[0,0,1,0], [0,0,"x\ny",0]]}]})x"),
                HasSubstr("features[0]: must be a number"));
    EXPECT_THAT(bad(R"x({"features": [{"line": [[0,0,1,0], [5,6,5,6]], "name": "brow"}]})x"),
                HasSubstr("features[0]: brow=5,6,5,6: a line needs a length"));
    EXPECT_THAT(bad(R"x({"features": [{"line": [[0,0,1,0]]}]})x"), HasSubstr("a morph needs two or more"));
    EXPECT_THAT(
        bad(R"x({"features": [{"line": [[0,0,1,0],[0,0,1,0]]}, {"line": [[0,0,1,0],[0,0,1,0],[0,0,1,0]]}]})x"),
        HasSubstr("features[1]: line 2=3 shapes: must be 2"));
    EXPECT_THAT(bad(R"x({"features": [{"line": [[0,0,1e999,0],[0,0,1,0]]}]})x"), HasSubstr("lines.file: "));
    EXPECT_THAT(bad(R"x({"features": [{"line": [[0,0,1,0],[0,0,1,0]], "curve": []}]})x"),
                HasSubstr("must not both be given"));
    EXPECT_THAT(bad(R"x({"features": [{"line": [[0,0,1,0],[0,0,1,0]], "weight": -1}]})x"),
                HasSubstr("weight=-1"));
    EXPECT_THAT(bad(R"x({"sizes": [[1, 0], [1, 1]], "features": [{"line": [[0,0,1,0],[0,0,1,0]]}]})x"),
                HasSubstr("sizes: size=1x0"));
    EXPECT_THAT(bad(std::string(100000, '[')), HasSubstr("lines.file: "));
}

// --- CSV --------------------------------------------------------------------------------------------------

TEST(FeaturesCsv, OnePairALine) {
    const Features f = parse_features_csv(
        "\xef\xbb\xbf"
        "ax0,ay0,ax1,ay1,bx0,by0,bx1,by1\r\n"
        "# eyes\r\n"
        " 1, 2,3 ,4,5,6,7,8\r\n"
        "\r\n"
        "1.5,-2e1,3,4,+5,6,7,8,0.25",
        "l.csv");
    ASSERT_EQ(f.size(), 2u);
    expect_line(f.line(0, 0), 1, 2, 3, 4);
    expect_line(f.line(1, 0), 1.5, -20, 3, 4);
    expect_line(f.line(1, 1), 5, 6, 7, 8);
    EXPECT_EQ(f.weight(1), 0.25);
}

TEST(FeaturesCsv, BadRowsAreNamed) {
    const auto bad = [](const std::string& text) { return message(parse_features_csv, text); };
    EXPECT_THAT(bad(""), HasSubstr("must have one pair"));
    EXPECT_THAT(bad("1,2,3,4,5,6,7\n"), HasSubstr("row 1: must be 8 numbers"));
    EXPECT_THAT(bad("#\n1,2,3,4,5,6,7,8\n1,2,3,4,5,6,7,eight\n"),
                HasSubstr("row 3: must be a number, not \"eight\""));
    EXPECT_THAT(bad("1,2,3,4,5,6,7,8,9,10\n"), HasSubstr("and a weight if wanted, not 10"));
    EXPECT_THAT(bad("1,2,1,2,5,6,7,8\n"), HasSubstr("row 1: line 1=1,2,1,2: a line needs a length"));
    EXPECT_THAT(bad("1,2,nan,2,5,6,7,8\n"), HasSubstr("row 1: "));
    EXPECT_THAT(bad("1,2,3,4,5,6,7,8,inf\n"), HasSubstr("row 1: line 1 weight"));
}

// --- SVG --------------------------------------------------------------------------------------------------

std::string svg(const std::string& a, const std::string& b) {
    return R"x(<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="i">)x"
           R"x(<g inkscape:groupmode="layer" inkscape:label="A">)x" +
           a + R"x(</g><g inkscape:groupmode="layer" inkscape:label="B">)x" + b + "</g></svg>";
}

TEST(FeaturesSvg, LayersMatchByIdAndLabel) {
    const Features f = parse_features_svg(
        svg(R"x(<path id="path1" d="M 1,2 3,4"/><path id="brow_a" d="m 10 10 l 5 0"/>)x"
            R"x(<line id="x" inkscape:label="nose" x1="1" y1="2" x2="3" y2="5"/>)x",
            R"x(<line id="y" inkscape:label="nose" x1="2" y1="2" x2="4" y2="5"/>)x"
            R"x(<path id="brow_b" d="M 12 10 H 20"/><path id="path1-3-6" d="M 6 7 V 9"/>)x"),
        "faces.svg");
    ASSERT_EQ(f.size(), 3u);
    expect_line(f.line(0, 0), 1, 2, 3, 4);
    expect_line(f.line(0, 1), 6, 7, 6, 9);
    expect_line(f.line(1, 0), 10, 10, 15, 10);
    expect_line(f.line(1, 1), 12, 10, 20, 10);
    expect_line(f.line(2, 1), 2, 2, 4, 5);
    EXPECT_EQ(f.name(2), "nose");
}

TEST(FeaturesSvg, TransformsPolylinesAndClosedPaths) {
    const Features f = parse_features_svg(
        svg(R"x(<g transform="translate(10,20) scale(2)"><polyline id="p" points="0,0 1,0 1,1"/></g>)x"
            R"x(<path id="q" transform="matrix(0 1 -1 0 5 0)" d="M0 0h1v1z"/>)x",
            R"x(<polyline id="p-1" points="0,0 1,0 1,1"/>)x"
            R"x(<polygon id="q-2" transform="rotate(90 1 1)" points="1 1 2 1 2 2" data-weight="7"/>)x"),
        "t.svg");
    ASSERT_EQ(f.size(), 5u);
    expect_line(f.line(0, 0), 10, 20, 12, 20);
    expect_line(f.line(1, 0), 12, 20, 12, 22);
    expect_line(f.line(2, 0), 5, 0, 5, 1);
    expect_line(f.line(2, 1), 1, 1, 1, 2);
    expect_line(f.line(4, 0), 4, 1, 5, 0);
}

TEST(FeaturesSvg, CurvesOfAllKinds) {
    const Features f =
        parse_features_svg(svg(R"x(<path id="c" d="M0 0C0 40 40 40 40 0S80-40 80 0Q100 40 120 0T160 0"/>)x",
                               R"x(<path id="c-1" d="M0 0L40 0 80 0 120 0 160 0"/>)x"),
                           "c.svg");
    ASSERT_GT(f.size(), 8u);
    expect_line(f.line(f.size() - 1, 0), f.line(f.size() - 1, 0).p.x, f.line(f.size() - 1, 0).p.y, 160, 0);
    // A straight partner is divided evenly, as Bezier's parameter goes on a straight cubic.
    for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(f.line(i, 1).p.y, 0, 1e-12);
}

TEST(FeaturesSvg, PicturesInLayersAreTheFrames) {
    const Features f = parse_features_svg(
        svg(R"x(<image x="100" y="50" width="30" height="20" transform="scale(2)"/>)x"
            R"x(<path id="p" d="M 200 100 220 120"/>)x",
            R"x(<image x="0" y="0" width="40" height="40"/><path id="p-1" d="M 1 2 3 4"/>)x"),
        "i.svg");
    expect_line(f.line(0, 0), 0, 0, 10, 10);
    EXPECT_EQ(f.frame(0).width, 30);
    EXPECT_EQ(f.frame(1).height, 40);
}

TEST(FeaturesSvg, EllipsesAreCurves) {
    const auto points = [](const std::string& shape) {
        const Features f = parse_features_svg(svg(shape, shape), "e.svg");
        std::vector<Point<double>> all;
        for (std::size_t i = 0; i < f.size(); ++i) all.push_back(f.line(i, 1).p);
        return all;
    };
    const auto circle = points(R"x(<circle id="c" cx="100" cy="50" r="40"/>)x");
    ASSERT_GE(circle.size(), 8u);
    EXPECT_NEAR(circle[0].x, 140, 1e-12);
    EXPECT_NEAR(circle[0].y, 50, 1e-12);
    EXPECT_GT(circle[1].y, 50);
    for (const Point<double>& p : circle) EXPECT_NEAR(std::hypot(p.x - 100, p.y - 50), 40, 40 * 3e-4);
    for (const Point<double>& p :
         points(R"x(<ellipse id="c" cx="10" cy="20" rx="30" ry="5" transform="scale(2,1)"/>)x"))
        EXPECT_NEAR(std::hypot((p.x - 20) / 60, (p.y - 20) / 5), 1, 3e-4);
    // Labels are enough, whatever is drawn, and however many there are without an id.
    const std::string eyes = R"x(<circle inkscape:label="left" cx="10" cy="10" r="3"/>
                                 <ellipse inkscape:label="right" cx="30" cy="10" rx="3" ry="2"/>
                                 <path inkscape:label="nose" d="M 20 10 20 20"/>)x",
                      turned = R"x(<path inkscape:label="nose" d="M 21 10 20 20"/>
                                   <ellipse inkscape:label="right" cx="31" cy="10" rx="3" ry="2"/>
                                   <ellipse inkscape:label="left" cx="11" cy="10" rx="3" ry="4"/>)x";
    const Features by_label = parse_features_svg(svg(eyes, turned), "x.svg");
    const Features by_id = parse_features_svg(
        svg(R"x(<circle id="a" cx="10" cy="10" r="3"/><ellipse id="b" cx="30" cy="10" rx="3" ry="2"/>
                <path id="c" d="M 20 10 20 20"/>)x",
            R"x(<path id="c" d="M 21 10 20 20"/><ellipse id="b" cx="31" cy="10" rx="3" ry="2"/>
                <ellipse id="a" cx="11" cy="10" rx="3" ry="4"/>)x"),
        "x.svg");
    ASSERT_EQ(by_label.size(), by_id.size());
    for (std::size_t i = 0; i < by_id.size(); ++i)
        for (const int k : {0, 1})
            expect_line(by_label.line(i, k), by_id.line(i, k).p.x, by_id.line(i, k).p.y, by_id.line(i, k).q.x,
                        by_id.line(i, k).q.y);
    EXPECT_THAT(message(parse_features_svg, svg(R"x(<circle id="c" r="0"/>)x", "")),
                HasSubstr("radii above 0"));
}

TEST(FeaturesSvg, LayersSayTheirNamesAndPictures) {
    const std::string line = R"x(<path id="p" d="M 1 2 3 4"/>)x";
    const auto picture = [](const std::string& link) {
        return R"x(<image width="10" height="10" )x" + link + "/>";
    };
    const Features f = parse_features_svg(
        svg(picture(R"x(xlink:href="../shots/cat.png")x") + line,
            picture(R"x(href="data:image/png;base64,AAAA")x") + R"x(<path id="p-1" d="M 5 6 7 8"/>)x"),
        "t.svg");
    EXPECT_EQ(f.title(0), "A");
    EXPECT_EQ(f.title(1), "B");
    EXPECT_EQ(f.picture(0), "cat.png");
    EXPECT_EQ(f.picture(1), "");
    const Features turned = f.in_order({1, 0});
    EXPECT_EQ(turned.title(0), "B");
    EXPECT_EQ(turned.picture(1), "cat.png");
    EXPECT_EQ(turned.line(0, 0).p.x, 5);
    EXPECT_EQ(turned.line(0, 1).p.x, 1);
    EXPECT_EQ(turned.frame(0).width, f.frame(1).width);
}

TEST(FeaturesSvg, BadFilesAreNamed) {
    const auto bad = [](const std::string& text) { return message(parse_features_svg, text); };
    const std::string line = R"x(<path id="p" d="M 1 2 3 4"/>)x";
    EXPECT_THAT(bad(""), HasSubstr("no XML"));
    EXPECT_THAT(bad("<svg><g"), HasSubstr("no XML"));
    EXPECT_THAT(bad("<html/>"), HasSubstr("must be an svg element"));
    EXPECT_THAT(bad("<svg>" + line + "</svg>"), HasSubstr("must have from 2 to 64 layers"));
    EXPECT_THAT(bad(svg(line, R"x(<path id="q" d="M 1 2 3 4"/>)x")),
                HasSubstr("q in layer B: layer A has nothing with this id"));
    EXPECT_THAT(bad(svg(line + R"x(<path id="r" d="M 1 2 3 4"/>)x", R"x(<path id="p-1" d="M 1 2 3 4"/>)x")),
                HasSubstr("r in layer A: layer B has nothing with this id"));
    EXPECT_THAT(bad(svg(line, R"x(<path id="p-1" d="M 1 2 3 4 5 6"/>)x")),
                HasSubstr("p: the layers have 1 and 2 segments"));
    EXPECT_THAT(bad(svg(line, R"x(<path id="p-1" d="M 1 2 A 3 4 5 6 7 8 9"/>)x")), HasSubstr("arcs"));
    EXPECT_THAT(bad(svg(line, R"x(<path id="p-1" d="M 1 2 3 x"/>)x")),
                HasSubstr("path p-1: there must be a number"));
    EXPECT_THAT(bad(svg(line, R"x(<path id="p-1" transform="turn(3)" d="M 1 2 3 4"/>)x")),
                HasSubstr("path p-1: transform: turn"));
    EXPECT_THAT(bad(svg(line, R"x(<path id="p-1" d="M 1 2 1 2"/>)x")),
                HasSubstr("p: p=1,2,1,2: a line needs a length"));
    const std::string eye = R"x(<path id="e1" inkscape:label="eye" d="M 1 2 3 4"/>)x",
                      other = R"x(<path id="e2" inkscape:label="eye" d="M 5 6 7 8"/>)x";
    EXPECT_THAT(bad(svg(eye + other, eye)), HasSubstr("eye in layer A: its label is there twice"));
    EXPECT_THAT(bad(svg(eye, eye + other)), HasSubstr("eye in layer B: its label is there twice"));
    std::string deep;
    for (int i = 0; i < 5000; ++i) deep += "<g>";
    deep += line;
    for (int i = 0; i < 5000; ++i) deep += "</g>";
    EXPECT_THAT(bad(svg(deep, line)), HasSubstr("nested too deeply"));
}

TEST(FeaturesFile, TheNamesEndChoosesTheReader) {
    EXPECT_EQ(parse_features_file("1,2,3,4,5,6,7,8", "a.CSV").size(), 1u);
    EXPECT_EQ(parse_features_file(
                  svg(R"x(<path id="p" d="M 1 2 3 4"/>)x", R"x(<path id="p-1" d="M 1 2 3 4"/>)x"), "a.svg")
                  .size(),
              1u);
    EXPECT_EQ(parse_features_file(R"x({"features": [{"line": [[0,0,1,0], [0,0,1,0]]}]})x", "a").size(), 1u);
}

TEST(FeaturesFile, MoreLinesThanAllowedAreRefused) {
    std::string csv;
    for (std::size_t i = 0; i < kMaxFeatures; ++i) csv += "1,2,3,4,5,6,7,8\n";
    EXPECT_EQ(parse_features_file(csv, "a.csv").size(), kMaxFeatures);
    csv += "1,2,3,4,5,6,7,8\n";
    EXPECT_THAT(message(parse_features_csv, csv), HasSubstr("131073: must have at most 131072 lines"));
}

TEST(FeaturesFile, EndlessFilesAreRefused) {
    const std::string big(text_file::kMostBytes + 1, ' ');
    for (const char* name : {"a.csv", "a.svg", "a.json"}) {
        try {
            parse_features_file(big, name);
            ADD_FAILURE();
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), HasSubstr("64 MB"));
        }
    }
}

}  // namespace
}  // namespace anamorph::test_features_file
