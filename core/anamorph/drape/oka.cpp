// SPDX-License-Identifier: Apache-2.0
#include "anamorph/drape/oka.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/error.h"
#include "anamorph/parameter.h"

namespace anamorph {
namespace {

constexpr int kMostBlocks = 1 << 22;

/// A block's linear map: x, y and depth of a point of the screen, its centre's, and what they gain by u and by v.
struct LinearMap {
    glm::dvec3 centre, by_u, by_v;
};

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
        const auto count = [&](int pixels) { return static_cast<int>(std::ceil(pixels / m_blocks.side)); };
        if (double(count(m_picture.width)) * count(m_picture.height) > kMostBlocks)
            throw Error("block", shortest(m_blocks.side),
                        "makes more than " + std::to_string(kMostBlocks) + " blocks; must be larger");
        for (int j = 0; j < count(m_picture.height); ++j)
            for (int i = 0; i < count(m_picture.width); ++i) add(i, j);
        return std::move(m_made);
    }

  private:
    /// Where a point of the picture is seen, and its depth. False where it is not in front of the camera.
    bool seen(double u, double v, glm::dvec3& at) const {
        const glm::dvec3 p = m_camera.in_frame(m_surface.position(u, v));
        const Point<double> on_screen = m_camera.seen(p);
        at = {on_screen.x, on_screen.y, p.z};
        return p.z >= m_camera.near() && std::isfinite(at.x + at.y + at.z);
    }

    void add(int i, int j) {
        const double u = (i + 0.5) * m_side.x, v = (j + 0.5) * m_side.y;
        LinearMap map;
        glm::dvec3 left, right, above, below;
        if (!seen(u, v, map.centre) || !seen(u - m_side.x, v, left) || !seen(u + m_side.x, v, right) ||
            !seen(u, v - m_side.y, above) || !seen(u, v + m_side.y, below))
            return;
        map.by_u = (right - left) / (2 * m_side.x);
        map.by_v = (below - above) / (2 * m_side.y);
        // The block and its share of the common area, within the picture.
        const double wide_u = m_blocks.overlap / 2 / m_picture.width,
                     wide_v = m_blocks.overlap / 2 / m_picture.height;
        const double u0 = std::max(0.0, i * m_side.x - wide_u),
                     u1 = std::min(1.0, (i + 1) * m_side.x + wide_u),
                     v0 = std::max(0.0, j * m_side.y - wide_v),
                     v1 = std::min(1.0, (j + 1) * m_side.y + wide_v);
        const double corners[4][2] = {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}};
        const auto first = static_cast<std::uint32_t>(m_made.corners.size());
        for (const auto& [s, t] : corners)
            if (!add_corner(map, s, t, s - u, t - v)) {
                m_made.corners.resize(first);
                return;
            }
        const auto leaf = static_cast<std::uint32_t>(m_made.leaves.size());
        m_made.leaves.push_back({SurfacePatch::kNone, bound(u, v, wide_u, wide_v),
                                 glm::length(glm::dvec2(map.by_u)), glm::length(glm::dvec2(map.by_v))});
        m_made.facets.push_back({{first, first + 1, first + 2}, leaf});
        m_made.facets.push_back({{first, first + 2, first + 3}, leaf});
    }
    /// False where it is too far off the screen.
    bool add_corner(const LinearMap& map, double u, double v, double from_u, double from_v) {
        const glm::dvec3 at = map.centre + from_u * map.by_u + from_v * map.by_v;
        const double x = std::nearbyint(at.x * m_unit), y = std::nearbyint(at.y * m_unit);
        if (!(std::max(std::fabs(x), std::fabs(y)) <= kMostGrid)) return false;
        m_made.corners.push_back({x, y, 1, -(m_blocks.linear_depth ? at.z : map.centre.z), u, v});
        return true;
    }

    double bound(double u, double v, double wide_u, double wide_v) const {
        using J = Jet<Interval, 2>;
        const double h = m_side.x / 2 + wide_u, k = m_side.y / 2 + wide_v;
        const double reach_u = std::max(m_side.x, h), reach_v = std::max(m_side.y, k);
        const SurfaceRange f = m_surface.range({u - reach_u, u + reach_u}, {v - reach_v, v + reach_v});
        J in_frame[3];
        for (int i = 0; i < 3; ++i)
            in_frame[i] = f[0] * m_camera.matrix()[0][i] + f[1] * m_camera.matrix()[1][i] +
                          f[2] * m_camera.matrix()[2][i] + m_camera.offset()[i];
        const auto off = [&](const J& coordinate) {
            const J g = (m_camera.perspective() ? coordinate / in_frame[2] : coordinate) * m_camera.focal();
            const double uu = 2 * magnitude(g.c[3]), uv = magnitude(g.c[4]), vv = 2 * magnitude(g.c[5]);
            return (h * m_side.x * uu + k * m_side.y * vv + h * h * uu + 2 * h * k * uv + k * k * vv) / 2;
        };
        const double size = std::hypot(off(in_frame[0]), off(in_frame[1])) + grid_error(m_made.grid_bits);
        return std::isnan(size) ? HUGE_VAL : size;
    }

    const DrapedSurface& m_surface;
    const Camera& m_camera;
    Size m_picture;
    OkaBlocks m_blocks;
    Facets m_made;
    double m_unit = 1;
    glm::dvec2 m_side{0.0};
};

}  // namespace

Facets oka_facets(const DrapedSurface& surface, const Camera& camera, const Size& picture,
                  const OkaBlocks& blocks) {
    return BlockMaker(surface, camera, picture, blocks).make();
}

}  // namespace anamorph
