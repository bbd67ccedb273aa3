// SPDX-License-Identifier: Apache-2.0
// Sources of several parts: every one is drawn, as it is drawn where it stands alone; one is chosen by number or name.
#include <OpenImageIO/imagebufalgo.h>

#include <thread>

#include "host.h"

namespace anamorph::test_parts {
namespace {

using namespace testing_oiio;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using testing::AllOf;
using testing::HasSubstr;

/// Pixels of one part of a file or recipe, as they are stored.
Pixels part_of(const std::string& name, int part) {
    const auto input = OIIO::ImageInput::open(name);
    EXPECT_TRUE(input) << name << ": " << OIIO::geterror();
    if (!input || !input->seek_subimage(part, 0)) {
        ADD_FAILURE() << name << " has no part " << part;
        return {};
    }
    Pixels pixels{input->spec(), {}};
    pixels.bytes.resize(pixels.spec.image_bytes(true));
    EXPECT_TRUE(input->read_image(part, 0, 0, pixels.spec.nchannels, OIIO::TypeUnknown, pixels.bytes.data()))
        << name << ": " << input->geterror();
    return pixels;
}

int parts_in(const std::string& name) {
    const auto input = open(name);
    int parts = 0;
    while (input && input->seek_subimage(parts, 0)) ++parts;
    return parts;
}

/// A plate, a mask with windows, ids.
class Parts : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("beauty.exr", 96, 64);
        ImageSpec window(70, 50, 1, OIIO::TypeHalf);
        window.x = -5;
        window.y = -6;
        // Parts of an EXR file have one display window.
        window.full_width = 96;
        window.full_height = 64;
        ImageBuf mask(window);
        for (int y = -6; y < 44; ++y)
            for (int x = -5; x < 65; ++x) {
                const float value = 0.01f * static_cast<float>(x + 2 * y + 40);
                mask.setpixel(x, y, 0, &value);
            }
        write_image(mask, "mask.exr");
        ImageBuf ids(ImageSpec(96, 64, 1, OIIO::TypeUInt32));
        std::vector<std::uint32_t> values;
        for (unsigned i = 0; i < 96 * 64; ++i) values.push_back(4000000001u + i);
        ids.set_pixels(ids.roi(), OIIO::TypeUInt32, values.data());
        write_image(ids, "ids.exr");
        ASSERT_EQ(
            run("oiiotool --native beauty.exr --attrib oiio:subimagename beauty mask.exr --attrib "
                "oiio:subimagename mask ids.exr --attrib oiio:subimagename ids --siappendall -o parts.exr")
                .status,
            0);
        ASSERT_EQ(parts_in("parts.exr"), 3);
    }
};

const char* const kNames[] = {"beauty", "mask", "ids"};

TEST_F(Parts, AreAllDrawnEachAsItIsAlone) {
    for (const std::string keys : {".lens?lens=3de4:k1=-0.1", ".map?u=x*1.1-3&v=y+2*sin(x/9)&filter=nearest",
                                   ".warp?mesh=grid.json&size=40x30&wrap=mirror",
                                   ".pano?from=rectilinear&srcfov=70&fov=90&size=50x40"}) {
        write_text("grid.json", R"({"columns": 1, "rows": 1, "units": "fractions",
                                    "vertices": [[0.1, -0.1], [1, 0.1], [0, 0.9], [1.2, 1]]})");
        EXPECT_EQ(parts_in("parts.exr" + keys), 3);
        for (int part = 0; part < 3; ++part) {
            SCOPED_TRACE(keys + " " + std::to_string(part));
            const std::string name = kNames[part];
            const Pixels drawn = part_of("parts.exr" + keys, part), alone = part_of(name + ".exr" + keys, 0);
            EXPECT_TRUE(drawn == alone);
            EXPECT_EQ(drawn.spec.get_string_attribute("oiio:subimagename"), name);
            EXPECT_EQ(drawn.spec.get_string_attribute("anamorph:subimage"), std::to_string(part) + " of 3");
            EXPECT_FALSE(alone.spec.find_attribute("anamorph:subimage"));
            for (const std::string& asked : {name, std::to_string(part)}) {
                const std::string one = "parts.exr" + keys + "&subimage=" + asked;
                EXPECT_EQ(parts_in(one), 1);
                EXPECT_TRUE(part_of(one, 0) == alone);
            }
        }
    }
    // What nearest moves, it moves with all its bits.
    const Pixels ids = part_of("parts.exr.map?filter=nearest", 2);
    EXPECT_EQ(ids.spec.format, OIIO::TypeUInt32);
    EXPECT_TRUE(ids == part_of("ids.exr", 0));
}

TEST_F(Parts, AreWrittenByStockPrograms) {
    ASSERT_EQ(run("oiiotool 'parts.exr.lens?lens=3de4:k1=-0.1&tile=0' -o out.exr").status, 0);
    EXPECT_EQ(parts_in("out.exr"), 3);
    for (int part = 0; part < 3; ++part) {
        EXPECT_EQ(part_of("out.exr", part).spec.get_string_attribute("oiio:subimagename"), kNames[part]);
        EXPECT_EQ(part_of("out.exr", part).spec.width,
                  part_of("parts.exr.lens?lens=3de4:k1=-0.1", part).spec.width);
    }
}

TEST_F(Parts, OtherSourcesHaveAsManyOrOne) {
    ASSERT_EQ(run("oiiotool beauty.exr --flip -o other.exr").status, 0);
    write_text("lines.json", R"({"features": [{"line": [[9, 9, 50, 20], [12, 5, 55, 30]]}]})");
    const std::string keys = "&features=lines.json&t=0.4";
    ASSERT_EQ(run("oiiotool beauty.exr other.exr --siappendall -o two.exr").status, 0);
    EXPECT_EQ(parts_in("two.exr.morph?b=other.exr" + keys), 2);
    EXPECT_TRUE(part_of("two.exr.morph?b=other.exr" + keys, 0) ==
                part_of("beauty.exr.morph?b=other.exr" + keys, 0));
    EXPECT_TRUE(part_of("two.exr.morph?b=other.exr" + keys, 1) ==
                part_of("other.exr.morph?b=other.exr" + keys, 0));
    EXPECT_TRUE(part_of("two.exr.morph?b=two.exr" + keys, 1) ==
                part_of("other.exr.morph?b=other.exr" + keys, 0));
    EXPECT_TRUE(part_of("two.exr.morph?b=two.exr&subimage=1" + keys, 0) ==
                part_of("other.exr.morph?b=other.exr" + keys, 0));
    // The third lacks a partner.
    ASSERT_EQ(run("oiiotool beauty.exr beauty.exr beauty.exr --siappendall -o three.exr").status, 0);
    EXPECT_THAT(open_error("three.exr.morph?b=two.exr" + keys),
                HasSubstr("source \"two.exr\" has 2 parts: must have 1, or as many as another has, 3"));
    // One serves for all, whichever it is.
    EXPECT_EQ(parts_in("other.exr.morph?b=two.exr" + keys), 2);
    EXPECT_TRUE(part_of("other.exr.morph?b=two.exr" + keys, 1) ==
                part_of("other.exr.morph?b=other.exr" + keys, 0));
    EXPECT_TRUE(part_of("other.exr.morph?b=two.exr" + keys, 0) ==
                part_of("other.exr.morph?b=beauty.exr" + keys, 0));
    // Of a film, the first.
    const std::string film = "three.exr.morph?b=other.exr&features=lines.json&frames=4";
    EXPECT_EQ(parts_in(film), 4);
    EXPECT_EQ(part_of(film, 2).spec.get_string_attribute("anamorph:subimage"), "0 of 3");
}

TEST_F(Parts, RecipesHandThemOn) {
    const std::string inner = "parts.exr.lens?lens=3de4:k1=-0.1", outer = "x.map?u=x+2&src=" + inner;
    EXPECT_EQ(parts_in(outer), 3);
    for (int part = 0; part < 3; ++part)
        EXPECT_TRUE(part_of(outer, part) ==
                    part_of("x.map?u=x+2&src=" + inner + "&subimage=" + std::to_string(part), 0));
    EXPECT_TRUE(part_of("x.map?u=x+2&subimage=1&src=" + inner, 0) == part_of(outer, 1));
    // A film as a source, and a file of pages.
    write_text("lines.json", R"({"features": [{"line": [[9, 9, 50, 20], [12, 5, 55, 30]]}]})");
    const std::string film = "beauty.exr.morph?b=beauty.exr&features=lines.json&frames=3";
    EXPECT_EQ(parts_in("x.map?src=" + film), 3);
    EXPECT_TRUE(part_of("x.map?filter=nearest&src=" + film, 1) == part_of(film, 1));
    ASSERT_EQ(run("oiiotool beauty.exr -d uint8 --dup --flip --siappendall -o pages.tif").status, 0);
    EXPECT_EQ(parts_in("pages.tif.map"), 2);
    EXPECT_TRUE(part_of("pages.tif.map", 1) == part_of("pages.tif", 1));
}

TEST_F(Parts, ThatAreNotThereAreRefused) {
    for (const std::string asked : {"3", "-1", "alpha", "1.5", "99999999999"})
        EXPECT_THAT(
            open_error("parts.exr.map?subimage=" + asked),
            HasSubstr("subimage=" + asked + ": must be an integer from 0 to 2, or one of beauty, mask, ids"));
    EXPECT_THAT(open_error("beauty.exr.map?subimage=1"), HasSubstr("must be an integer from 0 to 0"));
    EXPECT_EQ(parts_in("beauty.exr.map?subimage=0"), 1);
    const auto input = open("parts.exr.map");
    EXPECT_FALSE(input->seek_subimage(3, 0));
    EXPECT_FALSE(input->seek_subimage(-1, 0));
    EXPECT_FALSE(input->seek_subimage(1, 1));
}

// A host must not take those before it for all.
TEST_F(Parts, OneThatCannotBeDrawnIsAnErrorWhereItIsRead) {
    write_panorama("a.tif", 40, 20, OIIO::TypeUInt8);
    write_panorama("b.tif", 40, 40, OIIO::TypeUInt8);
    ASSERT_EQ(run("oiiotool a.tif b.tif a.tif --siappendall -o pages.tif").status, 0);
    const std::string recipe = "pages.tif.pano?to=rectilinear&fov=90&size=20x20";
    EXPECT_EQ(parts_in(recipe), 3);
    EXPECT_TRUE(part_of(recipe, 2) == part_of(recipe, 0));
    const auto input = open(recipe);
    std::vector<float> pixels(20 * 20 * 3);
    EXPECT_FALSE(input->read_image(1, 0, 0, 3, OIIO::TypeFloat, pixels.data()));
    EXPECT_THAT(input->geterror(), HasSubstr("from"));
    const Ran ran = run("oiiotool -a '" + recipe + "' -o out.tif");
    EXPECT_NE(ran.status, 0);
    EXPECT_THAT(ran.text, HasSubstr("anamorph: "));
}

TEST_F(Parts, AreReadFromThreadsInAnyOrder) {
    const std::string name = "parts.exr.lens?lens=3de4:k1=-0.1&tile=16";
    std::vector<Pixels> expected;
    for (int part = 0; part < 3; ++part) expected.push_back(part_of(name, part));
    const auto input = open(name);
    std::vector<std::thread> threads;
    std::atomic<int> wrong{0};
    for (int k = 0; k < 4; ++k)
        threads.emplace_back([&, k] {
            for (int i = 0; i < 30; ++i) {
                const int part = (i * 7 + k) % 3;
                Pixels got{input->spec(part, 0), {}};
                got.bytes.resize(got.spec.image_bytes(true));
                const bool read =
                    input->read_image(part, 0, 0, got.spec.nchannels, OIIO::TypeUnknown, got.bytes.data());
                if (!read || !(got == expected[static_cast<std::size_t>(part)])) ++wrong;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
}

// The picture on the far side of a drape goes part by part with that on this side where it has as many, and is its first else.
TEST_F(Parts, TheFarSideOfADrapeHasThemToo) {
    for (const char* side : {"front", "back"})
        for (const int i : {0, 1})
            write_image(panorama(40, 30, OIIO::TypeHalf, 3), side + std::to_string(i) + ".exr");
    ASSERT_EQ(run("oiiotool front0.exr front1.exr --mulc 0.5 --siappend -o fronts.exr").status, 0);
    ASSERT_EQ(run("oiiotool back0.exr --mulc 0.3 back1.exr --mulc 0.7 --siappend -o backs.exr").status, 0);
    const std::string view = "v.drape?surface=plane&rotate=0,180,0&size=40x30&filter=nearest";
    const std::string both = view + "&src=fronts.exr&back=backs.exr",
                      one = view + "&src=fronts.exr&back=back0.exr";
    for (const int i : {0, 1}) {
        const std::string number = std::to_string(i);
        ASSERT_EQ(run("oiiotool --subimage " + number + " backs.exr -o alone" + number + ".exr").status, 0);
        const Pixels truth = part_of(view + "&src=front0.exr&back=alone" + number + ".exr", 0);
        EXPECT_EQ(part_of(both, i), truth) << i;
        EXPECT_EQ(part_of(both + "&subimage=" + number, 0), truth) << i;
        EXPECT_EQ(part_of(one, i), part_of(view + "&src=front0.exr&back=back0.exr", 0)) << i;
    }
    EXPECT_NE(part_of(both, 0), part_of(both, 1));
}

// What is read beside the sources is the first part of its file, and the picture says so, however often it is opened.
TEST_F(Parts, AreSaidNotToBeReadOfOtherFiles) {
    ASSERT_EQ(run("oiiotool beauty.exr --ch R,G -o map.exr map.exr --siappend -o maps.exr").status, 0);
    ASSERT_EQ(run("oiiotool beauty.exr beauty.exr --siappend -o beauties.exr").status, 0);
    ASSERT_EQ(parts_in("maps.exr"), 2);
    const auto first = [](const std::string& name) {
        const auto input = open(name);
        return input ? input->spec().get_string_attribute("anamorph:first_part") : "none";
    };
    for (const int time : {0, 1}) {
        SCOPED_TRACE(time);
        EXPECT_EQ(first("beauty.exr.warp?mesh=maps.exr"), "mesh");
        EXPECT_EQ(first("beauty.exr.warp?mesh=map.exr"), "");
        EXPECT_EQ(first("beauty.exr.drape?height=maps.exr&size=30x20"), "height");
        EXPECT_EQ(first("maps.exr.drape?height=maps.exr&back=maps.exr&size=30x20"), "height");
        EXPECT_EQ(first("map.exr.drape?back=maps.exr&size=30x20"), "back");
        EXPECT_EQ(first("map.exr.drape?back=map.exr&size=30x20"), "");
        EXPECT_EQ(first("beauty.exr.drape?surface=positions&positions=beauties.exr&size=30x20"), "positions");
        EXPECT_EQ(first("beauty.exr.drape?blend=beauties.exr&weights=0.5&size=30x20"), "blend");
        EXPECT_EQ(first("map.exr.drape?height=maps.exr&back=maps.exr&size=30x20"), "back, height");
    }
}

// What is wrong with a file that is no source begins with the key that names it; what is too large names what made it so.
TEST_F(Parts, ErrorsNameTheirKeys) {
    EXPECT_THAT(open_error("beauty.exr.warp?mesh=none.json"),
                HasSubstr("mesh: file \"none.json\" does not exist"));
    EXPECT_THAT(open_error("beauty.exr.warp?mesh=none.exr"), HasSubstr("mesh: image \"none.exr\""));
    EXPECT_THAT(open_error("beauty.exr.drape?surface=positions&positions=none.exr"),
                HasSubstr("positions: image \"none.exr\""));
    EXPECT_THAT(open_error("beauty.exr.drape?height=none.exr"), HasSubstr("height: image \"none.exr\""));
    EXPECT_THAT(open_error("beauty.exr.drape?deform=none.json"), HasSubstr("deform: file \"none.json\""));
    EXPECT_THAT(open_error("beauty.exr.morph?b=beauty.exr&features=none.csv"),
                HasSubstr("features: file \"none.csv\" does not exist"));
    EXPECT_THAT(open_error("beauty.exr.pano?from=latlong&keys=none.json"),
                HasSubstr("keys: file \"none.json\""));
    EXPECT_THAT(open_error("beauty.exr.map?overscan=500000"), HasSubstr("overscan=1000096x1000064"));
    EXPECT_THAT(open_error("beauty.exr.map?size=1000000x1000000"), HasSubstr("size=1000000x1000000"));
    // Keys that mean nothing where they stand.
    EXPECT_THAT(
        open_error("beauty.exr.pano?from=latlong&d=0.5"),
        HasSubstr(
            "d=0.5: is of pannini, unified, eucm, double_sphere: must not be given with to=rectilinear"));
    EXPECT_THAT(open_error("beauty.exr.pano?from=latlong&srcd=0.5"),
                HasSubstr("must not be given with from=equirectangular"));
    for (const std::string output : {"stmap", "bound", "error", "coverage"})
        EXPECT_THAT(open_error("beauty.exr.map?alpha=1&output=" + output),
                    HasSubstr("alpha=1: is of output=color: must not be given with output=" + output));
}

}  // namespace
}  // namespace anamorph::test_parts
