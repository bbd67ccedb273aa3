// SPDX-License-Identifier: Apache-2.0
// JPEG files, and XMP, of any bytes.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "anamorph/panorama/photo_sphere.h"
#include "expect_error.h"

using namespace anamorph;

namespace {

void check(const PhotoSphere& values, std::size_t size) {
    for (const auto& [name, value] : values)
        fuzz::require(name.size() + value.size() <= size, "a value is a part of the text");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    fuzz::expect_no_failure_but_error([&] {
        std::istringstream file(text);
        const std::string xmp = xmp_of_jpeg(file);
        fuzz::require(xmp.size() <= size, "XMP is a part of the file");
        check(photo_sphere_of(xmp), size);
        check(photo_sphere_of(text), size);
    });
    return 0;
}
