// SPDX-License-Identifier: Apache-2.0
// Recipe files of any bytes, read by every operation as far as the picture that they ask for.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/operation/pano.h"
#include "expect_error.h"
#include "read_operation.h"

using namespace anamorph;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const Operation* operation : operations())
        fuzz::expect_no_failure_but_error([&] { fuzz::read_operation(*operation, parse_recipe(text)); });
    fuzz::expect_no_failure_but_error([&] {
        ParameterValues values(*pano_operation().parameters);
        values.assign(parse_recipe(text));
        const ReprojectRequest request = read_reproject_request(values, {1024, 512, std::nullopt});
        const Panorama map = request.map();
        Point<double> point;
        int piece = 0;
        map.exact(request.target.width() / 2.0, request.target.height() / 2.0, 0, point, piece);
    });
    return 0;
}
