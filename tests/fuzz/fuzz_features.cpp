// SPDX-License-Identifier: Apache-2.0
// Feature files of any bytes, by all three readers, as far as the map that they make.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/morph/features_file.h"
#include "expect_error.h"

using namespace anamorph;

namespace {

template <class Parse>
void read(const Parse& parse, std::string_view text) {
    fuzz::expect_no_failure_but_error([&] {
        const Features features = parse(text, "fuzz");
        fuzz::require(features.size() > 0, "a file has features");
        fuzz::require(features.shapes() >= 2, "a morph has shapes");
        const auto shapes = static_cast<std::size_t>(features.shapes());
        const std::vector<Size> sizes(shapes, {64, 48});
        std::vector<double> mixture(shapes, 0.0);
        mixture[0] = mixture[1] = 0.5;
        const FeatureMap map(features, sizes, {64, 48}, mixture, {});
        const Point<double> p = map(12.5, 30.5, 0);
        fuzz::require(std::isfinite(p.x) && std::isfinite(p.y), "a map has points");
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    read(parse_features_json, text);
    read(parse_features_csv, text);
    read(parse_features_svg, text);
    return 0;
}
