// SPDX-License-Identifier: Apache-2.0
// Stock programs as a user runs them: conformance items 1, 22, 25 to 28.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "host.h"

namespace anamorph::test_conformance_hosts {
namespace {

using namespace testing_oiio;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class Hosts : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("city.exr", 256, 128);
    }
};

void expect_same_images(const std::string& a, const std::string& b) {
    EXPECT_EQ(largest_difference(read_floats(a), read_floats(b)), 0) << a << " " << b;
}

TEST_F(Hosts, conformance_01_every_way_to_find_the_plugin) {
    const std::string folder = std::getenv("OIIO_LIBRARY_PATH");
    const std::string bare = "env -u OIIO_LIBRARY_PATH -u OPENIMAGEIO_OPTIONS ",
                      view = "'city.exr.pano?size=32'";
    EXPECT_EQ(run("oiiotool " + view + " -o 1.exr").status, 0);
    EXPECT_EQ(run(bare + "oiiotool " + view + " -o 0.exr").status, 1) << "found without being told where";
    const Ran two =
        run(bare + "oiiotool --oiioattrib plugin_searchpath " + folder + " " + view + " -o 2.exr");
    EXPECT_EQ(two.status, 0) << two.text;
    const Ran three =
        run(bare + "env OPENIMAGEIO_OPTIONS=plugin_searchpath=" + folder + " oiiotool " + view + " -o 3.exr");
    EXPECT_EQ(three.status, 0) << three.text;
    expect_same_images("1.exr", "2.exr");
    expect_same_images("1.exr", "3.exr");
}

TEST_F(Hosts, conformance_22_special_characters) {
    // Every character that oiiotool hands over unchanged.
    for (const char* name :
         {"a b.exr", "a,b.exr", "a:b.exr", "a;b.exr", "a=b.exr", "a(b).exr", "a[b].exr", "a+b.exr", "a*b.exr",
          "a.b.c.exr", "a-b_c~d!.exr", "a'b.exr", "\xC3\xBC.exr", "a%20x.exr"}) {
        SCOPED_TRACE(name);
        fs::copy_file("city.exr", name);
        std::string quoted;
        for (const char c : std::string(name)) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
        write_text("file.pano", std::string("size=16\nsrc=") + name + "\n");
        const Ran ran = run("oiiotool 'v.pano?size=16&src=" + quoted + "' -o named.exr '" + quoted +
                            ".pano?size=16' -o alone.exr file.pano -o file.exr");
        EXPECT_EQ(ran.status, 0) << ran.text;
        expect_same_images("named.exr", "alone.exr");
        expect_same_images("named.exr", "file.exr");
    }
    // Those that it reads itself, unless told not to; and those that only a recipe file can hold.
    for (const char* name : {"a#b.exr", "a@b.exr", "a{b}.exr"}) {
        SCOPED_TRACE(name);
        fs::copy_file("city.exr", name);
        const Ran ran =
            run(std::string("oiiotool --wildcardoff --evaloff 'v.pano?size=16&src=") + name + "' -o off.exr");
        EXPECT_EQ(ran.status, 0) << ran.text;
    }
    fs::copy_file("city.exr", "a&b.exr");
    write_text("file.pano", "size=16\nsrc=a&b.exr\n");
    EXPECT_EQ(run("oiiotool file.pano -o file.exr").status, 0);
    // Nested, three deep.
    const Ran nested = run(
        "oiiotool 'v.pano?size=16&src=w.pano?to=cubemap&size=64&src=city.exr.pano?to=equirectangular&yaw=90' "
        "-o n.exr");
    EXPECT_EQ(nested.status, 0) << nested.text;
}

TEST_F(Hosts, conformance_25_relative_absolute_and_linked_sources) {
    const std::string here = fs::current_path().string();
    fs::create_directories("shots/day");
    fs::copy_file("city.exr", "shots/day/near.exr");
    fs::create_symlink(here + "/city.exr", "shots/link.exr");
    fs::create_symlink("nowhere.exr", "shots/broken.exr");
    ASSERT_EQ(run("oiiotool 'city.exr.pano?size=16' -o expected.exr").status, 0);
    // In a file, relative to the file.
    write_text("shots/a.pano", "src=day/near.exr\nsize=16\n");
    write_text("shots/b.pano", "src=../city.exr\nsize=16\n");
    write_text("shots/c.pano", "src=link.exr\nsize=16\n");
    write_text("shots/d.pano", "src=" + here + "/city.exr\nsize=16\n");
    fs::create_symlink("shots/d.pano", "e.pano");
    fs::copy_file("city.exr", "shots/f.exr");
    write_text("shots/f.exr.pano", "size=16\n");
    for (const std::string name :
         {"shots/a.pano", "shots/b.pano", "shots/c.pano", "shots/d.pano", "e.pano", "shots/f.exr.pano"}) {
        SCOPED_TRACE(name);
        const Ran ran = run("oiiotool '" + name + "' -o out.exr '" + here + "/" + name +
                            "' -o absolute.exr './" + name + "' -o dotted.exr");
        EXPECT_EQ(ran.status, 0) << ran.text;
        for (const char* out : {"out.exr", "absolute.exr", "dotted.exr"})
            expect_same_images(out, "expected.exr");
    }
    // In a name, relative to the working folder.
    const Ran ran = run("oiiotool 'shots/a.pano?src=city.exr' -o out.exr");
    EXPECT_EQ(ran.status, 0) << ran.text;
    expect_same_images("out.exr", "expected.exr");
    write_text("g.pano", "src=shots/broken.exr\nsize=16\n");
    EXPECT_THAT(open_error("g.pano"), HasSubstr("shots/broken.exr"));
}

TEST_F(Hosts, conformance_26_what_fails_fails_with_status_1_and_a_reason) {
    write_text("bad.pano", "src=city.exr\nfov=200\n");
    write_text("self.pano", "src=self.pano\n");
    write_text("empty.exr", "");
    const std::pair<std::string, std::string> failing[] = {
        {"bad.pano", "fov=200"},
        {"self.pano", "read each other"},
        {"city.exr.pano?fov=200", "fov=200: must be above 0 and below 180 degrees for rectilinear"},
        {"city.exr.pano?jaw=1", "jaw=1: there is no such parameter"},
        {"city.exr.pano?size=1048576x1048576", "limits:imagesize_MB"},
        {"city.exr.pano?colorspace=nonsense", "colorspace=nonsense"},
        {"missing.exr.pano?size=8", "missing.exr"},
        {"empty.exr.pano?size=8", "empty.exr"},
        {"v.pano?size=8&src=self.pano", "read each other"},
        {"v.pano?size=8&src=w.pano?size=none", "size=none"},
        {"v.pano?size=8&src=none.anabuf", "none.anabuf"},
    };
    for (const auto& [name, reason] : failing) {
        SCOPED_TRACE(name);
        const Ran tool = run("oiiotool '" + name + "' -o out.exr");
        EXPECT_EQ(tool.status, 1) << tool.text;
        EXPECT_THAT(tool.text, HasSubstr(reason));
        const Ran info = run("iinfo '" + name + "'");
        EXPECT_EQ(info.status, 1) << info.text;
        EXPECT_THAT(info.text, HasSubstr(reason));
    }
    for (const char* command :
         {"idiff bad.pano city.exr", "iconvert bad.pano out.tif", "maketx bad.pano",
          "idiff self.pano city.exr", "iconvert self.pano out.tif", "maketx self.pano"}) {
        const Ran ran = run(command);
        EXPECT_NE(ran.status, 0) << command << ran.text;
        EXPECT_LT(ran.status, 124) << command << ran.text;
    }
    // A source that is damaged where only pixels are.
    write_panorama("cut.exr", 512, 256);
    fs::resize_file("cut.exr", fs::file_size("cut.exr") / 2);
    const Ran cut = run("oiiotool 'cut.exr.pano?to=equirectangular&size=512' -o out.exr");
    EXPECT_EQ(cut.status, 1) << cut.text;
}

TEST_F(Hosts, conformance_27_frames) {
    for (const char* number : {"0001", "0002", "0003"})
        fs::copy_file("city.exr", std::string("city.") + number + ".exr");
    const Ran pano = run("oiiotool --frames 1-3 'city.#.exr.pano?size=16&yaw=30' -o 'view.#.exr'");
    EXPECT_EQ(pano.status, 0) << pano.text;
    expect_same_images("view.0003.exr", "city.exr.pano?size=16&yaw=30");
    const Ran turning = run("oiiotool --frames 1-3 'city.exr.pano?size=16&yaw=%04d' -o 'turn.%04d.exr'");
    EXPECT_EQ(turning.status, 0) << turning.text;
    expect_same_images("turn.0003.exr", "city.exr.pano?size=16&yaw=3");
    const Ran computed =
        run("oiiotool --frames 1-2 'city.exr.pano?size=16&yaw={FRAME_NUMBER*10}' -o 'eval.#.exr'");
    EXPECT_EQ(computed.status, 0) << computed.text;
    expect_same_images("eval.0002.exr", "city.exr.pano?size=16&yaw=20");
}

TEST_F(Hosts, conformance_28_textures) {
    // maketx reads names that are on disk.
    write_text("tex.pano", "src=city.exr\nto=equirectangular\nyaw=40\nsize=256x128\n");
    const Ran made = run("maketx --filter box tex.pano -o made.tx");
    EXPECT_EQ(made.status, 0) << made.text;
    const Ran tool =
        run("oiiotool 'city.exr.pano?to=equirectangular&yaw=40&size=256x128' -otex:filtername=box tool.tx");
    EXPECT_EQ(tool.status, 0) << tool.text;
    expect_same_images("made.tx", "tex.pano");
    const Pixels level = read_pixels("made.tx", 2);
    EXPECT_EQ(level.spec.width, 64);
    EXPECT_EQ(read_pixels("tool.tx", 2).bytes, level.bytes);
    // The recipe's own levels are pictures of their own: right on average.
    const std::vector<float> own = read_floats("tex.pano?mip=1", 2), box = read_floats("made.tx", 2);
    EXPECT_LT(largest_difference(own, box), 0.1);
    const Ran info = run("iinfo -v 'tex.pano?mip=1'");
    EXPECT_THAT(info.text, HasSubstr("MIP-map levels: 256x128 128x64 64x32"));
}

TEST_F(Hosts, conformance_29_memory_follows_the_view) {
    const Ran ran =
        run("oiiotool 'v.pano?from=equirectangular&fov=5&size=1024x1024&yaw=33&pitch=11&"
            "src=big.null?RES=65536x32768&TILE=64x64&CHANNELS=3&TYPE=uint8' -o out.exr");
    EXPECT_EQ(ran.status, 0) << ran.text;
    std::printf("%.0f MB\n", ran.megabytes);
#if !defined(__SANITIZE_ADDRESS__)
    EXPECT_LT(ran.megabytes, 300);
#endif
}

TEST_F(Hosts, an_image_in_memory_is_a_source) {
    const Ran ran =
        run("oiiotool city.exr --resize 128x64 -o A.anabuf --pop 'view.pano?size=48&yaw=20&src=A.anabuf' -o "
            "one.exr "
            "--pop city.exr --resize 64x32 -o A.anabuf --pop 'other.pano?size=48&yaw=20&src=A.anabuf' -o "
            "two.exr");
    EXPECT_EQ(ran.status, 0) << ran.text;
    ASSERT_EQ(
        run("oiiotool city.exr --resize 128x64 -o small.exr city.exr --resize 64x32 -o tiny.exr").status, 0);
    expect_same_images("one.exr", "small.exr.pano?size=48&yaw=20");
    const Ran same = run("idiff -fail 0 -warn 0 two.exr 'tiny.exr.pano?size=48&yaw=20'");
    EXPECT_EQ(same.status, 0) << same.text;
    EXPECT_FALSE(fs::exists("A.anabuf"));
    // Data windows and integer types too.
    const Ran cropped =
        run("oiiotool city.exr -d uint8 --crop 100x50+20+30 -o B.anabuf -o crop.tif --pop "
            "'view.pano?size=48&src=B.anabuf' -o b.tif");
    EXPECT_EQ(cropped.status, 0) << cropped.text;
    expect_same_images("b.tif", "crop.tif.pano?size=48");
}

TEST_F(Hosts, a_source_map_drives_st_warp) {
    // oiiotool's own warp along our map is our picture, but for the widths of the filters. It draws no more
    // than the source's size.
    ASSERT_EQ(run("oiiotool 'city.exr.pano?size=256x128&fov=60&output=stmap' -o map.exr").status, 0);
    const Ran warp = run("oiiotool city.exr map.exr --st_warp:filter=triangle -o warp.exr");
    ASSERT_EQ(warp.status, 0) << warp.text;
    const std::vector<float> ours = read_floats("city.exr.pano?size=256x128&fov=60&filter=bilinear"),
                             theirs = read_floats("warp.exr");
    ASSERT_EQ(ours.size(), theirs.size());
    EXPECT_GT(
        *std::max_element(theirs.begin(), theirs.end()) - *std::min_element(theirs.begin(), theirs.end()),
        0.3f);
    double sum = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) sum += std::fabs(ours[i] - theirs[i]);
    // The picture's detail has amplitude 0.35; half a source pixel off is 0.02 on average.
    std::printf("mean difference %.5f\n", sum / double(ours.size()));
    EXPECT_LT(sum / double(ours.size()), 0.004);
}

}  // namespace
}  // namespace anamorph::test_conformance_hosts
