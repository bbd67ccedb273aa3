// SPDX-License-Identifier: Apache-2.0
// What the tests of the OpenImageIO side share: a folder of their own, test images, stock programs run as a
// user runs them.
#pragma once

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "anamorph/operation/operation.h"

namespace anamorph::testing_oiio {

/// Runs each test in an empty folder and removes it afterwards.
class InFolder : public testing::Test {
  protected:
    void SetUp() override;
    void TearDown() override;

  private:
    std::string m_folder, m_before;
};

struct Ran {
    int status = -1;       ///< exit status; 128 + signal where one ended it
    std::string text;      ///< standard output and error
    double megabytes = 0;  ///< largest resident size
};

/// Runs a shell command; one that takes longer than two minutes gets status 124.
Ran run(const std::string& command);

/// A panorama with detail everywhere, positive, not symmetric: channel c of pixel (x, y).
float panorama_value(int x, int y, int c, int width, int height);
OIIO::ImageBuf panorama(int width, int height, OIIO::TypeDesc type = OIIO::TypeFloat, int channels = 3);
/// Writes such a panorama to a file; `tile` 0: scanlines.
void write_panorama(const std::string& name, int width, int height, OIIO::TypeDesc type = OIIO::TypeFloat,
                    int channels = 3, int tile = 64);
void write_image(const OIIO::ImageBuf& image, const std::string& name);
/// Writes an image of floats that are all 1.
void write_white(const std::string& name, int width, int height, int channels);
/// Draws a recipe into a file of floats, as `oiiotool NAME -d float -o FILE` does, which takes a third of a second to start.
void draw(const std::string& name, const std::string& file);

/// The pixels of an image file as they are stored; the test fails where it cannot be read.
struct Pixels {
    OIIO::ImageSpec spec;
    std::vector<std::byte> bytes;
    friend bool operator==(const Pixels& a, const Pixels& b) {
        return a.spec.width == b.spec.width && a.spec.height == b.spec.height &&
               a.spec.nchannels == b.spec.nchannels && a.spec.format == b.spec.format && a.bytes == b.bytes;
    }
};
Pixels read_pixels(const std::string& name, int miplevel = 0);
std::vector<float> read_floats(const std::string& name, int miplevel = 0);

/// The message of an open that fails; "" and a failed test where it succeeds.
std::string open_error(const std::string& name);

/// A quarter of so many rounds of a long test; all of them where ANAMORPH_NIGHTLY is set.
int rounds(int at_night);

void write_text(const std::string& name, const std::string& text);

/// The plugin's input of this name; the test fails where it cannot be opened.
std::unique_ptr<OIIO::ImageInput> open(const std::string& name);

/// Joins the arguments of a recipe, later ones in place of earlier ones of the same key: "b=town.exr&t=0.3".
std::string joined(const std::vector<Assignment>& arguments);
/// The recipe that an operation gives as its example, of sources of these names (as many as it needs are
/// taken), with more arguments. Its side files are written to the working folder.
std::string example(const Operation& operation, const std::vector<std::string>& sources,
                    const std::vector<Assignment>& more = {});

/// Options of an operation.
OIIO::ParamValueList options(std::initializer_list<std::pair<const char*, const char*>> list);
/// The pixels of an image in memory, in its own format; the test fails where it has an error.
std::vector<std::byte> bytes(const OIIO::ImageBuf& image);

/// Checks that tile sizes, threads, and a cut of 40 x 30 pixels at (x, y) never change a recipe's pixels.
void expect_one_picture(const std::string& name, int x, int y);

/// Calls body(first, last) for 200 rounds, then for rounds(1000) more, and checks that these leave no handles open,
/// and of 1000 at most so many megabytes behind, in proportion.
void expect_nothing_left_behind(const std::function<void(int, int)>& body, double megabytes);

/// Reads random pixels of all these names through a cache, from several threads, and compares each with the
/// picture of width x height read whole.
void read_from_threads(OIIO::ImageCache& cache, const std::vector<std::string>& names,
                       const std::vector<std::vector<float>>& expected, int width, int height);

/// The largest difference of any channel.
double largest_difference(const std::vector<float>& a, const std::vector<float>& b);

}  // namespace anamorph::testing_oiio
