// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/plane_warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <queue>

#include "anamorph/error.h"
#include "anamorph/number/hypot.h"
#include "anamorph/number/interval.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool finite(glm::dvec3 p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}
bool finite(glm::dvec2 s) {
    return std::isfinite(s.x) && std::isfinite(s.y);
}

std::string written(glm::dvec3 p) {
    return shortest(p.x) + "," + shortest(p.y) + "," + shortest(p.z);
}

/// Beyond this distance, in extents, a Gaussian is below 1e-18.
double reach_of(DeformationKernel kernel) {
    return kernel == DeformationKernel::gaussian ? 6.44 : 1;
}

// --- Bounds of det(I + G D') over a box

/// exp(-x^2) and its derivative -2 x exp(-x^2), which has its extrema at x = -+sqrt(1/2).
Interval bell(const Interval& x) {
    const Interval s = square(x);
    return interval_detail::widen(std::exp(-s.hi), std::exp(-s.lo), interval_detail::kLibmMargin);
}
Interval bell_slope(const Interval& x) {
    const auto slope = [](double t) { return Interval(-2) * Interval(t) * bell(t); };
    const Interval a = slope(x.lo), b = slope(x.hi);
    Interval range{std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
    // Outwards: sqrt(2 / e) = 0.85776388496070679648...
    constexpr double kAt = 0.70710678118654752, kMost = 0.8577638849607069;
    if (x.lo <= -kAt && -kAt <= x.hi) range.hi = std::max(range.hi, kMost);
    if (x.lo <= kAt && kAt <= x.hi) range.lo = std::min(range.lo, -kMost);
    return std::isnan(magnitude(a)) || std::isnan(magnitude(b)) ? Interval::all() : range;
}

Interval clamped(const Interval& x, double low, double high) {
    return {std::clamp(x.lo, low, high), std::clamp(x.hi, low, high)};
}

/// The derivatives of F by u and v over a box.
std::array<Interval, 2> slopes(const Deformation& d, const Interval& u, const Interval& v) {
    const Interval x = (u - d.center.x) / Interval(d.extent.x), y = (v - d.center.y) / Interval(d.extent.y);
    if (std::isnan(magnitude(x)) || std::isnan(magnitude(y))) return {Interval::all(), Interval::all()};
    if (d.kernel == DeformationKernel::gaussian)
        return {bell_slope(x) * bell(y) / Interval(d.extent.x),
                bell_slope(y) * bell(x) / Interval(d.extent.y)};
    // dF/dx = -20 x (1 - r)^3 for r < 1
    const Interval rest = clamped(Interval(1) - sqrt(square(x) + square(y)), 0, 1);
    const Interval cube = rest * rest * rest * Interval(-20);
    return {clamped(x, -1, 1) * cube / Interval(d.extent.x), clamped(y, -1, 1) * cube / Interval(d.extent.y)};
}

Interval dot(const glm::dvec3& a, const glm::dvec3& b) {
    return Interval(a.x) * Interval(b.x) + Interval(a.y) * Interval(b.y) + Interval(a.z) * Interval(b.z);
}

/// Does a deformation reach into a box?
bool reaches(const Deformation& d, const Interval& u, const Interval& v) {
    const auto meets = [&](const Interval& s, double center, double extent) {
        const Interval reach = Interval(reach_of(d.kernel)) * Interval(extent);
        return !(s.hi < (Interval(center) - reach).lo || s.lo > (Interval(center) + reach).hi);
    };
    return meets(u, d.center.x, d.extent.x) && meets(v, d.center.y, d.extent.y);
}

/// det(I + A).
double determinant(glm::dvec2 by_u, glm::dvec2 by_v) {
    return (1 + by_u.x) * (1 + by_v.y) - by_u.y * by_v.x;
}

}  // namespace

ParameterPlane::ParameterPlane(glm::dvec3 origin, glm::dvec3 axis_u, glm::dvec3 axis_v)
    : m_origin(origin), m_axis_u(axis_u), m_axis_v(axis_v) {
    for (const auto& [name, vector] :
         {std::pair("origin", origin), std::pair("axis_u", axis_u), std::pair("axis_v", axis_v)})
        if (!finite(vector)) throw Error(name, written(vector), "must be finite");
    // The vectors are in units of the axes' lengths, so that no product leaves the range of double.
    const double length_u = glm::length(axis_u), length_v = glm::length(axis_v);
    const glm::dvec3 u = axis_u / length_u, v = axis_v / length_v, across = glm::cross(u, v);
    const double squared = glm::dot(across, across);
    if (!(squared > 1e-20) || !finite(1 / length_u * u) || !finite(1 / length_v * v))
        throw Error("axis_u and axis_v", written(axis_u) + " and " + written(axis_v),
                    "must be two directions that are not parallel");
    m_normal = across / std::sqrt(squared);
    m_gradient_u = glm::cross(v, across) / squared / length_u;
    m_gradient_v = glm::cross(across, u) / squared / length_v;
}

glm::dvec2 ParameterPlane::parameters(glm::dvec3 p) const {
    const glm::dvec3 from = p - m_origin;
    return {glm::dot(m_gradient_u, from), glm::dot(m_gradient_v, from)};
}

double ParameterPlane::depth(glm::dvec3 p) const {
    return glm::dot(m_normal, p - m_origin);
}

PlaneWarp::PlaneWarp(const ParameterPlane& plane, const std::vector<Deformation>& list) : m_plane(plane) {
    for (const Deformation& d : list) {
        check_deformation(d);
        if (!d.enabled || d.vector == glm::dvec3(0.0)) continue;
        if (d.has_depth())
            throw Error("extent", shortest(d.extent_w),
                        "a transform of space moves all depths: must be without a third number");
        if (d.has_side())
            throw Error("side", d.side == DeformationSide::front ? "front" : "back",
                        "a transform of space has no sides: must be both");
        m_list.push_back(d);
        if (glm::dot(plane.gradient_u(), d.vector) != 0 || glm::dot(plane.gradient_v(), d.vector) != 0)
            m_across = false;
    }
    if (m_list.empty()) return;
    m_least = glm::dvec2(kInfinity);
    m_most = -m_least;
    for (const Deformation& d : m_list) {
        const glm::dvec2 reach = reach_of(d.kernel) * d.extent;
        m_least =
            glm::dvec2(std::min(m_least.x, d.center.x - reach.x), std::min(m_least.y, d.center.y - reach.y));
        m_most =
            glm::dvec2(std::max(m_most.x, d.center.x + reach.x), std::max(m_most.y, d.center.y + reach.y));
    }
    m_side = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(m_list.size()))), 1, 256);
    m_bins.resize(static_cast<std::size_t>(m_side) * static_cast<std::size_t>(m_side));
    constexpr int kManyBins = 64;
    for (std::size_t k = 0; k < m_list.size(); ++k) {
        const glm::dvec2 reach = reach_of(m_list[k].kernel) * m_list[k].extent;
        const glm::dvec2 c = m_list[k].center;
        // One more bin each way covers the rounding.
        const int first_u = std::max(bin_of(c.x - reach.x, 0) - 1, 0),
                  last_u = std::min(bin_of(c.x + reach.x, 0) + 1, m_side - 1),
                  first_v = std::max(bin_of(c.y - reach.y, 1) - 1, 0),
                  last_v = std::min(bin_of(c.y + reach.y, 1) + 1, m_side - 1);
        if ((last_u - first_u + 1) * (last_v - first_v + 1) > kManyBins) {
            m_wide.push_back(k);
            continue;
        }
        for (int j = first_v; j <= last_v; ++j)
            for (int i = first_u; i <= last_u; ++i)
                m_bins[static_cast<std::size_t>(j * m_side + i)].entries.push_back(k);
    }
}

int PlaneWarp::bin_of(double value, int axis) const {
    // Halves, so that the width stays in the range of double.
    const double at = (value / 2 - m_least[axis] / 2) / (m_most[axis] / 2 - m_least[axis] / 2) * m_side;
    return at > 0 ? static_cast<int>(std::min(at, m_side - 1.)) : 0;  // 0 also where there is no width
}

DisplacementJet PlaneWarp::displacement(glm::dvec2 s) const {
    DisplacementJet sum;
    if (!(s.x >= m_least.x && s.x <= m_most.x && s.y >= m_least.y && s.y <= m_most.y)) return sum;
    const auto add = [&](std::size_t k) {
        const Deformation& d = m_list[k];
        const double reach = reach_of(d.kernel);
        if (std::fabs((s.x - d.center.x) / d.extent.x) <= reach &&
            std::fabs((s.y - d.center.y) / d.extent.y) <= reach)
            add_displacement(d, s, sum);
    };
    for (const std::size_t k : m_wide) add(k);
    if (m_side == 0) return sum;
    const auto bin = static_cast<std::size_t>(bin_of(s.y, 1) * m_side + bin_of(s.x, 0));
    for (const std::size_t k : m_bins[bin].entries) add(k);
    return sum;
}

glm::dvec3 PlaneWarp::forward(glm::dvec3 p) const {
    return p + displacement(m_plane.parameters(p)).value;
}

glm::dmat3 PlaneWarp::jacobian(glm::dvec3 p) const {
    const DisplacementJet d = displacement(m_plane.parameters(p));
    return glm::dmat3(1.0) + glm::outerProduct(d.by_u, m_plane.gradient_u()) +
           glm::outerProduct(d.by_v, m_plane.gradient_v());
}

glm::dvec2 PlaneWarp::residual(glm::dvec2 s, glm::dvec2 target, double share, DisplacementJet& jet) const {
    jet = displacement(s);
    return s - target +
           share * glm::dvec2(glm::dot(m_plane.gradient_u(), jet.value),
                              glm::dot(m_plane.gradient_v(), jet.value));
}

bool PlaneWarp::solve(glm::dvec2 target, double share, glm::dvec2& s) const {
    const double unit_u = glm::length(m_plane.axis_u()), unit_v = glm::length(m_plane.axis_v());
    const auto size = [&](glm::dvec2 r) { return hypot(r.x * unit_u, r.y * unit_v); };
    const double scale = size(target) + size(s);
    DisplacementJet jet;
    glm::dvec2 rest = residual(s, target, share, jet);
    for (int step = 0; step < 60 && size(rest) > 0; ++step) {
        const auto in_plane = [&](glm::dvec3 d) {
            return share * glm::dvec2(glm::dot(m_plane.gradient_u(), d), glm::dot(m_plane.gradient_v(), d));
        };
        const glm::dvec2 by_u = in_plane(jet.by_u), by_v = in_plane(jet.by_v);
        const double det = determinant(by_u, by_v);
        if (!(std::fabs(det) > 1e-14)) break;
        const glm::dvec2 newton{((1 + by_v.y) * rest.x - by_v.x * rest.y) / det,
                                ((1 + by_u.x) * rest.y - by_u.y * rest.x) / det};
        // Halved until the residual falls.
        bool fell = false;
        for (double part = 1; part > 1e-6 && !fell; part /= 2) {
            const glm::dvec2 next = s - part * newton;
            DisplacementJet next_jet;
            const glm::dvec2 next_rest = residual(next, target, share, next_jet);
            if (size(next_rest) < size(rest)) {
                s = next;
                rest = next_rest;
                jet = next_jet;
                fell = true;
            }
        }
        if (!fell) break;
    }
    // What rounding leaves: parameters of this size, and displacements.
    const double rounding =
        scale + size({glm::dot(m_plane.gradient_u(), jet.value), glm::dot(m_plane.gradient_v(), jet.value)});
    return size(rest) <= 64 * 0x1p-53 * rounding;
}

PlaneWarp::Inverse PlaneWarp::inverse(glm::dvec3 q) const {
    const glm::dvec2 target = m_plane.parameters(q);
    if (!finite(target)) return {q, finite(q)};
    glm::dvec2 s = target;
    bool found = m_across || solve(target, 1, s);
    if (!found) {
        // Along the way from the identity.
        constexpr int kSteps = 64;
        glm::dvec2 along = target;
        found = true;
        for (int i = 1; i <= kSteps && found; ++i)
            found = solve(target, static_cast<double>(i) / kSteps, along);
        if (found) s = along;
    }
    return {q - displacement(s).value, found};
}

/// A box of the plane, the deformations that reach into it, and what the determinant is there.
struct PlaneWarp::FoldBox {
    Interval determinant, u, v;
    std::vector<std::size_t> entries;

    bool operator<(const FoldBox& other) const { return determinant.lo > other.determinant.lo; }
    bool finite() const { return std::isfinite(u.hi - u.lo) && std::isfinite(v.hi - v.lo); }
};

PlaneWarp::FoldBox PlaneWarp::fold_box(const Interval& u, const Interval& v,
                                       const std::vector<std::size_t>& parents) const {
    FoldBox box{{}, u, v, {}};
    Interval a[2][2] = {};
    for (const std::size_t k : parents) {
        const Deformation& d = m_list[k];
        if (!reaches(d, u, v)) continue;
        box.entries.push_back(k);
        const auto by = slopes(d, u, v);
        const Interval g[2] = {dot(m_plane.gradient_u(), d.vector), dot(m_plane.gradient_v(), d.vector)};
        for (int row = 0; row < 2; ++row)
            for (std::size_t column = 0; column < 2; ++column) a[row][column] += g[row] * by[column];
    }
    const Interval one(1);
    box.determinant = (one + a[0][0]) * (one + a[1][1]) - a[0][1] * a[1][0];
    if (std::isnan(magnitude(box.determinant))) box.determinant = Interval::all();
    return box;
}

Fold PlaneWarp::find_fold(std::size_t most_boxes) const {
    if (m_across) return {};
    std::vector<std::size_t> all(m_list.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
    std::priority_queue<FoldBox> boxes;
    std::size_t work = 0;
    const auto push = [&](const Interval& u, const Interval& v, const std::vector<std::size_t>& parents) {
        work += parents.size();
        FoldBox box = fold_box(u, v, parents);
        if (!(box.determinant.lo > 0)) boxes.push(std::move(box));
    };
    push({m_least.x, m_most.x}, {m_least.y, m_most.y}, all);
    constexpr std::size_t kMostWork = 3'000'000;
    for (std::size_t count = 0; !boxes.empty(); ++count) {
        if (count >= most_boxes || work > kMostWork) return {FoldAnswer::undecided, {}};
        const FoldBox box = boxes.top();
        boxes.pop();
        const glm::dvec2 middle{box.u.lo / 2 + box.u.hi / 2, box.v.lo / 2 + box.v.hi / 2};
        if (!finite(middle) || !box.finite()) return {FoldAnswer::undecided, {}};
        if (fold_box(middle.x, middle.y, box.entries).determinant.hi <= 0) return {FoldAnswer::found, middle};
        // The longer side, measured in the extents of the finest deformation there, is halved.
        glm::dvec2 extent(kInfinity);
        for (const std::size_t k : box.entries)
            extent =
                glm::dvec2(std::min(extent.x, m_list[k].extent.x), std::min(extent.y, m_list[k].extent.y));
        if ((box.u.hi - box.u.lo) / extent.x >= (box.v.hi - box.v.lo) / extent.y) {
            push({box.u.lo, middle.x}, box.v, box.entries);
            push({middle.x, box.u.hi}, box.v, box.entries);
        } else {
            push(box.u, {box.v.lo, middle.y}, box.entries);
            push(box.u, {middle.y, box.v.hi}, box.entries);
        }
    }
    return {};
}

}  // namespace anamorph
