// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/facet_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anamorph/surface/facet_rows.h"

namespace anamorph::surface {
namespace {

/// Do pixels on the edge from a to b belong to the facet inside? Of an edge and its reverse one does.
bool owns(const FacetCorner& a, const FacetCorner& b) {
    return b.y > a.y || (b.y == a.y && b.x > a.x);
}

Box with_margin(const Box& box) {
    return {box.x0 - 1, box.y0 - 1, box.x1 + 1, box.y1 + 1};
}

}  // namespace

void SeenPixels::clear(const Box& pixels, bool with_nearness) {
    box = pixels;
    stride = pixels.width() + 16;
    const auto room = static_cast<std::size_t>(stride * box.height());
    nearness.assign(with_nearness ? room : 0, -std::numeric_limits<double>::infinity());
    u.resize(room);
    v.resize(room);
    facet.assign(room, kNone);
    bound.clear();
}

FacetRaster::FacetRaster(FacetRoom& room, const Size& screen, int square)
    : m_facets(room.facets),
      m_screen(screen),
      m_square(square),
      m_columns((screen.width + square - 1) / square),
      m_unit(std::ldexp(1.0, room.facets.grid_bits)),
      m_boxes(room.boxes),
      m_first(room.first),
      m_lists(room.lists) {
    const int rows = (screen.height + square - 1) / square;
    const auto square_of = [&](int at) {
        return static_cast<std::uint16_t>(static_cast<unsigned>(at) / static_cast<unsigned>(square));
    };
    m_boxes.clear();
    room.squares.clear();
    m_first.assign(static_cast<std::size_t>(m_columns * rows) + 1, 0);
    const auto each = [&](const FacetRoom::Squares& s, const auto& body) {
        for (int row = s.y0; row <= s.y1; ++row)
            for (int column = s.x0; column <= s.x1; ++column)
                body(static_cast<std::size_t>(row * m_columns + column));
    };
    // Counted, added up, and put in their order.
    for (const Facet& facet : m_facets.facets) {
        m_boxes.push_back(pixels_of(facet, 1));
        const Box b = intersection(with_margin(m_boxes.back()), {0, 0, screen.width, screen.height});
        room.squares.push_back(b.empty() ? FacetRoom::Squares{1, 1, 0, 0}
                                         : FacetRoom::Squares{square_of(b.x0), square_of(b.y0),
                                                              square_of(b.x1 - 1), square_of(b.y1 - 1)});
        each(room.squares.back(), [&](std::size_t at) { ++m_first[at + 1]; });
    }
    for (std::size_t i = 1; i < m_first.size(); ++i) m_first[i] += m_first[i - 1];
    m_lists.resize(m_first.back());
    // Each square's beginning moves to its end, which is the beginning of the next.
    for (std::size_t f = 0; f < m_boxes.size(); ++f)
        each(room.squares[f],
             [&](std::size_t at) { m_lists[m_first[at]++] = static_cast<std::uint32_t>(f); });
    std::rotate(m_first.begin(), m_first.end() - 1, m_first.end());
    m_first.front() = 0;
}

Box FacetRaster::pixels_of(const Facet& facet, int times) const {
    const Size screen{m_screen.width * times, m_screen.height * times};
    // In units of the grid's, all integers.
    const FacetCorner &a = m_facets.corners[facet.corner[0]], &b = m_facets.corners[facet.corner[1]],
                      &c = m_facets.corners[facet.corner[2]];
    const auto x0 = static_cast<std::int64_t>(std::min(std::min(a.x, b.x), c.x)),
               y0 = static_cast<std::int64_t>(std::min(std::min(a.y, b.y), c.y)),
               x1 = static_cast<std::int64_t>(std::max(std::max(a.x, b.x), c.x)),
               y1 = static_cast<std::int64_t>(std::max(std::max(a.y, b.y), c.y));
    // Pixel i has its centre at i + 1/2 - width / 2; places are counted in halves of units, so that this is one too.
    const int bits = m_facets.grid_bits + 1;
    const auto at = [&](std::int64_t place, int size) {
        return 2 * times * place + (std::int64_t{size - 1} << (bits - 1));
    };
    const auto first = [&](std::int64_t place, int size) {
        return static_cast<int>((at(place, size) + (std::int64_t{1} << bits) - 1) >> bits);
    };
    const auto end = [&](std::int64_t place, int size) {
        return static_cast<int>(at(place, size) >> bits) + 1;
    };
    return intersection(
        {first(x0, screen.width), first(y0, screen.height), end(x1, screen.width), end(y1, screen.height)},
        {0, 0, screen.width, screen.height});
}

bool FacetRaster::set_up(std::uint32_t index, const Box& part, int times, simd::FacetSetup& setup) const {
    const double unit = m_unit / times;
    const Facet& facet = m_facets.facets[index];
    const FacetCorner* c[3];
    for (int k = 0; k < 3; ++k) c[k] = &m_facets.corners[facet.corner[k]];
    const double area = edge_function(*c[0], *c[1], c[2]->x, c[2]->y);
    if (area == 0) return false;
    if (area < 0) std::swap(c[1], c[2]);
    const double inverse = 1 / std::fabs(area);
    const double left = (part.x0 + 0.5 - m_screen.width * times / 2.0) * unit,
                 top = (part.y0 + 0.5 - m_screen.height * times / 2.0) * unit;
    for (int k = 0; k < 3; ++k) {
        // The edge across from corner k, whose function is the area at the corner and 0 at the others.
        const FacetCorner &a = *c[(k + 1) % 3], &b = *c[(k + 2) % 3], &corner = *c[k];
        setup.e[k] = edge_function(a, b, left, top);
        setup.right[k] = -(b.y - a.y) * unit;
        setup.down[k] = (b.x - a.x) * unit;
        setup.least[k] = owns(a, b) ? 0 : 1;
        setup.nearness[k] = corner.nearness * inverse;
        setup.weight[k] = corner.weight;
        setup.u[k] = corner.weight * corner.u;
        setup.v[k] = corner.weight * corner.v;
    }
    setup.id = index;
    return true;
}

template <class Body>
void FacetRaster::each_near(const Box& box, int times, const Body& body) const {
    if (box.empty()) return;
    // Of the square in the middle: the box may reach over its edges by a pixel.
    const int row = (box.y0 + box.y1) / 2 / times / m_square,
              column = (box.x0 + box.x1) / 2 / times / m_square;
    const auto square = static_cast<std::size_t>(row * m_columns + column);
    const Box pixels{box.x0 / times, box.y0 / times, (box.x1 - 1) / times + 1, (box.y1 - 1) / times + 1};
    for (std::size_t i = m_first[square]; i < m_first[square + 1]; ++i) {
        // Where no pixel's centre is covered a sample may be.
        const Box& own = m_boxes[m_lists[i]];
        if (!intersection(times == 1 ? own : with_margin(own), pixels).empty()) body(m_lists[i]);
    }
}

void FacetRaster::draw(const Box& box, SeenPixels& seen, int times) const {
    seen.clear(box);
    each_near(box, times, [&](std::uint32_t facet) {
        const Box part =
            intersection(times == 1 ? m_boxes[facet] : pixels_of(m_facets.facets[facet], times), box);
        simd::FacetSetup setup;
        if (part.empty() || !set_up(facet, part, times, setup)) return;
        const std::size_t at = seen.index(part.x0, part.y0);
        simd::draw_facet(setup, part.width(), part.height(),
                         {seen.nearness.data() + at, seen.u.data() + at, seen.v.data() + at,
                          seen.facet.data() + at, seen.stride});
    });
}

void FacetRaster::each_covered(const Box& box, int times, const Covered& covered) const {
    each_near(box, times, [&](std::uint32_t facet) {
        const Box part = intersection(pixels_of(m_facets.facets[facet], times), box);
        simd::FacetSetup s;
        if (part.empty() || !set_up(facet, part, times, s)) return;
        for (int j = 0; j < part.height(); ++j)
            for (int i = 0; i < part.width(); ++i) {
                double weight = 0, u = 0, v = 0;
                bool in = true;
                for (int k = 0; k < 3; ++k) {
                    const double e = s.e[k] + j * s.down[k] + i * s.right[k];
                    in = in && e >= s.least[k];
                    weight += e * s.weight[k];
                    u += e * s.u[k];
                    v += e * s.v[k];
                }
                if (in) covered(facet, part.x0 + i, part.y0 + j, u / weight, v / weight);
            }
    });
}

}  // namespace anamorph::surface
