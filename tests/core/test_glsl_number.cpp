// SPDX-License-Identifier: Apache-2.0
// What formulas write in GLSL. That shaders compute the same is tested where there is OpenGL (tests/vtk/projector).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "anamorph/chart/chart.h"
#include "anamorph/number/glsl_number.h"
#include "anamorph/projector/panorama_glsl.h"

namespace anamorph::test_glsl_number {
namespace {

using anamorph::GlslNumber;
using anamorph::GlslText;
using testing::HasSubstr;
using testing::Not;

TEST(GlslNumber, ConstantsAreComputedAndEqualLinesAreShared) {
    GlslText text;
    const GlslNumber x = text.input("x"), two = GlslNumber(1) + 1.0;
    EXPECT_TRUE(two.is(2));
    EXPECT_EQ((x * 1.0).written(), "x");
    EXPECT_EQ((x + 0.0).written(), "x");
    EXPECT_TRUE((x * 0.0).is(0));
    EXPECT_EQ((x * two).written(), "t0");
    EXPECT_EQ((x * 2.0).written(), "t0");
    EXPECT_EQ(text.lines(), "  float t0 = x * 2.0;\n");
}

TEST(GlslNumber, LiteralsAreFloats) {
    EXPECT_EQ(GlslNumber(0.1).written(), "0.1");
    EXPECT_EQ(GlslNumber(-3).written(), "(-3.0)");
    EXPECT_EQ(GlslNumber(1e300).written(), "3.4028235e+38");
    EXPECT_EQ(GlslNumber(1e-300).written(), "0.0");
}

TEST(GlslNumber, ChoicesAreConditionals) {
    GlslText text;
    const GlslNumber x = text.input("x");
    const anamorph::GlslCondition below = is_negative(x);
    EXPECT_EQ(select(below, GlslNumber(-x), x).written(), "t2");
    EXPECT_EQ(text.lines(), "  bool t0 = x < 0.0;\n  float t1 = -x;\n  float t2 = t0 ? t1 : x;\n");
    EXPECT_EQ(select(is_zero(GlslNumber(0)), x, GlslNumber(1)).written(), "x");
}

TEST(GlslNumber, JetsWriteDerivatives) {
    GlslText text;
    using Jet = anamorph::Jet1<GlslNumber>;
    const Jet x = Jet::variable(text.input("x"), 1, 0), y = Jet::variable(text.input("y"), 0, 1);
    const Jet product = x * y;
    EXPECT_EQ(product.c[1].written(), "y");
    EXPECT_EQ(product.c[2].written(), "x");
}

TEST(PanoramaGlsl, HasAFunctionForEveryPieceOfEveryProjection) {
    for (const anamorph::Projection projection : anamorph::kProjections) {
        const anamorph::FaceGrid grid = anamorph::faces_of(projection);
        const anamorph::Chart chart(projection, 64 * std::max(grid.columns, 1), 64 * std::max(grid.rows, 1));
        const std::string text = anamorph::panorama_glsl(chart, "thrown");
        for (std::size_t i = 0; i < chart.pieces().size(); ++i)
            EXPECT_THAT(text, HasSubstr("bool thrownPiece" + std::to_string(i) + "("));
        for (const char* wrong : {"nan", "inf"}) EXPECT_THAT(text, Not(HasSubstr(wrong)));
    }
}

}  // namespace
}  // namespace anamorph::test_glsl_number
