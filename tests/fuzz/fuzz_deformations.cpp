// SPDX-License-Identifier: Apache-2.0
// Lists of deformations of any bytes: what can be read is written and read back, to the bit.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/deform/deformation_file.h"
#include "expect_error.h"

using namespace anamorph;

namespace {

template <class Parse, class Write>
void read(const Parse& parse, const Write& write, std::string_view text) {
    fuzz::expect_no_failure_but_error([&] {
        const auto list = parse(text, "fuzz");
        fuzz::require(parse(write(list), "written") == list, "a list reads back");
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    read(parse_entries_json, entries_json, text);
    read(parse_entries_csv, entries_csv, text);
    // What surfaces read: without names, images beside the others.
    using Write = std::string (*)(const std::vector<Deformation>&);
    read(parse_deformations_json, Write(deformations_json), text);
    read(parse_deformations_csv, Write(deformations_csv), text);
    return 0;
}
