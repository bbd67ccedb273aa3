// SPDX-License-Identifier: Apache-2.0
#include "host.h"

#include <OpenImageIO/imagebufalgo.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <thread>

namespace anamorph::testing_oiio {

namespace fs = std::filesystem;

void InFolder::SetUp() {
    ASSERT_TRUE(std::getenv("OIIO_LIBRARY_PATH")) << "set OIIO_LIBRARY_PATH to the plugin's folder";
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    m_before = fs::current_path().string();
    m_folder = testing::TempDir();
    m_folder += "anamorph_";
    m_folder += std::to_string(::getpid());
    m_folder += info->name();
    fs::remove_all(m_folder);
    fs::create_directories(m_folder);
    fs::current_path(m_folder);
}

void InFolder::TearDown() {
    fs::current_path(m_before);
    fs::remove_all(m_folder);
}

Ran run(const std::string& command) {
    Ran ran;
    int ends[2];
    if (::pipe(ends) != 0) return ran;
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(ends[1], 1);
        ::dup2(ends[1], 2);
        ::close(ends[0]);
        ::close(ends[1]);
        ::execlp("timeout", "timeout", "120", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
        ::_exit(127);
    }
    ::close(ends[1]);
    std::array<char, 4096> part;
    for (ssize_t n = 0; (n = ::read(ends[0], part.data(), part.size())) > 0;)
        ran.text.append(part.data(), static_cast<std::size_t>(n));
    ::close(ends[0]);
    int status = 0;
    rusage usage{};
    ::wait4(child, &status, 0, &usage);
    ran.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    ran.megabytes = double(usage.ru_maxrss) / 1024;
    return ran;
}

namespace {
// What a channel of a panorama has of a column, and of a row.
struct Waves {
    double wide, fine;
};
constexpr double kTurn = 6.283185307179586;
Waves column_waves(int x, int c, int width) {
    const double u = (x + 0.5) / width;
    return {std::sin(kTurn * (3 * u + c * 0.1)), std::sin(kTurn * 17 * u)};
}
Waves row_waves(int y, int c, int height) {
    const double v = (y + 0.5) / height;
    return {std::cos(kTurn * (2 * v + 0.3 * c)), std::sin(kTurn * 11 * v)};
}
float value_of(const Waves& column, const Waves& row, int x, int y, int c) {
    const double wave = column.wide * row.wide + 0.5 * column.fine * row.fine;
    const unsigned hash = (static_cast<unsigned>(x) * 73856093u) ^ (static_cast<unsigned>(y) * 19349663u) ^
                          (static_cast<unsigned>(c) * 83492791u);
    return static_cast<float>(0.45 + 0.25 * wave + 0.05 * double((hash >> 8) & 255) / 255);
}
}  // namespace

float panorama_value(int x, int y, int c, int width, int height) {
    return value_of(column_waves(x, c, width), row_waves(y, c, height), x, y, c);
}

OIIO::ImageBuf panorama(int width, int height, OIIO::TypeDesc type, int channels) {
    std::vector<Waves> columns;
    for (int x = 0; x < width; ++x)
        for (int c = 0; c < channels; ++c) columns.push_back(column_waves(x, c, width));
    std::vector<float> values;
    values.reserve(columns.size() * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        std::vector<Waves> row;
        for (int c = 0; c < channels; ++c) row.push_back(row_waves(y, c, height));
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const std::size_t c = i % row.size();
            values.push_back(
                value_of(columns[i], row[c], static_cast<int>(i / row.size()), y, static_cast<int>(c)));
        }
    }
    OIIO::ImageBuf image(OIIO::ImageSpec(width, height, channels, type));
    EXPECT_TRUE(image.set_pixels(OIIO::ROI::All(), OIIO::TypeFloat, values.data())) << image.geterror();
    return image;
}

void write_image(const OIIO::ImageBuf& image, const std::string& name) {
    ASSERT_TRUE(image.write(name)) << name << ": " << image.geterror();
}

void write_white(const std::string& name, int width, int height, int channels) {
    OIIO::ImageBuf image(OIIO::ImageSpec(width, height, channels, OIIO::TypeFloat));
    const std::vector<float> white(static_cast<std::size_t>(channels), 1.0f);
    OIIO::ImageBufAlgo::fill(image, white);
    write_image(image, name);
}

void draw(const std::string& name, const std::string& file) {
    OIIO::ImageBuf image(name);
    ASSERT_TRUE(image.read(0, 0, true, OIIO::TypeFloat)) << name << ": " << image.geterror();
    image.set_write_format(OIIO::TypeFloat);
    image.set_write_tiles(0, 0);
    write_image(image, file);
}

void write_panorama(const std::string& name, int width, int height, OIIO::TypeDesc type, int channels,
                    int tile) {
    OIIO::ImageBuf image = panorama(width, height, type, channels);
    if (tile > 0) image.set_write_tiles(tile, tile);
    write_image(image, name);
}

Pixels read_pixels(const std::string& name, int miplevel) {
    Pixels pixels;
    auto input = OIIO::ImageInput::open(name);
    if (!input) {
        ADD_FAILURE() << name << ": " << OIIO::geterror();
        return pixels;
    }
    pixels.spec = input->spec(0, miplevel);
    pixels.bytes.resize(pixels.spec.image_bytes());
    EXPECT_TRUE(
        input->read_image(0, miplevel, 0, pixels.spec.nchannels, pixels.spec.format, pixels.bytes.data()))
        << name << ": " << input->geterror();
    return pixels;
}

std::vector<float> read_floats(const std::string& name, int miplevel) {
    auto input = OIIO::ImageInput::open(name);
    if (!input) {
        ADD_FAILURE() << name << ": " << OIIO::geterror();
        return {};
    }
    const OIIO::ImageSpec spec = input->spec(0, miplevel);
    std::vector<float> pixels(static_cast<std::size_t>(spec.image_pixels()) *
                              static_cast<std::size_t>(spec.nchannels));
    EXPECT_TRUE(input->read_image(0, miplevel, 0, spec.nchannels, OIIO::TypeFloat, pixels.data()))
        << name << ": " << input->geterror();
    return pixels;
}

std::string open_error(const std::string& name) {
    auto input = OIIO::ImageInput::open(name);
    const std::string error = OIIO::geterror();
    EXPECT_FALSE(input) << name;
    return input ? "" : error;
}

int rounds(int at_night) {
    return std::getenv("ANAMORPH_NIGHTLY") ? at_night : at_night / 4;
}

void write_text(const std::string& name, const std::string& text) {
    std::ofstream(name, std::ios::binary) << text;
}

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    double largest = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        largest = std::max(largest, std::fabs(double(a[i]) - double(b[i])));
    return largest;
}

std::unique_ptr<OIIO::ImageInput> open(const std::string& name) {
    auto input = OIIO::ImageInput::open(name);
    EXPECT_TRUE(input) << name << ": " << OIIO::geterror();
    return input;
}

std::string joined(const std::vector<Assignment>& arguments) {
    std::vector<Assignment> all;
    for (const Assignment& a : arguments) {
        const auto same =
            std::find_if(all.begin(), all.end(), [&](const Assignment& b) { return b.key == a.key; });
        if (same == all.end())
            all.push_back(a);
        else
            same->value = a.value;
    }
    std::string text;
    for (const Assignment& a : all) text += (text.empty() ? "" : "&") + a.key + "=" + a.value;
    return text;
}

std::string example(const Operation& operation, const std::vector<std::string>& sources,
                    const std::vector<Assignment>& more) {
    for (const auto& [name, text] : operation.example.files) write_text(name, text);
    std::vector<Assignment> arguments;
    for (std::size_t i = 1; i < operation.least_sources; ++i)
        arguments.push_back({operation.sources[i], sources.at(i)});
    for (const Assignment& a : parse_recipe_name("?" + operation.example.arguments).assignments)
        arguments.push_back(a);
    arguments.insert(arguments.end(), more.begin(), more.end());
    const std::string base = operation.sources.empty() ? "picture" : sources.at(0);
    return base + "." + operation.name + "?" + joined(arguments);
}

OIIO::ParamValueList options(std::initializer_list<std::pair<const char*, const char*>> list) {
    OIIO::ParamValueList out;
    for (const auto& [key, value] : list) out.attribute(key, value);
    return out;
}

std::vector<std::byte> bytes(const OIIO::ImageBuf& image) {
    EXPECT_FALSE(image.has_error()) << image.geterror();
    std::vector<std::byte> out(image.spec().image_bytes());
    EXPECT_TRUE(image.get_pixels(image.roi(), image.spec().format, out.data())) << image.geterror();
    return out;
}

void expect_one_picture(const std::string& name, int x, int y) {
    SCOPED_TRACE(name);
    OIIO::attribute("threads", 1);
    const Pixels expected = read_pixels(name + "&tile=0");
    for (const char* tile : {"16", "17x31", "64", "512", "0"})
        for (const int threads : {1, 3}) {
            OIIO::attribute("threads", threads);
            EXPECT_EQ(read_pixels(name + "&tile=" + tile), expected) << tile << " " << threads;
        }
    OIIO::attribute("threads", 0);
    const std::string cut = " --cut 40x30+" + std::to_string(x) + "+" + std::to_string(y) + " -o ";
    const Ran ran = run("oiiotool '" + name + "&tile=32'" + cut + "cut.exr '" + name + "' -o whole.exr" +
                        cut + "cut_of_whole.exr");
    ASSERT_EQ(ran.status, 0) << ran.text;
    EXPECT_EQ(read_pixels("cut.exr").bytes, read_pixels("cut_of_whole.exr").bytes);
}

void expect_nothing_left_behind(const std::function<void(int, int)>& body, double megabytes) {
    const auto handles = [] {
        const fs::directory_iterator all("/proc/self/fd");
        return std::distance(begin(all), end(all));
    };
    const auto resident = [] {
        std::ifstream file("/proc/self/statm");
        long total = 0, pages = 0;
        file >> total >> pages;
        return double(pages) * 4096 / (1 << 20);
    };
    body(0, 200);
    const auto handles_before = handles();
    const double memory_before = resident();
    body(200, 200 + rounds(1000));
    EXPECT_LE(handles(), handles_before + 2);
#if defined(__SANITIZE_ADDRESS__)
    // Freed memory is kept from use.
    megabytes = HUGE_VAL;
#endif
    EXPECT_LE(resident(), memory_before + megabytes * rounds(1000) / 1000);
}

void read_from_threads(OIIO::ImageCache& cache, const std::vector<std::string>& names,
                       const std::vector<std::vector<float>>& expected, int width, int height) {
    std::atomic<int> wrong{0}, failed{0};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < 6; ++t)
        threads.emplace_back([&, t] {
            std::mt19937 random(t + 1);
            for (int i = 0; i < 1000; ++i) {
                const std::size_t n = random() % names.size();
                const int x = static_cast<int>(random() % unsigned(width)),
                          y = static_cast<int>(random() % unsigned(height));
                const std::size_t channels = expected[n].size() / static_cast<std::size_t>(width * height);
                std::vector<float> pixel(channels);
                if (!cache.get_pixels(OIIO::ustring(names[n]), 0, 0, x, x + 1, y, y + 1, 0, 1,
                                      OIIO::TypeFloat, pixel.data()))
                    ++failed;
                else if (!std::equal(pixel.begin(), pixel.end(),
                                     &expected[n][static_cast<std::size_t>(y * width + x) * channels]))
                    ++wrong;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(failed, 0) << cache.geterror();
}

}  // namespace anamorph::testing_oiio
