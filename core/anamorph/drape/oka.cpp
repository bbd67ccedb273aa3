// SPDX-License-Identifier: Apache-2.0
#include "anamorph/drape/oka.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "anamorph/drape/seen_range.h"
#include "anamorph/error.h"
#include "anamorph/parameter.h"

namespace anamorph {
namespace {

constexpr int kMostBlocks = 1 << 22;

using Taylor = std::array<Jet<Interval, 2>, 2>;

/// The length of the vector of polynomials of the second degree, over a quarter of a block from its centre to (right, down),
/// at most: part by part of it, so that its terms need not all be largest at once.
double length_of(const Taylor& p, double right, double down) {
    constexpr int kParts = 4;
    const auto part = [](double to, int i) {
        const double a = to * i / kParts, b = to * (i + 1) / kParts;
        return Interval(std::min(a, b), std::max(a, b));
    };
    double length = 0;
    for (int j = 0; j < kParts; ++j)
        for (int i = 0; i < kParts; ++i) {
            const Interval s = part(right, i), t = part(down, j);
            const auto size = [&](const Jet<Interval, 2>& g) {
                return magnitude(g.c[0] + g.c[1] * s + g.c[2] * t + g.c[3] * square(s) + g.c[4] * (s * t) +
                                 g.c[5] * square(t));
            };
            const double here = std::hypot(size(p[0]), size(p[1]));
            if (std::isnan(here)) return HUGE_VAL;
            length = std::max(length, here);
        }
    return length;
}

/// How far a block's map is off on the screen, at most: pixels.
double bound_of(const OkaBlock& map, const DrapedSurface& surface, const Camera& camera, double h, double k) {
    const Taylor centre = seen_range(camera, surface.range(Interval(map.u), Interval(map.v)));
    double size = 0;
    for (const double right : {-h, h})
        for (const double down : {-k, k}) {
            const auto from_centre = [](double to) { return Interval(std::min(0.0, to), std::max(0.0, to)); };
            const auto over = [&](double part) {
                return seen_range(camera, surface.range(from_centre(part * right) + map.u,
                                                        from_centre(part * down) + map.v));
            };
            // Of the integral of (1 - s) from 0 to 1, three quarters lie in the nearer half of the way.
            const Taylor near = over(0.5), far = over(1);
            Taylor off = centre;
            for (int i = 0; i < 2; ++i) {
                const auto axis = static_cast<std::size_t>(i);
                off[axis].c[0] -= map.centre[i];
                off[axis].c[1] -= map.by_u[i];
                off[axis].c[2] -= map.by_v[i];
                for (int n = 3; n < 6; ++n) off[axis].c[n] = near[axis].c[n] * 0.75 + far[axis].c[n] * 0.25;
            }
            size = std::max(size, length_of(off, right, down));
        }
    return size;
}

class BlockMaker {
  public:
    BlockMaker(const DrapedSurface& surface, const Camera& camera, const Size& picture,
               const OkaBlocks& blocks)
        : m_surface(surface), m_camera(camera), m_picture(picture), m_blocks(blocks) {
        m_made.grid_bits = grid_bits_of(camera.screen());
        m_made.inverse_depth = false;
        m_unit = std::ldexp(1.0, m_made.grid_bits);
        m_side = {blocks.side / picture.width, blocks.side / picture.height};
    }

    Facets make() {
        const Size count = oka_block_count(m_picture, m_blocks);
        for (int j = 0; j < count.height; ++j)
            for (int i = 0; i < count.width; ++i) add(i, j);
        const double h = (m_side.x + m_blocks.overlap / m_picture.width) / 2,
                     k = (m_side.y + m_blocks.overlap / m_picture.height) / 2;
        m_made.bound_of = [maps = std::move(m_maps), &surface = m_surface, camera = m_camera, h, k,
                           moved = grid_error(m_made.grid_bits)](std::uint32_t leaf) {
            return anamorph::bound_of(maps[leaf], surface, camera, h, k) + moved;
        };
        return std::move(m_made);
    }

  private:
    void add(int i, int j) {
        OkaBlock map;
        if (!oka_block(m_surface, m_camera, m_picture, m_blocks, i, j, map)) return;
        const double corners[4][2] = {{map.u0, map.v0}, {map.u1, map.v0}, {map.u1, map.v1}, {map.u0, map.v1}};
        const auto first = static_cast<std::uint32_t>(m_made.corners.size());
        for (const auto& [s, t] : corners)
            if (!add_corner(map, s, t)) {
                m_made.corners.resize(first);
                return;
            }
        const auto leaf = static_cast<std::uint32_t>(m_made.leaves.size());
        m_made.leaves.push_back({SurfacePatch::kNone, HUGE_VAL, glm::length(glm::dvec2(map.by_u)),
                                 glm::length(glm::dvec2(map.by_v))});
        m_maps.push_back(map);
        m_made.facets.push_back({{first, first + 1, first + 2}, leaf});
        m_made.facets.push_back({{first, first + 2, first + 3}, leaf});
    }
    /// False where it is too far off the screen.
    bool add_corner(const OkaBlock& map, double u, double v) {
        const glm::dvec3 at = map.centre + (u - map.u) * map.by_u + (v - map.v) * map.by_v;
        const double x = std::nearbyint(at.x * m_unit), y = std::nearbyint(at.y * m_unit);
        if (!(std::max(std::fabs(x), std::fabs(y)) <= kMostGrid)) return false;
        m_made.corners.push_back({x, y, 1, -(m_blocks.linear_depth ? at.z : map.centre.z), u, v});
        return true;
    }

    const DrapedSurface& m_surface;
    const Camera& m_camera;
    Size m_picture;
    OkaBlocks m_blocks;
    Facets m_made;
    std::vector<OkaBlock> m_maps;  ///< of the leaves
    double m_unit = 1;
    glm::dvec2 m_side{0.0};
};

}  // namespace

Size oka_block_count(const Size& picture, const OkaBlocks& blocks) {
    const auto count = [&](int pixels) { return std::ceil(pixels / blocks.side); };
    if (count(picture.width) * count(picture.height) > kMostBlocks)
        throw Error("block", shortest(blocks.side),
                    "makes more than " + std::to_string(kMostBlocks) + " blocks; must be larger");
    return {static_cast<int>(count(picture.width)), static_cast<int>(count(picture.height))};
}

bool oka_block(const DrapedSurface& surface, const Camera& camera, const Size& picture,
               const OkaBlocks& blocks, int i, int j, OkaBlock& block) {
    // Where a point of the picture is seen, and its depth.
    const auto seen = [&](double u, double v, glm::dvec3& at) {
        const glm::dvec3 p = camera.in_frame(surface.position(u, v));
        const Point<double> on_screen = camera.seen(p);
        at = {on_screen.x, on_screen.y, p.z};
        return p.z >= camera.near() && std::isfinite(at.x + at.y + at.z);
    };
    const double side_u = blocks.side / picture.width, side_v = blocks.side / picture.height;
    const double u = (i + 0.5) * side_u, v = (j + 0.5) * side_v;
    glm::dvec3 left, right, above, below;
    if (!seen(u, v, block.centre) || !seen(u - side_u, v, left) || !seen(u + side_u, v, right) ||
        !seen(u, v - side_v, above) || !seen(u, v + side_v, below))
        return false;
    block.u = u;
    block.v = v;
    block.by_u = (right - left) / (2 * side_u);
    block.by_v = (below - above) / (2 * side_v);
    const double wide_u = blocks.overlap / 2 / picture.width, wide_v = blocks.overlap / 2 / picture.height;
    block.u0 = std::max(0.0, i * side_u - wide_u);
    block.u1 = std::min(1.0, (i + 1) * side_u + wide_u);
    block.v0 = std::max(0.0, j * side_v - wide_v);
    block.v1 = std::min(1.0, (j + 1) * side_v + wide_v);
    return true;
}

Facets oka_facets(const DrapedSurface& surface, const Camera& camera, const Size& picture,
                  const OkaBlocks& blocks) {
    return BlockMaker(surface, camera, picture, blocks).make();
}

}  // namespace anamorph
