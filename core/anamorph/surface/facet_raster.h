// SPDX-License-Identifier: Apache-2.0
// Facets on the pixels of a screen: for a box of them, the nearest facet at each pixel's centre and the point of the
// picture that is seen there (Oka 1987, section 5: a z-buffer).
//
// Edges are functions of integers, the same for both facets that share one but for the sign, and pixels on an edge
// belong to one of the two: nothing is drawn twice, and no pixel within a surface is left out.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/surface/facet_rows.h"
#include "anamorph/surface/facets.h"

namespace anamorph::surface {

/// The points of a surface that are seen at the pixels of a box, row by row.
struct SeenPixels {
    static constexpr double kNone = -1;

    Box box;
    std::ptrdiff_t stride = 0;
    std::vector<double> nearness;  ///< empty where that of a facet says it
    std::vector<double> u, v;      ///< from 0 to 1
    std::vector<double> facet;     ///< number of the facet, or kNone
    std::vector<double> bound;     ///< bounds of points that have one of their own (DrapeMap), else empty

    /// Makes these the pixels of a box, in which nothing is seen. `with_nearness`: each pixel has one.
    void clear(const Box& pixels, bool with_nearness = true);
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>((y - box.y0) * stride + x - box.x0);
    }
};

/// Finds facets by the squares of the screen that they meet.
class FacetRaster {
  public:
    /// Sorts the room's facets by squares, in the room.
    FacetRaster(FacetRoom& room, const Size& screen, int square);

    /// Draws what is seen in a box within one square and the pixels next to it. `times`: pixels of the box
    /// are so many times finer than those of the screen, 1 to 8.
    void draw(const Box& box, SeenPixels& seen, int times = 1) const;

    /// Receives a facet, a pixel that it covers, seen or not, and the point of the picture there.
    using Covered = std::function<void(std::uint32_t facet, int x, int y, double u, double v)>;
    /// Gives `covered` all facets at all pixels of a box as draw() takes it.
    void each_covered(const Box& box, int times, const Covered& covered) const;

  private:
    /// The pixels whose centres a facet may cover.
    Box pixels_of(const Facet& facet, int times) const;
    /// Calls body(facet) for the facets that may meet a box.
    template <class Body>
    void each_near(const Box& box, int times, const Body& body) const;
    /// Sets up a facet's functions from the corner of a part of its pixels on. False where it has no area.
    bool set_up(std::uint32_t facet, const Box& part, int times, simd::FacetSetup& setup) const;

    const Facets& m_facets;
    Size m_screen;
    int m_square, m_columns;
    double m_unit;
    std::vector<Box>& m_boxes;          ///< the pixels of each facet
    std::vector<std::size_t>& m_first;  ///< where a square's list begins
    std::vector<std::uint32_t>& m_lists;
};

}  // namespace anamorph::surface
