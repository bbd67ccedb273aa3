// SPDX-License-Identifier: Apache-2.0
// Recipe names of any bytes.
#include <cstddef>
#include <cstdint>
#include <string>

#include "expect_error.h"
#include "read_operation.h"

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
    });
    for (const Operation* operation : operations())
        fuzz::expect_no_failure_but_error(
            [&] { fuzz::read_operation(*operation, parse_recipe_name(text).assignments); });
    return 0;
}
