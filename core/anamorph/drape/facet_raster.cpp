// SPDX-License-Identifier: Apache-2.0
#include "anamorph/drape/facet_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anamorph/simd/facet_rows.h"

namespace anamorph {
namespace {

/// Do pixels on the edge from a to b belong to the facet inside? Of an edge and its reverse one does.
bool owns(const FacetCorner& a, const FacetCorner& b) {
    return b.y > a.y || (b.y == a.y && b.x > a.x);
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

FacetRaster::FacetRaster(const Facets& facets, const Size& screen, int square)
    : m_facets(facets),
      m_screen(screen),
      m_square(square),
      m_columns((screen.width + square - 1) / square),
      m_unit(std::ldexp(1.0, facets.grid_bits)) {
    const int rows = (screen.height + square - 1) / square;
    // With a pixel around them.
    for (const Facet& facet : facets.facets) {
        const Box box = pixels_of(facet, 1);
        m_boxes.push_back(intersection({box.x0 - 1, box.y0 - 1, box.x1 + 1, box.y1 + 1},
                                       {0, 0, screen.width, screen.height}));
    }
    const auto each = [&](const auto& body) {
        for (std::size_t f = 0; f < m_boxes.size(); ++f) {
            const Box& b = m_boxes[f];
            if (b.empty()) continue;
            for (int row = b.y0 / square; row <= (b.y1 - 1) / square; ++row)
                for (int column = b.x0 / square; column <= (b.x1 - 1) / square; ++column)
                    body(static_cast<std::size_t>(row * m_columns + column), static_cast<std::uint32_t>(f));
        }
    };
    // Counted, added up, and put in their order.
    m_first.assign(static_cast<std::size_t>(m_columns * rows) + 1, 0);
    each([&](std::size_t at, std::uint32_t) { ++m_first[at + 1]; });
    for (std::size_t i = 1; i < m_first.size(); ++i) m_first[i] += m_first[i - 1];
    m_lists.resize(m_first.back());
    std::vector<std::size_t> next(m_first.begin(), m_first.end() - 1);
    each([&](std::size_t at, std::uint32_t f) { m_lists[next[at]++] = f; });
}

Box FacetRaster::pixels_of(const Facet& facet, int times) const {
    const Size screen{m_screen.width * times, m_screen.height * times};
    // In units of the grid's, all integers.
    std::int64_t x0 = INT64_MAX, y0 = INT64_MAX, x1 = INT64_MIN, y1 = INT64_MIN;
    for (const std::uint32_t corner : facet.corner) {
        const FacetCorner& c = m_facets.corners[corner];
        const auto x = static_cast<std::int64_t>(c.x), y = static_cast<std::int64_t>(c.y);
        x0 = std::min(x0, x);
        y0 = std::min(y0, y);
        x1 = std::max(x1, x);
        y1 = std::max(y1, y);
    }
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
    const double left = (part.x0 + 0.5 - m_screen.width * times / 2.0) * unit,
                 top = (part.y0 + 0.5 - m_screen.height * times / 2.0) * unit;
    for (int k = 0; k < 3; ++k) {
        // The edge across from corner k, whose function is the area at the corner and 0 at the others.
        const FacetCorner &a = *c[(k + 1) % 3], &b = *c[(k + 2) % 3], &corner = *c[k];
        setup.e[k] = edge_function(a, b, left, top);
        setup.right[k] = -(b.y - a.y) * unit;
        setup.down[k] = (b.x - a.x) * unit;
        setup.least[k] = owns(a, b) ? 0 : 1;
        setup.nearness[k] = corner.nearness / std::fabs(area);
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
    for (std::size_t i = m_first[square]; i < m_first[square + 1]; ++i)
        if (!intersection(m_boxes[m_lists[i]], pixels).empty()) body(m_lists[i]);
}

void FacetRaster::draw(const Box& box, SeenPixels& seen, int times) const {
    seen.clear(box);
    each_near(box, times, [&](std::uint32_t facet) {
        const Box part = intersection(pixels_of(m_facets.facets[facet], times), box);
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

}  // namespace anamorph
