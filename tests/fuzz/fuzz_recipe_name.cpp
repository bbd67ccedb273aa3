// SPDX-License-Identifier: Apache-2.0
// Recipe names of any bytes.
#include <cstddef>
#include <cstdint>
#include <string>

#include "anamorph/render/morph_parameters.h"
#include "anamorph/render/reproject_parameters.h"
#include "expect_error.h"

using namespace anamorph;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    fuzz::expect_no_failure_but_error([&] {
        const RecipeName name = parse_recipe_name(text);
        fuzz::require(text.starts_with(name.base), "a name starts with its base");
        for (const Assignment& a : name.assignments) {
            fuzz::require(!a.key.empty(), "a key is never empty");
            fuzz::require(text.find(a.value) != std::string::npos, "a value stands in the name as it is");
        }
        ParameterValues values(reproject_parameters());
        values.assign(name.assignments);
        read_reproject_request(values, {1024, 512, std::nullopt});
    });
    fuzz::expect_no_failure_but_error([&] {
        ParameterValues values(morph_parameters());
        values.assign(parse_recipe_name(text).assignments);
        read_morph_request(values, {{1024, 512}, {64, 64}, {8, 8}});
    });
    return 0;
}
