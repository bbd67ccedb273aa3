// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/source.h"

#include <cstring>

namespace anamorph {

bool MemorySource::read(int, const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const noexcept {
    const std::size_t pixel =
        static_cast<std::size_t>(m_image.channels) * static_cast<std::size_t>(size_of(m_image.type));
    for (int y = box.y0; y < box.y1; ++y, texels += row_stride) {
        if (m_image.packed()) {
            std::memcpy(texels, m_image.at(box.x0, y), pixel * static_cast<std::size_t>(box.width()));
            continue;
        }
        for (int x = box.x0; x < box.x1; ++x)
            std::memcpy(texels + pixel * static_cast<std::size_t>(x - box.x0), m_image.at(x, y), pixel);
    }
    return true;
}

}  // namespace anamorph
