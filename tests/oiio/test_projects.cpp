// SPDX-License-Identifier: Apache-2.0
// Projects of Hugin as sources: what is refused, and that hosts, functions and rewritten files show one picture. Where its points
// lie is for test_hugin.py.
#include <OpenImageIO/imagebuf.h>

#include <filesystem>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_projects {
namespace {

using namespace testing_oiio;
using OIIO::ImageBuf;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kPanorama = "p f2 w128 h64 v360 E1 R0 n\"TIFF_m\"\n";
const std::string kLeft = "i w64 h48 f0 v80 a0 b-0.01 c0 d1 e-2 y-20 p5 r3 Eev1 n\"left.exr\"\n";
const std::string kRight = "i w64 h48 f3 v=0 y25 p0 r0 S3,60,2,46 Eev1 n\"right.exr\"\n";

class Projects : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("left.exr", 64, 48);
        write_panorama("right.exr", 64, 48, OIIO::TypeHalf);
        write_text("two.pto", kPanorama + kLeft + kRight);
    }
    static std::string says(const std::string& name, const char* attribute) {
        const auto input = open(name);
        return input ? std::string(input->spec().get_string_attribute(attribute)) : "";
    }
};

TEST_F(Projects, EveryHostReadsOnePicture) {
    for (const char* name :
         {"two.pto?layers=order", "two.pto?layers=blend", "two.pto.pano?image=1&yaw=20&to=fisheye&size=90x70",
          "x.pano?src=two.pto&feather=7&overscan=9x5"})
        expect_one_picture(name, 30, 12);
    EXPECT_EQ(says("two.pto", "anamorph:from"), "2 layers of a project of 2");
    EXPECT_EQ(says("two.pto?image=1", "anamorph:from"), "fisheye (image 1 of a project of 2)");
    EXPECT_EQ(says("two.pto", "anamorph:not_applied"), "");
    EXPECT_EQ(read_floats("two.pto").size(), 128u * 64 * 3);
    // A width alone has the height that the panorama's shape gives it.
    write_text("narrow.pto", "p f2 w90 h80 v150\n" + kLeft);
    EXPECT_EQ(read_floats("narrow.pto?size=45").size(), 45u * 40 * 3);
}

TEST_F(Projects, ARewrittenOneIsReadAgain) {
    const std::vector<float> before = read_floats("two.pto");
    write_text("two.pto", kPanorama + kLeft + "i w64 h48 f3 v=0 y35 p0 r0 Eev2 n\"right.exr\"\n");
    EXPECT_NE(read_floats("two.pto"), before);
    EXPECT_EQ(says("two.pto", "anamorph:not_applied"), "Eev");
    write_text("two.pto", kPanorama + kLeft + kRight);
    EXPECT_EQ(read_floats("two.pto"), before);
    write_panorama("right.exr", 64, 48, OIIO::TypeUInt8);
    EXPECT_NE(read_floats("two.pto"), before) << "images that it names count too";
}

TEST_F(Projects, ImagesStandInItsFolder) {
    const std::vector<float> here = read_floats("two.pto");
    std::filesystem::create_directory("folder");
    for (const char* name : {"left.exr", "right.exr", "two.pto"})
        std::filesystem::rename(name, std::string("folder/") + name);
    EXPECT_EQ(read_floats("folder/two.pto"), here);
    write_text("view.pano", "src=folder/two.pto\n");
    EXPECT_EQ(read_floats("view.pano"), here);
    write_text("folder/view.pano", "src=two.pto\n");
    EXPECT_EQ(read_floats("folder/view.pano"), here);
}

TEST_F(Projects, FunctionsTakeThemWithoutImages) {
    const auto drawn = [](const OIIO::ParamValueList& list,
                          const std::vector<const ImageBuf*>& sources = {}) {
        ImageBuf result;
        apply(result, "pano", sources, list, OIIO::ROI(), 0);
        return result;
    };
    const ImageBuf all = drawn(options({{"src", "two.pto"}, {"layers", "blend"}}));
    ASSERT_FALSE(all.has_error()) << all.geterror();
    std::vector<float> pixels(128 * 64 * 3);
    ASSERT_TRUE(all.get_pixels(all.roi(), OIIO::TypeFloat, pixels.data()));
    EXPECT_EQ(pixels, read_floats("two.pto?layers=blend"));
    const ImageBuf left("left.exr");
    EXPECT_THAT(drawn(options({{"src", "two.pto"}}), {&left}).geterror(),
                HasSubstr("src=two.pto: must be given without source images"));
    EXPECT_THAT(drawn(options({{"src", "left.exr"}})).geterror(), HasSubstr("must be given in recipes only"));
    EXPECT_THAT(drawn({}).geterror(), HasSubstr("0 source images: must be 1"));
    EXPECT_THAT(drawn(options({{"src", "none.pto"}})).geterror(), HasSubstr("none.pto\" does not exist"));
}

TEST_F(Projects, ImagesAreTakenAsTheyAreStored) {
    ImageBuf left("left.exr");
    left.specmod().attribute("Orientation", 6);
    write_image(left, "turned.tif");
    write_text("stored.pto", kPanorama + "i w64 h48 f0 v80 y0 p0 r0 n\"left.exr\"\n");
    write_text("turned.pto", kPanorama + "i w64 h48 f0 v80 y0 p0 r0 n\"turned.tif\"\n");
    EXPECT_EQ(read_floats("turned.pto"), read_floats("stored.pto"));
}

TEST_F(Projects, AreFilmsAndParts) {
    write_text("keys.json", R"({"keys": {"yaw": [[0, 0], [2, 30]]}})");
    const std::string film = "x.pano?src=two.pto&to=rectilinear&fov=70&size=40x30&keys=keys.json";
    EXPECT_EQ(read_floats(film + "&frame=2"),
              read_floats("x.pano?src=two.pto&to=rectilinear&fov=70&size=40x30&yaw=30"));
    EXPECT_EQ(read_floats("x.pano?src=two.pto&mip=1&size=64x32", 1).size(), 32u * 16 * 3);
    EXPECT_EQ(read_floats("two.pto?frames=2"), read_floats("two.pto"));
    // What is refused as a key is refused as a key frame.
    for (const std::string name : {"srcyaw", "seam"}) {
        write_text("refused.json", R"({"keys": {")" + name + R"(": [[0, 0], [2, 30]]}})");
        EXPECT_THAT(open_error("two.pto.pano?keys=refused.json"),
                    AllOf(HasSubstr(name + "="), HasSubstr("must not be given with a project of Hugin")));
    }
    write_text("feather.json", R"({"keys": {"feather": [[0, 1], [2, 30]]}})");
    EXPECT_FALSE(read_floats("two.pto?layers=blend&keys=feather.json&frame=1").empty());
    EXPECT_THAT(open_error("two.pto?image=0&keys=feather.json"),
                HasSubstr("must not be given with image, of which there is one"));
    EXPECT_THAT(open_error("left.exr.pano?from=rectilinear&keys=feather.json"),
                AllOf(HasSubstr("feather="), HasSubstr("must be given together with a project")));
    // Of one that is not cropped a shutter may be open, and a chain is joined.
    EXPECT_FALSE(
        read_floats("x.pano?src=two.pto&image=0&shutter=2&samples=3&keys=keys.json&frame=1").empty());
    EXPECT_EQ(
        says("x.lens?lens=3de4:k1=0.05&src=(x.pano?src=two.pto&image=0&to=rectilinear&fov=70&size=40x30)",
             "anamorph:chain"),
        "lens of pano");
    EXPECT_THAT(says("x.lens?lens=3de4:k1=0.05&src=two.pto", "anamorph:chain"),
                HasSubstr("that is drawn first"));
}

TEST_F(Projects, SayWhatIsRefused) {
    const std::pair<const char*, const char*> rows[] = {
        {"from=fisheye", "from=fisheye: must not be given with a project of Hugin as src"},
        {"srcfov=90", "srcfov=90: must not be given with a project of Hugin as src"},
        {"srcyaw=9", "srcyaw=9: must not be given with a project"},
        {"srclens=none", "srclens=none: must not be given with a project"},
        {"srccrop=none", "srccrop=none: must not be given with a project"},
        {"pixels=centers", "pixels=centers: must not be given with a project"},
        {"stereo=top-bottom", "stereo=top-bottom: must not be given with a project"},
        {"eye=left", "eye=left: must not be given with a project"},
        {"scheme=hardware", "scheme=hardware: must not be given with a project"},
        {"machine=embm-2003", "machine=embm-2003: must not be given with a project"},
        {"to=formula", "to=formula: must not be given with a project"},
        {"face=left", "face=left: must be given together with to"},
        {"image=2", "image=2: must be the number of an image of the project, 0 to 1"},
        {"image=-1", "image=-1: must be an integer from 0 to 1023"},
        {"image=0&layers=blend", "layers=blend: must not be given with image"},
        {"image=0&feather=3", "feather=3: must not be given with image"},
        {"seam=10", "seam=10: must not be given with a project of Hugin as src"},
        {"srcpadding=3", "srcpadding=3: must not be given with a project of Hugin as src"},
        {"back_yaw=3", "back_yaw=3: must not be given with a project of Hugin as src"},
        {"feather=-1", "feather=-1: must be a number from 0 to 1e+06"},
        {"feather=nan", "feather=nan: must be a number from 0 to 1e+06"},
        {"layers=above", "layers=above: must be one of order, blend"},
        {"output=stmap", "output=stmap: must be of one image: with image=N"},
        {"wrap=clamp", "wrap=clamp: must be automatic or black"},
        {"shutter=1", "shutter=1: must be of an image that is not cropped"},
        {"data_filter=nearest", "data_filter=nearest: must not be given where images"},
        {"fov=2147483648", "fov=2147483648: must be"},
        {"size=2147483648", "size=2147483648: must be"},
    };
    for (const auto& [arguments, part] : rows)
        EXPECT_THAT(open_error(std::string("two.pto.pano?") + arguments),
                    AllOf(HasSubstr(part), Not(HasSubstr("\n"))))
            << arguments;
    EXPECT_THAT(open_error("left.exr.pano?from=rectilinear&image=0"),
                HasSubstr("image=0: must be given together with a project of Hugin as src, x.pto"));
    EXPECT_THAT(open_error("left.exr.pano?from=rectilinear&layers=order"),
                HasSubstr("must be given together with a project"));
    EXPECT_THAT(open_error("left.exr.pano?from=rectilinear&feather=3"),
                HasSubstr("must be given together with a project"));
    EXPECT_THAT(open_error("two.pto?src=left.exr"),
                HasSubstr("src=left.exr: must not be given with the name of a file"));
}

TEST_F(Projects, SayWhatIsWrongWithThem) {
    const auto error_of = [](const std::string& project, const std::string& arguments = "") {
        write_text("bad.pto", project);
        const std::string error = open_error("bad.pto" + arguments);
        EXPECT_THAT(error, Not(HasSubstr("\n")));
        return error;
    };
    EXPECT_THAT(error_of(""), HasSubstr("bad.pto: has no image: must have at least one row i"));
    EXPECT_THAT(error_of(kPanorama + "i w64 h48 f0 v80 n\"none.exr\""), HasSubstr("none.exr"));
    EXPECT_THAT(error_of(kPanorama + "i w64 h48 f0 v80 n\"http://x.y/z.exr\""), HasSubstr("z.exr"));
    EXPECT_THAT(error_of(kPanorama + "i w64 h47 f0 v80 n\"left.exr\""),
                HasSubstr("image 0 (left.exr) is 64x48 and its project says 64x47: must be the same"));
    EXPECT_THAT(error_of(kPanorama + "i w64 h48 f0 v180 n\"left.exr\""),
                HasSubstr("bad.pto: image 0 (left.exr): fov=180"));
    EXPECT_THAT(error_of(kPanorama + "i w64 h48 f4 v360 a0.1 n\"left.exr\""),
                AllOf(HasSubstr("bad.pto: image 0 (left.exr): "), HasSubstr("has no lens")));
    EXPECT_THAT(error_of(kPanorama + "i w64 h48 f1 v180 b9 n\"left.exr\""),
                HasSubstr("bad.pto: image 0 (left.exr): lens"));
    EXPECT_THAT(error_of(kPanorama + "i w64 h48 f0 v80 b9 n\"left.exr\""),
                HasSubstr("bad.pto: image 0 (left.exr): lens"));
    EXPECT_THAT(error_of(kPanorama + "i w64 h48 f0 v80 S64,70,0,48 n\"left.exr\""),
                HasSubstr("image 0 (left.exr): S: must have pixels of the image, 64x48"));
    EXPECT_THAT(error_of(kPanorama + "i w64 h48 f0 v80 TiX1 n\"left.exr\""),
                HasSubstr("bad.pto: row 2: TiX1: must be 0"));
    // Cameras too far away, and in the plane 1 ahead.
    for (const char* place : {"TrX1e7", "TrZ-1", "TrX1 Tpy90", "TrY-3 TrZ4 Tpp0 Tpy180 TrZ1"})
        EXPECT_THAT(error_of(kPanorama + "i w64 h48 f0 v80 " + place + " n\"left.exr\""),
                    testing::AnyOf(HasSubstr("TrX, TrY, TrZ"), HasSubstr("must be given once")))
            << place;
    EXPECT_THAT(error_of(kPanorama + "i w64 h48 f0 v80 g49 n\"left.exr\""),
                HasSubstr("g must be at most the picture's height"));
    EXPECT_THAT(error_of(kLeft), HasSubstr("to is not given and \"bad.pto\" has no row p"));
    EXPECT_THAT(error_of("p f12 w90 h80 v90\n" + kLeft),
                HasSubstr("to is not given: bad.pto: row 1: f12: must be one of"));
    EXPECT_THAT(error_of("p f0 w90 h80 v180\n" + kLeft), HasSubstr("fov=180: must be"));
    // What an image has that is not drawn is no matter to others; nor is the panorama to other views.
    write_text("bad.pto", "p f12 w90 h80 v90\n" + kLeft + "i w64 h48 f7 v80 n\"none.exr\"\n");
    EXPECT_EQ(read_floats("bad.pto?image=0&to=rectilinear&size=20").size(), 20u * 20 * 3);
    EXPECT_THAT(open_error("bad.pto?image=1&to=rectilinear"),
                HasSubstr("bad.pto: row 3: f7: must be one of the projections"));
    write_panorama("gray.exr", 64, 48, OIIO::TypeFloat, 1);
    EXPECT_THAT(error_of(kPanorama + kLeft + "i w64 h48 f0 v80 n\"gray.exr\""),
                HasSubstr("image 1 (gray.exr) has 1 channels and image 0 (left.exr) 3: must be the same"));
    write_image(ImageBuf("left.exr"), "left.jpg");
    EXPECT_THAT(error_of(kPanorama + kLeft + "i w64 h48 f0 v80 n\"left.jpg\""),
                AllOf(HasSubstr("image 1 (left.jpg) is in color space \"sRGB\" and image 0 (left.exr)"),
                      HasSubstr("must be the same, or colorspace be given")));
    // It cannot be made of itself.
    EXPECT_THAT(error_of(kPanorama + "i w128 h64 f4 v360 n\"bad.pto\""),
                HasSubstr("recipes read each other"));
}

}  // namespace
}  // namespace anamorph::test_projects
