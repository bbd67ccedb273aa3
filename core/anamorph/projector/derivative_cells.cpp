// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/derivative_cells.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

#include "anamorph/number/portable.h"

namespace anamorph {
namespace {

// The least and the largest reach of cells beyond their squares.
constexpr double kLeast = 0x1p-30, kMost = 0.125;
// The least width of a square, in reaches.
constexpr double kWider = 4;
// Stands for a few roundings of numbers of which 1 is the size, and of frames, which are off by 64 * 2^-53 of a ray.
constexpr double kRounding = 1e-13;

/// A number within `off` of another. What is rounded here is part of kRounding.
struct About {
    double at = 0, off = 0;

    /// The numbers of an interval.
    static About of(double low, double high) {
        const double at = 0.5 * (low + high);
        return {at, std::max(high - at, at - low) + kRounding * (std::fabs(low) + std::fabs(high))};
    }
};
About operator+(const About& a, const About& b) {
    return {a.at + b.at, a.off + b.off};
}
About operator-(const About& a, const About& b) {
    return {a.at - b.at, a.off + b.off};
}
About operator*(const About& a, const About& b) {
    return {a.at * b.at, std::fabs(a.at) * b.off + a.off * (std::fabs(b.at) + b.off)};
}

/// A vector of (u, v), w of eq. (1), and a.
struct Along {
    About u, v, a;
};

}  // namespace

/// The derivatives of x and y at the middle of a cell, and third ones anywhere in it.
struct DerivativeCells::Cell {
    struct Derivatives {
        About u, v, uu, uv, vv, uuu, uuv, uvv, vvv;

        /// Those of the first two degrees anywhere within (u, v) of the middle, by Taylor's formula.
        Derivatives within(const About& by_u, const About& by_v) const {
            const About more_uu = uuu * by_u + uuv * by_v, more_uv = uuv * by_u + uvv * by_v,
                        more_vv = uvv * by_u + vvv * by_v;
            Derivatives d;
            const auto half = [](const About& a) { return About{a.at / 2, a.off / 2}; };
            d.u = u + (uu + half(more_uu)) * by_u + (uv + half(more_uv)) * by_v;
            d.v = v + (uv + half(more_uv)) * by_u + (vv + half(more_vv)) * by_v;
            d.uu = uu + more_uu;
            d.uv = uv + more_uv;
            d.vv = vv + more_vv;
            return d;
        }
        /// Eq. (1).
        About second(const Along& e, const Along& f) const {
            return uu * (e.u * f.u) + uv * (e.u * f.v + e.v * f.u) + vv * (e.v * f.v) -
                   e.a * (u * f.u + v * f.v) - f.a * (u * e.u + v * e.v);
        }
    };
    bool is_known = false;
    double middle_u = 0, middle_v = 0;
    Derivatives x, y;
};

std::size_t DerivativeCells::Place::hash() const {
    const auto bits = [](double v) { return bit_cast<std::uint64_t>(v); };
    // Neighbours are to differ in the lower bits.
    const std::uint64_t sum =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(column)) * 0x9E3779B97F4A7C15u +
        static_cast<std::uint64_t>(static_cast<std::int64_t>(row)) * 0xC2B2AE3D27D4EB4Fu +
        (bits(width) >> 44) * 0x165667B19E3779F9u + static_cast<std::uint64_t>(face) * 0x27D4EB2F165667C5u;
    return sum >> 40;
}

/// The cells that a thread has read last, each at the place of its number.
class DerivativeCells::Kept {
  public:
    /// The cell of a place; `read` makes one that is not kept.
    template <class Read>
    const Cell& at(const Place& place, const Read& read) {
        Entry& entry = m_entries[place.hash() % m_entries.size()];
        if (!(entry.place == place)) {
            entry.cell = read();
            entry.place = place;
        }
        return entry.cell;
    }

  private:
    struct Entry {
        Place place;
        Cell cell;
    };
    std::vector<Entry> m_entries{2048};
};

DerivativeCells::DerivativeCells(const Chart& chart) : m_chart(chart) {
    static std::atomic<std::int64_t> count{0};
    m_number = ++count;
}

Branch DerivativeCells::branch_for(const glm::dvec3& middle) const {
    if (m_chart.counted() != Counted::azimuth)
        return m_chart.branch_around(Ray<double>{middle.x, middle.y, middle.z});
    // Along an axis of rays, whose parts are then parts of the cell's.
    return std::fabs(middle.x) > std::fabs(middle.z)
               ? m_chart.branch_around(Ray<double>{std::copysign(1, middle.x), 0, 0})
               : m_chart.branch_around(Ray<double>{0, 0, std::copysign(1, middle.z)});
}

DerivativeCells::Cell DerivativeCells::read(const Place& place) const {
    Cell cell;
    cell.middle_u = (place.column + 0.5) * place.width;
    cell.middle_v = (place.row + 0.5) * place.width;
    const int axis = place.face % 3, across = (axis + 1) % 3, down = (axis + 2) % 3;
    glm::dvec3 middle;
    middle[axis] = place.face < 3 ? 1 : -1;
    middle[across] = cell.middle_u;
    middle[down] = cell.middle_v;
    const Branch branch = branch_for(middle);
    const glm::dmat3 turn = glm::transpose(branch.axes);
    const Interval hair(-kRounding, kRounding);
    // The rays within `reach` of the middle, with derivatives by u and v.
    const auto rays = [&]<class J>(J, double reach) {
        const Interval range(-reach, reach);
        J part[3];
        for (int k = 0; k < 3; ++k)
            part[k] = J::variable(middle[axis] * turn[axis][k] + (middle[across] + range) * turn[across][k] +
                                      (middle[down] + range) * turn[down][k] + hair,
                                  turn[across][k] + hair, turn[down][k] + hair);
        return Ray<J>{part[0], part[1], part[2]};
    };
    const auto all = rays(Jet<Interval, 3>(), place.width * (0.5 + 1 / kWider));
    const Ray<Interval> range{all.x.c[0], all.y.c[0], all.z.c[0]};
    const bool one_branch = m_chart.counted() != Counted::azimuth || range.z.lo > 0;
    if (!one_branch || !(m_chart.sees(range, 0).lo > 0)) return cell;
    const auto within = m_chart.local_point(all, branch);
    const auto is_on = [](const Interval& at, double size) { return at.lo >= 0 && at.hi <= size; };
    if (!(m_chart.closed() || is_on(within.x.c[0], m_chart.width())) ||
        !is_on(within.y.c[0], m_chart.height()))
        return cell;
    const auto at_middle = m_chart.local_point(rays(Jet2<Interval>(), 0), branch);
    cell.is_known = true;
    const auto set = [&cell](const Jet2<Interval>& at, const Jet<Interval, 3>& in, Cell::Derivatives& to) {
        const auto about = [&](const Interval& one, double times) {
            const About number = About::of(one.lo * times, one.hi * times);
            cell.is_known = cell.is_known && std::isfinite(number.off);
            return number;
        };
        to = {about(at.c[1], 1), about(at.c[2], 1), about(at.c[3], 2), about(at.c[4], 1), about(at.c[5], 2),
              about(in.c[6], 6), about(in.c[7], 2), about(in.c[8], 2), about(in.c[9], 6)};
    };
    set(at_middle.x, within.x, cell.x);
    set(at_middle.y, within.y, cell.y);
    return cell;
}

const DerivativeCells::Cell& DerivativeCells::cell(const Place& place) const {
    thread_local Kept kept;
    return kept.at(place, [&] { return read(place); });
}

std::optional<Point<SecondForms>> DerivativeCells::over(std::span<const glm::dvec3> rays,
                                                        const glm::dvec3& middle, const glm::dvec3& e,
                                                        const glm::dvec3* f) const {
    const glm::dvec3 size = glm::abs(middle);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int across = (axis + 1) % 3, down = (axis + 2) % 3;
    if (!(size[axis] > 0x1p-300 && size[axis] < 0x1p300)) return {};
    // Scaled so that z is 1 at the middle.
    const double side = middle[axis] < 0 ? -1 : 1, scale = 1 / size[axis];
    double z_low = 1, z_high = 1;
    const double u = middle[across] * scale, v = middle[down] * scale;
    double u_low = u, u_high = u, v_low = v, v_high = v;
    for (const glm::dvec3& r : rays) {
        const double z = side * r[axis];
        if (!(z > 0)) return {};
        const double to_u = r[across] / z, to_v = r[down] / z;
        if (!(std::fabs(to_u) < 2 && std::fabs(to_v) < 2)) return {};
        z_low = std::min(z_low, z * scale);
        z_high = std::max(z_high, z * scale);
        u_low = std::min(u_low, to_u);
        u_high = std::max(u_high, to_u);
        v_low = std::min(v_low, to_v);
        v_high = std::max(v_high, to_v);
    }
    const double most = std::max({u_high - u, u - u_low, v_high - v, v - v_low});
    if (!(most > kLeast && most <= kMost)) return {};
    const double width = std::ldexp(1.0, std::ilogb(most * kWider) + 1);
    const Cell& known =
        cell({m_number, width, std::floor(u / width), std::floor(v / width), axis + (side < 0 ? 3 : 0)});
    if (!known.is_known) return {};
    const About per_z = About::of(1 / z_high, 1 / z_low), u_range = About::of(u_low, u_high),
                v_range = About::of(v_low, v_high);
    const auto along = [&](const glm::dvec3& d) {
        const auto part = [&](int k) { return About{d[k] * scale, kRounding}; };
        const About z = About{side, 0} * part(axis);
        return Along{(part(across) - u_range * z) * per_z, (part(down) - v_range * z) * per_z, z * per_z};
    };
    const About by_u = u_range - About{known.middle_u, kRounding},
                by_v = v_range - About{known.middle_v, kRounding};
    const auto x = known.x.within(by_u, by_v), y = known.y.within(by_u, by_v);
    const Along to_e = along(e), to_f = f ? along(*f) : Along();
    const auto forms = [&](const Cell::Derivatives& of) {
        SecondForms found;
        const auto set = [&](const Along& first, const Along& second, double& at, double& off) {
            const About form = of.second(first, second);
            at = form.at;
            off = form.off;
        };
        set(to_e, to_e, found.ee, found.off_ee);
        if (!f) return found;
        set(to_e, to_f, found.ef, found.off_ef);
        set(to_f, to_f, found.ff, found.off_ff);
        return found;
    };
    return Point<SecondForms>{forms(x), forms(y)};
}

}  // namespace anamorph
