// SPDX-License-Identifier: Apache-2.0
// Lenses by their names: where they put pixels, held against Lensfun's own correction; what is found and what is not.
#include "anamorph/lens_database.h"

#include <OpenImageIO/imagebufalgo.h>

#include <cmath>
#include <map>
#include <memory>

#include "anamorph/metadata.h"
#include "anamorph/oiio_ops.h"
#include "host.h"
#ifdef ANAMORPH_LENSFUN
#include <lensfun/lensfun.h>
#endif

namespace anamorph::test_lens_database {
namespace {

using namespace testing_oiio;
using testing::AllOf;
using testing::HasSubstr;

OIIO::ImageSpec photo(const Size& size) {
    OIIO::ImageSpec spec(size.width, size.height, 3, OIIO::TypeFloat);
    return spec;
}

/// What .lens or .pano makes of a text, for a source with this header.
struct Found {
    std::string lens;  ///< the model as text
    std::string says;
    SourceFacts facts;
};
Found found(const std::string& operation, const std::string& parameter, const std::string& text,
            const OIIO::ImageSpec& spec) {
    const Operation& op = *find_operation(operation);
    ParameterValues values(*op.parameters);
    values.assign({{parameter, text}});
    std::vector<SourceImage> sources = {source_image(spec)};
    const Attributes says = find_lenses(op, values, {spec}, sources);
    Found result{values.text(parameter), "", sources[0].facts};
    for (const Attribute& attribute : says) {
        EXPECT_EQ(attribute.name, "anamorph:" + parameter);
        result.says = std::get<std::string>(attribute.value);
    }
    return result;
}
std::string refusal(const std::string& text, const OIIO::ImageSpec& spec,
                    const std::string& operation = "lens", const std::string& parameter = "lens") {
    try {
        static_cast<void>(found(operation, parameter, text, spec));
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(LensDatabase, LeavesOtherLensesAlone) {
    for (const char* text : {"ptlens:b=0.1", "none", "lensfunny:a=1"})
        EXPECT_EQ(found("lens", "lens", text, photo({60, 40})).lens, text);
}

TEST(LensDatabase, RefusesWhatItCannotRead) {
    const OIIO::ImageSpec spec = photo({600, 400});
    const auto expect = [&](const std::string& text, const std::string& why) {
        EXPECT_THAT(refusal(text, spec), AllOf(HasSubstr("lens=" + text.substr(0, 7)), HasSubstr(why)))
            << text;
    };
    for (const char* text : {"lensfun:", "lensfun:x", "lensfun:a=1", "lensfun:,lens=x", "lensfun:LENS=x"})
        if (std::string(text) != "lensfun:")
            expect(text, "must be followed by lens=, camera=, focal= and crop=");
    expect("lensfun:lens=", "lens must not be empty");
    expect("lensfun:lens=a,lens=b", "lens must be given once");
    for (const char* text : {"lensfun:focal=0", "lensfun:focal=-3", "lensfun:focal=nan", "lensfun:focal=inf",
                             "lensfun:focal=1e9", "lensfun:focal=35mm", "lensfun:crop=1x"})
        expect(text, " must be a number from 0.01 to 100000");
}

#ifdef ANAMORPH_LENSFUN

TEST(LensDatabase, SaysWhatIsNear) {
    const OIIO::ImageSpec spec = photo({600, 400});
    const auto expect = [&](const std::string& text, const std::string& why) {
        EXPECT_THAT(refusal(text, spec), HasSubstr(why)) << text;
    };
    expect("lensfun", "the camera is not said: must be given, as in lensfun:camera=NAME");
    expect("lensfun:crop=1,focal=35", "the lens is not said");
    expect("lensfun:camera=Canon EOS 5D Mark III,focal=35", "the lens is not said");
    expect("lensfun:camera=Canon EOS 5D Mark XIX,lens=Canon EF 24-70mm f/2.8L II USM,focal=35",
           "camera Canon EOS 5D Mark XIX is not in Lensfun's database: near are Canon EOS 5D Mark");
    expect("lensfun:camera=Canon EOS 5D Mark III,lens=Canon EF 24-71mm f/2.8L II USM,focal=35",
           "is not in Lensfun's database for Canon EOS 5D Mark III: ");
    expect("lensfun:crop=1,focal=35,lens=Zyzzyva",
           "lens Zyzzyva is not in Lensfun's database: there is none like it");
    expect("lensfun:crop=1,lens=Canon EF 24-70mm f/2.8L II USM", "the focal length is not said");
    expect("lensfun:crop=1,lens=Canon EF 24-70mm f/2.8L II USM,focal=105",
           "focal 105 must be 24 to 70 mm for Canon EF 24-70mm f/2.8L II USM");
    // For a sensor larger than that of its calibration a lens is none.
    expect("lensfun:crop=0.3,lens=Canon EF 24-70mm f/2.8L II USM,focal=35", "is not in Lensfun's database");
    EXPECT_THAT(refusal("lensfun:crop=1,lens=Canon EF 24-70mm f/2.8L II USM,focal=35", spec, "pano", "lens"),
                HasSubstr("must be given together with the picture's width and height"));
}

/// The database, once more.
const lfDatabase& database() {
    static lfDatabase* const loaded = [] {
        lfDatabase* all = new lfDatabase;
        EXPECT_EQ(all->Load(), LF_NO_ERROR);
        return all;
    }();
    return *loaded;
}

/// Where Lensfun reads pixels of the picture without distortion, in its own single precision.
class Reference {
  public:
    Reference(const lfLens& lens, double crop, double focal, const Size& size)
        : m_modifier(std::make_unique<lfModifier>(&lens, static_cast<float>(crop), size.width, size.height)) {
        m_modifier->Initialize(&lens, LF_PF_F32, static_cast<float>(focal), 8, 1000, 1, lens.Type,
                               LF_MODIFY_DISTORTION, false);
    }
    /// Not a number where there is no distortion at all.
    Point<double> source(double x, double y) const {
        float xy[2];
        if (!m_modifier->ApplyGeometryDistortion(static_cast<float>(x - 0.5), static_cast<float>(y - 0.5), 1,
                                                 1, xy))
            return {NAN, NAN};
        return {xy[0] + 0.5, xy[1] + 0.5};
    }

  private:
    std::unique_ptr<lfModifier> m_modifier;
};

/// Lensfun's numbers are floats: of coordinates up to `far` pixels, each of its few operations is off by 2^-24 of that.
double tolerance_at(double far) {
    return 24 * std::ldexp(far, -24) + 2e-4;
}

const lfLens* lens_named(const std::string& name, double crop) {
    for (const lfLens* const* lens = database().GetLenses(); *lens; ++lens)
        if ((*lens)->Model == name && std::fabs((*lens)->CropFactor - crop) < 1e-3) return *lens;
    ADD_FAILURE() << name << " is not in the database";
    return nullptr;
}

struct Case {
    const char *lens, *camera;
    double calibrated, crop, focal;  ///< crop factors of the calibration and of the camera
    Size size;
};
const Case kCases[] = {
    // ptlens, at a focal length that was measured and between two; on a smaller sensor; upright.
    {"Canon EF 24-70mm f/2.8L II USM", "Canon EOS 5D Mark III", 1, 0, 24, {600, 400}},
    {"Canon EF 24-70mm f/2.8L II USM", "Canon EOS 5D Mark III", 1, 0, 29, {400, 600}},
    {"Canon EF 24-70mm f/2.8L II USM", "", 1, 1.6, 50, {640, 360}},
    // poly3
    {"Olympus Zuiko Digital ED 9-18mm f/4.0-5.6", "", 2, 2, 9, {640, 480}},
    {"Olympus Zuiko Digital ED 9-18mm f/4.0-5.6", "", 2, 2, 12.5, {640, 427}},
    {"Sigma 19mm f/2.8 DN", "", 2, 2.1, 19, {480, 640}},
    {"Schneider 80mm Xenotar f/2.8", "", 0.51, 0.51, 80, {500, 500}},
    // poly5, of the only lens that has it
    {"Canon PowerShot G12 & compatibles (Standard)", "", 4.63, 4.63, 6.1, {640, 480}},
    {"Canon PowerShot G12 & compatibles (Standard)", "", 4.63, 4.7, 10, {640, 480}},
    // fisheyes, whose lengths are real ones, too
    {"Nikon AF DX Fisheye-Nikkor 10.5mm f/2.8G ED", "", 1.523, 1.523, 10.5, {640, 425}},
    {"Olympus M.Zuiko Digital ED 8mm f/1.8 Fisheye Pro", "", 2, 2, 8, {640, 480}},
};

std::string text_of(const Case& c) {
    std::string text = std::string("lensfun:lens=") + c.lens + ",focal=" + shortest(c.focal);
    if (*c.camera) text += std::string(",camera=") + c.camera;
    if (c.crop > 0) text += ",crop=" + shortest(c.crop);
    return text;
}

TEST(LensDatabase, DrawsWhereLensfunDoes) {
    for (const Case& c : kCases) {
        SCOPED_TRACE(text_of(c) + " of " + std::to_string(c.size.width) + "x" +
                     std::to_string(c.size.height));
        const lfLens* lens = lens_named(c.lens, c.calibrated);
        ASSERT_TRUE(lens);
        double crop = c.crop;
        if (*c.camera) {
            const lfCamera** cameras = database().FindCamerasExt(nullptr, c.camera);
            ASSERT_TRUE(cameras && cameras[0]);
            crop = cameras[0]->CropFactor;
            lf_free(cameras);
        }
        const Reference reference(*lens, crop, c.focal, c.size);
        OIIO::ImageBuf source(photo(c.size)), map;
        OIIO::ImageBufAlgo::zero(source);
        ASSERT_TRUE(apply(map, "lens", {&source},
                          options({{"lens", text_of(c).c_str()}, {"output", "stmap"}, {"tol", "1e-5"}})))
            << map.geterror();
        EXPECT_THAT(std::string(map.spec().get_string_attribute("anamorph:lens")), HasSubstr("(Lensfun)"));
        double worst = 0;
        int seen = 0;
        for (int y = 0; y < c.size.height; y += 7)
            for (int x = 0; x < c.size.width; x += 7) {
                float uv[2];
                map.getpixel(x, y, uv, 2);
                if (uv[0] == -1 && uv[1] == -1) continue;
                const Point<double> p = reference.source(x + 0.5, y + 0.5);
                ASSERT_FALSE(std::isnan(p.x));
                worst = std::max(worst, std::hypot(uv[0] * c.size.width - p.x, uv[1] * c.size.height - p.y));
                ++seen;
            }
        EXPECT_LT(worst, tolerance_at(700));
        EXPECT_GT(seen, c.size.width * c.size.height / 49 / 2);
    }
}

/// Every lens of the database that has a name of its own, at one of the focal lengths at which it was measured.
TEST(LensDatabase, PutsPixelsOfEveryLensWhereLensfunDoes) {
    std::map<std::string, int> names;
    for (const lfLens* const* at = database().GetLenses(); *at; ++at) ++names[(*at)->Model];
    int lenses = 0, compared = 0, models[4] = {};
    const Size size{900, 600};
    for (const lfLens* const* at = database().GetLenses(); *at; ++at) {
        const lfLens& lens = **at;
        const std::string name = lens.Model;
        if (!lens.CalibDistortion || names[name] > 1) continue;
        ++lenses;
        int count = 0;
        while (lens.CalibDistortion[count]) ++count;
        const double focal = lens.CalibDistortion[lenses % count]->Focal;
        const std::string text =
            "lensfun:lens=" + name + ",crop=" + shortest(lens.CropFactor) + ",focal=" + shortest(focal);
        Found result;
        try {
            result = found("lens", "lens", text, photo(size));
        } catch (const Error&) {
            continue;  // several have these words
        }
        if (result.says.find(name) == std::string::npos) continue;
        lfLensCalibDistortion distortion;
        ASSERT_TRUE(lens.InterpolateDistortion(static_cast<float>(focal), distortion));
        const Chart chart(Projection::rectilinear, size.width, size.height, 60, PixelSpacing::edges, "", 1,
                          LensModel::parse(result.lens));
        const Reference reference(lens, lens.CropFactor, focal, size);
        const LensModel& model = chart.lens()->model();
        const double scale = chart.scale_x(), d = model.values[5], e = model.values[6];
        for (const auto& [x, y] :
             {std::pair{450.0, 300.0}, {453.0, 296.0}, {700.5, 130.25}, {60.0, 580.0}, {880.0, 20.0}}) {
            const Point<double> p = reference.source(x, y);
            // Of a picture whose axis stays where it is.
            const Point<double> ideal{(x - 450 - d) / scale, (y - 300 - e) / scale};
            if (!(chart.lens()->sees(ideal) > 0) || std::isnan(p.x)) continue;
            const Point<double> q = chart.lens()->observed(ideal);
            EXPECT_LT(std::hypot(q.x * scale + 450 - p.x, q.y * scale + 300 - p.y), tolerance_at(1000))
                << text << " is " << result.says << " " << result.lens;
        }
        ++compared;
        ++models[distortion.Model];
    }
    RecordProperty("lenses", lenses);
    RecordProperty("compared", compared);
    EXPECT_GT(compared, 0.8 * lenses);
    EXPECT_GT(models[LF_DIST_MODEL_POLY3], 100);
    EXPECT_GT(models[LF_DIST_MODEL_PTLENS], 400);
}

TEST(LensDatabase, KnowsAPhotosLensByItsMetadata) {
    OIIO::ImageSpec spec = photo({600, 400});
    spec.attribute("Make", "Canon");
    spec.attribute("Model", "Canon EOS 7D");
    spec.attribute("Exif:LensModel", "EF24-70mm f/2.8L II USM");
    spec.attribute("Exif:FocalLength", 35.0f);
    const Found by_metadata = found("pano", "srclens", "lensfun", spec);
    const Found by_name =
        found("pano", "srclens", "lensfun:lens=Canon EF 24-70mm f/2.8L II USM,camera=Canon EOS 7D,focal=35",
              photo({600, 400}));
    EXPECT_EQ(by_metadata.lens, by_name.lens);
    EXPECT_THAT(by_metadata.says, HasSubstr("Canon EF 24-70mm f/2.8L II USM, 35 mm, crop factor 1.6"));
    // A rectilinear lens of 35 mm, nominally, on a sensor whose diagonal is that of a film over the crop factor.
    EXPECT_EQ(by_name.facts.projection, Projection::rectilinear);
    EXPECT_EQ(by_name.facts.said_by, "Lensfun");
    const lfCamera** cameras = database().FindCamerasExt("Canon", "Canon EOS 7D");
    const double crop = cameras[0]->CropFactor;
    lf_free(cameras);
    const double width = std::hypot(36, 24) / crop * 3 / std::sqrt(13.0);
    EXPECT_NEAR(*by_name.facts.fov, 2 * std::atan(width / 2 / 35) * 180 / M_PI, 1e-6);
    // What the text says counts more than the metadata.
    EXPECT_THAT(found("pano", "srclens", "lensfun:focal=70", spec).says, HasSubstr(", 70 mm"));
}

TEST(LensDatabase, KnowsRealFocalLengthsAndFisheyes) {
    const Found fisheye =
        found("pano", "srclens", "lensfun:lens=Nikon AF DX Fisheye-Nikkor 10.5mm f/2.8G ED,crop=1.523",
              photo({600, 400}));
    EXPECT_EQ(fisheye.facts.projection, Projection::equisolid);
    // 10.31 mm in the middle, where the lens magnifies by 1 - a - b - c; the width is 4 f sin(fov / 4).
    const double f = 10.31 / (1 - 0.03347 + 0.0964 - 0.08113),
                 width = std::hypot(36, 24) / double{1.523f} * 3 / std::sqrt(13.0);
    EXPECT_NEAR(*fisheye.facts.fov, 4 * std::asin(width / 4 / f) * 180 / M_PI, 1e-4);
    // A source that says what it is is that.
    OIIO::ImageSpec spec = photo({600, 400});
    spec.attribute("panoramaProjection", "fisheye fov=120");
    const Found said =
        found("pano", "srclens", "lensfun:lens=Nikon AF DX Fisheye-Nikkor 10.5mm f/2.8G ED,crop=1.523", spec);
    EXPECT_EQ(said.facts.projection, Projection::fisheye);
    EXPECT_EQ(said.facts.fov, 120);
}

TEST(LensDatabase, ACameraWithOneLensHasIt) {
    EXPECT_THAT(found("lens", "lens", "lensfun:camera=Canon PowerShot G12,focal=6.1", photo({640, 480})).says,
                HasSubstr("G12"));
}

/// Recipes and functions are one.
class LensDatabaseRecipe : public InFolder {};

TEST_F(LensDatabaseRecipe, IsThatOfTheFunction) {
    OIIO::ImageBuf source(photo({300, 200}));
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 300; ++x) {
            const float value[] = {float(x), float(y), float((x * 7 + y * 13) % 11)};
            source.setpixel(x, y, value);
        }
    write_image(source, "photo.exr");
    const std::string lens = "lensfun:lens=Canon EF 24-70mm f/2.8L II USM,crop=1,focal=24";
    OIIO::ImageBuf drawn;
    ASSERT_TRUE(apply(drawn, "lens", {&source}, options({{"lens", lens.c_str()}}))) << drawn.geterror();
    std::vector<float> expected(300 * 200 * 3);
    drawn.get_pixels(OIIO::ROI(), OIIO::TypeFloat, expected.data());
    EXPECT_EQ(largest_difference(read_floats("photo.exr.lens?lens=" + lens), expected), 0);
    const Ran ran = run("oiiotool -v --info 'photo.exr.lens?lens=" + lens + "'");
    EXPECT_THAT(
        ran.text,
        HasSubstr("anamorph:lens: \"Canon EF 24-70mm f/2.8L II USM, 24 mm, crop factor 1 (Lensfun)\""));
    const Ran pano = run("oiiotool -v --info 'photo.exr.pano?fov=60&srclens=" + lens + "'");
    EXPECT_THAT(pano.text, AllOf(HasSubstr("anamorph:srclens: \"Canon EF 24-70mm"),
                                 HasSubstr("rectilinear (as Lensfun says)")));
    const Ran none = run("oiiotool -v --info 'photo.exr.lens?lens=lensfun:crop=1,lens=nothing like it'");
    EXPECT_THAT(none.text, HasSubstr("is not in Lensfun's database"));
}

#else

TEST(LensDatabase, IsRefusedWhereItIsNotBuiltIn) {
    EXPECT_THAT(refusal("lensfun:lens=a,crop=1,focal=35", photo({60, 40})),
                HasSubstr("was built without Lensfun"));
}

#endif

}  // namespace
}  // namespace anamorph::test_lens_database
