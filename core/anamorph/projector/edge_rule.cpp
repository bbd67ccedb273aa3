// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/edge_rule.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>

#include "anamorph/number/hypot.h"

namespace anamorph {
namespace {

using IntervalJet = Jet2<Interval>;

// What a handful of roundings may take from a bound that is made of a few operations.
constexpr double kHair = 1 + 1e-9;
// Wider cones are not worth a bound.
constexpr double kWidest = 0.5;

Ray<double> ray_of(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

/// All rays within a tangent of `rho` of the middle of some.
class Cone {
  public:
    explicit Cone(const std::array<glm::dvec3, 3>& rays) {
        std::array<glm::dvec3, 3> units;
        for (std::size_t i = 0; i < 3; ++i) m_c += units[i] = glm::normalize(rays[i]);
        m_c = glm::normalize(m_c);
        for (const glm::dvec3& u : units) {
            const double along = glm::dot(u, m_c);
            const double off = along > 0 ? glm::length(u - along * m_c) / along : HUGE_VAL;
            if (!(off <= m_rho)) m_rho = off;
        }
        m_rho *= kHair;
    }

    const glm::dvec3& middle() const { return m_c; }
    double rho() const { return m_rho; }

  private:
    glm::dvec3 m_c{0.0};
    double m_rho = 0;
};

/// A triangle of rays from the middle of its longest side's opposite corner: r = origin + s e + t f. It is an edge where e
/// and f are along it.
struct RayTriangle {
    std::array<glm::dvec3, 3> rays;
    glm::dvec3 e, f;

    explicit RayTriangle(const std::array<glm::dvec3, 3>& corners) : rays(corners) {
        std::size_t top = 0;
        double most = -1;
        for (std::size_t i = 0; i < 3; ++i) {
            const double side = glm::length(corners[(i + 1) % 3] - corners[(i + 2) % 3]);
            if (side > most) most = side, top = i;
        }
        e = corners[(top + 1) % 3] - corners[top];
        f = corners[(top + 2) % 3] - corners[top];
    }

    /// All of its rays turned by a matrix, with derivatives along e and f. What is as near to a plane of axes as
    /// `on_plane` of a ray lies in it. The box about them is larger by `wider`.
    Ray<IntervalJet> jets(const glm::dmat3& turn, double on_plane, double wider) const {
        std::array<glm::dvec3, 3> r;
        double size = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            r[i] = turn * rays[i];
            size = std::max(size, glm::length(r[i]));
        }
        const glm::dvec3 along = turn * e, across = turn * f;
        IntervalJet part[3];
        for (int i = 0; i < 3; ++i) {
            // The frame is off by a few roundings of the largest.
            const double hair = 64 * 0x1p-53 * size;
            double low = std::min({r[0][i], r[1][i], r[2][i]}) - hair;
            double high = std::max({r[0][i], r[1][i], r[2][i]}) + hair;
            const double more = wider * (high - low);
            if (low < 0 && low >= -on_plane * size) low = 0;
            if (high > 0 && high <= on_plane * size) high = std::max(0.0, low);
            if (low != 0) low -= more;
            if (high != 0) high += more;
            part[i].c[0] = {std::min(low, high), high};
            part[i].c[1] = {along[i] - hair, along[i] + hair};
            part[i].c[2] = {across[i] - hair, across[i] + hair};
        }
        return {part[0], part[1], part[2]};
    }
};

SecondForms forms_of(const IntervalJet& jet) {
    const Interval ee = jet.c[3] * 2.0, ef = jet.c[4], ff = jet.c[5] * 2.0;
    const auto middle = [](const Interval& i) { return 0.5 * i.lo + 0.5 * i.hi; };
    const auto radius = [&](const Interval& i) { return std::max(i.hi - middle(i), middle(i) - i.lo); };
    return {middle(ee), middle(ef), middle(ff), radius(ee), radius(ef), radius(ff)};
}

/// Eq. (2) for one coordinate: its form at the corners, and what it may be off anywhere.
struct Bend {
    double e, f, g;  ///< twice the form of e, f and their difference
    double off;

    explicit Bend(const SecondForms& of)
        : e(of.ee),
          f(of.ff),
          g(of.ee + of.ff - 2 * of.ef),
          off((of.off_ee + 2 * of.off_ef + of.off_ff) / 8) {}
};

/// The most of (l_0 l_1 e + l_0 l_2 f + l_1 l_2 g) / 2 and of its negative over all weights: at the middle of a side, or
/// where its derivatives are 0.
double most_within(double e, double f, double g) {
    double most = std::max({std::fabs(e), std::fabs(f), std::fabs(g)}) / 8;
    const double a = g * (e + f - g), b = f * (e + g - f), c = e * (f + g - e), sum = a + b + c;
    // The weights of the stationary point are as a : b : c.
    if (a * sum > 0 && b * sum > 0 && c * sum > 0) {
        const double l0 = a / sum, l1 = b / sum, l2 = c / sum;
        most = std::max(most, std::fabs(l0 * l1 * e + l0 * l2 * f + l1 * l2 * g) / 2);
    }
    return most;
}

/// A bound of what interpolation is off across a triangle, by eq. (2).
double bound_of(const Point<SecondForms>& forms) {
    const Bend x(forms.x), y(forms.y);
    // A vector is no longer than its parts in directions that are 22.5 degrees apart say.
    constexpr int kDirections = 8;
    static const auto directions = [] {
        std::array<glm::dvec2, kDirections> all;
        for (int i = 0; i < kDirections; ++i) {
            const double angle = std::numbers::pi * i / kDirections;
            all[static_cast<std::size_t>(i)] = {std::cos(angle), std::sin(angle)};
        }
        return all;
    }();
    static const double shortest = std::cos(std::numbers::pi / (2 * kDirections));
    double most = 0;
    for (const glm::dvec2& d : directions)
        most =
            std::max(most, most_within(d.x * x.e + d.y * y.e, d.x * x.f + d.y * y.f, d.x * x.g + d.y * y.g));
    const double sum = most / shortest + hypot(x.off, y.off);
    return sum * kHair;
}

/// Times a power of 2, so that the longest part is from 1 to 2. False where a ray has no direction then.
bool to_common_scale(std::array<glm::dvec3, 3>& rays) {
    double most = 0;
    for (const glm::dvec3& r : rays) most = std::max({most, std::fabs(r.x), std::fabs(r.y), std::fabs(r.z)});
    if (!(most > 0 && most < HUGE_VAL)) return false;
    const int exponent = -std::ilogb(most);
    // A product with a power of two is quicker, where there is one.
    const bool is_plain = std::abs(exponent) < 1022;
    const double power = is_plain ? std::ldexp(1.0, exponent) : 0;
    const auto scaled = [&](double v) { return is_plain ? v * power : std::ldexp(v, exponent); };
    for (glm::dvec3& r : rays) {
        r = {scaled(r.x), scaled(r.y), scaled(r.z)};
        if (!(glm::length(r) > 0)) return false;
    }
    return true;
}

/// What is read over a triangle: whether it is all beside the panorama, and a bound where there is one.
struct Reading {
    bool outside = false, smooth = false;
    double bound = 0;
};

bool beside(const Interval& range, double size) {
    return range.hi < 0 || range.lo > size;
}

Reading read(const Chart& chart, const RayTriangle& triangle, const Branch& branch, double on_plane,
             double wider) {
    const bool faces = chart.pieces().size() > 1, all_seen = chart.pieces_see_all();
    const Ray<IntervalJet> local = triangle.jets(glm::transpose(branch.axes), faces ? on_plane : 0, wider);
    const Ray<Interval> range{local.x.c[0], local.y.c[0], local.z.c[0]};
    Reading reading;
    if (!all_seen && chart.sees(range, branch.piece).hi < 0) {
        reading.outside = true;
        return reading;
    }
    const Point<IntervalJet> p = chart.local_point(local, branch);
    // Azimuths are counted within a quarter of a turn from those of the middle.
    const bool one_branch = chart.counted() != Counted::azimuth || range.z.lo > 0;
    reading.outside = one_branch && ((!chart.closed() && beside(p.x.c[0], chart.width())) ||
                                     beside(p.y.c[0], chart.height()));
    const bool seen = all_seen || chart.sees(range, branch.piece).lo > 0;
    reading.bound = bound_of({forms_of(p.x), forms_of(p.y)});
    reading.smooth = one_branch && seen && std::isfinite(reading.bound);
    return reading;
}

}  // namespace

EdgeRule::EdgeRule(const Projector& projector, double tol, double smallest, bool single)
    : m_projector(projector), m_tol(tol), m_smallest(smallest), m_on_plane(single ? 0x1p-20 : 0x1p-40) {
    // Where a panorama ends, cells would tell less than boxes of their own do, and triangles next to edges would be cut more often.
    if (projector.panorama().closed())
        m_cells = std::make_unique<const DerivativeCells>(projector.panorama());
}

bool EdgeRule::in_order(const glm::dvec3& a, const glm::dvec3& b) {
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
}

double EdgeRule::crossing(const glm::dvec3& a, const glm::dvec3& b) const {
    const Chart& chart = m_projector.panorama();
    // The root of what is linear along the edge and of two signs, neither of them in doubt.
    const auto root = [&](double at_a, double at_b) {
        const bool clear =
            std::fabs(at_a) > m_on_plane * glm::length(a) && std::fabs(at_b) > m_on_plane * glm::length(b);
        return clear && (at_a < 0) != (at_b < 0) ? at_a / (at_a - at_b) : -1;
    };
    if (chart.pieces().size() == 1) {
        if (chart.counted() != Counted::azimuth || (a.x < 0) == (b.x < 0)) return -1;
        const double t = root(a.x, b.x);
        return t > 0 && t < 1 && a.z + t * (b.z - a.z) < 0 ? t : -1;
    }
    const double crease = root(chart.crease(ray_of(a)), chart.crease(ray_of(b)));
    if (crease > 0 && crease < 1) return crease;
    // An end on a border is on several faces: the first crossing from any of them to any of the other end's.
    const std::vector<std::size_t> from = faces_at(a), to = faces_at(b);
    double first = -1;
    for (const std::size_t i : from)
        for (const std::size_t j : to) {
            const glm::dvec3 normal = chart.pieces()[i].toward - chart.pieces()[j].toward;
            const double t = root(glm::dot(normal, a), glm::dot(normal, b));
            if (t > 0 && t < 1 && (first < 0 || t < first)) first = t;
        }
    return first;
}

std::vector<std::size_t> EdgeRule::faces_at(const glm::dvec3& ray) const {
    const auto& pieces = m_projector.panorama().pieces();
    double most = -HUGE_VAL;
    for (const auto& piece : pieces) most = std::max(most, glm::dot(piece.toward, ray));
    std::vector<std::size_t> faces;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        if (glm::dot(pieces[i].toward, ray) >= most - m_on_plane * glm::length(ray)) faces.push_back(i);
    return faces;
}

std::vector<Branch> EdgeRule::branches_of_faces(const glm::dvec3& middle) const {
    const Chart& chart = m_projector.panorama();
    std::vector<Branch> found;
    for (const std::size_t face : faces_at(middle)) {
        const int piece = static_cast<int>(face);
        found.push_back(piece == chart.piece_of(ray_of(middle)) ? chart.branch_around(ray_of(middle))
                                                                : chart.branch(piece));
    }
    return found;
}

Branch EdgeRule::branch_between(const std::array<glm::dvec3, 3>& rays, const glm::dvec3& middle) const {
    const Chart& chart = m_projector.panorama();
    if (chart.counted() != Counted::azimuth) return chart.branch_around(ray_of(middle));
    // Half way between the azimuths that are farthest apart: part of an edge is then never farther from it than all.
    glm::dvec2 azimuths[3], half(0.0);
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i) {
        const double size = hypot(rays[i].x, rays[i].z);
        azimuths[i] = size > 0 ? glm::dvec2(rays[i].x, rays[i].z) / size : glm::dvec2(0.0);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 &p = azimuths[i], &q = azimuths[(i + 1) % 3];
        if (glm::dot(p, q) >= least) continue;
        least = glm::dot(p, q);
        half = p + q;
    }
    return chart.branch_around(Ray<double>{half.x, 0, half.y});
}

EdgeFinding EdgeRule::judge_rays(std::array<glm::dvec3, 3> rays, std::span<const Branch> branches,
                                 double share, double wider) const {
    const Chart& chart = m_projector.panorama();
    if (!to_common_scale(rays)) return {EdgeVerdict::split};
    const Cone cone(rays);
    if (!(cone.rho() <= kWidest)) return {EdgeVerdict::split};
    // Directions in the cone have no more forward than that of its middle and rho.
    if (cone.middle().z + cone.rho() < m_projector.least_forward() - 1e-9) return {EdgeVerdict::outside};
    const RayTriangle triangle(rays);
    bool outside = true, smooth = true;
    double most = 0;
    for (const Branch& branch : branches) {
        const Reading reading = read(chart, triangle, branch, m_on_plane, wider);
        if (reading.outside) continue;
        outside = false;
        smooth = smooth && reading.smooth;
        most = std::max(most, reading.bound);
    }
    if (outside) return {EdgeVerdict::outside};
    if (smooth && most <= share * m_tol) return {EdgeVerdict::bounded, most};
    // Faces have no poles, and more texels to a radian at their corners.
    const double reach = chart.pieces().size() > 1 ? 16 : 4;
    if (reach * cone.rho() * chart.pixels_per_radian() <= share * m_tol) return {EdgeVerdict::tiny};
    return {EdgeVerdict::split};
}

bool EdgeRule::is_off_in_middle(const glm::dvec3& a, const glm::dvec3& b) const {
    const Chart& chart = m_projector.panorama();
    const double most = kShare * m_tol, squared = glm::dot(a, a) * glm::dot(b, b);
    const glm::dvec3 across = glm::cross(a, b);
    // A panorama bends about as a circle does. Where that is half of what may be or less, or out of double's range, the bound decides.
    const double bend = glm::dot(across, across) / squared * chart.pixels_per_radian() / 8;
    if (!(bend > 0.5 * most) || !(squared > 0x1p-800 && squared < 0x1p800)) return false;
    const glm::dvec3 middle = 0.5 * (a + b);
    const int piece = chart.piece_of(ray_of(middle));
    Point<double> at[3];
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 r = i == 0 ? a : i == 1 ? b : middle;
        const Ray<double> local = transform(glm::transpose(chart.branch(piece).axes), ray_of(r));
        if (!chart.pieces_see_all() && !(chart.sees(local, piece) > 0)) return false;
        at[i] = chart.local_point(local, chart.branch(piece));
    }
    const double off = hypot(at[2].x - 0.5 * (at[0].x + at[1].x), at[2].y - 0.5 * (at[0].y + at[1].y));
    // Texels are off by some ten roundings of numbers up to the panorama's size, two of them by twice that.
    const double rounding = 64 * 0x1p-53 * std::max(chart.width(), chart.height());
    const bool is_within =
        at[2].x > 1 && at[2].x < chart.width() - 1 && at[2].y > 1 && at[2].y < chart.height() - 1;
    // Ends on either side of where azimuths begin are off by half of a turn.
    return is_within && off > 1.001 * most + rounding && off < 0.1 * chart.width();
}

EdgeFinding EdgeRule::judge_by_cells(const glm::dvec3& a, const glm::dvec3& b) const {
    if (!m_cells) return {};
    // Of an edge, where f is 0, eq. (2) is the form of e over 8.
    const auto bend = m_cells->over(std::array{a, b}, 0.5 * (a + b), b - a);
    if (!bend) return {};
    const auto length = [](double x, double y) { return std::sqrt(x * x + y * y) * kHair; };
    const double middle = length(bend->x.ee, bend->y.ee) / 8,
                 off = length(bend->x.off_ee, bend->y.off_ee) / 8;
    if (middle + off <= kSureShare * m_tol) return {EdgeVerdict::bounded, middle + off};
    // Bent by more than that everywhere, no bound of it is any less. What may be tiny (judge_rays) is not settled here.
    const glm::dvec3 across = glm::cross(a, b);
    const double seen = 2 * std::sqrt(glm::dot(across, across) / (glm::dot(a, a) * glm::dot(b, b))) *
                        m_projector.panorama().pixels_per_radian();
    return {middle - off > kShare * m_tol * kHair * kHair && seen > m_tol ? EdgeVerdict::split
                                                                          : EdgeVerdict::hopeless};
}

EdgeFinding EdgeRule::judge(const glm::dvec3& a, const glm::dvec3& b) const {
    const glm::dvec3 from = m_projector.ray(a), to = m_projector.ray(b);
    const double edge = glm::length(to - from);
    if (!(edge < HUGE_VAL)) return {};
    const double at = crossing(from, to);
    if (at > 0) return edge > m_smallest ? EdgeFinding{EdgeVerdict::cut, 0, at} : EdgeFinding{};
    EdgeFinding found = judge_by_cells(from, to);
    if (found.verdict == EdgeVerdict::hopeless && is_off_in_middle(from, to)) found = {EdgeVerdict::split};
    if (found.verdict == EdgeVerdict::hopeless) {
        const glm::dvec3 middle = 0.5 * (from + to);
        if (m_projector.panorama().pieces().size() > 1)
            found = judge_rays({from, to, from}, branches_of_faces(middle), kShare, kWider);
        else
            found = judge_rays({from, to, from}, std::array{branch_between({from, to, to}, middle)}, kShare,
                               kWider);
    }
    if (found.verdict == EdgeVerdict::split && !(edge > m_smallest)) return {};
    return found;
}

EdgeFinding EdgeRule::judge(const std::array<glm::dvec3, 3>& corners) const {
    std::array<glm::dvec3, 3> rays;
    for (std::size_t i = 0; i < 3; ++i) rays[i] = m_projector.ray(corners[i]);
    const glm::dvec3 middle = middle_of(rays);
    if (m_cells) {
        const RayTriangle triangle(rays);
        const auto forms =
            m_cells->over(rays, rays[0] / 3.0 + rays[1] / 3.0 + rays[2] / 3.0, triangle.e, &triangle.f);
        const double bound = forms ? bound_of(*forms) : HUGE_VAL;
        if (bound <= m_tol) return {EdgeVerdict::bounded, bound};
    }
    return judge_rays(rays, std::array{branch_between(rays, middle)}, 1, 0);
}

std::optional<glm::dvec3> EdgeRule::axis_in(const std::array<glm::dvec3, 3>& corners) const {
    if (m_projector.panorama().counted() != Counted::azimuth) return {};
    std::array<glm::dvec3, 3> rays;
    for (std::size_t i = 0; i < 3; ++i) rays[i] = m_projector.ray(corners[i]);
    if (!to_common_scale(rays)) return {};
    // Weights by areas as seen along the axis.
    glm::dvec3 weights;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 &p = rays[(i + 1) % 3], &q = rays[(i + 2) % 3];
        weights[static_cast<int>(i)] = p.x * q.z - p.z * q.x;
    }
    weights /= weights.x + weights.y + weights.z;
    for (int i = 0; i < 3; ++i)
        if (!(weights[i] > 1e-9)) return {};
    return weights;
}

glm::dvec3 EdgeRule::middle_of(const std::array<glm::dvec3, 3>& rays) {
    return scaled_ray(rays[0] / 3.0 + rays[1] / 3.0 + rays[2] / 3.0);
}

}  // namespace anamorph
