// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/edge_rule.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

namespace anamorph {
namespace {

using IntervalJet = Jet2<Interval>;

// What a handful of roundings may take from a bound that is made of a few operations.
constexpr double kHair = 1 + 1e-9;
// Wider balls are not worth a bound.
constexpr double kWidest = 0.5;

Ray<double> ray_of(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

/// What is read of the panorama over a cone of rays: (c + s e_1 + t e_2) for |s|, |t| <= rho.
class Cone {
  public:
    Cone(const glm::dvec3& middle, double rho) : m_c(glm::normalize(middle)), m_rho(rho * kHair) {
        const glm::dvec3 other = std::fabs(m_c.y) < 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
        m_e = glm::normalize(glm::cross(other, m_c));
        m_f = glm::cross(m_c, m_e);
    }

    const glm::dvec3& middle() const { return m_c; }

    /// The rays turned by a matrix, with derivatives along e_1 and e_2.
    Ray<IntervalJet> jets(const glm::dmat3& turn) const {
        const glm::dvec3 c = turn * m_c, e = turn * m_e, f = turn * m_f;
        const Interval off(-m_rho, m_rho);
        IntervalJet part[3];
        for (int i = 0; i < 3; ++i) {
            // The frame is off by a few roundings of 1.
            part[i].c[0] = Interval(c[i]) + off * e[i] + off * f[i] + Interval(-kFrame, kFrame);
            part[i].c[1] = Interval(e[i] - kFrame, e[i] + kFrame);
            part[i].c[2] = Interval(f[i] - kFrame, f[i] + kFrame);
        }
        return {part[0], part[1], part[2]};
    }

    /// Whether v . r may be positive for one of the rays.
    bool may_be_above(const glm::dvec3& v) const {
        return glm::dot(v, m_c) + glm::length(v) * (m_rho + kFrame) >= 0;
    }

  private:
    static constexpr double kFrame = 64 * 0x1p-53;
    glm::dvec3 m_c, m_e, m_f;
    double m_rho;
};

/// Bounds of the first and second derivatives of a jet, along any unit vector.
struct Slopes {
    double first, second;
};
Slopes slopes_of(const IntervalJet& jet) {
    const double ss = 2 * magnitude(jet.c[3]), st = magnitude(jet.c[4]), tt = 2 * magnitude(jet.c[5]);
    return {std::hypot(magnitude(jet.c[1]), magnitude(jet.c[2])), std::max(ss, tt) + st};
}

/// What is read over a cone: whether it is all beside the panorama, and bounds of derivatives where there are any.
struct Reading {
    bool outside = false, smooth = false;
    Slopes x{}, y{};
};

bool beside(const Interval& range, double size) {
    return range.hi < 0 || range.lo > size;
}

Reading read(const Chart& chart, const Cone& cone, const Branch& branch) {
    const Ray<IntervalJet> local = cone.jets(glm::transpose(branch.axes));
    const Ray<Interval> range{local.x.c[0], local.y.c[0], local.z.c[0]};
    Reading reading;
    if (chart.pieces().size() == 1 && chart.sees(range, branch.piece).hi < 0) {
        reading.outside = true;
        return reading;
    }
    const Point<IntervalJet> p = chart.local_point(local, branch);
    // Azimuths are counted within a quarter of a turn from those of the middle.
    const bool one_branch = chart.counted() != Counted::azimuth || range.z.lo > 0;
    reading.outside = one_branch && ((!chart.closed() && beside(p.x.c[0], chart.width())) ||
                                     beside(p.y.c[0], chart.height()));
    reading.x = slopes_of(p.x);
    reading.y = slopes_of(p.y);
    const double sum = reading.x.first + reading.x.second + reading.y.first + reading.y.second;
    const bool seen = chart.pieces().size() > 1 || chart.sees(range, branch.piece).lo > 0;
    reading.smooth = one_branch && seen && std::isfinite(sum);
    return reading;
}

/// The branches that rays of a cone may be read on: of each piece that they may meet, and sides of creases.
std::vector<Branch> branches_over(const Chart& chart, const Cone& cone) {
    const Ray<double> middle = ray_of(cone.middle());
    if (chart.pieces().size() == 1) return {chart.branch_around(middle)};
    const int best = chart.piece_of(middle);
    std::vector<Branch> branches;
    for (int i = 0; i < static_cast<int>(chart.pieces().size()); ++i) {
        const auto& pieces = chart.pieces();
        const glm::dvec3 toward =
            pieces[static_cast<std::size_t>(i)].toward - pieces[static_cast<std::size_t>(best)].toward;
        if (i == best)
            branches.push_back(chart.branch_around(middle));
        else if (cone.may_be_above(toward))
            branches.push_back(chart.branch(i));
    }
    return branches;
}

}  // namespace

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
        if (chart.counted() != Counted::azimuth) return -1;
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

EdgeFinding EdgeRule::judge_ball(const glm::dvec3& centre, double radius, double edge) const {
    const double distance = glm::length(centre);
    const double rho = radius / std::sqrt(std::max(0.0, (distance - radius) * (distance + radius))) * kHair;
    if (!(rho <= kWidest)) return {EdgeVerdict::split};
    const Chart& chart = m_projector.panorama();
    const Cone cone(centre, rho);
    // Directions in the cone have no more forward than that of its middle and rho.
    if (cone.middle().z + rho < m_projector.least_forward() - 1e-9) return {EdgeVerdict::outside};
    const double near = (distance - radius) / kHair;
    const double turned = std::sqrt(1 + rho * rho) / near, bent = (1 + 2 * rho) / (near * near);
    bool outside = true, smooth = true;
    double most = 0;
    for (const Branch& branch : branches_over(chart, cone)) {
        const Reading reading = read(chart, cone, branch);
        if (reading.outside) continue;
        outside = false;
        smooth = smooth && reading.smooth;
        // Eq. (2), then (1).
        const auto off = [&](const Slopes& s) {
            return (s.second * turned * turned + s.first * bent) * edge * edge / 6;
        };
        most = std::max(most, std::hypot(off(reading.x), off(reading.y)) * kHair);
    }
    if (outside) return {EdgeVerdict::outside};
    if (smooth && most <= m_tol) return {EdgeVerdict::bounded, most};
    if (4 * rho * chart.pixels_per_radian() <= m_tol) return {EdgeVerdict::tiny};
    return {EdgeVerdict::split};
}

EdgeFinding EdgeRule::judge(const glm::dvec3& a, const glm::dvec3& b) const {
    const glm::dvec3 from = m_projector.ray(a), to = m_projector.ray(b);
    const double edge = glm::length(to - from);
    if (!(edge < HUGE_VAL)) return {};
    const double at = crossing(from, to);
    if (at > 0) return edge > m_smallest ? EdgeFinding{EdgeVerdict::cut, 0, at} : EdgeFinding{};
    const EdgeFinding found = judge_ball(0.5 * (from + to), std::sqrt(0.75) * edge * kHair, edge * kHair);
    if (found.verdict == EdgeVerdict::split && !(edge > m_smallest)) return {};
    return found;
}

}  // namespace anamorph
