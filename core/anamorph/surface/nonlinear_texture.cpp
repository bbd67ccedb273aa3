// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/nonlinear_texture.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "anamorph/error.h"
#include "anamorph/number/hypot.h"
#include "anamorph/number/portable.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::surface {
namespace {

using Corners = std::array<std::int64_t, 3>;
using Weights = std::array<double, 3>;
using Texture = Point<double>;

std::size_t index_of(std::int64_t i) {
    return static_cast<std::size_t>(i);
}

/// The corner after each.
constexpr std::size_t kNextCorner[3] = {1, 2, 0};

bool all_finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// ---- Which points are one ----

/// The bits of a point's place and of its texture coordinates, by which points have an order that no numbering changes. Both zeros are one.
using PointBits = std::array<std::uint64_t, 5>;

PointBits bits_of(const TexturedMesh& mesh, std::int64_t i) {
    const glm::dvec3& p = mesh.points[index_of(i)];
    const Texture& t = mesh.texture[index_of(i)];
    const auto bits = [](double x) { return bit_cast<std::uint64_t>(x + 0.0); };
    return {bits(p.x), bits(p.y), bits(p.z), bits(t.x), bits(t.y)};
}

constexpr std::size_t kPlaceBits = 3;
bool same_place(const PointBits& a, const PointBits& b) {
    return std::equal(a.begin(), a.begin() + kPlaceBits, b.begin());
}

std::vector<PointBits> bits_of_all(const TexturedMesh& mesh) {
    std::vector<PointBits> bits;
    bits.reserve(mesh.points.size());
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
        bits.push_back(bits_of(mesh, static_cast<std::int64_t>(i)));
    return bits;
}

/// Of each point the first whose first `count` bits are the same.
std::vector<std::int64_t> first_of_same(const std::vector<PointBits>& bits, std::size_t count) {
    const auto begins_alike = [count](const PointBits& a, const PointBits& b) {
        return std::equal(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(count), b.begin());
    };
    std::vector<std::int64_t> order(bits.size()), first(bits.size());
    std::iota(order.begin(), order.end(), std::int64_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::int64_t a, std::int64_t b) { return bits[index_of(a)] < bits[index_of(b)]; });
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        std::int64_t least = order[begin];
        for (; end < order.size() && begins_alike(bits[index_of(order[begin])], bits[index_of(order[end])]);
             ++end)
            least = std::min(least, order[end]);
        for (std::size_t i = begin; i < end; ++i) first[index_of(order[i])] = least;
    }
    return first;
}

// ---- Slopes ----

/// Two directions of unit length across a normal and each other; none where it is no direction.
std::optional<std::pair<glm::dvec3, glm::dvec3>> plane_across(const glm::dvec3& normal) {
    const double length = glm::length(normal);
    if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
    const glm::dvec3 n = normal / length, reach = glm::abs(n);
    const glm::dvec3 least = reach.x <= std::min(reach.y, reach.z) ? glm::dvec3(1, 0, 0)
                             : reach.y <= reach.z                  ? glm::dvec3(0, 1, 0)
                                                                   : glm::dvec3(0, 0, 1);
    const glm::dvec3 first = glm::normalize(glm::cross(n, least));
    return std::pair(first, glm::cross(n, first));
}

/// The sums of the normal equations: of squares xx, xy, yy, and of products with u and with v.
struct SlopeSums {
    double xx = 0, xy = 0, yy = 0, xu = 0, yu = 0, xv = 0, yv = 0;

    void add(double x, double y, const Texture& d, double square) {
        xx += x * x / square, xy += x * y / square, yy += y * y / square;
        xu += x * d.x / square, yu += y * d.x / square;
        xv += x * d.y / square, yv += y * d.y / square;
    }
    /// The slope, along the two directions, that fits products with x and y best; the shortest where sides all but lie on one line.
    Point<double> solved(double x, double y) const {
        const double determinant = xx * yy - xy * xy, trace = xx + yy;
        if (determinant > 1e-12 * trace * trace)
            return {(yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant};
        if (!(trace > 0)) return {0, 0};
        // The columns of a matrix of rank 1 lie along its one direction, whose square is the trace.
        Point<double> along = xx >= yy ? Point<double>{xx, xy} : Point<double>{xy, yy};
        along = along * (1 / hypot(along.x, along.y));
        return along * ((along.x * x + along.y * y) / trace);
    }
};

class SlopeFitter {
  public:
    explicit SlopeFitter(const TexturedMesh& mesh)
        : m_mesh(mesh),
          m_bits(bits_of_all(mesh)),
          m_first(first_of_same(m_bits, 5)),
          m_begin(mesh.points.size() + 1) {
        for (const Corners& t : mesh.triangles)
            for (const std::int64_t p : t) ++m_begin[index_of(m_first[index_of(p)]) + 1];
        std::partial_sum(m_begin.begin(), m_begin.end(), m_begin.begin());
        m_about.resize(m_begin.back());
        std::vector<std::size_t> next(m_begin.begin(), m_begin.end() - 1);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            for (const std::int64_t p : mesh.triangles[t])
                m_about[next[index_of(m_first[index_of(p)])]++] = t;
    }

    std::vector<TextureSlopes> all(const ParallelFor& parallel_for) const {
        std::vector<TextureSlopes> slopes(m_first.size());
        const auto count = static_cast<std::int64_t>(m_first.size());
        if (count == 0) return slopes;
        parallel_for(count, [&](std::int64_t i) {
            if (m_first[index_of(i)] == i) slopes[index_of(i)] = at(index_of(i));
        });
        for (std::size_t i = 0; i < slopes.size(); ++i) slopes[i] = slopes[index_of(m_first[i])];
        return slopes;
    }

  private:
    const PointBits& bits(std::int64_t i) const { return m_bits[index_of(i)]; }

    /// The normal of a triangle, as long as twice its area, from its least corner.
    glm::dvec3 normal_of(const Corners& t) const {
        std::size_t least = 0;
        for (std::size_t i = 1; i < 3; ++i)
            if (bits(t[i]) < bits(t[least])) least = i;
        const glm::dvec3 &p = m_mesh.points[index_of(t[least])],
                         &q = m_mesh.points[index_of(t[(least + 1) % 3])],
                         &r = m_mesh.points[index_of(t[(least + 2) % 3])];
        return glm::cross(q - p, r - p);
    }

    TextureSlopes at(std::size_t point) const {
        std::vector<glm::dvec3> normals;
        std::vector<std::int64_t> others;
        for (std::size_t k = m_begin[point]; k < m_begin[point + 1]; ++k) {
            const Corners& t = m_mesh.triangles[m_about[k]];
            const glm::dvec3 normal = normal_of(t);
            if (all_finite(normal)) normals.push_back(normal);
            for (const std::int64_t p : t) others.push_back(m_first[index_of(p)]);
        }
        // Sums go in an order that no numbering changes.
        std::sort(normals.begin(), normals.end(), [](const glm::dvec3& a, const glm::dvec3& b) {
            return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
        });
        std::sort(others.begin(), others.end(),
                  [&](std::int64_t a, std::int64_t b) { return bits(a) < bits(b); });
        others.erase(std::unique(others.begin(), others.end()), others.end());
        const auto plane = plane_across(std::accumulate(normals.begin(), normals.end(), glm::dvec3(0.0)));
        if (!plane) return {};
        SlopeSums sums;
        for (const std::int64_t other : others) {
            const glm::dvec3 along = m_mesh.points[index_of(other)] - m_mesh.points[point];
            const Texture d = m_mesh.texture[index_of(other)] - m_mesh.texture[point];
            const double square = glm::dot(along, along);
            if (square > 0 && std::isfinite(1 / square) && std::isfinite(square + d.x + d.y))
                sums.add(glm::dot(along, plane->first), glm::dot(along, plane->second), d, square);
        }
        const auto in_space = [&](const Point<double>& s) {
            return s.x * plane->first + s.y * plane->second;
        };
        return {in_space(sums.solved(sums.xu, sums.yu)), in_space(sums.solved(sums.xv, sums.yv))};
    }

    const TexturedMesh& m_mesh;
    std::vector<PointBits> m_bits;
    std::vector<std::int64_t> m_first;
    std::vector<std::size_t> m_begin, m_about;  ///< of each point the triangles about it, from m_begin on
};

// ---- Cubics ----

/// What rounding adds to the distance of a cut triangle's linear interpolation from its cubic, both coordinates together, in units of
/// 2^-53 times Cubic::size, M. A difference of places rounds 1, a product 1, two sums 2, a third 1 and the value's sum 1: points on sides
/// 6 M. The middle one: 6/4 of these, and sums and products of at most 6/4 + 3/6 of M, 8 each: 25 M. The blossom is an average of these,
/// exact in its weights, whose three levels round 3 each: 9 M more, 34 M in all; along a side, 6 M and 9 M. A difference from
/// (i a + j b + k c) / 3 rounds 34 M for the cubic's point, 34 M for what it is taken from, and 6 M for itself: 74 M for each coordinate,
/// 105 M for both.
constexpr double kTextureRounding = 110;

/// Rounding may take this share of the tolerance, so that what is cut becomes better.
constexpr double kRoundingShare = 0.125;

/// A side whose cubic is off by no more than this share of the tolerance is cut no further. Of a triangle that is whole the middle point is
/// off by at most 6/4 of that, as b111 is 1/4 of six points on sides but for what is linear. So it holds the tolerance without a cut.
constexpr double kSideShare = 0.5;

/// Values beyond are none: sums of six stay in double's range.
constexpr double kLargestTexture = 1e300;

/// A cubic on a triangle: its values as a symmetric function of three directions, the blossom, at the corners.
struct TextureCubic {
    /// Of the corners i, j and k, in any order, in kIndex[i][j][k].
    Texture b[10];
    /// By corners i and j, the largest magnitude of what the side's point next to i is made of.
    double size_of_end[3][3] = {};
    double size = 0;

    static constexpr std::size_t kIndex[3][3][3] = {{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}},
                                                    {{1, 3, 4}, {3, 6, 7}, {4, 7, 8}},
                                                    {{2, 4, 5}, {4, 7, 8}, {5, 8, 9}}};

    TextureCubic(const TexturedMesh& mesh, const Corners& corners) {
        Texture sides{0, 0}, ends{0, 0};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t p = index_of(corners[i]);
            b[kIndex[i][i][i]] = mesh.texture[p];
            ends = ends + mesh.texture[p];
            for (std::size_t j = 0; j < 3; ++j) {
                if (i == j) continue;
                const Texture value = next_to(mesh, corners, i, j);
                b[kIndex[i][i][j]] = value;
                sides = sides + value;
            }
        }
        b[kIndex[0][1][2]] = sides * 0.25 - ends * (1.0 / 6);
    }

    /// The size of the cubic on a side.
    double size_of_side(std::size_t i, std::size_t j) const {
        return std::max(size_of_end[i][j], size_of_end[j][i]);
    }
    /// The blossom at three points in barycentric coordinates; at the same thrice it is the cubic.
    Texture at(const Weights& p, const Weights& q, const Weights& r) const {
        Texture value{0, 0};
        for (std::size_t i = 0; i < 3; ++i) {
            Texture row{0, 0};
            for (std::size_t j = 0; j < 3; ++j) {
                Texture inner{0, 0};
                for (std::size_t k = 0; k < 3; ++k) inner = inner + b[kIndex[i][j][k]] * r[k];
                row = row + inner * q[j];
            }
            value = value + row * p[i];
        }
        return value;
    }

  private:
    /// The point of Bernstein's form on the side from corner i to j that is next to i: it depends on the two ends alone.
    Texture next_to(const TexturedMesh& mesh, const Corners& corners, std::size_t i, std::size_t j) {
        const std::size_t p = index_of(corners[i]);
        const glm::dvec3 along = mesh.points[index_of(corners[j])] - mesh.points[p];
        const TextureSlopes& slopes = mesh.slopes[p];
        const Texture slope{glm::dot(slopes.u, along), glm::dot(slopes.v, along)};
        const Texture value = mesh.texture[p] + slope * (1.0 / 3);
        const glm::dvec3 reach = glm::abs(along);
        double& end = size_of_end[i][j];
        end = std::max(std::fabs(mesh.texture[p].x) + glm::dot(glm::abs(slopes.u), reach) / 3,
                       std::fabs(mesh.texture[p].y) + glm::dot(glm::abs(slopes.v), reach) / 3);
        if (!(end < kLargestTexture) || !std::isfinite(value.x + value.y))
            end = std::numeric_limits<double>::infinity();
        size = std::max(size, end);
        return value;
    }
};

/// The texture's size in which distances count, and what is asked for.
struct Wanted {
    Size texture;
    double tol = 0;

    double texels(const Texture& d) const {
        // hypot rounds less than 1 ulp, the products half of one.
        return hypot(d.x * texture.width, d.y * texture.height) * (1 + 0x1p-51);
    }
    double rounding(double size) const {
        return kTextureRounding * 0x1p-53 * size * std::max(texture.width, texture.height);
    }
    bool rounds_little(double size) const { return rounding(size) <= kRoundingShare * tol; }
};

/// The cubic on a side, from its lesser end to its greater one.
class SideCubic {
  public:
    /// Of the side of a triangle from corner `side` to the next.
    SideCubic(const TexturedMesh& mesh, const TextureCubic& cubic, const Corners& corners, std::size_t side,
              const Wanted& wanted)
        : m_wanted(wanted) {
        constexpr auto& kIndex = TextureCubic::kIndex;
        const std::size_t next = kNextCorner[side];
        const PointBits a = bits_of(mesh, corners[side]), b = bits_of(mesh, corners[next]);
        m_greater = a < b ? next : side;
        const std::size_t from = a < b ? side : next, to = m_greater;
        m_b[0] = cubic.b[kIndex[from][from][from]];
        m_b[1] = cubic.b[kIndex[from][from][to]];
        m_b[2] = cubic.b[kIndex[from][to][to]];
        m_b[3] = cubic.b[kIndex[to][to][to]];
        m_may_be_cut = !same_place(a, b) && wanted.rounds_little(cubic.size_of_side(from, to));
    }

    /// The corner that is the greater end.
    std::size_t greater() const { return m_greater; }
    Texture at(double t) const { return blossom(t, t, t); }
    /// Is the part from s to t to be cut in its middle?
    bool is_cut(double s, double t) const {
        if (!m_may_be_cut || !(t - s > 0x1p-40)) return false;
        const Texture a = at(s), b = at(t);
        const double off = std::max(m_wanted.texels(blossom(s, s, t) - (a * 2 + b) * (1.0 / 3)),
                                    m_wanted.texels(blossom(s, t, t) - (a + b * 2) * (1.0 / 3)));
        return off > kSideShare * m_wanted.tol;
    }

  private:
    Texture blossom(double p, double q, double r) const {
        const auto between = [](const Texture& a, const Texture& b, double t) { return a * (1 - t) + b * t; };
        const Texture c0 = between(m_b[0], m_b[1], p), c1 = between(m_b[1], m_b[2], p),
                      c2 = between(m_b[2], m_b[3], p);
        return between(between(c0, c1, q), between(c1, c2, q), r);
    }

    const Wanted& m_wanted;
    Texture m_b[4];
    std::size_t m_greater = 0;
    bool m_may_be_cut = false;
};

// ---- Seams ----

/// A side of a given triangle: from its corner `side` to the next.
struct SideOfTriangle {
    std::int64_t triangle;
    std::size_t side;
};

/// The sides of which an end is several points at one place, as where a texture has a seam or a seam ends: all that lie on one another are
/// cut alike.
class SeamSides {
  public:
    explicit SeamSides(const TexturedMesh& mesh) : m_place(first_of_same(bits_of_all(mesh), kPlaceBits)) {
        std::vector<bool> is_doubled(m_place.size());
        for (std::size_t i = 0; i < m_place.size(); ++i)
            if (m_place[i] != static_cast<std::int64_t>(i))
                is_doubled[i] = is_doubled[index_of(m_place[i])] = true;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            for (std::size_t s = 0; s < 3; ++s) {
                const Corners& corners = mesh.triangles[t];
                const std::int64_t a = corners[s], b = corners[kNextCorner[s]];
                if (!is_doubled[index_of(a)] && !is_doubled[index_of(b)]) continue;
                // One of each pair of points will do.
                auto& sides = m_sides[key_of(a, b)];
                if (sides.by_points.emplace(std::minmax(a, b)).second)
                    sides.all.push_back({static_cast<std::int64_t>(t), s});
            }
    }

    /// The sides that lie on the one between two points, that one included; null where it is alone.
    const std::vector<SideOfTriangle>* on(std::int64_t a, std::int64_t b) const {
        if (m_sides.empty()) return nullptr;
        const auto found = m_sides.find(key_of(a, b));
        return found == m_sides.end() ? nullptr : &found->second.all;
    }

  private:
    using Places = std::pair<std::int64_t, std::int64_t>;
    struct Sides {
        std::set<Places> by_points;
        std::vector<SideOfTriangle> all;
    };

    Places key_of(std::int64_t a, std::int64_t b) const {
        return std::minmax(m_place[index_of(a)], m_place[index_of(b)]);
    }

    std::vector<std::int64_t> m_place;
    std::map<Places, Sides> m_sides;
};

// ---- One triangle ----

[[noreturn]] void refuse_tol(double tol, const std::string& why) {
    throw Error("tol", shortest(tol), "must be larger: " + why);
}

/// How many triangles there are, of all threads together. Throws Error where they become too many.
class TriangleCount {
  public:
    TriangleCount(double tol, std::int64_t most) : m_tol(tol), m_most(most) {}
    void grow(std::size_t by) {
        if ((m_count += static_cast<std::int64_t>(by)) > m_most)
            refuse_tol(m_tol, "more than " + std::to_string(m_most) + " triangles would be needed");
    }

  private:
    const double m_tol;
    const std::int64_t m_most;
    std::atomic<std::int64_t> m_count{0};
};

/// A triangle cut, with corners 0 to 2 its own and from 3 on `points`. Where it is whole, it has none.
struct Pieces {
    std::vector<TexturedPoint> points;
    std::vector<std::array<int, 3>> triangles;
    double error = 0;
    bool is_finite = true;
};

class TriangleCutter {
  public:
    TriangleCutter(const TexturedMesh& mesh, std::int64_t triangle, const SeamSides& seams,
                   const Wanted& wanted, TriangleCount& count)
        : m_triangle(triangle),
          m_wanted(wanted),
          m_count(count),
          m_cubic(mesh, mesh.triangles[index_of(triangle)]),
          m_is_finite(m_cubic.size < kLargestTexture),
          m_has_bound(has_bound(mesh, triangle, m_cubic)),
          m_rounding(wanted.rounding(m_cubic.size)) {
        const Corners& corners = mesh.triangles[index_of(triangle)];
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t p = index_of(corners[i]);
            m_points.push_back({triangle, {}, mesh.points[p], mesh.texture[p]});
            m_points.back().weights[i] = 1;
            m_sides.emplace_back(mesh, m_cubic, corners, i, wanted);
            const auto* on_it = seams.on(corners[i], corners[kNextCorner[i]]);
            if (!on_it) continue;
            for (const SideOfTriangle& other : *on_it) {
                const Corners& theirs = mesh.triangles[index_of(other.triangle)];
                m_beside[i].emplace_back(mesh, TextureCubic(mesh, theirs), theirs, other.side, wanted);
            }
        }
    }

    /// Has a triangle an inside, of which a cubic makes something that has a bound?
    static bool has_bound(const TexturedMesh& mesh, std::int64_t triangle, const TextureCubic& cubic) {
        const Corners& corners = mesh.triangles[index_of(triangle)];
        const PointBits a = bits_of(mesh, corners[0]), b = bits_of(mesh, corners[1]),
                        c = bits_of(mesh, corners[2]);
        return cubic.size < kLargestTexture && !same_place(a, b) && !same_place(b, c) && !same_place(c, a);
    }

    Pieces run() {
        m_parts.push_back({{0, 1, 2}});
        m_count.grow(1);
        std::size_t measured = 0;
        do {
            if (m_has_bound)
                for (; measured < m_parts.size(); ++measured) measure(m_parts[measured]);
            measured = cut();
        } while (measured < m_parts.size());
        Pieces pieces;
        pieces.is_finite = m_is_finite;
        for (const Part& part : m_parts) {
            pieces.error = std::max(pieces.error, part.error);
            if (m_parts.size() > 1) pieces.triangles.push_back(part.points);
        }
        pieces.points.assign(m_points.begin() + 3, m_points.end());
        return pieces;
    }

  private:
    struct Part {
        std::array<int, 3> points;
        double error = 0;
        std::array<double, 3> sides{};  ///< the error along each side alone
    };
    using Ends = std::pair<int, int>;

    const TexturedPoint& point(int i) const { return m_points[static_cast<std::size_t>(i)]; }

    /// The given side that both points lie on; -1 where there is none.
    int given_side(int a, int b) const {
        for (std::size_t s = 0; s < 3; ++s) {
            const std::size_t opposite = (s + 2) % 3;
            if (point(a).weights[opposite] == 0 && point(b).weights[opposite] == 0)
                return static_cast<int>(s);
        }
        return -1;
    }

    /// What linear interpolation is off by: the farthest of the difference's Bernstein points, in whose convex hull it lies.
    void measure(Part& part) const {
        part.error = m_rounding;
        const auto off = [&](std::size_t i, std::size_t j, std::size_t k) {
            const TexturedPoint &a = point(part.points[i]), &b = point(part.points[j]),
                                &c = point(part.points[k]);
            const Texture linear = (a.texture + b.texture + c.texture) * (1.0 / 3);
            const double d =
                m_wanted.texels(m_cubic.at(a.weights, b.weights, c.weights) - linear) + m_rounding;
            if (!(d <= part.error)) part.error = d;
            return d;
        };
        for (std::size_t s = 0; s < 3; ++s) {
            const std::size_t a = s, b = kNextCorner[s];
            part.sides[s] = std::max(off(a, a, b), off(a, b, b));
        }
        off(0, 1, 2);
    }

    bool is_cut_by_rule(int side, int a, int b) const {
        const auto s = static_cast<std::size_t>(side);
        const std::size_t greater = m_sides[s].greater();
        const auto [t, u] = std::minmax(point(a).weights[greater], point(b).weights[greater]);
        if (m_sides[s].is_cut(t, u)) return true;
        return std::any_of(m_beside[s].begin(), m_beside[s].end(),
                           [t = t, u = u](const SideCubic& other) { return other.is_cut(t, u); });
    }

    /// Adds the sides of a part that are to be cut: the given ones' by their rule, others where it is off by too much.
    void want_cuts(const Part& part, std::map<Ends, int>& middles) const {
        // The error of the worst side that may be cut, of those within.
        double worst = 0;
        bool is_inner[3];
        for (std::size_t s = 0; s < 3; ++s) {
            const int a = part.points[s], b = part.points[kNextCorner[s]];
            const int side = given_side(a, b);
            is_inner[s] = side < 0;
            if (side >= 0 && is_cut_by_rule(side, a, b)) {
                middles.emplace(std::minmax(a, b), -1);
                worst = std::max(worst, part.sides[s]);
            } else if (is_inner[s])
                worst = std::max(worst, part.sides[s]);
        }
        if (!m_has_bound || part.error <= m_wanted.tol) return;
        for (std::size_t s = 0; s < 3; ++s)
            if (is_inner[s] && part.sides[s] >= 0.5 * worst)
                middles.emplace(std::minmax(part.points[s], part.points[kNextCorner[s]]), -1);
    }

    int middle_of(const Ends& ends) {
        const TexturedPoint &a = point(ends.first), &b = point(ends.second);
        TexturedPoint middle{m_triangle, {}, a.place * 0.5 + b.place * 0.5, {}};
        for (std::size_t i = 0; i < 3; ++i) middle.weights[i] = 0.5 * (a.weights[i] + b.weights[i]);
        const int side = given_side(ends.first, ends.second);
        const auto s = static_cast<std::size_t>(side);
        middle.texture = side >= 0 ? m_sides[s].at(middle.weights[m_sides[s].greater()])
                                   : m_cubic.at(middle.weights, middle.weights, middle.weights);
        m_points.push_back(middle);
        return static_cast<int>(m_points.size()) - 1;
    }

    /// Cuts the parts once; the new ones come last, after those that are as they were, whose number it returns.
    std::size_t cut() {
        std::map<Ends, int> middles;
        for (const Part& part : m_parts) want_cuts(part, middles);
        std::vector<Part> kept, made;
        if (!middles.empty()) {
            std::size_t more = 0;
            for (const Part& part : m_parts)
                for (std::size_t s = 0; s < 3; ++s)
                    more += middles.count(std::minmax(part.points[s], part.points[kNextCorner[s]]));
            m_count.grow(more);
            for (auto& [ends, id] : middles) id = middle_of(ends);
            for (const Part& part : m_parts) split(part, middles, kept, made);
            m_parts = std::move(kept);
        }
        const std::size_t unchanged = m_parts.size();
        m_parts.insert(m_parts.end(), made.begin(), made.end());
        return unchanged;
    }

    /// Adds a part to those that are kept, or two to four in its place.
    static void split(const Part& part, const std::map<Ends, int>& middles, std::vector<Part>& kept,
                      std::vector<Part>& made) {
        // Corners 0 to 2, and the middles of the sides after them as 3 to 5.
        std::array<int, 6> ids{};
        int count = 0;
        for (std::size_t s = 0; s < 3; ++s) {
            ids[s] = part.points[s];
            const auto found = middles.find(std::minmax(part.points[s], part.points[kNextCorner[s]]));
            ids[3 + s] = found == middles.end() ? -1 : found->second;
            count += ids[3 + s] >= 0;
        }
        const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
            made.push_back({{ids[a], ids[b], ids[c]}});
        };
        // The side that is cut alone, or left whole alone, or any.
        std::size_t s = 0;
        while (s < 2 && (ids[3 + s] >= 0) != (count != 2)) ++s;
        const std::size_t a = s, b = (s + 1) % 3, c = (s + 2) % 3;
        if (count == 0)
            kept.push_back(part);
        else if (count == 1) {
            add(a, 3 + a, c);
            add(3 + a, b, c);
        } else if (count == 2) {
            // The quadrilateral beside the whole side a b is cut from a.
            add(a, b, 3 + b);
            add(a, 3 + b, 3 + c);
            add(3 + c, 3 + b, c);
        } else {
            add(0, 3, 5);
            add(3, 1, 4);
            add(5, 4, 2);
            add(3, 4, 5);
        }
    }

    const std::int64_t m_triangle;
    const Wanted& m_wanted;
    TriangleCount& m_count;
    const TextureCubic m_cubic;
    const bool m_is_finite, m_has_bound;
    const double m_rounding;
    std::vector<SideCubic> m_sides;
    std::array<std::vector<SideCubic>, 3> m_beside;  ///< of each side those that lie on it
    std::vector<TexturedPoint> m_points;
    std::vector<Part> m_parts;
};

// ---- All of them ----

/// A point on a side: its ends, and how far it is from the lesser one.
struct PointOnSide {
    std::int64_t from, to;
    double at;
    bool operator==(const PointOnSide&) const = default;
};
struct PointOnSideHash {
    std::size_t operator()(const PointOnSide& p) const {
        std::uint64_t h = bit_cast<std::uint64_t>(p.at);
        for (const std::int64_t id : {p.from, p.to})
            h = (h ^ (h >> 29)) * 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(id);
        return static_cast<std::size_t>(h * 0x9e3779b97f4a7c15u);
    }
};

/// Puts triangles that were cut one by one together, whose points on common sides are one.
class Joiner {
  public:
    explicit Joiner(const TexturedMesh& mesh) : m_mesh(mesh) {}

    void add(std::int64_t triangle, const Pieces& pieces) {
        const Corners& corners = m_mesh.triangles[index_of(triangle)];
        m_result.max_error = std::max(m_result.max_error, pieces.error);
        m_result.not_finite += pieces.is_finite ? 0 : 1;
        std::vector<std::int64_t> ids(corners.begin(), corners.end());
        for (const TexturedPoint& point : pieces.points) ids.push_back(id_of(point, corners));
        if (pieces.triangles.empty()) m_result.triangles.push_back({corners, triangle});
        for (const auto& t : pieces.triangles) {
            Corners points;
            for (std::size_t k = 0; k < 3; ++k) points[k] = ids[static_cast<std::size_t>(t[k])];
            m_result.triangles.push_back({points, triangle});
        }
    }
    CutMesh take() { return std::move(m_result); }

  private:
    std::int64_t id_of(const TexturedPoint& point, const Corners& corners) {
        const std::int64_t next = static_cast<std::int64_t>(m_mesh.points.size() + m_result.points.size());
        const auto zero = std::find(point.weights.begin(), point.weights.end(), 0.0);
        if (zero != point.weights.end()) {
            const auto opposite = static_cast<std::size_t>(zero - point.weights.begin());
            std::size_t a = (opposite + 1) % 3, b = (opposite + 2) % 3;
            if (corners[b] < corners[a]) std::swap(a, b);
            const auto [found, is_new] =
                m_on_sides.try_emplace({corners[a], corners[b], point.weights[b]}, next);
            if (!is_new) return found->second;
        }
        m_result.points.push_back(point);
        return next;
    }

    const TexturedMesh& m_mesh;
    std::unordered_map<PointOnSide, std::int64_t, PointOnSideHash> m_on_sides;
    CutMesh m_result;
};

}  // namespace

std::vector<TextureSlopes> fitted_slopes(const TexturedMesh& mesh, const ParallelFor& parallel_for) {
    return SlopeFitter(mesh).all(parallel_for);
}

void check_texture(const Size& texture, double tol) {
    kTextureTolRow.check(tol, "tol");
    kTextureWidthRow.check(texture.width);
    kTextureHeightRow.check(texture.height);
}

CutMesh cut_texture(const TexturedMesh& mesh, const Size& texture, double tol,
                    const ParallelFor& parallel_for, std::int64_t most) {
    check_texture(texture, tol);
    const Wanted wanted{texture, tol};
    const auto count = static_cast<std::int64_t>(mesh.triangles.size());
    if (count == 0) return {};
    if (count > most) TriangleCount(tol, most).grow(mesh.triangles.size());
    // What rounds too much is refused before anything is cut.
    std::vector<double> sizes(mesh.triangles.size());
    parallel_for(count, [&](std::int64_t i) {
        const TextureCubic cubic(mesh, mesh.triangles[index_of(i)]);
        if (TriangleCutter::has_bound(mesh, i, cubic)) sizes[index_of(i)] = cubic.size;
    });
    const double largest_size = *std::max_element(sizes.begin(), sizes.end());
    if (!wanted.rounds_little(largest_size))
        refuse_tol(tol,
                   "texture coordinates as large as these round by " + brief(wanted.rounding(largest_size)));
    const SeamSides seams(mesh);
    TriangleCount made(tol, most);
    std::vector<Pieces> pieces(mesh.triangles.size());
    parallel_for(count, [&](std::int64_t i) {
        pieces[index_of(i)] = TriangleCutter(mesh, i, seams, wanted, made).run();
    });
    Joiner joiner(mesh);
    for (std::int64_t i = 0; i < count; ++i) joiner.add(i, pieces[index_of(i)]);
    return joiner.take();
}

}  // namespace anamorph::surface
