// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/source.h"

#include <cstdint>
#include <cstring>

namespace anamorph {
namespace {

/// Where the edge of a texel of `from` lies among `to` others, rounded down.
int edge_below(std::int64_t edge, int from, int to) {
    const std::int64_t at = edge * to;
    return static_cast<int>(at / from - (at % from < 0 ? 1 : 0));
}
int edge_above(std::int64_t edge, int from, int to) {
    return -edge_below(-edge, from, to);
}

}  // namespace

Box texels_over(const Box& box, const Size& from, const Size& to) noexcept {
    return {edge_below(box.x0, from.width, to.width), edge_below(box.y0, from.height, to.height),
            edge_above(box.x1, from.width, to.width), edge_above(box.y1, from.height, to.height)};
}

Box texels_within(const Box& box, const Size& from, const Size& to) noexcept {
    return {edge_above(box.x0, from.width, to.width), edge_above(box.y0, from.height, to.height),
            edge_below(box.x1, from.width, to.width), edge_below(box.y1, from.height, to.height)};
}

SourceLevel Source::level(int level) const noexcept {
    const Size own = size(level);
    const Box all = extent(level);
    if (level == 0 || all == SourceLevel(own).extent) return {own, all};
    // A texel is made of those that it meets on the level before.
    Box whole = extent(0);
    for (int i = 1; i <= level; ++i) whole = texels_within(whole, size(i - 1), size(i));
    return {own, all, whole};
}

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
