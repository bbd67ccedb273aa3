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

bool Occluders::meets(const Node& node, const std::vector<HalfSpace>& region) {
    for (const HalfSpace& half : region) {
        double most = half.offset, size = std::fabs(half.offset);
        for (int d = 0; d < 3; ++d) {
            const double low = half.normal[d] * node.low[d], high = half.normal[d] * node.high[d];
            most += std::max(low, high);
            size += std::max(std::fabs(low), std::fabs(high));
        }
        if (most < -1e-12 * size) return false;
    }
    return true;
}

void Occluders::for_each_in(const std::vector<HalfSpace>& region,
                            const std::function<bool(const Occluder&)>& body) const {
    std::vector<std::int32_t> open;
    if (!m_nodes.empty()) open.push_back(0);
    while (!open.empty()) {
        const std::int32_t at = open.back();
        open.pop_back();
        const Node& node = m_nodes[static_cast<std::size_t>(at)];
        if (!meets(node, region)) continue;
        if (node.right) {
            open.push_back(node.right);
            open.push_back(at + 1);
            continue;
        }
        for (std::int32_t i = node.begin; i < node.end; ++i)
            if (!body(m_occluders[static_cast<std::size_t>(i)])) return;
    }
}

/// The tetrahedron from the centre to a triangle.
std::vector<Occluders::HalfSpace> Occluders::region_before(const Rays& r) {
    const double side = triple(r) >= 0 ? 1 : -1;
    std::vector<HalfSpace> region;
    for (std::size_t k = 0; k < 3; ++k) region.push_back({glm::cross(r[k], r[(k + 1) % 3]) * side, 0});
    const glm::dvec3 n = glm::cross(r[1] - r[0], r[2] - r[0]) * side;
    region.push_back({-n, glm::dot(n, r[0])});
    return region;
}

/// The triangle from the centre to an edge.
std::vector<Occluders::HalfSpace> Occluders::region_before(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 n = glm::cross(a, b), along = glm::cross(n, b - a);
    const double offset = glm::dot(along, a);
    const double side = offset > 0 ? -1 : 1;
    return {{n, 0}, {-n, 0}, {glm::cross(n, a), 0}, {glm::cross(b, n), 0}, {along * side, -offset * side}};
}

bool Occluders::hides(const glm::dvec3& point) const {
    const glm::dvec3 r = point - m_centre;
    bool hidden = false;
    // The line between two pairs of planes, up to the point.
    const glm::dvec3 size = glm::abs(r);
    const glm::dvec3 other = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                             : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                  : glm::dvec3(0, 0, 1);
    const glm::dvec3 e = glm::cross(r, other), f = glm::cross(r, e);
    const std::vector<HalfSpace> on_way{{e, 0}, {-e, 0}, {f, 0}, {-f, 0}, {r, 0}, {-r, glm::dot(r, r)}};
    for_each_in(on_way, [&](const Occluder& o) {
        hidden = o.value(0, r) >= 0 && o.value(1, r) >= 0 && o.value(2, r) >= 0 && o.value(3, r) > 0;
        return !hidden;
    });
    return hidden;
}

bool Occluders::may_hide(const Rays& triangle) const {
    const Rays r{triangle[0] - m_centre, triangle[1] - m_centre, triangle[2] - m_centre};
    bool found = false;
    for_each_in(region_before(r), [&](const Occluder& o) {
        found = false;
        for (const glm::dvec3& corner : r) found = found || o.value(3, corner) > 0;
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
    for_each_in(region_before(r, s), [&](const Occluder& o) {
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
        for (const Part& part : m_lit) light.insert(light.end(), part.begin(), part.end());
        const bool dark_is_wide = m_all_dark || is_wide(m_dark);
        if (is_wide(light)) return dark_is_wide ? corner() : ShadowCover{ShadowCover::lit};
        // What has but strips of both is what most of it is.
        return {!dark_is_wide && is_mostly_lit() ? ShadowCover::lit : ShadowCover::hidden};
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
    /// Are points farther from the line through the two that are farthest apart?
    bool is_wide(const Part& part) const {
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
        return high - low > m_scale.thin;
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
    bool m_all_dark = false;
};

ShadowCover Occluders::cover(const Rays& triangle, const ShadowScale& scale) const {
    const Rays r{triangle[0] - m_centre, triangle[1] - m_centre, triangle[2] - m_centre};
    ShadowParts parts(r, scale);
    if (parts.is_narrow())
        return {hides((triangle[0] + triangle[1] + triangle[2]) / 3.0) ? ShadowCover::hidden
                                                                       : ShadowCover::lit};
    for_each_in(region_before(r), [&](const Occluder& o) { return parts.take(o); });
    return parts.cover();
}

}  // namespace anamorph
