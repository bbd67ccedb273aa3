// SPDX-License-Identifier: Apache-2.0
// Databases of lenses of any bytes, as Lensfun reads them (users have some of their own): the first line is what is asked for, the
// rest XML. What is found is a lens that can be drawn with, or an error.
#include <lensfun/lensfun.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "anamorph/chart/chart.h"
#include "anamorph/lens_search.h"
#include "expect_error.h"

using namespace anamorph;

namespace {

/// The lens of a database, of pictures of this size.
void check(const lfDatabase& database, const LensName& name, const Size& size) {
    const FoundLens found = find_lens(database, "srclens", name, size);
    fuzz::require(found.focal_length > 0 && std::isfinite(found.focal_length), "a lens has a focal length");
    const std::string text = found.model.text();
    fuzz::require(LensModel::parse(text).values == found.model.values, "a lens is what its text says");
    const Projection projection = found.projection.value_or(Projection::rectilinear);
    fuzz::expect_no_failure_but_error([&] {
        const Chart chart(projection, size.width, size.height, 60, PixelSpacing::edges, "srclens", 1,
                          found.model);
        fuzz::require(chart.lens()->reach() > 0, "a lens has a picture");
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // Lensfun and its parser do not stand for memory that is not there.
    fuzz::memory_may_fail = false;
    const std::string_view input(reinterpret_cast<const char*>(data), size);
    const std::size_t line = std::min(input.find('\n'), input.size());
    const std::string_view asked = input.substr(0, line), xml = input.substr(std::min(line + 1, size));
    fuzz::expect_no_failure_but_error([&] {
        if (!is_of_lens_database(asked)) throw Error("the first line must be lensfun:lens=NAME");
        const LensName name = parse_lens_name("srclens", std::string(asked));
        lfDatabase database;
        if (database.Load("fuzz.xml", xml.data(), xml.size()) != LF_NO_ERROR) throw Error("is no database");
        for (const Size& pixels : {Size{600, 400}, Size{1, 1}}) check(database, name, pixels);
    });
    return 0;
}
