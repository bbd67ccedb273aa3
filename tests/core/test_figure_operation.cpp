// SPDX-License-Identifier: Apache-2.0
// What the table of figures makes of its values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "anamorph/operation/operation.h"

namespace anamorph::test_figure_operation {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const char* const kScript = R"(figure doll 2 body head
ellipsoid body  130 190  90
ellipsoid head   85 100  85
joint neck   body    0 175 0   head   30 -90 0
repeat 0 1 moveto doll body 500 420 500
linear 0 4 spinby doll body body 80 z
view 1 4
stop
)";

class Texts final : public SideFileReader {
  public:
    std::map<std::string, std::string> files = {{"a/doll.n", kScript}};
    std::string text(const std::string& name) const override {
        const auto found = files.find(name);
        if (found == files.end()) throw Error("there is no file " + name);
        return found->second;
    }
    bool exists(const std::string& name) const override { return files.contains(name); }
    std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
        throw Error("there is no image " + name);
    }
};

std::unique_ptr<const Pictures> read(const std::vector<Assignment>& more, const Texts& texts = {}) {
    const Operation& operation = *find_operation("figure");
    ParameterValues values(*operation.parameters);
    values.assign(more);
    SideFiles files = {{"script", {"a/doll.n", ""}}};
    if (values.given("library")) files["library"] = {values.text("library"), ""};
    return operation.read({values, {}, files, texts});
}

std::vector<float> draw(const PictureRequest& request) {
    const int channels = request.pixels == PixelKind::point ? 2 : static_cast<int>(request.channels.size());
    const Box box = {0, 0, request.size.width, request.size.height};
    std::vector<float> pixels(static_cast<std::size_t>(box.width() * box.height() * channels));
    request.solve()->draw({}, box,
                          packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32,
                                      box.width(), box.height(), channels),
                          serial_for);
    return pixels;
}

std::vector<float> drawn(std::vector<Assignment> more, const Texts& texts = {}) {
    more.push_back({"size", "64x48"});
    more.push_back({"frame", "2"});
    return draw(*read(more, texts)->picture(0, 0));
}

std::string error_of(const std::vector<Assignment>& more, const Texts& texts = {}) {
    try {
        const auto pictures = read(more, texts);
        pictures->picture(0, 0)->solve();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

/// Of 64 x 48 pixels with so many channels.
void expect_like(const std::vector<float>& a, const std::vector<float>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1.01f / 128);
}

TEST(FigureOperation, FramesAreThoseThatTheScriptShows) {
    const auto film = read({});
    EXPECT_EQ(film->frames(), 3);
    const auto number = [](const PictureRequest& request) {
        for (const Attribute& a : request.says)
            if (a.name == "anamorph:frame") return std::get<int>(a.value);
        return -1;
    };
    for (int i = 0; i < 3; ++i) {
        const PictureRequest picture = *film->picture(i, 4);
        EXPECT_EQ(number(picture), i + 2);
        EXPECT_EQ(picture.size, (Size{62, 62}));
        const auto alone = read({{"frame", std::to_string(i + 2)}});
        EXPECT_EQ(alone->frames(), 1);
        EXPECT_EQ(draw(picture), draw(*alone->picture(0, 4)));
    }
    EXPECT_NE(draw(*film->picture(0, 4)), draw(*film->picture(1, 4)));
    // Frames that are not shown can be asked for, those that are not performed cannot.
    EXPECT_EQ(error_of({{"frame", "0"}}), "no error");
    EXPECT_THAT(error_of({{"frame", "5"}}), HasSubstr("frame=5: must be an integer from 0 to 4"));
    Texts still;
    still.files["a/doll.n"] = "figure f 1 e\nellipsoid e 1 2 3\nstop\n";
    EXPECT_EQ(read({}, still)->frames(), 1);
    EXPECT_EQ(number(*read({}, still)->picture(0, 0)), 0);
    still.files["a/doll.n"] = "figure f 1 e\nellipsoid e 1 2 3\nrepeat 0 100001 spinby f e e 1 x\nstop\n";
    EXPECT_THAT(error_of({}, still), HasSubstr("frame is not given and the script shows 100001 frames"));
}

TEST(FigureOperation, StylesHaveTheirChannels) {
    using Names = std::vector<std::string>;
    const auto channels = [](const char* style) { return read({{"style", style}})->picture(0, 0)->channels; };
    for (const char* style : {"shaded", "outline", "stick"})
        EXPECT_EQ(channels(style), (Names{"R", "G", "B", "A"}));
    EXPECT_EQ(channels("depth"), Names{"Z"});
    EXPECT_EQ(channels("id"), Names{"id"});
    EXPECT_EQ(read({{"style", "uv"}})->picture(0, 0)->pixels, PixelKind::point);
}

TEST(FigureOperation, ViewsAreWhatTheScriptCouldSay) {
    Texts turned, moved;
    turned.files["a/doll.n"] = "repeat 0 2 observe 10 20 30\n" + std::string(kScript);
    moved.files["a/doll.n"] = "repeat 0 2 place 400 450 500\n" + std::string(kScript);
    for (const char* style : {"shaded", "outline", "stick", "depth", "id"}) {
        SCOPED_TRACE(style);
        EXPECT_EQ(drawn({{"style", style}, {"camera", "10,20,30"}}), drawn({{"style", style}}, turned));
        EXPECT_EQ(drawn({{"style", style}, {"place", "400,450,500"}}), drawn({{"style", style}}, moved));
    }
    EXPECT_NE(drawn({{"camera", "10,20,30"}}), drawn({}));
    EXPECT_NE(drawn({{"perspective", "800"}}), drawn({}));
    // From very far away there is no perspective.
    expect_like(drawn({{"perspective", "1e9"}, {"style", "id"}}), drawn({{"style", "id"}}));
}

TEST(FigureOperation, ZoomAndLevelsAreSizes) {
    const std::vector<float> large =
        draw(*read({{"size", "128x96"}, {"frame", "2"}, {"style", "id"}})->picture(0, 0));
    const std::vector<float> zoomed = drawn({{"zoom", "2"}, {"style", "id"}});
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            EXPECT_EQ(zoomed[static_cast<std::size_t>(y * 64 + x)],
                      large[static_cast<std::size_t>((y + 24) * 128 + x + 32)]);
    // A level is what the mean of the one before comes close to.
    const std::vector<float> small = drawn({});
    const std::vector<float> level = draw(*read({{"size", "128x96"}, {"frame", "2"}})->picture(0, 1));
    EXPECT_EQ(level, small);
}

TEST(FigureOperation, ALibraryIsIncluded) {
    Texts texts;
    const std::string all = kScript;
    const std::size_t movements = all.find("repeat");
    texts.files["lib/dolls.n"] = all.substr(0, movements);
    texts.files["a/doll.n"] = all.substr(movements);
    EXPECT_EQ(drawn({{"library", "lib/dolls.n"}}, texts), drawn({}));
    texts.files["a/dolls.n"] = texts.files["lib/dolls.n"];
    texts.files["a/doll.n"] = "include dolls.n\n" + all.substr(movements);
    EXPECT_EQ(drawn({}, texts), drawn({}));
    // What is included is known before anything is performed.
    const Operation& operation = *find_operation("figure");
    const ParameterValues values(*operation.parameters);
    const LinkedFiles linked = operation.linked(values, {{"script", {"a/doll.n", ""}}}, texts);
    ASSERT_EQ(linked.size(), 1u);
    EXPECT_EQ(linked[0].name, "a/dolls.n");
}

TEST(FigureOperation, WhatIsWrongIsNamed) {
    EXPECT_THAT(error_of({{"camera", "1,2"}}), AllOf(HasSubstr("camera=1,2"), HasSubstr("three numbers")));
    EXPECT_THAT(error_of({{"camera", "1,2,1e300"}}), HasSubstr("must be three numbers from -1e+09 to 1e+09"));
    EXPECT_THAT(error_of({{"place", "1"}}), HasSubstr("place=1"));
    EXPECT_THAT(error_of({{"light", "0,0,0"}}), HasSubstr("light=0,0,0: must not be 0,0,0"));
    for (const char* key : {"red", "green", "blue", "let"}) {
        EXPECT_THAT(error_of({{key, "x"}}), HasSubstr("is of solid=formula alone")) << key;
        EXPECT_THAT(error_of({{"solid", "wood"}, {key, "x"}}), HasSubstr("is of solid=formula alone")) << key;
        EXPECT_THAT(error_of({{"solid", "formula"}, {key, "k=nosuch"}}), HasSubstr(key)) << key;
    }
    EXPECT_THAT(error_of({{"solid", "formula"}, {"red", "q+1"}}),
                AllOf(HasSubstr("red=q+1"), HasSubstr("q")));
    EXPECT_THAT(error_of({{"solid", "stone"}}), AllOf(HasSubstr("solid=stone"), HasSubstr("marble")));
    for (const char* samples : {"0", "17", "nan", "2147483648"})
        EXPECT_THAT(error_of({{"solid_samples", samples}}), HasSubstr("must be an integer from 1 to 16"));
    for (const char* scale : {"0", "nan", "inf", "-1"})
        EXPECT_THAT(error_of({{"solid_scale", scale}}), HasSubstr("must be a number from 0.001 to 1e+06"));
    for (const char* scale : {"nan", "inf", "2e6"})
        EXPECT_THAT(error_of({{"bump_scale", scale}}), HasSubstr("must be a number from -1e+06 to 1e+06"));
    // What would mean nothing is not kept in silence.
    for (const char* key : {"solid_scale", "solid_samples"})
        EXPECT_THAT(error_of({{key, "5"}}), HasSubstr(key + std::string("=5: must be given with solid")));
    EXPECT_THAT(error_of({{"bump_scale", "5"}}), HasSubstr("bump_scale=5: must be given with bump"));
    for (const char* outlines : {"limbs", "boxes", "cylinders"})
        EXPECT_THAT(error_of({{"style", "outline"}, {"outlines", outlines}, {"outline_tol", "2"}}),
                    HasSubstr("outline_tol=2: must be given with outlines=levels or outlines=contours"));
    for (const char* key : {"solid", "bump"})
        EXPECT_THAT(error_of({{"style", "depth"}, {key, "wood"}}),
                    HasSubstr("is of styles shaded and textured alone"));
    for (const char* style : {"depth", "outline", "stick"})
        EXPECT_THAT(error_of({{"style", style}, {"perturbation", "0.1"}}),
                    HasSubstr("perturbation=0.1: is of styles shaded and textured alone"));
    EXPECT_THAT(error_of({{"seed", "5"}}), HasSubstr("seed=5: must be given with perturbation"));
    EXPECT_THAT(error_of({{"solid", "formula"}}),
                HasSubstr("solid=formula: must be given with red, green or blue"));
    EXPECT_THAT(error_of({{"viewport", "0.5,0.5,0.5"}, {"style", "outline"}}),
                HasSubstr("viewport=0.5,0.5,0.5: must be x,y,a,b"));
    EXPECT_THAT(error_of({{"viewport", "0.5,0.5,0.5,0"}, {"style", "stick"}}), HasSubstr("from 1e-04 to 10"));
    EXPECT_THAT(error_of({{"viewport", "0.5,0.5,0.5,nan"}, {"style", "stick"}}), HasSubstr("viewport"));
    EXPECT_THAT(error_of({{"viewport", "0.5,0.5,0.5,0.5"}}),
                HasSubstr("is of styles outline and stick alone"));
    EXPECT_THAT(error_of({{"background", "0,0,256"}}), HasSubstr("must be three numbers from 0 to 255"));
    Texts wrong;
    wrong.files["a/doll.n"] = "figure f 1 e\nelipsoid e 1 2 3\nstop\n";
    EXPECT_THAT(error_of({}, wrong), HasSubstr("doll.n:2:1: error"));
    wrong.files.clear();
    EXPECT_THAT(error_of({}, wrong), HasSubstr("a/doll.n"));
    wrong.files["a/doll.n"] = "include none.n\n" + std::string(kScript);
    EXPECT_THAT(error_of({}, wrong), AllOf(HasSubstr("doll.n:1"), HasSubstr("none.n")));
}

TEST(FigureOperation, ViewportsAreSharesOfThePicture) {
    const std::vector<Assignment> lines = {
        {"style", "outline"}, {"zoom", "3"}, {"line_width", "1"}, {"viewport", "0.5,0.25,0.25,0.25"}};
    const std::vector<float> cut = drawn(lines), whole = drawn({lines.begin(), lines.begin() + 3});
    double inside = 0, beyond = 0;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            const auto at = static_cast<std::size_t>(4 * (64 * y + x) + 3);
            const double away = std::hypot((x + 0.5 - 32) / 16, (y + 0.5 - 12) / 12);
            // Lines reach half their width beyond their middles, their ends likewise.
            if (away > 1.15) {
                EXPECT_EQ(cut[at], 0) << x << " " << y;
            } else if (away < 0.85) {
                EXPECT_EQ(cut[at], whole[at]) << x << " " << y;
            }
            inside += away < 0.85 ? whole[at] : 0;
            beyond += away > 1.15 ? whole[at] : 0;
        }
    EXPECT_GT(inside, 1);
    EXPECT_GT(beyond, 1);
    // Overscan leaves it where it is.
    std::vector<Assignment> more = lines;
    more.push_back({"overscan", "8x4"});
    const std::vector<float> wide = drawn(more);
    ASSERT_EQ(wide.size(), 80u * 56 * 4);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64 * 4; ++x)
            ASSERT_NEAR(wide[static_cast<std::size_t>(4 * 80 * (y + 4) + 32 + x)],
                        cut[static_cast<std::size_t>(4 * 64 * y + x)], 1.01 / 128);
}

TEST(FigureOperation, BackgroundsAreColorsAndBands) {
    const std::vector<float> bands =
        drawn({{"background", "0.5,255,0,0,1,0,0,255"}, {"zoom", "1e-6"}, {"antialias", "0"}});
    const auto at = [](const std::vector<float>& pixels, int y) {
        const float* p = &pixels[static_cast<std::size_t>(4 * 64 * y)];
        return std::vector<float>(p, p + 4);
    };
    EXPECT_EQ(at(bands, 23), (std::vector<float>{1, 0, 0, 1}));
    EXPECT_EQ(at(bands, 24), (std::vector<float>{0, 0, 1, 1}));
    for (const char* wrong :
         {"1,2", "1,2,3,4,5", "0.5,256,0,0", "1.5,0,0,0", "0.6,0,0,0,0.5,0,0,0", "0,0,256"})
        EXPECT_THAT(error_of({{"background", wrong}}), HasSubstr("background")) << wrong;
    // A frame of MRASEL has its own.
    Texts texts;
    texts.files["a/in.mrasel"] = "1 0 1\n511 51 0 255\n100 100 100 2560 2560 0 0 0 0 map\n";
    ParameterValues values(*find_operation("figure")->parameters);
    values.assign({{"size", "64x48"}});
    const SideFiles files = {{"script", {"a/in.mrasel", ""}}};
    const auto film = find_operation("figure")->read({values, {}, files, texts});
    EXPECT_EQ(film->frames(), 1);
    EXPECT_EQ(at(draw(*film->picture(0, 0)), 0), (std::vector<float>{0.2f, 0, 1, 1}));
}

/// An image of 8 x 4 texels, of which texel (x, y) has the values x + 10 y, + 100 and + 200.
class Numbered final : public Source {
  public:
    PixelType type() const noexcept override { return PixelType::float32; }
    int channels() const noexcept override { return 3; }
    int levels() const noexcept override { return 1; }
    Size size(int) const noexcept override { return {8, 4}; }
    bool read(int, const Box& box, std::byte* texels, std::ptrdiff_t stride) const noexcept override {
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x)
                for (int c = 0; c < 3; ++c) {
                    const auto value = static_cast<float>(x + 10 * y + 100 * c);
                    std::memcpy(texels + (y - box.y0) * stride + (3 * (x - box.x0) + c) * 4, &value, 4);
                }
        return true;
    }
};

TEST(FigureOperation, MapsOfMraselThatAreMissingAreNamed) {
    Texts texts;
    texts.files["a/doll.n"] = "figure f 1 e\nellipsoid e 1 2 3\nrepeat 0 1 texture e face 0 0\nstop\n";
    for (int side = 512; side > 0; side /= 2) texts.files["a/face." + std::to_string(side)] = "";
    const Operation& operation = *find_operation("figure");
    ParameterValues values(*operation.parameters);
    values.assign({{"style", "textured"}});
    const SideFiles files = {{"script", {"a/doll.n", ""}}};
    EXPECT_EQ(operation.linked(values, files, texts).size(), 10u);
    texts.files.erase("a/face.64");
    try {
        operation.linked(values, files, texts);
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "face.64 does not exist: must be beside face.512, as MTEXTURE writes it");
    }
}

TEST(FigureOperation, MipsShowThePyramid) {
    class Images final : public SideFileReader {
      public:
        std::string text(const std::string&) const override {
            return "figure f 1 e\nellipsoid e 1 2 3\nrepeat 0 1 texture e map 0 0\nrepeat 0 1 texture e gone "
                   "0 0\nstop\n";
        }
        std::unique_ptr<SideImage> image(const std::string&, const std::string&) const override {
            class Sized final : public SideImage {
              public:
                Size size() const override { return {8, 4}; }
                int channels() const override { return 3; }
                std::vector<float> read(int) override { return {}; }
            };
            return std::make_unique<Sized>();
        }
    };
    const Operation& operation = *find_operation("figure");
    ParameterValues values(*operation.parameters);
    values.assign({{"output", "mips"}});
    SideFiles files = {{"script", {"a/doll.n", ""}}};
    const Images reader;
    const LinkedFiles linked = operation.linked(values, files, reader);
    ASSERT_EQ(linked.size(), 2u);
    for (const LinkedFile& file : linked) files[file.key] = {file.name, ""};
    const auto pictures = operation.read({values, {}, files, reader, {linked[1].key}});
    ASSERT_EQ(pictures->frames(), 2);
    const PictureRequest picture = *pictures->picture(0, 0);
    EXPECT_EQ(picture.size, (Size{16, 8}));
    EXPECT_EQ(picture.channels, std::vector<std::string>{"Y"});
    EXPECT_FALSE(pictures->picture(0, 1));
    const Numbered source;
    const auto part = [&](const Box& box) {
        std::vector<float> pixels(static_cast<std::size_t>(box.width() * box.height()), -1.0f);
        EXPECT_TRUE(picture.solve()->draw({&source, nullptr}, box,
                                          packed_view(reinterpret_cast<std::byte*>(pixels.data()),
                                                      PixelType::float32, box.width(), box.height(), 1),
                                          serial_for));
        return pixels;
    };
    const std::vector<float> all = part({0, 0, 16, 8});
    const auto at = [&](int x, int y) { return all[static_cast<std::size_t>(16 * y + x)]; };
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x) {
            const auto red = static_cast<float>(x + 10 * y);
            EXPECT_EQ(at(8 + x, y), red);
            EXPECT_EQ(at(x, 4 + y), red + 100);
            EXPECT_EQ(at(8 + x, 4 + y), red + 200);
        }
    // Level 1: 4 x 2, means of 2 x 2 texels; level 2: 2 x 1, the last.
    EXPECT_EQ(at(4, 0), 5.5f);
    EXPECT_EQ(at(7, 1), 31.5f);
    EXPECT_EQ(at(0, 2), 105.5f);
    EXPECT_EQ(at(4 + 3, 2 + 1), 231.5f);
    EXPECT_EQ(at(2, 0), 16.5f);
    EXPECT_EQ(at(1, 1), 120.5f);
    EXPECT_EQ(at(3, 1), 220.5f);
    EXPECT_EQ(at(0, 0), 0);
    for (const Box& box : {Box{1, 1, 5, 4}, Box{6, 3, 16, 5}}) {
        const std::vector<float> some = part(box);
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x)
                EXPECT_EQ(some[static_cast<std::size_t>((y - box.y0) * box.width() + x - box.x0)], at(x, y));
    }
    EXPECT_EQ(pictures->picture(1, 0)->size, (Size{2, 2}));
    EXPECT_THAT(error_of({{"output", "mips"}}), HasSubstr("has no texture"));
}

TEST(FigureOperation, MapsOfMraselAreTextures) {
    // The maps of `map` beside the script, left half red, right half blue; `other` is a picture of the host's.
    Texts texts;
    texts.files["a/in.mrasel"] = "2 0 0\n90 90 90 1280 2560 0 0 0 0 map\n90 90 90 3840 2560 0 0 0 0 other\n";
    for (int side = 512; side >= 1; side /= 2) {
        std::string& map = texts.files["a/map." + std::to_string(side)];
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                map += 2 * x < side ? std::string("\xff\0\0", 3) : std::string("\0\0\xff", 3);
    }
    const Operation& operation = *find_operation("figure");
    const auto opened = [&](const std::vector<Assignment>& more) {
        ParameterValues values(*operation.parameters);
        values.assign({{"size", "64x64"},
                       {"mapping", "mirrored"},
                       {"filter", "bilinear"},
                       {"lighting", "lambert"},
                       {"ambient", "1"}});
        values.assign(more);
        SideFiles files = {{"script", {"a/in.mrasel", ""}}};
        const LinkedFiles linked = operation.linked(values, files, texts);
        EXPECT_EQ(linked.size(), 11u);
        for (const LinkedFile& file : linked) {
            files[file.key] = {file.name, "", file.image};
            EXPECT_EQ(file.image, file.name == "a/other") << file.name;
        }
        return operation.read({values, {}, files, texts, {"texture/other"}});
    };
    // The host's only source is white: the second body's.
    const std::vector<float> white(12, 1.0f);
    const MemorySource host(
        packed_view(reinterpret_cast<const std::byte*>(white.data()), PixelType::float32, 2, 2, 3));
    std::vector<float> pixels(std::size_t{64} * 64 * 4);
    const Box box = {0, 0, 64, 64};
    opened({{"style", "textured"}})
        ->picture(0, 0)
        ->solve()
        ->draw({&host}, box,
               packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, 64, 64, 4),
               serial_for);
    const auto at = [&](int x, int y) {
        const float* p = &pixels[static_cast<std::size_t>(4 * (64 * y + x))];
        return std::vector<float>(p, p + 4);
    };
    EXPECT_EQ(at(11, 32), (std::vector<float>{1, 0, 0, 1}));
    EXPECT_EQ(at(21, 32), (std::vector<float>{0, 0, 1, 1}));
    EXPECT_EQ(at(48, 32), (std::vector<float>{1, 1, 1, 1}));
    // As a pyramid, too: level 0 has 512 texels, and red at the upper right.
    const auto mips = opened({{"output", "mips"}});
    ASSERT_EQ(mips->frames(), 2);
    const PictureRequest first = *mips->picture(0, 0);
    EXPECT_EQ(first.size, (Size{1024, 1024}));
    const Box part = {512, 0, 1024, 1};
    std::vector<float> row(512);
    first.solve()->draw({nullptr}, part,
                        packed_view(reinterpret_cast<std::byte*>(row.data()), PixelType::float32, 512, 1, 1),
                        serial_for);
    EXPECT_EQ(row[255], 1);
    EXPECT_EQ(row[256], 0);
    // A map that has another size is named.
    texts.files["a/map.64"] += "x";
    try {
        opened({{"style", "textured"}});
        FAIL();
    } catch (const Error& e) {
        EXPECT_THAT(e.what(), HasSubstr("a/map.64: has 12289 bytes: must have 12288"));
    }
}

}  // namespace
}  // namespace anamorph::test_figure_operation
