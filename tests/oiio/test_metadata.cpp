// SPDX-License-Identifier: Apache-2.0
// What a picture says of itself and what it takes over of its source: values that are no colour are written
// as they are, turned sources come upright, and a picture's projection is known to the next who reads it.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/strutil.h>

#include <cmath>
#include <filesystem>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_metadata {
namespace {

using namespace testing_oiio;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const char* const kGrid = R"({"columns": 2, "rows": 2, "units": "fractions", "vertices": [
    [0, 0], [0.5, 0], [1, 0],  [0, 0.5], [0.61, 0.42], [1, 0.5],  [0, 1], [0.5, 1], [1, 1]]})";

class Metadata : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("city.exr", 64, 32);
        write_text("grid.json", kGrid);
        write_text("lines.csv", "8,8,50,12,12,10,44,20\n40,20,20,28,44,18,18,30\n");
    }
};

ImageSpec spec_of(const std::string& name) {
    const auto input = open(name);
    return input ? input->spec() : ImageSpec();
}

TEST_F(Metadata, ValuesThatAreNoColourAreWrittenAsTheyAre) {
    for (const char* compression : {"dwaa", "dwab", "pxr24", "b44", "b44a", "jpeg"}) {
        const bool jpeg = compression == std::string("jpeg");
        const bool half = compression[0] == 'b';
        const std::string source = jpeg ? "lossy.jpg" : "lossy.exr";
        ImageBuf image = panorama(64, 32, half ? OIIO::TypeHalf : jpeg ? OIIO::TypeUInt8 : OIIO::TypeFloat);
        image.specmod().attribute("compression", compression);
        write_image(image, source);
        ASSERT_THAT(spec_of(source).get_string_attribute("compression", "jpeg"),
                    testing::StartsWith(compression));
        std::vector<std::string> recipes;
        for (const char* output : {"stmap", "error", "bound"}) {
            recipes.push_back(source + ".pano?size=48x40&output=" + output);
            recipes.push_back(source + ".pano?size=48x24&to=equirectangular&output=" + output);
        }
        for (const char* output : {"stmap", "error", "bound", "folds"})
            recipes.push_back(source + ".warp?mesh=grid.json&output=" + output);
        for (const char* output : {"stmap&picture=a", "stmap&picture=b", "error", "bound"})
            recipes.push_back(source + ".morph?features=lines.csv&b=" + source + "&output=" + output);
        const auto written = [](std::size_t i) { return "out" + std::to_string(i); };
        std::string command = "oiiotool";
        for (std::size_t i = 0; i < recipes.size(); ++i)
            command += " '" + recipes[i] + "' -o " + written(i) + ".exr -o " + written(i) + ".tif";
        const Ran ran = run(command);
        ASSERT_EQ(ran.status, 0) << ran.text;
        for (std::size_t i = 0; i < recipes.size(); ++i)
            for (const char* format : {".exr", ".tif"}) {
                SCOPED_TRACE(recipes[i] + " as " + format);
                const std::string file = written(i) + format;
                EXPECT_EQ(spec_of(file).format, OIIO::TypeFloat);
                EXPECT_TRUE(read_floats(file) == read_floats(recipes[i]));
                std::filesystem::remove(file);
            }
    }
}

TEST_F(Metadata, ColourKeepsHowItIsCodedAndValuesDoNot) {
    ImageBuf image = panorama(64, 32);
    const std::pair<const char*, const char*> coding[] = {{"compression", "dwab"},
                                                          {"oiio:ColorSpace", "sRGB"},
                                                          {"Exif:ColorSpace", "1"},
                                                          {"jpeg:subsampling", "4:4:4"},
                                                          {"ICCProfile:color_space", "RGB"}};
    for (const auto& [name, value] : coding) image.specmod().attribute(name, value);
    image.specmod().attribute("CompressionQuality", 40);
    image.specmod().attribute("Artist", "somebody");
    for (const char* output : {"color", "stmap", "error", "bound"}) {
        SCOPED_TRACE(output);
        const bool color = output == std::string("color");
        const ImageSpec spec = reproject(image, options({{"size", "8"}, {"output", output}})).spec();
        for (const auto& [name, value] : coding)
            EXPECT_EQ(spec.find_attribute(name) != nullptr, color) << name;
        EXPECT_EQ(spec.find_attribute("CompressionQuality") != nullptr, color);
        EXPECT_EQ(spec.get_string_attribute("Artist"), "somebody");
    }
}

TEST_F(Metadata, WhatTheWarpMakesUntrueIsDropped) {
    ImageBuf image = panorama(64, 32);
    for (const char* name :
         {"textureformat", "wrapmodes", "envmap", "oiio:SHA-1", "oiio:AverageColor", "GPano:ProjectionType",
          "Exif:FocalLength", "Exif:FocalLengthIn35mmFilm", "Exif:FocalPlaneXResolution", "Exif:SubjectArea",
          "Exif:PixelXDimension", "thumbnail_width", "originalDataWindow", "fovcot", "tiff:Compression"})
        image.specmod().attribute(name,
                                  name == std::string("GPano:ProjectionType") ? "equirectangular" : "1");
    const char* const kept[] = {
        "Artist",       "Copyright", "Exif:ExposureTime", "Exif:SubjectDistance", "Exif:Flash",
        "IPTC:Caption", "Make",      "DateTime"};
    for (const char* name : kept) image.specmod().attribute(name, "2");
    image.specmod().attribute("smpte:TimeCode", 3);
    const ImageBuf pictures[] = {
        reproject(image, options({{"size", "8"}})),
        mesh_warp(image, options({{"mesh", "grid.json"}})),
        morph(image, image, options({{"features", "lines.csv"}})),
        drape(image, options({{"surface", "cylinder"}})),
    };
    for (const ImageBuf& picture : pictures) {
        ASSERT_FALSE(picture.has_error()) << picture.geterror();
        for (const OIIO::ParamValue& a : image.spec().extra_attribs) {
            const std::string name = a.name().string();
            const bool holds = a.get_string() == "2" || a.get_string() == "3";
            EXPECT_EQ(picture.spec().find_attribute(name) != nullptr, holds) << name;
        }
    }
}

/// What a stored image shows, from the table of the TIFF specification: the sides on which its first row and
/// its first column lie.
ImageBuf shown(const ImageBuf& stored, int orientation) {
    const char* const sides[] = {"top left", "top right", "bottom right", "bottom left",
                                 "left top", "right top", "right bottom", "left bottom"};
    const std::string row = std::string(sides[orientation - 1])
                                .substr(0, std::string(sides[orientation - 1]).find(' ')),
                      column = std::string(sides[orientation - 1]).substr(row.size() + 1);
    const int w = stored.spec().width, h = stored.spec().height;
    const bool rows_stay = row == "top" || row == "bottom";
    ImageBuf upright(
        ImageSpec(rows_stay ? w : h, rows_stay ? h : w, stored.nchannels(), stored.spec().format));
    std::vector<float> pixel(static_cast<std::size_t>(stored.nchannels()));
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            stored.getpixel(x, y, pixel.data());
            const int from_row = row == "top" || row == "left" ? y : h - 1 - y;
            const int from_column = column == "top" || column == "left" ? x : w - 1 - x;
            upright.setpixel(rows_stay ? from_column : from_row, rows_stay ? from_row : from_column,
                             pixel.data());
        }
    return upright;
}

/// A stored image of each orientation, and what it shows.
class Orientations : public Metadata, public testing::WithParamInterface<int> {
  protected:
    void SetUp() override {
        Metadata::SetUp();
        ImageBuf stored = panorama(70, 44, OIIO::TypeUInt16, 3);
        stored.specmod().attribute("Orientation", GetParam());
        stored.set_write_tiles(16, 16);
        write_image(stored, "stored.tif");
        ImageBuf upright = shown(stored, GetParam());
        upright.specmod().attribute("Orientation", 1);
        upright.set_write_tiles(16, 16);
        write_image(upright, "upright.tif");
        ASSERT_EQ(spec_of("stored.tif").get_int_attribute("Orientation"), GetParam());
    }
};
INSTANTIATE_TEST_SUITE_P(Exif, Orientations, testing::Range(1, 9));

TEST_P(Orientations, SourcesAreReadUpright) {
    const char* const recipes[] = {".pano?from=rectilinear&fov=70&yaw=8",
                                   ".pano?from=fisheye&srcfov=120",
                                   ".warp?mesh=grid.json",
                                   ".warp?mesh=grid.json&mip=1&tile=16",
                                   ".morph?b=upright.tif&features=lines.csv",

                                   ".warp?mesh=grid.json&output=stmap"};
    for (const std::string recipe : recipes) {
        SCOPED_TRACE(recipe);
        EXPECT_TRUE(read_pixels("stored.tif" + recipe) == read_pixels("upright.tif" + recipe));
        EXPECT_EQ(spec_of("stored.tif" + recipe).get_int_attribute("Orientation", 1), 1);
    }
    EXPECT_TRUE(read_pixels("upright.tif.morph?b=stored.tif&features=lines.csv") ==
                read_pixels("upright.tif.morph?b=upright.tif&features=lines.csv"));
    for (const bool cached : {false, true}) {
        const auto cache = OIIO::ImageCache::create(true);
        ImageBuf stored("stored.tif", 0, 0, cached ? cache : nullptr),
            upright("upright.tif", 0, 0, cached ? cache : nullptr);
        ASSERT_TRUE(stored.read(0, 0, !cached));
        ASSERT_TRUE(upright.read(0, 0, !cached));
        const auto o = options({{"from", "rectilinear"}, {"yaw", "10"}});
        EXPECT_EQ(bytes(reproject(stored, o)), bytes(reproject(upright, o)));
        for (ImageBuf* image : {&stored, &upright}) image->specmod().attribute("oiio:ColorSpace", "sRGB");
        const auto w = options({{"mesh", "grid.json"}, {"colorspace", "linear"}});
        EXPECT_EQ(bytes(mesh_warp(stored, w)), bytes(mesh_warp(upright, w)));
        EXPECT_EQ(mesh_warp(stored, w).spec().get_int_attribute("Orientation"), 1);
        const auto d = options({{"surface", "page_turn"}, {"direction", "20"}, {"camera", "0.1,0.2,2"}});
        EXPECT_EQ(bytes(drape(stored, d)), bytes(drape(upright, d)));
    }
}

/// What a surface's positions are is asked of all that they show, and of no more.
TEST_F(Metadata, PositionsAndHeightsAreThoseOfTheDisplayWindow) {
    write_panorama("heights.exr", 60, 40);
    ASSERT_EQ(
        run("oiiotool heights.exr --crop 20x12+4+5 -o part.exr heights.exr --fullsize 20x12+4+5 -o more.exr "
            "heights.exr --cut 20x12+4+5 -o cut.exr")
            .status,
        0);
    const std::string drape = "city.exr.drape?camera=0.1,0.2,2&";
    for (const std::string key : {"height=", "positions="}) {
        const std::string surface = key[0] == 'p' ? drape + "surface=positions&" + key : drape + key;
        EXPECT_THAT(open_error(surface + "part.exr"), HasSubstr("\"part.exr\" has pixels in a part")) << key;
        EXPECT_TRUE(read_pixels(surface + "more.exr") == read_pixels(surface + "cut.exr")) << key;
        EXPECT_FALSE(read_pixels(surface + "more.exr") == read_pixels(surface + "heights.exr")) << key;
    }
}

TEST_F(Metadata, WindowsThatLieTooFarApartAreRefused) {
    ImageSpec spec(8, 8, 3, OIIO::TypeFloat);
    spec.x = 1 << 28;
    spec.full_width = spec.full_height = 64;
    ImageBuf far(spec);
    OIIO::ImageBufAlgo::zero(far);
    const std::string reason = "a data window of 8x8 pixels at 268435456,0: must lie within 1048576 pixels";
    EXPECT_THAT(mesh_warp(far, options({{"mesh", "grid.json"}})).geterror(), HasSubstr(reason));
    write_image(far, "far.exr");
    EXPECT_THAT(open_error("far.exr.warp?mesh=grid.json"), HasSubstr(reason));
    EXPECT_THAT(open_error("city.exr.warp?mesh=far.exr"), HasSubstr(reason));
}

TEST_P(Orientations, SoAreDataWindowsAndStMaps) {
    ImageBuf stored = panorama(70, 44);
    stored.specmod().attribute("Orientation", GetParam());
    ImageBuf part = OIIO::ImageBufAlgo::crop(stored, OIIO::ROI(12, 50, 5, 30));
    ImageBuf padded(ImageSpec(70, 44, 3, OIIO::TypeFloat));
    ASSERT_TRUE(OIIO::ImageBufAlgo::paste(padded, 0, 0, 0, 0, part));
    padded.specmod().attribute("Orientation", GetParam());
    const auto w = options({{"mesh", "grid.json"}});
    EXPECT_EQ(bytes(mesh_warp(part, w)), bytes(mesh_warp(shown(padded, GetParam()), w)));
    // An ST-map stored turned.
    ASSERT_EQ(run("oiiotool 'city.exr.warp?mesh=grid.json&output=stmap&size=20x30' -o st.exr").status, 0);
    ImageBuf map("st.exr"), turned;
    ASSERT_TRUE(map.read(0, 0, true));
    // Turned so that the orientation takes it back: 6 and 8 are each other's, the others their own.
    turned = shown(map, GetParam() == 6 ? 8 : GetParam() == 8 ? 6 : GetParam());
    turned.specmod().attribute("Orientation", GetParam());
    write_image(turned, "turned.exr");
    ASSERT_EQ(spec_of("turned.exr").get_int_attribute("Orientation", 1), GetParam());
    EXPECT_TRUE(read_pixels("city.exr.warp?mesh=turned.exr") == read_pixels("city.exr.warp?mesh=st.exr"));
}

TEST_F(Metadata, ATurnedSourceIsReadByTiles) {
    ImageBuf stored = panorama(1024, 1024, OIIO::TypeUInt8);
    stored.specmod().attribute("Orientation", 6);
    stored.set_write_tiles(64, 64);
    write_image(stored, "stored.tif");
    const auto cache = OIIO::ImageCache::create(true);
    const std::string name = "stored.tif.warp?mesh=grid.json&tile=64";
    std::vector<float> pixels(64 * 64 * 3);
    ASSERT_TRUE(
        cache->get_pixels(OIIO::ustring(name), 0, 0, 64, 128, 640, 704, 0, 1, OIIO::TypeFloat, pixels.data()))
        << cache->geterror();
    long long tiles = -1;
    ASSERT_TRUE(cache->get_image_info(OIIO::ustring("stored.tif"), 0, 0, OIIO::ustring("stat:tilesread"),
                                      OIIO::TypeDesc::INT64, &tiles));
    EXPECT_GT(tiles, 0);
    EXPECT_LE(tiles, 9) << "of 256";
}

TEST_F(Metadata, APanoramaSaysThatItIsOne) {
    const ImageSpec latlong = spec_of("city.exr.pano?to=equirectangular&size=64x32&yaw=30");
    EXPECT_EQ(latlong.get_string_attribute("GPano:ProjectionType"), "equirectangular");
    EXPECT_EQ(latlong.get_int_attribute("GPano:FullPanoWidthPixels"), 64);
    EXPECT_EQ(latlong.get_int_attribute("GPano:FullPanoHeightPixels"), 32);
    EXPECT_EQ(latlong.get_int_attribute("GPano:CroppedAreaTopPixels", -1), 0);
    EXPECT_EQ(latlong.get_string_attribute("textureformat"), "LatLong Environment");
    EXPECT_EQ(latlong.get_string_attribute("oiio:updirection"), "y");
    const ImageSpec cube = spec_of("city.exr.pano?to=cubemap&size=16");
    EXPECT_EQ(cube.get_string_attribute("textureformat"), "CubeFace Environment");
    EXPECT_EQ(cube.get_string_attribute("oiio:updirection"), "y");
    EXPECT_FALSE(cube.find_attribute("GPano:ProjectionType"));
    // Half of the height: the rest is cropped. A part of the turn is no environment.
    const ImageSpec band = spec_of("city.exr.pano?to=equirectangular&size=64x16");
    EXPECT_EQ(band.get_int_attribute("GPano:FullPanoHeightPixels"), 32);
    EXPECT_EQ(band.get_int_attribute("GPano:CroppedAreaTopPixels"), 8);
    EXPECT_FALSE(band.find_attribute("textureformat"));
    for (const char* no :
         {"to=equirectangular&fov=90&size=64x32", "to=equirectangular&size=64x64", "to=cubemap3x2&size=48x32",
          "to=rectilinear&size=64x32", "to=equirectangular&size=64x32&output=stmap"}) {
        const ImageSpec spec = spec_of(std::string("city.exr.pano?") + no);
        EXPECT_FALSE(spec.find_attribute("GPano:ProjectionType")) << no;
        EXPECT_FALSE(spec.find_attribute("textureformat")) << no;
        EXPECT_TRUE(spec.find_attribute("panoramaProjection")) << no;
    }
    // A warp of it is none any more.
    const ImageSpec warped = spec_of("x.warp?mesh=grid.json&src=city.exr.pano?to=equirectangular&size=64x32");
    for (const char* name : {"GPano:ProjectionType", "textureformat", "panoramaProjection", "anamorph:from"})
        EXPECT_FALSE(warped.find_attribute(name)) << name;
}

TEST_F(Metadata, ARecipeKnowsWhatItReads) {
    for (const std::string view :
         {"to=equirectangular&size=64x32", "to=equirectangular&size=64x16",
          "to=equirectangular&size=60x60&fov=90", "to=cylindrical&size=64x30",
          "to=rectilinear&size=50x40&fov=110", "to=rectilinear&size=50x40&lens=brown:k1=-0.05,d=2",
          "to=fisheye&size=40x40&fov=200", "to=equisolid&size=64x32", "to=stereographic&size=40x40&fov=250",
          "to=mercator&size=60x40", "to=cubemap&size=16x96", "to=cubemap3x2&size=48x32",
          "to=cubecross&size=64x48"}) {
        SCOPED_TRACE(view);
        const std::string recipe = "city.exr.pano?" + view;
        const std::size_t end = view.find('&'), fov = std::min(view.find("fov="), view.find("lens="));
        const std::string to = view.substr(3, end - 3),
                          degrees = fov == std::string::npos ? "" : "&src" + view.substr(fov);
        const std::string chained = "v.pano?yaw=20&size=30x30&src=" + recipe,
                          told = "v.pano?yaw=20&size=30x30&from=" + to + degrees + "&src=" + recipe;
        EXPECT_TRUE(read_pixels(chained) == read_pixels(told));
        EXPECT_EQ(spec_of(chained).get_string_attribute("anamorph:from"),
                  to + " (as panoramaProjection says)");
        // Also by way of a file, as a picture that is drawn first is.
        ASSERT_EQ(run("oiiotool '" + recipe + "' -o view.exr").status, 0);
        const std::string drawn = "v.pano?concatenate=0&" + told.substr(told.find('?') + 1);
        EXPECT_TRUE(read_pixels("view.exr.pano?yaw=20&size=30x30") == read_pixels(drawn));
    }
    EXPECT_THAT(open_error("v.pano?src=city.exr.warp?mesh=grid.json&size=30x30"),
                HasSubstr("from is not given"));
}

TEST_F(Metadata, WhatWasAssumedIsSaid) {
    const auto from = [](const std::string& name) {
        return spec_of(name).get_string_attribute("anamorph:from");
    };
    EXPECT_EQ(from("city.exr.pano?size=8"), "equirectangular (assumed from the 2:1 shape)");
    EXPECT_EQ(from("city.exr.pano?size=8&from=fisheye"), "fisheye (given)");
    write_panorama("strip.exr", 8, 48);
    EXPECT_EQ(from("strip.exr.pano?size=8"), "cubemap (assumed from the 1:6 shape)");
    ImageBuf image = panorama(64, 32);
    image.specmod().attribute("GPano:ProjectionType", "fisheye");
    write_image(image, "fish.exr");
    EXPECT_EQ(from("fish.exr.pano?size=8"), "fisheye (as GPano:ProjectionType says)");
    write_panorama("square.exr", 32, 32);
    EXPECT_THAT(open_error("square.exr.pano?size=8"), HasSubstr("from is not given"));
    // One face that was cut out of a cube map says no longer that it is one.
    ASSERT_EQ(run("oiiotool 'city.exr.pano?to=cubemap&size=16x96' --cut 16x16+0+16 -o face.exr").status, 0);
    EXPECT_THAT(open_error("face.exr.pano?size=8"), HasSubstr("from is not given and the source (16x16)"));
    EXPECT_EQ(from("face.exr.pano?size=8&from=rectilinear&srcfov=90"), "rectilinear (given)");
    ImageBuf dst(ImageSpec(8, 8, 3, OIIO::TypeFloat));
    ASSERT_TRUE(reproject(dst, panorama(64, 32))) << dst.geterror();
    EXPECT_EQ(dst.spec().get_string_attribute("anamorph:from"),
              "equirectangular (assumed from the 2:1 shape)");
}

/// 2 atan(w / 2 f) in degrees.
std::string flat_fov(double pixels, double focal_length) {
    return OIIO::Strutil::fmt::format(
        "{:.6g}", 2 * std::atan(pixels / 2 / focal_length) * 180 / 3.14159265358979323846);
}

/// The attributes of a camera, all integers or floats.
void take_photo(const std::string& name, int width, int height,
                const std::vector<std::pair<const char*, float>>& exif, int orientation = 1) {
    ImageBuf image = panorama(width, height, OIIO::TypeUInt8);
    for (const auto& [key, value] : exif) {
        const bool whole = std::string(key).find("Unit") != std::string::npos ||
                           std::string(key).find("Dimension") != std::string::npos ||
                           std::string(key).find("35mm") != std::string::npos;
        if (whole)
            image.specmod().attribute(key, static_cast<int>(value));
        else
            image.specmod().attribute(key, value);
    }
    image.specmod().attribute("Orientation", orientation);
    write_image(image, name);
}

TEST_F(Metadata, FocalLengthsAreWholeNumbersTooAndThoseOfNoLensAreNot) {
    const auto from = [](const auto& value, const char* name = "Exif:FocalLengthIn35mmFilm", int unit = 2) {
        ImageBuf image = panorama(60, 40, OIIO::TypeHalf);
        image.specmod().attribute(name, value);
        image.specmod().attribute("Exif:FocalPlaneXResolution", 100.0f);
        image.specmod().attribute("Exif:FocalPlaneResolutionUnit", unit);
        write_image(image, "photo.exr");
        return std::string(
            spec_of("photo.exr.pano?from=rectilinear&size=8").get_string_attribute("anamorph:from"));
    };
    // EXR keeps the type.
    EXPECT_THAT(from(28), HasSubstr("as Exif:FocalLengthIn35mmFilm=28 says"));
    EXPECT_THAT(from(28.0f), HasSubstr("as Exif:FocalLengthIn35mmFilm=28 says"));
    EXPECT_THAT(from(50, "Exif:FocalLength"), HasSubstr("as Exif:FocalLength=50 says"));
    for (const float none : {1e-30f, 1e30f, -28.0f, NAN, HUGE_VALF})
        EXPECT_THAT(from(none), HasSubstr("90 degrees assumed")) << none;
    // Pixels for no unit, or for one that Exif does not know.
    for (const int unit : {1, 99})
        EXPECT_THAT(from(50, "Exif:FocalLength", unit), HasSubstr("90 degrees assumed")) << unit;
}

TEST_F(Metadata, FocalLengthsOfExifAreTaken) {
    const double film = std::hypot(36, 24);
    struct Case {
        std::vector<std::pair<const char*, float>> exif;
        int width, height, orientation;
        double focal_length;  ///< pixels; 0: none
        std::string by;
    };
    const Case cases[] = {
        {{{"Exif:FocalLengthIn35mmFilm", 28}, {"Exif:FocalLength", 4.2f}},
         60,
         40,
         1,
         28 * std::hypot(60, 40) / film,
         "Exif:FocalLengthIn35mmFilm=28"},
        // Held upright: stored lying, as wide as the shorter side.
        {{{"Exif:FocalLengthIn35mmFilm", 28}},
         60,
         40,
         6,
         28 * std::hypot(60, 40) / film,
         "Exif:FocalLengthIn35mmFilm=28"},
        // In centimetres, and made smaller by 100 since.
        {{{"Exif:FocalLength", 35},
          {"Exif:FocalPlaneXResolution", 2000},
          {"Exif:FocalPlaneResolutionUnit", 3},
          {"Exif:PixelXDimension", 6000},
          {"Exif:PixelYDimension", 4000}},
         60,
         40,
         1,
         35 * 200 / 100.0,
         "Exif:FocalLength=35"},
        // In inches, which they are by default.
        {{{"Exif:FocalLength", 50}, {"Exif:FocalPlaneXResolution", 100}},
         64,
         32,
         1,
         50 * 100 / 25.4,
         "Exif:FocalLength=50"},
        {{{"Exif:FocalLength", 50}}, 64, 32, 1, 0, ""},
        {{{"Exif:FocalLengthIn35mmFilm", 0}, {"Exif:FocalLength", 0}, {"Exif:FocalPlaneXResolution", 9}},
         64,
         32,
         1,
         0,
         ""},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.by + " " + std::to_string(c.width));
        take_photo("photo.jpg", c.width, c.height, c.exif, c.orientation);
        const int across = c.orientation == 6 ? c.height : c.width;
        const std::string fov = c.focal_length > 0 ? flat_fov(across, c.focal_length) : "90";
        const std::string why = c.focal_length > 0 ? "as " + c.by + " says" : "assumed";
        const std::string view = "photo.jpg.pano?to=fisheye&fov=120&size=40x30&from=";
        EXPECT_EQ(spec_of(view + "rectilinear").get_string_attribute("anamorph:from"),
                  "rectilinear (given, " + fov + " degrees " + why + ")");
        EXPECT_LE(largest_difference(read_floats(view + "rectilinear"),
                                     read_floats(view + "rectilinear&srcfov=" + fov)),
                  1.01 / 255);
        // What is asked for comes first; other projections are no business of a focal length.
        EXPECT_EQ(spec_of(view + "rectilinear&srcfov=50").get_string_attribute("anamorph:from"),
                  "rectilinear (given)");
        EXPECT_EQ(spec_of(view + "fisheye").get_string_attribute("anamorph:from"), "fisheye (given)");
        // Of a lens too.
        const std::string lens = "photo.jpg.lens?lens=brown:k1=-0.1";
        if (c.focal_length == 0) {
            EXPECT_THAT(open_error(lens), HasSubstr("fov is not given"));
            continue;
        }
        EXPECT_EQ(spec_of(lens).get_string_attribute("anamorph:fov"), fov + " degrees " + why);
        EXPECT_LE(largest_difference(read_floats(lens), read_floats(lens + "&fov=" + fov)), 1.01 / 255);
        EXPECT_FALSE(spec_of(lens + "&fov=50").find_attribute("anamorph:fov"));
        EXPECT_THAT(open_error("photo.jpg.lens?lens=kb4:k1=0.1"), HasSubstr("fov is not given"));
    }
}

TEST_F(Metadata, WhatWasReachedIsWrittenToFiles) {
    // By a stock program, into a format that keeps any attribute.
    for (const Operation* operation : operations()) {
        const std::string recipe = example(*operation, {"city.exr", "city.exr"});
        SCOPED_TRACE(recipe);
        const Ran ran = run("oiiotool '" + recipe + "' -o y.exr && iinfo -v y.exr");
        ASSERT_EQ(ran.status, 0) << ran.text;
        const ImageSpec picture = spec_of(recipe), written = spec_of("y.exr");
        for (const char* name : {"anamorph:tol", "anamorph:max_error", "anamorph:exact_fraction"}) {
            EXPECT_GE(picture.get_float_attribute(name, -1), 0) << name;
            EXPECT_EQ(written.get_float_attribute(name, -1), picture.get_float_attribute(name, -2)) << name;
            EXPECT_THAT(ran.text, HasSubstr(name));
        }
    }
}

TEST_F(Metadata, ToleranceIsSaidWhereOneIsHeld) {
    const auto says = [](const std::string& name) {
        return spec_of(name).find_attribute("anamorph:tol") != nullptr;
    };
    for (const char* held : {"city.exr.pano?size=16", "city.exr.lens?lens=brown:k1=-0.1&fov=60&size=16",
                             "city.exr.drape?size=16", "city.exr.drape?size=16&scheme=exact"})
        EXPECT_TRUE(says(held)) << held;
    EXPECT_FALSE(says("city.exr.pano?size=16&scheme=hardware"));
    for (const char* none : {"city.exr.drape?size=16&scheme=hardware", "city.exr.drape?size=16&scheme=oka",
                             "city.exr.drape?size=16&scheme=oka-z"}) {
        EXPECT_FALSE(says(none)) << none;
        EXPECT_GE(spec_of(none + std::string("&reached=1")).get_float_attribute("anamorph:max_error", -1), 0)
            << none;
    }
}

TEST_F(Metadata, WhatTakesDrawingIsSaidOnRequest) {
    const ImageBuf city("city.exr");
    const std::string keys = "surface=sphere&size=40";
    for (const std::string scheme : {"oka", "oka-z", "hardware", "exact"}) {
        const std::string name = "city.exr.drape?" + keys + "&scheme=" + scheme;
        const ImageSpec opened = spec_of(name), asked = spec_of(name + "&reached=1");
        EXPECT_EQ(opened.find_attribute("anamorph:max_error"), nullptr) << scheme;
        EXPECT_EQ(opened.get_string_attribute("anamorph:not_computed"), "max_error: reached=1 computes it");
        EXPECT_EQ(asked.find_attribute("anamorph:not_computed"), nullptr) << scheme;
        // The same numbers as the function says, which draws all of it.
        const ImageBuf drawn = apply(
            "drape", {&city}, options({{"surface", "sphere"}, {"size", "40"}, {"scheme", scheme.c_str()}}));
        for (const char* number : {"anamorph:max_error", "anamorph:exact_fraction"}) {
            EXPECT_GE(asked.get_float_attribute(number, -1), 0) << scheme;
            EXPECT_EQ(asked.get_float_attribute(number, -1), drawn.spec().get_float_attribute(number, -2))
                << scheme;
        }
        EXPECT_GT(opened.get_int_attribute("anamorph:patches", -1), 0) << scheme;
        EXPECT_EQ(opened.get_int_attribute("anamorph:patches", -1),
                  asked.get_int_attribute("anamorph:patches", -2));
        EXPECT_EQ(read_pixels(name).bytes, read_pixels(name + "&reached=1").bytes) << scheme;
    }
    EXPECT_EQ(spec_of("city.exr.drape?" + keys).find_attribute("anamorph:not_computed"), nullptr);
    EXPECT_THAT(open_error("city.exr.drape?reached=2"), HasSubstr("reached=2: must be 0 or 1"));
}

TEST_F(Metadata, MachinesSayTheirErrorOnRequest) {
    const ImageBuf city("city.exr");
    write_text("machine.json", R"({"columns": 1, "rows": 1, "units": "fractions",
        "vertices": [[0, 0], [1, 0.1], [0.1, 1], [0.9, 0.9]]})");
    write_text("machine_lines.json", R"({"sizes": [[40, 40], [40, 40]],
        "features": [{"line": [[10, 10, 30, 12], [12, 14, 28, 10]]}]})");
    struct Case {
        std::string operation, keys, known;
        std::vector<const ImageBuf*> sources;
        OIIO::ParamValueList options;
    };
    const Case cases[] = {
        {"pano",
         "from=cylindrical&fov=60&size=40&machine=embm-2003:size=0",
         "anamorph:saturated_texels",
         {&city},
         options({{"from", "cylindrical"}, {"fov", "60"}, {"size", "40"}, {"machine", "embm-2003:size=0"}})},
        {"warp", "mesh=machine.json", "", {&city}, options({{"mesh", "machine.json"}})},
        {"morph",
         "b=city.exr&features=machine_lines.json",
         "anamorph:evaluations",
         {&city, &city},
         options({{"features", "machine_lines.json"}})},
    };
    for (Case one : cases) {
        const std::string name = "city.exr." + one.operation + "?scheme=hardware&" + one.keys;
        const ImageSpec opened = spec_of(name), asked = spec_of(name + "&reached=1");
        EXPECT_EQ(opened.find_attribute("anamorph:max_error"), nullptr) << name;
        EXPECT_EQ(opened.get_string_attribute("anamorph:not_computed"), "max_error: reached=1 computes it")
            << name;
        EXPECT_EQ(asked.find_attribute("anamorph:not_computed"), nullptr) << name;
        one.options.attribute("scheme", "hardware");
        const ImageBuf drawn = apply(one.operation, one.sources, one.options);
        for (const char* number :
             {"anamorph:max_error", "anamorph:exact_fraction", "anamorph:saturated_pixels"}) {
            EXPECT_GE(asked.get_float_attribute(number, -1), 0) << name;
            EXPECT_EQ(asked.get_float_attribute(number, -1), drawn.spec().get_float_attribute(number, -2))
                << name;
        }
        // What is counted before anything is drawn is always said.
        if (!one.known.empty()) {
            const OIIO::ParamValue *before = opened.find_attribute(one.known),
                                   *after = asked.find_attribute(one.known);
            ASSERT_TRUE(before && after) << name;
            EXPECT_EQ(before->get_string(), after->get_string()) << name;
        }
        EXPECT_EQ(spec_of("city.exr." + one.operation + "?" + one.keys.substr(0, one.keys.find("&machine")))
                      .find_attribute("anamorph:not_computed"),
                  nullptr)
            << name;
    }
}

TEST_F(Metadata, FramesOfFilmsSayWhatTheyReachedOnRequest) {
    const std::string film = "city.exr.morph?b=city.exr&features=machine_lines.json&size=20&frames=3";
    write_text("machine_lines.json", R"({"sizes": [[40, 40], [40, 40]],
        "features": [{"line": [[10, 10, 30, 12], [12, 14, 28, 10]]}]})");
    const ImageSpec opened = spec_of(film), asked = spec_of(film + "&reached=1");
    EXPECT_EQ(opened.find_attribute("anamorph:max_error"), nullptr);
    EXPECT_EQ(opened.get_string_attribute("anamorph:not_computed"), "max_error: reached=1 computes it");
    EXPECT_GE(asked.get_float_attribute("anamorph:max_error", -1), 0);
    EXPECT_EQ(asked.find_attribute("anamorph:not_computed"), nullptr);
}

TEST_F(Metadata, DepthsSayHowFarTheyAreOff) {
    const auto off = [](const std::string& keys) {
        return spec_of("city.exr.drape?surface=waves&size=40&output=depth" + keys)
            .get_float_attribute("anamorph:max_depth_error", -1);
    };
    EXPECT_GT(off(""), 0);
    EXPECT_LT(off("&tol=0.01"), off(""));
    EXPECT_EQ(off("&scheme=oka-z"), -1);
    EXPECT_EQ(spec_of("city.exr.drape?surface=waves&size=40").find_attribute("anamorph:max_depth_error"),
              nullptr);
}

TEST_F(Metadata, AFormulaSaysHowMuchOfThePictureHasNoPoint) {
    const auto fraction = [](const std::string& u) {
        return spec_of("city.exr.map?size=64&u=" + u).get_float_attribute("anamorph:undefined_fraction", -1);
    };
    EXPECT_EQ(fraction("x"), 0);
    EXPECT_EQ(fraction("x+1000"), 0) << "beyond the source is no matter of the formula";
    EXPECT_EQ(fraction("if(s<0.25,1/0,x)"), 0.25f);
    EXPECT_EQ(fraction("sqrt(-x)"), 1);
}

TEST_F(Metadata, StockProgramsKnowAnEnvironment) {
    // maketx keeps what the picture says; OpenEXR's own attribute comes back as a texture's format.
    write_text("sky.pano", "src=city.exr\nto=equirectangular\nsize=64x32\nyaw=10\n");
    ASSERT_EQ(run("maketx --envlatl sky.pano -o sky.exr").status, 0);
    EXPECT_EQ(spec_of("sky.exr").get_string_attribute("textureformat"), "LatLong Environment");
    EXPECT_EQ(spec_of("sky.exr.pano?size=8").get_string_attribute("anamorph:from").substr(0, 15),
              "equirectangular");
    const Ran info = run("iinfo -v sky.pano");
    EXPECT_THAT(info.text, AllOf(HasSubstr("GPano:ProjectionType: \"equirectangular\""),
                                 HasSubstr("textureformat: \"LatLong Environment\"")));
}

}  // namespace
}  // namespace anamorph::test_metadata
