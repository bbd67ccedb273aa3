// SPDX-License-Identifier: Apache-2.0
#include "anamorph/parameter/parameter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <numbers>
#include <random>

#include "anamorph/operation/pano.h"
#include "anamorph/operation/rows.h"
#include "anamorph/panorama/reproject.h"

namespace anamorph::test_parameter {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

template <class Body>
std::string error_of(const Body& body) {
    try {
        body();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

ParameterValues values(const std::vector<Assignment>& assignments) {
    ParameterValues v(*pano_operation().parameters);
    v.assign(assignments);
    v.refuse_definitions();
    return v;
}

ReprojectRequest request(const std::vector<Assignment>& assignments,
                         const SourceFacts& source = {2048, 1024, {}}) {
    return read_reproject_request(values(assignments), source);
}

TEST(Parameter, EveryDefaultIsAllowed) {
    for (const Parameter& p : *pano_operation().parameters) {
        SCOPED_TRACE(p.name);
        EXPECT_FALSE(p.documentation.empty());
        if (!p.default_value.empty()) {
            EXPECT_NO_THROW(values({{p.name, p.default_value}}));
        }
    }
}

TEST(Parameter, LaterPlacesOverrideEarlierOnes) {
    ParameterValues v(*pano_operation().parameters);
    v.assign({{"yaw", "10"}, {"pitch", "5"}});
    v.assign({{"yaw", "20"}});
    EXPECT_EQ(v.number("yaw"), 20);
    EXPECT_EQ(v.number("pitch"), 5);
    EXPECT_EQ(v.number("roll"), 0);
    EXPECT_TRUE(v.given("yaw"));
    EXPECT_FALSE(v.given("roll"));
}

TEST(Parameter, KeysThatDefineNames) {
    Parameter definitions;
    definitions.name = "let";
    definitions.definitions = true;
    const ParameterTable table{definitions};
    ParameterValues values(table);
    values.assign({{"b", "1"}, {"a", "2"}, {"LET", "z=1"}, {"B", "3"}});
    values.assign({{"a", "4"}});
    ASSERT_EQ(values.definitions().size(), 3);
    EXPECT_EQ(values.definitions()[1].key, "a");
    EXPECT_EQ(values.definitions()[1].value, "4");
    EXPECT_EQ(values.definitions()[2].key, "B");
    EXPECT_EQ(values.key(), "let=z=1\nb=1\na=4\nB=3\n");
    EXPECT_THROW(values.assign({{"a", "1"}, {"a", "2"}}), Error);
    EXPECT_THROW(values.assign({{"a b", "1"}}), Error);
}

TEST(Parameter, KeysInAnyCase) {
    const ParameterValues v = values({{"SIZE", "64x32"}, {"Tile", "16"}, {"MIP", "1"}});
    EXPECT_EQ(v.extent("size").width, 64);
    EXPECT_EQ(v.extent("size").height, 32);
    EXPECT_EQ(v.extent("tile").width, 16);
    EXPECT_EQ(v.extent("tile").height, -1);
    EXPECT_TRUE(v.toggle("mip"));
    EXPECT_THAT(error_of([] {
                    values({{"SIZE", "64"}, {"size", "32"}});
                }),
                HasSubstr("size=32: given twice"));
}

TEST(Parameter, MessagesAreUtf8) {
    EXPECT_EQ(printable("caf\u00e9 \u4e16 \U0001f600"), "caf\u00e9 \u4e16 \U0001f600");
    EXPECT_EQ(printable("caf\xe9, \xc3"), "caf?, ?");
    EXPECT_EQ(printable("\xc0\xaf\xed\xa0\x80\xf4\x90\x80\x80\n"), "??????????");
    // Cut between characters.
    EXPECT_EQ(printable(std::string(99, 'x') + "\u00e9\u00e9"), std::string(99, 'x') + "...");
    EXPECT_EQ(printable(std::string(98, 'x') + "\u00e9\u00e9"), std::string(98, 'x') + "\u00e9...");
}

TEST(Parameter, ErrorsNameParameterValueAndWhatIsAllowed) {
    const auto says = [](const char* key, const std::string& value, const char* allowed) {
        const std::string error = error_of([&] { values({{key, value}}); });
        EXPECT_THAT(error, AllOf(HasSubstr(key), HasSubstr(printable(value)), HasSubstr(allowed)));
        EXPECT_THAT(error, Not(HasSubstr("\n")));
        EXPECT_LT(error.size(), 400u);
    };
    for (const char* bad :
         {"", "abc", "nan", "inf", "-inf", "1e400", "1,5", "0x10", "1 2", "--1", "+-1", "1.5.2"})
        says("yaw", bad, "must be a finite number");
    for (const char* bad : {"-1", "-0.001", "nan", "infinity"})
        says("tol", bad, "must be a number of at least 0");
    for (const char* bad :
         {"0", "0x0", "-1", "12x", "x12", "1x2x3", "99999999999", "1.5", "64 x 64", "1048577"})
        says("size", bad, "must be N or NxM, integers from 1 to 1048576");
    says("filter", "sinc", "nearest, bilinear, bicubic, sharp_bicubic, antialias");
    says("to", "Rectilinear", "rectilinear");
    says("mip", "yes", "must be 0 or 1");
    says("src", "", "must not be empty");
    says("yaws", "1", "src, from, to");
    says("yaw", std::string(100000, '7'), "finite");
    says("yaw", "1\n2\t3", "finite");
}

TEST(Parameter, AKeyThatIsNearAnotherIsAskedAfter) {
    const auto error = [](const std::string& key) { return error_of([&] { values({{key, "1"}}); }); };
    EXPECT_THAT(error("jaw"),
                HasSubstr("jaw=1: there is no such parameter, perhaps yaw is meant: must be one of"));
    EXPECT_THAT(error("PICH"), HasSubstr("perhaps pitch is meant"));
    EXPECT_THAT(error("outptu"), HasSubstr("perhaps output is meant"));
    EXPECT_THAT(error("fvo"), HasSubstr("perhaps fov is meant"));
    EXPECT_THAT(error("ywa"), HasSubstr("perhaps yaw is meant"));
    EXPECT_THAT(error("vof"), testing::Not(HasSubstr("perhaps")));
    for (const std::string& far : {std::string("k"), std::string("elevation"), std::string(100000, 'y')})
        EXPECT_THAT(error(far), HasSubstr("there is no such parameter: must be one of"));
}

TEST(Parameter, WholeNumbersAndLists) {
    const ParameterTable table = {rows::whole("count", "", "2", 1, 99, "some"),
                                  rows::numbers("parts", -rows::kInfinity, "more"),
                                  rows::numbers("gains", 0, "more")};
    ParameterValues v(table);
    EXPECT_EQ(v.whole("count"), 2);
    v.assign({{"count", "17"}, {"parts", "0.5, -1e1,3"}});
    EXPECT_EQ(v.whole("count"), 17);
    EXPECT_EQ(v.numbers("parts"), (std::vector<double>{0.5, -10, 3}));
    const auto refuses = [&](const char* key, const char* value, const char* allowed) {
        EXPECT_THAT(error_of([&] {
                        v.assign({{key, value}});
                    }),
                    AllOf(HasSubstr(key), HasSubstr(allowed)))
            << value;
    };
    for (const char* bad : {"0", "100", "1.5", "", "one", "1,2", "99999999999"})
        refuses("count", bad, "must be an integer from 1 to 99");
    for (const char* bad : {"", ",", "1,", "1;2", "nan", "1,inf", "1 2"})
        refuses("parts", bad, "must be finite numbers, separated by commas");
    refuses("gains", "1,-2", "must be numbers of at least 0, separated by commas");
}

TEST(Parameter, TypedValuesAreThoseThatAreWritten) {
    const ParameterTable table = {rows::number("part", "", "", 0, 1, ""),
                                  rows::above(rows::number("above", "", "", 0, 1, "")),
                                  rows::whole("count", "", "", 1, 99, ""),
                                  rows::toggle("on", "0", ""),
                                  rows::numbers("gains", 0, ""),
                                  rows::size(""),
                                  rows::wrap("is black"),
                                  rows::text("note", "")};
    ParameterValues typed(table), written(table);
    typed.set("part", 0.1);
    typed.set("COUNT", 7);
    typed.set("on", true);
    typed.set("gains", std::vector<double>{0.25, 1e-300, 1.0 / 3});
    typed.set("size", Size{640, 480});
    typed.set("wrap", "mirror");
    typed.set("note", "a = b");
    written.assign({{"part", "0.1"},
                    {"count", "7"},
                    {"on", "1"},
                    {"gains", "0.25,1e-300,0.3333333333333333"},
                    {"size", "640x480"},
                    {"wrap", "mirror"},
                    {"note", "a = b"}});
    EXPECT_EQ(typed.key(), written.key());
    for (const ParameterValues& v : {typed, written}) {
        EXPECT_EQ(v.number("part"), 0.1);
        EXPECT_EQ(v.whole("count"), 7);
        EXPECT_TRUE(v.toggle("on"));
        EXPECT_EQ(v.numbers("gains"), (std::vector<double>{0.25, 1e-300, 1.0 / 3}));
        EXPECT_EQ(v.extent("size").height, 480);
        EXPECT_EQ(rows::chosen<Wrap>(v, "wrap"), Wrap::mirror);
    }
    const auto refuses = [&](const char* name, const auto& value) {
        EXPECT_THAT(error_of([&] { typed.set(name, value); }), AllOf(HasSubstr(name), HasSubstr("must")));
    };
    for (const double bad : {-0.1, 1.5, double(NAN), HUGE_VAL}) refuses("part", bad);
    refuses("above", 0.0);
    for (const double bad : {0.0, 1.5, 100.0, 1e300, double(NAN)}) refuses("count", bad);
    for (const double bad : {0.5, 2.0, double(NAN)}) refuses("on", bad);
    refuses("gains", std::vector<double>{});
    refuses("gains", std::vector<double>{1, -1});
    refuses("part", std::vector<double>{0.1, 0.2});
    refuses("size", Size{0, 5});
    refuses("size", Size{640, 1 << 30});
    refuses("wrap", 1.0);
    refuses("wrap", "Mirror");
    refuses("note", "");
    EXPECT_THAT(error_of([&] { typed.set("nonesuch", 1); }), HasSubstr("nonesuch"));
    const ParameterTable defining = {rows::definitions("let", "")};
    ParameterValues names(defining);
    names.set("h", 0.25);
    names.set("h", 0.5);
    ASSERT_EQ(names.definitions().size(), 1u);
    EXPECT_EQ(names.definitions()[0].value, "0.5");
    EXPECT_THAT(error_of([&] { names.set("2h", 1); }), HasSubstr("2h"));
    EXPECT_EQ(typed.key(), written.key()) << "what is refused changes nothing";
}

TEST(Parameter, NumbersDoNotDependOnTheLocale) {
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C"})
        if (std::setlocale(LC_ALL, name)) break;
    EXPECT_EQ(values({{"yaw", "1.5"}}).number("yaw"), 1.5);
    EXPECT_EQ(values({{"yaw", "+.25"}}).number("yaw"), 0.25);
    EXPECT_EQ(values({{"yaw", "-2e1"}}).number("yaw"), -20);
    EXPECT_EQ(shortest(0.01), "0.01");
    EXPECT_EQ(shortest(0.01f), "0.01");
    std::setlocale(LC_ALL, "C");
}

TEST(Recipe, LinesCommentsAndBlanks) {
    const auto a =
        parse_recipe("\xEF\xBB\xBF# view\r\n\r\n  to = rectilinear \r\n\tsrc=a = b#1.exr\n#yaw=1\nfov=90");
    ASSERT_EQ(a.size(), 3u);
    EXPECT_EQ(a[0].key, "to");
    EXPECT_EQ(a[0].value, "rectilinear");
    EXPECT_EQ(a[1].value, "a = b#1.exr");
    EXPECT_EQ(a[2].value, "90");
    EXPECT_TRUE(parse_recipe("").empty());
    EXPECT_TRUE(parse_recipe("\n\n#\n").empty());
}

TEST(Recipe, CommentsBehindValues) {
    const auto a = parse_recipe(
        "fov=100 # wide\nsrc=a#1.exr\t# a\nyaw = 3#4\nmesh=\"a #1.json\" # of the first\npoints=\"p\" "
        "q\nlens=# none\n"
        "machine={\"size\": 64}#\r\nroll=\"4 # 5\"");
    const char* const expected[] = {"100",    "a#1.exr",         "3#4",  "a #1.json", "\"p\" q",
                                    "# none", "{\"size\": 64}#", "4 # 5"};
    ASSERT_EQ(a.size(), std::size(expected));
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].value, expected[i]);
    EXPECT_EQ(parse_recipe("fov= # none")[0].value, "");
}

TEST(Recipe, ErrorsNameTheLine) {
    EXPECT_THAT(error_of([] { parse_recipe("yaw=1\nnonsense\n"); }), HasSubstr("line 2 is \"nonsense\""));
    EXPECT_THAT(error_of([] { parse_recipe("\n=1"); }), HasSubstr("line 2"));
    EXPECT_THAT(error_of([] { parse_recipe(std::string_view("a=1\nb=\0", 7)); }), HasSubstr("line 2"));
    EXPECT_THAT(error_of([] {
                    parse_recipe(
                        "\x7f"
                        "ELF\x02\x01");
                }),
                HasSubstr("line 1 holds a control character"));
    EXPECT_THAT(error_of([] { parse_recipe(std::string(kMaxRecipeBytes + 1, '\n')); }),
                HasSubstr("1048577 bytes"));
    EXPECT_NO_THROW(parse_recipe(std::string(kMaxRecipeBytes, '\n')));
}

TEST(RecipeName, SplitsArguments) {
    const RecipeName n = parse_recipe_name("a/b.exr.pano?to=rectilinear&src=c d/e;(1)[2]+*:%20,x.exr&yaw=3");
    EXPECT_EQ(n.base, "a/b.exr.pano");
    ASSERT_EQ(n.assignments.size(), 3u);
    EXPECT_EQ(n.assignments[1].value, "c d/e;(1)[2]+*:%20,x.exr");
    EXPECT_EQ(n.assignments[2].key, "yaw");
    EXPECT_TRUE(parse_recipe_name("plain.pano").assignments.empty());
    EXPECT_TRUE(parse_recipe_name("plain.pano?").assignments.empty());
}

TEST(RecipeName, ANestedNameTakesTheRest) {
    const RecipeName n = parse_recipe_name("x.pano?yaw=1&src=y.pano?yaw=2&src=z.null?RES=8x4&TILE=2x2");
    ASSERT_EQ(n.assignments.size(), 2u);
    EXPECT_EQ(n.assignments[1].value, "y.pano?yaw=2&src=z.null?RES=8x4&TILE=2x2");
    const RecipeName inner = parse_recipe_name(n.assignments[1].value);
    ASSERT_EQ(inner.assignments.size(), 2u);
    EXPECT_EQ(inner.assignments[1].value, "z.null?RES=8x4&TILE=2x2");
}

TEST(RecipeName, ANestedNameInBracketsStandsAnywhere) {
    const RecipeName n =
        parse_recipe_name("x.morph?a=(y.pano?yaw=2&fov=40)&t=0.3&b=(z(1).warp?mesh=(q.pano?a=1)&step=2)");
    ASSERT_EQ(n.assignments.size(), 3u);
    EXPECT_EQ(n.assignments[0].value, "y.pano?yaw=2&fov=40");
    EXPECT_EQ(n.assignments[1].value, "0.3");
    EXPECT_EQ(n.assignments[2].value, "z(1).warp?mesh=(q.pano?a=1)&step=2");
    // Brackets that are part of a name: those without arguments inside, and those that are not all of the
    // value.
    for (const char* value : {"(1).exr", "(old)/x.exr", "((", "(a", "a)", "()"})
        EXPECT_EQ(parse_recipe_name(std::string("x.pano?src=") + value + "&yaw=3").assignments[0].value,
                  value);
    EXPECT_EQ(parse_recipe_name("x.pano?src=(old)/y.pano?yaw=1&fov=3").assignments[0].value,
              "(old)/y.pano?yaw=1&fov=3");
    EXPECT_EQ(parse_recipe_name("x.pano?src=(y.pano?yaw=1&fov=3").assignments[0].value,
              "(y.pano?yaw=1&fov=3");
}

TEST(RecipeName, RefusesWhatIsNotAnAssignment) {
    for (const char* bad :
         {"a.pano?flag", "a.pano?&yaw=1", "a.pano?=1", "a.pano?yaw=1&&fov=2", "a.pano?yaw=\n"})
        EXPECT_THAT(error_of([&] { parse_recipe_name(bad); }), HasSubstr("must be key=value")) << bad;
}

TEST(RecipeName, RandomBytesGiveAnErrorOrAResult) {
    const unsigned seed = 20260729;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::string alphabet = std::string("src=yaw?&().pano#\r\n \t\xEF\xBB\xBF%x0123456789") + '\0';
    for (int i = 0; i < 20000; ++i) {
        std::string text(random() % 40, ' ');
        for (char& c : text) c = alphabet[random() % alphabet.size()];
        try {
            for (const Assignment& a : parse_recipe(text)) EXPECT_FALSE(a.key.empty());
        } catch (const Error&) {
        }
        try {
            for (const Assignment& a : parse_recipe_name(text).assignments) EXPECT_FALSE(a.key.empty());
        } catch (const Error&) {
        }
    }
}

TEST(ReprojectRequest, SaysFromWhereItCanBeKnown) {
    EXPECT_EQ(request({}).source.chart.projection(), Projection::equirectangular);
    EXPECT_EQ(request({}, {64, 384, {}}).source.chart.projection(), Projection::cubemap);
    EXPECT_EQ(request({}, {2048, 1024, Projection::mercator}).source.chart.projection(),
              Projection::mercator);
    EXPECT_EQ(request({{"from", "latlong"}}, {300, 200, {}}).source.chart.projection(),
              Projection::equirectangular);
    EXPECT_THAT(error_of([] {
                    request({}, {300, 200, {}});
                }),
                AllOf(HasSubstr("from"), HasSubstr("300x200")));
}

TEST(ReprojectRequest, SizeOfThePicture) {
    const auto size = [](const std::vector<Assignment>& assignments) {
        const Chart target = request(assignments).target;
        return std::pair(target.width(), target.height());
    };
    using Pair = std::pair<int, int>;
    EXPECT_EQ(size({{"size", "300x200"}}), Pair(300, 200));
    EXPECT_EQ(size({{"size", "300"}}), Pair(300, 300));
    EXPECT_EQ(size({{"size", "300"}, {"to", "equirectangular"}}), Pair(300, 150));
    EXPECT_EQ(size({{"size", "300"}, {"to", "equirectangular"}, {"fov", "90"}}), Pair(300, 300));
    EXPECT_EQ(size({{"size", "314"}, {"to", "cylindrical"}}), Pair(314, 100));
    EXPECT_EQ(size({{"size", "64"}, {"to", "cubemap"}}), Pair(64, 384));
    EXPECT_EQ(size({{"size", "96"}, {"to", "cubemap3x2"}}), Pair(96, 64));
    EXPECT_EQ(size({{"size", "128"}, {"to", "cubecross"}}), Pair(128, 96));
    // 2048 pixels for 2 pi: a 90 degree view is 2 tan 45 of them wide.
    EXPECT_EQ(size({}), Pair(652, 652));
    EXPECT_EQ(size({{"to", "equirectangular"}}), Pair(2048, 1024));
    EXPECT_EQ(size({{"to", "cubemap"}}), Pair(652, 6 * 652));
    EXPECT_EQ(size({{"fov", "179.9"}}), Pair(kMaxDefaultSize, kMaxDefaultSize));
}

TEST(ReprojectRequest, ErrorsOfLensesAndSizes) {
    EXPECT_THAT(error_of([] {
                    request({{"fov", "180"}});
                }),
                AllOf(HasSubstr("fov=180"), HasSubstr("below 180")));
    EXPECT_THAT(error_of([] {
                    request({{"fov", "0"}});
                }),
                HasSubstr("fov=0: must be a number above 0, at most 360"));
    EXPECT_THAT(error_of([] { request({{"to", "cubemap"}, {"fov", "80"}}); }), HasSubstr("fov=80"));
    EXPECT_THAT(error_of([] { request({{"to", "cubemap"}, {"size", "8x8"}}); }), HasSubstr("size=8x8"));
    EXPECT_THAT(error_of([] { request({{"from", "cubemap"}}); }), HasSubstr("source size=2048x1024"));
    EXPECT_THAT(error_of([] {
                    request({{"from", "rectilinear"}, {"srcfov", "190"}});
                }),
                HasSubstr("srcfov=190"));
}

TEST(ReprojectRequest, Lenses) {
    const SourceFacts photo{3000, 2000, Projection::rectilinear};
    const std::vector<Assignment> both = {{"srcfov", "70"},
                                          {"srclens", "brown:k1=-0.1"},
                                          {"srcpitch", "5"},
                                          {"lens", "ptlens:b=0.02,c=-0.5,d=3"},
                                          {"fov", "60"}};
    const ReprojectRequest r = request(both, photo);
    EXPECT_EQ(r.source.chart.lens()->model().text(), "brown:k1=-0.1");
    EXPECT_EQ(r.target.lens()->model().text(), "ptlens:b=0.02,c=-0.5,d=3");
    EXPECT_EQ(r.held.pitch, 5);
    EXPECT_EQ(r.orientation.pitch, 0);
    // As fine as the source at the centre, where this lens magnifies by 1.48.
    const double tangents = std::tan(30 * std::numbers::pi / 180) / std::tan(35 * std::numbers::pi / 180);
    EXPECT_EQ(r.target.width(), std::lround(3000 * tangents / 1.48));
    EXPECT_EQ(half_size(r.target)->lens()->model().text(), r.target.lens()->model().text());
    EXPECT_EQ(request({}).target.lens(), nullptr);
    EXPECT_EQ(request({{"lens", "none"}, {"srclens", "none"}}).target.lens(), nullptr);
    // What the image says of itself, unless its projection is another one or the recipe says something else.
    SourceFacts says = photo;
    says.lens = LensModel::parse("ptlens:b=-0.01");
    EXPECT_EQ(request({}, says).source.chart.lens()->model().text(), "ptlens:b=-0.01");
    EXPECT_EQ(request({{"from", "fisheye"}}, says).source.chart.lens(), nullptr);
    EXPECT_EQ(request({{"srclens", "none"}}, says).source.chart.lens(), nullptr);
}

/// What a request draws of noise.
std::vector<float> drawn(const std::vector<Assignment>& assignments, const SourceFacts& facts) {
    const ReprojectRequest r = request(assignments, facts);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(0, 1);
    std::vector<float> texels(static_cast<std::size_t>(facts.width) * static_cast<std::size_t>(facts.height));
    for (float& t : texels) t = value(random);
    const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                          PixelType::float32, facts.width, facts.height, 1));
    const Box all{0, 0, r.target.width(), r.target.height()};
    std::vector<float> pixels(static_cast<std::size_t>(all.width()) * static_cast<std::size_t>(all.height()));
    const ImageView view = packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32,
                                       all.width(), all.height(), 1);
    EXPECT_TRUE(reprojected_picture(r.map(), r.options).draw(&source, all, view));
    return pixels;
}

/// Of noise from 0 to 1, drawn with points that are .02 pixels apart at most.
void expect_near(const std::vector<float>& a, const std::vector<float>& b, const char* words) {
    ASSERT_EQ(a.size(), b.size());
    float worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::fabs(a[i] - b[i]));
    EXPECT_LE(worst, 0.04f) << words;
}

TEST(ReprojectRequest, KeysThatChangeNothingChangeNoBits) {
    const SourceFacts photo{300, 200, Projection::rectilinear}, fisheye{200, 200, Projection::fisheye};
    // Bilinear: other blocks may have other footprints, whose axes are only near the map's own.
    const std::vector<Assignment> look = {{"yaw", "12"},       {"pitch", "-7"}, {"roll", "3"},
                                          {"size", "150x100"}, {"fov", "80"},   {"filter", "bilinear"}};
    const auto with = [&](std::vector<Assignment> more) {
        more.insert(more.end(), look.begin(), look.end());
        return more;
    };
    const std::vector<Assignment> level = {{"srcyaw", "0"}, {"srcpitch", "0"}, {"srcroll", "-0"}};
    for (const char* tol : {"0.01", "0"}) {
        const auto of_photo = [&](std::vector<Assignment> keys) {
            keys.push_back({"tol", tol});
            return drawn(with(keys), photo);
        };
        const std::vector<float> plain = of_photo({});
        EXPECT_EQ(of_photo(level), plain);
        EXPECT_EQ(of_photo({{"lens", "none"}, {"srclens", "none"}}), plain);
        // A lens whose numbers are all 0 is read all the same, and may be drawn by other blocks.
        for (const char* lens : {"ptlens", "ptlens:a=0,b=-0", "brown", "brown:k1=0,p2=0,d=0", "3de4"}) {
            expect_near(of_photo({{"lens", lens}}), plain, lens);
            expect_near(of_photo({{"srclens", lens}}), plain, lens);
        }
        EXPECT_NE(of_photo({{"lens", "ptlens:b=0.01"}}), plain);
        EXPECT_NE(of_photo({{"srcroll", "0.5"}}), plain);

        const auto of_fisheye = [&](std::vector<Assignment> keys) {
            keys.insert(keys.end(), {{"to", "fisheye"}, {"srcfov", "180"}, {"tol", tol}});
            return drawn(with(keys), fisheye);
        };
        const std::vector<float> round = of_fisheye({});
        EXPECT_EQ(of_fisheye(level), round);
        EXPECT_EQ(of_fisheye({{"lens", "none"}, {"srclens", "none"}}), round);
        for (const char* lens : {"kb4", "kb4:k1=0"}) {
            expect_near(of_fisheye({{"lens", lens}}), round, lens);
            expect_near(of_fisheye({{"srclens", lens}}), round, lens);
        }
    }
    EXPECT_THAT(error_of([] { request({{"srclens", "ptlens"}}); }), HasSubstr("must be none for equirect"));
}

TEST(ReprojectRequest, ErrorsOfLenses) {
    const auto error = [](const std::vector<Assignment>& assignments) {
        return error_of([&] { request(assignments); });
    };
    EXPECT_THAT(error({{"lens", "ptlens:x=1"}}),
                HasSubstr("lens=ptlens:x=1: ptlens must be followed by values of"));
    EXPECT_THAT(
        error({{"srclens", "ptlens:a=1"}}),
        HasSubstr("srclens=ptlens:a=1: must be none for equirectangular of 360 degrees, which has no lens"));
    EXPECT_THAT(error({{"lens", "3de4:k1=-4"}, {"size", "300x200"}}),
                HasSubstr("lens=3de4:k1=-4: folds at a radius of 52 pixels: must not within 100"));
    EXPECT_THAT(error({{"srcyaw", "up"}}), HasSubstr("srcyaw=up: must be a finite number"));
}

TEST(ReprojectRequest, HalfSizes) {
    const auto levels = [](const std::vector<Assignment>& assignments) {
        std::optional<Chart> chart = request(assignments).target;
        int n = 0;
        for (; chart; chart = half_size(*chart)) ++n;
        return n;
    };
    EXPECT_EQ(levels({{"size", "64x64"}}), 7);
    EXPECT_EQ(levels({{"size", "100x3"}}), 7);
    EXPECT_EQ(levels({{"size", "1x1"}}), 1);
    EXPECT_EQ(levels({{"to", "cubemap"}, {"size", "12"}}), 4);
    EXPECT_EQ(levels({{"to", "cubecross"}, {"size", "64"}}), 5);
}

TEST(ReferencePage, HasEveryParameter) {
    const std::string page = reference_page("Panorama", *pano_operation().parameters);
    for (const Parameter& p : *pano_operation().parameters)
        EXPECT_THAT(page, HasSubstr("| `" + p.name + "`"));
    EXPECT_THAT(page, HasSubstr("| `tol` | `0.01` | source pixels | a number of at least 0 |"));
}

}  // namespace
}  // namespace anamorph::test_parameter
