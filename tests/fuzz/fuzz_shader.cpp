// SPDX-License-Identifier: Apache-2.0
// Programs of pixel shaders of any bytes, assembled, listed, assembled again and run.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/machine/shader_run.h"
#include "expect_error.h"

using namespace anamorph;
using namespace anamorph::machine;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    fuzz::expect_no_failure_but_error([&] {
        const ShaderProgram program = assemble_shader(text, "fuzz");
        const std::string listing = shader_listing(program);
        fuzz::require(shader_listing(assemble_shader(listing, "listing")) == listing, "a listing reads back");
        using T = FormatNumber<kFloat24>;
        ShaderInputs<T> inputs(program);
        inputs.coordinates[0] = {T(0.25), T(-3.0), T(1e30), T(0.0)};
        ShaderMachine<T> machine(program, inputs);
        machine.run([](int number, const T& u, const T& v) {
            return ShaderVector<T>{u, v, T(number), T(1.0)};
        });
    });
    return 0;
}
