// SPDX-License-Identifier: Apache-2.0
// What the original programs printed for scripts, and what this one performs: the same to two units of the
// last digit printed (they computed in single precision), orientations compared as turns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "anamorph/figure/body/ellipsoid_distance.h"
#include "anamorph/figure/files/frame_file.h"
#include "figure_cases.h"

namespace anamorph::test_figure_perform_originals {
using namespace figure;
namespace {

using namespace figure_cases;

const std::string kFigures = std::string(ANAMORPH_TEST_DATA) + "/figures/";

std::string data(const std::string& name) {
    const auto text = text_of_file(kFigures + name);
    EXPECT_TRUE(text) << kFigures + name;
    return text.value_or("");
}

void compare(const std::string& script, const std::string& printed) {
    Performance performance(parse_program(script, "original.n"));
    const std::vector<FigureFrame> frames = all_frames(performance),
                                   expected = parse_frames(printed, "original.3");
    ASSERT_GT(expected.size(), 0u);
    ASSERT_EQ(frames.size(), expected.size());
    for (std::size_t i = 0; i < frames.size() && !testing::Test::HasFailure(); ++i)
        expect_as_printed(frames[i], expected[i]);
}

class FigureProbe : public testing::TestWithParam<const char*> {};

TEST_P(FigureProbe, PerformsAsTheOriginalPrints) {
    const std::string name = GetParam();
    compare(data(name + ".n"), data(name + ".3"));
}

// Each shows one action, one distribution or one rule of time. `touch1` has a test of its own.
INSTANTIATE_TEST_SUITE_P(All, FigureProbe,
                         testing::Values("abbrev", "abda", "abdb", "acc", "ang", "att", "bendto", "cub",
                                         "dec", "det", "drag1", "flexb", "grj", "grl", "grnd", "gro", "lin",
                                         "neg", "obs", "over", "plc", "quad", "rest", "rotb", "same", "spd",
                                         "spinto", "spinx", "spinz", "start5"),
                         [](const auto& probe) { return std::string(probe.param); });

// The original's search for a touch ends where the ellipsoids overlap (ratio below 0.8): here they touch.
TEST(FigureProbe, TouchTouchesWhereTheOriginalDoesNot) {
    const auto ratio = [](const FigureFrame& frame) {
        return contact_of(body_named(frame, "b").shape, body_named(frame, "c").shape).ratio;
    };
    Performance performance(parse_program(data("touch1.n"), "touch1.n"));
    EXPECT_NEAR(ratio(performance.frame(1)), 1, 1e-9);
    EXPECT_LT(ratio(parse_frames(data("touch1.3"), "touch1.3").at(0)), 0.8);
}

// The file itself, character by character, where the rounding of single precision does not show.
TEST(FigureProbe, PrintsTheSameText) {
    for (const char* const name : {"att", "cub", "drag1", "obs", "plc", "spd", "spinto"}) {
        SCOPED_TRACE(name);
        Performance performance(parse_program(data(std::string(name) + ".n"), name));
        std::string text;
        const std::vector<FigureFrame> frames = all_frames(performance);
        for (const FigureFrame& frame : frames) text += frame_text(frame);
        EXPECT_EQ(text + frames_end_text(frames.back()), data(std::string(name) + ".3"));
    }
}

// --- Scripts of the 1980s, which are not part of this project: tested where they are at hand.

/// What `xz` unpacks; nothing where it is not installed.
std::optional<std::string> unpacked(const std::string& path) {
    std::FILE* const pipe = popen(("xz -dc '" + path + "' 2>/dev/null").c_str(), "r");
    if (!pipe) return std::nullopt;
    std::string text;
    char buffer[4096];
    for (std::size_t read; (read = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
        text.append(buffer, read);
    if (pclose(pipe) != 0 || text.empty()) return std::nullopt;
    return text;
}

class FigureScript1980s : public testing::TestWithParam<const char*> {};

TEST_P(FigureScript1980s, PerformsAsTheOriginalPrints) {
    const char* const given = std::getenv("ANAMORPH_NUDES");
    const std::string folder = given ? given : std::string(ANAMORPH_TEST_DATA) + "/../../../shared/nudes";
    const std::string name = GetParam();
    const auto script = text_of_file(folder + "/scripts/" + name + ".n");
    const auto printed = unpacked(folder + "/frames/" + name + ".3.xz");
    if (!script || !printed) {
        std::printf("not at hand: %s/scripts/%s.n, %s/frames/%s.3.xz, xz\n", folder.c_str(), name.c_str(),
                    folder.c_str(), name.c_str());
        return;
    }
    compare(*script, *printed);
}

INSTANTIATE_TEST_SUITE_P(All, FigureScript1980s, testing::Values("chol", "juggle", "plane", "sault", "walk"),
                         [](const auto& probe) { return std::string(probe.param); });

}  // namespace
}  // namespace anamorph::test_figure_perform_originals
