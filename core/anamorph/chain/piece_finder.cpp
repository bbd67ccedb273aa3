// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chain/piece_finder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace anamorph {
namespace {

double area_of(const Box& box) {
    return double(box.width()) * box.height();
}

}  // namespace

PieceFinder::PieceFinder(std::vector<Box> pieces) : m_pieces(std::move(pieces)), m_frame(m_pieces[0]) {
    double area = 0;
    for (const Box& piece : m_pieces) {
        m_frame = {std::min(m_frame.x0, piece.x0), std::min(m_frame.y0, piece.y0),
                   std::max(m_frame.x1, piece.x1), std::max(m_frame.y1, piece.y1)};
        area += area_of(piece);
    }
    m_have_gaps = area < area_of(m_frame);
    // About as many buckets as pieces.
    while (double(m_side) * m_side * double(m_pieces.size()) < area_of(m_frame)) m_side *= 2;
    m_columns = m_frame.width() / m_side + 1;
    m_rows = m_frame.height() / m_side + 1;
    m_buckets.resize(static_cast<std::size_t>(m_columns) * static_cast<std::size_t>(m_rows));
    for (std::size_t i = 0; i < m_pieces.size(); ++i) {
        const Box of{(m_pieces[i].x0 - m_frame.x0) / m_side, (m_pieces[i].y0 - m_frame.y0) / m_side,
                     (m_pieces[i].x1 - m_frame.x0) / m_side, (m_pieces[i].y1 - m_frame.y0) / m_side};
        for (int row = of.y0; row <= of.y1; ++row)
            for (int column = of.x0; column <= of.x1; ++column)
                m_buckets[static_cast<std::size_t>(row * m_columns + column)].push_back(static_cast<int>(i));
    }
}

std::size_t PieceFinder::bucket_of(double x, double y) const {
    const int column = static_cast<int>((x - m_frame.x0) / m_side),
              row = static_cast<int>((y - m_frame.y0) / m_side);
    return static_cast<std::size_t>(row * m_columns + column);
}

int PieceFinder::holding(const Interval& x, const Interval& y) const {
    const auto holds = [](const Box& box, const Interval& along, const Interval& down) {
        return along.lo >= box.x0 && along.hi <= box.x1 && down.lo >= box.y0 && down.hi <= box.y1;
    };
    if (!holds(m_frame, x, y)) return -1;
    if (m_pieces.size() == 1) return 0;
    // What holds a box holds its corner.
    for (const int i : m_buckets[bucket_of(x.lo, y.lo)])
        if (holds(m_pieces[static_cast<std::size_t>(i)], x, y)) return i;
    return -1;
}

}  // namespace anamorph
