// SPDX-License-Identifier: Apache-2.0
// What recipes lead to: nested ones are opened once and not without end, pipes and addresses are not opened
// at all, messages are one readable line, and no two pictures share a key.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/strutil.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <map>
#include <set>
#include <thread>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_recipe_files {
namespace {

using namespace testing_oiio;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

const char* const kGrid = R"({"columns": 1, "rows": 1, "units": "fractions",
                              "vertices": [[0, 0], [1, 0], [0, 1], [1, 1]]})";

class RecipeFiles : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("city.exr", 64, 32);
        write_text("grid.json", kGrid);
        write_text("lines.csv", "8,8,50,12,12,10,44,20\n");
        write_text("eight.json", R"({"features": [{"line": [[8, 8, 50, 12], [9, 8, 50, 12], [8, 9, 50, 12],
            [8, 8, 51, 12], [8, 8, 50, 13], [9, 9, 50, 12], [8, 8, 51, 13], [8, 9, 50, 13]]}]})");
    }

    /// A morph of eight pictures.
    static void write_morph_of_eight(const std::string& name,
                                     const std::function<std::string(int)>& picture) {
        std::string text = "features=eight.json\nshape_weights=";
        for (int i = 0; i < 8; ++i) text += i ? ",0.125" : "0.125";
        for (int i = 0; i < 8; ++i) text += OIIO::Strutil::fmt::format("\n{}={}", char('a' + i), picture(i));
        write_text(name, text);
    }
};

/// Counts how often each file of the working folder is opened while it lives.
class Opens {
  public:
    Opens() : m_watch(::inotify_init1(IN_NONBLOCK)) {
        // Closing stands between two openings, which would be told as one otherwise.
        EXPECT_GE(::inotify_add_watch(m_watch, ".", IN_OPEN | IN_CLOSE), 0);
    }
    ~Opens() { ::close(m_watch); }
    std::map<std::string, int> count() {
        alignas(inotify_event) char buffer[1 << 16];
        for (ssize_t n = 0; (n = ::read(m_watch, buffer, sizeof buffer)) > 0;)
            for (ssize_t at = 0; at < n;) {
                const auto* event = reinterpret_cast<const inotify_event*>(buffer + at);
                if (event->mask & IN_OPEN) ++m_count[event->len ? event->name : "."];
                EXPECT_FALSE(event->mask & IN_Q_OVERFLOW);
                at += static_cast<ssize_t>(sizeof(inotify_event)) + event->len;
            }
        return m_count;
    }

  private:
    int m_watch;
    std::map<std::string, int> m_count;
};

TEST_F(RecipeFiles, AChainOfMorphsOpensEachRecipeOnce) {
    for (int i = 1; i <= 7; ++i) {
        const std::string next = i == 7 ? "city.exr" : OIIO::Strutil::fmt::format("r{}.morph", i + 1);
        write_morph_of_eight(OIIO::Strutil::fmt::format("r{}.morph", i), [&](int) { return next; });
    }
    Opens opens;
    open("r1.morph");
    for (int i = 1; i <= 7; ++i) {
        const std::string name = OIIO::Strutil::fmt::format("r{}.morph", i);
        EXPECT_EQ(opens.count()[name], 1) << name;
    }
    EXPECT_EQ(opens.count()["eight.json"], 1);
    // Reading is asked for by the cache, once for each more.
    EXPECT_EQ(read_floats("r1.morph").size(), 64u * 32 * 3);
    for (const auto& [name, count] : opens.count()) EXPECT_LE(count, 16) << name;
}

TEST_F(RecipeFiles, StMapsThatAreRecipesAreOpenedOnceToo) {
    for (int i = 1; i <= 12; ++i) {
        const std::string next = OIIO::Strutil::fmt::format("m{}.warp", i + 1);
        write_text(OIIO::Strutil::fmt::format("m{}.warp", i),
                   i == 12 ? "src=city.exr\nmesh=grid.json\noutput=stmap\n"
                           : "output=stmap\nstep=8\nsrc=" + next + "\nmesh=" + next + "\n");
    }
    Opens opens;
    EXPECT_EQ(read_floats("m1.warp").size(), 64u * 32 * 2);
    for (const auto& [name, count] : opens.count()) EXPECT_LE(count, 30) << name;
}

TEST_F(RecipeFiles, ARecipeReadsFromSoManyOthersAndNoMore) {
    const auto name = [](char kind, int i, int j, const char* end) {
        return OIIO::Strutil::fmt::format("{}{}_{}.{}", kind, i, j, end);
    };
    // 8 morphs and 64 panoramas; then 36 more; then one more than 100.
    write_morph_of_eight("top.morph", [&](int i) { return name('m', i, 0, "morph"); });
    for (int i = 0; i < 8; ++i) {
        write_morph_of_eight(name('m', i, 0, "morph"), [&](int j) { return name('p', i, j, "pano"); });
        for (int j = 0; j < 8; ++j)
            write_text(name('p', i, j, "pano"), "src=city.exr\nto=equirectangular\nsize=64x32\n");
    }
    open("top.morph");
    const auto nest = [&](int number) {
        write_text(name('p', number / 8, number % 8, "pano"),
                   "to=equirectangular\nsize=64x32\nsrc=" + name('q', number, 0, "pano"));
        write_text(name('q', number, 0, "pano"), "src=city.exr\nto=equirectangular\nsize=64x32\n");
    };
    for (int i = 0; i < 28; ++i) nest(i);
    open("top.morph");
    nest(28);
    EXPECT_THAT(open_error("top.morph"),
                HasSubstr("recipe \"top.morph\" reads from more than 100 others: must be at most so many"));
}

TEST_F(RecipeFiles, OpenPicturesAreSharedAndSeenAnewWhenTheyChange) {
    write_text("in.pano", "src=city.exr\nto=equirectangular\nsize=64x32\nyaw=10\n");
    write_text("out.pano", "src=in.pano\nto=equirectangular\nsize=64x32\n");
    const auto first = open("out.pano");
    const std::vector<float> before = read_floats("out.pano");
    write_text("in.pano", "src=city.exr\nto=equirectangular\nsize=64x32\nyaw=100\n");
    const std::vector<float> after = read_floats("out.pano");
    EXPECT_NE(before, after);
    EXPECT_EQ(after, read_floats("out.pano?tile=16"));
}

TEST_F(RecipeFiles, PipesDevicesAndFoldersAreRefused) {
    for (const char* pipe : {"pipe.png", "pipe.json", "pipe.csv", "pipe"}) ASSERT_EQ(::mkfifo(pipe, 0600), 0);
    fs::create_directory("folder");
    const std::pair<std::string, std::string> refused[] = {
        {"v.pano?size=8&src=pipe.png", "src=pipe.png"},
        {"pipe.pano?size=8", "src=pipe"},
        {"v.pano?size=8&src=/dev/zero", "src=/dev/zero"},
        {"v.pano?size=8&src=folder", "src=folder"},
        {"city.exr.warp?mesh=pipe.png", "mesh=pipe.png"},
        {"city.exr.warp?mesh=pipe.json", "mesh=pipe.json"},
        {"city.exr.warp?points=pipe.csv", "points=pipe.csv"},
        {"city.exr.morph?b=city.exr&features=pipe.csv", "features=pipe.csv"},
        {"city.exr.morph?b=pipe.png&features=lines.csv", "b=pipe.png"},
        {"v.pano?size=8&src=w.warp?src=city.exr&mesh=pipe.png", "mesh=pipe.png"},
    };
    for (const auto& [name, named] : refused)
        EXPECT_THAT(open_error(name),
                    HasSubstr(named + ": is not a file but a folder, pipe or device: must be "
                                      "the name of a file"))
            << name;
    OIIO::ImageBuf image = panorama(64, 32);
    EXPECT_THAT(mesh_warp(image, options({{"mesh", "pipe.png"}})).geterror(),
                HasSubstr("mesh=pipe.png: is not"));
    EXPECT_THAT(mesh_warp(image, options({{"points", "pipe.csv"}})).geterror(), HasSubstr("is not a file"));
}

/// Accepts connections to a port of this machine and closes them.
class Listener {
  public:
    Listener() : m_socket(::socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        EXPECT_EQ(::bind(m_socket, reinterpret_cast<sockaddr*>(&address), size), 0);
        EXPECT_EQ(::listen(m_socket, 8), 0);
        EXPECT_EQ(::getsockname(m_socket, reinterpret_cast<sockaddr*>(&address), &size), 0);
        m_port = ntohs(address.sin_port);
        m_thread = std::thread([this] {
            while (!m_stop) {
                pollfd waiting{m_socket, POLLIN, 0};
                if (::poll(&waiting, 1, 50) < 1) continue;
                ++m_connections;
                ::close(::accept(m_socket, nullptr, nullptr));
            }
        });
    }
    ~Listener() {
        m_stop = true;
        m_thread.join();
        ::close(m_socket);
    }
    int port() const { return m_port; }
    int connections() const { return m_connections; }

  private:
    int m_socket, m_port = 0;
    std::atomic<bool> m_stop{false};
    std::atomic<int> m_connections{0};
    std::thread m_thread;
};

TEST_F(RecipeFiles, AddressesAreNotConnectedTo) {
    Listener listener;
    const std::string address = OIIO::Strutil::fmt::format("127.0.0.1:{}/x.mp4", listener.port());
    for (const std::string scheme : {"http://", "HTTP://", "tcp://", "http:", "rtmp://", "ftp://",
                                     "subfile,,start,0,end,9,,:http://", "concat:http://"}) {
        const std::string url = scheme + address;
        for (const std::string& name : {"v.pano?size=8&src=" + url, "city.exr.warp?mesh=" + url,
                                        "city.exr.morph?features=lines.csv&b=" + url})
            EXPECT_THAT(open_error(name), HasSubstr(": is an address: must be the name of a file, unless the "
                                                    "environment variable ANAMORPH_ALLOW_URLS is 1"))
                << name;
        EXPECT_THAT(mesh_warp(panorama(64, 32), options({{"mesh", url.c_str()}})).geterror(),
                    HasSubstr("is an address"));
    }
    EXPECT_EQ(listener.connections(), 0);
    // One that was asked for; where OpenImageIO has a reader that connects.
    const std::string recipe = "iinfo 'v.pano?size=8&src=http://" + address + "'";
    EXPECT_EQ(run(recipe).status, 1);
    EXPECT_EQ(listener.connections(), 0);
    const Ran asked = run("ANAMORPH_ALLOW_URLS=1 " + recipe);
    EXPECT_EQ(asked.status, 1);
    EXPECT_THAT(asked.text, Not(HasSubstr("is an address")));
    if (OIIO::get_string_attribute("format_list").find("ffmpeg") != std::string::npos) {
        EXPECT_GT(listener.connections(), 0);
    }
    // A file with a colon in its name is a file.
    fs::copy_file("city.exr", "shot:1.exr");
    EXPECT_EQ(read_floats("v.pano?size=8&src=shot:1.exr"), read_floats("v.pano?size=8&src=city.exr"));
}

TEST_F(RecipeFiles, MessagesArePrintable) {
    const std::string odd = "mi\nss\x1b[31ming\x07.exr", shown = "mi?ss?[31ming?.exr";
    for (const std::string& name : {odd + ".pano?size=8", odd + ".warp?mesh=grid.json"})
        EXPECT_THAT(open_error(name), HasSubstr("source \"" + shown + "\"")) << name;
    write_text(odd, "this is no image");
    for (const std::string& name :
         {odd + ".pano?size=8", odd + ".warp?mesh=grid.json", odd + ".morph?b=city.exr&features=lines.csv"})
        EXPECT_THAT(open_error(name), HasSubstr("source \"" + shown + "\"")) << name;
    write_text("odd\x1b.pano", "src=city.exr\nfov=none\n");
    std::vector<std::string> errors = {
        open_error(odd + ".pano?size=8"),
        open_error("odd\x1b.pano"),
        open_error("v\x01.pano?size=x\x02"),
        reproject(OIIO::ImageBuf("no\x1bne.exr")).geterror(),
        mesh_warp(panorama(64, 32), options({{"mesh", "no\x1bne.exr"}})).geterror(),
        mesh_warp(panorama(64, 32), options({{"mesh", "no\x1bne.json"}})).geterror()};
    for (const std::string& error : errors) {
        EXPECT_FALSE(error.empty());
        for (const char c : error) EXPECT_GE(static_cast<unsigned char>(c), 0x20) << error;
    }
}

TEST_F(RecipeFiles, WhatANestedRecipeLacksIsSaidOnce) {
    write_text("bad.pano", "src=city.exr\nfov=none\n");
    const std::pair<std::string, std::string> failing[] = {
        {"v.pano?size=8&src=w.pano?size=none",
         "in \"w.pano\": size=none: must be N or NxM, integers from 1 to 1048576"},
        {"v.pano?size=8&src=bad.pano",
         "recipe \"bad.pano\": fov=none: must be a number above 0, at most 360"},
        {"v.pano?size=8&src=w.pano?size=8&src=none.exr", "in \"w.pano\": source \"none.exr\": "},
        {"v.pano?size=8&src=w.pano?fov=200&src=city.exr",
         "in \"w.pano\": fov=200: must be above 0 and below 180 degrees for rectilinear"},
    };
    for (const auto& [name, message] : failing) {
        SCOPED_TRACE(name);
        const std::string error = open_error(name);
        EXPECT_THAT(error, testing::StartsWith("anamorph: " + message));
        EXPECT_EQ(error.find("anamorph: ", 1), std::string::npos) << error;
        const std::string told = run("oiiotool '" + name + "' -o out.exr").text;
        const std::size_t first = told.find(message);
        ASSERT_NE(first, std::string::npos) << told;
        EXPECT_EQ(told.find(message, first + 1), std::string::npos) << told;
    }
}

TEST_F(RecipeFiles, ASourceIsCalledByItsName) {
    // Each time it is written anew the cache knows it by another spelling, which is nobody's business.
    write_panorama("s.tif", 512, 256, OIIO::TypeUInt8);
    for (int i = 0; i < 6; ++i) {
        write_image(OIIO::ImageBufAlgo::mul(panorama(512, 256, OIIO::TypeUInt8), 1 - 0.1f * float(i)),
                    "s.tif");
        read_floats("v.pano?size=8&src=s.tif");
        read_floats("v.pano?size=8&src=w.pano?to=equirectangular&size=64x32&src=s.tif");
    }
    for (const std::string name :
         {"v.pano?size=8&src=s.tif", "v.pano?size=8&src=w.pano?to=equirectangular&size=64x32&src=s.tif"}) {
        SCOPED_TRACE(name);
        write_panorama("s.tif", 512, 256, OIIO::TypeUInt8);
        const auto input = open(name);
        ASSERT_TRUE(input);
        fs::remove("s.tif");
        OIIO::ImageCache::create(true)->invalidate_all(true);
        std::vector<float> pixels(8 * 8 * 3);
        ASSERT_FALSE(input->read_image(0, 0, 0, 3, OIIO::TypeFloat, pixels.data()));
        const std::string error = input->geterror();
        EXPECT_THAT(error, AllOf(testing::StartsWith("anamorph: source \"s.tif\": "), Not(HasSubstr("./"))));
        EXPECT_EQ(error.find("source \"", 15), std::string::npos) << error;
        EXPECT_THAT(open_error(name), AllOf(HasSubstr("source \"s.tif\": "), Not(HasSubstr("./"))));
    }
}

TEST_F(RecipeFiles, ASourceThatIsTooLargeIsNamed) {
    write_text("huge.ppm", "P6\n2147483647 2147483647\n255\nabc");
    write_text("wide.ppm", "P6\n16777217 1\n255\nabc");
    for (const std::string name :
         {"huge.ppm.pano?from=rectilinear", "huge.ppm.pano?from=fisheye&to=fisheye&size=8",
          "huge.ppm.warp?mesh=grid.json", "huge.ppm.lens?lens=ptlens:b=0.1", "huge.ppm.drape?surface=sphere",
          "huge.ppm.mosaic?circles=1", "city.exr.morph?b=huge.ppm&features=lines.csv",
          "city.exr.drape?backdrop=huge.ppm"})
        EXPECT_THAT(open_error(name),
                    HasSubstr("source \"huge.ppm\" has 2147483647x2147483647 pixels: must have 1x1 to "
                              "16777216x16777216"))
            << name;
    EXPECT_THAT(open_error("wide.ppm.pano?from=rectilinear"),
                HasSubstr("source \"wide.ppm\" has 16777217x1 pixels"));
}

TEST_F(RecipeFiles, MemoryThatCannotBeHadIsCalledSo) {
    // 2 GB for an ST-map's values.
    const Ran ran =
        run("ulimit -v 1500000; iinfo "
            "'city.exr.warp?step=64&mesh=big.null?RES=16384x16384&CHANNELS=2&TYPE=uint8'");
    EXPECT_EQ(ran.status, 1) << ran.text;
    EXPECT_THAT(ran.text, HasSubstr("not enough memory for \"city.exr.warp?"));
    EXPECT_THAT(ran.text, Not(HasSubstr("bad_alloc")));
    EXPECT_EQ(message_of(std::bad_alloc(), "the picture"), "not enough memory for the picture");
    EXPECT_EQ(message_of(std::length_error("vector"), "it"), "not enough memory for it");
    EXPECT_EQ(message_of(Error("fov", "\n", "must be\t1"), "it"), "fov=?: must be?1");
}

}  // namespace
}  // namespace anamorph::test_recipe_files
