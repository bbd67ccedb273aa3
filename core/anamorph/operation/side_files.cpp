// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/side_files.h"

#include <algorithm>
#include <cstddef>

#include "anamorph/error.h"

namespace anamorph {

std::vector<float> read_display(SideImage& image, int count, const std::string& what) {
    const Size size = image.size();
    const Box data{0, 0, size.width, size.height}, display = image.display();
    if (!(intersection(display, data) == display))
        throw Error(what + " has pixels in a part of its display window only: must have them in all of it");
    std::vector<float> all = image.read(count);
    if (display == data) return all;
    std::vector<float> shown;
    const auto values = [&](int pixels) { return std::ptrdiff_t{pixels} * count; };
    shown.reserve(static_cast<std::size_t>(values(display.width()) * display.height()));
    for (int y = display.y0; y < display.y1; ++y) {
        const auto row = all.begin() + values(size.width) * y + values(display.x0);
        shown.insert(shown.end(), row, row + values(display.width()));
    }
    return shown;
}

}  // namespace anamorph
