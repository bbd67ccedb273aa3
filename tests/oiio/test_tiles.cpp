// SPDX-License-Identifier: Apache-2.0
// What is handed out in tiles, and to which programs in scanlines: those that write what they read as it came keep the source's habit.
#include "host.h"

namespace anamorph::test_tiles {
namespace {

using namespace testing_oiio;

class Tiles : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("rows.exr", 300, 150, OIIO::TypeHalf, 3, 0);
        write_panorama("tiled.exr", 300, 150, OIIO::TypeHalf, 3, 64);
        write_text("ball.nudes", "figure f 1 e\nellipsoid e 200 300 100\nstop\n");
    }
    /// The tiles of what a program makes of a recipe.
    static int written_by(const std::string& program, const std::string& recipe) {
        const Ran ran = run(program == "oiiotool" ? "oiiotool '" + recipe + "' -o out.exr"
                                                  : program + " '" + recipe + "' out.exr");
        EXPECT_EQ(ran.status, 0) << ran.text;
        return open("out.exr")->spec().tile_width;
    }
};

TEST_F(Tiles, ProgramsThatWriteKeepTheSourcesHabit) {
    const std::string lens = ".lens?lens=3de4:k1=0.1";
    for (const std::string program : {"oiiotool", "iconvert"}) {
        SCOPED_TRACE(program);
        EXPECT_EQ(written_by(program, "rows.exr" + lens), 0);
        EXPECT_EQ(read_pixels("out.exr"), read_pixels("rows.exr" + lens));
        EXPECT_EQ(written_by(program, "tiled.exr" + lens), 256);
        EXPECT_EQ(read_pixels("out.exr"), read_pixels("rows.exr" + lens));
        EXPECT_EQ(written_by(program, "rows.exr" + lens + "&tile=64"), 64);
        EXPECT_EQ(written_by(program, "tiled.exr" + lens + "&tile=0"), 0);
        // Chains go by the file that they begin with, joined or drawn first.
        EXPECT_EQ(written_by(program, "v.map?u=x&v=y&src=(rows.exr" + lens + ")"), 0);
        EXPECT_EQ(written_by(program, "v.map?u=x&v=y&concatenate=0&src=(rows.exr" + lens + ")"), 0);
        EXPECT_EQ(read_pixels("out.exr"),
                  read_pixels("v.map?u=x&v=y&concatenate=0&src=(rows.exr" + lens + ")"));
        EXPECT_EQ(written_by(program, "v.map?u=x&v=y&src=(tiled.exr" + lens + ")"), 256);
        EXPECT_EQ(written_by(program, "ball.nudes?frame=0&size=300"), 0);
    }
    // A part, and MIP levels, which have tiles.
    ASSERT_EQ(run("oiiotool 'rows.exr" + lens + "' --cut 40x30+200+70 -o cut.exr").status, 0);
    const Pixels cut = read_pixels("cut.exr"), whole = read_pixels("rows.exr" + lens);
    for (int y = 0; y < 30; ++y)
        ASSERT_TRUE(std::equal(cut.bytes.begin() + y * 40 * 6, cut.bytes.begin() + (y + 1) * 40 * 6,
                               whole.bytes.begin() + ((y + 70) * 300 + 200) * 6))
            << y;
    EXPECT_EQ(written_by("iconvert", "rows.exr.pano?from=latlong&to=latlong&mip=1"), 256);
}

TEST_F(Tiles, OthersReadAsFarAsTheyNeed) {
    for (const std::string source : {"rows.exr", "tiled.exr"}) {
        EXPECT_EQ(open(source + ".lens?lens=3de4:k1=0.1")->spec().tile_width, 256);
        EXPECT_EQ(open(source + ".lens?lens=3de4:k1=0.1&tile=0")->spec().tile_width, 0);
    }
    EXPECT_EQ(open("ball.nudes?frame=0")->spec().tile_width, 256);
}

}  // namespace
}  // namespace anamorph::test_tiles
