// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

#include "anamorph/deform/deformation_reach.h"
#include "anamorph/error.h"
#include "anamorph/number/rounded.h"
#include "anamorph/surface/shape/all.h"

namespace anamorph::surface {
namespace {

/// What influence() encloses over a box of (u, v), for Wendland's kernel, which is smooth at r = 0 though r is not. With
/// x and y in extents and r^2 = x^2 + y^2, up to r = 1:
///     F_x = -20 (1 - r)^3 x,  F_xx = -20 (1 - r)^3 + 60 (1 - r)^2 x^2 / r,  F_xy = 60 (1 - r)^2 x y / r,
/// where x^2 / r is at most r, and |x y| / r at most r / 2.
Jet<Interval, 2> wendland_range(const Deformation& d, const Interval& u, const Interval& v) {
    const Interval a = Interval(1) / Interval(d.extent.x), b = Interval(1) / Interval(d.extent.y);
    const Interval x = (u - d.center.x) * a, y = (v - d.center.y) * b;
    const Interval r = min(sqrt(square(x) + square(y)), Interval(1)), rest = max(1.0 - r, Interval(0));
    const Interval squared = square(rest), cubed = squared * rest;
    const auto over_r = [&](const Interval& product, const Interval& bound) {
        const Interval quotient = r.lo > 0 ? product / r : bound;
        return Interval(std::max(quotient.lo, bound.lo), std::min(quotient.hi, bound.hi));
    };
    const Interval xx = over_r(square(x), {0, r.hi}), yy = over_r(square(y), {0, r.hi}),
                   xy = over_r(x * y, {-r.hi / 2, r.hi / 2});
    Jet<Interval, 2> f(square(squared) * (r * 4.0 + 1.0));
    f.c[1] = cubed * x * -20.0 * a;
    f.c[2] = cubed * y * -20.0 * b;
    f.c[3] = (cubed * -10.0 + squared * xx * 30.0) * square(a);
    f.c[4] = squared * xy * 60.0 * a * b;
    f.c[5] = (cubed * -10.0 + squared * yy * 30.0) * square(b);
    return f;
}

/// What encloses g(x) = e^(-x^2), g' = -2 x g and g''/2 = (2 x^2 - 1) g over an interval: their values at its ends and at
/// the extrema within, +-1/sqrt(2) of g', and 0 and +-sqrt(3/2) of g''.
struct GaussianRange {
    Interval value, slope, bend;

    explicit GaussianRange(const Interval& x) {
        *this = at(x.lo);
        const GaussianRange end = at(x.hi);
        value = hull(value, end.value);
        slope = hull(slope, end.slope);
        bend = hull(bend, end.bend);
        // A little beyond the numbers below, and beyond where they are met.
        const auto meets = [&](double place) { return x.lo <= place + 1e-12 && x.hi >= place - 1e-12; };
        if (meets(0)) {
            value = hull(value, 1);
            bend = hull(bend, -1);
        }
        if (meets(-std::sqrt(0.5))) slope.hi = std::max(slope.hi, 0.857763884961);
        if (meets(std::sqrt(0.5))) slope.lo = std::min(slope.lo, -0.857763884961);
        if (meets(-std::sqrt(1.5)) || meets(std::sqrt(1.5))) bend.hi = std::max(bend.hi, 0.446260320297);
    }

  private:
    GaussianRange() = default;
    static GaussianRange at(double x) {
        GaussianRange r;
        // The square is half a unit of 2^-52 off, which the exponential multiplies by itself.
        const double squared = x * x, g = std::exp(-squared);
        r.value = g > 4 * interval_detail::kSmallest
                      ? interval_detail::widen(g, g, (squared + 16) * interval_detail::kUlp)
                      : Interval(0, 8 * interval_detail::kSmallest);
        r.slope = r.value * (-2 * x);
        r.bend = r.value * Interval(2 * squared - 1 - (squared + 1) * 0x1p-50,
                                    2 * squared - 1 + (squared + 1) * 0x1p-50);
        return r;
    }
};

/// What influence() encloses over a box of (u, v), for the Gaussian, a product of two of one variable.
Jet<Interval, 2> gaussian_range(const Deformation& d, const Interval& u, const Interval& v) {
    const Interval a = Interval(1) / Interval(d.extent.x), b = Interval(1) / Interval(d.extent.y);
    const GaussianRange x((u - d.center.x) * a), y((v - d.center.y) * b);
    Jet<Interval, 2> f(x.value * y.value);
    f.c[1] = x.slope * y.value * a;
    f.c[2] = x.value * y.slope * b;
    f.c[3] = x.bend * y.value * square(a);
    f.c[4] = x.slope * y.slope * (a * b);
    f.c[5] = x.value * y.bend * square(b);
    return f;
}

using IntervalJet = Jet<Interval, 2>;

/// f(z), where f and its derivative are enclosed over the box, and half its second derivative wherever it exists.
IntervalJet composed(const Interval& f, const Interval& slope, const Interval& bend, const IntervalJet& z) {
    IntervalJet r(f);
    r.c[1] = slope * z.c[1];
    r.c[2] = slope * z.c[2];
    r.c[3] = slope * z.c[3] + bend * square(z.c[1]);
    r.c[4] = slope * z.c[4] + bend * (z.c[1] * z.c[2] * 2.0);
    r.c[5] = slope * z.c[5] + bend * square(z.c[2]);
    return r;
}

/// Encloses Wendland's kernel of three ways, any functions of u and v, as the other wendland_range() does that of two:
/// F_x = -20 (1 - r)^3 x and F_xz = 60 (1 - r)^2 x z / r.
IntervalJet wendland_range(const std::array<IntervalJet, 3>& ways) {
    const std::array<Interval, 3> at = {ways[0].c[0], ways[1].c[0], ways[2].c[0]};
    // The derivatives of x, y and z by u and v.
    const std::array<std::array<Interval, 2>, 3> by = {
        {{ways[0].c[1], ways[0].c[2]}, {ways[1].c[1], ways[1].c[2]}, {ways[2].c[1], ways[2].c[2]}}};
    const Interval r = min(sqrt(square(at[0]) + square(at[1]) + square(at[2])), Interval(1)),
                   rest = max(1.0 - r, Interval(0));
    const Interval squared = square(rest), cubed = squared * rest;
    const auto second = [&](std::size_t i, std::size_t j) {
        const Interval bound = i == j ? Interval(0, r.hi) : Interval(-r.hi / 2, r.hi / 2);
        const Interval product = i == j ? square(at[i]) : at[i] * at[j];
        const Interval quotient = r.lo > 0 ? product / r : bound;
        const Interval over_r(std::max(quotient.lo, bound.lo), std::min(quotient.hi, bound.hi));
        return i == j ? cubed * -20.0 + squared * over_r * 60.0 : squared * over_r * 60.0;
    };
    const auto along = [&](std::size_t s, std::size_t t) {
        Interval sum(0);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) sum += second(i, j) * (by[i][s] * by[j][t]);
        return sum;
    };
    const std::array<Interval, 3> first = {cubed * at[0] * -20.0, cubed * at[1] * -20.0,
                                           cubed * at[2] * -20.0};
    IntervalJet f(square(squared) * (r * 4.0 + 1.0));
    f.c[3] = along(0, 0) * 0.5;
    f.c[4] = along(0, 1);
    f.c[5] = along(1, 1) * 0.5;
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t c = 1; c < 6; ++c) f.c[c] = f.c[c] + first[k] * ways[k].c[c];
    return f;
}

/// Encloses side_share(), which rises: H(t) = t^2 (3 - 2 t), H' = 6 t (1 - t), H'' = 6 - 12 t, all with t from 0 to 1, and
/// H'' also 0 where t goes beyond.
IntervalJet side_range(const IntervalJet& facing) {
    const Interval t = facing.c[0] * 2.0, within = min(max(t, Interval(0)), Interval(1));
    const auto value = [](double at) { return square(Interval(at)) * (3.0 - Interval(at) * 2.0); };
    const auto slope = [](double at) { return Interval(at) * (1.0 - Interval(at)) * 6.0; };
    Interval rise = hull(slope(within.lo), slope(within.hi));
    if (within.lo <= 0.5 && within.hi >= 0.5) rise.hi = std::max(rise.hi, 1.5);
    Interval bend = 6.0 - within * 12.0;
    if (!(t.lo > 0 && t.hi < 1)) bend = hull(bend, Interval(0));
    if (t.hi < 0 || t.lo > 1) bend = rise = Interval(0);
    // By the chain rule with t = 2 n . V / |V|.
    return composed({value(within.lo).lo, value(within.hi).hi}, rise * 2.0, bend * 2.0, facing);
}

/// Encloses the kernel of a bump with a frame: of three ways x, each a function of u and v.
IntervalJet framed_range(const Deformation& d, const IntervalJet& u, const IntervalJet& v,
                         const IntervalJet& w) {
    const auto turn = turn_of<Interval>(d);
    const IntervalJet from[3] = {u - IntervalJet(Interval(d.center.x)), v - IntervalJet(Interval(d.center.y)),
                                 w - IntervalJet(Interval(d.center_w))};
    const double extent[3] = {d.extent.x, d.extent.y, d.extent_w};
    std::array<IntervalJet, 3> x;
    for (std::size_t k = 0; k < 3; ++k) {
        IntervalJet sum = from[0] * IntervalJet(turn[0][k]);
        for (std::size_t j = 1; j < 3; ++j) sum = sum + from[j] * IntervalJet(turn[j][k]);
        x[k] = sum * IntervalJet(Interval(1) / Interval(extent[k]));
    }
    if (d.kernel == DeformationKernel::wendland_c2) return wendland_range(x);
    IntervalJet f(Interval(1));
    for (const IntervalJet& way : x) {
        const GaussianRange range(way.c[0]);
        f = f * composed(range.value, range.slope, range.bend, way);
    }
    return f;
}

/// influence(), and what encloses it.
template <class T>
T influence_of(const Deformation& d, const T& u, const T& v) {
    return influence(d, u, v);
}
/// The same where u and v are the variables themselves, with no products by what is 0 or 1: F_u = -2 x F / a_u. The bits are those of
/// influence().
Jet<double, 1> influence_of(const Deformation& d, const Jet<double, 1>& u, const Jet<double, 1>& v) {
    if (d.kernel != DeformationKernel::gaussian) return influence(d, u, v);
    const double a = 1 / d.extent.x, b = 1 / d.extent.y;
    const double x = (u.c[0] - d.center.x) * a, y = (v.c[0] - d.center.y) * b;
    Jet<double, 1> f(gaussian_of(x * x + y * y));
    f.c[1] = -2 * (x * a) * f.c[0];
    f.c[2] = -2 * (y * b) * f.c[0];
    return f;
}
/// Encloses influence() where u and v are the variables themselves.
IntervalJet influence_of(const Deformation& d, const IntervalJet& u, const IntervalJet& v) {
    return d.kernel == DeformationKernel::wendland_c2 ? wendland_range(d, u.value(), v.value())
                                                      : gaussian_range(d, u.value(), v.value());
}
/// Encloses the kernel of a bump with depth and no frame.
IntervalJet deep_range(const Deformation& d, const IntervalJet& u, const IntervalJet& v,
                       const IntervalJet& w) {
    const IntervalJet z =
        (w - IntervalJet(Interval(d.center_w))) * IntervalJet(Interval(1) / Interval(d.extent_w));
    if (d.kernel == DeformationKernel::gaussian) {
        const GaussianRange deep(z.c[0]);
        return influence_of(d, u, v) * composed(deep.value, deep.slope, deep.bend, z);
    }
    const Interval a = Interval(1) / Interval(d.extent.x), b = Interval(1) / Interval(d.extent.y);
    IntervalJet x((u.value() - d.center.x) * a), y((v.value() - d.center.y) * b);
    x.c[1] = a;
    y.c[2] = b;
    return wendland_range({x, y, z});
}

/// The same with depth or side.
template <class T>
T influence_of(const Deformation& d, const T& u, const T& v, const T& w, const T& facing) {
    return influence(d, u, v, w, facing);
}
IntervalJet influence_of(const Deformation& d, const IntervalJet& u, const IntervalJet& v,
                         const IntervalJet& w, const IntervalJet& facing) {
    const IntervalJet f = d.has_frame()   ? framed_range(d, u, v, w)
                          : d.has_depth() ? deep_range(d, u, v, w)
                                          : influence_of(d, u, v);
    return d.has_side() ? f * side_range(facing) : f;
}

/// What is added up, read with the numbers that a DrapedSurface is read with. Jets are of u and v, the variables
/// themselves.
class SurfacePart {
  public:
    virtual ~SurfacePart() = default;
    virtual SurfacePoint<double> point(const double& u, const double& v) const = 0;
    virtual SurfacePoint<DoubleDouble> point(const DoubleDouble& u, const DoubleDouble& v) const = 0;
    virtual SurfacePoint<Interval> point(const Interval& u, const Interval& v) const = 0;
    virtual SurfacePoint<Jet<double, 1>> point(const Jet<double, 1>& u, const Jet<double, 1>& v) const = 0;
    virtual SurfacePoint<Jet<Interval, 2>> point(const Jet<Interval, 2>& u,
                                                 const Jet<Interval, 2>& v) const = 0;
    // The unit normals, of parts that has_smooth_normals() allows; (0, 0, 0) of others.
    virtual SurfacePoint<double> normal(const double& u, const double& v) const = 0;
    virtual SurfacePoint<DoubleDouble> normal(const DoubleDouble& u, const DoubleDouble& v) const = 0;
    virtual SurfacePoint<Interval> normal(const Interval& u, const Interval& v) const = 0;
    virtual SurfacePoint<Jet<double, 1>> normal(const Jet<double, 1>& u, const Jet<double, 1>& v) const = 0;
    virtual SurfacePoint<Jet<Interval, 2>> normal(const Jet<Interval, 2>& u,
                                                  const Jet<Interval, 2>& v) const = 0;
};

/// Reads `Reader::read`, a template, with those.
template <class Reader>
class ReadPart final : public SurfacePart {
  public:
    explicit ReadPart(Reader reader) : m_reader(std::move(reader)) {}
    SurfacePoint<double> point(const double& u, const double& v) const override {
        return m_reader.read(u, v);
    }
    SurfacePoint<DoubleDouble> point(const DoubleDouble& u, const DoubleDouble& v) const override {
        return m_reader.read(u, v);
    }
    SurfacePoint<Interval> point(const Interval& u, const Interval& v) const override {
        return m_reader.read(u, v);
    }
    SurfacePoint<Jet<double, 1>> point(const Jet<double, 1>& u, const Jet<double, 1>& v) const override {
        return m_reader.read(u, v);
    }
    SurfacePoint<Jet<Interval, 2>> point(const Jet<Interval, 2>& u,
                                         const Jet<Interval, 2>& v) const override {
        return m_reader.read(u, v);
    }

    SurfacePoint<double> normal(const double& u, const double& v) const override { return normal_at(u, v); }
    SurfacePoint<DoubleDouble> normal(const DoubleDouble& u, const DoubleDouble& v) const override {
        return normal_at(u, v);
    }
    SurfacePoint<Interval> normal(const Interval& u, const Interval& v) const override {
        return normal_at(u, v);
    }
    SurfacePoint<Jet<double, 1>> normal(const Jet<double, 1>& u, const Jet<double, 1>& v) const override {
        return normal_at(u, v);
    }
    SurfacePoint<Jet<Interval, 2>> normal(const Jet<Interval, 2>& u,
                                          const Jet<Interval, 2>& v) const override {
        return normal_at(u, v);
    }

  private:
    template <class T>
    SurfacePoint<T> normal_at(const T& u, const T& v) const {
        if constexpr (requires { m_reader.normal(u, v); })
            return m_reader.normal(u, v);
        else
            return {T(0.0), T(0.0), T(0.0)};
    }

    Reader m_reader;
};

template <class Formula>
concept HasNormal = requires(const Formula& formula) {
    formula.normal(0.0, 0.0);
};

/// p + k q.
template <class T>
SurfacePoint<T> plus(const SurfacePoint<T>& p, const SurfacePoint<T>& q, const T& k) {
    return {p.x + k * q.x, p.y + k * q.y, p.z + k * q.z};
}

/// A formula, raised along its normal.
template <class Formula>
struct FormulaReader {
    Formula formula;
    std::shared_ptr<const SampledField> heights;
    double scale;

    template <class T>
    SurfacePoint<T> read(const T& u, const T& v) const {
        const SurfacePoint<T> p = formula.point(u, v);
        if constexpr (HasNormal<Formula>)
            if (heights) {
                T height(0.0);
                heights->read(u, v, &height);
                return plus(p, formula.normal(u, v), T(height * scale));
            }
        return p;
    }
    template <class T>
    SurfacePoint<T> normal(const T& u, const T& v) const requires HasNormal<Formula> {
        return formula.normal(u, v);
    }
};

struct PositionsReader {
    std::shared_ptr<const SampledField> positions;

    template <class T>
    SurfacePoint<T> read(const T& u, const T& v) const {
        std::array<T, 3> p{T(0.0), T(0.0), T(0.0)};
        positions->read(u, v, p.data());
        return {p[0], p[1], p[2]};
    }
};

/// A formula that is text, raised along nothing.
struct TextReader {
    SpaceFormula formula;

    template <class T>
    SurfacePoint<T> read(const T& u, const T& v) const {
        const auto [x, y, z] = read_program<3>(formula.point, u, v);
        return {x, y, z};
    }
    SurfacePoint<Interval> read(const Interval& u, const Interval& v) const {
        const auto [x, y, z] = read_program<3, DefinedInterval>(formula.point, u, v);
        return {x, y, z};
    }
    /// Jets, which are not bounded where a derivative jumps, do not know of positions what intervals do.
    SurfacePoint<Jet<Interval, 2>> read(const Jet<Interval, 2>& u, const Jet<Interval, 2>& v) const {
        auto [x, y, z] = read_program<3>(formula.point, u, v);
        const SurfacePoint<Interval> p = read(u.value(), v.value());
        x.c[0] = p.x;
        y.c[0] = p.y;
        z.c[0] = p.z;
        return {x, y, z};
    }
    /// The rounding of read() in double, over a box: no more than what there is of exact and of rounded
    /// points, which one interval holds.
    double rounding(const Interval& u, const Interval& v) const {
        using R = Rounded<double>;
        const auto rounded = read_program<3>(formula.point, R(u, 0, 0), R(v, 0, 0));
        const SurfacePoint<Interval> all = read(u, v);
        double most = 0;
        for (const auto& [axis, range] : {std::pair(0, all.x), std::pair(1, all.y), std::pair(2, all.z)}) {
            const double error = rounded[axis].error, width = (range.hi - range.lo) * (1 + 1e-15),
                         least = error <= width ? error : width;
            most = least <= HUGE_VAL ? std::max(most, least) : HUGE_VAL;
        }
        return most;
    }
    Certainty missing(const Interval& u, const Interval& v) const {
        if (formula.is_everywhere) return Certainty::no;
        const Interval domain = read_program<1, DefinedInterval>(formula.domain, u, v)[0];
        return domain.lo > 0 ? Certainty::no : domain.hi <= 0 ? Certainty::yes : Certainty::open;
    }
};

/// The box of a number's constant part.
Interval box_of(const Interval& a) {
    return a;
}
Interval box_of(double a) {
    return a;
}
template <class T, int N>
Interval box_of(const Jet<T, N>& a) {
    return box_of(a.c[0]);
}

/// What is not known but for its size, where a number says so.
template <class T>
void add_unknown(SurfacePoint<T>&, const glm::dvec3&) {}
Interval unknown(double size) {
    return {-size, size};
}
void add_unknown(SurfacePoint<Interval>& p, const glm::dvec3& size) {
    p = {p.x + unknown(size.x), p.y + unknown(size.y), p.z + unknown(size.z)};
}
void add_unknown(SurfacePoint<Jet<Interval, 2>>& p, const glm::dvec3& size) {
    for (int k = 0; k < Jet<Interval, 2>::kSize; ++k) {
        p.x.c[k] += unknown(size.x);
        p.y.c[k] += unknown(size.y);
        p.z.c[k] += unknown(size.z);
    }
}

class SummedSurface final : public DrapedSurface {
  public:
    explicit SummedSurface(const SurfaceSum& sum);

    glm::dvec3 position(double u, double v) const noexcept override {
        const SurfacePoint<double> p = point(u, v);
        return {p.x, p.y, p.z};
    }
    void positions(std::span<const double> u, std::span<const double> v, glm::dvec3* to) const override {
        for (std::size_t j = 0; j < v.size(); ++j)
            for (std::size_t i = 0; i < u.size(); ++i) {
                const SurfacePoint<double> p = sum_of_parts(u[i], v[j]);
                to[j * u.size() + i] = {p.x, p.y, p.z};
            }
        std::vector<double> across;
        const std::vector<Seen<double>> seen = seen_on_grid(u, v, to);
        for (std::size_t k = 0; k < m_deformations.size(); ++k) {
            if (m_deformations[k].is_plain())
                move_grid(k, u, v, across, to);
            else
                move_deep_grid(m_deformations[k], u, v, seen, to);
        }
    }
    double rounding(double u, double v) const noexcept override {
        // Whatever an operation rounds, intervals enclose it. Eight times that: a surface's own numbers, such as turns in
        // radians, have been rounded too.
        const SurfacePoint<Interval> p = point(Interval(u), Interval(v));
        return 8 * std::max({p.x.hi - p.x.lo, p.y.hi - p.y.lo, p.z.hi - p.z.lo});
    }
    double rounding(const Interval& u, const Interval& v) const noexcept override {
        const double known = DrapedSurface::rounding(u, v);
        return m_text ? known + m_text_weight * m_text->rounding(u, v) : known;
    }
    SurfaceFrame frame(double u, double v) const noexcept override {
        using J = Jet<double, 1>;
        const SurfacePoint<J> p = point(J::variable(u, 1, 0), J::variable(v, 0, 1));
        const auto part = [&](int i) { return glm::dvec3(p.x.c[i], p.y.c[i], p.z.c[i]); };
        return {part(0), part(1), part(2)};
    }
    std::array<DoubleDouble, 3> truth(DoubleDouble u, DoubleDouble v) const noexcept override {
        SurfacePoint<DoubleDouble> p = sum_of_parts(u, v);
        const Seen<DoubleDouble> seen = seen_at(p, u, v);
        for (const Deformation& d : m_deformations) p = moved(p, d, u, v, seen);
        return {p.x, p.y, p.z};
    }
    SurfaceRange range(const Interval& u, const Interval& v) const noexcept override {
        using J = Jet<Interval, 2>;
        const SurfacePoint<J> p = point(J::variable(u, 1.0, 0.0), J::variable(v, 0.0, 1.0));
        return {p.x, p.y, p.z};
    }
    Certainty missing(const Interval& u, const Interval& v) const noexcept override {
        Certainty all = Certainty::no;
        const auto add = [&](Certainty one) {
            if (one != Certainty::no && all != Certainty::yes) all = one;
        };
        for (const auto& field : m_fields) add(field->missing(u, v));
        if (m_text) add(m_text->missing(u, v));
        return all;
    }

  private:
    template <class T>
    SurfacePoint<T> sum_of_parts(const T& u, const T& v) const {
        SurfacePoint<T> sum = m_parts[0]->point(u, v);
        if (m_weights[0] != 1) sum = {sum.x * m_weights[0], sum.y * m_weights[0], sum.z * m_weights[0]};
        for (std::size_t i = 1; i < m_parts.size(); ++i)
            sum = plus(sum, m_parts[i]->point(u, v), T(m_weights[i]));
        return sum;
    }
    /// What deformations with depth or side see of the undeformed surface: its depth, which is z, and the mean of its parts'
    /// normals, by the magnitudes of their weights.
    template <class T>
    struct Seen {
        T w{0.0};
        SurfacePoint<T> normal{T(0.0), T(0.0), T(0.0)};

        T facing(const Deformation& d) const {
            const Triple<T> direction = side_direction<T>(d);
            return normal.x * direction.x + normal.y * direction.y + normal.z * direction.z;
        }
    };
    template <class T>
    Seen<T> seen_at(const SurfacePoint<T>& undeformed, const T& u, const T& v) const {
        Seen<T> seen;
        if (!m_deep) return seen;
        seen.w = undeformed.z;
        if (!m_sided) return seen;
        double magnitudes = 0;
        for (const double weight : m_weights) magnitudes += std::fabs(weight);
        for (std::size_t i = 0; i < m_parts.size() && magnitudes > 0; ++i)
            seen.normal = plus(seen.normal, m_parts[i]->normal(u, v), T(m_weights[i] / magnitudes));
        return seen;
    }
    std::vector<Seen<double>> seen_on_grid(std::span<const double> u, std::span<const double> v,
                                           const glm::dvec3* undeformed) const {
        std::vector<Seen<double>> seen;
        for (std::size_t j = 0; j < v.size() && m_deep; ++j)
            for (std::size_t i = 0; i < u.size(); ++i, ++undeformed)
                seen.push_back(seen_at<double>({undeformed->x, undeformed->y, undeformed->z}, u[i], v[j]));
        return seen;
    }
    template <class T>
    static T share_of(const Deformation& d, const T& u, const T& v, const Seen<T>& seen) {
        if (d.is_plain()) return influence_of(d, u, v);
        return influence_of(d, u, v, seen.w, d.has_side() ? seen.facing(d) : T(0.0));
    }
    template <class T>
    static SurfacePoint<T> moved(const SurfacePoint<T>& p, const Deformation& d, const T& u, const T& v,
                                 const Seen<T>& seen) {
        const T share = share_of(d, u, v, seen);
        const auto add = [&](const T& a, double k) { return k == 0 ? a : T(a + share * k); };
        return {add(p.x, d.vector.x), add(p.y, d.vector.y), add(p.z, d.vector.z)};
    }
    /// Moves the points of a grid that a deformation reaches. A Gaussian is a product of a column's and a row's: off by less
    /// than 8 (r^2 + 1) F, where point(Interval) allows 16.
    void move_grid(std::size_t index, std::span<const double> u, std::span<const double> v,
                   std::vector<double>& across, glm::dvec3* to) const {
        const Deformation& d = m_deformations[index];
        const DeformationReach::Reached& box = m_reach.reached(index);
        const auto reaches = [](double at, double low, double high) { return at >= low && at <= high; };
        const auto kernel = [&](double x) { return kernel_value(d.kernel, x, 0.0); };
        const bool product = d.kernel == DeformationKernel::gaussian;
        std::size_t first = u.size(), end = 0;
        across.assign(u.size(), 0);
        for (std::size_t i = 0; i < u.size(); ++i) {
            if (!reaches(u[i], box.u0, box.u1)) continue;
            if (product) across[i] = kernel((u[i] - d.center.x) * (1 / d.extent.x));
            first = std::min(first, i);
            end = i + 1;
        }
        for (std::size_t j = 0; j < v.size() && first < end; ++j) {
            if (!reaches(v[j], box.v0, box.v1)) continue;
            const double down = product ? kernel((v[j] - d.center.y) * (1 / d.extent.y)) : 0;
            glm::dvec3* const row = to + j * u.size();
            for (std::size_t i = first; i < end; ++i) {
                if (!product && !reaches(u[i], box.u0, box.u1)) continue;
                row[i] += (product ? across[i] * down : influence(d, u[i], v[j])) * d.vector;
            }
        }
    }
    static void move_deep_grid(const Deformation& d, std::span<const double> u, std::span<const double> v,
                               const std::vector<Seen<double>>& seen, glm::dvec3* to) {
        for (std::size_t j = 0; j < v.size(); ++j)
            for (std::size_t i = 0; i < u.size(); ++i)
                to[j * u.size() + i] += share_of(d, u[i], v[j], seen[j * u.size() + i]) * d.vector;
    }
    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        SurfacePoint<T> p = sum_of_parts(u, v);
        const Seen<T> seen = seen_at(p, u, v);
        std::size_t near = 0;
        m_reach.each_near(box_of(u), box_of(v), [&](std::size_t i) {
            p = moved(p, m_deformations[i], u, v, seen);
            ++near;
        });
        if (near < m_deformations.size()) add_unknown(p, m_reach.far());
        return p;
    }
    /// How much of F is lost, in units of 2^-53, where it has a frame: x errs by 3^(1/2) (22.6 K + 2.5) r units (kFrameError), so r^2 by
    /// (79 K + 9) r^2 and a Gaussian by as much of itself, and by 16 (r^2 + 1) of what exp and the sum of squares lose; Wendland's kernel by
    /// |r F'| <= 0.7, 32 (K + 1), and by 16. A depth that is off moves x by so much over the least extent, and F by 2.2 times that.
    static double lost_in_frame(const Deformation& d, double u, double v, const Interval& w) {
        double squared = 0;
        for (const double x : in_own_frame(d, u, v, w.lo)) squared += x * x;
        const auto [least, most] = std::minmax({d.extent.x, d.extent.y, d.extent_w});
        const double ratio = most / least, f = influence(d, u, v, w.lo, 1.0);
        const double kernel = d.kernel == DeformationKernel::gaussian
                                  ? (f > 0 ? f * ((80 * ratio + 26) * (squared + 1)) : 0)
                                  : 32 * (ratio + 1) + 16;
        return 1.01 * (kernel + 2.2 * 0x1p53 * (w.hi - w.lo) / least);
    }
    /// How far point() in double may be from the exact point, for rounding() alone: where deformations are concerned, the
    /// point itself is not known. x and y of a kernel are off by 3 units of 2^-53 of themselves, r^2 by 8, and, with what
    /// exp or the polynomial lose, F by less than 16 (r^2 + 1) F; each sum, by one unit of what is added up. With depth or side, F is
    /// also off by what the depth and the normal may be, times the greatest slopes of F by z, 20 r (1 - r)^3 <= 2.2, and of S by
    /// n . V / |V|, 3; S and n . V / |V| round as kDeepError counts it.
    SurfacePoint<Interval> point(const Interval& u, const Interval& v) const {
        SurfacePoint<Interval> p = sum_of_parts(u, v);
        const Seen<Interval> seen = seen_at(p, u, v);
        glm::dvec3 lost(0.0), added(magnitude(p.x), magnitude(p.y), magnitude(p.z));
        m_reach.each_near(u, v, [&](std::size_t i) {
            const Deformation& d = m_deformations[i];
            const double x = (u.lo - d.center.x) / d.extent.x, y = (v.lo - d.center.y) / d.extent.y;
            glm::dvec3 moved = glm::abs(d.vector) * kernel_value(d.kernel, x, y);
            double square_of_z = 0;
            if (d.has_frame()) {
                moved = glm::abs(d.vector) * influence(d, u.lo, v.lo, seen.w.lo, 1.0);
                lost += glm::abs(d.vector) * lost_in_frame(d, u.lo, v.lo, seen.w);
            } else if (d.has_depth()) {
                const double z = (seen.w.lo - d.center_w) / d.extent_w;
                // Of a side, as if it were all there.
                const double f = influence(d, u.lo, v.lo, seen.w.lo, 1.0);
                moved = glm::abs(d.vector) * f;
                square_of_z = f > 0 ? z * z : 0;
                lost += glm::abs(d.vector) * (2.2 * 0x1p53 * (seen.w.hi - seen.w.lo) / d.extent_w);
            }
            if (d.has_side()) {
                const Interval facing = seen.facing(d);
                lost += moved * (64 + 3 * 0x1p53 * (facing.hi - facing.lo));
            }
            added += moved;
            lost += added;
            if (!d.has_frame()) lost += moved * (16 * (x * x + y * y + square_of_z + 1));
        });
        add_unknown(p, lost * 0x1p-53 + m_reach.far());
        return p;
    }

    std::vector<std::unique_ptr<SurfacePart>> m_parts;
    std::vector<double> m_weights;
    std::vector<std::shared_ptr<const SampledField>> m_fields;
    std::optional<TextReader> m_text;
    double m_text_weight = 0;                 ///< the sum of its magnitudes
    std::vector<Deformation> m_deformations;  ///< with v down
    bool m_deep = false, m_sided = false;     ///< has any of them depth or side, a side?
    DeformationReach m_reach;
};

using MakePart = std::unique_ptr<SurfacePart> (*)(const SurfaceSum&);

template <class Formula>
std::unique_ptr<SurfacePart> make_part(const SurfaceSum& sum) {
    using Reader = FormulaReader<Formula>;
    return std::make_unique<ReadPart<Reader>>(Reader{Formula(sum.shape), sum.heights, sum.height_scale});
}

std::unique_ptr<SurfacePart> make_part_of(const SurfaceSum::Part& part, const SurfaceSum& sum) {
    static const std::vector<MakePart> makers = {
#define ANAMORPH_SURFACE(name, Type) make_part<shapes::Type>,
#include "anamorph/surface/shape/list.h"
#undef ANAMORPH_SURFACE
    };
    if (part.which < makers.size()) return makers[part.which](sum);
    if (part.which == makers.size())
        return std::make_unique<ReadPart<PositionsReader>>(
            PositionsReader{part.positions ? part.positions : sum.positions});
    return std::make_unique<ReadPart<TextReader>>(TextReader{sum.formula.value()});
}

/// The deformations that are enabled, checked, with v counted up as it is down here. Differences from a
/// centre are exact near by, and one from 1 would not be.
std::vector<Deformation> enabled(std::vector<Deformation> list) {
    for (Deformation& d : list) {
        check_deformation(d);
        d.center.y = 1 - d.center.y;
        // A mirror image of the frame: its own v counts the other way as well, of which r^2 knows nothing.
        d.orientation = {d.orientation.x, -d.orientation.y, d.orientation.z, -d.orientation.w};
    }
    std::erase_if(list, [](const Deformation& d) { return !d.enabled; });
    return list;
}

SummedSurface::SummedSurface(const SurfaceSum& sum)
    : m_deformations(enabled(sum.deformations)), m_reach(m_deformations) {
    for (const SurfaceSum::Part& part : sum.parts) {
        m_parts.push_back(make_part_of(part, sum));
        m_weights.push_back(part.weight);
        if (part.positions) m_fields.push_back(part.positions);
        if (part.which == surface_names().size() + 1) m_text_weight += std::fabs(part.weight);
    }
    for (const auto& field : {sum.positions, sum.heights})
        if (field) m_fields.push_back(field);
    if (sum.formula) m_text = TextReader{*sum.formula};
    m_deep = needs_depth(m_deformations);
    m_sided = needs_normals(m_deformations);
    for (const SurfaceSum::Part& part : sum.parts)
        if (m_sided && !has_smooth_normals(part.which))
            throw Error(
                "side", "front or back",
                "the normals of " + all_surface_names()[part.which] + " may turn abruptly: must be both");
}

}  // namespace

const std::vector<std::string>& surface_names() {
    static const std::vector<std::string> names = {
#define ANAMORPH_SURFACE(name, Type) #name,
#include "anamorph/surface/shape/list.h"
#undef ANAMORPH_SURFACE
    };
    return names;
}

const std::vector<std::string>& all_surface_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all = surface_names();
        all.insert(all.end(), {"positions", "formula"});
        return all;
    }();
    return names;
}

bool has_smooth_normals(std::size_t which) {
    static const std::vector<bool> smooth = {
#define ANAMORPH_SURFACE(name, Type) HasNormal<shapes::Type>,
#include "anamorph/surface/shape/list.h"
#undef ANAMORPH_SURFACE
    };
    return which < smooth.size() && smooth[which];
}

std::shared_ptr<const DrapedSurface> make_surface(const SurfaceSum& sum) {
    return std::make_shared<SummedSurface>(sum);
}

std::shared_ptr<const DrapedSurface> make_surface(std::size_t which, const SurfaceShape& shape,
                                                  const std::vector<Deformation>& deformations) {
    SurfaceSum sum;
    sum.parts = {{which, 1}};
    sum.shape = shape;
    sum.deformations = deformations;
    return make_surface(sum);
}

}  // namespace anamorph::surface
