// SPDX-License-Identifier: Apache-2.0
// Recipe files of any bytes, read as far as the map or the picture that they ask for.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/render/morph_parameters.h"
#include "anamorph/render/reproject_parameters.h"
#include "anamorph/render/warp_parameters.h"
#include "expect_error.h"

using namespace anamorph;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    fuzz::expect_no_failure_but_error([&] {
        ParameterValues values(reproject_parameters());
        values.assign(parse_recipe(text));
        const ReprojectRequest request = read_reproject_request(values, {1024, 512, std::nullopt});
        fuzz::require(request.target.width() > 0 && request.target.height() > 0, "a picture has pixels");
        fuzz::require(request.options.tol >= 0 && std::isfinite(request.options.tol), "tol is a number");

        const Panorama map = request.map();
        Point<double> point;
        int piece = 0;
        map.exact(request.target.width() / 2.0, request.target.height() / 2.0, 0, point, piece);
    });
    fuzz::expect_no_failure_but_error([&] {
        ParameterValues values(warp_parameters());
        values.assign(parse_recipe(text));
        const WarpRequest request = read_warp_request(values, {1024, 512});
        fuzz::require(request.target.width > 0 && request.target.height > 0, "a picture has pixels");
        fuzz::require(std::isfinite(request.options.amount) && request.step > 0,
                      "amount and step are numbers");
    });
    fuzz::expect_no_failure_but_error([&] {
        ParameterValues values(morph_parameters());
        values.assign(parse_recipe(text));
        const MorphRequest request = read_morph_request(values, {{1024, 512}, {64, 64}});
        fuzz::require(request.width > 0 && request.height > 0, "a picture has pixels");
        for (const int frame : {0, request.frames - 1})
            fuzz::require(std::isfinite(request.frame_options(frame).t), "t is a number");
    });
    return 0;
}
