// SPDX-License-Identifier: Apache-2.0
// How boxes of target pixels are cut: into parts, and into blocks.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <optional>
#include <span>

#include "anamorph/geometry/box.h"
#include "anamorph/plan/block_writer.h"

namespace anamorph::plan_detail {

inline constexpr int kBlockWidth = BlockWriter::kWidth, kBlockHeight = BlockWriter::kHeight;
// The least side of boxes: below, a polynomial costs more than its pixels.
inline constexpr int kFloor = 8;

inline int pixels_of(const Box& box) {
    return box.width() * box.height();
}

inline bool is_block(const Box& box) {
    return box.width() <= kBlockWidth && box.height() <= kBlockHeight;
}

/// The block about the middle of a larger box.
inline Box middle_of(const Box& box) {
    const int x0 = (box.x0 + box.x1) / 2, y0 = (box.y0 + box.y1) / 2;
    return {x0, y0, std::min(x0 + kBlockWidth, box.x1), std::min(y0 + kBlockHeight, box.y1)};
}

/// A half of a box, whose first half is a power of two pixels wide or high.
inline Box sub_box(const Box& box, bool vertical_cut, bool second) {
    Box b = box;
    if (vertical_cut) {
        const int cut = box.x0 + static_cast<int>(std::bit_ceil(static_cast<unsigned>(box.width()))) / 2;
        (second ? b.x0 : b.x1) = cut;
    } else {
        const int cut = box.y0 + static_cast<int>(std::bit_ceil(static_cast<unsigned>(box.height()))) / 2;
        (second ? b.y0 : b.y1) = cut;
    }
    return b;
}

/// Is a box that is cut across its longer side (counted in blocks) cut from top to bottom?
inline bool is_cut_vertically(const Box& box) {
    const int wide = box.width() * kBlockHeight, high = box.height() * kBlockWidth;
    return wide > high || (wide == high && box.width() > kFloor);
}

/// Both halves of a box, cut the other way where the side asked for is no longer than `floor`. None where both are not.
inline std::optional<std::array<Box, 2>> halves_of(const Box& box, bool vertical_cut, int floor) {
    if (vertical_cut ? box.width() <= floor : box.height() <= floor) vertical_cut = !vertical_cut;
    if (vertical_cut ? box.width() <= floor : box.height() <= floor) return {};
    return {{sub_box(box, vertical_cut, false), sub_box(box, vertical_cut, true)}};
}

/// The quarters of a box, or its halves where one side is at the floor. None where both are.
class Quarters {
  public:
    explicit Quarters(const Box& box) {
        const bool across = box.width() > kFloor, down = box.height() > kFloor;
        if (!across && !down) return;
        for (const bool lower : {false, true})
            for (const bool right : {false, true}) {
                if ((lower && !down) || (right && !across)) continue;
                const Box row = down ? sub_box(box, false, lower) : box;
                m_boxes[m_count++] = across ? sub_box(row, true, right) : row;
            }
    }
    bool empty() const { return m_count == 0; }
    operator std::span<const Box>() const { return {m_boxes, m_count}; }

  private:
    Box m_boxes[4];
    std::size_t m_count = 0;
};

/// Calls body(part) for the parts of a box on a grid of width x height from its corner.
template <class Body>
void for_boxes(const Box& box, int width, int height, const Body& body) {
    for (int y = box.y0; y < box.y1; y += height)
        for (int x = box.x0; x < box.x1; x += width)
            body(Box{x, y, std::min(x + width, box.x1), std::min(y + height, box.y1)});
}
template <class Body>
void for_blocks(const Box& box, const Body& body) {
    for_boxes(box, kBlockWidth, kBlockHeight, body);
}

}  // namespace anamorph::plan_detail
