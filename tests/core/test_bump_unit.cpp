// SPDX-License-Identifier: Apache-2.0
// The bump unit: the errors that Kim 2003, section 4.6, published, and how they depend on the bump map.
#include "anamorph/machine/bump_unit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "anamorph/error.h"
#include "anamorph/machine/machine_text.h"
#include "anamorph/operation/pano.h"

namespace anamorph::test_bump_unit {
using namespace machine;
namespace {

constexpr int kScreen = 512;

/// A cylinder of 360 degrees and 2 tan 45 degrees high, up to 3e-7 of that, seen level with 90 degrees.
Panorama published_view() {
    return Panorama(Chart(Projection::cylindrical, 355, 113),
                    Chart(Projection::rectilinear, kScreen, kScreen, 90));
}

/// The same from the formulas of section 4.2, written out another way.
Point<double> exact_coordinates(int i, int j) {
    const double x = (2 * i + 1.0) / kScreen - 1, y = (2 * j + 1.0) / kScreen - 1;
    const double radius = std::hypot(1.0, x);
    return {0.5 + std::asin(x / radius) / (2 * std::numbers::pi), 0.5 + 0.5 * y / radius};
}

struct Errors {
    double mean, max;
};

/// Distances (eq. 4.6) in texture coordinates, before or after they are read back.
Errors errors_of(const BumpUnit& unit, bool read_back) {
    const BumpedPanorama drawn(published_view(), unit);
    const ReadBack back;
    double sum = 0, most = 0;
    for (int j = 0; j < kScreen; ++j)
        for (int i = 0; i < kScreen; ++i) {
            const UnitCoordinates used = drawn.at((i + 0.5) / kScreen, (j + 0.5) / kScreen);
            const Point<double> exact = exact_coordinates(i, j), at = read_back ? back(used.at) : used.at;
            const double error = std::hypot(at.x - exact.x, at.y - exact.y);
            EXPECT_FALSE(used.beyond);
            sum += error;
            most = std::max(most, error);
        }
    return {sum / (kScreen * kScreen), most};
}

/// Section 4.6: 256 x 256, 16 bits, 90 degrees, 512 x 512, read back by G16R16: 8.66e-6 and 9.9e-4.
TEST(BumpUnit, PublishedErrorsComeOut) {
    const Errors bumped = errors_of(BumpUnit{}, true);
    EXPECT_GE(bumped.mean, 5e-6);
    EXPECT_LE(bumped.mean, 1.3e-5);
    EXPECT_GE(bumped.max, 8e-4);
    EXPECT_LE(bumped.max, 1.2e-3);
    BumpUnit linear;
    linear.size = 0;
    const Errors without = errors_of(linear, true);
    EXPECT_NEAR(without.mean, 0.023, 0.0005);
    EXPECT_NEAR(without.max, 0.074, 0.001);
}

/// Where the published maximum comes from: it is that of reading back at the texture's upper and lower edge, half a texel
/// of 256. Before, it is half of that, of the bump map's edge; with a border of one texel it is a hundredth of it.
TEST(BumpUnit, ABorderOfOneTexelTakesTheMaximumAway) {
    BumpUnit unit;
    const Errors clamped = errors_of(unit, false);
    unit.edge = BumpUnit::Edge::border;
    const Errors bordered = errors_of(unit, false);
    EXPECT_GT(errors_of(unit, true).max, 8e-4);
    EXPECT_LT(clamped.max, 6e-4);
    EXPECT_GT(clamped.max, 1e-4);
    EXPECT_LT(bordered.max, clamped.max / 20);
}

/// Texels of float: the error is that of linear interpolation, which falls by four when the size doubles, and no more
/// than h^2 / 8 (|f_ss| + |f_tt|) of the residuals' derivatives. Beyond 256 nothing of it is seen through the read-back.
TEST(BumpUnit, BilinearErrorFallsWithTheSquareOfTheSize) {
    BumpUnit unit;
    unit.texel = kFloat32;
    unit.weight_bits = 23;
    unit.edge = BumpUnit::Edge::border;
    double last = 0;
    for (const int size : {34, 66, 130, 258}) {
        unit.size = size;
        const Errors errors = errors_of(unit, false);
        // By x': theta'' = -x' / (pi (1 + x'^2)^2), at most .104; v'' = y' (2 x'^2 - 1) / (2 (1 + x'^2)^(5/2)), at most .5.
        const double h = 2.0 / (size - 2);
        EXPECT_LE(errors.max, h * h / 8 * std::hypot(0.104, 0.5) + 1e-6) << size;
        if (last > 0) {
            EXPECT_NEAR(last / errors.mean, 4, 0.5) << size;
        }
        last = errors.mean;
    }
    BumpUnit small, large;
    large.size = 1024;
    EXPECT_LT(errors_of(small, true).mean, 1.25 * errors_of(large, true).mean);
    small.size = 32;
    EXPECT_GT(errors_of(small, true).mean, 4 * errors_of(large, true).mean);
}

/// Eight bits serve when they are scaled (4.4.3), and are steps of 2^-7 of texture coordinates when they are not.
TEST(BumpUnit, FewBitsNeedScaling) {
    BumpUnit unit;
    unit.edge = BumpUnit::Edge::border;
    const double sixteen = errors_of(unit, false).mean;
    unit.texel = kSigned8;
    const double scaled = errors_of(unit, false).mean;
    unit.scaled = false;
    const double plain = errors_of(unit, false).mean;
    EXPECT_GT(plain, 2e-4);
    EXPECT_LT(plain, std::ldexp(1, -7));
    EXPECT_LT(scaled, plain / 4);
    EXPECT_LT(sixteen, scaled / 4);
}

TEST(BumpUnit, PrecisionOfArithmeticIsSeen) {
    BumpUnit unit;
    unit.edge = BumpUnit::Edge::border;
    double last = 0;
    for (const NumberFormat& format : {kFloat32, kFloat24, kFloat16}) {
        unit.arithmetic = format;
        const double mean = errors_of(unit, false).mean;
        EXPECT_GT(mean, last) << name_of(format);
        last = mean;
    }
    EXPECT_GT(last, 5e-5);
    EXPECT_LT(last, std::ldexp(1, -10));
}

/// Every pixel's distance from the exact point is within the bound of its block.
TEST(BumpUnit, BoundsHoldAndThePictureSaysWhatWasReached) {
    const Panorama map(Chart(Projection::equirectangular, 400, 200),
                       Chart(Projection::rectilinear, 100, 80, 70), {170, 20, 5});
    BumpUnit unit;
    unit.size = 16;
    const BumpedPanorama bumped(map, unit);
    const Reached reached = bumped.reached(serial_for);
    EXPECT_EQ(reached.exact_fraction, 0);
    EXPECT_GT(reached.max_error, 0.001);
    EXPECT_LT(reached.max_error, 3);
    double most = 0;
    for (const Block& block : bumped.blocks(0)) {
        std::vector<double> x(80), y(80);
        std::vector<std::int32_t> piece(80);
        for (int row = 0; row < block.box.height(); ++row) {
            bumped.exact_rows(block, row, row + 1, {x.data(), y.data(), piece.data(), 80});
            for (int i = 0; i < block.box.width(); ++i) {
                Point<DoubleDouble> exact{};
                int source_piece = 0;
                ASSERT_TRUE(map.exact<DoubleDouble>(block.box.x0 + i + 0.5, block.box.y0 + row + 0.5, 0,
                                                    exact, source_piece));
                // The view is across the seam.
                const auto k = static_cast<std::size_t>(i);
                const double across = std::remainder(x[k] - double(exact.x), 400.0);
                const double off = std::hypot(across, y[k] - double(exact.y));
                EXPECT_LE(off, block.bound);
                most = std::max(most, off);
            }
        }
    }
    EXPECT_NEAR(most, reached.max_error, 1e-6);
}

/// Rounding is known of small boxes only about the seam: bounds are of the size of errors all the same.
TEST(BumpUnit, BoundsAreTightAboutSeams) {
    const Panorama map(Chart(Projection::equirectangular, 256, 128),
                       Chart(Projection::rectilinear, 96, 64, 90), {180, 10, 0});
    const BumpedPanorama bumped(map, BumpUnit{});
    EXPECT_LT(bumped.reached(serial_for).max_error, 0.1);
}

TEST(BumpUnit, SaturationIsCounted) {
    // Eye coordinates beyond 8 are those of 2 atan 8 = 165.75 degrees: of 64 columns that are 11.43 / 32 apart, 5 on each side.
    const Panorama map(Chart(Projection::cylindrical, 400, 200), Chart(Projection::rectilinear, 64, 16, 170));
    BumpUnit unit;
    unit.projecting = BumpUnit::Projecting::pixel;
    EXPECT_EQ(BumpedPanorama(map, unit).saturated_pixels(serial_for), 0);
    unit.arithmetic = kFixed16;
    int columns = 0;
    for (int i = 0; i < 64; ++i)
        columns += std::fabs((i + 0.5) / 32 - 1) * std::tan(85 * std::numbers::pi / 180) >= 8;
    EXPECT_EQ(columns, 20);
    EXPECT_EQ(BumpedPanorama(map, unit).saturated_pixels(serial_for), 16 * columns);
    EXPECT_EQ(BumpedPanorama(published_view(), unit).saturated_pixels(serial_for), 0);
    // Residuals of more than the texture that are not scaled do not fit texels up to 1.
    ProjectionPlane plane = projection_planes(published_view()).front();
    plane.right = 3;
    unit.scaled = false;
    unit.size = 32;
    // |x'| is (2 i + 1) / 32 - 1: its 3 and the azimuth's sixth are beyond 1 where it is above .35.
    EXPECT_EQ(BumpStage(published_view().source(), published_view().target(), plane, unit).saturated_texels(),
              32 * 20);
}

/// The attributes of a picture that the operation pano makes of a source of 400 x 200.
std::map<std::string, double> reached_by(const std::vector<Assignment>& more) {
    struct NoFiles final : SideFileReader {
        std::string text(const std::string& name) const override { throw Error("there is no file " + name); }
        std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
            throw Error("there is no image " + name);
        }
    };
    const Operation& pano = *find_operation("pano");
    ParameterValues values(*pano.parameters);
    values.assign({{"from", "equirectangular"}, {"size", "64x48"}, {"fov", "80"}, {"scheme", "hardware"}});
    values.assign(more);
    SourceImage source;
    source.facts.width = 400;
    source.facts.height = 200;
    const NoFiles files;
    const auto solved = pano.read({values, {source}, {}, files})->picture(0, 0)->solve();
    EXPECT_EQ(solved->reached_by_drawing(), values.text("scheme") == "hardware");
    std::map<std::string, double> numbers;
    for (const Attribute& a : solved->reached(serial_for))
        numbers[a.name] =
            std::holds_alternative<int>(a.value) ? std::get<int>(a.value) : std::get<double>(a.value);
    return numbers;
}

TEST(BumpUnit, IsASchemeOfPanoramas) {
    auto standard = reached_by({}), preset = reached_by({{"machine", "embm-2003"}});
    EXPECT_EQ(standard, preset);
    EXPECT_GT(standard["anamorph:max_error"], 1e-3);
    EXPECT_LT(standard["anamorph:max_error"], 0.1);
    EXPECT_EQ(standard["anamorph:exact_fraction"], 0);
    EXPECT_EQ(standard["anamorph:saturated_pixels"], 0);
    EXPECT_GT(reached_by({{"machine", "{\"size\": 0}"}})["anamorph:max_error"], 3);
    auto wide = reached_by({{"fov", "170"},
                            {"size", "64x16"},
                            {"machine", "{\"arithmetic\": \"fixed16\", \"projecting\": \"pixel\"}"}});
    EXPECT_EQ(wide["anamorph:saturated_pixels"], 16 * 20);
    EXPECT_EQ(standard["anamorph:saturated_texels"], 0);
    EXPECT_THROW(reached_by({{"scheme", "exact"}, {"machine", "{\"size\": 0}"}}), Error);
    EXPECT_THROW(reached_by({{"machine", "new"}}), Error);
    for (const Assignment& other : {Assignment{"to", "fisheye"}, Assignment{"from", "fisheye"},
                                    Assignment{"lens", "brown:k1=-0.1"}, Assignment{"pitch", "89.99"}})
        EXPECT_THROW(reached_by({other}), Error) << other.key;
}

TEST(BumpUnit, RefusesSourcesThatAreTooLarge) {
    BumpUnit unit;
    unit.texture_side = 256;
    try {
        const BumpedPanorama bumped(
            Panorama(Chart(Projection::equirectangular, 512, 256), Chart(Projection::rectilinear, 8, 8, 90)),
            unit);
        FAIL();
    } catch (const Error& e) {
        EXPECT_STREQ(
            e.what(),
            "machine: a source of 512x256 does not fit its textures: must be at most 256 either way");
    }
}

TEST(MachineText, SaysWhatIsWrong) {
    const auto message = [](const char* text) -> std::string {
        try {
            bump_unit_from_text(text);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_EQ(message("embm-2003"), "");
    EXPECT_EQ(message("{}"), "");
    EXPECT_EQ(message("embm"),
              "machine=embm: must be embm-2003, embm-2003:key=value,key=value or an object of JSON, {...}");
    EXPECT_EQ(message(""),
              "machine=: must be embm-2003, embm-2003:key=value,key=value or an object of JSON, {...}");
    EXPECT_EQ(message("{\"size\": 4097}"), "machine: size=4097: must be an integer from 0 to 4096");
    EXPECT_EQ(message("{\"size\": 1.5}"), "machine: size=1.5: must be an integer from 0 to 4096");
    EXPECT_EQ(message("{\"size\": \"a\"}"), "machine: size=\"a\": must be an integer from 0 to 4096");
    EXPECT_EQ(message("{\"texel\": \"R8\"}"),
              "machine: texel=\"R8\": must be one of V16U16, V8U8, float16, float32");
    EXPECT_EQ(message("{\"scaled\": 1}"), "machine: scaled=1: must be true or false");
    EXPECT_NE(message("{\"sise\": 1}").find("\"sise\": no such key; the keys are card, projecting"),
              std::string::npos);
    EXPECT_NE(message("{").find("is no JSON"), std::string::npos);
    EXPECT_EQ(message("embm-2003:size=2,size=3"), "machine=size=3: must be key=value, each key once");
    EXPECT_EQ(message("embm-2003:size"), "machine=size: must be key=value, each key once");
    EXPECT_EQ(message("embm-2003:size=x"), "machine: size=\"x\": must be an integer from 0 to 4096");
    EXPECT_EQ(message("embm-2003:scaled=1"), "machine: scaled=1: must be true or false");
    EXPECT_EQ(message("embm-2003:texel=V8U8,scaled=false,size=64"), "");
    EXPECT_EQ(bump_unit_from_text("embm-2003:texel=V8U8,size=64").size, 64);
    EXPECT_EQ(bump_unit_from_text("embm-2003:texel=V8U8,size=64").texel, kSigned8);
    const BumpUnit unit = bump_unit_from_text(
        R"({"size": 64, "texel": "V8U8", "scaled": false, "weight_bits": 5, "edge": "border",
            "arithmetic": "fixed16", "address_bits": 4, "texture_side": 1024})");
    EXPECT_EQ(unit.size, 64);
    EXPECT_EQ(unit.texel, kSigned8);
    EXPECT_FALSE(unit.scaled);
    EXPECT_EQ(unit.weight_bits, 5);
    EXPECT_EQ(unit.edge, BumpUnit::Edge::border);
    EXPECT_EQ(unit.arithmetic, kFixed16);
    EXPECT_EQ(unit.address_bits, 4);
    EXPECT_EQ(unit.texture_side, 1024);
}

/// Cards do what section 4.4 says of them, and no more.
TEST(MachineText, CardsRefuseWhatTheyCannotDo) {
    const auto message = [](const std::string& keys) -> std::string {
        try {
            bump_unit_from_text("embm-2003:" + keys);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    };
    for (const std::string card : {"geforce3", "geforce4", "radeon"}) {
        EXPECT_EQ(bump_unit_from_text("embm-2003:card=" + card).texel, kSigned8);
        EXPECT_EQ(message("card=" + card + ",texel=V16U16"),
                  "machine: texel=V16U16: must be V8U8 with card=" + card);
        EXPECT_EQ(message("card=" + card + ",texel=V16U16,size=0"), "");
    }
    for (const std::string card : {"reference", "radeon8500", "radeon9700"}) {
        EXPECT_EQ(bump_unit_from_text("embm-2003:card=" + card).texel, kSigned16);
        EXPECT_EQ(message("card=" + card + ",texel=V8U8,projecting=pixel"), "");
        EXPECT_EQ(message("card=" + card + ",texel=float32"),
                  "machine: texel=float32: must be V8U8 or V16U16 with card=" + card);
    }
    EXPECT_EQ(message("card=geforce4,projecting=pixel"), "");
    for (const std::string card : {"geforce3", "radeon"})
        EXPECT_EQ(message("card=" + card + ",projecting=pixel"),
                  "machine: projecting=pixel: must be vertex with card=" + card +
                      ", which perturbs no coordinates that are projected per pixel");
    EXPECT_EQ(message("card=any,projecting=pixel,texel=float16"), "");
    EXPECT_EQ(message("card=voodoo"),
              "machine: card=\"voodoo\": must be one of any, geforce3, geforce4, radeon, radeon8500, "
              "radeon9700, reference");
    EXPECT_EQ(message("planes=17"), "machine: planes=17: must be an integer from 1 to 16");
    EXPECT_EQ(message("x_max=-1"), "machine: x_max=-1: must be a number from 0 to 1000");
    EXPECT_NE(message("y_max=nan").find("y_max=nan"), std::string::npos);
}

}  // namespace
}  // namespace anamorph::test_bump_unit
