// SPDX-License-Identifier: Apache-2.0
// Rows of files without tiles: decoded once, as many as are needed, in any order of asking.
#include "anamorph/file_rows.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <thread>

#include "anamorph/error.h"
#include "anamorph/image_source.h"
#include "host.h"

namespace anamorph::test_file_rows {
namespace {

using namespace testing_oiio;

constexpr int kWidth = 300, kHeight = 1000;

/// Opens a file and counts how often.
struct Counted {
    std::string name;
    int opened = 0;

    FileRows::Opener opener() {
        return [this] {
            ++opened;
            return OIIO::ImageInput::open(name);
        };
    }
};

/// All channels as the core has them.
FileRows::Pixels pixels_of(const OIIO::ImageSpec& spec) {
    const PixelType type = pixel_type(spec.format);
    return {type, spec.nchannels, oiio_type(type)};
}

class FileRowsOf : public InFolder, public testing::WithParamInterface<const char*> {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        const bool floats = GetParam() == std::string("exr");
        file.name = std::string("rows.") + GetParam();
        write_image(panorama(kWidth, kHeight, floats ? OIIO::TypeHalf : OIIO::TypeUInt8), file.name);
        want = read_pixels(file.name);
    }
    FileRows rows() { return {file.opener(), file.name, 0, want.spec, pixels_of(want.spec)}; }
    /// Row y of what is there.
    bool equal(const FileRows& rows, int y) const {
        const auto row = static_cast<std::size_t>(rows.view().row_stride);
        return std::equal(rows.view().at(0, y), rows.view().at(0, y) + row,
                          want.bytes.data() + row * static_cast<std::size_t>(y));
    }
    bool decoded(const FileRows& rows, int y) const {
        const std::byte* const row = rows.view().at(0, y);
        return std::any_of(row, row + rows.view().row_stride, [](std::byte b) { return b != std::byte{0}; });
    }

    Counted file;
    Pixels want;
};

INSTANTIATE_TEST_SUITE_P(Formats, FileRowsOf, testing::Values("jpg", "png", "tif", "exr"));

TEST_P(FileRowsOf, AreThoseOfTheFileInAnyOrder) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    FileRows all = rows();
    for (int n = 0; n < 20; ++n) {
        const int first = std::uniform_int_distribution(0, kHeight - 1)(random);
        const int end = std::min(kHeight, first + std::uniform_int_distribution(1, 150)(random));
        all.need(first, end);
        for (int y = first; y < end; ++y) ASSERT_TRUE(equal(all, y)) << "row " << y;
    }
    // Of 64 rows at least, each way back makes twice as many: 4 of them lead to 1000, and the way down begins anew after each.
    EXPECT_LE(file.opened, 1 + 2 * 4);
}

TEST_P(FileRowsOf, AreDecodedBackwardsInFewSteps) {
    FileRows all = rows();
    for (int first = kHeight - 40; first >= 0; first -= 64) all.need(first, first + 20);
    // Of 40 rows each way back makes at least twice as many; one strip at a time it would be 16 steps.
    EXPECT_LE(file.opened, 6);
}

TEST_P(FileRowsOf, GoOnWhereTheyEndedAfterAWayBack) {
    FileRows some = rows();
    some.need(600, 640);
    some.need(520, 530);
    EXPECT_EQ(file.opened, 2);
    some.need(640, 700);
    EXPECT_EQ(file.opened, 2) << "the reader that was farther down is kept";
    // A view's upper edge is bent: what is passed through from its top goes up in one step.
    if (const std::string format = GetParam(); format == "png" || format == "jpg") {
        some.need(300, 310);
        EXPECT_EQ(file.opened, 2);
    }
    for (int y = 520; y < 700; ++y) EXPECT_TRUE(equal(some, y)) << "row " << y;
    EXPECT_FALSE(decoded(some, 100));
    EXPECT_FALSE(decoded(some, 800));
}

TEST_P(FileRowsOf, BeyondThoseNeededStayUntouched) {
    FileRows some = rows();
    some.need(300, 340);
    some.need(380, 400);
    EXPECT_EQ(file.opened, 1) << "the way down needs no second decoding";
    for (int y = 300; y < 400; ++y) EXPECT_TRUE(equal(some, y)) << "row " << y;
    EXPECT_FALSE(decoded(some, 0));
    EXPECT_FALSE(decoded(some, 200));
    EXPECT_FALSE(decoded(some, 600));
}

TEST_P(FileRowsOf, AreTheSameOnThreads) {
    FileRows shared = rows();
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (int n = 0; n < 10; ++n) {
                const int first = (n * 373 + t * 211) % (kHeight - 20);
                shared.need(first, first + 20);
                for (int y = first; y < first + 20; ++y) EXPECT_TRUE(equal(shared, y)) << "row " << y;
            }
        });
    for (std::thread& thread : threads) thread.join();
}

TEST_P(FileRowsOf, SayWhyTheyCannotBeRead) {
    FileRows changed = rows();
    write_image(panorama(kWidth, kHeight / 2, OIIO::TypeUInt8), file.name);
    EXPECT_THAT([&] { changed.need(0, 10); },
                testing::ThrowsMessage<Error>("has changed since it was opened"));
    // Another file of the same size, after the first rows of the one before.
    FileRows replaced(file.opener(), file.name, 0, read_pixels(file.name).spec, pixels_of(want.spec));
    replaced.need(100, 110);
    write_image(panorama(kWidth, kHeight / 2, OIIO::TypeUInt8), "other" + file.name);
    std::filesystem::rename("other" + file.name, file.name);
    EXPECT_THAT([&] { replaced.need(300, 310); },
                testing::ThrowsMessage<Error>("has changed since it was opened"));

    FileRows away(file.opener(), file.name, 0, read_pixels(file.name).spec, pixels_of(want.spec));
    std::filesystem::rename(file.name, "away");
    EXPECT_THROW(away.need(0, 10), Error);
    std::filesystem::rename("away", file.name);
    EXPECT_NO_THROW(away.need(0, 10)) << "it is there again";
}

TEST(FileRows, SayWhichFilesAreDamaged) {
    // Some readers report success, and leave an error.
    for (const char* name : {"damaged.tif", "damaged.png", "damaged.jpg"}) {
        SCOPED_TRACE(name);
        write_image(panorama(kWidth, kHeight, OIIO::TypeUInt8), name);
        Counted file{name};
        const OIIO::ImageSpec spec = read_pixels(name).spec;
        std::filesystem::resize_file(name, std::filesystem::file_size(name) * 6 / 10);
        FileRows rows(file.opener(), name, 0, spec, pixels_of(spec));
        EXPECT_THROW(rows.need(kHeight - 10, kHeight), Error);
        const int before = file.opened;
        EXPECT_THROW(rows.need(kHeight - 20, kHeight - 10), Error);
        EXPECT_EQ(file.opened, before) << "each block would try again";
        std::filesystem::remove(name);
    }
}

using TiledSources = InFolder;

// The cache tells of a tile that it cannot read once, and hands it out from then on.
TEST_F(TiledSources, StayDamaged) {
    ASSERT_EQ(
        run("oiiotool --pattern noise 256x128 3 -d uint8 --tile 64 64 --compression zip -o good.tif").status,
        0);
    std::ifstream good("good.tif", std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(good), {}};
    // There whole tiles are, compressed, but for the directory at the end.
    std::fill(bytes.begin() + std::ssize(bytes) / 8, bytes.begin() + std::ssize(bytes) / 2, '\xff');
    std::ofstream("bad.tif", std::ios::binary) << bytes;
    const std::string lens = "bad.tif.lens?lens=3de4:k1=0&filter=bilinear";
    std::vector<float> pixels(256 * 128 * 3);
    for (const std::string& name : {lens, lens, lens + "&tol=0.02", std::string("v.map?src=bad.tif&u=x&v=y")})
        for (int again = 0; again < 2; ++again) {
            const auto input = open(name);
            ASSERT_TRUE(input) << OIIO::geterror();
            EXPECT_FALSE(input->read_image(0, 0, 0, 3, OIIO::TypeFloat, pixels.data())) << name << again;
            EXPECT_THAT(input->geterror(), testing::HasSubstr("bad.tif")) << name << again;
        }
}

using UntiledSources = InFolder;

TEST_F(UntiledSources, TakeMemoryForTheirRowsInTheirOwnType) {
    // 96 MiB of uint8: as one tile of floats it would be 384.
    ASSERT_EQ(
        run("oiiotool --pattern constant:color=.5,.4,.3 8192x4096 3 -d uint8 --scanline -o big.tif").status,
        0);
    const double least =
        run("oiiotool --pattern constant:color=.5,.4,.3 512x512 3 -d uint8 -o view.tif").megabytes;
    const Ran view =
        run("oiiotool 'big.tif.pano?to=rectilinear&fov=90&size=512x512&filter=bilinear' -o view.tif");
    EXPECT_EQ(view.status, 0) << view.text;
    EXPECT_LT(view.megabytes, least + 120);
    // Of a band of 20 degrees, less than a fifth of the rows.
    const Ran band =
        run("oiiotool 'big.tif.pano?to=cylindrical&fov=20&size=512x512&filter=bilinear' -o view.tif");
    EXPECT_EQ(band.status, 0) << band.text;
    EXPECT_LT(band.megabytes, least + 60);
}

}  // namespace
}  // namespace anamorph::test_file_rows
