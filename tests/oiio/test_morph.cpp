// SPDX-License-Identifier: Apache-2.0
// Feature morphs: recipes and the function, that they agree, films, key shapes, and what is refused.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>

#include <cmath>
#include <filesystem>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_morph {
namespace {

using namespace testing_oiio;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ParamValueList;
using OIIO::TypeDesc;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

const std::string kLines =
    "ax0,ay0,ax1,ay1,bx0,by0,bx1,by1\n30,20,90,30,40,24,85,40\n20,70,60,80,25,60,62,84\n75,55,80,75,78,50,70,"
    "80\n";

class Morph : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_picture("a.exr", 0);
        write_picture("b.exr", 1);
        write_text("lines.csv", kLines);
    }

    /// Pictures that differ: a panorama, or that with its channels turned.
    static void write_picture(const std::string& name, int turn, int width = 120, int height = 96,
                              TypeDesc type = OIIO::TypeFloat, int channels = 3) {
        ImageBuf image = panorama(width, height, type, channels);
        if (turn > 0) image = OIIO::ImageBufAlgo::flop(image);
        if (turn > 1) image = OIIO::ImageBufAlgo::flip(image);
        write_image(image, name);
    }
};

ImageBuf read(const std::string& name, int subimage = 0) {
    ImageBuf image(name, subimage, 0);
    EXPECT_TRUE(image.read(subimage, 0, true)) << image.geterror();
    return image;
}

const std::string kMorph = "a.exr.morph?b=b.exr&features=lines.csv";

TEST_F(Morph, TheRecipeIsTheCall) {
    for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::UINT16, TypeDesc::HALF, TypeDesc::FLOAT})
        for (const int channels : {1, 3, 4}) {
            SCOPED_TRACE(std::string(type.c_str()) + " " + std::to_string(channels));
            const bool integer = type == TypeDesc::UINT8 || type == TypeDesc::UINT16;
            const std::string a = integer ? "s.tif" : "s.exr", b = integer ? "t.tif" : "t.exr";
            write_picture(a, 0, 120, 96, type, channels);
            write_picture(b, 1, 100, 110, type, channels);
            const ImageBuf image_a = read(a), image_b = read(b);
            ASSERT_EQ(image_a.spec().format, type);
            const ImageBuf call = morph(image_a, image_b, options({{"features", "lines.csv"}, {"t", "0.3"}}));
            const Pixels recipe = read_pixels("x.morph?a=" + a + "&b=" + b + "&features=lines.csv&t=0.3");
            EXPECT_EQ(bytes(call), recipe.bytes);
            EXPECT_EQ(recipe.spec.width, 120);
            EXPECT_EQ(recipe.spec.format, type);
            EXPECT_NE(recipe.bytes, read_pixels(a).bytes);
            EXPECT_LE(recipe.spec.get_float_attribute("anamorph:max_error", 9), 0.01f);
            EXPECT_FLOAT_EQ(recipe.spec.get_float_attribute("anamorph:t", -1), 0.3f);
        }
}

TEST_F(Morph, TheEndsAreThePictures) {
    for (const char* type : {"uint8", "uint16", "half", "float"}) {
        SCOPED_TRACE(type);
        const std::string end = std::string(type)[0] == 'u' ? ".tif" : ".exr";
        const Ran ran = run("oiiotool a.exr -d " + std::string(type) + " -o A" + end + " b.exr -d " + type +
                            " -o B" + end);
        ASSERT_EQ(ran.status, 0) << ran.text;
        const std::string name = "'x.morph?a=A" + end + "&b=B" + end + "&features=lines.csv&tol=0&t=";
        const Ran same =
            run("oiiotool " + name + "0' -o 0" + end + " " + name + "1' -o 1" + end + " && idiff -fail 0 " +
                "-warn 0 0" + end + " A" + end + " && idiff -fail 0 -warn 0 1" + end + " B" + end);
        EXPECT_EQ(same.status, 0) << same.text;
    }
    // Of another size: B is seen whole where the picture has its size.
    write_picture("wide.exr", 2, 200, 80);
    const std::string name = "a.exr.morph?b=wide.exr&features=lines.csv&tol=0";
    EXPECT_EQ(read_pixels(name + "&t=0").bytes, read_pixels("a.exr").bytes);
    EXPECT_EQ(read_pixels(name + "&t=1&size=200x80").bytes, read_pixels("wide.exr").bytes);
    // The colour of one, the shape of the other.
    EXPECT_EQ(read_pixels(kMorph + "&t=0.5&t_color=0"), read_pixels(kMorph + "&t=0.5&picture=a"));
    EXPECT_EQ(read_pixels(kMorph + "&t=0.5&t_color=1"), read_pixels(kMorph + "&t=0.5&picture=b"));
}

TEST_F(Morph, ToleranceIsSaidAndHeld) {
    const auto said = [](const std::string& name) {
        const ImageSpec spec = read_pixels(name).spec;
        return std::pair(spec.find_attribute("anamorph:tol") != nullptr,
                         spec.get_float_attribute("anamorph:max_error", -1));
    };
    for (const char* scheme : {"&scheme=auto", "&scheme=exact"}) {
        EXPECT_TRUE(said(kMorph + scheme).first) << scheme;
        EXPECT_LE(said(kMorph + scheme).second, 0.01f) << scheme;
    }
}

TEST_F(Morph, TilesThreadsAndCropsNeverChangePixels) {
    for (const char* arguments : {"&t=0.4&size=300x200", "&t=0.7&weight_b=1&weight_a=0.01", "&tol=0&t=0.5",
                                  "&output=lines", "&output=stmap&picture=b&pin_border=1"})
        expect_one_picture(kMorph + arguments, 20, 25);
}

TEST_F(Morph, EachOutputIsWhatItsNameSays) {
    for (const char* output : {"color", "lines", "color&picture=a", "color&picture=b"})
        EXPECT_EQ(read_pixels(kMorph + "&output=" + output).spec.nchannels, 3) << output;
    EXPECT_NE(read_pixels(kMorph + "&output=lines").bytes, read_pixels(kMorph).bytes);
    for (const char* output : {"stmap&picture=a", "stmap&picture=b"})
        EXPECT_EQ(read_pixels(kMorph + "&output=" + output).spec.nchannels, 2) << output;
    EXPECT_EQ(read_pixels(kMorph + "&output=stmap"), read_pixels(kMorph + "&output=stmap&picture=a"));
    EXPECT_THAT(open_error(kMorph + "&picture=c"), HasSubstr("picture=c: must be one of"));
    // Drawn along its map, a picture is what it is by itself.
    for (const std::string which : {"a", "b"}) {
        const Ran map = run("oiiotool '" + kMorph + "&tol=0&output=stmap&picture=" + which + "' -o st.exr");
        ASSERT_EQ(map.status, 0) << map.text;
        const std::vector<float> along =
                                     read_floats(which + ".exr.warp?mesh=st.exr&filter=bilinear&wrap=clamp"),
                                 warped = read_floats(kMorph + "&tol=0&filter=bilinear&picture=" + which);
        ASSERT_EQ(along.size(), warped.size());
        // Float fractions of 120 pixels; the picture changes by less than 0.4 a pixel.
        EXPECT_LT(largest_difference(along, warped), 1e-3) << which;
    }
    for (const char* tol : {"1", "0.0625", "0.015625"}) {
        const std::string name = kMorph + "&tol=" + tol + "&output=";
        const std::vector<float> error = read_floats(name + "error"), bound = read_floats(name + "bound");
        for (std::size_t i = 0; i < error.size(); ++i) ASSERT_LE(error[i], bound[i] + 1e-6f) << i;
        EXPECT_LE(*std::max_element(bound.begin(), bound.end()), std::stof(tol));
    }
}

TEST_F(Morph, EveryKindOfFeaturesFile) {
    write_text("one.csv", "30,20,90,30,40,24,85,40\n20,70,60,80,25,60,62,84\n");
    write_text("one.json", R"({"features": [{"line": [[30, 20, 90, 30], [40, 24, 85, 40]]},
        {"line": [[20, 70, 60, 80], [25, 60, 62, 84]], "name": "chin"}]})");
    write_text("one.svg", R"(<?xml version="1.0"?>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="120" height="96" viewBox="0 0 120 96">
  <g inkscape:groupmode="layer" inkscape:label="A"><line id="brow" x1="30" y1="20" x2="90" y2="30"/><path id="chin" d="M 20,70 60,80"/></g>
  <g inkscape:groupmode="layer" inkscape:label="B"><line id="brow-b" x1="40" y1="24" x2="85" y2="40"/><path id="chin-7" d="M 25,60 62,84"/></g>
</svg>)");
    const Pixels expected = read_pixels("a.exr.morph?b=b.exr&features=one.csv");
    EXPECT_EQ(read_pixels("a.exr.morph?b=b.exr&features=one.json").bytes, expected.bytes);
    EXPECT_EQ(read_pixels("a.exr.morph?b=b.exr&features=one.svg").bytes, expected.bytes);
    // The border held, by the recipe and by the file.
    write_text("held.json", R"({"pin_border": 2, "features": [{"line": [[30, 20, 90, 30], [40, 24, 85, 40]]},
        {"line": [[20, 70, 60, 80], [25, 60, 62, 84]]}]})");
    const Pixels held = read_pixels("a.exr.morph?b=b.exr&features=held.json");
    EXPECT_NE(held.bytes, expected.bytes);
    EXPECT_EQ(read_pixels("a.exr.morph?b=b.exr&features=one.csv&pin_border=2").bytes, held.bytes);
    EXPECT_EQ(read_pixels("a.exr.morph?b=b.exr&features=held.json&pin_border=0").bytes, expected.bytes);
    // Edited, with as many bytes.
    write_text("one.csv", "30,20,90,30,40,24,85,40\n20,70,60,80,35,60,72,84\n");
    EXPECT_NE(read_pixels("a.exr.morph?b=b.exr&features=one.csv").bytes, expected.bytes);
}

TEST_F(Morph, AFilmIsItsFrames) {
    const std::string film = kMorph + "&frames=5&mip=1";
    auto input = OIIO::ImageInput::open(film);
    ASSERT_TRUE(input) << OIIO::geterror();
    for (const int frame : {3, 0, 4, 2, 1}) {
        ASSERT_TRUE(input->seek_subimage(frame, 0)) << frame;
        EXPECT_EQ(input->current_subimage(), frame);
        EXPECT_EQ(input->spec().get_float_attribute("anamorph:t", -1), static_cast<float>(frame) / 4);
        const std::string name = kMorph + "&mip=1&t=" + std::to_string(frame / 4.0);
        EXPECT_EQ(bytes(read(film, frame)), read_pixels(name).bytes);
        // Its levels too.
        std::vector<float> pixels(60 * 48 * 3);
        ASSERT_TRUE(input->read_image(frame, 1, 0, 3, OIIO::TypeFloat, pixels.data())) << input->geterror();
        EXPECT_EQ(pixels, read_floats(name, 1));
    }
    EXPECT_FALSE(input->seek_subimage(5, 0));
    EXPECT_FALSE(input->seek_subimage(0, 20));
    // A film of one colour.
    EXPECT_EQ(bytes(read(kMorph + "&frames=3&t_color=1", 1)), read_pixels(kMorph + "&t=0.5&t_color=1").bytes);
    // As a user splits it, and frame by frame.
    const Ran split = run("oiiotool '" + kMorph + "&frames=3' --sisplit -o:all=1 'f.%04d.exr'");
    EXPECT_EQ(split.status, 0) << split.text;
    const Ran named = run("oiiotool --frames 1-3 '" + kMorph + "&t={(FRAME_NUMBER-1)/2.0}' -o 'g.#.exr'");
    EXPECT_EQ(named.status, 0) << named.text;
    for (const std::string number : {"1", "2", "3"}) {
        const std::string f = "f.000" + number + ".exr", g = "g.000" + number + ".exr";
        EXPECT_EQ(read_pixels(f).bytes, read_pixels(g).bytes) << number;
    }
    const Ran info = run("iinfo -a '" + kMorph + "&frames=5'");
    EXPECT_THAT(info.text, HasSubstr("5 subimages"));
    // As many frames as there may be are opened at once and seen one by one.
    const std::string long_film = kMorph + "&frames=9999";
    auto many = OIIO::ImageInput::open(long_film);
    ASSERT_TRUE(many) << OIIO::geterror();
    for (int i = 0; i < 9999; ++i) ASSERT_TRUE(many->seek_subimage(i, 0));
    EXPECT_FALSE(many->seek_subimage(9999, 0));
    std::vector<float> last(120 * 96 * 3);
    ASSERT_TRUE(many->read_image(9998, 0, 0, 3, OIIO::TypeFloat, last.data())) << many->geterror();
    EXPECT_EQ(last, read_floats(kMorph + "&t=1"));
}

TEST_F(Morph, SeveralKeyShapes) {
    write_picture("c.exr", 2);
    write_text("three.json", R"({"features": [
        {"line": [[30, 20, 90, 30], [40, 24, 85, 40], [35, 22, 80, 50]]},
        {"line": [[20, 70, 60, 80], [25, 60, 62, 84], [30, 66, 50, 88]]}]})");
    const std::string name = "a.exr.morph?b=b.exr&c=c.exr&features=three.json&tol=0&shape_weights=";
    EXPECT_EQ(read_pixels(name + "1,0,0").bytes, read_pixels("a.exr").bytes);
    EXPECT_EQ(read_pixels(name + "0,1,0").bytes, read_pixels("b.exr").bytes);
    EXPECT_EQ(read_pixels(name + "0,0,1").bytes, read_pixels("c.exr").bytes);
    const ImageBuf a = read("a.exr"), b = read("b.exr"), c = read("c.exr");
    const std::vector<const ImageBuf*> pictures = {&a, &b, &c};
    ParamValueList o = options({{"features", "three.json"}, {"tol", "0"}, {"color_weights", "0, 0.5, 0.5"}});
    const float weights[] = {0.5f, 0.25f, 0.25f};
    o.attribute("shape_weights", TypeDesc(TypeDesc::FLOAT, 3), weights);
    const ImageBuf call = morph(pictures, o);
    EXPECT_EQ(bytes(call), read_pixels(name + "0.5,0.25,0.25&color_weights=0,0.5,0.5").bytes);
    ImageBuf dst;
    EXPECT_TRUE(morph(dst, pictures, o)) << dst.geterror();
    EXPECT_EQ(bytes(dst), bytes(call));
    const std::pair<const char*, const char*> failing[] = {
        {"1,0", "shape_weights"},
        {"0.5,0.5,0.5", "shape_weights"},
        {"1,0,0&t=0.5", "t=0.5: must not be given together with shape_weights"},
        {"1,0,x", "shape_weights=1,0,x: must be numbers from -1e+06 to 1e+06, separated by commas"},
        {"1,0,0&d=none.exr", "none.exr"},
        {"1,0,0&e=c.exr", "must be given together with d"},
    };
    for (const auto& [arguments, reason] : failing)
        EXPECT_THAT(open_error(name + arguments), HasSubstr(reason)) << arguments;
    EXPECT_THAT(open_error("a.exr.morph?b=b.exr&c=c.exr&features=three.json"),
                HasSubstr("shape_weights is not given"));
    EXPECT_THAT(open_error("a.exr.morph?b=b.exr&features=three.json"),
                HasSubstr("three.json: the file has 3 shapes: must have 2"));
}

TEST_F(Morph, ColoursOfOneSpaceAreBlended) {
    ImageBuf a = panorama(120, 96), b = OIIO::ImageBufAlgo::flop(a);
    a.specmod().attribute("oiio:ColorSpace", "sRGB");
    write_image(a, "a.tif");
    b.specmod().attribute("oiio:ColorSpace", "linear");
    EXPECT_THAT(morph(read("a.tif"), b, options({{"features", "lines.csv"}})).geterror(),
                HasSubstr("must be the same, or colorspace be given"));
    // In one space, and back to that of a.
    const ImageBuf made =
        morph(a, b, options({{"features", "lines.csv"}, {"colorspace", "scene_linear"}, {"t", "0.25"}}));
    ASSERT_FALSE(made.has_error()) << made.geterror();
    EXPECT_EQ(made.spec().get_string_attribute("oiio:ColorSpace"), "sRGB");
    const ImageBuf linear = OIIO::ImageBufAlgo::colorconvert(a, "sRGB", "linear");
    const ImageBuf expected = OIIO::ImageBufAlgo::colorconvert(
        morph(linear, b, options({{"features", "lines.csv"}, {"t", "0.25"}})), "linear", "sRGB");
    const auto same = OIIO::ImageBufAlgo::compare(made, expected, 1e-4f, 1e-4f);
    EXPECT_EQ(same.nfail, 0u) << same.maxerror;
}

TEST_F(Morph, WhatFailsSaysWhyInALine) {
    write_text("point.csv", "30,20,90,30,40,24,85,40\n10,10,10,10,20,20,30,30\n");
    write_text("cut.json", R"({"features": [{"line": [[30, 20, 90)");
    write_text("counts.csv", "30,20,90,30,40,24,85\n");
    write_text("words.csv", "30,20,90,30,40,24,85,forty\n");
    write_text("none.svg", "<svg></svg>");
    write_text("huge.csv", "");
    fs::resize_file("huge.csv", 100 << 20);
    fs::create_directory("folder.csv");
    write_picture("grey.exr", 0, 120, 96, OIIO::TypeFloat, 1);
    write_text("self.morph", "a=a.exr\nb=self.morph\nfeatures=lines.csv\n");
    const std::pair<std::string, std::string> failing[] = {
        {"a.exr.morph?features=lines.csv", "b is not given"},
        {"a.exr.morph?b=b.exr", "features is not given"},
        {"x.morph?b=b.exr&features=lines.csv", "source \"x\""},
        {"a.exr.morph?b=none.exr&features=lines.csv", "none.exr"},
        {"a.exr.morph?b=b.exr&features=none.csv", "none.csv\" does not exist"},
        {"a.exr.morph?b=b.exr&features=point.csv", "point.csv"},
        {"a.exr.morph?b=b.exr&features=cut.json", "cut.json"},
        {"a.exr.morph?b=b.exr&features=counts.csv", "counts.csv"},
        {"a.exr.morph?b=b.exr&features=words.csv", "words.csv"},
        {"a.exr.morph?b=b.exr&features=none.svg", "none.svg"},
        {"a.exr.morph?b=b.exr&features=huge.csv", "104857600 bytes"},
        {"a.exr.morph?b=b.exr&features=folder.csv", "is not a file"},
        {"a.exr.morph?b=grey.exr&features=lines.csv", "has 1 channels and a has 3"},
        {kMorph + "&t=nan", "t=nan"},
        {kMorph + "&t=0.5&frames=3", "t=0.5: must not be given together with frames"},
        {kMorph + "&frames=10000", "frames=10000"},
        {kMorph + "&frames=-1", "frames=-1"},
        {kMorph + "&weight_a=-1", "weight_a=-1"},
        {kMorph + "&shape_weights=1,1", "shape_weights"},
        {kMorph + "&scheme=hermite", "scheme=hermite"},
        {kMorph + "&machine=new", "machine=new: must be kim-2003"},
        {kMorph + "&scheme=hardware&machine=kim-2003:cells=0", "cells=0: must be an integer from 1 to 128"},
        {kMorph + "&scheme=hardware&output=lines", "output=lines: must be another"},
        {kMorph + "&scheme=hardware&t_color=2", "by an alpha from 0 to 1"},
        {kMorph + "&size=1048576x1048576", "limits:imagesize_MB"},
        {kMorph + "&yaw=3", "yaw=3: there is no such parameter"},
        {"self.morph", "read each other: self.morph -> self.morph"},
    };
    for (const auto& [name, reason] : failing) {
        SCOPED_TRACE(name);
        const std::string error = open_error(name);
        EXPECT_THAT(error, AllOf(HasSubstr(reason), Not(HasSubstr("\n"))));
        EXPECT_LT(error.size(), 600u);
    }
    // A picture that is damaged where only its pixels are; it is not read where it has no part.
    write_picture("cut.exr", 1);
    fs::resize_file("cut.exr", fs::file_size("cut.exr") * 3 / 4);
    const Ran cut = run("oiiotool 'a.exr.morph?b=cut.exr&features=lines.csv' -o out.exr");
    EXPECT_EQ(cut.status, 1) << cut.text;
    EXPECT_THAT(cut.text, HasSubstr("cut.exr"));
    EXPECT_EQ(read_pixels("a.exr.morph?b=cut.exr&features=lines.csv&t=0&tol=0").bytes,
              read_pixels("a.exr").bytes);
    // The call says the same.
    const ImageBuf a = panorama(120, 96);
    ImageBuf dst;
    EXPECT_FALSE(morph(dst, a, a, options({{"features", "none.csv"}})));
    EXPECT_THAT(dst.geterror(), AllOf(HasSubstr("morph: "), HasSubstr("none.csv"), Not(HasSubstr("\n"))));
    EXPECT_FALSE(morph(dst, {&a}, options({{"features", "lines.csv"}})));
    EXPECT_THAT(dst.geterror(), HasSubstr("1 source images: must be 2 to 8"));
    EXPECT_FALSE(morph(dst, {&a, nullptr}, options({{"features", "lines.csv"}})));
    EXPECT_THAT(dst.geterror(), HasSubstr("null"));
    EXPECT_FALSE(morph(dst, a, a, options({{"features", "lines.csv"}, {"frames", "3"}})));
    EXPECT_THAT(dst.geterror(), HasSubstr("frames=3: must be given in recipes only"));
    // In place.
    ImageBuf itself = panorama(120, 96);
    const ImageBuf b = OIIO::ImageBufAlgo::flop(itself);
    const ImageBuf expected = morph(itself, b, options({{"features", "lines.csv"}}));
    EXPECT_TRUE(morph(itself, itself, b, options({{"features", "lines.csv"}}))) << itself.geterror();
    EXPECT_EQ(bytes(itself), bytes(expected));
}

// Which layer is which picture's its link says, or else the order; the picture says what was taken.
TEST_F(Morph, LayersBelongToThePicturesThatTheyLinkTo) {
    const auto layer = [](const std::string& label, const std::string& link, const std::string& path) {
        return "<g inkscape:groupmode=\"layer\" inkscape:label=\"" + label +
               "\"><image width=\"120\" height=\"96\" xlink:href=\"" + link + "\"/><path id=\"p_" + label +
               "\" d=\"" + path + "\"/></g>";
    };
    const std::string head = "<svg xmlns:inkscape=\"i\" xmlns:xlink=\"x\">";
    const std::string of_a = layer("one", "shots/a.exr", "M 30 20 90 30"),
                      of_b = layer("two", "b.exr", "M 40 24 85 40");
    write_text("straight.svg", head + of_a + of_b + "</svg>");
    write_text("turned.svg", head + of_b + of_a + "</svg>");
    write_text("renamed.svg", head + layer("two", "x.exr", "M 40 24 85 40") +
                                  layer("one", "y.exr", "M 30 20 90 30") + "</svg>");
    const auto drawn = [](const std::string& file) {
        return read_floats("a.exr.morph?b=b.exr&features=" + file);
    };
    const auto said = [](const std::string& file) {
        return std::string(
            open("a.exr.morph?b=b.exr&features=" + file)->spec().get_string_attribute("anamorph:shapes"));
    };
    EXPECT_EQ(drawn("turned.svg"), drawn("straight.svg"));
    EXPECT_GT(largest_difference(drawn("renamed.svg"), drawn("straight.svg")), 0.01);
    EXPECT_EQ(said("straight.svg"), "a is layer one, b is layer two");
    EXPECT_EQ(said("turned.svg"), "a is layer one, b is layer two");
    EXPECT_EQ(said("renamed.svg"), "a is layer two, b is layer one");
    EXPECT_EQ(said("lines.csv"), "");
}

}  // namespace
}  // namespace anamorph::test_morph
