// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/edges.h"

#include <algorithm>
#include <cmath>

namespace anamorph::surface {
namespace {

// Samples are drawn for squares of this side at a time.
constexpr int kCell = 8;

// From pixel to pixel points go on as far as next to them, or up to so many times farther.
constexpr double kSteady = 4;

struct Step {
    double u, v;
    double size() const { return std::max(std::fabs(u), std::fabs(v)); }
};

/// What is seen, by places in its rows.
class Seen {
  public:
    Seen(const DrapeMap& map, const SeenPixels& pixels) : m_map(map), m_pixels(pixels) {}

    /// Does an edge go between (x, y) and its neighbours?
    bool edge_at(int x, int y) const {
        return breaks(x, y, 1, 0) || breaks(x, y, -1, 0) || breaks(x, y, 0, 1) || breaks(x, y, 0, -1);
    }

  private:
    bool inside(int x, int y) const {
        const Box& b = m_pixels.box;
        return x >= b.x0 && x < b.x1 && y >= b.y0 && y < b.y1;
    }
    double facet(int x, int y) const { return m_pixels.facet[m_pixels.index(x, y)]; }
    std::uint32_t leaf(double facet) const { return m_map.facet(facet).leaf; }
    /// Have two facets a corner in common?
    bool touch(double a, double b) const {
        const auto& p = m_map.facet(a).corner;
        const auto& q = m_map.facet(b).corner;
        return std::any_of(std::begin(p), std::end(p), [&](std::uint32_t corner) {
            return corner == q[0] || corner == q[1] || corner == q[2];
        });
    }
    Step step(int x, int y, int dx, int dy) const {
        const std::size_t a = m_pixels.index(x, y), b = m_pixels.index(x + dx, y + dy);
        return {m_pixels.u[b] - m_pixels.u[a], m_pixels.v[b] - m_pixels.v[a]};
    }
    /// Between (x, y) and its neighbour at (dx, dy).
    bool breaks(int x, int y, int dx, int dy) const {
        if (!inside(x + dx, y + dy)) return false;
        const double here = facet(x, y), there = facet(x + dx, y + dy);
        if (here == there) return false;
        if (here == SeenPixels::kNone || there == SeenPixels::kNone) return true;
        if (leaf(here) == leaf(there) || touch(here, there)) return false;
        const auto jacobian = [&](double f) {
            return m_map.jacobian_of(m_map.facet(f), x + dx / 2.0 + 0.5, y + dy / 2.0 + 0.5);
        };
        const auto usual = [&](const Jacobian& j) {
            const Size& size = m_map.picture();
            return Step{(j.x_i * dx + j.x_j * dy) / size.width, (j.y_i * dx + j.y_j * dy) / size.height};
        };
        const Step a = usual(jacobian(here)), b = usual(jacobian(there)), s = step(x, y, dx, dy);
        const double most = std::max(a.size(), b.size()),
                     off = std::min(Step{s.u - a.u, s.v - a.v}.size(), Step{s.u - b.u, s.v - b.v}.size());
        return !(off <= kSteady * most);
    }

    const DrapeMap& m_map;
    const SeenPixels& m_pixels;
};

/// The parts of a pixel, from what is seen at its samples.
std::vector<EdgePart> parts_of(const DrapeMap& map, const SeenPixels& samples, int x, int y) {
    std::vector<EdgePart> parts;
    constexpr double kShare = 1.0 / (kEdgeSamples * kEdgeSamples);
    for (int j = 0; j < kEdgeSamples; ++j)
        for (int i = 0; i < kEdgeSamples; ++i) {
            const std::size_t at = samples.index(x * kEdgeSamples + i, y * kEdgeSamples + j);
            if (samples.facet[at] == SeenPixels::kNone) continue;
            const auto facet = static_cast<std::uint32_t>(samples.facet[at]);
            const std::uint32_t leaf = map.facet(std::size_t{facet}).leaf;
            auto part = std::find_if(parts.begin(), parts.end(), [&](const EdgePart& p) {
                return map.facet(std::size_t{p.facet}).leaf == leaf;
            });
            if (part == parts.end()) part = parts.insert(part, {facet, 0, 0, 0, 0, 0});
            part->x += x + (i + 0.5) / kEdgeSamples;
            part->y += y + (j + 0.5) / kEdgeSamples;
            part->u += samples.u[at];
            part->v += samples.v[at];
            part->share += kShare;
        }
    for (EdgePart& part : parts) {
        const double count = part.share / kShare;
        part.x /= count;
        part.y /= count;
        part.u /= count;
        part.v /= count;
    }
    return parts;
}

}  // namespace

std::vector<EdgePixel> edges_in(const DrapeMap& map, const SeenRegion& region, const Box& part) {
    std::vector<EdgePixel> edges;
    const Seen seen(map, region.pixels());
    SeenPixels samples;
    const auto on_grid = [](int at) { return at - at % kCell; };
    // What is beside these is not seen: whether the surface ends within them only their samples tell.
    const auto is_outermost = [&](int x, int y) {
        return x == 0 || y == 0 || x + 1 == map.width() || y + 1 == map.height();
    };
    for (int top = on_grid(part.y0); top < part.y1; top += kCell)
        for (int left = on_grid(part.x0); left < part.x1; left += kCell) {
            const Box cell = intersection({left, top, left + kCell, top + kCell}, part);
            const std::size_t first = edges.size();
            Box around{cell.x1, cell.y1, cell.x0, cell.y0};
            for (int y = cell.y0; y < cell.y1; ++y)
                for (int x = cell.x0; x < cell.x1; ++x) {
                    if (!is_outermost(x, y) && !seen.edge_at(x, y)) continue;
                    edges.push_back({x, y, {}});
                    around = {std::min(around.x0, x), std::min(around.y0, y), std::max(around.x1, x + 1),
                              std::max(around.y1, y + 1)};
                }
            if (edges.size() == first) continue;
            map.see({around.x0 * kEdgeSamples, around.y0 * kEdgeSamples, around.x1 * kEdgeSamples,
                     around.y1 * kEdgeSamples},
                    samples, kEdgeSamples);
            for (std::size_t i = first; i < edges.size(); ++i)
                edges[i].parts = parts_of(map, samples, edges[i].x, edges[i].y);
            const auto is_no_edge = [&](const EdgePixel& pixel) {
                const float covered = pixel.covered();
                return !seen.edge_at(pixel.x, pixel.y) && (covered == 0 || covered == 1);
            };
            edges.erase(
                std::remove_if(edges.begin() + static_cast<std::ptrdiff_t>(first), edges.end(), is_no_edge),
                edges.end());
        }
    return edges;
}

}  // namespace anamorph::surface
