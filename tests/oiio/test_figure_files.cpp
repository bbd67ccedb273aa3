// SPDX-License-Identifier: Apache-2.0
// Files that are figures by their ending alone, .n, .nudes, .bvh, .cif and .mrasel, by the list of what a plugin
// has to conform to; and what lies behind figures, from files.
#include <algorithm>
#include <filesystem>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_figure_files {
namespace {

using namespace testing_oiio;
using testing::HasSubstr;

struct FigureFile {
    const char *name, *text;
    int frames;
};

constexpr const char* kDoll =
    "figure f 1 e\nellipsoid e 200 300 100\nrepeat 0 1 moveto f e 500 500 500\nlinear 0 3 spinby f e e 60 "
    "z\nstop\n";
const FigureFile kFiles[] = {
    {"doll.n", kDoll, 3},
    {"doll.nudes", kDoll, 3},
    {"arm.bvh",
     "HIERARCHY ROOT arm { OFFSET 0 0 0 CHANNELS 1 Zrotation JOINT hand { OFFSET 10 0 0 CHANNELS 1 "
     "Zrotation\n"
     "End Site { OFFSET 5 0 0 } } } MOTION Frames: 2 Frame Time: 0.04\n0 0\n30 40\n",
     2},
    {"pair.cif",
     "data_x\n_cell_length_a 5\n_cell_length_b 5\n_cell_length_c 5\n_cell_angle_alpha 90\n_cell_angle_beta "
     "90\n"
     "_cell_angle_gamma 90\nloop_\n_symmetry_equiv_pos_as_xyz\nx,y,z\n-x,-y,-z\nloop_\n_atom_site_label\n"
     "_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\nC1 .1 .1 .2\n",
     1},
    {"in.mrasel", "1 0 2\n255 0 0 90\n511 0 50 150\n150 100 100 2560 2560 0 0 0 300 city.exr\n", 1},
};

class FigureFiles : public InFolder, public testing::WithParamInterface<FigureFile> {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        OIIO::ImageCache::create(true)->invalidate_all(true);
        write_text(file(), GetParam().text);
        write_panorama("city.exr", 96, 48);
    }
    static std::string file() { return GetParam().name; }
    static std::string name() { return file() + "?size=96x72"; }
};

TEST_P(FigureFiles, OpenCloseAndReopen) {
    const auto input = open(name());
    ASSERT_TRUE(input);
    for (int i = 0; i < GetParam().frames; ++i) EXPECT_TRUE(input->seek_subimage(i, 0)) << i;
    EXPECT_FALSE(input->seek_subimage(GetParam().frames, 0));
    EXPECT_FALSE(input->seek_subimage(0, 1));
    EXPECT_FALSE(input->seek_subimage(-1, 0));
    EXPECT_TRUE(input->seek_subimage(0, 0));
    EXPECT_TRUE(input->close());
    EXPECT_TRUE(input->close());
    OIIO::ImageSpec spec, config;
    EXPECT_TRUE(input->open(name(), spec));
    EXPECT_EQ(spec.width, 96);
    EXPECT_EQ(spec.height, 72);
    config.attribute("figure:size", "96x72");
    OIIO::ImageSpec configured;
    EXPECT_TRUE(input->open(file(), configured, config));
    EXPECT_EQ(configured.width, 96);
    EXPECT_THAT(open_error(file() + "?sise=96"), HasSubstr("sise"));
    EXPECT_THAT(open_error(file() + "?size=nan"), HasSubstr("size"));
    EXPECT_THAT(open_error(file() + "?frame=1000"), HasSubstr("frame"));
}

TEST_P(FigureFiles, EndingsInCapitals) {
    std::string capitals = file();
    std::transform(capitals.begin() + static_cast<std::ptrdiff_t>(capitals.find('.')), capitals.end(),
                   capitals.begin() + static_cast<std::ptrdiff_t>(capitals.find('.')),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    write_text(capitals, GetParam().text);
    EXPECT_EQ(read_pixels(capitals + "?size=96x72"), read_pixels(name()));
    // A folder, and a link.
    std::filesystem::create_directory("sub dir");
    write_text("sub dir/" + file(), GetParam().text);
    EXPECT_EQ(read_pixels("sub dir/" + file() + "?size=96x72"), read_pixels(name()));
    std::filesystem::create_symlink(std::filesystem::absolute(file()), "sub dir/link." + file());
    EXPECT_EQ(read_pixels("sub dir/link." + file() + "?size=96x72"), read_pixels(name()));
}

TEST_P(FigureFiles, OnePictureInAnyTilesThreadsAndCuts) {
    expect_one_picture(name() + "&style=textured&filter=summed_area&backdrop=city.exr", 20, 10);
}

TEST_P(FigureFiles, FilesCutOffOrNonsenseAreErrors) {
    const std::string text = GetParam().text;
    for (std::size_t size = 0; size < text.size(); size += 3) {
        write_text(file(), text.substr(0, size));
        const auto input = OIIO::ImageInput::open(name());
        EXPECT_EQ(!input, OIIO::has_error()) << size;
        static_cast<void>(OIIO::geterror());
    }
    std::string junk(3000, '\0');
    for (std::size_t i = 0; i < junk.size(); ++i) junk[i] = static_cast<char>(i * 97 % 251);
    for (const std::string& wrong : {std::string(), std::string("\0\0\0", 3), junk, "\xef\xbb\xbf" + junk}) {
        write_text(file(), wrong);
        const auto input = OIIO::ImageInput::open(name());
        EXPECT_EQ(!input, OIIO::has_error());
        static_cast<void>(OIIO::geterror());
    }
    std::filesystem::remove(file());
    EXPECT_EQ(run("oiiotool '" + name() + "' -o out.png").status, 1);
}

INSTANTIATE_TEST_SUITE_P(Endings, FigureFiles, testing::ValuesIn(kFiles), [](const auto& file) {
    return std::string(file.param.name).substr(std::string(file.param.name).find('.') + 1);
});

class FigureBackgrounds : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        OIIO::ImageCache::create(true)->invalidate_all(true);
        write_text("dressed.n",
                   "figure f 1 e\nellipsoid e 200 300 100\nrepeat 0 1 moveto f e 500 500 500\n"
                   "repeat 0 1 texture e city.exr 0 0\nrepeat 0 1 texture e none 0 0\nstop\n");
    }
};

TEST_F(FigureBackgrounds, ABackdropIsSeenBehindFigures) {
    write_panorama("city.exr", 96, 96);
    const std::vector<float> city = read_floats("city.exr");
    const std::vector<float> drawn = read_floats("dressed.n?size=96&backdrop=city.exr");
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(drawn[c], city[c], 1e-6);
    EXPECT_EQ(drawn[3], 1);
    // The function draws the same, a change is seen, and one that is not there is named.
    OIIO::ImageCache::create(true)->invalidate_all(true);
    EXPECT_EQ(bytes(apply("figure", {},
                          options({{"script", "dressed.n"}, {"size", "96"}, {"backdrop", "city.exr"}}))),
              read_pixels("dressed.n?size=96&backdrop=city.exr").bytes);
    write_panorama("city.exr", 48, 48);
    EXPECT_NE(read_floats("dressed.n?size=96&backdrop=city.exr"), drawn);
    std::filesystem::remove("city.exr");
    const Pixels missing = read_pixels("dressed.n?size=96&backdrop=city.exr");
    EXPECT_EQ(missing.spec.get_string_attribute("anamorph:missing_textures"), "backdrop");
}

TEST_F(FigureBackgrounds, BumpsThatAreNotThereAreAnError) {
    write_text("torn.png", "\x89PNG");
    for (const std::string file : {"nothing.exr", "torn.png"})
        EXPECT_THAT(open_error("dressed.n?size=96&bump=" + file),
                    HasSubstr("anamorph: bump=" + file + ": must be an image that can be opened"));
}

TEST_F(FigureBackgrounds, MipsAreAPictureForEachTexture) {
    write_panorama("city.exr", 64, 32);
    const Ran ran = run("oiiotool 'dressed.n?output=mips' --subimage 0 -o mips.exr");
    ASSERT_EQ(ran.status, 0) << ran.text;
    const Pixels mips = read_pixels("mips.exr");
    EXPECT_EQ(mips.spec.width, 128);
    EXPECT_EQ(mips.spec.height, 64);
    EXPECT_EQ(mips.spec.nchannels, 1);
    const std::vector<float> city = read_floats("city.exr"), layout = read_floats("dressed.n?output=mips");
    for (std::size_t y = 0; y < 32; ++y)
        for (std::size_t x = 0; x < 64; ++x) {
            EXPECT_EQ(layout[y * 128 + 64 + x], city[(y * 64 + x) * 3]);
            EXPECT_EQ(layout[(y + 32) * 128 + x], city[(y * 64 + x) * 3 + 1]);
            EXPECT_EQ(layout[(y + 32) * 128 + 64 + x], city[(y * 64 + x) * 3 + 2]);
        }
    const auto input = open("dressed.n?output=mips");
    ASSERT_TRUE(input->seek_subimage(1, 0));
    EXPECT_EQ(input->spec().width, 2);
    EXPECT_EQ(input->spec().get_string_attribute("anamorph:missing_textures"), "none");
}

}  // namespace
}  // namespace anamorph::test_figure_files
