// SPDX-License-Identifier: Apache-2.0
// Wrong names, recipes and values, and none that crashes or hangs: conformance items 20, 21, 23, 24, 32.
#include <filesystem>
#include <map>
#include <random>

#include "host.h"

namespace anamorph::test_conformance_bad_input {
namespace {

using namespace testing_oiio;
using OIIO::ImageInput;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

class BadInput : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("city.exr", 64, 32);
    }
};

/// One line that names the parameter, what was given and what is allowed.
void expect_refused(const std::string& arguments, const std::string& parameter,
                    const std::string& allowed = "must") {
    SCOPED_TRACE(arguments);
    const std::string error = open_error("city.exr.pano?" + arguments);
    EXPECT_THAT(error, AllOf(HasSubstr(parameter), HasSubstr(allowed), Not(HasSubstr("\n"))));
    EXPECT_LT(error.size(), 500u);
}

/// Opens and reads what opens; the values are such that either is right.
void open_and_read(const std::string& name) {
    auto input = ImageInput::open(name);
    if (!input) {
        EXPECT_NE(OIIO::geterror(), "") << name;
        return;
    }
    const OIIO::ImageSpec spec = input->spec();
    ASSERT_LE(spec.image_pixels(), 1u << 24) << name;
    std::vector<float> pixels(static_cast<std::size_t>(spec.image_pixels()) *
                              static_cast<std::size_t>(spec.nchannels));
    EXPECT_TRUE(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, pixels.data()))
        << name << ": " << input->geterror();
}

TEST_F(BadInput, MachinesOfOtherSchemes) {
    for (const char* scheme : {"", "scheme=exact&"})
        expect_refused(std::string("to=rectilinear&") + scheme + "machine=embm-2003", "machine=embm-2003",
                       "must be given with scheme=hardware only");
}

TEST_F(BadInput, ProjectionsThatAreText) {
    for (const char* key :
         {"ray_x=px", "ray_y=py", "ray_z=1", "point_x=lon", "point_y=lat", "let=k=1", "frame=1"})
        expect_refused(key, "is of to=formula");
    for (const char* key : {"fov=90", "d=1", "e=0.5", "lens=brown:k1=0.1", "scheme=direct", "scheme=hardware",
                            "machine=embm-2003"})
        expect_refused(std::string("to=formula&") + key, "to=formula");
    expect_refused("to=formula&ray_x=px*", "ray_x=px*", "column 4: expected a number");
    expect_refused("to=formula&point_y=lan", "point_y=lan",
                   "column 1: expected a name that is known, not lan");
    expect_refused("to=formula&point_x=px", "point_x=px", "expected a name that is known, not px");
    expect_refused("to=formula&ray_x=1&point_x=lon",
                   "ray_x, ray_y or ray_z and point_x or point_y are given");
    expect_refused("to=formula&k=1", "k=1", "there is no such parameter, and no formula uses the name");
    expect_refused("to=formula&frame=nan", "frame=nan");
    for (const char* blind : {"ray_z=0&ray_x=0&ray_y=0", "ray_x=log(-1)", "point_x=1&point_y=1"})
        expect_refused(std::string("to=formula&") + blind, "size is not given");
    expect_refused("to=formula&point_x=1&point_y=1&size=20", "squeezes the source to a line or a point");
    expect_refused("to=formula&point_x=if(lon+lat>0,lon,lon+1)&size=20", "point_x and point_y",
                   "must be continuous");
    open_and_read("city.exr.pano?to=formula&ray_x=px/0&size=20");
    open_and_read("city.exr.pano?to=formula&ray_x=exp(exp(99*px))&size=20");
    open_and_read("city.exr.pano?to=formula&ray_x=1e308*px&ray_y=1e308*py&ray_z=1e-308&size=20");
}

TEST_F(BadInput, NumbersOfProjectionsAndLensesOfADatabase) {
    for (const char* of : {"", "src"}) {
        const std::string d = std::string(of) + "d=", e = std::string(of) + "e=";
        for (const char* wrong : {"-1", "1001", "nan", "inf", "x", ""}) expect_refused(d + wrong, d + wrong);
        for (const char* wrong : {"-0.1", "1.1", "nan", "-inf", "2147483648"})
            expect_refused(e + wrong, e + wrong);
    }
    expect_refused("to=double_sphere&d=1.5", "d=1.5: must be from -0.999 to 1 for double_sphere");
    expect_refused("to=eucm&d=0", "d=0: must be from 0.001 to 1000 for eucm");
    expect_refused("from=unified&srcd=-0.5", "srcd=-0.5: must be from 0 to 1000 for unified");
    expect_refused("to=eucm&e=0&fov=180", "fov=180", "below 180 degrees for eucm");
    expect_refused("from=rectilinear&srclens=ocam:a0=-40", "ocam must be of a stereographic picture");
    expect_refused("from=stereographic&srclens=ocam:a2=1", "folds at a radius of 0 pixels");
    expect_refused("from=rectilinear&srclens=poly:k0=nan", "k0 must be a number");
    // Lenses of cylinders and panoramas.
    for (const char* from : {"equirectangular", "cylindrical"}) {
        const std::string of = std::string("from=") + from + "&srcfov=100&srclens=";
        for (const char* lens :
             {"brown:k1=0.1", "3de4:k1=0.1", "division:k1=0.1", "kb4:k1=0.1", "ocam:a0=-40"})
            expect_refused(of + lens, "srclens", std::string("must be ptlens or poly for ") + from);
        for (const char* lens :
             {"ptlens:a=nan", "ptlens:a=1e400", "ptlens:g=inf", "poly:k1=nan",
              "ptlens:b=", "poly:k1=0.1,k1=0.1", "ptlens:k1=0.1", "poly:a=0.1", "ptlens:a=-2147483648,b=1e9"})
            expect_refused(of + lens, "srclens=");
        for (const char* lens : {"ptlens:b=-0.02,d=2,e=-1,g=3,t=-2", "poly:k0=0.01,k1=-0.01"})
            open_and_read("city.exr.pano?size=20&" + of + lens);
        expect_refused(std::string("from=") + from + "&srcfov=360&srclens=ptlens:b=0.01", "srclens",
                       "360 degrees");
    }
    for (const char* wrong : {"lensfun:", "lensfun:lens=nothing like it,crop=1,focal=35", "lensfun:focal=nan",
                              "lensfun:crop=2147483648", "lensfun:lens=a,lens=b", "lensfun:=", "lensfun"})
        expect_refused(std::string("from=rectilinear&srclens=") + wrong, "srclens=lensfun", "");
    expect_refused("to=rectilinear&lens=lensfun:lens=x,crop=1,focal=35", "width and height");
}

// Every key of every operation, given what is no value of most: a picture, or one line that names the key.
TEST_F(BadInput, EveryKeyIsNamedByItsError) {
    write_text("lines.csv", "10,10,40,20,12,14,41,18\n");
    write_text("few.json", R"({"columns": 1, "rows": 1, "vertices": [[0, 0], [60, 3], [0, 30], [64, 32]]})");
    write_text("one.n", "figure one 1 a\nellipsoid a 1 1 1\nstop\n");
    const std::map<std::string, std::string> others{
        {"pano", "size=9&src=city.exr"},   {"lens", "lens=3de4:k1=0.01&src=city.exr"},
        {"map", "size=9&src=city.exr"},    {"warp", "mesh=few.json&src=city.exr"},
        {"mosaic", "size=9&src=city.exr"}, {"morph", "features=lines.csv&b=city.exr&a=city.exr"},
        {"drape", "size=9&src=city.exr"},  {"figure", "size=9&script=one.n"}};
    const char* const wild[] = {
        "nan",     "-inf",  "-1",   "2147483648", "-2147483649", "4294967297",
        "1e400",   "",      "x",    " ",          "5%%",         "nan%",
        "1e9%",    "5x5x5", "-5x3", "9x",         "[1",          "2147483648x2147483648",
        "a:b=c,d", "\x01"};
    int refused = 0;
    for (const Operation* operation : operations()) {
        const auto found = others.find(operation->name);
        if (found == others.end()) continue;
        const std::string rest = "&" + found->second + "&";
        for (const Parameter& parameter : *operation->parameters)
            for (const char* value : wild) {
                // Files are opened, and a key that is given twice is another error.
                if (rest.find("&" + parameter.name + "=") != std::string::npos) continue;
                const std::string name =
                    "v." + operation->name + "?" + parameter.name + "=" + value + "&" + found->second;
                if (OIIO::ImageInput::open(name)) continue;
                const std::string error = OIIO::geterror();
                ++refused;
                // A source is called by its own name.
                EXPECT_THAT(error, AllOf(AnyOf(HasSubstr(parameter.name),
                                               HasSubstr(std::string("source \"") + value + "\"")),
                                         Not(HasSubstr("\n"))))
                    << name;
                EXPECT_LE(error.size(), 400u) << name << "\n" << error;
            }
    }
    EXPECT_GT(refused, 3000);
}

TEST_F(BadInput, conformance_20_sizes) {
    for (const char* size :
         {"0", "-1", "0x5", "5x0", "5x-5", "99999999999", "1048577", "1e3", "5x", "x", "4294967297x1"})
        expect_refused(std::string("size=") + size, "size=");
    // More than limits:imagesize_MB, which is 32 GB unless set.
    for (const char* size : {"1048576", "1048576x1048576", "100000x100000"})
        expect_refused(std::string("size=") + size, "limits:imagesize_MB");
    for (const char* tile : {"-1", "99999", "64x", "1x1x1"})
        expect_refused(std::string("tile=") + tile, "tile=");
    int limit = 0;
    ASSERT_TRUE(OIIO::getattribute("limits:imagesize_MB", limit));
    OIIO::attribute("limits:imagesize_MB", 1);
    expect_refused("size=1024", "must make at most 1 MB");
    open_and_read("city.exr.pano?size=100");
    OIIO::attribute("limits:imagesize_MB", limit);
    expect_refused("size=16x16&to=cubemap", "size=16x16", "needs square faces, 1 across and 6 down");
}

TEST_F(BadInput, conformance_21_values) {
    for (const char* key : {"yaw", "pitch", "roll", "fov", "srcfov", "tol"})
        for (const char* value :
             {"nan", "-nan", "inf", "-inf", "1e999", "", "abc", "1,5", "1 2", "0x1p3", "--1", "1e"})
            expect_refused(std::string(key) + "=" + value, key);
    for (const char* key : {"from", "to", "filter", "wrap", "pixels", "scheme", "output"})
        for (const char* value : {"", "none", "BILINEAR ", "1"})
            expect_refused(std::string(key) + "=" + value, key);
    expect_refused("fov=0", "fov=0");
    expect_refused("fov=-10", "fov=-10");
    expect_refused("fov=180", "fov=180");
    expect_refused("to=fisheye&fov=361", "fov=361");
    expect_refused("to=cubemap&fov=80", "fov=80", "always has 90 degrees");
    expect_refused("tol=-0.1", "tol=-0.1");
    expect_refused("mip=2", "mip=2");
    expect_refused("yaw=1&yaw=2", "yaw=2: given twice");
    expect_refused("size=8&SIZE=8", "size=8: given twice");
    expect_refused("jaw=1", "there is no such parameter");
    expect_refused("colorspace=nonsense", "colorspace=nonsense");
    expect_refused("=3", "argument \"=3\"");
    // These OpenImageIO refuses itself.
    for (const char* arguments : {"flag", "yaw=1&&fov=3", "yaw=1&"})
        open_error(std::string("city.exr.pano?") + arguments);
    expect_refused("yaw=" + std::string(200000, '9'), "yaw=999");
    expect_refused(std::string(200000, 'k') + "=1", "there is no such parameter");
}

TEST_F(BadInput, conformance_21_extreme_values) {
    for (const char* arguments :
         {"yaw=1e308", "yaw=-1e308&pitch=1e307", "fov=1e-300", "fov=1e-9", "fov=179.999999", "srcfov=1e-300",
          "srcfov=1e-9&from=rectilinear", "tol=1e300", "tol=1e-300", "to=stereographic&fov=359.999999",
          "to=mercator&fov=1e-12", "to=cylindrical&size=64x4096", "to=equirectangular&size=1x1",
          "to=equirectangular&size=4096x1", "pixels=centers", "from=fisheye&srcfov=360&fov=170",
          "filter=nearest&tol=1e9"})
        open_and_read(std::string("city.exr.pano?") + arguments +
                      (std::string(arguments).find("size") == std::string::npos ? "&size=48x32" : ""));
    // The smallest sources.
    write_panorama("one.exr", 1, 1, OIIO::TypeFloat, 1, 0);
    write_panorama("two.exr", 2, 1, OIIO::TypeFloat, 1, 0);
    for (const char* from : {"equirectangular", "rectilinear", "fisheye", "mercator"})
        for (const char* filter : {"nearest", "bilinear", "bicubic", "sharp_bicubic", "antialias"})
            for (const char* name : {"one.exr", "two.exr"})
                open_and_read(std::string(name) + ".pano?size=33x17&pixels=edges&from=" + from +
                              "&filter=" + filter);
    open_and_read("two.exr.pano?size=33x17&pixels=centers");
}

TEST_F(BadInput, conformance_21_nan_and_infinity_in_pixels_stay_local) {
    OIIO::ImageBuf image = panorama(256, 128);
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         0.5f};
    image.setpixel(128, 64, bad);
    write_image(image, "bad.exr");
    for (const char* filter : {"nearest", "bilinear", "bicubic", "sharp_bicubic", "antialias"}) {
        SCOPED_TRACE(filter);
        const std::vector<float> view =
            read_floats(std::string("bad.exr.pano?size=256x256&filter=") + filter);
        int touched = 0;
        for (std::size_t i = 0; i < view.size(); i += 3)
            touched += !std::isfinite(view[i]) || !std::isfinite(view[i + 1]);
        // A source pixel is about 3 view pixels wide; the widest footprint is 4 source pixels.
        EXPECT_GT(touched, 0);
        EXPECT_LE(touched, 16 * 16 * 4);
    }
}

TEST_F(BadInput, conformance_23_recipe_files) {
    const auto expect_error = [](const std::string& text, const std::string& part) {
        write_text("r.pano", text);
        const std::string error = open_error("r.pano");
        EXPECT_THAT(error, AllOf(HasSubstr("r.pano"), HasSubstr(part), Not(HasSubstr("\n"))));
    };
    const std::vector<float> expected = read_floats("city.exr.pano?size=20&yaw=3");
    write_text("city.exr.pano", "");
    EXPECT_EQ(read_floats("city.exr.pano?size=20&yaw=3"), expected);
    std::filesystem::remove("city.exr.pano");
    write_text("r.pano", "src=city.exr\r\nsize=20\r\n\r\n# yaw=5\r\nyaw=3\r\n");
    EXPECT_EQ(read_floats("r.pano"), expected);
    write_text("r.pano", "\xEF\xBB\xBFsrc=city.exr\nsize=20\nyaw=3");
    EXPECT_EQ(read_floats("r.pano"), expected);
    expect_error("src=city.exr\nyaw=3\nyaw=4\n", "yaw=4: given twice");
    expect_error("src=city.exr\nyaw three\n", "line 2 is \"yaw three\"");
    expect_error(std::string("src=city.exr\nyaw=\0 3\n", 21), "line 2 holds a control character");
    expect_error("\x89PNG\r\n\x1a\n", "line");
    expect_error("src=city.exr\nfov=1e999\n", "fov=1e999: must be a number above 0, at most 360");

    write_text("huge.pano", "src=city.exr\n");
    std::filesystem::resize_file("huge.pano", 100 << 20);
    EXPECT_THAT(open_error("huge.pano"), HasSubstr("104857600 bytes: must have at most 1048576"));
    std::filesystem::create_directory("folder.pano");
    EXPECT_THAT(open_error("folder.pano"), HasSubstr("is not a file"));

    const std::string whole =
        "\xEF\xBB\xBF# view\r\nsrc=city.exr\r\nsize=20x10\nto=rectilinear\nyaw=3.25e0\nmip=1\n";
    for (std::size_t n = 0; n <= whole.size(); ++n) {
        SCOPED_TRACE(n);
        write_text("cut.pano", whole.substr(0, n));
        auto input = ImageInput::open("cut.pano");
        if (!input) {
            EXPECT_THAT(OIIO::geterror(), Not(testing::IsEmpty()));
        }
    }
}

TEST_F(BadInput, conformance_24_foreign_names_are_left_alone) {
    write_text("junk.foo", "this is no image");
    write_text("junk.pano.foo", "src=city.exr");
    for (const char* name : {"junk.foo", "missing.foo", "junk.pano.foo", "junk.foo?src=a.pano"}) {
        SCOPED_TRACE(name);
        const Ran ran = run(std::string("iinfo '") + name + "'");
        EXPECT_EQ(ran.status, 1) << ran.text;
        EXPECT_THAT(ran.text, Not(HasSubstr("anamorph")));
    }
    const auto input = ImageInput::create("anamorph_recipes");
    OIIO::ImageSpec spec;
    EXPECT_FALSE(input->open("city.exr", spec));
    EXPECT_THAT(input->geterror(), HasSubstr("not a .pano"));
}

TEST_F(BadInput, conformance_32_random_names_and_recipes) {
    const unsigned seed = 90210;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto pick = [&](const auto& list) { return std::string(list[random() % std::size(list)]); };
    const char* const keys[] = {"src",    "from",       "to",     "fov",  "srcfov", "yaw",    "size",
                                "tile",   "mip",        "filter", "wrap", "tol",    "pixels", "scheme",
                                "output", "colorspace", "RES",    "x",    ""};
    const char* const values[] = {"city.exr", "a.pano?yaw=1", "b.pano",  "cubemap", "latlong", "90",
                                  "1e-5",     "-3",           "8x4",     "64",      "0",       "1",
                                  "nearest",  "mirror",       "centers", "exact",   "stmap",   "linear",
                                  "\xff",     "%20",          "",        "?",       "="};
    int opened = 0;
    for (int i = 0; i < 3000; ++i) {
        std::string text;
        const char separator = i % 2 ? '&' : '\n';
        for (unsigned n = random() % 5; n > 0; --n) text += pick(keys) + "=" + pick(values) + separator;
        if (!text.empty()) text.pop_back();
        if (random() % 4 == 0 && !text.empty())
            text[random() % text.size()] = static_cast<char>(random() % 256);
        if (i % 2 == 0) write_text("r.pano", text);
        const std::string name = i % 2 ? "city.exr.pano?" + text : "r.pano";
        auto input = ImageInput::open(name);
        opened += input ? 1 : 0;
        if (!input) {
            ASSERT_NE(OIIO::geterror(), "") << name;
        }
    }
    EXPECT_GT(opened, 50);
}

}  // namespace
}  // namespace anamorph::test_conformance_bad_input
