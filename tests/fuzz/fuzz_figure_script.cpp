// SPDX-License-Identifier: Apache-2.0
// Scripts of any bytes, parsed in both dialects and performed for some frames, forwards and backwards.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/figure/files/frame_file.h"
#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/script.h"
#include "expect_error.h"

using namespace anamorph;
using namespace anamorph::figure;

namespace {

void perform(const Program& program) {
    PerformanceOptions options;
    options.memory = 4096;  // states are thinned out at once
    options.message = [](const std::string& line) {
        fuzz::require(line.find_first_of("\r\n") == std::string::npos, "a message is one line");
    };
    Performance performance(program, options);
    // The frames of a script may be many, and far apart.
    constexpr int kLast = 40;
    if (performance.first_frame() > kLast) return;
    int shown = 0;
    FigureFrame last;
    performance.for_each_frame([&](const FigureFrame& frame) {
        last = frame;
        for (const Body& body : frame.bodies)
            fuzz::require(std::isfinite(body.shape.center.x) && body.shape.axes.x >= 0, "places are numbers");
        ++shown;
        return frame.number + performance.frame_step() <= kLast;
    });
    if (shown == 0) return;
    const FigureFrame again = performance.frame(last.number);
    for (std::size_t i = 0; i < last.bodies.size(); ++i)
        fuzz::require(last.bodies[i].shape == again.bodies[i].shape,
                      "a frame is the same when asked for again");
    fuzz::require(performance.frame(std::min(last.number, 1)).bodies.size() == last.bodies.size(),
                  "all stay");
    const std::string text = frame_text(last) + frames_end_text(last);
    fuzz::require(parse_frames(text, "fuzz.3").size() == (last.bodies.empty() ? 0u : 1u), "frames read back");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    for (const Dialect dialect : {Dialect::classic, Dialect::strict}) {
        ScriptOptions options;
        options.dialect = dialect;
        // A text may include itself, or its second half.
        options.include = [&](const std::string& name) {
            return std::optional<std::string>(name == "self" ? text : text.substr(text.size() / 2));
        };
        if (data[0] & 1) options.libraries = {"half"};
        const Script script = parse_script(text, "fuzz.n", options);
        for (const Diagnostic& d : script.diagnostics)
            fuzz::require(d.text().find_first_of("\r\n") == std::string::npos, "a diagnostic is one line");
        if (script.ok()) fuzz::expect_no_failure_but_error([&] { perform(script.program); });
    }
    return 0;
}
