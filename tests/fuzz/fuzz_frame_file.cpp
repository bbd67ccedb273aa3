// SPDX-License-Identifier: Apache-2.0
// Frame files of any bytes: what is read is written and reads back as the same text.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/figure/files/frame_file.h"
#include "expect_error.h"

using namespace anamorph;
using namespace anamorph::figure;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    fuzz::expect_no_failure_but_error([&] {
        for (const FigureFrame& frame : parse_frames(text, "fuzz.3")) {
            const std::string written = frame_text(frame);
            const auto back = parse_frames(written, "again.3");
            fuzz::require(back.size() == 1, "a frame reads back");
            fuzz::require(back[0].bodies.size() == frame.bodies.size(), "all ellipsoids read back");
            fuzz::require(back[0].joints.size() == frame.joints.size(), "all joints read back");
            for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
                fuzz::require(back[0].bodies[i].shape.center == frame.bodies[i].shape.center,
                              "places read back");
                fuzz::require(back[0].bodies[i].name == frame.bodies[i].name, "names read back");
                fuzz::require(back[0].bodies[i].texture == frame.bodies[i].texture, "pictures read back");
            }
        }
    });
    return 0;
}
