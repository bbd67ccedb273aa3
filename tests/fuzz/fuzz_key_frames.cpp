// SPDX-License-Identifier: Apache-2.0
// Key frames of any bytes: what can be read is a number at any time.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/deform/key_frames_file.h"
#include "expect_error.h"

using namespace anamorph;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    fuzz::expect_no_failure_but_error([&] {
        for (const NamedKeyFrames& keys : parse_key_frames_json(text, "fuzz"))
            for (const double time : {-1e9, 0.0, 0.5, 1.0, 1e9})
                for (const double number : keys.frames.at(time))
                    fuzz::require(!std::isnan(number), "a value is a number");
    });
    return 0;
}
