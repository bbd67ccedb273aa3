// SPDX-License-Identifier: Apache-2.0
// Motions and crystals of any bytes: whatever is read has frames of finite ellipsoids, which are written as glTF.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "anamorph/figure/files/motion_file.h"
#include "anamorph/figure/files/scene_file.h"
#include "expect_error.h"

using namespace anamorph;
using namespace anamorph::figure;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const char* name : {"fuzz.bvh", "fuzz.cif", "fuzz.mrasel"})
        fuzz::expect_no_failure_but_error([&] {
            const auto motion = read_motion(text, name);
            std::vector<FigureFrame> frames;
            for (int f = 0; f <= std::min(motion->last_frame(), 3); ++f) frames.push_back(motion->frame(f));
            for (const FigureFrame& frame : frames)
                for (const Body& body : frame.bodies)
                    for (int c = 0; c < 3; ++c)
                        fuzz::require(std::isfinite(body.shape.center[c]) && body.shape.axes[c] >= 0 &&
                                          std::isfinite(body.shape.axes[c]),
                                      "an ellipsoid is finite");
            // The library that writes JSON asks for memory to free what it built, and ends the program where there is none.
            fuzz::memory_may_fail = false;
            fuzz::require(glb_file(frames, 25).starts_with("glTF"), "frames become glTF");
            fuzz::memory_may_fail = true;
        });
    return 0;
}
