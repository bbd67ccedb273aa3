// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/facets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::surface {
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
          m_offset_size(largest(glm::abs(camera.offset()))),
          m_slope_x(camera.screen().width / (2 * camera.focal())),
          m_slope_y(camera.screen().height / (2 * camera.focal())) {}

    /// Where a patch is.
    FrameRange place(const SurfacePatch& patch) const { return turned(patch.position, m_camera.offset()); }

    /// Is nothing of a patch at that place on the screen?
    bool hidden(const FrameRange& p) const {
        if (m_camera.perspective()) {
            const double far = p.high(2);
            if (!(far > m_camera.near())) return std::isfinite(far);
            // Half spaces through the eye: x - slope z > 0 is to the right of the screen.
            return beside(p, 0, m_slope_x) || beside(p, 1, m_slope_y);
        }
        return p.low(0) > m_slope_x || p.high(0) < -m_slope_x || p.low(1) > m_slope_y ||
               p.high(1) < -m_slope_y;
    }

    /// The directions across the line of sight to the middle of a patch, x - (X / Z) z and y - (Y / Z) z of the camera's
    /// frame as vectors of the object's, and z; and how far X / Z and Y / Z are from the middle's.
    struct Sight {
        simd::Axes axes;
        glm::dvec2 off;
    };
    /// The bound (E) on the screen.
    struct Bound {
        double bound;
        double depth;      ///< of what is drawn, at least
        double off_depth;  ///< e_z, and what it is rounded by
        Sight sight;
    };
    Bound bound(const SurfacePatch& patch, const FrameRange& p) const {
        Bound b{0, 0, 0, sight_of(p)};
        const double rounding = 2 * patch.rounding * m_size + frame_rounding(p);
        double reach[3][4];
        simd::reach_along(b.sight.axes, patch.bends, 3, reach);
        for (int k = 0; k < 3; ++k) reach[0][k] += reach[1][k] + reach[2][k];
        b.off_depth = reach[0][2] + rounding;
        b.depth = std::max(p.low(2), m_camera.near()) - b.off_depth;
        b.bound = on_screen(across(b.sight, reach[0]) + glm::dvec2(2 * rounding), b.depth);
        if (!std::isfinite(b.bound)) return bound_by_place(b, p);
        return b;
    }
    /// A patch that is drawn, and how fast the surface moves there.
    FacetLeaf leaf(const SurfacePatch& patch, std::int32_t index, const FrameRange& p, const Bound& b) const {
        double reach[2][4];
        simd::reach_along(b.sight.axes, patch.slopes, 2, reach);
        // What rows make of depths, u and v, sums of three products whose weights are not negative, is off by a few units of 2^-53.
        const double slopes = reach[0][2] + reach[1][2],
                     rounding = 0x1p-48 * (std::fabs(p.high(2)) + (std::isfinite(slopes) ? slopes : 0));
        return {index,
                b.bound,
                on_screen(across(b.sight, reach[0]), b.depth),
                on_screen(across(b.sight, reach[1]), b.depth),
                p.low(2),
                p.high(2),
                b.off_depth + rounding};
    }

  private:
    double frame_rounding(const FrameRange& p) const {
        return kFrameRounding * (largest(glm::abs(p.middle) + p.radius) + 2 * m_offset_size);
    }
    /// Where nothing is known of derivatives or of rounding: no two points of a patch, exact or computed, are seen farther from
    /// each other than its place is wide on the screen.
    Bound bound_by_place(Bound b, const FrameRange& p) const {
        const double rounding = frame_rounding(p);
        b.depth = std::max(p.low(2), m_camera.near()) - rounding;
        b.off_depth = p.high(2) - p.low(2) + 2 * rounding;
        glm::dvec2 width(0.0);
        for (int i = 0; i < 2; ++i) {
            width[i] = p.high(i) - p.low(i);
            // Of X / Z, in units of the least depth.
            if (m_camera.perspective()) {
                const double shrunk = b.depth / p.high(2);
                width[i] = p.high(i) * (p.high(i) > 0 ? 1 : shrunk) - p.low(i) * (p.low(i) > 0 ? shrunk : 1);
            }
        }
        b.bound = on_screen(width * (1 + 1e-9) + glm::dvec2(4 * rounding), b.depth);
        return b;
    }
    FrameRange turned(const VectorRange& range, const glm::dvec3& offset = glm::dvec3(0.0)) const {
        return {m_camera.matrix() * range.middle + offset, m_sizes * range.radius};
    }
    bool beside(const FrameRange& p, int axis, double slope) const {
        const double radius = p.radius[axis] + slope * p.radius.z;
        return p.middle[axis] - slope * p.middle.z > radius || -p.middle[axis] - slope * p.middle.z > radius;
    }
    Sight sight_of(const FrameRange& p) const {
        const glm::dmat3& m = m_camera.matrix();
        Sight sight{{}, glm::dvec2(0.0)};
        double middle[2] = {0, 0};
        if (m_camera.perspective()) {
            // Of two points one is on the screen, and |X' / Z' - X / Z| = |e_x - (X / Z) e_z| / Z' holds the other way round
            // too. The hundredth is for rounding.
            const double near = 1 / std::max(p.low(2), m_camera.near()), far = 1 / p.high(2),
                         slope[2] = {1.01 * m_slope_x, 1.01 * m_slope_y};
            for (int i = 0; i < 2; ++i) {
                const double low = std::max(p.low(i) * (p.low(i) > 0 ? far : near), -slope[i]),
                             high = std::min(p.high(i) * (p.high(i) > 0 ? near : far), slope[i]);
                middle[i] = (low + high) / 2;
                sight.off[i] = std::max(0.0, (high - low) / 2 * (1 + 1e-9)) + 1e-9 * slope[i];
            }
        }
        for (int i = 0; i < 3; ++i) {
            double* const to = sight.axes.coordinates[i];
            to[0] = m[i].x - middle[0] * m[i].z;
            to[1] = m[i].y - middle[1] * m[i].z;
            to[2] = m[i].z;
        }
        return sight;
    }
    /// |x - (X / Z) z| and |y - (Y / Z) z| of vectors, at most, for all X / Z and Y / Z of a patch, by how far they reach
    /// along its axes.
    static glm::dvec2 across(const Sight& sight, const double (&reach)[4]) {
        return {reach[0] + sight.off.x * reach[2], reach[1] + sight.off.y * reach[2]};
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
    double m_offset_size;
    double m_slope_x, m_slope_y;
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
    static constexpr std::uint32_t kUnused = ~0u;

  public:
    FacetMaker(SurfaceTree& tree, const Camera& camera, double tol, FacetRoom& room)
        : m_tree(tree), m_camera(camera), m_view(camera), m_tol(tol), m_room(room), m_made(room.facets) {
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

    void make() {
        m_made.corners.clear();
        m_made.facets.clear();
        m_made.leaves.clear();
        m_room.fits.clear();
        collect();
        number_corners();
        for (std::size_t i = 0; i < m_made.leaves.size(); ++i) cut(static_cast<std::uint32_t>(i));
    }

  private:
    /// The largest patches within the tolerance.
    void collect() {
        // A few at a time: what memory holds of a patch is asked for when it is met and has come when it is looked at.
        std::array<std::int32_t, 8> some{};
        std::vector<std::int32_t>& open = m_room.open;
        m_room.outlines.clear();
        m_room.hidden.clear();
        open.assign(1, 0);
        for (std::size_t visited = 0; !open.empty();) {
            const std::size_t count = std::min(some.size(), open.size());
            std::copy(open.end() - static_cast<std::ptrdiff_t>(count), open.end(), some.begin());
            open.resize(open.size() - count);
            for (visited += count; const std::int32_t index : std::span(some).first(count)) visit(index);
            if (std::max(4 * m_made.leaves.size(), visited) > 4 * m_most_leaves)
                throw TooManyPatches(m_tol, m_most_leaves);
        }
    }
    /// Keeps a patch, or opens its halves.
    void visit(std::int32_t index) {
        const SurfacePatch& patch = m_tree.patch(index);
        const FrameRange place = m_view.place(patch);
        if (patch.missing || m_view.hidden(place)) {
            m_room.hidden.push_back(index);
            return;
        }
        const PatchView::Bound found = m_view.bound(patch, place);
        if (found.bound <= m_wanted && patch.open) {
            // What is left of it is no wider than what is drawn may be off.
            m_room.hidden.push_back(index);
            return;
        }
        if (found.bound <= m_wanted) {
            m_made.leaves.push_back(m_view.leaf(patch, index, place, found));
            m_made.leaves.back().bound += grid_error(m_made.grid_bits);
            m_room.outlines.push_back({patch.corners, patch.sides});
            return;
        }
        const std::int32_t halves = m_tree.halves(index);
        if (halves == SurfacePatch::kNone) refuse(patch);
        for (const std::int32_t half : {halves + 1, halves}) {
            m_tree.prefetch(half);
            m_room.open.push_back(half);
        }
    }

    /// A patch that is as small as they get, and too large: the surface jumps there, or double tells no more of it.
    [[noreturn]] void refuse(const SurfacePatch& patch) const {
        const bool bends = std::all_of(std::begin(patch.bends), std::end(patch.bends), [](const auto& bend) {
            return std::isfinite(bend.radius[0] + bend.radius[1] + bend.radius[2]);
        });
        if (bends)
            throw Error("tol", shortest(m_tol),
                        "is less than what double makes of this surface from so near");
        const auto place = [](double at) { return brief(std::round(at * 1e9) / 1e9); };
        throw Error("the surface is torn near u=" + place(patch.u0()) + ", v=" + place(1 - patch.v0()) +
                    ", or grows beyond all bounds, or intervals cannot tell that it does not: must be "
                    "continuous wherever it is defined");
    }

    SpacePoint space_point(double u, double v) const {
        return {m_camera.in_frame(m_tree.surface().position(u, v)), u, v};
    }
    SpacePoint point_of(std::uint32_t corner) const {
        return space_point(m_made.corners[corner].u, m_made.corners[corner].v);
    }
    std::uint32_t add_corner(const SpacePoint& point) {
        // To the nearest integer, below 2^51, where they end in their last bits.
        const auto on_grid = [](double at) { return (at + 0x1.8p52) - 0x1.8p52; };
        const Point<double> seen = m_camera.seen(point.p);
        const double weight = m_camera.weight(point.p), x = on_grid(seen.x * m_unit),
                     y = on_grid(seen.y * m_unit);
        m_made.corners.push_back(
            {x, y, weight, m_camera.perspective() ? weight : -point.p.z, point.u, point.v});
        m_room.fits.push_back(point.p.z >= m_camera.near() && std::fabs(x) <= kMostGrid &&
                              std::fabs(y) <= kMostGrid);
        return static_cast<std::uint32_t>(m_made.corners.size() - 1);
    }
    /// Gives the tree's corners that are drawn their numbers.
    void number_corners() {
        m_room.numbers.assign(m_tree.corners().size(), kUnused);
        m_room.used.clear();
        const auto use = [&](const std::array<std::int32_t, 4>& corners) {
            for (const std::int32_t corner : corners) {
                std::uint32_t& number = m_room.numbers[static_cast<std::size_t>(corner)];
                if (number != kUnused) continue;
                number = static_cast<std::uint32_t>(m_room.used.size());
                m_room.used.push_back(corner);
            }
        };
        for (const FacetRoom::Outline& outline : m_room.outlines) use(outline.corners);
        // So that a side with a corner anywhere has one in its middle (walk()).
        for (const std::int32_t patch : m_room.hidden) use(m_tree.patch(patch).corners);
        for (const std::int32_t corner : m_room.used) {
            const SurfaceCorner& c = m_tree.corners()[static_cast<std::size_t>(corner)];
            add_corner({m_camera.in_frame(c.position), c.u, c.v});
        }
    }
    /// Among those that are drawn, or kUnused.
    std::uint32_t index_of(std::int32_t corner) const {
        return corner == SurfacePatch::kNone ? kUnused : m_room.numbers[static_cast<std::size_t>(corner)];
    }

    /// The corners on a side after its first end, up to the other one: those of neighbours are at its middle, or
    /// there is none.
    void walk(std::int32_t index, bool forward, std::int32_t end) {
        const SurfaceSide& side = m_tree.side(index);
        if (index_of(side.middle) == kUnused) {
            m_room.rim.push_back(index_of(end));
            return;
        }
        walk(side.halves + (forward ? 0 : 1), forward, side.middle);
        walk(side.halves + (forward ? 1 : 0), forward, end);
    }

    void cut(std::uint32_t leaf) {
        const FacetRoom::Outline& outline = m_room.outlines[leaf];
        m_room.rim.clear();
        // A corner that is alone between those of the patch.
        std::size_t apex = 0;
        bool alone = false;
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t first = m_room.rim.size();
            walk(outline.sides[i], i < 2, outline.corners[(i + 1) % 4]);
            if (m_room.rim.size() - first != 2) continue;
            apex = first;
            alone = true;
        }
        const std::size_t count = m_room.rim.size();
        const auto rim = [&](std::size_t i) { return m_room.rim[i < count ? i : i - count]; };
        if (count == 4 || alone) {
            for (std::size_t i = 1; i + 1 < count; ++i)
                add_facet(rim(apex), rim(apex + i), rim(apex + i + 1), leaf);
            return;
        }
        const SurfacePatch& patch = m_tree.patch(m_made.leaves[leaf].patch);
        const std::uint32_t middle =
            add_corner(space_point(patch.u0() + patch.side_u() / 2, patch.v0() + patch.side_v() / 2));
        for (std::size_t i = 0; i < count; ++i) add_facet(rim(i), rim(i + 1), middle, leaf);
    }

    void add_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t leaf) {
        if (m_room.fits[a] && m_room.fits[b] && m_room.fits[c])
            m_made.facets.push_back({{a, b, c}, leaf});
        else
            add_clipped({point_of(a), point_of(b), point_of(c)}, leaf);
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
    FacetRoom& m_room;
    Facets& m_made;
    std::size_t m_most_leaves = 0;
    double m_unit = 1, m_wanted = 0, m_guard = 0;
};

}  // namespace

TooManyPatches::TooManyPatches(double tol, std::size_t most_made, const std::string& rule)
    : Error("tol", shortest(tol),
            "takes more than " + std::to_string(most_made) + " patches of the surface" + rule),
      most(most_made) {}

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

void cut_into_facets(SurfaceTree& tree, const Camera& camera, double tol, FacetRoom& room) {
    FacetMaker(tree, camera, tol, room).make();
}

Facets cut_into_facets(SurfaceTree& tree, const Camera& camera, double tol) {
    FacetRoom room;
    cut_into_facets(tree, camera, tol, room);
    return std::move(room.facets);
}

}  // namespace anamorph::surface
