// SPDX-License-Identifier: Apache-2.0
#include "anamorph/drape/facets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "anamorph/error.h"
#include "anamorph/parameter.h"

namespace anamorph {
namespace {

// What turning a point into the camera's frame loses, in the size of the result and of the offset: sums of four products,
// in units of 2^-53.
constexpr double kFrameRounding = 0x1p-50;

/// A range of the camera's frame.
struct FrameRange {
    glm::dvec3 middle, radius;

    double low(int i) const { return middle[i] - radius[i]; }
    double high(int i) const { return middle[i] + radius[i]; }
};

double largest(const glm::dvec3& v) {
    return std::max({v.x, v.y, v.z});
}

glm::dmat3 magnitudes(const glm::dmat3& m) {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

/// Patches as a camera sees them.
class PatchView {
  public:
    explicit PatchView(const Camera& camera)
        : m_camera(camera),
          m_sizes(magnitudes(camera.matrix())),
          m_size(largest(m_sizes * glm::dvec3(1.0))),
          m_slope_x(camera.screen().width / (2 * camera.focal())),
          m_slope_y(camera.screen().height / (2 * camera.focal())) {}

    /// Is nothing of the patch on the screen?
    bool hidden(const SurfacePatch& patch) const {
        const FrameRange p = turned(patch.position, m_camera.offset());
        if (m_camera.perspective()) {
            const double far = p.high(2);
            if (!(far > m_camera.near())) return std::isfinite(far);
            // Half spaces through the eye: x - slope z > 0 is to the right of the screen.
            return beside(p, 0, m_slope_x) || beside(p, 1, m_slope_y);
        }
        return p.low(0) > m_slope_x || p.high(0) < -m_slope_x || p.low(1) > m_slope_y ||
               p.high(1) < -m_slope_y;
    }

    /// The bound (E) on the screen, and how fast the surface moves there.
    /// `least` is what of the bound no finer patch could mend; infinite where that is not known yet.
    FacetLeaf leaf(const SurfacePatch& patch, std::int32_t index, double& least) const {
        const FrameRange p = turned(patch.position, m_camera.offset());
        const double h = patch.side_u(), k = patch.side_v();
        const Sight sight = sight_of(p);
        const double rounding =
            2 * patch.rounding * m_size + kFrameRounding * (largest(glm::abs(p.middle) + p.radius) +
                                                            2 * largest(glm::abs(m_camera.offset())));
        const auto across = [&](const VectorRange& by) { return steps(sight, by); };
        // A bound of e_z, for the depth.
        const glm::dvec3 ahead(m_camera.matrix()[0].z, m_camera.matrix()[1].z, m_camera.matrix()[2].z);
        const auto depth_of = [&](const VectorRange& by) { return most(ahead, by); };
        const auto error = [&](const auto& size) {
            return (size(patch.by_uu) * (h * h) + size(patch.by_uv) * (2 * h * k) +
                    size(patch.by_vv) * (k * k)) /
                   8.0;
        };
        const double e_z = error(depth_of) + rounding;
        const double depth = std::max(p.low(2), m_camera.near()) - e_z;
        FacetLeaf leaf{index, 0, 0, 0, p.low(2), p.high(2)};
        const glm::dvec2 bends = error(across), rounds(rounding * 2);
        leaf.bound = on_screen(bends + rounds, depth);
        const bool deep = m_camera.perspective() && !(p.radius.z < depth / 2);
        least =
            deep || glm::length(bends) * 16 > glm::length(rounds) ? HUGE_VAL : on_screen(rounds, 2 * depth);
        leaf.by_u = on_screen(across(patch.by_u), depth);
        leaf.by_v = on_screen(across(patch.by_v), depth);
        return leaf;
    }

  private:
    FrameRange turned(const VectorRange& range, const glm::dvec3& offset = glm::dvec3(0.0)) const {
        return {m_camera.matrix() * range.middle + offset, m_sizes * range.radius};
    }
    bool beside(const FrameRange& p, int axis, double slope) const {
        const double radius = p.radius[axis] + slope * p.radius.z;
        return p.middle[axis] - slope * p.middle.z > radius || -p.middle[axis] - slope * p.middle.z > radius;
    }
    /// The directions across the line of sight to the middle of a patch, x - (X / Z) z and y - (Y / Z) z of the camera's
    /// frame as vectors of the object's, and how far X / Z and Y / Z are from the middle's.
    struct Sight {
        glm::dvec3 x, y, z;
        glm::dvec2 off;
    };
    Sight sight_of(const FrameRange& p) const {
        const glm::dmat3& m = m_camera.matrix();
        Sight sight{
            {m[0].x, m[1].x, m[2].x}, {m[0].y, m[1].y, m[2].y}, {m[0].z, m[1].z, m[2].z}, glm::dvec2(0.0)};
        if (!m_camera.perspective()) return sight;
        // Of two points one is on the screen, and |X' / Z' - X / Z| = |e_x - (X / Z) e_z| / Z' holds the other way round
        // too. The hundredth is for rounding.
        const double depth = std::max(p.low(2), m_camera.near()),
                     slope[2] = {1.01 * m_slope_x, 1.01 * m_slope_y};
        double middle[2];
        for (int i = 0; i < 2; ++i) {
            const double low = std::max(p.low(i) / (p.low(i) > 0 ? p.high(2) : depth), -slope[i]),
                         high = std::min(p.high(i) / (p.high(i) > 0 ? depth : p.high(2)), slope[i]);
            middle[i] = (low + high) / 2;
            sight.off[i] = std::max(0.0, (high - low) / 2 * (1 + 1e-9)) + 1e-9 * slope[i];
        }
        sight.x -= middle[0] * sight.z;
        sight.y -= middle[1] * sight.z;
        return sight;
    }
    static double most(const glm::dvec3& along, const VectorRange& range) {
        return std::fabs(glm::dot(along, range.middle)) + glm::dot(glm::abs(along), range.radius);
    }
    /// |x - (X / Z) z| and |y - (Y / Z) z| of the vectors of a range, at most, for all X / Z and Y / Z of a patch.
    static glm::dvec2 steps(const Sight& sight, const VectorRange& range) {
        const double ahead = most(sight.z, range);
        return {most(sight.x, range) + sight.off.x * ahead, most(sight.y, range) + sight.off.y * ahead};
    }
    /// Such steps in pixels, at least `depth` ahead. Infinite where depth is not positive.
    double on_screen(const glm::dvec2& step, double depth) const {
        const double size = m_camera.focal() * glm::length(step);
        if (!m_camera.perspective()) return size;
        return depth > 0 ? size / depth : HUGE_VAL;
    }

    const Camera& m_camera;
    glm::dmat3 m_sizes;
    double m_size;  ///< the frame's coordinates of a step of up to 1 each way are at most this
    double m_slope_x, m_slope_y;
};

/// Corners of patches by their place in parameters, in units of 2^-kMostLevels: an open hash table of few bytes an entry.
class CornerTable {
  public:
    CornerTable() : m_entries(std::size_t{1} << m_bits) {}

    /// The corner at (u, v); null where there is none.
    const std::uint32_t* find(std::uint64_t u, std::uint64_t v) const {
        const Entry& entry = m_entries[slot({u, v})];
        return entry.place != kFree ? &entry.corner : nullptr;
    }
    void insert(std::uint64_t u, std::uint64_t v, std::uint32_t corner) {
        if (2 * (m_places.size() + 1) > m_entries.size()) grow();
        m_entries[slot({u, v})] = {static_cast<std::uint32_t>(m_places.size()), corner};
        m_places.push_back({u, v});
    }

  private:
    static constexpr std::uint32_t kFree = ~0u;
    struct Place {
        std::uint64_t u, v;
        bool operator==(const Place&) const = default;
    };
    struct Entry {
        std::uint32_t place = kFree, corner = 0;
    };

    std::size_t slot(const Place& at) const {
        // Places have few digits, so that only the highest bits of the product tell them apart.
        const std::uint64_t mixed = at.u * 0x9e3779b97f4a7c15u + at.v * 0xc2b2ae3d27d4eb4fu;
        const std::size_t mask = m_entries.size() - 1;
        std::size_t i = static_cast<std::size_t>(mixed >> (64 - m_bits));
        while (m_entries[i].place != kFree && m_places[m_entries[i].place] != at) i = (i + 1) & mask;
        return i;
    }
    void grow() {
        std::vector<Entry> old(std::size_t{1} << ++m_bits);
        old.swap(m_entries);
        for (const Entry& entry : old)
            if (entry.place != kFree) m_entries[slot(m_places[entry.place])] = entry;
    }

    int m_bits = 12;
    std::vector<Entry> m_entries;
    std::vector<Place> m_places;
};

/// A point of the surface in the camera's frame, and its parameters.
struct SpacePoint {
    glm::dvec3 p;
    double u, v;
};

bool before(const SpacePoint& a, const SpacePoint& b) {
    return std::array{a.p.x, a.p.y, a.p.z, a.u, a.v} < std::array{b.p.x, b.p.y, b.p.z, b.u, b.v};
}

/// Where the edge from a to b meets a plane, from their distances from it; the same point from either end.
SpacePoint between(const SpacePoint& a, double from_a, const SpacePoint& b, double from_b) {
    if (before(b, a)) return between(b, from_b, a, from_a);
    const double s = from_a / (from_a - from_b);
    return {a.p + s * (b.p - a.p), a.u + s * (b.u - a.u), a.v + s * (b.v - a.v)};
}

// Bounds of so many patches take seconds; of more, minutes.
constexpr std::size_t kLeastLimit = std::size_t{1} << 16, kMostLimit = std::size_t{1} << 20;

class FacetMaker {
  public:
    FacetMaker(SurfaceTree& tree, const Camera& camera, double tol)
        : m_tree(tree), m_camera(camera), m_view(camera), m_tol(tol) {
        // A bending surface takes about as many patches as it has pixels over the tolerance.
        const Size& screen = camera.screen();
        const double likely = 2.0 * screen.width * screen.height / std::min(tol, 1.0);
        m_most_leaves = std::clamp(static_cast<std::size_t>(std::min(likely, 1e9)), kLeastLimit, kMostLimit);
        m_made.grid_bits = grid_bits_of(camera.screen());
        m_made.inverse_depth = camera.perspective();
        m_unit = std::ldexp(1.0, m_made.grid_bits);
        m_wanted = tol * (1 - kFloatShare) - grid_error(m_made.grid_bits);
        m_guard = std::ldexp(kMostGrid, -m_made.grid_bits);
    }

    Facets make() {
        collect();
        for (const FacetLeaf& leaf : m_made.leaves) insert_corners(m_tree.patch(leaf.patch));
        // So that an edge with a corner anywhere has one in its middle (walk()).
        for (const std::int32_t patch : m_hidden) insert_corners(m_tree.patch(patch));
        for (std::size_t i = 0; i < m_made.leaves.size(); ++i) cut(static_cast<std::uint32_t>(i));
        return std::move(m_made);
    }

  private:
    /// The largest patches within the tolerance.
    void collect() {
        std::vector<std::int32_t> open = {0};
        for (std::size_t visited = 0; !open.empty(); ++visited) {
            const std::int32_t index = open.back();
            open.pop_back();
            const SurfacePatch& patch = m_tree.patch(index);
            if (patch.missing || m_view.hidden(patch)) {
                m_hidden.push_back(index);
                continue;
            }
            double least = 0;
            FacetLeaf leaf = m_view.leaf(patch, index, least);
            if (leaf.bound <= m_wanted) {
                leaf.bound += grid_error(m_made.grid_bits);
                m_made.leaves.push_back(leaf);
                continue;
            }
            const std::int32_t halves = m_tree.halves(index);
            if (halves == SurfacePatch::kNone || (least > m_wanted && least < HUGE_VAL))
                throw Error("tol", shortest(m_tol),
                            "is less than what double makes of this surface from so near");
            if (std::max(4 * m_made.leaves.size(), visited) > 4 * m_most_leaves)
                throw Error("tol", shortest(m_tol),
                            "takes more than " + std::to_string(m_most_leaves) + " patches of the surface");
            open.push_back(halves + 1);
            open.push_back(halves);
        }
    }

    static std::uint64_t lattice(std::uint64_t i, int level) {
        return i << (SurfaceTree::kMostLevels - level);
    }

    SpacePoint space_point(std::uint64_t u, std::uint64_t v) const {
        const double s = std::ldexp(static_cast<double>(u), -SurfaceTree::kMostLevels),
                     t = std::ldexp(static_cast<double>(v), -SurfaceTree::kMostLevels);
        return {m_camera.in_frame(m_tree.surface().position(s, t)), s, t};
    }
    std::uint32_t add_corner(const SpacePoint& point) {
        m_points.push_back(point);
        const Point<double> seen = m_camera.seen(point.p);
        const double weight = m_camera.weight(point.p);
        m_made.corners.push_back({std::nearbyint(seen.x * m_unit), std::nearbyint(seen.y * m_unit), weight,
                                  m_camera.perspective() ? weight : -point.p.z, point.u, point.v});
        return static_cast<std::uint32_t>(m_points.size() - 1);
    }
    std::uint32_t corner_at(std::uint64_t u, std::uint64_t v) {
        if (const std::uint32_t* known = m_table.find(u, v)) return *known;
        const std::uint32_t corner = add_corner(space_point(u, v));
        m_table.insert(u, v, corner);
        return corner;
    }
    void insert_corners(const SurfacePatch& patch) {
        for (std::uint64_t j = 0; j < 2; ++j)
            for (std::uint64_t i = 0; i < 2; ++i)
                corner_at(lattice(patch.iu + i, patch.level_u), lattice(patch.iv + j, patch.level_v));
    }

    struct Place {
        std::uint64_t u, v;
    };
    /// The corners on an edge after its first end, up to the other one: those of neighbours are at its middle, or
    /// there is none.
    void walk(const Place& a, const Place& b) {
        const Place middle{(a.u + b.u) / 2, (a.v + b.v) / 2};
        const bool halves = (a.u + b.u) % 2 == 0 && (a.v + b.v) % 2 == 0;
        if (!halves || !m_table.find(middle.u, middle.v)) {
            m_rim.push_back(*m_table.find(b.u, b.v));
            return;
        }
        walk(a, middle);
        walk(middle, b);
    }

    void cut(std::uint32_t leaf) {
        const SurfacePatch& patch = m_tree.patch(m_made.leaves[leaf].patch);
        const std::uint64_t u0 = lattice(patch.iu, patch.level_u), u1 = lattice(patch.iu + 1, patch.level_u),
                            v0 = lattice(patch.iv, patch.level_v), v1 = lattice(patch.iv + 1, patch.level_v);
        m_rim.clear();
        walk({u0, v0}, {u1, v0});
        walk({u1, v0}, {u1, v1});
        walk({u1, v1}, {u0, v1});
        walk({u0, v1}, {u0, v0});
        if (m_rim.size() == 4) {
            add_facet(m_rim[0], m_rim[1], m_rim[2], leaf);
            add_facet(m_rim[0], m_rim[2], m_rim[3], leaf);
            return;
        }
        const std::uint32_t middle = add_corner(space_point(u0 / 2 + u1 / 2, v0 / 2 + v1 / 2));
        for (std::size_t i = 0; i < m_rim.size(); ++i)
            add_facet(m_rim[i], m_rim[(i + 1) % m_rim.size()], middle, leaf);
    }

    /// On the screen and its grid?
    bool fits(std::uint32_t corner) const {
        const FacetCorner& c = m_made.corners[corner];
        return m_points[corner].p.z >= m_camera.near() && std::fabs(c.x) <= kMostGrid &&
               std::fabs(c.y) <= kMostGrid;
    }
    void add_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t leaf) {
        if (fits(a) && fits(b) && fits(c))
            m_made.facets.push_back({{a, b, c}, leaf});
        else
            add_clipped({m_points[a], m_points[b], m_points[c]}, leaf);
    }

    /// What lies in front of the camera and near the screen, as a fan.
    void add_clipped(std::vector<SpacePoint> polygon, std::uint32_t leaf) {
        for (const SpacePoint& point : polygon)
            if (!std::isfinite(point.p.x + point.p.y + point.p.z)) return;
        const double slope = m_guard / m_camera.focal() * (1 - 1e-9);
        const auto depth = [&](const SpacePoint& s) { return m_camera.perspective() ? s.p.z : 1; };
        if (m_camera.perspective())
            clip(polygon, [&](const SpacePoint& s) { return s.p.z - m_camera.near(); });
        for (int axis = 0; axis < 2; ++axis) {
            clip(polygon, [&](const SpacePoint& s) { return slope * depth(s) - s.p[axis]; });
            clip(polygon, [&](const SpacePoint& s) { return slope * depth(s) + s.p[axis]; });
        }
        if (polygon.size() < 3) return;
        std::vector<std::uint32_t> corners;
        for (SpacePoint& point : polygon) {
            // An edge's end on the near plane is on it.
            if (m_camera.perspective()) point.p.z = std::max(point.p.z, m_camera.near());
            corners.push_back(add_corner(point));
        }
        for (std::size_t i = 1; i + 1 < corners.size(); ++i)
            m_made.facets.push_back({{corners[0], corners[i], corners[i + 1]}, leaf});
    }
    /// Keeps where distance(point) is not negative (Sutherland and Hodgman 1974).
    template <class Distance>
    static void clip(std::vector<SpacePoint>& polygon, const Distance& distance) {
        std::vector<SpacePoint> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const SpacePoint &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            const double from_a = distance(a), from_b = distance(b);
            if (from_a >= 0) kept.push_back(a);
            if ((from_a >= 0) != (from_b >= 0)) kept.push_back(between(a, from_a, b, from_b));
        }
        polygon.swap(kept);
    }

    SurfaceTree& m_tree;
    const Camera& m_camera;
    PatchView m_view;
    double m_tol;
    std::size_t m_most_leaves = 0;
    std::vector<std::int32_t> m_hidden;  ///< patches that were met and are not on the screen
    double m_unit = 1, m_wanted = 0, m_guard = 0;
    Facets m_made;
    std::vector<SpacePoint> m_points;  ///< of the corners
    CornerTable m_table;
    std::vector<std::uint32_t> m_rim;
};

}  // namespace

int grid_bits_of(const Size& screen) {
    // Twice as far as the screen's edges.
    int bits = 8;
    while ((1 << bits) < std::max(screen.width, screen.height)) ++bits;
    return std::ilogb(kMostGrid) - bits;
}

double grid_error(int bits) {
    // Half a unit either way, and what is lost before it is rounded.
    return std::ldexp(0.7072, -bits);
}

Facets cut_into_facets(SurfaceTree& tree, const Camera& camera, double tol) {
    return FacetMaker(tree, camera, tol).make();
}

}  // namespace anamorph
