// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/occluders.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <optional>

namespace anamorph {
namespace {

constexpr std::size_t kLeaf = 4;
using Rays = std::array<glm::dvec3, 3>;

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The plane through the centre and two points, the same but for its sign in both orders.
glm::dvec3 plane_through(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 n = glm::cross(a, b);
    return n / glm::length(n);
}

double triple(const Rays& r) {
    return glm::dot(r[0], glm::cross(r[1], r[2]));
}

/// What is nearer to a plane than its rounding lies in it.
double snapped(double value, double ray, const ShadowScale& scale) {
    return std::fabs(value) <= scale.on_plane * ray ? 0 : value;
}

/// A part of an edge, which goes from 0 to 1.
struct Stretch {
    double from, to;
};

/// The first end of the union of stretches; -1 if there is none.
double first_end(std::vector<Stretch>& dark, double hair) {
    std::sort(dark.begin(), dark.end(), [](const Stretch& p, const Stretch& q) { return p.from < q.from; });
    for (std::size_t i = 0; i < dark.size();) {
        Stretch all = dark[i++];
        for (; i < dark.size() && dark[i].from <= all.to + hair; ++i) all.to = std::max(all.to, dark[i].to);
        if (all.to - all.from <= hair) continue;
        if (all.from > hair) return all.from;
        if (all.to < 1 - hair) return all.to;
    }
    return -1;
}

/// A convex part of a triangle, by weights of its corners.
using Part = std::vector<glm::dvec3>;
const Part kWhole = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// The parts of a convex part where a linear function of the weights is at least 0, and at most.
void divide(const Part& part, const glm::dvec3& at_corners, Part& above, Part& below) {
    above.clear();
    below.clear();
    for (std::size_t i = 0; i < part.size(); ++i) {
        const glm::dvec3 &a = part[i], &b = part[(i + 1) % part.size()];
        const double at_a = glm::dot(at_corners, a), at_b = glm::dot(at_corners, b);
        if (at_a >= 0) above.push_back(a);
        if (at_a <= 0) below.push_back(a);
        if (at_a * at_b >= 0) continue;
        const double t = at_a / (at_a - at_b);
        above.push_back(a * (1 - t) + b * t);
        below.push_back(above.back());
    }
}

}  // namespace

double Occluders::Occluder::value(std::size_t k, const glm::dvec3& ray) const {
    return glm::dot(normals[k], ray) - (k == 3 ? depth : 0);
}

Occluders::Occluders(const std::vector<glm::dvec3>& corners, const glm::dvec3& centre) : m_centre(centre) {
    std::vector<Rays> triangles;
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
        const Rays r{corners[i] - centre, corners[i + 1] - centre, corners[i + 2] - centre};
        const double volume = triple(r);
        const bool counts = is_finite(r[0]) && is_finite(r[1]) && is_finite(r[2]) && std::isfinite(volume);
        if (counts && volume != 0) triangles.push_back(r);
    }
    if (!triangles.empty()) build(triangles, 0, triangles.size());
    for (const Rays& r : triangles) {
        const double side = triple(r) > 0 ? 1 : -1;
        Occluder o;
        for (std::size_t k = 0; k < 3; ++k) o.normals[k] = plane_through(r[k], r[(k + 1) % 3]) * side;
        glm::dvec3 n = glm::cross(r[1] - r[0], r[2] - r[0]) * side;
        n /= glm::length(n);
        o.depth = glm::dot(n, r[0]);
        o.normals[3] = n * (1 - kTouching);
        m_occluders.push_back(o);
    }
}

void Occluders::build(std::vector<Rays>& triangles, std::size_t begin, std::size_t end) {
    Node node{glm::dvec3(HUGE_VAL), glm::dvec3(-HUGE_VAL), static_cast<std::int32_t>(begin),
              static_cast<std::int32_t>(end), 0};
    for (std::size_t i = begin; i < end; ++i)
        for (const glm::dvec3& r : triangles[i])
            for (int d = 0; d < 3; ++d) {
                node.low[d] = std::min(node.low[d], r[d]);
                node.high[d] = std::max(node.high[d], r[d]);
            }
    const std::size_t own = m_nodes.size();
    m_nodes.push_back(node);
    if (end - begin <= kLeaf) return;
    const glm::dvec3 size = node.high - node.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle_of = [axis](const Rays& r) { return r[0][axis] + r[1][axis] + r[2][axis]; };
    const auto at = [&](std::size_t i) { return triangles.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t half = begin + (end - begin) / 2;
    std::nth_element(at(begin), at(half), at(end),
                     [&](const Rays& a, const Rays& b) { return middle_of(a) < middle_of(b); });
    build(triangles, begin, half);
    m_nodes[own].right = static_cast<std::int32_t>(m_nodes.size());
    build(triangles, half, end);
}

/// A convex region about the centre: t r, with t from 0 to 1 and r in a box about some rays, where half spaces hold.
class Occluders::Region {
  public:
    /// About the rays of points from a centre.
    explicit Region(std::span<const glm::dvec3> points, const glm::dvec3& centre = glm::dvec3(0.0),
                    double hair = kHair)
        : m_hair(hair) {
        glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
        double size = 0;
        for (const glm::dvec3& point : points) {
            const glm::dvec3 r = point - centre;
            low = glm::min(low, r);
            high = glm::max(high, r);
            size = std::max(size, glm::length(r));
        }
        // Where t r is in a node's box, t low <= node.high and t (-high) <= -node.low.
        for (int d = 0; d < 3; ++d) {
            bound(low[d] - m_hair * size, 3 + d, 1);
            bound(-(high[d] + m_hair * size), d, -1);
        }
    }
    void add(const HalfSpace& half) { m_halves[m_half_count++] = half; }

    /// False only where no point of a node's box is in the region, but for rounding.
    bool meets(const Node& node) const {
        const double box[] = {node.low.x, node.low.y, node.low.z, node.high.x, node.high.y, node.high.z};
        double from = 0, to = 1;
        for (std::size_t i = 0; i < m_lower_count; ++i)
            from = std::max(from, box[m_lower[i].number] * m_lower[i].factor);
        for (std::size_t i = 0; i < m_upper_count; ++i)
            to = std::min(to, box[m_upper[i].number] * m_upper[i].factor);
        if (!(from <= to)) return false;
        for (std::size_t i = 0; i < m_half_count; ++i)
            if (!reaches(m_halves[i], node)) return false;
        return true;
    }

    /// The share of lengths that is taken for rounding: that of a few operations, 2^-50, is less.
    static constexpr double kHair = 1e-12;

  private:
    /// t is bounded by one of the six numbers of a box, times a factor.
    struct Bound {
        int number;
        double factor;
    };
    /// Takes t k <= side * box[number] as a bound. One that says nothing for 0 times infinity, a NaN, leaves t as it was.
    void bound(double k, int number, double side) {
        if (k > 0)
            m_upper[m_upper_count++] = {number, side / k};
        else
            m_lower[m_lower_count++] = {number, k < 0 ? side / k : -side * HUGE_VAL};
    }
    bool reaches(const HalfSpace& half, const Node& node) const {
        double most = half.offset, size = std::fabs(half.offset);
        for (int d = 0; d < 3; ++d) {
            const double low = half.normal[d] * node.low[d], high = half.normal[d] * node.high[d];
            most += std::max(low, high);
            size += std::max(std::fabs(low), std::fabs(high));
        }
        return !(most < -m_hair * size);
    }

    std::array<Bound, 6> m_lower{}, m_upper{};
    std::array<HalfSpace, 5> m_halves{};
    std::size_t m_lower_count = 0, m_upper_count = 0, m_half_count = 0;
    double m_hair;  ///< shares of lengths that are taken for rounding
};

template <class Body>
void Occluders::for_each_in(const Region& region, const Body& body) const {
    // Each level halves what is left, so that at most as many halves wait as there are bits in their number.
    std::array<std::int32_t, 32> open;
    std::size_t waiting = 0;
    if (!m_nodes.empty()) open[waiting++] = 0;
    while (waiting > 0) {
        const std::int32_t at = open[--waiting];
        const Node& node = m_nodes[static_cast<std::size_t>(at)];
        if (!region.meets(node)) continue;
        if (node.right) {
            open[waiting++] = node.right;
            open[waiting++] = at + 1;
            continue;
        }
        for (std::int32_t i = node.begin; i < node.end; ++i)
            if (!body(i)) return;
    }
}

/// The tetrahedron from the centre to a triangle.
Occluders::Region Occluders::region_before(const Rays& r, double hair) {
    const double side = triple(r) >= 0 ? 1 : -1;
    Region region(r, glm::dvec3(0.0), std::max(hair, Region::kHair));
    for (std::size_t k = 0; k < 3; ++k) region.add({glm::cross(r[k], r[(k + 1) % 3]) * side, 0});
    const glm::dvec3 n = glm::cross(r[1] - r[0], r[2] - r[0]) * side;
    region.add({-n, glm::dot(n, r[0])});
    return region;
}

/// The triangle from the centre to an edge.
Occluders::Region Occluders::region_before(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 n = glm::cross(a, b), along = glm::cross(n, b - a);
    const double offset = glm::dot(along, a);
    const double side = offset > 0 ? -1 : 1;
    Region region(std::array{a, b});
    for (const HalfSpace& half : {HalfSpace{n, 0}, HalfSpace{-n, 0}, HalfSpace{glm::cross(n, a), 0},
                                  HalfSpace{glm::cross(b, n), 0}, HalfSpace{along * side, -offset * side}})
        region.add(half);
    return region;
}

bool Occluders::Occluder::hides(const glm::dvec3& ray) const {
    return value(0, ray) >= 0 && value(1, ray) >= 0 && value(2, ray) >= 0 && value(3, ray) > 0;
}

bool Occluders::hides(const glm::dvec3& point) const {
    const glm::dvec3 r = point - m_centre;
    bool hidden = false;
    for_each_in(Region({&point, 1}, m_centre), [&](std::int32_t i) {
        hidden = m_occluders[static_cast<std::size_t>(i)].hides(r);
        return !hidden;
    });
    return hidden;
}

void Occluders::find_before(std::span<const glm::dvec3> points, std::vector<std::int32_t>& found) const {
    found.clear();
    for_each_in(Region(points, m_centre), [&](std::int32_t i) {
        found.push_back(i);
        return true;
    });
}

bool Occluders::find_before(const Rays& triangle, std::size_t most, std::vector<std::int32_t>& found) const {
    found.clear();
    const Rays r{triangle[0] - m_centre, triangle[1] - m_centre, triangle[2] - m_centre};
    const double size = glm::length(r[0]) + glm::length(r[1]) + glm::length(r[2]);
    bool enough = size < HUGE_VAL;
    if (!enough) return false;
    for_each_in(region_before(r), [&](std::int32_t i) {
        const Occluder& o = m_occluders[static_cast<std::size_t>(i)];
        // A condition that holds in no corner holds nowhere between them, and one that holds in all holds everywhere, by more than
        // values are rounded.
        const double hair = Region::kHair * (size + std::fabs(o.depth));
        bool all = true;
        for (const std::size_t k : {3, 0, 1, 2}) {
            const double a = o.value(k, r[0]), b = o.value(k, r[1]), c = o.value(k, r[2]);
            if (std::max({a, b, c}) < -hair) return true;
            all = all && std::min({a, b, c}) > hair;
        }
        if (all) {
            enough = true;
            found.assign(1, i);
            return false;
        }
        enough = found.size() < most;
        if (enough) found.push_back(i);
        return enough;
    });
    return enough;
}

bool Occluders::hides(const glm::dvec3& point, std::span<const std::int32_t> triangles) const {
    const glm::dvec3 r = point - m_centre;
    return std::any_of(triangles.begin(), triangles.end(),
                       [&](std::int32_t i) { return m_occluders[static_cast<std::size_t>(i)].hides(r); });
}

bool Occluders::may_hide(const Rays& triangle, double hair) const {
    const Rays r{triangle[0] - m_centre, triangle[1] - m_centre, triangle[2] - m_centre};
    bool found = false;
    for_each_in(region_before(r, hair), [&](std::int32_t i) {
        const Occluder& o = m_occluders[static_cast<std::size_t>(i)];
        found = false;
        for (const glm::dvec3& corner : r) found = found || o.value(3, corner) > -hair * glm::length(corner);
        return !found;
    });
    return found;
}

double Occluders::border(const glm::dvec3& a, const glm::dvec3& b, double hair,
                         const ShadowScale& scale) const {
    const glm::dvec3 r = a - m_centre, s = b - m_centre;
    const double size = std::max(glm::length(r), glm::length(s));
    // Where the edge lies in the border of a shadow, there is another one without it on its other side.
    std::vector<Stretch> dark, inner;
    // Where a corner of a shadow just reaches the edge, the border goes on within the triangles beside it.
    std::vector<double> touched;
    bool all_dark = false;
    for_each_in(region_before(r, s), [&](std::int32_t i) {
        const Occluder& o = m_occluders[static_cast<std::size_t>(i)];
        Stretch stretch{0, 1};
        bool on_side = false;
        for (const std::size_t k : {3, 0, 1, 2}) {
            const double at_a = snapped(o.value(k, r), size, scale),
                         at_b = snapped(o.value(k, s), size, scale);
            const double most = std::max(at_a, at_b);
            if (most < 0 || (k == 3 && most == 0)) return true;
            on_side = on_side || (at_a == 0 && at_b == 0);
            if (at_a < 0)
                stretch.from = std::max(stretch.from, at_a / (at_a - at_b));
            else if (at_b < 0)
                stretch.to = std::min(stretch.to, at_a / (at_a - at_b));
        }
        if (!(stretch.from <= stretch.to + hair)) return true;
        if (stretch.to <= stretch.from + hair) {
            touched.push_back(0.5 * (stretch.from + stretch.to));
            return true;
        }
        dark.push_back(stretch);
        if (!on_side) inner.push_back(stretch);
        // All of it within one shadow: no other border counts.
        all_dark = !on_side && stretch.from == 0 && stretch.to == 1;
        return !all_dark;
    });
    if (all_dark) return -1;
    const bool same = dark.size() == inner.size();
    const double first = first_end(dark, hair), other = same ? first : first_end(inner, hair);
    double least = first < 0 || (other > 0 && other < first) ? other : first;
    for (const double t : touched) {
        const auto covers = [&](const Stretch& d) { return d.from < t - hair && d.to > t + hair; };
        if (t > hair && t < 1 - hair && (least < 0 || t < least) &&
            std::none_of(dark.begin(), dark.end(), covers))
            least = t;
    }
    return least;
}

/// A triangle divided into what is lit and what lies in shadows.
class ShadowParts {
  public:
    ShadowParts(const Rays& rays, const ShadowScale& scale) : m_rays(rays), m_scale(scale) {
        for (const glm::dvec3& r : rays) m_size = std::max(m_size, glm::length(r));
        set_flat();
        m_lit.push_back(kWhole);
    }

    /// Takes a shadow away; false if all of the triangle is in it.
    bool take(const Occluders::Occluder& o) {
        std::array<glm::dvec3, 4> at;
        bool all = true;
        for (const std::size_t k : {3, 0, 1, 2}) {
            double most = 0, least = 0;
            for (int i = 0; i < 3; ++i) {
                at[k][i] = snapped(o.value(k, m_rays[static_cast<std::size_t>(i)]), m_size, m_scale);
                most = std::max(most, at[k][i]);
                least = std::min(least, at[k][i]);
            }
            if (most == 0) return true;
            all = all && least == 0;
        }
        m_takers.push_back(at);
        if (all) m_all_dark = true, m_lit.clear();
        std::vector<Part> lit;
        for (const Part& part : m_lit) subtract(part, at, lit);
        m_lit.swap(lit);
        return !m_lit.empty();
    }

    /// Is it too narrow to be divided?
    bool is_narrow() const { return !is_wide(kWhole); }

    ShadowCover cover() const {
        if (m_dark.empty() && !m_all_dark) return {ShadowCover::lit};
        Part light;
        double light_widths = 0;
        for (const Part& part : m_lit) {
            light.insert(light.end(), part.begin(), part.end());
            light_widths += width(part);
        }
        const bool dark_is_wide = m_all_dark || are_wide(m_dark, m_dark_widths);
        if (are_wide(light, light_widths)) return dark_is_wide ? corner() : ShadowCover{ShadowCover::lit};
        // What has but strips of light is hidden, unless that is most of a narrow triangle, of which strips of dark may be neglected.
        if (!is_mostly_lit()) return {ShadowCover::hidden};
        return dark_is_wide ? corner() : ShadowCover{ShadowCover::lit};
    }

  private:
    /// The triangle about as it is seen, in texels.
    void set_flat() {
        glm::dvec3 c(0.0);
        for (const glm::dvec3& r : m_rays) c += r / glm::length(r);
        c /= glm::length(c);
        const glm::dvec3 other = std::fabs(c.y) < 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
        const glm::dvec3 e = glm::normalize(glm::cross(other, c)), f = glm::cross(c, e);
        for (std::size_t i = 0; i < 3; ++i)
            m_flat[i] = glm::dvec2(glm::dot(e, m_rays[i]), glm::dot(f, m_rays[i])) *
                        (m_scale.per_radian / glm::dot(c, m_rays[i]));
        for (std::size_t i = 0; i < 3; ++i)
            m_length = std::max(m_length, glm::length(m_flat[(i + 1) % 3] - m_flat[i]));
    }
    glm::dvec2 flat(const glm::dvec3& l) const {
        return m_flat[0] * l[0] + m_flat[1] * l[1] + m_flat[2] * l[2];
    }
    double area(const Part& part) const {
        double sum = 0;
        for (std::size_t i = 2; i < part.size(); ++i) {
            const glm::dvec2 p = flat(part[i - 1]) - flat(part[0]), q = flat(part[i]) - flat(part[0]);
            sum += p.x * q.y - p.y * q.x;
        }
        return 0.5 * std::fabs(sum);
    }
    bool is_mostly_lit() const {
        double lit = 0;
        for (const Part& part : m_lit) lit += area(part);
        return 2 * lit > area(kWhole);
    }
    /// The width of a strip along the two points that are farthest apart, in which all points lie.
    double width(const Part& part) const {
        double longest = 0;
        glm::dvec2 from(0.0), along(0.0);
        for (std::size_t i = 0; i < part.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const glm::dvec2 apart = flat(part[i]) - flat(part[j]);
                if (glm::length(apart) <= longest) continue;
                longest = glm::length(apart);
                from = flat(part[j]);
                along = apart / longest;
            }
        double low = 0, high = 0;
        for (const glm::dvec3& l : part) {
            const glm::dvec2 d = flat(l) - from;
            low = std::min(low, along.x * d.y - along.y * d.x);
            high = std::max(high, along.x * d.y - along.y * d.x);
        }
        return high - low;
    }
    bool is_wide(const Part& part) const { return width(part) > m_scale.thin; }
    /// May a disc wider than what is neglected lie in parts, of which all points are given, and the sum of their widths? It does not
    /// where one strip holds them, nor where strips do that are no wider together: those that cover a disc are at least as wide as
    /// it (Bang 1951). Between triangles that share sides rounding leaves many parts, of hardly any width.
    bool are_wide(const Part& points, double widths) const {
        return widths > m_scale.thin && is_wide(points);
    }

    void subtract(const Part& part, const std::array<glm::dvec3, 4>& at, std::vector<Part>& lit) {
        std::vector<Part> beside;
        Part inside = part, above, below;
        for (const glm::dvec3& side : at) {
            divide(inside, side, above, below);
            if (below.size() > 2) beside.push_back(below);
            inside = above;
            if (inside.size() < 3) break;
        }
        if (inside.size() < 3 || area(inside) == 0) {
            lit.push_back(part);
            return;
        }
        m_dark.insert(m_dark.end(), inside.begin(), inside.end());
        m_dark_widths += width(inside);
        lit.insert(lit.end(), beside.begin(), beside.end());
    }

    /// How many borders of shadows meet at a point that is in no shadow but on their borders; 0 within a shadow.
    int borders_at(const glm::dvec3& l) const {
        const double near = 4 * m_scale.on_plane * m_size + 1e-13 * m_size;
        std::vector<glm::dvec3> met;
        for (const auto& at : m_takers) {
            double least = HUGE_VAL;
            for (const glm::dvec3& side : at) least = std::min(least, glm::dot(side, l));
            if (least > near) return 0;
            if (least < -near) continue;
            for (const glm::dvec3& side : at) {
                if (std::fabs(glm::dot(side, l)) > near) continue;
                const auto same = [&](const glm::dvec3& other) {
                    return glm::length(glm::cross(side, other)) <=
                           1e-9 * glm::length(side) * glm::length(other);
                };
                if (std::none_of(met.begin(), met.end(), same)) met.push_back(side);
            }
        }
        return static_cast<int>(met.size());
    }

    /// A corner of a shadow that is well within the triangle; failing that, a point of a border, or the middle.
    ShadowCover corner() const {
        Part points = m_dark;
        for (const Part& part : m_lit) points.insert(points.end(), part.begin(), part.end());
        const double whole = 2 * area(kWhole);
        ShadowCover best{ShadowCover::both};
        best.mostly_lit = is_mostly_lit();
        double best_worth = 0;
        for (const glm::dvec3& l : points) {
            double within = HUGE_VAL;
            for (std::size_t i = 0; i < 3; ++i) {
                const double side = glm::length(m_flat[(i + 2) % 3] - m_flat[(i + 1) % 3]);
                within = std::min(within, l[static_cast<int>(i)] * whole / side);
            }
            if (!(within > m_scale.thin)) continue;
            const int borders = std::min(borders_at(l), 2);
            if (within + m_length * borders <= best_worth) continue;
            best_worth = within + m_length * borders;
            best.corner = l;
            best.has_corner = borders == 2;
        }
        return best;
    }

    Rays m_rays;
    ShadowScale m_scale;
    double m_size = 0, m_length = 0;
    std::array<glm::dvec2, 3> m_flat{};
    std::vector<Part> m_lit;
    std::vector<std::array<glm::dvec3, 4>> m_takers;
    Part m_dark;
    double m_dark_widths = 0;
    bool m_all_dark = false;
};

ShadowCover Occluders::cover(const Rays& triangle, const ShadowScale& scale) const {
    const Rays r{triangle[0] - m_centre, triangle[1] - m_centre, triangle[2] - m_centre};
    ShadowParts parts(r, scale);
    if (parts.is_narrow())
        return {hides((triangle[0] + triangle[1] + triangle[2]) / 3.0) ? ShadowCover::hidden
                                                                       : ShadowCover::lit};
    for_each_in(region_before(r),
                [&](std::int32_t i) { return parts.take(m_occluders[static_cast<std::size_t>(i)]); });
    return parts.cover();
}

}  // namespace anamorph
