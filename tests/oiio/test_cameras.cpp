// SPDX-License-Identifier: Apache-2.0
// Panoramas as cameras and stitchers write them: parts of a whole, turned and tilted, with pixels that are not square; and views
// by focal length or by their height.
#include <OpenImageIO/imagebufalgo.h>

#include <cmath>
#include <numbers>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_cameras {
namespace {

using namespace testing_oiio;
using OIIO::ImageBuf;
using testing::HasSubstr;

constexpr int kWide = 320, kHigh = 160;

std::string says(const std::string& name, const char* attribute) {
    const auto input = open(name);
    return input ? std::string(input->spec().get_string_attribute(attribute)) : "";
}

double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    double sum = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) sum += std::fabs(a[i] - b[i]);
    return sum / static_cast<double>(a.size());
}

class Cameras : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("whole.exr", kWide, kHigh);
    }

    /// Writes a part of the whole that begins at x, y, perhaps across the seam, and returns its pixels.
    static ImageBuf part(int x, int y, int width, int height) {
        ImageBuf whole("whole.exr"), cut(OIIO::ImageSpec(width, height, 3, OIIO::TypeFloat));
        for (int j = 0; j < height; ++j)
            for (int i = 0; i < width; ++i) {
                float pixel[3];
                whole.getpixel((x + i) % kWide, y + j, pixel);
                cut.setpixel(i, j, pixel);
            }
        return cut;
    }
    static void say_part(ImageBuf& image, int x, int y, int width, int height) {
        OIIO::ImageSpec& spec = image.specmod();
        spec.attribute("GPano:ProjectionType", "equirectangular");
        spec.attribute("GPano:FullPanoWidthPixels", kWide);
        spec.attribute("GPano:FullPanoHeightPixels", kHigh);
        spec.attribute("GPano:CroppedAreaLeftPixels", x);
        spec.attribute("GPano:CroppedAreaTopPixels", y);
        spec.attribute("GPano:CroppedAreaImageWidthPixels", width);
        spec.attribute("GPano:CroppedAreaImageHeightPixels", height);
    }
};

const char* const kView = "&to=rectilinear&fov=40&size=80x60";

// A part shows what the whole shows there, wherever it lies: in the middle, near a pole, across the seam.
TEST_F(Cameras, PartsOfPanoramasLieWhereTheyBelong) {
    const struct {
        int x, y, width, height;
        const char* look;
    } cases[] = {{100, 40, 120, 80, "&yaw=0&pitch=0"},   {20, 30, 100, 90, "&yaw=-100&pitch=10&roll=20"},
                 {250, 30, 140, 90, "&yaw=179&pitch=5"}, {90, 0, 140, 90, "&yaw=5&pitch=62"},
                 {90, 70, 140, 90, "&yaw=5&pitch=-62"},  {0, 40, 320, 80, "&yaw=-170&pitch=-10"}};
    for (const auto& c : cases) {
        SCOPED_TRACE(std::string(c.look) + " from " + std::to_string(c.x));
        ImageBuf image = part(c.x, c.y, c.width, c.height);
        write_image(image, "keys.exr");
        say_part(image, c.x, c.y, c.width, c.height);
        write_image(image, "tags.exr");
        const std::string look = kView + std::string(c.look) + "&tol=0.00001",
                          crop = "&srccrop=320x160+" + std::to_string(c.x) + "+" + std::to_string(c.y);
        const std::vector<float> whole = read_floats("whole.exr.pano?from=latlong" + look),
                                 by_tags = read_floats("tags.exr.pano?filter=antialias" + look),
                                 by_keys = read_floats("keys.exr.pano?from=latlong" + crop + look);
        EXPECT_LT(largest_difference(by_tags, whole), 2e-4);
        EXPECT_LT(largest_difference(by_keys, whole), 2e-4);
    }
    EXPECT_EQ(says("tags.exr.pano?size=8", "anamorph:from"),
              "equirectangular (as GPano:ProjectionType says, a part of 320x160 at 0,40)");
}

// Tags are of the picture as it was taken; a copy of half the size has the same.
TEST_F(Cameras, ResizedPartsKeepTheirPlace) {
    ImageBuf image = part(60, 40, 160, 80);
    say_part(image, 60, 40, 160, 80);
    write_image(image, "part.exr");
    ASSERT_EQ(run("oiiotool part.exr --resize 80x40 -o half.exr").status, 0);
    ASSERT_EQ(run("oiiotool part.exr --resize 80x80 -o narrow.exr").status, 0);
    const std::string view =
        "&to=rectilinear&fov=40&size=40x30&yaw=-20&filter=bilinear&tol=0.0001&output=stmap";
    const std::vector<float> places = read_floats("part.exr.pano?srcyaw=0" + view);
    EXPECT_LT(largest_difference(read_floats("half.exr.pano?srcyaw=0" + view), places), 1e-5);
    EXPECT_LT(largest_difference(read_floats("narrow.exr.pano?srcyaw=0" + view), places), 1e-5);
    // Other fields of view that are asked for are the whole's.
    EXPECT_GT(largest_difference(read_floats("part.exr.pano?srcfov=180" + view), places), 1e-2);
}

// Rows of a panorama with metadata are of 180 degrees in all, also where nothing of it was cut off.
TEST_F(Cameras, WholePanoramasWithMetadataMayBeSqueezed) {
    ImageBuf image = part(0, 0, kWide, kHigh);
    say_part(image, 0, 0, kWide, kHigh);
    write_image(image, "tagged.exr");
    ASSERT_EQ(run("oiiotool tagged.exr --resize 160x160 -o squeezed.exr").status, 0);
    const std::string view = ".pano?srcyaw=0&fov=70&size=40x30&yaw=-20&pitch=10&tol=0.0001&output=stmap";
    const std::vector<float> places = read_floats("whole.exr" + view);
    EXPECT_LT(largest_difference(read_floats("tagged.exr" + view), places), 1e-6);
    EXPECT_LT(largest_difference(read_floats("squeezed.exr" + view), places), 1e-5);
    EXPECT_GT(largest_difference(read_floats("squeezed.exr.pano?srccrop=none&from=latlong&" + view.substr(6)),
                                 places),
              0.1);
    // Of other projections what the tags say of parts does not count.
    ImageBuf fish = part(0, 0, 100, 50);
    say_part(fish, 20, 30, 100, 50);
    fish.specmod().attribute("GPano:ProjectionType", "fisheye");
    write_image(fish, "fish.exr");
    EXPECT_EQ(says("fish.exr.pano?size=8", "anamorph:from"), "fisheye (as GPano:ProjectionType says)");
}

// What a picture says of itself is read back to the last digit.
TEST_F(Cameras, PicturesAreReadAsTheyWereWritten) {
    for (const std::string to :
         {"to=rectilinear&vfov=110", "to=pannini&d=0.5&fov=150&vfov=80", "to=fisheye&focal=7.3"}) {
        SCOPED_TRACE(to);
        ASSERT_EQ(run("oiiotool 'whole.exr.pano?" + to + "&size=60x40' -o seen.exr").status, 0);
        const std::string said = says("whole.exr.pano?size=60x40&" + to, "panoramaProjection"),
                          fov = said.substr(said.find("fov=") + 4,
                                            said.find(' ', said.find("fov=")) - said.find("fov=") - 4);
        std::string keys = "&srcfov=" + fov + "&from=" + said.substr(0, said.find(' '));
        if (said.find("vfov=") != std::string::npos && to.find("fov=150") != std::string::npos)
            keys += "&srcvfov=80&srcd=0.5";
        const std::string view = "&to=fisheye&fov=90&size=40x30&yaw=13&pitch=-20&tol=0&output=stmap";
        EXPECT_EQ(largest_difference(read_floats("seen.exr.pano?srcyaw=0" + view),
                                     read_floats("seen.exr.pano?srcyaw=0" + keys + view)),
                  0);
    }
}

TEST_F(Cameras, PosesAreTheSourcesAngles) {
    ImageBuf image = part(0, 0, kWide, kHigh);
    image.specmod().attribute("GPano:ProjectionType", "equirectangular");
    image.specmod().attribute("GPano:PoseHeadingDegrees", 30.0f);
    image.specmod().attribute("GPano:PosePitchDegrees", -7.5f);
    image.specmod().attribute("GPano:PoseRollDegrees", 12);
    write_image(image, "posed.exr");
    EXPECT_TRUE(read_floats("posed.exr.pano?fov=60&size=50x40") ==
                read_floats("whole.exr.pano?fov=60&size=50x40&srcyaw=30&srcpitch=-7.5&srcroll=12"));
    EXPECT_TRUE(read_floats("posed.exr.pano?fov=60&size=50x40&srcyaw=0&srcroll=3") ==
                read_floats("whole.exr.pano?fov=60&size=50x40&srcpitch=-7.5&srcroll=3"));
    // A part that was tilted: the tilt is that of the whole.
    ImageBuf tilted = part(40, 30, 160, 100);
    say_part(tilted, 40, 30, 160, 100);
    tilted.specmod().attribute("GPano:PosePitchDegrees", 20.0f);
    write_image(tilted, "tilted.exr");
    const std::string view = "&fov=30&size=50x40&yaw=-50&pitch=25&tol=0.00001";
    EXPECT_LT(largest_difference(read_floats("tilted.exr.pano?pixels=edges" + view),
                                 read_floats("whole.exr.pano?srcpitch=20" + view)),
              2e-4);
}

// A whole sphere squeezed into a square, and back.
TEST_F(Cameras, PixelsNeedNotBeSquare) {
    ASSERT_EQ(run("oiiotool whole.exr --resize:filter=box 160x160 -o squeezed.exr").status, 0);
    const std::string look = "&fov=70&size=90x70&yaw=150&pitch=50&filter=bilinear";
    EXPECT_LT(mean_difference(read_floats("squeezed.exr.pano?from=latlong&srcvfov=180" + look),
                              read_floats("whole.exr.pano?from=latlong" + look)),
              0.02);
    // What is drawn so says so, and is read so.
    const std::string square = "whole.exr.pano?to=latlong&vfov=180&size=160x160";
    EXPECT_EQ(says(square, "panoramaProjection"), "equirectangular fov=360 vfov=180");
    ASSERT_EQ(run("oiiotool '" + square + "' -o square.exr").status, 0);
    EXPECT_LT(mean_difference(read_floats("square.exr.pano?wrap=automatic" + look),
                              read_floats("whole.exr.pano?from=latlong" + look)),
              0.02);
    // Where things stand is no matter of sampling.
    const std::vector<float> uv = read_floats("squeezed.exr.pano?from=latlong&srcvfov=180&output=stmap" +
                                              look),
                             whole = read_floats("whole.exr.pano?from=latlong&output=stmap" + look);
    EXPECT_LT(largest_difference(uv, whole), 2e-4);
}

// A picture without a size is as fine as the shorter sides of its source's pixels.
TEST_F(Cameras, DefaultSizesSeeOblongPixels) {
    ASSERT_EQ(run("oiiotool whole.exr --resize 64x256 -o tall.exr").status, 0);
    const auto input = open("tall.exr.pano?from=latlong&srcvfov=180&to=equirectangular");
    ASSERT_TRUE(input);
    EXPECT_EQ(input->spec().width, 512);
    EXPECT_EQ(input->spec().height, 256);
}

// The place of a part is turned with its picture, also where its numbers are written as floats.
TEST_F(Cameras, PartsMayBeStoredTurned) {
    ImageBuf image = part(60, 40, 160, 80);
    write_image(image, "part.exr");
    ImageBuf turned = OIIO::ImageBufAlgo::rotate180(image);
    turned.specmod().attribute("Orientation", 3);
    // Of the stored picture, which is upside down: as far from the other corner.
    say_part(turned, kWide - 60 - 160, kHigh - 40 - 80, 160, 80);
    for (const char* name : {"FullPanoWidth", "FullPanoHeight", "CroppedAreaLeft", "CroppedAreaTop",
                             "CroppedAreaImageWidth", "CroppedAreaImageHeight"}) {
        const std::string key = std::string("GPano:") + name + "Pixels";
        turned.specmod().attribute(key, static_cast<float>(turned.spec().get_int_attribute(key)));
    }
    write_image(turned, "turned.exr");
    const std::string view = "&fov=40&size=40x30&yaw=-20&tol=0.0001";
    EXPECT_EQ(largest_difference(read_floats("turned.exr.pano?srcyaw=0" + view),
                                 read_floats("part.exr.pano?from=latlong&srccrop=320x160+60+40" + view)),
              0);
}

// A part that cannot be one is not taken for one, and that is said.
TEST_F(Cameras, PartsThatCannotBeAreSaidNotToBeUsed) {
    const auto source_of = [](const std::string& name, const std::string& keys) {
        return says(name + ".pano?from=equirectangular&to=rectilinear&fov=60&size=32x24" + keys,
                    "anamorph:from");
    };
    const std::string said = "not the part that GPano:CroppedArea... says, which cannot be";
    int number = 0;
    for (const auto& [name, value] : {std::pair{"FullPanoWidthPixels", 0.0f},
                                      {"FullPanoHeightPixels", -1.0f},
                                      {"CroppedAreaLeftPixels", 2147483648.0f},
                                      {"CroppedAreaTopPixels", -1.0f},
                                      {"CroppedAreaImageWidthPixels", 321.0f},
                                      {"CroppedAreaImageHeightPixels", NAN}}) {
        ImageBuf image = part(60, 40, 160, 80);
        say_part(image, 60, 40, 160, 80);
        image.specmod().attribute(std::string("GPano:") + name, value);
        const std::string file = "impossible" + std::to_string(number++) + ".exr";
        write_image(image, file);
        EXPECT_THAT(source_of(file, ""), HasSubstr(said)) << name;
        EXPECT_THAT(source_of(file, "&srccrop=none"), testing::Not(HasSubstr(said))) << name;
        EXPECT_THAT(source_of(file, "&srccrop=320x160+60+40"), testing::Not(HasSubstr(said))) << name;
    }
    ImageBuf image = part(60, 40, 160, 80);
    write_image(image, "unsaid.exr");
    EXPECT_THAT(source_of("unsaid.exr", ""), testing::Not(HasSubstr(said)));
}

/// A JPEG file with XMP, as cameras write it.
void write_jpeg(const ImageBuf& image, const std::string& name, const std::string& xmp) {
    write_image(image, "plain.jpg");
    std::ifstream plain("plain.jpg", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(plain), {}};
    const std::string segment = std::string("http://ns.adobe.com/xap/1.0/") + '\0' + xmp;
    const std::size_t length = segment.size() + 2;
    std::ofstream(name, std::ios::binary)
        << bytes.substr(0, 2) << "\xff\xe1" << static_cast<char>(length / 256)
        << static_cast<char>(length % 256) << segment << bytes.substr(2);
}

// OpenImageIO 2.4 does not hand on what the XMP of a JPEG says of panoramas.
TEST_F(Cameras, PartsAreKnownByTheXmpOfJpeg) {
    const std::string begin =
        "<x:xmpmeta xmlns:x='adobe:ns:meta/'><rdf:RDF "
        "xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'>"
        "<rdf:Description xmlns:GPano='http://ns.google.com/photos/1.0/panorama/' ";
    const std::string as_attributes =
        begin +
        "GPano:ProjectionType='equirectangular' GPano:FullPanoWidthPixels='320' "
        "GPano:FullPanoHeightPixels='160' GPano:CroppedAreaLeftPixels='250' GPano:CroppedAreaTopPixels='30' "
        "GPano:CroppedAreaImageWidthPixels='140' GPano:CroppedAreaImageHeightPixels='90' "
        "GPano:PoseHeadingDegrees='12.5'/></rdf:RDF></x:xmpmeta>";
    std::string as_elements = begin + ">";
    for (const auto& [key, value] : {std::pair{"ProjectionType", "equirectangular"},
                                     {"FullPanoWidthPixels", "320"},
                                     {"FullPanoHeightPixels", "160"},
                                     {"CroppedAreaLeftPixels", "250"},
                                     {"CroppedAreaTopPixels", "30"},
                                     {"CroppedAreaImageWidthPixels", "140"},
                                     {"CroppedAreaImageHeightPixels", "90"},
                                     {"PoseHeadingDegrees", "12.5"}})
        as_elements += std::string("<GPano:") + key + ">" + value + "</GPano:" + key + ">";
    as_elements += "</rdf:Description></rdf:RDF></x:xmpmeta>";
    const ImageBuf image = part(250, 30, 140, 90);
    for (const std::string& xmp : {as_attributes, as_elements}) {
        write_jpeg(image, "camera.jpg", xmp);
        EXPECT_EQ(says("camera.jpg.pano?size=8", "anamorph:from"),
                  "equirectangular (as GPano:ProjectionType says, a part of 320x160 at 250,30)");
        const std::string view = "&yaw=170&fov=60&size=40x30";
        const std::vector<float> expected =
            read_floats("plain.jpg.pano?from=equirectangular&srccrop=320x160+250+30&srcyaw=12.5" + view);
        EXPECT_EQ(largest_difference(read_floats("camera.jpg.pano?mip=0" + view), expected), 0);
        // Functions know the file of their source.
        ImageBuf drawn;
        const ImageBuf source("camera.jpg");
        ASSERT_TRUE(
            apply(drawn, "pano", {&source}, options({{"yaw", "170"}, {"fov", "60"}, {"size", "40x30"}})))
            << drawn.geterror();
        std::vector<float> pixels(expected.size());
        drawn.get_pixels(OIIO::ROI(), OIIO::TypeFloat, pixels.data());
        EXPECT_EQ(largest_difference(pixels, expected), 0);
    }
    // What cannot be is none.
    for (const std::string& xmp : {std::string("no XML"), begin + "GPano:FullPanoWidthPixels='2147483648'/>",
                                   begin + "GPano:CroppedAreaLeftPixels='nan'/></rdf:RDF></x:xmpmeta>"}) {
        write_jpeg(image, "camera.jpg", xmp);
        EXPECT_EQ(largest_difference(read_floats("camera.jpg.pano?from=equirectangular&size=40x30"),
                                     read_floats("plain.jpg.pano?from=equirectangular&size=40x30")),
                  0);
    }
}

TEST_F(Cameras, ViewsByHeightAndByFocalLength) {
    const auto same = [](const std::string& a, const std::string& b) {
        SCOPED_TRACE(a + " and " + b);
        const std::string keys = "whole.exr.pano?yaw=20&pitch=10&output=stmap&tol=0.00001";
        EXPECT_LT(largest_difference(read_floats(keys + a), read_floats(keys + b)), 2e-6);
    };
    const auto degrees = [](double radians) { return std::to_string(radians * 180 / std::numbers::pi); };
    // 90 by 60 square pixels: tangents are to each other as sides.
    same("&vfov=40&size=90x60",
         "&size=90x60&fov=" + degrees(2 * std::atan(1.5 * std::tan(20 * std::numbers::pi / 180))));
    same("&to=fisheye&vfov=100&size=90x60", "&to=fisheye&fov=150&size=90x60");
    same("&to=latlong&vfov=90&size=160", "&to=latlong&size=160x40");
    // A plane 2 high and 3 wide, in radians, of square pixels.
    same("&to=cylindrical&vfov=90&size=90x60&fov=" + degrees(3),
         "&to=cylindrical&size=90x60&fov=" + degrees(3));
    same("&focal=24&size=90x60", "&size=90x60&fov=" + degrees(2 * std::atan(18.0 / 24)));
    same("&focal=4&sensor=5.6&size=90x60", "&size=90x60&fov=" + degrees(2 * std::atan(0.7)));
    same("&to=fisheye&focal=8&sensor=20&size=60", "&to=fisheye&size=60&fov=" + degrees(2.5));
    same("&to=equisolid&focal=8&sensor=20&size=60",
         "&to=equisolid&size=60&fov=" + degrees(4 * std::asin(20.0 / 32)));
    const std::string photo = "whole.exr.pano?from=rectilinear&fov=50&size=40x30&output=stmap";
    EXPECT_LT(largest_difference(read_floats(photo + "&srcfocal=28"),
                                 read_floats(photo + "&srcfov=" + degrees(2 * std::atan(18.0 / 28)))),
              2e-6);
    EXPECT_LT(
        largest_difference(read_floats(photo + "&srcvfov=40"),
                           read_floats(photo + "&srcfov=" +
                                       degrees(2 * std::atan(2 * std::tan(20 * std::numbers::pi / 180))))),
        2e-6);
}

TEST_F(Cameras, SayWhatIsWrong) {
    const struct {
        const char *keys, *message;
    } cases[] = {
        {"focal=24&fov=60", "focal=24: must not be given together with fov"},
        {"sensor=24", "sensor=24: must be given together with focal"},
        {"focal=0", "focal=0: must be"},
        {"focal=nan", "focal=nan: must be"},
        {"to=orthographic&focal=8", "focal=8: is too short"},
        {"to=cubemap&focal=24", "focal=24: must be of a picture in one piece"},
        {"vfov=180", "vfov=180: must be above 0 and below 180 degrees for rectilinear"},
        {"to=latlong&vfov=181", "vfov=181: must be above 0 and up to 180 degrees for equirectangular"},
        {"to=cylindrical&vfov=180", "vfov=180: must be above 0 and below 180 degrees for cylindrical"},
        {"to=mercator&vfov=180&fov=360", "vfov=180: must be above 0 and below 180 degrees for mercator"},
        {"to=cubemap&vfov=90", "vfov=90: cubemap has none but its own"},
        {"to=orthographic&vfov=170&size=90x30", "vfov=170: is too much"},
        {"to=formula&vfov=90", "vfov=90: is of other projections"},
        {"srcvfov=200", "srcvfov=200: must be"},
        {"srccrop=320x160", "srccrop=320x160: must be none, or WxH+X+Y"},
        {"srccrop=320x160+1+1",
         "srccrop=320x160+1+1: must be none, or WxH+X+Y with the source, 320x160, inside"},
        {"srccrop=99999999999x9+0+0", "must be none, or WxH+X+Y"},
        {"srccrop=640x320+700+0", "must be none, or WxH+X+Y"},
        {"srccrop=640x320+0+0&from=fisheye",
         "srccrop=640x320+0+0: must be of a projection whose columns are meridians"},
        {"srcfov=180&srccrop=640x320+500+0", "must not run across the seam"},
        {"pixels=centers&srccrop=640x320+0+0", "pixels=centers: must be edges"},
    };
    for (const auto& c : cases) {
        SCOPED_TRACE(c.keys);
        const std::string keys = c.keys;
        const std::string more = std::string(keys.find("from=") == std::string::npos ? "from=latlong&" : "") +
                                 (keys.find("size=") == std::string::npos ? "size=60&" : "");
        EXPECT_THAT(open_error("v.pano?src=whole.exr&" + more + keys), HasSubstr(c.message));
    }
    // Tags that cannot be are none.
    ImageBuf image = part(0, 0, 160, 80);
    say_part(image, 10, 100, 160, 80);
    write_image(image, "wrong.exr");
    EXPECT_EQ(
        says("wrong.exr.pano?size=8", "anamorph:from"),
        "equirectangular (as GPano:ProjectionType says, not the part that GPano:CroppedArea... says, which "
        "cannot be)");
}

TEST_F(Cameras, AreOnePicture) {
    write_image(part(250, 30, 140, 90), "part.exr");
    expect_one_picture(
        "part.exr.pano?from=latlong&srccrop=320x160+250+30&yaw=170&pitch=20&fov=110&size=160x120", 50, 40);
}

// --- two eyes ---

/// The pictures of two eyes above each other, or side by side, and how one is said to lie in them.
void join_eyes(const std::string& left, const std::string& right) {
    ASSERT_EQ(run("oiiotool " + left + " " + right + " --mosaic 1x2 -o above.exr").status, 0);
    ASSERT_EQ(run("oiiotool " + left + " " + right + " --mosaic 2x1 -o beside.exr").status, 0);
}

// Each eye's picture is what its own file shows, seams, poles and pyramids included.
TEST_F(Cameras, EyesSeeTheirOwnPart) {
    ASSERT_EQ(run("oiiotool whole.exr --flop --mulc 0.5 -o right.exr").status, 0);
    join_eyes("whole.exr", "right.exr");
    for (const std::string view :
         {"&to=rectilinear&fov=70&yaw=170&pitch=20&size=60x40", "&to=fisheye&fov=180&pitch=90&size=40",
          "&to=equirectangular&yaw=33&size=50", "&to=rectilinear&fov=30&yaw=20&size=60x40&alpha=1"})
        for (const std::string filter : {"antialias", "bicubic", "sharp_bicubic", "nearest"}) {
            SCOPED_TRACE(view + " " + filter);
            const std::string keys = view + "&from=latlong&filter=" + filter;
            const std::vector<float> left = read_floats("whole.exr.pano?srcyaw=0" + keys),
                                     right = read_floats("right.exr.pano?srcyaw=0" + keys);
            for (const std::string stereo :
                 {"above.exr.pano?stereo=top-bottom", "beside.exr.pano?stereo=side-by-side"}) {
                EXPECT_EQ(largest_difference(read_floats(stereo + "&eye=left" + keys), left), 0) << stereo;
                EXPECT_EQ(largest_difference(read_floats(stereo + "&eye=right" + keys), right), 0) << stereo;
            }
            std::vector<float> both = left;
            both.insert(both.end(), right.begin(), right.end());
            EXPECT_EQ(largest_difference(read_floats("above.exr.pano?stereo=top-bottom" + keys), both), 0);
        }
    const auto input = open("beside.exr.pano?stereo=side-by-side&from=latlong&to=rectilinear&size=60x40");
    EXPECT_EQ(input->spec().width, 120);
    EXPECT_EQ(input->spec().height, 40);
    expect_one_picture("beside.exr.pano?stereo=side-by-side&from=latlong&to=rectilinear&size=60x40", 40, 5);
    expect_one_picture("above.exr.pano?stereo=top-bottom&from=latlong&to=rectilinear&size=60x40", 10, 20);
}

TEST_F(Cameras, EyesAreRefusedWhereTheyCannotBe) {
    EXPECT_THAT(open_error("whole.exr.pano?eye=left"), HasSubstr("must be given together with stereo"));
    write_panorama("odd.exr", 64, 33);
    EXPECT_THAT(open_error("odd.exr.pano?from=latlong&stereo=top-bottom"), HasSubstr("even height"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&stereo=top-bottom&output=stmap"),
                HasSubstr("output"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&stereo=top-bottom&overscan=4"),
                HasSubstr("must be of one eye"));
}

// --- faces ---

// A face alone is that of the whole layout.
TEST_F(Cameras, FacesStandAlone) {
    const struct {
        const char *to, *face;
        int column, row;
    } cases[] = {{"cubemap", "+x", 0, 0},       {"cubemap", "-x", 0, 1},       {"cubemap", "+y", 0, 2},
                 {"cubemap", "-y", 0, 3},       {"cubemap", "+z", 0, 4},       {"cubemap", "-z", 0, 5},
                 {"cubemap", "left", 0, 0},     {"cubemap", "up", 0, 2},       {"cubemap", "back", 0, 5},
                 {"cubemap3x2", "right", 0, 0}, {"cubemap3x2", "left", 1, 0},  {"cubemap3x2", "up", 2, 0},
                 {"cubemap3x2", "down", 0, 1},  {"cubemap3x2", "front", 1, 1}, {"cubemap3x2", "back", 2, 1},
                 {"cubecross", "front", 1, 1},  {"cubecross", "up", 1, 0},     {"cubecross", "back", 3, 1}};
    constexpr int kSide = 24;
    const std::string view = "whole.exr.pano?from=latlong&yaw=20&pitch=10&tol=0.00001&filter=bilinear";
    for (const auto& c : cases) {
        SCOPED_TRACE(std::string(c.to) + " " + c.face);
        const FaceGrid grid = faces_of(projection_from_name(c.to));
        const int width = grid.columns * kSide;
        const std::vector<float> layout =
                                     read_floats(view + "&to=" + c.to + "&size=" + std::to_string(width)),
                                 face = read_floats(view + "&to=" + c.to + "&face=" + c.face + "&size=24");
        ASSERT_EQ(face.size(), 3u * kSide * kSide);
        double most = 0;
        for (int y = 0; y < kSide; ++y)
            for (int i = 0; i < 3 * kSide; ++i) {
                const int at = ((c.row * kSide + y) * width + c.column * kSide) * 3 + i;
                most = std::max(most, double{std::fabs(face[static_cast<std::size_t>(3 * kSide * y + i)] -
                                                       layout[static_cast<std::size_t>(at)])});
            }
        EXPECT_LT(most, 1e-4);
    }
    // By default as large as in the layout.
    EXPECT_EQ(6 * open("whole.exr.pano?from=latlong&to=cubemap&face=+x")->spec().height,
              open("whole.exr.pano?from=latlong&to=cubemap")->spec().height);
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=eac&face=up"), HasSubstr("must be of to=cubemap"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=cubemap3x2&face=+x"),
                HasSubstr("or of to=cubemap"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=cubemap&face=top"), HasSubstr("face"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=cubemap&face=up&size=20x30"), HasSubstr("square"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=cubemap&face=up&size=20&fov=70"),
                HasSubstr("must not be given with face"));
}

// Films have equi-angular cubes in frames of 16:9.
TEST_F(Cameras, EquiAngularCubesMayBeOblong) {
    ASSERT_EQ(run("oiiotool 'whole.exr.pano?from=latlong&to=eac&size=192x108&tol=0.0001' -o film.exr").status,
              0);
    const std::string view = "&to=rectilinear&fov=60&size=60x40&filter=bilinear&tol=0.0001";
    const std::string corner = view + "&yaw=40&pitch=-30";
    EXPECT_LT(mean_difference(read_floats("film.exr.pano?from=eac" + corner),
                              read_floats("whole.exr.pano?from=latlong" + corner)),
              0.02);
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=eac&size=192x107"),
                HasSubstr("faces of equal height, 3 across"));
    // Nor need faces be whole pixels wide, with a margin around their rows or without one.
    for (const std::string film :
         {"size=191x108", "size=224x126&padding=rows:2", "size=192x108&padding=rows:3"}) {
        const std::string name = film.substr(5, 3) + ".exr";
        ASSERT_EQ(
            run("oiiotool 'whole.exr.pano?from=latlong&to=eac&tol=0.0001&" + film + "' -o " + name).status,
            0);
        for (const std::string turn : {"", "&yaw=45", "&yaw=-135&pitch=10", "&pitch=90&roll=30"})
            EXPECT_LT(mean_difference(read_floats(name + ".pano?from=eac" + view + turn),
                                      read_floats("whole.exr.pano?from=latlong" + view + turn)),
                      0.02)
                << film << turn;
    }
    for (const std::string bad :
         {"rows:", "rows:-1", "rows:x", "rows:2.5", "row:2", "rows:99999999", "2:rows"})
        EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=eac&size=160x90&padding=" + bad),
                    HasSubstr("padding"))
            << bad;
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=eac&size=160x90&padding=2"),
                HasSubstr("rows:2, around each row of faces, where 160 pixels are no multiple of 3"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=cubemap3x2&size=192x128&padding=rows:2"),
                HasSubstr("rows: must be of eac, not of cubemap3x2"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=eac&size=160x90&padding=rows:14"),
                HasSubstr("less than a quarter of the sides"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=cubemap3x2&size=192x108"),
                HasSubstr("square faces"));
}

}  // namespace
}  // namespace anamorph::test_cameras
